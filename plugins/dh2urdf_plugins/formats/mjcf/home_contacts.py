"""The links of an arm that touch each other where it starts, found without a collision library.

Links are drawn thicker than they are, from joint to joint: those of a folded wrist overlap, and a simulator would push
them apart. Every shape but a mesh is taken for the capsule around it: all points within a radius of a segment.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from dh2urdf.kinematics import link_poses
from dh2urdf.robot_check.contacts import capsule_around, overlap, placed_capsule
from dh2urdf_plugins.home_pose import stepped

if TYPE_CHECKING:
    from dh2urdf.robot import Robot


def touching_at_home(robot: Robot) -> list[tuple[str, str]]:
    """The pairs of links that touch at home, or where all joints have made a step from there, to either side."""
    capsules = {link.name: [each for each in map(capsule_around, link.collisions) if each] for link in robot.links}
    found: dict[tuple[str, str], None] = {}
    for steps in (0.0, -1.0, 1.0):
        frames = link_poses(robot, {each.name: stepped(each, steps) for each in robot.actuated_joints})
        placed = [(name, placed_capsule(each, frames[name])) for name, shapes in capsules.items() for each in shapes]
        for (first, one), (second, other) in combinations(placed, 2):
            if first != second and overlap(one, other):
                found[first, second] = None
    return list(found)
