"""What SDF and MJCF have in common: read back, both are the robot that was written."""

import re
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from any_tables import SEEN_LENGTHS, manipulators
from hypothesis import given, settings

import dh2urdf
from dh2urdf.errors import EmitterError
from dh2urdf.kinematics import KinematicChain
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Manipulator
from dh2urdf.robot import Inertial, Link, Mesh, Robot
from dh2urdf.stages import Emitter, ReadsBack
from dh2urdf_plugins.base_bodies import BASE
from dh2urdf_plugins.formats.mjcf import EMITTER as MJCF
from dh2urdf_plugins.formats.sdf import EMITTER as SDF
from dh2urdf_plugins.formats.urdf import EMITTER as URDF
from dh2urdf_plugins.formats.xacro import EMITTER as XACRO
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

formats = pytest.mark.parametrize("emitter", [SDF, MJCF], ids=lambda emitter: emitter.name)
frames = pytest.mark.parametrize("frames", ["aligned", "dh"])


def content_of(emitter: Emitter[Any], robot: Robot, **options: Any) -> bytes:
    (file,) = emitter.emit(robot, "arm", emitter.options(**options))
    return bytes(file.content)


def written(emitter: Emitter[Any], robot: Robot, folder: Path, **options: Any) -> Path:
    path = folder / f"arm{emitter.suffixes[0]}"
    path.write_bytes(content_of(emitter, robot, **options))
    return path


def read(emitter: Emitter[Any], path: Path) -> Robot:
    reads = emitter.can(ReadsBack)
    return reads.read_back(path)


def pose_of(robot: Robot, link: str, values: dict[str, float], root: str) -> np.ndarray:
    chain = KinematicChain.between(robot, root, link)
    return as_matrices(chain.forward_kinematics([values[name] for name in chain.actuated]))


def assert_same_arm(found: Robot, robot: Robot) -> None:
    """The links are where they were written, at rest and moved; masses, limits and shapes are those that were."""
    values = {joint.name: value for joint, value in zip(robot.moving_joints, SOME, strict=False)}
    links = {link.name: link for link in found.links}
    joints = {joint.name: joint for joint in found.joints}
    assert {*links} - {"world"} == {link.name for link in robot.links} - {"world"}
    assert found.followers == robot.followers
    for link in robot.links:
        if link.name != robot.root:
            for at in (dict.fromkeys(values, 0.0), values):
                error = pose_of(found, link.name, at, robot.root) - pose_of(robot, link.name, at, robot.root)
                assert np.abs(error).max() < 1e-12
        assert_same_link(links[link.name] if link.name != "world" else found.links[0], link)
    for joint in robot.moving_joints:
        other = joints[joint.name]
        assert other.type is joint.type
        assert other.axis == pytest.approx(joint.axis, abs=1e-15)  # MuJoCo makes it a unit vector again
        assert (other.limits.lower, other.limits.upper) == (joint.limits.lower, joint.limits.upper)
        assert other.limits.effort == joint.limits.effort
        assert (other.damping, other.friction) == (joint.damping, joint.friction)


SOME = [0.3 * k * (-1) ** k for k in range(1, 60)]


def assert_same_link(found: Link, link: Link) -> None:
    if link.inertial and link.inertial.mass:
        assert found.inertial == link.inertial
    else:
        assert found.inertial is None
    for mine, theirs in ((found.visuals, link.visuals), (found.collisions, link.collisions)):
        for shape, wanted in zip(mine, theirs, strict=True):
            assert type(shape.geometry) is type(wanted.geometry)
            assert shape.geometry == wanted.geometry
            assert np.abs(as_matrices(shape.origin.transform) - as_matrices(wanted.origin.transform)).max() < 1e-15
    colours = [visual.material and visual.material.rgba for visual in link.visuals]
    assert [visual.material and visual.material.rgba for visual in found.visuals] == colours


@pytest.mark.parametrize("emitter", [URDF, XACRO, SDF, MJCF], ids=lambda emitter: emitter.name)
def test_the_whole_file_is_known(arm: Robot, emitter: Emitter[Any]) -> None:
    """What is in the files of a small arm, to the letter.

    Of the servo in the MJCF: 100 N less the weight of 2.5 kg, at 0.05 · 0.25 m, are 6038 N/m; times twice 50 ms, less
    the damping of the joint, 603.3 N·s/m; and the inertia to which that belongs is 20 · 0.7548 kg.
    """
    joints = (*arm.joints[:2], replace(arm.joints[-1], parent="link_1"))
    small = replace(arm, links=(*arm.links[:3], arm.links[-1]), joints=joints)
    for file in emitter.emit(small, "arm", emitter.options()):
        assert file.content == (Path(__file__).parent / "whole_files" / file.name).read_bytes()


@formats
@frames
def test_published_arms_read_back_as_they_are(
    reference_robot: Any, emitter: Emitter[Any], frames: str, tmp_path: Path
) -> None:
    """Read back, every published arm is the arm that was written, and reaches the poses that its publisher computed."""
    robot = TRANSFORM.transform(reference_robot.manipulator, TRANSFORM.options(frames=frames))
    found = read(emitter, written(emitter, robot, tmp_path))
    assert_same_arm(found, robot)
    chain = KinematicChain.between(found)
    for q, pose in zip(reference_robot.q, reference_robot.poses, strict=True):
        assert np.abs(as_matrices(chain.forward_kinematics(q)) - np.array(pose)).max() < 1e-9


