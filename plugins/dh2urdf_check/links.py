"""Links and joints of a robot description, what moves as one body, what it weighs, and what sdformat keeps of it."""

from __future__ import annotations

import math
from contextlib import suppress
from functools import cache, cached_property
from graphlib import CycleError, TopologicalSorter
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.columns import BOUNDS, INERTIA
from dh2urdf.kinematics.mass import compound, placed, principal_moments
from dh2urdf.manipulator import JOINT_TYPES, WORLD, Inertia, JointType, Limits
from dh2urdf.robot import WEIGHTLESS, Inertial, Joint, Link, Origin, Robot
from dh2urdf.rotations import IDENTITY, X_AXIS, Z_AXIS, ZERO, RigidTransform, add, norm, rotate, scale
from dh2urdf_check.numbers import mujoco_numbers, numbers_of

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
    """The tree of a description, of which `root` is the element ``robot``."""

    def __init__(self, root: etree._Element) -> None:
        self.root = root
        self.link: dict[str, etree._Element] = {}  # the first of each name
        for element in root.iterchildren("link") if root.tag == "robot" else ():
            if name := element.get("name"):
                self.link.setdefault(name, element)
        self.joints: list[JointNode] = []
        self.holders: dict[str, list[JointNode]] = {}  # by the name of a link, those that move it; between links alone
        self.held: dict[str, list[JointNode]] = {}  # those that hang from it, as before
        for element in root.iterchildren("joint"):
            ends = [element.find(tag) for tag in ("parent", "child")]
            parent, child = ("" if end is None else end.get("link") or "" for end in ends)
            joint = JointNode(element, element.get("name") or "", element.get("type") or "", parent, child)
            self.joints.append(joint)
            if joint.parent in self.link and joint.child in self.link:
                self.holders.setdefault(joint.child, []).append(joint)
                self.held.setdefault(joint.parent, []).append(joint)
        # The links that no joint moves.
        self.roots = [name for name in self.link if name not in self.holders]
        self.body, self.merged = cache(self._body), cache(self._merged)
        self.kept, self.holding_nothing = self._kept_by_sdformat()

    def holder(self, name: str) -> JointNode | None:
        """The joint that moves a link."""
        return next(iter(self.holders.get(name, ())), None)

    def _body(self, name: str) -> tuple[str, ...]:
        """A link and all that is fixed to it, directly or not: what moves as one body."""
        found, seen = [name], {name}
        for each in found:
            for joint in self.held.get(each, ()):
                if joint.kind == "fixed" and joint.child not in seen:
                    seen.add(joint.child)
                    found.append(joint.child)
        return tuple(found)

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
        for node in (node for joints in self.holders.values() for node in joints):
            origin, axis, limit = (node.element.find(tag) for tag in ("origin", "axis", "limit"))
            kind, xyz, rpy = JOINT_TYPES.get(node.kind), vector_of(origin, "xyz", ZERO), vector_of(origin, "rpy", ZERO)
            way = Z_AXIS if kind is JointType.FIXED else vector_of(axis, "xyz", X_AXIS)
            if kind is None or not xyz or not rpy or not way or not norm(way):
                continue
            lower, upper = (None if limit is None else numbers_of(limit.get(name), 1) for name in BOUNDS)
            joint = Joint(
                name=node.name,
                type=kind,
                parent=node.parent,
                child=node.child,
                origin=Origin(xyz=xyz, rpy=rpy),
                axis=scale(1.0 / norm(way), way),
                limits=Limits(lower=lower[0] if lower else None, upper=upper[0] if upper else None),
                mark=mark(node.element),
            )
            first.setdefault(joint.child, joint)
        names = dict.fromkeys((self.roots[0], *self.link))
        links = tuple(Link(name=name) for name in names)
        return Robot(name=self.root.get("name") or "", links=links, joints=tuple(first.values()))

    # --- What bodies weigh --------------------------------------------------------------------------------------------

    @cached_property
    def masses(self) -> dict[str, float]:
        """The masses that urdfdom reads [kg]: 0 where there is none."""
        found = dict.fromkeys(self.link, 0.0)
        for name, link in self.link.items():
            numbers = numbers_of(_mass_text(link), 1)
            if numbers and pose_of(link.find("inertial/origin")):
                (found[name],) = numbers
        return found

    def is_weightless(self, name: str) -> bool:
        """Whether a link weighs nothing, and nothing that is fixed to it does; a text that is no number is not 0."""
        texts = [_mass_text(self.link[each]) for each in self.body(name)]
        return all(text is None or numbers_of(text, 1) == (0.0,) for text in texts)

    def is_light(self, name: str) -> bool:
        """Whether MuJoCo takes the mass of a link and of all that is fixed to it for 0."""
        if self.masses[name] >= _LIGHTEST and not self._has_negative_mass:
            return False  # without a look at the others
        texts = [_mass_text(self.link[each]) for each in self.body(name)]
        masses = [numbers_of(text, 1) or (math.inf,) for text in texts if text is not None]
        return sum(mass[0] for mass in masses) < _LIGHTEST

    @cached_property
    def _has_negative_mass(self) -> bool:
        return any(mass < 0.0 for mass in self.masses.values())

    def _merged(self, names: tuple[str, ...]) -> Inertial | None:
        """Links that are fixed to the first of them as one body, in its frame; None where it is not known."""
        poses: dict[str, RigidTransform] = {names[0]: IDENTITY}
        parts: list[Inertial] = []
        for name in names:
            holder, link = self.holder(name), self.link[name]
            if name not in poses:
                step = pose_of(holder.element.find("origin")) if holder else None
                above = poses.get(holder.parent) if holder else None
                if step is None or above is None:
                    return None
                poses[name] = above @ step
            if link.find("inertial") is not None:
                if (part := inertial_of(link)) is None:
                    return None
                parts.append(placed(part, poses[name]))
        try:
            return compound(parts)
        except (ValueError, IndexError):  # no mass, or no body
            return None

    # --- What sdformat keeps ------------------------------------------------------------------------------------------

    def _kept_by_sdformat(self) -> tuple[dict[str, list[str]], set[str]]:
        """The links that are left, each with those that are fixed to it; below one that weighs nothing, none.

        Besides, those that weigh nothing with all that is fixed to them: sdformat drops what moves on them.
        """
        root = self.roots[:1]
        apart = {
            extension.get("reference")
            for extension in self.root.iterchildren("gazebo")
            for child in extension
            if child.tag in {"preserveFixedJoint", "disableFixedJointLumping"}
            and (child.text or "").strip().lower() in {"true", "1"}
        }
        heads = [joint.child for joint in self.held.get(WORLD, ())] if root == [WORLD] else list(root)
        seen, found = {WORLD} if root == [WORLD] else set[str](), dict[str, list[str]]()
        holding_nothing = set[str]()
        for head in heads:
            if head in seen:
                continue
            body, joints = [head], []
            seen.add(head)
            for name in body:
                for joint in self.held.get(name, ()):
                    if joint.kind != "fixed" or name == WORLD or joint.name in apart:
                        joints.append(joint)
                    elif joint.child not in seen:
                        seen.add(joint.child)
                        body.append(joint.child)
            if head != WORLD and abs(sum(self.masses[name] for name in body)) <= _NOTHING:
                continue
            found[head] = body
            weights: dict[str, float] = {}
            for name in reversed(body):  # What is fixed to a link comes after it.
                below = (joint.child for joint in self.held.get(name, ()) if joint.kind == "fixed")
                weights[name] = self.masses[name] + sum(weights.get(child, 0.0) for child in below)
            holding_nothing |= {name for name in body[1:] if abs(weights[name]) <= _NOTHING and name != WORLD}
            heads.extend(joint.child for joint in joints if joint.parent not in holding_nothing)
        return found, holding_nothing

    @cached_property
    def without_centre(self) -> list[str]:
        """Links that are added to another, where both together weigh 0: their centre of mass is 0/0.

        A link is added to the one that holds it after what is fixed to it has been, in the order of the joints' names.
        """
        found = list[str]()
        for body in self.kept.values():
            masses = {name: self.masses[name] for name in body}
            filled = {name for name in body if self.link[name].find("inertial") is not None}
            for name in reversed(body):
                for joint in sorted(self.held.get(name, ()), key=lambda joint: joint.name):
                    if joint.kind == "fixed" and joint.child in filled:
                        filled.add(name)
                        masses[name] += masses[joint.child]
                        if masses[name] == 0.0 and self.holder(joint.child) is not None:
                            found.append(joint.child)
        return found

    @cached_property
    def refused_by_gazebo(self) -> set[str]:
        """Links that sdformat keeps, and whose mass or inertia is wrong with what is fixed to them."""
        return {
            name
            for names in self.kept.values()
            if (body := self.merged(tuple(names))) is None
            or body.mass < 0.0
            or law(body.inertia) in {"definite", "triangle"}
            for name in names
        }


