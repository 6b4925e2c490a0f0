"""Profiles, each proved by the reader that it is for: what is better with it than with the portable file."""

import ctypes
import logging
import math
import re
import shutil
import subprocess
import tomllib
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from importlib.resources import files
from pathlib import Path
from typing import Any, get_args
from xml.etree import ElementTree as ET

import pytest
from drake_frames import drake_plant
from two_fingers import HAND

import dh2urdf_plugins.formats.urdf
from dh2urdf.cells.attachments import attached
from dh2urdf.cells.cell import ArmCall, Cell, CellCall, compose
from dh2urdf.errors import EmitterError
from dh2urdf.robot import Origin, Robot
from dh2urdf.stages import GivesNotices, ReadsBack
from dh2urdf_plugins.edits.attach import AttachOptions
from dh2urdf_plugins.formats.urdf import EMITTER as URDF, ProfileName
from dh2urdf_plugins.formats.urdf.profiles import PROFILES, Profile
from dh2urdf_plugins.formats.xacro import EMITTER as XACRO
from dh2urdf_plugins.formats.xacro.reader import expand
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

Write = Callable[..., Path]

PAGE = Path(__file__).parents[3] / "docs" / "profiles.md"
CONFIGS = Path(__file__).parents[3] / "configs"
profiles = pytest.mark.parametrize("profile", PROFILES)


