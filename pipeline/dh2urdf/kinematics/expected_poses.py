"""Where the tables have the tips of a robot: what everything that is written is measured against.

A robot made of one table has one tip, tool0, and its pose is the DH product. A cell of several arms has a tool0 of
each, whose pose is a product of such products: along every arm on the way, from the world outwards, its placement and
then its rows, up to the link that holds the next arm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.elementwise import total
from dh2urdf.kinematics.chain import compile_table, reach
from dh2urdf.kinematics.walk import CompiledChain, values_of
from dh2urdf.manipulator import ROOT, TOOL, JointType, Manipulator
from dh2urdf.rotations import IDENTITY, RigidTransform, norm
from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Sequence


class Stretch(NamedTuple):
    """The way along one arm.

    Attributes:
        manipulator: its table as far as the way goes; what follows the last of these rows is its tool.
        joints: names of its moving joints in the robot, in order.
        placement: the arm's root link in what holds it.
    """

    manipulator: Manipulator
    joints: tuple[str, ...]
    placement: RigidTransform = IDENTITY


@dataclass(frozen=True, slots=True, kw_only=True)
class Tip:
    """A frame whose pose the tables say.

    Attributes:
        link: its name in the robot.
        way: the arms on the way to it, from the root outwards.
        columns: which entries of the robot's joint vector move it, in the order of the way.
    """

    link: str
    way: tuple[Stretch, ...]
    columns: tuple[int, ...]

    @property
    def joints(self) -> tuple[str, ...]:
        """The moving joints on the way, from the root outwards."""
        return tuple(name for stretch in self.way for name in stretch.joints)

    def values(self, q: Sequence[float]) -> tuple[float, ...]:
        """The entries of the robot's joint vector that move it [rad or m]."""
        return tuple(q[column] for column in self.columns)

    def compiled(self) -> CompiledChain:
        """The way to it, as moves and turns, at joint vectors of the robot: the product of the DH products."""
        chain = CompiledChain()
        first = 0
        for table, joints, placement in self.way:
            chain.transform(placement)
            compile_table(chain, table, self.columns[first : first + len(joints)])
            first += len(joints)
        chain.stop()
        return chain

    def pose(self, q: Sequence[float]) -> RigidTransform:
        """T(root → tip) at a joint vector of the robot [rad or m]."""
        return self.compiled().walk(values_of(q))[0].transform

    def reach(self, poses: Sequence[Sequence[float]]) -> float:
        """An upper bound of its distance from the root at some joint vectors [m]."""
        rows = [row for stretch in self.way for row in stretch.manipulator.moving_rows]
        sliding = [column for column, row in zip(self.columns, rows, strict=True) if row.type is JointType.PRISMATIC]
        travel = max((total(abs(q[column]) for column in sliding) for q in poses), default=0.0) if sliding else 0.0
        return total(norm(placement.translation) + reach(table) for table, _, placement in self.way) + travel


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedPoses:
    """What the tables declare about a robot.

    Attributes:
        name: the robot's name.
        root: name of its root link.
        tips: the frames whose poses follow from the tables.
        joints: its moving joints; a joint vector has an entry for each.
        mark: where the robot is in its file.
    """

    name: str
    root: str = ROOT
    tips: tuple[Tip, ...]
    joints: tuple[str, ...]
    mark: Mark | None = None

    @classmethod
    def of(cls, manipulator: Manipulator) -> ExpectedPoses:
        """The poses of a robot that is one arm."""
        joints = tuple(row.joint for row in manipulator.moving_rows)
        tip = Tip(link=TOOL, way=(Stretch(manipulator, joints),), columns=tuple(range(len(joints))))
        return cls(name=manipulator.name, tips=(tip,), joints=joints, mark=manipulator.mark)
