"""The proof of attachments: what was written has every link of theirs where their own files have it.

With the pose X of an attachment's first link in the link that holds it, T(root → link) of the written robot has to be
T(root → holder) · X · T(first link → link), where the last factor is that of the file of the attachment alone, as its
own reader has it. Joints that follow others move by the law of that file.
"""

from __future__ import annotations

import math
from functools import reduce
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import INERTIA
from dh2urdf.errors import ProofError
from dh2urdf.kinematics.chain import link_poses
from dh2urdf.kinematics.expected_poses import fractions
from dh2urdf.robot import with_followers
from dh2urdf.rotations import greater_of, hypot, is_column, norm, subtract
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.robot import Attachment, Inertial, Joint, Robot
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.source import Problem

say = Messages(__file__)

BOUND = 1e-12
"""What a link may be away from its place: [m] per metre of its distance, at least per 1 m, and [rad]."""
VECTORS = 8
"""Joint vectors at which links are compared, besides zero and both ends of the limits."""


def prove_attachments(robot: Robot, written: Robot, *, masses: bool = True) -> None:
    """Check that what was read back from a file has the attachments of the robot that it was written of; takes columns.

    Args:
        robot: the robot that was written.
        written: what its file says.
        masses: whether it also says masses and shapes.

    Raises:
        ProofError: a link is missing or not in its place, or its mass is another one.
    """
    problems = [problem for each in robot.attachments for problem in _problems(each, written, masses=masses)]
    if masses and robot.attachments and not problems:
        counts = [sum(len(link.shapes) for link in each.links) for each in (robot, written)]
        if counts[0] != counts[1]:
            problems.append(say("attached-shapes-lost", wanted=counts[0], count=counts[1]))
    if problems:
        raise ProofError([problem.about(robot=robot.name) for problem in problems[:5]])


def _problems(attachment: Attachment, written: Robot, *, masses: bool) -> Iterator[Problem]:
    prefix, part = attachment.prefix, attachment.robot
    names = {link.name for link in written.links}
    if missing := [prefix + link.name for link in part.links if prefix + link.name not in names]:
        yield say("attached-link-missing", name=attachment.name, link=missing[0])
        return
    placement, size = attachment.placement.transform, max(1.0, norm(attachment.placement.xyz))
    for q in _joint_vectors(part):
        alone = link_poses(part, q)
        found = link_poses(written, {prefix + name: value for name, value in q.items()})
        held = found[attachment.parent].inverse
        for link in part.links:
            wanted, there = placement @ alone[link.name], held @ found[prefix + link.name]
            error = _largest(_difference(wanted, there))
            if not error <= BOUND * max(size, norm(wanted.translation)):
                told = ", ".join(f"{name} = {value:.6g}" for name, value in q.items())
                yield say("attached-link-moved", name=attachment.name, link=prefix + link.name, error=error, q=told)
                return
    bodies = {link.name: link.inertial for link in written.links}
    for link in part.links if masses else ():
        if not _same_body(link.inertial, bodies[prefix + link.name]):
            yield say("attached-mass-changed", name=attachment.name, link=prefix + link.name)


def _joint_vectors(part: Robot) -> Iterator[dict[str, float]]:
    """Values of the joints that move by themselves [rad or m]: zero, both ends of their limits, and some between."""
    joints = part.actuated_joints
    names, ranges = [joint.name for joint in joints], [_range(joint) for joint in joints]
    yield dict.fromkeys(names, 0.0)
    for shares in ((0.0,) * len(joints), (1.0,) * len(joints), *fractions(len(joints), VECTORS)) if joints else ():
        values = [low + share * (high - low) for share, (low, high) in zip(shares, ranges, strict=True)]
        yield dict(zip(names, values, strict=True))


def _range(joint: Joint) -> tuple[float, float]:
    lower, upper = joint.limits.lower, joint.limits.upper
    if lower is None or upper is None or not (-1e3 < lower <= upper < 1e3):  # noqa: PLR2004 - as `LARGEST_SAMPLE` has it
        return -math.pi, math.pi
    return lower, upper


def whole_vectors(robot: Robot, vectors: Sequence[Mapping[str, float]]) -> Iterator[dict[str, float]]:
    """The values of all moving joints [rad or m], given those of a table: others are drawn, and followers follow."""
    others = [joint for joint in robot.actuated_joints if vectors and joint.name not in vectors[0]]
    for number, (given, shares) in enumerate(zip(vectors, fractions(len(others), len(vectors)), strict=True)):
        drawn = {}
        for joint, share in zip(others, shares, strict=True):
            low, high = _range(joint)
            drawn[joint.name] = low + share * (high - low) if number else min(max(0.0, low), high)
        yield with_followers({**given, **drawn}, robot.followers)


def leaves(robot: Robot) -> list[str]:
    """The links of attachments that hold no other link."""
    holders = {joint.parent for joint in robot.joints}
    names = [each.prefix + link.name for each in robot.attachments for link in each.robot.links]
    return [name for name in names if name not in holders]


def _difference(one: RigidTransform, other: RigidTransform) -> Any:  # noqa: ANN401 - a number or a column
    """How far two frames are from each other: the greater of the distance [m] and the distance of their axes."""
    turned = hypot(*[left - right for left, right in zip(one.rotation, other.rotation, strict=True)])
    return greater_of(norm(subtract(one.translation, other.translation)), turned)


def _largest(error: Any) -> float:  # noqa: ANN401 - a number or a column
    return float(reduce(max, error.tolist())) if is_column(error) else float(error)


def _same_body(one: Inertial | None, other: Inertial | None) -> bool:
    if one is None or other is None or not one.mass:
        return not (one and one.mass) and not (other and other.mass)
    pairs = [(one.mass, other.mass), *zip(one.com, other.com, strict=True)]
    pairs += [(getattr(one.inertia, name), getattr(other.inertia, name)) for name in INERTIA]
    size = max(abs(getattr(one.inertia, name)) for name in INERTIA)
    return all(abs(left - right) <= BOUND * max(abs(left), size, 1e-30) for left, right in pairs)
