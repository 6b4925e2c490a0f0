"""The loader `mujoco`: loads MJCF or URDF into MuJoCo, measures the arm, and takes what MuJoCo reports about it.

MuJoCo compiles a file into arrays: orientations become quaternions, an inertia its principal moments in a frame of
their own, fixed links without `fusestatic="false"` a part of the link that holds them. It has no velocity limits.
https://mujoco.readthedocs.io/en/stable/modeling.html says, under "URDF extensions", what it reads of a URDF.

Quaternions and principal moments cost little: over the published arms, tool0 was found within 5e-16 of the reach and
3e-15 rad, inertias within 5e-15 of their trace. So MuJoCo is measured with what any double precision is allowed.
"""

from __future__ import annotations

import contextlib
import ctypes.util
import importlib
import math
import os
import re
import sys
from dataclasses import replace
from functools import partial
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.mass import GRAVITY
from dh2urdf.manipulator import JointType
from dh2urdf.measuring import Body
from dh2urdf.rotations import ZERO, RigidTransform, multiply, transpose
from dh2urdf.source import Messages, shown
from dh2urdf.stages import HeldRobot
from dh2urdf_plugins.home_pose import stepped
from dh2urdf_plugins.loaders import measures, viewpoint

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from dh2urdf.robot import Joint, Robot
    from dh2urdf.source import Problem
    from dh2urdf.stages import LoadReport, LoadRequest, Question
    from dh2urdf_plugins.loaders.simulators import SimulatorOptions
    from dh2urdf_plugins.loaders.viewpoint import View

say = Messages(__file__)

TIME_STEP = 0.001  # time step of the hold test [s]
YIELD = measures.HOLD_STAYS / 4  # displacement at which a motor of the hold test gives its full effort [rad or m]
MOTOR_SETTLING = 0.05  # time constant with which such a motor settles [s]
WEIGHT_RISES = measures.HOLD_SECONDS / 2
"""Time in which the weight comes on [s]; all at once, it would fall into the motors and ask for twice the effort."""
FOLLOW_SECONDS = 3.0  # time that the arm has to follow a step of its targets [s]
REACHED = 0.005  # distance from its target at which a joint has reached it [rad or m]
OVERSHOOT = 0.5  # share of the step by which a joint may overshoot at most
FASTEST_JOINT = 8.0  # speed up to which a joint follows a step without being thrown [rad/s or m/s]
HELD_JOINTS = 300
"""Largest number of joints of a hold test: the time of a step grows with its cube, and beyond it takes minutes."""

_SHADOW_MAP = 4096  # [pixels]; with more, the processor that renders is busy with the shadow map most of the time
_LIBRARIES = {"egl": "EGL", "osmesa": "OSMesa"}  # MuJoCo's name of a way to render, and the library that it needs
_SKY = ((0.97, 0.98, 1.0), (0.90, 0.92, 0.95))  # above and below
_THICKER = 0.003  # by what share a link is drawn thicker than the one before: more than its facets are flat
_VISUALS, _FLOORS = 1, 2  # groups of shapes; MuJoCo puts what a URDF says to collide into group 0


