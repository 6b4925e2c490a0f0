"""What sdformat keeps of the links: those that weigh something, with what is fixed to them."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING

from dh2urdf.kinematics.mass import compound, placed
from dh2urdf.manipulator import WORLD, Inertia
from dh2urdf.robot import WEIGHTLESS, Inertial
from dh2urdf.rotations import IDENTITY
from dh2urdf.row_fields import INERTIA
from dh2urdf_check.merged import pose_of
from dh2urdf_check.numbers import urdfdom_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.rotations import RigidTransform
    from dh2urdf_check.document.description import Description, JointNode, LinkNode
    from dh2urdf_check.document.tree import Element

_SPARE = 5.0 * sys.float_info.epsilon
"""By what share of their sum sdformat lets moments be off."""
_NOTHING = 1e-6
"""Mass that sdformat takes for 0 [kg]."""


def mass_of(inertial: Element | None) -> float:
    """The mass that urdfdom reads [kg]: 0 where it cannot read the origin or the mass."""
    mass = inertial.first("mass") if inertial else None
    if inertial is None or mass is None or _has_wrong_origin(inertial):
        return 0.0
    numbers = urdfdom_numbers(mass.get("value") or "", 1)
    return numbers[0] if numbers else 0.0


def kept(description: Description) -> list[list[LinkNode]]:
    """The bodies that are left, each a link with those that are fixed to it; below one that weighs nothing, none."""
    if not description.roots:
        return []
    found: list[list[LinkNode]] = []
    apart = _kept_apart(description)
    root = description.roots[0]
    heads = [root]
    if root.name == WORLD:
        heads = [description.link[joint.child] for joint in description.held.get(WORLD, ())]
    seen = {WORLD} if root.name == WORLD else set[str]()
    for head in heads:
        if head.name in seen:
            continue
        body: list[LinkNode] = [head]
        joints: list[JointNode] = []
        seen.add(head.name)
        for node in body:
            for joint in description.held.get(node.name, ()):
                if joint.kind != "fixed" or node.name == WORLD or joint.name in apart:
                    joints.append(joint)
                elif joint.child not in seen:
                    seen.add(joint.child)
                    body.append(description.link[joint.child])
        if head.name != WORLD and abs(sum(mass_of(node.inertial) for node in body)) <= _NOTHING:
            continue
        found.append(body)
        lost = {link.name for link in holding_nothing(description, body)}
        heads.extend(description.link[joint.child] for joint in joints if joint.parent not in lost)
    return found


def body_of(description: Description) -> dict[LinkNode, list[LinkNode]]:
    """The body that is left of each link, where one is."""
    return {link: body for body in description.once(kept) for link in body}


def holding_nothing(description: Description, body: list[LinkNode]) -> list[LinkNode]:
    """Links of a body that weigh nothing, with all that is fixed to them: sdformat drops what moves on them."""
    weights: dict[str, float] = {}
    for node in reversed(body):  # What is fixed to a link comes after it.
        below = (joint.child for joint in description.held.get(node.name, ()) if joint.kind == "fixed")
        weights[node.name] = mass_of(node.inertial) + sum(weights.get(child, 0.0) for child in below)
    return [node for node in body[1:] if abs(weights[node.name]) <= _NOTHING and node.name != WORLD]


def _kept_apart(description: Description) -> set[str]:
    """Names of the fixed joints that an extension keeps."""
    return {
        extension.get("reference") or ""
        for extension in description.root.all("gazebo")
        for child in extension.children
        if child.tag in {"preserveFixedJoint", "disableFixedJointLumping"} and child.text.lower() in {"true", "1"}
    }


def without_centre(description: Description, body: list[LinkNode]) -> Iterator[LinkNode]:
    """Links that are added to another, where both together weigh 0: their centre of mass is 0/0.

    A link is added to the one that holds it after all that is fixed to it has been, in the order of the joints' names.
    """
    masses = {node.name: mass_of(node.inertial) for node in body}
    filled = {node.name for node in body if node.inertial}
    for node in reversed(body):
        for joint in sorted(description.held.get(node.name, ()), key=lambda joint: joint.name):
            if joint.kind != "fixed" or joint.child not in filled:
                continue
            filled.add(node.name)
            masses[node.name] += masses[joint.child]
            if masses[node.name] == 0.0:
                yield description.link[joint.child]


def merged(description: Description, body: list[LinkNode]) -> Inertial | None:
    """Mass and inertia of a body, as urdfdom reads those of its links; None where that is not known."""
    poses: dict[str, RigidTransform] = {body[0].name: IDENTITY}
    parts: list[Inertial] = []
    for node in body:
        holder = description.holder(node)
        if node is not body[0]:
            step = pose_of(holder.element.first("origin")) if holder else None
            above = poses.get(holder.parent) if holder else None
            if step is None or above is None:
                return None
            poses[node.name] = above @ step
        if node.inertial and (part := _inertial(node.inertial)):
            parts.append(placed(part, poses[node.name]))
    try:
        return compound(parts)
    except (ValueError, IndexError):  # no mass, or no body
        return None


def _inertial(inertial: Element) -> Inertial | None:
    """As urdfdom reads it."""
    pose, mass = pose_of(inertial.first("origin")), inertial.first("mass")
    if pose is None or mass is None or urdfdom_numbers(mass.get("value") or "", 1) is None:
        return None
    return placed(Inertial(mass=mass_of(inertial), inertia=tensor_of(inertial)), pose)


def tensor_of(inertial: Element | None) -> Inertia:
    """The inertia that urdfdom reads: 0 where one of its elements is no number."""
    inertia = inertial.first("inertia") if inertial else None
    read = [urdfdom_numbers(inertia.get(name) or "", 1) for name in INERTIA] if inertia else [None]
    if None in read:
        return WEIGHTLESS.inertia
    return Inertia(**dict(zip(INERTIA, (numbers[0] for numbers in read if numbers), strict=True)))


def takes_inertia(inertia: Inertia) -> bool:
    """Whether sdformat takes a tensor for that of a body.

    It forgives the last digits alone, and loses half of them itself where two principal moments are nearly the same, as
    in a thin rod (`MassMatrix3::IsValid` of ignition-math 6, after Kronenburg, https://arxiv.org/abs/1306.6291v4).
    """
    # It writes the numbers with 16 digits, and reads them.
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    xx, yy, zz, xy, xz, yz = (float(f"{getattr(inertia, name):.16g}") for name in names)
    b, spare = xx + yy + zz, _SPARE * abs(xx + yy + zz)
    c = xx * yy - xy**2 + xx * zz - xz**2 + yy * zz - yz**2
    d = xx * yz**2 + yy * xz**2 + zz * xy**2 - xx * yy * zz - 2.0 * xy * xz * yz
    if min(xx, xx * yy - xy**2, -d) + spare < 0.0:
        return False
    low, middle, high = sorted((xx, yy, zz))
    if max(abs(xy), abs(xz), abs(yz)) > 1e-6 * high:
        p = b**2 - 3.0 * c
        low = middle = high = b / 3.0
        if p >= (1e-6 * max(xx, yy, zz)) ** 2:
            delta = math.acos(min(max(0.5 * (2.0 * b**3 - 9.0 * b * c - 27.0 * d) / p**1.5, -1.0), 1.0))
            turns = (delta / 3.0, (delta + math.tau) / 3.0, (delta - math.tau) / 3.0)
            low, middle, high = sorted((b + 2.0 * math.sqrt(p) * math.cos(turn)) / 3.0 for turn in turns)
    spare = _SPARE * abs(low + middle + high)
    return low + spare >= 0.0 and low + middle + spare >= high


def _has_wrong_origin(inertial: Element) -> bool:
    origin = inertial.first("origin")
    texts = [origin.get(name) for name in ("xyz", "rpy")] if origin else []
    return any(text is not None and urdfdom_numbers(text, 3) is None for text in texts)
