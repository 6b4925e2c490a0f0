"""Models within a model of SDF, as links, joints and frames of that one.

From the specification (http://sdformat.org/tutorials, "Pose Frame Semantics" and "Model Composition"): what is in the
model ``n`` is called ``n::…`` outside of it, the frame of the model is called ``n``, and moves with its canonical link.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.manipulator import WORLD

if TYPE_CHECKING:
    from collections.abc import Callable

MODEL = "__model__"
_NAMED = ("link", "joint", "frame")


def flatten(model: etree._Element, refuse: Callable[[etree._Element], None]) -> None:
    """Takes the links, joints and frames of nested models into a model.

    Args:
        model: the model; it is changed.
        refuse: takes a nested model that cannot be taken in, as its place depends on one of its frames; it stays out.
    """
    for inner in model.findall("model"):
        flatten(inner, refuse)
        name, place = inner.get("name", ""), model.index(inner)
        model.remove(inner)
        canonical = inner.get("canonical_link") or next((link.get("name") for link in inner.iterchildren("link")), None)
        if inner.get("placement_frame") or canonical is None:
            refuse(inner)
            continue
        frame = etree.Element("frame", name=name, attached_to=f"{name}::{canonical}")
        frame.sourceline = inner.sourceline
        pose = inner.find("pose")
        pose = etree.SubElement(frame, "pose") if pose is None else pose
        pose.text = pose.text or "0 0 0 0 0 0"
        pose.set("relative_to", pose.get("relative_to") or MODEL)
        frame.append(pose)
        children = list(inner.iterchildren(*_NAMED))
        for child in children:
            _rename(child, name)
        for child in reversed([frame, *children]):
            model.insert(place, child)


def leave_out_attached(model: etree._Element, not_read: Callable[[etree._Element, str], None]) -> None:
    """Takes joints and frames out of a model that includes others, where they are at what is not in it.

    Args:
        model: the model; it is changed.
        not_read: takes each of them, and the words for it.
    """
    known = {element.get("name") for element in model.iterchildren(*_NAMED)} | {MODEL, WORLD}
    while left := [each for each in model.iterchildren("joint", "frame") if not _references(each) <= known]:
        for each in left:
            not_read(each, f"a {each.tag} at an included model")
            known.discard(each.get("name"))
            model.remove(each)


def _references(element: etree._Element) -> set[str]:
    """What the place of a joint or frame, and its axis, depend on."""
    named = [
        *((end.text or "").strip() for end in element.iterchildren("parent", "child")),
        element.get("attached_to"),
        *(pose.get("relative_to") for pose in element.iterchildren("pose")),
        *(axis.get("expressed_in") for axis in element.iterfind("axis/xyz")),
    ]
    return {name for name in named if name}


def _rename(element: etree._Element, name: str) -> None:
    """Makes an element of the model `name` one of the model around that."""

    def outside(word: str | None) -> str:
        return word or "" if word == WORLD else name if word in {None, "", MODEL} else f"{name}::{word}"

    element.set("name", outside(element.get("name")))
    if element.tag == "frame":
        element.set("attached_to", outside(element.get("attached_to")))
    for each in element.iter("parent", "child"):
        each.text = outside((each.text or "").strip())
    for each in element.iter("mimic"):
        each.set("joint", outside(each.get("joint")))
    for each in element.iter("pose", "xyz"):
        for attribute in ("relative_to", "expressed_in"):
            if each.get(attribute):
                each.set(attribute, outside(each.get(attribute)))
    if element.tag == "link":
        pose = element.find("pose")
        if pose is None:
            pose = etree.SubElement(element, "pose")
            pose.text = "0 0 0 0 0 0"
        pose.set("relative_to", pose.get("relative_to") or name)
