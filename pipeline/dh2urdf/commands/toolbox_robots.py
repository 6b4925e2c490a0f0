"""Robots of the Robotics Toolbox for Python as tables.

Nothing of the toolbox is imported: what counts are the attributes of `DHRobot` and `DHLink`, as its version 1.5
documents them (P. Corke and J. Haviland, "Not your grandmother's toolbox", ICRA 2021).
"""

from __future__ import annotations

import math
from typing import Any, get_args

from dh2urdf.errors import ProofError, TableError
from dh2urdf.kinematics.chain import angle_error, forward_kinematics, position_error
from dh2urdf.kinematics.mass import Inertias, possible_inertia
from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.plugin_system.calls import warn_of
from dh2urdf.rotations import IDENTITY, RigidTransform, nearest_rotation
from dh2urdf.source import Messages, Problem

say = Messages(__file__)

_SAME = 1e-9  # how far T(q) of the table may be from the robot's own [m, rad]
_NEEDED = ("a", "alpha", "d", "theta", "offset", "isrevolute", "isprismatic", "mdh")
_POSES = (0.0, 0.7, -1.3)


def from_roboticstoolbox(
    robot: Any,  # noqa: ANN401 - a class of another package
    *,
    name: str | None = None,
    inertias: Inertias = "repair",
) -> Manipulator:
    """The table of a `DHRobot` of the Robotics Toolbox for Python.

    ::

        from roboticstoolbox.models.DH import Panda

        arm = dh2urdf.from_roboticstoolbox(Panda())
        dh2urdf.convert(arm, "panda.urdf")

    Joint values mean the same: T(q) of the table is compared with ``robot.fkine(q)``. Limits, masses, centres of mass
    and inertias go to the rows; friction and the inertia of a motor as the joint feels them, behind its gear ratio G:
    B·G², |Tc|·|G| and Jm·G². A mass of 0, which is that of a link of unknown mass, is left out.

    Args:
        robot: a `DHRobot`, standard or modified, lengths in m.
        name: the name of the manipulator; that of the robot without it.
        inertias: what becomes of inertias that no body has, as the toolbox has them of its Puma 560: ``repair`` takes
            the nearest that a body can have, ``recompute`` that of the drawn shape, ``keep`` leaves them to `convert`.

    Returns:
        The manipulator. Its notices, which are also given as `TableWarning`, say what has no place in a table.

    Raises:
        TableError: the robot has no DH links, or links of both conventions, or a number of it is wrong; or `inertias`
            is none of its three words.
        ProofError: T(q) of the table is not the robot's.
    """
    links = list(getattr(robot, "links", ()))
    kinds = {bool(link.mdh) for link in links if hasattr(link, "mdh")}
    if not links or not all(hasattr(link, each) for link in links for each in _NEEDED):
        raise _error("toolbox-no-robot")
    if inertias not in get_args(Inertias):
        raise _error("toolbox-inertias-unknown", found=inertias, choices=get_args(Inertias))
    if len(kinds) > 1:
        raise _error("toolbox-two-conventions")
    names = [str(getattr(link, "name", "") or "") for link in links]
    if len(set(names)) < len(names) or not all(names):  # They have no names of their own.
        names = [f"link_{number}" for number in range(1, len(links) + 1)]
    notices: list[Problem] = []
    rows = tuple(_row(link, number, names[number], inertias, notices) for number, link in enumerate(links))
    arm = Manipulator(
        name=name or str(getattr(robot, "name", "") or "robot"),
        convention=Convention.MODIFIED if kinds == {True} else Convention.STANDARD,
        rows=rows,
        base=_pose(robot, "base"),
        tool=_pose(robot, "tool"),
        notices=tuple(notices),
    )
    for value in _POSES:
        q = [value * (1.0 + 0.1 * number) for number in range(len(rows))]
        theirs, ours = _transform(robot.fkine(q)), forward_kinematics(arm, q)
        far = max(position_error(ours, theirs), angle_error(ours, theirs))
        if not far <= _SAME * max(1.0, *map(abs, theirs.translation)):
            raise ProofError(say("toolbox-robot-differs", robot=arm.name, far=far, q=q))
    warn_of(arm.notices)
    return arm


