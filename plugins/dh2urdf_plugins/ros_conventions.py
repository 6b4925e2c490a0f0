"""What ROS wants of the names and versions of packages, and MoveIt of its controllers."""

from __future__ import annotations

import re

PACKAGE_NAME = re.compile(r"[a-z][a-z0-9]*(?:_[a-z0-9]+)*")
"""The names of packages by REP 144; tools accept others."""
VERSION = re.compile(r"[0-9]+\.[0-9]+\.[0-9]+")
"""Versions in a package.xml by REP 149."""
CONTROLLER_MANAGER = "moveit_simple_controller_manager"
"""The plugin of MoveIt, and the key of its options, that sends trajectories to controllers of ros2_control."""