@pytest.fixture
def ur5(reference_robots: Sequence[Any]) -> Robot:
    """A UR5 of boxes whose base collides, whose first joint has friction, and whose second cannot be at 0."""
    manipulator = next(robot for robot in reference_robots if robot.id == "urdoc_ur5").manipulator
    robot = TRANSFORM.transform(manipulator, TRANSFORM.options(shape="box", base_collision=True))
    first, second, *_ = robot.moving_joints
    above = replace(second.limits, lower=0.2)
    changed = {first.name: replace(first, friction=0.5), second.name: replace(second, limits=above)}
    return replace(robot, joints=tuple(changed.get(joint.name, joint) for joint in robot.joints))


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Writes the URDF of a robot for a profile."""

    def urdf(robot: Robot, profile: str) -> Path:
        (file,) = URDF.emit(robot, f"arm_{profile}", URDF.options(profile=profile))
        path = tmp_path / file.name
        path.write_bytes(file.content)
        return path

    return urdf


def expanded(robot: Robot, profile: str, folder: Path, **options: Any) -> bytes:
    files = XACRO.emit(robot, "arm", XACRO.options(profile=profile, **options))
    for file in files:
        (folder / file.name).write_bytes(file.content)
    return expand(folder / files[0].name)


# --- All profiles -----------------------------------------------------------------------------------------------------


def test_every_profile_has_a_name() -> None:
    """What the option accepts is what there is; portable is the default and decides nothing."""
    assert tuple(PROFILES) == get_args(ProfileName)
    assert PROFILES["portable"] == Profile()
    assert (URDF.options().profile, XACRO.options().profile) == ("portable", "portable")
    assert len(set(map(repr, PROFILES.values()))) == len(PROFILES)


@profiles
def test_other_limits_are_told(reference_robots: Sequence[Any], write: Write, profile: ProfileName) -> None:
    """The file of a profile has the limits of the arm, but for those that a notice names, joint by joint."""
    reads = URDF.can(ReadsBack)
    gives = URDF.can(GivesNotices)
    widened = 0
    for published in reference_robots:
        robot = TRANSFORM.transform(published.manipulator, TRANSFORM.options())
        limits = {joint.name: joint.limits for joint in robot.joints}
        found = reads.read_back(write(robot, profile)).moving_joints
        other = {joint.name: joint.limits for joint in found if joint.limits != limits[joint.name]}
        told = {each.joint for each in gives.notices(robot, URDF.options(profile=profile)) if each.field == "limits"}
        assert told == set(other)
        for name, held in other.items():
            assert held == replace(
                limits[name], lower=min(limits[name].lower or 0.0, 0.0), upper=max(limits[name].upper or 0.0, 0.0)
            )
        widened += len(other)
    assert bool(widened) == (profile == "coppeliasim")


@profiles
@pytest.mark.parametrize("single_file", [False, True])
def test_the_xacro_says_the_same(ur5: Robot, write: Write, tmp_path: Path, profile: str, *, single_file: bool) -> None:
    """Expanded, the xacro of a profile is its URDF: same elements in the same order, but for a world, which comes first."""
    found = ET.fromstring(expanded(ur5, profile, tmp_path, single_file=single_file))  # noqa: S314
    wanted = ET.parse(write(ur5, profile)).getroot()  # noqa: S314
    elements, others = ([described(element) for element in tree.iter()] for tree in (found, wanted))
    assert Counter(elements) == Counter(others)
    assert elements == others or PROFILES[profile].held


def described(element: Any) -> tuple[Any, ...]:
    """An element with its numbers as such: xacro evaluates some of them."""
    words = {
        key: tuple(
            round(float(word), 12) + 0.0 if re.fullmatch(r"-?[0-9.]+(e-?\d+)?", word) else word for word in text.split()
        )
        for key, text in element.attrib.items()
    }
    return (element.tag, (element.text or "").strip(), tuple(sorted(words.items())))


@profiles
def test_a_cell_is_the_same_in_both(cli: Callable[..., Any], tmp_path: Path, profile: str) -> None:
    """Of a cell with an arm on another, URDF and expanded xacro, of one file but for the portable one, say the same."""
    emitters = f"emitters=[{{stage: urdf, options: {{profile: {profile}}}}}, {{stage: xacro, options: {{profile: {profile}, single_file: {profile != 'portable'}}}}}]"
    transform = "transform={stage: alpha-swap, options: {base_collision: true}}"
    words = ("--set", emitters, "--set", "loaders=[]", "--set", transform)
    cli("run", CONFIGS / "ur5_on_track.yaml", "-o", tmp_path, *words)
    found = ET.fromstring(expand(tmp_path / "ur5_on_track.urdf.xacro"))  # noqa: S314
    wanted = ET.parse(tmp_path / "ur5_on_track.urdf").getroot()  # noqa: S314
    assert Counter(map(described, found.iter())) == Counter(map(described, wanted.iter()))


def with_hands(robot: Robot, **parents: str) -> Robot:
    """A robot with a hand of each name on a link."""
    for name, parent in parents.items():
        options = AttachOptions(file=HAND, name=name, parent=parent, xyz=(0.1, 0.0, 0.011), rpy=(0.1, 0.2, math.pi / 2))
        robot = attached(robot, options.attachment[0])
    return robot


@profiles
@pytest.mark.parametrize("single_file", [False, True])
def test_what_is_attached_is_the_same_in_both(
    ur5: Robot, write: Write, tmp_path: Path, profile: str, *, single_file: bool
) -> None:
    """A hand that holds another one, in a macro each, with their transmissions, systems and materials."""
    robot = with_hands(ur5, hand="tool0", second="hand_tool0")
    found = ET.fromstring(expanded(robot, profile, tmp_path, single_file=single_file))  # noqa: S314
    wanted = ET.parse(write(robot, profile)).getroot()  # noqa: S314
    assert Counter(map(described, found.iter())) == Counter(map(described, wanted.iter()))
    files = {path.name: path.read_bytes() for path in tmp_path.glob("*.xacro")}
    assert [name for name, content in files.items() if b'name="part_hand"' in content] == [
        "arm.urdf.xacro" if single_file else "arm_parts.xacro"
    ]
    assert sum(content.count(b"<mimic") for content in files.values()) == 1


@profiles
def test_a_cell_of_hands_is_the_same_in_both(ur5: Robot, write: Write, tmp_path: Path, profile: str) -> None:
    """One macro for hands of two arms, on the floor and on a hand; the arm that bears two is a kind of its own."""
    arm = with_hands(ur5, hand="tool0")
    arms = tuple(
        ArmCall(name=name, of="ur5", prefix=f"{name}_", placement=Origin(xyz=(at, 0.0, 0.0)))
        for name, at in (("left", 0.0), ("right", 1.0))
    )
    cell = compose(Cell(call=CellCall(name="cell", arms=arms), manipulators={}), {"ur5": arm})
    robot = with_hands(cell, floor="world", extra="left_hand_tool0")
    found = ET.fromstring(expanded(robot, profile, tmp_path))  # noqa: S314
    wanted = ET.parse(write(robot, profile)).getroot()  # noqa: S314
    assert Counter(map(described, found.iter())) == Counter(map(described, wanted.iter()))
    macros = re.findall(r'<xacro:macro name="(\w+)"', (tmp_path / "arm_parts.xacro").read_text())
    assert macros == ["part_hand"]
    macros = re.findall(r'<xacro:macro name="(\w+)"', (tmp_path / "arm_macro.xacro").read_text())
    assert [name for name in macros if not name.endswith("_at")] == ["urdoc_ur5", "urdoc_ur5_2"]
    calls = re.findall(r"<xacro:(part\w+) prefix=", (tmp_path / "arm.urdf.xacro").read_text())
    assert calls == ["part_hand"] * 2


# --- Each by its reader -----------------------------------------------------------------------------------------------


def test_ros(ur5: Robot, write: Write, capfd: pytest.CaptureFixture[str]) -> None:
    """urdf_parser_py has nothing to say, where it complains of a tag of the portable file."""
    urdf = pytest.importorskip("urdf_parser_py.urdf")
    said = {}
    for profile in ("portable", "ros"):
        urdf.URDF.from_xml_file(str(write(ur5, profile)))
        said[profile] = capfd.readouterr().err
    assert 'Unknown tag "mujoco"' in said["portable"]
    assert said["ros"] == ""


def test_pybullet(ur5: Robot, write: Write, capfd: pytest.CaptureFixture[str]) -> None:
    """PyBullet has nothing to say, where it warns of the root of the portable file; the arm is as heavy."""
    bullet = pytest.importorskip("pybullet")
    bullet.connect(bullet.DIRECT)
    ctypes.CDLL(None).fflush(None)
    capfd.readouterr()
    said, masses = {}, {}
    try:
        for profile in ("portable", "pybullet"):
            arm = bullet.loadURDF(str(write(ur5, profile)), useFixedBase=True)
            masses[profile] = sum(bullet.getDynamicsInfo(arm, number)[0] for number in range(bullet.getNumJoints(arm)))
            ctypes.CDLL(None).fflush(None)
            said[profile] = "".join(capfd.readouterr())
    finally:
        bullet.disconnect()
    assert "No inertial data for link" in said["portable"]
    assert said["pybullet"] == ""
    assert masses["pybullet"] == masses["portable"] == pytest.approx(ur5.mass, rel=1e-6)


def test_mujoco(reference_robots: Sequence[Any], write: Write) -> None:
    """No contact pushes the arm away from its base, as in the portable file."""
    mujoco = pytest.importorskip("mujoco")
    manipulator = next(robot for robot in reference_robots if robot.id == "rtb_P8").manipulator
    robot = TRANSFORM.transform(manipulator, TRANSFORM.options(base_collision=True))
    contacts, moved = {}, {}
    for profile in ("portable", "mujoco"):
        model = mujoco.MjModel.from_xml_path(str(write(robot, profile)))
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        contacts[profile] = data.ncon
        model.opt.gravity[:] = 0.0  # Then nothing else moves it.
        for _ in range(500):
            mujoco.mj_step(model, data)
        moved[profile] = abs(data.qpos).max()
    assert contacts["portable"] > 0
    assert contacts["mujoco"] == 0
    assert moved["portable"] > 0.01
    assert moved["mujoco"] == 0.0


def test_gazebo(ur5: Robot, write: Write, tmp_path: Path) -> None:
    """sdformat makes a model of it that stands on the world; that of the portable file is free to fall."""
    command = shutil.which("gz") or shutil.which("ign")
    if command is None:
        pytest.skip("sdformat is not installed (Debian: libsdformat-dev, ignition-tools)")
    free = {}
    for profile in ("portable", "gazebo"):
        done = subprocess.run([command, "sdf", "-p", str(write(ur5, profile))], capture_output=True, check=True)
        path = tmp_path / f"{profile}.sdf"
        path.write_bytes(done.stdout)
        plant = drake_plant(path)
        free[profile] = plant.num_velocities() - len(ur5.moving_joints)
    assert free == {"portable": 6, "gazebo": 0}


def test_coppeliasim_gets_what_it_reads(ur5: Robot, write: Write) -> None:
    """No axis is -z, every material has its colour where it is used, each body touches, and no frame has an inertial.

    Of others a frame weighs a kilogram there, and a body stands still: `tests/plugins/loaders/test_coppeliasim_arms.py`.
    """
    ur5 = replace(ur5, links=tuple(replace(link, collisions=()) for link in ur5.links))
    axes, colours, odd = {}, {}, {}
    for profile in ("portable", "coppeliasim"):
        tree = ET.parse(write(ur5, profile)).getroot()  # noqa: S314
        axes[profile] = {axis.get("xyz") for axis in tree.iter("axis")}
        odd[profile] = {
            link.get("name")
            for link in tree.iter("link")
            if (mass := link.find("inertial/mass")) is not None
            and (link.find("collision") is None or not float(mass.get("value")))
        }
        colours[profile] = [material.find("color") is not None for material in tree.findall("link/visual/material")]
    assert "0 0 -1" in axes["portable"]
    assert axes["coppeliasim"] == axes["portable"] - {"0 0 -1"} | {"1e-30 0 -1"}
    assert {"link_5", "tool0"} <= odd["portable"]
    assert odd["coppeliasim"] == {"base_link_inertia"}
    assert not any(colours["portable"])
    assert all(colours["coppeliasim"])
    assert len(colours["coppeliasim"]) == len(colours["portable"]) > 0


def test_names_that_coppeliasim_changes(ur5: Robot, write: Write) -> None:
    """Names that an API call must write otherwise are reported; two joints of one name there cannot be distinguished."""
    options, gives = URDF.options(profile="coppeliasim"), URDF.can(GivesNotices)

    def renamed(names: dict[str, str]) -> Robot:
        return replace(ur5, joints=tuple(replace(each, name=names.get(each.name, each.name)) for each in ur5.joints))

    told = [notice.message for notice in gives.notices(renamed({"joint_3": "größe-3"}), options)]
    assert [("gr____e_3" in message, "größe-3" in message) for message in told].count((True, True)) == 1
    assert not any("größe-3" in notice.message for notice in gives.notices(ur5, options))
    alike = renamed({"joint_3": "a-b", "joint_4": "a.b"})
    write(alike, "portable")
    with pytest.raises(EmitterError):
        write(alike, "coppeliasim")


def test_drake(ur5: Robot, write: Write, caplog: pytest.LogCaptureFixture) -> None:
    """Every joint has an actuator with its effort, and Drake logs nothing; of the portable file it knows no effort."""
    efforts, logged = {}, {}
    for profile in ("portable", "drake"):
        caplog.clear()
        with caplog.at_level(logging.INFO, "drake"):
            plant = drake_plant(write(ur5, profile))
        actuators = map(plant.get_joint_actuator, plant.GetJointActuatorIndices())
        efforts[profile] = {actuator.joint().name(): actuator.effort_limit() for actuator in actuators}
        logged[profile] = [record.getMessage() for record in caplog.records if record.name.startswith("drake")]
    assert efforts["portable"] == {}
    assert efforts["drake"] == {joint.name: joint.limits.effort for joint in ur5.moving_joints}
    assert any("friction" in message for message in logged["portable"])
    assert logged["drake"] == []


# --- The page ---------------------------------------------------------------------------------------------------------


def table() -> str:
    """The decisions as a table of Markdown."""
    lines = ["| portable | otherwise | for | why |", "|---|---|---|---|"]
    decisions = tomllib.loads((files(dh2urdf_plugins.formats.urdf) / "profiles.toml").read_text("utf-8"))
    assert [*decisions] == [decision.name for decision in fields(Profile)]
    for decision in fields(Profile):
        users = [name for name, profile in PROFILES.items() if getattr(profile, decision.name) != decision.default]
        words = decisions[decision.name]
        listed = ", ".join(f"`{name}`" for name in users)
        lines.append(f"| {words['portable']} | {words['otherwise']} | {listed} | {words['why']} |")
    return "\n".join([*lines, ""])


def test_the_page_has_every_decision(*, renew: bool) -> None:
    """The table in docs/profiles.md is that of profiles.py and profiles.toml; `--renew` writes it."""
    text = PAGE.read_text("utf-8")
    pattern = re.compile(r"(?<=<!-- decisions -->\n)(.*?)(?=<!-- /decisions -->)", re.DOTALL)
    if renew:
        PAGE.write_text(pattern.sub(lambda _: table(), text), "utf-8")
        text = PAGE.read_text("utf-8")
    found = pattern.search(text)
    assert found is not None
    assert found[0] == table(), "run `pytest --renew tests/plugins/emitters/test_profiles.py`"
