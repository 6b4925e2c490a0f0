"""What a proof reads: robots that hold all that is in their files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.errors import ProofError
from dh2urdf.source import Problem, shown

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.robot import Robot
    from dh2urdf.source import Mark


def whole(robot: Robot, loose: Mapping[str, str], unread: Mapping[str, Sequence[Mark]], accepted: str) -> Robot:
    """A robot of which nothing was left out.

    Args:
        robot: the robot of a file.
        loose: the types of joints that no table has, by name.
        unread: what could not be read, by the words for it: the places.
        accepted: the types of joints that the format has and tables, too.

    Raises:
        ProofError: something was left out.
    """
    for joint in robot.joints if loose else ():
        if (kind := loose.get(joint.name)) is not None:
            raise ProofError(not_of_a_manipulator(kind, accepted, joint.mark))
    for what, (mark, *_) in unread.items():
        raise ProofError(Problem(message=f"{what} is not read here", mark=mark))
    return robot


def not_of_a_manipulator(kind: str, accepted: str, mark: Mark | None) -> Problem:
    """The problem of a joint whose type is not one of a manipulator."""
    return Problem(message=f"joint type {shown(kind)} is not one of a manipulator", accepted=accepted, mark=mark)
