from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import Dh2UrdfError
from dh2urdf.manipulator import JointType, Limits
from dh2urdf.plugin_system import load
from dh2urdf.robot import Link, Material, Parameter, Robot, Sphere, Visual

if TYPE_CHECKING:
    from collections.abc import Callable

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
REP_144 = {"UR5": "ur5", "7dof": "arm_7dof", "my__arm": "my_arm", "x": "arm_x", "é": "arm_e", "关节": "my_arm"}
CASES: dict[str, tuple[str, str, dict[str, Any], Change, str]] = {
    "a limit that is missing": (
        "urdf",
        "arm",
        {},
        partial(joint, "", limits=NO_VELOCITY),
        r"joint 'lift', field 'limits\.velocity': a prismatic joint needs velocity",
    ),
    "a material with two colours": ("urdf", "arm", {}, two_colours, "material 'paint' has two colours"),
    "SDF: a moving link without mass": (
        "sdf",
        "arm",
        {},
        partial(link, "link_3", inertial=None),
        "needs a mass of the moving link 'link_3'",
    ),
    "SDF: nothing at rest": ("sdf", "arm", {}, partial(link, "base_link_inertia", inertial=None), "a body at rest"),
    **{
        f"SDF: {name}": ("sdf", "arm", {}, partial(joint, "turn", name=name), f"SDF cannot hold the name '{name}'")
        for name in ("world", "__arm__", "a::b")
    },
    "MJCF: equal limits": (
        "mjcf",
        "arm",
        {},
        partial(joint, "turn", limits=NO_WAY),
        "joint 'turn', field 'limits'.*no way",
    ),
    **{
        f"xacro: the parameter {name}": ("xacro", "arm", {}, partial(parameter, name), "cannot be a xacro property")
        for name in ("prefix", "pi", "max", "lambda", "a b", "__a", "2a", "${x}")
    },
    **{
        f"ros2: a package {stem}": ("ros2", stem, {}, same, f"`package: {proposed}`")
        for stem, proposed in REP_144.items()
    },
    **{
        f"ros2: a link {name}": (
            "ros2",
            "arm",
            {},
            partial(link, "tool0", name=name),
            f"the link '{name}'.*rename it to '{proposed}'",
        )
        for name, proposed in (("tool 0", "tool_0"), ("Épaule ü", "Epaule_u"))
    },
    "ros2: a version of two numbers": ("ros2", "arm", {"version": "1.0"}, same, "three numbers"),
    **{
        f"ros2: an acceleration of {number}": ("ros2", "arm", {"acceleration": number}, same, "number greater than 0")
        for number in (0.0, -1.0, float("inf"), float("nan"))
    },
    "ros2: nothing to plan for": (
        "ros2",
        "arm",
        {"moveit": True},
        partial(joint, "", type=JointType.FIXED),
        "MoveIt plans for joints that move, and this robot has none",
    ),
    "table: none is known": ("table", "arm", {}, same, "the table of this robot is not known"),
}


@pytest.mark.parametrize("case", CASES)
def test_what_cannot_be_written_is_refused(arm: Robot, case: str) -> None:
    """The error names the joint, the link or the option, and what is accepted."""
    stage, stem, options, change, message = CASES[case]
    emitter = load().get("emitter", stage)
    with pytest.raises(Dh2UrdfError) as caught:
        emitter.emit(change(arm), stem, emitter.options(**options))
    assert re.search(message, str(caught.value), re.DOTALL), str(caught.value)
