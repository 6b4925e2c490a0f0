"""The manipulator of a chain: kinematics, limits, masses and meshes as a table has them, and what is left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.kinematics import dh_frames
from dh2urdf.manipulator import DHRow, JointType, Limits, Manipulator
from dh2urdf.robot_check import UNIT
from dh2urdf.rotations import norm, scale
from dh2urdf.source import Mark, Problem, listed, shown
from dh2urdf_plugins.descriptions.bodies import Body, Carried
from dh2urdf_plugins.extraction.chain import Precision
from dh2urdf_plugins.extraction.measuring import RANDOM_VECTORS, chain_difference
from dh2urdf_plugins.extraction.solving import Choices, Solution, solve
from dh2urdf_plugins.readers.words.names import RESERVED

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.robot import Joint
    from dh2urdf_plugins.descriptions.description import Description
    from dh2urdf_plugins.descriptions.trees import Tree
    from dh2urdf_plugins.extraction.splitting import NearlyParallel

_FEW = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What is asked of a description.

    Attributes:
        choices: of the table.
        name: the manipulator's name.
        find: the file that an address of a mesh means.
        repair: whether rounded parts of π are read as they were meant.
    """

    choices: Choices
    name: str
    find: Callable[[str], Path | None]
    repair: bool


def manipulator_of(description: Description, tree: Tree, tip: str, asked: Asked) -> Manipulator:
    """The manipulator of the chain to a tip link.

    Args:
        description: the file.
        tree: its links and joints, with the parts of π as they are to be read.
        tip: the tip link.
        asked: what is asked for.

    Raises:
        TableError: the chain is none of an arm, or no table of it is within the tolerance.
    """
    raw = tree.chain(tip)
    chain = tuple(map(_with_unit_axis, raw))
    solution = solve(chain, asked.choices)
    about = _About(description.file, asked.name)
    if not solution.difference.largest <= asked.choices.tolerance:
        raise TableError(about.too_far(solution, asked.choices))
    carried = Carried(tree, chain, asked.find)
    notices = [about.proved(tree, tip, solution)]
    notices += about.rounded(description, tip, tree, repaired=asked.repair)
    notices += map(about.nearly_parallel, solution.nearly_parallel)
    notices += about.left_out(carried, description)
    notices += about.axes(raw)
    precision = Precision.of(asked.choices.tolerance, solution.length)
    rows, row_notices = _rows(solution, chain, carried, about, precision)
    base = carried.body(0, solution.table.base, precision)
    lost = [*about.lost(carried, base), *about.weightless(rows)]
    try:
        return Manipulator(
            name=asked.name,
            convention=solution.table.convention,
            rows=rows,
            base=solution.table.base,
            tool=solution.table.tool,
            base_mass=base.mass,
            base_visual=base.visual,
            base_collision=base.collision,
            mark=Mark(file=description.file),
            notices=(*description.notices, *notices, *row_notices, *lost, *description.unheld),
        )
    except TableError as error:
        raise TableError(problem.about(mark=Mark(file=description.file)) for problem in error.problems) from error


def _with_unit_axis(joint: Joint) -> Joint:
    if joint.type is JointType.FIXED or (length := norm(joint.axis)) == 1.0:
        return joint
    return replace(joint, axis=scale(1.0 / length, joint.axis))


# Rows.


def _rows(
    solution: Solution, chain: Sequence[Joint], carried: Carried, about: _About, precision: Precision
) -> tuple[tuple[DHRow, ...], list[Problem]]:
    """The rows with all that goes with them."""
    moving = {joint.name: joint for joint in chain if joint.type is not JointType.FIXED}
    frames = dh_frames(solution.table, (0.0,) * len(moving))
    names = _Names(moving.values())
    rows: list[DHRow] = []
    segment, unlimited = 0, dict[str, list[str]]()
    for row, frame in zip(solution.table.rows, frames[1:], strict=True):
        if row.type is JointType.FIXED:
            rows.append(
                replace(row, joint=names.fresh(row.joint), link=names.fresh(f"{rows[-1].link}_split"), mass=0.0)
            )
            continue
        segment += 1
        joint = moving[row.joint]
        body = carried.body(segment, frame, precision)
        limits = _limits(joint, unlimited)
        if limits.lower is not None and limits.upper is not None and limits.lower > limits.upper:
            raise TableError(about.reversed_limits(joint))
        rows.append(_full(row, joint, names.of(joint), body, limits))
    return tuple(rows), [*about.values(unlimited), *names.notices(about)]


