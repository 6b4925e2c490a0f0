"""Rules about mass and inertia: of links, and of what moves as one body."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.kinematics.mass import inertia_problem, principal_moments
from dh2urdf.robot import WEIGHTLESS
from dh2urdf.row_fields import INERTIA
from dh2urdf.source import shown
from dh2urdf_check.document.description import ALL, MOVING, Hit
from dh2urdf_check.gazebo import (
    body_of,
    holding_nothing,
    kept,
    mass_of,
    merged as merged_by_gazebo,
    takes_inertia,
    tensor_of,
    without_centre,
)
from dh2urdf_check.merged import head_of, inertial_of, merged_inertial
from dh2urdf_check.numbers import ROUNDED, SMALLEST_MOMENT, is_no_inertia

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Inertial
    from dh2urdf_check.document.description import Description, LinkNode
    from dh2urdf_check.document.tree import Element


SMALLEST_MASS = 1e-15
"""A mass that MuJoCo takes for 0 [kg]."""


def hits(description: Description) -> Iterator[Hit]:
    """Findings about every link's mass and inertia."""
    if description.roots:
        yield from _root(description, description.roots[0])
    for link in description.links:
        if link.inertial is None:
            yield from _without_inertial(description, link)
        else:
            yield from _mass(description, link, link.inertial)
            yield from _inertia(description, link, link.inertial)
    yield from _weightless_chains(description)
    yield from _weightless_holders(description)


def _moves(description: Description, link: LinkNode) -> bool:
    holder = description.holder(link)
    return holder is not None and holder.kind in MOVING


def _root(description: Description, root: LinkNode) -> Iterator[Hit]:
    if root.inertial is None:
        yield Hit("root-without-inertial", root.element, f"the root link {shown(root.name)} has no inertial")
    elif root.mass != 0.0:
        yield Hit("root-with-inertial", root.element, f"the root link {shown(root.name)} has an inertial")
    if not description.once(kept):
        message = f"the root link {shown(root.name)} weighs nothing, nor does what is fixed to it"
        yield Hit("weightless-root", root.element, message)


def _without_inertial(description: Description, link: LinkNode) -> Iterator[Hit]:
    if description.holder(link) is None:
        return
    message = f"link {shown(link.name)} has no inertial"
    if not _moves(description, link):
        in_mujoco = _collides(link) and description.holder(head_of(description, link)) is not None
        of_frame = {"pybullet", "mujoco"} if in_mujoco else {"pybullet"}
        yield Hit("frame-without-inertial", link.element, message, of_frame)
        return
    of = set(ALL)
    if not description.is_body_weightless(link):  # What is fixed to a link is merged into it first.
        of -= {"gazebo"}
    elif not any(_collides(node) for node in description.body(link)):
        of -= {"mujoco"}
        yield Hit("nothing-that-weighs", link.element, f"link {shown(link.name)} moves, and nothing gives it a mass")
    yield Hit("missing-inertial", link.element, message, of)


def _collides(link: LinkNode) -> bool:
    """Whether a link has shapes of which MuJoCo computes a mass."""
    return link.inertial is None and link.element.first("collision") is not None


def _mass(description: Description, link: LinkNode, inertial: Element) -> Iterator[Hit]:
    mass, about = inertial.first("mass"), f"link {shown(link.name)}"
    if mass is None or mass.get("value") is None:
        yield Hit("inertial-without-mass", inertial, f"the inertial of {about} has no mass")
        return
    value = mass.number("value")
    if value is not None and value < 0.0:
        of = set(ALL) if _moves(description, link) else ALL - {"mujoco"}
        yield Hit("negative-mass", mass, f"{about} has the mass {value:g}", of - _gazebo_takes(description, link))
    elif value == 0.0 and _moves(description, link):
        of = ALL if description.is_body_weightless(link) else {"drake"}
        yield Hit("zero-mass", mass, f"{about} moves and has the mass 0", of)
    elif value and _moves(description, link) and _is_body_light(description, link):
        yield Hit("zero-mass", mass, f"{about} moves and has the mass {value:g}, which MuJoCo takes for 0", {"mujoco"})
    elif value == 0.0 and (body := inertial_of(inertial)) and body.inertia != WEIGHTLESS.inertia:
        yield Hit("zero-mass", mass, f"{about} has the mass 0, and an inertia", {"drake"})


def _is_body_light(description: Description, link: LinkNode) -> bool:
    """Whether MuJoCo takes the mass of a link and of all that is fixed to it for 0; not where one is not known."""
    if (link.mass or 0.0) >= SMALLEST_MASS and not description.once(_has_negative_mass):
        return False  # without a look at the others
    body = [each for each in description.body(link) if each.inertial]
    return sum(math.inf if each.mass is None else each.mass for each in body) < SMALLEST_MASS


def _has_negative_mass(description: Description) -> bool:
    return any((link.mass or 0.0) < 0.0 for link in description.links)


