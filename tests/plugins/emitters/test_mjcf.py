"""MJCF as MuJoCo itself reads it."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import Convention, DHRow, Limits, Manipulator
from dh2urdf.robot import Box, Cylinder, Sphere
from dh2urdf_plugins.formats.mjcf import EMITTER, MjcfOptions
from dh2urdf_plugins.formats.mjcf.writer import DEEPEST
from dh2urdf_plugins.formats.urdf import EMITTER as URDF
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.robot import Robot

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


def test_servos_hold_the_arm(reference_robots: Any) -> None:
    """With the actuators that are written by default and no code at all, an arm stays where it is."""
    data = settled(model_of(ur5(reference_robots)))
    assert np.abs(data.qpos).max() < 1e-6
    assert np.abs(data.qvel).max() < 1e-3


def test_servos_follow_a_step(reference_robots: Any) -> None:
    """A servo goes to its target and stops there, and never gives more than the effort of its joint."""
    robot = ur5(reference_robots)
    model = model_of(robot)
    data = mujoco.MjData(model)
    data.ctrl[:] = [0.5, -1.0, 1.0, 0.5, -0.5, 1.0]
    model.opt.gravity[:] = 0
    for _ in range(round(4.0 / model.opt.timestep)):
        mujoco.mj_step(model, data)
        efforts = np.array([joint.limits.effort for joint in robot.moving_joints])
        assert (np.abs(data.qfrc_actuator) <= efforts * (1 + 1e-12)).all()
    assert np.abs(data.qpos - data.ctrl).max() < 1e-3


def test_motors_leave_the_control_to_the_user(reference_robots: Any) -> None:
    """Torque motors, within the efforts; with no torque the arm falls."""
    robot = ur5(reference_robots)
    model = model_of(robot, actuators="motor")
    for number, joint in enumerate(robot.moving_joints):
        assert tuple(model.actuator_ctrlrange[number]) == (-joint.limits.effort, joint.limits.effort)
        assert tuple(model.actuator_forcerange[number]) == (-joint.limits.effort, joint.limits.effort)
        assert model.actuator_gainprm[number][0] == 1.0
    assert np.abs(settled(model).qpos).max() > 0.5


def test_a_base_that_collides_throws_nothing(reference_robots: Any) -> None:
    """With a collision shape on the base, a URDF has contacts at rest in MuJoCo, and MJCF has none."""
    robot = ur5(reference_robots, base_collision=True, shape="box")
    (file,) = URDF.emit(robot, "arm", URDF.options())
    contacts = []
    for model in (mujoco.MjModel.from_xml_string(file.content.decode()), model_of(robot)):
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        contacts.append(data.ncon)
    assert contacts[0] > 0
    assert contacts[1] == 0
    assert np.abs(settled(model_of(robot)).qpos).max() < 1e-6


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
    assert '<mesh name="mesh_1" file="package://arm/hand.stl" scale="0.001 0.001 0.001"/>' in text
    assert text.count('mesh="mesh_1"') == 2


def test_a_cell_has_all_its_arms(cli: Callable[..., Any], tmp_path: Path) -> None:
    """Of an arm on another arm too, MuJoCo finds the sites and the actuators."""
    cli("run", CONFIGS / "ur5_on_track.yaml", "-o", tmp_path, "--set", "emitters=[mjcf]", "--set", "loaders=[]")
    models = [mujoco.MjModel.from_xml_path(str(path)) for path in tmp_path.glob("*.xml")]
    cell = max(models, key=lambda model: model.njnt)
    sites = [cell.site(number).name for number in range(cell.nsite)]
    assert len([name for name in sites if name.endswith("tool0")]) == 2
    assert cell.nu == cell.njnt == 7
    data = settled(cell)
    assert np.abs(data.qpos).max() < 1e-6


def chain_of(count: int) -> Robot:
    limits = Limits(lower=-1.0, upper=1.0)
    rows = tuple(
        DHRow(joint=f"joint_{i}", link=f"link_{i}", a=0.2, alpha=0.3, d=0.1, limits=limits) for i in range(1, count + 1)
    )
    return robot_of(Manipulator(name="long", convention=Convention.STANDARD, rows=rows))


def test_the_longest_chain_is_read() -> None:
    """MuJoCo's XML parser takes only so many elements within each other; a longer chain is refused, with the reason."""
    assert model_of(chain_of(DEEPEST - 2)).njnt == DEEPEST - 2
    with pytest.raises(EmitterError, match="no chain of so many links") as caught:
        text_of(chain_of(DEEPEST - 1))
    assert caught.value.problems[0].joint == f"joint_{DEEPEST - 1}"


def test_the_loader_takes_it(cli: Callable[..., Any], tmp_path: Path) -> None:
    """Where a run writes MJCF, the loader loads that: with its servos, its motors, or neither, the arm is right."""
    for kind in ("position", "motor", "none"):
        emitters = f"emitters=[urdf, {{stage: mjcf, options: {{actuators: {kind}}}}}]"
        loaders = "loaders=[{stage: mujoco, options: {picture: false, poses: 3}}]"
        out = tmp_path / kind
        cli("run", CONFIGS / "ur5.yaml", "-o", out, "--set", emitters, "--set", loaders)
        import json

        (entry,) = json.loads((out / "report.json").read_text("utf-8"))["manipulators"]
        report = entry["loaders"]["mujoco"]
        assert (report["hold"]["stayed"], report["findings"], report["output"]) == (True, [], "")
        assert report["position_error"] < 1e-14
        assert math.isclose(report["mass"], sum_of_masses(out / "ur5.urdf"), rel_tol=1e-14)


def sum_of_masses(path: Path) -> float:
    from lxml import etree

    return sum(float(mass.get("value")) for mass in etree.parse(path).iter("mass"))
