"""The line that says how the table is, and below it what is wrong, problem by problem."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf.studio import words
from dh2urdf.studio.layout.table_bar import ENDS
from dh2urdf.studio.table_grid import all_problems

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.studio.editing.reading import CellProblem
    from dh2urdf.studio.editing.session import Session

MOST_PROBLEMS = 30
"""Problems that are spelled out; all wrong cells are marked."""


class ProblemList:
    """The problems of the table; each that is about a cell or a field leads there.

    Args:
        on_click: is called with a problem that a person has clicked.
    """

    def __init__(self, on_click: Callable[[CellProblem], None]) -> None:
        self._on_click = on_click
        with ui.element("div").classes("studio-told").props('role="status" aria-live="polite"'):
            self._status = ui.label().classes("studio-status")
            self._told = ui.element("div").style("display: contents")

    def show(self, session: Session) -> dict[str, str]:
        """Shows the problems of a session's table.

        Returns:
            What is wrong by attribute of the table: base, tool, payload.
        """
        problems = all_problems(session)
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
                    box.props("type=button").on("click", lambda found=found: self._on_click(found))
                with box:
                    ui.label(f"{words.place(found, session.table)}{found.text}")
        return {found.field: found.text for found in errors if found.row is None and found.field}
