"""A robot description laid upon the arm of the table: how far the two are from each other, and taking its numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.errors import ConfigError, Dh2UrdfError
from dh2urdf.kinematics.chain import KinematicChain, angle_error, forward_kinematics, link_poses, position_error
from dh2urdf.kinematics.comparison import DECIMALS, POSES, TOLERANCE, Agreement, compare
from dh2urdf.kinematics.expected_poses import ExpectedPoses, proof_vectors
from dh2urdf.kinematics.screws import axis_error, screws_of_chain, screws_of_table
from dh2urdf.manipulator import Convention, JointType, Manipulator
from dh2urdf.quantities import number_in
from dh2urdf.quantities.units import UNITS
from dh2urdf.rotations import IDENTITY, RigidTransform
from dh2urdf.stage_calls.calls import default_call
from dh2urdf.table_text.texts import dimension_of, table_text, unit_of
from dh2urdf_studio.drawing.parts import BESIDE
from dh2urdf_studio.drawing.scene import Figure
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.reading import read_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.manipulator import DHRow
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.robot import Robot
    from dh2urdf.table_text import TableText

V = TypeVar("V")
NAME = "description/"
"""What stands before the names of the description's nodes and joints in the scene."""
_SAME = TOLERANCE / 10
"""Numbers that differ less [m] and [rad] are left as they are."""


class Apart(NamedTuple):
    """How far a joint axis, or the tip, is from where the table has it: a distance [m] and an angle [rad]."""

    distance: float
    angle: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Beside:
    """A description beside a table.

    Attributes:
        figure: the description as it is drawn, its base link where the table's is.
        agreement: what `dh2urdf.kinematics.comparison.compare` finds; None where the chain cannot be found.
        refusal: why it cannot.
        chain: its joints from the base link to the tip link; None where the two cannot be compared joint by joint.
        worst: the largest differences over the joint vectors of a proof: of each joint axis, and of the tip.
    """

    figure: Figure
    agreement: Agreement | None = None
    refusal: str = ""
    chain: KinematicChain | None = None
    worst: tuple[Apart, ...] = ()

    def named(self, values: Sequence[V]) -> dict[str, V]:
        """What belongs to the joints of the table in order, by the names of the description's joints in the scene."""
        if self.agreement is None or self.chain is None:
            return {}
        return {NAME + name: value for name, value in zip(self.agreement.joints, values, strict=True)}


def beside(figure: Figure, table: Manipulator, robot: Robot, *, base_link: str = "", tip_link: str = "") -> Beside:
    """Lay a description upon the arm of a table."""
    figure = replace(figure, name=NAME, tint=BESIDE, opacity=0.45, link_frames=False)
    try:
        agreement = compare(figure.robot, table, base_link=base_link or None, tip_link=tip_link or None)
    except ConfigError as error:
        return Beside(figure=figure, refusal="; ".join(problem.message for problem in error.problems))
    figure = replace(figure, place=link_poses(figure.robot, {})[agreement.base_link].inverse)
    if agreement.difference is None:
        return Beside(figure=figure, agreement=agreement)
    chain = KinematicChain.between(figure.robot, agreement.base_link, agreement.tip_link)
    every = [differences(chain, table, q) for q in proof_vectors(ExpectedPoses.of(table), robot, POSES)]
    worst = tuple(Apart(*map(max, zip(*of_one, strict=True))) for of_one in zip(*every, strict=True))
    return Beside(figure=figure, agreement=agreement, chain=chain, worst=worst)


def tip_error(robot: Robot, q: Mapping[str, float], pose: RigidTransform) -> tuple[float, float]:
    """How far the tip of a robot is from a pose in base_link, at joint values by name [m, rad]."""
    found = KinematicChain.between(robot).forward_kinematics([q.get(joint.name, 0.0) for joint in robot.moving_joints])
    return position_error(pose, found), angle_error(pose, found)


def differences(chain: KinematicChain, table: Manipulator, q: Sequence[float]) -> tuple[Apart, ...]:
    """How far the moving joints' axes of a description, and its tip, are from those of a table at a joint vector.

    A description places the frames of its links as it likes along the axes; so of a joint its axis is compared: the
    distance of the description's joint from the table's axis, and the angle between the two axes.
    """
    axes = zip(screws_of_chain(chain, q), screws_of_table(table, q), strict=True)
    found, wanted = chain.forward_kinematics(tuple(q)), forward_kinematics(table, q)
    tip = Apart(position_error(wanted, found), angle_error(wanted, found))
    return (*(Apart(*axis_error(one, other)) for one, other in axes), tip)


# --- Taking the numbers of a description: as few cells as make the two the same arm -----------------------------------


