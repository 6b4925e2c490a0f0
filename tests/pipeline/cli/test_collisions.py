"""`dh2urdf collisions`: pairs of URDFs and xacros of any origin, in new SRDFs and in earlier ones."""

import subprocess
import sys
from pathlib import Path

import pytest
from command_line import Cli
from lxml import etree

pytest.importorskip("pinocchio")

ROBOT = """<robot name="two" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="far" default="2.0"/>
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="left"><collision><origin xyz="1 0 0"/><geometry>SHAPE</geometry></collision></link>
  <link name="right"><collision><origin xyz="-1 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="turn_left" type="continuous"><parent link="base"/><child link="left"/><axis xyz="0 0 2"/></joint>
  <joint name="turn_right" type="revolute">
    <parent link="base"/><child link="right"/><origin xyz="0 $(arg far) 0"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="turn_left" multiplier="0.1"/>
  </joint>
</robot>
"""
SPHERE = '<sphere radius="0.1"/>'
TETRAHEDRON = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def plain(shape: str = SPHERE, far: str = "9.0") -> str:
    lines = ROBOT.replace("SHAPE", shape).replace("$(arg far)", far).splitlines()
    return "\n".join(line for line in lines if "xacro:arg" not in line)


def pairs(content: str | bytes) -> dict[tuple[str, str], str]:
    root = etree.fromstring(content.encode() if isinstance(content, str) else content)
    return {(each.get("link1"), each.get("link2")): each.get("reason") for each in root.findall("disable_collisions")}


FOUND = {("base", "left"): "Adjacent", ("base", "right"): "Adjacent", ("left", "right"): "Never"}


def test_to_standard_output_and_to_a_file(cli: Cli, tmp_path: Path) -> None:
    """The same bytes; the summary goes to standard error."""
    (tmp_path / "two.urdf").write_text(plain())
    told = cli("collisions", tmp_path / "two.urdf")
    assert pairs(told.stdout) == FOUND
    assert told.stderr.strip() == (
        "two.urdf: 3 links with collision shapes; Adjacent 2, Default 0, Always 0, Never 1; 0 pairs to check"
    )
    cli("collisions", tmp_path / "two.urdf", "-o", tmp_path / "two.srdf", "-q")
    assert (tmp_path / "two.srdf").read_text() == told.stdout


def test_an_earlier_file_is_brought_up_to_date(cli: Cli, tmp_path: Path) -> None:
    """In place with -o, or from another one with --update, which stays as it is."""
    (tmp_path / "two.urdf").write_text(plain())
    earlier = '<robot name="two">\n  <!-- mine -->\n  <group name="all"/>\n</robot>\n'
    (tmp_path / "old.srdf").write_text(earlier)
    cli("collisions", tmp_path / "two.urdf", "--update", tmp_path / "old.srdf", "-o", tmp_path / "new.srdf")
    assert (tmp_path / "old.srdf").read_text() == earlier
    new = (tmp_path / "new.srdf").read_text()
    assert new.startswith(earlier.removesuffix("</robot>\n"))
    assert pairs(new) == FOUND
    cli("collisions", tmp_path / "two.urdf", "-o", tmp_path / "old.srdf")
    assert (tmp_path / "old.srdf").read_text() == new
    (tmp_path / "two.urdf").write_text(plain(far="0.5"))
    cli("collisions", tmp_path / "two.urdf", "-o", tmp_path / "old.srdf")
    assert pairs((tmp_path / "old.srdf").read_bytes()) == {pair: FOUND[pair] for pair in list(FOUND)[:2]}


def test_options_reach_the_search(cli: Cli, tmp_path: Path) -> None:
    """Two that meet and two that keep 30 cm apart; a wrong number is an error."""
    mimic = '<mimic joint="turn_left" multiplier="0.1"/>'
    (tmp_path / "two.urdf").write_text(plain(far="0.25").replace(mimic, ""))
    robot = tmp_path / "two.urdf"
    assert ("left", "right") not in pairs(cli("collisions", robot, "--trials", "500", "--seed", "4").stdout)
    cli("collisions", robot, "--trials", "0", status=2)
    (tmp_path / "two.urdf").write_text(plain(far="2.25").replace(mimic, ""))
    assert ("left", "right") in pairs(cli("collisions", robot).stdout)
    assert ("left", "right") not in pairs(cli("collisions", robot, "--min-distance", "0.5").stdout)


def test_a_xacro_is_expanded_with_arguments(cli: Cli, tmp_path: Path) -> None:
    """Inside the fence: the values of arguments decide where the links are."""
    (tmp_path / "two.urdf.xacro").write_text(ROBOT.replace("SHAPE", SPHERE))
    assert ("left", "right") not in pairs(cli("collisions", tmp_path / "two.urdf.xacro", "far:=0.5").stdout)
    assert pairs(cli("collisions", tmp_path / "two.urdf.xacro", "far:=9.0").stdout) == FOUND
    evil = ROBOT.replace("SHAPE", SPHERE).replace("$(arg far)", "${open('/etc/passwd').read()}")
    (tmp_path / "evil.urdf.xacro").write_text(evil)
    assert "open" in cli("collisions", tmp_path / "evil.urdf.xacro", status=2).stderr


def test_meshes_are_found_in_packages(cli: Cli, tmp_path: Path) -> None:
    """Named by --package-path."""
    (tmp_path / "src" / "lab" / "meshes").mkdir(parents=True)
    (tmp_path / "src" / "lab" / "package.xml").write_text("<package><name>lab</name></package>")
    (tmp_path / "src" / "lab" / "meshes" / "part.obj").write_text(TETRAHEDRON)
    (tmp_path / "other").mkdir()
    robot = tmp_path / "other" / "two.urdf"
    robot.write_text(plain('<mesh filename="package://lab/meshes/part.obj" scale="2 2 2"/>'))
    cli("collisions", robot, status=2)
    assert pairs(cli("collisions", robot, "--package-path", tmp_path / "src").stdout) == FOUND


def test_without_pinocchio_the_error_names_the_extra(tmp_path: Path) -> None:
    """Status 3; the help of the command needs nothing of it."""
    (tmp_path / "two.urdf").write_text(plain())
    code = (
        "import sys; sys.modules['pinocchio'] = None; from dh2urdf.cli import main; main(['collisions', *sys.argv[1:]])"
    )
    command = [sys.executable, "-c", code]
    failed = subprocess.run([*command, tmp_path / "two.urdf"], capture_output=True, text=True, check=False)
    assert failed.returncode == 3
    assert "dh2urdf[pinocchio]" in failed.stderr
    helped = subprocess.run([*command, "--help"], capture_output=True, text=True, check=True)
    assert "MoveIt" in helped.stdout
