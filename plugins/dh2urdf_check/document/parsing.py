"""The tree of a text as the parsers of C++ read it: TinyXML-2, and urdfdom 3's TinyXML where that reads otherwise.

They know no entities, no encodings and no namespaces, take much that is not well-formed XML, and refuse some of what
is. A file comes from a stranger: nothing is expanded, nothing is fetched, and no depth of nesting is recursed into.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from typing import NamedTuple
from xml.parsers import expat

from dh2urdf.documents import ACCEPTED_XML, ForbiddenXmlError, check_encoding
from dh2urdf_check.document.tree import DEEPEST, Element

_SPACE = re.compile(r"[ \t\r\n\f\v]*")
_NAME = re.compile(r"[A-Za-z_:\x80-\U0010ffff][-.\w:\x80-\U0010ffff]*", re.ASCII)
_ODD_NAME = re.compile(r"[^\s/>=]*")
_ATTRIBUTE = re.compile(r"[ \t\r\n\f\v]*=[ \t\r\n\f\v]*(?:\"([^\"]*)\"|'([^']*)'|([^\s/>\"']+))")
_REFERENCE = re.compile(r"&(?:(quot|amp|apos|lt|gt)|#(?:x([0-9A-Fa-f]{1,6})|([0-9]{1,7})));")
_BAD_REFERENCE = re.compile(r"&#(?!x[0-9A-Fa-f]+;|[0-9]+;)")
_ENTITIES = {"quot": '"', "amp": "&", "apos": "'", "lt": "<", "gt": ">"}
_MARKUP = b"\"'<>"
_BOM = "\ufeff"
_HIGHEST = 0x10FFFF
_SURROGATES = range(0xD800, 0xE000)
_LEADS = ((0xF0, 4), (0xE0, 3), (0xC2, 2), (0, 1))
"""The first byte of a letter in UTF-8, from which on the letter has so many."""
_ENCODING = re.compile(rb"<\?xml[^>]*encoding\s*=\s*[\"']([^\"']+)[\"']", re.IGNORECASE)


class NotXmlError(Exception):
    """No reader takes the text.

    Attributes:
        reason: what is wrong.
        line: where, from 1.
        column: where, from 1.
    """

    def __init__(self, reason: str, line: int, column: int) -> None:
        self.reason, self.line, self.column = reason, line, column
        super().__init__(reason, line, column)


class Oddity(NamedTuple):
    """Something in a text that not every parser takes.

    Attributes:
        rule: the rule about it.
        line: where, from 1.
        column: where, from 1.
        message: what is there.
    """

    rule: str
    line: int
    column: int
    message: str


class Parsed(NamedTuple):
    """A text as a tree.

    Attributes:
        root: the element `robot`, or the first one where there is none.
        oddities: what not every parser takes.
    """

    root: Element
    oddities: list[Oddity]


def parse(content: bytes) -> Parsed:
    """The tree of a text.

    Raises:
        NotXmlError: no reader takes it.
    """
    if content[:2] in {b"\xff\xfe", b"\xfe\xff"} or b"\0" in content[:4]:
        raise NotXmlError("it is encoded in UTF-16 or UTF-32, and readers take UTF-8", 1, 1)
    reading = _Reading(content)
    reading.read()
    elements = reading.top.children
    if not elements:
        raise NotXmlError("there is no element in it", 1, 1)
    root = next((element for element in elements if element.tag == "robot"), elements[0])
    if root is not elements[0]:
        reading.odd(
            "robot-not-first", elements[0].line, elements[0].column, f"before the robot there is {elements[0].tag}"
        )
    if not reading.oddities:
        reading.oddities.extend(_not_strict(content))
    return Parsed(root, reading.oddities)


def _not_strict(content: bytes) -> list[Oddity]:
    """Why a text is not well-formed XML: what ROS's programs in Python report about it."""
    try:
        expat.ParserCreate().Parse(content, True)
    except expat.ExpatError as error:
        return [Oddity("not-strict-xml", error.lineno, error.offset + 1, expat.ErrorString(error.code))]
    except (ValueError, LookupError) as error:  # an encoding that Python does not know, or that is no 8-bit one
        return [Oddity("not-strict-xml", 1, 1, str(error))]
    return []


