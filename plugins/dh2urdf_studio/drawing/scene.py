"""What is to be drawn: links, joint axes and frames as nodes with parts, and where the nodes are at q.

A node is a rigid thing with a name; its parts never move in it. So what a browser needs once is a `Drawing`, and what
it needs while joints move is a pose for every node. The poses come from `dh2urdf.kinematics`: links from the robot,
DH frames from the table, by different code, so that the screen itself would show the one off the other.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.kinematics.chain import dh_frames, link_poses
from dh2urdf.manipulator import FLANGE, TOOL, WORLD, JointType, Manipulator
from dh2urdf.robot import Box, Cylinder, Joint, Mesh, Robot, Sphere
from dh2urdf.rotations import IDENTITY, RigidTransform, norm, scale
from dh2urdf.source import Problem
from dh2urdf.table_text import TableText
from dh2urdf_studio.drawing.mesh_files import SUFFIXES, DrawnMesh
from dh2urdf_studio.drawing.parts import (
    APART,
    AXIS_COLOURS,
    COLLISION,
    GREY,
    Colour,
    Grip,
    SceneNode,
    ScenePart,
    grips,
    mass_parts,
    towards,
)
from dh2urdf_studio.drawing.strokes import Stroke, robot_normals, strokes, table_normals
from dh2urdf_studio.page_data import PAGE

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.robot import Geometry, Link

LAYERS: dict[str, str] = PAGE["layers"]  # what can be shown and hidden, and what a person calls it

FRAME_SIZE = 0.08  # length of a frame's arrows in reaches of the arm
CENTRE_SIZE = 0.012  # radius of the ball at a centre of mass in reaches
REACH_OF_A_POINT = 0.5  # reach that an arm of no size is drawn with [m]
DECIMALS = 9  # of a length [m] that a browser gets
_AXIS_LENGTH = 2.6


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """One robot in the scene."""

    robot: Robot
    manipulator: Manipulator | None = None  # its table, where it has one
    typed: TableText | None = None  # the table as it was typed, whose texts and units are at its parameters
    name: str = ""  # what stands before the names of its nodes
    place: RigidTransform = IDENTITY  # of its root
    tint: Colour | None = None  # in place of its own ones
    plain: Colour = GREY  # of links that have none
    opacity: float = 1.0  # less than 1 for a robot that is looked through, to see another one at its place
    title: str = ""  # at its root
    link_frames: bool = (
        True  # whether frames of its links are shown: of all where it has no table, else flange and tool0
    )
    files: Mapping[str, Path] = field(default_factory=dict)  # that the addresses of its meshes mean
    as_in_ros: bool = True  # whether the axis up of COLLADA files is not followed: see `dh2urdf.meshes.read_parts`
    loose: Mapping[str, str] = field(
        default_factory=dict
    )  # types that no table has of joints, which are fixed in the robot
    notices: tuple[Problem, ...] = ()  # what is in its file and could not be read

    @property
    def tool(self) -> str:
        """The link that goes where a person wants it: tool0, or the tip of what is attached."""
        return (TOOL, *self.robot.tips)[-1]


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """A scene without its poses."""

    figures: tuple[Figure, ...] = ()
    nodes: tuple[SceneNode, ...] = ()  # everything that has a pose
    reach: float = 1.0  # of the largest robot [m]
    unseen: tuple[str, ...] = ()  # the meshes that have no file, or none that can be drawn

    @classmethod
    def of(cls, figures: Sequence[Figure]) -> Drawing:
        """The drawing of some robots."""
        size = max((extent(figure.robot) for figure in figures), default=1.0)
        size = size if size > 1 / 10**DECIMALS else REACH_OF_A_POINT
        nodes = tuple(node for figure in figures for node in _nodes(figure, size))
        meshes = ((mesh, figure) for figure in figures for mesh in meshes_of(figure.robot))
        unseen = dict.fromkeys(mesh.filename for mesh, figure in meshes if _file_of(mesh, figure) is None)
        return cls(figures=tuple(figures), nodes=nodes, reach=size, unseen=tuple(unseen))

    @property
    def meshes(self) -> dict[str, DrawnMesh]:
        """The mesh files that are drawn, by what a page asks for them by."""
        parts = (part for node in self.nodes for part in node.parts)
        return {part.mesh.key: part.mesh for part in parts if part.mesh is not None}

    @property
    def grips(self) -> dict[str, Grip]:
        """How links can be dragged, by the names of their nodes."""
        return {node.name: node.grip for node in self.nodes if node.grip is not None}

    @property
    def first_meshes(self) -> tuple[str, ...]:
        """The keys of the mesh files that links show, in the order of the links: collision shapes come on request."""
        parts = (part for node in self.nodes for part in node.parts if part.layer == "links")
        return tuple(dict.fromkeys(part.mesh.key for part in parts if part.mesh is not None))

    def poses(self, q: Mapping[str, float]) -> tuple[RigidTransform, ...]:
        """Where the nodes are, in their order, at joint values by name, a figure's name before it [rad or m]."""
        found: list[RigidTransform] = []
        for figure in self.figures:
            own, table = _own_values(figure, q), figure.manipulator
            links = link_poses(figure.robot, own)
            frames = [links.get(link.name, IDENTITY) for link in figure.robot.links]
            frames += dh_frames(table, [own[row.joint] for row in table.actuated_rows]) if table else ()
            found += [figure.place @ frame for frame in frames]
        return tuple(found)

    def strokes(self, q: Mapping[str, float]) -> tuple[Stroke, ...]:
        """The DH parameters of the figures that have a table, where they are at q."""
        found: list[Stroke] = []
        for figure in self.figures:
            if figure.manipulator is not None:
                own, radius = _own_values(figure, q), 0.8 * FRAME_SIZE * self.reach
                found += strokes(figure.manipulator, own, place=figure.place, radius=radius, typed=figure.typed)
        return tuple(found)

    def normals(self, q: Mapping[str, float], only: int | None = None) -> tuple[Stroke, ...]:
        """The joint axes and their common normals at q; of tables of one row alone, where its number is given."""
        found: list[Stroke] = []
        for figure in self.figures:
            own, place, table = _own_values(figure, q), figure.place, figure.manipulator
            if table is None:
                found += robot_normals(figure.robot, own, place=place, reach=self.reach)
            else:
                found += table_normals(table, own, place=place, reach=self.reach, typed=figure.typed, only=only)
        return tuple(found)

    def as_json(self) -> dict[str, Any]:
        """The drawing as a browser takes it."""
        nodes = []
        for node in self.nodes:
            own = {
                each: getattr(node, each) for each in ("name", "row", "figure", "carrier", "label", "layer", "rooted")
            }
            own["grip"] = node.grip and {each: getattr(node.grip, each) for each in ("carrier", "axis", "slides")}
            own["parts"] = [
                {
                    **{each: getattr(part, each) for each in ("shape", "size", "layer", "colour", "opacity")},
                    "pose": numbers(part.pose),
                    "mesh": part.mesh and part.mesh.key,
                    "ownColours": part.own_colours,
                }
                for part in node.parts
            ]
            nodes.append(own)
        tool = self.figures[0].name + self.figures[0].tool if self.figures else TOOL
        return {"reach": self.reach, "tool": tool, "nodes": nodes}


