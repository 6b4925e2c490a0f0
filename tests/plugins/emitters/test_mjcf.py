"""MJCF as MuJoCo itself reads it, and moves it."""

import math
import random
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import Convention, DHRow, JointType, Limits, Manipulator
from dh2urdf.robot import Box, Cylinder, Robot, Sphere
from dh2urdf.robot_check.contacts import capsule_distance
from dh2urdf_plugins.formats.mjcf import EMITTER, MjcfOptions
from dh2urdf_plugins.formats.mjcf.home_contacts import touching_at_home
from dh2urdf_plugins.formats.mjcf.writer import DEEPEST
from dh2urdf_plugins.home_pose import stepped
from dh2urdf_plugins.loaders.measures import gravity_loads
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM
from servo_steps import follow

mujoco = pytest.importorskip("mujoco")

CONFIGS = Path(__file__).parents[3] / "configs"


def text_of(robot: Robot, **options: Any) -> str:
    (file,) = EMITTER.emit(robot, "arm", MjcfOptions(**options))
    return file.content.decode()


def model_of(robot: Robot, **options: Any) -> Any:
    return mujoco.MjModel.from_xml_string(text_of(robot, **options))


def robot_of(manipulator: Manipulator, **options: Any) -> Robot:
    return TRANSFORM.transform(manipulator, TRANSFORM.options(**options))


def without_meshes(robot: Robot) -> Robot:
    """The arm by hand, whose mesh no package has."""
    shapes = (Box, Cylinder, Sphere)
    return replace(
        robot,
        links=tuple(
            replace(link, visuals=tuple(each for each in link.visuals if isinstance(each.geometry, shapes)))
            for link in robot.links
        ),
    )


