"""The rules that the formulas of a robot must keep."""

from __future__ import annotations

import math
import re
from functools import lru_cache
from typing import TYPE_CHECKING

from dh2urdf.robot import Box, Cylinder
from dh2urdf.source import Messages, Problem

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Robot

say = Messages(__file__)


FUNCTIONS = frozenset({"abs", "max", "min", "sin", "cos", "atan2"})
"""The functions that formulas may use."""
_IDENTIFIER = r"(?<![\w.])[^\W\d]\w*"


def formula_problems(robot: Robot) -> Iterator[Problem]:
    """Formulas use the robot's parameters, each declared once with a finite number, and the known functions."""
    declared: set[str] = set()
    for parameter in robot.parameters:
        if parameter.name in declared or not math.isfinite(parameter.value):
            code = "parameter-twice" if parameter.name in declared else "parameter-infinite"
            yield say(code, joint=parameter.joint, field=parameter.name, value=parameter.value)
        declared.add(parameter.name)
    known = declared | FUNCTIONS
    for formula in _formulas(robot):
        for name in _names_in(formula):
            if name not in known:
                yield say("formula-name-unknown", found=name, formula=formula, functions=sorted(FUNCTIONS))


def _formulas(robot: Robot) -> Iterator[str]:
    shapes = [shape for link in robot.links for shape in link.shapes]
    for origin in [*(joint.origin for joint in robot.joints), *(shape.origin for shape in shapes)]:
        yield from origin.xyz_formula or ()
        yield from origin.rpy_formula or ()
    for shape in shapes:
        match shape.geometry:
            case Box(size_formula=(x, y, z)):
                yield from (x, y, z)
            case Cylinder(length_formula=str(length)):
                yield length


@lru_cache(maxsize=4096)
def _names_in(formula: str) -> tuple[str, ...]:
    """The names that a formula uses; the robots of a run share most of their formulas."""
    return tuple(dict.fromkeys(re.findall(_IDENTIFIER, formula)))
