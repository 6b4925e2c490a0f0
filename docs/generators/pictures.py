"""The pictures of the pages, drawn from the project's own kinematics: `python docs/generators/pictures.py` writes them.

A test compares the files in docs/pictures with what is drawn here, and the frames in them with the DH product.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.kinematics import dh_transform, row_transform
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.rotations import IDENTITY, RigidTransform, Vec3, add, rotate, scale
from diagram import pipeline
from drawing import FAINT, INK, X_COLOUR, Z_COLOUR, Camera, Drawing, axis_tip, svg
from gallery import gallery
from servo_steps import servo_steps

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.robot import Robot

FOLDER = Path(__file__).parents[1] / "pictures"
TABLE = Path(__file__).parents[2] / "configs" / "tables" / "ur5_paper.csv"

A, ALPHA, D, THETA = 1.7, math.radians(40), 1.4, math.radians(48)
"""A row with nothing special: no angle is right, nothing is 0."""
AXES = 0.62
"""Length of the drawn axes of a frame [m]."""
STANDARD_CAMERA = Camera(azimuth=math.radians(-74), elevation=math.radians(28), scale=185)
MODIFIED_CAMERA = Camera(azimuth=math.radians(-118), elevation=math.radians(26), scale=185)


def partial(convention: Convention, **parts: float) -> RigidTransform:
    """The transform of a row of which only some parts are there: the others are 0."""
    return dh_transform(convention, **{"a": 0.0, "alpha": 0.0, "d": 0.0, "theta": 0.0, **parts})


def standard_row() -> str:
    """The standard convention: frame i−1 stands on the axis of joint i, its own row leads to frame i."""
    convention = Convention.STANDARD
    turned = partial(convention, theta=THETA, d=D)  # after Rz(θ) Tz(d)
    moved = partial(convention, theta=THETA, d=D, a=A)  # and Tx(a)
    end = partial(convention, theta=THETA, d=D, a=A, alpha=ALPHA)  # and Rx(α): frame i
    sheet = Drawing(STANDARD_CAMERA)
    _axis(sheet, IDENTITY, -0.6, D + 0.95, "axis of joint i")
    _axis(sheet, end, -0.65, 1.5, "axis of joint i+1")
    _link(sheet, IDENTITY.translation, turned.translation, moved.translation)
    sheet.cylinder(RigidTransform(IDENTITY.rotation, (0.0, 0.0, -0.24)), 0.17, 0.34)
    sheet.cylinder(RigidTransform(end.rotation, add(end.translation, scale(-0.24, _z(end)))), 0.17, 0.34)
    _length(sheet, IDENTITY.translation, turned.translation, Z_COLOUR)
    _length(sheet, turned.translation, moved.translation, X_COLOUR)
    level = RigidTransform(IDENTITY.rotation, turned.translation)
    _angle(sheet, level, THETA, name=("θ", "i"), origin=("x", "i−1"), by=(16, 10))
    upright = RigidTransform(turned.rotation, moved.translation)
    _twist(sheet, upright, ALPHA, name=("α", "i"), origin=("z", "i−1"), by=(8, -8))
    _frame(sheet, IDENTITY, "i−1", {"x": (2, 22), "y": (22, 0), "z": (-22, 8)})
    _frame(sheet, end, "i", {"x": (16, 10), "y": (-12, -2), "z": (16, 12)})
    sheet.label((0.0, 0.0, D * 0.72), "d", "i", by=(-18, 4), colour=Z_COLOUR)
    sheet.label(scale(0.5, add(turned.translation, moved.translation)), "a", "i", by=(4, -12), colour=X_COLOUR)
    return svg([sheet], (-120, -500, 620, 610), "A row of a table in the standard convention: frame i−1 to frame i")


def modified_row() -> str:
    """The modified convention: a and α of the link before lead to the axis of joint i, on which frame i stands."""
    convention = Convention.MODIFIED
    moved = partial(convention, a=A)  # after Tx(a), which Rx(α) does not change
    tilted = partial(convention, a=A, alpha=ALPHA)  # and Rx(α)
    risen = partial(convention, a=A, alpha=ALPHA, d=D)  # and Tz(d), which Rz(θ) does not change
    end = partial(convention, a=A, alpha=ALPHA, d=D, theta=THETA)  # frame i
    sheet = Drawing(MODIFIED_CAMERA)
    _axis(sheet, IDENTITY, -0.5, 1.6, "axis of joint i−1")
    _axis(sheet, tilted, -0.6, D + 1.25, "axis of joint i")
    _link(sheet, IDENTITY.translation, moved.translation, risen.translation)
    sheet.cylinder(RigidTransform(IDENTITY.rotation, (0.0, 0.0, -0.24)), 0.17, 0.34)
    sheet.cylinder(RigidTransform(tilted.rotation, add(moved.translation, scale(-0.24, _z(tilted)))), 0.17, 0.34)
    _length(sheet, IDENTITY.translation, moved.translation, X_COLOUR)
    _length(sheet, moved.translation, risen.translation, Z_COLOUR)
    _twist(sheet, moved, ALPHA, name=("α", "i−1"), origin=("z", "i−1"), by=(8, -8))
    _angle(sheet, risen, THETA, name=("θ", "i"), origin=("x", "i−1"), by=(18, 4))
    _frame(sheet, IDENTITY, "i−1", {"x": (2, 24), "y": (-16, 2), "z": (-22, 8)})
    _frame(sheet, end, "i", {"x": (-14, -4), "y": (-14, 0), "z": (16, 14)})
    sheet.label((A * 0.62, 0.0, 0.0), "a", "i−1", by=(0, 24), colour=X_COLOUR)
    sheet.label(scale(0.5, add(moved.translation, risen.translation)), "d", "i", by=(20, 8), colour=Z_COLOUR)
    return svg([sheet], (-120, -320, 620, 420), "A row of a table in the modified convention: frame i−1 to frame i")


# --- Pieces of a row --------------------------------------------------------------------------------------------------


def _z(frame: RigidTransform) -> Vec3:
    return rotate(frame.rotation, (0.0, 0.0, 1.0))


def _axis(sheet: Drawing, frame: RigidTransform, lower: float, upper: float, words: str) -> None:
    """A joint axis: the z axis of a frame, drawn long, with its words at the upper end."""
    ends = [add(frame.translation, scale(length, _z(frame))) for length in (lower, upper)]
    sheet.line(*ends, colour=FAINT, width=1.3, dashes="14 4 3 4")
    x, y = sheet.at(ends[1])
    sheet.words((x, y - 8), words)


def _link(sheet: Drawing, *corners: Vec3) -> None:
    sheet.line(*corners, colour="#c9d2dc", width=22)
    sheet.line(*corners, colour="#e6ebf1", width=19)


def _length(sheet: Drawing, start: Vec3, end: Vec3, colour: str) -> None:
    sheet.line(start, end, colour=colour, width=4)


def _angle(
    sheet: Drawing,
    frame: RigidTransform,
    angle: float,
    *,
    name: tuple[str, str],
    origin: tuple[str, str],
    by: tuple[float, float],
) -> None:
    """The turn about z: from the x axis of the frame before, drawn here again, to the new one."""
    sheet.line(frame.translation, axis_tip(frame, "x", AXES * 1.1), colour=X_COLOUR, width=1.5, dashes="4 5")
    sheet.label(axis_tip(frame, "x", AXES * 1.1), *origin, by=(14, 10), colour=FAINT)
    sheet.arc(frame, angle, AXES * 0.8, colour=Z_COLOUR)
    sheet.label(_on_arc(frame, angle / 2, AXES * 0.8), *name, by=by, colour=Z_COLOUR)


def _twist(
    sheet: Drawing,
    frame: RigidTransform,
    angle: float,
    *,
    name: tuple[str, str],
    origin: tuple[str, str],
    by: tuple[float, float],
) -> None:
    """The turn about x: from the z axis of the frame before, drawn here again, to the new one."""
    sheet.line(frame.translation, axis_tip(frame, "z", AXES * 1.35), colour=Z_COLOUR, width=1.5, dashes="4 5")
    sheet.label(axis_tip(frame, "z", AXES * 1.35), *origin, by=(-20, 4), colour=FAINT)
    about_x = _about_x(frame)
    sheet.arc(about_x, angle, AXES * 1.2, colour=X_COLOUR)
    sheet.label(_on_arc(about_x, angle / 2, AXES * 1.2), *name, by=by, colour=X_COLOUR)


def _about_x(frame: RigidTransform) -> RigidTransform:
    """The axes in the order z, −y, x: a turn from z about x is then one from x about z."""
    xx, xy, xz, yx, yy, yz, zx, zy, zz = frame.rotation
    return RigidTransform((xz, -xy, xx, yz, -yy, yx, zz, -zy, zx), frame.translation)


def _on_arc(frame: RigidTransform, angle: float, radius: float) -> Vec3:
    return add(frame.translation, rotate(frame.rotation, (radius * math.cos(angle), radius * math.sin(angle), 0.0)))


def _frame(sheet: Drawing, frame: RigidTransform, index: str, by: dict[str, tuple[float, float]]) -> None:
    sheet.triad(frame, AXES, width=3, head=11)
    sheet.dot(frame.translation)
    for axis, shift in by.items():
        sheet.label(axis_tip(frame, axis, AXES), axis, index, by=shift)


# --- The UR5 of the paper ---------------------------------------------------------------------------------------------


def arm() -> Manipulator:
    """The UR5 of the paper's table III."""
    catalog = load()
    reader = catalog.reader_for(TABLE)
    (manipulator,) = reader.read(TABLE, reader.options())
    return manipulator  # type: ignore[return-value]  # the table is right


