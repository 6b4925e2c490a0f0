"""The elements of a robot description as its readers see them, with their places.

The readers' parsers (TinyXML, TinyXML-2) know no entities, no document types and no namespaces, and take comments with
``--`` and odd letters. A file comes from a stranger: nothing is expanded and nothing is fetched.
"""

from __future__ import annotations

import re
from typing import NamedTuple
from xml.parsers import expat

from lxml import etree

from dh2urdf.documents import ACCEPTED_XML, ForbiddenXmlError, check_encoding

DEEPEST = 1000
"""Elements inside each other that are kept; what is deeper is passed over."""
_ENCODING = re.compile(rb"<\?xml[^>]*encoding\s*=\s*[\"']([^\"']+)[\"']", re.IGNORECASE)
_COMMENT = re.compile(r"(?<=<!--).*?(?=-->)", re.DOTALL)
_INSTRUCTION = re.compile(r"<\?.*?\?>", re.DOTALL)
_DOCUMENT_TYPE = re.compile(r"<!DOCTYPE[^>\[]*(?:\[.*?\]\s*(?=>))?>", re.DOTALL)
_NO_BREAK = re.compile(r"[^\n]")
_NO_LETTER = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_NO_REFERENCE = re.compile(r"&(?!(?:quot|amp|apos|lt|gt|#x[0-9A-Fa-f]{1,6}|#[0-9]{1,7});)")
_VALUE = re.compile(r"""(?<==)(?:"[^"<>]*"|'[^'<>]*')""")
_TAB, _BREAK = "\ue009", "\ue00a"
"""What stands for a tab and before a line break in a value: XML makes blanks of them, and readers do not."""


class NotXmlError(Exception):
    """A text that is no XML: the reason, and the line and column, from 1."""

    def __init__(self, reason: str, line: int = 1, column: int = 1) -> None:
        self.reason, self.at = reason, (line, column)
        super().__init__(reason, line, column)


class Parsed(NamedTuple):
    """A text as a tree, in which `:` of a name, which names no namespace here, is a point."""

    root: etree._Element
    places: dict[etree._Element, tuple[int, int]]  # the line and column of each element, in the order of the text
    complaint: tuple[str, tuple[int, int]] | None  # why it is not XML to the letter, and its line and column


def parse(content: bytes) -> Parsed:
    """The tree of a text."""
    if content[:2] in {b"\xff\xfe", b"\xfe\xff"} or b"\0" in content[:4]:
        raise NotXmlError("it is encoded in UTF-16 or UTF-32, and readers take UTF-8")
    places: dict[etree._Element, tuple[int, int]] = {}
    above: list[etree._Element | None] = []
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def started(tag: str, attributes: dict[str, str]) -> None:
        if len(above) > DEEPEST:
            above.append(None)
            return
        values = {
            _name(name): text.replace(_TAB, "\t").replace(f"{_BREAK} ", "\n") for name, text in attributes.items()
        }
        holder = above[-1] if above else None
        element = etree.Element(_name(tag), values) if holder is None else etree.SubElement(holder, _name(tag), values)
        above.append(element)
        places[element] = (parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)

    def read(text: str) -> None:
        element = above[-1] if above else None
        if element is not None and not len(element):
            element.text = (element.text or "") + text

    parser.StartElementHandler, parser.EndElementHandler = started, lambda _tag: above.pop()
    parser.CharacterDataHandler = read
    try:
        parser.Parse(_read_as(content), True)
    except expat.ExpatError as error:
        if above or not places:
            raise NotXmlError(expat.ErrorString(error.code), error.lineno, error.offset + 1) from None
    complaint = None
    try:
        expat.ParserCreate().Parse(content, True)
    except expat.ExpatError as error:
        complaint = expat.ErrorString(error.code), (error.lineno, error.offset + 1)
    except (ValueError, LookupError) as error:  # an encoding that Python does not know, or that is no 8-bit one
        complaint = str(error), (1, 1)
    return Parsed(next(iter(places)), places, complaint)


def _name(name: str) -> str:
    return f"{'_' if name.startswith(':') else ''}{name.replace(':', '.')}"


def without_comments(text: str) -> str:
    """A text with blanks in its comments."""
    return _blanked(_COMMENT, "-->", text)


def _blanked(pattern: re.Pattern[str], end: str, text: str) -> str:
    """A text with blanks where a pattern matches; behind its last end no place is searched for one."""
    cut = text.rfind(end) + len(end)
    return pattern.sub(lambda found: _NO_BREAK.sub(" ", found[0]), text[:cut]) + text[cut:]


def _read_as(content: bytes) -> str:
    """A text as XML to the letter, every element at its place."""
    declared = _ENCODING.match(content.lstrip())
    encoding = declared[1].decode("ascii", "replace").lower() if declared else "utf-8"
    try:
        check_encoding(encoding)
    except ForbiddenXmlError as error:
        raise NotXmlError(f"{error.msg}; accepted: {ACCEPTED_XML}") from None
    is_latin = not encoding.startswith(("utf", "us-", "ascii"))
    text = content.decode("latin-1" if is_latin else "utf-8", "replace").removeprefix("\ufeff")
    text = without_comments(re.sub(r"\r(?!\n)", " ", text))
    text = _blanked(_INSTRUCTION, "?>", text)
    if found := _DOCUMENT_TYPE.match(text, max(text.find("<!DOCTYPE"), 0)):
        text = f"{text[: found.start()]}{_NO_BREAK.sub(' ', found[0])}{text[found.end() :]}"
    text = _NO_REFERENCE.sub("&amp;", _NO_LETTER.sub(lambda found: " " if found[0] == "\0" else "?", text))
    return _VALUE.sub(lambda found: found[0].replace("\t", _TAB).replace("\n", f"{_BREAK}\n"), text)