def own_table(path: Path, catalog: Catalog, like: Manipulator, ends: tuple[str, str]) -> Manipulator | None:
    """The table of the chain of a description between two links, in the convention of a table; None if it has none."""
    try:
        call = default_call(catalog, catalog.reader_for(path))
        chain = {"convention": str(like.convention), "base_link": ends[0], "tip_link": ends[1]}
        found = list(read_items(replace(call, options=replace(call.options, **chain)), path))
    except (Dh2UrdfError, TypeError):  # a reader without these options reads no chains
        return None
    return found[0] if len(found) == 1 and isinstance(found[0], Manipulator) else None


def adopted(
    table: TableText, arm: Manipulator, found: Beside, own: Manipulator | None, catalog: Catalog
) -> TableText | None:
    """The table with the numbers that make it the arm of a description; None where no table of these rows is.

    The numbers are those of the description's own table, or the base, tool, signs and offsets that the comparison has
    found: whichever are fewer. Every cell whose number is the same keeps its text.
    """
    agreement = found.agreement
    if agreement is None or found.chain is None:
        return None
    zero = found.chain.forward_kinematics((0.0,) * len(arm.moving_rows))
    right = []
    for wanted in (own, own and _in_these_rows(own, arm, zero), agreement.corrected):
        if wanted is None or _kinds(wanted) != _kinds(arm):
            continue
        changed = _with_numbers(table, arm, wanted)
        made = read_whole(changed, catalog).manipulator
        ends = {"base_link": agreement.base_link, "tip_link": agreement.tip_link}
        if made is not None and compare(found.figure.robot, made, **ends).holds:
            right.append(changed)
    return min(right, key=lambda each: changed_cells(table, each), default=None)


def changed_cells(table: TableText, other: TableText) -> int:
    """How many cells of a table are others, base and tool included."""
    rows = zip(table.rows, other.rows, strict=True)
    cells = sum(one.get(field, "") != row.get(field, "") for one, row in rows for field in {*one, *row})
    return cells + (table.base != other.base) + (table.tool != other.tool)


def _kinds(arm: Manipulator) -> tuple[Convention, list[tuple[bool, bool]]]:
    return arm.convention, [(row.type is JointType.FIXED, row.type is JointType.PRISMATIC) for row in arm.rows]


def _in_these_rows(own: Manipulator, arm: Manipulator, zero: RigidTransform) -> Manipulator | None:
    """A description's own table with the fixed rows of another one, and a tool that makes up for what that moves.

    What comes after the last axis is that of the other one too: it only moves the tool, which leads to tool0 where all
    joint values are 0.
    """
    if len(own.moving_rows) != len(arm.moving_rows):
        return None
    kept = ("a", "alpha", "d") if arm.convention is Convention.STANDARD else ("d",)
    new, rows = list(own.moving_rows), []
    new[-1:] = [replace(last, **{field: getattr(arm.moving_rows[-1], field) for field in kept}) for last in new[-1:]]
    for row in arm.rows:
        if row.type is not JointType.FIXED:
            moving = new.pop(0)
            numbers = ("a", "alpha", "d", "theta", "offset", "sign")
            row = replace(row, **{field: getattr(moving, field) for field in numbers})  # noqa: PLW2901 - the same row
        rows.append(row)
    bare = replace(arm, base=own.base, rows=tuple(rows), tool=IDENTITY)
    tool = forward_kinematics(bare, (0.0,) * len(arm.moving_rows)).inverse @ zero
    xyz, rpy = (tuple(round(number, DECIMALS) for number in each) for each in (tool.translation, tool.rpy))
    return replace(bare, tool=RigidTransform.from_xyz_rpy(xyz, rpy))  # type: ignore[arg-type]  # three of them


def _with_numbers(table: TableText, arm: Manipulator, wanted: Manipulator) -> TableText:
    pairs = enumerate(zip(arm.rows, wanted.rows, strict=True))
    cells = {(number, field): text for number, (row, new) in pairs for field, text in _cells(row, new, table)}
    texts = table_text(replace(arm, base=wanted.base, tool=wanted.tool), table.length_unit, table.angle_unit)
    ends = {
        name: getattr(texts, name)
        for name in ("base", "tool")
        if max(f(getattr(arm, name), getattr(wanted, name)) for f in (position_error, angle_error)) > _SAME
    }
    return replace(edits.with_cells(table, cells), **ends)


def _cells(row: DHRow, new: DHRow, table: TableText) -> Iterator[tuple[str, str]]:
    """The cells of a row that have other numbers, with their texts; an offset that is there is kept."""
    length, angle = UNITS[table.length_unit], UNITS[table.angle_unit]
    moved = "d" if row.type is JointType.PRISMATIC else "theta"
    for field in ("a", "alpha", "d", "theta"):
        before, value = getattr(row, field), getattr(new, field)
        if field == moved:
            value += new.offset - row.offset
        apart = math.remainder(value - before, math.tau) if field in ("alpha", "theta") else value - before
        dimension = dimension_of(field, row.type)
        if abs(apart) > _SAME and dimension is not None:
            yield field, number_in(value, unit_of(dimension, length, angle))
    if row.sign != new.sign:
        yield "sign", str(new.sign)
