"""The triangles of mesh files, in metres with z up, and the body that they enclose.

trimesh reads the files. A COLLADA file says which unit its numbers have and which axis points up; trimesh follows
neither, so both are followed here, as COLLADA 1.4.1 (chapter 5, `<asset>`) has them.

The integrals over a volume are sums over the tetrahedra between a point and the triangles, exactly as in S. Lien and
J. Kajiya, "A symbolic method for calculating the integral properties of arbitrary nonconvex polyhedra", IEEE Computer
Graphics and Applications 4 (1984). `math.fsum` adds them, so they are the same on every machine.
"""

from __future__ import annotations

import io
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.isolation.fence import refuse_without_wall
from dh2urdf.kinematics.mass import placed
from dh2urdf.manipulator import Inertia
from dh2urdf.robot import Inertial
from dh2urdf.rotations import IDENTITY_ROTATION, RigidTransform

if TYPE_CHECKING:
    from dh2urdf.meshes.addresses import NamedFiles

FORMATS = (".stl", ".obj", ".dae")  # how the names of mesh files end that can be read

_NEGLIGIBLE = 1e-12  # over the size of a body or the trace of its inertia
_TO_Z_UP = {"X_UP": ((0, -1, 0), (0, 0, -1), (1, 0, 0)), "Y_UP": ((1, 0, 0), (0, 0, -1), (0, 1, 0))}
_ZIP = b"PK\x03\x04"


class Asset(NamedTuple):
    """What a COLLADA file declares about its numbers."""

    unit: float = 1.0  # the unit of lengths [m]
    up: str = "Z_UP"  # the axis that points up: ``X_UP``, ``Y_UP``, also where the file does not say it, or ``Z_UP``


class Texture(NamedTuple):
    """A picture on triangles.

    The corners of the triangles are in the picture at `uv`, of shape (3 M, 2): (0, 0) is its lower left corner, and
    (1, 1) its upper right one. Beyond these the picture repeats.
    """

    uv: Any
    image: Any  # a Pillow image


class Part(NamedTuple):
    """The triangles of one colour or texture; where they have both, the texture is multiplied by the colour."""

    vertices: Any  # [m], of shape (N, 3)
    faces: Any  # numbers of vertices, of shape (M, 3), anticlockwise as seen from outside
    rgba: tuple[float, float, float, float] | None  # in 0..1; None where the file gives no colour
    texture: Texture | None = None  # none, too, where the files that a mesh names are not read


# --- Files ------------------------------------------------------------------------------------------------------------


def load_scene(content: bytes, suffix: str, *, process: bool, named: NamedFiles | None = None) -> Any:  # noqa: ANN401 - a module without type information
    """What is in a mesh file as a trimesh scene, in the file's own unit and axes.

    Where it is asked to process, trimesh merges vertices that are close, and drops those that are not finite. Files
    that the mesh file names are read by `named` alone. What a reader of other people's files raises is anything; a
    `ValueError` also says that the kernel offers no wall, and the user does not trust the file.
    """
    import trimesh

    refuse_without_wall()
    if content.startswith(_ZIP):
        raise ValueError("it is a ZIP archive: unpack it")
    if suffix == ".dae":
        _elements(content)  # Of a stranger: the parser of pycollada would follow what it declares.
    files: Any = named  # it has what trimesh calls of a resolver
    if suffix == ".dae" and not process:
        # The scene of a COLLADA file as it is: `trimesh.load_scene` merges its vertices whatever it is asked for.
        from trimesh.exchange import dae

        read: Any = dae  # its functions have no types
        loaded = read.load_collada(io.BytesIO(content), resolver=files)
        scene: Any = trimesh.Scene()
        for name, given in loaded["geometry"].items():
            scene.geometry[name] = trimesh.Trimesh(**given, process=False)
        for node in loaded["graph"]:
            scene.graph.update(frame_to=node["frame_to"], matrix=node["matrix"], geometry=node["geometry"])
        return scene
    return trimesh.load_scene(io.BytesIO(content), file_type=suffix[1:], process=process, resolver=files)


