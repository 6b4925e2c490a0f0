"""Cells: several arms in one robot description, whose root is the link `world`.

Every arm keeps what it is alone; its links, joints and materials get a prefix, and a fixed joint holds its root link on
the world or on a link of another arm.
"""

from __future__ import annotations

from dataclasses import dataclass, field as attribute, fields, replace
from enum import StrEnum
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.cells.attachments import attached, prefixed_joint, prefixed_link
from dh2urdf.columns import ManipulatorGroups, RowField
from dh2urdf.errors import RobotError
from dh2urdf.fields import replace_unchecked
from dh2urdf.kinematics.chain import dh_frames, joints_between, link_poses
from dh2urdf.kinematics.expected_poses import ExpectedPoses, Stretch, Tip
from dh2urdf.manipulator import TOOL, WORLD, JointType, Manipulator
from dh2urdf.quantities import Dimension
from dh2urdf.robot import WEIGHTLESS, Arm, Attachment, Collision, Joint, Link, Origin, Robot, Visual
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, shown
from dh2urdf.stages import Rejected
from dh2urdf.variations.laws import Law
from dh2urdf.variations.sampling import Sampling

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

say = Messages(__file__)

REMEMBERED = 1000
"""Names of manipulators that a message may suggest; a run may have a million."""
SHOWN_NAMES = 20
"""Names that a message lists."""


class WantedTables:
    """Keeps the manipulators of some names, and no others.

    Of the cells and variations of the run nothing is made; each variation is given with what it is made of.
    """

    def __init__(
        self, names: Iterable[str], cells: Iterable[str] = (), variations: Mapping[str, str] = MappingProxyType({})
    ) -> None:
        self._cells, self._variations = frozenset(cells), variations
        self._wanted: dict[str, list[Manipulator | Rejected]] = {name: [] for name in names}
        self._names: list[str] = []

    def see(self, item: Manipulator | ManipulatorGroups | Rejected) -> None:
        """Take notice of what a reader gave."""
        names = item.names if isinstance(item, ManipulatorGroups) else [item.name]
        if not self._wanted.keys().isdisjoint(names):
            for each in item.tables() if isinstance(item, ManipulatorGroups) else [item]:
                if each.name in self._wanted:  # Of too many, two are enough to say so.
                    self._wanted[each.name] = [*self._wanted[each.name][:1], each]
        self._names += names[: REMEMBERED - len(self._names)]

    def has(self, name: str) -> bool:
        """Whether a manipulator of a name that is wanted has been seen."""
        return bool(self._wanted[name])

    def table(self, name: str, user: str, mark: Mark | None) -> Manipulator | tuple[Problem, ...]:
        """The manipulator of a name, once everything has been seen; why not, where there is none.

        Messages call what is made of it as `user`: ``the arm 'left'``. The mark is the place of the name in the run
        file.
        """
        about: dict[str, Any] = {"field": "of", "found": name, "user": user}
        match self._wanted[name]:
            case [Manipulator() as table]:
                return table
            case [Rejected(problems=problems)]:
                return say("not-made", mark, **about), *problems
            case [] if other := self._made(name):
                return (say("made-of-no-input", mark, name=name, other=other, **about),)
            case []:
                names = list(dict.fromkeys(self._names))
                few = [*names[:SHOWN_NAMES], *(["…"] if len(names) > SHOWN_NAMES else [])]
                near = did_you_mean(name, names)
                return (say("made-of-nothing", mark, name=name, names=few, suggestion=near, **about),)
            case items:
                marks = " and ".join(str(item.mark) for item in items if item.mark)
                where = f"they are at {marks}" if marks else None
                return (say("made-of-several", mark, name=name, suggestion=where, **about),)

    def _made(self, name: str) -> str | None:
        """What of the run itself has a name: a cell, a variation, or a variant, as `v_1` of `v`."""
        of, _, number = name.rpartition("_")
        if name in self._cells:
            return "a cell"
        if self._variations.get(name, name) != name:  # A variation without a name has that of what it is made of.
            return "a variation"
        return f"a variant of {shown(of)}" if of in self._variations and number.isdecimal() else None


