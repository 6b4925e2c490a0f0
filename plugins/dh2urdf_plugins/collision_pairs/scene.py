"""The collision shapes of a mechanism in coal, moved by pinocchio: which links touch in a state.

coal is the collision library behind pinocchio, made of FCL, which MoveIt uses. Meshes are surfaces in both: a link that
is wholly inside the mesh of another does not touch it.

A tree of links and joints that moves: what drives its joints, where they start, and random states. States are those of
MoveIt's robot model: a joint starts at 0, or in the middle of its limits where 0 is outside; random values are uniform
within the limits, or a turn where there are none; a joint that mimics another follows it, wherever that leads; a
floating joint turns about its origin and a planar joint about z, since nothing limits where they are.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np  # noqa: TID253 - pinocchio, which moves the shapes, imports it, too

from dh2urdf.errors import InputError, MissingDependencyError
from dh2urdf.manipulator import JointType
from dh2urdf.meshes import read_parts
from dh2urdf.robot import Box, Cylinder, Follower, Mesh, Robot, Sphere, followers_of, with_followers
from dh2urdf.rotations import norm
from dh2urdf.source import Mark, Messages

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from random import Random

    from dh2urdf.robot import Geometry, Joint, Origin
    from dh2urdf.rotations import Vec3

say = Messages(__file__)


FLOATING, PLANAR = "floating", "planar"


Quaternion = tuple[float, float, float, float]
State = Mapping[str, float | Quaternion]
"""The values of moving joints by name [rad or m]; of a floating joint its orientation, as a quaternion (x, y, z, w)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mechanism:
    """A robot whose floating and planar joints move, too."""

    robot: Robot  # the links and joints; floating and planar joints are fixed in it
    loose: Mapping[str, str] = field(default_factory=dict)  # floating and planar joints, by name
    file: str | None = None  # what messages call the description

    def moves(self, joint: Joint) -> bool:
        """Whether a joint moves, by itself or behind another."""
        return joint.type is not JointType.FIXED or joint.name in self.loose

    @property
    def followers(self) -> dict[str, Follower]:
        """The joints that follow another one, by name, and how."""
        return followers_of(filter(self.moves, self.robot.joints))

    def from_root(self) -> tuple[Joint, ...]:
        """The joints, each behind the one that holds its parent."""
        links, followers, joints = [link.name for link in self.robot.links], self.followers, self.robot.joints
        for joint in joints:
            if joint.follows and self.moves(joint) and joint.name not in followers:
                raise self._error("leader-not-followed", joint, leader=joint.follows.leader)
            if joint.type is not JointType.FIXED and not norm(joint.axis):
                raise self._error("axis-of-length-0", joint)
            for name in {joint.parent, joint.child} - set(links):
                raise self._error("joint-of-no-link", joint, name=name, links=links[:20])
        children = [joint.child for joint in joints]
        ordered: list[Joint] = []
        reached, waiting = set(links) - set(children), list(joints)
        is_tree = len(reached) == 1 and len(children) == len(set(children))
        while ready := [joint for joint in waiting if joint.parent in reached]:
            ordered += ready
            reached |= {joint.child for joint in ready}
            waiting = [joint for joint in waiting if joint.child not in reached]
        if waiting or not is_tree:
            raise self._error("no-tree")
        return tuple(ordered)

    def _error(self, code: str, joint: Joint | None = None, **about: Any) -> InputError:  # noqa: ANN401 - of a message
        mark = joint.mark if joint and joint.mark else Mark(file=self.file) if self.file else None
        robot, name = None if self.file else self.robot.name, joint.name if joint else None
        return InputError(say(code, mark, robot=robot, joint=name, **about))

    # States

    def state(self, random: Random | None = None) -> State:
        """Where the joints start, or a state within the limits that is drawn."""
        values: dict[str, float | Quaternion] = {}
        followers = self.followers
        for joint in self.robot.joints:
            if not self.moves(joint) or joint.name in followers:
                continue
            if self.loose.get(joint.name) == FLOATING:
                values[joint.name] = _anyhow_turned(random) if random else (0.0, 0.0, 0.0, 1.0)
                continue
            lower, upper = self._range(joint)
            if random:
                values[joint.name] = lower + random.random() * (upper - lower)
            else:
                values[joint.name] = 0.0 if lower <= 0.0 <= upper else 0.5 * lower + 0.5 * upper
        return with_followers(values, followers)

    def _range(self, joint: Joint) -> tuple[float, float]:
        """The limits of a joint: a turn where it has none; a joint that slides without limits stays where it starts."""
        lower, upper = joint.limits.lower, joint.limits.upper
        if joint.type is JointType.CONTINUOUS or self.loose.get(joint.name) == PLANAR:
            return -math.pi, math.pi
        if joint.limits.velocity is None and lower is None and upper is None:
            return (0.0, 0.0) if joint.type is JointType.PRISMATIC else (-math.pi, math.pi)
        return lower or 0.0, upper or 0.0


