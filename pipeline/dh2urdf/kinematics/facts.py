"""What the axes of an arm declare about its kinematics: parallel axes, a spherical wrist, the parameters of an OPW arm.

OPW: an ortho-parallel basis with a spherical wrist, as most industrial arms of six joints have it (Brandstötter,
Angerer, Hofbaur: An analytical solution of the inverse kinematics problem of industrial serial manipulators with an
ortho-parallel basis and a spherical wrist, 2014). Solvers of that kind take a1, a2, b, c1 … c4, and for each joint an
offset and a sign: the angle of the model is sign·q − offset.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

from dh2urdf.kinematics.chain import Screw, angle_error, forward_kinematics, position_error, screws_of_table
from dh2urdf.manipulator import JointType
from dh2urdf.rotations import RigidTransform, Vec3, add, cross, dot, is_column, mapped, norm, scale, subtract, where

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.columns import ManipulatorColumns
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.rotations import Condition

ZERO_LENGTH, ZERO_ANGLE = 1e-9, 1e-9
"""What counts as no length [m] and no angle [rad]."""
_OPW_JOINTS = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class OpwParameters:
    """The parameters of an arm with an ortho-parallel basis and a spherical wrist."""

    a1: float  # from axis 1 to axis 2 [m]
    a2: float  # from axis 3 to axis 4, across [m]
    b: float  # from the plane of the arm to the wrist, sideways [m]
    c1: float  # height of axis 2 above the base link [m]
    c2: float  # from axis 2 to axis 3 [m]
    c3: float  # from axis 3 to the wrist's centre [m]
    c4: float  # from the wrist's centre to the tip [m]
    offsets: tuple[float, ...]  # of the joints [rad]
    signs: tuple[int, ...]  # of the joints, 1 or −1


@dataclass(frozen=True, slots=True, kw_only=True)
class KinematicFacts:
    """What the axes of an arm say."""

    parallel: tuple[tuple[str, ...], ...]  # runs of joints whose axes are parallel, by name
    spherical_wrist: tuple[str, ...]  # the last three joints, where their axes meet in one point
    opw: OpwParameters | None  # the parameters of an OPW arm; None for any other

    def sentences(self) -> list[str]:
        """The facts, each as a sentence without a full stop."""
        found = [f"the axes of {', '.join(names)} are parallel" for names in self.parallel]
        if self.spherical_wrist:
            found.append(f"spherical wrist: the axes of {', '.join(self.spherical_wrist)} meet in one point")
        if (opw := self.opw) is not None:
            lengths = [f"{name} = {getattr(opw, name):.6g}" for name in ("a1", "a2", "b", "c1", "c2", "c3", "c4")]
            offsets = ", ".join(f"{offset:.6g}" for offset in opw.offsets)
            signs = ", ".join(map(str, opw.signs))
            found.append(f"OPW arm: {', '.join(lengths)} [m], offsets = [{offsets}] [rad], signs = [{signs}]")
        return found


def kinematic_facts(arm: Manipulator) -> KinematicFacts:
    """The facts of an arm."""
    (facts,) = _facts(arm, 1, lambda places: [arm] * len(places))
    return facts


def kinematic_facts_of_columns(arms: ManipulatorColumns) -> list[KinematicFacts]:
    """The facts of each of many arms, as `kinematic_facts` finds them."""
    return _facts(arms.table, len(arms), arms.tables)


def _facts(
    table: Manipulator, count: int, tables_of: Callable[[Sequence[int]], Sequence[Manipulator]]
) -> list[KinematicFacts]:
    """The facts of so many arms: of one table, or of one in columns, some of whose arms are got by their places."""
    moving = table.moving_rows
    lines = screws_of_table(table)
    names = tuple([row.joint for row in moving])
    turning = [row.type in (JointType.REVOLUTE, JointType.CONTINUOUS) for row in moving]
    has_wrist: Condition = False
    if len(lines) > 2 and all(turning[-3:]) and not any(row.follows for row in moving[-3:]):  # noqa: PLR2004
        has_wrist, _ = _meeting(*lines[-3:])
    places = [place for place, has in enumerate(_entries(has_wrist, count)) if has]
    wrists = dict.fromkeys(places, names[-3:])
    opw: dict[int, OpwParameters | None] = {}
    if len(lines) == _OPW_JOINTS and all(turning) and not table.followers:
        opw.update(zip(places, map(_opw, tables_of(places)), strict=True))
    neighbours = [_entries(_are_parallel(*pair), count) for pair in pairwise(lines)]
    parallel = [_runs(names, each) for each in zip(*neighbours, strict=True)] or [()] * count
    return [
        KinematicFacts(parallel=parallel[place], spherical_wrist=wrists.get(place, ()), opw=opw.get(place))
        for place in range(count)
    ]


def _entries(condition: Condition, count: int) -> list[bool]:
    """A condition of each of some arms."""
    return condition.tolist() if is_column(condition) else [condition] * count


@lru_cache
def _runs(names: tuple[str, ...], parallel: tuple[bool, ...]) -> tuple[tuple[str, ...], ...]:
    """Runs of joints whose axes are parallel, given for each joint and the one after it whether theirs are."""
    runs = [[names[0]]]
    for name, is_parallel in zip(names[1:], parallel, strict=True):
        if is_parallel:
            runs[-1].append(name)
        else:
            runs.append([name])
    return tuple(tuple(run) for run in runs if len(run) > 1)


def _are_parallel(one: Screw, other: Screw) -> Condition:
    """Whether two lines are parallel; takes columns."""
    return norm(cross(one.direction, other.direction)) <= ZERO_ANGLE


def _crossing(one: Screw, other: Screw) -> tuple[Condition, Vec3]:
    """Whether two lines meet and are not parallel, and the point of the first where they do; takes columns."""
    normal = cross(one.direction, other.direction)
    square = dot(normal, normal)
    between = subtract(other.point, one.point)
    meet = (square > ZERO_ANGLE**2) & (abs(dot(between, normal)) <= ZERO_LENGTH * mapped(math.sqrt, square))
    along = dot(cross(between, other.direction), normal) / where(meet, square, 1.0)
    return meet, add(one.point, scale(along, one.direction))


def _meeting(first: Screw, second: Screw, third: Screw) -> tuple[Condition, Vec3]:
    """Whether three lines meet in one point, neighbours at an angle, and the point; takes columns."""
    (one_meets, point), (other_meets, other) = _crossing(first, second), _crossing(second, third)
    return one_meets & other_meets & (norm(subtract(point, other)) <= ZERO_LENGTH), point


def _opw(arm: Manipulator) -> OpwParameters | None:
    """The parameters of an arm; None for an arm of another kind, or with a tool beside axis 6."""
    found = _AtZero(arm).parameters()
    if found.c2 <= ZERO_LENGTH:  # Axes 2 and 3 are one line.
        return None
    for q in ((0.0,) * _OPW_JOINTS, (0.3, -0.8, 1.1, 0.6, -1.3, 2.0), (-1.9, 0.4, -0.7, -2.2, 0.9, -0.5)):
        one, other = forward_kinematics(arm, q), opw_pose(found, q)
        if not (position_error(one, other) <= 1e-8 and angle_error(one, other) <= 1e-8):  # noqa: PLR2004
            return None
    return found


class _AtZero:
    """An arm whose joints are turned to the zero of the model, one after the other from the base outwards.

    There axis 1 is along z, axes 2, 3 and 5 along y, axes 4 and 6 along z, and the arm points up. What comes of another
    kind of arm does not have its poses.
    """

    def __init__(self, arm: Manipulator) -> None:
        self._arm = arm
        self._q, self._signs = [0.0] * _OPW_JOINTS, [1] * _OPW_JOINTS

    def parameters(self) -> OpwParameters:
        """The parameters, if it is an OPW arm."""
        self._signs[0] = 1 if self._axis(1).direction[2] > 0 else -1
        self._turn_along_y(2)
        second, third = self._axis(2), self._axis(3)
        self._signs[2] = 1 if third.direction[1] > 0 else -1
        (a1, _, c1), (x, _, z) = second.point, third.point
        c2 = math.hypot(x - a1, z - c1)
        self._turn(2, -math.atan2(x - a1, z - c1))
        ux, _, uz = self._axis(4).direction
        self._turn(3, -math.atan2(ux, uz))
        x, y, z = self._wrist_centre()
        if z - (c1 + c2) < -ZERO_LENGTH:  # The forearm is up, whichever way axis 4 points.
            self._turn(3, math.pi)
            self._signs[3] = -1
            x, y, z = self._wrist_centre()
        self._turn_along_y(5)
        tip = forward_kinematics(self._arm, self._q).rotation
        self._turn(5, -math.atan2(tip[2], tip[8]))
        self._signs[5] = 1 if self._axis(6).direction[2] > 0 else -1
        tip = forward_kinematics(self._arm, self._q).rotation
        self._turn(6, -math.atan2(tip[3], tip[0]))
        c4 = forward_kinematics(self._arm, self._q).translation[2] - z
        offsets = [math.remainder(sign * value, math.tau) for sign, value in zip(self._signs, self._q, strict=True)]
        offsets = [0.0 if abs(offset) <= ZERO_ANGLE else offset for offset in offsets]
        lengths = {"a1": a1, "a2": x - a1, "b": y, "c1": c1, "c2": c2, "c3": z - c1 - c2, "c4": c4}
        return OpwParameters(**lengths, offsets=tuple(offsets), signs=tuple(self._signs))

    def _axis(self, joint: int) -> Screw:
        return screws_of_table(self._arm, self._q)[joint - 1]

    def _wrist_centre(self) -> Vec3:
        _, centre = _meeting(*screws_of_table(self._arm, self._q)[3:])
        return centre

    def _turn(self, joint: int, angle: float) -> None:
        """Turn a joint by an angle [rad] about its direction in the model."""
        place = joint - 1
        self._q[place] = math.remainder(self._q[place] + self._signs[place] * angle, math.tau)

    def _turn_along_y(self, joint: int) -> None:
        """Turn the joint before until an axis is along y, whichever way, by the smaller angle."""
        x, y, _ = self._axis(joint).direction
        sign = self._signs[joint - 1] = 1 if y >= -ZERO_ANGLE else -1
        self._turn(joint - 1, math.atan2(sign * x, sign * y))


def opw_pose(opw: OpwParameters, q: Sequence[float]) -> RigidTransform:
    """T(base_link → tip) by the model's own equations, at a value for each joint [rad]."""
    t1, t2, t3, t4, t5, t6 = (
        sign * value - offset for sign, value, offset in zip(opw.signs, q, opw.offsets, strict=True)
    )
    s1, c1, s23, c23 = math.sin(t1), math.cos(t1), math.sin(t2 + t3), math.cos(t2 + t3)
    s4, c4, s5, c5, s6, c6 = math.sin(t4), math.cos(t4), math.sin(t5), math.cos(t5), math.sin(t6), math.cos(t6)
    x = opw.a1 + opw.c2 * math.sin(t2) + opw.a2 * c23 + opw.c3 * s23
    z = opw.c1 + opw.c2 * math.cos(t2) - opw.a2 * s23 + opw.c3 * c23
    arm = RigidTransform(
        (c1 * c23, -s1, c1 * s23, s1 * c23, c1, s1 * s23, -s23, 0.0, c23), (c1 * x - s1 * opw.b, s1 * x + c1 * opw.b, z)
    )
    wrist = RigidTransform(
        (
            *(c4 * c5 * c6 - s4 * s6, -c4 * c5 * s6 - s4 * c6, c4 * s5),
            *(s4 * c5 * c6 + c4 * s6, -s4 * c5 * s6 + c4 * c6, s4 * s5),
            *(-s5 * c6, s5 * s6, c5),
        ),
        (opw.c4 * c4 * s5, opw.c4 * s4 * s5, opw.c4 * c5),
    )
    return arm @ wrist
