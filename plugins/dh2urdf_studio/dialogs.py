"""What the studio asks and hands over: opening, saving, generating, converting, and what went wrong."""

from __future__ import annotations

import traceback
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nicegui import ElementFilter, run, ui

from dh2urdf.errors import Dh2UrdfError
from dh2urdf.manipulator import Convention
from dh2urdf.table_text import ANGLE_UNITS, LENGTH_UNITS
from dh2urdf_studio import gallery, words
from dh2urdf_studio.editing import save as saving
from dh2urdf_studio.editing.opening import Opened, tables_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.table_text import TableText
    from dh2urdf_studio.editing.save import Saved
    from dh2urdf_studio.editing.session import Session

LARGEST_FILE = 64 * 2**20
"""Size of a file that may be opened [B]."""
_MOST_WARNINGS = 3
LOST = "The files did not arrive. Open them again."
"""The message where the connection was cut while files were sent."""
MOST_CHOICES = 1000
"""Manipulators of a file that a person is given to choose from."""
_MEANINGS = {
    Convention.STANDARD: "standard (Denavit-Hartenberg, Spong): Rz(θ) Tz(d) Tx(a) Rx(α)",
    Convention.MODIFIED: "modified (Craig): Rx(α) Tx(a) Rz(θ) Tz(d)",
}


@contextmanager
def card(title: str, *, persistent: bool = False) -> Iterator[ui.dialog]:
    """A dialog with a title, which is its name for those who do not see it."""
    with ui.dialog() as dialog, ui.card().classes("studio-card"):
        dialog.props["aria-label"] = title
        if persistent:
            dialog.props("persistent")
        with ui.element("h2"):
            ui.label(title)
        yield dialog


async def answer_of(dialog: ui.dialog) -> Any:  # noqa: ANN401 - what was submitted
    """What a person answers; None where the dialog, or its tab, was closed."""
    answer = await dialog
    if not dialog.is_deleted:  # as everything of a tab is that was closed
        dialog.delete()
        dialog.client.run_javascript("dhPage.back()")
    return answer


# --- Converting -------------------------------------------------------------------------------------------------------


async def ask_convention(convention: Convention, *, possible: bool) -> bool | None:
    """Whether to convert to a convention (True) or to reinterpret (False); None for neither."""
    moved = (
        "a and α move down by one row; what is left over goes into the tool."
        if convention is Convention.MODIFIED
        else "a and α move up by one row; what is left over goes into the base."
    )
    both = (
        f"Convert: the same arm, other numbers. {moved}",
        "Reinterpret: the same numbers, another arm. They were meant so from the beginning.",
    )
    answer = await _ask(f"To the convention {_MEANINGS[convention]}", lambda: both, possible=possible)
    return None if answer is None else bool(answer[0])


async def ask_units(length: str, angle: str, *, possible: bool) -> tuple[str, str, bool] | None:
    """Units, which can be chosen again here, and whether to convert to them or to reinterpret; None for neither."""
    answer = await _ask(
        "To other units",
        lambda *units: (
            f"Convert: the same arm, its numbers in {' and '.join(units)}. Cells that name their unit stay.",
            f"Reinterpret: the same numbers, now {' and '.join(units)}: another arm.",
        ),
        possible=possible,
        units={"unit of lengths": (LENGTH_UNITS, length), "unit of angles": (ANGLE_UNITS, angle)},
    )
    return answer and (answer[0], answer[1], answer[2])


async def _ask(
    title: str,
    told: Callable[..., tuple[str, str]],
    *,
    possible: bool,
    units: Mapping[str, tuple[Sequence[str], str]] | None = None,
) -> tuple[Any, ...] | None:
    # Another choice may have come before the dialog was on the page.
    for asked in ElementFilter(kind=ui.dialog, marker="conversion"):
        asked.submit(None)

    def show() -> None:
        for button, text in zip((convert, again), told(*(each.value for each in chosen)), strict=True):
            button.set_text(text)

    with card(title) as dialog:
        dialog.mark("conversion")
        with ui.element("div").classes("studio-row") as row:
            chosen = [
                ui.toggle(list(every), value=unit, on_change=show).props(f'unelevated no-caps aria-label="{name}"')
                for name, (every, unit) in (units or {}).items()
            ]
        row.set_visibility(bool(chosen))
        convert = ui.button(on_click=lambda: dialog.submit(True)).props("unelevated align=left autofocus")
        convert.classes("studio-choice").set_enabled(possible)
        if not possible:
            ui.label("A table that is not right yet cannot be converted.").classes("studio-status")
        again = ui.button(on_click=lambda: dialog.submit(False)).props("outline align=left").classes("studio-choice")
        ui.button("Cancel", on_click=lambda: dialog.submit(None)).props("flat")
        show()
    answer = await answer_of(dialog)
    return None if answer is None else (*(each.value for each in chosen), answer)


# --- Opening ----------------------------------------------------------------------------------------------------------


