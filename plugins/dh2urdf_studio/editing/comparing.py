"""A robot description laid upon the arm of the table: how far the two are from each other, joint by joint."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from dh2urdf.errors import ConfigError
from dh2urdf.kinematics.chain import KinematicChain, angle_error, forward_kinematics, link_poses, position_error
from dh2urdf.kinematics.comparison import POSES, Agreement, compare
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.kinematics.proof_vectors import proof_vectors
from dh2urdf.kinematics.screws import axis_error, screws_of_chain, screws_of_table
from dh2urdf_studio.drawing.colours import BESIDE
from dh2urdf_studio.drawing.scene import Figure

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Robot
    from dh2urdf.rotations import RigidTransform

V = TypeVar("V")
NAME = "description/"
"""What stands before the names of the description's nodes and joints in the scene."""


class Apart(NamedTuple):
    """How far a joint axis, or the tip, is from where the table has it.

    Attributes:
        distance: [m].
        angle: [rad].
    """

    distance: float
    angle: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Beside:
    """A description beside a table.

    Attributes:
        agreement: what `dh2urdf.kinematics.comparison.compare` finds; None where the chain cannot be found.
        refusal: why it cannot.
        figure: the description as it is drawn, its base link where the table's is.
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
    """Lay a description upon the arm of a table.

    Args:
        figure: the description.
        table: the table.
        robot: the robot of the table, whose joints have limits.
        base_link: where the description's chain begins; the root where it is empty.
        tip_link: where it ends; the likeliest link where it is empty.
    """
    figure = replace(figure, name=NAME, tint=BESIDE, opacity=0.45, link_frames=False)
    try:
        agreement = compare(figure.robot, table, base_link=base_link or None, tip_link=tip_link or None)
    except ConfigError as error:
        return Beside(figure=figure, refusal="; ".join(problem.message for problem in error.problems))
    base = link_poses(figure.robot, {})[agreement.base_link]
    figure = replace(figure, place=base.inverse)
    if agreement.difference is None:
        return Beside(figure=figure, agreement=agreement)
    chain = KinematicChain.between(figure.robot, agreement.base_link, agreement.tip_link)
    every = [differences(chain, table, q) for q in proof_vectors(ExpectedPoses.of(table), robot, POSES)]
    worst = tuple(
        Apart(max(each.distance for each in of_one), max(each.angle for each in of_one))
        for of_one in zip(*every, strict=True)
    )
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
