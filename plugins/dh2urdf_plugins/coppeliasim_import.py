"""What CoppeliaSim's URDF importer needs another value for, in its profile and its loader.

All of it was seen in CoppeliaSim 4.10.0 rev 0; docs/simulators.md has the rest of what the importer does.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.errors import EmitterError
from dh2urdf.source import Messages, Problem, listed, shown

if TYPE_CHECKING:
    from dh2urdf.manipulator import Limits
    from dh2urdf.robot import Joint, Robot
    from dh2urdf.rotations import Vec3

say = Messages(__file__)

NUDGE = 1e-30
"""What is added to an axis along -z across it: the importer turns z to the axis about the vector across both, and
leaves z as it is where that is zero, below 1e-162. With 1e-30 nobody else's double changes, and no float underflows."""


def alias(name: str) -> str:
    """The name of an object of CoppeliaSim: each byte but ASCII letters, digits and ``_`` becomes a ``_``."""
    return re.sub(rb"[^A-Za-z0-9_]", b"_", name.encode()).decode() or "_"


def importable_axis(axis: Vec3) -> Vec3:
    """An axis that the importer turns the right way: of ``0 0 -1`` it makes ``0 0 1``."""
    x, y, z = axis
    return (NUDGE, 0.0, z) if z < 0.0 and math.hypot(x, y) < NUDGE else axis


def importable_limits(limits: Limits) -> Limits:
    """Limits with 0 in them: a joint that cannot be at 0 is put elsewhere before its link is placed."""
    lower, upper = limits.lower, limits.upper
    if lower is None or upper is None:
        return limits
    return replace(limits, lower=min(lower, 0.0), upper=max(upper, 0.0))


def widened_joints(robot: Robot) -> list[Joint]:
    """The moving joints whose limits the importer cannot be given."""
    return [joint for joint in robot.moving_joints if importable_limits(joint.limits) != joint.limits]


def check_aliases(robot: Robot) -> None:
    """Checks that no two links and no two joints get the same name.

    Raises:
        EmitterError: two do.
    """
    for what, names in (("links", [link.name for link in robot.links]), ("joints", [j.name for j in robot.joints])):
        taken: dict[str, str] = {}
        for name in names:
            if (other := taken.setdefault(alias(name), name)) != name:
                code, of = "coppeliasim-names-alike", robot.name
                raise EmitterError(say(code, robot=of, found=alias(name), what=what, other=other, name=name))


def notices_for_coppeliasim(robot: Robot) -> list[Problem]:
    """What CoppeliaSim has otherwise than the table, once the file is imported: limits and names."""
    notices = []
    for joint in widened_joints(robot):
        lower, upper = joint.limits.lower or 0.0, joint.limits.upper or 0.0
        code, width = "coppeliasim-limits-widened", upper - lower
        notices.append(say(code, joint=joint.name, field="limits", lower=lower, width=width))
    names = [*(joint.name for joint in robot.moving_joints), *(link.name for link in robot.links)]
    if other := [name for name in names if alias(name) != name]:
        pairs = listed([f"`{alias(name)}` for {shown(name)}" for name in other])
        notices.append(say("coppeliasim-other-names", pairs=pairs))
    return notices
