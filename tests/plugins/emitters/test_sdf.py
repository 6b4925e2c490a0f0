"""SDF as sdformat and Drake read it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drake_frames import drake_plant
from lxml import etree
from sdformat_calls import sdformat

from dh2urdf.manipulator import Manipulator
from dh2urdf.robot import Robot
from dh2urdf.stages import ReadsBack
from dh2urdf_plugins.formats.sdf import EMITTER, SdfOptions
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

CONFIGS = Path(__file__).parents[3] / "configs"


def robot_of(manipulator: Manipulator, **options: Any) -> Robot:
    return TRANSFORM.transform(manipulator, TRANSFORM.options(**options))


def text_of(robot: Robot, **options: Any) -> str:
    (file,) = EMITTER.emit(robot, "arm", SdfOptions(**options))
    return file.content.decode()


def write(robot: Robot, folder: Path, **options: Any) -> Path:
    path = folder / "arm.sdf"
    path.write_text(text_of(robot, **options), "utf-8")
    return path


def test_sdformat_takes_published_arms(reference_robot: Any, tmp_path: Path) -> None:
    """Valid, without a word; what sdformat hands on has every link, the masses, and flange and tool0 as frames."""
    robot = robot_of(reference_robot.manipulator)
    path = write(robot, tmp_path)
    assert sdformat("--check", path).strip() == "Valid."
    model = etree.fromstring(sdformat("--print", path).encode()).find("model")
    frames = {frame.get("name"): frame.get("attached_to") for frame in model.findall("frame")}
    assert frames == {"base_link": None, **dict.fromkeys(("flange", "tool0"), robot.links[-3].name)}
    bodies = [link for link in robot.links if link.inertial and link.inertial.mass]
    assert [link.get("name") for link in model.findall("link")] == [link.name for link in bodies]
    assert sum(float(mass.text) for mass in model.iter("mass")) == pytest.approx(robot.mass, rel=1e-14)


def test_drake_has_published_arms(reference_robot: Any, tmp_path: Path) -> None:
    """Drake puts tool0 where the publisher computed it, and has an actuator with the effort for every joint."""
    robot = robot_of(reference_robot.manipulator)
    plant = drake_plant(write(robot, tmp_path))
    context = plant.CreateDefaultContext()
    base, tool0 = plant.GetFrameByName("base_link"), plant.GetFrameByName("tool0")
    names = [joint.name for joint in robot.moving_joints]
    places = [plant.GetJointByName(name).position_start() for name in names]
    for values, pose in zip(reference_robot.q, reference_robot.poses, strict=True):
        q = np.zeros(len(values))
        q[places] = values
        plant.SetPositions(context, q)
        found = plant.CalcRelativeTransform(context, base, tool0).GetAsMatrix4()
        assert np.abs(found - np.array(pose)).max() < 1e-9
    actuators = map(plant.get_joint_actuator, plant.GetJointActuatorIndices())
    efforts = {actuator.joint().name(): actuator.effort_limit() for actuator in actuators}
    assert efforts == {joint.name: joint.limits.effort for joint in robot.moving_joints}


def test_it_stands_in_the_world_unless_told_otherwise(reference_robots: Any, tmp_path: Path) -> None:
    """A joint holds the base on the world; without it the same file is an arm that something else can hold."""
    robot = robot_of(reference_robots[0].manipulator)
    held, free = text_of(robot), text_of(robot, fixed=False)
    joint = etree.fromstring(held.encode()).find("model/joint")
    assert (joint.get("type"), joint.findtext("parent")) == ("fixed", "world")
    assert "world" not in free
    assert sdformat("--check", write(robot, tmp_path, fixed=False)).strip() == "Valid."
    for fixed, free in ((False, 6), (True, 0)):
        plant = drake_plant(write(robot, tmp_path, fixed=fixed))
        assert plant.num_velocities() == len(robot.moving_joints) + free


def test_a_root_with_mass_is_a_link(arm: Robot) -> None:
    """It is held by a joint of a name that is free."""
    heavy = replace(arm, links=(replace(arm.links[0], inertial=arm.links[1].inertial), *arm.links[1:]))
    model = etree.fromstring(text_of(heavy).encode()).find("model")
    assert model.find("link").get("name") == "base_link"
    assert (model.find("joint").get("name"), model.find("joint").findtext("child")) == ("base_joint", "base_link")
    assert etree.fromstring(text_of(heavy, fixed=False).encode()).find("model/joint").findtext("parent") == "base_link"


def test_a_cell_is_one_model(cli: Callable[..., Any], tmp_path: Path) -> None:
    """An arm on another arm, and one beside it: valid, held by the world, and every tool0 where Drake is asked."""
    cli("run", CONFIGS / "ur5_on_track.yaml", "-o", tmp_path, "--set", "emitters=[sdf]", "--set", "loaders=[]")
    path = max(tmp_path.glob("*.sdf"), key=lambda each: each.stat().st_size)
    assert sdformat("--check", path).strip() == "Valid."
    frames = [frame.get("name") for frame in etree.fromstring(sdformat("--print", path).encode()).iter("frame")]
    assert len([name for name in frames if name.endswith("tool0")]) == 2
    plant = drake_plant(path)
    context = plant.CreateDefaultContext()
    from dh2urdf.kinematics import KinematicChain

    reads = EMITTER.can(ReadsBack)
    found = reads.read_back(path)
    draw = np.random.default_rng(3)
    joints = {joint.name: float(draw.uniform(-1, 1)) for joint in found.moving_joints}
    q = np.zeros(len(joints))
    for name, value in joints.items():
        q[plant.GetJointByName(name).position_start()] = value
    plant.SetPositions(context, q)
    for name in frames:
        chain = KinematicChain.between(found, "world", name)
        pose = chain.forward_kinematics([joints[joint.name] for joint in chain.joints if joint.name in joints])
        T = plant.GetFrameByName(name).CalcPoseInWorld(context)
        assert np.abs(T.translation() - pose.translation).max() < 1e-12
        assert np.abs(T.rotation().matrix().ravel() - pose.rotation).max() < 1e-12