def _full(row: DHRow, joint: Joint, names: tuple[str, str], body: Body, limits: Limits) -> DHRow:
    return replace(
        row,
        joint=names[0],
        link=names[1],
        limits=limits,
        mass=body.mass,
        com=body.com,
        inertia=body.inertia,
        damping=_not_negative(joint.damping),
        friction=_not_negative(joint.friction),
        armature=_not_negative(joint.armature),
        visual=body.visual,
        collision=body.collision,
        mark=joint.mark,
    )


def _not_negative(value: float | None) -> float | None:
    return value if value is None or value >= 0.0 else None


def _limits(joint: Joint, left_out: dict[str, list[str]]) -> Limits:
    """The limits of a joint as far as a table has them; what is left out goes by its text to the names of joints."""
    given = joint.limits
    lower, upper = given.lower, given.upper
    if joint.type is JointType.CONTINUOUS:
        lower = upper = None
    elif (lower is None) is not (upper is None):  # URDF: what is not written is 0
        lower, upper = lower or 0.0, upper or 0.0
    kept: dict[str, float | None] = {"velocity": given.velocity, "effort": given.effort}
    for name, value in kept.items():
        if value is not None and value <= 0.0:
            left_out.setdefault(f"{name} {value:.9g}", []).append(joint.name)
            kept[name] = None
    return Limits(lower=lower, upper=upper, **kept)


class _Names:
    """Names of joints and links, which share one set in a table, with those that every description of ours has."""

    def __init__(self, moving: Iterable[Joint]) -> None:
        self._taken = {*RESERVED, *(joint.name for joint in moving)}
        self._renamed: dict[str, str] = {}

    def of(self, joint: Joint) -> tuple[str, str]:
        """The names of a joint and of the link that it moves."""
        name = joint.name
        if name in RESERVED:
            name = self._renamed[joint.name] = self.fresh(f"{name}_joint")
        link = self.fresh(joint.child, "_link")
        if link != joint.child:
            self._renamed[joint.child] = link
        return name, link

    def fresh(self, name: str, ending: str = "_") -> str:
        """A name that nothing has."""
        while name in self._taken:
            name += ending
        self._taken.add(name)
        return name

    def notices(self, about: _About) -> Iterator[Problem]:
        """What was renamed."""
        if self._renamed:
            pairs = [f"{shown(old)} is {shown(new)}" for old, new in self._renamed.items()]
            message = f"names that joints, links or every written description have already: {listed(pairs, _FEW)}"
            yield about.notice(message)


# The facts about the robot.


