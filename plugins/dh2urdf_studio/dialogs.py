"""What the studio asks and hands over: opening, pasting, converting, files and links, and what went wrong."""

from __future__ import annotations

import json
import traceback
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from nicegui import ElementFilter, run, ui

from dh2urdf.errors import Dh2UrdfError
from dh2urdf.table_text import ANGLE_UNITS, LENGTH_UNITS
from dh2urdf_studio import words
from dh2urdf_studio.editing.edits import kept_table, kept_text
from dh2urdf_studio.editing.opening import Opened, gallery, gallery_table
from dh2urdf_studio.editing.reading import CellProblem
from dh2urdf_studio.editing.save import saved
from dh2urdf_studio.page_data import PAGE
from dh2urdf_studio.widgets import ANSWERED, row_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.table_text import TableText
    from dh2urdf_studio.editing.save import Saved
    from dh2urdf_studio.editing.session import Session

LARGEST_FILE = 64 * 2**20  # size of a file that may be opened [B]
LOST = "The files did not arrive. Open them again."  # the message where the connection was cut while files were sent
MOST_CHOICES = 1000  # manipulators of a file that a person is given to choose from
_MOST_WARNINGS = 3


@contextmanager
def card(title: str, *, persistent: bool = False, cancel: str = "") -> Iterator[ui.dialog]:
    """A dialog with a title, which is its name for those who do not see it, and a button that answers nothing."""
    with ui.dialog() as dialog, ui.card().classes("studio-card"):
        dialog.props["aria-label"] = title
        if persistent:
            dialog.props("persistent")
        with ui.element("h2"):
            ui.label(title)
        yield dialog
        if cancel:
            ui.button(cancel, on_click=lambda: dialog.submit(None)).props("flat")


def _choice(dialog: ui.dialog, text: str, answer: Any, *, first: bool = False) -> ui.button:  # noqa: ANN401 - what is submitted
    """A button of a question, as wide as the card."""
    button = ui.button(text, on_click=lambda: dialog.submit(answer)).classes("studio-choice")
    return button.props(f"no-caps align=left {'unelevated autofocus' if first else 'outline'}")


async def answer_of(dialog: ui.dialog) -> Any:  # noqa: ANN401 - what was submitted
    """What a person answers; None where the dialog, or its tab, was closed."""
    answer = await dialog
    if not dialog.is_deleted:  # as everything of a tab is that was closed
        dialog.delete()
        dialog.client.run_javascript("dhPage.back()")
    return answer


async def ask(
    title: str,
    told: Sequence[str],
    choices: Sequence[tuple[str, Any]] = (),
    *,
    look: str = "studio-status",
    usual: int | None = 0,
    cancel: str = "Cancel",
) -> Any:  # noqa: ANN401 - what was chosen
    """Ask a question, or only show paragraphs; the answer, None where the question, or the tab, was closed.

    Choices are the texts of buttons, with their answers. Enter takes the `usual` one, unless a person should think
    first; a button without an answer is left out where there has to be one.
    """
    with card(title, persistent=not cancel) as dialog:
        for text in told:
            with ui.element("div").classes(look):
                ui.label(text)
        for number, (text, answer) in enumerate(choices):
            _choice(dialog, text, answer, first=number == usual)
        if cancel:
            ui.button(cancel, on_click=lambda: dialog.submit(None)).props(f"flat {'' if choices else 'autofocus'}")
    return await answer_of(dialog)


# --- Converting -------------------------------------------------------------------------------------------------------


