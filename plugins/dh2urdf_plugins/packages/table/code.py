"""Tables as code: a rigidBodyTree of MATLAB's Robotics System Toolbox, a DHRobot of the Robotics Toolbox for Python.

MATLAB: `setFixedTransform(joint, [a alpha d theta], 'dh')` leaves out theta of a revolute joint and d of a prismatic
one, and has no offset. A constant there is a fixed body of its own: before the joint in the standard convention, after
it in the modified one, where it commutes with the motion. `JointAxis` is -z where the joint counts the other way.
Source: reference pages of `rigidBodyJoint`, `rigidBodyJoint.setFixedTransform` and `rigidBody` (R2024b).

Python: a link of the toolbox is A(q) with the joint variable ±q + offset, as a row of a table is. Every link moves, so
fixed rows before the first joint go into the base, those after the last one into the tool. Each link has the centre of
mass in its DH frame and the inertia tensor about the centre of mass; with a gear ratio of 1, Jm is the inertia of the
rotor behind the gear. Source: P. Corke and J. Haviland, "Not your grandmother's toolbox" (ICRA 2021); classes `DHLink`
and `DHRobot` of roboticstoolbox-python 1.5.
"""

from __future__ import annotations

import json
import re
from functools import partial
from typing import TYPE_CHECKING

from dh2urdf.errors import EmitterError
from dh2urdf.kinematics import row_transform
from dh2urdf.manipulator import ROOT, TOOL, Convention, Follower, JointType
from dh2urdf.quantities import UNITS, format_number, number_in
from dh2urdf.rotations import IDENTITY
from dh2urdf.source import Messages, Problem, free_name
from dh2urdf.table_text.texts import law_text
from dh2urdf_plugins.formats import numbered_name
from dh2urdf_plugins.packages.templates import filled

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.rotations import RigidTransform
    from dh2urdf_plugins.packages.table import Format

say = Messages(__file__)

_NOT_A_NAME = re.compile(r"[^A-Za-z0-9]+")
_STRING = re.compile(r'"(?:\\.|[^"\\])*"')
_MATLAB_NAMES = ("body", "joint", "pi", "inf")
_TOOLBOX_NAMES = ("np", "pi", "inf", "DHRobot", "SE3")
_WITHOUT = {
    "matlab": ("a rigidBodyTree", ("velocity", "effort", "radius", "damping", "friction", "armature")),
    "roboticstoolbox": ("a DHRobot", ("velocity", "effort", "radius")),
}
"""By format: what its object is called, and the fields that it has no place for beside meshes."""
_WEIGHTLESS = "body.Mass = 0;\nbody.Inertia = [0 0 0 0 0 0];"  # what a body without a mass needs: MATLAB gives it 1 kg


# --- MATLAB -----------------------------------------------------------------------------------------------------------


def matlab_file(arms: Sequence[Manipulator]) -> bytes:
    """A script that makes a rigidBodyTree of each arm."""
    title = ", ".join(" ".join(arm.name.split()) for arm in arms)
    text = f"% DH table of {title} for the Robotics System Toolbox of MATLAB, in m, rad and kg.\n"
    for name, arm in _variables(arms, _MATLAB_NAMES):
        text += f"\n{name} = rigidBodyTree('DataFormat', 'row');\n{name}.BaseName = '{ROOT}';\n"
        parent = ROOT
        for body, words in _bodies(arm):
            text += filled("table/templates/body.m", TREE=name, BODY=_quoted(body), PARENT=_quoted(parent), **words)
            parent = body
        if arm.followers:
            values = ", ".join(_led(arm, lambda number: f"q({number + 1})"))
            text += "% Joint values of the tree, from those of the joints that follow none.\n"
            text += f"{name}_q = @(q) [{values}];\n"
    return text.encode()


