"""The stage ``ros2``: packages for ROS 2. What writes and reads them is imported when it is called."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.stages import EmittedFile, Emitter, GivesNotices, ReadsBack, WritesFolders
from dh2urdf_plugins.emitters import checks
from dh2urdf_plugins.emitters.ros2.options import Ros2Options
from dh2urdf_plugins.read_back import read_foreign_xacro

if TYPE_CHECKING:
    from dh2urdf.robot import Robot
    from dh2urdf.source import Problem


def emit(robot: Robot, stem: str, options: Ros2Options) -> tuple[EmittedFile, ...]:
    """The packages of a robot; the xacro to open comes first.

    Raises:
        EmitterError: ROS cannot use a name, an option is wrong, or the robot lacks what URDF or MoveIt requires.
        MissingDependencyError: what finds collision pairs for MoveIt is not installed.
    """
    from dh2urdf_plugins.emitters.ros2.packages import packages_of

    return packages_of(robot, stem, options)


def folders(stem: str, options: Ros2Options) -> tuple[str, ...]:
    """The packages of a robot."""
    from dh2urdf_plugins.emitters.ros2.moveit_package import moveit_name
    from dh2urdf_plugins.emitters.ros2.package_files import package_stem

    name = package_stem(stem, options.package)
    return (f"{name}_description", *([moveit_name(name)] if options.moveit else ()))


def notices(robot: Robot, options: Ros2Options) -> list[Problem]:
    """What a person should know of the package, such as what package.xml still needs."""
    from dh2urdf_plugins.emitters.ros2.packages import notices_of_packages

    return notices_of_packages(robot, options)


EMITTER = Emitter(
    name="ros2",
    summary="ROS 2 packages: a description with ros2_control, launch files and tests, and a configuration of MoveIt",
    suffixes=(),
    options=Ros2Options,
    emit=emit,
    capabilities=(
        ReadsBack(read_foreign_xacro, is_costly=True),
        WritesFolders(folders),
        *checks("packages.inspection:inspect_package", "packages.inspection:packages", finds_packages=True),
        GivesNotices(notices),
    ),
)
