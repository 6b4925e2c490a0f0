"""What is taken along of a scene: a binary glTF file of its robots, and a turn about the arm as an animated GIF."""

from __future__ import annotations

import base64
import binascii
import io
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import OutputError, pip_install
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.rotations import IDENTITY
from dh2urdf.source import Messages
from dh2urdf_studio.drawing.mesh_files import creased, surfaces
from dh2urdf_studio.drawing.scene import from_root

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from dh2urdf_studio.drawing.mesh_files import DrawnMesh, Surface
    from dh2urdf_studio.drawing.parts import ScenePart
    from dh2urdf_studio.drawing.scene import Drawing

say = Messages(__file__)

FRAMES = 36  # frames of a turn
LARGEST = 640  # the longer side of a frame [px]
_SHOWN = 80  # for this long [ms]
_SIDES = 32
_ARROW = ((0.0, 0.0), (0.035, 0.0), (0.035, 0.76), (0.095, 0.76), (0.0, 1.0))  # radius and height
_ARROWS = (
    ((0.94, 0.08, 0.08), (0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0)),
    ((0.05, 0.65, 0.14), (0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)),
    ((0.08, 0.31, 1.0), IDENTITY.rotation),
)
"""The axes x, y and z of a frame: their colours, and the rotations that turn z there."""
_Y_UP = ((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, -1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
"""z points up here, y in glTF."""


def glb(drawing: Drawing, q: Mapping[str, float], layers: Collection[str], name: str) -> bytes:
    """The robots of a drawing as a binary glTF, written by trimesh.

    Every link is a node with its name, and a child of the link that holds it: the product of the matrices from the
    root's child to a link is the forward kinematics. The root turns z up into y up.
    """
    import numpy as np
    import trimesh

    scene: Any = trimesh.Scene(base_frame=f"{name} (z up)")  # its methods have no types
    pieces = _Pieces()
    scene.graph.update(frame_to=name, frame_from=scene.graph.base_frame, matrix=np.array(_Y_UP))
    matrices = {node.name: as_matrices(pose) for node, pose in zip(drawing.nodes, drawing.poses(q), strict=True)}
    links = ((figure.name, *each) for figure in drawing.figures for each in from_root(figure.robot))
    holders = {before + link.name: before + holder if holder else "" for before, link, holder in links}
    nodes = {node.name: node for node in drawing.nodes}
    # What holds comes first; the rest, DH frames for one, is held by nothing.
    for each in [*holders, *(node for node in nodes if node not in holders)]:
        parts = [part for part in nodes[each].parts if part.layer in layers]
        holder = holders.get(each)
        if holder is None and not parts:
            continue
        own = np.linalg.inv(matrices[holder]) @ matrices[each] if holder else matrices[each]
        scene.graph.update(frame_to=each, frame_from=holder or name, matrix=own)
        for number, (mesh, matrix) in enumerate(found for part in parts for found in pieces.of(part)):
            scene.geometry.setdefault(mesh, pieces.meshes[mesh])
            scene.graph.update(frame_to=f"{each} body {number}", frame_from=each, matrix=matrix, geometry=mesh)
    if not scene.geometry:
        raise OutputError(say("nothing-shown"))
    return bytes(scene.export(file_type="glb", include_normals=True))


class _Pieces:
    """The meshes of parts with their colours, each made once, by name."""

    def __init__(self) -> None:
        from trimesh import creation

        shapes: Any = creation  # its functions have no types
        plain = {
            "box": shapes.box(),
            "cylinder": shapes.cylinder(1.0, 1.0, sections=_SIDES),
            "sphere": shapes.icosphere(3),
            "frame": shapes.revolve(_ARROW, sections=_SIDES),
        }
        self._surfaces: dict[str | DrawnMesh, list[tuple[Any, Surface]]] = {
            shape: [(None, creased(mesh.vertices, mesh.faces))] for shape, mesh in plain.items()
        }
        self.meshes: dict[str, Any] = {}

    def of(self, part: ScenePart) -> Iterator[tuple[str, Any]]:
        """The names of the meshes of a part, each with its matrix in the part's node."""
        import numpy as np

        matrix, size = as_matrices(part.pose), part.size
        if part.mesh is not None:
            if part.mesh not in self._surfaces:
                self._surfaces[part.mesh] = list(surfaces(part.mesh))
            for number, (own, surface) in enumerate(self._surfaces[part.mesh]):
                rgba = own or (1.0, 1.0, 1.0, 1.0)
                if not (part.own_colours and (own or surface.texture)):
                    surface, rgba = surface._replace(uv=None, texture=None), (*part.colour, 1.0)  # noqa: PLW2901 - bare
                yield self._mesh(f"{part.mesh.key} {number}", surface, (*rgba[:3], rgba[3] * part.opacity)), matrix
            return
        ((_, surface),) = self._surfaces[part.shape]
        if part.shape == "frame":
            for colour, turn in _ARROWS:
                pointing = matrix.copy()
                pointing[:3, :3] = size[0] * matrix[:3, :3] @ np.reshape(turn, (3, 3))
                yield self._mesh(part.shape, surface, (*colour, part.opacity)), pointing
            return
        sides = (size[0], size[0], size[1]) if part.shape == "cylinder" else size
        matrix[:3, :3] *= sides if len(sides) > 1 else sides[0]
        yield self._mesh(part.shape, surface, (*part.colour, part.opacity)), matrix

    def _mesh(self, what: str, surface: Surface, rgba: Sequence[float]) -> str:
        import trimesh

        texture = surface.texture
        name = f"{what} {' '.join(f'{part:.3f}' for part in rgba)}{' textured' if texture else ''}"
        if name not in self.meshes:
            linear = [*(_linear(part) for part in rgba[:3]), rgba[3]]
            look: dict[str, Any] = {"baseColorFactor": linear, "metallicFactor": 0.0, "roughnessFactor": 0.7}
            look["alphaMode"] = "BLEND" if rgba[3] < 1.0 else "OPAQUE"
            if texture is not None:
                from PIL import Image

                look["baseColorTexture"] = Image.open(io.BytesIO(texture.content))
            module: Any = trimesh.visual  # its functions have no types
            visual = module.TextureVisuals(uv=surface.uv, material=module.material.PBRMaterial(**look))
            self.meshes[name] = trimesh.Trimesh(
                surface.positions, surface.faces, vertex_normals=surface.normals, visual=visual, process=False
            )
        return name


def _linear(part: float) -> float:
    """A part of a colour of sRGB, in which URDFs have them, in the linear space of glTF (IEC 61966-2-1)."""
    part = min(max(part, 0.0), 1.0)
    return part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4  # noqa: PLR2004 - the standard's


def gif(frames: Sequence[str]) -> bytes:
    """An endless animation of pictures of one size, which the page sends as PNGs in data addresses.

    A GIF and no WebM: a browser records a WebM in real time, so that a slow graphics card drops frames.
    """
    try:
        from PIL import Image
    except ImportError as error:
        raise OutputError(say("pillow-missing", command=pip_install("dh2urdf[studio]"))) from error
    pictures: list[Image.Image] = []
    for frame in frames:
        try:
            content = base64.b64decode(frame.removeprefix("data:image/png;base64,"), validate=True)
            opened = Image.open(io.BytesIO(content), formats=["PNG"])
            if max(opened.size) > LARGEST or (pictures and opened.size != pictures[0].size):
                raise ValueError(f"its size is {opened.size}")
            pictures.append(opened.convert("RGB"))
        except (binascii.Error, OSError, ValueError, Image.DecompressionBombError) as error:
            raise OutputError(say("frame-no-picture", number=len(pictures) + 1, reason=error)) from error
    width, height = pictures[0].size
    samples = pictures[:: max(1, len(pictures) // 6)]
    sheet = Image.new("RGB", (width, height * len(samples)))
    for number, picture in enumerate(samples):
        sheet.paste(picture, (0, height * number))
    palette = sheet.quantize(256, method=Image.Quantize.MEDIANCUT)  # one for all: colours do not flicker
    first, *others = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    written = io.BytesIO()
    first.save(written, "GIF", save_all=True, append_images=others, duration=_SHOWN, loop=0, optimize=False)
    return written.getvalue()
