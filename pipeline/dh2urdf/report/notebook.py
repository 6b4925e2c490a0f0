"""What a notebook shows of a manipulator and of a robot: a table and, where matplotlib is installed, a drawing.

The HTML stands by itself and takes its colours from where it stands, light or dark. Names come from strangers' files,
and every one is escaped.
"""

from __future__ import annotations

import math
from functools import cache
from hashlib import sha256
from html import escape
from importlib.resources import files
from importlib.util import find_spec
from typing import TYPE_CHECKING

from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Robot
from dh2urdf.rotations import IDENTITY
from dh2urdf.source import printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.robot import Joint
    from dh2urdf.rotations import RigidTransform

MOST_ROWS = 200
"""Rows of a table that are shown; a table is as high as fifteen of them, and scrolls."""
_LIMITS = ("lower [rad, m]", "upper [rad, m]")


def manipulator_html(manipulator: Manipulator) -> str:
    """The DH table of a manipulator, with its convention, base and tool, in m and rad, angles also in degrees."""
    count = len(manipulator.rows)
    facts = [f"{manipulator.convention} convention", f"{count} row{'s' if count != 1 else ''}"]
    facts += [
        f"{name} {_frame(frame)}"
        for name, frame in (("base", manipulator.base), ("tool", manipulator.tool))
        if frame != IDENTITY
    ]
    if manipulator.payload is not None:
        facts.append(f"payload {_number(manipulator.payload.mass)} kg")
    head = ("no.", "joint", "type", "a [m]", "α [rad]", "d [m]", "θ [rad]", "offset [rad, m]", "sign", *_LIMITS)
    return _html(
        manipulator.name,
        facts,
        _table(head, 3, [_dh_row(number, row) for number, row in enumerate(manipulator.rows[:MOST_ROWS], 1)], count),
        _drawing(manipulator),
    )


def robot_html(robot: Robot) -> str:
    """The joints of a robot, with their links, origins and limits, in m and rad, angles also in degrees."""
    moving = len(robot.moving_joints)
    facts = [
        f"{len(robot.links)} links",
        f"{moving} moving joint{'s' if moving != 1 else ''}",
        f"{_number(robot.mass)} kg",
        f"root {_text(robot.root)}",
    ]
    head = ("joint", "type", "parent", "child", "xyz [m]", "rpy [rad]", "axis", *_LIMITS, "child's mass [kg]")
    masses = {link.name: link.inertial.mass for link in robot.links if link.inertial}
    return _html(
        robot.name,
        facts,
        _table(head, 4, [_joint_row(joint, masses) for joint in robot.joints[:MOST_ROWS]], len(robot.joints)),
        _drawing(robot),
    )


def _dh_row(number: int, row: DHRow) -> tuple[str, ...]:
    return (
        str(number),
        _text(row.joint),
        row.type,
        _number(row.a),
        _angle(row.alpha),
        _number(row.d),
        _angle(row.theta),
        _value(row.offset, row.type),
        str(row.sign),
        _value(row.limits.lower, row.type),
        _value(row.limits.upper, row.type),
    )


def _joint_row(joint: Joint, masses: Mapping[str, float]) -> tuple[str, ...]:
    motion: tuple[str, ...] = ("", "", "")
    if joint.type is not JointType.FIXED:
        limits = (_value(limit, joint.type) for limit in (joint.limits.lower, joint.limits.upper))
        motion = (_vector(joint.axis), *limits)
    return (
        _text(joint.name),
        joint.type,
        _text(joint.parent),
        _text(joint.child),
        _vector(joint.origin.xyz),
        _vector(joint.origin.rpy),
        *motion,
        _number(masses[joint.child]) if masses.get(joint.child) else "",
    )


# --- HTML -------------------------------------------------------------------------------------------------------------


def _html(name: str, facts: Iterable[str], table: str, drawing: str) -> str:
    told = " · ".join(facts)
    return (
        f'<div class="dh2urdf"><style>{_style()}</style><p><b>{_text(name)}</b> <span>{told}</span></p>'
        f'<div class="parts">{drawing}<div class="rows">{table}</div></div></div>'
    )


@cache
def _style() -> str:
    return files("dh2urdf.report").joinpath("templates", "notebook.css").read_text("utf-8")


def _table(head: Sequence[str], words: int, rows: Sequence[Sequence[str]], count: int) -> str:
    """A table of so many rows, the first of which are shown; its first columns are words, the others numbers."""
    kinds = ["", *[""] * (words - 1), *[' class="n"'] * (len(head) - words)]
    titles = "".join(f"<th{kind}>{title}</th>" for kind, title in zip(kinds, head, strict=True))
    body = "".join(
        f"<tr>{''.join(f'<td{kind}>{cell}</td>' for kind, cell in zip(kinds, row, strict=True))}</tr>" for row in rows
    )
    if (more := count - len(rows)) > 0:
        body += f'<tr><td colspan="{len(head)}"><small>… {more} more</small></td></tr>'
    return f"<table><thead><tr>{titles}</tr></thead><tbody>{body}</tbody></table>"


def _text(text: str) -> str:
    """A name from a file, without control characters, nor those that turn the direction of what follows."""
    return escape(printable(text))


def _number(value: float) -> str:
    return f"{value + 0.0:.6g}"


def _angle(value: float) -> str:
    """An angle in rad, and in degrees."""
    return f"{_number(value)} <small>{_number(math.degrees(value))}°</small>" if value else "0"


def _value(value: float | None, kind: JointType) -> str:
    """A joint value: an angle, or a length of a prismatic joint."""
    if value is None:
        return "<small>–</small>"
    return f"{_number(value)} <small>m</small>" if kind is JointType.PRISMATIC else _angle(value)


def _vector(values: Iterable[float]) -> str:
    return " ".join(f"{value + 0.0:.4g}" for value in values)


def _frame(frame: RigidTransform) -> str:
    return f"xyz {_vector(frame.translation)} m, rpy {_vector(frame.rpy)} rad"


# --- The drawing ------------------------------------------------------------------------------------------------------


def _drawing(what: Manipulator | Robot) -> str:
    """The arm or robot as SVG; nothing where matplotlib is not installed, or where there is nothing to be drawn."""
    if find_spec("matplotlib") is None:
        return ""
    from dh2urdf.report.figures import FARTHEST_DRAWN, skeleton_figure, without_warnings
    from dh2urdf.report.skeletons import arm_skeleton, robot_skeleton

    try:
        if isinstance(what, Robot):
            bones, frames = robot_skeleton(what), "link frames"
        else:
            bones, frames = arm_skeleton(ExpectedPoses.of(what).tips[0]), "DH frames"
    except (ValueError, OverflowError):  # no tree, or an angle that is no number or endless
        return ""
    places = [*bones.tips, *(frame.translation for frame in bones.frames)]
    if not all(abs(number) < FARTHEST_DRAWN for place in places for number in place):
        return ""
    # The parts of a drawing have names on the page: those of the same drawing may be the same.
    key = f"dh2urdf-{sha256(repr(bones).encode()).hexdigest()[:12]}"
    with without_warnings():
        svg = skeleton_figure([bones], f"zero joint values, with joint axes and {frames}", key)
    return f"<figure>{svg}</figure>"
