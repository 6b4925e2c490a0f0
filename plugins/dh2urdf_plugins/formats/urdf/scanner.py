"""Reads the joints of many plain URDF files at once: the proof of every file of a long run.

The value of an attribute is between two quotes. Cut at its quotes, a text is a list of pieces, markup and values by
turns, and texts whose pieces are the same bytes, but for the numbers in them, are the same elements with other numbers
in them. So the slow reader, `urdf_reader` beside this one, reads each part of a file once (see `urdf_parts`); of all
others the numbers are taken by their places. Files with the same parts are of one *skeleton*, and what many of them
have in common besides is compared as bytes (see `urdf_forms`). Nothing here comes from the emitter, and nothing is
taken for granted of the form that it gives to files: a file of any origin is read, or left to the slow reader.

What is read is what the slow reader would read, well-formedness included, since of every file it is checked that

- before the root there is nothing but an XML declaration of UTF-8 and a comment, both well-formed, and the first
  attribute of the root is its name, which is printable text without entities;
- after that, all bytes are those of parts that the slow reader has read, the names of links and joints included, but
  for the values of the attributes that URDF defines as numbers; in these parts lxml has found the quotes around
  attributes, and nowhere else;
- each of these values has as many numbers as there, with one space between them, and each is a finite number as JSON
  writes it, whether the proof needs it or not.
"""

from __future__ import annotations

import re
from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf_plugins.formats.urdf.forms import Form, Joints, Skeleton, joints_of
from dh2urdf_plugins.formats.urdf.parts import Parts

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.robot import Robot
    from dh2urdf_plugins.formats.urdf.parts import Part

# XML 1.0: prolog (22), XML declaration (23), comment (15), in which no `--` is, start tag (40).
_HEAD = re.compile(
    rb"""(?: <\?xml[ ]version="1\.0" (?:[ ]encoding="(?:UTF|utf)-8")? \?> )?
    [ \t\r\n]*+ (?: <!-- [^-]*+ (?:-[^-]++)*+ --> [ \t\r\n]*+ )?
    <robot[ ]name="( [^"<&\t\r\n]*+ )" """,
    re.VERBOSE,
)
_LINE_ENDS_AND_TABS = b"\t\r\n"

_FILES_AT_ONCE = 64
"""Files whose numbers are read in one call: so many that their texts stay in the processor's cache."""
_MOST_SKELETONS, _MOST_PARTS = 1000, 10_000
"""Of skeletons and of parts so many are remembered from call to call, some kilobytes each."""


class _Found(NamedTuple):
    """Files whose joints differ in numbers only.

    Attributes:
        joints: their joints.
        indices: which files they are.
        name: the robot's name in the first of them.
        table: the numbers of their joints, a row for each.
    """

    joints: Joints
    indices: list[int]
    name: str
    table: Any


def _together(form: Form, files: Sequence[tuple[int, str, bytes]]) -> Iterator[_Found]:
    """The joints of files of one form, given with their indices, names and numbers."""
    good, table = form.rows([text for _, _, text in files])
    if good:
        yield _Found(form.joints, [files[place][0] for place in good], files[good[0]][1], table)


