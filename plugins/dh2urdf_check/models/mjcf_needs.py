"""Rules about what an element of an MJCF needs beside it: names, limits that rise, directions, a body that stands."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.source import listed, shown
from dh2urdf_check.models.models import Hit, elements_of
from dh2urdf_check.numbers import mujoco_numbers
from dh2urdf_plugins.formats.mjcf.shapes import WITHOUT_MASS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from dh2urdf_plugins.formats.mjcf.elements import Elements

_TARGETS = ("joint", "jointinparent", "tendon", "site", "cranksite", "body")
"""What an actuator drives."""
_ONE_OF = {
    "connect": (("site1", "site2"), ("body1", "anchor")),
    "weld": (("site1", "site2"), ("body1",)),
    "distance": (("geom1",), ("body1",)),
    "normal": (("geom1",), ("body1",)),
    "fromto": (("geom1",), ("body1",)),
    "rangefinder": (("site",), ("camera",)),
}
"""Attributes of equalities and sensors, of which there must be those of one kind."""
_LIMITS = {
    "range": "limited",
    "ctrlrange": "ctrllimited",
    "forcerange": "forcelimited",
    "actrange": "actlimited",
    "actuatorfrcrange": "actuatorfrclimited",
}
"""What makes a range one of limits."""
_LIMITED = ("joint", "spatial", "fixed")
_SHORTEST = 1e-14
"""Length that MuJoCo takes for 0."""
_NEEDED = {"mesh": "mesh", "hfield": "hfield"}
_DIRECTIONS = {"axisangle": 3, "zaxis": 3, "xyaxes": 6, "dir": 3}


def hits(root: etree._Element, elements: Elements) -> Iterator[Hit]:
    """Findings about the elements that are no defaults, with what their classes give them."""
    for element in elements_of(root):
        above = element.getparent()
        if above is None or next(element.iterancestors("default"), None) is not None:
            continue
        section = str(above.tag)
        if section == "actuator":
            if element.tag != "plugin" and not any(map(element.get, _TARGETS)):
                yield Hit("missing-attribute", element, f"{element.tag} has none of {listed(_TARGETS)}", {"mujoco"})
        elif section in {"equality", "sensor"} and (kinds := _ONE_OF.get(str(element.tag))):
            if not any(all((element.get(name) or "").strip() for name in kind) for kind in kinds):
                needed = " or ".join(listed(kind) for kind in kinds)
                of = {"mujoco", "drake"} if element.tag == "connect" else {"mujoco"}
                yield Hit("missing-attribute", element, f"{element.tag} needs {needed}", of)
        elif element.tag in {"geom", "site"}:
            yield from _geom(element, elements)
        if section == "actuator" or (element.tag in _LIMITED and section != "equality"):
            yield from _limits(element, elements)
        yield from _directions(element)


def _limits(element: etree._Element, elements: Elements) -> Iterator[Hit]:
    """Ranges that do not rise; those of joints in finite numbers have rules that more readers share."""
    given = elements.attributes(element)
    kind = given.get("type", "hinge") if element.tag == "joint" else ""
    if kind in {"ball", "free"}:
        return
    for name, by in _LIMITS.items():
        if given.get(by) != "true" or (kind and name == "range" and _has_plain_range(given)):
            continue
        text = given.get(name) or ""
        ends = mujoco_numbers(text, 2) or (() if text.strip() else (0.0, 0.0))
        if ends and ends[0] >= ends[1]:
            what = f"and its {name} is {shown(text)}" if text else f"and has no {name}"
            rule = "swapped-limits" if ends[0] > ends[1] else "equal-limits"
            yield Hit(rule, element, f'{element.tag} has {by}="true", {what}', {"mujoco"})


def _has_plain_range(given: dict[str, str]) -> bool:
    ends = mujoco_numbers(given.get("range") or "", 2)
    is_hexadecimal = "x" in given.get("range", "").lower()
    return "range" not in given or (ends is not None and all(map(math.isfinite, ends)) and not is_hexadecimal)


def _directions(element: etree._Element) -> Iterator[Hit]:
    for name, count in _DIRECTIONS.items():
        read = mujoco_numbers(element.get(name) or "", 4 if name == "axisangle" else count) or ()
        for start in range(0, count if read else 0, 3):
            if math.hypot(*read[start : start + 3]) < _SHORTEST or (start and _are_parallel(read)):
                yield Hit("direction-zero", element, f"{name} of {element.tag} is {shown(element.get(name) or '')}")
                break


def _are_parallel(axes: tuple[float, ...]) -> bool:
    x, y = axes[:3], axes[3:]
    along = sum(a * b for a, b in zip(x, y, strict=True)) / math.hypot(*x) ** 2
    return math.dist(y, [along * a for a in x]) < _SHORTEST


def _geom(element: etree._Element, elements: Elements) -> Iterator[Hit]:
    given = elements.attributes(element)
    kind = given.get("type", "sphere")
    needed = _NEEDED.get(kind)
    if needed and not given.get(needed):
        of = {"mujoco", "drake"} if (element.tag, kind) == ("geom", "mesh") and "mesh" not in given else {"mujoco"}
        yield Hit("missing-attribute", element, f"{element.tag} of type {kind} has no {needed}", of)
    ends = mujoco_numbers(given.get("fromto", ""), 6)
    if ends and kind in {"sphere", "plane"}:
        yield Hit("unknown-word", element, f"{element.tag} of type {kind} has `fromto`", {"mujoco"})
    elif ends and math.dist(ends[:3], ends[3:]) <= _SHORTEST:
        message = f"fromto of a {kind} is {shown(given['fromto'])}, and ends where it begins"
        yield Hit("size-not-positive", element, message, {"mujoco", "drake"} if element.tag == "geom" else {"mujoco"})
    if element.tag == "geom" and kind in WITHOUT_MASS and any(map(_moves, element.iterancestors("body"))):
        yield Hit("moving-plane", element, f"a {kind} is in a body that moves")
    if element.tag == "geom" and kind == "plane":
        sizes = mujoco_numbers(given.get("size") or "0 0 0", 3)
        is_short = sizes is None and any(mujoco_numbers(given["size"], count) for count in (1, 2))
        if is_short or (sizes and not sizes[2] > 0.0):
            message = f"size of a plane is {shown(given.get('size', ''))}: it needs 3, the last above 0"
            yield Hit("size-not-positive", element, message, {"mujoco"})


def _moves(body: etree._Element) -> bool:
    waiting = [body]
    for each in waiting:
        for child in each.iterchildren("joint", "freejoint", "frame"):
            if child.tag != "frame":
                return True
            waiting.append(child)
    return False
