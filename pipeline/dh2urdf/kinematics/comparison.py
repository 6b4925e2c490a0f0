"""Whether a robot description is the arm of a table; and where it is not, what would make it so."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

from dh2urdf.errors import ConfigError
from dh2urdf.kinematics.chain import (
    KinematicChain,
    angle_error,
    forward_kinematics,
    position_error,
    screws_of_chain,
    screws_of_table,
)
from dh2urdf.kinematics.screws import Mismatch, align
from dh2urdf.manipulator import FLANGE, TOOL, Convention, Follower, JointType, Manipulator
from dh2urdf.quantities.number_text import format_number, number_in
from dh2urdf.quantities.units import UNITS
from dh2urdf.rotations import HALF_PI, IDENTITY, RigidTransform, Vec3
from dh2urdf.source import Mark, Messages, did_you_mean, shown
from dh2urdf.table_text.texts import law_text

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from dh2urdf.kinematics.screws import Alignment
    from dh2urdf.manipulator import DHRow
    from dh2urdf.robot import Joint, Robot

say = Messages(__file__)

TOLERANCE = 1e-6
"""What two arms may differ that are the same [m] and [rad]: what files lose that round their numbers to ten digits."""
NEAR = 5e-3
"""What the axes of two arms may differ that are nearly the same [m] and [rad]."""
POSES = 32
"""Random joint vectors at which poses are compared, besides zero."""
USUAL_TIPS = (TOOL, "tcp", FLANGE, "ee_link")
"""Links that are the tip of an arm where a description has them, the likeliest first."""
_PREFIXED_TIPS = ("_" + TOOL, "_tcp")
"""What the names of such links end with where arms have prefixes, the likeliest first."""

DECIMALS = 12
"""Decimals of numbers that are computed of a description [m or rad]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """How far two arms are from each other."""

    position_error: float  # largest distance of the tips [m]
    angle_error: float  # largest angle between them [rad]
    q: tuple[float, ...]  # the description's joint vector at the largest distance [rad or m]

    @property
    def is_none(self) -> bool:
        """Whether they are the same arm."""
        return max(self.position_error, self.angle_error) <= TOLERANCE


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """What came of laying a robot description beside a table."""

    base_link: str  # where the description's chain begins
    tip_link: str  # where it ends
    joints: tuple[str, ...]  # its moving joints
    # how far the two are from each other as they stand; None where they cannot be compared
    difference: Difference | None
    # the table with the base, tool, signs and offsets that make them the same arm, or nearly so; None where there is no
    # such table, or none is needed
    corrected: Manipulator | None = None
    remaining: Difference | None = None  # how far they are from each other then
    first_difference: str | None = None  # why there is no such table: where they part, as a sentence

    @property
    def holds(self) -> bool:
        """Whether the description is the arm of the table as it stands."""
        return self.difference is not None and self.difference.is_none