S = TypeVar("S", Visual, Collision)
T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmCall:
    """An arm of a cell as a run file asks for it."""

    name: str  # its name in the cell
    of: str  # name of the manipulator of the run that it is
    prefix: str  # what stands before the names of its links, joints and materials
    parent: str | None = None  # name of the arm that holds it; None for the world
    link: str = WORLD  # the link of that arm, without its prefix
    placement: Origin = Origin()  # its root link in the link that holds it
    floating: bool = False  # whether nothing holds it in the world
    part: Attachment | None = None  # what it is where it is no manipulator, but a part of the run
    mark: Mark | None = attribute(default=None, compare=False)
    of_mark: Mark | None = attribute(default=None, compare=False)  # where its manipulator is named
    parent_mark: Mark | None = attribute(default=None, compare=False)  # where its parent is named


class Combine(StrEnum):
    """How the variants of several arms come together in cells."""

    PAIRS = "pairs"
    """The first of each arm in the first cell, the second of each in the second."""
    ALL = "all"
    """Every variant of one arm with every variant of each other arm, those of the last arm fastest."""


PLACES = {
    **dict.fromkeys(("x", "y", "z"), RowField(Dimension.LENGTH)),
    **dict.fromkeys(("roll", "pitch", "yaw"), RowField(Dimension.ANGLE)),
}
"""The numbers of a placement."""
TRIPLES = {"xyz": ("x", "y", "z"), "rpy": ("roll", "pitch", "yaw")}
"""Three of them, which vary alike and each by itself."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacementRule:
    """How the placement of an arm varies from cell to cell, as a run file asks for it."""

    arm: str
    field: str  # one of `PLACES` or of `TRIPLES`
    law: Law  # how its values are drawn
    mark: Mark | None = attribute(default=None, compare=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class CellCall:
    """A cell as a run file asks for it, or cells of one name that are numbered."""

    name: str
    arms: tuple[ArmCall, ...]  # its arms, parents before children
    order: tuple[str, ...] = attribute(default=(), compare=False)  # their names as the run file has them
    combine: Combine = Combine.PAIRS
    vary: tuple[PlacementRule, ...] = ()
    count: int | None = None  # how many cells; None for as many as there are variants, or points of grids
    seed: int = 0  # which of all samples of placements
    sampling: Sampling = Sampling.RANDOM  # how this sample spreads
    notices: tuple[Problem, ...] = ()  # what is odd about its section
    count_mark: Mark | None = attribute(default=None, compare=False)
    mark: Mark | None = attribute(default=None, compare=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """A cell and the tables of its arms: all that a worker needs to make it."""

    call: CellCall  # the cell as the run file asks for it
    manipulators: dict[str, Manipulator]  # the tables, by their names

    @property
    def name(self) -> str:
        """The cell's name."""
        return self.call.name

    @property
    def mark(self) -> Mark | None:
        """Where the cell stands."""
        return self.call.mark


def cannot_be(arm: ArmCall, problems: Sequence[Problem]) -> Iterator[Problem]:
    """The problems of an arm's table as problems of the cell, with a sentence before them that names the cell."""
    yield say("not-made", arm.of_mark or arm.mark, field="of", found=arm.of, user=the_arm(arm))
    yield from problems


def the_arm(arm: ArmCall) -> str:
    """What messages call an arm."""
    return f"the arm {shown(arm.name)}"


def _of(arm: ArmCall, code: str, field: str, mark: Mark | None, **more: Any) -> Problem:  # noqa: ANN401 - of a message
    return say(code, mark or arm.mark, field=field, found=getattr(arm, field, None), arm=arm.name, **more)


# --- The robot --------------------------------------------------------------------------------------------------------


