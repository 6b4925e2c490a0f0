"""What MuJoCo alone reads: its extension of URDF, and the attributes of MJCF that the extension shares with it.

The words and counts are those that MuJoCo 4.0.0 takes; a test asks it of each.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.source import did_you_mean, listed, shown
from dh2urdf_plugins.lint.document.description import Hit
from dh2urdf_plugins.lint.numbers import mujoco_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_plugins.lint.document.description import Description, JointNode

_SWITCH = ("false", "true")
_FLAGS = ("enable", "disable")
_OR_AUTO = (*_SWITCH, "auto")
_SWITCHES = (
    "alignfree autolimits balanceinertia discardvisual fitaabb fusestatic savecanonical savecompiled saveinertial "
    "strippath usethread"
)
READ = ("compiler", "option", "flag", "size", "joint")
"""The elements of which words and counts are known."""
_WORDS: dict[str, dict[str, tuple[str, ...]]] = {
    "compiler": {
        **dict.fromkeys(_SWITCHES.split(), _SWITCH),
        "angle": ("radian", "degree"),
        "coordinate": ("local", "global"),
        "inertiafromgeom": _OR_AUTO,
        "conflict": ("warning", "merge", "error"),
    },
    "option": {
        "integrator": ("Euler", "RK4", "implicit", "implicitfast"),
        "cone": ("pyramidal", "elliptic"),
        "jacobian": ("dense", "sparse", "auto"),
        "solver": ("PGS", "CG", "Newton"),
    },
    "joint": {"limited": _OR_AUTO, "actuatorfrclimited": _OR_AUTO, "actuatorgravcomp": _SWITCH},
}
"""The words that an attribute of an element may have."""
_NUMBERS = (
    "timestep impratio tolerance ls_tolerance noslip_tolerance ccd_tolerance sleep_tolerance density viscosity o_margin"
)
_COUNTS = {
    "compiler": {"boundmass": 1, "boundinertia": 1, "settotalmass": 1, "inertiagrouprange": 2},
    "option": dict.fromkeys(_NUMBERS.split(), 1) | dict.fromkeys(("gravity", "wind", "magnetic"), 3),
}
"""How many numbers an attribute has, or none."""
_ITERATIONS = "iterations ls_iterations noslip_iterations ccd_iterations sdf_initpoints sdf_iterations"
_COUNTED = (
    "njmax nconmax nstack nkey nuserdata nuser_body nuser_jnt nuser_geom nuser_site nuser_cam nuser_tendon "
    "nuser_actuator nuser_sensor"
)
_WHOLE = {"option": frozenset(_ITERATIONS.split()), "size": frozenset(_COUNTED.split())}
"""The attributes that are a whole number."""
_INTEGER = re.compile(r"\s*(?:[-+]?[0-9]+)?\s*", re.ASCII)
_AXES = 3


def fault_of(tag: str, name: str, text: str) -> str:
    """What MuJoCo refuses of an attribute; empty where it takes it, or where that is not known."""
    about = f"{name} of {tag} is {shown(text)}"
    if words := _FLAGS if tag == "flag" else _WORDS.get(tag, {}).get(name):
        near = did_you_mean(text, words) or f"it may be {listed(words)}"
        return "" if text in words else f"{about}: {near}"
    if count := _COUNTS.get(tag, {}).get(name):
        is_read = not text.strip() or mujoco_numbers(text, count) is not None
        return "" if is_read else f"{about}, not {'a number' if count == 1 else f'{count} numbers'}"
    if name in _WHOLE.get(tag, ()):
        return "" if _INTEGER.fullmatch(text) else f"{about}, not a whole number"
    is_short = (tag, name) == ("compiler", "eulerseq") and len(text) != _AXES
    return f"{about}, not three letters" if is_short else ""


def hits(description: Description) -> Iterator[Hit]:
    """Findings about the extension, of which MuJoCo reads no more than the compiler, options and sizes."""
    extension = description.root.first("mujoco")
    for element in extension.walk() if extension else ():
        for name, text in element.attributes.items():
            if fault := fault_of(element.tag, name, text):
                yield Hit("mujoco-extension", element, fault)
    compiler = extension.first("compiler") if extension else None
    if compiler is None:
        return
    if compiler.get("coordinate") == "global":
        yield Hit("mujoco-extension", compiler, "coordinate of compiler is 'global', which MuJoCo knows no more")
    if compiler.get("autolimits") == "false" and (joint := next(filter(_is_limited, description.joints), None)):
        message = f"autolimits of compiler is 'false', and joint {shown(joint.name)} has limits"
        yield Hit("mujoco-extension", compiler, message)


def _is_limited(joint: JointNode) -> bool:
    """Whether MuJoCo reads limits of a joint: of its range, or of its effort."""
    limit = joint.element.first("limit")
    if limit is None or joint.kind in {"fixed", "floating"}:
        return False
    lower, upper, effort = (_number(limit.get(name)) for name in ("lower", "upper", "effort"))
    return bool(effort) or (joint.kind != "continuous" and lower is not None and upper is not None and lower < upper)


def _number(text: str | None) -> float | None:
    numbers = mujoco_numbers(text or "", 1)
    return numbers[0] if numbers else None