def contacts_at_zero(model: Any) -> set[frozenset[str]]:
    """The pairs of bodies that MuJoCo finds in contact at joint values 0."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return {
        frozenset(model.body(model.geom_bodyid[geom]).name for geom in (contact.geom1, contact.geom2))
        for contact in data.contact
    }


def test_links_that_touch_at_the_start_are_excluded() -> None:
    """A third link that lies along the first: MuJoCo finds this contact if neighbours alone are excluded."""
    pytest.importorskip("pinocchio")
    rows = [
        DHRow(joint=f"j{number}", link=f"link_{number}", a=a, alpha=0.0, d=0.0, theta=theta)
        for number, (a, theta) in enumerate([(0.5, 0.0), (0.2, math.pi), (0.2, 0.0)], start=1)
    ]
    robot = robot_of(Manipulator(name="folded", convention=Convention.STANDARD, rows=tuple(rows)))
    neighbours = model_of(robot, excludes="neighbours")
    assert contacts_at_zero(neighbours) == {frozenset(("link_1", "link_3"))}
    for excludes in ("home", "touching"):
        model = model_of(robot, excludes=excludes)
        assert contacts_at_zero(model) == set()
        assert model.nexclude == neighbours.nexclude + 1


def test_published_arms_are_the_same_in_mujoco(reference_robot: Any, capfd: pytest.CaptureFixture[str]) -> None:
    """MuJoCo has every mass, inertia, limit and effort, excludes the neighbours, and puts the site tool0 right."""
    robot = robot_of(reference_robot.manipulator)
    model = model_of(robot)
    data = mujoco.MjData(model)
    assert model.body_mass.sum() == pytest.approx(robot.mass, rel=1e-14)
    for link in robot.links:
        if link.inertial and link.inertial.mass:
            body = model.body(link.name)
            assert body.mass[0] == link.inertial.mass
            assert body.ipos == pytest.approx(link.inertial.com, abs=1e-15)
            trace = link.inertial.inertia.ixx + link.inertial.inertia.iyy + link.inertial.inertia.izz
            assert body.inertia.sum() == pytest.approx(trace, rel=1e-13)
    assert [model.joint(number).name for number in range(model.njnt)] == [each.name for each in robot.moving_joints]
    for number, joint in enumerate(robot.moving_joints):
        if joint.limits.lower is not None:
            assert tuple(model.jnt_range[number]) == (joint.limits.lower, joint.limits.upper)
            assert tuple(model.actuator_ctrlrange[number]) == (joint.limits.lower, joint.limits.upper)
        assert tuple(model.actuator_forcerange[number]) == (-joint.limits.effort, joint.limits.effort)
        assert tuple(model.jnt_actfrcrange[number]) == (-joint.limits.effort, joint.limits.effort)
        assert model.actuator_trnid[number][0] == number
    pairs = {(int(each) >> 16, int(each) & 0xFFFF) for each in model.exclude_signature}
    for joint in robot.moving_joints:
        ends = sorted((model.body(joint.parent).id, model.body(joint.child).id))
        assert tuple(ends) in pairs
    for q, pose in zip(reference_robot.q, reference_robot.poses, strict=True):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        site = data.site("tool0")
        assert np.abs(site.xmat.reshape(3, 3) - np.array(pose)[:3, :3]).max() < 1e-9
        assert np.abs(site.xpos - np.array(pose)[:3, 3]).max() < 1e-9
    assert {model.site(number).name for number in range(model.nsite)} == {"flange", "tool0"}
    assert capfd.readouterr() == ("", "")


def ur5(reference_robots: Any, **options: Any) -> Robot:
    published = next(robot for robot in reference_robots if robot.id == "urdoc_ur5")
    return robot_of(published.manipulator, **options)


def settled(model: Any, seconds: float = 2.0) -> Any:
    """The model after some time under gravity, from q = 0 with all controls at 0."""
    data = mujoco.MjData(model)
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
    assert not any(warning.number for warning in data.warning)
    return data


def test_motors_leave_the_control_to_the_user(reference_robots: Any) -> None:
    """Torque motors, within the efforts; with no torque the arm falls."""
    robot = ur5(reference_robots)
    model = model_of(robot, actuators="motor")
    for number, joint in enumerate(robot.moving_joints):
        assert tuple(model.actuator_ctrlrange[number]) == (-joint.limits.effort, joint.limits.effort)
        assert tuple(model.actuator_forcerange[number]) == (-joint.limits.effort, joint.limits.effort)
        assert model.actuator_gainprm[number][0] == 1.0
    assert np.abs(settled(model).qpos).max() > 0.5


def test_one_of_everything_loads(arm: Robot) -> None:
    """Each joint type, each primitive, damping and friction, an effort of one servo per joint."""
    model = model_of(without_meshes(arm))
    assert [model.joint(name).type[0] for name in ("lift", "turn", "spin")] == [
        *(mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_HINGE)
    ]
    assert [bool(model.jnt_limited[model.joint(name).id]) for name in ("lift", "turn", "spin")] == [True, True, False]
    assert [bool(model.actuator_ctrllimited[number]) for number in range(3)] == [True, True, False]
    assert model.dof_damping[model.joint("turn").dofadr[0]] == 0.1
    assert model.dof_frictionloss[model.joint("turn").dofadr[0]] == 0.2
    box = model.body("link_2").geomadr[0]
    assert model.geom_size[box] == pytest.approx([0.2125, 0.04, 0.04])


def test_the_rotors_are_felt(arm: Robot) -> None:
    """MuJoCo has the armature of a joint that says one, and of the others what servos need: none beside motors."""
    joints = tuple(replace(joint, armature=0.02) if joint.name == "turn" else joint for joint in arm.joints)
    robot = without_meshes(replace(arm, joints=joints))
    for actuators, others in (("position", [0.5586, 0.15]), ("motor", [0, 0]), ("none", [0, 0])):
        model = model_of(robot, actuators=actuators)
        lift, turn, spin = (model.dof_armature[model.joint(name).dofadr[0]] for name in ("lift", "turn", "spin"))
        assert (turn, [lift, spin]) == (0.02, others)
        assert model.nu == (0 if actuators == "none" else 3)  # The efforts stay with the joints.
        assert model.jnt_actfrcrange[:, 1].tolist() == [joint.limits.effort for joint in robot.moving_joints]
        assert (model.body_gravcomp.any(), model.jnt_actgravcomp.any()) == ((actuators == "position",) * 2)


def test_meshes_are_assets(arm: Robot) -> None:
    """A mesh file is named once, however many shapes are made of it."""
    mesh = arm.links[3].visuals[0]
    links = tuple(replace(link, visuals=(mesh, mesh)) if link.name == "link_2" else link for link in arm.links)
    text = text_of(replace(arm, links=links))
    assert text.count("<mesh ") == 1
    assert '<mesh name="mesh_1" file="package://arm/hand.stl" scale="0.001 0.001 0.001" inertia="shell"/>' in text
    assert text.count('mesh="mesh_1"') == 2


def test_the_longest_chain_is_read(long_chain: Callable[[int], Robot]) -> None:
    """MuJoCo's XML parser takes only so many elements within each other; a longer chain is refused, with the reason."""
    assert model_of(long_chain(DEEPEST - 2)).njnt == DEEPEST - 2
    with pytest.raises(EmitterError) as caught:
        text_of(long_chain(DEEPEST - 1))
    (problem,) = caught.value.problems
    assert (problem.code, problem.joint) == ("mujoco-chain-too-long", f"joint_{DEEPEST - 1}")


# --- The servos: steps of all joints at once, from home, with contacts and within the efforts

STEPS = (0.01, 0.2)


def check_steps(model: Any) -> None:
    """All joints reach their targets within 3 s, and none is thrown."""
    for step in STEPS:
        response = follow(model, step)
        assert response.error < 0.005
        assert response.overshoot < 0.1
        assert response.speed < 8.0


