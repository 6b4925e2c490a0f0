"""Tables as code for the Robotics Toolbox for Python: a DHRobot.

A link of the toolbox is A(q) with the joint variable ±q + offset, as a row of a table is. Every link moves, so fixed
rows before the first joint go into the base, those after the last one into the tool. Each link has the centre of mass
in its DH frame and the inertia tensor about the centre of mass; with a gear ratio of 1, Jm is the inertia of the rotor
behind the gear.

Source: P. Corke and J. Haviland, "Not your grandmother's toolbox" (ICRA 2021); classes `DHLink` and `DHRobot` of
roboticstoolbox-python 1.5.
"""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING

from dh2urdf.errors import EmitterError
from dh2urdf.kinematics import row_transform
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.quantities import format_number
from dh2urdf.rotations import IDENTITY
from dh2urdf.source import Problem
from dh2urdf_plugins.emitters.table.code import angle_code, matrix_rows, unsaid, variables

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.rotations import RigidTransform

_RESERVED = ("np", "pi", "inf", "DHRobot", "SE3")
_STRING = re.compile(r'"(?:\\.|[^"\\])*"')
_LISTED = ", "
_UNHELD = ("velocity", "effort", "radius", "visual", "collision")


def toolbox_file(arms: Sequence[Manipulator]) -> bytes:
    """A Python module with a DHRobot for each arm.

    Raises:
        EmitterError: a fixed row is between moving ones.
    """
    text = "\n".join(line for name, arm in variables(arms, _RESERVED) for line in ("", *_robot(name, arm)))
    words = set(re.findall(r"\w+", _STRING.sub("", text)))
    classes = sorted({_class(arm, row) for arm in arms for row in arm.moving_rows})
    title = ", ".join(" ".join(arm.name.split()) for arm in arms)
    lines = [_docstring(f"DH table of {title} for the Robotics Toolbox for Python, in m, rad and kg."), ""]
    if constants := [name for name in ("inf", "pi") if name in words]:
        lines += [f"from math import {', '.join(constants)}", ""]
    if "np" in words:
        lines.append("import numpy as np")
    lines.append(f"from roboticstoolbox import {', '.join(sorted(['DHRobot', *classes]))}")
    if "SE3" in words:
        lines.append("from spatialmath import SE3")
    return "\n".join([*lines, text, ""]).encode()


def _docstring(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"""{escaped}"""'


def _robot(name: str, arm: Manipulator) -> Iterator[str]:
    base, rows, tool = _moving(arm)
    yield f"{name} = DHRobot("
    yield "    ["
    for row in rows:
        yield f"        {_class(arm, row)}({', '.join(_link(row))}),"
    yield "    ],"
    yield f"    name={_text(arm.name)},"
    for place, pose in (("base", base), ("tool", tool)):
        if pose != IDENTITY:
            yield f"    {place}=SE3({_array(matrix_rows(pose))}, check=False),"
    yield ")"


def _moving(arm: Manipulator) -> tuple[RigidTransform, Sequence[DHRow], RigidTransform]:
    """The base, the moving rows and the tool, with the fixed rows at the ends in base and tool.

    Raises:
        EmitterError: a fixed row is between moving ones.
    """
    rows = list(arm.rows)
    base, tool = arm.base, arm.tool
    while rows and rows[0].type is JointType.FIXED:
        base @= row_transform(arm.convention, rows.pop(0))
    while rows and rows[-1].type is JointType.FIXED:
        tool = row_transform(arm.convention, rows.pop()) @ tool
    between = [row for row in rows if row.type is JointType.FIXED]
    if between or not rows:
        raise EmitterError(
            Problem(
                message="every link of a DHRobot moves, and a row between two joints is fixed"
                if between
                else "every link of a DHRobot moves, and no row of the table does",
                robot=arm.name,
                mark=between[0].mark if between else arm.mark,
                found=(between or arm.rows)[0].joint,
                accepted="fixed rows before the first joint and after the last one",
                suggestion="`dh2urdf convert` to URDF, then `dh2urdf extract`, folds fixed rows into the others",
            )
        )
    return base, rows, tool


def _class(arm: Manipulator, row: DHRow) -> str:
    kind = "Prismatic" if row.type is JointType.PRISMATIC else "Revolute"
    return f"{kind}{'MDH' if arm.convention is Convention.MODIFIED else 'DH'}"


def _link(row: DHRow) -> Iterator[str]:
    """The arguments of a link."""
    is_prismatic = row.type is JointType.PRISMATIC
    number = format_number if is_prismatic else angle_code
    yield f"theta={angle_code(row.theta)}" if is_prismatic else f"d={format_number(row.d)}"
    yield f"a={format_number(row.a)}"
    yield f"alpha={angle_code(row.alpha)}"
    if said := [number(value) for value in (row.d if is_prismatic else row.theta, row.offset) if value]:
        yield f"offset={' + '.join(said)}"
    if row.sign < 0:
        yield "flip=True"
    if (row.limits.lower, row.limits.upper) != (None, None):
        lower = "-inf" if row.limits.lower is None else number(row.limits.lower)
        yield f"qlim=[{lower}, {'inf' if row.limits.upper is None else number(row.limits.upper)}]"
    yield from _dynamics(row)
    yield f"name={_text(row.link)}"


def _dynamics(row: DHRow) -> Iterator[str]:
    """The arguments of a link's body and motor."""
    if row.mass is not None:
        yield f"m={format_number(row.mass)}"
    if row.com is not None:
        yield f"r=[{', '.join(map(format_number, row.com))}]"
    if row.inertia is not None:
        i = row.inertia
        tensor = ((i.ixx, i.ixy, i.ixz), (i.ixy, i.iyy, i.iyz), (i.ixz, i.iyz, i.izz))
        yield f"I={_array([[*map(format_number, line)] for line in tensor])}"
    if (row.armature, row.damping, row.friction) != (None, None, None):
        yield "G=1"
    if row.armature is not None:
        yield f"Jm={format_number(row.armature)}"
    if row.damping is not None:
        yield f"B={format_number(row.damping)}"
    if row.friction is not None:
        yield f"Tc=[{format_number(row.friction)}, {format_number(-row.friction)}]"


def _array(rows: Sequence[Sequence[str]]) -> str:
    return f"np.array([{', '.join(f'[{_LISTED.join(row)}]' for row in rows)}])"


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=True)


def left_out_of_toolbox(arms: Sequence[Manipulator]) -> Iterator[Problem]:
    """What a DHRobot has no place for, as notices."""
    yield from unsaid(arms, _UNHELD, "a DHRobot")
    held = ("mass", "com", "inertia")
    if any(
        getattr(row, name) is not None
        for arm in arms
        for row in arm.rows
        for name in held
        if row not in arm.moving_rows
    ):
        yield Problem(message="a DHRobot has no fixed links: the masses of fixed rows are left out", severity="notice")
