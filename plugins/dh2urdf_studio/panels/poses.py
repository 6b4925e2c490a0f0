"""Poses that a person has stored, where one frame is in another, and where tool0 can be."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf.manipulator import ROOT, TOOL
from dh2urdf.quantities.units import UNITS
from dh2urdf.rotations import norm
from dh2urdf_studio import joints
from dh2urdf_studio.widgets import Panel, row_of, small_button

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf_studio.editing.session import OpenArm

TICK = 0.05  # time from one step of a motion to the next [s]
_STRETCH = 1.5  # from one pose to the next [s]
_POINTS = 4000  # of the workspace, for arms of up to a hundred joints
_NUMBERS = 400_000  # joint values that are drawn at most


class PosesPanel(Panel):
    """Stores poses, brings the arm back to each, and plays all of them."""

    ICON, TITLE, NAME = "animation", "stored poses", "stored poses"

    def _lay_out(self) -> None:
        self._way: list[Mapping[str, float]] = []
        self._progress = 0.0  # along the way, in poses
        self._arm: OpenArm | None = None  # whose way it is
        self._laid: list[dict[str, float]] | None = None  # the poses that have buttons
        with row_of():
            small_button("store this pose", self._store, "add")
            self._play = small_button("play", self._play_or_stop, "play_arrow")
        self._list = row_of()
        self._timer = ui.timer(TICK, self._go_on, active=False)

    def _show_arm(self, _: OpenArm) -> None:
        session = self._session
        self._play.set_text("stop" if self._timer.active else "play")
        self._play.set_enabled(bool(session.poses))
        if self._laid == session.poses:
            return
        self._laid = list(session.poses)
        self._list.clear()
        with self._list:
            for number in range(len(session.poses)):
                with ui.button_group().props("outline"):
                    go = ui.button(f"{number + 1}", on_click=partial(self._start, session.poses[number : number + 1]))
                    go.props(f'outline dense size=sm aria-label="pose {number + 1}"')
                    drop = ui.button(icon="close", on_click=partial(self._drop, number))
                    drop.props(f'outline dense size=sm aria-label="forget pose {number + 1}"')

    def _store(self) -> None:
        self._session.poses.append(dict(self._session.q))
        self.show()

    def _drop(self, number: int) -> None:
        self._timer.deactivate()
        del self._session.poses[number : number + 1]
        self.show()

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
    """The joint values on a way [rad or m]: linear in each joint, beginning and ending each stretch at rest."""
    begin = min(int(progress), len(way) - 1)
    part = progress - begin
    if not part:
        return dict(way[begin])
    part = part * part * (3.0 - 2.0 * part)
    one, other = way[begin], way[begin + 1]
    return {name: value + part * (other.get(name, value) - value) for name, value in one.items()}


class MeasuringPanel(Panel):
    """Measures between two frames, and shows the workspace as a cloud of points."""

    ICON, TITLE = "straighten", "measure between frames, and show the workspace"
    NAME = "measuring"

    def _lay_out(self) -> None:
        self._arm: OpenArm | None = None  # whose workspace is shown
        with row_of():
            self._from, self._to = (
                ui.select([], on_change=self._choose).props(f'dense outlined prefix="{word}" aria-label="{word}"')
                for word in ("from", "to")
            )
            self._cloud = ui.checkbox("workspace", on_change=self.show).props("dense size=xs")
        self._words = ui.label().classes("studio-measured").style("white-space: pre-line")
        self._reach = ui.label()

    def switch(self) -> None:
        """Open it, or close it; the line between the frames comes and goes with it."""
        super().switch()
        self._on_move()

    def show(self) -> None:
        """Show the measures as they are now."""
        session, arm = self._session, self._session.arm if self._is_open else None
        wanted = arm if self._cloud.value else None
        if wanted is not self._arm:
            self._arm = wanted
            self._show_workspace()
        if arm is None:
            session.measured = None
        super().show()

    def _show_arm(self, arm: OpenArm) -> None:
        session = self._session
        frames = session.frames
        for select, usual in ((self._from, ROOT), (self._to, TOOL)):
            select.set_options(list(frames), value=select.value if select.value in frames else usual)
        session.measured = str(self._from.value), str(self._to.value)
        one, other = (frames[name] for name in session.measured)
        pose = one.inverse @ other
        length, angle = UNITS[arm.table.length_unit], UNITS[arm.table.angle_unit]
        xyz = ", ".join(f"{length.number(x):.6g}" for x in pose.translation)
        rpy = ", ".join(f"{angle.number(x):.6g}" for x in pose.rpy)
        distance = f"distance {length.number(norm(pose.translation)):.6g} {length.symbol}"
        self._words.set_text(f"{distance}\nxyz {xyz} {length.symbol}; rpy {rpy} {angle.symbol}")

    def _choose(self) -> None:
        self.show()
        self._on_move()

    def _show_workspace(self) -> None:
        """Show where tool0 is at random joint values inside the limits, or nothing."""
        import numpy as np

        self._reach.set_text("")
        if self._arm is None:
            self._tell("showCloud", [])
            return
        manipulator, sliders = self._arm.manipulator, self._session.sliders
        count = max(1, min(_POINTS, _NUMBERS // max(1, len(sliders))))
        drawn = [joints.anywhere(sliders) for _ in range(count)]
        q = np.array([[each.get(row.joint, 0.0) for row in manipulator.actuated_rows] for each in drawn])
        points = manipulator.fk(q)[:, :3, 3]
        self._tell("showCloud", points.round(6).ravel().tolist())  # to a micrometre
        far = np.linalg.norm(points, axis=1)
        unit = UNITS[self._arm.table.length_unit]
        least, most = (f"{unit.number(float(each)):.4g} {unit.symbol}" for each in (far.min(), far.max()))
        self._reach.set_text(f"workspace: tool0 was {least} to {most} from base_link in {count} random poses")
