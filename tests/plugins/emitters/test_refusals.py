from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import pytest

from dh2urdf.errors import Dh2UrdfError
from dh2urdf.manipulator import JointType, Limits
from dh2urdf.plugin_system import load
from dh2urdf.robot import Follower, Link, Material, Parameter, Robot, Sphere, Visual

Change = Callable[[Robot], Robot]


def link(of: str, robot: Robot, /, **words: Any) -> Robot:
    """A robot with another link of a name."""
    return replace(robot, links=tuple(replace(each, **words) if each.name == of else each for each in robot.links))


def joint(of: str, robot: Robot, /, **words: Any) -> Robot:
    """A robot with another joint of a name; with all of them others where it has none."""
    joints = tuple(replace(each, **words) if of in ("", each.name) else each for each in robot.joints)
    return replace(robot, joints=joints)


def two_colours(robot: Robot) -> Robot:
    paints = [Material(name="paint", rgba=(red, 0.0, 0.0, 1.0)) for red in (0.25, 0.5)]
    visuals = tuple(Visual(geometry=Sphere(radius=1.0), material=paint) for paint in paints)
    return replace(robot, links=(Link(name="l", visuals=visuals),), joints=())


def parameter(name: str, robot: Robot) -> Robot:
    return replace(robot, parameters=(Parameter(name=name, value=1.0, unit="m", joint="lift"),))


def same(robot: Robot) -> Robot:
    return robot


NO_VELOCITY, NO_WAY = Limits(lower=-1.0, upper=1.0, effort=5.0), Limits(lower=0.5, upper=0.5, velocity=1.0, effort=5.0)
CASES: dict[str, tuple[str, str, dict[str, Any], Change, str]] = {
    "a limit that is missing": ("urdf", "arm", {}, partial(joint, "", limits=NO_VELOCITY), "limit-needed"),
    "a material with two colours": ("urdf", "arm", {}, two_colours, "material-of-two-colours"),
    "SDF: a moving link without mass": (
        *("sdf", "arm", {}),
        *(partial(link, "link_3", inertial=None), "sdf-link-without-mass"),
    ),
    "SDF: nothing at rest": (
        *("sdf", "arm", {}),
        *(partial(link, "base_link_inertia", inertial=None), "sdf-without-body-at-rest"),
    ),
    **{
        f"SDF: {name}": ("sdf", "arm", {}, partial(joint, "turn", name=name), "sdf-name-wrong")
        for name in ("__arm__", "a::b")
    },
    **{
        f"{form}: {what}": (form, "arm", {}, partial(joint, "turn", follows=law), "law-not-mimic")
        for form in ("urdf", "xacro", "sdf")
        for what, law in (("a square", Follower("swing", 1.0, 0.0, (0.5,))), ("what is held", Follower("", 0.0, 0.4)))
    },
    "MJCF: equal limits": ("mjcf", "arm", {}, partial(joint, "turn", limits=NO_WAY), "mujoco-limits-of-no-way"),
    **{
        f"xacro: the parameter {name}": ("xacro", "arm", {}, partial(parameter, name), "xacro-property-wrong")
        for name in ("prefix", "pi", "lambda", "${x}")
    },
    **{f"ros2: a package {stem}": ("ros2", stem, {}, same, "package-name-wrong") for stem in ("UR5", "x", "关节")},
    "ros2: a link": ("ros2", "arm", {}, partial(link, "tool0", name="Épaule ü"), "ros-name-wrong"),
    "ros2: a version of two numbers": ("ros2", "arm", {"version": "1.0"}, same, "package-version-wrong"),
    **{
        f"ros2: an acceleration of {number}": ("ros2", "arm", {"acceleration": number}, same, "acceleration-wrong")
        for number in (0.0, float("nan"))
    },
    "ros2: nothing to plan for": (
        *("ros2", "arm", {"moveit": True}),
        *(partial(joint, "", type=JointType.FIXED), "moveit-without-joints"),
    ),
    "gazebo: a joint called world": (
        *("urdf", "arm", {"profile": "gazebo"}),
        *(partial(joint, "turn", name="world"), "gazebo-world-taken"),
    ),
    "table: none is known": ("table", "arm", {}, same, "table-unknown"),
}


@pytest.mark.parametrize("case", CASES)
def test_what_cannot_be_written_is_refused(arm: Robot, case: str) -> None:
    stage, stem, options, change, code = CASES[case]
    emitter = load().get("emitter", stage)
    with pytest.raises(Dh2UrdfError) as caught:
        emitter.emit(change(arm), stem, emitter.options(**options))
    assert caught.value.problems[0].code == code
