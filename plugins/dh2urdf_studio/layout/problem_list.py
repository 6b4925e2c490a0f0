"""The line that says how the table is, and below it what is wrong, problem by problem."""

from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf_studio import words
from dh2urdf_studio.layout.table_bar import ENDS

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf_studio.editing.reading import CellProblem
    from dh2urdf_studio.editing.session import Session

MOST_PROBLEMS = 30
"""Problems that are spelled out; all wrong cells are marked."""


class ProblemList:
    """The problems of the table; each that is about a cell or a field leads there, and one that asks has buttons.

    Args:
        session: the session.
        on_unit: is called with a problem that asks for a unit, and the unit that a person has pressed.
    """

    def __init__(self, session: Session, on_unit: Callable[[CellProblem, str], None]) -> None:
        self._session, self._on_unit = session, on_unit
        with ui.element("div").classes("studio-told").props('role="status" aria-live="polite"'):
            self._status = ui.label().classes("studio-status")
            self._told = ui.element("div").style("display: contents")

    def show(self) -> dict[str, str]:
        """Shows the problems of the table.

        Returns:
            What is wrong by attribute of the table: base, tool, payload.
        """
        session = self._session
        problems = session.problems
        errors = [found for found in problems if found.problem.severity == "error"]
        text, kind = words.status(session, len(errors))
        self._status.set_text(text)
        self._status.classes(replace=f"studio-status {kind}")
        self._told.clear()
        with self._told:
            for found in [*errors, *(found for found in problems if found not in errors)][:MOST_PROBLEMS]:
                leads = found.row is not None or found.field in ENDS
                box = ui.element("button" if leads else "div").classes(f"studio-problem {found.problem.severity}")
                if leads:
                    key = None if found.row is None else session.history.keys[found.row]
                    field = found.field if key is None or found.field in session.columns else "a"
                    box.props("type=button").on("click", js_handler=f"() => dhGrid.goTo(...{json.dumps([key, field])})")
                with box:
                    ui.label(f"{words.place(found, session.table)}{found.text}")
                if units := found.units(session.table):
                    with ui.element("div").classes(f"studio-problem studio-asked {found.problem.severity}"):
                        for unit in units:
                            act = partial(self._on_unit, found, unit)
                            ui.button(unit, on_click=act).props('unelevated dense no-caps padding="2px 10px"')
        return {found.field: found.text for found in errors if found.row is None and found.field}