async def ask_table(catalog: Catalog) -> Opened | None:
    """A table of the gallery or of a file; None where none was chosen."""
    suffixes = table_suffixes(catalog)
    with card("Open a table") as dialog:

        def refuse(told: str) -> None:
            problem.set_text(told)
            problem.set_visibility(True)

        def refuse_file(reason: str, name: str) -> None:
            told = f"{name} is too large" if reason == "max-file-size" else f"{name} is no file that can be opened"
            refuse(f"{told}\naccepted: {accepted}")

        async def take(event: Any) -> None:  # noqa: ANN401 - NiceGUI's
            name, size = event.file.name, event.file.size()
            if size > LARGEST_FILE:  # before it is in memory, whatever the page has let through
                refuse_file("max-file-size", name)
                return
            problem.set_visibility(False)
            busy.set_visibility(True)
            told.set_text(words.busy(name, size))
            tables = await run.io_bound(tables_of, name, await event.file.read(), catalog, MOST_CHOICES + 1)
            if dialog.is_deleted or not dialog.value:  # a person has gone on without it
                return
            busy.set_visibility(False)
            if isinstance(tables, str):
                refuse(tables)
            else:
                dialog.submit(tables)

        accepted = f"one of {', '.join(suffixes)}, of at most {LARGEST_FILE // 2**20} MB"
        label = "drop a file of yours here, or choose it"
        upload = ui.upload(label=label, auto_upload=True, max_file_size=LARGEST_FILE, on_upload=take)
        why = "([{ failedPropValidation, file }]) => emit(failedPropValidation, file.name)"
        upload.on("rejected", lambda event: refuse_file(*event.args), js_handler=why)
        upload.props(f'accept="{",".join(suffixes)}" flat bordered').style("width: 100%")
        choose_file = ui.button("Choose a file", icon="folder_open", on_click=lambda: upload.run_method("pickFiles"))
        choose_file.props("unelevated no-caps autofocus")
        with ui.element("div").style("width: 100%") as busy:
            told = ui.label().classes("studio-status")
            ui.linear_progress(show_value=False).props("indeterminate instant-feedback")
        busy.set_visibility(False)
        problem = ui.label().classes("studio-problem error")
        problem.set_visibility(False)
        ui.label("or one of the gallery").classes("studio-status")
        with ui.element("div").classes("studio-gallery"):
            for item in gallery.tables():
                box = (
                    ui.element("button").classes("studio-gallery-table").props(f'type="button" data-name="{item.name}"')
                )
                box.on("click", lambda item=item: dialog.submit((Opened(gallery.table(item.file, catalog)),)))
                with box:
                    with ui.element("b"):
                        ui.label(item.name)
                    ui.label(item.told)
        ui.button("Cancel", on_click=lambda: dialog.submit(None)).props("flat")
    tables = await answer_of(dialog)
    return await choose(tables)


def table_suffixes(catalog: Catalog) -> list[str]:
    """How the names of files end that can be opened."""
    return [suffix for item in catalog.provided("reader") for suffix in getattr(item.stage, "suffixes", ())]


async def choose(tables: tuple[Opened, ...] | None) -> Opened | None:
    """One of some tables; a person is asked where there are several. None where none was chosen."""
    if not tables:
        return None
    return tables[0] if len(tables) == 1 else await _ask_which(tables)


async def ask_back(table: TableText) -> bool:
    """Whether a table that the browser has kept is to be opened again."""
    with card("The studio was started anew", persistent=True) as dialog:
        rows = words.count(len(table.rows), "row", "rows")
        ui.label(f"This tab has kept a table of {rows}, {table.name or 'without a name'}.").classes("studio-status")
        with ui.element("div").classes("studio-row"):
            ui.button("Bring it back", on_click=lambda: dialog.submit("back")).props("unelevated autofocus")
            ui.button("Go on without it", on_click=lambda: dialog.submit("without")).props("flat")
    answer = await answer_of(dialog)
    return bool(answer == "back")


def warn(text: str) -> None:
    """Shows what a person should know of the table on the page, until it is closed or another table is there."""
    ui.notification(text, type="warning", multi_line=True, timeout=None, close_button="Close").mark("table")


def forget_warnings() -> None:
    """Takes away what was shown of a table that is no longer on the page."""
    for shown in ElementFilter(kind=ui.notification, marker="table"):
        shown.dismiss()


class Warnings:
    """One notification of what a person should know, until it is closed: a mesh robot may have a hundred such texts."""

    def __init__(self) -> None:
        self._texts: list[str] = []
        self._shown: ui.notification | None = None

    def add(self, text: str) -> None:
        """Shows a text, beside those that are there."""
        self._texts.append(text)
        message = "\n".join(self._texts[:_MOST_WARNINGS])
        if (more := len(self._texts) - _MOST_WARNINGS) > 0:
            message += f"\nand {words.count(more, 'thing', 'things')} like these"
        if self._shown is not None:
            self._shown.message = message
            return
        self._shown = ui.notification(message, type="warning", multi_line=True, timeout=None, close_button="Close")
        self._shown.on_dismiss(self._forget)

    def _forget(self) -> None:
        self._texts, self._shown = [], None


