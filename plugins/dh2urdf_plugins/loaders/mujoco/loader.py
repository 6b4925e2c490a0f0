"""The loader `mujoco`: loads the written MJCF or URDF, measures the arm, and takes what MuJoCo reports about it.

MuJoCo compiles a file into arrays: orientations become quaternions, an inertia its principal moments in a frame of
their own, fixed links without `fusestatic="false"` a part of the link that holds them. It has no velocity limits.
https://mujoco.readthedocs.io/en/stable/modeling.html says, under "URDF extensions", what it reads of a URDF.

Quaternions and principal moments cost little: over the published arms, tool0 was found within 5e-16 of the reach and
3e-15 rad, inertias within 5e-15 of their trace. So MuJoCo is measured with what any double precision is allowed.
"""

from __future__ import annotations

import contextlib
import importlib
import math
import os
import sys
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.mass import GRAVITY
from dh2urdf.manipulator import JointType
from dh2urdf.source import Messages, shown
from dh2urdf_plugins.home_pose import stepped
from dh2urdf_plugins.loaders.measures import (
    HOLD_SECONDS,
    HOLD_STAYS,
    OVERLAP,
    Comparison,
    farthest,
    hold_start,
    printed,
)
from dh2urdf_plugins.loaders.mujoco.model import Model, complaints, print_warning
from dh2urdf_plugins.loaders.simulators import PACKAGES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.rotations import RigidTransform
    from dh2urdf.source import Problem
    from dh2urdf.stages import LoadReport, LoadRequest
    from dh2urdf_plugins.loaders.simulators import PictureOptions

say = Messages(__file__)

TIME_STEP = 0.001
"""Time step of the hold test [s]."""
YIELD = HOLD_STAYS / 4
"""Displacement at which a motor of the hold test gives its full effort [rad or m]."""
MOTOR_SETTLING = 0.05
"""Time constant with which such a motor settles [s]."""
WEIGHT_RISES = HOLD_SECONDS / 2
"""Time in which the weight comes on [s]; all at once, it would fall into the motors and ask for twice the effort."""
FOLLOW_SECONDS = 3.0
"""Time that the arm has to follow a step of its targets [s]."""
REACHED = 0.005
"""Distance from its target at which a joint has reached it [rad or m]."""
OVERSHOOT = 0.5
"""Share of the step by which a joint may overshoot at most."""
FASTEST_JOINT = 8.0
"""Speed up to which a joint follows a step without being thrown [rad/s or m/s]."""
HELD_JOINTS = 300
"""Largest number of joints of a hold test: the time of a step grows with its cube, and beyond it takes minutes."""