@dataclass(frozen=True, slots=True)
class _About:
    """The words about a manipulator."""

    file: str
    name: str

    def notice(self, message: str, *, field: str | None = None, suggestion: str | None = None) -> Problem:
        """A notice of the manipulator."""
        mark = Mark(file=self.file)
        return Problem(
            message=message, severity="notice", mark=mark, robot=self.name, field=field, suggestion=suggestion
        )

    def proved(self, tree: Tree, tip: str, solution: Solution) -> Problem:
        """Which chain it is, and how far the table is from it."""
        position, angle = solution.difference
        return self.notice(
            f"the table is the chain from {shown(tree.base)} to {shown(tip)}: its tip is within {position:.2g} m and "
            f"{angle:.2g} rad of the file's at {RANDOM_VECTORS + 1} joint vectors"
        )

    def too_far(self, solution: Solution, choices: Choices) -> Problem:
        """That no table is within the tolerance."""
        position, angle = solution.difference
        return Problem(
            message=f"the table is {position:.2g} m and {angle:.2g} rad from the file's chain, and the tolerance is "
            f"{choices.tolerance:.2g}",
            mark=Mark(file=self.file),
            robot=self.name,
            field="tolerance",
            found=f"{choices.tolerance:.9g}",
            accepted=f"a tolerance above {max(position, angle):.2g}: doubles hold no table that is nearer",
            suggestion="the option near_parallel: split keeps numbers of the arm's own size"
            if any(not pair.split for pair in solution.nearly_parallel)
            else None,
        )

    def rounded(self, description: Description, tip: str, tree: Tree, *, repaired: bool) -> Iterator[Problem]:
        """The numbers that were meant to be parts of π, and what they do to the tip."""
        if not description.rounded or description.repaired is None:
            return
        above = {joint.child: joint for joint in reversed(description.repaired.joints)}
        other = replace(tree, above=above).chain(tip)
        difference = chain_difference(*(tuple(map(_with_unit_axis, joints)) for joints in (tree.chain(tip), other)))
        first = description.rounded[0]
        lines = list(dict.fromkeys(str(each.line) for each in description.rounded if each.line))
        places = len(description.rounded)
        where = f" (line{'s' if len(lines) > 1 else ''} {listed(lines, _FEW)})" if lines else ""
        count = f"{places} place{'s' if places > 1 else ''}{where}"
        others = "" if all(each.text == first.text for each in description.rounded) else " and the like"
        if repaired:
            yield self.notice(
                f"{first.text} was read as {first.word}{others} in {count}: the tip differs from the file's by up to "
                f"{difference.position:.2g} m and {difference.angle:.2g} rad",
                field="rounded_pi",
            )
        elif difference.largest > 1e-10:  # noqa: PLR2004 - below, the table has the part of π anyhow
            yield self.notice(
                f"{first.text} stands for {first.word}{others} in {count}, and is kept as it is written",
                field="rounded_pi",
                suggestion="the option rounded_pi: repair reads it so, the tip then differs by up to "
                f"{difference.position:.2g} m",
            )

    def nearly_parallel(self, pair: NearlyParallel) -> Problem:
        """Two axes that are nearly parallel."""
        axes = f"joints {shown(pair.first)} and {shown(pair.second)} are {pair.angle:.2g} rad from parallel"
        if pair.split:
            return self.notice(
                f"{axes}: a fixed row is between them, in place of a d of {pair.far:.3g} m", field="near_parallel"
            )
        return self.notice(
            f"{axes}: d reaches {pair.far:.3g} m",
            field="near_parallel",
            suggestion="the option near_parallel: split writes a fixed row in its place",
        )

    def left_out(self, carried: Carried, description: Description) -> Iterator[Problem]:
        """Joints that are no part of the chain."""
        if carried.left_out:
            names = listed([shown(name) for name in carried.left_out], _FEW)
            yield self.notice(f"joints that leave the chain are left out, their links as they are at 0: {names}")
        followers = [name for name in description.followers if name in carried.left_out]
        if followers:
            yield self.notice(
                f"joints that mimic others are among them: {listed([shown(name) for name in followers], _FEW)}"
            )

    def axes(self, chain: Sequence[Joint]) -> Iterator[Problem]:
        """Axes that are no unit vectors."""
        names = [
            shown(joint.name)
            for joint in chain
            if joint.type is not JointType.FIXED and abs(norm(joint.axis) - 1.0) > UNIT
        ]
        if names:
            yield self.notice(
                f"the axes of {listed(names, _FEW)} have another length than 1: their directions are taken"
            )

    def values(self, left_out: dict[str, list[str]]) -> Iterator[Problem]:
        """Limits that no joint can have."""
        for text, names in left_out.items():
            yield self.notice(
                f"{text} stands for an unknown one and is left out: {listed([shown(name) for name in names], _FEW)}",
                field=f"limits.{text.partition(' ')[0]}",
            )

    def reversed_limits(self, joint: Joint) -> Problem:
        """Limits that leave a joint no value."""
        limits = joint.limits
        return Problem(
            message=f"lower, {limits.lower:.12g}, is above upper, {limits.upper:.12g}",
            mark=joint.mark or Mark(file=self.file),
            robot=self.name,
            joint=joint.name,
            field="limits.lower",
            accepted="lower at most upper",
        )

    def weightless(self, rows: Sequence[DHRow]) -> Iterator[Problem]:
        """Links without a mass beside others that have one: no row that moves has the mass 0."""
        names = [shown(row.link) for row in rows if row.mass is None]
        if names and any(row.mass for row in rows):
            yield self.notice(
                f"the file has no mass for {listed(names, _FEW)}, and has one for other links: the table has none, and "
                "robots that are made of it have the mass of a drawn shape there",
                field="mass",
                suggestion="write a mass into the rows: a small one if the link has no body",
            )

    def lost(self, carried: Carried, base: Body) -> Iterator[Problem]:
        """What a table has no place for."""
        if base.mass:
            yield self.notice("the base keeps its mass, and not its centre of mass and inertia", field="base.mass")
        for sentence in carried.lost:
            yield self.notice(f"the table leaves out {sentence}")
