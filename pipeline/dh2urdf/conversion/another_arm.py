"""A file that is not the arm of the table, and whose fault it is: of the emitter, or of what made the robot."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import ProofError
from dh2urdf.kinematics.proof import TOLERANCE, Proof, prove
from dh2urdf.source import Problem
from dh2urdf.stages import Edit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.kinematics.expected_poses import ExpectedPoses
    from dh2urdf.kinematics.proof_vectors import Poses
    from dh2urdf.robot import Robot
    from dh2urdf.stage_calls.calls import Call


def makers_at_fault(expected: ExpectedPoses, robot: Robot, poses: Poses, calls: Sequence[Call[Any]]) -> str:
    """The transform and the edits that made a robot which is another arm, in words; empty where it is the table's."""
    with suppress(ProofError):
        if prove(expected, robot, poses).holds:
            return ""
    makers = [call for call in calls if not isinstance(call.stage, Edit) or call.stage.edit_robot is not None]
    return f"the {' and the '.join(str(call.attribution) for call in makers)} made"


def far_off(proof: Proof, expected: ExpectedPoses) -> Problem:
    """How far a file moves a tool0 to other places than the table does."""
    message = (
        f"{proof.tip} is off by {proof.position_error:.3g} m and {proof.angle_error:.3g} rad at q = {list(proof.q)}; "
        f"allowed are {proof.tolerance:.3g} m and {TOLERANCE:.3g} rad"
    )
    return Problem(message=message, robot=expected.name, mark=expected.mark)


def another_arm(problems: Sequence[Problem], what: str) -> ProofError:
    """The error that what somebody made is another arm, for reasons that are given."""
    return ProofError(
        [replace(each, message=f"what {what} is not the arm of the table: {each.message}") for each in problems]
    )
