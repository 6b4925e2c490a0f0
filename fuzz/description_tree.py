"""Robot descriptions as trees that can be spoilt: read from any URDF, written as they stand, however wrong."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

if TYPE_CHECKING:
    from collections.abc import Iterator
    from random import Random


@dataclass(eq=False)
class Node:
    """An element.

    Attributes:
        tag: its name.
        attributes: names and texts; a name may be there twice.
        children: the elements in it.
        text: raw text in it, before its children.
    """

    tag: str
    attributes: list[tuple[str, str]] = field(default_factory=list)
    children: list[Node] = field(default_factory=list)
    text: str = ""

    def get(self, name: str) -> str | None:
        """The first attribute of a name."""
        return next((text for key, text in self.attributes if key == name), None)

    def set(self, name: str, text: str) -> None:
        """Give an attribute another text, or add it."""
        for index, (key, _) in enumerate(self.attributes):
            if key == name:
                self.attributes[index] = (key, text)
                return
        self.attributes.append((name, text))

    def remove(self, name: str) -> None:
        """Take the attributes of a name away."""
        self.attributes = [pair for pair in self.attributes if pair[0] != name]

    def all(self, *tags: str) -> list[Node]:
        """The children of some names."""
        return [child for child in self.children if child.tag in tags]

    def first(self, tag: str) -> Node | None:
        """The first child of a name."""
        return next(iter(self.all(tag)), None)

    def walk(self) -> Iterator[Node]:
        """This element and all in it."""
        yield self
        for child in self.children:
            yield from child.walk()

    def copy(self) -> Node:
        """An element of its own that is the same."""
        return copy.deepcopy(self)

    def written(self, indent: str = "") -> str:
        """The text of it; nothing is escaped but what ends an attribute or begins an element."""
        attributes = "".join(f' {name}="{_escaped(text)}"' for name, text in self.attributes)
        if not self.children and not self.text:
            return f"{indent}<{self.tag}{attributes}/>\n"
        inner = "".join(child.written(indent + "  ") for child in self.children)
        return f"{indent}<{self.tag}{attributes}>{self.text}\n{inner}{indent}</{self.tag}>\n"


def _escaped(text: str) -> str:
    return text.replace('"', "&quot;").replace("<", "&lt;")


def read(text: str | bytes) -> Node:
    """The tree of a sound description."""
    return _node(ET.fromstring(text))  # noqa: S314 - of packages that are installed


def _node(element: ET.Element) -> Node:
    return Node(
        element.tag, list(element.attrib.items()), [_node(child) for child in element if isinstance(child.tag, str)]
    )


def piece(robot: Node, rng: Random, most: int) -> Node:
    """A connected part of a robot with few links, as a robot: what readers do with more of them they do with these."""
    joints: dict[str, list[Node]] = {}
    for joint in robot.all("joint"):
        parent, child = joint.first("parent"), joint.first("child")
        if parent and child:
            joints.setdefault(parent.get("link") or "", []).append(joint)
    links = {link.get("name") or "": link for link in robot.all("link")}
    kept, held, waiting = [], [], [rng.choice(sorted(links))]
    while waiting and len(kept) < most:
        name = waiting.pop(rng.randrange(len(waiting)))
        if name not in links or name in kept:
            continue
        kept.append(name)
        for joint in joints.get(name, ()):
            held.append(joint)
            waiting.append((joint.first("child") or joint).get("link") or "")
    inside = [joint for joint in held if (joint.first("child") or joint).get("link") in kept]
    others = [child for child in robot.children if child.tag not in {"link", "joint", "gazebo"}]
    names = {joint.get("name") for joint in inside}
    for joint in inside:
        joint.children = [c for c in joint.children if c.tag != "mimic" or c.get("joint") in names]
    others = [other for other in others if other.tag != "transmission"]
    return Node(robot.tag, robot.attributes, [*others, *(links[name] for name in kept), *inside]).copy()


def any_of(rng: Random, robot: Node, *tags: str) -> Node | None:
    """An element of some names; None where there is none."""
    found = [node for node in robot.walk() if node.tag in tags]
    return rng.choice(found) if found else None
