"""The stage ``ros2``: packages for ROS 2. What writes and reads them is imported when it is called."""

from __future__ import annotations

from dh2urdf.stages import Emitter, GivesNotices, ReadsBack, WritesFolders
from dh2urdf_plugins.formats import checks, read_foreign_xacro
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.packages.ros2.options import Ros2Options

_PACKAGES = f"{__name__}.packages"


def folders(stem: str, options: Ros2Options) -> tuple[str, ...]:
    """The packages of a robot."""
    from dh2urdf_plugins.packages.ros2.moveit_package import moveit_name
    from dh2urdf_plugins.packages.ros2.package_files import package_stem

    name = package_stem(stem, options.package)
    return (f"{name}_description", *([moveit_name(name)] if options.moveit else ()))


EMITTER = Emitter(
    name="ros2",
    summary="ROS 2 packages: a description with ros2_control, launch files and tests, and a configuration of MoveIt",
    suffixes=(),
    options=Ros2Options,
    emit=Late(f"{_PACKAGES}:packages_of"),
    capabilities=(
        ReadsBack(read_foreign_xacro, is_costly=True),
        WritesFolders(folders),
        *checks("packages.inspection:inspect_package", "packages.inspection:packages", finds_packages=True),
        GivesNotices(Late(f"{_PACKAGES}:notices_of_packages")),
    ),
)
