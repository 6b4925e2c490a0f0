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
    from dh2urdf.plugin_system.calls import Call
    from dh2urdf.robot import Robot

_NOT_THE_ARM = "is not the arm of the table: "


def far_off(proof: Proof, emitter: str, expected: ExpectedPoses) -> ProofError:
    """The error that a file of an emitter moves a tool0 to other places than the table does."""
    message = (
        f"what the emitter {emitter!r} wrote {_NOT_THE_ARM}{proof.tip} is off by "
        f"{proof.position_error:.3g} m and {proof.angle_error:.3g} rad at q = {list(proof.q)}; "
        f"allowed are {proof.tolerance:.3g} m and {TOLERANCE:.3g} rad"
    )
    return ProofError(Problem(message=message, robot=expected.name, mark=expected.mark))


def fault_of(
    error: ProofError, expected: ExpectedPoses, robot: Robot, poses: Poses, makers: Sequence[Call[Any]]
) -> ProofError:
    """The error of a file, or that of the transform and the edits where the robot itself is another arm."""
    with suppress(ProofError):
        if prove(expected, robot, poses).holds:
            return error
    named = [
        str(call.at_work) for call in makers if not (isinstance(call.stage, Edit) and call.stage.edit_robot is None)
    ]
    problems = []
    for problem in error.problems:
        _, _, how = problem.message.rpartition(_NOT_THE_ARM)
        problems.append(replace(problem, message=f"what the {' and the '.join(named)} made {_NOT_THE_ARM}{how}"))
    return ProofError(problems)
