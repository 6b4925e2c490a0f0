"""Elements of a URDF that are for other programs, and the names in them.

What `ros2_control`, `transmission`, `gazebo` and the like mean is nobody's business here. They travel as they are, but
for the names of links and joints: an attribute or a text that is such a name, and nothing else, is one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lxml import etree

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Set as AbstractSet

__all__ = ["lost_references", "renamed"]

DEFINED = {
    "transmission": "name",
    "actuator": "name",
    "leftActuator": "name",
    "rightActuator": "name",
    "ros2_control": "name",
    "sensor": "name",
}
"""Elements that give a name, which is unique in a robot, and the attribute that has it."""
REFERENCES = {
    "gazebo[@reference]": "reference",
    "transmission/joint[@name]": "name",
    "transmission/leftJoint[@name]": "name",
    "transmission/rightJoint[@name]": "name",
    "ros2_control/joint[@name]": "name",
}
"""Elements that name a link or a joint, and the attribute that has the name."""


def lost_references(elements: Iterable[str], names: AbstractSet[str]) -> Iterator[tuple[str, str, str]]:
    """The references to links and joints that there are not: tag, attribute, and the name."""
    for text in elements:
        whole = etree.Element("robot")
        whole.append(etree.fromstring(text))
        for path, attribute in REFERENCES.items():
            for element in whole.iterfind(path):
                if (name := element.get(attribute, "")) not in names:
                    yield str(element.tag), attribute, name


def renamed(text: str, names: AbstractSet[str], rename: Callable[[str], str]) -> etree._Element:
    """An element in which every name that it gives, and every name of these, is another one."""
    element = etree.fromstring(text)
    for each in element.iter(etree.Element):
        given = DEFINED.get(str(each.tag))
        if str(each.tag) == "sensor" and element.tag != "ros2_control":
            given = None  # one of Gazebo's, whose name is its link's business
        for attribute, value in each.items():
            if attribute == given or value in names:
                each.set(attribute, rename(str(value)))
        if (inner := (each.text or "").strip()) in names:
            each.text = rename(inner)
    return element
