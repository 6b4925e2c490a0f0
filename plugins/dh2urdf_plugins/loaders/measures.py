"""What is asked of a simulator: of a written arm and of a file of any origin, the same questions to all of them."""

from __future__ import annotations

import math
from functools import partial
from itertools import combinations
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf import measuring
from dh2urdf.errors import LoaderError
from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.mass import GRAVITY, compound, placed
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Inertial, Sphere, with_followers
from dh2urdf.rotations import IDENTITY, ZERO, RigidTransform, Rotation, Vec3, add, rotate, scale, subtract
from dh2urdf.source import Messages, Problem, listed, shown
from dh2urdf_plugins.base_bodies import STILL, is_weightless_base

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Mapping, Sequence

    from dh2urdf.measuring import Body
    from dh2urdf.robot import Geometry, Joint, Robot
    from dh2urdf.stages import Question

say = Messages(__file__)


SINGLE_PRECISION = 2.0**-23  # distance of 1 to the next number in single precision

HOLD_SECONDS = 2.0  # how long the hold test lasts [s]
TIME_STEP = 1 / 240
"""Time step of the hold test, where a simulator needs none that is shorter [s]: PyBullet's usual one."""
HOLD_STAYS = 0.01  # joint displacement up to which the arm has stayed where it was [rad or m]

OVERLAP = 1e-5
"""How far collision shapes overlap at least to be a finding [m]: shapes that just touch do not.

Ten times the tolerance of Drake's search (FCL). Of boxes, spheres and cylinders of 20 mm to 1 m that touch, in any
orientation, MuJoCo finds an overlap of up to 3e-7 m, Drake of 1e-15 m, and PyBullet of 1e-15 m besides its margins.
"""


def clipped(joint: Joint, value: float) -> float:
    """The joint value nearest to the one given that the joint's limits allow [rad or m]."""
    lower, upper = joint.limits.lower, joint.limits.upper
    return min(max(value, -math.inf if lower is None else lower), math.inf if upper is None else upper)


def hold_start(robot: Robot) -> tuple[float, ...]:
    """The joint vector of the hold test: q = 0, clipped into the limits, which not every arm has around 0."""
    start = with_followers({joint.name: clipped(joint, 0.0) for joint in robot.actuated_joints}, robot.followers)
    return tuple(start[joint.name] for joint in robot.moving_joints)


def vector(array: Any) -> Vec3:  # noqa: ANN401 - an array of shape (3,)
    """Three plain numbers, none of them −0.0."""
    x, y, z = (float(element) + 0.0 for element in array)
    return (x, y, z)


def rotation(matrix: Any) -> Rotation:  # noqa: ANN401 - an array of shape (3, 3) or (9,)
    """Nine plain numbers, row by row, none of them −0.0."""
    a, b, c, d, e, f, g, h, i = (float(element) + 0.0 for element in matrix.reshape(9))
    return (a, b, c, d, e, f, g, h, i)


def frame(matrix: Any, array: Any) -> RigidTransform:  # noqa: ANN401 - as above
    """A frame of the arrays of its rotation and its translation."""
    return RigidTransform(rotation(matrix), vector(array))


def carriers(robot: Robot, kept: Container[str] = ()) -> dict[str, tuple[str, RigidTransform]]:
    """Of every link the one that carries it, and its frame there: fixed joints hold links together as one body.

    Links in `kept` stay links of their own, though fixed joints hold them.
    """
    found = {link.name: (link.name, IDENTITY) for link in robot.links}
    for joint in robot.held_rigidly:  # Parents before children.
        if joint.child not in kept:
            carrier, frame = found[joint.parent]
            found[joint.child] = carrier, frame @ joint.origin.transform
    return found


def lumped_bodies(robot: Robot, kept: Container[str] = ()) -> dict[str, Inertial]:
    """The mass properties of every rigid body, by the name of the link that carries it and in that link's frame.

    So a simulator holds them that knows moving bodies only, and adds to each what fixed joints hold to it.
    """
    carried = carriers(robot, kept)
    parts: dict[str, list[Inertial]] = {link: [] for link, _ in carried.values()}
    for link in robot.links:
        if link.inertial and link.inertial.mass:
            carrier, frame = carried[link.name]
            parts[carrier].append(placed(link.inertial, frame))
    return {name: compound(bodies) if bodies else Inertial(mass=0.0) for name, bodies in parts.items()}


def touching_pairs(robot: Robot) -> list[tuple[str, str]]:
    """The pairs of links whose contact would be a collision: they move against each other, and no joint joins them.

    Links that fixed joints hold together are one body; a body and the next one always meet at their joint.
    """
    body = {link: carrier for link, (carrier, _) in carriers(robot).items()}
    neighbours = {frozenset((body[joint.parent], body[joint.child])) for joint in robot.joints}
    return [
        (first, second)
        for first, second in combinations((link.name for link in robot.links if link.collisions), 2)
        if body[first] != body[second] and frozenset((body[first], body[second])) not in neighbours
    ]


