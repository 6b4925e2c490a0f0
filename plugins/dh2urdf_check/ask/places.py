"""Where the links and joints of a file are, and which of them the words of a program are about."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.source import Mark
from dh2urdf_check.document import NotXmlError, parse

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence
    from pathlib import Path

    from lxml import etree

JOINT, LINKS = "joint", ("link", "body")
PARTS = (JOINT, *LINKS)
_OWNERS = frozenset({*PARTS, "model", "robot"})
"""The elements whose names programs tell."""
_LINE = re.compile(r"(?:\bline[ =:]+|\.(?:urdf|sdf|xml|mjcf)[:>]L?|:L)(\d+)(?! in \S*/)")
_NAMED = re.compile(r"['\"\[(<]([^'\"\[\]()<>]+)['\"\])>]|(?:\b(?:link|joint|body|name|frame|element)|:) +(\S+)")


class Places:
    """The elements of a file, as far as it is XML, in the order of the text, and the line in which each begins.

    `marks` are where the elements are in their own files, where the text is what a xacro expands to.
    """

    def __init__(self, content: bytes, file: Path, marks: Sequence[Mark | None] = ()) -> None:
        self.whole = Mark(file=str(file))
        try:
            found = parse(content).places
        except NotXmlError:
            found = {}
        self.elements = {element: line for element, (line, _) in found.items()}
        own = [Mark(file=str(file), line=line, column=column) for line, column in found.values()]
        placed = [given or self.whole for given in marks] if len(marks) == len(found) else own
        self._marks = dict(zip(found, placed, strict=True))

    def of_name(self, name: str, kinds: Collection[str]) -> tuple[str, Mark]:
        """What has a name, of some kinds, and where it is; the file where there is none."""
        for element, mark in self._marks.items():
            if element.tag in kinds and element.tag in _OWNERS and element.get("name", "") == name:
                return str(element.tag), mark
        return "link", self.whole

    def of_words(self, words: str) -> tuple[str, str, Mark]:
        """What a message is about: the tag and the name of a link or joint, and where; the file, where it tells none.

        A name in it decides, or else a line.
        """
        parts = ((element, mark) for element, mark in self._marks.items() if element.tag in PARTS)
        names = {element.get("name", ""): (str(element.tag), element.get("name", ""), mark) for element, mark in parts}
        said = [(found[1] or found[2]).strip(".,;:'\"[]()<>") for found in _NAMED.finditer(words)]
        if name := next((each for each in reversed(said) if each in names), ""):
            return names[name]
        if numbers := _LINE.findall(words):
            before = [element for element, line in self.elements.items() if line <= int(numbers[-1])]
            if before:
                kind, name = owner_of(before[-1])
                mark = self._marks[before[-1]]
                return (kind, name, mark) if kind in PARTS else ("", "", mark)
        return "", "", self.whole

    def at(self, mark: Mark | None) -> Iterator[etree._Element]:
        """The elements that are at a place; a macro puts several there."""
        for element, found in self._marks.items():
            if mark and (found.file, found.line) == (mark.file, mark.line) and mark.column in {None, found.column}:
                yield element


def owner_of(element: etree._Element) -> tuple[str, str]:
    """The tag and the name of the link or joint, or else of the model, that an element is in, or that it is."""
    at: etree._Element | None = element
    while at is not None and at.tag not in _OWNERS:
        at = at.getparent()
    return ("", "") if at is None else (str(at.tag), at.get("name", ""))
