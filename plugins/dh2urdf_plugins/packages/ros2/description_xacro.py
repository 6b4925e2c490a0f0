"""The xacros of a description package: the macro of each kind of arm, its ros2_control, and the file to open.

Lengths and angles of the table, limits, masses and initial positions are in YAML files; the macros read them, so that
a calibration replaces a file. All properties are inside the macros: at the scope of a file, those of two arms would
overwrite each other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, get_args

from lxml import etree

from dh2urdf_plugins.formats.urdf.writer import INERTIA, append_comment, append_robot, serialise
from dh2urdf_plugins.formats.xacro import writer as xacro
from dh2urdf_plugins.packages.ros2 import PLUGINS, HardwareName
from dh2urdf_plugins.packages.ros2.yaml_files import (
    LIMIT_KEYS,
    ControlledJoints,
    controlled_joints,
    follows_whole_table,
    parameter_key,
)
from dh2urdf_plugins.packages.srdf.semantics import arms_of
from dh2urdf_plugins.packages.templates import filled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.robot import Inertial, Joint, Robot
    from dh2urdf_plugins.packages.ros2 import Ros2Options

_GAZEBO = ("gz_ros2_control-system", "gz_ros2_control::GazeboSimROS2ControlPlugin")


class Kind(NamedTuple):
    """A kind of arm in a package."""

    macro: str  # the name of its macro
    robot: Robot  # the robot that it is alone, with its attachments
    folder: str  # the folder of its YAML files in the package

    @property
    def bare(self) -> Robot:
        """The robot that its table means."""
        return xacro.without_attachments(self.robot)

    @property
    def files(self) -> dict[str, str]:
        """The parameters of the macro that are files, with the names of their defaults."""
        table = {"dh_file": "dh.yaml"} if follows_whole_table(self.robot) else {}
        return {**table, "limits_file": "joint_limits.yaml", "physical_file": "physical_parameters.yaml"}

    def default(self, package: str, file: str) -> str:
        """The place of a file in the installed package, as xacro finds it."""
        return f"$(find {package})/{self.folder}/{file}"


class _PackageNotation(xacro.XacroNotation):
    """Formulas over the rows of the table, and numbers that are in YAML files."""

    def __init__(self, robot: Robot) -> None:
        super().__init__(robot.parameters if follows_whole_table(robot) else ())

    def number_of_joint(self, joint: Joint, name: str, value: float) -> str:  # noqa: ARG002 - it is in a file
        if name in LIMIT_KEYS:
            return f"${{limits['{joint.name}']['{LIMIT_KEYS[name]}']}}"
        return f"${{physical['joints']['{joint.name}']['{name}']}}"

    def body(self, link: str, inertial: Inertial) -> dict[str, str]:
        if not inertial.mass:
            return super().body(link, inertial)
        of_link = f"physical['links']['{link}']"
        com = " ".join(f"${{{of_link}['com'][{place}]}}" for place in range(3))
        inertia = {name: f"${{{of_link}['inertia']['{name}']}}" for name in INERTIA}
        return {"com": com, "mass": f"${{{of_link}['mass']}}", **inertia}


def parts_file(package: str) -> str:
    """Where a package has the macros of what is attached."""
    return f"urdf/{package.removesuffix('_description')}_parts.xacro"


def macro_file(kind: Kind, package: str, parts: xacro.PartMacros) -> bytes:
    """The macro of a kind of arm, and a second one for a call without an origin block."""
    robot, name = kind.bare, kind.macro
    notation = _PackageNotation(robot)
    library = etree.Element("robot", nsmap={"xacro": xacro.NAMESPACE})
    if kind.robot.attachments:
        xacro.append_element(library, "include", filename=f"$(find {package})/{parts_file(package)}")
    files = {each: kind.default(package, file) for each, file in kind.files.items()}
    macro = xacro.append_macro(library, name, " ".join(f"{each}:='{default}'" for each, default in files.items()))
    if follows_whole_table(robot):
        append_comment(macro, "The rows of the table, which origins and shapes follow.")
        xacro.append_element(macro, "property", name="dh", value="${xacro.load_yaml(dh_file)['dh']['joints']}")
        for parameter in robot.parameters:
            value = f"${{dh['{parameter.joint}']['{parameter_key(parameter)}']}}"
            xacro.append_element(macro, "property", name=xacro.property_name(parameter), value=value)
    xacro.append_element(macro, "property", name="limits", value="${xacro.load_yaml(limits_file)['joint_limits']}")
    xacro.append_element(macro, "property", name="physical", value="${xacro.load_yaml(physical_file)}")
    xacro.append_mounting(macro, notation.name(robot.mounting), notation.name(robot.root))
    append_robot(macro, robot, notation)
    for attachment in kind.robot.attachments:
        parts.append_call(macro, kind.robot, attachment, notation.name)
    xacro.append_placed_macro(library, name, files)
    return serialise(library, robot.comment)


def control_file(kind: Kind, package: str, options: Ros2Options) -> bytes:
    """The macro of the ros2_control element of a kind of arm, or of an attachment.

    A joint that follows another one has states and no commands: since ROS 2 Jazzy the hardware moves it as its
    ``<mimic>`` says (ros2_control, migration from Iron to Jazzy).
    """
    states = "\n".join(
        f'<state_interface name="{each}"/>'
        for each in ("velocity", *(("effort",) if "effort" in options.command_interfaces else ()))
    )
    commands = "\n".join(f'<command_interface name="{each}"/>' for each in options.command_interfaces)
    template, followers, joints = "ros2/templates/ros2_control{}.xacro".format, kind.bare.followers, []
    for joint in kind.bare.moving_joints:
        if joint.name in followers:
            joints.append(filled(template("_follower"), JOINT=joint.name, STATES=states))
        else:
            joints.append(filled(template("_joint"), JOINT=joint.name, COMMANDS=commands, STATES=states))
    plugin, file = PLUGINS[options.hardware], kind.default(package, "initial_positions.yaml")
    words = {"MACRO": kind.macro, "PLUGIN": plugin, "FILE": file, "JOINTS": "".join(joints).removesuffix("\n")}
    return filled(template(""), **words).encode()


def systems_of(
    robot: Robot, kinds: Sequence[Kind], parts: xacro.PartMacros, options: Ros2Options
) -> list[tuple[ControlledJoints, Kind]]:
    """What has a ros2_control that the packages write, each with the kind that it is; none without hardware."""
    found: list[tuple[ControlledJoints, Kind]] = []
    arms = {arm.prefix: next(kind for kind in kinds if kind.robot is arm.kind) for arm in arms_of(robot)}
    for each in controlled_joints(robot, options.group) if options.controlled else ():
        if each.attachment is None:
            found.append((each, arms[each.prefix]))
        elif each.hardware.joints:
            macro = parts.macro_of(robot, each.attachment)
            found.append((each, Kind(macro=macro, robot=each.hardware, folder=f"config/{macro}")))
    return found


def top_file(robot: Robot, kinds: Sequence[Kind], parts: xacro.PartMacros, package: str, options: Ros2Options) -> bytes:
    """The file to open: a robot of its own arguments, or the arms of a cell where they are."""
    notation = xacro.XacroNotation()
    top = etree.Element("robot", name=notation.text(robot.name), nsmap={"xacro": xacro.NAMESPACE})
    controlled, systems = options.controlled, systems_of(robot, kinds, parts, options)
    files = {} if robot.arms else kinds[0].files
    placement = {} if robot.arms else xacro.PLACEMENT
    defaults = {name: kinds[0].default(package, file) for name, file in files.items()}
    for each, kind in systems:
        defaults[f"{each.positions}_file"] = kind.default(package, "initial_positions.yaml")
    xacro.append_arguments(top, {**placement, **defaults, **({"hardware": options.hardware} if controlled else {})})
    if controlled:
        # Appends the plugin that the argument `hardware` stands for; xacro refuses any other word than the option's.
        plugins = ", ".join(f"{word}='{PLUGINS.get(word, '')}'" for word in get_args(HardwareName))
        xacro.append_element(top, "property", name="hardware_plugins", value=f"${{dict({plugins})}}")
        refusal = f"xacro.fatal('hardware is', hardware, 'and must be one of {', '.join(get_args(HardwareName))}')"
        xacro.append_element(top, "property", name="hardware", value="$(arg hardware)")
        value = f"${{hardware_plugins[hardware] if hardware in hardware_plugins else {refusal}}}"
        xacro.append_element(top, "property", name="hardware_plugin", value=value)
    included = [f"urdf/{kind.macro}_macro.xacro" for kind in kinds] + [parts_file(package)] * bool(robot.attachments)
    included += dict.fromkeys(f"urdf/{kind.macro}.ros2_control.xacro" for _, kind in systems)
    for file in included:
        xacro.append_element(top, "include", filename=f"$(find {package})/{file}")
    xacro.append_calls(top, robot, {kind.macro: kind.robot for kind in kinds}, parts, files)
    for each, kind in systems:  # It is there unless the hardware is `none`.
        own = notation.text(each.prefix)
        prefix = xacro.as_text(own) if robot.arms else f"'$(arg prefix){own}'"
        words = {"prefix": prefix, "plugin": "${hardware_plugin}"}
        chosen = xacro.append_element(top, "if", value="${hardware_plugin != ''}")
        file = f"$(arg {each.positions}_file)"
        xacro.append_element(chosen, f"{kind.macro}_ros2_control", **words, initial_positions_file=file)
    if controlled:  # The plugin of Gazebo, which is there when its hardware is chosen.
        chosen = xacro.append_element(top, "if", value="${hardware == 'gazebo'}")
        file, name = _GAZEBO
        plugin = etree.SubElement(etree.SubElement(chosen, "gazebo"), "plugin", {"filename": file, "name": name})
        etree.SubElement(plugin, "parameters").text = f"$(find {package})/config/ros2_controllers.yaml"
    return serialise(top, robot.comment)
