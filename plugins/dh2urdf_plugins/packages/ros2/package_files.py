"""The files that make a folder a package, and what shows and tests a robot in ROS 2; names that ROS accepts."""

from __future__ import annotations

import pprint
import re
import unicodedata
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

from dh2urdf.errors import EmitterError
from dh2urdf.kinematics import link_poses
from dh2urdf.manipulator import TOOL, JointType
from dh2urdf.robot import with_followers
from dh2urdf.rotations import norm, total
from dh2urdf.source import Messages, markdown_text
from dh2urdf_plugins.home_pose import initial_position
from dh2urdf_plugins.packages import templates
from dh2urdf_plugins.packages.ros2 import NO_EMAIL, NO_LICENSE, NO_MAINTAINER
from dh2urdf_plugins.packages.ros2.yaml_files import follows_whole_table
from dh2urdf_plugins.ros_conventions import PACKAGE_NAME

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.robot import Robot
    from dh2urdf_plugins.packages.ros2 import Ros2Options
    from dh2urdf_plugins.packages.ros2.description_xacro import Kind

say = Messages(__file__)


TESTING = ("ament_cmake_pytest", "liburdfdom-tools", "xacro")
_SHORTEST = 2
_SUFFIX = "_description"
_PARTS = (0.5, 0.2, 0.9)  # where between their limits the joints are in the test of a package
_UNLIMITED = 3.0  # the bound of a joint without limits in that test [rad]


# --- Names ------------------------------------------------------------------------------------------------------------


def package_stem(stem: str, package: str) -> str:
    """What the names of a robot's packages begin with: as `robot_name` has it, allowed or not."""
    return package.removesuffix(_SUFFIX) or stem


def robot_name(stem: str, package: str) -> str:
    """The name of a robot in the names of its packages, which is that of its file or what the option `package` has.

    Where REP 144 does not allow the name, the error proposes another.
    """
    name = package_stem(stem, package)
    if PACKAGE_NAME.fullmatch(name) and len(name) >= _SHORTEST:
        return name
    package, proposed = f"{name}{_SUFFIX}", proposed_name(name)
    raise EmitterError(say("package-name-wrong", field="package", found=name, package=package, proposed=proposed))


def proposed_name(name: str) -> str:
    """The name that REP 144 allows and that is nearest to another."""
    near = plain_name(name.lower(), "[^a-z0-9]+").strip("_")
    if not near:
        return "my_arm"
    return near if near[0].isalpha() and len(near) >= _SHORTEST else f"arm_{near}"


def check_names(robot: Robot, *, prefixes: bool) -> None:
    """Checks that the names of links, joints and materials are safe in YAML keys, parameters and frames."""
    problems = []
    materials = [visual.material.name for link in robot.links for visual in link.visuals if visual.material]
    named = [("link", link.name) for link in robot.links] + [("joint", joint.name) for joint in robot.joints]
    for what, name in [*named, *(("material", name) for name in dict.fromkeys(materials))]:
        if not re.fullmatch(r"[A-Za-z0-9_-]+", name):
            near = plain_name(name).strip("_") or what
            problems.append(say("ros-name-wrong", found=name, what=what, near=near))
    # They begin the names of controllers, which are nodes: letters, digits, ``_`` (rmw_validate_node_name).
    begin = [("ros-prefix-wrong", "arm", arm.prefix, arm.name) for arm in robot.arms if arm.prefix]
    begin += [("ros-part-wrong", "part", each.name, "") for each in robot.attachments if each.robot.actuated_joints]
    for code, what, name, arm_name in begin if prefixes else ():
        if not re.fullmatch("[A-Za-z_][A-Za-z0-9_]*", name):
            near = plain_name(name, "[^A-Za-z0-9_]+")
            proposed = f"{what}_{near}" if near[:1].isdigit() else near
            problems.append(say(code, found=name, arm=arm_name, proposed=proposed))
    if problems:
        raise EmitterError(problems)


def plain_name(name: str, others: str = "[^A-Za-z0-9_-]+") -> str:
    """A name without accents, and with ``_`` for each run of other characters."""
    bare = "".join(letter for letter in unicodedata.normalize("NFKD", name) if not unicodedata.combining(letter))
    return re.sub(others, "_", bare)


# --- Packages ---------------------------------------------------------------------------------------------------------


def filled(template: str, **words: str) -> bytes:
    """A file of the folder ``templates``."""
    return templates.filled(f"ros2/templates/{template}", **words).encode()


def package_xml(
    package: str, description: str, options: Ros2Options, needed: Iterable[str], tested: Iterable[str]
) -> bytes:
    """``package.xml`` in format 3 (REP 149)."""
    depends = [f"<exec_depend>{name}</exec_depend>" for name in needed]
    depends += [f"<test_depend>{name}</test_depend>" for name in tested]
    return filled(
        "package.xml",
        NAME=package,
        VERSION=options.version,
        DESCRIPTION=escape(description),
        EMAIL=escape(options.email or NO_EMAIL),
        MAINTAINER=escape(options.maintainer or NO_MAINTAINER),
        LICENSE=escape(options.license or NO_LICENSE),
        DEPENDS="\n".join(depends),
    )


