"""Links whose shapes are mesh files: where they stand, what they weigh, and what is wrong with them.

A mesh is given in the DH frame after its row, so that it stands where it was drawn whichever frames the links get. Its
mass properties are those of the volume that its triangles enclose; of a mesh that is not closed, and so encloses none,
those of its convex hull. trimesh reads the files and finds hulls; it is asked where the table leaves something open.

The integrals over the volume are sums over the tetrahedra between a point and the triangles, exactly as in S. Lien and
J. Kajiya, "A symbolic method for calculating the integral properties of arbitrary nonconvex polyhedra", IEEE Computer
Graphics and Applications 4 (1984). `math.fsum` adds them, so they are the same on every machine.
"""

from __future__ import annotations

import io
import math
import re
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import MissingDependencyError, TransformError
from dh2urdf.manipulator import Inertia
from dh2urdf.mass_properties import placed, scaled
from dh2urdf.meshes import read_mesh
from dh2urdf.robot import Collision, Inertial, Mesh, Origin, Visual
from dh2urdf.rotations import IDENTITY_ROTATION, RigidTransform
from dh2urdf.source import Problem, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.manipulator import DHRow, Manipulator, MeshFile, MeshShape
    from dh2urdf.robot import Material
    from dh2urdf.rotations import Vec3

FORMATS = (".stl", ".obj", ".dae")
LARGE, SMALL = 10.0, 1e-3
"""Sizes of a mesh at which a careful person would look at its scale [m]."""

_FLAT = 1e-12  # volume over the cube of the size: below, it is rounding
_ROUNDING = 1e-12  # over the size of a body or the trace of its inertia
_HEAD = 1 << 16  # of a COLLADA file: its asset element stands first
_UNIT = re.compile(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']([^\"']*)[\"']")
_UP = re.compile(rb"<up_axis>\s*([XYZ])_UP\s*</up_axis>")
_OTHER_FILES = {".obj": re.compile(rb"^\s*mtllib\s", re.MULTILINE), ".dae": re.compile(rb"<init_from>[^<]*\.\w+\s*<")}


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshBody:
    """A mesh as a solid body of 1 kg/m³, in the frame of the mesh.

    Attributes:
        solid: its mass properties.
        is_closed: whether they are those of the mesh itself, not of its convex hull.
        size: the longest edge of the box around it [m].
    """

    solid: Inertial
    is_closed: bool
    size: float


# --- Shapes -----------------------------------------------------------------------------------------------------------


def mesh_visual(shape: MeshShape, dh_frame: RigidTransform, material: Material) -> Visual:
    """A mesh as it is seen; COLLADA files have colours of their own."""
    own_colours = Path(shape.file.path).suffix.lower() == ".dae"
    return Visual(
        geometry=_geometry(shape), origin=_origin(shape, dh_frame), material=None if own_colours else material
    )


def mesh_collision(shape: MeshShape, dh_frame: RigidTransform) -> Collision:
    """A mesh as it touches."""
    return Collision(geometry=_geometry(shape), origin=_origin(shape, dh_frame))


def _geometry(shape: MeshShape) -> Mesh:
    return Mesh(filename=f"file://{shape.file.path}", scale=shape.scale, file=shape.file)


def _origin(shape: MeshShape, dh_frame: RigidTransform) -> Origin:
    """The frame of a mesh in the link's frame; numbers, also where the link follows parameters."""
    frame = dh_frame @ shape.pose
    x, y, z = frame.translation
    return Origin(xyz=(x + 0.0, y + 0.0, z + 0.0), rpy=frame.rpy)


# --- Masses -----------------------------------------------------------------------------------------------------------


def mesh_solid(mesh: Mesh, density: float) -> Inertial:
    """A mesh of one density [kg/m³] as a body, in its own frame.

    Raises:
        TransformError: its file cannot be read, or encloses nothing.
        MissingDependencyError: a package that reads it is not installed.
    """
    if mesh.file is None:
        raise TransformError(f"the file of the mesh {shown(mesh.filename)} is not at hand")
    body = mesh_body(mesh.file, mesh.scale).solid
    return Inertial(mass=density * body.mass, com=body.com, inertia=scaled(body.inertia, density))


@lru_cache(maxsize=256)
def mesh_body(file: MeshFile, scale: Vec3) -> MeshBody:
    """The body of a mesh file, each axis scaled; a robot's variants share it.

    Raises:
        TransformError: the file cannot be read, or encloses nothing.
        MissingDependencyError: a package that reads it is not installed.
    """
    mesh = _read(file)
    mesh.vertices = mesh.vertices * scale
    size = 0.0 if mesh.extents is None else float(max(mesh.extents))
    is_closed = bool(mesh.is_watertight and mesh.is_winding_consistent)
    solid = _integrals(mesh.triangles, _middle(mesh.bounds)) if is_closed else None
    if solid is None or not abs(solid.mass) > _FLAT * size**3:
        is_closed, solid = False, _hull(mesh, size)
    if solid is None:
        raise TransformError(
            Problem(
                message=f"the mesh {shown(Path(file.path).name)} is flat, so that it weighs nothing",
                accepted="a mesh that encloses a volume, or mass, com and inertia in the table",
            )
        )
    return MeshBody(solid=solid, is_closed=is_closed, size=size)