class Arm(Model):
    """The arm as MuJoCo holds it, beside the robot that was written; its root is in the world's origin.

    Raises:
        LoaderError: MuJoCo cannot load the file, or has fused links of it.
    """

    def __init__(self, mujoco: Any, request: LoadRequest) -> None:  # noqa: ANN401 - a module without type information
        self.request, self.robot = request, request.robot
        self.comparison = Comparison("MuJoCo", request)
        try:
            super().__init__(mujoco, request.path.resolve())
        except (ValueError, mujoco.FatalError) as error:
            said = " ".join(str(error).split())
            raise LoaderError(self.comparison.placed(say("mujoco-cannot-load", reason=said))) from error
        self._servo = int(mujoco.mjtBias.mjBIAS_AFFINE)
        self._refuse_fused_links()

    def report(self) -> LoadReport:
        """Measure everything but the picture.

        Raises:
            LoaderError: MuJoCo holds another arm.
        """
        joints = [self.held_joint(number) for number in range(self.model.njnt)]
        report = self.comparison.loaded(version("mujoco"), joints, self.held_bodies())
        joints = [{**joint, "velocity": None} for joint in joints]
        report = replace(report, joints=tuple(joints), **self.comparison.poses(self.frames))
        if not joints:
            return report
        if len(joints) > HELD_JOINTS:
            found, accepted = f"{len(joints)} moving joints", f"at most {HELD_JOINTS} moving joints"
            return replace(report, findings=self.comparison.too_large("mujoco-hold-left-out", found, accepted))
        hold, findings = self._hold()
        if hold["stayed"] and self.model.nkey and (self.model.actuator_biastype == self._servo).any():
            followed, more_findings = self._follow()
            hold, findings = {**hold, **followed}, (*findings, *more_findings)
        return replace(report, hold=hold, findings=findings)

    def addresses(self, model: Any) -> list[int]:  # noqa: ANN401 - MuJoCo's model
        """Where in a model's array of positions the values of a joint vector stand."""
        return [int(model.joint(joint.name).qposadr[0]) for joint in self.robot.moving_joints]

    def frames(self, q: Sequence[float], links: Sequence[str]) -> dict[str, RigidTransform]:
        """The frames of some links, sites among them, in the world at a joint vector."""
        self.data.qpos[self.addresses(self.model)] = q
        self.mujoco.mj_kinematics(self.model, self.data)
        return self.placed(links)

    def _refuse_fused_links(self) -> None:
        held = {*self.bodies, *self.sites}
        if fused := [shown(link.name) for link in self.robot.links if link.name not in held]:
            raise LoaderError(self.comparison.placed(say("mujoco-fused-links", links=fused)))

    # The hold test

    def _hold(self) -> tuple[dict[str, Any], tuple[Problem, ...]]:
        """Whether motors keep the arm where it is under gravity, with the efforts that MuJoCo read."""
        mujoco, start = self.mujoco, hold_start(self.robot)
        model = self._with_motors()
        model.opt.timestep = TIME_STEP
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        data, places = mujoco.MjData(model), self.addresses(model)
        data.qpos[places] = start
        data.ctrl[:] = data.qpos[[int(model.jnt_qposadr[joint]) for joint in model.actuator_trnid[:, 0]]]
        mujoco.mj_forward(model, data)
        contacts = self._overlaps(data)
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT

        def vectors() -> Iterator[Any]:
            for step in range(round(HOLD_SECONDS / TIME_STEP)):
                model.opt.gravity[:] = (0.0, 0.0, -GRAVITY * min(1.0, step * TIME_STEP / WEIGHT_RISES))
                mujoco.mj_step(model, data)
                if any(data.warning[kind].number for kind in _divergence(mujoco)):
                    yield [math.inf] * len(places)  # MuJoCo has put the arm back to where it began.
                    return
                yield data.qpos[places]

        return self.comparison.hold(start, farthest(start, vectors()), contacts)

    def _with_motors(self) -> Any:  # noqa: ANN401 - MuJoCo's model
        """The model with a position servo on every joint, which MuJoCo itself keeps within the effort it read.

        A servo that the file has is taken as it is; a motor gets a control. The servo is a stiff spring and damper. The
        damper is integrated implicitly: with a time constant of half a time step or more, the two are stable at any
        stiffness.
        """
        mujoco = self.mujoco
        spec = mujoco.MjSpec.from_file(str(self.request.path.resolve()))
        own = {actuator.target: actuator for actuator in spec.actuators}
        for joint in self.robot.moving_joints:
            servo = own.get(joint.name)
            if not (effort := joint.limits.effort) or (servo and servo.biastype == self._servo):
                continue
            stiffness = effort / YIELD
            servo = servo or spec.add_actuator(name=f"hold {joint.name}", target=joint.name)
            servo.trntype = mujoco.mjtTrn.mjTRN_JOINT
            servo.gaintype, servo.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
            servo.gainprm[0] = stiffness
            servo.biasprm[1], servo.biasprm[2] = -stiffness, -stiffness * MOTOR_SETTLING
            servo.ctrllimited = mujoco.mjtLimited.mjLIMITED_FALSE
        return spec.compile()

    def _follow(self) -> tuple[dict[str, Any], tuple[Problem, ...]]:
        """Whether the servos of the file bring all joints to targets a step from home, with its own time steps."""
        import numpy as np

        mujoco, model = self.mujoco, self.model
        data, joints = mujoco.MjData(model), [joint for joint in self.robot.moving_joints if joint.limits.effort]
        places = [int(model.joint(joint.name).qposadr[0]) for joint in joints]
        mujoco.mj_resetDataKeyframe(model, data, 0)
        start = data.qpos[places]
        target = np.array([stepped(joint, 1.0) for joint in joints])
        for joint, value in zip(joints, target, strict=True):
            data.actuator(joint.name).ctrl[0] = value
        beyond, speed = np.zeros(len(joints)), 0.0
        for _ in range(round(FOLLOW_SECONDS / model.opt.timestep)):
            mujoco.mj_step(model, data)
            beyond = np.fmax(beyond, (data.qpos[places] - target) / (target - start))
            speed = max(speed, float(np.abs(data.qvel).max()))
        errors, overshoot = np.abs(data.qpos[places] - target), float(beyond.max())
        if any(data.warning[kind].number for kind in _divergence(mujoco)):
            errors[:] = np.inf
        error, joint = float(errors.max()), joints[int(errors.argmax())]
        followed = {
            "target_error": error if math.isfinite(error) else None,
            "overshoot": overshoot,
            "largest_speed": speed,
        }
        if error <= REACHED and overshoot < OVERSHOOT and speed <= FASTEST_JOINT:
            return followed, ()
        unit = "m" if joint.type is JointType.PRISMATIC else "rad"
        by = f"{error:.3g} {unit} from its target" if math.isfinite(error) else "thrown away"
        about = {"seconds": FOLLOW_SECONDS, "by": by, "overshoot": overshoot, "speed": speed}
        return followed, (self.comparison.weak(joint, "servos-do-not-follow", **about),)

    def _overlaps(self, data: Any) -> list[tuple[str, str]]:  # noqa: ANN401 - MuJoCo's data
        """The pairs of links, none joined to the other, whose collision shapes overlap."""
        names = {number: name for name, number in self.bodies.items()}
        body = self.model.geom_bodyid
        touching = [contact for contact in data.contact if contact.dist < -OVERLAP]
        return self.comparison.overlapping((names[body[each.geom1]], names[body[each.geom2]]) for each in touching)