def _bodies(arm: Manipulator) -> Iterator[tuple[str, dict[str, str]]]:
    """The bodies of a tree from the base to the tool, each with the words of its template."""
    taken = {ROOT, TOOL, *(row.link for row in arm.rows), *(row.joint for row in arm.rows)}
    free = partial(free_name, taken=taken)
    if arm.base != IDENTITY:
        yield free("base_frame"), _fixed(free("base_frame_joint"), _matlab_matrix(arm.base))
    is_standard = arm.convention is Convention.STANDARD
    notation = "'dh'" if is_standard else "'mdh'"
    for row in arm.rows:
        mass = "\n".join(_matlab_mass(row))
        # A constant part of the joint variable is a fixed body, before the joint or after it.
        constant = ""
        if row.type is not JointType.FIXED and (offset := _offset(row)):
            constant = f"[0, 0, {offset}, 0]" if row.type is JointType.PRISMATIC else f"[0, 0, 0, {offset}]"
            constant = f"{constant}, {notation}"
        if constant and is_standard:
            yield free(f"{row.link}_zero"), _fixed(free(f"{row.joint}_zero"), constant)
        is_last = is_standard or not constant
        # What `setFixedTransform` leaves out of the four numbers is 0 here.
        d = format_number(0.0 if row.type is JointType.PRISMATIC else row.d)
        theta = _angle(row.theta if row.type in (JointType.PRISMATIC, JointType.FIXED) else 0.0)
        is_bounded = (row.limits.lower, row.limits.upper) != (None, None) or row.type is JointType.CONTINUOUS
        has_limits = is_bounded and row.type is not JointType.FIXED
        words = {
            "JOINT": _quoted(row.joint),
            "KIND": "revolute" if row.type is JointType.CONTINUOUS else str(row.type),
            "TRANSFORM": f"[{format_number(row.a)}, {_angle(row.alpha)}, {d}, {theta}], {notation}",
            "AXIS": "joint.JointAxis = [0 0 -1];" if row.sign < 0 else "",
            "LIMITS": f"joint.PositionLimits = {_limits(row)};" if has_limits else "",
            "MASS": mass if is_last else "",
        }
        yield row.link if is_last else free(f"{row.link}_zero"), words
        if not is_last:
            yield row.link, _fixed(free(f"{row.joint}_zero"), constant, mass)
    yield TOOL, _fixed(free(f"{TOOL}_joint"), _matlab_matrix(arm.tool))


def _fixed(joint: str, transform: str, mass: str = "") -> dict[str, str]:
    """The words of a body that is fixed to the one before."""
    words = {"JOINT": _quoted(joint), "KIND": "fixed", "TRANSFORM": transform, "MASS": mass or _WEIGHTLESS}
    return {**words, "AXIS": "", "LIMITS": ""}


def _matlab_mass(row: DHRow) -> Iterator[str]:
    """Mass properties as a rigidBody has them: the inertia tensor is about the origin of the body's frame [kg·m²]."""
    if row.mass is None:
        return
    yield f"body.Mass = {format_number(row.mass)};"
    x, y, z = com = row.com or (0.0, 0.0, 0.0)
    yield f"body.CenterOfMass = [{' '.join(map(format_number, com))}];"
    if (i := row.inertia) is not None:  # The theorem of parallel axes.
        m = row.mass
        diagonal = (i.ixx + m * (y * y + z * z), i.iyy + m * (x * x + z * z), i.izz + m * (x * x + y * y))
        tensor = (*diagonal, i.iyz - m * y * z, i.ixz - m * x * z, i.ixy - m * x * y)
        yield f"body.Inertia = [{' '.join(map(format_number, tensor))}];"


def _matlab_matrix(transform: RigidTransform) -> str:
    return f"[{'; '.join(' '.join(row) for row in _matrix(transform))}]"


def _quoted(text: str) -> str:
    """A text of MATLAB."""
    quoted = " ".join(text.split()).replace("'", "''")
    return f"'{quoted}'"


# --- Robotics Toolbox for Python --------------------------------------------------------------------------------------


