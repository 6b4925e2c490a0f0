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
import re
import sys
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.mass import GRAVITY
from dh2urdf.manipulator import JointType
from dh2urdf.measuring import Body
from dh2urdf.rotations import ZERO, RigidTransform, multiply, transpose
from dh2urdf.source import shown
from dh2urdf_plugins.home_pose import stepped
from dh2urdf_plugins.loaders.measures import (
    HOLD_SECONDS,
    HOLD_STAYS,
    OVERLAP,
    Comparison,
    farthest,
    hold_start,
    printed,
    rotation,
    vector,
)
from dh2urdf_plugins.loaders.simulators import PACKAGES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.source import Problem
    from dh2urdf.stages import LoadReport, LoadRequest
    from dh2urdf_plugins.loaders.simulators import PictureOptions

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


class Arm:
    """The arm as MuJoCo holds it, beside the robot that was written; its root is in the world's origin.

    Raises:
        LoaderError: MuJoCo cannot load the file, or has fused links of it.
    """

    def __init__(self, mujoco: Any, request: LoadRequest) -> None:  # noqa: ANN401 - a module without type information
        self.mujoco, self.request, self.robot = mujoco, request, request.robot
        self.comparison = Comparison("MuJoCo", request)
        try:
            self.model = mujoco.MjModel.from_xml_path(str(request.path.resolve()))
        except (ValueError, mujoco.FatalError) as error:
            said = " ".join(str(error).split())
            raise LoaderError(self.comparison.problem(message=f"MuJoCo cannot load the file: {said}")) from error
        self.data = mujoco.MjData(self.model)
        self.bodies = {self.model.body(number).name: number for number in range(self.model.nbody)}
        sites = {self.model.site(number).name: number for number in range(self.model.nsite)}
        self.sites = {name: number for name, number in sites.items() if name not in self.bodies}
        self.joints = {self.model.joint(number).name: number for number in range(self.model.njnt)}
        self._servo = int(mujoco.mjtBias.mjBIAS_AFFINE)
        self._refuse_fused_links()

    def report(self) -> LoadReport:
        """Measure everything but the picture.

        Raises:
            LoaderError: MuJoCo holds another arm.
        """
        joints = [self._held_joint(number) for number in range(self.model.njnt)]
        report = self.comparison.loaded(version("mujoco"), joints, self._held_bodies())
        joints = [{**joint, "velocity": None} for joint in joints]
        report = replace(report, joints=tuple(joints), **self.comparison.poses(self.frames))
        if not joints:
            return report
        if len(joints) > HELD_JOINTS:
            message = "MuJoCo would take minutes for the hold test of so large an arm: it was left out"
            found, accepted = f"{len(joints)} moving joints", f"at most {HELD_JOINTS} moving joints"
            return replace(report, findings=self.comparison.too_large(message, found, accepted))
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
        data = self.data
        data.qpos[self.addresses(self.model)] = q
        self.mujoco.mj_kinematics(self.model, data)
        frames = {}
        for name in links:
            if name in self.sites:
                site = self.sites[name]
                frames[name] = RigidTransform(rotation(data.site_xmat[site]), vector(data.site_xpos[site]))
            else:
                body = self.bodies[name]
                frames[name] = RigidTransform(rotation(data.xmat[body]), vector(data.xpos[body]))
        return frames

    # What was loaded

    def _refuse_fused_links(self) -> None:
        held = {*self.bodies, *self.sites}
        if fused := [shown(link.name) for link in self.robot.links if link.name not in held]:
            raise LoaderError(
                self.comparison.problem(
                    message=f"MuJoCo has fused links into those that hold them, or lost them: {', '.join(fused)}",
                    suggestion='it keeps them where the file says <mujoco><compiler fusestatic="false"/></mujoco>',
                )
            )

    def _held_joint(self, number: int) -> dict[str, Any]:
        """A joint as MuJoCo has it; limits that make no sense, it has switched off."""
        model, types = self.model, self.mujoco.mjtJoint
        limited = bool(model.jnt_limited[number])
        kinds = {int(types.mjJNT_HINGE): "revolute" if limited else "continuous", int(types.mjJNT_SLIDE): "prismatic"}
        kind = int(model.jnt_type[number])
        limits = [model.jnt_actfrcrange[number][1]] if model.jnt_actfrclimited[number] else []
        moved_by = model.actuator_trnid[:, 0] == number
        limits += list(model.actuator_forcerange[moved_by & (model.actuator_forcelimited != 0), 1])
        return {
            "name": model.joint(number).name,
            "type": kinds.get(kind, types(kind).name),
            "axis": vector(model.jnt_axis[number]),
            "lower": float(model.jnt_range[number][0]) if limited else None,
            "upper": float(model.jnt_range[number][1]) if limited else None,
            "effort": float(min(limits)) if limits else None,
        }

    def _held_bodies(self) -> dict[str, Body]:
        """The links as MuJoCo has them, a site without mass; inertias are turned back from their principal axes."""
        import numpy as np

        bodies = {name: Body(0.0, ZERO, (0.0,) * 9) for name in self.sites}
        for name, number in self.bodies.items():
            matrix = np.zeros(9)
            self.mujoco.mju_quat2Mat(matrix, self.model.body_iquat[number])
            axes = rotation(matrix)
            a, b, c = vector(self.model.body_inertia[number])
            tensor = multiply(multiply(axes, (a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c)), transpose(axes))
            mass = float(self.model.body_mass[number])
            # The centre of no mass is wherever MuJoCo's compiler left it.
            bodies[name] = Body(mass, vector(self.model.body_ipos[number]) if mass else ZERO, tensor)
        return bodies

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
        message = (
            f"the servos do not follow a step: after {FOLLOW_SECONDS:g} s this joint was {by}; "
            f"joints overshot by up to {overshoot:.0%} of the step, at up to {speed:.3g} rad/s or m/s"
        )
        return followed, (self.comparison.weak(joint, message),)

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
    mujoco.set_mju_user_warning(_print_warning)
    arm = Arm(mujoco, request)
    report = arm.report()
    if request.picture:
        try:
            write_picture(mujoco, request.path, arm, request.picture)
        except NoGraphicsError as error:
            finding = arm.comparison.problem(
                message=f"MuJoCo took no picture: {error}",
                severity="notice",
                suggestion="install EGL (Debian and Ubuntu: apt-get install libegl1 libopengl0 libgl1-mesa-dri), "
                "or say `picture: false`",
            )
            return replace(report, findings=(*report.findings, finding))
        report = replace(report, picture=request.picture.name)
    return report


def _print_warning(text: str | bytes) -> None:
    """Print a warning; without this, MuJoCo writes it into a file in the working directory too."""
    words = text.decode("utf-8", "replace") if isinstance(text, bytes) else text
    os.write(2, f"WARNING: {' '.join(words.split())}\n".encode())


_MESSAGE = re.compile(r"^(?:WARNING|ERROR): *(.+?) *$", re.MULTILINE)
_UNNAMED = "Geom with duplicate name ''"  # MuJoCo 3.3 prints this for every file with two shapes: shapes have no names


def read_output(request: LoadRequest, output: str) -> tuple[Problem, ...]:
    """MuJoCo's warnings; what graphics libraries print is not about the arm."""
    said = [("", text) for text in _MESSAGE.findall(output) if not text.startswith(_UNNAMED)]
    return printed("MuJoCo", request, said)
