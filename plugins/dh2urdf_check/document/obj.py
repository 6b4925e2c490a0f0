"""What an OBJ holds, as the readers take it that look into it.

The lines are looked at in blocks, by arrays of the words in them; those that are not plain numbers, one by one.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.source import shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

_VERTEX = re.compile(rb"^[ \t]*v[ \t]+(?:([^\s#]\S*)(?:[ \t]+(\S+)(?:[ \t]+(\S+))?)?)?", re.MULTILINE)
_NUMBER = re.compile(
    rb"[-+]?(?:0x(?:[0-9a-f]+\.?[0-9a-f]*|\.[0-9a-f]+)(?:p[-+]?[0-9]+)?"
    rb"|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[-+]?[0-9]+)?|inf|nan)",
    re.IGNORECASE,
)
_BEGINS = rb"(?:[-+]?[0-9]|[-+]\.[0-9]|[-+]?(?:nan|inf))"
"""The beginnings of texts that assimp counts as numbers."""
_COUNTED = re.compile(_BEGINS, re.IGNORECASE)
_ODD_LINE = re.compile(
    rb"^(?:vn[ \t](?![ \t]*(?:(?:\.|%b)\S*[ \t]+){2}(?:\.|%b))|vt[ \t](?![ \t]*%b\S*[ \t]+%b)"
    rb"|[flp][ \t](?=[^\n#]*[^-+0-9/ \t\n#\\])|v[ \t](?=[^\n#]*[0-9.]e[-+]?[ \t\n]))[^\n]*" % (4 * (_BEGINS,)),
    re.MULTILINE | re.IGNORECASE,
)
"""A line with something else than numbers, for which assimp refuses the file."""
_COMMENTS = {"drake": re.compile(rb"(?<=[ \t])#[^\n]*"), "pinocchio": re.compile(rb"#[^\n]*")}
"""The comments behind something else that a reader knows; to others, their words are corners of faces."""
_IN_FACES = b"0123456789/-+ \t\nflp"
_VERTEX_LINE = re.compile(rb"^[ \t]*v[ \t].*", re.MULTILINE)
_BLOCK = 2**18
"""How much is looked at together [B]."""
_DIGITS = 18
"""Digits of a number that 8 bytes hold."""
_COMPONENTS = (3, 4, 6)
"""Numbers of a vertex that assimp takes: with a weight, or with a colour."""
_WEIGHTED = 4
_SMALLEST_WEIGHT = 7e-46
"""Weight that assimp takes for 0: it has single precision."""
KNOW_COMMENTS = tuple(_COMMENTS)
"""The readers that know comments behind faces."""


class Obj(NamedTuple):
    """What an OBJ holds.

    Attributes:
        vertices: of shape (n, 3); 0 for what is missing or begins with no number.
        corners: the vertices of the faces with three corners or more, counted from 1, one face after the other.
        counts: how many corners each of these faces has.
        stray: a number in a face that is none of a vertex; None where there is no such one.
        stray_in_line: the same of a line or point: 0, or too far back.
        largest: the largest number in a face, line or point.
        has_edges: whether there are lines.
        lacks_normals: whether it has normals, and a face with a corner that has none of them.
        has_plain_face: whether a face begins in the first column.
        odd: the lines that are not plain numbers.
    """

    vertices: NDArray[Any]
    corners: NDArray[Any]
    counts: NDArray[Any]
    stray: int | None
    stray_in_line: int | None
    largest: int
    has_edges: bool
    lacks_normals: bool
    has_plain_face: bool
    odd: bytes

    @property
    def is_sound(self) -> bool:
        """Whether every number of a vertex is one of a vertex."""
        return self.stray is None and self.stray_in_line is None


class _Numbers(NamedTuple):
    """The numbers of some lines, how many each line has, and how many vertices there are before each."""

    numbers: NDArray[Any]
    counts: NDArray[Any]
    before: NDArray[Any]


def read_obj(lines: bytes) -> Obj:
    """The vertices and faces of an OBJ whose lines end with a line feed."""
    import numpy as np

    blocks, above = [], 0
    for start, end in _ends_of_blocks(lines):
        blocks.append(_Block(lines[start:end], above))
        above += len(blocks[-1].vertices)
    faces, edges = (
        _Numbers(*map(np.concatenate, zip(*columns, strict=True)))
        for columns in ([block.faces for block in blocks], [block.edges for block in blocks])
    )
    normals = sum(block.normals for block in blocks)
    is_face = faces.counts >= 3  # noqa: PLR2004 - else it is a point or a line
    corners = faces.numbers[np.repeat(is_face, faces.counts)]
    beyond = corners[corners > above]
    stray = _stray(faces)
    return Obj(
        vertices=np.concatenate([block.vertices for block in blocks]),
        corners=corners,
        counts=faces.counts[is_face],
        stray=int(beyond[0]) if stray is None and len(beyond) else stray,
        stray_in_line=_stray(edges),
        largest=max(int(each.numbers.max(initial=0)) for each in (faces, edges)),
        has_edges=any(block.has_edges for block in blocks),
        lacks_normals=normals > 0
        and not all(low > 0 and high <= normals for low, high in (b.of_normals for b in blocks)),
        has_plain_face=any(block.has_plain_face for block in blocks),
        odd=b"".join(block.odd for block in blocks),
    )


def read_obj_as(reader: str, lines: bytes) -> Obj:
    """The same, as a reader takes it that knows comments behind faces, and the mark before a text in UTF-8."""
    return read_obj(_COMMENTS[reader].sub(b"", lines.removeprefix(b"\xef\xbb\xbf")))


def _ends_of_blocks(lines: bytes) -> Iterator[tuple[int, int]]:
    """The beginnings and ends of blocks of whole lines, one of them at least."""
    start = 0
    while start < len(lines) or not start:
        end = lines.find(b"\n", start + _BLOCK) + 1 or max(len(lines), 1)
        yield start, end
        start = end


def _stray(of: _Numbers) -> int | None:
    """A number that is 0, or goes back beyond the first vertex."""
    import numpy as np

    if (of.numbers > 0).all():
        return None
    odd = of.numbers[(of.numbers == 0) | (-of.numbers > np.repeat(of.before, of.counts))]
    return None if not len(odd) else 0 if (odd == 0).any() else int(odd[0])


class _Block:
    """A block of whole lines, with as many vertices above it.

    Attributes:
        vertices: its vertices, of shape (n, 3).
        faces: the corners of its faces, of which some may be points or lines.
        edges: those of its lines and points.
        has_edges: whether there are lines.
        has_plain_face: whether a face begins in the first column.
        normals: how many normals there are.
        of_normals: the least and the greatest number of a normal that a corner has; 0 where one has none.
        odd: the lines that are not plain numbers.
    """

    def __init__(self, lines: bytes, above: int) -> None:
        import numpy as np

        self._text = text = np.frombuffer(b"\n%b\n\n" % lines, np.uint8)
        blank = (text == ord(" ")) | ((text >= ord("\t")) & (text <= ord("\r")))
        self._ends = np.flatnonzero(text == ord("\n"))
        self._words = np.flatnonzero(blank[:-1] & ~blank[1:]) + 1
        line = np.searchsorted(self._ends, self._words)
        firsts = np.flatnonzero(np.diff(line, prepend=-1))
        self._line, self._counts = line[firsts], np.diff(firsts, append=len(line)) - 1
        at = self._words[firsts]
        is_one, is_two = ((end == ord(" ")) | (end == ord("\t")) for end in (text[at + 1], text[at + 2]))
        self._keys = np.where(is_one, text[at], np.where(is_two, text[at] * np.uint16(256) + text[at + 1], 0))
        is_vertex, is_face = self._has(b"v"), self._has(b"f")
        before = above + np.cumsum(is_vertex)
        self.faces = self._numbers_of(is_face, before)
        is_edge = self._has(b"l") | self._has(b"p")
        self.edges = self._numbers_of(is_edge, before)
        self.has_edges = bool(self._has(b"l").any())
        self.normals = int(self._has(b"vn").sum())
        self.of_normals = self._normals_of(is_face & (self._counts > 2))  # noqa: PLR2004 - corners
        self.vertices, is_plain = self._vertices(is_vertex)
        is_first = text[at - 1] == ord("\n")
        self.has_plain_face = bool((is_face & is_first).any())
        begin = text[self._words]
        begin = text[self._words + ((begin == ord("-")) | (begin == ord("+")))]
        is_number = (begin - ord("0")) < 10  # noqa: PLR2004 - of what is no digit, 10 or more
        strange = np.add.reduceat(~is_number, firsts, dtype=int) - 1 if len(firsts) else self._counts
        self.odd = self._bytes_of(
            (is_vertex & ((strange > 0) | ~is_first | (not is_plain)))
            | (self._has(b"vn") & ((strange > 0) | (self._counts < 3)))  # noqa: PLR2004 - coordinates
            | (self._has(b"vt") & ((strange > 0) | (self._counts < 2)))  # noqa: PLR2004 - coordinates
            | ((is_face | is_edge) & bool(self._bytes_of(is_face | is_edge).translate(None, _IN_FACES)))
        )

    def _has(self, key: bytes) -> NDArray[Any]:
        """Which of the lines begin with a word."""
        found: NDArray[Any] = self._keys == int.from_bytes(key, "big")
        return found

    def _bytes_of(self, these: NDArray[Any]) -> bytes:
        """The text of some lines."""
        import numpy as np

        chosen = np.zeros(len(self._ends) - 1, bool)
        chosen[self._line[these] - 1] = True
        return bytes(self._text[1 : self._ends[-1] + 1][np.repeat(chosen, np.diff(self._ends))].tobytes())

    def _words_of(self, these: NDArray[Any]) -> NDArray[Any]:
        """Which of the words are in some lines, and not the first there."""
        import numpy as np

        found = np.repeat(these, self._counts + 1)
        found[np.cumsum(self._counts + 1) - self._counts - 1] = False
        return found

    def _numbers_of(self, these: NDArray[Any], before: NDArray[Any]) -> _Numbers:
        words = self._words[self._words_of(these)]
        return _Numbers(self._numbers_at(words), self._counts[these], before[these])

    def _numbers_at(self, at: NDArray[Any]) -> NDArray[Any]:
        """The numbers at some places, as the function ``atoi`` of C reads them: 0 where there is none."""
        import numpy as np

        text = self._text
        is_negative = text[at] == ord("-")
        at = at + (is_negative | (text[at] == ord("+")))
        numbers = np.zeros(len(at), np.int64)
        for _ in range(_DIGITS):
            digits = text[at] - ord("0")  # of what is no digit, 10 or more: the difference has no sign
            going = digits < 10  # noqa: PLR2004 - a decimal digit
            if not going.any():
                break
            numbers = np.where(going, 10 * numbers + digits, numbers)
            at = at + going
        return np.where(is_negative, -numbers, numbers)

    def _normals_of(self, faces: NDArray[Any]) -> tuple[int, int]:
        """The least and the greatest number of a normal: a corner is ``vertex/texture/normal``."""
        import numpy as np

        if not faces.any():
            return 1, 1
        slashes = np.flatnonzero(self._text == ord("/"))
        word = np.searchsorted(self._words, slashes, "right") - 1
        last = np.zeros(len(self._words), np.int64)
        last[word] = slashes
        corners = self._words_of(faces)
        if (np.bincount(word, minlength=len(self._words))[corners] != 2).any():  # noqa: PLR2004 - slashes
            return 0, 0
        numbers = np.abs(self._numbers_at(last[corners] + 1))
        return int(numbers.min()), int(numbers.max())

    def _vertices(self, these: NDArray[Any]) -> tuple[NDArray[Any], bool]:
        """The vertices, and whether all are three plain numbers, with a colour or without."""
        import numpy as np

        lines, counts = self._bytes_of(these), self._counts[these]
        if not len(counts):
            return np.empty((0, 3)), True
        if (count := int(counts[0])) in {3, _WEIGHTED, 6} and (counts == count).all():
            try:
                columns = range(1, count + 1)
                rows = np.loadtxt(lines.decode("ascii").split("\n"), comments=None, usecols=columns, ndmin=2)
                return rows[:, :3], count != _WEIGHTED
            except ValueError:  # of a text that is no number
                pass
        return np.array([[_begin(text) for text in match.groups(b"")] for match in _VERTEX.finditer(lines)]), False


def _begin(text: bytes) -> float:
    if (match := _NUMBER.match(text)) is None:
        return 0.0
    return float.fromhex(match[0].decode()) if b"x" in match[0].lower() else float(match[0])


def triangles_of(obj: Obj) -> NDArray[Any] | None:
    """The triangles of the faces, by vertices counted from 0.

    None where one is counted from the end, or where there are neither faces nor lines: MuJoCo makes a hull then.
    """
    import numpy as np

    corners, counts = obj.corners, obj.counts
    if (corners < 0).any() or not (len(counts) or obj.has_edges):
        return None
    first = np.repeat(np.cumsum(counts) - counts, counts)
    at = np.flatnonzero(np.arange(len(corners)) - first >= 2)  # noqa: PLR2004 - a fan from its first corner
    return np.stack([corners[first[at]], corners[at - 1], corners[at]], axis=1) - 1


def has_area(obj: Obj) -> bool:
    """Whether one of the faces has three different vertices."""
    ends = obj.counts.cumsum()
    faces = zip((ends - obj.counts).tolist(), ends.tolist(), strict=True)
    return any(len(set(obj.corners[start:end].tolist())) > 2 for start, end in faces)  # noqa: PLR2004 - two are a line


def problem_of_assimp(obj: Obj) -> str:
    """Why assimp alone refuses an OBJ with faces; empty where it takes it, or where others refuse it, too."""
    if not obj.is_sound:
        return ""
    if obj.largest > len(obj.vertices):
        return f"a line or point of it has the vertex {obj.largest:,}, and it has fewer"
    if match := _ODD_LINE.search(obj.odd):
        return _of_words(match[0])
    return _problem_of_vertices(obj) if obj.has_plain_face else "its faces begin with blanks"


def _problem_of_vertices(obj: Obj) -> str:
    passed = []
    for match in _VERTEX_LINE.finditer(obj.odd):
        words = match[0].partition(b"#")[0].split()[1:]
        count = sum(_COUNTED.match(word) is not None for word in words)
        if match[0].endswith(b"\\"):  # It goes on in the next line.
            continue
        if not match[0].startswith(b"v") or count not in _COMPONENTS:
            passed.append(match[0])
        elif any(_COUNTED.match(word) is None for word in words[:count]):
            return _of_words(match[0])
        elif count == _WEIGHTED and abs(_begin(words[3].lower().partition(b"x")[0])) < _SMALLEST_WEIGHT:
            return f"the vertex {_shown(match[0])} has the weight 0"
    if passed and obj.largest > len(obj.vertices) - len(passed):
        return f"the vertex {_shown(passed[0])} begins with a blank, or has not 3, 4 or 6 numbers"
    return ""


def _of_words(line: bytes) -> str:
    return f"the line {_shown(line)} has something else than numbers"


def _shown(line: bytes) -> str:
    return shown(line.decode("utf-8", "replace").rstrip())
