"""`dh2urdf check` of folders and of several files."""

import json
import os
from pathlib import Path

import pytest
from command_line import Cli

LINK = '<?xml version="1.0"?>\n<robot name="{}">\n  <link name="base_link"/>\n  {}\n</robot>\n'
FILES = ("a/arm.urdf.xacro", "a/sound.xml", "one.urdf", "package.xml", "two.urdf")
"""What is checked of the folder: its descriptions, and the package that it is."""
TWICE = '<link name="base_link"/>'
XACRO = '<?xml version="1.0"?>\n<robot {} xmlns:xacro="http://ros.org/wiki/xacro">\n{}\n</robot>\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Descriptions, parts of descriptions, and everything else that is in the folders of makers."""
    root = tmp_path / "robots"
    for name, content in {
        "one.urdf": LINK.format("one", TWICE),
        "two.urdf": LINK.format("two", TWICE + TWICE),
        "a/sound.xml": LINK.format("three", ""),
        "a/arm.urdf.xacro": XACRO.format('name="arm"', '<xacro:include filename="part.xacro"/><xacro:base/>'),
        "a/part.xacro": XACRO.format(
            'name="part"', '<xacro:macro name="base"><link name="base_link"/><link name="base_link"/></xacro:macro>'
        ),
        "a/nameless.xacro": XACRO.format("", '<link name="${of_who_includes_it}"/>'),
        "a/arm.srdf": '<robot name="arm"><group name="arm"/></robot>',
        "package.xml": "<package><name>robots</name></package>",
        "meshes/part.stl": "solid part\nendsolid part\n",
        "README": "a robot",
        ".hidden/not.urdf": LINK.format("hidden", TWICE),
    }.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(content)
    return root


def test_a_folder_is_checked_by_what_is_in_its_files(cli: Cli, folder: Path) -> None:
    """Whole descriptions are found whatever their suffix; a cause is printed once, with the files that have it."""
    assert folder.is_dir()
    lines = cli("check", "--no-ask", "robots", "--for", "ros", status=1).stdout.splitlines()
    (index,) = [number for number, line in enumerate(lines) if line.endswith("[duplicate-link]")]
    assert lines[index].startswith("robots/a/part.xacro:3:50: error: ")
    assert lines[index + 1] == (
        "    and 3 more in 3 files: robots/one.urdf:4:3, robots/two.urdf:4:3, robots/two.urdf:4:27"
    )
    assert lines[index + 2] == "    by the macro called at robots/a/arm.urdf.xacro:3:39"
    assert lines[index + 3].startswith("    ros (foretold): ")
    assert lines[-3:] == [
        "4 errors",
        "4 descriptions and 1 package checked; 10 files looked at",
        "foretold: errors in ros",
    ]


def test_a_folder_as_json(cli: Cli, folder: Path) -> None:
    """Every finding, and the rules with how many there are in which file."""
    assert folder.is_dir()
    told = json.loads(cli("check", "--no-ask", "robots", "--for", "ros", "--format", "json", status=1).stdout)
    assert set(told) == {"schema", "version", "files", "looked_at", "consumers", "asked", "counts", "rules", "findings"}
    assert told["files"] == [f"robots/{name}" for name in FILES]
    assert told["looked_at"] == 10
    assert told["rules"]["duplicate-link"] == {
        "severity": "error",
        "files": {"robots/a/part.xacro": 1, "robots/one.urdf": 1, "robots/two.urdf": 2},
    }
    assert sum(told["counts"].values()) == len(told["findings"])


def test_what_cannot_be_looked_at_is_a_finding(cli: Cli, folder: Path) -> None:
    """A link to nothing and a pipe: the other files are checked all the same."""
    (folder / "broken.urdf").symlink_to("nowhere.urdf")
    os.mkfifo(folder / "pipe.urdf")
    told = json.loads(cli("check", "--no-ask", "robots", "--format", "json", status=1).stdout)
    found = {
        finding["file"]: finding["message"] for finding in told["findings"] if finding["rule"] == "unreadable-file"
    }
    assert found == {
        "robots/broken.urdf": "this link leads to 'nowhere.urdf', where there is no file",
        "robots/pipe.urdf": "this is a pipe or a device, not a file",
    }
    assert told["files"] == [f"robots/{name}" for name in FILES]


def test_arguments_reach_the_xacros_of_a_folder(cli: Cli, folder: Path) -> None:
    """And no other file is disturbed by them."""
    (folder / "a" / "arm.urdf.xacro").write_text(
        XACRO.format('name="arm"', '<xacro:arg name="n" default="one"/><link name="$(arg n)"/><link name="two"/>')
    )
    assert "'two' has the name" in cli("check", "--no-ask", "robots", "n:=two", status=1).stdout
    assert "'two' has the name" not in cli("check", "--no-ask", "robots", status=1).stdout


def test_the_packages_of_a_folder_are_known_to_its_files(cli: Cli, folder: Path) -> None:
    """By the names that they give themselves, to a URDF and a xacro of another package; a single file needs the option."""
    mesh = '<visual><geometry><mesh filename="package://parts/part.obj"/></geometry></visual>'
    (folder / "parts_of_all").mkdir()
    (folder / "parts_of_all" / "package.xml").write_text("<package><name>parts</name></package>")
    (folder / "parts_of_all" / "part.obj").touch()
    (folder / "parts_of_all" / "hand.xacro").write_text(XACRO.format("", f'<link name="hand">{mesh}</link>'))
    (folder / "two.urdf").write_text(f'<robot name="two"><link name="a">{mesh}</link></robot>')
    (folder / "arm.xacro").write_text(
        XACRO.format('name="arm"', '<xacro:include filename="$(find parts)/hand.xacro"/>')
    )
    for words in (["robots"], ["robots/two.urdf", "--package-path", "robots/parts_of_all"]):
        told = json.loads(cli("check", "--no-ask", *words, "--format", "json", status=1).stdout)
        assert not {finding["rule"] for finding in told["findings"]} & {"unresolved-package", "xacro-fails"}
    alone = json.loads(cli("check", "--no-ask", "robots/two.urdf", "--format", "json", status=1).stdout)
    assert "unresolved-package" in {finding["rule"] for finding in alone["findings"]}