def _blocked(graph: dict[str, list[str]]) -> set[str]:
    """The nodes that circles keep from an order of all."""
    sorter, ordered = TopologicalSorter(graph), set[str]()
    with suppress(CycleError):  # The others can be ordered all the same.
        sorter.prepare()
    while ready := sorter.get_ready():
        ordered.update(ready)
        sorter.done(*ready)
    return graph.keys() - ordered


def vector_of(element: etree._Element | None, name: str, usual: Vec3) -> Vec3 | None:
    """A vector of an element; the usual one where there is none, and None where it is not written in numbers."""
    text = None if element is None else element.get(name)
    numbers = usual if text is None else numbers_of(text, 3)
    return (numbers[0], numbers[1], numbers[2]) if numbers else None


def pose_of(origin: etree._Element | None) -> RigidTransform | None:
    """The frame of an origin; None where it is not written in numbers."""
    xyz, rpy = vector_of(origin, "xyz", ZERO), vector_of(origin, "rpy", ZERO)
    return RigidTransform.from_xyz_rpy(xyz, rpy) if xyz and rpy else None


# --- Bodies -----------------------------------------------------------------------------------------------------------


_ROUNDED = 1e-9
"""By what share of the largest a principal moment may be off."""
_SMALLEST_MOMENT = 1e-14
"""Principal moment that MuJoCo takes for 0 [kg·m²]."""
_LIGHTEST = 1e-15
"""Mass that MuJoCo takes for 0 [kg]."""
_NOTHING = 1e-6
"""Mass that sdformat takes for 0 [kg]."""
_TOO_WIDE = 2.0
"""How much wider than the shapes a body may be: shapes are simplified, and motors have no shape."""
_SMALLEST = 0.05
"""What a body without larger shapes may measure [m]: a rotor that is not drawn, a frame with a placeholder."""


