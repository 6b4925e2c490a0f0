"""What a table may declare about the bodies of links: shapes, meshes, inertia, and a payload."""

from __future__ import annotations

from dataclasses import dataclass, field

from dh2urdf.record_fields import take_exact_fields, take_fields
from dh2urdf.rotations import IDENTITY, RigidTransform, Vec3
from dh2urdf.source import Mark


@dataclass(frozen=True, slots=True, kw_only=True)
class Inertia:
    """A symmetric inertia tensor [kg·m²]; the products are those of the matrix, not their negatives."""

    ixx: float
    iyy: float
    izz: float
    ixy: float = 0.0
    ixz: float = 0.0
    iyz: float = 0.0

    def __post_init__(self) -> None:
        take_fields(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkGeometry:
    """What shape links are drawn with; None where the table leaves it to the transform.

    Attributes:
        shape: ``cylinder``, ``box``, ``capsule`` (a cylinder with sphere caps) or ``arm`` (tubes with housings at
            the joints).
        radius: radius, or half the thickness of a box [m].
    """

    shape: str | None = None
    radius: float | None = None

    def __post_init__(self) -> None:
        take_exact_fields(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshFile:
    """A file that holds a triangle mesh.

    Attributes:
        path: its absolute path.
        sha256: the hash of what is in it, in hexadecimal digits: what is made of it depends on that.
        content: what is in it, where it is made by the pipeline and not on disk; its path then names it alone.
    """

    path: str
    sha256: str
    content: bytes | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        take_exact_fields(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshShape:
    """A mesh file as the shape of a link.

    Attributes:
        file: the file.
        pose: the frame of the mesh in the DH frame after the link's row; of the base, in the DH frame before the first.
        scale: factors along the axes of the mesh.
        mark: where the file is named.
    """

    file: MeshFile
    pose: RigidTransform = IDENTITY
    scale: Vec3 = (1.0, 1.0, 1.0)
    mark: Mark | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        take_exact_fields(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class Payload:
    """What an arm carries at its tool.

    Attributes:
        mass: its mass [kg].
        com: its centre of mass in tool0 [m].
        inertia: inertia tensor about the centre of mass, axes of tool0 [kg·m²]; None for that of a solid ball.
    """

    mass: float
    com: Vec3 = (0.0, 0.0, 0.0)
    inertia: Inertia | None = None

    def __post_init__(self) -> None:
        take_exact_fields(self)