class Held(measures.Model):
    """What MuJoCo makes of a file; of a written one, the root is in the world's origin."""

    def __init__(self, path: Path) -> None:
        self.mujoco: Any = sys.modules["mujoco"]
        self.path, self.servo = path, int(self.mujoco.mjtBias.mjBIAS_AFFINE)
        self.mujoco.set_mju_user_warning(_print_warning)
        self.model = self.mujoco.MjModel.from_xml_path(str(path))
        self.data = self.mujoco.MjData(self.model)
        self.bodies = {self.model.body(number).name: number for number in range(self.model.nbody)}
        sites = {self.model.site(number).name: number for number in range(self.model.nsite)}
        self.sites = {name: number for name, number in sites.items() if name not in self.bodies}
        self.joints = {self.model.joint(number).name: number for number in range(self.model.njnt)}

    def put(self, values: Mapping[str, float]) -> None:
        """Put joints at values [rad or m], and the others where the file has them."""
        self.mujoco.mj_resetData(self.model, self.data)
        for name, value in values.items():
            if name in self.joints:
                self.data.qpos[int(self.model.jnt_qposadr[self.joints[name]])] = value
        self.mujoco.mj_kinematics(self.model, self.data)

    def placed(self, links: Iterable[str]) -> dict[str, RigidTransform]:
        """The frames of some links, sites among them, in the world."""
        data, frames = self.data, {}
        for name in links:
            at = self.sites.get(name)
            held = data.body(self.bodies[name]) if at is None else data.site(at)
            frames[name] = measures.frame(held.xmat, held.xpos)
        return frames

    def floats(self, number: int) -> bool:
        """Whether a joint leaves its body free."""
        return int(self.model.jnt_type[number]) == int(self.mujoco.mjtJoint.mjJNT_FREE)

    def held_joint(self, number: int) -> dict[str, Any]:
        """A joint as MuJoCo has it; limits that make no sense, it has switched off."""
        model, types = self.model, self.mujoco.mjtJoint
        limited = bool(model.jnt_limited[number])
        kinds = {int(types.mjJNT_HINGE): "revolute" if limited else "continuous", int(types.mjJNT_SLIDE): "prismatic"}
        kind = int(model.jnt_type[number])
        limits = [model.jnt_actfrcrange[number][1]] if model.jnt_actfrclimited[number] else []
        moved_by = model.actuator_trnid[:, 0] == number
        limits += list(model.actuator_forcerange[moved_by & (model.actuator_forcelimited != 0), 1])
        name, axis = model.joint(number).name, measures.vector(model.jnt_axis[number])
        bounds = map(float, model.jnt_range[number]) if limited else (None, None)
        effort = float(min(limits)) if limits else None
        return measures.joint_record(name, kinds.get(kind, types(kind).name), axis, *bounds, effort=effort)

    def held_bodies(self) -> dict[str, Body]:
        """The links as MuJoCo has them, a site without mass; inertias are turned back from their principal axes."""
        bodies = {name: Body(0.0, ZERO, (0.0,) * 9) for name in self.sites}
        for name, number in self.bodies.items():
            axes = measures.rotation(self._matrix(self.model.body_iquat[number]))
            a, b, c = measures.vector(self.model.body_inertia[number])
            tensor = multiply(multiply(axes, (a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c)), transpose(axes))
            mass = float(self.model.body_mass[number])
            # The centre of no mass is wherever MuJoCo's compiler left it.
            bodies[name] = Body(mass, measures.vector(self.model.body_ipos[number]) if mass else ZERO, tensor)
        return bodies

    def held_mimic(self, number: int) -> tuple[str, float, float] | None:
        """Which joint a joint follows by an equality constraint: its name, the factor and the offset."""
        model = self.model
        for at in range(model.neq):
            kind, first, second = int(model.eq_type[at]), int(model.eq_obj1id[at]), int(model.eq_obj2id[at])
            if kind == int(self.mujoco.mjtEq.mjEQ_JOINT) and first == number and second >= 0:
                offset, factor = (float(each) for each in model.eq_data[at][:2])
                return model.joint(second).name, factor, offset
        return None

    def bars(self) -> dict[str, int]:
        """The hinges of bars by which joints follow, by the names of these joints, which their constraints have."""
        model, site = self.model, int(self.mujoco.mjtObj.mjOBJ_SITE)
        named = [(model.equality(at).name, at) for at in range(model.neq) if int(model.eq_objtype[at]) == site]
        bodies = [(name, int(model.site_bodyid[model.eq_obj1id[at]])) for name, at in named if name in self.joints]
        return {name: int(model.body_jntadr[body]) for name, body in bodies}

    def held_shapes(self) -> Iterator[tuple[str, str, measures.Lengths]]:
        """The lengths of the shapes of each body; one that touches nothing is for the eye."""
        model, types = self.model, self.mujoco.mjtGeom
        for at in range(model.ngeom):
            kind, (x, y, z) = int(model.geom_type[at]), model.geom_size[at]
            if kind == int(types.mjGEOM_MESH):  # MuJoCo has turned it to its principal axes.
                mesh = int(model.geom_dataid[at])
                first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
                turned = self._matrix(model.mesh_quat[mesh])
                size = measures.lengths_of(model.mesh_vert[first : first + count] @ turned.reshape(3, 3).T)
            else:
                by_kind = {
                    int(types.mjGEOM_SPHERE): (x, x, x),
                    int(types.mjGEOM_CAPSULE): (x, x, x + y),
                    int(types.mjGEOM_CYLINDER): (x, x, y),
                }
                size = measures.lengths(*(2 * each for each in by_kind.get(kind, (x, y, z))))
            touches = model.geom_contype[at] or model.geom_conaffinity[at]
            yield model.body(int(model.geom_bodyid[at])).name, measures.COLLISION if touches else measures.VISUAL, size

    def _matrix(self, quaternion: Any) -> Any:  # noqa: ANN401 - arrays
        import numpy as np

        matrix = np.zeros(9)
        self.mujoco.mju_quat2Mat(matrix, quaternion)
        return matrix


