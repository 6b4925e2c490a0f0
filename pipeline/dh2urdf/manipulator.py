"""A manipulator as its table says it: Denavit-Hartenberg rows, in SI units.

What is None was not said; the transform computes it. Nothing here is interpreted: the convention, the offset and
the sign stay as the table has them, and `dh2urdf.kinematics.chain` is the one place that knows what they mean.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.errors import RecordValueError
from dh2urdf.fields import ExactRecord, Record, function_of, refuse, unchecked
from dh2urdf.rotations import IDENTITY, RigidTransform, Vec3
from dh2urdf.shapes import (
    Inertia,
    LinkGeometry,
    MeshFile,
    MeshShape,
    Payload,
)
from dh2urdf.source import Mark, Messages, Problem, did_you_mean

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Mapping, Sequence
    from typing import Any, TypeAlias

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    JointVectors: TypeAlias = ArrayLike | Mapping[str, ArrayLike]
    """Joint vectors as an array, or by the names of the joints."""

__all__ = [
    "BASE",
    "ENDS",
    "FLANGE",
    "JOINT_TYPES",
    "ROOT",
    "TOOL",
    "WORLD",
    "Convention",
    "DHRow",
    "Follower",
    "Inertia",
    "JointType",
    "Limits",
    "LinkGeometry",
    "Manipulator",
    "MeshFile",
    "MeshShape",
    "Payload",
    "leader_problems",
    "new_dh_row",
    "new_inertia",
    "new_limits",
    "whole_laws",
]

say = Messages(__file__)

WORLD = "world"
"""The link that stands still: the root of a cell, and a name that simulators keep for themselves."""
ROOT = "base_link"
"""The root of an arm."""
BASE = "base_link_inertia"
"""The body of its base: a root that has an inertial itself is one that KDL does not take."""
FLANGE = "flange"
"""The frame after the last row."""
TOOL = "tool0"
"""The frame at the tip."""
ENDS = (FLANGE, TOOL)
_SHOWN_TYPES = 24
"""Types of joints that the text of a manipulator shows."""


class Convention(StrEnum):
    """Which of the two Denavit-Hartenberg conventions a table is written in."""

    STANDARD = "standard"
    """Classic, distal (Denavit-Hartenberg, Paul, Spong): A = Rz(theta) Tz(d) Tx(a) Rx(alpha)."""
    MODIFIED = "modified"
    """Proximal (Craig): A = Rx(alpha) Tx(a) Rz(theta) Tz(d); a row carries a and alpha of the link before it."""


class JointType(StrEnum):
    """How a joint moves."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"


_POWERS = 4
"""The highest power of a leader's value in a law, as of MJCF's `polycoef`."""
JOINT_TYPES = {kind.value: kind for kind in JointType}
"""The types of joints by their words."""


