"""Models within a model of SDF, as links, joints and frames of that one.

From the specification (http://sdformat.org/tutorials, "Pose Frame Semantics" and "Model Composition"): what is in the
model ``n`` is called ``n::…`` outside of it, the frame of the model is called ``n``, and moves with its canonical link.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.manipulator import WORLD
from dh2urdf_plugins.read_back.sdf.versions import MODEL

if TYPE_CHECKING:
    from collections.abc import Callable

PLACED_BY = "placement_frame"
"""The attribute of a model, and of the frame that is made of it, with the frame whose pose the pose of the model is."""
AT_INCLUDED = "at an included model"
"""The type of a joint whose parent is in a model that is not read."""
_NAMED = ("link", "joint", "frame")


def flatten(model: etree._Element) -> str | None:
    """Takes the links, joints and frames of nested models into a model.

    Args:
        model: the model; it is changed.

    Returns:
        The canonical link, which the frame of the model moves with: the one that it names, else its first own link,
        else that of the first model in it. None where it has no link.
    """
    canonical = model.get("canonical_link") or next((link.get("name") for link in model.iterchildren("link")), None)
    for inner in model.findall("model"):
        name, includes = inner.get("name", ""), inner.find(".//include") is not None
        own = flatten(inner)
        carrier = own or (AT_INCLUDED if includes else None)
        frame = etree.Element("frame", name=name, attached_to=f"{name}::{carrier}" if carrier else MODEL)
        canonical = canonical or (f"{name}::{own}" if own else None)
        frame.sourceline = inner.sourceline
        if placed := inner.get(PLACED_BY):
            frame.set(PLACED_BY, _outside(placed, name))
        pose = inner.find("pose")
        pose = etree.SubElement(frame, "pose") if pose is None else pose
        pose.text = pose.text or "0 0 0 0 0 0"
        pose.set("relative_to", pose.get("relative_to") or MODEL)
        frame.append(pose)
        children = list(inner.iterchildren(*_NAMED))
        for child in children:
            _rename(child, name)
        for child in [frame, *children]:
            inner.addprevious(child)
        model.remove(inner)
    return canonical


def leave_out_attached(model: etree._Element, not_read: Callable[[etree._Element, str], None]) -> None:
    """Takes joints and frames out of a model that includes others, where they are at what is not in it.

    A joint that moves what is in the model stays, as one of the type `AT_INCLUDED`, so that nobody takes what is behind
    it for held by the world.

    Args:
        model: the model; it is changed.
        not_read: takes each of them, and the words for it.
    """
    known = {element.get("name") for element in model.iterchildren(*_NAMED)} | {MODEL, WORLD}
    parts = list(model.iterchildren("joint", "frame"))
    at: defaultdict[str | None, list[etree._Element]] = defaultdict(list)
    for each in parts:
        for target in _references(each):
            at[target].append(each)
    for each in parts:  # Behind them come those at what is left out.
        if each.getparent() is not model or _references(each) <= known:
            continue
        not_read(each, f"a {each.tag} at an included model")
        if (name := each.get("name")) in known:
            known.discard(name)
            parts += at[name]
        child = each.find("child")
        if child is not None and (child.text or "").strip() in known:
            each[:] = [child]
            etree.SubElement(each, "parent").text = WORLD
            each.set("type", AT_INCLUDED)
        else:
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
    element.set("name", _outside(element.get("name"), name))
    if element.tag == "frame":
        element.set("attached_to", _outside(element.get("attached_to"), name))
    for each in element.iter("parent", "child"):
        each.text = _outside((each.text or "").strip(), name)
    for each in element.iter("mimic"):
        each.set("joint", _outside(each.get("joint"), name))
    for each in element.iter("pose", "xyz", "frame"):
        for attribute in ("relative_to", "expressed_in", PLACED_BY):
            if each.get(attribute):
                each.set(attribute, _outside(each.get(attribute), name))
    if element.tag == "link":
        pose = element.find("pose")
        if pose is None:
            pose = etree.SubElement(element, "pose")
            pose.text = "0 0 0 0 0 0"
        pose.set("relative_to", pose.get("relative_to") or name)


def _outside(word: str | None, name: str) -> str:
    """What the model around the model `name` calls something in that."""
    return WORLD if word == WORLD else name if word in {None, "", MODEL} else f"{name}::{word}"