async def ask_conversion(
    title: str, texts: Sequence[str], units: Sequence[str] = (), *, possible: bool
) -> tuple[Any, ...] | None:
    """Units, which can be chosen again here, and whether to convert to them or to reinterpret; None for neither."""
    # Another choice may have come before the dialog was on the page.
    for asked in ElementFilter(kind=ui.dialog, marker="conversion"):
        asked.submit(None)

    def show() -> None:
        for button, text in zip((convert, again), texts, strict=True):
            button.set_text(text.format(units=" and ".join(each.value for each in chosen)))

    with card(title, cancel="Cancel") as dialog:
        dialog.mark("conversion")
        with row_of() as row:
            every = ("unit of lengths", LENGTH_UNITS), ("unit of angles", ANGLE_UNITS)
            chosen = [
                ui.toggle([*names], value=unit, on_change=show).props(f'unelevated no-caps aria-label="{told}"')
                for (told, names), unit in zip(every, units, strict=False)
            ]
        row.set_visibility(bool(chosen))
        convert = _choice(dialog, "", answer=True, first=True)
        convert.set_enabled(possible)
        if not possible:
            ui.label("A table that is not right yet cannot be converted.").classes("studio-status")
        again = _choice(dialog, "", answer=False)
        show()
    answer = await answer_of(dialog)
    return None if answer is None else (*(each.value for each in chosen), answer)


# --- Pasting ----------------------------------------------------------------------------------------------------------


async def ask_paste(
    found: tuple[Opened, ...] | str, other: tuple[Opened, ...] | str
) -> tuple[Opened, ...] | str | None:
    """What to do with a pasted text that has a header: tables to open, ``cells``, or None for nothing."""
    cells = "Put its cells in here, as they are", "cells"
    if isinstance(found, str):
        answer = await ask("What you paste may be misread", [found], [cells], look="studio-problem error", usual=None)
    else:
        table = found[0].table
        many = f"{len(found)} manipulators" if len(found) > 1 else f"{table.name}: {_rows(table)}"
        named = f", {table.convention}" if table.convention else ""
        told = f"{many}{named}, read as a CSV file is: its header, units and separators are understood"
        units = reversed({_units(tables): tables for tables in (other, found)}.items())
        choices = [(f"Open it in place of this table: {text}", tables) for text, tables in units]
        answer = await ask("The clipboard holds a whole table", [told], [*choices, cells])
    return answer  # type: ignore[no-any-return]  # of these three types


def _units(tables: tuple[Opened, ...] | str) -> str:
    if isinstance(tables, str):
        return tables
    return f"lengths in {tables[0].table.length_unit}, angles in {tables[0].table.angle_unit}"


async def ask_columns(choices: Sequence[Sequence[str]], cells: Sequence[str]) -> Sequence[str] | None:
    """The fields of columns that have no names, of which one is a row of cells; None for nothing."""
    told = f"The first row is {' | '.join(cell or 'empty' for cell in cells)}. What are its columns?"
    named = [(", ".join(PAGE["columns"][field].get("header", field) for field in fields), fields) for fields in choices]
    answer: Sequence[str] | None = await ask("The columns that you paste have no names", [told], named)
    return answer


# --- Opening ----------------------------------------------------------------------------------------------------------


async def ask_table(catalog: Catalog, choose_file: str) -> Opened | None:
    """A table of the gallery; None where none was chosen, or a file is, which the page opens by `choose_file`."""
    with card("Open a table", cancel="Cancel") as dialog:
        own = ui.button("Choose a file", icon="folder_open", on_click=lambda: dialog.submit(None))
        own.props("unelevated no-caps autofocus").on("click", js_handler=f"() => {choose_file}")
        ui.label("A file can also be dropped anywhere on the page. The gallery has:").classes("studio-status")
        with ui.element("div").classes("studio-gallery"):
            for file, what in gallery().items():
                name = file.partition(".")[0]
                box = ui.element("button").classes("studio-gallery-table").props(f'type="button" data-name="{name}"')
                box.on("click", lambda file=file: dialog.submit(Opened(gallery_table(file, catalog))))
                with box:
                    with ui.element("b"):
                        ui.label(name)
                    ui.label(what)
    opened: Opened | None = await answer_of(dialog)
    return opened


