"""The vertices and faces of OBJ and STL files, as the readers take them that look into them."""

from __future__ import annotations

import re
from itertools import islice
from typing import TYPE_CHECKING, Any

from dh2urdf.source import shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

VERTEX = {
    ".stl": re.compile(rb"^[ \t]*vertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.MULTILINE),
    ".obj": re.compile(rb"^[ \t]*v[ \t]+(?:([^\s#]\S*)(?:[ \t]+(\S+)(?:[ \t]+(\S+))?)?)?", re.MULTILINE),
}
FACE = re.compile(rb"^[ \t]*f((?:[ \t]+\S+){3,})", re.MULTILINE)
_NUMBER = re.compile(
    rb"[-+]?(?:0x(?:[0-9a-f]+\.?[0-9a-f]*|\.[0-9a-f]+)(?:p[-+]?[0-9]+)?"
    rb"|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[-+]?[0-9]+)?|inf|nan)",
    re.IGNORECASE,
)
_LINE = re.compile(rb"^[ \t]*l[ \t]", re.MULTILINE)
_BEGINS = rb"(?:[-+]?[0-9]|[-+]\.[0-9]|[-+]?(?:nan|inf))"
"""The beginnings of texts that assimp counts as numbers."""
_ODD_VERTEX = re.compile(
    rb"^(?:[ \t]+v[ \t]|v[ \t](?![ \t]*(?:%b\S*[ \t]+){2}%b))[^\n]*" % (_BEGINS, _BEGINS), re.MULTILINE | re.IGNORECASE
)
"""A vertex that assimp passes over: it begins with a blank, or is not three numbers."""
_ODD_LINE = re.compile(
    rb"^(?:vn[ \t](?![ \t]*(?:(?:\.|%b)\S*[ \t]+){2}(?:\.|%b))|vt[ \t](?![ \t]*%b\S*[ \t]+%b)"
    rb"|f[ \t](?=[^\n#]*[^-+0-9/ \t\n#\\])|v[ \t](?=[^\n#]*[0-9.]e[-+]?[ \t\n]))[^\n]*" % (4 * (_BEGINS,)),
    re.MULTILINE | re.IGNORECASE,
)
"""A line of an OBJ with something else than numbers, for which assimp refuses the file."""
_PLAIN_FACE = re.compile(rb"^f[ \t]", re.MULTILINE)
_NORMAL = re.compile(rb"^[ \t]*vn[ \t]", re.MULTILINE)
_WITH_NORMAL = re.compile(rb"[^\s/]+/[^\s/]*/([-+]?[0-9]+)(?=\s|\Z)")
_CHUNK = 4096
_BLOCK = 2**20
"""How much of an OBJ is looked at together [B]."""
_DIGITS = 18
"""Digits of a number that 8 bytes hold."""
_TRIANGLES = 2**16
"""How many triangles are looked at together."""
FLAT = 1e-14
"""How far from a plane or line vertices may be that are in it, as a share of the largest coordinate."""
POINT = 1e-12
"""The size of a mesh that Drake takes for a point [m]."""


def vertices_of(lines: bytes, suffix: str) -> NDArray[Any]:
    """The vertices of a file of text, of shape (n, 3); 0 for what is missing or begins with no number.

    Raises:
        ValueError: a text in an STL is no number.
    """
    import numpy as np

    chunks, texts = [], (match.groups(b"") for match in VERTEX[suffix].finditer(lines))
    while chunk := list(islice(texts, _CHUNK)):
        try:
            chunks.append(np.array(chunk).astype(float))
        except ValueError:
            if suffix != ".obj":
                raise
            chunks.append(np.array([[_begin(text) for text in corner] for corner in chunk]))
    return np.concatenate(chunks) if chunks else np.empty((0, 3))


def _begin(text: bytes) -> float:
    if (match := _NUMBER.match(text)) is None:
        return 0.0
    return float.fromhex(match[0].decode()) if b"x" in match[0].lower() else float(match[0])


def problem_of_assimp(lines: bytes, count: int, triangles: NDArray[Any]) -> str:
    """Why assimp refuses an OBJ with as many vertices, and with faces; empty where it takes it."""
    if match := _ODD_LINE.search(lines):
        return f"the line {_shown(match[0])} has something else than numbers"
    if not _PLAIN_FACE.search(lines):
        return "its faces begin with blanks"
    found = (match[0].rstrip() for match in _ODD_VERTEX.finditer(lines))
    odd = [line for line in found if not line.endswith(b"\\")]  # It goes on in the next line.
    if odd and int(triangles.max(initial=0)) >= count - len(odd):
        return f"the vertex {_shown(odd[0])} begins with a blank, or is not three numbers"
    return ""


def _shown(line: bytes) -> str:
    return shown(line.decode("utf-8", "replace").rstrip())


def triangles_of(lines: bytes) -> NDArray[Any] | None:
    """The triangles of the faces of an OBJ, by vertices counted from 0.

    None where one is counted from the end, or where there are neither faces nor lines: MuJoCo makes a hull then.
    """
    import numpy as np

    if not FACE.search(lines) and not _LINE.search(lines):
        return None
    found = []
    for start, end in _blocks(lines):
        faces = FACE.findall(lines, start, end)
        numbers = _vertex_numbers(b"".join(faces))
        if (numbers < 0).any():
            return None
        counts = np.array([len(face.split()) for face in faces], np.int64)
        first = np.repeat(np.cumsum(counts) - counts, counts)
        at = np.flatnonzero(np.arange(len(numbers)) - first >= 2)  # noqa: PLR2004 - a fan from its first corner
        found.append(np.stack([numbers[first[at]], numbers[at - 1], numbers[at]], axis=1) - 1)
    return np.concatenate(found) if found else np.empty((0, 3), np.int64)


def summed_volume(vertices: NDArray[Any], triangles: NDArray[Any]) -> float:
    """The pyramids between the triangles and their common centre, added up whatever their orientation.

    So MuJoCo has the volume of a mesh of a URDF (`mjCMesh::ComputeVolume`, its inertia of the kind `legacy`).
    """
    import numpy as np

    moment, area, volume = np.zeros(3), 0.0, 0.0
    parts = [triangles[start : start + _TRIANGLES] for start in range(0, len(triangles), _TRIANGLES)]
    with np.errstate(all="ignore"):  # of what is not finite
        for part in parts:
            centres, normals = _facets(vertices[part])
            areas = np.linalg.norm(normals, axis=1)
            moment, area = moment + areas @ centres, area + float(areas.sum())
        if not area:
            return 0.0
        for part in parts:
            centres, normals = _facets(vertices[part])
            volume += float(np.abs(np.einsum("ij,ij->i", centres - moment / area, normals)).sum()) / 3.0
    return volume


def _facets(corners: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """The centres of triangles, and their normals whose lengths are the areas."""
    import numpy as np

    first, second, third = corners[:, 0], corners[:, 1], corners[:, 2]
    return corners.mean(axis=1), np.cross(second - first, third - first) / 2.0


def dimensions(vertices: NDArray[Any]) -> int:
    """Of finite vertices: 0 at one place, 1 in one line, 2 in one plane, else 3; as nearly as their numbers can be."""
    import numpy as np

    arms = vertices - vertices[0]
    along = arms[np.argmax(np.einsum("ij,ij->i", arms, arms))]
    normals = np.cross(arms, along)
    sizes = np.linalg.norm(normals, axis=1)
    length, largest = float(np.linalg.norm(along)), float(np.abs(vertices).max())
    if length < POINT:
        return 0
    if sizes.max() <= FLAT * largest * length:
        return 1
    normal = normals[np.argmax(sizes)] / sizes.max()
    return 2 if np.abs(arms @ normal).max() <= FLAT * largest else 3


def lacks_normals(lines: bytes) -> bool:
    """Whether an OBJ has normals, and a face with a corner that has none."""
    count = sum(1 for _ in _NORMAL.finditer(lines))
    for start, end in _blocks(lines) if count else ():
        corners = b"".join(FACE.findall(lines, start, end))
        numbers = abs(_vertex_numbers(b" " + b" ".join(_WITH_NORMAL.findall(corners))))
        if len(numbers) != len(corners.split()) or not ((numbers > 0) & (numbers <= count)).all():
            return True
    return False


def stray_corner(lines: bytes, count: int) -> int | None:
    """A number in the faces of an OBJ that is none of its vertices, which are counted from 1.

    A corner is ``vertex/texture/normal``, and a negative vertex is counted from the last one before the face.
    """
    is_backwards = False
    for start, end in _blocks(lines):
        numbers = _vertex_numbers(b"".join(FACE.findall(lines, start, end)))
        for odd in (numbers[numbers > count], numbers[numbers == 0]):
            if len(odd):
                return int(odd[0])
        is_backwards |= bool((numbers < 0).any())
    return _stray_backwards(lines) if is_backwards else None


def _stray_backwards(lines: bytes) -> int | None:
    """A negative number in the faces of an OBJ that goes back beyond its first vertex."""
    count = 0
    for start, end in _blocks(lines):
        numbers = _vertex_numbers(b"".join(FACE.findall(lines, start, end)))
        if (numbers < -count).any():
            for line in lines[start:end].split(b"\n"):
                count += VERTEX[".obj"].match(line) is not None
                if match := FACE.match(line):
                    for number in _vertex_numbers(match[1]).tolist():
                        if number < -count:
                            return int(number)
        else:
            count += sum(1 for _ in VERTEX[".obj"].finditer(lines, start, end))
    return None


def _blocks(lines: bytes) -> Iterator[tuple[int, int]]:
    """The beginnings and ends of blocks of whole lines."""
    start = 0
    while start < len(lines):
        end = lines.find(b"\n", start + _BLOCK) + 1 or len(lines)
        yield start, end
        start = end


def _vertex_numbers(corners: bytes) -> NDArray[Any]:
    """The first number of each of some corners, as the function ``atoi`` of C reads it: 0 where there is none."""
    import numpy as np

    text = np.frombuffer(corners + b" ", np.uint8)
    at = np.flatnonzero((text[:-1] <= ord(" ")) & (text[1:] > ord(" "))) + 1
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


def has_area(faces: Iterable[bytes]) -> bool:
    """Whether one of some faces has three different vertices."""
    return any(
        len({corner.partition(b"/")[0] for corner in face.split()}) > 2  # noqa: PLR2004 - two are a line
        for face in faces
    )
