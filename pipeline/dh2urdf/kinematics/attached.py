"""The proof of attachments: what was written has every link of theirs where their own files have it.

With the pose X of an attachment's first link in the link that holds it, T(root → link) of the written robot has to be
T(root → holder) · X · T(first link → link), where the last factor is that of the file of the attachment alone, as its
own reader has it. Joints that follow others move by the law of that file.
"""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import INERTIA
from dh2urdf.errors import ProofError
from dh2urdf.kinematics.chain import link_poses
from dh2urdf.kinematics.expected_poses import ExpectedPoses, proof_vectors
from dh2urdf.rotations import greater_of, hypot, is_column, norm, subtract
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Inertial, Robot
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.source import Problem

say = Messages(__file__)

BOUND = 1e-12
"""What a link may be away from its place: [m] per metre of its distance, at least per 1 m, and [rad]."""
VECTORS = 9
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
    problems = [*_lost(robot, written)] or [*_moved(robot, written)] or [*(_changed(robot, written) if masses else ())]
    if problems:
        raise ProofError([problem.about(robot=robot.name) for problem in problems[:5]])


def _lost(robot: Robot, written: Robot) -> Iterator[Problem]:
    """Links that the file does not have."""
    names = {link.name for link in written.links}
    for each in robot.attachments:
        missing = [each.prefix + link.name for link in each.robot.links if each.prefix + link.name not in names]
        if missing:
            yield say("attached-link-missing", name=each.name, link=missing[0])


def _moved(robot: Robot, written: Robot) -> Iterator[Problem]:
    """Links that are not in their places, of each attachment the first one."""
    told = set[str]()
    for vectors in zip(*(_vectors(each.robot) for each in robot.attachments), strict=True):
        both = list(zip(robot.attachments, vectors, strict=True))
        found = link_poses(written, {each.prefix + name: value for each, q in both for name, value in q.items()})
        for each, q in both:
            placement, size = each.placement.transform, max(1.0, norm(each.placement.xyz))
            alone, held = link_poses(each.robot, q), found[each.parent].inverse
            for link in each.robot.links if each.prefix not in told else ():
                wanted, name = placement @ alone[link.name], each.prefix + link.name
                error = _largest(_difference(wanted, held @ found[name]))
                if not error <= BOUND * max(size, norm(wanted.translation)):
                    at = ", ".join(f"{joint} = {value:.6g}" for joint, value in q.items())
                    yield say("attached-link-moved", name=each.name, link=name, error=error, q=at)
                    told.add(each.prefix)
                    break


def _changed(robot: Robot, written: Robot) -> Iterator[Problem]:
    """Links with another mass, or with fewer shapes."""
    links = {link.name: link for link in written.links}
    for each in robot.attachments:
        for link in each.robot.links:
            found = links[each.prefix + link.name]
            about: dict[str, Any] = {"name": each.name, "link": found.name}
            if not _same_body(link.inertial, found.inertial):
                yield say("attached-mass-changed", **about)
            # SDF and MJCF have the shapes of a frame without mass on the body that holds it.
            if link.inertial and link.inertial.mass and len(found.shapes) < len(link.shapes):
                yield say("attached-shapes-lost", wanted=len(link.shapes), count=len(found.shapes), **about)


def _vectors(part: Robot) -> list[dict[str, float]]:
    """Values of the joints of a robot that move by themselves [rad or m]: those of the proof of an arm."""
    own = ExpectedPoses(name=part.name, tips=(), joints=tuple([joint.name for joint in part.actuated_joints]))
    return [dict(zip(own.joints, q, strict=True)) for q in proof_vectors(own, part, VECTORS)]


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
