"""The YAML files of a MoveIt package: kinematics, limits, controllers, and what the setup assistant reads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf_plugins.emitters.ros2.options import NO_EMAIL, NO_MAINTAINER
from dh2urdf_plugins.emitters.ros2.yaml_files import controller_name, yaml_file
from dh2urdf_plugins.ros_conventions import CONTROLLER_MANAGER

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.robot import Joint
    from dh2urdf_plugins.emitters.ros2.options import Ros2Options
    from dh2urdf_plugins.emitters.ros2.yaml_files import ArmJoints
    from dh2urdf_plugins.emitters.srdf.semantics import Group

SPACE = 6
"""The freedoms of a pose: a group with fewer joints reaches positions only."""
SPEED_UP = 0.5
"""How long a joint takes to its full velocity where no acceleration is given [s]."""
_ACCELERATION = 1.0
"""The acceleration of a joint without a velocity [rad/s² or m/s²]."""
_SCALING = 0.1
_RESOLUTION, _TIMEOUT = 0.005, 0.05
_CARTESIAN = {"max_trans_vel": 1.0, "max_trans_acc": 2.25, "max_trans_dec": -5.0, "max_rot_vel": 1.57}
"""The limits of the tool that MoveIt's setup assistant writes [m/s, m/s², m/s², rad/s]."""


def reaches_positions_only(group: Group) -> bool:
    """Whether a group has too few joints for every pose."""
    return len(group.joints) < SPACE


def kinematics(groups: Sequence[Group]) -> bytes:
    """``kinematics.yaml``: a solver for each group that is a chain."""
    solvers: dict[str, dict[str, Any]] = {}
    for group in groups:
        solvers[group.name] = {
            "kinematics_solver": "kdl_kinematics_plugin/KDLKinematicsPlugin",
            "kinematics_solver_search_resolution": _RESOLUTION,
            "kinematics_solver_timeout": _TIMEOUT,
        }
        if reaches_positions_only(group):
            solvers[group.name]["position_only_ik"] = True
    return yaml_file(solvers, "The solver of the inverse kinematics of each group.")


def planning_limits(joints: Sequence[Joint], acceleration: float | None) -> bytes:
    """``joint_limits.yaml`` of MoveIt: what the description does not have of velocities and accelerations."""
    content = {
        "default_velocity_scaling_factor": _SCALING,
        "default_acceleration_scaling_factor": _SCALING,
        "joint_limits": {joint.name: _planning_limits(joint, acceleration) for joint in joints},
    }
    return yaml_file(
        content,
        "Velocities in rad/s or m/s, accelerations in rad/s² or m/s². A request may set its own scaling factors, up to",
        "1.0; those below are the ones of a request without any.",
    )


def _planning_limits(joint: Joint, acceleration: float | None) -> dict[str, Any]:
    velocity = float(joint.limits.velocity or 0.0)
    default = velocity / SPEED_UP if velocity else _ACCELERATION
    return {
        "has_velocity_limits": velocity > 0.0,
        "max_velocity": velocity,
        "has_acceleration_limits": True,
        "max_acceleration": default if acceleration is None else float(acceleration),
    }


def moveit_controllers(arms: Sequence[ArmJoints]) -> bytes:
    """``moveit_controllers.yaml``: the trajectory controllers of ros2_control, as MoveIt calls them."""
    manager: dict[str, Any] = {"controller_names": [controller_name(prefix) for prefix, _ in arms]}
    for prefix, joints in arms:
        manager[controller_name(prefix)] = {
            "type": "FollowJointTrajectory",
            "action_ns": "follow_joint_trajectory",
            "default": True,
            "joints": [f"{prefix}{joint.name}" for joint in joints],
        }
    content = {
        "moveit_controller_manager": f"{CONTROLLER_MANAGER}/MoveItSimpleControllerManager",
        CONTROLLER_MANAGER: manager,
    }
    return yaml_file(
        content, "The controllers that execute what MoveIt plans; they are those of ros2_controllers.yaml."
    )


def cartesian_limits() -> bytes:
    """``pilz_cartesian_limits.yaml``: how fast the Pilz planner moves the tool."""
    return yaml_file(
        {"cartesian_limits": _CARTESIAN},
        "Limits of the tool for the Pilz planner, in m/s, m/s² and rad/s. No table has them: these are what MoveIt's",
        "setup assistant writes.",
    )


def setup_assistant(name: str, description: str, options: Ros2Options) -> bytes:
    """``.setup_assistant``: where the description and the SRDF are, for MoveIt's configuration builder.

    The time is that of no run, so that the same robot gives the same bytes.
    """
    settings = {
        "author_name": options.maintainer or NO_MAINTAINER,
        "author_email": options.email or NO_EMAIL,
        "generated_timestamp": 0,
    }
    content = {
        "urdf": {"package": description, "relative_path": f"urdf/{name}.urdf.xacro"},
        "srdf": {"relative_path": f"config/{name}.srdf"},
        "package_settings": settings,
    }
    return yaml_file({"moveit_setup_assistant_config": content})
