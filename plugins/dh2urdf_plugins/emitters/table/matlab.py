"""Tables as code for MATLAB's Robotics System Toolbox: a rigidBodyTree.

`setFixedTransform(joint, [a alpha d theta], 'dh')` leaves out theta of a revolute joint and d of a prismatic one, and
has no offset. A constant there is a fixed body of its own: before the joint in the standard convention, after it in the
modified one, where it commutes with the motion. `JointAxis` is -z where the joint counts the other way.

Source: reference pages of `rigidBodyJoint`, `rigidBodyJoint.setFixedTransform` and `rigidBody` (R2024b).
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from dh2urdf.manipulator import ROOT, TOOL, Convention, JointType
from dh2urdf.quantities import format_number
from dh2urdf.rotations import IDENTITY
from dh2urdf.source import free_name
from dh2urdf_plugins.emitters.table.code import angle_code, matrix_rows, unsaid, variables

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.manipulator import DHRow, Inertia, Manipulator
    from dh2urdf.rotations import Vec3
    from dh2urdf.source import Problem

_KINDS = {
    JointType.REVOLUTE: "revolute",
    JointType.CONTINUOUS: "revolute",
    JointType.PRISMATIC: "prismatic",
    JointType.FIXED: "fixed",
}
_WEIGHTLESS = ("body.Mass = 0;", "body.Inertia = [0 0 0 0 0 0];")
"""What a body without a mass needs: MATLAB gives it 1 kg."""
_RESERVED = ("body", "joint", "pi", "inf")
_UNHELD = ("velocity", "effort", "radius", "damping", "friction", "armature", "visual", "collision")


def matlab_file(arms: Sequence[Manipulator]) -> bytes:
    """A script that makes a rigidBodyTree of each arm."""
    title = ", ".join(" ".join(arm.name.split()) for arm in arms)
    lines = [f"% DH table of {title} for the Robotics System Toolbox of MATLAB, in m, rad and kg."]
    for name, arm in variables(arms, _RESERVED):
        lines += ["", *_Tree(name, arm).lines()]
    return "\n".join([*lines, ""]).encode()


class _Tree:
    """The code of one arm."""

    def __init__(self, variable: str, arm: Manipulator) -> None:
        self._variable, self._arm = variable, arm
        self._parent = ROOT
        taken = {ROOT, TOOL, *(row.link for row in arm.rows), *(row.joint for row in arm.rows)}
        self._free = partial(free_name, taken=taken)

    def lines(self) -> Iterator[str]:
        """The statements that make the tree."""
        yield f"{self._variable} = rigidBodyTree('DataFormat', 'row');"
        yield f"{self._variable}.BaseName = '{ROOT}';"
        if self._arm.base != IDENTITY:
            yield from self._placed(self._free("base_frame"), self._free("base_frame_joint"), self._matrix("base"))
        for row in self._arm.rows:
            yield from self._row(row)
        yield from self._placed(TOOL, self._free(f"{TOOL}_joint"), self._matrix("tool"))

    def _row(self, row: DHRow) -> Iterator[str]:
        """The body of a row, and the fixed body of a constant that the joint has no place for."""
        is_standard = self._arm.convention is Convention.STANDARD
        notation = "'dh'" if is_standard else "'mdh'"
        constant = _constant(row)
        if constant and is_standard:
            yield from self._placed(
                self._free(f"{row.link}_zero"),
                self._free(f"{row.joint}_zero"),
                constant,
                notation,
            )
        body = self._free(f"{row.link}_zero") if constant and not is_standard else row.link
        yield ""
        yield f"body = rigidBody({_text(body)});"
        yield f"joint = rigidBodyJoint({_text(row.joint)}, '{_KINDS[row.type]}');"
        yield f"setFixedTransform(joint, [{', '.join(_parameters(row))}], {notation});"
        if row.sign < 0:
            yield "joint.JointAxis = [0 0 -1];"
        yield from _limits(row)
        yield "body.Joint = joint;"
        bodies = list(_mass(row))
        yield from bodies if body == row.link else ()
        yield f"addBody({self._variable}, body, {_text(self._parent)});"
        self._parent = body
        if constant and not is_standard:
            yield from self._placed(row.link, self._free(f"{row.joint}_zero"), constant, notation, bodies)

    def _placed(
        self, body: str, joint: str, transform: str, notation: str = "", mass: Sequence[str] = ()
    ) -> Iterator[str]:
        """A body that is fixed to the one before."""
        yield ""
        yield f"body = rigidBody({_text(body)});"
        yield f"joint = rigidBodyJoint({_text(joint)}, 'fixed');"
        yield f"setFixedTransform(joint, {transform}{', ' if notation else ''}{notation});"
        yield "body.Joint = joint;"
        yield from mass or _WEIGHTLESS
        yield f"addBody({self._variable}, body, {_text(self._parent)});"
        self._parent = body

    def _matrix(self, name: str) -> str:
        rows = matrix_rows(getattr(self._arm, name))
        return f"[{'; '.join(' '.join(row) for row in rows)}]"


def _parameters(row: DHRow) -> tuple[str, str, str, str]:
    """a, alpha, d and theta as `setFixedTransform` takes them, without what it would leave out."""
    d = 0.0 if row.type is JointType.PRISMATIC else row.d
    theta = row.theta if row.type in (JointType.PRISMATIC, JointType.FIXED) else 0.0
    return format_number(row.a), angle_code(row.alpha), format_number(d), angle_code(theta)


def _constant(row: DHRow) -> str | None:
    """The constant part of the joint variable as the parameters of a fixed joint; None where there is none."""
    if row.type is JointType.FIXED:
        return None
    is_prismatic = row.type is JointType.PRISMATIC
    number = format_number if is_prismatic else angle_code
    said = [number(value) for value in (row.d if is_prismatic else row.theta, row.offset) if value]
    if not said:
        return None
    value = " + ".join(said)
    return f"[0, 0, {value}, 0]" if is_prismatic else f"[0, 0, 0, {value}]"


def _limits(row: DHRow) -> Iterator[str]:
    lower, upper = row.limits.lower, row.limits.upper
    if row.type is JointType.FIXED:
        return
    if (lower, upper) != (None, None) or row.type is JointType.CONTINUOUS:
        number = format_number if row.type is JointType.PRISMATIC else angle_code
        least = "-inf" if lower is None else number(lower)
        yield f"joint.PositionLimits = [{least}, {'inf' if upper is None else number(upper)}];"


def _mass(row: DHRow) -> Iterator[str]:
    """Mass properties as a rigidBody has them: the inertia tensor is about the origin of the body's frame."""
    if row.mass is None:
        return
    yield f"body.Mass = {format_number(row.mass)};"
    com = row.com or (0.0, 0.0, 0.0)
    yield f"body.CenterOfMass = [{' '.join(map(format_number, com))}];"
    if row.inertia is not None:
        yield f"body.Inertia = [{' '.join(map(format_number, _about_origin(row.inertia, row.mass, com)))}];"


def _about_origin(inertia: Inertia, mass: float, com: Vec3) -> tuple[float, ...]:
    """Ixx, Iyy, Izz, Iyz, Ixz and Ixy about the origin of the frame, by the theorem of parallel axes [kg·m²]."""
    x, y, z = com
    return (
        inertia.ixx + mass * (y * y + z * z),
        inertia.iyy + mass * (x * x + z * z),
        inertia.izz + mass * (x * x + y * y),
        inertia.iyz - mass * y * z,
        inertia.ixz - mass * x * z,
        inertia.ixy - mass * x * y,
    )


def _text(text: str) -> str:
    quoted = " ".join(text.split()).replace("'", "''")
    return f"'{quoted}'"


def left_out_of_matlab(arms: Sequence[Manipulator]) -> Iterator[Problem]:
    """What a rigidBodyTree has no place for, as notices."""
    yield from unsaid(arms, _UNHELD, "a rigidBodyTree")
