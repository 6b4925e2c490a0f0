"""The panel that explains the picked row: its matrices, and its four motions one after the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf_studio.drawing.motions import NAMES, order
from dh2urdf_studio.panels.lesson_words import explained
from dh2urdf_studio.panels.poses import TICK

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf_studio.editing.session import Session

_STEP = 0.04  # of a motion in a tick: a motion takes 1.25 s
_ALL = 4.0


class LessonPanel:
    """Explains the picked row beside the arm, and moves a frame through it."""

    ICON, TITLE = "school", "explain the picked row"

    def __init__(self, session: Session, on_move: Callable[[], None]) -> None:
        """Lay the panel out, hidden.

        Args:
            session: what it is about.
            on_move: draws the pose anew.
        """
        self._session, self._on_move, self._until = session, on_move, _ALL
        with (
            ui.element("aside")
            .classes("studio-panel studio-lesson")
            .props('aria-label="the picked row"') as self._panel
        ):
            with ui.element("div").classes("studio-row"):
                self._title = ui.label().classes("studio-caption")
                ui.button("play", icon="play_arrow", on_click=self._play).props("outline dense no-caps size=sm")
                self._steps = [
                    ui.button(on_click=lambda number=number: self._one(number)).props("flat dense no-caps size=sm")
                    for number in range(int(_ALL))
                ]
            self._text = ui.html(sanitize=False).classes("studio-lesson-text")
        self._timer = ui.timer(TICK, self._go_on, active=False)
        self.show()

    def switch(self) -> None:
        """Open it, or close it."""
        session = self._session
        session.lesson = _ALL if session.lesson is None else None
        self._timer.deactivate()
        self._on_move()

    def show(self) -> None:
        """Show the picked row as it is now."""
        session = self._session
        self._panel.set_visibility(session.lesson is not None and session.arm is not None)
        if session.lesson is None or session.arm is None:
            return
        self._panel.props(f"data-progress={session.lesson:.2f}")
        row = session.drawn_row
        names = [NAMES[field] for field in order(session.arm.manipulator.convention)]
        for number, (button, name) in enumerate(zip(self._steps, names, strict=True), start=1):
            button.set_text(f"{number} {name}")
            button.set_enabled(row is not None)
        if row is None:
            self._title.set_text("Pick a row of the table, or a link of the arm.")
            self._text.set_content("")
            return
        self._title.set_text(f"row {(session.row or 0) + 1}")
        self._text.set_content(explained(session.arm.manipulator, row, session.q, session.table))

    def _play(self) -> None:
        self._start(0.0, _ALL)

    def _one(self, number: int) -> None:
        self._start(float(number), number + 1.0)

    def _start(self, progress: float, until: float) -> None:
        self._session.lesson, self._until = progress, until
        self._timer.activate()
        self._on_move()

    def _go_on(self) -> None:
        session = self._session
        if session.lesson is None:
            self._timer.deactivate()
            return
        session.lesson = min(session.lesson + _STEP, self._until)
        if session.lesson >= self._until:
            self._timer.deactivate()
        self._on_move()
