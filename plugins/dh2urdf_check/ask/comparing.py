"""What a program made of a file beside our own reading of it: links, joints, masses, poses and shapes that differ."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.expected_poses import ExpectedPoses, joint_vectors
from dh2urdf.kinematics.mass import tensor
from dh2urdf.manipulator import JointType
from dh2urdf.measuring import pose_error, written_joint
from dh2urdf.robot import Mesh, with_followers
from dh2urdf.rotations import RigidTransform
from dh2urdf_plugins.loaders.measures import carriers, edges, lumped_bodies

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from dh2urdf.robot import Robot
    from dh2urdf.stages import HeldRobot, Question
    from dh2urdf.stages.foreign_robot import ForeignRobot

POSTURES = 5
"""At how many joint vectors the poses of all links are compared."""
NEAR = 1e-5
"""Difference that is none: a share of a number, or of the arm's reach, or an angle [rad]. PyBullet tells poses in
single precision; a file that is read wrong differs by more."""
WORLD = "world"
"""The root that our reading of an SDF or MJCF adds."""
_ROUND = 1e-3
"""Share of its length by which a shape that is round may be longer, which a program makes of flat faces."""
_HULL = 0.2
"""Share by which a program may take a mesh for larger, which has a margin around it or turned boxes."""
_WITHOUT_END = 1e9
"""A limit beyond which there is none."""


class Difference(NamedTuple):
    """Something that a program has otherwise than the file."""

    rule: str  # its kind, of rules/seen.yaml
    name: str  # the link or joint that it is about
    text: str  # what the program does, as a sentence whose subject it is


def postures(own: ForeignRobot) -> tuple[dict[str, float], ...]:
    """The joint vectors at which poses are compared, the first at rest; within the limits, and joints follow others."""
    robot, followers = own.robot, own.robot.followers
    asked = ExpectedPoses(name=robot.name, tips=(), joints=tuple([joint.name for joint in robot.actuated_joints]))
    values = [dict(zip(asked.joints, q, strict=True)) for q in joint_vectors(asked, robot, POSTURES)]
    return tuple([with_followers(each, followers) for each in values])


def differences(own: ForeignRobot, held: HeldRobot, question: Question) -> list[Difference]:
    """Where a program has something otherwise than our own reading of the file."""
    return [
        *_links(own.robot, held),
        *_joints(own, held),
        *_masses(own.robot, held),
        *_poses(own.robot, held, question),
        *_shapes(own, held),
    ]


def _links(robot: Robot, held: HeldRobot) -> Iterator[Difference]:
    """Links that are not there: merged into the one that holds them by fixed joints, or lost."""
    fixed = {joint.child: joint for joint in robot.joints if joint.type is JointType.FIXED}
    held_by_fixed = {joint.parent for joint in fixed.values()}
    for link in robot.links:
        if link.name in held.links or link.name == WORLD:
            continue
        if link.name in fixed or (link.name == robot.root and (link.name not in held_by_fixed or held.links)):
            into = "the world" if link.name == robot.root else "the link that holds it"
            text = f"merges it into {into}: there is no link of this name"
            if link.name == robot.root and link.inertial is not None and link.inertial.mass > 0.0:
                total = sum(each.inertial.mass for each in robot.links if each.inertial)
                text += f", and {link.inertial.mass:g} of {total:g} kg are gone"
            rule = "seen-lost-root" if link.name == robot.root else "seen-merged-link"
            yield Difference(rule, link.name, text)
        else:
            yield Difference("seen-lost-link", link.name, "has no such link")


def _joints(own: ForeignRobot, held: HeldRobot) -> Iterator[Difference]:
    if not held.joints and own.robot.moving_joints and not any(held.links.values()):
        return  # It tells nothing of joints.
    found = {joint["name"]: joint for joint in held.joints}
    for joint in own.robot.moving_joints:
        there = found.get(joint.name)
        if there is None:
            yield Difference("seen-lost-joint", joint.name, "has no such joint")
            continue
        if joint.type is JointType.REVOLUTE and there.get("type") == "continuous":
            yield Difference("seen-limit", joint.name, "leaves it without limits")
            there = {**there, "type": "revolute", "lower": joint.limits.lower, "upper": joint.limits.upper}
        for field, written in written_joint(joint).items():
            if field not in there or (written is None and field in {"velocity", "effort"}):
                continue
            if not _same(there[field], written):
                rule = "seen-axis" if field == "axis" else "seen-joint-type" if field == "type" else "seen-limit"
                yield Difference(rule, joint.name, f"has the {field} {_shown(there[field])}, not {_shown(written)}")
        if "mimic" in there and there["mimic"] is None and joint.follows:
            text = f"lets it move by itself: it does not follow {joint.follows.leader!r}"
            yield Difference("seen-mimic", joint.name, text)


def _same(found: Any, written: Any) -> bool:  # noqa: ANN401 - words, numbers and vectors
    if isinstance(written, tuple):
        length = math.hypot(*written)
        return length == 0.0 or math.dist(found, [each / length for each in written]) <= NEAR
    if found is None or written is None:
        return found is written or abs(written if found is None else found) >= _WITHOUT_END
    if isinstance(written, float):
        is_endless = abs(found) >= _WITHOUT_END and abs(written) >= _WITHOUT_END
        return bool(is_endless or abs(found - written) <= NEAR * max(abs(written), NEAR))
    return bool(found == written)


def _shown(value: Any) -> str:  # noqa: ANN401 - words, numbers and vectors
    if isinstance(value, tuple | list):
        return f"({', '.join(f'{each:g}' for each in value)})"
    return f"{value:g}" if isinstance(value, float) else "without end" if value is None else str(value)


def _masses(robot: Robot, held: HeldRobot) -> Iterator[Difference]:
    """Masses, centres and inertias of the bodies, each with what fixed joints hold to it where the program merges."""
    told = {name: body for name, body in held.links.items() if body is not None}
    for name, body in lumped_bodies(robot, told.keys() - {WORLD}).items():
        if name not in told:
            continue
        mass, com, inertia = told[name]
        if not abs(mass - body.mass) <= NEAR * max(body.mass, NEAR):
            yield Difference("seen-mass", name, f"has a mass of {mass:g} kg, not {body.mass:g} kg")
            continue
        if body.mass == 0.0:
            continue
        size = math.sqrt(sum(map(abs, tensor(body.inertia)[::4])) / abs(body.mass)) + math.hypot(*body.com)
        if not math.dist(com, body.com) <= NEAR * max(size, NEAR):
            text = f"has the centre of mass at {_shown(com)} m, not {_shown(body.com)} m"
            yield Difference("seen-centre", name, text)
        wanted = tensor(body.inertia)
        most = max(abs(is_ - was) for is_, was in zip(inertia, wanted, strict=True))
        if not most <= NEAR * (sum(map(abs, wanted[::4])) + body.mass * math.hypot(*body.com) ** 2):
            text = f"has an inertia of {_shown(inertia[::4])} kg·m² about the axes, not {_shown(wanted[::4])} kg·m²"
            yield Difference("seen-inertia", name, text)


def _poses(robot: Robot, held: HeldRobot, question: Question) -> Iterator[Difference]:
    """The first link of each chain that is elsewhere: what hangs from it is so for the same reason."""
    parents = {joint.child: joint.parent for joint in robot.joints}
    elsewhere: dict[str, str] = {}
    for number, values in enumerate(question.postures):
        wanted = link_poses(robot, values)
        found = {name: frames[number] for name, frames in held.frames.items() if number < len(frames)}
        known = [name for name in wanted if name in found]
        if not known:
            return
        a, b, c, x, d, e, f, y, g, h, i, z, *_ = found[known[0]]
        first, to_first = RigidTransform((a, b, c, d, e, f, g, h, i), (x, y, z)), wanted[known[0]].inverse
        for name in known:
            own = to_first @ wanted[name]
            distance, angle = pose_error(first @ own, found[name])
            far = distance > NEAR * max(1.0, math.hypot(*own.translation)) or angle > 10 * NEAR
            if far and name not in elsewhere:
                elsewhere[name] = f"has it {distance:.3g} m and {angle:.3g} rad away from where the file puts it"
    for name, text in elsewhere.items():
        if parents.get(name) not in elsewhere:
            yield Difference("seen-pose", name, text)


def _shapes(own: ForeignRobot, held: HeldRobot) -> Iterator[Difference]:
    """Boxes, cylinders and spheres of another size, of bodies where the program has as many shapes as the file."""
    carried = carriers(own.robot, held.links.keys())
    for word in ("visual", "collision"):
        wanted: dict[str, list[list[float]]] = {}
        for link in own.robot.links:
            for shape in link.visuals if word == "visual" else link.collisions:
                lengths = sorted(edges(shape.geometry) or (), reverse=True)  # of a mesh, none
                wanted.setdefault(carried[link.name][0], []).append(lengths)
        for name, sizes in wanted.items():
            found = sorted(held.shapes.get(name, {}).get(word, ()))
            if len(found) == len(sizes) and all(sizes):
                for is_, was in zip(found, sorted(sizes), strict=True):
                    if math.dist(is_, was) > _ROUND * max(was):
                        yield Difference("seen-shape", name, f"has a {word} of {_shown(is_)} m, not {_shown(was)} m")
                        break


def unlike_meshes(robot: Robot, told: Mapping[str, HeldRobot]) -> Iterator[tuple[str, Difference]]:
    """Meshes that programs take for unlike sizes, as they do with a unit that one of them follows: with the program.

    A mesh file is not read here: `told`, the robots that programs made of the file, by their names, are compared with
    the first of them that tells the size.
    """
    meshes = {
        (link.name, word): count
        for link in robot.links
        for word, shapes in (("visual", link.visuals), ("collision", link.collisions))
        if (count := len(shapes)) and all(isinstance(shape.geometry, Mesh) for shape in shapes)
    }
    for (name, word), count in meshes.items():
        sizes = {
            program: sorted(found)
            for program, held in told.items()
            if len(found := held.shapes.get(name, {}).get(word, ())) == count
        }
        if len(sizes) < 2:  # noqa: PLR2004 - two programs to compare
            continue
        (first, reference), *others = sizes.items()
        for program, found in others:
            factors = [max(is_) / max(was) for is_, was in zip(found, reference, strict=True) if max(was) > 0.0]
            worst = max(factors, key=lambda factor: abs(math.log(factor or NEAR)), default=1.0)
            if not 1 / (1 + _HULL) < worst < 1 + _HULL:
                text = f"has a {word} mesh {worst:.4g} times as large as {first} has it: units of length differ"
                yield program, Difference("seen-mesh-size", name, text)
