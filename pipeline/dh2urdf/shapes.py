"""Bodies, meshes, shapes and materials of links, in tables and in robots."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from dh2urdf.fields import ExactRecord, Record
from dh2urdf.rotations import IDENTITY, ZERO, RigidTransform, Vec3
from dh2urdf.source import Mark

Formulas: TypeAlias = tuple[str, str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Inertia(Record):
    """A symmetric inertia tensor [kg·m²]; the products are those of the matrix, not their negatives."""

    ixx: float
    iyy: float
    izz: float
    ixy: float = 0.0
    ixz: float = 0.0
    iyz: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkGeometry(ExactRecord):
    """What shape links are drawn with; None where the table leaves it to the transform.

    Attributes:
        shape: ``cylinder``, ``box``, ``capsule`` (a cylinder with sphere caps) or ``arm`` (tubes with housings at
            the joints).
        radius: radius, or half the thickness of a box [m].
    """

    shape: str | None = None
    radius: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshFile(ExactRecord):
    """A file that holds a triangle mesh.

    Attributes:
        path: its absolute path.
        sha256: the hash of what is in it, in hexadecimal digits: what is made of it depends on that.
        content: what is in it, where it is made by the pipeline and not on disk; its path then names it alone.
        named: pictures and files of materials that it names and that are copied with it. The hash is that of its copy
            then, which has the names of their copies.
        name: what a mesh calls it that names it.
    """

    path: str
    sha256: str
    content: bytes | None = field(default=None, compare=False, repr=False)
    named: tuple[MeshFile, ...] = field(default=(), compare=False, repr=False)
    name: str = field(default="", compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshShape(ExactRecord):
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Payload(ExactRecord):
    """What an arm carries at its tool.

    Attributes:
        mass: its mass [kg].
        com: its centre of mass in tool0 [m].
        inertia: inertia tensor about the centre of mass, axes of tool0 [kg·m²]; None for that of a solid ball.
    """

    mass: float
    com: Vec3 = (0.0, 0.0, 0.0)
    inertia: Inertia | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter(Record):
    """A number of the table that formulas may use.

    Attributes:
        name: an identifier such as ``a_2``.
        value: its value.
        unit: ``m`` or ``rad``.
        joint: name of the joint whose row says it.
    """

    name: str
    value: float
    unit: str
    joint: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Origin(Record):
    """A frame in its parent frame.

    Attributes:
        xyz: position [m].
        rpy: fixed-axis roll, pitch, yaw [rad].
        xyz_formula: the formulas of xyz.
        rpy_formula: the formulas of rpy.
    """

    xyz: Vec3 = ZERO
    rpy: Vec3 = ZERO
    xyz_formula: Formulas | None = field(default=None, compare=False)
    rpy_formula: Formulas | None = field(default=None, compare=False)

    @classmethod
    def of(cls, transform: RigidTransform) -> Origin:
        """The frame that a rigid transform leads to."""
        return cls(xyz=transform.translation, rpy=transform.rpy)

    @property
    def transform(self) -> RigidTransform:
        """The rigid transform from the parent frame to this one."""
        return RigidTransform.from_xyz_rpy(self.xyz, self.rpy)


@dataclass(frozen=True, slots=True, kw_only=True)
class Box(Record):
    """A box about its origin; size along x, y, z [m]."""

    size: Vec3
    size_formula: Formulas | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cylinder(Record):
    """A cylinder about its origin, along z; radius and length [m]."""

    radius: float
    length: float
    length_formula: str | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Sphere(Record):
    """A sphere about its origin; radius [m]."""

    radius: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Mesh(Record):
    """A mesh file.

    Attributes:
        filename: the file as a description names it: a path from the description's folder, or a URI.
        scale: factors along the axes of the mesh.
        file: the file that is meant, where it is at hand; the pipeline then copies it, and says how it is named.
    """

    filename: str
    scale: Vec3 = (1.0, 1.0, 1.0)
    file: MeshFile | None = field(default=None, compare=False)


Geometry: TypeAlias = Box | Cylinder | Sphere | Mesh


@dataclass(frozen=True, slots=True, kw_only=True)
class Material(Record):
    """A colour with a name.

    Attributes:
        name: its name.
        rgba: red, green, blue, alpha in 0..1.
        texture: the address of a picture that is on it; empty without.
        picture: the file of this picture, where it is at hand.
    """

    name: str
    rgba: tuple[float, float, float, float]
    texture: str = ""
    picture: MeshFile | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Visual(Record):
    """A shape that is seen."""

    geometry: Geometry
    origin: Origin = Origin()
    material: Material | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Collision(Record):
    """A shape that touches."""

    geometry: Geometry
    origin: Origin = Origin()
