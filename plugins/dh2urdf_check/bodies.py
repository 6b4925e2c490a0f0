"""What moves as one body in a robot description, what it weighs, and what sdformat keeps of it."""

from __future__ import annotations

import math
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

from dh2urdf.columns import INERTIA
from dh2urdf.kinematics.mass import compound, placed, principal_moments
from dh2urdf.manipulator import WORLD, Inertia
from dh2urdf.robot import WEIGHTLESS, Inertial
from dh2urdf.rotations import IDENTITY, add, rotate
from dh2urdf_check.links import pose_of
from dh2urdf_check.numbers import mujoco_numbers, numbers_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from lxml import etree

    from dh2urdf.rotations import RigidTransform, Vec3
    from dh2urdf_check.links import Links

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


class Bodies:
    """The bodies of a description."""

    def __init__(self, links: Links) -> None:
        self._links = links
        self._merged: dict[tuple[str, ...], Inertial | None] = {}
        self._masses: dict[str, float] = {}

    def mass(self, name: str) -> float:
        """The mass that urdfdom reads of a link [kg]: 0 where there is none."""
        if name not in self._masses:
            link = self._links.link[name]
            numbers = numbers_of(_mass_text(link), 1)
            self._masses[name] = numbers[0] if numbers and pose_of(link.find("inertial/origin")) else 0.0
        return self._masses[name]

    def is_weightless(self, name: str) -> bool:
        """Whether a link weighs nothing, and nothing that is fixed to it does; a text that is no number is not 0."""
        texts = [_mass_text(self._links.link[each]) for each in self._links.body(name)]
        return all(text is None or numbers_of(text, 1) == (0.0,) for text in texts)

    def is_light(self, name: str) -> bool:
        """Whether MuJoCo takes the mass of a link and of all that is fixed to it for 0."""
        if self.mass(name) >= _LIGHTEST and not self._has_negative_mass:
            return False  # without a look at the others
        texts = [_mass_text(self._links.link[each]) for each in self._links.body(name)]
        masses = [numbers_of(text, 1) or (math.inf,) for text in texts if text is not None]
        return sum(mass[0] for mass in masses) < _LIGHTEST

    @cached_property
    def _has_negative_mass(self) -> bool:
        return any(self.mass(name) < 0.0 for name in self._links.link)

    def merged(self, names: Sequence[str]) -> Inertial | None:
        """Links that are fixed to the first of them as one body, in its frame; None where it is not known."""
        key = tuple(names)
        if key not in self._merged:
            self._merged[key] = self._merge(key)
        return self._merged[key]

    def _merge(self, names: tuple[str, ...]) -> Inertial | None:
        poses: dict[str, RigidTransform] = {names[0]: IDENTITY}
        parts: list[Inertial] = []
        for name in names:
            holder, link = self._links.holder(name), self._links.link[name]
            if name not in poses:
                step = pose_of(holder.element.find("origin")) if holder else None
                above = poses.get(holder.parent) if holder else None
                if step is None or above is None:
                    return None
                poses[name] = above @ step
            if link.find("inertial") is not None:
                part = inertial_of(link)
                if part is None:
                    return None
                parts.append(placed(part, poses[name]))
        try:
            return compound(parts)
        except (ValueError, IndexError):  # no mass, or no body
            return None

    # --- What sdformat keeps ------------------------------------------------------------------------------------------

    @cached_property
    def kept(self) -> dict[str, list[str]]:
        """The links that are left, each with those that are fixed to it; below one that weighs nothing, none."""
        links, root = self._links, self._links.roots[:1]
        apart = {
            extension.get("reference")
            for extension in links.root.iterchildren("gazebo")
            for child in extension
            if child.tag in {"preserveFixedJoint", "disableFixedJointLumping"}
            and (child.text or "").strip().lower() in {"true", "1"}
        }
        heads = [joint.child for joint in links.held.get(WORLD, ())] if root == [WORLD] else list(root)
        seen, found = {WORLD} if root == [WORLD] else set[str](), dict[str, list[str]]()
        for head in heads:
            if head in seen:
                continue
            body, joints = [head], []
            seen.add(head)
            for name in body:
                for joint in links.held.get(name, ()):
                    if joint.kind != "fixed" or name == WORLD or joint.name in apart:
                        joints.append(joint)
                    elif joint.child not in seen:
                        seen.add(joint.child)
                        body.append(joint.child)
            if head != WORLD and abs(sum(map(self.mass, body))) <= _NOTHING:
                continue
            found[head] = body
            lost = set(self._holding_nothing(body))
            heads.extend(joint.child for joint in joints if joint.parent not in lost)
        return found

    def _holding_nothing(self, body: list[str]) -> Iterator[str]:
        """Links of a body that weigh nothing, with all that is fixed to them: sdformat drops what moves on them."""
        weights: dict[str, float] = {}
        for name in reversed(body):  # What is fixed to a link comes after it.
            below = (joint.child for joint in self._links.held.get(name, ()) if joint.kind == "fixed")
            weights[name] = self.mass(name) + sum(weights.get(child, 0.0) for child in below)
        return (name for name in body[1:] if abs(weights[name]) <= _NOTHING and name != WORLD)

    @cached_property
    def holding_nothing(self) -> list[str]:
        """Those of all bodies."""
        return [name for body in self.kept.values() for name in self._holding_nothing(body)]

    @cached_property
    def without_centre(self) -> list[str]:
        """Links that are added to another, where both together weigh 0: their centre of mass is 0/0.

        A link is added to the one that holds it after what is fixed to it has been, in the order of the joints' names.
        """
        links, found = self._links, list[str]()
        for body in self.kept.values():
            masses = {name: self.mass(name) for name in body}
            filled = {name for name in body if links.link[name].find("inertial") is not None}
            for name in reversed(body):
                for joint in sorted(links.held.get(name, ()), key=lambda joint: joint.name):
                    if joint.kind == "fixed" and joint.child in filled:
                        filled.add(name)
                        masses[name] += masses[joint.child]
                        if masses[name] == 0.0 and links.holder(joint.child) is not None:
                            found.append(joint.child)
        return found

    @cached_property
    def _body_of(self) -> dict[str, list[str]]:
        return {name: body for body in self.kept.values() for name in body}

    def suits_gazebo(self, name: str) -> bool:
        """Whether sdformat drops a link, or what is fixed to the link makes mass and inertia right."""
        if name not in self._body_of:
            return True
        body = self.merged(self._body_of[name])
        return body is not None and body.mass >= 0.0 and law(body.inertia) not in {"definite", "triangle"}


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
    for shape in (*link.iterchildren("visual", "collision"),):
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
