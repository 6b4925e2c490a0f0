"""What a description may name for a mesh: the choices of `dh2urdf.meshes.conversion`."""

from __future__ import annotations

from enum import StrEnum


class MeshConversion(StrEnum):
    """What descriptions name for a mesh."""

    NEVER = "never"
    """The file as it is given."""
    AUTO = "auto"
    """An OBJ file, with the scale, and a COLLADA file's unit, axes and transforms, in its numbers."""
    HULL = "hull"
    """The same; what touches is the convex hull."""
    DECOMPOSITION = "decomposition"
    """The same; what touches are convex parts."""