def _divergence(mujoco: Any) -> tuple[int, ...]:  # noqa: ANN401 - a module without type information
    """The warnings after which MuJoCo begins the simulation anew."""
    kinds = mujoco.mjtWarning
    return (int(kinds.mjWARN_BADQPOS), int(kinds.mjWARN_BADQVEL), int(kinds.mjWARN_BADQACC))


def prepare(options: PictureOptions) -> None:
    """Import MuJoCo, which asks the environment once, while it is imported, by what to render.

    Raises:
        MissingDependencyError: MuJoCo, or Pillow for a picture, is not installed.
    """
    from dh2urdf_plugins.loaders.mujoco.picture import graphics

    if library := graphics() if options.picture else "disable":
        os.environ["MUJOCO_GL"] = library
    with contextlib.suppress(Exception):  # Whatever a broken graphics library raises: MuJoCo works without one.
        importlib.import_module("mujoco")
    if "mujoco" not in sys.modules:
        os.environ["MUJOCO_GL"] = "disable"
    PACKAGES["mujoco"].load(options)


def load(request: LoadRequest, options: PictureOptions) -> LoadReport:
    """Load an MJCF or a URDF into MuJoCo and measure it.

    A picture that cannot be taken, where there is no graphics library, is a finding.

    Raises:
        LoaderError: MuJoCo cannot load the file, or holds another arm than the one that was written.
        MissingDependencyError: MuJoCo, or Pillow for a picture, is not installed.
    """
    from dh2urdf_plugins.loaders.mujoco.picture import NoGraphicsError, write_picture

    prepare(options)
    mujoco = sys.modules["mujoco"]
    mujoco.set_mju_user_warning(print_warning)
    arm = Arm(mujoco, request)
    report = arm.report()
    if request.picture:
        try:
            write_picture(mujoco, request.path, arm, request.picture)
        except NoGraphicsError as error:
            finding = arm.comparison.placed(say("mujoco-no-picture", reason=error))
            return replace(report, findings=(*report.findings, finding))
        report = replace(report, picture=request.picture.name)
    return report


def read_output(request: LoadRequest, output: str) -> tuple[Problem, ...]:
    """MuJoCo's warnings; what graphics libraries print is not about the arm."""
    return printed("MuJoCo", request, [("", text) for text in complaints(output)])