def _read(file: MeshFile) -> Any:  # noqa: ANN401 - a module without type information
    """The triangles of a file as trimesh has them."""
    suffix = Path(file.path).suffix.lower()
    try:
        import trimesh
    except ImportError as error:
        raise _missing("trimesh") from error
    content = read_mesh(file)
    try:
        if b"<!ENTITY" in content:  # of a stranger: it could name any file, or become endless
            raise ValueError("it declares entities")
        mesh = trimesh.load_scene(io.BytesIO(content), file_type=suffix[1:]).to_mesh()
        if mesh.bounds is None:
            raise ValueError("it has no triangle whose corners are at finite places")
    except ImportError as error:
        raise _missing("pycollada") from error
    except (MissingDependencyError, MemoryError):
        raise
    except Exception as error:  # what readers of other people's files raise is anything
        reason = " ".join(str(error).split()) or type(error).__name__
        message = f"the mesh {shown(Path(file.path).name)} cannot be read as {suffix[1:].upper()}: {reason[:200]}"
        raise TransformError(Problem(message=message)) from error
    return mesh


def _missing(package: str) -> MissingDependencyError:
    return MissingDependencyError("transform 'alpha-swap', for the mass of a mesh,", package, "dh2urdf[meshes]")


def _hull(mesh: Any, size: float) -> Inertial | None:  # noqa: ANN401 - see `_read`
    """The body of the convex hull; None where all points lie in a plane."""
    try:
        from scipy.spatial import QhullError
    except ImportError as error:
        raise _missing("scipy") from error
    try:
        hull = mesh.convex_hull
    except (QhullError, ValueError):
        return None
    solid = _integrals(hull.triangles, _middle(hull.bounds))
    return solid if solid and solid.mass > _FLAT * size**3 else None


def _middle(bounds: Any) -> Any:  # noqa: ANN401 - arrays
    return 0.5 * (bounds[0] + bounds[1])


def _integrals(triangles: Any, middle: Any) -> Inertial | None:  # noqa: ANN401 - arrays (N, 3, 3) and (3,)
    """The body that triangles enclose, of 1 kg/m³; whether they are seen from inside or outside does not matter."""
    x, y, z = (tuple([triangles[:, corner, axis] - middle[axis] for corner in range(3)]) for axis in range(3))
    (ax, bx, cx), (ay, by, cy), (az, bz, cz) = x, y, z
    six = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    volume = _sum(six) / 6.0
    if not volume:
        return None
    way, mass = math.copysign(1.0, volume), abs(volume)
    com = [_sum(six * sum(corners)) / 24.0 / volume for corners in (x, y, z)]

    def moment(i: int, j: int) -> float:
        """The integral of the product of two coordinates about the centre of mass [m⁵]."""
        u, v = (x, y, z)[i], (x, y, z)[j]
        products = sum(u) * sum(v) + u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
        return way * _sum(six * products) / 120.0 - mass * com[i] * com[j]

    xx, yy, zz = (moment(axis, axis) for axis in range(3))
    body = Inertial(
        mass=mass,
        com=(com[0], com[1], com[2]),
        inertia=Inertia(ixx=yy + zz, iyy=xx + zz, izz=xx + yy, ixy=-moment(0, 1), ixz=-moment(0, 2), iyz=-moment(1, 2)),
    )
    to_mesh = RigidTransform(IDENTITY_ROTATION, tuple(map(float, middle)))  # type: ignore[arg-type]  # three of them
    return _without_rounding(placed(body, to_mesh))


def _without_rounding(body: Inertial) -> Inertial:
    """A body with 0 for what is nothing but the rounding of sums: the centre of a symmetric mesh is in its plane."""
    i, trace = body.inertia, body.inertia.ixx + body.inertia.iyy + body.inertia.izz
    gyration = math.sqrt(max(trace, 0.0) / body.mass)
    x, y, z = (0.0 if abs(number) <= _ROUNDING * gyration else number for number in body.com)
    xy, xz, yz = (0.0 if abs(number) <= _ROUNDING * trace else number for number in (i.ixy, i.ixz, i.iyz))
    return replace(body, com=(x, y, z), inertia=replace(i, ixy=xy, ixz=xz, iyz=yz))


