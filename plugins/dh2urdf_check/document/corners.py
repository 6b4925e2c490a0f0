"""What the readers compute of the vertices and triangles of a mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

_TRIANGLES = 2**16
"""How many triangles are looked at together."""
FLAT = 1e-14
"""How far from a plane or line vertices may be that are in it, as a share of the largest coordinate."""
_SAMPLE = 64
"""How many vertices are looked at first."""
NOTHING = 1e-12
"""What Drake takes for no distance [m]."""


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


def is_planar(vertices: NDArray[Any]) -> bool:
    """Whether finite vertices are in one plane, in one line or at one place, as nearly as their numbers can be."""
    import numpy as np

    nearly = FLAT * float(np.abs(vertices).max())
    return all(_is_planar(each, nearly) for each in (_sample(vertices), vertices))


def _sample(vertices: NDArray[Any]) -> NDArray[Any]:
    """Some of the vertices: where these are in no plane, all are in none."""
    return vertices[:: max(1, len(vertices) // _SAMPLE)]


def _is_planar(vertices: NDArray[Any], nearly: float) -> bool:
    import numpy as np

    arms = vertices - vertices[0]
    along = arms[np.argmax(np.einsum("ij,ij->i", arms, arms))]
    normals = np.cross(arms, along)
    sizes = np.linalg.norm(normals, axis=1)
    if sizes.max() <= nearly * float(np.linalg.norm(along)):
        return True
    return bool(np.abs(arms @ (normals[np.argmax(sizes)] / sizes.max())).max() <= nearly)


def has_hull(vertices: NDArray[Any]) -> bool:
    """Whether Drake makes a hull of the vertices of an OBJ: it takes 0 for what is not finite.

    It does not where all are at one place or in one line, nor where qhull takes what is left for flat. To vertices in a
    plane, Drake adds one at a distance of 1 (`geometry/proximity/make_convex_hull_mesh_impl.cc`).
    """
    import numpy as np

    with np.errstate(all="ignore"):
        vertices = np.where(np.isfinite(vertices), vertices, 0.0)
        rounding = _rounding(vertices)
        return _has_hull(_sample(vertices), rounding, of_plane=False) or _has_hull(vertices, rounding, of_plane=True)


def _has_hull(vertices: NDArray[Any], rounding: float, *, of_plane: bool) -> bool:
    import numpy as np

    arms = vertices - vertices[0]
    lengths = np.linalg.norm(arms, axis=1)
    first = int(np.argmax(lengths >= NOTHING))
    normals = np.cross(arms[first] / lengths[first], arms)
    sizes = np.linalg.norm(normals, axis=1)
    second = int(np.argmax(sizes >= NOTHING))
    if not (lengths[first] >= NOTHING and sizes[second] >= NOTHING):
        return False
    normal = normals[second] / sizes[second]
    if of_plane and (np.abs(arms @ normal) <= NOTHING).all():
        vertices = np.vstack([vertices, vertices.mean(axis=0) + normal])
    return _depth(vertices) > 4.0 * rounding  # The common centre is at a quarter of the height.


def _depth(vertices: NDArray[Any]) -> float:
    """The least height of a large simplex of vertices."""
    import numpy as np

    axis = np.argmax(np.ptp(vertices, axis=0))
    start, end = vertices[np.argmin(vertices[:, axis])], vertices[np.argmax(vertices[:, axis])]
    arms, along = vertices - start, end - start
    third = arms[np.argmax(np.linalg.norm(np.cross(arms, along), axis=1))]
    fourth = arms[np.argmax(np.abs(arms @ np.cross(along, third)))]
    sides = ((along, third), (along, fourth), (third, fourth), (third - along, fourth - along))
    return float(abs(fourth @ np.cross(along, third)) / max(np.linalg.norm(np.cross(*pair)) for pair in sides))


def _rounding(vertices: NDArray[Any]) -> float:
    """What qhull takes for a rounding error of a distance (`qh_distround`)."""
    import numpy as np

    each = np.abs(vertices).max(axis=0)
    largest, total = float(each.max()), float(each.sum())
    return float(np.finfo(float).eps * (3.0 * min(3.0**0.5 * largest, total) * 1.01 + largest))
