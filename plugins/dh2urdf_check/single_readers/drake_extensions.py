"""Elements of a URDF in Drake's own namespace: joints, springs, constraints and shapes, as its parser reads them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.manipulator import WORLD
from dh2urdf.source import listed, shown
from dh2urdf_check.document.description import TURNING_OR_SLIDING, Hit
from dh2urdf_check.numbers import drake_number, drake_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from dh2urdf_check.document.description import Description
    from dh2urdf_check.document.tree import Element

_JOINTS = ("ball", "planar", "screw", "universal", "curvilinear")
"""Types of a `drake:joint`; the others are those of a `joint`."""
_CURVES = {"drake:line_segment": ("length",), "drake:circular_arc": ("radius", "angle")}
_SHAPES = {"drake:ellipsoid": ("a", "b", "c"), "drake:capsule": ("radius", "length")}
_ROUND = {"sphere", "cylinder", "capsule", "drake:capsule", "drake:ellipsoid"}
_ANY, _POSITIVE = -math.inf, 5e-324


class _Force(NamedTuple):
    """What a spring or a constraint needs.

    Attributes:
        prefix: what the names of its parts begin with.
        ends: the parts that name bodies, or frames.
        parts: the others, with the count of their numbers and the least that each may be.
        of_two: whether its ends have to be two.
    """

    prefix: str
    ends: tuple[str, ...]
    parts: dict[str, tuple[int, float]]
    of_two: bool = False


_BODIES = ("body_A", "body_B")
_TENDON = "drake:tendon_constraint"
_POINTS = {"p_AP": (3, _ANY), "p_BQ": (3, _ANY)}
_FORCES = {
    "drake:linear_bushing_rpy": _Force(
        "drake:bushing_",
        ("frameA", "frameC"),
        dict.fromkeys(("torque_stiffness", "torque_damping", "force_stiffness", "force_damping"), (3, 0.0)),
    ),
    "drake:linear_spring_damper": _Force(
        "drake:linear_spring_damper_",
        _BODIES,
        {**_POINTS, "free_length": (1, _POSITIVE), "stiffness": (1, 0.0), "damping": (1, 0.0)},
    ),
    "drake:ball_constraint": _Force("drake:ball_constraint_", _BODIES, _POINTS, of_two=True),
    _TENDON: _Force(
        "drake:tendon_constraint_",
        (),
        {
            "offset": (1, _ANY),
            "lower_limit": (1, _ANY),
            "upper_limit": (1, _ANY),
            "stiffness": (1, _POSITIVE),
            "damping": (1, 0.0),
        },
    ),
}
_PROXIMITY = {
    "mesh_resolution_hint": _ANY,
    "hydroelastic_modulus": _ANY,
    "hunt_crossley_dissipation": 0.0,
    "point_contact_stiffness": _POSITIVE,
    "mu_dynamic": 0.0,
    "mu_static": 0.0,
    "relaxation_time": 0.0,
    "hydroelastic_margin": 0.0,
}
"""The least that a property of a collision shape may be."""


def hits(description: Description) -> Iterator[Hit]:
    """Findings about the elements that have Drake's namespace; the first fault of each."""
    seen = set[int]()
    for element, problems in _problems(description):
        if id(element) not in seen and (problem := next(problems, None)):
            seen.add(id(element))
            yield Hit("drake-extension", element, f"{element.tag} {problem}")


def _problems(description: Description) -> Iterator[tuple[Element, Iterator[str]]]:
    """Elements, and what is wrong with each."""
    names = {joint.name for joint in description.joints}
    for joint in description.root.all("drake:joint"):
        if joint.get("drake_ignore") != "true":
            yield joint, _of_joint(joint, description, names)
        names.add(joint.get("name") or "")
    links, kinds = {*description.link}, {joint.name: joint.kind for joint in description.joints}
    frames = {*links, *(frame.get("name") or "" for frame in description.root.all("frame"))}
    for tag, force in _FORCES.items():
        for element in description.root.all(tag):
            yield element, _of_ends(element, force, links if force.ends == _BODIES else frames)
            yield element, _of_parts(element, force)
            if tag == _TENDON:
                yield element, _of_tendon(element, force.prefix, kinds)
    for actuator in (actuator for each in description.root.all("transmission") for actuator in each.all("actuator")):
        if gains := actuator.first("drake:controller_gains"):
            yield gains, _of_numbers(gains, {"p": 0.0, "d": 0.0})
    yield from _in_shapes(description)


def _in_shapes(description: Description) -> Iterator[tuple[Element, Iterator[str]]]:
    for shape in (shape for link in description.links for shape in link.shapes):
        geometry, properties = shape.first("geometry"), shape.first("drake:proximity_properties")
        for body in geometry.children if geometry else ():
            yield body, _of_numbers(body, dict.fromkeys(_SHAPES.get(body.tag, ()), _POSITIVE))
        if properties and shape.tag == "collision":
            yield properties, _of_proximity(properties, geometry)


