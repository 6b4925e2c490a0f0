"""Hands a written file to a simulator, and says what it should find there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.attribution import Call, blaming
from dh2urdf.isolation import load_in_child
from dh2urdf.kinematics import KinematicChain
from dh2urdf.proof import joint_vectors
from dh2urdf.source import shown
from dh2urdf.stage_answers import a_plain_name, a_record
from dh2urdf.stages import Loader, LoadReport, LoadRequest

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from dh2urdf.conversion import Written
    from dh2urdf.robot import Robot
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.truth import Truth


def load_written(
    truth: Truth,
    robot: Robot,
    call: Call[Loader[Any]],
    written: Sequence[Written],
    *,
    keeps_kinematics: bool,
    picture: Path,
) -> LoadReport:
    """What a simulator says of the file that was written beside where the picture goes.

    Where the transform does not keep the kinematics, the simulator is held against the robot, not against the tables.
    """
    loader = call.stage
    names = {emitted.stage: emitted.files[0].name for emitted in written}
    path = next(picture.with_name(names[wanted]) for wanted in loader.formats if wanted in names)
    with blaming(call, "poses"):
        count = a_record(loader.poses(call.options), int)
    poses = joint_vectors(truth, robot, count)
    with blaming(call, "picture"):
        pictured = a_record(loader.picture(call.options), bool)
    expected: dict[str, tuple[tuple[float, ...], ...]] = {}
    for tip in truth.tips:
        chain = KinematicChain.between(robot, truth.root, tip.link)
        expected[tip.link] = tuple(
            _elements(tip.pose(q) if keeps_kinematics else chain.forward_kinematics(tip.values(q))) for q in poses
        )
    request = LoadRequest(
        path=path,
        robot=robot,
        poses=poses,
        expected=expected,
        mark=truth.mark,
        picture=picture if pictured else None,
    )
    with blaming(call):
        report = load_in_child(loader, request, call.options, f"the {call.at_work}")
        if report.picture and not picture.with_name(a_plain_name(report.picture)).is_file():
            raise ValueError(f"it reported a picture {shown(report.picture)} and wrote none")
        return report


def _elements(frame: RigidTransform) -> tuple[float, ...]:
    """A rigid transform as the 16 elements of its homogeneous matrix, row by row."""
    r, t = frame
    return (*r[0:3], t[0], *r[3:6], t[1], *r[6:9], t[2], 0.0, 0.0, 0.0, 1.0)
