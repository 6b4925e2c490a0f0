"""What a person is asked where a text is pasted."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf_studio import words
from dh2urdf_studio.dialogs import answer_of, card

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf_studio.editing.opening import Opened

_SIGNS = {"joint": "name", "alpha": "α", "theta": "θ"}


async def ask_paste(
    found: tuple[Opened, ...] | str, other: tuple[Opened, ...] | str
) -> tuple[Opened, ...] | str | None:
    """What to do with a pasted text that has a header: tables to open, ``cells``, or None for nothing.

    Args:
        found: its tables, or why it cannot be read as one, or its cells would be misread.
        other: its tables where units that it does not name are the usual ones, and not those of the page.
    """
    bad = "What you paste may be misread"
    with card(bad if isinstance(found, str) else "The clipboard holds a whole table") as dialog:
        if isinstance(found, str):
            ui.label(found).classes("studio-problem error")
        else:
            rows = words.count(len(found[0].table.rows), "row", "rows")
            many = f"{len(found)} manipulators" if len(found) > 1 else f"{found[0].table.name}: {rows}"
            named = f", {found[0].table.convention}" if found[0].table.convention else ""
            told = f"{many}{named}, read as a CSV file is: its header, units and separators are understood"
            ui.label(told).classes("studio-status")
            for units, tables in reversed({_units(tables): tables for tables in (other, found)}.items()):
                text = f"Open it in place of this table: {units}"
                open_it = ui.button(text, on_click=lambda tables=tables: dialog.submit(tables)).props("align=left")
                open_it.props("unelevated autofocus" if tables is found else "outline").classes("studio-choice")
        put = ui.button("Put its cells in here, as they are", on_click=lambda: dialog.submit("cells"))
        put.props("outline align=left").classes("studio-choice")
        ui.button("Cancel", on_click=lambda: dialog.submit(None)).props("flat")
    answer: tuple[Opened, ...] | str | None = await answer_of(dialog)
    return answer


def _units(tables: tuple[Opened, ...] | str) -> str:
    if isinstance(tables, str):
        return tables
    return f"lengths in {tables[0].table.length_unit}, angles in {tables[0].table.angle_unit}"


async def ask_columns(choices: Sequence[Sequence[str]], cells: Sequence[str]) -> Sequence[str] | None:
    """The fields of columns that have no names; None for nothing.

    Args:
        choices: the fields in the orders that are usual.
        cells: the first row.
    """
    with card("The columns that you paste have no names") as dialog:
        ui.label(f"The first row is {' | '.join(cell or 'empty' for cell in cells)}. What are its columns?").classes(
            "studio-status"
        )
        for number, fields in enumerate(choices):
            text = ", ".join(_SIGNS.get(field, field) for field in fields)
            button = ui.button(text, on_click=lambda fields=fields: dialog.submit(fields))
            button.props(f"outline align=left no-caps {'' if number else 'autofocus'}").classes("studio-choice")
        ui.button("Cancel", on_click=lambda: dialog.submit(None)).props("flat")
    answer: Sequence[str] | None = await answer_of(dialog)
    return answer
