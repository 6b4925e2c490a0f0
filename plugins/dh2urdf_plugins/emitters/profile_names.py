"""The names of the profiles: what the options of the stages need of `dh2urdf_plugins.emitters.profiles`."""

from __future__ import annotations

from typing import Literal, TypeAlias

ProfileName: TypeAlias = Literal["portable", "ros", "pybullet", "mujoco", "gazebo", "coppeliasim", "drake"]
PROFILE_HELP = "readers that the file is for; portable: all of them"
