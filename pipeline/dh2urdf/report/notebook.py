"""What a notebook shows of a manipulator and of a robot: a table and, where matplotlib is installed, a drawing.

The HTML stands by itself and takes its colours from where it stands, light or dark. Names come from strangers' files,
and every one is escaped.
"""

from __future__ import annotations

import math
from hashlib import sha256
from html import escape
from importlib.resources import files
from importlib.util import find_spec
from typing import TYPE_CHECKING

from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.manipulator import JointType
from dh2urdf.report.conversions import counted
from dh2urdf.robot import Robot
from dh2urdf.rotations import IDENTITY
from dh2urdf.source import printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.manipulator import Manipulator

MOST_ROWS = 200  # rows of a table that are shown; a table is as high as fifteen of them, and scrolls
_LIMITS = ("lower [rad, m]", "upper [rad, m]")


def manipulator_html(manipulator: Manipulator) -> str:
    """The DH table of a manipulator, with its convention, base and tool, in m and rad, angles also in degrees."""
    count = len(manipulator.rows)
    facts = [f"{manipulator.convention} convention", counted(count, "row")]
    for name, frame in (("base", manipulator.base), ("tool", manipulator.tool)):
        if frame != IDENTITY:
            facts.append(f"{name} xyz {_vector(frame.translation)} m, rpy {_vector(frame.rpy)} rad")
    if manipulator.payload is not None:
        facts.append(f"payload {_number(manipulator.payload.mass)} kg")
    head = ("no.", "joint", "type", "a [m]", "α [rad]", "d [m]", "θ [rad]", "offset [rad, m]", "sign", *_LIMITS)
    rows = [
        [
            str(number),
            _text(row.joint),
            row.type,
            _number(row.a),
            _value(row.alpha),
            _number(row.d),
            _value(row.theta),
            _value(row.offset, row.type),
            str(row.sign),
            _value(row.limits.lower, row.type),
            _value(row.limits.upper, row.type),
        ]
        for number, row in enumerate(manipulator.rows[:MOST_ROWS], 1)
    ]
    return _html(manipulator, facts, head, 3, rows, count)


def robot_html(robot: Robot) -> str:
    """The joints of a robot, with their links, origins and limits, in m and rad, angles also in degrees."""
    moving = len(robot.moving_joints)
    facts = [f"{len(robot.links)} links", counted(moving, "moving joint")]
    facts += [f"{_number(robot.mass)} kg", f"root {_text(robot.root)}"]
    head = ("joint", "type", "parent", "child", "xyz [m]", "rpy [rad]", "axis", *_LIMITS, "child's mass [kg]")
    masses = {link.name: link.inertial.mass for link in robot.links if link.inertial}
    rows = []
    for joint in robot.joints[:MOST_ROWS]:
        motion = ["", "", ""]
        if joint.type is not JointType.FIXED:
            ends = [_value(end, joint.type) for end in (joint.limits.lower, joint.limits.upper)]
            motion = [_vector(joint.axis), *ends]
        mass = _number(masses[joint.child]) if masses.get(joint.child) else ""
        names = [_text(joint.name), joint.type, _text(joint.parent), _text(joint.child)]
        rows.append([*names, _vector(joint.origin.xyz), _vector(joint.origin.rpy), *motion, mass])
    return _html(robot, facts, head, 4, rows, len(robot.joints))


def _html(  # noqa: PLR0917 - what there is to show
    what: Manipulator | Robot, facts: list[str], head: Sequence[str], words: int, rows: list[list[str]], count: int
) -> str:
    """Facts, a drawing, and a table of so many rows; its first columns are words, the others numbers."""
    kinds = ["" if number < words else ' class="n"' for number in range(len(head))]

    def line(tag: str, cells: Sequence[str]) -> str:
        inner = [f"<{tag}{kind}>{cell}</{tag}>" for kind, cell in zip(kinds, cells, strict=True)]
        return f"<tr>{''.join(inner)}</tr>"

    body = "".join(line("td", row) for row in rows)
    if (more := count - len(rows)) > 0:
        body += f'<tr><td colspan="{len(head)}"><small>… {more} more</small></td></tr>'
    table = f"<table><thead>{line('th', head)}</thead><tbody>{body}</tbody></table>"
    style = files("dh2urdf.report").joinpath("templates", "notebook.css").read_text("utf-8")
    return (
        f'<div class="dh2urdf"><style>{style}</style><p><b>{_text(what.name)}</b> <span>{" · ".join(facts)}</span></p>'
        f'<div class="parts">{_drawing(what)}<div class="rows">{table}</div></div></div>'
    )


def _text(text: str) -> str:
    """A name from a file, without control characters, nor those that turn the direction of what follows."""
    return escape(printable(text))


def _number(value: float) -> str:
    return f"{value + 0.0:.6g}"


def _value(value: float | None, kind: JointType = JointType.REVOLUTE) -> str:
    """A joint value: an angle in rad, and in degrees; or a length of a prismatic joint."""
    if value is None:
        return "<small>–</small>"
    if kind is JointType.PRISMATIC:
        return f"{_number(value)} <small>m</small>"
    return f"{_number(value)} <small>{_number(math.degrees(value))}°</small>" if value else "0"


def _vector(values: Iterable[float]) -> str:
    return " ".join(f"{value + 0.0:.4g}" for value in values)


def _drawing(what: Manipulator | Robot) -> str:
    """The arm or robot as SVG; nothing where matplotlib is not installed, or where there is nothing to be drawn."""
    if find_spec("matplotlib") is None:
        return ""
    from dh2urdf.report.figures import FARTHEST_DRAWN, arm_skeleton, robot_skeleton, skeleton_figure

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
    svg = skeleton_figure([bones], f"zero joint values, with joint axes and {frames}", key)
    return f"<figure>{svg}</figure>"
