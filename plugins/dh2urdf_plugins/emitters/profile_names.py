"""The names of the profiles: what the options of the stages need of `dh2urdf_plugins.emitters.profiles`."""

from __future__ import annotations

from typing import Literal, TypeAlias

from dh2urdf_plugins.late import Late

ProfileName: TypeAlias = Literal["portable", "ros", "pybullet", "mujoco", "gazebo", "coppeliasim", "drake"]
PROFILE_HELP = "readers that the file is for; portable: all of them"

notices = Late("dh2urdf_plugins.emitters.profiles:notices_with")
"""What a person should know of a URDF or a xacro, such as that Gazebo drops it."""
