"""Profiles: where one URDF cannot serve every reader, what a URDF for one of them has otherwise, and why.

The portable URDF is read alike by all. Each field of `Profile` is a decision in which readers contradict each other;
`profiles.toml` has the reasons, `PROFILES` says who decides otherwise, and ``docs/profiles.md`` has both as a table.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from lxml import etree

from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import WORLD, JointType
from dh2urdf.robot import WEIGHTLESS, Arm, Collision, Joint, Link, Origin, Robot
from dh2urdf.source import Messages, Problem
from dh2urdf_plugins.base_bodies import links_at_rest, notices_for_gazebo, notices_of_riders, with_base_bodies

if TYPE_CHECKING:
    from collections.abc import Set as AbstractSet

    from dh2urdf_plugins.formats.urdf import ProfileName
    from dh2urdf_plugins.formats.urdf.writer import Notation

say = Messages(__file__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """The decisions of one profile, which `profiles.toml` explains; the defaults are those of the portable file."""

    mujoco_element: bool = True
    frame_masses: bool = False
    base_collision: bool = True
    held: bool = False
    base_body: bool = False
    frame_inertials: bool = True
    solid_links: bool = False
    exact_axes: bool = True
    exact_limits: bool = True
    shared_materials: bool = True
    transmissions: bool = False
    joint_friction: bool = True


PROFILES: dict[ProfileName, Profile] = {
    "portable": Profile(),
    "ros": Profile(mujoco_element=False),
    "pybullet": Profile(frame_masses=True),
    "mujoco": Profile(base_collision=False),
    "gazebo": Profile(held=True, base_body=True),
    "coppeliasim": Profile(
        frame_inertials=False, solid_links=True, exact_axes=False, exact_limits=False, shared_materials=False
    ),
    "drake": Profile(transmissions=True, joint_friction=False),
}
FOR_GAZEBO_TOO: tuple[ProfileName, ...] = ("portable", "ros")
"""Profiles whose files are loaded into Gazebo, too."""


def adapted(robot: Robot, profile: Profile) -> Robot:
    """The robot that a profile's file describes."""
    if profile == PROFILES["portable"]:
        return robot
    if profile == PROFILES["coppeliasim"]:
        from dh2urdf_plugins.coppeliasim_import import check_aliases

        check_aliases(robot)
    if not robot.arms:
        robot = _adapted_arm(robot, profile)
    else:
        # Arms of one kind stay arms of one kind: xacro has one macro for each.
        kinds = {id(arm.kind): _adapted_arm(arm.kind, profile) for arm in robot.arms}
        bases = {arm.prefix + link for arm in robot.arms for link in links_at_rest(arm.kind)}
        arms = tuple(replace(arm, kind=kinds[id(arm.kind)]) for arm in robot.arms)
        robot = replace(_adapted(robot, profile, bases), arms=arms)
    return _held(robot) if profile.held and robot.root != WORLD else robot


def notices_of(robot: Robot, options: Any) -> list[Problem]:  # noqa: ANN401 - those of a URDF or a xacro
    """What a person should know of the file of a profile."""
    name: ProfileName = options.profile
    found: list[Problem] = []
    if robot.attachments and PROFILES[name].mujoco_element:
        from dh2urdf_plugins.formats.urdf.writer import Notation, append_mujoco

        found += append_mujoco(etree.Element("robot"), robot, Notation())
    if name == "coppeliasim":
        from dh2urdf_plugins.coppeliasim_import import notices_for_coppeliasim

        found += notices_for_coppeliasim(robot)
    elif PROFILES[name].base_body:
        found += [*notices_for_gazebo(robot, filled=True), *notices_of_riders(robot)]
    elif name in FOR_GAZEBO_TOO:
        found += notices_for_gazebo(robot, filled=False)
    return found


def append_transmissions(parent: etree._Element, robot: Robot, notation: Notation) -> None:
    """Appends a motor for every joint that has an effort (http://wiki.ros.org/urdf/XML/Transmission)."""
    for joint in robot.actuated_joints:
        if not joint.limits.effort:
            continue
        name = notation.name(joint.name)
        transmission = etree.SubElement(parent, "transmission", {"name": f"{name}_transmission"})
        etree.SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
        for tag, each in (("joint", name), ("actuator", f"{name}_actuator")):
            element = etree.SubElement(transmission, tag, {"name": each})
            etree.SubElement(element, "hardwareInterface").text = "hardware_interface/EffortJointInterface"
            if tag == "actuator":
                etree.SubElement(element, "mechanicalReduction").text = "1"


def _adapted_arm(robot: Robot, profile: Profile) -> Robot:
    return _adapted(robot, profile, links_at_rest(robot))


def _adapted(robot: Robot, profile: Profile, bases: AbstractSet[str]) -> Robot:
    if profile.base_body:
        robot = with_base_bodies(robot)
    links = tuple([_adapted_link(link, profile, is_base=link.name in bases) for link in robot.links])
    if profile.frame_masses:
        bare = [link.inertial is None and link.name != WORLD for link in links]
        links = tuple(
            [replace(link, inertial=WEIGHTLESS) if is_bare else link for link, is_bare in zip(links, bare, strict=True)]
        )
    return replace(robot, links=links, joints=tuple(_adapted_joint(joint, profile) for joint in robot.joints))


def _adapted_joint(joint: Joint, profile: Profile) -> Joint:
    if not profile.joint_friction and joint.friction is not None:
        joint = replace(joint, friction=None)
    if joint.type is not JointType.FIXED and not (profile.exact_axes and profile.exact_limits):
        from dh2urdf_plugins.coppeliasim_import import importable_axis, importable_limits

        axis = joint.axis if profile.exact_axes else importable_axis(joint.axis)
        limits = joint.limits if profile.exact_limits else importable_limits(joint.limits)
        joint = replace(joint, axis=axis, limits=limits)
    return joint


def _adapted_link(link: Link, profile: Profile, *, is_base: bool) -> Link:
    if not profile.frame_inertials and link.inertial and not link.inertial.mass:
        link = replace(link, inertial=None)
    if not profile.base_collision and is_base:
        link = replace(link, collisions=())
    if profile.solid_links and link.inertial and not link.collisions and not is_base:
        shapes = tuple(Collision(geometry=visual.geometry, origin=visual.origin) for visual in link.visuals)
        link = replace(link, collisions=shapes)
    return link


def _held(robot: Robot) -> Robot:
    """The cell of one arm, which stands where the world does."""
    names = {link.name for link in robot.links} | {joint.name for joint in robot.joints}
    if WORLD in names:
        raise EmitterError(say("gazebo-world-taken", robot=robot.name))
    root, *others = robot.links
    mounted = replace(root, inertial=root.inertial or WEIGHTLESS)
    base_joint = Joint(name=robot.mounting, type=JointType.FIXED, parent=WORLD, child=root.name)
    return replace(
        robot,
        links=(Link(name=WORLD), mounted, *others),
        joints=(base_joint, *robot.joints),
        arms=(Arm(name=robot.name, kind=robot, prefix="", parent=WORLD, placement=Origin()),),
    )