def _inertia(description: Description, link: LinkNode, inertial: Element) -> Iterator[Hit]:
    inertia, about = inertial.first("inertia"), f"link {shown(link.name)}"
    if inertia is None:
        if inertial.first("mass") is not None:
            yield Hit("mass-without-inertia", inertial, f"{about} has a mass and no inertia")
        return
    if missing := [name for name in INERTIA if inertia.get(name) is None]:
        of = ALL - {"drake"}  # It takes 0 for what is missing, and PyBullet for products of inertia.
        if not {"ixx", "iyy", "izz"} & set(missing):
            of -= {"pybullet"}
        yield Hit("mass-without-inertia", inertia, f"the inertia of {about} has no {', '.join(missing)}", of)
        return
    body = inertial_of(inertial)
    if body is None:
        yield from _moments_alone(inertia, about)
        return
    if body.inertia == WEIGHTLESS.inertia:
        merged = description.once(merged_inertial, head := head_of(description, link))
        if (
            body.mass > 0.0
            and _moves(description, head)
            and merged is not None
            and merged.inertia == WEIGHTLESS.inertia
        ):
            yield Hit("zero-inertia", inertia, f"{about} has a mass and the inertia 0")
    else:
        yield from _moments(description, link, inertia, body)


def _moments(description: Description, link: LinkNode, inertia: Element, body: Inertial) -> Iterator[Hit]:
    about, (low, middle, high) = f"link {shown(link.name)}", principal_moments(body.inertia)
    what = f"the principal moments of its inertia are {low:.6g}, {middle:.6g} and {high:.6g} kg·m²"
    moments = f"{about}: {inertia_problem(body.inertia) or what}"
    minding = ALL if body.mass > 0.0 else frozenset({"mujoco", "gazebo"})
    if low < -ROUNDED * high:
        yield Hit("inertia-not-positive-definite", inertia, moments, minding - _gazebo_takes(description, link))
    elif low + middle < high * (1.0 - ROUNDED):
        yield Hit("inertia-triangle-inequality", inertia, moments, minding - _gazebo_takes(description, link))
    else:
        if low < SMALLEST_MOMENT:
            yield Hit("inertia-semidefinite", inertia, moments)
        body_in_gazebo = description.once(body_of).get(link)
        if body_in_gazebo and not takes_inertia(tensor_of(link.inertial)) and _is_alone(link, body_in_gazebo):
            yield Hit("inertia-triangle-inequality", inertia, f"{moments}, but for rounding", {"gazebo"})


def _moments_alone(inertia: Element, about: str) -> Iterator[Hit]:
    """Of an inertia whose mass or origin is no number: MuJoCo reads nan and inf there, and looks at the inertia."""
    numbers = [inertia.number(name) for name in INERTIA]
    tensor = tuple(number for number in numbers if number is not None)
    if len(tensor) == len(INERTIA) and is_no_inertia(tensor, moves=False):
        message = f"the inertia of {about} is that of no body"
        yield Hit("inertia-not-positive-definite", inertia, message, {"mujoco"})


def _gazebo_takes(description: Description, link: LinkNode) -> set[str]:
    """Gazebo, where it drops a link, or where what is fixed to the link makes it right."""
    body = description.once(body_of).get(link)
    if body is None:
        return {"gazebo"}
    if _is_alone(link, body) and mass_of(link.inertial) >= 0.0:
        return {"gazebo"} if takes_inertia(tensor_of(link.inertial)) else set()
    merged = description.once(merged_by_gazebo, body)
    if merged is None:
        return set()
    low, middle, high = principal_moments(merged.inertia)
    wrong = merged.mass < 0.0 or low < -ROUNDED * high or low + middle < high * (1.0 - ROUNDED)
    return set() if wrong else {"gazebo"}


def _is_alone(link: LinkNode, body: list[LinkNode]) -> bool:
    """Whether sdformat keeps a link as a body to which nothing else adds."""
    return body[0] is link and not any(node.inertial for node in body[1:])


def _weightless_chains(description: Description) -> Iterator[Hit]:
    """Links that sdformat adds up to a mass of 0: their common centre of mass is 0/0."""
    for link in (link for body in description.once(kept) for link in without_centre(description, body)):
        if (holder := description.holder(link)) is None:
            continue
        about, above = f"link {shown(link.name)}", f"link {shown(holder.parent)}"
        message = f"{about} weighs nothing and is fixed to {above}, which weighs nothing"
        if mass_of(link.inertial):
            message = f"{about} is fixed to {above}, and what is fixed to it weighs nothing in all"
        yield Hit("weightless-chain", link.element, message)


def _weightless_holders(description: Description) -> Iterator[Hit]:
    """Links that weigh nothing, are fixed to another one, and hold a joint that moves."""
    for link in (link for body in description.once(kept) for link in holding_nothing(description, body)):
        moving = [shown(joint.name) for joint in description.held.get(link.name, ()) if joint.kind in MOVING]
        if moving:
            message = f"link {shown(link.name)} weighs nothing, and holds the moving joint {moving[0]}"
            yield Hit("weightless-holder", link.element, message)
