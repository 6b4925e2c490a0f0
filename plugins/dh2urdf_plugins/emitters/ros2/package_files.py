"""The files that make a folder a package: package.xml, CMakeLists.txt, the README and what goes with them."""

from __future__ import annotations

import re
from importlib.resources import files as resources
from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.source import markdown_text
from dh2urdf_plugins.emitters.ros2.options import NO_EMAIL, NO_LICENSE, NO_MAINTAINER
from dh2urdf_plugins.emitters.ros2.yaml_files import follows_whole_table

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.robot import Robot
    from dh2urdf_plugins.emitters.ros2.description_xacro import Kind
    from dh2urdf_plugins.emitters.ros2.options import Ros2Options

SCHEMA = "http://download.ros.org/schema/package_format3.xsd"
VIEWING = (
    "joint_state_publisher",
    "joint_state_publisher_gui",
    "launch",
    "launch_ros",
    "robot_state_publisher",
    "rviz2",
    "xacro",
)
CONTROLLING = ("controller_manager", "joint_state_broadcaster", "joint_trajectory_controller")
TESTING = ("ament_cmake_pytest", "liburdfdom-tools", "xacro")


def filled(template: str, **words: str) -> bytes:
    """A file of the folder ``templates``, with words in the places that ``@`` marks."""
    text = (
        resources("dh2urdf_plugins.emitters.ros2").joinpath("templates", f"{template}.in").read_text(encoding="utf-8")
    )
    return re.sub("@([A-Z_]+)@", lambda place: words[place[1]], text).encode()  # At once: a word may be a robot's name.


def package_xml(
    package: str, description: str, options: Ros2Options, needed: Iterable[str], tested: Iterable[str]
) -> bytes:
    """``package.xml`` in format 3 (REP 149)."""
    root = etree.Element("package", format="3")
    etree.SubElement(root, "name").text = package
    etree.SubElement(root, "version").text = options.version
    etree.SubElement(root, "description").text = description
    maintainer = etree.SubElement(root, "maintainer", email=options.email or NO_EMAIL)
    maintainer.text = options.maintainer or NO_MAINTAINER
    etree.SubElement(root, "license").text = options.license or NO_LICENSE
    etree.SubElement(root, "buildtool_depend").text = "ament_cmake"
    for tag, names in (("exec_depend", needed), ("test_depend", tested)):
        for name in names:
            etree.SubElement(root, tag).text = name
    etree.SubElement(etree.SubElement(root, "export"), "build_type").text = "ament_cmake"
    etree.indent(root, "  ")
    model = etree.ProcessingInstruction("xml-model", f'href="{SCHEMA}" schematypens="http://www.w3.org/2001/XMLSchema"')
    parts = [etree.tostring(part, encoding="UTF-8") for part in (model, root)]
    return b'<?xml version="1.0"?>\n' + b"\n".join(parts) + b"\n"


def cmake_lists(package: str, folders: Iterable[str], test: str, names: Iterable[str] = ()) -> bytes:
    """``CMakeLists.txt``, which installs the folders and files that are there, and runs a test."""
    files = "".join(f"\ninstall(FILES {name} DESTINATION share/${{PROJECT_NAME}})" for name in names)
    return filled("CMakeLists.txt", PACKAGE=package, FOLDERS=" ".join(sorted(folders)), FILES=files, TEST=test)


def changelog(package: str, version: str) -> bytes:
    """``CHANGELOG.rst`` in the form that catkin_pkg reads (REP 132)."""
    title = f"Changelog for package {package}"
    line = "^" * len(title)
    entry = f"{version} (forthcoming)"
    return f"{line}\n{title}\n{line}\n\nForthcoming\n-----------\n* {entry}: made by dh2urdf\n".encode()


def license_file(options: Ros2Options) -> bytes:
    """``LICENSE``: the identifier of the license, whose text is the maintainer's to add."""
    return f"SPDX-License-Identifier: {options.license}\n".encode()


def readme(package: str, name: str, robot: Robot, kinds: Sequence[Kind], options: Ros2Options) -> bytes:
    """``README.md``: how to build the package, and which of its files a person replaces."""
    control = "| `urdf/*.ros2_control.xacro` | its joints for ros2_control |\n"
    return filled(
        "README.md",
        PACKAGE=package,
        NAME=name,
        ROBOT=markdown_text(robot.name),
        CONTROL=control if options.controlled else "",
        USE="" if robot.arms else _use(package, kinds[0]),
        CALIBRATION="\n".join(_calibration(kind) for kind in kinds),
    )


def _use(package: str, kind: Kind) -> str:
    controllers = "`ros2_controllers.yaml` names the joints without a prefix: write its joints with yours.\n"
    return (
        f"Mount the arm in a robot of your own:\n\n"
        f'    <xacro:include filename="$(find {package})/urdf/{kind.macro}_macro.xacro"/>\n'
        f'    <xacro:{kind.macro} prefix="left_" parent="table">\n'
        f'      <origin xyz="0 0 0.8" rpy="0 0 0"/>\n'
        f"    </xacro:{kind.macro}>\n\n"
        f"The arguments of the file to open are `prefix`, `parent` (a link to mount the arm on, such as `world`), "
        f"`xyz` and `rpy`,\nand the files that the macro reads. {controllers}"
    )


def _calibration(kind: Kind) -> str:
    if follows_whole_table(kind.robot):
        return (
            f"The macro `{kind.macro}` reads the rows of the table from `{kind.folder}/dh.yaml`. Write the numbers of "
            "a calibrated arm\ninto a file of the same form and pass its path as `dh_file`; nothing else changes.\n"
        )
    return (
        f"The macro `{kind.macro}` has the numbers of the table, because the joint axes depend on all rows before "
        "them. For a\ncalibrated arm run dh2urdf on the calibrated table. With `--frames dh` the rows are in "
        "`config/dh.yaml` instead, and\nanother file can take its place.\n"
    )
