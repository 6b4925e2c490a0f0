"""Links whose shapes are mesh files: where they stand, what they weigh, and what is wrong with them.

A mesh is given in the DH frame after its row, so that it stands where it was drawn whichever frames the links get. Its
mass properties are those of the volume that its triangles enclose; of a mesh that is not closed, and so encloses none,
those of its convex hull. trimesh reads the files and finds hulls; it is asked where the table leaves something open.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.errors import MissingDependencyError, TransformError
from dh2urdf.kinematics.mass import scaled
from dh2urdf.meshes import FORMATS, REMEDY, Asset, asset_of, enclosed, file_address, load_scene, read_mesh, to_metres
from dh2urdf.robot import Inertial, Mesh, Origin
from dh2urdf.source import Messages, Problem
from dh2urdf_plugins.transforms.checks import is_weighed

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.manipulator import DHRow, Manipulator, MeshFile, MeshShape
    from dh2urdf.rotations import RigidTransform, Vec3

say = Messages(__file__)

LARGE, SMALL = 10.0, 1e-3
"""Sizes of a mesh at which a careful person would look at its scale [m]."""
_FLAT = 1e-12  # volume over the cube of the size: below, it is rounding
_OTHER_FILES = {".obj": re.compile(rb"^\s*mtllib\s", re.MULTILINE), ".dae": re.compile(rb"<init_from>[^<]*\.\w+\s*<")}


def placed_mesh(shape: MeshShape, dh_frame: RigidTransform) -> dict[str, Any]:
    """A mesh, and its origin in the link's frame: numbers, also where the link follows parameters."""
    frame = dh_frame @ shape.pose
    x, y, z = frame.translation
    mesh = Mesh(filename=file_address(shape.file.path), scale=shape.scale, file=shape.file)
    return {"geometry": mesh, "origin": Origin(xyz=(x + 0.0, y + 0.0, z + 0.0), rpy=frame.rpy)}


# --- Masses -----------------------------------------------------------------------------------------------------------


class MeshBody(NamedTuple):
    """A mesh as a solid body of 1 kg/m³, in the frame of the mesh."""

    solid: Inertial  # its mass properties
    is_closed: bool  # whether they are those of the mesh itself, not of its convex hull
    size: float  # the longest edge of the box around it [m]


def mesh_solid(mesh: Mesh, density: float) -> Inertial:
    """A mesh of one density [kg/m³] as a body, in its own frame.

    Raises:
        TransformError: its file cannot be read, or encloses nothing.
        MissingDependencyError: a package that reads it is not installed.
    """
    if mesh.file is None:
        raise TransformError(say("mesh-not-at-hand", mesh=mesh.filename))
    body = mesh_body(mesh.file, mesh.scale).solid
    return Inertial(mass=density * body.mass, com=body.com, inertia=scaled(body.inertia, density))


@lru_cache(maxsize=256)
def mesh_body(file: MeshFile, scale: Vec3) -> MeshBody:
    """The body of a mesh file, each axis scaled; a robot's variants share it.

    Raises:
        TransformError: the file cannot be read, or encloses nothing.
        MissingDependencyError: a package that reads it is not installed.
    """
    try:
        import trimesh  # noqa: F401 - here it is known what is missing
        from scipy.spatial import QhullError
    except ImportError as error:
        raise _missing(error.name or "trimesh", error) from error
    mesh = _read(file)
    mesh.vertices = mesh.vertices * scale
    size = 0.0 if mesh.extents is None else float(max(mesh.extents))

    def solid_of(one: Any) -> Inertial | None:  # noqa: ANN401 - a mesh, see `_read`
        solid = enclosed(one.triangles, 0.5 * (one.bounds[0] + one.bounds[1]))
        return solid if solid is not None and abs(solid.mass) > _FLAT * size**3 else None

    for _ in range(2):
        if mesh.is_watertight and mesh.is_winding_consistent and (solid := solid_of(mesh)):
            return MeshBody(solid, is_closed=True, size=size)
        # A file with several colours, or with hard edges, has a corner several times.
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
    try:
        solid = solid_of(mesh.convex_hull)
    except (QhullError, ValueError):  # all points lie in a plane
        solid = None
    if solid is None:
        raise TransformError(say("mesh-flat", name=Path(file.path).name))
    return MeshBody(solid, is_closed=False, size=size)


