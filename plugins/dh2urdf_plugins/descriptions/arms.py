"""The manipulator of a chain: kinematics, limits, masses and meshes as a table has them, and what is left out."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import BOUNDS, DYNAMICS, LIMITS
from dh2urdf.errors import TableError
from dh2urdf.kinematics import dh_frames
from dh2urdf.manipulator import DHRow, Follower, JointType, Limits, Manipulator
from dh2urdf.robot_check import UNIT
from dh2urdf.rotations import norm, scale
from dh2urdf.source import Mark, Messages, Problem, free_name, listed, shown
from dh2urdf_plugins.descriptions.bodies import Carried
from dh2urdf_plugins.extraction.chain import Precision
from dh2urdf_plugins.extraction.solving import RANDOM_VECTORS, Choices, Solution, chain_difference, solve
from dh2urdf_plugins.readers.words.names import RESERVED

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.robot import Joint
    from dh2urdf_plugins.descriptions.description import Description
    from dh2urdf_plugins.descriptions.trees import Tree

say = Messages(__file__)

_FEW = 6


def manipulator_of(
    tree: Tree, tip: str, name: str, choices: Choices, find: Callable[[str], Path | None], *, repair: bool
) -> Manipulator:
    """The manipulator, under a name, of the chain from the base link of a tree to a tip link.

    `find` finds the file that an address of a mesh means, and `repair` is whether rounded parts of π are read as meant.
    """
    description, mark = tree.description, Mark(file=tree.description.file)
    given = tree.chain(tip)
    chain = tuple(map(_with_unit_axis, given))
    solution, tolerance = solve(chain, choices), choices.tolerance
    found: dict[str, Any] = dict(zip(("position", "angle"), solution.difference, strict=True))
    if not solution.error <= tolerance:
        is_split = all(pair.split for pair in solution.nearly_parallel)
        advice = None if is_split else "the option near_parallel: split keeps numbers of the arm's own size"
        found |= {"tolerance": tolerance, "least": solution.error, "suggestion": advice}
        raise TableError(say("table-too-far", mark, robot=name, field="tolerance", found=f"{tolerance:.9g}", **found))
    carried = Carried(tree, chain, find, Precision.of(tolerance, solution.length))
    notices = [
        say("chain-extracted", base=tree.base, tip=tip, **found, count=RANDOM_VECTORS + 1),
        *_rounded(tree, tip, repair=repair),
        *(pair.notice() for pair in solution.nearly_parallel),
        *_besides_the_chain(description, given, carried),
    ]
    rows, row_notices = _rows(solution, chain, carried, mark)
    rows = _led(rows, chain, tree.robot.followers)
    base = carried.body(0, solution.table.base)
    notices += row_notices
    if base.mass:
        notices.append(say("base-keeps-mass-alone", field="base.mass"))
    notices += [say("left-out-of-table", what=sentence) for sentence in carried.lost]
    # Links without a mass beside others that have one: no row that moves has the mass 0.
    weightless = [shown(row.link) for row in rows if row.mass is None]
    if weightless and any(row.mass for row in rows):
        notices.append(say("masses-missing", field="mass", links=listed(weightless, _FEW)))
    notices = [each.about(robot=name, mark=mark) for each in notices]
    try:
        return replace(
            solution.table,
            name=name,
            rows=rows,
            base_mass=base.mass,
            base_visual=base.visual,
            base_collision=base.collision,
            mark=mark,
            notices=(*description.notices, *notices, *description.left_out),
        )
    except TableError as error:
        raise TableError(problem.about(mark=mark) for problem in error.problems) from error


def _with_unit_axis(joint: Joint) -> Joint:
    if joint.type is JointType.FIXED or (length := norm(joint.axis)) == 1.0:
        return joint
    return replace(joint, axis=scale(1.0 / length, joint.axis))


def _rows(
    solution: Solution, chain: Sequence[Joint], carried: Carried, mark: Mark
) -> tuple[tuple[DHRow, ...], list[Problem]]:
    """The rows with all that goes with them, and notices."""
    moving = {joint.name: joint for joint in chain if joint.type is not JointType.FIXED}
    frames = dh_frames(solution.table, (0.0,) * len(moving))
    names = _Names(moving)
    rows: list[DHRow] = []
    segment, unknown = 0, dict[str, list[str]]()
    for row, frame in zip(solution.table.rows, frames[1:], strict=True):
        if row.type is JointType.FIXED:
            joint_name, link = (free_name(each, names.taken) for each in (row.joint, f"{rows[-1].link}_split"))
            rows.append(replace(row, joint=joint_name, link=link, mass=0.0))
            continue
        segment += 1
        joint = moving[row.joint]
        body, limits = carried.body(segment, frame), _limits(joint, unknown, mark)
        name, link = names.of(joint)
        dynamics: dict[str, Any] = {name: getattr(joint, name) for name in DYNAMICS}
        dynamics = {key: None if value is not None and value < 0.0 else value for key, value in dynamics.items()}
        rows.append(replace(row, joint=name, link=link, limits=limits, mark=joint.mark, **body._asdict(), **dynamics))
    notices = []
    for text, joints in unknown.items():
        names_of = listed(list(map(shown, joints)), _FEW)
        field = f"limits.{text.partition(' ')[0]}"
        notices.append(say("limit-left-out", field=field, limit=text, joints=names_of))
    if names.renamed:
        pairs = [f"{shown(old)} is {shown(new)}" for old, new in names.renamed.items()]
        notices.append(say("names-replaced", pairs=listed(pairs, _FEW)))
    return tuple(rows), notices


def _led(rows: Sequence[DHRow], chain: Sequence[Joint], followers: Mapping[str, Follower]) -> tuple[DHRow, ...]:
    """The rows, of which some follow others: joint values of a table mean what they do in the description."""
    moving = [joint.name for joint in chain if joint.type is not JointType.FIXED]
    own = dict(zip(moving, (row.joint for row in rows if row.type is not JointType.FIXED), strict=True))
    laws = {own[name]: law._replace(leader=own[law.leader]) for name, law in followers.items() if name in own}
    return tuple(replace(row, follows=laws.get(row.joint)) for row in rows)


def _limits(joint: Joint, unknown: dict[str, list[str]], mark: Mark) -> Limits:
    """The limits of a joint as far as a table has them; what is left out goes by its text to the names of joints."""
    lower, upper = joint.limits.lower, joint.limits.upper
    if joint.type is JointType.CONTINUOUS:
        lower = upper = None
    elif (lower is None) is not (upper is None):  # URDF: what is not written is 0
        lower, upper = lower or 0.0, upper or 0.0
    if lower is not None and upper is not None and lower > upper:
        about: dict[str, Any] = {"joint": joint.name, "lower": lower, "upper": upper}
        raise TableError(say("lower-above-upper", joint.mark or mark, field="limits.lower", **about))
    kept: dict[str, float | None] = {name: getattr(joint.limits, name) for name in LIMITS if name not in BOUNDS}
    for name, value in kept.items():
        if value is not None and value <= 0.0:
            unknown.setdefault(f"{name} {value:.9g}", []).append(joint.name)
            kept[name] = None
    return Limits(lower=lower, upper=upper, **kept)


class _Names:
    """Names of joints and links, which share one set in a table, with those that every description of ours has."""

    def __init__(self, moving: Iterable[str]) -> None:
        self.taken = {*RESERVED, *moving}
        self.renamed: dict[str, str] = {}

    def of(self, joint: Joint) -> tuple[str, str]:
        """The names of a joint and of the link that it moves."""
        name = free_name(f"{joint.name}_joint", self.taken) if joint.name in RESERVED else joint.name
        link = joint.child
        while link in self.taken:
            link += "_link"
        self.taken.add(link)
        self.renamed |= {old: new for old, new in ((joint.name, name), (joint.child, link)) if old != new}
        return name, link


def _rounded(tree: Tree, tip: str, *, repair: bool) -> Iterator[Problem]:
    """The numbers that were meant to be parts of π, and what they do to the tip."""
    description = tree.description
    if description.repaired is None:
        return
    repaired = {joint.child: joint for joint in reversed(description.repaired.joints)}
    chain = [_with_unit_axis(joint) for joint in tree.chain(tip)]
    meant = [replace(joint, origin=repaired[joint.child].origin) for joint in chain]
    position, angle = chain_difference(chain, meant)
    first, places = description.rounded[0], len(description.rounded)
    lines = list(dict.fromkeys(str(each.line) for each in description.rounded if each.line))
    where = f" (line{'s' if len(lines) > 1 else ''} {listed(lines, _FEW)})" if lines else ""
    count = f"{places} place{'s' if places > 1 else ''}{where}"
    others = "" if all(each.text == first.text for each in description.rounded) else " and the like"
    about: dict[str, Any] = {"text": first.text, "word": first.word + others, "count": count, "position": position}
    if repair:
        yield say("pi-repaired", field="rounded_pi", **about, angle=angle)
    elif max(position, angle) > 1e-10:  # noqa: PLR2004 - below, the table has the part of π anyhow
        yield say("pi-rounded", field="rounded_pi", **about)


def _besides_the_chain(description: Description, chain: Sequence[Joint], carried: Carried) -> Iterator[Problem]:
    """Joints that are no part of the chain, and axes that are no unit vectors."""
    followers = [each.name for each in description.robot.joints if each.follows and each.name in carried.left_out]
    moving = [joint for joint in chain if joint.type is not JointType.FIXED]
    long_axes = [joint.name for joint in moving if abs(norm(joint.axis) - 1.0) > UNIT]
    for code, names in (
        ("joints-left-out", carried.left_out),
        ("followers-left-out", followers),
        ("axes-of-other-length", long_axes),
    ):
        if names:
            yield say(code, joints=listed(list(map(shown, names)), _FEW))