def robot(**options: str) -> Robot:
    """The robot that the α-swap makes of it."""
    stage: Any = load().get("transform", "alpha-swap")
    made: Robot = stage.transform(arm(), stage.options(**options))
    return made


def link_frames(made: Robot) -> dict[str, RigidTransform]:
    """Where the frame of every link is at joint values 0."""
    frames = {made.root: IDENTITY}
    for joint in made.joints:
        frames[joint.child] = frames[joint.parent] @ joint.origin.transform
    return frames


def segments(manipulator: Manipulator) -> list[tuple[Vec3, Vec3, Vec3]]:
    """The two segments of every row at joint values 0: along d, then along a (standard convention)."""
    found, frame = [], manipulator.base
    for row in manipulator.rows:
        start, frame = frame, frame @ row_transform(manipulator.convention, row)
        middle = add(start.translation, scale(row.d + 0.0, _z(start)))
        found.append((start.translation, middle, frame.translation))
    return found


UR5_CAMERA = Camera(azimuth=math.radians(-62), elevation=math.radians(20), scale=560, centre=(-0.4, -0.1, 0.05))


def frames() -> str:
    """The same arm with both kinds of link frames."""
    sheets = []
    for number, kind in enumerate(("aligned", "dh")):
        sheet = Drawing(UR5_CAMERA, shift=(0.0, 265.0 * number))
        for corners in segments(arm()):
            _link(sheet, *corners)
        placed = link_frames(robot(frames=kind))
        for name in (*(f"link_{i}" for i in range(1, 7)), "tool0"):
            sheet.triad(placed[name], 0.085, width=2.4, head=8)
            sheet.dot(placed[name].translation, radius=2.5)
        sheet.words((110, 265.0 * number - 95), f"frames: {kind}", size=17, colour=INK, anchor="start")
        sheets.append(sheet)
    return svg(
        sheets, (-325, -145, 660, 500), "The frames of the links of a UR5, aligned with the base and as in the table"
    )