def _anyhow_turned(random: Random) -> Quaternion:
    """A rotation from the uniform distribution over all: K. Shoemake, "Uniform random rotations", Graphics Gems III."""
    radius, first, second = random.random(), math.tau * random.random(), math.tau * random.random()
    small, large = math.sqrt(1.0 - radius), math.sqrt(radius)
    return small * math.sin(first), small * math.cos(first), large * math.sin(second), large * math.cos(second)


Pair = tuple[str, str]  # two links, the first in the order of their names


def pair_of(one: str, other: str) -> Pair:
    """The pair of two links, the first in the order of their names as bytes."""
    return (one, other) if one < other else (other, one)


class Scene:
    """The collision shapes of a mechanism; `links` are those that have any, in the order of the description."""

    def __init__(self, mechanism: Mechanism, mesh: Callable[[Mesh], tuple[bytes, str]]) -> None:
        """Builds the mechanism in pinocchio; `mesh` returns the content and the suffix of a mesh."""
        self._pinocchio, self._coal = _package("pinocchio", "pin"), _package("coal", "coal")
        self._mechanism, self._mesh = mechanism, mesh
        self._meshes: dict[tuple[str, Vec3], Any] = {}
        self._model = self._pinocchio.Model()
        self._joints: dict[str, int] = {}
        self._place_links()
        self._shapes = self._pinocchio.GeometryModel()
        self.links = tuple(link.name for link in mechanism.robot.links if link.collisions)
        numbers: dict[str, list[int]] = {name: [] for name in self.links}
        for link in mechanism.robot.links:
            for collision in link.collisions:
                number, placement = self._carriers[link.name]
                placement = placement * self._transform(collision.origin)
                name, shape = f"{link.name}_{self._shapes.ngeoms}", self._geometry(link.name, collision.geometry)
                shaped = self._pinocchio.GeometryObject(name, number, placement, shape)
                numbers[link.name].append(self._shapes.addGeometryObject(shaped))
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
        pinocchio, joints = self._pinocchio, self._mechanism.from_root()
        held = {joint.child for joint in joints}
        root = next(link.name for link in self._mechanism.robot.links if link.name not in held)
        self._carriers = {root: (0, pinocchio.SE3.Identity())}
        for joint in joints:
            number, placement = self._carriers[joint.parent]
            placement = placement * self._transform(joint.origin)
            if self._mechanism.moves(joint):
                loose = self._mechanism.loose.get(joint.name)
                if loose == FLOATING:
                    model = pinocchio.JointModelSpherical()
                elif loose == PLANAR:
                    model = pinocchio.JointModelRevoluteUnaligned(np.array((0.0, 0.0, 1.0)))
                else:
                    kind = "Prismatic" if joint.type is JointType.PRISMATIC else "Revolute"
                    model = getattr(pinocchio, f"JointModel{kind}Unaligned")(np.array(joint.axis) / norm(joint.axis))
                number, placement = self._model.addJoint(number, model, placement, joint.name), pinocchio.SE3.Identity()
                self._joints[joint.name] = number
            self._carriers[joint.child] = (number, placement)

    def _transform(self, origin: Origin) -> Any:  # noqa: ANN401 - as above
        rotation, translation = origin.transform
        return self._pinocchio.SE3(np.array(rotation).reshape(3, 3), np.array(translation))

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
            code = "collision-mesh-unreadable"
            raise InputError(say(code, found=mesh.filename, link=link, reason=error)) from error
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
    found: set[Pair] = set()
    for one in shaped:
        met, ahead = {one}, [one]
        while ahead:
            around = joined[ahead.pop()] - met
            met |= around
            ahead += around - shaped
            found |= {pair_of(one, other) for other in around & shaped}
    yield from sorted(found)