def toolbox_file(arms: Sequence[Manipulator]) -> bytes:
    """A Python module with a DHRobot for each arm; a fixed row between moving ones is an `EmitterError`."""
    text = ""
    for name, arm in _variables(arms, _TOOLBOX_NAMES):
        base, rows, tool = _moving(arm)
        poses = {
            place.upper(): "" if pose == IDENTITY else f"{place}=SE3({_array(_matrix(pose))}, check=False),"
            for place, pose in (("base", base), ("tool", tool))
        }
        links = "\n".join(f"{_class(arm, row)}({', '.join(_link(row))})," for row in rows)
        text += filled("table/templates/robot.py", NAME=name, LINKS=links, TEXT=json.dumps(arm.name), **poses)
        if arm.followers:
            values = ", ".join(_led(arm, lambda number: f"q[{number}]"))
            text += filled("table/templates/followers.py", NAME=name, VALUES=values)
    words = set(re.findall(r"\w+", _STRING.sub("", text)))
    classes = sorted({_class(arm, row) for arm in arms for row in arm.moving_rows})
    title = ", ".join(" ".join(arm.name.split()) for arm in arms).replace("\\", "\\\\").replace('"', '\\"')
    constants = ", ".join(name for name in ("inf", "pi") if name in words)
    head = filled(
        "table/templates/module.py",
        TITLE=title,
        CONSTANTS=constants and f"from math import {constants}\n",
        NUMPY="import numpy as np" if "np" in words else "",
        CLASSES=", ".join(sorted(["DHRobot", *classes])),
        POSES="from spatialmath import SE3" if "SE3" in words else "",
    )
    return f"{head}{text}".encode()


def _moving(arm: Manipulator) -> tuple[RigidTransform, Sequence[DHRow], RigidTransform]:
    """The base, the moving rows and the tool, with the fixed rows at the ends in base and tool."""
    rows = list(arm.rows)
    base, tool = arm.base, arm.tool
    while rows and rows[0].type is JointType.FIXED:
        base @= row_transform(arm.convention, rows.pop(0))
    while rows and rows[-1].type is JointType.FIXED:
        tool = row_transform(arm.convention, rows.pop()) @ tool
    between = [row for row in rows if row.type is JointType.FIXED]
    if between or not rows:
        code, mark = ("fixed-row-between", between[0].mark) if between else ("nothing-moves", arm.mark)
        raise EmitterError(say(code, mark, robot=arm.name, found=(between or arm.rows)[0].joint))
    return base, rows, tool


def _class(arm: Manipulator, row: DHRow) -> str:
    kind = "Prismatic" if row.type is JointType.PRISMATIC else "Revolute"
    return f"{kind}{'MDH' if arm.convention is Convention.MODIFIED else 'DH'}"


def _link(row: DHRow) -> list[str]:
    """The arguments of a link, of its body and of its motor."""
    is_prismatic = row.type is JointType.PRISMATIC
    i, friction = row.inertia, row.friction
    tensor = ((i.ixx, i.ixy, i.ixz), (i.ixy, i.iyy, i.iyz), (i.ixz, i.iyz, i.izz)) if i else ()
    words = {
        "theta" if is_prismatic else "d": _angle(row.theta) if is_prismatic else format_number(row.d),
        "a": format_number(row.a),
        "alpha": _angle(row.alpha),
        "offset": _offset(row),
        "flip": "True" if row.sign < 0 else "",
        "qlim": _limits(row) if (row.limits.lower, row.limits.upper) != (None, None) else "",
        "m": "" if row.mass is None else format_number(row.mass),
        "r": "" if row.com is None else f"[{', '.join(map(format_number, row.com))}]",
        "I": _array([[*map(format_number, line)] for line in tensor]) if tensor else "",
        "G": "" if (row.armature, row.damping, friction) == (None, None, None) else "1",
        "Jm": "" if row.armature is None else format_number(row.armature),
        "B": "" if row.damping is None else format_number(row.damping),
        "Tc": "" if friction is None else f"[{format_number(friction)}, {format_number(-friction)}]",
        "name": json.dumps(row.link),
    }
    return [f"{name}={word}" for name, word in words.items() if word]


