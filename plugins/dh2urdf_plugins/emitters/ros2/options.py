"""What a person may choose of a ROS 2 package."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

HardwareName: TypeAlias = Literal["mock", "gazebo", "topic", "none"]

PLUGINS: dict[HardwareName, str] = {
    "mock": "mock_components/GenericSystem",
    "gazebo": "gz_ros2_control/GazeboSimSystem",
    "topic": "topic_based_ros2_control/TopicBasedSystem",
}
"""The hardware plugins of ros2_control by the option that chooses them."""

NO_LICENSE = "TODO: License declaration"
NO_MAINTAINER, NO_EMAIL = "user", "user@todo.todo"
"""What `ros2 pkg create` writes for what a person does not give."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ros2Options:
    """How a description package is named, and what it drives."""

    package: str = field(
        default="",
        metadata={"help": "name of the robot in the names of its packages; by default that of the table"},
    )
    maintainer: str = field(default="", metadata={"help": "name of the maintainer in package.xml"})
    email: str = field(default="", metadata={"help": "address of the maintainer in package.xml"})
    license: str = field(default="", metadata={"help": "license in package.xml, as an SPDX identifier"})
    version: str = field(default="0.1.0", metadata={"help": "version in package.xml: three numbers"})
    hardware: HardwareName = field(
        default="mock",
        metadata={"help": "hardware of ros2_control that is the default of the description; none: no ros2_control"},
    )