@formats
def test_an_arm_with_one_of_everything_reads_back(arm: Robot, emitter: Emitter[Any], tmp_path: Path) -> None:
    """Every joint type, every shape, meshes, damping and friction."""
    assert_same_arm(read(emitter, written(emitter, arm, tmp_path)), arm)


@formats
@frames
@given(manipulator=manipulators(most=9, lengths=SEEN_LENGTHS))
@settings(max_examples=25)
def test_any_table_reads_back(emitter: Emitter[Any], frames: str, manipulator: Manipulator) -> None:
    """Any joint types, fixed rows in the middle and at the end, any angles and followers, base and tool; also a table."""
    robot = TRANSFORM.transform(manipulator, TRANSFORM.options(frames=frames))
    with tempfile.TemporaryDirectory() as folder:
        path = written(emitter, robot, Path(folder))
        assert_same_arm(read(emitter, path), robot)
        if q := dict(zip([row.joint for row in manipulator.actuated_rows], SOME, strict=False)):
            table = dh2urdf.extract(path, base_link=robot.root, tip_link="tool0")
            assert np.abs(table.fk(q) - manipulator.fk(q)).max() < 1e-9


def renamed(robot: Robot, names: dict[str, str]) -> Robot:
    return replace(
        robot,
        links=tuple(replace(link, name=names.get(link.name, link.name)) for link in robot.links),
        joints=tuple(
            replace(
                joint,
                name=names.get(joint.name, joint.name),
                parent=names.get(joint.parent, joint.parent),
                child=names.get(joint.child, joint.child),
            )
            for joint in robot.joints
        ),
    )


@formats
@pytest.mark.parametrize("name", ["a b", "<&>", "\"quoted'", "élan", "--", "007", "$(find x)"])
def test_names_are_kept_to_the_letter(arm: Robot, emitter: Emitter[Any], name: str, tmp_path: Path) -> None:
    """Whatever a name means to XML."""
    robot = renamed(arm, {"link_1": name, "turn": f"{name} turns"})
    assert_same_arm(read(emitter, written(emitter, robot, tmp_path)), robot)


UNWRITABLE = ({"link_1": "a\nb"}, {"link_1": "world"}, {"turn": "\x1b[2J"}, {"turn": "\ud800"}, {"turn": "\uffff"})


@pytest.mark.parametrize(
    ("emitter", "names"),
    [
        (emitter, names)
        for emitter in (URDF, SDF, MJCF)
        for names in UNWRITABLE
        if emitter != URDF or "world" not in str(names)
    ],
)
def test_a_name_that_the_format_cannot_hold_is_refused(
    arm: Robot, emitter: Emitter[Any], names: dict[str, str]
) -> None:
    """Characters that XML lacks, which are shown harmlessly, and the name of what stands still."""
    with pytest.raises(EmitterError) as caught:
        content_of(emitter, renamed(arm, names))
    assert all(character.isprintable() or character == "\n" for character in str(caught.value))


@formats
def test_a_shape_of_a_weightless_link_is_not_lost(arm: Robot, emitter: Emitter[Any], tmp_path: Path) -> None:
    """It stands where it would, whatever carries it."""
    shape = replace(arm.links[2].visuals[1], material=None)
    robot = replace(
        arm, links=tuple(replace(link, visuals=(shape,)) if link.name == "flange" else link for link in arm.links)
    )
    found = read(emitter, written(emitter, robot, tmp_path))
    spheres = [
        pose_of(found, link.name, {"lift": 0.1, "turn": 0.5, "spin": 0.7}, "base_link")
        @ as_matrices(visual.origin.transform)
        for link in found.links
        for visual in link.visuals
        if visual.material is None and not isinstance(visual.geometry, Mesh)
    ]
    flange = pose_of(robot, "flange", {"lift": 0.1, "turn": 0.5, "spin": 0.7}, "base_link")
    assert len(spheres) == 1
    assert np.abs(spheres[0] - flange).max() < 1e-12


def test_a_base_of_mass_0_is_a_body_in_sdf(arm: Robot) -> None:
    """sdformat has no model without one; it stands still, and the moving links weigh what they did."""
    links = tuple(replace(each, inertial=Inertial(mass=0.0)) if each.name == BASE else each for each in arm.links)
    with_base, without = (content_of(SDF, robot) for robot in (arm, replace(arm, links=links)))
    masses = [re.findall(r"<mass>(.*?)</mass>", content.decode()) for content in (with_base, without)]
    assert masses[1] == ["1", *masses[0][1:]]


@pytest.mark.parametrize(
    "emitter", [URDF, pytest.param(XACRO, marks=pytest.mark.long), SDF], ids=lambda emitter: emitter.name
)
def test_a_thousand_axes_are_written_and_read_back(
    emitter: Emitter[Any], long_chain: Callable[[int], Robot], tmp_path: Path
) -> None:
    """Nothing recurses over the chain."""
    robot, q = long_chain(1000), [0.01 * ((7 * k) % 11) for k in range(1000)]
    for file in emitter.emit(robot, "arm", emitter.options()):
        (tmp_path / file.name).write_bytes(file.content)
    found = read(emitter, tmp_path / f"arm{emitter.suffixes[0]}")
    poses = [as_matrices(KinematicChain.between(each).forward_kinematics(q)) for each in (found, robot)]
    assert np.abs(poses[0] - poses[1]).max() < 1e-9
