"""A robot as a description, checked before it is written and read back after."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import columns_of
from dh2urdf.commands.arguments import path_or_none, words_of
from dh2urdf.commands.choices import stage_calls
from dh2urdf.conversion.file_endings import refuse_other_ending
from dh2urdf.errors import ProofError, RobotError
from dh2urdf.kinematics.chain import KinematicChain, angle_error, position_error
from dh2urdf.kinematics.proof import TOLERANCE
from dh2urdf.manipulator import JointType
from dh2urdf.meshes.files import FILE, located, prefix_of
from dh2urdf.output.spooled import spooled
from dh2urdf.output.whole_files import safe_stem, write_whole
from dh2urdf.plugin_system.catalog import load
from dh2urdf.robot import Robot
from dh2urdf.robot_check import check_robot
from dh2urdf.source import Mark, Problem
from dh2urdf.stage_calls.calls import a_record, blaming, emitted_files
from dh2urdf.stages import ReadsBack

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping


def write_description(
    robot: Robot, suffix: str, out: str | os.PathLike[str] | None, options: Mapping[str, object], function: str
) -> str:
    """A robot in the format of the files with a suffix, for a function that is called so; see `Robot.to_urdf`."""
    mark = Mark(file=function)
    target = path_or_none("out", out, mark)
    problems = [problem for problem in check_robot(robot) if problem.severity == "error"]
    if columns_of(robot):
        problems.append(Problem(message="a number of the robot is an array", robot=robot.name, accepted="one number"))
    if problems:
        raise RobotError(problem.about(mark=mark) for problem in problems)
    catalog = load()
    emitter: Any = catalog.emitter_for(Path(f"robot{suffix}"))
    if target is not None:
        refuse_other_ending(catalog, Path(target), emitter, mark)
    given = {"emitter": words_of(options)}
    (call,) = stage_calls(catalog, {"emitter": [emitter]}, mark, given)["emitter"]
    robot = located(robot, prefix_of(FILE))
    with blaming(call):
        stem = safe_stem(robot.name)
        content = emitted_files(emitter.emit(robot, stem, call.options), stem)[0].content
        with spooled(content, str(mark), emitter.suffixes[0]) as path:
            described: Robot = a_record(emitter.can(ReadsBack).read_back(path), Robot)
    _compare(robot, described, mark)
    if target is not None:
        write_whole(Path(target), content)
    return content.decode()


def _compare(robot: Robot, described: Robot, mark: Mark) -> None:
    """Compare every way from the root to an outermost link, at four joint vectors."""
    parents = {joint.parent for joint in robot.joints}
    for tip in (joint.child for joint in robot.joints if joint.child not in parents):
        given, found = (KinematicChain.between(each, robot.root, tip) for each in (robot, described))
        limits = [joint.limits for joint in given.joints if joint.type is not JointType.FIXED]
        bounds = [
            (-math.pi if each.lower is None else each.lower, math.pi if each.upper is None else each.upper)
            for each in limits
        ]
        for part in (0.0, 1.0, 0.3, 0.7):
            parts = [part if number % 2 else 1.0 - part for number in range(len(bounds))]
            q = [lower + share * (upper - lower) for share, (lower, upper) in zip(parts, bounds, strict=True)]
            left, right = given.forward_kinematics(q), found.forward_kinematics(q)
            position, angle = position_error(left, right), angle_error(left, right)
            if not (position <= TOLERANCE and angle <= TOLERANCE):
                message = f"what was written has {tip} {position:.3g} m and {angle:.3g} rad away at q = {q}"
                raise ProofError(Problem(message=message, mark=mark, robot=robot.name))