def swap() -> str:
    """What the paper's algorithm makes of the table, and what the exact one does."""
    sheets = []
    for variant, words, shift in (
        ("paper", "variant: paper", (-330.0, 0.0)),
        ("exact", "variant: exact", (120.0, -30.0)),
    ):
        made = robot(variant=variant)
        placed = link_frames(made)
        sheet = Drawing(UR5_CAMERA._replace(scale=460), shift=shift)
        if variant == "exact":
            for corners in segments(arm()):
                _link(sheet, *corners)
        else:
            _link(
                sheet, *(placed[joint.child].translation for joint in made.moving_joints), placed["tool0"].translation
            )
        for number, joint in enumerate(made.moving_joints, start=1):
            frame = placed[joint.child]
            direction = rotate(frame.rotation, joint.axis)
            ends = [add(frame.translation, scale(length, direction)) for length in (-0.09, 0.11)]
            sheet.arrow(ends[0], ends[1], colour=Z_COLOUR, width=2.4, head=8)
            sheet.dot(frame.translation, radius=3)
            (x0, y0), (x1, y1) = map(sheet.at, ends)
            beside = (
                (x0 - 14, min(y0, y1) + 6) if abs(x1 - x0) < 1 else (x1 + 12, y1 + 4)
            )  # of an upright arrow on its left
            sheet.words(beside, str(number), colour=Z_COLOUR)
        x, _ = sheet.at((0.0, 0.0, 0.0))
        sheet.words((x, 110), words, size=17, colour=INK)
        sheets.append(sheet)
    return svg(sheets, (-330, -500, 700, 640), "The joint axes of the paper's UR5, as published and exact")


PICTURES: dict[str, Callable[[], str]] = {
    "dh-standard.svg": standard_row,
    "dh-modified.svg": modified_row,
    "frames.svg": frames,
    "alpha-swap.svg": swap,
    "pipeline.svg": pipeline,
    "servo-steps.svg": servo_steps,
    **gallery(),
}

if __name__ == "__main__":
    for name, draw in PICTURES.items():
        (FOLDER / name).write_text(draw(), "utf-8")