def _row(link: Any, number: int, name: str, how: Inertias, notices: list[Problem]) -> DHRow:  # noqa: ANN401
    """A row: the joint variable is ±q + offset, and takes the place of theta, or of d, of the link."""

    def given(attribute: str) -> float:
        return float(getattr(link, attribute, 0.0) or 0.0)

    def tell(code: str, field: str, **values: Any) -> None:  # noqa: ANN401 - of a message
        notices.append(say(code, joint=joint, field=field, **values))

    joint, slides, gear, mass = f"joint_{number + 1}", bool(link.isprismatic), given("G") or 1.0, given("m")
    bounds = [None, None] if getattr(link, "qlim", None) is None else _flat(link.qlim)
    lower, upper = (None if each is None or not math.isfinite(each) else each for each in bounds)
    ixx, ixy, ixz, _, iyy, iyz, _, _, izz = tensor = _flat(link.I)
    inertia = Inertia(ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz) if any(tensor) else None
    x, y, z = _flat(link.r)
    if not mass and (any((x, y, z)) or inertia):
        tell("toolbox-link-without-mass", "mass", number=number + 1)
    if mass and inertia:
        inertia, message = possible_inertia(inertia, how)
        if message:
            tell("toolbox-inertia", "inertia", reason=message)
    forward, backward = [0.0, 0.0] if getattr(link, "Tc", None) is None else _flat(link.Tc)
    if forward != -backward:
        tell("toolbox-friction", "friction", forward=forward, backward=backward, number=number + 1)
    return DHRow(
        joint=joint,
        link=name,
        type=JointType.PRISMATIC if slides else JointType.REVOLUTE,
        a=float(link.a),
        alpha=float(link.alpha),
        d=0.0 if slides else float(link.d),
        theta=float(link.theta) if slides else 0.0,
        offset=float(link.offset),
        sign=-1 if getattr(link, "isflip", getattr(link, "flip", False)) else 1,
        limits=Limits(lower=lower, upper=upper),
        mass=mass or None,
        com=(x, y, z) if mass else None,
        inertia=inertia if mass else None,
        damping=given("B") * gear**2 or None,
        friction=max(abs(forward), abs(backward)) * abs(gear) or None,
        armature=given("Jm") * gear**2 or None,
    )


def _pose(robot: Any, which: str) -> RigidTransform:  # noqa: ANN401 - of another package
    """The base or the tool: an SE3 or a matrix."""
    if (value := getattr(robot, which, None)) is None:
        return IDENTITY
    if len(_flat(getattr(value, "A", value))) != 16:  # noqa: PLR2004 - of a 4x4 matrix
        raise _error("toolbox-no-pose", which=which, value=value)
    pose = _transform(value)
    nearest, deviation = nearest_rotation(pose.rotation)
    if not deviation <= _SAME:
        raise _error("toolbox-no-rotation", which=which, deviation=deviation)
    return RigidTransform(nearest, pose.translation)


def _transform(pose: Any) -> RigidTransform:  # noqa: ANN401 - an SE3, whose matrix is its A, or a matrix
    a, b, c, x, d, e, f, y, g, h, i, z, *_ = _flat(getattr(pose, "A", pose))
    return RigidTransform((a, b, c, d, e, f, g, h, i), (x, y, z))


def _flat(values: Any) -> list[float]:  # noqa: ANN401 - an array of any form
    import numpy as np

    flat: list[float] = np.asarray(values, dtype=float).ravel().tolist()
    return flat


def _error(code: str, **values: Any) -> TableError:  # noqa: ANN401 - of a message
    return TableError(say(code, function="from_roboticstoolbox()", **values))
