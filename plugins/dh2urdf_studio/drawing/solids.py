"""Surfaces of the shapes in a scene, for files: triangles with a normal for each corner."""

from __future__ import annotations

from itertools import pairwise
from math import cos, pi, sin
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

_SIDES = 32
CYLINDER = ((0.0, -0.5), (1.0, -0.5), (1.0, 0.5), (0.0, 0.5))
"""Radius and height along a cylinder of radius 1 and length 1, whose axis is z."""
SPHERE = tuple((round(sin(pi * step / 16), 12), -cos(pi * step / 16)) for step in range(17))
"""Radius and height along a sphere of radius 1."""
ARROW = ((0.0, 0.0), (0.035, 0.0), (0.035, 0.76), (0.095, 0.76), (0.0, 1.0))
"""Radius and height along an arrow of length 1, which points along z."""


class Picture(NamedTuple):
    """A picture on triangles, as browsers show it.

    Attributes:
        content: the file.
        media_type: its type, such as ``image/png``.
    """

    content: bytes
    media_type: str


class Surface(NamedTuple):
    """Triangles.

    Attributes:
        positions: corners [m], of shape (N, 3).
        normals: the direction outwards at each corner, of shape (N, 3).
        corners: numbers of corners, three for each triangle, anticlockwise as seen from outside, of shape (3 M,).
        uv: where the corners are in the texture, as `dh2urdf.meshes.triangles.Texture` has them, of shape (N, 2).
        texture: the picture on the triangles.
    """

    positions: Any
    normals: Any
    corners: Any
    uv: Any = None
    texture: Picture | None = None


def box() -> Surface:
    """A cube of side 1 about the origin."""
    import numpy as np

    positions, normals = [], []
    for axis in range(3):
        for sign in (1.0, -1.0):
            normal, one = np.zeros(3), np.zeros(3)
            normal[axis], one[(axis + 1) % 3] = sign, 1.0
            other = np.cross(normal, one)
            positions += [0.5 * (normal + i * one + j * other) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            normals += 4 * [normal]
    corners = [4 * face + corner for face in range(6) for corner in (0, 1, 2, 0, 2, 3)]
    return Surface(np.array(positions), np.array(normals), np.array(corners))


def turned(profile: Sequence[tuple[float, float]], *, is_round: bool = False) -> Surface:
    """What a line sweeps when it turns about z.

    Args:
        profile: its points, radius and height, from the lower end of z to the upper one.
        is_round: whether it is an arc about the origin, which has no edges.
    """
    import numpy as np

    angles = np.linspace(0.0, 2.0 * pi, _SIDES + 1)
    outwards, upwards = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1), np.array([0.0, 0.0, 1.0])
    positions: list[Any] = []
    normals: list[Any] = []
    corners: list[int] = []
    for start, end in pairwise(profile):
        flat = np.array([end[1] - start[1], start[0] - end[0]])
        for point in (start, end):
            radial, axial = point if is_round else flat / np.linalg.norm(flat)
            positions.extend(point[0] * outwards + point[1] * upwards)
            normals.extend(radial * outwards + axial * upwards)
        below = len(positions) - 2 * len(angles)
        for one in range(below, below + _SIDES):
            other = one + len(angles)
            corners += [one, one + 1, other + 1] if start[0] > 0.0 else []
            corners += [one, other + 1, other] if end[0] > 0.0 else []
    return Surface(np.array(positions), np.array(normals), np.array(corners))
