"""Which chain of a description is the arm: its base link, its tip links, and what keeps a chain from being one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.kinematics import USUAL_TIPS
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Joint
from dh2urdf.rotations import norm
from dh2urdf.source import Mark, Problem, did_you_mean, listed, shown
from dh2urdf_plugins.descriptions.description import Description
from dh2urdf_plugins.readers.words.bounds import MEASURABLE_ARM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.robot import Robot

EVERY = "*"
"""As a tip link: every leaf that a joint moves."""
_SHOWN = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Tree:
    """The links and joints of a description by name.

    Attributes:
        description: the description.
        above: by link, the joint that holds it; of several the first.
        below: by link, the joints that it holds.
        doubly: links that several joints hold, or a joint and a constraint, which closes a loop.
        base: the base link.
    """

    description: Description
    above: dict[str, Joint]
    below: dict[str, list[Joint]]
    doubly: frozenset[str]
    base: str

    @classmethod
    def of(cls, description: Description, base_link: str | None) -> Tree:
        """The tree of a description.

        Raises:
            TableError: there is no such link, or no root, or several.
        """
        robot = description.robot
        above, below, doubly = dict[str, "Joint"](), dict[str, list["Joint"]](), set(description.doubly)
        for joint in robot.joints:
            if joint.child in above:
                doubly.add(joint.child)
            above.setdefault(joint.child, joint)
            below.setdefault(joint.parent, []).append(joint)
        base = _link(description, base_link, "base_link") if base_link else _root(description, above)
        return cls(description=description, above=above, below=below, doubly=frozenset(doubly), base=base)

    @property
    def robot(self) -> Robot:
        """The robot of the description."""
        return self.description.robot

    def reached(self) -> dict[str, int]:
        """The links below the base link, itself included, each with the moving joints before it."""
        moving, ahead = {self.base: 0}, [self.base]
        while ahead:
            link = ahead.pop()
            for joint in self.below.get(link, ()):
                if joint.child not in moving:
                    moving[joint.child] = moving[link] + (joint.type is not JointType.FIXED)
                    ahead.append(joint.child)
        return moving

    def leaves(self) -> dict[str, int]:
        """The links that hold nothing, in the order of the file, each with the moving joints before it."""
        reached = self.reached()
        return {
            link.name: reached[link.name]
            for link in self.robot.links
            if link.name in reached and not self.below.get(link.name)
        }

    def tips(self, tip_link: str | None) -> list[str]:
        """The tip links that are meant.

        Raises:
            TableError: there is no such link, or which of several leaves is meant is not said.
        """
        if tip_link == EVERY:
            leaves = self.leaves()
            return [name for name, count in leaves.items() if count] or list(leaves)
        if tip_link:
            return [_link(self.description, tip_link, "tip_link")]
        reached = self.reached()
        if usual := next((name for name in USUAL_TIPS if reached.get(name)), None):
            return [usual]
        leaves = {name: count for name, count in self.leaves().items() if count}
        if len(leaves) > 1:
            named = [f"{name} ({count} moving joint{'s' if count > 1 else ''})" for name, count in leaves.items()]
            raise self._error(
                f"the description has {len(leaves)} leaves: {listed(named, _SHOWN)}",
                "tip_link",
                accepted="the name of a link, or * for every leaf",
                suggestion="the option tip_link chooses one",
            )
        return list(leaves) or list(self.leaves())

    def chain(self, tip: str) -> tuple[Joint, ...]:
        """The joints from the base link to a tip link.

        Raises:
            TableError: there is no way, or a joint on it has no place in a table.
        """
        joints: list[Joint] = []
        link = tip
        while link != self.base:
            joint = self.above.get(link)
            if joint is None or len(joints) > len(self.robot.joints):
                raise self._error(
                    f"no chain leads from link {shown(self.base)} to link {shown(tip)}",
                    "tip_link",
                    suggestion="the options base_link and tip_link choose the ends",
                )
            if link in self.doubly:
                holders = "several joints" if link not in self.description.doubly else "several joints or constraints"
                raise self._error(
                    f"{holders} hold the link {shown(link)}: the chain is part of a loop",
                    "tip_link",
                    suggestion="the option tip_link chooses a link before it; a table is a chain without loops",
                )
            joints.append(joint)
            link = joint.parent
        joints.reverse()
        self._refuse(joints, tip)
        return tuple(joints)

    def _refuse(self, joints: Sequence[Joint], tip: str) -> None:
        for joint in joints:
            if (word := self.description.loose.get(joint.name)) is not None:
                raise self._error(
                    f"the chain holds {shown(joint.name)}, which is {word}",
                    joint=joint,
                    accepted="joints that turn about or slide along one axis",
                    suggestion=self._way_round(joints, joint),
                )
            if (follower := self.description.followers.get(joint.name)) is not None:
                whom = shown(follower.leader) if follower.leader else "another joint"
                raise self._error(
                    f"the chain holds {shown(joint.name)}, which mimics {whom}",
                    joint=joint,
                    accepted="joints that move on their own",
                    suggestion=self._way_round(joints, joint),
                )
            numbers = (*joint.origin.xyz, *joint.origin.rpy, *joint.axis)
            if not all(abs(number) <= MEASURABLE_ARM for number in numbers):
                raise self._error(
                    "its origin or its axis holds a number that no arm has",
                    joint=joint,
                    accepted=f"numbers up to {MEASURABLE_ARM:g}",
                )
            if joint.type is not JointType.FIXED and not norm(joint.axis):
                raise self._error("the axis of the joint has no length", joint=joint, accepted="a direction")
        if all(joint.type is JointType.FIXED for joint in joints):
            raise self._error(
                f"no joint moves between link {shown(self.base)} and link {shown(tip)}",
                "tip_link",
                accepted="a chain with a joint that moves",
                suggestion="the option tip_link chooses another end",
            )

    def _way_round(self, joints: Sequence[Joint], joint: Joint) -> str:
        """The ends of the parts of a chain before and behind a joint in which a joint moves on its own."""
        unfit = self.description.loose.keys() | self.description.followers.keys()
        at = joints.index(joint)
        before, behind = (
            any(each.type is not JointType.FIXED and each.name not in unfit for each in part)
            for part in (joints[:at], joints[at + 1 :])
        )
        ways = [f"tip_link: {joint.parent} ends before it"] * before + [
            f"base_link: {joint.child} begins behind it"
        ] * behind
        if not ways:
            return "the option tip_link chooses the end of another chain"
        return f"the option {', or '.join(ways)}"

    def _error(
        self,
        message: str,
        field: str | None = None,
        *,
        joint: Joint | None = None,
        accepted: str | None = None,
        suggestion: str | None = None,
    ) -> TableError:
        mark = joint.mark if joint is not None and joint.mark else Mark(file=self.description.file)
        name = None if joint is None else joint.name
        return TableError(
            Problem(message=message, mark=mark, joint=name, field=field, accepted=accepted, suggestion=suggestion)
        )


def _names(description: Description) -> list[str]:
    """The links, those included that only joints name: `world` is there without a word for some."""
    links = [link.name for link in description.robot.links]
    return list(dict.fromkeys([*links, *(joint.parent for joint in description.robot.joints)]))


def _link(description: Description, name: str, option: str) -> str:
    names = _names(description)
    if name not in names:
        raise TableError(
            Problem(
                message=f"the description has no link {shown(name)}",
                mark=Mark(file=description.file),
                field=option,
                found=name,
                accepted=listed(names, _SHOWN),
                suggestion=did_you_mean(name, names),
            )
        )
    return name


def _root(description: Description, above: dict[str, Joint]) -> str:
    roots = [name for name in _names(description) if name not in above]
    if len(roots) == 1:
        return roots[0]
    if len(roots) > 1:
        message = f"{len(roots)} links have no parent: {listed([shown(root) for root in roots], _SHOWN)}"
        suggestion = "the option base_link chooses one"
    elif description.robot.links:
        message, suggestion = (
            "no link is the root: the joints form a loop",
            "the options base_link and tip_link choose a chain",
        )
    else:
        raise TableError(
            Problem(
                message="the description has no links",
                mark=Mark(file=description.file),
                accepted="a robot with links and joints",
                suggestion="an SRDF and a file of macros have none: give the file that has them, or calls the macros",
            )
        )
    raise TableError(
        Problem(message=message, mark=Mark(file=description.file), field="base_link", suggestion=suggestion)
    )
