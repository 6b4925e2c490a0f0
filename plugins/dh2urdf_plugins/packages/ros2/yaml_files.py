"""The YAML files of a description package, which a person replaces without touching a xacro, and those of MoveIt.

ROS parameters are typed, and xacro reads YAML as numbers: each real number is written as a float, ``3.0`` and not
``3``.
"""

from __future__ import annotations

import re
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from lxml import etree

from dh2urdf.fields import replace_unchecked
from dh2urdf.robot import Follower
from dh2urdf_plugins.formats.urdf.writer import INERTIA, LIMITS_OF
from dh2urdf_plugins.formats.xacro.writer import without_attachments
from dh2urdf_plugins.home_pose import initial_position
from dh2urdf_plugins.packages.ros2 import NO_EMAIL, NO_MAINTAINER
from dh2urdf_plugins.packages.srdf.semantics import arms_of, moving_attachments
from dh2urdf_plugins.packages.templates import filled
from dh2urdf_plugins.ros_conventions import CONTROLLER_MANAGER

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.robot import Attachment, Joint, Parameter, Robot
    from dh2urdf_plugins.packages.ros2 import Ros2Options
    from dh2urdf_plugins.packages.srdf.semantics import Group


LIMIT_KEYS = {"lower": "min_position", "upper": "max_position", "velocity": "max_velocity", "effort": "max_effort"}
"""The key of each limit in joint_limits.yaml, as MoveIt and ros2_control name it."""
UPDATE_RATE = 100  # cycles of the controller manager [1/s]
SPACE = 6  # the freedoms of a pose: a group with fewer joints reaches positions only
SPEED_UP = 0.5  # how long a joint takes to its full velocity where no acceleration is given [s]
_ACCELERATION = 1.0  # the acceleration of a joint without a velocity [rad/s² or m/s²]


class ControlledJoints(NamedTuple):
    """The actuated joints of an arm or of an attachment, which one trajectory controller moves."""

    label: str  # what the names of the controller, and of the file and argument of initial positions, begin with
    prefix: str  # what the names of its links and joints begin with
    robot: Robot  # the arm or the attachment alone, without the prefix
    attachment: Attachment | None = None

    @property
    def joints(self) -> list[str]:
        """The names of the joints in the whole robot."""
        return [self.prefix + joint.name for joint in self.robot.actuated_joints]

    @property
    def controller(self) -> str:
        """The name of the controller."""
        return f"{self.label}joint_trajectory_controller"

    @property
    def positions(self) -> str:
        """What the file of initial positions is called; the argument that names another one has ``_file`` behind it."""
        return f"{self.label}initial_positions"

    @property
    def hardware(self) -> Robot:
        """The robot with those moving joints alone that are in the ros2_control that the packages write.

        Those that the attachment's own file has in one are not: no two may have one joint, and a joint that follows is
        where its leader is.
        """
        elements = map(etree.fromstring, self.attachment.elements if self.attachment else ())
        own = {each.get("name") for system in elements if system.tag == "ros2_control" for each in system.iter("joint")}
        moving, followers = self.robot.moving_joints, self.robot.followers
        pairs = [(each, followers.get(each.name, Follower(each.name)).leader) for each in moving]
        others = [each for each, leader in pairs if own.isdisjoint((each.name, leader))]
        return replace_unchecked(self.robot, joints=tuple(others))


def controlled_joints(robot: Robot, group: str) -> list[ControlledJoints]:
    """The controllers of the arms and attachments of a robot that move; `group` is what groups of arms are called."""
    arms = [ControlledJoints(arm.prefix, arm.prefix, without_attachments(arm.kind)) for arm in arms_of(robot)]
    parts = moving_attachments(robot, group).items()
    return [
        *[each for each in arms if each.joints],
        *[ControlledJoints(f"{name}_", each.prefix, each.robot, each) for name, each in parts],
    ]


