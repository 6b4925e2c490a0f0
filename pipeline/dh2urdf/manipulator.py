"""A manipulator as its table says it: Denavit-Hartenberg rows, in SI units.

What is None was not said; the transform computes it. Nothing here is interpreted: the convention, the offset and
the sign stay as the table has them, and `dh2urdf.kinematics` is the one place that knows what they mean.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

from dh2urdf.rotations import IDENTITY, RigidTransform, Vec3
from dh2urdf.source import Mark, Problem

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


class Convention(StrEnum):
    """Which of the two Denavit-Hartenberg conventions a table is written in."""

    STANDARD = "standard"
    """Classic, distal (Denavit-Hartenberg, Paul, Spong): A = Rz(theta) Tz(d) Tx(a) Rx(alpha)."""
    MODIFIED = "modified"
    """Proximal (Craig): A = Rx(alpha) Tx(a) Rz(theta) Tz(d); a row carries a and alpha of the link before it."""


class JointType(StrEnum):
    """How a joint moves."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Bounds of one joint value q and of its motion; None where the table says nothing.

    Attributes:
        lower: smallest q [rad or m].
        upper: largest q [rad or m].
        velocity: largest speed [rad/s or m/s].
        effort: largest torque or force [N·m or N].
    """

    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Inertia:
    """A symmetric inertia tensor [kg·m²]; the products are those of the matrix, not their negatives."""

    ixx: float
    iyy: float
    izz: float
    ixy: float = 0.0
    ixz: float = 0.0
    iyz: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkGeometry:
    """What shape links are drawn with; None where the table leaves it to the transform.

    Attributes:
        shape: ``cylinder``, ``box`` or ``capsule`` (a cylinder with sphere caps).
        radius: radius, or half the thickness of a box [m].
    """

    shape: str | None = None
    radius: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshFile:
    """A file that holds a triangle mesh.

    Attributes:
        path: its absolute path.
        sha256: the hash of what stands in it, in hexadecimal digits: what is made of it depends on that.
    """

    path: str
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshShape:
    """A mesh file as the shape of a link.

    Attributes:
        file: the file.
        pose: the frame of the mesh in the DH frame after the link's row; of the base, in the DH frame before the first.
        scale: factors along the axes of the mesh [1].
        mark: where the file is named.
    """

    file: MeshFile
    pose: RigidTransform = IDENTITY
    scale: Vec3 = (1.0, 1.0, 1.0)
    mark: Mark | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class DHRow:
    """One row of the table: one joint and the link that it moves.

    Attributes:
        joint: name of the joint.
        link: name of the link that it moves.
        type: how it moves.
        a: length of the common normal [m]; a of the link before in the modified convention.
        alpha: twist [rad]; of the link before in the modified convention.
        d: offset along the joint axis [m].
        theta: angle about the joint axis [rad].
        offset: added to the joint variable [rad or m].
        sign: 1, or -1 where the joint counts the other way.
        limits: bounds of q.
        mass: mass of the link [kg].
        com: centre of mass in the DH frame after this row [m].
        inertia: inertia tensor about the centre of mass, axes of the DH frame after this row [kg·m²].
        radius: radius of the link's shape [m].
        damping: viscous friction of the joint [N·m·s/rad or N·s/m].
        friction: static friction of the joint [N·m or N].
        armature: inertia of the motor's rotor as the joint feels it, behind the gear [kg·m² or kg].
        visual: the mesh that the link is seen as.
        collision: the mesh that the link touches with.
        mark: the row in its file.
    """

    joint: str
    link: str
    type: JointType = JointType.REVOLUTE
    a: float
    alpha: float
    d: float
    theta: float = 0.0
    offset: float = 0.0
    sign: int = 1
    limits: Limits = Limits()
    mass: float | None = None
    com: Vec3 | None = None
    inertia: Inertia | None = None
    radius: float | None = None
    damping: float | None = None
    friction: float | None = None
    armature: float | None = None
    visual: MeshShape | None = None
    collision: MeshShape | None = None
    mark: Mark | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Manipulator:
    """A serial arm as its table says it.

    Attributes:
        name: the manipulator's name, as the user wrote it.
        convention: the Denavit-Hartenberg convention of the rows.
        rows: one per joint, from the base outwards.
        base: rigid transform from base_link to the first DH frame.
        tool: rigid transform from the last DH frame to tool0.
        geometry: shape of every link.
        density: density of links without a mass [kg/m³].
        base_mass: mass of the base's body [kg].
        base_geometry: shape of the base's body.
        base_visual: the mesh that the base is seen as.
        base_collision: the mesh that the base touches with.
        visuals: whether links are seen at all; None leaves it to the transform.
        collisions: whether links touch at all; None leaves it to the transform.
        mark: the manipulator's place in its file.
        notices: what a careful person would want to know about how it was read.
    """

    name: str
    convention: Convention
    rows: tuple[DHRow, ...]
    base: RigidTransform = IDENTITY
    tool: RigidTransform = IDENTITY
    geometry: LinkGeometry = LinkGeometry()
    density: float | None = None
    base_mass: float | None = None
    base_geometry: LinkGeometry = LinkGeometry()
    base_visual: MeshShape | None = None
    base_collision: MeshShape | None = None
    visuals: bool | None = None
    collisions: bool | None = None
    mark: Mark | None = field(default=None, compare=False)
    notices: tuple[Problem, ...] = field(default=(), compare=False)

    @property
    def moving_rows(self) -> tuple[DHRow, ...]:
        """The rows that have a joint value, in order: q has one entry for each."""
        return tuple(row for row in self.rows if row.type is not JointType.FIXED)

    def fk(self, q: ArrayLike) -> NDArray[np.float64]:
        """Forward kinematics: the DH product at one joint vector or at many.

        Args:
            q: joint vectors of shape (..., n), one value per moving row [rad or m].

        Returns:
            T(base_link → tool0) of shape (..., 4, 4), lengths in m.

        Raises:
            ValueError: the joint vectors have another number of values than the table has moving rows.
        """
        from dh2urdf.kinematics import pose_matrices

        return pose_matrices(self, q)

    def _repr_html_(self) -> str:
        """What a notebook shows: the table and, with matplotlib, a drawing of the arm."""
        from dh2urdf.report.notebook import manipulator_html

        return manipulator_html(self)