def prepare(options: SimulatorOptions) -> None:
    """Import MuJoCo, which asks the environment once, while it is imported, by what to render."""
    if library := graphics() if getattr(options, "picture", False) else "disable":
        os.environ["MUJOCO_GL"] = library
    with contextlib.suppress(Exception):  # Whatever a broken graphics library raises: MuJoCo works without one.
        importlib.import_module("mujoco")
    if "mujoco" not in sys.modules:
        os.environ["MUJOCO_GL"] = "disable"


# --- The arm of a run


def load(request: LoadRequest, _options: SimulatorOptions) -> LoadReport:
    """Load an MJCF or a URDF into MuJoCo and measure it.

    A picture that cannot be taken, where there is no graphics library, is a finding.
    """
    comparison = measures.Comparison("MuJoCo", request)
    mujoco: Any = sys.modules["mujoco"]
    try:
        held = Held(request.path.resolve())
    except (ValueError, mujoco.FatalError) as error:
        said = " ".join(str(error).split())
        raise LoaderError(comparison.placed(say("mujoco-cannot-load", reason=said))) from error
    if fused := [shown(link.name) for link in request.robot.links if link.name not in {*held.bodies, *held.sites}]:
        raise LoaderError(comparison.placed(say("mujoco-fused-links", links=fused)))
    report = _report(held, comparison)
    if request.picture:
        try:
            _write_picture(held, comparison, request.picture)
        except _NoGraphicsError as error:
            finding = comparison.placed(say("mujoco-no-picture", reason=error))
            return replace(report, findings=(*report.findings, finding))
        report = replace(report, picture=request.picture.name)
    return report


def _report(held: Held, comparison: measures.Comparison) -> LoadReport:
    """Measure everything but the picture."""
    model = held.model
    free = {at: model.body(int(model.jnt_bodyid[at])).name for at in range(model.njnt) if held.floats(at)}
    own = set(range(model.njnt)) - free.keys() - {*held.bars().values()}
    joints = [held.held_joint(number) for number in sorted(own)]
    # It holds the root of a URDF.
    others = [] if comparison.robot.root in comparison.robot.floating else comparison.floats(free.values())
    report = comparison.loaded(version("mujoco"), joints, held.held_bodies(), others=others)
    joints = [{**joint, "velocity": None} for joint in joints]
    report = replace(report, joints=tuple(joints), **comparison.poses_of(held))
    if not joints:
        return report
    if len(joints) > HELD_JOINTS:
        found, accepted = f"{len(joints)} moving joints", f"at most {HELD_JOINTS} moving joints"
        left_out = comparison.placed(say("mujoco-hold-left-out", found=found, accepted=accepted))
        return replace(report, findings=(left_out,))
    report = replace(report, **_hold(held, comparison))
    if report.hold["stayed"] and model.nkey and (model.actuator_biastype == held.servo).any():
        followed, findings = _follow(held, comparison)
        report = replace(report, hold={**report.hold, **followed}, findings=(*report.findings, *findings))
    return report