def _led(arm: Manipulator, value: Callable[[int], str]) -> Iterator[str]:
    """The value of each moving joint, of those of the joints that follow none."""
    numbers = {row.joint: number for number, row in enumerate(arm.actuated_rows)}
    followers = arm.followers
    for row in arm.moving_rows:
        law = followers.get(row.joint, Follower(row.joint))
        yield law_text(law._replace(leader=value(numbers[law.leader])), _number(row)(law.offset))


def _array(rows: Sequence[Sequence[str]]) -> str:
    lists = [f"[{', '.join(row)}]" for row in rows]
    return f"np.array([{', '.join(lists)}])"


# --- Both -------------------------------------------------------------------------------------------------------------


def _angle(value: float) -> str:
    """An angle [rad] as an expression of pi, where it is a simple one to the last bit: ``-3*pi/4``."""
    return number_in(value, UNITS["rad"])


def _number(row: DHRow) -> Callable[[float], str]:
    """How code writes values of a row's joint variable."""
    return format_number if row.type is JointType.PRISMATIC else _angle


def _offset(row: DHRow) -> str:
    """The constant part of the joint variable; empty where there is none."""
    constants = (row.d if row.type is JointType.PRISMATIC else row.theta, row.offset)
    return " + ".join(_number(row)(value) for value in constants if value)


def _limits(row: DHRow) -> str:
    """The limits of a joint as a list of two numbers."""
    lower, upper = row.limits.lower, row.limits.upper
    least = "-inf" if lower is None else _number(row)(lower)
    return f"[{least}, {'inf' if upper is None else _number(row)(upper)}]"


def _matrix(transform: RigidTransform) -> list[list[str]]:
    """A rigid transform as four rows of four numbers."""
    r, t = transform
    rows = [[*map(format_number, (*r[3 * row : 3 * row + 3], t[row]))] for row in range(3)]
    return [*rows, ["0", "0", "0", "1"]]


def _variables(arms: Sequence[Manipulator], reserved: Iterable[str]) -> Iterator[tuple[str, Manipulator]]:
    """The arms, each with a name of a variable: ``robot`` of a single one, else of the arm's name."""
    if len(arms) == 1:
        yield "robot", arms[0]
        return
    taken = set(reserved)
    for arm in arms:
        name = _NOT_A_NAME.sub("_", arm.name).strip("_").lower()
        name = name if name[:1].isalpha() else f"robot_{name}".rstrip("_")
        taken.add(name := numbered_name(name, taken))
        yield name, arm


def left_out_of_code(name: Format, arms: Sequence[Manipulator]) -> Iterator[Problem]:
    """What the arms have and a rigidBodyTree or a DHRobot has no place for, as notices."""
    if name not in _WITHOUT:
        return
    what, fields = _WITHOUT[name]
    rows = [row for arm in arms for row in arm.rows]
    owners = [owner for row in rows for owner in (row, row.limits)]
    of_arms = {"base mass": "base_mass", "payload": "payload", "base meshes": "base_visual base_collision"}
    of_rows = {each: each for each in (*fields, "visual", "collision")}
    found = [
        word
        for places, names_of in ((owners, of_rows), (arms, of_arms))
        for word, names in names_of.items()
        if any(getattr(each, name, None) is not None for each in places for name in names.split())
    ]
    if found:
        yield say("no-place-in-code", what=what, fields=found)
    fixed = [row for arm in arms for row in arm.rows if row not in arm.moving_rows]
    if name == "roboticstoolbox" and any((row.mass, row.com, row.inertia) != (None, None, None) for row in fixed):
        yield say("fixed-masses-left-out")
