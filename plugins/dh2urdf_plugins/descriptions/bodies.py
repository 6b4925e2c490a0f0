"""What a chain carries: masses, centres of mass, inertias and meshes of its links, in the frames of the table.

Whatever is fixed to a link is part of it, and so is a branch behind joints that leave the chain, as it is at q = 0.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.columns import INERTIA
from dh2urdf.errors import ConfigError
from dh2urdf.kinematics.mass import compound, inertia_problem, placed
from dh2urdf.manipulator import Inertia, JointType, MeshShape
from dh2urdf.meshes import FORMATS, find_mesh
from dh2urdf.robot import Mesh
from dh2urdf.rotations import IDENTITY, RigidTransform, Vec3
from dh2urdf.source import shown
from dh2urdf_plugins.extraction.chain import between_decimals, decimal_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from dh2urdf.robot import Collision, Joint, Visual
    from dh2urdf_plugins.descriptions.trees import Tree
    from dh2urdf_plugins.extraction.chain import Precision

_DIGITS = 1e-10
"""What an element of an inertia may lose of the largest one."""


class Body(NamedTuple):
    """What the rows of a table hold of a link."""

    mass: float | None  # [kg]; None where the description gives it none
    com: Vec3 | None  # its centre of mass in the frame [m]
    inertia: Inertia | None  # about the centre of mass, axes of the frame [kg·m²]; None where it is none of a body
    visual: MeshShape | None  # what it is seen as
    collision: MeshShape | None  # what it touches with


class Carried:
    """The links of a chain, by the joint of the chain that moves them.

    Attributes:
        segments: by link, the number of moving joints of the chain before it.
        poses: by link, its frame in the base link at q = 0.
        left_out: the moving joints that leave the chain.
        lost: what a table has no place for, as sentences.
    """

    def __init__(
        self, tree: Tree, chain: Sequence[Joint], find: Callable[[str], Path | None], precision: Precision
    ) -> None:
        """Follows the tree from the base link; `find` finds the file of a mesh, and numbers may lose the precision."""
        on_chain = {joint.name for joint in chain}
        self._links = {link.name: link for link in tree.robot.links}
        self._find, self._precision = find, precision
        self.segments: dict[str, int] = {tree.base: 0}
        self.poses: dict[str, RigidTransform] = {tree.base: IDENTITY}
        leaving: set[str] = set()
        self.lost: list[str] = []
        for joint in tree.walk(without=tree.description.faulty):
            moves, is_on_chain = joint.type is not JointType.FIXED, joint.name in on_chain
            self.segments[joint.child] = self.segments[joint.parent] + (moves and is_on_chain)
            self.poses[joint.child] = self.poses[joint.parent] @ joint.origin.transform
            leaving |= {joint.name} if moves and not is_on_chain else set()
        self.left_out = [joint.name for joint in tree.robot.joints if joint.name in leaving]

    def body(self, segment: int, frame: RigidTransform) -> Body:
        """What is carried by the n-th joint of the chain, or the base (0), in its frame in the base link at q = 0."""
        back = frame.inverse
        names = [name for name in self._links if self.segments.get(name) == segment]
        what = "the base" if segment == 0 else shown(names[0])
        weighed = [(name, body) for name in names if (body := self._links[name].inertial) and body.mass]
        seen = [(name, shape) for name in names for shape in self._links[name].visuals]
        touching = [(name, shape) for name in names for shape in self._links[name].collisions]
        mass = com = inertia = None
        numbers = [
            number
            for _, body in weighed
            for number in (body.mass, *body.com, *(getattr(body.inertia, name) for name in INERTIA))
        ]
        if 0.0 < sum(body.mass for _, body in weighed) < math.inf and all(map(math.isfinite, numbers)):
            whole = compound([placed(body, back @ self.poses[name]) for name, body in weighed])
            x, y, z = map(self._precision.length_of, whole.com)
            mass, com, inertia = whole.mass, (x, y, z), self._inertia(whole.inertia, what)
        elif weighed:
            self.lost.append(f"the mass of {what}, which is not greater than 0, or not finite")
        visual, collision = (
            self._mesh(seen, back, f"{what} is seen as"),
            self._mesh(touching, back, f"{what} is touched with"),
        )
        return Body(mass, com, inertia, visual, collision)

    def _inertia(self, inertia: Inertia, what: str) -> Inertia | None:
        elements = {name: getattr(inertia, name) for name in INERTIA}
        precision = between_decimals(_DIGITS * max(map(abs, elements.values())))
        written = Inertia(**{name: decimal_of(value, precision) for name, value in elements.items()})
        for tensor in (written, inertia):
            if (broken := inertia_problem(tensor)) is None:
                return tensor
        self.lost.append(f"the inertia of {what}: {broken}")
        return None

    def _mesh(
        self, shapes: Sequence[tuple[str, Visual | Collision]], back: RigidTransform, what: str
    ) -> MeshShape | None:
        """The mesh of a link, where it has one shape and that is a mesh at hand."""
        if not shapes:
            return None
        name, shape = shapes[0]
        mesh = shape.geometry
        if len(shapes) > 1 or not isinstance(mesh, Mesh):
            why = f"{len(shapes)} shapes" if len(shapes) > 1 else "a shape that is no mesh"
        elif (path := self._find(mesh.filename)) is None:
            why = f"there is no file {shown(mesh.filename)}"
        elif path.suffix.lower() not in FORMATS:
            why = f"{shown(path.name)} is no STL, OBJ or DAE file"
        else:
            try:
                pose = self._precision.pose_of(back @ self.poses[name] @ shape.origin.transform)
                return MeshShape(file=find_mesh(path.name, path.parent), pose=pose, scale=mesh.scale)
            except ConfigError as error:
                why = error.problems[0].message
        self.lost.append(f"what {what}: {why}")
        return None
