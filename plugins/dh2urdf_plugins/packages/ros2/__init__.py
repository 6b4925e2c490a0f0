"""The stage ``ros2``: packages for ROS 2. What writes and reads them is imported when it is called."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Literal, TypeAlias

from dh2urdf.errors import ConfigError
from dh2urdf.source import Messages
from dh2urdf.stages import Emitter, GivesNotices, ReadsBack, WritesFolders
from dh2urdf_plugins.formats import checks, read_foreign_xacro
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.options import option
from dh2urdf_plugins.packages.srdf import SrdfOptions

say = Messages(__file__)

Interface: TypeAlias = Literal["position", "velocity", "effort"]
HardwareName: TypeAlias = Literal["mock", "gazebo", "topic", "none"]

PLUGINS: dict[HardwareName, str] = {
    "mock": "mock_components/GenericSystem",
    "gazebo": "gz_ros2_control/GazeboSimSystem",
    "topic": "topic_based_ros2_control/TopicBasedSystem",
}
"""The hardware plugins of ros2_control by the option that chooses them."""

NO_LICENSE = "TODO: License declaration"
NO_MAINTAINER, NO_EMAIL = "user", "user@todo.todo"  # what `ros2 pkg create` writes for what a person does not give
_EMAIL = re.compile(r"[-\w%+]+(\.[-\w%+]+)*@[-a-zA-Z0-9%]+(\.[-a-zA-Z0-9%]+)*\.[a-zA-Z]{2,}", re.ASCII)  # catkin_pkg's
_ACCEPTED = {
    "maintainer": "a name in one line, such as Ada Lovelace",
    "email": "one address, such as ada@lab.org",
    "license": "an SPDX identifier, such as BSD-3-Clause",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Ros2Options(SrdfOptions):
    """How the packages are named, what they drive, and how MoveIt plans."""

    package: str = option("name of the robot in the names of its packages; by default that of the table", "")
    maintainer: str = option("name of the maintainer in package.xml", "")
    email: str = option("address of the maintainer in package.xml", "")
    license: str = option("license in package.xml, as an SPDX identifier", "")
    version: str = option("version in package.xml: three numbers", "0.1.0")
    hardware: HardwareName = option(
        "hardware of ros2_control that is the default of the description; none: no ros2_control", "mock"
    )
    command_interfaces: tuple[Interface, ...] = option(
        "what the hardware takes for each joint: position, and on request velocity and effort; the "
        "trajectory controller commands positions",
        ("position",),
    )
    moveit: bool = option(
        "also write the configuration of MoveIt, which trials, seed, min_distance and group are for", False
    )
    acceleration: float | None = option(
        "largest acceleration of all joints for MoveIt [rad/s², m/s²]; by default that of the table, or "
        "one that reaches the full velocity in 0.5 s",
        None,
    )

    @property
    def controlled(self) -> bool:
        """Whether ros2_control is in the description."""
        return self.hardware != "none"

    def __post_init__(self) -> None:
        """Refuses what no package can have."""
        SrdfOptions.__post_init__(self)
        for name, accepted in _ACCEPTED.items():
            text = getattr(self, name)
            if text and not (text.isprintable() and text.strip() and (name != "email" or _EMAIL.fullmatch(text))):
                raise ConfigError(say("package-text-wrong", field=name, found=text, accepted=accepted))
        given = self.command_interfaces
        if "position" not in given or len(set(given)) < len(given):
            code = "interface-twice" if "position" in given else "interface-position-missing"
            raise ConfigError(say(code, field="command_interfaces", found=", ".join(given)))
        if self.acceleration is not None and not (math.isfinite(self.acceleration) and self.acceleration > 0.0):
            raise ConfigError(say("acceleration-wrong", field="acceleration", found=f"{self.acceleration:.9g}"))


_PACKAGES = f"{__name__}.packages"


def folders(stem: str, options: Ros2Options) -> tuple[str, ...]:
    """The packages of a robot."""
    from dh2urdf_plugins.packages.ros2.package_files import package_stem

    name = package_stem(stem, options.package)
    return (f"{name}_description", *([f"{name}_moveit_config"] if options.moveit else ()))


EMITTER = Emitter(
    name="ros2",
    summary="ROS 2 packages: a description with ros2_control, launch files and tests, and a configuration of MoveIt",
    suffixes=(),
    options=Ros2Options,
    emit=Late(f"{_PACKAGES}:packages_of"),
    capabilities=(
        ReadsBack(read_foreign_xacro, is_costly=True),
        WritesFolders(folders),
        *checks("packages:inspect_package", "packages:packages", finds_packages=True),
        GivesNotices(Late(f"{_PACKAGES}:notices_of_packages")),
    ),
)
