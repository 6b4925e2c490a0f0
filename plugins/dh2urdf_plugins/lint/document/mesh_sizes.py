"""How large a mesh file is: the sides of the box around it, read without a package for meshes.

Any file may be at the address of a mesh, so its size is bounded; what cannot be read has no size here. Other rules
report such files.
"""

from __future__ import annotations

import math
import re
from itertools import islice, product
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree as ET

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

LARGEST = 2**25
"""Size of a mesh file that is read [B]."""
STL_HEADER, STL_TRIANGLE = 84, 50  # bytes: 80 of any text, then the number of triangles in 4
_CORNER = {
    ".stl": re.compile(rb"^[ \t]*vertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.MULTILINE),
    ".obj": re.compile(rb"^v[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.MULTILINE),
}
_CHUNK = 4096
_MOST_NODES = 10_000


def sides_of(path: Path) -> tuple[float, float, float] | None:
    """The sides of the box around a mesh in its own axes, in the unit of the file or, of COLLADA, in metres.

    Args:
        path: a file that is there; its suffix says which format it has.

    Returns:
        The sides; None where the file cannot be read, is too large, or has another format than STL, OBJ and DAE.
    """
    try:
        if path.stat().st_size > LARGEST:
            return None
        box = _box(path.read_bytes(), path.suffix.lower())
    except (OSError, ValueError, LookupError, ET.ParseError):
        return None
    if box is None:
        return None
    x, y, z = (float(side) for side in box[1] - box[0])
    return (x, y, z) if all(map(math.isfinite, (x, y, z))) else None


def _box(content: bytes, suffix: str) -> NDArray[Any] | None:
    """The least and the greatest coordinates, of shape (2, 3)."""
    if suffix == ".dae":
        return _of_collada(content)
    if suffix == ".stl" and (corners := _of_binary_stl(content)) is not None:
        return _around(corners)
    if suffix not in _CORNER:
        return None
    texts = (match.groups() for match in _CORNER[suffix].finditer(content))
    return _around_all(_around(chunk) for chunk in _chunks(texts))


def _chunks(texts: Iterator[tuple[bytes, ...]]) -> Iterator[NDArray[Any]]:
    import numpy as np

    while chunk := list(islice(texts, _CHUNK)):
        yield np.array(chunk).astype(float)


def _of_binary_stl(content: bytes) -> NDArray[Any] | None:
    """The corners of all triangles; None where the file is an STL of text."""
    import numpy as np

    count = int.from_bytes(content[80:STL_HEADER], "little")
    if len(content) < STL_HEADER or len(content) < STL_HEADER + count * STL_TRIANGLE:
        return None
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])
    return np.frombuffer(content, triangle, count, STL_HEADER)["corners"].reshape(-1, 3).astype(float)


def _around(corners: NDArray[Any]) -> NDArray[Any] | None:
    import numpy as np

    return np.stack([corners.min(axis=0), corners.max(axis=0)]) if len(corners) else None


def _around_all(boxes: Iterator[NDArray[Any] | None]) -> NDArray[Any] | None:
    import numpy as np

    found = [box for box in boxes if box is not None]
    return _around(np.concatenate(found)) if found else None


# --- COLLADA 1.4.1 ----------------------------------------------------------------------------------------------------


def _of_collada(content: bytes) -> NDArray[Any] | None:
    """Around the boxes of all geometries where the scene has them.

    Raises:
        ValueError: it declares entities, or what should be a number is none.
        LookupError: something is missing.
        ParseError: it is no XML.
    """
    if b"<!ENTITY" in content.replace(b"\0", b""):  # of a stranger: it could become endless
        raise ValueError
    root = ET.fromstring(content)  # noqa: S314 - it has no entities
    for element in root.iter():
        element.tag = str(element.tag).rpartition("}")[2]
    unit = root.find("asset/unit")
    metres = float(unit.get("meter", "1")) if unit is not None else 1.0
    boxes = {f"#{geometry.get('id')}": _geometry(geometry) for geometry in root.iterfind("library_geometries/geometry")}
    box = _around_all(_placed(root, boxes))
    return None if box is None else metres * box


def _geometry(geometry: ET.Element) -> NDArray[Any] | None:
    """The box around the vertices of a geometry."""
    import numpy as np

    sources = {f"#{source.get('id')}": source for source in geometry.iterfind("mesh/source")}
    boxes = []
    for given in geometry.iterfind("mesh/vertices/input[@semantic='POSITION']"):
        source = sources[given.get("source", "")]
        accessor = source.find("technique_common/accessor")
        stride = int(accessor.get("stride", "1")) if accessor is not None else 3
        numbers = np.array((source.findtext("float_array") or "").split(), dtype=float)
        boxes.append(_around(numbers.reshape(-1, stride)[:, :3]))
    return _around_all(iter(boxes))


def _placed(root: ET.Element, boxes: dict[str, NDArray[Any] | None]) -> Iterator[NDArray[Any]]:
    """The corners of each geometry's box where a node of the scene has it."""
    import numpy as np

    waiting = [(node, np.eye(4)) for node in root.iterfind("library_visual_scenes/visual_scene/node")]
    for node, above in waiting:
        if len(waiting) > _MOST_NODES:
            raise ValueError
        place = above
        for step in node:
            place = place @ _transform(step)
        for instance in node.iterfind("instance_geometry"):
            if (box := boxes[instance.get("url", "")]) is not None:
                corners = np.array([[*corner, 1.0] for corner in product(*box.T)])
                yield corners @ place[:3].T
        waiting.extend((child, place) for child in node.iterfind("node"))


def _transform(step: ET.Element) -> NDArray[Any]:
    """The matrix of a child of a node; that of what does not move anything is the identity."""
    import numpy as np

    matrix = np.eye(4)
    if step.tag not in {"matrix", "translate", "scale", "rotate"}:
        return matrix
    numbers = np.array((step.text or "").split(), dtype=float)
    match step.tag:
        case "matrix":
            return numbers.reshape(4, 4)
        case "rotate":
            matrix[:3, :3] = _turn(*numbers.reshape(4).tolist())
        case "translate":
            matrix[:3, 3] = numbers.reshape(3)
        case _:
            matrix[:3, :3] = np.diag(numbers.reshape(3))
    return matrix


def _turn(x: float, y: float, z: float, degrees: float) -> NDArray[Any]:
    """The rotation about an axis, after Rodrigues."""
    import numpy as np

    length, angle = math.hypot(x, y, z) or 1.0, math.radians(degrees)
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]) / length
    return np.eye(3) + math.sin(angle) * k + (1.0 - math.cos(angle)) * k @ k
