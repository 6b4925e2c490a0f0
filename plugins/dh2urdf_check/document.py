"""A description as `check` reads it: its elements, and where each is in the files that it comes from.

A file comes from a stranger: nothing is expanded but a xacro, behind the fence, and nothing is fetched.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.parsers import expat

from lxml import etree

from dh2urdf.documents import read_bytes
from dh2urdf.errors import InputError
from dh2urdf.source import Mark
from dh2urdf_plugins.formats.mjcf.elements import include_files
from dh2urdf_plugins.formats.xml_files import FILE, LARGEST, tree_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.stages import Expansion
    from dh2urdf_plugins.formats.mjcf.elements import Missing

_COMMENT = re.compile(r"(?<=<!--).*?(?=-->)", re.DOTALL)
_PROLOGUE = b'<?xml version="1.0" encoding="utf-8"?>' + 5 * b"\n"
"""As many lines as the command `xacro` writes before the robot: a line without an element is one of its output."""
_NO_REFERENCE = re.compile(rb"&(?!(?:quot|amp|apos|lt|gt|#x[0-9A-Fa-f]{1,6}|#[0-9]{1,7});)")
_OTHER_ENCODING = re.compile(rb"\A\s*<\?xml[^>]*encoding\s*=\s*[\"'](?!utf-?8)|\A(?:\xff\xfe|\xfe\xff)", re.IGNORECASE)


class Text(NamedTuple):
    """A description: its text, its elements, and where they are written."""

    path: Path
    content: bytes  # what readers get: of a xacro, what it expands to
    root: etree._Element
    marks: dict[etree._Element, Mark]  # the place of each element, in the order of the text
    calls: dict[etree._Element, tuple[Mark, ...]]  # where the macros are called that an element comes from
    missing: Sequence[Missing] = ()  # what an MJCF includes and is not there

    @property
    def whole(self) -> Mark:
        """The file."""
        return Mark(file=str(self.path))

    @property
    def plain(self) -> str:
        """The text with blanks in comments, a letter a byte."""
        return _COMMENT.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), self.content.decode("latin-1"))

    def at(self, mark: Mark | None) -> Iterator[etree._Element]:
        """The elements that are at a place; a macro puts several there."""
        for element, found in self.marks.items():
            if mark and (found.file, found.line) == (mark.file, mark.line) and mark.column in {None, found.column}:
                yield element


def line_of(element: etree._Element) -> int:
    """The line of an element in the text that it was read from."""
    line: Any = element.sourceline  # the stubs of lxml say that it may be an ellipsis
    return int(line)


def unread(path: Path) -> Text:
    """A description of which nothing but its bytes is known."""
    return Text(path, read_bytes(path, InputError, limit=LARGEST), etree.Element("unread"), {}, {})


def read_text(path: Path, form: str, expansion: Expansion | None = None) -> Text:
    """A description of a format; a `ProofError` where it has no elements, or xacro cannot expand it."""
    content = read_bytes(path, InputError, limit=LARGEST)
    marks: dict[etree._Element, Mark] = {}
    if form == "xacro":
        from dh2urdf_plugins.xacro_fence.expansion import expand_foreign, mark_of

        expanded = expand_foreign(path, expansion)
        content = _PROLOGUE + expanded.content
        root = tree_of(content, str(path))
        calls = {}
        for element, place in zip(root.iter(etree.Element), expanded.places, strict=True):
            unknown = Mark(file=str(path), place=f"line {line_of(element)} of what it expands to")
            marks[element] = mark_of(place) if place else unknown
            calls[element] = tuple(map(mark_of, place.calls)) if place else ()
        return Text(path, content, root, marks, calls)
    readable = _as_readers_take_it(content)
    root = tree_of(readable, str(path), is_deep=form == "mjcf")
    columns = dict(zip(root.iter(etree.Element), _columns(readable), strict=False))
    included = include_files(root, path) if form == "mjcf" else ()
    for element in root.iter(etree.Element):
        above = element.getparent()
        file = str(element.get(FILE) or (path if above is None else marks[above].file))
        marks[element] = Mark(file=file, line=line_of(element), column=columns.get(element))
    return Text(path, content, root, marks, {}, included)


def _columns(content: bytes) -> list[int]:
    """The column of each element of a text that is XML to the letter, from 1; else of none."""
    found: list[int] = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda _tag, _values: found.append(parser.CurrentColumnNumber + 1)
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError, LookupError):  # an encoding that Python does not know, too
        return []
    return found


def _as_readers_take_it(content: bytes) -> bytes:
    """A text as readers take it: they copy letters that are not in UTF-8, unless it declares so, and any `&`."""
    if _OTHER_ENCODING.match(content):
        return content
    return _NO_REFERENCE.sub(b"&amp;", content.decode("utf-8", "replace").encode())
