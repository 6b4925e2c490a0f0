"""Arms and parts that nothing holds in the world.

A robot has them on its root, the link `world`, by fixed joints whose origins are where they are at first. MJCF has a
joint for that, and SDF no joint. URDF leaves the world out: what floats is the root then, of which there is one.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.errors import EmitterError, ProofError
from dh2urdf.manipulator import WORLD
from dh2urdf.robot import Link
from dh2urdf.source import Messages, listed

if TYPE_CHECKING:
    from dh2urdf.robot import Robot
    from dh2urdf.rotations import RigidTransform

say = Messages(__file__)


def without_world(robot: Robot) -> Robot:
    """The robot as a format has it in which nothing can float but the root; itself, where nothing floats.

    Raises:
        EmitterError: something else is on the world, too.
    """
    if not robot.floating or robot.root in robot.floating:
        return robot
    (root, *others) = [joint.child for joint in robot.joints if joint.parent == robot.root]
    if others:
        floating, links = listed(robot.floating, 5), listed([root, *others], 5)
        raise EmitterError(say("world-of-several", robot=robot.name, floating=floating, links=links))
    return replace(
        robot,
        links=robot.links[1:],
        joints=tuple([joint for joint in robot.joints if joint.child != root]),
        arms=tuple([replace(arm, parent="") if arm.parent == robot.root else arm for arm in robot.arms]),
        attachments=tuple(
            [replace(each, parent="") if each.parent == robot.root else each for each in robot.attachments]
        ),
    )


def start_of(robot: Robot, root: str) -> RigidTransform:
    """Where a link that floats is at first: T(world → link)."""
    return next(joint for joint in robot.joints if joint.child == root).origin.transform


def with_world(robot: Robot, written: Robot) -> Robot:
    """What was read back from a file, its root in the world, where the file leaves the world out."""
    if written.root not in robot.floating:
        return written
    start = next(joint for joint in robot.joints if joint.child == written.root)
    links, joints = (Link(name=WORLD), *written.links), (start, *written.joints)
    return replace(written, links=links, joints=joints, floating=(written.root,))


def prove_floating(robot: Robot, written: Robot) -> None:
    """Check that what was read back from a file floats as the robot that was written.

    Raises:
        ProofError: something is held that floats in the robot, or the other way round.
    """
    above = {joint.child: joint.parent for joint in written.held_rigidly if joint.parent != written.root}

    def body(link: str) -> str:
        while link in above:
            link = above[link]
        return link

    wanted = {body(link): link for link in robot.floating}
    if robot.floating and wanted.keys() != {*written.floating}:
        found, floating = listed(sorted(written.floating), 5) or "none", listed(robot.floating, 5)
        raise ProofError(say("floats-otherwise", robot=robot.name, found=found, wanted=floating))