def asset_of(content: bytes, suffix: str) -> Asset:
    """What a file declares about its unit and its axes.

    STL and OBJ say nothing: metres with z up are meant. glTF has metres with y up.
    """
    if suffix in (".glb", ".gltf"):
        return Asset(up="Y_UP")
    if suffix != ".dae":
        return Asset()
    asset = _elements(content).find(".//{*}asset")
    if asset is None:
        return Asset(up="Y_UP")
    unit = asset.find("{*}unit")
    text = "1" if unit is None else unit.get("meter", "1")
    try:
        length = float(text)
    except ValueError:
        length = math.nan
    if not 0.0 < length < math.inf:
        raise ValueError(f"its unit is {text[:20]!r} m")
    return Asset(length, asset.findtext("{*}up_axis", "Y_UP").strip())


def _elements(content: bytes) -> Any:  # noqa: ANN401 - an element of lxml
    """The outermost element of a COLLADA file."""
    from dh2urdf.documents.xml_elements import xml_root

    try:
        return xml_root(content)
    except SyntaxError as error:  # those of lxml are
        raise ValueError(error.msg) from error


def to_metres(asset: Asset) -> Any:  # noqa: ANN401 - an array
    """The homogeneous matrix from a file's unit and axes to metres with z up."""
    import numpy as np

    if asset.up not in {"Z_UP", *_TO_Z_UP}:
        raise ValueError(f"its up_axis is {asset.up[:20]!r}")
    matrix = np.eye(4)
    matrix[:3, :3] = asset.unit * np.array(_TO_Z_UP.get(asset.up, np.eye(3)))
    return matrix


def read_parts(
    content: bytes,
    suffix: str,
    scale: tuple[float, float, float],
    *,
    as_in_ros: bool = False,
    named: NamedFiles | None = None,
) -> list[Part]:
    """All triangles of a file, scaled, by their colours and textures in the order of their first appearance.

    Nothing is merged, moved or left out. Where the scale or a node of the file is a mirror, triangles are turned
    round, so that outside stays outside. Without triangles, or with a corner that is not finite, it is a `ValueError`.

    Args:
        content: the file.
        suffix: one of `FORMATS`.
        scale: factors along the axes of the mesh.
        as_in_ros: whether the axis up of a COLLADA file is taken for z whatever the file says: so do RViz and MoveIt,
            and makers' descriptions are drawn for them.
        named: as in `load_scene`.
    """
    import numpy as np

    scene = load_scene(content, suffix, process=False, named=named)
    asset = asset_of(content, suffix)
    if as_in_ros and suffix == ".dae":
        asset = asset._replace(up="Z_UP")
    outer = np.diag([*scale, 1.0]) @ to_metres(asset)
    found: dict[tuple[tuple[float, ...] | None, int], list[tuple[Any, Any, Texture | None]]] = {}
    for matrix, mesh in (
        (scene.graph[node][0], scene.geometry[scene.graph[node][1]]) for node in scene.graph.nodes_geometry
    ):
        if not len(getattr(mesh, "faces", ())):
            continue
        whole = outer @ matrix
        x, y, z = np.asarray(mesh.vertices).T
        vertices = np.column_stack([a * x + b * y + c * z + d for a, b, c, d in whole[:3]])
        if not np.isfinite(vertices).all() and not np.isfinite(vertices[mesh.faces]).all():
            raise ValueError("corners of its triangles are at no finite place")
        faces = mesh.faces[:, ::-1] if np.linalg.det(whole[:3, :3]) < 0.0 else mesh.faces
        texture = _texture(mesh, faces) if named else None
        look = _colour(mesh), id(texture.image) if texture else 0
        found.setdefault(look, []).append((vertices, faces, texture))
    if not found:
        raise ValueError("it has no triangles")
    parts = []
    for (rgba, _), pieces in found.items():  # of each, all have the same picture, or all have none
        textures = [texture for _, _, texture in pieces if texture is not None]
        uv = np.concatenate([texture.uv for texture in textures]) if textures else None
        parts.append(Part(*_joined(pieces), rgba, Texture(uv, textures[0].image) if textures else None))  # type: ignore[arg-type]  # four numbers
    return parts


def _colour(mesh: Any) -> tuple[float, ...] | None:  # noqa: ANN401 - see `load_scene`
    """The colour of a mesh that has a plain one: of COLLADA and glTF, or the diffuse one of an MTL."""
    material = getattr(mesh.visual, "material", None)
    factor = getattr(material, "baseColorFactor", None)
    if factor is None and "kd" in getattr(material, "kwargs", ()):
        factor = getattr(material, "diffuse", None)
    if factor is None:
        return None
    red, green, blue, alpha = (round(float(part) / 255.0, 6) for part in factor)
    return (red, green, blue, alpha or 1.0)  # COLLADA knows two meanings of 0; nobody draws what cannot be seen


