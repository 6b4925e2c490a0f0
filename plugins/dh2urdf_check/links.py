"""Links and joints of a robot description, as far as they are there, and the arm that they are."""

from __future__ import annotations

from contextlib import suppress
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.manipulator import JOINT_TYPES, JointType, Limits
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import X_AXIS, Z_AXIS, ZERO, RigidTransform, norm, scale
from dh2urdf_check.numbers import numbers_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from lxml import etree

    from dh2urdf.rotations import Vec3
    from dh2urdf.source import Mark

MOVING = ("revolute", "continuous", "prismatic", "floating", "planar")


class JointNode(NamedTuple):
    """A joint; what it lacks is an empty text."""

    element: etree._Element
    name: str
    kind: str
    parent: str
    child: str


class Links:
    """The tree of a description.

    Attributes:
        root: the element ``robot``.
        link: the first link of each name.
        joints: all joints.
        holders: by the name of a link, the joints that move it; only those between links that are there.
        held: by the name of a link, the joints that hang from it; as before.
        roots: the names of the links that no joint moves.
    """

    def __init__(self, root: etree._Element) -> None:
        self.root = root
        self.link: dict[str, etree._Element] = {}
        for element in root.iterchildren("link") if root.tag == "robot" else ():
            if name := element.get("name"):
                self.link.setdefault(name, element)
        self.joints = [_joint(element) for element in root.iterchildren("joint")]
        self.holders: dict[str, list[JointNode]] = {}
        self.held: dict[str, list[JointNode]] = {}
        for joint in self.joints:
            if joint.parent in self.link and joint.child in self.link:
                self.holders.setdefault(joint.child, []).append(joint)
                self.held.setdefault(joint.parent, []).append(joint)
        self.roots = [name for name in self.link if name not in self.holders]
        self._bodies: dict[str, list[str]] = {}

    def holder(self, name: str) -> JointNode | None:
        """The joint that moves a link."""
        return next(iter(self.holders.get(name, ())), None)

    def body(self, name: str) -> list[str]:
        """A link and all that is fixed to it, directly or not: what moves as one body."""
        if name not in self._bodies:
            found = dict.fromkeys([name])
            waiting = [name]
            for each in waiting:
                new = [j.child for j in self.held.get(each, ()) if j.kind == "fixed" and j.child not in found]
                found |= dict.fromkeys(new)
                waiting += dict.fromkeys(new)
            self._bodies[name] = [*found]
        return self._bodies[name]

    @cached_property
    def heads(self) -> dict[str, str]:
        """The link that each link is merged into; of a ring of fixed links, each into one of them."""
        heads: dict[str, str] = {}
        for name in self.link:
            way = {name: None}
            while name not in heads and (holder := self.holder(name)) and holder.kind == "fixed":
                if holder.parent in way:
                    break
                name = holder.parent  # noqa: PLW2901 - the way up
                way[name] = None
            heads.update(dict.fromkeys(way, heads.get(name, name)))
        return heads

    @cached_property
    def reached(self) -> set[str]:
        """The links below the roots, these included."""
        waiting, seen = list(self.roots), set[str]()
        while waiting:
            name = waiting.pop()
            if name not in seen:
                seen.add(name)
                waiting.extend(joint.child for joint in self.held.get(name, ()))
        return seen

    @cached_property
    def in_rings(self) -> set[str]:
        """The links that hang from each other in a circle, and those between two circles."""
        above = {child: [joint.parent for joint in joints] for child, joints in self.holders.items()}
        below = {parent: [joint.child for joint in joints] for parent, joints in self.held.items()}
        return _blocked(above) & _blocked(below)

    def robot(self, mark: Callable[[etree._Element], Mark]) -> Robot | None:
        """Links and joints without bodies and shapes, to compare kinematics; None where there is no tree of them.

        An axis is made a unit vector, as readers do. A joint is left out where a chain cannot lead over it: it is of no
        type of a manipulator, lacks a link, has no direction, or a text in it is not the number that it should be.
        """
        if not self.roots:
            return None
        first: dict[str, Joint] = {}
        for joints in self.holders.values():
            for node in joints:
                if joint := _read(node, mark(node.element)):
                    first.setdefault(joint.child, joint)
        names = dict.fromkeys((self.roots[0], *self.link))
        links = tuple(Link(name=name) for name in names)
        return Robot(name=self.root.get("name") or "", links=links, joints=tuple(first.values()))


def _blocked(graph: dict[str, list[str]]) -> set[str]:
    """The nodes that circles keep from an order of all."""
    sorter, ordered = TopologicalSorter(graph), set[str]()
    with suppress(CycleError):  # The others can be ordered all the same.
        sorter.prepare()
    while ready := sorter.get_ready():
        ordered.update(ready)
        sorter.done(*ready)
    return graph.keys() - ordered


def _joint(element: etree._Element) -> JointNode:
    ends = [element.find(tag) for tag in ("parent", "child")]
    parent, child = ("" if end is None else end.get("link") or "" for end in ends)
    return JointNode(element, element.get("name") or "", element.get("type") or "", parent, child)


def pose_of(origin: etree._Element | None) -> RigidTransform | None:
    """The frame of an origin; None where it is not written in numbers."""
    pose = []
    for name in ("xyz", "rpy"):
        text = None if origin is None else origin.get(name)
        numbers = ZERO if text is None else numbers_of(text, 3)
        if numbers is None:
            return None
        pose.append((numbers[0], numbers[1], numbers[2]))
    return RigidTransform.from_xyz_rpy(*pose)


def _read(node: JointNode, mark: Mark) -> Joint | None:
    kind, pose = JOINT_TYPES.get(node.kind), pose_of(node.element.find("origin"))
    axis = Z_AXIS if kind is JointType.FIXED else _direction(node.element.find("axis"))
    if kind is None or pose is None or axis is None:
        return None
    limit = node.element.find("limit")
    lower, upper = (None if limit is None else numbers_of(limit.get(name), 1) for name in ("lower", "upper"))
    return Joint(
        name=node.name,
        type=kind,
        parent=node.parent,
        child=node.child,
        origin=_origin(node.element.find("origin")),
        axis=axis,
        limits=Limits(lower=lower[0] if lower else None, upper=upper[0] if upper else None),
        mark=mark,
    )


def _origin(element: etree._Element | None) -> Origin:
    texts = {} if element is None else {name: element.get(name) for name in ("xyz", "rpy")}
    return Origin(**{name: numbers_of(text, 3) for name, text in texts.items() if text is not None})  # type: ignore[arg-type]  # `pose_of` has read them


def _direction(element: etree._Element | None) -> Vec3 | None:
    text = None if element is None else element.get("xyz")
    numbers = X_AXIS if text is None else numbers_of(text, 3)
    axis = (numbers[0], numbers[1], numbers[2]) if numbers else None
    return scale(1.0 / length, axis) if axis and (length := norm(axis)) else None
