"""Where one frame is in another, and where tool0 can be."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf.manipulator import ROOT, TOOL
from dh2urdf.quantities.units import UNITS
from dh2urdf.rotations import norm
from dh2urdf_studio import joints

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.rotations import RigidTransform
    from dh2urdf_studio.editing.session import OpenArm, Session

_POINTS = 4000  # of the workspace, for arms of up to a hundred joints
_NUMBERS = 400_000  # joint values that are drawn at most


class MeasuringPanel:
    """Measures between two frames, and shows the workspace as a cloud of points."""

    ICON, TITLE = "straighten", "measure between frames, and show the workspace"

    def __init__(self, session: Session, on_move: Callable[[], None], show_cloud: Callable[..., None]) -> None:
        """Lay the panel out, hidden.

        Args:
            session: what it is about.
            on_move: draws the pose anew.
            show_cloud: shows points in the scene, of shape (n, 3) [m]; none where there are none.
        """
        self._session, self._on_move, self._show_cloud = session, on_move, show_cloud
        self._is_open = False
        self._arm: OpenArm | None = None  # whose workspace is shown
        with ui.element("aside").classes("studio-panel").props('aria-label="measuring"') as self._panel:
            with ui.element("div").classes("studio-row"):
                self._from, self._to = (
                    ui.select([], on_change=self._choose).props(f'dense outlined prefix="{word}" aria-label="{word}"')
                    for word in ("from", "to")
                )
                self._cloud = ui.checkbox("workspace", on_change=self.show).props("dense size=xs")
            self._words = ui.label().classes("studio-measured").style("white-space: pre-line")
            self._reach = ui.label()
        self.show()

    def switch(self) -> None:
        """Open it, or close it."""
        self._is_open = not self._is_open
        self.show()
        self._on_move()

    def show(self) -> None:
        """Show the measures as they are now."""
        session = self._session
        arm = session.arm
        is_open = self._is_open and arm is not None
        self._panel.set_visibility(is_open)
        wanted = arm if is_open and self._cloud.value else None
        if wanted is not self._arm:
            self._arm = wanted
            self._show_workspace()
        if not is_open or arm is None:
            session.measured = None
            return
        frames = session.frames
        for select, usual in ((self._from, ROOT), (self._to, TOOL)):
            select.set_options(list(frames), value=select.value if select.value in frames else usual)
        session.measured = str(self._from.value), str(self._to.value)
        one, other = (frames[name] for name in session.measured)
        self._words.set_text(self._told(one.inverse @ other))

    def _choose(self) -> None:
        self.show()
        self._on_move()

    def _told(self, pose: RigidTransform) -> str:
        table = self._session.table if self._session.arm is None else self._session.arm.table
        length, angle = UNITS[table.length_unit], UNITS[table.angle_unit]
        xyz = ", ".join(f"{length.number(x):.6g}" for x in pose.translation)
        rpy = ", ".join(f"{angle.number(x):.6g}" for x in pose.rpy)
        distance = length.number(norm(pose.translation))
        return f"distance {distance:.6g} {length.symbol}\nxyz {xyz} {length.symbol}; rpy {rpy} {angle.symbol}"

    def _show_workspace(self) -> None:
        """Show where tool0 is at random joint values inside the limits, or nothing."""
        import numpy as np

        self._reach.set_text("")
        if self._arm is None:
            self._show_cloud(np.zeros((0, 3)))
            return
        manipulator, sliders = self._arm.manipulator, self._session.sliders
        count = max(1, min(_POINTS, _NUMBERS // max(1, len(sliders))))
        drawn = [joints.anywhere(sliders) for _ in range(count)]
        q = np.array([[each.get(row.joint, 0.0) for row in manipulator.moving_rows] for each in drawn])
        points = manipulator.fk(q)[:, :3, 3]
        self._show_cloud(points)
        far = np.linalg.norm(points, axis=1)
        unit = UNITS[self._arm.table.length_unit]
        least, most = (f"{unit.number(float(each)):.4g} {unit.symbol}" for each in (far.min(), far.max()))
        self._reach.set_text(f"workspace: tool0 was {least} to {most} from base_link in {count} random poses")
