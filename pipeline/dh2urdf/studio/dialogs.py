"""What the studio asks and hands over: opening, saving, generating, converting, and what went wrong."""

from __future__ import annotations

import tempfile
import traceback
from pathlib import Path
from typing import TYPE_CHECKING

from nicegui import run, ui

from dh2urdf.errors import Dh2UrdfError
from dh2urdf.manipulator import Convention
from dh2urdf.studio import gallery, words
from dh2urdf.studio.editing import save as saving
from dh2urdf.studio.editing.opening import Opened, open_tables

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.studio.editing.save import Saved
    from dh2urdf.studio.editing.session import Session
    from dh2urdf.table_text import TableText

LARGEST_FILE = 64 * 2**20
"""Size of a file that may be opened [B]."""
_MEANINGS = {
    Convention.STANDARD: "standard (Denavit-Hartenberg, Spong): Rz(θ) Tz(d) Tx(a) Rx(α)",
    Convention.MODIFIED: "modified (Craig): Rx(α) Tx(a) Rz(θ) Tz(d)",
}


# --- Converting -------------------------------------------------------------------------------------------------------


async def ask_convention(convention: Convention, *, possible: bool) -> bool | None:
    """Whether to convert to a convention (True) or to reinterpret (False); None for neither."""
    moved = (
        "a and α move down by one row; what is left over goes into the tool."
        if convention is Convention.MODIFIED
        else "a and α move up by one row; what is left over goes into the base."
    )
    return await _ask(
        f"To the convention {_MEANINGS[convention]}",
        f"Convert: the same arm, other numbers. {moved}",
        "Reinterpret: the same numbers, another arm. They were meant so from the beginning.",
        possible=possible,
    )


async def ask_units(length: str, angle: str, *, possible: bool) -> bool | None:
    """Whether to convert to units (True) or to reinterpret (False); None for neither."""
    return await _ask(
        f"To {length} and {angle}",
        f"Convert: the same arm, its numbers in {length} and {angle}. Cells that name their unit stay as they are.",
        f"Reinterpret: the same numbers, now {length} and {angle}: another arm.",
        possible=possible,
    )


async def _ask(title: str, convert: str, reinterpret: str, *, possible: bool) -> bool | None:
    with ui.dialog() as dialog, ui.card().classes("studio-card"):
        ui.html(f"<h2>{title}</h2>", sanitize=False)
        button = ui.button(convert, on_click=lambda: dialog.submit("convert")).props("unelevated align=left autofocus")
        button.classes("studio-choice").set_enabled(possible)
        if not possible:
            ui.label("A table that is not right yet cannot be converted.").classes("studio-status")
        again = ui.button(reinterpret, on_click=lambda: dialog.submit("reinterpret")).props("outline align=left")
        again.classes("studio-choice")
        ui.button("Cancel", on_click=lambda: dialog.submit(None)).props("flat")
    answer = await dialog
    dialog.delete()
    return None if answer is None else answer == "convert"


# --- Opening ----------------------------------------------------------------------------------------------------------


async def ask_table(catalog: Catalog) -> TableText | None:
    """A table of the gallery or of a file; None where none was chosen."""
    suffixes = [suffix for item in catalog.provided("reader") for suffix in getattr(item.stage, "suffixes", ())]
    with ui.dialog() as dialog, ui.card().classes("studio-card"):
        ui.html("<h2>Open a table</h2>", sanitize=False)

        def refuse(told: str) -> None:
            problem.set_text(told)
            problem.set_visibility(True)

        async def take(event: object) -> None:
            name, content = event.file.name, await event.file.read()  # type: ignore[attr-defined]  # NiceGUI's
            tables = await run.io_bound(_tables, name, content, catalog)
            if isinstance(tables, str):
                refuse(tables)
            else:
                dialog.submit(tables)

        label = "a file of yours: choose it, or drop it here"
        upload = ui.upload(label=label, auto_upload=True, max_file_size=LARGEST_FILE, on_upload=take)
        accepted = f"one of {', '.join(suffixes)}, of at most {LARGEST_FILE // 2**20} MB"
        upload.on_rejected(lambda: refuse(f"this is not a file that can be opened\naccepted: {accepted}"))
        upload.props(f'accept="{",".join(suffixes)}" flat bordered').style("width: 100%")
        problem = ui.label().classes("studio-problem error")
        problem.set_visibility(False)
        ui.label("or one of the gallery").classes("studio-status")
        with ui.element("div").classes("studio-gallery"):
            for item in gallery.exhibits():
                box = ui.element("button").classes("studio-exhibit").props(f'type="button" data-name="{item.name}"')
                box.on("click", lambda item=item: dialog.submit((Opened(gallery.exhibit(item.file, catalog)),)))
                with box:
                    with ui.element("b"):
                        ui.label(item.name)
                    ui.label(item.told)
        ui.button("Cancel", on_click=lambda: dialog.submit(None)).props("flat")
    tables = await dialog
    dialog.delete()
    if not tables:
        return None
    chosen = tables[0] if len(tables) == 1 else await _ask_which(tables)
    if chosen is None:
        return None
    if chosen.lost:
        ui.notify(words.without(chosen.lost), type="warning", multi_line=True, timeout=0, close_button="Close")
    table: TableText = chosen.table
    return table