def compare(
    robot: Robot, manipulator: Manipulator, *, base_link: str | None = None, tip_link: str | None = None
) -> Agreement:
    """Compare the kinematics of a description with those of a table, joint by joint in order.

    The chain begins at the root where no base link is named. Where no tip is, it ends at a link with a usual name, or
    at the last one behind as many moving joints as the table has.

    Raises:
        ConfigError: the description has no such link, or no chain between the two.
    """
    base = _link(robot, base_link, "--base-link") if base_link else robot.root
    tip = _link(robot, tip_link, "--tip-link") if tip_link else _tip(robot, base, len(manipulator.moving_rows))
    try:
        chain = KinematicChain.between(robot, base, tip)
    except ValueError as error:
        raise ConfigError(say("ends-without-chain", reason=error)) from None
    names = tuple(joint.name for joint in chain.moving)
    result = Agreement(base_link=base, tip_link=tip, joints=names, difference=None)
    if apart := _other_joints(chain, manipulator.moving_rows):
        return replace(result, first_difference=apart)
    own, given = dict(zip([row.joint for row in manipulator.moving_rows], names, strict=True)), manipulator.followers
    wanted = {own[name]: law._replace(leader=own[law.leader]) for name, law in given.items()}
    laws = {name: law for name, law in chain.followers.items() if name in names}
    if apart := _other_laws(names, laws, wanted, math.inf):
        return replace(result, first_difference=apart)
    # Where joints stand is seen if each moves by itself; with signs and offsets of its own, a table has other laws.
    chain = KinematicChain.of(chain.joints)
    manipulator = replace(manipulator, rows=tuple(replace(row, follows=None) for row in manipulator.rows))
    difference = _difference(chain, manipulator)
    if difference.is_none:
        apart = _other_laws(names, laws, wanted, TOLERANCE)
        return replace(result, first_difference=apart) if apart else replace(result, difference=difference)
    result = replace(result, difference=difference)
    found = _with_correction(result, chain, manipulator)
    if found.corrected and laws:
        of_table = {name: joint for joint, name in own.items()}
        told = {of_table[name]: law._replace(leader=of_table[law.leader]) for name, law in laws.items()}
        rows = tuple(replace(row, follows=told.get(row.joint)) for row in found.corrected.rows)
        found = replace(found, corrected=replace(found.corrected, rows=rows))
    if found.first_difference is None or not (meant := _read_otherwise(chain, manipulator)):
        return found
    return replace(found, first_difference=f"{found.first_difference}; {meant}")


# Which chain.


def usual_tips(names: Collection[str]) -> list[str]:
    """The links that are usually meant by the tip of an arm: the one of the likeliest name, else all of one ending.

    The tip of an arm with a prefix, such as ``left_tool0``, counts where no link has a name of `USUAL_TIPS` as it
    stands.
    """
    if (whole := next((name for name in USUAL_TIPS if name in names), None)) is not None:
        return [whole]
    endings = ([name for name in names if name.endswith(ending)] for ending in _PREFIXED_TIPS)
    return next(filter(None, endings), [])


def _link(robot: Robot, name: str, option: str) -> str:
    names = [link.name for link in robot.links]
    if name not in names:
        mark, near = Mark(file="command line"), did_you_mean(name, names)
        raise ConfigError(say("link-unknown", mark, field=option, found=name, names=names[:20], suggestion=near))
    return name


def _tip(robot: Robot, base: str, moving: int) -> str:
    """The likeliest tip: a usual name, else the last link, of those behind as many moving joints as are wanted."""
    count = {base: 0}
    below: dict[str, list[Joint]] = {}
    for joint in robot.joints:
        below.setdefault(joint.parent, []).append(joint)
    for name in (order := [base]):
        for joint in below.get(name, ()):
            if joint.child not in count:
                count[joint.child] = count[name] + (joint.type is not JointType.FIXED)
                order.append(joint.child)
    wanted = min(count.values(), key=lambda number: (abs(number - moving), number))
    fitting = [name for name in order if count[name] == wanted]
    usual = usual_tips(fitting)
    return usual[0] if len(usual) == 1 else fitting[-1]


def _other_joints(chain: KinematicChain, rows: Sequence[DHRow]) -> str | None:
    """Why the two cannot be compared joint by joint."""
    joints = chain.moving
    if len(joints) != len(rows):
        return f"the description has {len(joints)} moving joints on this chain, the table {len(rows)}"
    for number, (joint, row) in enumerate(zip(joints, rows, strict=True), start=1):
        if (joint.type is JointType.PRISMATIC) != (row.type is JointType.PRISMATIC):
            types = f"{joint.type} in the description and {row.type} in the table"
            return f"joint {number}, {shown(joint.name)}, is {types}"
    return None


