"""The section `cells` of a run file: which arms stand where in one robot description."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.cells.cell import ArmCall, CellCall
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import WORLD
from dh2urdf.quantities.quantity import Dimension
from dh2urdf.robot import Origin
from dh2urdf.rotations import ZERO, Vec3
from dh2urdf.run_file.validator import Distinct, Key, Many, Record
from dh2urdf.run_file.value_types import ANY_TEXT, TEXT, triple
from dh2urdf.source import Mark, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

ACCEPTED_PARENT = "world, or a link of another arm of the cell, such as left/tool0"
NO_ARMS = (
    "this cell has no arms",
    "a list such as [{name: left, of: ur5}, {name: right, of: ur5, xyz: [0, -0.5, 0]}]",
)


def _arm(
    *,
    name: str,
    of: str,
    prefix: str | None = None,
    parent: str = WORLD,
    xyz: Vec3 = ZERO,
    rpy: Vec3 = ZERO,
    mark: Mark,
    of_mark: Mark,
    parent_mark: Mark | None,
) -> ArmCall:
    problems = []
    if name == WORLD or "/" in name:
        message = f"an arm cannot be named {shown(name)}: parents are written as world or ARM/LINK"
        problems.append(Problem(message=message, field="name", accepted="another name"))
    arm, slash, link = parent.partition("/")
    if parent != WORLD and not (arm and slash and link):
        holder = (arm or link).removesuffix("_tool0")  # as its link is called in the file that is written
        near = did_you_mean(parent, [WORLD]) or f"an arm's tool is {shown(f'{holder}/tool0')}"
        message = f"{shown(parent)} is no parent"
        problems.append(Problem(message=message, field="parent", accepted=ACCEPTED_PARENT, suggestion=near))
    if problems:
        raise ConfigError(problems)
    return ArmCall(
        name=name,
        of=of,
        prefix=f"{name}_" if prefix is None else prefix,
        parent=None if parent == WORLD else arm,
        link=link or WORLD,
        placement=Origin(xyz=xyz, rpy=rpy),
        mark=mark,
        of_mark=of_mark,
        parent_mark=parent_mark,
    )


def _cell(name: str, arms: Sequence[ArmCall], mark: Mark) -> CellCall:
    if problems := [*_same_names(arms), *_orphans(arms)]:
        raise ConfigError(problems)
    return CellCall(name=name, arms=_parents_first(arms), mark=mark)


def _same_names(arms: Sequence[ArmCall]) -> Iterator[Problem]:
    """Names, and prefixes, which every arm's base_link gets, differ."""
    for what in ("name", "prefix"):
        first: dict[str, ArmCall] = {}
        for arm in arms:
            word = getattr(arm, what)
            if first.setdefault(word, arm) is not arm:
                yield Problem(
                    message=f"two arms of this cell have the {what} {shown(word)}",
                    field="arms",
                    mark=arm.mark,
                    found=word,
                    accepted=f"a {what} of its own for each",
                    suggestion=f"the first is at {first[word].mark}",
                )


def _orphans(arms: Sequence[ArmCall]) -> Iterator[Problem]:
    """Arms that stand on others stand on some of the cell."""
    names = [arm.name for arm in arms]
    for arm in arms:
        if arm.parent is not None and arm.parent not in names:
            yield Problem(
                message=f"the cell has no arm {shown(arm.parent)} that could hold {shown(arm.name)}",
                field="arms",
                mark=arm.parent_mark,
                found=f"{arm.parent}/{arm.link}",
                accepted=", ".join([WORLD, *(f"{name}/LINK" for name in names if name != arm.name)]),
                suggestion=did_you_mean(arm.parent, names),
            )


def _parents_first(arms: Sequence[ArmCall]) -> tuple[ArmCall, ...]:
    """The arms so that each comes after the one that holds it, otherwise as they are written.

    Raises:
        ConfigError: they hold each other.
    """
    ordered: dict[str, ArmCall] = {}
    waiting = list(arms)
    while waiting:
        for arm in waiting:
            if arm.parent is None or arm.parent in ordered:
                ordered[arm.name] = arm
        left = [arm for arm in waiting if arm.name not in ordered]
        if len(left) == len(waiting):
            circle = " and ".join(f"{shown(arm.name)} on {shown(f'{arm.parent}/{arm.link}')}" for arm in left)
            raise ConfigError(
                Problem(
                    message=f"these arms hold each other in a circle: {circle}",
                    field="arms",
                    mark=left[0].parent_mark,
                    found=f"{left[0].parent}/{left[0].link}",
                    accepted="a parent for each, so that every way leads to the world",
                )
            )
        waiting = left
    return tuple(ordered.values())


ARM = Record(
    _arm,
    {
        "name": Key(TEXT, "the arm's name in the cell", missing=("this arm has no 'name'", "`name: NAME`")),
        "of": Key(
            TEXT,
            "the manipulator of this run that it is",
            missing=("this arm has no 'of'", "`of: NAME`, the name of a manipulator of this run"),
        ),
        "prefix": Key(ANY_TEXT, "before the names of its links and joints; NAME_ by default"),
        "parent": Key(TEXT, "world, or a link of another arm, such as left/tool0"),
        "xyz": Key(triple(Dimension.LENGTH), "where it stands on its parent [m]"),
        "rpy": Key(triple(Dimension.ANGLE), "its orientation there: roll, pitch, yaw [rad]"),
    },
    marks={"mark": ("",), "of_mark": ("of",), "parent_mark": ("parent",)},
)
CELL = Record(
    _cell,
    {
        "name": Key(
            TEXT,
            "the cell's name, after which its files are named",
            missing=("this cell has no 'name'", "`name: NAME`, after which its files are named"),
        ),
        "arms": Key(Many(ARM, empty=NO_ARMS, takes_one=False), missing=NO_ARMS),
    },
    marks={"mark": ("",)},
)
CELLS = Many(CELL, distinct=Distinct("name", "two cells are named {}", "names that differ"))