def compose(cell: Cell, robots: Mapping[str, Robot]) -> Robot:
    """The robot of a cell, given the robots of its manipulators by their names.

    Raises:
        RobotError: an arm stands on a link that there is not, or two arms have a name in common.
    """
    robot = Robot(name=cell.name, links=(Link(name=WORLD),), joints=())
    for each in _placed_kinds(cell, robots):
        robot = attached(robot, each) if isinstance(each, Attachment) else _with_arm(robot, each)
    named = [f"{arm.name} ({arm.kind.name})" for arm in robot.arms]
    named += [each.name for each in robot.attachments if each.name in {arm.name for arm in cell.call.arms}]
    free = [arm for arm in cell.call.arms if arm.floating]
    floating = tuple([arm.prefix + (arm.part.robot if arm.part else robots[arm.of]).root for arm in free])
    return replace(robot, floating=floating, comment=f"{cell.name}: a cell of {', '.join(named)}, made by dh2urdf")


def _with_arm(robot: Robot, arm: Arm) -> Robot:
    """A cell with one more arm."""
    kind, prefix = arm.kind, arm.prefix
    name, root = prefix + kind.mounting, prefix + kind.root
    mounting = Joint(name=name, type=JointType.FIXED, parent=arm.parent, child=root, origin=arm.placement)
    joints = [prefixed_joint(replace(joint, origin=_in_numbers(joint.origin)), prefix) for joint in kind.joints]
    # PyBullet takes a link without inertial for 1 kg, unless it is the root: here it is not.
    first, *others = kind.links
    first = first if first.inertial else replace(first, inertial=WEIGHTLESS)
    attachments = [
        replace(each, name=f"{arm.name}_{each.name}", prefix=prefix + each.prefix, parent=prefix + each.parent)
        for each in kind.attachments
    ]
    return replace(
        robot,
        links=(*robot.links, *(_placed_link(link, prefix) for link in (first, *others))),
        joints=(*robot.joints, mounting, *joints),
        arms=(*robot.arms, arm),
        attachments=(*robot.attachments, *attachments),
        loaded=(*robot.loaded, *(prefix + name for name in kind.loaded)),
    )


def _placed_kinds(cell: Cell, robots: Mapping[str, Robot]) -> Iterator[Arm | Attachment]:
    """The arms with their robots, and the parts, each with the name of its parent in the cell.

    Raises:
        RobotError: as `compose`.
    """
    problems: list[Problem] = []
    calls = {arm.name: arm for arm in cell.call.arms}
    owners: dict[str, ArmCall | None] = {WORLD: None}
    for arm in cell.call.arms:
        kind = arm.part.robot if arm.part else robots[arm.of]
        mounting = f"{arm.name}_joint" if arm.part else kind.mounting
        names = [mounting, *(link.name for link in kind.links), *(joint.name for joint in kind.joints)]
        taken = next((name for name in names if arm.prefix + name in owners), None)
        if taken is not None:
            name = arm.prefix + taken
            other = owners[name]
            whose = f"the arm {shown(other.name)}" if other else "the root of the cell"
            problems.append(_of(arm, "arms-share-a-name", "prefix", None, name=name, whose=whose))
        owners.update(dict.fromkeys((arm.prefix + name for name in names), arm))
        parent = WORLD
        if arm.parent is not None:
            holder = calls[arm.parent]
            parent = holder.prefix + arm.link
            known = [link.name for link in (holder.part.robot if holder.part else robots[holder.of]).links]
            if arm.link not in known:
                near = did_you_mean(arm.link, known) or did_you_mean(arm.link.removeprefix(holder.prefix), known)
                about = {"place": f"{arm.parent}/{arm.link}", "links": [f"{arm.parent}/{name}" for name in known]}
                problems.append(_of(arm, "stands-on-no-link", "parent", arm.parent_mark, suggestion=near, **about))
        if arm.part is None:
            yield Arm(name=arm.name, kind=kind, prefix=arm.prefix, parent=parent, placement=arm.placement)
        elif not problems:
            start = arm.part.placement
            at = arm.placement if start == Origin() else Origin.of(arm.placement.transform @ start.transform)
            yield replace(arm.part, name=arm.name, prefix=arm.prefix, parent=parent, placement=at)
    if problems:
        raise RobotError(problems)