def _of_numbers(element: Element, least: dict[str, float]) -> Iterator[str]:
    """What is wrong with the attributes of an element; `least` has the least that each may be."""
    for name, bound in least.items():
        text = element.get(name)
        if (number := drake_number(text)) is None or number < bound:
            yield f"has no {name}" if text is None else f"has the {name} {shown(text)}"


def _of_proximity(properties: Element, geometry: Element | None) -> Iterator[str]:
    read = dict[str, float]()
    for name, least in _PROXIMITY.items():
        if element := properties.first(f"drake:{name}"):
            yield from (f"of a {name} that {problem}" for problem in _of_numbers(element, {"value": least}))
            read[name] = drake_number(element.get("value")) or 0.0
    if read.get("mu_dynamic", 0.0) > read.get("mu_static", math.inf):
        yield "with a mu_dynamic above mu_static"
    kinds = {kind for kind in ("rigid", "compliant", "soft") if properties.first(f"drake:{kind}_hydroelastic")}
    if "soft" in kinds or len(kinds) > 1:
        yield f"of a shape that is {listed(sorted(kinds))}; it may be rigid or compliant"
    is_round = any(body.tag in _ROUND for body in (geometry.children[:1] if geometry else ()))
    if kinds and is_round and not read.get("mesh_resolution_hint", 0.0) > 0.0:
        yield "without a mesh_resolution_hint above 0"
    if "compliant" in kinds and not read.get("hydroelastic_modulus", 0.0) > 0.0:
        yield "without a hydroelastic_modulus above 0"


def _of_joint(joint: Element, description: Description, names: set[str]) -> Iterator[str]:
    """What is wrong with a joint; `names` are those of the joints before."""
    name, kind = joint.get("name"), joint.get("type")
    ends = [end.get("link") if end else None for end in map(joint.first, ("parent", "child"))]
    if None in {name, kind, *ends}:
        yield "has no name, no type, no parent or no child"
    if not all((name, kind, *ends)):
        return  # Drake passes over it.
    if lost := [end for end in ends if end not in description.link and end != WORLD]:
        yield f"is of link {shown(lost[0] or '')}, and there is no such link"
    if name in names:
        yield f"has the name {shown(name or '')}, as another joint has"
    if ends[0] == ends[1]:
        yield f"is of {shown(ends[0] or '')} and itself"
    if kind not in _JOINTS:
        yield f"has the type {shown(kind or '')}; the types are {listed(_JOINTS)}"
    pitch, curves = joint.first("drake:screw_thread_pitch"), joint.first("drake:curves")
    if kind == "screw" and (pitch is None or drake_number(pitch.get("value")) is None):
        yield "has no drake:screw_thread_pitch"
    if kind == "curvilinear" and not (curves and curves.children and all(map(_is_curve, curves.children))):
        yield "has no drake:curves, or one that is no line or arc"


def _is_curve(curve: Element) -> bool:
    read = [drake_number(curve.get(name)) for name in _CURVES.get(curve.tag, ("",))]
    return None not in read and (read[0] or 0.0) > 0.0 and read[-1] != 0.0


def _of_ends(element: Element, force: _Force, known: set[str]) -> Iterator[str]:
    """What is wrong with the ends of a spring or a constraint; `known` are the bodies or frames that it may name."""
    ends = [found.get("name") if (found := element.first(force.prefix + end)) else None for end in force.ends]
    for end, name in zip(force.ends, ends, strict=True):
        if name not in known:
            about = f"{force.prefix}{end}"
            yield f"has no {about}" if name is None else f"has the {about} {shown(name)}, which is not there"
    if force.of_two and ends[0] == ends[1]:
        yield f"is of {shown(ends[0] or '')} and itself"


def _of_parts(element: Element, force: _Force) -> Iterator[str]:
    for part, (count, least) in force.parts.items():
        found, about = element.first(force.prefix + part), f"{force.prefix}{part}"
        read = drake_numbers((found.get("value") if found else None) or "")
        if len(read) != count or min(read) < least:
            what = f"{count} numbers" if count > 1 else "one number"
            bound = "" if least == _ANY else f" of {'more than ' if least else ''}0{'' if least else ' or more'}"
            yield f"has no {about} with {what}{bound}"


def _of_tendon(element: Element, prefix: str, kinds: Mapping[str, str]) -> Iterator[str]:
    seen = set[str]()
    for joint in element.all(f"{prefix}joint"):
        name = joint.get("name") or ""
        if kinds.get(name) not in TURNING_OR_SLIDING:
            yield f"is of joint {shown(name)}, and there is no such joint of one value"
        if name in seen:
            yield f"has the joint {shown(name)} twice"
        yield from (f"of a joint that {problem}" for problem in _of_numbers(joint, {"a": _ANY}))
        seen.add(name)
    if not seen:
        yield "has no joints"
    limits = (element.first(f"{prefix}{end}_limit") for end in ("lower", "upper"))
    lower, upper = (drake_number(limit.get("value")) if limit else None for limit in limits)
    if (lower or 0.0) > (upper or 0.0):
        yield "has a lower limit above the upper one"
