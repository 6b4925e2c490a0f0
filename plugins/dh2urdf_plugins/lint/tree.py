"""A robot description as it stands in the file: elements with their places, nothing mended and nothing refused.

The parser is expat, which knows the line and the column where every element begins. A file comes from a stranger:
entities are not expanded, nothing is fetched, and no depth of nesting is recursed into.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING
from xml.parsers import expat

if TYPE_CHECKING:
    from collections.abc import Iterator

DEEPEST = 1000
"""Elements inside each other that are kept [1]; what stands deeper is passed over."""


@dataclass(slots=True, eq=False)
class Element:
    """An element and its place.

    Attributes:
        tag: its name, with the prefix that it has in the file.
        attributes: its attributes.
        line: the line where it begins, from 1.
        column: the column where it begins, from 1.
        children: the elements in it.
    """

    tag: str
    attributes: dict[str, str]
    line: int
    column: int
    children: list[Element] = field(default_factory=list)

    def get(self, attribute: str) -> str | None:
        """The text of an attribute."""
        return self.attributes.get(attribute)

    def all(self, tag: str) -> list[Element]:
        """The children of a name."""
        return [child for child in self.children if child.tag == tag]

    def first(self, *path: str) -> Element | None:
        """The first child of a name, its first child of the next name, and so on."""
        element: Element | None = self
        for tag in path:
            element = next((child for child in element.children if child.tag == tag), None) if element else None
        return element

    def walk(self) -> Iterator[Element]:
        """This element and all in it, in the order of the file."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.children))

    def numbers(self, attribute: str, count: int) -> tuple[float, ...] | None:
        """As many finite numbers as an attribute should hold; None where it holds something else."""
        return numbers_of(self.get(attribute), count)

    def number(self, attribute: str) -> float | None:
        """The finite number that an attribute holds; None where it holds something else."""
        found = self.numbers(attribute, 1)
        return found[0] if found else None


def numbers_of(text: str | None, count: int) -> tuple[float, ...] | None:
    """As many finite numbers as a text should hold; None where it holds something else."""
    words = (text or "").split()
    if len(words) != count or any("_" in word for word in words):  # `float` takes 1_000, which no reader does.
        return None
    try:
        found = tuple(map(float, words))
    except ValueError:
        return None
    return found if all(map(math.isfinite, found)) else None


class NotXmlError(Exception):
    """The text is not well-formed XML.

    Attributes:
        reason: what expat says.
        line: where, from 1.
        column: where, from 1.
    """

    def __init__(self, reason: str, line: int, column: int) -> None:
        self.reason, self.line, self.column = reason, line, column
        super().__init__(reason, line, column)


@dataclass(frozen=True, slots=True, kw_only=True)
class Parsed:
    """A text as a tree.

    Attributes:
        root: the outermost element.
        declarations: the line of a document type that has declarations of its own; None where there is none.
        entities: whether these declare entities; the tree then ends before them, and `root` is empty.
    """

    root: Element
    declarations: int | None
    entities: bool


class _EntitiesError(Exception):
    pass


def parse(content: bytes) -> Parsed:
    """The tree of a text.

    Raises:
        NotXmlError: it is not well-formed XML.
    """
    builder = _Builder()
    try:
        builder.parser.Parse(content, True)
    except _EntitiesError:
        return Parsed(
            root=Element("robot", {}, builder.declarations or 1, 1), declarations=builder.declarations, entities=True
        )
    except expat.ExpatError as error:
        raise NotXmlError(expat.ErrorString(error.code), error.lineno, error.offset + 1) from None
    except (ValueError, LookupError) as error:  # an encoding that Python does not know, or that is no 8-bit one
        raise NotXmlError(str(error), 1, 1) from None
    return Parsed(root=builder.top.children[0], declarations=builder.declarations, entities=False)


class _Builder:
    """Builds the tree while expat reads."""

    def __init__(self) -> None:
        self.top = Element("", {}, 0, 0)
        self.declarations: int | None = None
        self._open = [self.top]
        self._too_deep = 0
        self.parser = parser = expat.ParserCreate()
        parser.SetParamEntityParsing(expat.XML_PARAM_ENTITY_PARSING_NEVER)
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.StartDoctypeDeclHandler = self._doctype
        parser.EntityDeclHandler = self._entity

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        if len(self._open) > DEEPEST:
            self._too_deep += 1
            return
        element = Element(tag, attributes, self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1)
        self._open[-1].children.append(element)
        self._open.append(element)

    def _end(self, _tag: str) -> None:
        if self._too_deep:
            self._too_deep -= 1
        else:
            self._open.pop()

    def _doctype(self, _name: str, _system: str | None, _public: str | None, has_declarations: bool) -> None:  # noqa: FBT001 - expat's signature
        if has_declarations:
            self.declarations = self.parser.CurrentLineNumber

    def _entity(self, *_what: object) -> None:
        raise _EntitiesError