def _filled(template: str, content: Mapping[str, Any], **words: str) -> bytes:
    """A YAML file of the folder ``templates`` with its content."""
    import yaml

    class Dumper(yaml.SafeDumper):
        """Quotes what ROS would not read as a text."""

    def text(dumper: Any, word: str) -> Any:  # noqa: ANN401 - types of yaml
        return dumper.represent_scalar("tag:yaml.org,2002:str", word, style="'" if is_no_text(word) else None)

    Dumper.add_representer(str, text)
    written = yaml.dump(
        _plain(content), Dumper=Dumper, sort_keys=False, default_flow_style=None, width=110, allow_unicode=True
    )
    return filled(f"ros2/templates/{template}", CONTENT=written.removesuffix("\n"), **words).encode()


@cache
def _fixed_values() -> dict[str, Any]:
    """What is the same in the files of every package."""
    import yaml

    return yaml.safe_load((Path(__file__).parent / "fixed_values.yaml").read_text("utf-8"))  # type: ignore[no-any-return]


def depends(*what: str) -> list[str]:
    """The packages that are needed for some uses, in their order."""
    return sorted({package for each in what for package in _fixed_values()[each]})


def is_no_text(word: str) -> bool:
    """Whether ROS reads a word without quotes as a truth value or a number, where YAML libraries read a text.

    Its parser of parameters takes ``y`` and ``n`` for truth values, and for a number what `strtoll` and `strtod` of C
    take: ``1e3``, ``0x1p3``, ``inf`` (`get_value` in rcl_yaml_param_parser/src/parse.c).
    """
    if re.fullmatch(r"[yYnN]|[-+]?0[xX][0-9a-fA-F.]+(?:[pP][-+]?[0-9]+)?", word):
        return True
    try:
        float(word)
    except ValueError:
        return False
    return "_" not in word


def is_no_text_to_launch(word: str) -> bool:
    """Whether the quotes of such a word are lost where launch_ros writes parameters, with PyYAML's own rules."""
    import yaml

    return is_no_text(word) and yaml.safe_dump([word]).startswith(f"- {word}")


def _plain(value: Any) -> Any:  # noqa: ANN401 - what YAML has
    """A value in which each number that is a float has its own type, and 0.0 has no sign."""
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    return float(value) + 0.0 if isinstance(value, float) else value


# --- The arm ----------------------------------------------------------------------------------------------------------


def parameter_key(parameter: Parameter) -> str:
    """The key of a parameter in the row of its joint: ``a`` for ``a_1``."""
    return re.sub(r"(.)_[0-9]+\Z", r"\1", parameter.name, flags=re.DOTALL)


def follows_whole_table(robot: Robot) -> bool:
    """Whether the origins of a robot are formulas over lengths and angles, so that another table can take their place.

    Where the angles are in the axes, as in aligned frames, a table with other angles would give a wrong arm.
    """
    return any(parameter.unit == "rad" for parameter in robot.parameters)


def dh_file(robot: Robot) -> bytes:
    """``dh.yaml``: the rows of the table, by the names of their joints, with a hash that changes with each number."""
    rows: dict[str, dict[str, float]] = {}
    for parameter in robot.parameters:
        rows.setdefault(parameter.joint, {})[parameter_key(parameter)] = parameter.value
    numbers = ";".join(f"{joint}:{key}={value!r}" for joint, row in rows.items() for key, value in row.items())
    table = {"hash": f"dh_{sha256(numbers.encode()).hexdigest()[:20]}", "joints": rows}
    return _filled("dh.yaml", {"dh": table}, NAME=robot.name)


def joint_limits(robot: Robot) -> bytes:
    """``joint_limits.yaml``: the limits of each joint, with the keys that MoveIt and ros2_control use."""
    limits = {
        joint.name: {LIMIT_KEYS[name]: getattr(joint.limits, name) for name in LIMITS_OF[joint.type]}
        for joint in robot.moving_joints
    }
    return _filled("joint_limits.yaml", {"joint_limits": limits})