class _Reading:
    """Reads a text from its beginning to its end."""

    def __init__(self, content: bytes) -> None:
        self.top = Element("", {}, 0, 0)
        self.oddities: list[Oddity] = []
        self._text = _decoded(content).removeprefix(_BOM)
        self._breaks = [match.start() for match in re.finditer("\n", self._text)]
        self._at = 0
        self._open = [self.top]
        self._too_deep: list[str] = []
        self._has_begun = False

    def read(self) -> None:
        """Read all of it."""
        text = self._text
        while True:
            start = text.find("<", self._at)
            between = text[self._at : start if start >= 0 else len(text)]
            end = between.find("\0")
            if end >= 0:
                self._nul(self._at + end)
                return
            if len(self._open) == 1 and between.strip():
                first = self._at + len(between) - len(between.lstrip())
                if not self.top.children:
                    raise self._error("there is text before the first element", first)
                self._odd_at("loose-xml", first, "there is text behind the last element")
                return
            self._begin_with(between)
            if start < 0:
                break
            self._at = start
            if not self._markup():
                return
        if len(self._open) > 1 or self._too_deep:
            last = self._open[-1]
            raise NotXmlError(f"the element {last.tag} is not closed", last.line, last.column)

    def _begin_with(self, text: str) -> None:
        """Take a text for that of the open element, if nothing is before it."""
        if not self._open[-1].text and not self._open[-1].children:
            self._open[-1].text = text.strip()

    def odd(self, rule: str, line: int, column: int, message: str) -> None:
        """Note what not every parser takes, once of a kind."""
        if not any(oddity.rule == rule for oddity in self.oddities):
            self.oddities.append(Oddity(rule, line, column, message))

    def _odd_at(self, rule: str, at: int, message: str) -> None:
        self.odd(rule, *self._place(at), message)

    def _place(self, at: int) -> tuple[int, int]:
        line = bisect_right(self._breaks, at - 1)
        return line + 1, at - (self._breaks[line - 1] if line else -1)

    def _error(self, reason: str, at: int) -> NotXmlError:
        return NotXmlError(reason, *self._place(at))

    def _nul(self, at: int) -> None:
        """TinyXML-2 ends at a NUL, which may be behind everything only."""
        if self._text[at:].strip("\0 \t\r\n") or len(self._open) > 1:
            self._odd_at("nul-byte", at, "there is a NUL byte in the text")
            self._text = self._text[:at] + self._text[at:].replace("\0", " ")
            self.read()

    def _markup(self) -> bool:
        """Read what begins with `<`; False where nothing behind it counts."""
        text, at = self._text, self._at
        if text.startswith("<!--", at):
            if (end := text.find("-->", at + 4)) < 0:
                return self._unclosed("comment")
            self._at = end + 3
        elif text.startswith("<![CDATA[", at):
            if (end := text.find("]]>", at)) < 0:
                raise self._error("a CDATA section is not closed", at)
            self._begin_with(text[at + len("<![CDATA[") : end])
            self._at = end + 3
        elif text.startswith("<!", at):
            return self._document_type()
        elif text.startswith("<?", at):
            if (end := text.find("?>", at)) < 0:
                raise self._error("a processing instruction is not closed", at)
            if self._has_begun:
                self._odd_at("loose-xml", at, f"{text[at : at + 5]} is not at the beginning")
            self._at = end + 2
            return True
        elif text.startswith("</", at):
            return self._end()
        else:
            self._start()
        self._has_begun = True
        return True

    def _unclosed(self, what: str) -> bool:
        if not self.top.children or len(self._open) > 1:
            raise self._error(f"a {what} is not closed", self._at)
        self._odd_at("loose-xml", self._at, f"a {what} is not closed")
        return False

    def _document_type(self) -> bool:
        at, text = self._at, self._text
        end, bracket = text.find(">", at), text.find("[", at)
        if end < 0:
            return self._unclosed("document type")
        if 0 <= bracket < end:
            self._odd_at("document-type", at, "the document type has declarations of its own")
            closed = re.compile(r"\]\s*>").search(text, bracket)
            end = closed.end() - 1 if closed else end
        self._has_begun, self._at = True, end + 1
        return True

    def _start(self) -> None:
        begin, text = self._at, self._text
        space = _SPACE.match(text, begin + 1)
        name = _NAME.match(text, space.end()) if space else None
        if name is None:
            self._odd_name(begin)
            return
        line, column = self._place(begin)
        element = Element(name[0], {}, line, column)
        self._at = name.end()
        while True:
            space = _SPACE.match(text, self._at)
            self._at = space.end() if space else self._at
            if text.startswith(">", self._at):
                self._at += 1
                self._push(element)
                return
            if text.startswith("/>", self._at):
                self._at += 2
                self._push(element)
                self._pop()
                return
            self._attribute(element, begin)

    def _odd_name(self, begin: int) -> None:
        """TinyXML passes over what is no name, up to the next `>`; TinyXML-2 refuses the text."""
        name = _ODD_NAME.match(self._text, begin + 1)
        end = self._text.find(">", begin)
        if end < 0 or (name is None) or self._text[begin + 1 : begin + 2].isspace():
            raise self._error("`<` is no beginning of an element", begin)
        self._odd_at("loose-xml", begin, f"{self._text[begin : end + 1][:40]} is no element")
        self._at = end + 1

    def _attribute(self, element: Element, begin: int) -> None:
        name = _NAME.match(self._text, self._at)
        value = _ATTRIBUTE.match(self._text, name.end()) if name else None
        if name is None or value is None:
            raise self._error(f"the element {element.tag} is not closed, or has an attribute without a value", begin)
        if name[0] in element.attributes:
            raise self._error(f"the element {element.tag} has the attribute {name[0]} twice", begin)
        if value[3] is not None:
            self._odd_at("loose-xml", self._at, f"the value of {name[0]} has no quotes")
        raw = next(group for group in value.groups() if group is not None)
        if "\0" in raw:
            self._odd_at("nul-byte", name.start(), "there is a NUL byte in the text")
        if "&#" in raw and _BAD_REFERENCE.search(raw):
            self._odd_at(
                "bad-character-reference", name.start(), f"there is no such character in the value of {name[0]}"
            )
        if any("\udc80" <= letter <= "\udcff" for letter in raw):
            self._not_utf8(raw, name)
            raw = raw.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
        element.attributes[name[0]] = _REFERENCE.sub(_letter, raw) if "&" in raw else raw
        self._at = value.end()

    def _not_utf8(self, raw: str, name: re.Match[str]) -> None:
        """TinyXML takes as many bytes for one letter as the first of them asks for, a quote among them."""
        content = (raw + '"').encode("utf-8", "surrogateescape")
        at, swallows = 0, False
        while at < len(content) - 1:
            byte = content[at]
            length = next(count for first, count in _LEADS if byte >= first)
            swallows |= any(other in _MARKUP for other in content[at + 1 : at + length])
            at += length
        if swallows:
            self._odd_at("wrong-encoding", name.start(), f"the value of {name[0]} is not UTF-8")

    def _push(self, element: Element) -> None:
        if self._too_deep or len(self._open) > DEEPEST:
            self._too_deep.append(element.tag)
        else:
            self._open[-1].children.append(element)
            self._open.append(element)

    def _pop(self) -> None:
        if self._too_deep:
            self._too_deep.pop()
        else:
            self._open.pop()

    def _end(self) -> bool:
        at = self._at
        match = re.compile(r"</([^\s>]*)\s*>").match(self._text, at)
        if len(self._open) == 1:
            return False  # Readers end here.
        tag = self._too_deep[-1] if self._too_deep else self._open[-1].tag
        if match is None or match[1] != tag:
            found = self._text[at : at + 40].partition(">")[0]
            raise self._error(f"{found}> closes no element: the last one open is {tag}", at)
        self._pop()
        self._at = match.end()
        return True


def _decoded(content: bytes) -> str:
    """A text in Latin-1, where it declares that, or in UTF-8; what is none is kept as surrogates.

    Raises:
        NotXmlError: it declares an encoding that is not read.
    """
    declared = _ENCODING.match(content.lstrip())
    encoding = declared[1].decode("ascii", "replace").lower() if declared else "utf-8"
    try:
        check_encoding(encoding)
    except ForbiddenXmlError as error:
        raise NotXmlError(f"{error.msg}; accepted: {ACCEPTED_XML}", 1, 1) from None
    if not encoding.startswith(("utf", "us-", "ascii")):
        return content.decode("latin-1")
    return content.decode("utf-8", "surrogateescape")


def _letter(match: re.Match[str]) -> str:
    if match[1]:
        return _ENTITIES[match[1]]
    code = int(match[2], 16) if match[2] else int(match[3])
    return chr(code) if 0 < code <= _HIGHEST and code not in _SURROGATES else match[0]
