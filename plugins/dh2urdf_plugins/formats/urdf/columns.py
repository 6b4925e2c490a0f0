"""URDF of many robots at once: the file of one of them as a template, filled in.

There is no second emitter: the template is the tree that `urdf_tree` makes of the robot, with a slot wherever a number
is a column. Cut at its slots, it is a row of texts, most of them the same in every file.
"""

from __future__ import annotations

import re
from itertools import repeat
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import EmitterError
from dh2urdf.quantities import format_number, format_rows
from dh2urdf.robot_check import LONGEST_NAME
from dh2urdf.rotations import is_column
from dh2urdf.source import Messages
from dh2urdf.stages import EmittedFile
from dh2urdf_plugins.formats.urdf.profiles import PROFILES
from dh2urdf_plugins.formats.urdf.writer import LONGEST_COMMENT, Notation, check_lines, serialise, urdf_tree

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from dh2urdf.columns import Mask, RobotColumns
    from dh2urdf_plugins.formats.urdf import UrdfOptions

say = Messages(__file__)


_OPEN, _CLOSE = "\ue000", "\ue001"  # for private use: nothing means them, and XML takes them
_SLOT = re.compile(f"{_OPEN}([a-z0-9]+){_CLOSE}")
_NAME, _COMMENT = "name", "comment"
_COLLISION = re.compile(r"\n {4}<collision>.*?</collision>", re.DOTALL)
_ESCAPED = re.compile('[&<>"]')


class ColumnNotation(Notation):
    """Writes slots for columns; the first column belongs into slot 0."""

    def __init__(self) -> None:
        super().__init__()
        self.columns: list[Any] = []

    def text(self, text: str) -> str:
        """A text that is the same in every file, and could not be taken for a slot."""
        if _OPEN in text:
            raise EmitterError(say("name-with-slot", found=text))
        return super().text(text)

    def numbers(self, numbers: Iterable[float]) -> str:
        """Numbers, and slots for columns of them."""
        return " ".join([self._column(number) if is_column(number) else format_number(number) for number in numbers])

    def _column(self, column: Any) -> str:  # noqa: ANN401 - an array
        self.columns.append(column)
        return _slot(str(len(self.columns) - 1))


def emit_columns(
    robots: RobotColumns, stems: Sequence[str], options: UrdfOptions
) -> list[tuple[EmittedFile, ...]] | None:
    """The URDF of each of many robots, as ``<stem>.urdf``.

    A robot that is not sure, or whose name or comment has to be escaped, gets no file. None where one file is not
    another with other numbers, or where there can be none: `emit` makes them one by one, or says why it cannot.
    """
    if PROFILES[options.profile] != PROFILES["portable"] or options.version != "1.0":
        return None
    told = zip(robots.sure.tolist(), robots.names, robots.comments, strict=True)
    written = [
        index
        for index, (sure, name, comment) in enumerate(told)
        if sure
        # A name that is in an attribute as it is, on a line that no reader cuts, and a comment that is as it is.
        and (len(name) <= LONGEST_NAME and name.isprintable() and not _ESCAPED.search(name))
        and (0 < len(comment) <= LONGEST_COMMENT and comment.isprintable() and "--" not in comment)
    ]
    try:
        contents = dict(zip(written, _contents(robots, written), strict=True)) if written else {}
    except EmitterError:
        return None
    return [
        (EmittedFile(name=f"{stem}.urdf", content=contents[index]),) if index in contents else ()
        for index, stem in enumerate(stems)
    ]


def _contents(robots: RobotColumns, written: list[int]) -> list[bytes]:
    """The files of some of many robots."""
    notation = ColumnNotation()
    content = serialise(urdf_tree(robots.robot, _slot(_NAME), notation), _COMMENT)
    check_lines(content)
    template = content.decode("utf-8").replace(_COMMENT, _slot(_COMMENT), 1)
    is_whole = len(written) == len(robots)
    entries, rows = format_rows([column if is_whole else column[written] for column in notation.columns])
    # The texts of a file are its name, its comment and its numbers, in that order.
    slots = {str(number): entry if isinstance(entry, bytes) else entry + 2 for number, entry in enumerate(entries)}
    slots |= {_NAME: 0, _COMMENT: 1}
    parts: list[list[Any]] = []
    masks: list[list[bool]] = []
    position = 0
    for (start, end), present in _optional(robots, template):
        parts += (_part(template[position:start], slots), _part(template[start:end], slots))
        masks.append(present[written].tolist())
        position = end
    last = _part(template[position:], slots)
    told = [[robots.names[index].encode(), robots.comments[index].encode()] for index in written]
    forms: dict[tuple[bool, ...], tuple[list[bytes], Callable[[list[bytes]], tuple[bytes, ...]]]] = {}
    contents = []
    for texts, numbers, *present in zip(told, rows if entries else repeat([]), *masks, strict=False):
        shapes = tuple(present)
        if shapes not in forms:
            own = [part for number, part in enumerate(parts) if number % 2 == 0 or shapes[number // 2]]
            joined: list[Any] = [b""]  # the pieces of files, every second one to be filled in
            for first, *others in [*own, last]:
                joined[-1] += first
                joined += others
            forms[shapes] = joined, itemgetter(*joined[1::2])  # two at least: the name and the comment
        pieces, pick = forms[shapes]
        pieces[1::2] = pick(texts + numbers)
        contents.append(b"".join(pieces))
    return contents


def _optional(robots: RobotColumns, template: str) -> Iterator[tuple[tuple[int, int], Mask]]:
    """Where in a template the shapes are that not all robots have, and which have them."""
    spans = (match.span() for match in _COLLISION.finditer(template))
    for place, link in enumerate(robots.robot.links):
        masks = [robots.present.get((place, number)) for number, _ in enumerate(link.collisions)]
        if masks and not link.inertial and not link.visuals and all(mask is not None for mask in masks):
            # An element with nothing else would be written in another form.
            raise EmitterError(say("links-empty-in-some"))
        for mask in masks:
            span = next(spans)
            if mask is not None:
                yield span, mask


def _part(text: str, slots: Mapping[str, bytes | int]) -> list[Any]:
    """A piece of a template: its texts, and between two of them where the text is among those of a file."""
    pieces: list[Any] = [b""]
    for index, piece in enumerate(_SLOT.split(text)):
        entry = slots[piece] if index % 2 else piece.encode()
        if isinstance(entry, int):
            pieces += (entry, b"")
        else:
            pieces[-1] += entry
    return pieces


def _slot(key: str) -> str:
    """What is in a template where files differ."""
    return f"{_OPEN}{key}{_CLOSE}"
