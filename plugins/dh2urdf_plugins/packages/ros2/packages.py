"""The stage ``ros2``: a description package for every robot or cell."""

from __future__ import annotations

from dataclasses import replace
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import JointType
from dh2urdf.meshes import copy_name, read_mesh
from dh2urdf.robot import Collision, Joint, Link, Mesh, Origin, Visual
from dh2urdf.rotations import IDENTITY
from dh2urdf.source import Problem
from dh2urdf.stages import EmittedFile
from dh2urdf_plugins.formats.urdf.profiles import PROFILES, adapted, notices_of
from dh2urdf_plugins.formats.urdf.writer import check_lines
from dh2urdf_plugins.packages.ros2.description_xacro import (
    Kind,
    arms_of,
    control_file,
    macro_file,
    top_file,
)
from dh2urdf_plugins.packages.ros2.moveit_package import moveit_name, moveit_notices, moveit_package
from dh2urdf_plugins.packages.ros2.package_files import (
    CONTROLLING,
    TESTING,
    VIEWING,
    changelog,
    check_names,
    check_prefixes,
    cmake_lists,
    launch_file,
    license_file,
    package_xml,
    proposed_name,
    readme,
    robot_name,
    rviz_file,
    test_file,
)
from dh2urdf_plugins.packages.ros2.yaml_files import (
    arm_joints,
    controllers,
    dh_file,
    follows_whole_table,
    initial_positions,
    joint_limits,
    physical_parameters,
)
from dh2urdf_plugins.ros_conventions import VERSION

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.robot import Robot
    from dh2urdf_plugins.packages.ros2.options import Ros2Options


BASE = "base"


def packages_of(robot: Robot, stem: str, options: Ros2Options) -> tuple[EmittedFile, ...]:
    """The packages of a robot; the xacro to open comes first.

    Raises:
        EmitterError: ROS cannot use a name, an option is wrong, or the robot lacks what URDF or MoveIt requires.
        MissingDependencyError: what finds collision pairs for MoveIt is not installed.
    """
    if not VERSION.fullmatch(options.version):
        accepted = "three numbers with dots between them, such as 1.2.0 (REP 149)"
        message = "this is not the version of a ROS package"
        raise EmitterError(Problem(message=message, field="version", found=options.version, accepted=accepted))
    name = robot_name(stem, options.package)
    check_names(robot)
    if options.controlled or options.moveit:
        check_prefixes(robot)
    package = f"{name}_description"
    copies: dict[str, bytes] = {}
    robot = _with_meshes(adapted(_with_base(robot), PROFILES["ros"]), package, copies)
    kinds = _kinds(robot, name)
    contents = dict(_description(robot, kinds, name, package, options))
    contents.update(sorted(copies.items()))
    folders = {PurePosixPath(path).parts[0] for path in contents if "/" in path} - {"test"}
    contents["CMakeLists.txt"] = cmake_lists(package, folders, "test_description")
    written = {f"{package}/{path}": content for path, content in contents.items()}
    if options.moveit:
        files = moveit_package(robot, name, package, options)
        written.update({f"{moveit_name(name)}/{path}": content for path, content in files.items()})
    for path in (path for path in written if path.endswith(".xacro")):
        check_lines(written[path])
    return tuple(EmittedFile(name=path, content=content) for path, content in written.items())


def _kinds(robot: Robot, name: str) -> list[Kind]:
    """The kinds of arms of a robot: its own, or those of a cell, each with a folder of its own for its numbers."""
    if not robot.arms:
        return [Kind(macro=name, robot=robot, folder="config")]
    kinds: list[Kind] = []
    taken = {name}
    for arm in robot.arms:
        if all(kind.robot is not arm.kind for kind in kinds):
            macro = first = proposed_name(arm.kind.name)
            number = 1
            while taken.intersection(macros := {macro, f"{macro}_at", f"{macro}_ros2_control"}):
                number += 1
                macro = f"{first}_{number}"
            taken |= macros
            kinds.append(Kind(macro=macro, robot=arm.kind, folder=f"config/{macro}"))
    return kinds