# A cell has no parameters of its own, for two arms would both have an a_1: its numbers have no formulas. Those of the
# arms are in `Arm.kind`.


def _placed_link(link: Link, prefix: str) -> Link:
    visuals, collisions = tuple(map(_placed_shape, link.visuals)), tuple(map(_placed_shape, link.collisions))
    return prefixed_link(replace(link, visuals=visuals, collisions=collisions), prefix)


def _placed_shape(shape: S) -> S:
    return replace(shape, geometry=_in_numbers(shape.geometry), origin=_in_numbers(shape.origin))


def _in_numbers(record: T) -> T:
    """An origin or a geometry without its formulas."""
    formulas = [each.name for each in fields(record) if each.name.endswith("_formula")]  # type: ignore[arg-type]
    return replace_unchecked(record, **dict.fromkeys(formulas))


# --- What is proved ---------------------------------------------------------------------------------------------------


def expected_poses_of(cell: Cell, robots: Mapping[str, Robot]) -> ExpectedPoses:
    """Where the tables have tool0 of every arm of a cell; the robots say where the links stand that hold other arms."""
    calls = {arm.name: arm for arm in cell.call.arms}
    arms = [arm for arm in cell.call.arms if arm.part is None]
    rows = [(arm, row) for arm in arms for row in cell.manipulators[arm.of].actuated_rows]
    joints = tuple(arm.prefix + row.joint for arm, row in rows)
    columns = {name: column for column, name in enumerate(joints)}
    before: dict[str, tuple[Stretch, ...]] = {}  # the way to what holds each arm
    roots: dict[str, str | None] = {}  # where that way begins: the link of a part, or the root of the cell
    tips: list[Tip] = []
    for arm in arms:
        before[arm.name], root = (), None
        holder = calls[arm.parent] if arm.parent is not None else None
        if holder is not None and (holder.part or arm.link in robots[holder.of].foreign_names):
            # The proof of attachments says where that is.
            root = holder.prefix + arm.link
        elif holder is not None:
            held = _up_to(arm.link, cell.manipulators[holder.of], robots[holder.of])
            before[arm.name], root = (*before[holder.name], _stretch(holder, held)), roots[holder.name]
        roots[arm.name] = root
        way = (*before[arm.name], _stretch(arm, cell.manipulators[arm.of]))
        own = {name: columns[name] for stretch in way for name in stretch.leading}
        tips.append(Tip(link=arm.prefix + TOOL, way=way, columns=own, root=root))
    return ExpectedPoses(name=cell.name, root=WORLD, tips=tuple(tips), joints=joints, mark=cell.mark)


def _stretch(arm: ArmCall, table: Manipulator) -> Stretch:
    return Stretch(table, arm.prefix, arm.placement.transform)


def _up_to(link: str, table: Manipulator, robot: Robot) -> Manipulator:
    """An arm's table as far as one of its links, which stands where its tool would.

    A table knows DH frames and tool0, not where a transform puts the frames of links. But a link moves as the DH frame
    of its row does; how it is in that frame is seen where the values of all joints that move by themselves are 0.
    """
    if link == TOOL:
        return table
    moving = sum(joint.type is not JointType.FIXED for joint in joints_between(robot, robot.root, link))
    numbers = [number for number, row in enumerate(table.rows, start=1) if row.type is not JointType.FIXED]
    count, followers = numbers[moving - 1] if moving else 0, table.followers
    frame = dh_frames(table, [0.0] * len(table.actuated_rows))[count]
    rows = tuple(replace_unchecked(row, follows=followers.get(row.joint)) for row in table.rows[:count])
    return replace_unchecked(table, rows=rows, tool=frame.inverse @ link_poses(robot, {})[link])