def _sum(column: Any) -> float:  # noqa: ANN401 - an array
    return math.fsum(column.tolist())


# --- What is wrong ----------------------------------------------------------------------------------------------------


def mesh_problems(manipulator: Manipulator) -> list[Problem]:
    """What is wrong with the meshes of a table, and what a careful person would want to know of them.

    Raises:
        MissingDependencyError: a package that is needed for masses is not installed.
    """
    problems: list[Problem] = []
    if manipulator.base_visual:
        problems += _shape_problems(manipulator.base_visual, "base.visual", None, weighed=True)
    if manipulator.base_collision and manipulator.base_collision != manipulator.base_visual:
        problems += _shape_problems(manipulator.base_collision, "base.collision", None, weighed=False)
    for row in manipulator.rows:
        if row.visual:
            problems += _shape_problems(row.visual, "visual", row, weighed=not is_weighed(row))
        if row.collision and row.collision != row.visual:
            problems += _shape_problems(row.collision, "collision", row, weighed=False)
    return problems


def unplaced_meshes(manipulator: Manipulator) -> Iterator[Problem]:
    """Meshes stand in DH frames; the paper's chain has none."""
    message = "meshes stand in DH frames, which the paper's chain does not have; its boxes are drawn"
    if manipulator.base_visual or manipulator.base_collision:
        yield Problem(message=message, severity="notice", field="base")
    for row in manipulator.rows:
        if shape := row.visual or row.collision:
            mark = shape.mark or row.mark
            yield Problem(message=message, severity="notice", mark=mark, joint=row.joint, field="visual")


def is_weighed(row: DHRow) -> bool:
    """Whether a table says all that there is to say of the mass of a link."""
    return row.mass is not None and row.com is not None and row.inertia is not None


def _shape_problems(shape: MeshShape, field: str, row: DHRow | None, *, weighed: bool) -> Iterator[Problem]:
    name = shown(Path(shape.file.path).name)

    def problem(message: str, **more: Any) -> Problem:  # noqa: ANN401 - words of a problem
        joint, mark = (row.joint, row.mark) if row else (None, None)
        return Problem(message=message, mark=shape.mark or mark, joint=joint, field=field, **more)

    suffix = Path(shape.file.path).suffix.lower()
    if suffix not in FORMATS:
        yield problem(f"the mesh {name} is in no format that simulators share", found=suffix, accepted="STL, OBJ, DAE")
        return
    if not all(factor and math.isfinite(factor) for factor in shape.scale):
        found = ", ".join(f"{factor:.12g}" for factor in shape.scale)
        yield problem(f"the scale of the mesh {name} is {found}", found=found, accepted="factors that are not 0")
        return
    for message, suggestion in _remarks(shape.file):
        yield problem(f"the mesh {name} {message}", severity="notice", suggestion=suggestion)
    if not weighed:
        return
    try:
        body = mesh_body(shape.file, shape.scale)
    except TransformError as error:
        for why in error.problems:
            told = problem(why.message, accepted=why.accepted)
            yield replace(told, found=shape.file.path)
        return
    if not body.is_closed:
        yield problem(
            f"the mesh {name} is not closed: its mass is that of its convex hull",
            severity="notice",
            suggestion="give mass, com and inertia, or close the mesh",
        )
    if not SMALL < body.size < LARGE:
        yield problem(
            f"the mesh {name} is {body.size:.3g} m long",
            severity="notice",
            suggestion="if its numbers are in mm, give it the scale 0.001; if they are in m, the scale 1",
        )


@lru_cache(maxsize=256)
def _remarks(file: MeshFile) -> tuple[tuple[str, str], ...]:
    """What a file says that readers of robot descriptions take in different ways, each with what to do about it."""
    content = read_mesh(file)
    suffix = Path(file.path).suffix.lower()
    remarks = []
    if suffix == ".dae":
        head = content[:_HEAD]
        unit, up = _UNIT.search(head), _UP.search(head)
        if unit and _is_other_unit(unit[1]):
            said = unit[1].decode(errors="replace")[:20]
            remarks.append((f"says that its unit is {said} m", "in metres"))
        if up is None or up[1] != b"Z":
            axis = "y" if up is None else up[1].decode().lower()  # COLLADA 1.4, <up_axis>: Y_UP where it is not said
            remarks.append((f"says that {axis} points up", "with z up"))
    remarks = [
        (f"{message}, which some readers follow and others do not", f"export it {how}") for message, how in remarks
    ]
    if suffix in _OTHER_FILES and _OTHER_FILES[suffix].search(content):
        remarks.append(("names files of materials or textures, which are not copied with it", "give it plain colours"))
    return tuple(remarks)


def _is_other_unit(text: bytes) -> bool:
    try:
        return float(text) != 1.0
    except ValueError:
        return True