def physical_parameters(robot: Robot) -> bytes:
    """``physical_parameters.yaml``: the mass properties of links, and what resists the motion of joints."""
    links = {
        link.name: {
            "mass": link.inertial.mass,
            "com": link.inertial.com,
            "inertia": {name: getattr(link.inertial.inertia, name) for name in INERTIA},
        }
        for link in robot.links
        if link.inertial and link.inertial.mass
    }
    joints = {}
    for joint in robot.moving_joints:
        given = {"damping": joint.damping, "friction": joint.friction}
        if said := {name: value for name, value in given.items() if value is not None}:
            joints[joint.name] = said
    return _filled("physical_parameters.yaml", {"links": links, "joints": joints})


# --- ros2_control -----------------------------------------------------------------------------------------------------


def initial_positions(robot: Robot) -> bytes:
    """``initial_positions.yaml``: where the joints start."""
    positions = {joint.name: initial_position(joint) for joint in robot.actuated_joints}
    return _filled("initial_positions.yaml", {"initial_positions": positions})


def controllers(every: Sequence[ControlledJoints]) -> bytes:
    """``ros2_controllers.yaml``: a trajectory controller for each of these, and the broadcaster of joint states."""
    fixed, name = _fixed_values(), "joint_state_broadcaster"
    manager: dict[str, Any] = {"update_rate": UPDATE_RATE, name: fixed[name]}
    content: dict[str, Any] = {"controller_manager": {"ros__parameters": manager}}
    for each in every:
        manager[each.controller] = fixed["trajectory_controller"]
        parameters = {"joints": each.joints, **fixed["trajectory_parameters"]}
        content[each.controller] = {"ros__parameters": parameters}
    return _filled("ros2_controllers.yaml", content)


# --- MoveIt -----------------------------------------------------------------------------------------------------------


def kinematics(groups: Sequence[Group]) -> bytes:
    """``kinematics.yaml``: a solver for each group that is a chain."""
    solver = _fixed_values()["solver"]
    solvers = {
        group.name: {**solver, **({"position_only_ik": True} if len(group.joints) < SPACE else {})} for group in groups
    }
    return _filled("kinematics.yaml", solvers)


def planning_limits(joints: Sequence[Joint], acceleration: float | None) -> bytes:
    """``joint_limits.yaml`` of MoveIt: what the description does not have of velocities and accelerations."""
    limits = {}
    for joint in joints:
        velocity = float(joint.limits.velocity or 0.0)
        default = joint.limits.acceleration or (velocity / SPEED_UP if velocity else _ACCELERATION)
        limits[joint.name] = {
            "has_velocity_limits": velocity > 0.0,
            "max_velocity": velocity,
            "has_acceleration_limits": True,
            "max_acceleration": float(default if acceleration is None else acceleration),
            **({"has_jerk_limits": True, "max_jerk": float(joint.limits.jerk)} if joint.limits.jerk else {}),
        }
    return _filled("planning_limits.yaml", {**_fixed_values()["scaling"], "joint_limits": limits})


def moveit_controllers(every: Sequence[ControlledJoints]) -> bytes:
    """``moveit_controllers.yaml``: the trajectory controllers of ros2_control, as MoveIt calls them."""
    manager: dict[str, Any] = {"controller_names": [each.controller for each in every]}
    for each in every:
        manager[each.controller] = {**_fixed_values()["moveit_controller"], "joints": each.joints}
    plugin = f"{CONTROLLER_MANAGER}/MoveItSimpleControllerManager"
    return _filled("moveit_controllers.yaml", {"moveit_controller_manager": plugin, CONTROLLER_MANAGER: manager})


def setup_assistant(name: str, description: str, options: Ros2Options) -> bytes:
    """``.setup_assistant``: where the description and the SRDF are, for MoveIt's configuration builder.

    The time is that of no run, so that the same robot gives the same bytes.
    """
    content = {
        "urdf": {"package": description, "relative_path": f"urdf/{name}.urdf.xacro"},
        "srdf": {"relative_path": f"config/{name}.srdf"},
        "package_settings": {
            "author_name": options.maintainer or NO_MAINTAINER,
            "author_email": options.email or NO_EMAIL,
            "generated_timestamp": 0,
        },
    }
    return _filled("setup_assistant", {"moveit_setup_assistant_config": content})