def numbers(pose: RigidTransform) -> list[float]:
    """The upper three rows of the 4x4 matrix, to a nanometre."""
    r, t = pose
    return [round(x, DECIMALS) for x in (*r[0:3], t[0], *r[3:6], t[1], *r[6:9], t[2])]


def from_root(robot: Robot) -> Iterator[tuple[Link, str]]:
    """The links, each behind the one that holds it and with its name, branch after branch; unreached ones last."""
    links = {link.name: link for link in robot.links}
    holders = {joint.child: joint.parent for joint in reversed(robot.joints)}
    waiting = [*reversed(links), *(name for name in reversed(links) if name not in holders)]
    while waiting:
        name = waiting.pop()
        if (link := links.pop(name, None)) is not None:
            yield link, holders.get(name, "")
            waiting += [joint.child for joint in reversed(robot.joints) if joint.parent == name]


def extent(robot: Robot) -> float:
    """An upper bound of the distance of any link from the root, prismatic joints at their farther limit [m]."""
    far: dict[str, float] = {}
    for joint in robot.joints:
        travel = max(abs(joint.limits.lower or 0.0), abs(joint.limits.upper or 0.0))
        slide = travel if joint.type is JointType.PRISMATIC else 0.0
        far[joint.child] = far.get(joint.parent, 0.0) + norm(joint.origin.xyz) + slide
    return max(far.values(), default=0.0)


