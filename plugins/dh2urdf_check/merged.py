"""What moves as one body, as the readers see it that merge fixed links into the links that hold them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.kinematics.mass import compound, placed
from dh2urdf.manipulator import Inertia
from dh2urdf.robot import Inertial
from dh2urdf.rotations import IDENTITY, ZERO, RigidTransform
from dh2urdf.row_fields import INERTIA

if TYPE_CHECKING:
    from dh2urdf_check.document.description import Description, LinkNode
    from dh2urdf_check.document.tree import Element


def head_of(description: Description, link: LinkNode) -> LinkNode:
    """The link that a link is merged into: itself, where it moves or is a root."""
    head = description.once(_heads)[link.name]
    return link if head.name == link.name else head


def _heads(description: Description) -> dict[str, LinkNode]:
    """The link that each link is merged into; of a ring of fixed links, each into one of them."""
    heads: dict[str, LinkNode] = {}
    for link in description.link.values():
        way = {link.name: link}
        while link.name not in heads and (holder := description.holder(link)) and holder.kind == "fixed":
            if holder.parent in way:
                break
            link = way[holder.parent] = description.link[holder.parent]  # noqa: PLW2901 - the way up
        heads.update(dict.fromkeys(way, heads.get(link.name, link)))
    return heads


def inertial_of(element: Element) -> Inertial | None:
    """A mass with its inertia; None where one of them is missing, or a text is not the number that it should be."""
    mass, inertia = element.first("mass"), element.first("inertia")
    pose = pose_of(element.first("origin"))
    value = mass.number("value") if mass else None
    elements = [inertia.number(name) for name in INERTIA] if inertia else [None]
    if value is None or pose is None or None in elements:
        return None
    tensor = Inertia(**dict(zip(INERTIA, [number or 0.0 for number in elements], strict=True)))
    return placed(Inertial(mass=value, inertia=tensor), pose)


def merged_inertial(description: Description, head: LinkNode) -> Inertial | None:
    """Mass and inertia of a link with all that is fixed to it, in its frame; None where that is not known."""
    poses: dict[str, RigidTransform] = {head.name: IDENTITY}
    bodies: list[Inertial] = []
    for link in description.body(head):
        holder = description.holder(link)
        if link is not head:
            step = pose_of(holder.element.first("origin")) if holder else None
            above = poses.get(holder.parent) if holder else None
            if step is None or above is None:
                return None
            poses[link.name] = above @ step
        if link.inertial is not None:
            body = inertial_of(link.inertial)
            if body is None:
                return None
            bodies.append(placed(body, poses[link.name]))
    try:
        return compound(bodies)
    except (ValueError, IndexError):  # no mass, or no body
        return None


def pose_of(origin: Element | None) -> RigidTransform | None:
    """The frame of an origin; None where it is not written in numbers."""
    if origin is None:
        return IDENTITY
    pose: list[tuple[float, float, float]] = []
    for name in ("xyz", "rpy"):
        numbers = ZERO if origin.get(name) is None else origin.numbers(name, 3)
        if numbers is None:
            return None
        pose.append((numbers[0], numbers[1], numbers[2]))
    return RigidTransform.from_xyz_rpy(*pose)
