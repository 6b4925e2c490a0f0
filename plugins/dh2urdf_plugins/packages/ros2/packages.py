"""The packages of a robot or a cell: its description, and the configuration of MoveIt that goes with it.

The files for MoveIt are those that its setup assistant writes and that ``moveit_configs_utils`` looks for
(moveit/moveit2).
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, TypeVar

from lxml import etree

from dh2urdf.cells.floating import without_world
from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import WORLD, JointType
from dh2urdf.meshes import copy_name, read_mesh, with_addresses, with_its_files, with_shapes
from dh2urdf.robot import Joint, Link, Origin
from dh2urdf.rotations import IDENTITY
from dh2urdf.source import Messages, Problem, listed, markdown_text
from dh2urdf.stages import EmittedFile
from dh2urdf_plugins.formats.urdf import UrdfOptions
from dh2urdf_plugins.formats.urdf.profiles import PROFILES, adapted, notices_of
from dh2urdf_plugins.formats.urdf.writer import check_lines, serialise
from dh2urdf_plugins.formats.xacro.writer import NAMESPACE, PartMacros, XacroNotation, append_element, with_laden_kinds
from dh2urdf_plugins.packages.ros2 import description_xacro as xacros, package_files as files, yaml_files as yamls
from dh2urdf_plugins.packages.srdf import srdf
from dh2urdf_plugins.packages.srdf.semantics import Semantics, arms_of
from dh2urdf_plugins.ros_conventions import VERSION

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.manipulator import MeshFile
    from dh2urdf.robot import Collision, Robot, Visual
    from dh2urdf_plugins.packages.ros2 import Ros2Options

    S = TypeVar("S", Visual, Collision)

say = Messages(__file__)


BASE = "base"


def packages_of(robot: Robot, stem: str, options: Ros2Options) -> tuple[EmittedFile, ...]:
    """The packages of a robot; the xacro to open comes first."""
    if not VERSION.fullmatch(options.version):
        raise EmitterError(say("package-version-wrong", field="version", found=options.version))
    name = files.robot_name(stem, options.package)
    files.check_names(robot, prefixes=options.controlled or options.moveit)
    package = f"{name}_description"
    copies: dict[str, bytes] = {}
    robot = adapted(_with_base(with_laden_kinds(without_world(robot))), PROFILES["ros"])
    robot = _with_meshes(robot, package, copies)
    contents = dict(_description(robot, _kinds(robot, name), name, package, options))
    contents.update(sorted(copies.items()))
    folders = {PurePosixPath(path).parts[0] for path in contents if "/" in path} - {"test"}
    contents["CMakeLists.txt"] = files.cmake_lists(package, folders, "test_description")
    written = {f"{package}/{path}": content for path, content in contents.items()}
    if options.moveit:
        moveit = f"{name}_moveit_config"
        written.update((f"{moveit}/{path}", content) for path, content in _moveit(robot, name, moveit, options))
    for path in (path for path in written if path.endswith(".xacro")):
        check_lines(written[path])
    return tuple(EmittedFile(name=path, content=content) for path, content in written.items())


def _kinds(robot: Robot, name: str) -> list[xacros.Kind]:
    """The kinds of arms of a robot: its own, or those of a cell, each with a folder of its own for its numbers."""
    if not robot.arms:
        return [xacros.Kind(macro=name, robot=robot, folder="config")]
    kinds: list[xacros.Kind] = []
    taken = {name}
    for arm in robot.arms:
        if all(kind.robot is not arm.kind for kind in kinds):
            macro = first = files.proposed_name(arm.kind.name)
            number = 1
            while taken.intersection(macros := {macro, f"{macro}_at", f"{macro}_ros2_control"}):
                number += 1
                macro = f"{first}_{number}"
            taken |= macros
            kinds.append(xacros.Kind(macro=macro, robot=arm.kind, folder=f"config/{macro}"))
    return kinds


def _description(
    robot: Robot, kinds: Sequence[xacros.Kind], name: str, package: str, options: Ros2Options
) -> Iterator[tuple[str, bytes]]:
    """The files of the description package by their places in it, the one to open first."""
    controlled = options.controlled
    parts = PartMacros(robot, PROFILES["ros"], "1.0", [kind.macro for kind in kinds])
    yield f"urdf/{name}.urdf.xacro", xacros.top_file(robot, kinds, parts, package, options)
    for kind in kinds:
        yield f"urdf/{kind.macro}_macro.xacro", xacros.macro_file(kind, package, parts)
        if yamls.follows_whole_table(kind.robot):
            yield f"{kind.folder}/dh.yaml", yamls.dh_file(kind.robot)
        yield f"{kind.folder}/joint_limits.yaml", yamls.joint_limits(kind.bare)
        yield f"{kind.folder}/physical_parameters.yaml", yamls.physical_parameters(kind.bare)
    if robot.attachments:
        yield xacros.parts_file(package), serialise(parts.library(), robot.comment)
    for kind in {kind.macro: kind for _, kind in xacros.systems_of(robot, kinds, parts, options)}.values():
        yield f"urdf/{kind.macro}.ros2_control.xacro", xacros.control_file(kind, package, options)
        yield f"{kind.folder}/initial_positions.yaml", yamls.initial_positions(kind.bare)
    if controlled:
        yield "config/ros2_controllers.yaml", yamls.controllers(yamls.controlled_joints(robot, options.group))
    yield "launch/view_robot.launch.py", files.launch_file(package, name, robot)
    yield "rviz/view_robot.rviz", files.view("view_robot.rviz", robot)
    yield "test/test_description.py", files.test_file(package, name, robot)
    needed = yamls.depends("viewing", *(["controlling"] if controlled else []))
    summary = f"The description of {robot.name}"
    yield "package.xml", files.package_xml(package, summary, options, needed, files.TESTING)
    yield "README.md", files.readme(package, name, robot, kinds, options)
    yield from files.changelog_and_license(package, options).items()


# --- MoveIt -----------------------------------------------------------------------------------------------------------


def _moveit(robot: Robot, name: str, package: str, options: Ros2Options) -> Iterator[tuple[str, bytes]]:
    """The files of the MoveIt package by their places in it."""
    if not robot.actuated_joints:
        raise EmitterError(say("moveit-without-joints", field="moveit"))
    description, controlled = f"{name}_description", options.controlled
    joints = yamls.controlled_joints(robot, options.group)
    yield f"config/{name}.srdf", srdf(robot, options, options.group)
    yield f"config/{name}.urdf.xacro", _shown_description(robot, name, package, options)
    yield "config/kinematics.yaml", yamls.kinematics(Semantics(robot, options.group).chains)
    yield "config/joint_limits.yaml", yamls.planning_limits(robot.actuated_joints, options.acceleration)
    yield "config/moveit_controllers.yaml", yamls.moveit_controllers(joints)
    if controlled:
        yield "config/ros2_controllers.yaml", yamls.controllers(joints)
        for each in (each for each in joints if each.hardware.joints):
            yield f"config/{each.positions}.yaml", yamls.initial_positions(each.hardware)
    yield "config/pilz_cartesian_limits.yaml", files.filled("pilz_cartesian_limits.yaml")
    yield "config/moveit.rviz", files.view("moveit.rviz", robot)
    # The launch files are named by the functions of `moveit_configs_utils.launches` that they call.
    launches = ["move_group", "moveit_rviz", "rsp", "setup_assistant"]
    launches += ["static_virtual_joint_tfs"] if robot.root not in {WORLD, *robot.floating} else []
    for what in [*launches, *(("demo", "spawn_controllers") if controlled else ())]:
        launch = files.filled("moveit.launch.py", PACKAGE=package, NAME=name, WHAT=what)
        yield f"launch/{what}.launch.py", launch
    yield "test/test_moveit_config.py", files.filled("test_moveit_config.py", NAME=name)
    yield ".setup_assistant", yamls.setup_assistant(name, description, options)
    needed = sorted([description, *yamls.depends("planning", *(["controlling"] if controlled else []))])
    tested = ("ament_cmake_pytest", "python3-yaml", "xacro")
    summary = f"The configuration of MoveIt for {robot.name}"
    yield "package.xml", files.package_xml(package, summary, options, needed, tested)
    folders = ("config", "launch")
    yield "CMakeLists.txt", files.cmake_lists(package, folders, "test_moveit_config", (".setup_assistant",))
    start = files.filled("moveit_demo.md", PACKAGE=package).decode() if controlled else ""
    words = {"PACKAGE": package, "DESCRIPTION": description, "ROBOT": markdown_text(robot.name), "START": start}
    yield "README.md", files.filled("moveit_README.md", **words)
    yield from files.changelog_and_license(package, options).items()


def _shown_description(robot: Robot, name: str, package: str, options: Ros2Options) -> bytes:
    """The description that MoveIt shows: that of the other package, with hardware that a demonstration can run."""
    top = etree.Element("robot", name=XacroNotation().text(robot.name), nsmap={"xacro": NAMESPACE})
    if options.controlled:
        append_element(top, "arg", name="hardware", default="mock")
        for each in (each for each in yamls.controlled_joints(robot, options.group) if each.hardware.joints):
            place = f"$(find {package})/config/{each.positions}.yaml"
            append_element(top, "arg", name=f"{each.positions}_file", default=place)
    append_element(top, "include", filename=f"$(find {name}_description)/urdf/{name}.urdf.xacro")
    return serialise(top)


# --- The frame of the controller, and meshes --------------------------------------------------------------------------


def _with_base(robot: Robot) -> Robot:
    """A robot with the frame `base` of REP 199, where the base of its table is somewhere else than base_link.

    Of a cell, each arm has it. A robot that has the name already keeps what it has.
    """
    kinds = {id(arm.kind): _with_base(arm.kind) for arm in robot.arms}
    links, joints = list(robot.links), list(robot.joints)
    for arm in arms_of(robot):
        table, root = arm.kind.manipulator, arm.kind.root
        joint, child, parent = (arm.prefix + name for name in (f"{root}-{BASE}", BASE, root))
        taken = {each.name for each in links} | {each.name for each in joints}
        if table is not None and table.base != IDENTITY and taken.isdisjoint((joint, child)):
            origin = Origin.of(table.base)
            joints.append(Joint(name=joint, type=JointType.FIXED, parent=parent, child=child, origin=origin))
            links.append(Link(name=child))
    arms = tuple(replace(arm, kind=kinds[id(arm.kind)]) for arm in robot.arms)
    return replace(robot, links=tuple(links), joints=tuple(joints), arms=arms)


def _with_meshes(robot: Robot, package: str, copies: dict[str, bytes]) -> Robot:
    """A robot whose meshes are files of the package, those of an attachment in a folder that is called as it is.

    Takes the contents of these files.
    """
    every = [each for whole in (robot, *(arm.kind for arm in robot.arms)) for each in whole.attachments]
    folders = {each.prefix + link: files.plain_name(each.robot.name) for each in every for link in each.names}

    def copied(folder: str, link: str, shape: S) -> list[S]:
        folder = f"meshes/{folders.get(link, folder)}"

        def address_of(file: MeshFile) -> str:
            copies.update((f"{folder}/{copy_name(each)}", read_mesh(each)) for each in with_its_files(file))
            return f"package://{package}/{folder}/{copy_name(file)}"

        return [with_addresses(shape, address_of)]

    return with_shapes(robot, partial(copied, "visual"), partial(copied, "collision"))


# --- Notices ----------------------------------------------------------------------------------------------------------


def notices_of_packages(robot: Robot, options: Ros2Options) -> list[Problem]:
    """What a person should know of the packages, such as what package.xml still needs."""
    found = notices_of(robot, UrdfOptions(profile="ros"))
    if missing := [name for name in ("maintainer", "email", "license") if not getattr(options, name)]:
        options_missing = ", ".join(f"`{name}`" for name in missing)
        found.append(say("package-xml-incomplete", missing=missing, options=options_missing))
    for arm in arms_of(robot):
        table = arm.kind.manipulator
        if table is not None and table.base != IDENTITY and BASE in {row.link for row in table.rows}:
            found.append(say("frame-name-taken", name=f"{arm.prefix}{BASE}"))
    controlled = yamls.controlled_joints(robot, options.group) if options.controlled else ()
    keeping = [each.attachment for each in controlled if len(each.hardware.joints) < len(each.robot.moving_joints)]
    found += [say("part-drives-itself", name=each.name) for each in keeping if each]
    if not options.moveit:
        return found
    without = [joint.name for joint in robot.actuated_joints if joint.limits.acceleration is None]
    if options.acceleration is None and without:
        found.append(say("no-accelerations", joints=listed(without), seconds=yamls.SPEED_UP))
    for name in (joint.name for joint in robot.actuated_joints if yamls.is_no_text_to_launch(joint.name)):
        found.append(say("joint-name-no-text", name=name, other=f"joint_{name}"))
    for group in Semantics(robot, options.group).chains:
        if (count := len(group.joints)) < yamls.SPACE:
            joints = f"{count} joint{'' if count == 1 else 's'}"
            found.append(say("group-too-small", group=group.name, joints=joints))
    return found
