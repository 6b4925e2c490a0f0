"""A mesh in the forms that every simulator takes: OBJ of triangles, its convex hull, or convex parts of it.

`behind_fence` runs in a child process, since a mesh may be anybody's file: behind the fence it can read no other file,
and has bounded time and memory. What is written is read again and compared with what was given before it is returned.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np  # noqa: TID253 - this module is imported where a mesh is converted

from dh2urdf.isolation.fence import enter
from dh2urdf.meshes.kinds import MeshConversion
from dh2urdf.meshes.triangles import Part, read_parts

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.rotations import Vec3

CONCAVITY = 0.05
"""Concavity of a part at which CoACD stops cutting: its `threshold`, over half of the mesh's longest edge."""
COVER = 0.05  # how far parts of a decomposition may stand off from the mesh, over its longest edge

_ROUNDING = 1e-9  # of places over the longest edge
_CLOSE = 1e-7  # of points to the planes of a hull, over the longest edge: Qhull's own precision
_CHUNK = 1 << 22  # distances that are computed at a time


class Forms(NamedTuple):
    """What is seen of a mesh, by colours, and what touches, as OBJ files; a description gives a colour of None."""

    visuals: list[tuple[tuple[float, float, float, float] | None, bytes]]
    collisions: list[bytes]


def behind_fence(content: bytes, suffix: str, scale: Vec3, how: MeshConversion, seconds: float) -> Forms:
    """The forms of a mesh file, made in this process within some seconds; it can do nothing else from then on.

    A `ValueError` says what is wrong with the mesh; an `ImportError` and a `MemoryError` are what they are.
    """
    import trimesh

    # What would be imported on the way is imported before: behind the fence, no module can be read.
    sample = trimesh.creation.box().export(file_type=suffix[1:])
    forms_of(sample.encode() if isinstance(sample, str) else sample, suffix, (1.0, 1.0, 1.0), how)
    enter([Path(__file__).parent], seconds)
    try:
        return forms_of(content, suffix, scale, how)
    except ImportError:
        raise
    except MemoryError:
        pass  # What took it is let go of before anything else is done.
    except Exception as error:  # noqa: BLE001 - what readers of other people's files raise is anything
        raise ValueError(" ".join(str(error).split())[:200] or type(error).__name__) from None
    raise MemoryError  # That of numpy cannot be handed to another process.


def forms_of(content: bytes, suffix: str, scale: Vec3, how: MeshConversion) -> Forms:
    """The forms of a mesh file; as `behind_fence`, without a fence."""
    parts = read_parts(content, suffix, scale)
    seen = [(part.rgba, _written([part])) for part in parts]
    whole = seen[0][1] if len(parts) == 1 else _written(parts)
    match how:
        case MeshConversion.HULL:
            points = np.unique(_soup(parts).reshape(-1, 3), axis=0)
            hull = _convex(points)
            if _outside(points, hull).max() > _CLOSE * np.ptp(points, axis=0).max():
                raise ValueError("its convex hull does not hold it")
            return Forms(seen, [_written([hull])])
        case MeshConversion.DECOMPOSITION:
            return Forms(seen, _convex_parts(np.concatenate([_soup([part]) for part in parts])))
    return Forms(seen, [whole])


# --- OBJ --------------------------------------------------------------------------------------------------------------


def _written(parts: Sequence[Part]) -> bytes:
    """Parts as an OBJ file, which has been read again."""
    lines, before = [], 1
    for part in parts:  # vertices, then triangles; every number as the shortest text that is read as the same double
        lines += [f"v {x!r} {y!r} {z!r}\n" for x, y, z in part.vertices.tolist()]
    for part in parts:
        lines += [f"f {a} {b} {c}\n" for a, b, c in (part.faces + before).tolist()]
        before += len(part.vertices)
    text = "".join(lines).encode()
    triangles, again = _soup(parts), _soup(read_parts(text, ".obj", (1.0, 1.0, 1.0)))
    size = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    if triangles.shape != again.shape or not np.abs(triangles - again).max() <= _ROUNDING * size:
        raise ValueError("as OBJ it is read as another surface")
    return text


def _soup(parts: Sequence[Part]) -> Any:  # noqa: ANN401 - an array
    """The corners of all triangles, of shape (N, 3, 3)."""
    return np.concatenate([part.vertices[part.faces] for part in parts])


# --- Convex shapes ----------------------------------------------------------------------------------------------------


def _convex(points: Any) -> Part:  # noqa: ANN401 - an array
    """The convex hull of points."""
    import trimesh
    from scipy.spatial import QhullError

    try:
        hull = trimesh.convex.convex_hull(points)
    except QhullError:
        hull = None
    if hull is None or not (hull.is_watertight and hull.volume > 0.0):
        raise ValueError("it is flat, and has no convex hull")
    return Part(np.array(hull.vertices), np.array(hull.faces), None)


def _convex_parts(triangles: Any) -> list[bytes]:  # noqa: ANN401 - an array
    """Convex parts that are together about as large as the mesh, each as OBJ.

    The parts are those of X. Wei, M. Liu, Z. Ling and H. Su, "Approximate Convex Decomposition for 3D Meshes with
    Collision-Aware Concavity and Tree Search", ACM Transactions on Graphics 41 (2022), by its authors' library.
    """
    import coacd

    points, faces = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    size = float(np.ptp(points, axis=0).max())
    whole = _convex(points)  # It is not flat.
    coacd.set_log_level("off")
    mesh = coacd.Mesh(points, faces.reshape(-1, 3))
    parts = [_convex(vertices) for vertices, _ in coacd.run_coacd(mesh, threshold=CONCAVITY, seed=0)]
    left = points
    for part in parts:
        left = left[_outside(left, part) > COVER * size]
    if len(left) or any(_outside(part.vertices, whole).max() > COVER * size for part in parts):
        raise ValueError(f"its convex parts stand off from it by more than {COVER:.0%} of its size")
    return [_written([part]) for part in parts]


def _outside(points: Any, hull: Part) -> Any:  # noqa: ANN401 - arrays
    """How far points lie outside the planes of a convex shape [m]; negative inside."""
    from scipy.spatial import ConvexHull

    planes = ConvexHull(hull.vertices).equations
    step = max(1, _CHUNK // len(planes))
    blocks = range(0, len(points), step)
    return np.concatenate(
        [(points[at : at + step] @ planes[:, :3].T + planes[:, 3]).max(axis=1) for at in blocks] or [[]]
    )
