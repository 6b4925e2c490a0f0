"""Where the elements of an expanded xacro come from: file, line and column in the sources, and the calls of macros.

Every element of xacro's document is given its place as user data of the DOM, which is no part of the text and goes with
the element wherever xacro moves or copies it.
"""

from __future__ import annotations

import types
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.dom import UserDataHandler, expatbuilder
from xml.dom.minidom import Document, Element

if TYPE_CHECKING:
    from collections.abc import Iterator
    from xml.dom.minidom import Node

_KEY = "dh2urdf place"
_NO_MACROS = {"xacro:include", "xacro:insert_block", "xacro:if", "xacro:unless"}
"""What xacro replaces by content of its own place."""


class Place(NamedTuple):
    """Where an element is in the sources.

    Attributes:
        file: the file, as xacro names it: relative to the folder of the first file, or absolute.
        line: from 1.
        column: from 1.
        calls: where the macros are called that it comes from, the innermost first; they have no calls themselves.
    """

    file: str
    line: int
    column: int
    calls: tuple[Place, ...] = ()


def keep_places(xacro: types.ModuleType) -> None:
    """Has xacro's documents know the places of their elements; in this process, for good."""
    builder: Any = expatbuilder.ExpatBuilderNS
    start, replace_node = builder.start_element_handler, xacro.replace_node

    def started(self: Any, name: str, attributes: list[str]) -> None:  # noqa: ANN401 - a builder
        start(self, name, attributes)
        parser = self.getParser()
        place = Place(xacro.filestack[-1], parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)
        self.curNode.setUserData(_KEY, place, _COPIER)

    def replaced(node: Element, by: Any, content_only: bool = False) -> None:  # noqa: ANN401, FBT001, FBT002 - as xacro calls it
        is_call = isinstance(by, Element) and node.nodeType == node.ELEMENT_NODE and node.tagName not in _NO_MACROS
        if is_call and (call := place_of(node)):
            for element in _elements(by):
                if place := place_of(element):
                    element.setUserData(_KEY, place._replace(calls=(*place.calls, call._replace(calls=()))), _COPIER)
        replace_node(node, by, content_only)

    builder.start_element_handler = started
    xacro.replace_node = replaced  # type: ignore[attr-defined]


def _keep_place(operation: int, key: str, place: Place, _original: Node, copy: Node) -> None:
    """Give a copy of an element the place of its original."""
    if operation == UserDataHandler.NODE_CLONED:
        copy.setUserData(key, place, _COPIER)


_COPIER = types.SimpleNamespace(handle=_keep_place)


def place_of(element: Element) -> Place | None:
    """Where an element is in the sources; None of one that xacro has made itself."""
    place: Place | None = element.getUserData(_KEY)
    return place


def places(document: Document) -> list[Place | None]:
    """The places of all elements of a document, in its order."""
    return [place_of(element) for element in _elements(document.documentElement)] if document.documentElement else []


def place_of_failure(error: BaseException) -> Place | None:
    """The place of the innermost element that xacro was at when it failed."""
    found: Place | None = None
    trace = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_globals.get("__name__") == "xacro":
            names = trace.tb_frame.f_locals
            element = next((names[name] for name in ("node", "elt") if isinstance(names.get(name), Element)), None)
            found = (place_of(element) if element is not None else None) or found
        trace = trace.tb_next
    return found


def _elements(root: Element) -> Iterator[Element]:
    waiting: list[Element] = [root]
    while waiting:
        element = waiting.pop()
        yield element
        waiting.extend(child for child in reversed(element.childNodes) if isinstance(child, Element))