def with_joints(robot: Robot, **numbers: Any) -> Robot:
    """The robot with other numbers of its moving joints."""
    moving = robot.moving_joints
    return replace(robot, joints=tuple(replace(each, **numbers) if each in moving else each for each in robot.joints))


def with_efforts(robot: Robot, efforts: dict[str, float | None]) -> Robot:
    return replace(
        robot,
        joints=tuple(
            replace(joint, limits=replace(joint.limits, effort=efforts[joint.name])) if joint.name in efforts else joint
            for joint in robot.joints
        ),
    )


def test_published_arms_follow_a_step(reference_robot: Any) -> None:
    """Steps of 0.01 and 0.2 rad, of a quarter of that in m where a joint slides, though some of the arms are folded."""
    check_steps(model_of(robot_of(reference_robot.manipulator)))


def test_published_arms_follow_a_step_from_anywhere(reference_robot: Any) -> None:
    """The gains fit every pose, not only that of the keyframe: no joint overshoots by more than a tenth."""
    model = model_of(robot_of(reference_robot.manipulator, collisions="none"))
    lower, upper = np.where(model.jnt_limited, model.jnt_range.T, [[-3.0], [3.0]])
    model.key_qpos[0] = np.random.default_rng(1).uniform(lower, upper)
    check_steps(model)


@pytest.mark.parametrize("cell", ["ur5_on_track", "pair"])
def test_cells_follow_a_step(cli: Callable[..., Any], tmp_path: Path, cell: str) -> None:
    """All arms of a cell at once."""
    cli("run", CONFIGS / f"{cell}.yaml", "-o", tmp_path, "--set", "emitters=[mjcf]", "--set", "loaders=[]")
    check_steps(mujoco.MjModel.from_xml_path(str(tmp_path / f"{cell}.xml")))


def any_arm(seed: int) -> Robot:
    """An arm of 1 to 9 joints, 0.1 to 3 m and 0.1 to 200 kg; of every second one the efforts just carry its weight."""
    draw = random.Random(seed)  # noqa: S311 - no secret
    count, reach, mass = draw.randint(1, 9), 10 ** draw.uniform(-1.0, 0.48), 10 ** draw.uniform(-1.0, 2.3)
    parts = [draw.choice((0.001, draw.random())) for _ in range(2 * count)]
    rows = []
    for number in range(count):
        slides = draw.random() < 0.2
        limits = (
            Limits(lower=draw.choice((0.0, -0.2 * reach)), upper=draw.uniform(0.2, 0.6) * reach)
            if slides
            else draw.choice(
                [Limits(lower=-3.0, upper=3.0), Limits(lower=0.4, upper=2.5), Limits(lower=-3.0, upper=0.0)]
            )
        )
        rows.append(
            DHRow(
                joint=f"joint_{number}",
                link=f"link_{number}",
                type=JointType.PRISMATIC if slides else JointType.REVOLUTE,
                a=parts[2 * number] / sum(parts) * reach,
                alpha=draw.choice((0.0, 0.5 * math.pi, -0.5 * math.pi, draw.uniform(-3.0, 3.0))),
                d=parts[2 * number + 1] / sum(parts) * reach,
                theta=draw.choice((0.0, 0.5 * math.pi)),
                limits=limits,
                mass=mass * 0.7**number,
            )
        )
    manipulator = Manipulator(name="any", convention=draw.choice(list(Convention)), rows=tuple(rows))
    robot = robot_of(manipulator, radius=0.03 * reach)
    if seed % 2:
        loads = [[abs(load) for load in gravity_loads(robot, q)] for q in poses_of(robot, draw)]
        least = [0.1 * joint.limits.effort for joint in robot.moving_joints if joint.limits.effort]
        worst = [1.05 * max(each) for each in zip(least, *loads, strict=True)]
        robot = with_efforts(robot, dict(zip([joint.name for joint in robot.moving_joints], worst, strict=True)))
    return robot


def poses_of(robot: Robot, draw: random.Random) -> list[list[float]]:
    """Joint vectors: those of the steps, and others anywhere."""
    joints = robot.moving_joints
    near = [[stepped(joint, way * k / 8) for joint in joints] for way in (-1, 1) for k in range(9)]
    limits = [(joint.limits.lower or 0.0, joint.limits.upper or 0.0) for joint in joints]
    return near + [[draw.uniform(*each) for each in limits] for _ in range(40)]


@pytest.mark.parametrize("seed", range(40))
def test_any_arm_follows_a_step(seed: int) -> None:
    """Light and heavy arms, with default efforts and with ones that are 1.05 times the weight that they carry."""
    check_steps(model_of(any_arm(seed)))


