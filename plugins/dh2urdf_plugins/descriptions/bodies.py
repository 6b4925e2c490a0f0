"""What a chain carries: masses, centres of mass, inertias and meshes of its links, in the frames of the table.

Whatever is fixed to a link is part of it, and so is a branch behind joints that leave the chain, as it is at q = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import Inertia, JointType, MeshShape
from dh2urdf.mass_properties import compound, inertia_problem, placed
from dh2urdf.meshes import FORMATS, find_mesh
from dh2urdf.robot import Mesh
from dh2urdf.rotations import IDENTITY, RigidTransform, Vec3
from dh2urdf.source import shown
from dh2urdf_plugins.extraction.chain import between_decimals, decimal_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from dh2urdf.robot import Collision, Inertial, Joint, Visual
    from dh2urdf_plugins.descriptions.trees import Tree
    from dh2urdf_plugins.extraction.chain import Precision

    Shape = TypeVar("Shape", Visual, Collision)

_DIGITS = 1e-10
"""What an element of an inertia may lose of the largest one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """What the rows of a table hold of a link.

    Attributes:
        mass: its mass [kg]; None where the description gives it none.
        com: its centre of mass in the frame [m].
        inertia: about the centre of mass, axes of the frame [kg·m²]; None where it is none of a body.
        visual: the mesh that it is seen as.
        collision: the mesh that it touches with.
    """

    mass: float | None = None
    com: Vec3 | None = None
    inertia: Inertia | None = None
    visual: MeshShape | None = None
    collision: MeshShape | None = None


class Carried:
    """The links of a chain, by the joint of the chain that moves them.

    Attributes:
        segments: by link, the number of moving joints of the chain before it.
        poses: by link, its frame in the base link at q = 0.
        left_out: the moving joints that leave the chain.
        lost: what a table has no place for, as sentences.
    """

    def __init__(self, tree: Tree, chain: Sequence[Joint], find: Callable[[str], Path | None]) -> None:
        """Follows the tree from the base link.

        Args:
            tree: the description's links and joints.
            chain: the joints from the base link to the tip link.
            find: the file that an address of a mesh means; None where there is none.
        """
        on_chain = {joint.name for joint in chain}
        self._links = {link.name: link for link in tree.robot.links}
        self._find = find
        self.segments: dict[str, int] = {tree.base: 0}
        self.poses: dict[str, RigidTransform] = {tree.base: IDENTITY}
        self.left_out: list[str] = []
        self.lost: list[str] = []
        ahead = [tree.base]
        while ahead:
            parent = ahead.pop()
            for joint in tree.below.get(parent, ()):
                if joint.child in self.poses:
                    continue
                moves = joint.type is not JointType.FIXED
                self.segments[joint.child] = self.segments[parent] + (moves and joint.name in on_chain)
                self.poses[joint.child] = self.poses[parent] @ joint.origin.transform
                if moves and joint.name not in on_chain:
                    self.left_out.append(joint.name)
                ahead.append(joint.child)
        order = [joint.name for joint in tree.robot.joints]
        self.left_out.sort(key=order.index)

    def body(self, segment: int, frame: RigidTransform, precision: Precision) -> Body:
        """What is carried by a joint of the chain, in its frame at q = 0.

        Args:
            segment: number of the joint, from 1 on; 0 for the base.
            frame: the frame of the row in the base link.
            precision: what numbers may lose.
        """
        back = frame.inverse
        names = [name for name in self._links if self.segments.get(name) == segment]
        what = "the base" if segment == 0 else shown(names[0])
        weighed = [(name, body) for name in names if (body := self._links[name].inertial) and body.mass]
        seen = [(name, shape) for name in names for shape in self._links[name].visuals]
        touching = [(name, shape) for name in names for shape in self._links[name].collisions]
        mass = com = inertia = None
        if 0.0 < sum(body.mass for _, body in weighed) < math.inf and all(_is_finite(body) for _, body in weighed):
            whole = compound([placed(body, back @ self.poses[name]) for name, body in weighed])
            mass, com, inertia = whole.mass, self._com(whole, precision), self._inertia(whole, what)
        elif weighed:
            self.lost.append(f"the mass of {what}, which is not greater than 0, or not finite")
        return Body(
            mass=mass,
            com=com,
            inertia=inertia,
            visual=_posed(self._mesh(seen, back, what, "seen as"), precision),
            collision=_posed(self._mesh(touching, back, what, "touched with"), precision),
        )

    @staticmethod
    def _com(body: Inertial, precision: Precision) -> Vec3:
        x, y, z = (precision.length_of(value) for value in body.com)
        return (x, y, z)

    def _inertia(self, body: Inertial, what: str) -> Inertia | None:
        elements = {name: getattr(body.inertia, name) for name in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")}
        precision = between_decimals(_DIGITS * max(map(abs, elements.values())))
        written = Inertia(**{name: decimal_of(value, precision) for name, value in elements.items()})
        for tensor in (written, body.inertia):
            if (broken := inertia_problem(tensor)) is None:
                return tensor
        self.lost.append(f"the inertia of {what}: {broken}")
        return None

    def _mesh(
        self, shapes: Sequence[tuple[str, Shape]], back: RigidTransform, what: str, verb: str
    ) -> MeshShape | None:
        """The mesh of a link, where it has one shape and that is a mesh at hand."""
        if len(shapes) != 1 or not isinstance(mesh := shapes[0][1].geometry, Mesh):
            if shapes:
                count = "a shape that is no mesh" if len(shapes) == 1 else f"{len(shapes)} shapes"
                self.lost.append(f"what {what} is {verb}: {count}")
            return None
        name, shape = shapes[0]
        try:
            if (path := self._find(mesh.filename)) is None:
                self.lost.append(f"what {what} is {verb}: there is no file {shown(mesh.filename)}")
                return None
            if path.suffix.lower() not in FORMATS:
                self.lost.append(f"what {what} is {verb}: {shown(path.name)} is no STL, OBJ or DAE file")
                return None
            file = find_mesh(path.name, path.parent)
        except ConfigError as error:
            self.lost.append(f"what {what} is {verb}: {error.problems[0].message}")
            return None
        return MeshShape(file=file, pose=back @ self.poses[name] @ shape.origin.transform, scale=mesh.scale)


def _posed(shape: MeshShape | None, precision: Precision) -> MeshShape | None:
    """A mesh whose pose has the numbers of a table."""
    return shape and replace(shape, pose=precision.pose_of(shape.pose))


def _is_finite(body: Inertial) -> bool:
    i = body.inertia
    return all(map(math.isfinite, (body.mass, *body.com, i.ixx, i.iyy, i.izz, i.ixy, i.ixz, i.iyz)))