def _other_laws(
    names: Sequence[str], laws: Mapping[str, Follower], wanted: Mapping[str, Follower], tolerance: float
) -> str | None:
    """Which joint follows another one, or by other numbers, than the table says."""
    for number, name in enumerate(names, start=1):
        both = [each.get(name, Follower(name)) for each in (laws, wanted)]
        gap = math.dist(both[0][1:3], both[1][1:3])
        if both[0].leader != both[1].leader or both[0].higher or gap > tolerance:
            texts = [law_text(law, f"{law.offset:.9g}") if law.leader != name else "none" for law in both]
            return f"joint {number}, {shown(name)}, follows {texts[0]} in the description and {texts[1]} in the table"
    return None


# How far apart.


def _difference(chain: KinematicChain, manipulator: Manipulator) -> Difference:
    """The difference at zero and at random joint vectors: limits do not matter where two chains are the same."""
    draw = random.Random(f"dh2urdf {manipulator.name}")  # noqa: S311 - reproducible on purpose
    sizes = [1.0 if joint.type is JointType.PRISMATIC else math.pi for joint in chain.moving]
    vectors = [tuple(draw.uniform(-1.0, 1.0) * size for size in sizes) for _ in range(POSES)]
    errors = [
        (position_error(one, other), angle_error(one, other), q)
        for q in [(0.0,) * len(sizes), *vectors]
        for one, other in [(chain.forward_kinematics(q), forward_kinematics(manipulator, q))]
    ]
    position, _, q = max(errors, key=lambda error: error[:2])
    return Difference(position_error=position, angle_error=max(angle for _, angle, _ in errors), q=q)


# What would make them agree.


def _with_correction(result: Agreement, chain: KinematicChain, manipulator: Manipulator) -> Agreement:
    (wanted, zero), given = screws_of_chain(chain), screws_of_table(manipulator)
    found, apart = align(wanted, given, TOLERANCE), None
    if isinstance(found, Mismatch):
        joint = f"joint {found.joint + 1}, {shown(chain.moving[found.joint].name)}"
        how = f"stands elsewhere, by {found.distance:.3g} m"
        if found.angle > TOLERANCE:
            how = f"has another direction, by {found.angle:.3g} rad"
        apart = f"they part at {joint}: to the joints before, its axis {how}"
        found = align(wanted, given, NEAR)
    if isinstance(found, Mismatch):
        return replace(result, first_difference=apart)
    candidates = [_corrected(manipulator, alignment, zero) for alignment in found]
    corrected = min(candidates, key=lambda candidate: len(changes(manipulator, candidate)))
    return replace(result, corrected=corrected, remaining=_difference(chain, corrected), first_difference=apart)


_FACTORS = (1.0, 0.001, 0.01, 0.0254, 0.1, 10.0, 25.4, 100.0, 1000.0, 1 / 0.0254, 1 / 25.4)
"""What lengths of a table are times where they were read in another unit than theirs."""
_TURNS = ((1.0, ""), (math.pi / 180, "angles in degrees"), (180 / math.pi, "angles in rad"))


def _read_otherwise(chain: KinematicChain, manipulator: Manipulator) -> str | None:
    """In which other convention or units the table would be the arm of the description; None where in none."""
    wanted, zero = screws_of_chain(chain)
    conventions = sorted(Convention, key=lambda each: each is not manipulator.convention)
    for convention, factor, (turn, angles) in product(conventions, _FACTORS, _TURNS):
        rows = []
        for row in manipulator.rows:
            offset = row.offset * (factor if row.type is JointType.PRISMATIC else turn)
            row = replace(row, a=row.a * factor, d=row.d * factor, offset=offset)  # noqa: PLW2901 - as it is read
            rows.append(replace(row, alpha=row.alpha * turn, theta=row.theta * turn))
        other = replace(manipulator, convention=convention, rows=tuple(rows))
        if other == manipulator or isinstance(aligned := align(wanted, screws_of_table(other), TOLERANCE), Mismatch):
            continue
        said = [f"the {convention} convention"] if convention is not manipulator.convention else []
        said += [f"lengths times {factor:.4g}"] if factor != 1.0 else []
        said += [angles] if angles else []
        needed = min(len(changes(other, _corrected(other, alignment, zero))) for alignment in aligned)
        more = ", with another base, tool, sign or offset" if needed else ""
        return f"read with {' and '.join(said)}, the table is the arm of the description{more}"
    return None


