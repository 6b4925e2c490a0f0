"""Elements of a URDF that Drake alone reads: transmissions, frames, groups for collisions, joints of loops."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.source import shown
from dh2urdf_check.document.description import Hit
from dh2urdf_check.numbers import drake_number, drake_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.document.description import Description, JointNode
    from dh2urdf_check.document.tree import Element

_SEVERAL = {"floating", "planar"}
"""Types of joints with several coordinates."""
_STILL = {"fixed"}
_GROUP = "drake:collision_filter_group"


def hits(description: Description) -> Iterator[Hit]:
    """Findings about what Drake alone reads."""
    yield from _transmissions(description)
    for name, found in _frames(description):
        yield Hit(name, found[0], found[1], {"drake"})
    for name, found in _groups(description):
        yield Hit(name, found[0], found[1], {"drake"})
    for loop in description.root.all("loop_joint"):
        yield Hit("unknown-joint-type", loop, "a loop_joint, which Drake knows and refuses", {"drake"})


def actuated_joints(description: Description) -> set[str]:
    """Names of the joints for which Drake reads a transmission."""
    return {
        joint.get("name") or ""
        for transmission in description.root.all("transmission")
        if "SimpleTransmission" in (_type_of(transmission) or "")
        if (joint := transmission.first("joint")) and transmission.first("actuator")
    }


def _transmissions(description: Description) -> Iterator[Hit]:
    """Drake reads those of the type that it knows, and passes over the others."""
    kinds = {joint.name: "fixed" if _is_idle(joint) else joint.kind for joint in description.joints}
    actuators = set[str]()
    for transmission in description.root.all("transmission"):
        kind, element = _type_of(transmission), transmission.first("type")
        if kind is None:
            yield Hit("transmission-incomplete", transmission, "a transmission has no type")
        elif element and not kind:
            yield Hit("transmission-type-empty", element, "a transmission has an empty type")
        elif "SimpleTransmission" in kind:
            if problem := _problem(transmission, kinds, actuators):
                yield Hit("transmission-incomplete", transmission, f"a transmission {problem}")
            joint, actuator = transmission.first("joint"), transmission.first("actuator")
            if actuator and joint and kinds.get(joint.get("name") or "") not in _SEVERAL | _STILL:
                actuators.add(actuator.get("name") or "")


def _is_idle(joint: JointNode) -> bool:
    """Whether the effort of a joint is 0; Drake passes over its transmission, as over that of a fixed joint."""
    limit = joint.element.first("limit")
    return limit is not None and drake_number(limit.get("effort")) == 0.0 and joint.kind not in _SEVERAL


def _type_of(transmission: Element) -> str | None:
    """The type of a transmission: of its element, or, where there is none, of its attribute."""
    kind = transmission.first("type")
    return kind.text if kind else transmission.get("type")


def _problem(transmission: Element, kinds: dict[str, str], actuators: set[str]) -> str:
    """What is wrong with a transmission; `actuators` are those of the ones before."""
    joint, actuator = transmission.first("joint"), transmission.first("actuator")
    if joint is None or actuator is None:
        return f"has no {'joint' if joint is None else 'actuator'}"
    name, driven = actuator.get("name"), joint.get("name")
    if not driven or not name:
        return "has a joint or actuator without a name"
    if driven not in kinds:
        return f"is of joint {shown(driven)}, and there is no such joint"
    if kinds[driven] in _SEVERAL:
        return f"is of joint {shown(driven)}, which is {kinds[driven]}"
    if name in actuators and kinds[driven] not in _STILL:  # Drake passes over the transmission of one that is still.
        return f"has the actuator {shown(name)}, as another has"
    numbers = (actuator.first("drake:rotor_inertia"), actuator.first("drake:gear_ratio"))
    wrong = [element.tag for element in numbers if element and drake_number(element.get("value")) is None]
    wrong = [] if kinds[driven] in _STILL else wrong
    return f"has a {wrong[0]} that is no number" if wrong else ""


_Found = tuple[str, tuple["Element", str]]
"""A rule, and where and how it is broken."""


def _frames(description: Description) -> Iterator[_Found]:
    names = {*description.link}
    for frame in description.root.all("frame"):
        name, link = frame.get("name"), frame.get("link")
        if not name or not link:
            yield "missing-name", (frame, f"a frame has no {'link' if name else 'name'}")
            continue
        if link not in description.link and link != "world":
            message = f"the frame {shown(name)} is of link {shown(link)}, and there is no such link"
            yield "undefined-link", (frame, message)
        if name in names:
            yield "duplicate-link", (frame, f"the frame {shown(name)} has the name of a link or of another frame")
        names.add(name)
        for attribute in ("xyz", "rpy"):
            text = frame.get(attribute)
            if text is not None and len(drake_numbers(text)) != len("xyz"):
                yield "invalid-vector", (frame, f"{attribute} of frame is {shown(text)}, not 3 finite numbers")


def _groups(description: Description) -> Iterator[_Found]:
    read = [group for group in description.root.all(_GROUP) if group.get("ignore") != "true"]
    names, before = {group.get("name") for group in read}, set[str | None]()
    for group in read:
        about, members = f"a {_GROUP}", group.all("drake:member")
        links = [member.get("link") for member in members]
        ignored = [each.get("name") for each in group.all("drake:ignored_collision_filter_group")]
        if None in {group.get("name"), *links, *ignored}:
            yield "missing-name", (group, f"{about}, or one in it, has no name")
        elif group.get("name") in before:
            yield "duplicate-link", (group, f"{about} has the name of another")
        elif not members and not group.all("drake:member_group"):
            yield "undefined-link", (group, f"{about} has no members")
        elif lost := [link for link in links if link not in description.link]:
            yield "undefined-link", (group, f"{about} has the link {shown(lost[0] or '')}, and there is no such link")
        elif lost := [name for name in ignored if name not in names]:
            yield "undefined-link", (group, f"{about} ignores the group {shown(lost[0] or '')}, which is not there")
        before.add(group.get("name"))
