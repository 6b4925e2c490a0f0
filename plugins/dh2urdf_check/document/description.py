"""Links and joints of a robot description, as far as they are there, and the form in which rules say what they find."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from dh2urdf.source import listed, shown
from dh2urdf_check.document.tree import Element

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping
    from pathlib import Path


T = TypeVar("T")

ALL = frozenset({"pybullet", "mujoco", "pinocchio", "drake", "ros", "gazebo", "coppeliasim"})
"""The readers that were tried with every rule."""
MOVING = ("revolute", "continuous", "prismatic", "floating", "planar")
TURNING_OR_SLIDING = ("revolute", "continuous", "prismatic")
"""The types of joints that have an axis and one value."""
TYPES = (*MOVING, "fixed")
SHAPES = {
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "sphere": ("radius",),
    "capsule": ("radius", "length"),
    "mesh": ("filename",),
}
"""Shapes with the attributes that they need."""
_FEW = 4


class Hit(NamedTuple):
    """A place where a rule is broken.

    Attributes:
        rule: the rule's name.
        at: the element, or the line.
        message: what is there.
        of: the consumers that it matters to, where the rule as such names more.
    """

    rule: str
    at: Element | int
    message: str
    of: Collection[str] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class LinkNode:
    """A link with a name."""

    name: str
    element: Element

    @property
    def inertial(self) -> Element | None:
        """Its inertial."""
        return self.element.first("inertial")

    @property
    def mass(self) -> float | None:
        """Its mass [kg]; None where there is none, or none that is a number."""
        mass = self.element.first("inertial", "mass")
        return mass.number("value") if mass else None

    @property
    def is_weightless(self) -> bool:
        """Whether it weighs nothing: a text that is no number is not taken for 0."""
        return self.element.first("inertial", "mass") is None or self.mass == 0.0

    @property
    def shapes(self) -> list[Element]:
        """Its visuals and collisions."""
        return [child for child in self.element.children if child.tag in {"visual", "collision"}]


@dataclass(frozen=True, slots=True, eq=False)
class JointNode:
    """A joint; what it lacks is an empty text."""

    name: str
    kind: str
    parent: str
    child: str
    element: Element

    @property
    def is_left_out_by_drake(self) -> bool:
        """Whether its parent or child is an empty name."""
        ends = (self.element.first("parent"), self.element.first("child"))
        return any(end is not None and end.get("link") == "" for end in ends)


class Description:
    """A robot description.

    Attributes:
        root: the element ``robot``.
        path: the file.
        content: its text.
        links: the links that have a name, in the order of the file; of two with one name, both.
        joints: the joints.
        link: the first link of each name.
        packages: the folders of the ROS packages that are known by their names, its own one among them.
        place: where an element stands, as a message says it.
    """

    def __init__(
        self,
        root: Element,
        path: Path,
        content: bytes,
        place: Callable[[Element], str] = lambda at: f"line {at.line}",
        packages: Mapping[str, Path] | None = None,
    ) -> None:
        self.root, self.path, self.content, self.place = root, path, content, place
        self.packages = packages or {}
        self.links = [LinkNode(name, element) for element in root.all("link") if (name := element.get("name"))]
        self.joints = [_joint(element) for element in root.all("joint")]
        self.link = {node.name: node for node in reversed(self.links)}
        self._once: dict[tuple[object, ...], Any] = {}

    def once(self, find: Callable[..., T], *about: object) -> T:
        """What a function finds about this description and parts of it, found once: rules ask it for every link."""
        key = (find, *map(id, about))
        if key not in self._once:
            self._once[key] = find(self, *about)
        return self._once[key]  # type: ignore[no-any-return]  # what `find` has returned

    @cached_property
    def holders(self) -> dict[str, list[JointNode]]:
        """The joints that move a link, by the link's name; only those between links that are there."""
        found: dict[str, list[JointNode]] = {}
        for joint in self.joints:
            if joint.parent in self.link and joint.child in self.link:
                found.setdefault(joint.child, []).append(joint)
        return found

    @cached_property
    def held(self) -> dict[str, list[JointNode]]:
        """The joints that hang from a link, by the link's name; only those between links that are there."""
        found: dict[str, list[JointNode]] = {}
        for joints in self.holders.values():
            for joint in joints:
                found.setdefault(joint.parent, []).append(joint)
        return found

    @cached_property
    def roots(self) -> list[LinkNode]:
        """The links that no joint moves."""
        return [node for node in self.link.values() if node.name not in self.holders][::-1]

    def holder(self, link: LinkNode) -> JointNode | None:
        """The joint that moves a link."""
        return next(iter(self.holders.get(link.name, ())), None)

    def body(self, link: LinkNode) -> list[LinkNode]:
        """A link and all that is fixed to it, directly or not: what moves as one body."""
        found, seen = [link], {link.name}
        for node in found:
            for joint in self.held.get(node.name, ()):
                if joint.kind == "fixed" and joint.child not in seen:
                    seen.add(joint.child)
                    found.append(self.link[joint.child])
        return found

    def is_body_weightless(self, link: LinkNode) -> bool:
        """Whether a link weighs nothing, and nothing that is fixed to it does."""
        return all(node.is_weightless for node in self.body(link))

    def reached(self) -> set[str]:
        """Names of the links below the roots, these included."""
        waiting, seen = [root.name for root in self.roots], set[str]()
        while waiting:
            name = waiting.pop()
            if name not in seen:
                seen.add(name)
                waiting.extend(joint.child for joint in self.held.get(name, ()))
        return seen

    def rings(self) -> dict[str, int]:
        """The same number for links that hang from each other, by name.

        Kosaraju's algorithm (Aho, Hopcroft and Ullman, *Data Structures and Algorithms*, 1983, section 6.7).
        """
        finished: list[str] = []
        seen = set[str]()
        for start in self.link:
            waiting = [(start, False)]
            while waiting:
                name, is_done = waiting.pop()
                if is_done:
                    finished.append(name)
                elif name not in seen:
                    seen.add(name)
                    waiting += [(name, True), *((joint.child, False) for joint in self.held.get(name, ()))]
        ring: dict[str, int] = {}
        for number, start in enumerate(reversed(finished)):
            above = [start]
            while above:
                name = above.pop()
                if name not in ring:
                    ring[name] = number
                    above.extend(joint.parent for joint in self.holders.get(name, ()))
        return ring


def few(names: Iterable[str]) -> str:
    """The first of some names, as a message says them, and how many more there are."""
    return listed([shown(name) for name in dict.fromkeys(names)], _FEW)


def _joint(element: Element) -> JointNode:
    parent, child = element.first("parent"), element.first("child")
    return JointNode(
        name=element.get("name") or "",
        kind=element.get("type") or "",
        parent=(parent.get("link") if parent else None) or "",
        child=(child.get("link") if child else None) or "",
        element=element,
    )