def gravity_loads(robot: Robot, q: Sequence[float]) -> tuple[float, ...]:
    """What gravity asks of every moving joint at a joint vector, at rest [N or N·m]; the root is in the world's origin.

    The weight of all that a joint carries acts at its common centre of mass: on a joint that turns as the moment about
    its axis, on one that slides as the share along its axis.
    """
    frames = link_poses(robot, {joint.name: value for joint, value in zip(robot.moving_joints, q, strict=True)})
    mass = dict.fromkeys(frames, 0.0)
    moment = dict.fromkeys(frames, ZERO)
    for link in robot.links:
        if link.inertial and link.inertial.mass:
            frame, mass[link.name] = frames[link.name], link.inertial.mass
            centre = add(frame.translation, rotate(frame.rotation, link.inertial.com))
            moment[link.name] = scale(link.inertial.mass, centre)
    loads: dict[str, float] = {}
    for joint in reversed(robot.joints):  # Parents come before children.
        child, frame = joint.child, frames[joint.child]
        mass[joint.parent] += mass[child]
        moment[joint.parent] = add(moment[joint.parent], moment[child])
        x, y, z = rotate(frame.rotation, joint.axis)
        arm = subtract(moment[child], scale(mass[child], frame.translation))
        slides = joint.type is JointType.PRISMATIC
        loads[joint.name] = GRAVITY * (mass[child] * z if slides else x * arm[1] - y * arm[0])
    return tuple(loads[joint.name] for joint in robot.moving_joints)


def farthest(start: Sequence[float], vectors: Iterable[Sequence[float]]) -> list[float]:
    """How far each joint got from its start, over the joint vectors of a hold test [rad or m].

    A joint without a number any more got infinitely far.
    """
    import numpy as np

    away = np.nan_to_num(np.abs(np.subtract([*vectors], start)), nan=np.inf)
    found: list[float] = away.max(axis=0).tolist()
    return found


