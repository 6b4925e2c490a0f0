"""A URDF as the rules see it: the elements that its readers find, and what they make of links and joints, in XPath."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from lxml import etree

from dh2urdf.manipulator import WORLD
from dh2urdf_check.document.description import MOVING, Hit
from dh2urdf_check.document.tree import Element
from dh2urdf_check.finders import Document, text_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from dh2urdf_check.document.description import Description, LinkNode
    from dh2urdf_check.rules import Rule

_NOT_IN_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def hits(description: Description, rules: dict[str, Rule]) -> Iterator[Hit]:
    """The places where a description breaks rules that are data."""
    origin: dict[etree._Element, Element] = {}
    root = _copied(description.root, origin)
    document = Document(root, description.path, _functions(description, root), lambda at: description.place(origin[at]))
    for hit in document.hits(rules.values()):
        yield Hit(hit.rule, origin[hit.at], hit.message, hit.of)


def _copied(element: Element, origin: dict[etree._Element, Element]) -> etree._Element:
    """The elements for XPath: `:` of a prefix, which names no namespace here, is a point in them."""
    pairs = [(element, root := _copy(element))]
    for each, copy in pairs:
        origin[copy] = each
        for child in each.children:
            inner = _copy(child)
            copy.append(inner)
            pairs.append((child, inner))
    return root


def _copy(element: Element) -> etree._Element:
    names = ((name.replace(":", "."), value) for name, value in element.attributes.items())
    attributes = {name: _NOT_IN_XML.sub("?", value) for name, value in names}
    copy = etree.Element(element.tag.replace(":", "."), attributes)
    copy.text = _NOT_IN_XML.sub("?", element.text)
    return copy


def _functions(description: Description, root: etree._Element) -> dict[str, Callable[..., Any]]:
    """The functions of XPath in the rules of URDF; those of links take the element of a link, or its name."""
    compiler = description.root.first("mujoco", "compiler") or Element("compiler", {}, 0, 0)
    fuses = compiler.get("fusestatic") != "false"  # MuJoCo merges what is fixed to the world into it.

    def link_of(found: Any) -> LinkNode | None:  # noqa: ANN401 - what XPath has
        at = found[0] if isinstance(found, list) and found else found
        name = str(at.get("name")) if etree.iselement(at) else text_of(at)
        return description.link.get(name)

    def moves(_: object, found: Any) -> bool:  # noqa: ANN401
        """Whether a joint that moves holds a link."""
        link = link_of(found)
        holder = description.holder(link) if link else None
        return holder is not None and holder.kind in MOVING

    def is_root(_: object, found: Any) -> bool:  # noqa: ANN401
        """Whether a link is the first that no joint holds."""
        link = link_of(found)
        return link is not None and description.roots[:1] == [link]

    kinds = {joint.name: joint.kind for joint in description.joints}
    at_rest = [node for each in description.roots for node in description.body(each)] if fuses else description.roots
    static = {node.name for node in at_rest if fuses or node.name == WORLD}
    driven = {
        str(joint.get("name"))
        for transmission in root.iterfind("transmission")
        if "SimpleTransmission" in (transmission.findtext("type") or transmission.get("type") or "")
        for joint in transmission.iterfind("joint")
    }

    def is_fixed(_: object, found: Any) -> bool:  # noqa: ANN401
        """Whether a fixed joint holds a link."""
        link = link_of(found)
        holder = description.holder(link) if link else None
        return holder is not None and holder.kind == "fixed"

    return {
        "moves": moves,
        "is-fixed": is_fixed,
        "static": lambda _, name: text_of(name) in static,
        "kind": lambda _, name: kinds.get(text_of(name), ""),
        "is-driven": lambda _, name: text_of(name) in driven,
        "is-root": is_root,
        "draws": lambda _: compiler.get("discardvisual") == "false",
        "fuses": lambda _: fuses,
    }
