"""Where the links and joints of a file are, and which of them the words of a program are about."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple
from xml.parsers import expat

from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence
    from pathlib import Path

JOINT, LINKS = "joint", ("link", "body")
_OWNERS = frozenset({JOINT, *LINKS, "model", "robot"})
"""The elements whose names programs tell."""
_LINE = re.compile(r"(?:\bline[ =:]+|\.(?:urdf|sdf|xml|mjcf)[:>]L?|:L)(\d+)(?! in \S*/)")
_NAMED = re.compile(r"['\"\[(<]([^'\"\[\]()<>]+)['\"\])>]|(?:\b(?:link|joint|body|name|frame|element)|:) +(\S+)")


class At(NamedTuple):
    """An element.

    Attributes:
        line: where it begins, from 1 on.
        column: as before.
        tag: its tag.
        name: its name, or that of the link or joint that it is in.
        owner: the tag of what has that name.
        above: the tags of the elements that it is in, from the outermost on.
    """

    line: int
    column: int
    tag: str
    name: str
    owner: str
    above: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Places:
    """The elements of a file, in the order of the text.

    Attributes:
        elements: all of them.
        marks: where each is in its file; of what a xacro expands to, in the file where it is written.
        whole: the file.
    """

    elements: tuple[At, ...]
    marks: tuple[Mark, ...]
    whole: Mark

    def of_name(self, name: str, kinds: Collection[str]) -> tuple[str, Mark]:
        """What has a name, of some kinds, and where it is; the file where there is none."""
        owning = ((at.tag, mark) for at, mark in self._owning() if at.name == name and at.tag in kinds)
        return next(owning, ("link", self.whole))

    def of_words(self, words: str) -> tuple[str, str, Mark]:
        """What a message is about: the tag and the name of a link or joint, and where; the file, where it tells none.

        A name in it decides, or else a line.
        """
        names = {at.name: (at.tag, at.name, mark) for at, mark in self._owning() if at.tag in {JOINT, *LINKS}}
        said = [(found[1] or found[2]).strip(".,;:'\"[]()<>") for found in _NAMED.finditer(words)]
        if name := next((each for each in reversed(said) if each in names), ""):
            return names[name]
        if numbers := _LINE.findall(words):
            before = [number for number, at in enumerate(self.elements) if at.line <= int(numbers[-1])]
            if before:
                at, mark = self.elements[before[-1]], self.marks[before[-1]]
                is_part = at.owner in {JOINT, *LINKS}
                return (at.owner, at.name, mark) if is_part else ("", "", mark)
        return "", "", self.whole

    def at(self, mark: Mark | None) -> Iterator[At]:
        """The elements that are at a place; a macro puts several there."""
        for at, found in zip(self.elements, self.marks, strict=True):
            if mark and (found.file, found.line) == (mark.file, mark.line) and mark.column in {None, found.column}:
                yield at

    def _owning(self) -> Iterator[tuple[At, Mark]]:
        return ((at, mark) for at, mark in zip(self.elements, self.marks, strict=True) if at.tag == at.owner)


def places_in(content: bytes, file: Path, marks: Sequence[Mark | None] = ()) -> Places:
    """The elements of a text, as far as it is XML.

    Args:
        content: the text.
        file: the file, as it was named.
        marks: where the elements are in their own files, where the text is what a xacro expands to.
    """
    found, above = list[At](), list[tuple[str, str, str]]()  # of the elements that are open: tag, name, owner

    def started(tag: str, attributes: dict[str, str]) -> None:
        _, name, owner = above[-1] if above else ("", "", "")
        if tag in _OWNERS:
            name, owner = attributes.get("name", ""), tag
        tags = tuple(each[0] for each in above)
        found.append(At(parser.CurrentLineNumber, parser.CurrentColumnNumber + 1, tag, name, owner, tags))
        above.append((tag, name, owner))

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = started, lambda _tag: above.pop()
    whole = Mark(file=str(file))
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError, LookupError):
        return Places((), (), whole)
    own = [Mark(file=str(file), line=at.line, column=at.column) for at in found]
    placed = [given or whole for given in marks] if len(marks) == len(found) else own
    return Places(tuple(found), tuple(placed), whole)
