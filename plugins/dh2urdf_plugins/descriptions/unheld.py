"""What a description holds besides the links and joints of a robot: no table has it, and a notice names it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from dh2urdf_plugins.read_back.mjcf.elements import Elements

_URDF = {
    ".": "link joint material mujoco",
    "link": "inertial visual collision",
    "joint": "origin parent child axis limit dynamics mimic",
}
"""The elements that are read, or are no part of the robot, by what holds them."""
_URDF_ATTRIBUTES = {"limit": "lower upper effort velocity", "dynamics": "damping friction"}
_SDF = ("plugin", "gripper", "link/sensor", "link/battery", "link/light", "joint/sensor")
_MJCF = ("sensor", "tendon", "keyframe")
_ACTUATORS = ("general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle")


def of_urdf(root: etree._Element) -> Iterator[tuple[str, etree._Element]]:
    """What a URDF holds besides, in words, and where."""
    for path, known in _URDF.items():
        for holder in root.iterfind(path):
            for element in holder.iterchildren(etree.Element):
                if element.tag not in known.split():
                    yield f"the element {_name(element, element.tag)}{'' if path == '.' else f' of a {path}'}", element
    for tag, known in _URDF_ATTRIBUTES.items():
        for element in root.iterfind(f"joint/{tag}"):
            for name in map(str, element.attrib):
                if name not in known.split():
                    yield f"the attribute {_name(element, name)} of a {tag}", element


def _name(element: etree._Element, name: str) -> str:
    """A name as the file writes it, with its prefix."""
    if name[:1] != "{":
        return name
    space, _, local = name[1:].partition("}")
    prefix = next((prefix for prefix, address in element.nsmap.items() if address == space), None)
    return f"{prefix}:{local}" if prefix else local


def of_sdf(root: etree._Element) -> Iterator[tuple[str, etree._Element]]:
    """What the first model of an SDF holds besides, in words, and where."""
    model = next((each for path in ("model", "world/model") for each in root.iterfind(path)), None)
    if model is None:
        return
    for path in _SDF:
        holder, _, tag = path.rpartition("/")
        for element in model.iterfind(f".//{path}" if holder else path):
            yield f"the element {tag}{f' of a {holder}' if holder else ''}", element
    for spring in model.iterfind(".//joint/axis/dynamics/spring_stiffness"):
        if (spring.text or "").strip(" 0.\n"):
            yield "the spring of a joint", spring


def of_mjcf(elements: Elements) -> Iterator[tuple[str, etree._Element]]:
    """What an MJCF holds besides, in words, and where."""
    for section in elements.root.iterchildren("actuator"):
        for actuator in section.iterchildren(etree.Element):
            yield "an actuator, but for the effort of its joint,", actuator
    for section in elements.root.iterchildren(*_MJCF):
        for element in section.iterchildren(etree.Element):
            yield f"a {'keyframe' if section.tag == 'keyframe' else section.tag}", element
    for camera in elements.root.iterfind("worldbody//camera"):
        yield "a camera", camera
    for joint in elements.root.iterfind("worldbody//joint"):
        given = elements.attributes(joint)
        if "springdamper" in given or given.get("stiffness", "0").strip(" 0."):
            yield "the spring of a joint", joint


def efforts_of_mjcf(elements: Elements) -> Mapping[str, float]:
    """The efforts of joints that one actuator drives, by the joint's name: what its force can reach [N or N·m].

    https://mujoco.readthedocs.io/en/stable/XMLreference.html#actuator-general: the effort at the joint is the force
    times the gear; the force of a motor is what controls it.
    """
    driven: dict[str, list[float | None]] = {}
    for section in elements.root.iterchildren("actuator"):
        for actuator in section.iterchildren(etree.Element):
            given = elements.attributes(actuator, *_ACTUATORS)
            if joint := given.get("joint") or given.get("jointinparent"):
                driven.setdefault(joint, []).append(_effort(actuator, given, elements))
    return {joint: found[0] for joint, found in driven.items() if len(found) == 1 and found[0]}


def _effort(actuator: etree._Element, given: dict[str, str], elements: Elements) -> float | None:
    reaches = [("forcerange", "forcelimited")]
    if actuator.tag == "motor":
        reaches.append(("ctrlrange", "ctrllimited"))
    try:
        gear = elements.numbers(actuator, given, "gear", (1.0,), most=6)[0]
        ranges = [elements.limits(actuator, given, name, limited) for name, limited in reaches]
        found = [max(map(abs, limits)) for limits in ranges if limits]
    except ProofError:  # numbers that are none; the effort is unknown then
        return None
    return abs(gear) * min(found) if found else None
