"""Which chain of a description is the arm: its base link, its tip links, and what keeps a chain from being one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import TableError
from dh2urdf.kinematics import usual_tips
from dh2urdf.manipulator import JointType
from dh2urdf.rotations import norm
from dh2urdf.source import Mark, Messages, did_you_mean, listed, shown
from dh2urdf_plugins.readers.words.bounds import MEASURABLE_ARM

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Sequence

    from dh2urdf.robot import Joint
    from dh2urdf_plugins.descriptions.description import Description

say = Messages(__file__)

EVERY = "*"
"""As a tip link: every leaf that a joint moves."""
_SHOWN = 10
"""How many links a message names."""


class Tree:
    """The links and joints of a description by name."""

    def __init__(self, description: Description, base_link: str | None) -> None:
        """Take the tree of a description, from a base link or from its root."""
        self.description, self.robot = description, description.robot
        self._above: dict[str, Joint] = {}  # by link, the joint that holds it; of several the first
        self._below: dict[str, list[Joint]] = {}  # by link, the joints that it holds
        # Links that several joints hold, or a joint and a constraint, which closes a loop.
        self._doubly = set(description.doubly)
        for joint in self.robot.joints:
            if joint.child in self._above:
                self._doubly.add(joint.child)
            self._above.setdefault(joint.child, joint)
            self._below.setdefault(joint.parent, []).append(joint)
        # The links, those included that only joints name: `world` is there without a word for some.
        links, parents = (link.name for link in self.robot.links), (joint.parent for joint in self.robot.joints)
        self._names = list(dict.fromkeys((*links, *parents)))
        self.base = self._link(base_link, "base_link") if base_link else self._root()

    def _link(self, name: str, option: str) -> str:
        if name not in self._names:
            known, near = listed(self._names, _SHOWN), did_you_mean(name, self._names)
            raise self._error("link-unknown", option, found=name, names=known, suggestion=near)
        return name

    def _root(self) -> str:
        roots = [name for name in self._names if name not in self._above]
        if len(roots) == 1:
            return roots[0]
        if not self.robot.links:
            raise self._error("no-links")
        few = listed([shown(root) for root in roots], _SHOWN)
        raise self._error("several-roots" if roots else "no-root", "base_link", count=len(roots), links=few)

    def _reached(self) -> dict[str, int]:
        """The links below the base link, itself included, each with the moving joints before it."""
        moving = {self.base: 0}
        for joint in self.walk():
            moving[joint.child] = moving[joint.parent] + (joint.type is not JointType.FIXED)
        return moving

    def walk(self, *, without: Container[str] = ()) -> Iterator[Joint]:
        """The joints below the base link, each behind those that hold it; what some joints hold may be left out."""
        met, ahead = {self.base}, [self.base]
        while ahead:
            for joint in self._below.get(ahead.pop(), ()):
                if joint.child not in met and joint.name not in without:
                    met.add(joint.child)
                    ahead.append(joint.child)
                    yield joint

    def leaves(self) -> dict[str, int]:
        """The links that hold nothing, in the order of the file, each with the moving joints before it."""
        reached, names = self._reached(), [link.name for link in self.robot.links]
        return {name: reached[name] for name in names if name in reached and not self._below.get(name)}

    def tips(self, tip_link: str | None) -> list[str]:
        """The tip links that are meant: one by its name, by a usual name, or as the only leaf; or every leaf."""
        if tip_link and tip_link != EVERY:
            return [self._link(tip_link, "tip_link")]
        moved = {name: count for name, count in self._reached().items() if count}
        usual = [] if tip_link else usual_tips(moved)
        if len(usual) == 1:
            return usual
        leaves = {name: count for name, count in self.leaves().items() if count}
        if len(leaves) > 1 and not tip_link:
            counts = {name: moved[name] for name in usual or leaves}
            named = [f"{name} ({count} moving joint{'s' if count > 1 else ''})" for name, count in counts.items()]
            what = "links that may be the tip" if usual else "leaves"
            raise self._error("several-leaves", "tip_link", count=len(named), what=what, leaves=listed(named, _SHOWN))
        return list(leaves or self.leaves())

    def chain(self, tip: str) -> tuple[Joint, ...]:
        """The joints from the base link to a tip link."""
        joints: list[Joint] = []
        link = tip
        while link != self.base:
            joint = self._above.get(link)
            if joint is None or len(joints) > len(self.robot.joints):
                raise self._error("no-way", "tip_link", base=self.base, tip=tip)
            if link in self._doubly:
                holders = "several joints or constraints" if link in self.description.doubly else "several joints"
                raise self._error("chain-in-loop", "tip_link", holders=holders, link=link)
            joints.insert(0, joint)
            link = joint.parent
        able = self._following(joints)
        for joint in joints:
            self._check(joint, able)
        if all(joint.type is JointType.FIXED for joint in joints):
            raise self._error("chain-without-motion", "tip_link", base=self.base, tip=tip)
        return tuple(joints)

    def _following(self, joints: Sequence[Joint]) -> set[str]:
        """The joints that a table can have as followers: of others of the chain, by linear laws."""
        slides = {
            joint.name: joint.type is JointType.PRISMATIC for joint in joints if joint.type is not JointType.FIXED
        }
        laws = [(name, law) for name, law in self.robot.followers.items() if name in slides and not law.higher]
        return {name for name, law in laws if slides.get(law.leader) is slides[name]}

    def _check(self, joint: Joint, followers: Container[str]) -> None:
        """Refuses a joint that is faulty, or that no table has."""
        if (faulty := self.description.faulty.get(joint.name)) is not None and faulty.fault is not None:
            raise TableError(faulty.fault)
        loose, name, law = self.description.loose, joint.name, joint.follows
        if name in loose or (law and name not in followers):
            leader = shown(law.leader) if law and law.leader else "another joint"
            what = f"is {loose[name]}" if name in loose else f"mimics {leader}"
            raise self._error("joint-not-own", joint=joint, what=what)
        numbers = (*joint.origin.xyz, *joint.origin.rpy, *joint.axis)
        if not all(abs(number) <= MEASURABLE_ARM for number in numbers):
            raise self._error("joint-beyond-arms", joint=joint, most=MEASURABLE_ARM)
        if joint.type is not JointType.FIXED and not norm(joint.axis):
            raise self._error("axis-of-length-0", joint=joint)

    def _error(self, code: str, field: str | None = None, joint: Joint | None = None, **words: Any) -> TableError:  # noqa: ANN401 - of a message
        mark = (joint.mark if joint else None) or Mark(file=self.description.file)
        return TableError(say(code, mark, joint=joint.name if joint else None, field=field, **words))