def _texture(mesh: Any, faces: Any) -> Texture | None:  # noqa: ANN401 - see `load_scene`
    """The picture on a mesh, with a place in it for each corner."""
    import numpy as np
    from trimesh.visual import material as materials

    material, uv = getattr(mesh.visual, "material", None), getattr(mesh.visual, "uv", None)
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    if image is None or uv is None or len(uv) != len(mesh.vertices) or not np.isfinite(uv).all():
        return None
    made: Any = materials  # its functions have no types
    # The grey square that trimesh puts on a mesh whose MTL file is not there, or lacks its material.
    return None if image == made.empty_material().image else Texture(uv[faces].reshape(-1, 2), image)


def _joined(pieces: list[tuple[Any, Any, Texture | None]]) -> tuple[Any, Any]:
    """Meshes as one, vertices at the same place merged, in the order of the file."""
    import numpy as np

    # Plain arrays: those of trimesh note each access.
    plain = [(np.asarray(vertices), np.asarray(faces)) for vertices, faces, _ in pieces]
    corners = np.concatenate([vertices[faces] for vertices, faces in plain]).reshape(-1, 3) + 0.0
    _, first, which = np.unique(corners, axis=0, return_index=True, return_inverse=True)
    way = np.argsort(first)
    rank = np.empty_like(way)
    rank[way] = np.arange(len(way))
    return corners[first[way]], rank[which.reshape(-1)].reshape(-1, 3)


# --- Bodies -----------------------------------------------------------------------------------------------------------


def enclosed(triangles: Any, middle: Any) -> Inertial | None:  # noqa: ANN401 - arrays (N, 3, 3) and (3,)
    """The body that triangles enclose, of 1 kg/m³; None where they enclose nothing.

    Whether they are seen from inside or outside does not matter. Corners [m] have the shape (N, 3, 3). The closer the
    middle is to their midst, the less rounding there is.
    """

    def total(column: Any) -> float:  # noqa: ANN401 - an array
        return math.fsum(column.tolist())

    x, y, z = (tuple([triangles[:, corner, axis] - middle[axis] for corner in range(3)]) for axis in range(3))
    (ax, bx, cx), (ay, by, cy), (az, bz, cz) = x, y, z
    six = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    volume = total(six) / 6.0
    if not volume:
        return None
    way, mass = math.copysign(1.0, volume), abs(volume)
    com = [total(six * sum(corners)) / 24.0 / volume for corners in (x, y, z)]

    def moment(i: int, j: int) -> float:
        """The integral of the product of two coordinates about the centre of mass [m⁵]."""
        u, v = (x, y, z)[i], (x, y, z)[j]
        products = sum(u) * sum(v) + u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
        return way * total(six * products) / 120.0 - mass * com[i] * com[j]

    xx, yy, zz = (moment(axis, axis) for axis in range(3))
    body = Inertial(
        mass=mass,
        com=(com[0], com[1], com[2]),
        inertia=Inertia(ixx=yy + zz, iyy=xx + zz, izz=xx + yy, ixy=-moment(0, 1), ixz=-moment(0, 2), iyz=-moment(1, 2)),
    )
    to_mesh = RigidTransform(IDENTITY_ROTATION, tuple(map(float, middle)))  # type: ignore[arg-type]  # three of them
    body = placed(body, to_mesh)
    # 0 for what is nothing but the rounding of sums: the centre of a symmetric mesh is in its plane.
    i, trace = body.inertia, body.inertia.ixx + body.inertia.iyy + body.inertia.izz
    gyration = math.sqrt(max(trace, 0.0) / body.mass)
    cx, cy, cz = (0.0 if abs(number) <= _NEGLIGIBLE * gyration else number for number in body.com)
    xy, xz, yz = (0.0 if abs(number) <= _NEGLIGIBLE * trace else number for number in (i.ixy, i.ixz, i.iyz))
    return replace(body, com=(cx, cy, cz), inertia=replace(i, ixy=xy, ixz=xz, iyz=yz))