def cmake_lists(package: str, folders: Iterable[str], test: str, names: Iterable[str] = ()) -> bytes:
    """``CMakeLists.txt``, which installs the folders and files that are there, and runs a test."""
    files = "\n".join(f"install(FILES {name} DESTINATION share/${{PROJECT_NAME}})" for name in names)
    return filled("CMakeLists.txt", PACKAGE=package, FOLDERS=" ".join(sorted(folders)), FILES=files, TEST=test)


def changelog_and_license(package: str, options: Ros2Options) -> dict[str, bytes]:
    """``CHANGELOG.rst`` as catkin_pkg reads it (REP 132), and the identifier of a license, whose text a person adds."""
    line = "^" * len(f"Changelog for package {package}")
    files = {"CHANGELOG.rst": filled("CHANGELOG.rst", LINE=line, PACKAGE=package, VERSION=options.version)}
    return files | ({"LICENSE": f"SPDX-License-Identifier: {options.license}\n".encode()} if options.license else {})


def readme(package: str, name: str, robot: Robot, kinds: Sequence[Kind], options: Ros2Options) -> bytes:
    """``README.md``: how to build the package, and which of its files a person replaces."""
    control = "| `urdf/*.ros2_control.xacro` | its joints for ros2_control |"
    parts = "| `urdf/*_parts.xacro` | the macros of what is attached, with the numbers of its own files |"
    use = b"" if robot.arms else filled("use.md", PACKAGE=package, MACRO=kinds[0].macro)
    calibrations = [
        filled("calibration_of_table.md", MACRO=kind.macro, FOLDER=kind.folder)
        if follows_whole_table(kind.robot)
        else filled("calibration.md", MACRO=kind.macro)
        for kind in kinds
    ]
    return filled(
        "README.md",
        PACKAGE=package,
        NAME=name,
        ROBOT=markdown_text(robot.name),
        CONTROL=control if options.controlled else "",
        PARTS=parts if robot.attachments else "",
        USE=use.decode().removesuffix("\n"),
        CALIBRATION=b"\n".join(calibrations).decode(),
    )


# --- View and test ----------------------------------------------------------------------------------------------------


def launch_file(package: str, name: str, robot: Robot) -> bytes:
    """``view_robot.launch.py``; the arms of a cell have their prefixes already."""
    # The command is split as a shell does: an empty text is two quotes.
    declaration = """DeclareLaunchArgument(
    "prefix", default_value='""', description="Prefix of the names of links and joints."
),"""
    return filled(
        "view_robot.launch.py",
        PACKAGE=package,
        NAME=name,
        PREFIX_ARGUMENT="" if robot.arms else '" prefix:=",\nLaunchConfiguration("prefix"),',
        PREFIX_DECLARATION="" if robot.arms else declaration,
    )


def view(template: str, robot: Robot) -> bytes:
    """A view of RViz: the robot from a distance that suits its size."""
    size = max(total(norm(joint.origin.xyz) for joint in robot.joints) / max(len(robot.arms), 1), 0.1)
    numbers = {"CELL": size / 5.0, "MARKER": size / 3.0, "DISTANCE": 2.0 * size, "HEIGHT": size / 3.0}
    return filled(template, ROOT=robot.root, **{name: f"{value:.3g}" for name, value in numbers.items()})


def test_file(package: str, name: str, robot: Robot) -> bytes:
    """``test_description.py``: T(root → tool) at some joint vectors, as numbers.

    Of an attachment, its tip or last link is a tool.
    """
    tools = [arm.prefix + TOOL for arm in robot.arms] or [TOOL]
    tools = [tool for tool in tools if any(link.name == tool for link in robot.links)] or [robot.links[-1].name]
    tools += [each.prefix + (each.tip or each.robot.links[-1].name) for each in robot.attachments]
    poses = []
    for part in (0.0, *_PARTS):  # first where the joints start
        values = {joint.name: initial_position(joint) for joint in robot.actuated_joints}
        for place, joint in enumerate(robot.actuated_joints if part else ()):
            lower, upper = joint.limits.lower, joint.limits.upper
            if joint.type is JointType.CONTINUOUS or lower is None or upper is None:
                lower, upper = -_UNLIMITED, _UNLIMITED
            share = part if place % 2 else 1.0 - part
            values[joint.name] = round(lower + share * (upper - lower), 6)
        values = with_followers(values, robot.followers)
        frames = link_poses(robot, values)
        rows = {}
        for tool in tools:
            r, t = frames[tool]
            top = [[*(x + 0.0 for x in r[3 * i : 3 * i + 3]), t[i] + 0.0] for i in range(3)]
            rows[tool] = [*top, [0.0, 0.0, 0.0, 1.0]]
        poses.append((values, rows))
    return filled(
        "test_description.py",
        PACKAGE=package,
        NAME=name,
        PREFIXES='[""]' if robot.arms else '["", "left_"]',
        ROOT=robot.root,
        POSES=pprint.pformat(poses, width=110, sort_dicts=False),
    )