def _corrected(manipulator: Manipulator, alignment: Alignment, zero: RigidTransform) -> Manipulator:
    """The table with a base, signs and offsets of an alignment, and with the tool that makes the poses at zero one."""
    base = _rounded(RigidTransform(alignment.rotation, alignment.translation) @ manipulator.base)
    moved = iter(zip(alignment.signs, alignment.offsets, strict=True))
    rows = list(manipulator.rows)
    for index, row in enumerate(rows):
        if row.type is not JointType.FIXED:
            sign, offset = next(moved)
            turns, turned = row.type is not JointType.PRISMATIC, row.offset + row.sign * offset
            turned = _number(math.remainder(turned, math.tau) if turns else turned, is_angle=turns)
            rows[index] = replace(row, sign=row.sign * sign, offset=turned)
    bare = replace(manipulator, base=base, rows=tuple(rows), tool=IDENTITY)
    reached = forward_kinematics(bare, (0.0,) * len(bare.actuated_rows))
    return replace(bare, tool=_rounded(reached.inverse @ zero))


def _rounded(pose: RigidTransform) -> RigidTransform:
    x, y, z = (_number(value) for value in pose.translation)
    roll, pitch, yaw = (_number(value, is_angle=True) for value in pose.rpy)
    return RigidTransform.from_xyz_rpy((x, y, z), (roll, pitch, yaw))


def _number(value: float, *, is_angle: bool = False) -> float:
    """A number without the rounding of what it was computed from; an angle near a quarter turn is one."""
    if is_angle and abs(value - (turns := round(value / HALF_PI)) * HALF_PI) <= TOLERANCE / 10:
        value = turns * HALF_PI
        return value + 0.0 if value != -math.pi else math.pi
    return round(value, DECIMALS) + 0.0


def changes(manipulator: Manipulator, corrected: Manipulator) -> tuple[str, ...]:
    """What a corrected table says otherwise, a text each that can be in a table: base, tool, signs, offsets."""
    found = [
        f"{name}: {{xyz: [{_vector(new.translation)}], rpy: [{_vector(new.rpy, is_angle=True)}]}}"
        for name, old, new in (("base", manipulator.base, corrected.base), ("tool", manipulator.tool, corrected.tool))
        if max(position_error(old, new), angle_error(old, new)) > TOLERANCE / 10
    ]
    laws, old_laws = corrected.followers, manipulator.followers
    for old_row, row in zip(manipulator.rows, corrected.rows, strict=True):
        cells = [f"sign: {row.sign}"] if row.sign != old_row.sign else []
        is_angle = row.type is not JointType.PRISMATIC
        law, old = laws.get(row.joint), old_laws.get(row.joint)
        if law and old and math.dist(law[1:3], old[1:3]) > TOLERANCE / 10:
            cells.append(f"follows: {law_text(law, number_text(law.offset, is_angle=is_angle))}")
        if abs(row.offset - old_row.offset) > TOLERANCE / 10:
            cells.append(f"offset: {number_text(row.offset, is_angle=is_angle)}")
        if cells:
            found.append(f"joint {row.joint}: {', '.join(cells)}")
    return tuple(found)


def _vector(vector: Vec3, *, is_angle: bool = False) -> str:
    return ", ".join(number_text(_number(value, is_angle=is_angle), is_angle=is_angle) for value in vector)


def number_text(value: float, *, is_angle: bool = False) -> str:
    """A number as a table may say it: angles as parts of pi where they are."""
    return number_in(value, UNITS["rad"]) if is_angle else format_number(value)