def _addresses(model: Any, joints: Iterable[Joint]) -> list[int]:  # noqa: ANN401 - MuJoCo's model
    """Where in a model's array of positions the values of joints stand."""
    return [int(model.joint(joint.name).qposadr[0]) for joint in joints]


def _hold(held: Held, comparison: measures.Comparison) -> dict[str, Any]:
    """Whether motors keep the arm where it is under gravity, with the efforts that MuJoCo read."""
    mujoco, start = held.mujoco, measures.hold_start(comparison.robot)
    model = _with_motors(held, comparison.robot)
    model.opt.timestep = TIME_STEP
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    data, places = mujoco.MjData(model), _addresses(model, comparison.robot.moving_joints)
    data.qpos[places] = start
    for name, bar in held.bars().items():
        data.qpos[int(model.jnt_qposadr[bar])] = data.joint(comparison.robot.followers[name].leader).qpos[0]
    data.ctrl[:] = data.qpos[[int(model.jnt_qposadr[joint]) for joint in model.actuator_trnid[:, 0]]]
    mujoco.mj_forward(model, data)
    names, body = {number: name for name, number in held.bodies.items()}, model.geom_bodyid
    touching = [contact for contact in data.contact if contact.dist < -measures.OVERLAP]
    contacts = comparison.overlapping((names[body[at.geom1]], names[body[at.geom2]]) for at in touching)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT

    def vectors() -> Iterator[Any]:
        for step in range(round(measures.HOLD_SECONDS / TIME_STEP)):
            model.opt.gravity[:] = (0.0, 0.0, -GRAVITY * min(1.0, step * TIME_STEP / WEIGHT_RISES))
            mujoco.mj_step(model, data)
            if _has_begun_anew(mujoco, data):
                yield [math.inf] * len(places)  # MuJoCo has put the arm back to where it began.
                return
            yield data.qpos[places]

    return comparison.hold(start, measures.farthest(start, vectors()), contacts)


def _with_motors(held: Held, robot: Robot) -> Any:  # noqa: ANN401 - MuJoCo's model
    """The model with a position servo on every joint, which MuJoCo itself keeps within the effort it read.

    A servo that the file has is taken as it is; a motor gets a control. The servo is a stiff spring and damper. The
    damper is integrated implicitly: with a time constant of half a time step or more, the two are stable at any
    stiffness.
    """
    mujoco = held.mujoco
    spec = mujoco.MjSpec.from_file(str(held.path))
    own = {actuator.target: actuator for actuator in spec.actuators}
    for joint in robot.moving_joints:
        servo = own.get(joint.name)
        if not (effort := joint.limits.effort) or (servo and servo.biastype == held.servo):
            continue
        stiffness = effort / YIELD
        servo = servo or spec.add_actuator(name=f"hold {joint.name}", target=joint.name)
        servo.trntype = mujoco.mjtTrn.mjTRN_JOINT
        servo.gaintype, servo.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
        servo.gainprm[0] = stiffness
        servo.biasprm[1], servo.biasprm[2] = -stiffness, -stiffness * MOTOR_SETTLING
        servo.ctrllimited = mujoco.mjtLimited.mjLIMITED_FALSE
    return spec.compile()


