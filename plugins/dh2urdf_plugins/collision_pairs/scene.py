"""The collision shapes of a mechanism in coal, moved by pinocchio: which links touch in a state.

coal is the collision library behind pinocchio, made of FCL, which MoveIt uses. Meshes are surfaces in both: a link that
is wholly inside the mesh of another does not touch it.
"""

from __future__ import annotations

import importlib
from itertools import combinations
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import InputError, MissingDependencyError
from dh2urdf.manipulator import JointType
from dh2urdf.meshes import read_parts
from dh2urdf.robot import Box, Cylinder, Mesh, Sphere
from dh2urdf.rotations import norm
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.collision_pairs.mechanism import FLOATING, PLANAR

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from dh2urdf.robot import Collision, Geometry, Joint, Origin
    from dh2urdf.rotations import Vec3
    from dh2urdf_plugins.collision_pairs.mechanism import Mechanism, State

Pair = tuple[str, str]
"""Two links, the first in the order of their names."""


def pair_of(one: str, other: str) -> Pair:
    """The pair of two links, the first in the order of their names as bytes."""
    return (one, other) if one < other else (other, one)


class Scene:
    """The collision shapes of a mechanism.

    Attributes:
        links: the links that have a shape, in the order of the description.
    """

    def __init__(self, mechanism: Mechanism, mesh: Callable[[Mesh], tuple[bytes, str]]) -> None:
        """Builds the mechanism in pinocchio.

        Args:
            mechanism: the links and joints.
            mesh: the content and the suffix of a mesh.

        Raises:
            InputError: the links are no tree, or a mesh cannot be read.
            MissingDependencyError: pinocchio, coal or what reads meshes is not installed.
        """
        self._pinocchio, self._coal = _package("pinocchio", "pin"), _package("coal", "coal")
        self._mechanism, self._mesh = mechanism, mesh
        self._meshes: dict[tuple[str, Vec3], Any] = {}
        self._model = self._pinocchio.Model()
        self._joints: dict[str, int] = {}
        self._place_links()
        self._shapes = self._pinocchio.GeometryModel()
        self.links = tuple(link.name for link in mechanism.robot.links if link.collisions)
        numbers = {
            link.name: [self._shape(link.name, collision) for collision in link.collisions]
            for link in mechanism.robot.links
        }
        self._pairs: list[Pair] = []
        for one, other in combinations(self.links, 2):
            for first in numbers[one]:
                for second in numbers[other]:
                    self._shapes.addCollisionPair(self._pinocchio.CollisionPair(first, second))
                    self._pairs.append(pair_of(one, other))
        self._data, self._found = self._model.createData(), self._shapes.createData()

    def ignore(self, pairs: Iterable[Pair]) -> None:
        """Has pairs not be looked at any more."""
        gone = set(pairs)
        for number, pair in enumerate(self._pairs):
            if pair in gone:
                self._found.deactivateCollisionPair(number)

    def touching(self, state: State, margin: float = 0.0) -> set[Pair]:
        """The pairs that touch in a state, or come nearer than a margin [m]."""
        for request in self._found.collisionRequests:
            request.security_margin = margin
        coordinates = self._pinocchio.neutral(self._model)
        for name, number in self._joints.items():
            joint = self._model.joints[number]
            coordinates[joint.idx_q : joint.idx_q + joint.nq] = state[name]
        self._pinocchio.computeCollisions(self._model, self._data, self._shapes, self._found, coordinates, False)
        results, active = self._found.collisionResults, self._found.activeCollisionPairs
        return {pair for number, pair in enumerate(self._pairs) if active[number] and results[number].isCollision()}

    # What is built

    def _place_links(self) -> None:
        """Adds the moving joints to the model; a link behind fixed ones is placed on the joint that carries it."""
        joints = self._mechanism.from_root()
        held = {joint.child for joint in joints}
        root = next(link.name for link in self._mechanism.robot.links if link.name not in held)
        self._carriers = {root: (0, self._pinocchio.SE3.Identity())}
        for joint in joints:
            number, placement = self._carriers[joint.parent]
            placement = placement * self._transform(joint.origin)
            if self._mechanism.moves(joint):
                number = self._model.addJoint(number, self._kind(joint), placement, joint.name)
                placement = self._pinocchio.SE3.Identity()
                self._joints[joint.name] = number
            self._carriers[joint.child] = (number, placement)

    def _kind(self, joint: Joint) -> Any:  # noqa: ANN401 - pinocchio has no types
        import numpy as np

        loose = self._mechanism.loose.get(joint.name)
        if loose == FLOATING:
            return self._pinocchio.JointModelSpherical()
        axis = np.array((0.0, 0.0, 1.0) if loose == PLANAR else joint.axis) / (1.0 if loose else norm(joint.axis))
        slides = joint.type is JointType.PRISMATIC
        kind = "JointModelPrismaticUnaligned" if slides else "JointModelRevoluteUnaligned"
        return getattr(self._pinocchio, kind)(axis)

    def _transform(self, origin: Origin) -> Any:  # noqa: ANN401 - as above
        import numpy as np

        rotation, translation = origin.transform
        return self._pinocchio.SE3(np.array(rotation).reshape(3, 3), np.array(translation))

    def _shape(self, link: str, collision: Collision) -> int:
        number, placement = self._carriers[link]
        name = f"{link}_{self._shapes.ngeoms}"
        shape = self._geometry(link, collision.geometry)
        placement = placement * self._transform(collision.origin)
        added: int = self._shapes.addGeometryObject(self._pinocchio.GeometryObject(name, number, placement, shape))
        return added

    def _geometry(self, link: str, geometry: Geometry) -> Any:  # noqa: ANN401 - as above
        match geometry:
            case Box(size=size):
                return self._coal.Box(*size)
            case Cylinder(radius=radius, length=length):
                return self._coal.Cylinder(radius, length)
            case Sphere(radius=radius):
                return self._coal.Sphere(radius)
            case Mesh():
                key = (geometry.filename, geometry.scale)
                if key not in self._meshes:
                    self._meshes[key] = self._triangles(link, geometry)
                return self._meshes[key]

    def _triangles(self, link: str, mesh: Mesh) -> Any:  # noqa: ANN401 - as above
        content, suffix = self._mesh(mesh)
        try:
            parts = read_parts(content, suffix, mesh.scale)
        except ImportError as error:
            package = "pycollada" if error.name == "collada" else "trimesh"
            user, extra = "a collision shape that is a mesh", "dh2urdf[meshes]"
            raise MissingDependencyError(user, package, extra, error) from error
        except Exception as error:
            message = f"the mesh {shown(mesh.filename)} of the link {shown(link)} cannot be read: {error}"
            accepted = "a mesh that has triangles, as STL, OBJ or DAE"
            raise InputError(Problem(message=message, found=mesh.filename, accepted=accepted)) from error
        surface = self._coal.BVHModelOBBRSS()
        surface.beginModel(sum(len(part.faces) for part in parts), sum(len(part.vertices) for part in parts))
        for part in parts:
            for corners in part.vertices[part.faces]:
                surface.addTriangle(*corners)
        surface.endModel()
        return surface


def _package(module: str, package: str) -> Any:  # noqa: ANN401 - a module without types
    try:
        return importlib.import_module(module)
    except ImportError as error:
        user, extra = "the search for collision pairs", "dh2urdf[pinocchio]"
        raise MissingDependencyError(user, package, extra, error) from error


def shaped_neighbours(mechanism: Mechanism) -> Iterator[Pair]:
    """The pairs of links with shapes that one joint joins, or several with links without a shape between them."""
    joined: dict[str, set[str]] = {link.name: set() for link in mechanism.robot.links}
    for joint in mechanism.robot.joints:
        joined[joint.parent].add(joint.child)
        joined[joint.child].add(joint.parent)
    shaped = {link.name for link in mechanism.robot.links if link.collisions}
    found = {pair_of(one, other) for one in shaped for other in joined[one] & shaped}
    waiting = set(joined) - shaped
    while waiting:
        region, around = {waiting.pop()}, set[str]()
        ahead = list(region)
        while ahead:
            for other in joined[ahead.pop()]:
                if other in shaped:
                    around.add(other)
                elif other not in region:
                    region.add(other)
                    ahead.append(other)
        waiting -= region
        found |= {pair_of(one, other) for one, other in combinations(sorted(around), 2)}
    yield from sorted(found)