class Comparison(measuring.Comparison):
    """What a simulator holds, beside the robot that was written."""

    def is_filled_in(self, name: str, written: Inertial, held: Body) -> bool:
        """Whether a link is a base without a mass, to which the file gives one for a reader that needs it."""
        return is_weightless_base(name, written) and held.mass == STILL.mass

    def values(self, q: Sequence[float]) -> dict[str, float]:
        """A joint vector by the names of the moving joints [rad or m]."""
        return {joint.name: value for joint, value in zip(self.robot.moving_joints, q, strict=True)}

    def frames_of(self, held: Model, q: Sequence[float], links: Sequence[str] = ()) -> dict[str, RigidTransform]:
        """The frames of some links at a joint vector, of all links by default."""
        held.put(self.values(q))
        return held.placed(links or [link.name for link in self.robot.links])

    def poses_of(self, held: Model) -> dict[str, Any]:
        """As `poses`, of what a simulator has made of the file."""
        return self.poses(partial(self.frames_of, held))

    def floats(self, found: Iterable[str]) -> list[Problem]:
        """The problem of a robot of which other bodies float in the simulator than it has."""
        carried = carriers(self.robot)
        held = sorted({carried[link][0] for link in found if link in carried})
        if held == sorted(self.robot.floating):
            return []
        found, wanted = listed(held) or "none", listed(self.robot.floating) or "none"
        return [self.placed(say("simulator-floats", simulator=self.simulator, found=found, wanted=wanted))]

    def lost(self, links: Iterable[str]) -> list[Problem]:
        """The problems of links that the simulator does not have."""
        return [self.placed(say("simulator-lost-link", simulator=self.simulator, link=link)) for link in links]

    def overlapping(self, found: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
        """The pairs among those that overlap whose contact is a collision: none is joined to the other."""
        overlaps = set(map(frozenset, found))
        return [pair for pair in touching_pairs(self.robot) if frozenset(pair) in overlaps]

    def hold(
        self, start: Sequence[float], displacement: Sequence[float], contacts: Sequence[tuple[str, str]]
    ) -> dict[str, Any]:
        """The hold test as a report has it, and its findings; `contacts` are pairs of links that overlapped then.

        Displacements from the `start` [rad or m] are infinite where the arm flew apart. An arm does not stay where a
        motor is too weak, or where every motor is strong enough and the solver is not.
        """
        largest = max(displacement, default=0.0)
        loads = zip(self.robot.moving_joints, gravity_loads(self.robot, start), strict=True)
        share = max((share_of(joint.limits.effort, load) for joint, load in loads), default=0.0)
        weakest = self.robot.moving_joints[displacement.index(largest)] if largest > 0.0 else None
        hold = {
            "seconds": HOLD_SECONDS,
            "start": tuple(start),
            "largest_displacement": largest if math.isfinite(largest) else None,
            "joint": weakest.name if weakest else None,
            "threshold": HOLD_STAYS,
            "stayed": largest <= HOLD_STAYS,
            "largest_load": share if math.isfinite(share) else None,
            "contacts": list(contacts),
        }
        findings = []
        if weakest and largest > HOLD_STAYS:
            unit = "m" if weakest.type is JointType.PRISMATIC else "rad"
            by = f"by {largest:.3g} {unit}" if math.isfinite(largest) else "without end"
            if share <= 1.0:
                gave_way = say("solver-gave-way", joint=weakest.name, seconds=HOLD_SECONDS, by=by, share=share)
                findings.append(self.placed(gave_way))
            else:
                findings.append(self.weak(weakest, "arm-did-not-stay", seconds=HOLD_SECONDS, by=by))
        if contacts:
            pairs = listed([f"{shown(first)} and {shown(second)}" for first, second in contacts])
            findings.append(self.placed(say("shapes-overlap", pairs=pairs)))
        return {"hold": hold, "findings": tuple(findings)}

    def weak(self, joint: Joint, code: str, **about: Any) -> Problem:  # noqa: ANN401 - of a message
        """The finding about a joint whose effort does not suffice."""
        found = str(joint.limits.effort)
        return self.placed(say(code, joint=joint.name, field="limits.effort", found=found, **about))


def share_of(effort: float | None, load: float) -> float:
    """The share of a joint's effort that a load asks; infinite where there is no effort."""
    return abs(load) / effort if effort else math.inf if load else 0.0


# --- What a simulator makes of a file: see `dh2urdf.stages.Inspects`

VISUAL, COLLISION = "visual", "collision"
Lengths: TypeAlias = tuple[float, float, float]


def joint_record(
    name: str, kind: str, axis: tuple[float, ...], lower: float | None, upper: float | None, **others: float | None
) -> dict[str, Any]:
    """A joint as reports have it; one that turns without end has no limits."""
    lower, upper = (None, None) if kind == "continuous" else (lower, upper)
    return {"name": name, "type": kind, "axis": axis, "lower": lower, "upper": upper, **others}


class Model:
    """What a simulator makes of a file: where it puts joints, and where links are then."""

    def put(self, values: Mapping[str, float]) -> None:
        """Put joints at values [rad or m], at rest."""
        raise NotImplementedError

    def placed(self, links: Iterable[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the world, with the joints where they are put."""
        raise NotImplementedError

    def told_frames(
        self, links: Iterable[str], postures: Iterable[Mapping[str, float]]
    ) -> dict[str, list[list[float]]]:
        """The frames of a `dh2urdf.stages.HeldRobot`."""
        links, found = tuple(links), dict[str, list[list[float]]]()
        for values in postures:
            self.put(values)
            for name, (r, t) in self.placed(links).items():
                matrix = (*r[:3], t[0], *r[3:6], t[1], *r[6:], t[2], 0.0, 0.0, 0.0, 1.0)
                found.setdefault(name, []).append([*map(float, matrix)])
        return found


def told_bodies(bodies: Mapping[str, Body]) -> dict[str, tuple[float, tuple[float, ...], tuple[float, ...]] | None]:
    """The links of a `dh2urdf.stages.HeldRobot`."""
    return {name: (float(body.mass), tuple(body.com), tuple(body.inertia)) for name, body in bodies.items()}


def told_shapes(shapes: Iterable[tuple[str, str, Lengths | None]]) -> dict[str, dict[str, list[Lengths]]]:
    """The shapes of a `dh2urdf.stages.HeldRobot`, of links and kinds; None is a size that nobody tells."""
    found: dict[str, dict[str, list[Lengths]]] = {}
    for link, kind, size in shapes:
        if size:
            found.setdefault(link, {}).setdefault(kind, []).append(size)
    return found


def refused(error: BaseException | str, question: Question) -> LoaderError:
    """A simulator's refusal of a file: its words in one line, with places in the file as ``line 12``.

    An empty text says that the reason is in what the simulator prints.
    """
    words = str(error).replace(f"/{question.path}:", "line ").replace(f"{question.path}:", "line ")
    words = words.replace(str(question.path), question.path.name)
    return LoaderError(" ".join(words.split()))


def lengths(x: float, y: float, z: float) -> Lengths:
    """The lengths of a shape along its axes, the longest first [m]."""
    first, second, third = sorted((float(x), float(y), float(z)), reverse=True)
    return first, second, third


def edges(geometry: Geometry) -> Lengths | None:
    """The edges of the box around a shape, in its axes [m]; None of a mesh, whose size only its file has."""
    match geometry:
        case Box(size=size):
            return size
        case Cylinder(radius=radius, length=length):
            return (2 * radius, 2 * radius, length)
        case Sphere(radius=radius):
            return (2 * radius, 2 * radius, 2 * radius)
    return None


def round_lengths(radius: float, length: float | None = None) -> Lengths:
    """The lengths of a sphere, or of a cylinder or a capsule with its caps, the longest first [m]."""
    return lengths(2 * radius, 2 * radius, 2 * radius if length is None else length)


def lengths_of(vertices: Any) -> Lengths:  # noqa: ANN401 - an array of shape (n, 3)
    """The lengths of a mesh along its axes, the longest first [m]."""
    import numpy as np

    return lengths(*np.ptp(np.asarray(vertices, dtype=float).reshape(-1, 3), axis=0))
