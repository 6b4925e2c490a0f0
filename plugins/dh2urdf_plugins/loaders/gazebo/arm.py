"""The arm as sdformat hands it to Gazebo, compared with the robot that was written.

sdformat lumps what a fixed joint holds into the link that carries it: of a URDF, flange and tool0 are no links in
Gazebo. (Later versions keep a frame of the name.) So links are compared with the sum of what they carry, and tool0 is
measured at its carrier, times the transform between the two that was written.
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.manipulator import WORLD, JointType
from dh2urdf.mass_properties import compound, placed
from dh2urdf.measuring import DOUBLE
from dh2urdf.robot import Inertial
from dh2urdf.rotations import IDENTITY, RigidTransform, quarter_turns
from dh2urdf.source import shown
from dh2urdf.stages import LoadReport
from dh2urdf_plugins.base_bodies import with_base_bodies

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.measuring import Precision
    from dh2urdf.robot import Robot
    from dh2urdf.source import Problem
    from dh2urdf_plugins.loaders.gazebo.sdf_model import SdfJoint, SdfModel
    from dh2urdf_plugins.loaders.measures import Comparison


class Arm:
    """The arm as sdformat has it, beside the robot that was written."""

    def __init__(self, model: SdfModel, comparison: Comparison) -> None:
        self.model, self.comparison, self.robot = model, comparison, comparison.robot
        self.carriers = self._carriers()

    def report(self, version: str) -> LoadReport:
        """Measure everything.

        Args:
            version: that of sdformat.

        Raises:
            LoaderError: sdformat holds another arm.
        """
        joints = tuple(_held_joint(joint) for joint in self.model.joints if joint.type != "fixed")
        masses, problems = self.comparison.masses(self.model.links, self._written_bodies())
        if problems := [*self.comparison.joints(joints), *problems]:
            raise LoaderError(problems)
        report = LoadReport(simulator="sdformat", version=version, joints=joints, **masses)
        return replace(report, **self.comparison.poses(self._frames), findings=self._lumped())

    def _carriers(self) -> dict[str, tuple[str, RigidTransform]]:
        """Of every link that was written, the link that it became or is lumped into, and its pose there."""
        above = {joint.child: joint for joint in self.robot.joints}
        carriers: dict[str, tuple[str, RigidTransform]] = {}
        for link in self.robot.links:  # Parents before children.
            joint = above.get(link.name)
            if link.name in self.model.links or joint is None or joint.type is not JointType.FIXED:
                carriers[link.name] = (link.name, IDENTITY)
            elif joint.parent in carriers:
                carrier, pose = carriers[joint.parent]
                carriers[link.name] = (carrier, pose @ joint.origin.transform)
        return carriers

    def _written_bodies(self) -> dict[str, Inertial]:
        """What the links of the model should be: the sums of what they carry."""
        carried: dict[str, list[Inertial]] = {}
        for link in with_base_bodies(self.robot).links:  # sdformat has no arm whose base weighs nothing
            carrier, pose = self.carriers[link.name]
            parts = carried.setdefault(carrier, [])
            if link.inertial and link.inertial.mass:
                parts.append(placed(link.inertial, pose))
        return {
            name: compound(parts) if parts else Inertial(mass=0.0)
            for name, parts in carried.items()
            if parts or name not in {WORLD, *self.model.poses} - {*self.model.links}  # No link need be in a mere frame.
        }

    def _frames(self, q: Sequence[float], links: Sequence[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the root at a joint vector."""
        values = {joint.name: value for joint, value in zip(self.robot.moving_joints, q, strict=True)}
        held = self.model.frames(values)
        to_root = held[self.robot.root].inverse
        frames = {}
        for name in links:
            carrier, pose = (name, IDENTITY) if name in held else self.carriers[name]
            frames[name] = to_root @ held[carrier] @ pose
        return frames

    def _lumped(self) -> tuple[Problem, ...]:
        """The frames that are missing in Gazebo: a person looks for tool0 there in vain."""
        lost = [
            link.name
            for link in self.robot.links[1:]
            if link.name not in self.model.poses and not (link.inertial and link.inertial.mass)
        ]
        if not lost:
            return ()
        names = ", ".join(f"{shown(name)} (in {shown(self.carriers[name][0])})" for name in lost)
        return (
            self.comparison.problem(
                message=f"Gazebo has no frame of the links that sdformat lumped into others: {names}",
                severity="notice",
            ),
        )


def precision(robot: Robot) -> Precision:
    """What sdformat's arithmetic is: double precision, written in 16 digits, and less near the singular pitch.

    It reads a joint's roll, pitch and yaw, keeps a quaternion, and writes them anew. It takes the pitch from an asin:
    near ±π/2 that loses as many digits as the cosine of the pitch is small, half of all at the worst. (Exactly there
    it does not.) Lumping moves an inertia to another point, so that of a body far from there its digits count as little
    as beside m·r².
    """
    epsilon = sys.float_info.epsilon
    pitches = [joint.origin.rpy[1] for joint in robot.joints]
    lost = 4.0 * sum(
        min(epsilon / abs(math.cos(pitch)), math.sqrt(epsilon)) for pitch in pitches if quarter_turns(pitch) is None
    )
    return DOUBLE._replace(
        position=DOUBLE.position + lost, angle=DOUBLE.angle + lost, inertia_about_origin=4.0 * epsilon
    )


def _held_joint(joint: SdfJoint) -> dict[str, Any]:
    """A joint as sdformat has it."""
    endless = joint.type == "revolute" and joint.lower is None and joint.upper is None
    return {
        "name": joint.name,
        "type": "continuous" if endless else joint.type,
        "axis": joint.axis,
        "lower": joint.lower,
        "upper": joint.upper,
        "velocity": joint.velocity,
        "effort": joint.effort,
    }
