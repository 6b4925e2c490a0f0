"""What MoveIt has to know of a robot: how it is held, its groups, and named states.

The elements are those that srdfdom reads (moveit/srdfdom, src/model.cpp).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.errors import EmitterError
from dh2urdf.kinematics import KinematicChain
from dh2urdf.manipulator import ENDS, TOOL, WORLD, JointType
from dh2urdf.quantities import format_numbers
from dh2urdf.source import Messages, free_name
from dh2urdf_plugins.formats import numbered_name
from dh2urdf_plugins.formats.urdf.writer import Notation
from dh2urdf_plugins.home_pose import initial_position

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from dh2urdf.robot import Arm, Attachment, Joint, Robot
    from dh2urdf_plugins.collision_pairs.search import CollisionPairs

say = Messages(__file__)

EVERY_ARM = "all"  # the group of all arms of a cell


class Group(NamedTuple):
    """The joints that are planned for together."""

    name: str  # its name
    base: str  # the link where its chain begins
    tip: str  # the link where it ends
    joints: tuple[Joint, ...]  # its actuated joints


def arms_of(robot: Robot) -> list[tuple[str, Robot]]:
    """The arms of a robot with their prefixes: those of a cell, or the robot itself."""
    return [(arm.prefix, arm.kind) for arm in robot.arms] or [("", robot)]


def groups(robot: Robot, name: str) -> list[Group]:
    """A group for each arm that moves: the name alone, or behind the prefix of the arm in a cell.

    It ends at tool0, or at the tip of the last attachment that has one and that the arm bears.
    """
    if not name.strip() or (len(robot.arms) > 1 and any(arm.prefix + name == EVERY_ARM for arm in robot.arms)):
        raise EmitterError(say("group-name-wrong", field="group", found=name, every=EVERY_ARM))
    found, foreign = [], robot.foreign_names
    above = {joint.child: joint.parent for joint in robot.joints}
    for prefix, kind in arms_of(robot):
        links = [prefix + link.name for link in kind.links if prefix + link.name not in foreign]
        base, tip = prefix + kind.root, prefix + TOOL if prefix + TOOL in links else links[-1]
        for each in (each for each in robot.attachments if each.tip is not None):
            link: str | None = each.parent
            while link in foreign:
                link = above.get(link)
            tip = f"{each.prefix}{each.tip}" if link in links else tip
        if joints := _actuated(robot, base, tip):
            found.append(Group(prefix + name, base, tip, joints))
    return found


def chains(robot: Robot, name: str) -> list[Group]:
    """A group for each arm on another arm, from where the lowest one stands; none for what an arm holds as its tool."""
    owners = {arm.prefix + link.name: arm for arm in robot.arms for link in arm.kind.links}
    own = {group.name: group for group in groups(robot, name)}
    taken = {EVERY_ARM, *own}
    found = []
    for arm in robot.arms:
        group = own.get(arm.prefix + name)
        holders = [arm]
        while holder := owners.get(holders[0].parent):
            holders.insert(0, holder)
        if group is None or len(holders) == 1 or _is_tool(arm, holders[-2]):
            continue
        base = holders[0].prefix + holders[0].kind.root
        joints = _actuated(robot, base, group.tip)
        if len(joints) > len(group.joints):
            chain = free_name("_".join((*(each.name for each in holders), name)), taken)
            taken.add(chain)
            found.append(Group(chain, base, group.tip, joints))
    return found


def _actuated(robot: Robot, base: str, tip: str) -> tuple[Joint, ...]:
    followers = robot.followers
    return tuple([joint for joint in KinematicChain.between(robot, base, tip).moving if joint.name not in followers])


def _is_tool(arm: Arm, holder: Arm) -> bool:
    """Whether an arm is what another one holds, such as a gripper: at its flange or tool, with fewer joints."""
    is_at_end = arm.parent in {holder.prefix + end for end in ENDS}
    return is_at_end and 0 < len(arm.kind.moving_joints) < len(holder.kind.moving_joints)


def moving_attachments(robot: Robot, name: str) -> dict[str, Attachment]:
    """The attachments that move, by names of their own among arms and their groups, which are called `name`."""
    prefixes = [prefix for prefix, _ in arms_of(robot)]
    taken = {EVERY_ARM, *(prefix + name for prefix in prefixes), *(prefix.removesuffix("_") for prefix in prefixes)}
    found: dict[str, Attachment] = {}
    for each in robot.attachments:
        if each.robot.actuated_joints:
            found[numbered_name(each.name, {*taken, *found})] = each
    return found


def semantics(robot: Robot, pairs: CollisionPairs, group_name: str) -> etree._Element:
    """The SRDF of a robot or a cell."""
    notation = Notation()
    root = etree.Element("robot", name=notation.text(robot.name))
    if robot.root != WORLD:
        name = free_name("virtual_joint", {joint.name for joint in robot.joints})
        held = {"name": name, "type": "fixed", "parent_frame": WORLD, "child_link": robot.root}
        _append(root, "virtual_joint", held, notation)
    arms, parts = groups(robot, group_name), moving_attachments(robot, group_name)
    for group in _append_groups(root, arms, chains(robot, group_name), _groups_of(robot, parts)):
        positions = [initial_position(joint) for joint in group.joints]
        state = {"name": "home" if any(positions) else "zero", "group": group.name}
        element = _append(root, "group_state", state, notation)
        for joint, position in zip(group.joints, positions, strict=True):
            _append(element, "joint", {"name": joint.name, "value": format_numbers((position,))[0]}, notation)
    for words in _end_effectors(robot, arms, parts, group_name):
        _append(root, "end_effector", words, notation)
    for follower in robot.followers:
        _append(root, "passive_joint", {"name": follower}, notation)
    for pair in pairs.disabled:
        _append(root, "disable_collisions", pair._asdict(), notation)
    return root


def _groups_of(robot: Robot, parts: Mapping[str, Attachment]) -> Iterator[tuple[Group, list[str]]]:
    """The groups of attachments, each with its links."""
    for name, each in parts.items():
        own = {each.prefix + joint.name for joint in each.robot.actuated_joints}
        joints = tuple([joint for joint in robot.joints if joint.name in own])
        yield Group(name, "", "", joints), [each.prefix + link.name for link in each.robot.links]


def _append_groups(
    root: etree._Element, arms: list[Group], chains: list[Group], parts: Iterable[tuple[Group, list[str]]]
) -> list[Group]:
    """Appends the groups of arms, of chains of them, of all arms, and of attachments; returns those with a state."""
    notation, found = Notation(), list(arms)
    for group in (*arms, *chains):
        element = _append(root, "group", {"name": group.name}, notation)
        _append(element, "chain", {"base_link": group.base, "tip_link": group.tip}, notation)
    if len(arms) > 1:
        element = _append(root, "group", {"name": EVERY_ARM}, notation)
        for group in arms:
            _append(element, "group", {"name": group.name}, notation)
        found.append(Group(EVERY_ARM, "", "", tuple(joint for group in arms for joint in group.joints)))
    for group, links in parts:
        element = _append(root, "group", {"name": group.name}, notation)
        for link in links:
            _append(element, "link", {"name": link}, notation)
        chains = [*chains, group]
    return [*found, *chains]


def _end_effectors(
    robot: Robot, groups_of_arms: Sequence[Group], parts: Mapping[str, Attachment], group: str
) -> Iterator[dict[str, str]]:
    """The attributes of what is at the ends of arms."""
    for name, each in parts.items():
        if end := _end_of_an_arm(robot, each, groups_of_arms):
            yield {"name": name, "parent_link": end[0], "group": name, "parent_group": end[1]}
    arms = {arm.prefix + end: arm for arm in robot.arms for end in ENDS}
    for arm in robot.arms:
        if (holder := arms.get(arm.parent)) and _is_tool(arm, holder):
            own, parent = (each.prefix + group for each in (arm, holder))
            yield {"name": arm.name, "parent_link": arm.parent, "group": own, "parent_group": parent}


def _end_of_an_arm(robot: Robot, attachment: Attachment, arms: Sequence[Group]) -> tuple[str, str] | None:
    """The link of a group that bears an attachment, and the group, where nothing between it and the tip moves.

    MoveIt looks for the link in the group: a flange beside the way to tool0 is in none.
    """
    above = {joint.child: joint for joint in robot.joints}
    for group in arms:
        inside = {group.base, *(joint.child for joint in KinematicChain.between(robot, group.base, group.tip).joints)}
        link = attachment.parent
        while link not in inside and (joint := above.get(link)) and joint.type is JointType.FIXED:
            link = joint.parent
        behind = KinematicChain.between(robot, link, group.tip).joints if link in inside else ()
        if link in inside and all(joint.type is JointType.FIXED for joint in behind):
            return link, group.name
    return None


def _append(parent: etree._Element, tag: str, words: dict[str, str], notation: Notation) -> etree._Element:
    return etree.SubElement(parent, tag, {name: notation.text(word) for name, word in words.items()})