def _follow(held: Held, comparison: measures.Comparison) -> tuple[dict[str, Any], tuple[Problem, ...]]:
    """Whether the servos of the file bring all joints to targets a step from home, with its own time steps."""
    import numpy as np

    mujoco, model = held.mujoco, held.model
    data, joints = mujoco.MjData(model), [joint for joint in comparison.robot.actuated_joints if joint.limits.effort]
    places, speeds = _addresses(model, joints), [int(model.joint(joint.name).dofadr[0]) for joint in joints]
    mujoco.mj_resetDataKeyframe(model, data, 0)
    start = data.qpos[places]
    target = np.array([stepped(joint, 1.0) for joint in joints])
    for joint, value in zip(joints, target, strict=True):
        data.actuator(joint.name).ctrl[0] = value
    beyond, speed = np.zeros(len(joints)), 0.0
    for _ in range(round(FOLLOW_SECONDS / model.opt.timestep)):
        mujoco.mj_step(model, data)
        beyond = np.fmax(beyond, (data.qpos[places] - target) / (target - start))
        speed = max(speed, float(np.abs(data.qvel[speeds]).max()))
    errors, overshoot = np.abs(data.qpos[places] - target), float(beyond.max())
    if _has_begun_anew(mujoco, data):
        errors[:] = np.inf
    error, joint = float(errors.max()), joints[int(errors.argmax())]
    followed = {"target_error": error if math.isfinite(error) else None, "overshoot": overshoot, "largest_speed": speed}
    if error <= REACHED and overshoot < OVERSHOOT and speed <= FASTEST_JOINT:
        return followed, ()
    unit = "m" if joint.type is JointType.PRISMATIC else "rad"
    by = f"{error:.3g} {unit} from its target" if math.isfinite(error) else "thrown away"
    about = {"seconds": FOLLOW_SECONDS, "by": by, "overshoot": overshoot, "speed": speed}
    return followed, (comparison.weak(joint, "servos-do-not-follow", **about),)


def _has_begun_anew(mujoco: Any, data: Any) -> bool:  # noqa: ANN401 - MuJoCo's data
    """Whether MuJoCo has begun the simulation anew, since numbers grew beyond all bounds."""
    kinds = mujoco.mjtWarning
    bad = (kinds.mjWARN_BADQPOS, kinds.mjWARN_BADQVEL, kinds.mjWARN_BADQACC)
    return any(data.warning[int(kind)].number for kind in bad)


# --- A picture


class _NoGraphicsError(Exception):
    """Nothing can be rendered on this machine."""


def graphics() -> str | None:
    """What to render by, as MuJoCo's variable MUJOCO_GL has it; None where MuJoCo knows, or the variable is set."""
    if sys.platform != "linux" or os.environ.get("MUJOCO_GL"):
        return None
    return next((name for name, library in _LIBRARIES.items() if ctypes.util.find_library(library)), "disable")


def _write_picture(held: Held, comparison: measures.Comparison, path: Path) -> None:
    """Render the arm in a pose that shows it well, without a display: by EGL or OSMesa, whichever is installed."""
    from PIL import Image

    mujoco, robot = held.mujoco, comparison.robot
    view = viewpoint.best_view(robot, partial(comparison.frames_of, held))
    model = _lit_model(held, view)
    data = mujoco.MjData(model)
    data.qpos[_addresses(model, robot.moving_joints)] = view.q
    mujoco.mj_forward(model, data)
    camera, drawn = mujoco.MjvCamera(), mujoco.MjvOption()
    camera.lookat[:], camera.distance = view.target, view.distance
    camera.azimuth = math.degrees(viewpoint.AZIMUTH) + 180.0
    camera.elevation = -math.degrees(viewpoint.ELEVATION)
    drawn.geomgroup[:] = drawn.sitegroup[:] = 0
    drawn.geomgroup[_FLOORS] = 1
    drawn.geomgroup[_VISUALS if _VISUALS in model.geom_group else 0] = 1
    if not hasattr(mujoco, "GLContext"):
        raise _NoGraphicsError("there is no library that renders without a display")
    width, height = viewpoint.RENDERED
    try:
        renderer = mujoco.Renderer(model, height, width)
    except Exception as error:  # A library that is there and does not work raises errors of its own.
        raise _NoGraphicsError(" ".join(str(error).split()) or type(error).__name__) from error
    with contextlib.closing(renderer):
        renderer.update_scene(data, camera, drawn)
        viewpoint.write_png(Image.fromarray(renderer.render()), path)