# --- Nodes ------------------------------------------------------------------------------------------------------------


def _nodes(figure: Figure, reach: float) -> Iterator[SceneNode]:
    robot, table = figure.robot, figure.manipulator
    rows = {row.joint: number for number, row in enumerate(table.rows)} if table else {}
    above = {joint.child: joint for joint in robot.joints}
    moved = {joint.child for joint in robot.moving_joints}  # and what hangs on them
    while more := {joint.child for joint in robot.joints if joint.parent in moved} - moved:
        moved |= more
    # So many reaches, and no more than half of a usual link, which the arrows of a frame would bury.
    far = max(extent(arm.kind) for arm in robot.arms) if robot.arms else reach
    size = min(FRAME_SIZE, 0.5 / max(1, len(robot.moving_joints) // max(1, len(robot.arms)))) * far
    held = grips(robot, figure.name)
    bodies_of = {link.name: list(_bodies(link, figure)) for link in robot.links}
    for link in robot.links:
        joint = above.get(link.name)
        bodies = bodies_of[link.name]
        near = [] if joint is None else [*bodies_of.get(joint.parent, ()), *bodies]
        if not any(part.layer == "links" for part in bodies):
            bodies += _sticks(link, figure, 0.15 * size)
        parts = [*bodies, *mass_parts(link, CENTRE_SIZE * reach), *(_axis(joint, size, near) if joint else ())]
        is_flange = link.name == FLANGE
        is_frame = link.name == TOOL or (figure.link_frames and joint is not None and (table is None or is_flange))
        if is_frame:  # The flange's is smaller: tool0 often stands where it does.
            parts.append(ScenePart(shape="frame", size=(0.6 * size if is_flange else size,), layer="frames"))
        label, layer = link.name if is_frame else "", "frames"
        if joint is None and figure.title:
            label, layer = figure.title, "links"
        yield SceneNode(
            name=figure.name + link.name,
            row=rows.get(joint.name) if joint else None,
            figure=figure.name,
            grip=held.get(link.name),
            carrier=_carrier(figure, joint) if is_frame else None,
            parts=tuple(parts),
            label=label,
            layer=layer,
            rooted=table is None and link.name not in moved,
        )
    if table is not None:
        root = next(link.name for link in robot.links if link.name not in above)
        for number in range(len(table.rows) + 1):
            part = ScenePart(shape="frame", size=(size,), layer="frames")
            row = number - 1 if number else None
            name, carrier = f"{figure.name}frame {number}", f"{figure.name}{f'frame {number - 1}' if number else root}"
            label = f"{{{number}}}"
            yield SceneNode(name=name, row=row, figure=figure.name, carrier=carrier, parts=(part,), label=label)


def _carrier(figure: Figure, joint: Joint | None) -> str | None:
    """The node of the frame that carries a link's: its parent's or, in a table, the last DH frame."""
    if joint is None or not figure.link_frames:
        return None
    table = figure.manipulator
    return figure.name + (joint.parent if table is None or joint.parent == FLANGE else f"frame {len(table.rows)}")


def _bodies(link: Link, figure: Figure) -> Iterator[ScenePart]:
    for visual in link.visuals:
        part = _part(visual.geometry, figure)
        if part is not None:
            red, green, blue, opacity = visual.material.rgba if visual.material else (*figure.plain, 1.0)
            colour, pose = figure.tint or (red, green, blue), visual.origin.transform
            is_foreign = isinstance(visual.geometry, Mesh) and visual.geometry.file is None
            own = figure.tint is None and (is_foreign or visual.material is None)
            yield replace(part, pose=pose, colour=colour, opacity=opacity * figure.opacity, own_colours=own)
    for collision in link.collisions:
        part = _part(collision.geometry, figure)
        if part is not None:
            pose = collision.origin.transform
            yield replace(part, pose=pose, layer="collision", colour=COLLISION, opacity=0.45)


def _sticks(link: Link, figure: Figure, radius: float) -> Iterator[ScenePart]:
    """The skeleton of a link that has nothing to draw: from its own origin to those of the joints that it holds."""
    colour, opacity = figure.tint or figure.plain, figure.opacity
    for joint in figure.robot.joints:
        length = norm(joint.origin.xyz)
        stands_there = joint.parent == WORLD and joint.type is JointType.FIXED  # Nothing holds it in the world.
        if joint.parent == link.name and length > 0.0 and not stands_there:
            pose = RigidTransform(towards(joint.origin.xyz), scale(0.5, joint.origin.xyz))
            yield ScenePart(shape="cylinder", size=(radius, length), pose=pose, colour=colour, opacity=opacity)


def meshes_of(robot: Robot) -> Iterator[Mesh]:
    """The meshes of a robot's visuals and collisions, link by link."""
    for link in robot.links:
        geometries = (*(visual.geometry for visual in link.visuals), *(other.geometry for other in link.collisions))
        yield from (geometry for geometry in geometries if isinstance(geometry, Mesh))


def _file_of(mesh: Mesh, figure: Figure) -> DrawnMesh | None:
    """The file of a mesh; None where none can be drawn. A table's mesh knows its own, and its axis up."""
    path = figure.files.get(mesh.filename) if mesh.file is None else Path(mesh.file.path)
    if path is None or path.suffix.lower() not in SUFFIXES:
        return None
    return DrawnMesh(path=path, scale=mesh.scale, as_in_ros=figure.as_in_ros and mesh.file is None)


def _part(geometry: Geometry, figure: Figure) -> ScenePart | None:
    """A shape in its own frame; None for a mesh that cannot be drawn."""
    match geometry:
        case Box(size=size):
            return ScenePart(shape="box", size=size)
        case Cylinder(radius=radius, length=length):
            return ScenePart(shape="cylinder", size=(radius, length))
        case Sphere(radius=radius):
            return ScenePart(shape="sphere", size=(radius,))
        case Mesh():
            file = _file_of(geometry, figure)
            return ScenePart(shape="mesh", size=(), mesh=file) if file else None


def _axis(joint: Joint, size: float, near: Sequence[ScenePart]) -> Iterator[ScenePart]:
    """The axis of a joint in its child's frame; its colour is never that of the links it joins."""
    colours, taken = AXIS_COLOURS.get(joint.type), [part.colour for part in near if part.layer == "links"]
    if colours is not None and norm(joint.axis) > 0.0:
        pose = RigidTransform(towards(joint.axis), (0.0, 0.0, 0.0))
        clear = (each for each in colours if all(math.dist(each, other) >= APART for other in taken))
        colour, sizes = next(clear, colours[-1]), (0.035 * size, _AXIS_LENGTH * size)
        yield ScenePart(shape="cylinder", size=sizes, pose=pose, layer="axes", colour=colour)


def _own_values(figure: Figure, q: Mapping[str, float]) -> dict[str, float]:
    return {joint.name: q.get(figure.name + joint.name, 0.0) for joint in figure.robot.moving_joints}
