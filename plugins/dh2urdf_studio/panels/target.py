"""The pose of tool0: boxes to type it in, a handle to drag it by, and how well the arm moves from there."""

from __future__ import annotations

import asyncio
import math
from functools import partial
from typing import TYPE_CHECKING

from nicegui import run, ui

from dh2urdf.errors import InputError
from dh2urdf.kinematics.inverse import InverseSolution, dexterity
from dh2urdf.quantities import evaluate
from dh2urdf.quantities.units import UNITS, Dimension, QuantityError, Unit
from dh2urdf.rotations import (
    IDENTITY,
    IDENTITY_ROTATION,
    RigidTransform,
    quaternion_from_rotation,
    rotation_from_quaternion,
    rotation_from_rpy,
)
from dh2urdf_studio.widgets import Panel, row_of, toggle
from dh2urdf_studio.words import USUAL, decimals, short

if TYPE_CHECKING:
    from dh2urdf.table_text import TableText
    from dh2urdf_studio.editing.session import OpenArm

PLACE = ("x", "y", "z")
TURNS = {"roll, pitch, yaw": ("roll", "pitch", "yaw"), "quaternion": ("qx", "qy", "qz", "qw")}
_BARE = Unit(symbol="", dimension=Dimension.NUMBER)
_NO_LENGTH = 1e-9  # of a quaternion
_SINGULAR = 1e-9  # a singular value that is less is rounding
_PATIENCE = 0.2  # of a person who waits for an answer [s]


