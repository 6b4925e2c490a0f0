"""Collision pairs in the text of an SRDF: those of an earlier file are brought up to date, all else stays as it is."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple, NoReturn
from xml.parsers import expat
from xml.sax.saxutils import quoteattr

from dh2urdf.errors import InputError
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.collision_pairs.scene import pair_of
from dh2urdf_plugins.collision_pairs.search import REASONS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.robot import Robot
    from dh2urdf_plugins.collision_pairs.scene import Pair
    from dh2urdf_plugins.collision_pairs.search import DisabledPair

TAG = "disable_collisions"
_INDENT = "  "
_WIDE = (b"\xfe\xff", b"\xff\xfe", b"\0")


def pair_element(pair: DisabledPair) -> str:
    """The element of a pair."""
    link1, link2 = map(quoteattr, (pair.link1, pair.link2))
    return f'<{TAG} link1={link1} link2={link2} reason="{pair.reason}"/>'


def new_file(robot: Robot, pairs: Sequence[DisabledPair]) -> bytes:
    """An SRDF that has collision pairs alone."""
    lines = [
        '<?xml version="1.0"?>',
        f"<robot name={quoteattr(robot.name)}>",
        *(f"{_INDENT}{pair_element(pair)}" for pair in pairs),
        "</robot>",
    ]
    return "".join(f"{line}\n" for line in lines).encode()


def updated(content: bytes, file: str, robot: Robot, pairs: Sequence[DisabledPair]) -> tuple[bytes, list[Problem]]:
    """An SRDF with other collision pairs.

    Pairs of the same reason stay where they are, and so do pairs that have a reason of their own, such as ``User``:
    those are somebody's decision. Other pairs go, and new ones come behind the last.

    Args:
        content: the SRDF.
        file: what messages call it.
        robot: the robot of the description.
        pairs: its collision pairs.

    Returns:
        The whole file, and notices.

    Raises:
        InputError: it is no SRDF, or it has macros.
    """
    document = _Document(content, file)
    wanted = {(pair.link1, pair.link2): pair for pair in pairs}
    links = {link.name for link in robot.links}
    notices = list(_notices(document, robot.name, links))
    kept = {element.pair for element in document.elements if element.reason not in REASONS}
    edits: list[tuple[int, int, str]] = []
    met = set(kept)
    for element in document.elements:
        pair = wanted.get(element.pair)
        if element.reason not in REASONS:
            continue
        if pair is None or element.pair in met:
            edits.append((*document.whole_lines(element), ""))
        elif pair.reason != element.reason:
            edits.append((element.start, element.end, pair_element(pair)))
        met.add(element.pair)
    added = [pair_element(pair) for key, pair in wanted.items() if key not in met]
    if added:
        edits.append(document.insertion(added))
    for start, end, text in sorted(edits, reverse=True):
        content = content[:start] + text.encode(document.encoding, "xmlcharrefreplace") + content[end:]
    return content, notices


def _notices(document: _Document, robot: str, links: set[str]) -> Iterator[Problem]:
    if document.robot != robot:
        message = f"the SRDF is of the robot {shown(document.robot)}, the description of {shown(robot)}"
        suggestion = "MoveIt reports this as an error: give both the same name"
        yield Problem(message=message, severity="notice", mark=Mark(file=document.file), suggestion=suggestion)
    for element in document.elements:
        unknown = [name for name in element.pair if name not in links]
        if element.reason not in REASONS and unknown:
            message = f"the pair of {' and '.join(map(shown, element.pair))} stays, though the description has no link "
            yield Problem(
                message=f"{message}{' and no link '.join(map(shown, unknown))}",
                severity="notice",
                mark=Mark(file=document.file, line=element.line),
                suggestion="remove it, or name links of the description",
            )


class _Element(NamedTuple):
    """A pair in the text: where it is, in bytes, and what it has."""

    start: int
    end: int
    pair: Pair
    reason: str
    line: int


class _Document:
    """The places in an SRDF where its collision pairs are.

    Attributes:
        content: the text.
        file: what messages call it.
        encoding: how it is encoded.
        robot: the name of the robot.
        elements: the pairs, in their order.
    """

    def __init__(self, content: bytes, file: str) -> None:
        """Finds the pairs.

        Raises:
            InputError: it is no SRDF, or it has macros.
        """
        self.content, self.file, self.encoding, self.robot = content, file, "utf-8", ""
        self.elements: list[_Element] = []
        self._depth = 0
        self._opened: _Element | None = None
        self._end = 0
        if any(mark in content[:4] for mark in _WIDE):
            self._refuse("the SRDF has two bytes for each character", accepted="UTF-8")
        parser = self._parser = expat.ParserCreate()
        parser.XmlDeclHandler = self._declared
        parser.StartDoctypeDeclHandler = self._document_type
        parser.StartElementHandler, parser.EndElementHandler = self._begun, self._ended
        try:
            parser.Parse(content, True)
        except expat.ExpatError as error:
            mark = Mark(file=file, line=error.lineno, column=error.offset + 1)
            message = f"this is not XML: {expat.ErrorString(error.code)}"
            raise InputError(Problem(message=message, mark=mark, accepted="an SRDF")) from error

    def whole_lines(self, element: _Element) -> tuple[int, int]:
        """From where to where a pair goes: with its lines, where nothing else is in them."""
        start, end = element.start, element.end
        line = self.content.rfind(b"\n", 0, start) + 1
        after = re.compile(rb"[ \t]*\r?\n").match(self.content, end)
        if after and not self.content[line:start].strip():
            return line, after.end()
        return start, end

    def insertion(self, added: Sequence[str]) -> tuple[int, int, str]:
        """Where new pairs come: behind the last one, or at the end of the robot."""
        ending = "\r\n" if b"\r\n" in self.content else "\n"
        if self.elements:
            last = self.elements[-1]
            line = self.content.rfind(b"\n", 0, last.start) + 1
            margin = self.content[line : last.start].decode(self.encoding)
            margin = margin if not margin.strip() else ""
            return last.end, last.end, "".join(f"{ending}{margin}{each}" for each in added)
        line = self.content.rfind(b"\n", 0, self._end) + 1
        text = "".join(f"{_INDENT}{each}{ending}" for each in added)
        if self.content[line : self._end].strip():
            return self._end, self._end, ending + text
        return line, line, text

    def _declared(self, _version: str, encoding: str | None, _standalone: int) -> None:
        self.encoding = encoding or "utf-8"

    def _document_type(self, *_words: object) -> None:
        self._refuse("a document type is not accepted in an SRDF", accepted="an SRDF without <!DOCTYPE>")

    def _begun(self, tag: str, attributes: dict[str, str]) -> None:
        if tag.startswith("xacro:"):
            self._refuse(
                "the SRDF has macros of xacro, in which no pairs can be brought up to date",
                accepted="a plain SRDF",
                suggestion="expand it with `xacro`, or write the pairs to a file that it includes",
            )
        if self._depth == 0:
            if tag != "robot":
                self._refuse(f"the outermost element is {shown(tag)}", accepted="robot")
            self.robot = attributes.get("name", "").strip()
        elif self._depth == 1 and tag == TAG:
            pair = pair_of(attributes.get("link1", "").strip(), attributes.get("link2", "").strip())
            start, line = self._parser.CurrentByteIndex, self._parser.CurrentLineNumber
            self._opened = _Element(start, start, pair, attributes.get("reason", ""), line)
        self._depth += 1

    def _ended(self, tag: str) -> None:
        self._depth -= 1
        place = self._parser.CurrentByteIndex
        is_tag = self.content.startswith(b"</", place) and self.content.startswith(tag.encode(self.encoding), place + 2)
        if self._depth == 0:
            if not is_tag:
                self._refuse("the robot has no content", accepted="<robot> and </robot>")
            self._end = place
        elif self._depth == 1 and self._opened is not None:
            end = self.content.index(b">", place) + 1 if is_tag else place
            self.elements.append(self._opened._replace(end=end))
            self._opened = None

    def _refuse(self, message: str, *, accepted: str, suggestion: str | None = None) -> NoReturn:
        mark = Mark(file=self.file, line=self._parser.CurrentLineNumber if self._depth else None)
        raise InputError(Problem(message=message, mark=mark, accepted=accepted, suggestion=suggestion))