def tensor_of(inertia: etree._Element | None) -> Inertia | None:
    """The tensor of an element `inertia`; None where a text is not the number that it should be."""
    read = [numbers_of(inertia.get(name), 1) for name in INERTIA] if inertia is not None else [None]
    if None in read:
        return None
    return Inertia(**dict(zip(INERTIA, (numbers[0] for numbers in read if numbers), strict=True)))


def law(inertia: Inertia) -> str:
    """Which law of a body an inertia breaks: `zero`, `definite`, `triangle`, `semidefinite`, or an empty text."""
    if inertia == WEIGHTLESS.inertia:
        return "zero"
    low, middle, high = principal_moments(inertia)
    if low < -_ROUNDED * high:
        return "definite"
    if low + middle < high * (1.0 - _ROUNDED):
        return "triangle"
    return "semidefinite" if low < _SMALLEST_MOMENT else ""


def is_refused_by_mujoco(inertia: etree._Element, *, moves: bool) -> bool:
    """Whether MuJoCo refuses a tensor, of which it reads all six elements, infinite ones, too."""
    read = [mujoco_numbers(inertia.get(name) or "", 1) for name in INERTIA]
    numbers = [each[0] for each in read if each]
    if len(numbers) < len(INERTIA):
        return False
    if not all(map(math.isfinite, numbers)):
        return moves
    return law(Inertia(**dict(zip(INERTIA, numbers, strict=True)))) not in {"", "zero"}


def inertial_of(link: etree._Element) -> Inertial | None:
    """The body of a link in its frame; None where something of it is missing, or a text is not a number."""
    mass, pose = numbers_of(_mass_text(link), 1), pose_of(link.find("inertial/origin"))
    tensor = tensor_of(link.find("inertial/inertia"))
    if mass is None or pose is None or tensor is None:
        return None
    return placed(Inertial(mass=mass[0], inertia=tensor), pose)


def _mass_text(link: etree._Element) -> str | None:
    mass = link.find("inertial/mass")
    return None if mass is None else mass.get("value")


# --- Sizes ------------------------------------------------------------------------------------------------------------


def half_sizes(shape: etree._Element | None) -> Vec3 | None:
    """Half of the extents of a shape in its own frame [m]; None of a mesh, whose extents are not known."""
    if shape is None:
        return None
    size = numbers_of(shape.get("size"), 3)
    radius, length = (numbers_of(shape.get(name), 1) for name in ("radius", "length"))
    if shape.tag == "box" and size:
        return size[0] / 2, size[1] / 2, size[2] / 2
    if shape.tag in {"sphere", "cylinder"} and radius and (length or shape.tag == "sphere"):
        return radius[0], radius[0], length[0] / 2 if shape.tag == "cylinder" and length else radius[0]
    return None


def implausible(link: etree._Element) -> str:
    """What is hardly meant of a link's mass, beside its shapes: its centre or its inertia, as a sentence."""
    corners: list[Vec3] = []
    for shape in link.iterchildren("visual", "collision"):
        half, pose = half_sizes(shape.find("geometry/*")), pose_of(shape.find("origin"))
        if half is None or pose is None:
            return ""
        for signs in product((-1, 1), repeat=3):
            x, y, z = (sign * side for sign, side in zip(signs, half, strict=True))
            corners.append(add(pose.translation, rotate(pose.rotation, (x, y, z))))
    body, pose = inertial_of(link), pose_of(link.find("inertial/origin"))
    if not corners or body is None or pose is None or body.mass <= 0.0:
        return ""
    com, sides = pose.translation, [(min(axis), max(axis)) for axis in zip(*corners, strict=True)]
    diagonal = max(math.hypot(*(high - low for low, high in sides)), _SMALLEST)
    outside = math.hypot(*(max(low - c, c - high, 0.0) for (low, high), c in zip(sides, com, strict=True)))
    if outside > _TOO_WIDE * diagonal:
        return f"the centre of mass is {outside:.3g} m outside its shapes, which measure {diagonal:.3g} m"
    # No point of a body is farther from its centre of mass than its radius of gyration asks for: I = m·k², k ≤ r.
    reach = max(*(math.dist(corner, com) for corner in corners), _SMALLEST)
    gyration = math.sqrt(max(*principal_moments(body.inertia), 0.0) / body.mass)
    if gyration <= _TOO_WIDE * reach:
        return ""
    return (
        f"the inertia is that of {body.mass:g} kg at a distance of {gyration:.3g} m, and its shapes reach {reach:.3g} m"
    )
