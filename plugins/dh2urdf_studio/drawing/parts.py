"""What nodes of the scene are made of: bodies with a size, a place, a colour and a layer."""

from __future__ import annotations

from dataclasses import dataclass

from dh2urdf.rotations import IDENTITY, X_AXIS, Y_AXIS, RigidTransform, Rotation, Vec3, cross, norm, scale
from dh2urdf_studio.drawing.colours import GREY, Colour
from dh2urdf_studio.drawing.grips import Grip
from dh2urdf_studio.drawing.mesh_files import DrawnMesh


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenePart:
    """A body of a node.

    Attributes:
        shape: ``box`` (size x, y, z), ``cylinder`` (radius, length), ``sphere`` (radius, or three half axes), ``frame``
            (length) or ``mesh`` (none).
        size: its sizes [m].
        pose: where it is in the node.
        layer: with what it is shown, one of `LAYERS`.
        colour: its colour.
        opacity: 1 for what cannot be looked through.
        mesh: the mesh file.
        own_colours: whether the colours of the mesh file come before `colour`: those of a description do, as in RViz.
    """

    shape: str
    size: tuple[float, ...]
    pose: RigidTransform = IDENTITY
    layer: str = "links"
    colour: Colour = GREY
    opacity: float = 1.0
    mesh: DrawnMesh | None = None
    own_colours: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneNode:
    """A rigid thing.

    Attributes:
        name: what it is called: a link's name, or ``frame 3``.
        row: number of the row of the table that it belongs to, counted from 0.
        figure: the name of the robot that it belongs to.
        grip: how it can be dragged; None where no joint moves it.
        carrier: the node whose frame carries its frame; None for what shows no frame, and for a root.
        parts: its bodies.
        label: a text that is at its origin.
        layer: with what the label is shown.
        rooted: whether no joint moves it, in a robot that may stand elsewhere than at its root.
    """

    name: str
    row: int | None = None
    figure: str = ""
    grip: Grip | None = None
    carrier: str | None = None
    parts: tuple[ScenePart, ...] = ()
    label: str = ""
    layer: str = "frames"
    rooted: bool = False


def towards(direction: Vec3) -> Rotation:
    """A rotation that turns z into a direction."""
    z = scale(1.0 / norm(direction), direction)
    helper = X_AXIS if abs(z[0]) < 0.9 else Y_AXIS  # noqa: PLR2004 - any that is not nearly parallel
    y = cross(z, helper)
    y = scale(1.0 / norm(y), y)
    x = cross(y, z)
    return (x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2])