class _Scanner:
    """Reads files, and remembers the skeletons that it has met.

    What it remembers makes it faster and changes nothing: a skeleton is the same, whichever of its files comes first.
    """

    def __init__(self, parts: Parts) -> None:
        self.parts = parts
        self.skeletons: dict[tuple[Part, ...], Skeleton] = {}
        self._by_kinds: dict[tuple[object, ...], Joints] = {}  # of the parts
        self._joints: dict[object, Joints] = {}
        self._last: list[Form] = []  # that of the last file that had one: often the next file has it too
        self._with_form: dict[tuple[int, ...], dict[Skeleton, Form]] = {}  # by the number of shapes of each link

    def scan(self, contents: Iterable[tuple[int, bytes]]) -> Iterator[_Found]:
        """The joints of files, given with their indices, that are plain."""
        import numpy as np

        alone: dict[Joints, list[tuple[int, str, list[float]]]] = {}
        waiting: dict[Form, list[tuple[int, str, bytes]]] = {}
        for index, content in contents:
            head = _HEAD.match(content)
            if head is None or not _is_printable(head[0]):
                continue
            start = head.end()
            for form in self._candidates(content):
                if (numbers := form.numbers(content, start)) is not None:
                    files = waiting.setdefault(form, [])
                    files.append((index, head[1].decode(), numbers))
                    if len(files) == _FILES_AT_ONCE:
                        yield from _together(form, waiting.pop(form))
                    self._last = [form]
                    break
            else:
                if found := self._one(content[start:]):
                    alone.setdefault(found[0], []).append((index, head[1].decode(), found[1]))
        for joints, found_alone in alone.items():
            indices, names, rows = zip(*found_alone, strict=True)
            yield _Found(joints, list(indices), names[0], np.array(rows, dtype=float))
        for form, files in waiting.items():
            yield from _together(form, files)

    def _candidates(self, content: bytes) -> Iterator[Form]:
        """The forms that a file may have."""
        yield from self._last
        if self._with_form:
            yield from self._with_form.get(_shapes(content), {}).values()

    def _one(self, text: bytes) -> tuple[Joints, list[float]] | None:
        """The joints of a file and their numbers, of what is after its name; None where the file is not plain."""
        found = self.parts.of(text)
        if found is None:
            return None
        parts, numbers = found
        skeleton = self.skeletons.get(parts)
        if skeleton is None:
            skeleton = self.skeletons[parts] = Skeleton(parts, self._joints_of(parts))
        if form := skeleton.see(text):
            self._with_form.setdefault(_shapes(text), {})[skeleton] = form
        return skeleton.joints, numbers[: skeleton.count]

    def _joints_of(self, parts: Sequence[Part]) -> Joints:
        """The joints of files of some parts; the same ones for files whose joints differ in numbers only."""
        kinds = tuple([part.kind for part in parts])
        found = self._by_kinds.get(kinds)
        if found is None:
            made = joints_of(parts)
            found = self._by_kinds[kinds] = self._joints.setdefault(made.kind, made)
        return found


def _shapes(text: bytes) -> tuple[int, ...]:
    """How many shapes each link has: files of one skeleton agree in it, and few others do."""
    return tuple([part.count(b"<geometry") for part in text.split(b"<link ")])


def _is_printable(head: bytes) -> bool:
    """Whether a text is UTF-8 without any character that XML cannot hold, or that nobody sees."""
    try:
        return head.translate(None, _LINE_ENDS_AND_TABS).decode().isprintable()
    except UnicodeDecodeError:
        return False


_scanner = _Scanner(Parts())


def scan_columns(contents: Sequence[bytes]) -> list[tuple[list[int], Robot]]:
    """The joints of many URDF files, in groups whose members differ in numbers only.

    A file that is not surely read as `urdf_reader` reads it is in no group, whatever the others are.

    Args:
        contents: the files.

    Returns:
        For each group the places of its members among the files, and a robot with their joints, whose numbers are
        columns as in `dh2urdf.columns`, and the names of their links; its name is the first one's.
    """
    import numpy as np

    global _scanner  # noqa: PLW0603 - the skeletons are remembered from call to call
    if len(_scanner.skeletons) > _MOST_SKELETONS or _scanner.parts.size > _MOST_PARTS:
        _scanner = _Scanner(_scanner.parts if _scanner.parts.size <= _MOST_PARTS else Parts())
    groups: dict[Joints, list[_Found]] = {}
    for found in _scanner.scan(enumerate(contents)):
        groups.setdefault(found.joints, []).append(found)
    read = []
    for joints, parts in groups.items():
        indices = np.array(list(chain.from_iterable([part.indices for part in parts])))
        order = np.argsort(indices)
        name = min(parts, key=lambda part: part.indices[0]).name
        table = np.concatenate([part.table for part in parts])[order]
        read.append((indices[order].tolist(), joints.with_numbers(name, table)))
    return sorted(read, key=lambda group: group[0][0])