def _tables(name: str, content: bytes, catalog: Catalog) -> tuple[Opened, ...] | str:
    """The tables of a file that was uploaded, or what is wrong with it."""
    with tempfile.TemporaryDirectory(prefix="dh2urdf-") as folder:
        path = Path(folder) / Path(name).name
        try:
            path.write_bytes(content)
            return open_tables(path, catalog)
        except Dh2UrdfError as error:
            return str(error).replace(f"{folder}/", "")


async def _ask_which(tables: tuple[Opened, ...]) -> Opened | None:
    with ui.dialog() as dialog, ui.card().classes("studio-card"):
        ui.html(f"<h2>The file holds {len(tables)} manipulators</h2>", sanitize=False)
        names = {number: opened.table.name for number, opened in enumerate(tables)}
        chosen = ui.select(names, value=0, label="manipulator", with_input=True).style("width: 100%")
        with ui.element("div").classes("studio-row"):
            ui.button("Open", on_click=lambda: dialog.submit(chosen.value))
            ui.button("Cancel", on_click=lambda: dialog.submit(None)).props("flat")
    answer = await dialog
    dialog.delete()
    return None if answer is None else tables[answer]


# --- Saving -----------------------------------------------------------------------------------------------------------


def savings(catalog: Catalog) -> Iterator[tuple[str, str, str]]:
    """What can be saved: its kind, the format, and what the menu calls it."""
    for name in saving.table_formats(catalog):
        yield "table", name, f"Table as {name}"
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
        if kind == "run":
            return [saving.run_file(table, variant, catalog)]
        if kind == "robot":
            return [saving.robot_file(table, name, variant, catalog)]
        files = saving.all_files(table, variant, catalog)
        stem = Path(files[0].name).stem
        return [saving.Saved(name=f"{stem}.zip", content=saving.zipped(files))]

    try:
        for file in await run.io_bound(make) or ():
            _hand_over(file)
    except Dh2UrdfError as error:
        await show_error("This cannot be made yet", error)


async def generate(session: Session) -> None:
    """Press Generate: the URDF, made and proved as the command line makes and proves it."""
    try:
        file = await run.io_bound(saving.robot_file, session.table, "urdf", _made(session), session.catalog)
    except Dh2UrdfError as error:
        await show_error("The URDF cannot be generated yet", error)
        return
    if file is not None:  # as it is while the server ends
        _hand_over(file)


def _made(session: Session) -> str:
    """The variant that files are made in: where both are shown, the arm itself."""
    return "paper" if session.variant == "paper" else "exact"


def _hand_over(file: Saved) -> None:
    ui.download.content(file.content, file.name)
    told = f"{file.name}, {len(file.content) / 1000:.1f} kB"
    if file.proof is not None:
        proof = file.proof
        told += (
            f"\nread back and compared with the table at {proof.poses} joint vectors: tool0 is within "
            f"{proof.position_error:.2g} m and {proof.angle_error:.2g} rad of the DH product"
            if proof.holds
            else f"\nthe paper's variant: tool0 is up to {proof.position_error:.3g} m from the DH product"
        )
    ui.notify(
        told, type="positive" if file.proof is None or file.proof.holds else "warning", multi_line=True, timeout=9000
    )


# --- What went wrong --------------------------------------------------------------------------------------------------


async def show_error(title: str, error: Dh2UrdfError) -> None:
    """Says what keeps something from being made."""
    problems = getattr(error, "problems", ())
    with ui.dialog() as dialog, ui.card().classes("studio-card"):
        ui.html(f"<h2>{title}</h2>", sanitize=False)
        for problem in problems[:20]:
            where = f"{problem.joint}, {problem.field}: " if problem.joint and problem.field else ""
            parts = [where + problem.message, problem.accepted and f"accepted: {problem.accepted}", problem.suggestion]
            with ui.element("div").classes("studio-problem error"):
                ui.label("\n".join(part for part in parts if part))
        if not problems:
            ui.label(str(error))
        ui.button("Close", on_click=lambda: dialog.submit(None)).props("flat autofocus")
    await dialog
    dialog.delete()


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
