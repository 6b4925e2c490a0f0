"""The robots of a scene at a pose as a binary glTF file: links as nested nodes, with what is drawn of them.

The file is written here and not by trimesh, which the extra `studio` does without: only mesh files need it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.rotations import IDENTITY
from dh2urdf_studio.drawing.colours import WHITE
from dh2urdf_studio.drawing.glb_file import GlbFile
from dh2urdf_studio.drawing.mesh_files import surfaces
from dh2urdf_studio.drawing.solids import ARROW, CYLINDER, SPHERE, Surface, box, turned

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping

    from dh2urdf_studio.drawing.mesh_files import DrawnMesh
    from dh2urdf_studio.drawing.parts import ScenePart
    from dh2urdf_studio.drawing.scene import Drawing, Figure

_ARROWS = (
    ((0.94, 0.08, 0.08), (0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0)),
    ((0.05, 0.65, 0.14), (0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)),
    ((0.08, 0.31, 1.0), IDENTITY.rotation),
)
"""The axes x, y and z of a frame: their colours, and the rotations that turn z there."""


def glb(drawing: Drawing, q: Mapping[str, float], layers: Collection[str], name: str) -> bytes:
    """The robots of a drawing as a binary glTF.

    Every link is a node with its name, and a child of the link that holds it: the product of the matrices from the
    root's child to a link is the forward kinematics. The root turns z up into y up.

    Args:
        drawing: the robots.
        q: joint values by name, as `Drawing.poses` takes them [rad or m].
        layers: of which layers parts are written, keys of `LAYERS`.
        name: name of the root.

    Raises:
        OutputError: a mesh file cannot be read.
    """
    import numpy as np

    file, shapes = GlbFile(name), _PartMeshes()
    places = [as_matrices(pose) for pose in drawing.poses(q)]
    matrices = {node.name: place for node, place in zip(drawing.nodes, places, strict=True)}
    holders = {child: holder for figure in drawing.figures for child, holder in _held(figure)}
    nodes = {node.name: node for node in drawing.nodes}
    numbers = {"": GlbFile.ROOT}
    # What holds comes first; the rest, DH frames for one, is held by nothing.
    for each in [*holders, *(name for name in nodes if name not in holders)]:
        parts = [part for part in nodes[each].parts if part.layer in layers]
        holder = holders.get(each)
        if holder is None and not parts:
            continue
        own = np.linalg.inv(matrices[holder]) @ matrices[each] if holder else matrices[each]
        numbers[each] = file.add_node(numbers[holder or ""], each, own)
        for part in parts:
            for mesh, matrix in shapes.of(part, file):
                file.add_node(numbers[each], part.layer, matrix, mesh)
    return file.content()


def _held(figure: Figure) -> Iterator[tuple[str, str]]:
    """The links of a robot that the root holds, after the ones that hold them, with their names; "" holds the root."""
    robot, before = figure.robot, figure.name
    children = {joint.child for joint in robot.joints}
    waiting = [link.name for link in robot.links if link.name not in children]
    seen = set(waiting)
    yield from ((before + root, "") for root in waiting)
    while waiting:
        holder = waiting.pop()
        for joint in robot.joints:
            if joint.parent == holder and joint.child not in seen:
                seen.add(joint.child)
                waiting.append(joint.child)
                yield before + joint.child, before + holder


class _PartMeshes:
    """The surfaces of parts, each computed once."""

    def __init__(self) -> None:
        self._plain = {
            "box": box(),
            "cylinder": turned(CYLINDER),
            "sphere": turned(SPHERE, is_round=True),
            "frame": turned(ARROW),
        }
        self._of_files: dict[DrawnMesh, tuple[tuple[tuple[float, float, float, float] | None, Surface], ...]] = {}

    def of(self, part: ScenePart, file: GlbFile) -> Iterator[tuple[int, Any]]:
        """The meshes of a part in a file, each with its matrix in the part's node."""
        import numpy as np

        matrix, opacity = as_matrices(part.pose), part.opacity
        if part.mesh is not None:
            if part.mesh not in self._of_files:
                self._of_files[part.mesh] = tuple(surfaces(part.mesh))
            pieces = []
            for number, (own, surface) in enumerate(self._of_files[part.mesh]):
                key = part.mesh, number
                if not (part.own_colours and (own or surface.texture)):
                    pieces.append((key, surface._replace(uv=None, texture=None), (*part.colour, opacity)))
                    continue
                red, green, blue, alpha = own or (*WHITE, 1.0)
                pieces.append((key, surface, (red, green, blue, alpha * opacity)))
            yield file.mesh(pieces), matrix
            return
        surface = self._plain[part.shape]
        if part.shape == "frame":
            for colour, turn in _ARROWS:
                pointing = matrix.copy()
                pointing[:3, :3] = part.size[0] * matrix[:3, :3] @ np.reshape(turn, (3, 3))
                yield file.mesh([(part.shape, surface, (*colour, opacity))]), pointing
            return
        radius = part.size[0]
        sides = (radius, radius, part.size[1]) if part.shape == "cylinder" else part.size
        matrix[:3, :3] *= sides if len(sides) > 1 else radius
        yield file.mesh([(part.shape, surface, (*part.colour, opacity))]), matrix
