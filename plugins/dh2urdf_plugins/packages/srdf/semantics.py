"""What MoveIt has to know of a robot: how it is held, its groups, and named states.

The elements are those that srdfdom reads (moveit/srdfdom, src/model.cpp).
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.documents import prefixed_srdf
from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import TOOL, WORLD, JointType
from dh2urdf.quantities import format_numbers
from dh2urdf.robot import Arm, Origin
from dh2urdf.source import Messages, free_name
from dh2urdf_plugins.formats import numbered_name
from dh2urdf_plugins.formats.urdf.writer import Notation
from dh2urdf_plugins.home_pose import initial_position

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Attachment, Joint, Robot
    from dh2urdf_plugins.collision_pairs.search import CollisionPairs

say = Messages(__file__)

EVERY_ARM = "all"  # the group of all arms of a cell


class Group(NamedTuple):
    """Joints that are planned for together."""

    name: str
    joints: tuple[Joint, ...]  # those that move by themselves
    members: tuple[tuple[str, dict[str, str]], ...]  # its elements: tags and attributes
    base: str = ""  # of a chain, the link where it begins
    tip: str = ""  # of a chain, the link where it ends


def arms_of(robot: Robot) -> tuple[Arm, ...]:
    """The arms of a cell, or the robot itself as the only one, on nothing."""
    return robot.arms or (Arm(name="", kind=robot, prefix="", parent="", placement=Origin()),)


def moving_attachments(robot: Robot, name: str) -> dict[str, Attachment]:
    """The attachments that move, by names of their own among arms and their groups, which are called `name`."""
    prefixes = [arm.prefix for arm in arms_of(robot)]
    taken = {EVERY_ARM, *(prefix + name for prefix in prefixes), *(prefix.removesuffix("_") for prefix in prefixes)}
    found: dict[str, Attachment] = {}
    for each in robot.attachments:
        if each.robot.actuated_joints:
            found[numbered_name(each.name, {*taken, *found})] = each
    return found


class Semantics:
    """The groups of a robot, and what is at the ends of its arms.

    Args:
        robot: a robot or a cell.
        name: the name of the group of an arm, which is behind the prefix of the arm in a cell.

    Attributes:
        groups: a chain for each arm that moves; a chain for each arm on what moves, from where the lowest of it stands;
            one of all arms; and the links of each attachment that moves.
        end_effectors: the attributes of each attachment, and of each arm with fewer joints, at the end of an arm.

    Raises:
        EmitterError: no group can have the name.
    """

    def __init__(self, robot: Robot, name: str) -> None:
        if not name.strip() or (len(robot.arms) > 1 and any(arm.prefix + name == EVERY_ARM for arm in robot.arms)):
            raise EmitterError(say("group-name-wrong", field="group", found=name, every=EVERY_ARM))
        every, self._followers = arms_of(robot), robot.followers
        self._above = {joint.child: joint for joint in robot.joints}
        # By the names of their links; those of attachments are among the links of their arms, too.
        self._parts: dict[str, Arm | Attachment] = {
            each.prefix + link.name: each for each in every for link in each.kind.links
        }
        self._parts |= {each.prefix + link.name: each for each in robot.attachments for link in each.robot.links}
        chains = [(arm, self._chain(arm.prefix + name, _root(arm), self._tip(arm, robot))) for arm in every]
        arms = [(arm, group) for arm, group in chains if group.joints]
        others = []
        for own, each in moving_attachments(robot, name).items():
            names = {each.prefix + inner for inner in each.names}
            joints = tuple([joint for joint in robot.actuated_joints if joint.name in names])
            links = tuple([("link", {"name": link.name}) for link in robot.links if link.name in names])
            others.append((each, Group(own, joints, links)))
        self.end_effectors = [*self._ends([group for _, group in arms], [*others, *arms])]
        tools = {each["group"] for each in self.end_effectors}
        self.groups = [group for _, group in arms]
        for arm, group in arms:
            way = self._holders(arm)
            own = free_name(
                "_".join((*(each.name for each in way), name)), {EVERY_ARM, *(each.name for each in self.groups)}
            )
            whole = self._chain(own, _root(way[0]), group.tip)
            if group.name not in tools and len(whole.joints) > len(group.joints):
                self.groups.append(whole)
        if len(arms) > 1:
            joints = tuple([joint for _, group in arms for joint in group.joints])
            self.groups.append(Group(EVERY_ARM, joints, tuple([("group", {"name": group.name}) for _, group in arms])))
        self.groups += [group for _, group in others]

    @property
    def chains(self) -> list[Group]:
        """The groups that are chains."""
        return [group for group in self.groups if group.base]

    def _holders(self, part: Arm | Attachment) -> list[Arm | Attachment]:
        """What a part is on, the lowest first, and the part."""
        way = [part]
        while holder := self._parts.get(way[0].parent):
            way.insert(0, holder)
        return way

    def _tip(self, arm: Arm, robot: Robot) -> str:
        """Where the group of an arm ends: at tool0, or at the tip of the last attachment that has one and is on it."""
        own = [link for each in arm.kind.links if self._parts[link := arm.prefix + each.name] is arm]
        tip = arm.prefix + TOOL if arm.prefix + TOOL in own else own[-1]
        for each in (each for each in robot.attachments if each.tip is not None):
            bearing = [part for part in self._holders(each) if isinstance(part, Arm)]
            tip = f"{each.prefix}{each.tip}" if bearing and bearing[-1] is arm else tip
        return tip

    def _way(self, base: str, tip: str) -> list[Joint]:
        """The joints from a link to one that is on it."""
        way: list[Joint] = []
        while tip != base:
            way.insert(0, self._above[tip])
            tip = way[0].parent
        return way

    def _chain(self, name: str, base: str, tip: str) -> Group:
        moving = [joint for joint in self._way(base, tip) if joint.type is not JointType.FIXED]
        joints = tuple([joint for joint in moving if joint.name not in self._followers])
        return Group(name, joints, (("chain", {"base_link": base, "tip_link": tip}),), base, tip)

    def _rigid(self, link: str) -> list[str]:
        """A link, and those that fixed joints above it join with it."""
        way = [link]
        while (joint := self._above.get(way[-1])) and joint.type is JointType.FIXED:
            way.append(joint.parent)
        return way

    def _ends(self, arms: list[Group], others: list[tuple[Arm | Attachment, Group]]) -> Iterator[dict[str, str]]:
        """The attributes of what nothing that moves is between and the tip of an arm.

        MoveIt looks for the parent link in the parent group: a flange beside the way to tool0 is in none.
        """
        tips = {self._rigid(arm.tip)[-1]: arm for arm in arms}
        for part, group in others:
            way = self._rigid(part.parent)
            if (arm := tips.get(way[-1])) and (not group.base or len(group.joints) < len(arm.joints)):
                inside = {arm.base, *(joint.child for joint in self._way(arm.base, arm.tip))}
                parent = next(link for link in way if link in inside)
                name = part.name if group.base else group.name
                yield {"name": name, "parent_link": parent, "group": group.name, "parent_group": arm.name}


def _root(part: Arm | Attachment) -> str:
    """The root of a part in the whole robot."""
    return part.prefix + (part.kind if isinstance(part, Arm) else part.robot).root


def semantics(robot: Robot, pairs: CollisionPairs, group_name: str) -> etree._Element:
    """The SRDF of a robot or a cell."""
    notation, found = Notation(), Semantics(robot, group_name)
    root = etree.Element("robot", name=notation.text(robot.name))

    def append(tag: str, words: dict[str, str], parent: etree._Element = root) -> etree._Element:
        return etree.SubElement(parent, tag, {name: notation.text(word) for name, word in words.items()})

    if robot.root != WORLD:
        name = free_name("virtual_joint", {joint.name for joint in robot.joints})
        kind = "floating" if robot.root in robot.floating else "fixed"
        append("virtual_joint", {"name": name, "type": kind, "parent_frame": WORLD, "child_link": robot.root})
    for group in found.groups:
        element = append("group", {"name": group.name})
        for tag, words in group.members:
            append(tag, words, element)
    for group in found.groups:
        positions = [initial_position(joint) for joint in group.joints]
        element = append("group_state", {"name": "home" if any(positions) else "zero", "group": group.name})
        for joint, position in zip(group.joints, positions, strict=True):
            append("joint", {"name": joint.name, "value": format_numbers((position,))[0]}, element)
    carried = [prefixed_srdf(text, each.prefix) for each in robot.attachments for text in each.semantics]
    names = [group.name for group in found.groups] + [str(each.get("name")) for each in carried if each.tag == "group"]
    if twice := [name for name, count in Counter(names).items() if count > 1]:
        raise EmitterError(say("srdf-group-taken", field="group", found=twice[0]))
    passive = {each.get("name") for each in carried if each.tag == "passive_joint"}
    decided = {frozenset((each.get("link1"), each.get("link2"))) for each in carried}
    others = [("end_effector", words) for words in found.end_effectors]
    others += [("passive_joint", {"name": follower}) for follower in robot.followers if follower not in passive]
    others += [("disable_collisions", pair._asdict()) for pair in pairs.disabled if frozenset(pair[:2]) not in decided]
    for tag, words in others:
        append(tag, words)
    root.extend(carried)
    return root
