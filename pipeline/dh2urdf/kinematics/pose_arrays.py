"""Poses and Jacobians of tables and robots at one joint vector or at many, as arrays.

What `Manipulator` and `Robot` have as methods. The products are those of `dh2urdf.kinematics.chain`.

Source of the Jacobian: Siciliano, Sciavicco, Villani and Oriolo, Robotics: Modelling, Planning and Control (2009),
eqs. 3.29 and 3.30. A revolute joint with the axis z through the point p moves the origin o of the tool by z × (o − p)
and turns it by z; a prismatic one moves it by z.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.errors import RecordTypeError, RecordValueError
from dh2urdf.kinematics.chain import (
    KinematicChain,
    Screw,
    as_matrices,
    dh_frames,
    link_poses,
    screws_in_frames,
    screws_of_chain,
)
from dh2urdf.kinematics.joint_vectors import JointNames, joint_values
from dh2urdf.manipulator import ROOT, TOOL, Follower
from dh2urdf.rotations import IDENTITY, cross, subtract
from dh2urdf.source import Mark, Messages, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Robot
    from dh2urdf.rotations import RigidTransform, Vec3

    Matrices = NDArray[np.float64]

say = Messages(__file__)


def pose_matrices(model: Manipulator | KinematicChain, q: ArrayLike) -> NDArray[np.float64]:
    """Forward kinematics at many joint vectors at once.

    Args:
        model: a table, or a chain of a robot.
        q: joint vectors of shape (..., n) [rad or m].

    Returns:
        T(base → tool0) of shape (..., 4, 4).

    Raises:
        RecordError: the joint vectors have another number of values than the model has moving joints, or a value is
            none.
    """
    if not isinstance(model, KinematicChain):
        return table_pose(model, q)
    names = JointNames(model.actuated, model.actuated, whose="the chain", function="pose_matrices()")
    return _chain_pose(model, names, q)


# --- Tables


def table_pose(manipulator: Manipulator, q: Any, *, full: bool = False) -> Matrices:  # noqa: ANN401 - whatever is given
    """T(base_link → tool0) of shape (..., 4, 4); see `Manipulator.fk`."""
    function = "Manipulator.fk()"
    values, shape = joint_values(q, joints_of(manipulator, function, full=full))
    return _matrices(dh_frames(manipulator, values)[-1] @ manipulator.tool, shape, function)


def table_poses(manipulator: Manipulator, q: Any, *, full: bool) -> dict[str, Matrices]:  # noqa: ANN401 - whatever is given
    """T(base_link → DH frame) by link; see `Manipulator.fk_all`."""
    function = "Manipulator.fk_all()"
    values, shape = joint_values(q, joints_of(manipulator, function, full=full))
    frames = dh_frames(manipulator, values)
    poses = {ROOT: IDENTITY}
    poses |= {row.link: frame for row, frame in zip(manipulator.rows, frames[1:], strict=True)}
    poses[TOOL] = frames[-1] @ manipulator.tool
    return {link: _matrices(pose, shape, function) for link, pose in poses.items()}


def table_jacobian(manipulator: Manipulator, q: Any, *, full: bool) -> Matrices:  # noqa: ANN401 - whatever is given
    """The geometric Jacobian of tool0 in base_link, of shape (..., 6, n); see `Manipulator.jacobian`."""
    function = "Manipulator.jacobian()"
    values, shape = joint_values(q, joints_of(manipulator, function, full=full))
    frames = dh_frames(manipulator, values)
    screws = screws_in_frames(manipulator, frames)
    columns = jacobian_of(screws, (frames[-1] @ manipulator.tool).translation, shape, function)
    given = dict(zip([row.joint for row in manipulator.actuated_rows], values, strict=True))
    return led(columns, [row.joint for row in manipulator.moving_rows], given, manipulator.followers)


def joints_of(manipulator: Manipulator, function: str, *, full: bool = False) -> JointNames:
    """The joints that a joint vector of a table speaks of."""
    if not isinstance(full, bool):
        about = {"value": repr(full), "kind": "flag", "accepted": "True or False"}
        raise RecordTypeError(say("argument-wrong", Mark(file=function), field="full", **about))
    moving = tuple(row.joint for row in manipulator.actuated_rows)
    wanted = tuple(row.joint for row in manipulator.rows) if full else moving
    return JointNames(wanted, moving, whose=f"manipulator {shown(manipulator.name)}", function=function)


# --- Robots


def robot_pose(robot: Robot, q: Any, tip: str) -> Matrices:  # noqa: ANN401 - whatever is given
    """T(root → tip) of shape (..., 4, 4); see `Robot.fk`."""
    return _chain_pose(*Way.to(robot, tip, "Robot.fk()"), q)


def _chain_pose(chain: KinematicChain, names: JointNames, q: Any) -> Matrices:  # noqa: ANN401 - whatever is given
    """T(root → tip) of shape (..., 4, 4) of a chain whose joints have these names."""
    values, shape = joint_values(q, names)
    return _matrices(chain.forward_kinematics(values), shape, names.function)


def robot_poses(robot: Robot, q: Any) -> dict[str, Matrices]:  # noqa: ANN401 - whatever is given
    """T(root → link) by link; see `Robot.fk_all`."""
    actuated = tuple(joint.name for joint in robot.actuated_joints)
    names = JointNames(actuated, actuated, whose=f"robot {shown(robot.name)}", function="Robot.fk_all()")
    values, shape = joint_values(q, names)
    poses = link_poses(robot, dict(zip(actuated, values, strict=True)))
    return {link.name: _matrices(poses[link.name], shape, names.function) for link in robot.links}


def robot_jacobian(robot: Robot, q: Any, tip: str) -> Matrices:  # noqa: ANN401 - whatever is given
    """The geometric Jacobian of a link in the root link, of shape (..., 6, n); see `Robot.jacobian`."""
    way = Way.to(robot, tip, "Robot.jacobian()")
    values, shape = joint_values(q, way.names)
    screws, end = screws_of_chain(way.chain, values)
    columns = jacobian_of(screws, end.translation, shape, way.names.function)
    given = dict(zip(way.names.moving, values, strict=True))
    return led(columns, [joint.name for joint in way.chain.moving], given, way.chain.followers)


class Way(NamedTuple):
    """The joints on the way from the root to a link, and those that they follow."""

    chain: KinematicChain
    names: JointNames  # of the actuated joints; a mapping may name the others of the robot, too

    @classmethod
    def to(cls, robot: Robot, tip: str, function: str) -> Way:
        """The way to a link, for a public function that messages name."""
        chain = KinematicChain.between(robot, robot.root, tip)
        moving = chain.actuated
        known = tuple(joint.name for joint in robot.actuated_joints if joint.name not in moving)
        whose = f"the way of robot {shown(robot.name)} to {shown(tip)}"
        return cls(chain, JointNames(moving, moving, known, whose=whose, function=function))


# --- Arrays


def _matrices(pose: RigidTransform, shape: tuple[int, ...], function: str) -> Matrices:
    import numpy as np

    return _finite(np.broadcast_to(as_matrices(pose), (*shape, 4, 4)), function)


def jacobian_of(screws: Sequence[Screw], tool: Vec3, shape: tuple[int, ...], function: str) -> Matrices:
    """The geometric Jacobian of a point [m] that these joints move, at joint vectors of this shape."""
    import numpy as np

    jacobian = np.zeros((*shape, 6, len(screws)))
    for number, (direction, point, slides) in enumerate(screws):
        linear = direction if slides else cross(direction, subtract(tool, point))
        for element, value in enumerate((*linear, *((0.0, 0.0, 0.0) if slides else direction))):
            jacobian[..., element, number] = value
    return _finite(jacobian, function)


def led(
    columns: Matrices, moving: Iterable[str], values: Mapping[str, Any], followers: Mapping[str, Follower]
) -> Matrices:
    """The Jacobian for the joints that have values, from that for all that move: a follower moves at its law's rate."""
    import numpy as np

    if not followers:
        return columns
    actuated, found = [*values], np.zeros((*columns.shape[:-1], len(values)))
    for number, law in enumerate(followers.get(name, Follower(name)) for name in moving):
        if law.leader:
            rate = np.asarray(law.rate(values[law.leader]))
            found[..., actuated.index(law.leader)] += rate[..., None] * columns[..., number]
    return found


def _finite(numbers: Matrices, function: str) -> Matrices:
    import numpy as np

    if not np.isfinite(numbers).all():
        raise RecordValueError(say("pose-infinite", Mark(file=function)))
    return numbers