def _read(file: MeshFile) -> Any:  # noqa: ANN401 - a module without type information
    """The triangles of a file as trimesh has them."""
    suffix, content = Path(file.path).suffix.lower(), read_mesh(file)
    try:
        mesh = load_scene(content, suffix, process=True).to_mesh()
        if mesh.bounds is None:
            raise ValueError("it has no triangle whose corners are at finite places")
        if (asset := asset_of(content, suffix)) != Asset():
            mesh.apply_transform(to_metres(asset))
    except ImportError as error:
        raise _missing("pycollada", error) from error
    except (MissingDependencyError, MemoryError):
        raise
    except Exception as error:  # what readers of other people's files raise is anything
        reason = " ".join(str(error).split()) or type(error).__name__
        code, name, form = "mesh-unreadable", Path(file.path).name, suffix[1:].upper()
        raise TransformError(say(code, name=name, format=form, reason=reason[:200])) from error
    return mesh


def _missing(package: str, error: ImportError) -> MissingDependencyError:
    package = package.partition(".")[0]
    return MissingDependencyError("transform 'alpha-swap', for the mass of a mesh,", package, "dh2urdf[meshes]", error)


# --- What is wrong ----------------------------------------------------------------------------------------------------


def mesh_problems(manipulator: Manipulator) -> list[Problem]:
    """What is wrong with the meshes of a table, and what a careful person would want to know of them."""
    problems: list[Problem] = []
    for row in (None, *manipulator.rows):
        of = "base." if row is None else ""
        visual = manipulator.base_visual if row is None else row.visual
        collision = manipulator.base_collision if row is None else row.collision
        if visual:
            problems += _shape_problems(visual, f"{of}visual", row, weighed=row is None or not is_weighed(row))
        if collision and collision != visual:
            problems += _shape_problems(collision, f"{of}collision", row, weighed=False)
    return problems


def unplaced_meshes(manipulator: Manipulator) -> Iterator[Problem]:
    """Meshes are in DH frames; the paper's chain has none."""
    if manipulator.base_visual or manipulator.base_collision:
        yield say("paper-meshes", field="base")
    for row in manipulator.rows:
        if shape := row.visual or row.collision:
            yield say("paper-meshes", shape.mark or row.mark, joint=row.joint, field="visual")


def _shape_problems(shape: MeshShape, field: str, row: DHRow | None, *, weighed: bool) -> Iterator[Problem]:
    path = Path(shape.file.path)
    name, suffix = path.name, path.suffix.lower()

    joint, place = (row.joint, shape.mark or row.mark) if row else (None, shape.mark)

    def problem(code: str, **more: Any) -> Problem:  # noqa: ANN401 - of a message
        return say(code, place, joint=joint, field=field, name=name, **more)

    if suffix not in FORMATS:
        yield problem("mesh-format-unshared", found=suffix)
        return
    if not all(factor and math.isfinite(factor) for factor in shape.scale):
        found = ", ".join(f"{factor:.12g}" for factor in shape.scale)
        yield problem("mesh-scale-wrong", found=found)
        return
    for code, about in _remarks(shape.file):
        yield problem(code, **about)
    if not weighed:
        return
    try:
        body = mesh_body(shape.file, shape.scale)
    except TransformError as error:
        for why in error.problems:
            yield replace(why, mark=place, joint=joint, field=field, found=shape.file.path)
        return
    if not body.is_closed:
        yield problem("mesh-open")
    if not SMALL < body.size < LARGE:
        yield problem("mesh-size-odd", size=body.size)


@lru_cache(maxsize=256)
def _remarks(file: MeshFile) -> tuple[tuple[str, dict[str, str]], ...]:
    """What a file says that readers of robot descriptions take in different ways: the codes, and what they name."""
    content, suffix = read_mesh(file), Path(file.path).suffix.lower()
    try:
        asset = asset_of(content, suffix)
    except ValueError:  # It is no COLLADA; its reader reports that.
        return ()
    remarks: list[tuple[str, dict[str, str]]] = []
    if asset.unit != 1.0:
        remarks.append(("mesh-of-own-unit", {"unit": f"{asset.unit:.6g}", "remedy": REMEDY}))
    if asset.up != "Z_UP":
        remarks.append(("mesh-of-own-up", {"axis": asset.up[:1].lower(), "remedy": REMEDY}))
    if suffix in _OTHER_FILES and _OTHER_FILES[suffix].search(content):
        remarks.append(("mesh-names-files", {}))
    return tuple(remarks)