@pytest.mark.parametrize("numbers", [{"armature": 0.0}, {"armature": 1e-3}, {"friction": 2.0}, {"damping": 30.0}])
def test_what_the_table_says_is_kept(reference_robots: Any, numbers: dict[str, float]) -> None:
    """Armature, friction and damping of the table are in the model, and the arm follows with them."""
    published = next(robot for robot in reference_robots if robot.id == "urdoc_ur5")
    model = model_of(with_joints(robot_of(published.manipulator), **numbers))
    ((name, value),) = numbers.items()
    found = {"armature": model.dof_armature, "friction": model.dof_frictionloss, "damping": model.dof_damping}[name]
    assert (found == value).all()
    check_steps(model)


def planar(limits: Limits) -> Robot:
    """Three links in a row, which swing in a vertical plane."""
    rows = tuple(
        DHRow(joint=f"j{k}", link=f"l{k}", a=0.4, alpha=0.0, d=0.0, mass=2.0, limits=limits) for k in range(1, 4)
    )
    down = DHRow(joint="mount", link="mount_link", type=JointType.FIXED, a=0.0, alpha=0.5 * math.pi, d=0.5, mass=1.0)
    return robot_of(Manipulator(name="planar", convention=Convention.STANDARD, rows=(down, *rows)))


def left_alone(model: Any, seconds: float = 2.0) -> Any:
    """Where the joints are some time after the start at home."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
    return data.qpos - model.key_qpos[0]


def test_an_arm_starts_at_home() -> None:
    """A keyframe inside limits that exclude 0, with targets that hold the arm there."""
    model = model_of(planar(Limits(lower=0.4, upper=1.0)))
    assert model.key("home").qpos.tolist() == model.key("home").ctrl.tolist() == [0.7, 0.7, 0.7]
    assert np.abs(left_alone(model)).max() < 1e-6


@pytest.mark.parametrize(("share", "stays"), [(1.02, True), (0.98, False)])
def test_the_weight_counts_into_the_effort(share: float, *, stays: bool) -> None:
    """Servos that carry the weight give no more than their efforts: with 2 % less than the weight, the arm falls."""
    robot = planar(Limits(lower=-3.0, upper=3.0))
    loads = gravity_loads(robot, (0.0, 0.0, 0.0))
    efforts = {joint.name: share * abs(load) for joint, load in zip(robot.moving_joints, loads, strict=True)}
    moved = np.abs(left_alone(model_of(with_efforts(robot, efforts)))).max()
    assert (moved < 1e-6) if stays else (moved > 0.1)


def test_nothing_carries_a_joint_without_an_effort() -> None:
    """A joint without a motor swings, with all that hangs on it; the joints before it hold."""
    robot = with_efforts(planar(Limits(lower=-3.0, upper=3.0)), {"j2": None})
    first, second, _ = np.abs(left_alone(model_of(robot), 0.5))
    assert first < 0.1
    assert second > 0.5


def test_folded_arms_touch_nothing_at_home(reference_robot: Any) -> None:
    """MuJoCo finds no contact at home, nor after a step to either side; the option `neighbours` leaves them."""
    robot = robot_of(reference_robot.manipulator)
    model = model_of(robot)
    data = mujoco.MjData(model)
    for steps in (-1.0, -0.5, 0.0, 0.5, 1.0):
        for joint in robot.moving_joints:
            data.joint(joint.name).qpos[0] = stepped(joint, steps)
        mujoco.mj_forward(model, data)
        assert data.ncon == 0
    if reference_robot.id == "rtb_Mico":
        assert ("link_2", "link_4") in touching_at_home(robot)
    if reference_robot.id == "kst_iiwa_14R820":
        assert touching_at_home(robot) == []


CAPSULE = '<body pos="{}"><freejoint/><geom name="{}" type="capsule" fromto="{}" size="{}"/></body>'


@pytest.mark.parametrize("seed", range(20))
def test_capsules_are_as_far_apart_as_in_mujoco(seed: int) -> None:
    """The distance of two capsules that do not overlap, in any position."""
    draw = random.Random(seed)  # noqa: S311 - no secret
    capsules = []
    for shift in (0.0, 1.5):
        start, end = ([draw.uniform(-0.5, 0.5) + shift for _ in range(3)] for _ in range(2))
        capsules.append((tuple(start), tuple(end), draw.uniform(0.01, 0.1)))
    bodies = [
        CAPSULE.format("0 0 0", name, " ".join(map(repr, (*start, *end))), radius)
        for name, (start, end, radius) in zip("ab", capsules, strict=True)
    ]
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{''.join(bodies)}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    found = mujoco.mj_geomDistance(model, data, 0, 1, 10.0, None)
    assert capsule_distance(*capsules) == pytest.approx(found, abs=1e-6)  # type: ignore[arg-type]
