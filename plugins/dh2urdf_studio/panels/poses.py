"""Poses that a person has stored, and the arm's way from one to the next."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from dh2urdf_studio.editing.session import OpenArm, Session

TICK = 0.05
"""Time from one step of a motion to the next [s]."""
_STRETCH = 1.5  # from one pose to the next [s]


class PosesPanel:
    """Stores poses, brings the arm back to each, and plays all of them."""

    ICON, TITLE = "animation", "stored poses"

    def __init__(self, session: Session, on_move: Callable[[], None]) -> None:
        """Lay the panel out, hidden.

        Args:
            session: what it is about.
            on_move: draws the pose anew.
        """
        self._session, self._on_move, self._is_open = session, on_move, False
        self._way: list[Mapping[str, float]] = []
        self._progress = 0.0  # along the way, in poses
        self._arm: OpenArm | None = None  # whose way it is
        self._laid: list[dict[str, float]] | None = None  # the poses that have buttons
        with ui.element("aside").classes("studio-panel").props('aria-label="stored poses"') as self._panel:
            with ui.element("div").classes("studio-row"):
                ui.button("store this pose", icon="add", on_click=self._store).props("outline dense no-caps size=sm")
                self._play = ui.button("play", icon="play_arrow", on_click=self._play_or_stop)
                self._play.props("outline dense no-caps size=sm")
            self._list = ui.element("div").classes("studio-row")
        self._timer = ui.timer(TICK, self._go_on, active=False)
        self.show()

    def switch(self) -> None:
        """Open it, or close it."""
        self._is_open = not self._is_open
        self.show()

    def show(self) -> None:
        """Show the poses that are stored."""
        session = self._session
        self._panel.set_visibility(self._is_open and session.arm is not None)
        self._play.set_text("stop" if self._timer.active else "play")
        self._play.set_enabled(bool(session.poses))
        if self._laid == session.poses:
            return
        self._laid = list(session.poses)
        self._list.clear()
        with self._list:
            for number in range(len(session.poses)):
                with ui.button_group().props("outline"):
                    go = ui.button(f"{number + 1}", on_click=lambda number=number: self._go(number))
                    go.props(f'outline dense size=sm aria-label="pose {number + 1}"')
                    drop = ui.button(icon="close", on_click=lambda number=number: self._drop(number))
                    drop.props(f'outline dense size=sm aria-label="forget pose {number + 1}"')

    def _store(self) -> None:
        self._session.poses.append(dict(self._session.q))
        self.show()

    def _drop(self, number: int) -> None:
        self._timer.deactivate()
        del self._session.poses[number : number + 1]
        self.show()

    def _go(self, number: int) -> None:
        self._start(self._session.poses[number : number + 1])

    def _play_or_stop(self) -> None:
        if self._timer.active:
            self._timer.deactivate()
            self.show()
        else:
            self._start(self._session.poses)

    def _start(self, poses: list[dict[str, float]]) -> None:
        """Leave for some poses, from where the arm is."""
        self._way, self._progress, self._arm = [dict(self._session.q), *poses], 0.0, self._session.arm
        self._timer.activate()
        self.show()

    def _go_on(self) -> None:
        last = len(self._way) - 1
        self._progress = min(self._progress + TICK / _STRETCH, float(last))
        if self._progress >= last or self._session.arm is not self._arm:
            self._timer.deactivate()
        if self._session.arm is self._arm:
            self._session.move(between(self._way, self._progress))
            self._on_move()
        self.show()


def between(way: list[Mapping[str, float]], progress: float) -> dict[str, float]:
    """The joint values on a way [rad or m]: linear in each joint, beginning and ending each stretch at rest.

    Args:
        way: joint values by name; joints that a pose does not have stay where they are.
        progress: 0 at the first pose, 1 at the second, and so on.
    """
    begin = min(int(progress), len(way) - 1)
    part = progress - begin
    if not part:
        return dict(way[begin])
    part = part * part * (3.0 - 2.0 * part)
    one, other = way[begin], way[begin + 1]
    return {name: value + part * (other.get(name, value) - value) for name, value in one.items()}