class Follower(NamedTuple):
    """How a joint follows another one: its value is offset + multiplier x + higher[0] x² + … of the leader's value x.

    Attributes:
        leader: name of the joint that it follows; empty where the file names none.
        multiplier: not a number where the file has none that can be read.
        offset: [rad or m].
        higher: factors of the square of the leader's value, its cube and so on; MJCF has them.
    """

    leader: str
    multiplier: float = 1.0
    offset: float = 0.0
    higher: tuple[float, ...] = ()

    @property
    def is_sound(self) -> bool:
        """Whether all numbers are finite, and the powers are those that MJCF has."""
        return len(self.higher) < _POWERS and all(map(math.isfinite, self.factors))

    @property
    def is_held(self) -> bool:
        """Whether the joint keeps one value, and follows none."""
        return not self.leader and not any(self.factors[1:]) and self.is_sound

    @property
    def factors(self) -> tuple[float, ...]:
        """The factors of the powers of the leader's value, from its power 0: the offset comes first."""
        return (self.offset, self.multiplier, *self.higher)

    def value(self, leading: float) -> float:
        """The value of the joint where the leader has the one given [rad or m]."""
        powers = 0.0
        for factor in reversed(self.higher):
            powers = (powers + factor) * leading
        return (self.multiplier + powers) * leading + self.offset

    def behind(self, leader: Follower) -> Follower:
        """The law by which the joint follows the leader of its leader: the polynomial of a polynomial."""
        inner, whole = leader.factors, [0.0]
        for factor in reversed(self.factors):  # Horner's rule
            product = [0.0] * (len(whole) + len(inner) - 1)
            for power, one in enumerate(whole):
                for more, other in enumerate(inner):
                    product[power + more] += one * other
            whole = [product[0] + factor, *product[1:]]
        while len(whole) > 2 and not whole[-1]:  # noqa: PLR2004 - offset and multiplier stay
            whole.pop()
        return Follower(leader.leader, whole[1], whole[0], tuple(whole[2:]))

    def rate(self, leading: float) -> float:
        """How fast the joint moves for each rad or m of the leader, at a value of that."""
        powers = ((power + 2) * factor * leading ** (power + 1) for power, factor in enumerate(self.higher))
        return self.multiplier + sum(powers)


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits(Record):
    """Bounds of one joint value q and of its motion; None where the table says nothing.

    Attributes:
        lower: smallest q [rad or m].
        upper: largest q [rad or m].
        velocity: largest speed [rad/s or m/s].
        effort: largest torque or force [N·m or N].
        acceleration: largest acceleration [rad/s² or m/s²].
        jerk: largest change of the acceleration [rad/s³ or m/s³].
    """

    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None
    acceleration: float | None = None
    jerk: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DHRow(ExactRecord):
    """One row of the table: one joint and the link that it moves.

    Attributes:
        joint: name of the joint.
        link: name of the link that it moves.
        type: how it moves.
        a: length of the common normal [m]; a of the link before in the modified convention.
        alpha: twist [rad]; of the link before in the modified convention.
        d: offset along the joint axis [m].
        theta: angle about the joint axis [rad].
        offset: added to the joint variable [rad or m].
        sign: 1, or -1 where the joint counts the other way.
        limits: bounds of q.
        mass: mass of the link [kg].
        com: centre of mass in the DH frame after this row [m].
        inertia: inertia tensor about the centre of mass, axes of the DH frame after this row [kg·m²].
        radius: radius of the link's shape [m].
        damping: viscous friction of the joint [N·m·s/rad or N·s/m].
        friction: static friction of the joint [N·m or N].
        armature: inertia of the motor's rotor as the joint feels it, behind the gear [kg·m² or kg].
        follows: the joint whose value decides q of this one, and how; None where the joint moves by itself.
        visual: the mesh that the link is seen as.
        collision: the mesh that the link touches with.
        mark: the row in its file.
    """

    joint: str
    link: str
    type: JointType = JointType.REVOLUTE
    a: float
    alpha: float
    d: float
    theta: float = 0.0
    offset: float = 0.0
    sign: int = 1
    limits: Limits = Limits()
    mass: float | None = None
    com: Vec3 | None = None
    inertia: Inertia | None = None
    radius: float | None = None
    damping: float | None = None
    friction: float | None = None
    armature: float | None = None
    follows: Follower | None = None
    visual: MeshShape | None = None
    collision: MeshShape | None = None
    mark: Mark | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        ExactRecord.__post_init__(self)  # `super()` means another class where a dataclass has slots
        for name in ("joint", "link"):
            if not getattr(self, name).strip():
                refuse(self, name, "name-missing", getattr(self, name), what=f"the {name}")
        if self.sign not in (1, -1):
            refuse(self, "sign", "sign-wrong", self.sign)
        if self.type is JointType.FIXED:
            for name, allowed in (("offset", 0.0), ("sign", 1)):
                if (value := getattr(self, name)) != allowed:
                    refuse(self, name, "fixed-joint-moves", value, name=name, allowed=allowed)
            if self.follows:
                refuse(self, "follows", "fixed-joint-follows", self.follows.leader)
        if self.follows and (self.follows.higher or not self.follows.is_sound):
            refuse(self, "follows", "law-not-linear", str(tuple(self.follows)))
        lower, upper = self.limits.lower, self.limits.upper
        if lower is not None and upper is not None and lower > upper:
            refuse(self, "limits.lower", "lower-above-upper", lower, lower=lower, upper=upper)


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Manipulator(ExactRecord):
    """A serial arm as its table says it.

    Attributes:
        name: the manipulator's name, as the user wrote it.
        convention: the Denavit-Hartenberg convention of the rows.
        rows: one per joint, from the base outwards.
        base: rigid transform from base_link to the first DH frame.
        tool: rigid transform from the last DH frame to tool0.
        geometry: shape of every link.
        density: density of links without a mass [kg/m³].
        base_mass: mass of the base's body [kg]; 0 for none.
        payload: what the arm carries at tool0.
        base_geometry: shape of the base's body.
        base_visual: the mesh that the base is seen as.
        base_collision: the mesh that the base touches with.
        visuals: whether links are seen at all; None leaves it to the transform.
        collisions: whether links touch at all; None leaves it to the transform.
        mark: the manipulator's place in its file.
        notices: what a careful person would want to know about how it was read.
    """

    name: str
    convention: Convention
    rows: tuple[DHRow, ...]
    base: RigidTransform = IDENTITY
    tool: RigidTransform = IDENTITY
    geometry: LinkGeometry = LinkGeometry()
    density: float | None = None
    base_mass: float | None = None
    payload: Payload | None = None
    base_geometry: LinkGeometry = LinkGeometry()
    base_visual: MeshShape | None = None
    base_collision: MeshShape | None = None
    visuals: bool | None = None
    collisions: bool | None = None
    mark: Mark | None = field(default=None, compare=False)
    notices: tuple[Problem, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        ExactRecord.__post_init__(self)  # `super()` means another class where a dataclass has slots
        if not self.name.strip():
            refuse(self, "name", "name-missing", self.name, what="the manipulator")
        if not self.rows:
            refuse(self, "rows", "no-rows", ())
        for name in ("joint", "link"):
            names = [getattr(row, name) for row in self.rows]
            if len(set(names)) < len(names):
                twin = next(word for index, word in enumerate(names) if word in names[:index])
                numbers = [index for index, word in enumerate(names) if word == twin]
                place = f"rows[{numbers[1]}].{name}"
                refuse(self, place, "rows-alike", twin, first=numbers[0], second=numbers[1], what=name, word=twin)
        if problems := [*leader_problems(self.rows)]:
            own = Mark(file=f"{type(self).__name__}()")
            raise RecordValueError(problem.about(robot=self.name, mark=own) for problem in problems)

    @property
    def moving_rows(self) -> tuple[DHRow, ...]:
        """The rows whose joints move, in order: by themselves, or because they follow another one."""
        return tuple(row for row in self.rows if row.type is not JointType.FIXED)

    @property
    def actuated_rows(self) -> tuple[DHRow, ...]:
        """The rows whose joints move by themselves, in order: q has one entry for each."""
        return tuple(row for row in self.rows if row.type is not JointType.FIXED and row.follows is None)

    @property
    def followers(self) -> dict[str, Follower]:
        """The joints that follow another one, by name, and how they follow the one that moves by itself."""
        return whole_laws({row.joint: row.follows for row in self.rows if row.follows})

    @classmethod
    def from_dh(
        cls,
        table: object,
        *,
        convention: str | Convention | None = None,
        units: str | Mapping[str, str] | None = None,
        columns: Sequence[str] | None = None,
        types: str | Sequence[str] | None = None,
        joints: Sequence[str] | None = None,
        name: str | None = None,
        robot: str | None = None,
        file: str | os.PathLike[str] | None = None,
        mark: Mark | None = None,
        **options: object,
    ) -> Manipulator:
        """The manipulator of a table that is at hand: an array, a data frame, lists, mappings, or a text.

        The table means what it would mean in a file: headers in any spelling, with units, and cells with expressions.

        ::

            Manipulator.from_dh(array, columns=["theta", "d", "a", "alpha"], convention="standard")
            Manipulator.from_dh(frame, convention="modified", units={"length": "mm", "angle": "deg"})
            Manipulator.from_dh([{"a": 0.4, "alpha": "pi/2", "d": 0}, …], convention="standard", types="RP")

        Args:
            table: an array of shape (rows, columns); a DataFrame, whose index may have the names of the joints; a list
                of rows, whose first one may be the header; a list of mappings; a mapping of columns; or the text of a
                CSV file.
            convention: the Denavit-Hartenberg convention, where the table does not say it.
            units: the units of bare numbers, such as ``{"length": "mm", "angle": "deg"}``; m and rad without them.
            columns: what the columns are, in their order, where they have no names. Their order is never guessed.
            types: the type of each joint, as a column ``type`` has it, such as ``"RRP"``.
            joints: the name of each joint.
            name: the name of the manipulator; ``robot`` where nothing says it.
            robot: which manipulator is meant, where the table has several.
            file: the file that the table comes from: messages name it, and the row. For readers of plugins.
            mark: the place of the table in its file, where the file has several: messages name it as well.
            options: further options of the reader of tables: ``base``, ``tool``, ``length_unit``, ``angle_unit``.

        Returns:
            The manipulator. Its notices are also given as `TableWarning`; where a stage of a plugin calls this, the
            caller of the stage reports them.

        Raises:
            TableError: the table cannot be read; the row and the column are named.
            ConfigError: an option is unknown or its value wrong.
        """
        given = {"convention": None if convention is None else str(convention), "units": units, **options}
        return function_of("commands.given_tables.manipulator_of")(
            table,
            columns=columns,
            types=types,
            joints=joints,
            name=name,
            robot=robot,
            file=file,
            mark=mark,
            options={key: value for key, value in given.items() if value is not None},
        )

    def to_csv(self, out: str | os.PathLike[str] | None = None) -> str:
        """The table as CSV, in m and rad, which `dh2urdf.read` reads back as the same manipulator to the last bit.

        Args:
            out: the file to write; without it nothing is written.

        Returns:
            The text of the file.

        Raises:
            RecordValueError: the table says something that CSV has no place for, such as meshes.
            ConfigError: the file's name is that of another format.
            OutputError: the file cannot be written.
        """
        return function_of("commands.written.write_table")(self, ".csv", out, "Manipulator.to_csv()")

    def to_yaml(self, out: str | os.PathLike[str] | None = None) -> str:
        """The table as YAML, as `to_csv` has it as CSV."""
        return function_of("commands.written.write_table")(self, ".yaml", out, "Manipulator.to_yaml()")

    def fk(self, q: JointVectors, *, full: bool = False) -> NDArray[np.float64]:
        """Forward kinematics: the DH product at one joint vector or at many.

        Args:
            q: joint vectors of shape (..., n), one value per actuated row [rad or m]; or a mapping from the names of
                these joints to a value, or to an array of values, for each. Joints that follow another one have no
                value here.
            full: whether q has a value for every row instead, which is 0 for fixed ones and for followers.

        Returns:
            T(base_link → tool0) of shape (..., 4, 4), lengths in m.

        Raises:
            RecordError: the joint vectors have another number of values than the table has actuated rows, a joint is
                unknown or missing, or a value is not a finite number. It is a TypeError or a ValueError, too.
        """
        return function_of("kinematics.pose_arrays.table_pose")(self, q, full=full)

    def fk_all(self, q: JointVectors, *, full: bool = False) -> dict[str, NDArray[np.float64]]:
        """The DH frame of every link, the base and tool0 included, at one joint vector or at many.

        The frame of a link is the DH frame after its row. A robot description may have its link frames elsewhere:
        `Robot.fk_all` has those.

        Args:
            q: joint vectors as `fk` accepts them.
            full: whether q has a value for every row.

        Returns:
            By the name of the link, from ``base_link`` to ``tool0``, T(base_link → frame) of shape (..., 4, 4).

        Raises:
            RecordError: as of `fk`.
        """
        return function_of("kinematics.pose_arrays.table_poses")(self, q, full=full)

    def jacobian(self, q: JointVectors, *, full: bool = False) -> NDArray[np.float64]:
        """The geometric Jacobian J of tool0, with the axes of base_link: the twist of tool0 is J·dq/dt.

        The first three rows are the velocity of the origin of tool0 [m/s], the last three the angular velocity [rad/s].
        Pinocchio calls this frame LOCAL_WORLD_ALIGNED.

        Args:
            q: joint vectors as `fk` accepts them.
            full: whether q has a value for every row. The Jacobian has a column for each actuated row, even so.

        Returns:
            Matrices of shape (..., 6, n), a column for each actuated row; what follows it is in its column.

        Raises:
            RecordError: as of `fk`.
        """
        return function_of("kinematics.pose_arrays.table_jacobian")(self, q, full=full)

    def __repr__(self) -> str:
        """Name, convention, number of moving joints and the types of the rows: R, C, P, and F for fixed."""
        types = "".join(row.type.value[0].upper() for row in self.rows)
        shown_types = types if len(types) <= _SHOWN_TYPES else f"{types[:_SHOWN_TYPES]}…"
        axes = len(self.actuated_rows)
        return f"<Manipulator {self.name!r}: {self.convention}, {axes} {'axis' if axes == 1 else 'axes'} {shown_types}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the table and, with matplotlib, a drawing of the arm."""
        return function_of("report.notebook.manipulator_html")(self)


def whole_laws(followers: Mapping[str, Follower]) -> dict[str, Follower]:
    """The laws of followers, each referred to the joint at the end of its leaders, which follows none.

    Left out are those that come to no end, and those whose laws are not sound.
    """
    whole: dict[str, Follower] = {}
    for name, law in followers.items():
        met = {name}
        while law.is_sound and law.leader in followers and law.leader not in met:
            met.add(law.leader)
            law = law.behind(whole.get(law.leader, followers[law.leader]))  # noqa: PLW2901 - on the way to the end
        if law.is_sound and law.leader not in followers:
            whole[name] = law
    return whole


def leader_problems(rows: Sequence[DHRow]) -> Iterator[Problem]:
    """What is wrong with the leaders of rows that follow others; each problem names its row's joint."""
    laws = {row.joint: row.follows for row in rows if row.follows}
    named = {row.joint: row for row in rows} if laws else {}
    for name, law in laws.items():
        row, leader = named[name], named.get(law.leader)
        about: dict[str, Any] = {"joint": name, "field": "follows", "found": law.leader}
        if leader is None:
            near = did_you_mean(law.leader, [other for other in named if other != name])
            yield say("leader-unknown", row.mark, **about, suggestion=near)
        elif leader.type is JointType.FIXED:
            yield say("leader-fixed", row.mark, **about)
        elif (leader.type is JointType.PRISMATIC) is not (row.type is JointType.PRISMATIC):
            yield say("leader-moves-otherwise", row.mark, **about, own=row.type, other=leader.type)
        else:
            way = [name]
            while (after := laws.get(way[-1])) and after.leader not in way:
                way.append(after.leader)
            if after and after.leader == name:
                yield say("leaders-in-circle", row.mark, **about, circle=way)


# Constructors without checks, for stages that have computed the values: see `dh2urdf.fields.unchecked`.
new_dh_row = unchecked(DHRow)
new_inertia = unchecked(Inertia)
new_limits = unchecked(Limits)