class TargetPanel(Panel):
    """Shows the pose of tool0 in boxes, and moves the arm to the pose that is typed there, or dragged to."""

    ICON, TITLE, NAME = "ads_click", "set the pose of tool0", "the pose of tool0"

    def _lay_out(self) -> None:
        self._keeps_texts = False  # what was typed stays where the arm does not reach it: other boxes may follow
        self._boxes: dict[str, ui.input] = {}
        self._shown: dict[str, tuple[str, float]] = {}  # the text of a box, and the value that it was made of
        self._focused = ""  # the box that a person types in
        self._searches = 0
        self._dragged = IDENTITY_ROTATION  # how tool0 was turned when the handle was taken
        with row_of():
            self._caption = ui.label("T(base_link → tool0)").classes("studio-caption")
            self._turn = toggle([*TURNS], "how the orientation is written", self.show, next(iter(TURNS)))
        with row_of():
            for name in (*PLACE, *sum(TURNS.values(), ())):
                box = ui.input().props(f'dense outlined prefix="{name}" aria-label="{name} of tool0"')
                box.classes("studio-target-box").on("change", self._typed)
                box.on("focus", partial(self._focus, name)).on("blur", partial(self._focus, "", after=name))
                self._boxes[name] = box
        self._answer = ui.label().classes("studio-target-answer").props('role="status"')
        self._numbers = ui.label().classes("studio-target-numbers")

    def _focus(self, name: str, after: str | None = None) -> None:
        if after in (None, self._focused):  # The browser reports that a box is left after the focus of the next one.
            self._focused = name

    def switch(self) -> None:
        """Open it, or close it; the handle comes and goes with it."""
        self._answer.set_text("")
        super().switch()
        self._tell("showHandle", self._is_open)

    def _show_arm(self, arm: OpenArm) -> None:
        """Show the pose, and what the arm can do from here."""
        session, pose = self._session, self._session.tool_pose or IDENTITY
        self._caption.set_text(f"T(base_link → {session.tool})")
        length, angle = UNITS[arm.table.length_unit], UNITS[arm.table.angle_unit]
        rpy, quaternion = TURNS.values()
        values = {name: (length, value) for name, value in zip(PLACE, pose.translation, strict=True)}
        values |= {name: (angle, value) for name, value in zip(rpy, pose.rpy, strict=True)}
        parts = quaternion_from_rotation(pose.rotation)
        values |= {name: (_BARE, part) for name, part in zip(quaternion, parts, strict=True)}
        for name, box in self._boxes.items():
            if not self._keeps_texts and name != self._focused:
                unit, value = values[name]
                digits = max(USUAL, decimals(length, session.reach)) if name in PLACE else USUAL
                box.set_value(short(unit.number(value), digits))
                self._shown[name] = box.value, value
            box.set_visibility(name in PLACE or name in TURNS[self._turn.value])
        here = dexterity(arm.manipulator, session.vector)
        told = f"manipulability {here.manipulability:.3g}; smallest singular value {here.smallest_singular_value:.3g}"
        if here.smallest_singular_value < _SINGULAR:
            told = "The arm is at a singularity: manipulability 0"
        if sliders := [slider for slider in session.sliders if slider.name in here.margins]:
            nearest = min(sliders, key=lambda slider: here.margins[slider.name])
            margin = nearest.shown(here.margins[nearest.name])
            told += f"; nearest limit: {nearest.name}, {margin:.4g} {nearest.unit.symbol}"
        self._numbers.set_text(told)

    def _number(self, name: str, unit: Unit) -> float:
        """The number in a box in SI units; where nothing was typed, all digits of it."""
        text = self._boxes[name].value or ""
        shown, value = self._shown.get(name, ("", 0.0))
        if text == shown:
            return value
        try:
            return evaluate(text, unit.dimension, unit, decimal_comma=True).value
        except QuantityError as error:
            error.add_note(name)
            raise

    def _pose(self, table: TableText) -> RigidTransform:
        """The pose in the boxes, in the units of a table; a `QuantityError` where there is none."""
        length, angle = UNITS[table.length_unit], UNITS[table.angle_unit]
        x, y, z = (self._number(name, length) for name in PLACE)
        names = TURNS[self._turn.value]
        if len(names) == len(PLACE):
            roll, pitch, yaw = (self._number(name, angle) for name in names)
            return RigidTransform(rotation_from_rpy((roll, pitch, yaw)), (x, y, z))
        parts = [self._number(name, _BARE) for name in names]
        size = math.hypot(*parts)
        if size < _NO_LENGTH:
            message = "a quaternion of length 0 is no orientation"
            raise QuantityError(message, "four numbers, at least one of which is not 0")
        return RigidTransform(rotation_from_quaternion([part / size for part in parts]), (x, y, z))

    async def _typed(self) -> None:
        """Move the arm to the pose in the boxes; in a thread, as a search may take a while."""
        arm = self._session.arm
        if arm is None:
            return
        self._searches += 1
        number = self._searches
        try:
            search: asyncio.Future[tuple[dict[str, float], InverseSolution] | None] = asyncio.ensure_future(
                run.io_bound(self._session.search, self._pose(arm.table))
            )
            done, _ = await asyncio.wait({search}, timeout=_PATIENCE)
            if not done:
                self._answer.set_text("searching …")
            found = await search
        except (QuantityError, InputError) as error:
            self._answer.set_text(": ".join([*getattr(error, "__notes__", ()), str(error)]))
            return
        is_newest = number == self._searches and self._session.arm is arm
        if found is not None and is_newest:  # else the studio ends, or something else was asked for meanwhile
            self._keeps_texts = not found[1].reached
            self._take(*found)
            self._keeps_texts = False

    def drag(self, x: float, y: float, z: float, *, begins: bool) -> None:
        """Follow the handle: the tool comes to a place [m], turned as it was when the handle was taken."""
        arm, pose = self._session.arm, self._session.tool_pose
        if arm is None or pose is None:
            return
        if begins:
            self._dragged = pose.rotation
        target = RigidTransform(self._dragged, (x, y, z))
        self._take(*self._session.search(target, attempts=1))

    def _take(self, values: dict[str, float], found: InverseSolution) -> None:
        self._session.move(values)
        self._on_move()
        far = float(f"{found.position_error * 1000.0:.3g}")  # and no power of ten: 1080
        tool = self._session.tool
        short_of = f"{tool} is {far:g} mm and {math.degrees(found.angle_error):.3g}° from it."
        self._answer.set_text(f"{tool} is there" if found.reached else f"The arm cannot reach this pose: {short_of}")
