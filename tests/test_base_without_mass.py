"""What is written of any table is an arm in Gazebo, too: the base has a mass, but where the table has `base: {mass: 0}`."""

import json
from pathlib import Path
from typing import Any, get_args

import pytest
from command_line import Cli
from lxml import etree
from sdformat_calls import sdformat

import dh2urdf
from dh2urdf.stages import Expansion
from dh2urdf_plugins.formats.urdf import ProfileName
from dh2urdf_plugins.formats.xacro.reader import expand
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

HEADER = "# convention: standard\njoint,type,a,alpha,d,mass\n"
WEIGHED = HEADER + "one,R,0.3,pi/2,0,3\ntwo,P,0.2,0,0,2\n"
STATED = "# base: {mass: 0}\n" + WEIGHED
FULL = HEADER.replace("mass", "mass,com_x,com_y,com_z,ixx,iyy,izz") + (
    "one,R,0.3,pi/2,0,3,-0.1,0,0,0.02,0.03,0.03\ntwo,R,0.2,0,0,2,-0.1,0,0,0.01,0.02,0.02\n"
)
TABLES = {
    "weighed": WEIGHED,
    "full": FULL,
    "none": HEADER + "one,R,0.3,pi/2,0,\ntwo,P,0.2,0,0,\n",
    "frame first": HEADER + "stand,F,0,0,0.5,0\none,R,0.3,pi/2,0,3\n",
    "base with a mass": "# base: {mass: 2}\n" + WEIGHED,
    "base and tool": "# base: {xyz: [1, 0, 0.5], rpy: [0.1, 0, pi]}\n# tool: {xyz: [0, 0, 0.1]}\n" + FULL,
}
DROPS, FILLED = "Gazebo drops the whole arm of this URDF", "this file gives it 1 kg"
RIDER = "Gazebo drops an arm of this URDF that stands on another arm"
CELL = """inputs: [first.csv, second.csv]
cells:
  - name: shop
    arms: [{name: one, of: first}, {name: two, of: second, xyz: [1, 0, 0]}, {name: up, of: first, parent: two/tool0}]
output: o
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in {**TABLES, "stated": STATED}.items():
        (tmp_path / f"{name}.csv").write_text(text)
    return tmp_path


def assert_whole(path: Path, moving: int) -> None:
    """`check` finds no error, and the real sdformat keeps all moving joints and every kilogram.

    A joint with the world, which holds an SDF in Gazebo, is none to PyBullet: nothing that PyBullet takes holds it.
    """
    found = {finding.rule for finding in dh2urdf.check(path).findings if finding.severity == "error"}
    assert found == ({"sdf-world-parent"} if path.suffix == ".sdf" else set())
    content = path.read_bytes() if path.suffix != ".xacro" else expand(path)
    plain = path.with_name(f"plain{path.suffix}").with_suffix(".sdf" if path.suffix == ".sdf" else ".urdf")
    plain.write_bytes(content)
    model = etree.fromstring(sdformat("--print", plain).encode()).find("model")
    assert len([joint for joint in model.findall("joint") if joint.get("type") != "fixed"]) == moving
    kept = sum(float(mass.text) for mass in model.iter("mass"))
    assert kept == pytest.approx(sum(masses(plain).values()), rel=1e-9)


def masses(path: Path) -> dict[str, float]:
    """The mass of each link of a URDF or SDF that has one [kg]."""
    found = {}
    for link in etree.parse(path).iter("link"):
        mass = link.find("inertial/mass")
        if mass is not None:
            found[str(link.get("name"))] = float(mass.get("value") or mass.text or "0")
    return found


@pytest.mark.parametrize(
    ("table", "profile"),
    [*((table, "gazebo") for table in TABLES), *(("none", profile) for profile in get_args(ProfileName))],
)
def test_every_profile_of_every_table(folder: Path, table: str, profile: str) -> None:
    """Whichever masses the table has, and in every profile, the file is whole, and no notice speaks of the base."""
    made = dh2urdf.convert(folder / f"{table}.csv", folder / "arm.urdf", profile=profile)
    assert_whole(folder / "arm.urdf", len(made.manipulator.moving_rows))
    assert [notice for notice in made.notices if notice.field == "base.mass"] == []
    if profile == "gazebo":  # The base of the SDF has the mass that it has in the URDF.
        dh2urdf.convert(folder / f"{table}.csv", folder / "arm.sdf")
        assert_whole(folder / "arm.sdf", len(made.manipulator.moving_rows))
        assert masses(folder / "arm.sdf")["base_link_inertia"] == masses(folder / "arm.urdf")["base_link_inertia"]


@pytest.mark.parametrize(
    ("first", "second", "emitter"),
    [("full", "none", "urdf, options: {profile: gazebo}"), ("none", "full", "xacro"), ("full", "weighed", "sdf")],
)
def test_a_cell_of_such_arms(folder: Path, cli: Cli, first: str, second: str, emitter: str) -> None:
    """Two arms beside each other, and one that stands on the tool of another."""
    cell = CELL.replace("first", first).replace("second", second)
    (folder / "run.yaml").write_text(f"{cell}emitters: [{{stage: {emitter}}}]\n")
    cli("run", "run.yaml", "--quiet")
    (path,) = folder.glob("o/shop.*")
    assert_whole(path, 6)


def test_a_package_for_gazebo(folder: Path, cli: Cli) -> None:
    """The description of a package whose hardware is Gazebo's."""
    cli("convert", "none.csv", "--to", "ros2", "--set", "hardware=gazebo", "-o", "o/")
    (path,) = folder.glob("o/*/urdf/*.urdf.xacro")
    plain = folder / "plain.urdf"
    plain.write_bytes(expand_foreign(path, Expansion(package_paths=(folder / "o",))).content)
    assert b"GazeboSimROS2ControlPlugin" in plain.read_bytes()
    assert_whole(plain, 2)


@pytest.mark.parametrize(
    ("emitter", "options", "said"),
    [("urdf", {}, DROPS), ("urdf", {"profile": "gazebo"}, FILLED), ("sdf", {}, FILLED), ("mjcf", {}, "")],
)
def test_a_mass_of_0_is_a_choice(folder: Path, emitter: str, options: dict[str, Any], said: str) -> None:
    """The notice names Gazebo where the file's base has no mass, or one that the table does not state."""
    made = dh2urdf.convert(folder / "stated.csv", formats=emitter, **options)
    found = [notice.message for notice in made.notices if notice.field == "base.mass"]
    assert len(found) == bool(said)
    assert all(said in message for message in found)


def test_what_gazebo_gets_of_a_cell_without_masses_of_bases(folder: Path, cli: Cli) -> None:
    """The base at rest without a mass gets one; no other link does, such as the base of an arm on a link that moves."""
    cell = CELL.replace("first", "stated").replace("second", "none")
    (folder / "run.yaml").write_text(f"{cell}emitters: [{{stage: urdf, options: {{profile: gazebo}}}}]\n")
    cli("run", "run.yaml", "--quiet")
    (path,) = folder.glob("o/shop.*")
    found = masses(path)
    assert found["one_base_link_inertia"] == 1.0
    assert 0 < found["two_base_link_inertia"] != 1.0
    (shop,) = (
        row for row in json.loads((folder / "o" / "report.json").read_bytes())["manipulators"] if row["name"] == "shop"
    )
    assert RIDER in json.dumps(shop["notices"])
    roots = ("one_base_link", "two_base_link", "up_base_link", "up_base_link_inertia")
    assert [found.get(name, 0.0) for name in roots] == [0.0] * 4