async def _ask_which(tables: tuple[Opened, ...]) -> Opened | None:
    more = len(tables) > MOST_CHOICES
    with card(f"The file holds {f'more than {MOST_CHOICES}' if more else len(tables)} manipulators") as dialog:
        names = {number: opened.table.name for number, opened in enumerate(tables[:MOST_CHOICES])}
        if more:
            told = f"the first {MOST_CHOICES} can be chosen; `dh2urdf studio FILE --robot NAME` opens any of them"
            ui.label(told).classes("studio-status")
        chosen = ui.select(names, value=0, label="manipulator", with_input=True).style("width: 100%")
        with ui.element("div").classes("studio-row"):
            ui.button("Open", on_click=lambda: dialog.submit(chosen.value))
            ui.button("Cancel", on_click=lambda: dialog.submit(None)).props("flat")
    answer = await answer_of(dialog)
    return None if answer is None else tables[answer]


# --- Saving -----------------------------------------------------------------------------------------------------------


def savings(catalog: Catalog) -> Iterator[tuple[str, str, str]]:
    """What can be saved: its kind, the format, and what the menu calls it."""
    for name in saving.table_formats(catalog):
        yield "table", name, f"Table as {name}"
    for suffix in saving.other_suffixes(catalog):
        yield "other", suffix, f"Table as {suffix}"
    for name in saving.robot_formats(catalog):
        yield "robot", name, f"Robot as {name}"
    yield "run", "", "Run file"
    yield "all", "", "Everything, as a zip"


async def save(session: Session, kind: str, name: str) -> None:
    """Hands over what was chosen, or says what keeps it from being made."""
    table, catalog, variant = session.table, session.catalog, _made(session)

    def make() -> list[Saved]:
        if kind == "table":
            return [saving.table_file(table, name, catalog)]
        if kind == "other":
            return [saving.other_file(table, name, variant, catalog)]
        if kind == "run":
            return [saving.run_file(table, variant, catalog)]
        if kind == "robot":
            return [saving.robot_file(table, name, variant, catalog)]
        files = saving.all_files(table, variant, catalog)
        there = {Path(file.name).suffix for file in files}
        missing.extend(suffix for suffix in saving.other_suffixes(catalog) if suffix not in there)
        stem = Path(files[0].name).stem
        return [saving.Saved(name=f"{stem}.zip", content=saving.zipped(files))]

    missing: list[str] = []
    try:
        for file in await run.io_bound(make) or ():
            hand_over(file)
        if missing:
            warn(f"Not in the zip, as the format cannot hold this table: {', '.join(missing)}. Save one to see why.")
    except Dh2UrdfError as error:
        await show_error("This cannot be made yet", error)


async def generate(session: Session) -> None:
    """Press Generate: the URDF, made and proved as the command line makes and proves it."""
    format_name = session.catalog.usual("emitter").name
    try:
        file = await run.io_bound(saving.robot_file, session.table, format_name, _made(session), session.catalog)
    except Dh2UrdfError as error:
        await show_error("The URDF cannot be generated yet", error)
        return
    if file is not None:  # as it is while the server ends
        hand_over(file)


def _made(session: Session) -> str:
    """The variant that files are made in: where both are shown, the arm itself."""
    return session.variant if session.variant in session.variants else session.variants[0]


def hand_over(file: Saved) -> None:
    """Downloads a file, and tells its size and how right it is."""
    ui.download.content(file.content, file.name)
    told = f"{file.name}, {len(file.content) / 1000:.1f} kB"
    if file.proof is not None:
        proof = file.proof
        told += (
            f"\nread back and compared with the table at {proof.poses} joint vectors: tool0 is within "
            f"{proof.position_error:.2g} m and {proof.angle_error:.2g} rad of the DH product"
            if proof.holds
            else f"\nnot the arm of the table: tool0 is up to {proof.position_error:.3g} m from the DH product"
        )
    ui.notify(
        told, type="positive" if file.proof is None or file.proof.holds else "warning", multi_line=True, timeout=9000
    )


# --- What went wrong --------------------------------------------------------------------------------------------------


async def show_error(title: str, error: Dh2UrdfError) -> None:
    """Says what keeps something from being made."""
    problems = getattr(error, "problems", ())
    with card(title) as dialog:
        for problem in problems[:20]:
            where = f"{problem.joint}, {problem.field}: " if problem.joint and problem.field else ""
            parts = [where + problem.message, problem.accepted and f"accepted: {problem.accepted}", problem.suggestion]
            with ui.element("div").classes("studio-problem error"):
                ui.label("\n".join(part for part in parts if part))
        if not problems:
            ui.label(str(error))
        ui.button("Close", on_click=lambda: dialog.submit(None)).props("flat autofocus")
    await answer_of(dialog)


def show_fault(error: Exception) -> None:
    """Says that the studio itself failed: on the page, where the person is, and not only in a terminal."""
    told = str(error) if isinstance(error, Dh2UrdfError) else f"{type(error).__name__}: {error}"
    traceback.print_exception(error)
    ui.notify(
        f"The studio failed at this: {told}\nThe table is as it was. This is a fault of dh2urdf, not of your table.",
        type="negative",
        multi_line=True,
        timeout=0,
        close_button="Close",
    )
