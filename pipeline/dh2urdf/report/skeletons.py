"""What is drawn of an arm or a robot where all joint values are 0: lines, joint axes and frames."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics.chain import forward_kinematics, joint_variables, row_transform
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.rotations import IDENTITY, RigidTransform, Vec3, add, rotate

if TYPE_CHECKING:
    from dh2urdf.kinematics.expected_poses import Tip
    from dh2urdf.robot import Robot


class JointAxis(NamedTuple):
    """The axis of a moving joint.

    Attributes:
        number: the joint's among the moving joints, from 1.
        at: a point on it [m].
        direction: the unit vector about which the joint turns, or along which it slides.
        slides: whether it slides.
    """

    number: int
    at: Vec3
    direction: Vec3
    slides: bool


class Skeleton(NamedTuple):
    """An arm or a robot where all joint values are 0, in the root frame [m].

    Attributes:
        paths: lines from the root outwards; each branch of a tree begins where it leaves another one.
        axes: the axes of the moving joints.
        frames: the base, the frames of the links, and the tips.
        tips: where the paths end.
    """

    paths: tuple[tuple[Vec3, ...], ...]
    axes: tuple[JointAxis, ...]
    frames: tuple[RigidTransform, ...]
    tips: tuple[Vec3, ...]


def arm_skeleton(tip: Tip) -> Skeleton:
    """The last arm on the way to a tip, as its table has it: along every d and a."""
    pose = IDENTITY
    for table, joints, placement in tip.way[:-1]:
        pose = pose @ placement @ forward_kinematics(table, [0.0] * len(joints))
    table, _, placement = tip.way[-1]
    pose = pose @ placement
    path, frames = [pose.translation], [pose]
    axes: list[JointAxis] = []
    pose = pose @ table.base
    path.append(pose.translation)
    frames.append(pose)
    for row in table.rows:
        _, d = joint_variables(row)
        after = pose @ row_transform(table.convention, row)
        # The joint turns about z of the frame before it, in the modified convention about z of its own.
        if table.convention is Convention.STANDARD:
            foot, corner = pose, add(pose.translation, rotate(pose.rotation, (0.0, 0.0, d)))
        else:
            foot, corner = after, add(pose.translation, rotate(pose.rotation, (row.a, 0.0, 0.0)))
        path += [corner, after.translation]
        if row.type is not JointType.FIXED:
            at = foot.translation if table.convention is Convention.STANDARD else corner
            direction = rotate(foot.rotation, (0.0, 0.0, float(row.sign)))
            axes.append(JointAxis(len(axes) + 1, at, direction, row.type is JointType.PRISMATIC))
        pose = after
        frames.append(pose)
    pose = pose @ table.tool
    tool0 = pose.translation
    return Skeleton(((*path, tool0),), tuple(axes), (*frames, pose), (tool0,))


def robot_skeleton(robot: Robot) -> Skeleton:
    """A robot as its joints have it: straight from link to link.

    Of frames that end in one point, such as a flange and tool0, the last one is drawn.

    Raises:
        ValueError: a joint stands before the one that holds it: this is no tree with its parents first.
    """
    poses = {robot.root: IDENTITY}
    ending = {robot.root: [IDENTITY.translation]}
    paths = list(ending.values())
    axes: list[JointAxis] = []
    frames = [IDENTITY]
    for joint in robot.joints:
        if joint.parent not in poses:
            raise ValueError(f"the joint {joint.name!r} has no parent {joint.parent!r} before it")
        pose = poses[joint.child] = poses[joint.parent] @ joint.origin.transform
        path = ending.pop(joint.parent, None)
        if path is None:  # another child of it has gone on with its line
            path = [poses[joint.parent].translation]
            paths.append(path)
        path.append(pose.translation)
        ending[joint.child] = path
        if joint.type is not JointType.FIXED:
            direction = rotate(pose.rotation, joint.axis)
            axes.append(JointAxis(len(axes) + 1, pose.translation, direction, joint.type is JointType.PRISMATIC))
            frames.append(pose)
    ends = {poses[link].translation: poses[link] for link in ending}
    lines = tuple(tuple(path) for path in paths if len(set(path)) > 1)
    return Skeleton(lines, tuple(axes), (*frames, *ends.values()), tuple(ends))