async def choose(tables: tuple[Opened, ...] | None) -> Opened | None:
    """One of some tables; a person is asked where there are several. None where none was chosen."""
    if not tables or len(tables) == 1:
        return tables[0] if tables else None
    more = len(tables) > MOST_CHOICES
    with card(f"The file holds {f'more than {MOST_CHOICES}' if more else len(tables)} manipulators") as dialog:
        names = {number: opened.table.name for number, opened in enumerate(tables[:MOST_CHOICES])}
        if more:
            told = f"the first {MOST_CHOICES} can be chosen; `dh2urdf studio FILE --robot NAME` opens any of them"
            ui.label(told).classes("studio-status")
        chosen = ui.select(names, value=0, label="manipulator", with_input=True).style("width: 100%")
        with row_of():
            ui.button("Open", on_click=lambda: dialog.submit(chosen.value))
            ui.button("Cancel", on_click=lambda: dialog.submit(None)).props("flat")
    answer = await answer_of(dialog)
    return None if answer is None else tables[answer]


async def ask_back(table: TableText) -> bool:
    """Whether a table that the browser has kept is to be opened again."""
    told = f"This tab has kept a table of {_rows(table)}, {table.name or 'without a name'}."
    choices = [("Bring it back", True), ("Go on without it", False)]
    return bool(await ask("The studio was started anew", [told], choices, cancel=""))


def _rows(table: TableText) -> str:
    return words.count(len(table.rows), "row", "rows")


# --- Saving -----------------------------------------------------------------------------------------------------------


async def make(session: Session, kind: str, name: str, failed: str = "This cannot be made yet") -> None:
    """Hands over one of the `savings` of a session; where both variants are shown, of the arm itself."""
    variant = session.variant if session.variant in session.variants else session.variants[0]
    try:
        wanted = session.table, kind, name, variant, session.catalog, session.changes
        file = await run.io_bound(saved, *wanted)
    except Dh2UrdfError as error:
        await show_error(failed, error)
        return
    if file is None:  # as it is while the server ends
        return
    hand_over(file)
    if file.missing:
        warn(PAGE["warnings"]["missing"].format(suffixes=", ".join(file.missing)))


def hand_over(file: Saved) -> None:
    """Downloads a file, and tells its size and how right it is."""
    ui.download.content(file.content, file.name)
    told, proof = f"{file.name}, {len(file.content) / 1000:.1f} kB", file.proof
    if proof is not None:
        told += (
            f"\nread back and compared with the table at {proof.poses} joint vectors: tool0 is within "
            f"{proof.position_error:.2g} m and {proof.angle_error:.2g} rad of the DH product"
            if proof.holds
            else f"\nnot the arm of the table: tool0 is up to {proof.position_error:.3g} m from the DH product"
        )
    ui.notify(told, type="positive" if proof is None or proof.holds else "warning", multi_line=True, timeout=9000)


# --- Links ------------------------------------------------------------------------------------------------------------


async def show_link(table: TableText) -> None:
    """Show a link that holds a table; it is made in the browser, and goes nowhere but to the clipboard."""
    link = str(await ui.run_javascript(f"return dhPage.link({json.dumps(kept_text(table))})", timeout=ANSWERED))
    with card("A link with this table") as dialog:
        ui.label("The link itself holds the whole table: nothing is sent to anybody.").classes("studio-status")
        ui.input(value=link).props('readonly outlined dense aria-label="link"').classes("studio-wide")
        with row_of():
            copy = ui.button("Copy", on_click=lambda: dialog.submit("copied")).props("unelevated autofocus")
            copy.on("click", js_handler=f"() => navigator.clipboard?.writeText({json.dumps(link)})")
            ui.button("Close", on_click=lambda: dialog.submit(None)).props("flat")
    await answer_of(dialog)


async def linked_table() -> TableText | None:
    """The table of the link by which the page was opened; None where it was opened without one, or it is damaged."""
    text = await ui.run_javascript("return dhPage.linked()", timeout=ANSWERED)
    if text is None:
        return None
    table = kept_table(str(text))
    if table is None:
        warn(PAGE["warnings"]["link"])
    return table


# --- What went wrong --------------------------------------------------------------------------------------------------


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


async def show_error(title: str, error: Dh2UrdfError) -> None:
    """Says what keeps something from being made."""
    told = []
    for problem in getattr(error, "problems", ())[:20]:
        where = f"{problem.joint}, {problem.field}: " if problem.joint and problem.field else ""
        told.append(where + CellProblem(problem=problem).text)
    await ask(title, told or [str(error)], look="studio-problem error", cancel="Close")


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