def _lit_model(held: Held, view: View) -> Any:  # noqa: ANN401 - MuJoCo's model
    """The model on a light floor, under a light sky, with a lamp that throws shadows."""
    mujoco = held.mujoco
    spec = mujoco.MjSpec.from_file(str(held.path))
    spec.stat.center, spec.stat.extent = view.target, view.distance / 4
    spec.visual.global_.fovy = math.degrees(viewpoint.FIELD_OF_VIEW)
    spec.visual.global_.offwidth, spec.visual.global_.offheight = viewpoint.RENDERED
    spec.visual.quality.shadowsize, spec.visual.quality.offsamples = _SHADOW_MAP, 0
    spec.visual.quality.numslices = 96
    spec.visual.headlight.ambient = (0.45, 0.45, 0.45)
    spec.visual.headlight.diffuse = (0.25, 0.25, 0.25)
    spec.visual.headlight.specular = (0.0, 0.0, 0.0)
    sky = spec.add_texture(name="dh2urdf sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, width=256, height=1536)
    sky.builtin = mujoco.mjtBuiltin.mjBUILTIN_GRADIENT
    sky.rgb1, sky.rgb2 = _SKY
    (x, y, z), half = view.floor
    floor = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, pos=(x, y, z - half / 100))
    floor.size, floor.rgba, floor.group = (half, half, half / 100), viewpoint.FLOOR, _FLOORS
    away = (0.6, -0.5, 1.2)
    place = [at + 2 * view.distance * to for at, to in zip(view.target, away, strict=True)]
    lamp = spec.worldbody.add_light(pos=place)
    lamp.dir = [-to for to in away]
    lamp.diffuse, lamp.specular, lamp.castshadow = (0.55, 0.55, 0.55), (0.1, 0.1, 0.1), True
    lamp.cutoff, lamp.exponent = 30.0, 0.0
    model = spec.compile()
    # Where links of one thickness overlap, their surfaces would fight for the same pixels.
    model.geom_size *= 1.0 + _THICKER * (model.geom_bodyid[:, None] % 4)
    return model


# --- A file of any origin


def inspect(question: Question) -> HeldRobot:
    """What MuJoCo makes of a URDF or an MJCF."""
    mujoco: Any = sys.modules["mujoco"]
    try:
        held = Held(question.path)
    except (ValueError, mujoco.FatalError) as error:
        raise measures.refused(error, question) from error
    model, free = held.model, int(mujoco.mjtJoint.mjJNT_FREE)
    names = [name for number in range(1, model.nbody) if (name := model.body(number).name)]
    bodies = held.held_bodies()
    moving = [number for number in range(model.njnt) if int(model.jnt_type[number]) != free]
    joints = [{**held.held_joint(number), "mimic": held.held_mimic(number)} for number in moving]
    barred = held.bars().keys()  # How these follow is in no number of the model.
    return HeldRobot(
        links=measures.told_bodies({name: bodies[name] for name in names}),
        joints=[{k: v for k, v in one.items() if k != "mimic" or one["name"] not in barred} for one in joints],
        frames=held.told_frames(names, question.postures),
        shapes=measures.told_shapes(held.held_shapes()),
        root_is_loose=bool((model.jnt_type == free).any()),
    )


def _print_warning(text: str | bytes) -> None:
    """Print a warning; without this, MuJoCo writes it into a file in the working directory too."""
    words = text.decode("utf-8", "replace") if isinstance(text, bytes) else text
    os.write(2, f"WARNING: {' '.join(words.split())}\n".encode())


_MESSAGE = re.compile(r"^(?:WARNING|ERROR): *(.+?) *$", re.MULTILINE)
_UNNAMED = "Geom with duplicate name ''"  # MuJoCo 3.3 prints this for every file with two shapes: shapes have no names


def messages(output: str, _request: LoadRequest | None = None) -> list[tuple[str, str]]:
    """MuJoCo's warnings; what graphics libraries print is not about the arm."""
    return [("", text) for text in _MESSAGE.findall(output) if not text.startswith(_UNNAMED)]
