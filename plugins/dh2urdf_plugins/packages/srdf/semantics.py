"""What MoveIt has to know of a robot: how it is held, its groups, and named states.

The elements are those that srdfdom reads (moveit/srdfdom, src/model.cpp).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.errors import EmitterError
from dh2urdf.kinematics import KinematicChain
from dh2urdf.manipulator import ENDS, TOOL, WORLD
from dh2urdf.quantities import format_numbers
from dh2urdf.source import Messages, free_name
from dh2urdf_plugins.formats.urdf.writer import Notation
from dh2urdf_plugins.home_pose import initial_position

if TYPE_CHECKING:
    from dh2urdf.robot import Arm, Joint, Robot
    from dh2urdf_plugins.collision_pairs.search import CollisionPairs

say = Messages(__file__)

EVERY_ARM = "all"  # the group of all arms of a cell


class Group(NamedTuple):
    """The joints that are planned for together."""

    name: str  # its name
    base: str  # the link where its chain begins
    tip: str  # the link where it ends
    joints: tuple[Joint, ...]  # its moving joints


def arms_of(robot: Robot) -> list[tuple[str, Robot]]:
    """The arms of a robot with their prefixes: those of a cell, or the robot itself."""
    return [(arm.prefix, arm.kind) for arm in robot.arms] or [("", robot)]


def groups(robot: Robot, name: str) -> list[Group]:
    """A group for each arm that moves: the name alone, or behind the prefix of the arm in a cell."""
    if not name.strip() or (len(robot.arms) > 1 and any(arm.prefix + name == EVERY_ARM for arm in robot.arms)):
        raise EmitterError(say("group-name-wrong", field="group", found=name, every=EVERY_ARM))
    found = []
    for prefix, kind in arms_of(robot):
        links = [link.name for link in kind.links]
        base, tip = prefix + kind.root, prefix + (TOOL if TOOL in links else links[-1])
        chain = KinematicChain.between(robot, base, tip)
        joints = tuple(joint for joint in chain.moving if joint.name not in chain.followers)
        if joints:
            found.append(Group(prefix + name, base, tip, joints))
    return found


def chains(robot: Robot, name: str) -> list[Group]:
    """A group for each arm on another arm, from where the lowest one stands; none for what an arm holds as its tool."""
    owners = {arm.prefix + link.name: arm for arm in robot.arms for link in arm.kind.links}
    own = {group.tip: group for group in groups(robot, name)}
    taken = {EVERY_ARM, *(group.name for group in own.values())}
    found = []
    for arm in robot.arms:
        group = next((each for tip, each in own.items() if owners[tip] is arm), None)
        holders = [arm]
        while holder := owners.get(holders[0].parent):
            holders.insert(0, holder)
        if group is None or len(holders) == 1 or _is_tool(arm, holders[-2]):
            continue
        base = holders[0].prefix + holders[0].kind.root
        joints = KinematicChain.between(robot, base, group.tip).moving
        if len(joints) > len(group.joints):
            chain = free_name("_".join((*(each.name for each in holders), name)), taken)
            taken.add(chain)
            found.append(Group(chain, base, group.tip, joints))
    return found


def _is_tool(arm: Arm, holder: Arm) -> bool:
    """Whether an arm is what another one holds, such as a gripper: at its flange or tool, with fewer joints."""
    is_at_end = arm.parent in {holder.prefix + end for end in ENDS}
    return is_at_end and 0 < len(arm.kind.moving_joints) < len(holder.kind.moving_joints)


def semantics(robot: Robot, pairs: CollisionPairs, group_name: str) -> etree._Element:
    """The SRDF of a robot or a cell."""
    notation = Notation()
    root = etree.Element("robot", name=notation.text(robot.name))
    if robot.root != WORLD:
        name = free_name("virtual_joint", {joint.name for joint in robot.joints})
        held = {"name": name, "type": "fixed", "parent_frame": WORLD, "child_link": robot.root}
        _append(root, "virtual_joint", held, notation)
    found = groups(robot, group_name)
    whole = chains(robot, group_name)
    for group in (*found, *whole):
        element = _append(root, "group", {"name": group.name}, notation)
        _append(element, "chain", {"base_link": group.base, "tip_link": group.tip}, notation)
    if len(found) > 1:
        element = _append(root, "group", {"name": EVERY_ARM}, notation)
        for group in found:
            _append(element, "group", {"name": group.name}, notation)
        found.append(Group(EVERY_ARM, "", "", tuple(joint for group in found for joint in group.joints)))
    for group in (*found, *whole):
        positions = [initial_position(joint) for joint in group.joints]
        element = _append(
            root, "group_state", {"name": "home" if any(positions) else "zero", "group": group.name}, notation
        )
        for joint, position in zip(group.joints, positions, strict=True):
            _append(element, "joint", {"name": joint.name, "value": format_numbers((position,))[0]}, notation)
    arms = {arm.prefix + end: arm for arm in robot.arms for end in ENDS}
    for arm in robot.arms:
        if (holder := arms.get(arm.parent)) and _is_tool(arm, holder):
            own, parent = (each.prefix + group_name for each in (arm, holder))
            words = {"name": arm.name, "parent_link": arm.parent, "group": own, "parent_group": parent}
            _append(root, "end_effector", words, notation)
    for pair in pairs.disabled:
        _append(root, "disable_collisions", pair._asdict(), notation)
    return root


def _append(parent: etree._Element, tag: str, words: dict[str, str], notation: Notation) -> etree._Element:
    return etree.SubElement(parent, tag, {name: notation.text(word) for name, word in words.items()})