def _description(
    robot: Robot, kinds: Sequence[Kind], name: str, package: str, options: Ros2Options
) -> Iterator[tuple[str, bytes]]:
    """The files of the description package by their places in it, the one to open first."""
    controlled = options.controlled
    yield f"urdf/{name}.urdf.xacro", top_file(robot, kinds, package, options)
    for kind in kinds:
        yield f"urdf/{kind.macro}_macro.xacro", macro_file(kind, package)
        if follows_whole_table(kind.robot):
            yield f"{kind.folder}/dh.yaml", dh_file(kind.robot)
        yield f"{kind.folder}/joint_limits.yaml", joint_limits(kind.robot)
        yield f"{kind.folder}/physical_parameters.yaml", physical_parameters(kind.robot)
        if controlled:
            yield f"urdf/{kind.macro}.ros2_control.xacro", control_file(kind, package, options)
            yield f"{kind.folder}/initial_positions.yaml", initial_positions(kind.robot)
    if controlled:
        yield "config/ros2_controllers.yaml", controllers(arm_joints(robot))
    yield "launch/view_robot.launch.py", launch_file(package, name, robot)
    yield "rviz/view_robot.rviz", rviz_file(robot)
    yield "test/test_description.py", test_file(package, name, robot)
    needed = sorted({*VIEWING, *(CONTROLLING if controlled else ())})
    yield "package.xml", package_xml(package, f"The description of {robot.name}", options, needed, TESTING)
    yield "README.md", readme(package, name, robot, kinds, options)
    yield "CHANGELOG.rst", changelog(package, options.version)
    if options.license:
        yield "LICENSE", license_file(options)


# --- The frame of the controller --------------------------------------------------------------------------------------


def _with_base(robot: Robot) -> Robot:
    """A robot with the frame `base` of REP 199, where the base of its table is somewhere else than base_link.

    Of a cell, each arm has it. A robot that has the name already keeps what it has.
    """
    kinds = {id(arm.kind): _with_base(arm.kind) for arm in robot.arms}
    links, joints = list(robot.links), list(robot.joints)
    for prefix, kind in arms_of(robot):
        table = kind.manipulator
        joint, child, parent = (prefix + name for name in (f"{kind.root}-{BASE}", BASE, kind.root))
        taken = {each.name for each in links} | {each.name for each in joints}
        if table is not None and table.base != IDENTITY and taken.isdisjoint((joint, child)):
            origin = Origin.of(table.base)
            joints.append(Joint(name=joint, type=JointType.FIXED, parent=parent, child=child, origin=origin))
            links.append(Link(name=child))
    arms = tuple(replace(arm, kind=kinds[id(arm.kind)]) for arm in robot.arms)
    return replace(robot, links=tuple(links), joints=tuple(joints), arms=arms)


# --- Meshes -----------------------------------------------------------------------------------------------------------


def _with_meshes(robot: Robot, package: str, copies: dict[str, bytes]) -> Robot:
    """A robot whose meshes are files of the package; takes the contents of these files."""
    kinds = {id(arm.kind): _with_meshes(arm.kind, package, copies) for arm in robot.arms}
    links = tuple(_with_mesh(link, package, copies) for link in robot.links)
    return replace(robot, links=links, arms=tuple(replace(arm, kind=kinds[id(arm.kind)]) for arm in robot.arms))


def _with_mesh(link: Link, package: str, copies: dict[str, bytes]) -> Link:
    def named(shape: Visual | Collision, folder: str) -> Mesh | None:
        mesh = shape.geometry
        if not isinstance(mesh, Mesh) or mesh.file is None:
            return None
        path = f"meshes/{folder}/{copy_name(mesh.file)}"
        copies[path] = read_mesh(mesh.file)
        return replace(mesh, filename=f"package://{package}/{path}")

    return replace(
        link,
        visuals=tuple(replace(each, geometry=named(each, "visual") or each.geometry) for each in link.visuals),
        collisions=tuple(replace(each, geometry=named(each, "collision") or each.geometry) for each in link.collisions),
    )


def notices_of_packages(robot: Robot, options: Ros2Options) -> list[Problem]:
    """What a person should know of the package, such as what package.xml still needs."""
    missing = [name for name in ("maintainer", "email", "license") if not getattr(options, name)]
    found = notices_of(robot, "ros")
    if missing:
        found.append(
            Problem(
                message=f"package.xml has no {', '.join(missing)}: it has what `ros2 pkg create` writes instead",
                severity="notice",
                suggestion="set the options " + ", ".join(f"`{name}`" for name in missing),
            )
        )
    for prefix, kind in arms_of(robot):
        table = kind.manipulator
        if table is not None and table.base != IDENTITY and BASE in {row.link for row in table.rows}:
            message = (
                f"{prefix}{BASE} is the name of a link of the table: no frame of the controller is written (REP 199)"
            )
            found.append(Problem(message=message, severity="notice", suggestion="give the link another name"))
    if options.moveit:
        found += moveit_notices(robot, options)
    return found
