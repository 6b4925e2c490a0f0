"""What a description is, read as plainly as can be, and whether it is what a reader has loaded.

Nothing here is shared with `dh2urdf check`: the file is read with Python's own parser, the first element of a name
counts, and numbers are those of `float`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.etree import ElementTree as ET

if TYPE_CHECKING:
    from collections.abc import Iterator

    from consumers import Behaviour

TURNING, SLIDING = "revolute", "prismatic"
KINDS = {"revolute": TURNING, "continuous": TURNING, "prismatic": SLIDING}
"""The types of joints that are compared, as readers tell them."""
RELATIVE, ABSOLUTE = 1e-5, 1e-9
"""How far numbers may be from those of the file: some readers print them with six digits."""


class Joint(NamedTuple):
    """A joint of a file; None where there is no number."""

    kind: str
    parent: str
    child: str
    numbers: dict[str, float | None]


class Plain(NamedTuple):
    """A description: the joints by their names, and the mass of each link, None where there is no number [kg]."""

    joints: dict[str, Joint]
    masses: dict[str, float | None]
    is_fused: bool

    def bodies(self) -> dict[str, list[str]]:
        """The links that are fixed to each other, by the one that holds the others."""
        above = {joint.child: joint.parent for joint in self.joints.values() if joint.kind == "fixed"}
        found: dict[str, list[str]] = {}
        for link in self.masses:
            head, steps = link, 0
            while head in above and steps < len(above):
                head, steps = above[head], steps + 1
            found.setdefault(head, []).append(link)
        return found

    def mass(self, links: list[str]) -> float | None:
        """The mass of some links together [kg]; None where one of them is none."""
        masses = [mass for link in links if (mass := self.masses.get(link)) is not None]
        return sum(masses) if len(masses) == len(links) else None


def plain(content: bytes) -> Plain | None:
    """The description in a file; None where Python's parser does not read it."""
    try:
        root = ET.fromstring(content)  # noqa: S314 - made by this folder
    except (ET.ParseError, ValueError, LookupError):
        return None
    space = root.tag.rpartition("}")[0]
    for element in root.iter():  # Readers of robots know no namespaces.
        if space and isinstance(element.tag, str):
            element.tag = element.tag.removeprefix(f"{space}}}")
    joints: dict[str, Joint] = {}
    for element in root.iterfind("joint"):
        ends = [
            found.get("link", "") if (found := element.find(end)) is not None else "" for end in ("parent", "child")
        ]
        limit = element.find("limit")
        numbers = {name: _number(limit, name) for name in ("lower", "upper", "effort", "velocity")}
        joints.setdefault(element.get("name", ""), Joint(element.get("type", ""), *ends, numbers))
    masses: dict[str, float | None] = {}
    for link in root.iterfind("link"):
        is_empty = link.find("inertial") is None
        masses.setdefault(link.get("name", ""), 0.0 if is_empty else _number(link.find("inertial/mass"), "value"))
    compiler = root.find("mujoco/compiler")
    return Plain(joints, masses, compiler is None or compiler.get("fusestatic") != "false")


def _number(element: ET.Element | None, name: str) -> float | None:
    try:
        return float(element.get(name, "")) if element is not None else None
    except ValueError:
        return None


def difference(consumer: str, file: Plain, behaviour: Behaviour) -> str:
    """The first thing that a reader has loaded otherwise than it is in the file; empty where there is none."""
    return next(_differences(consumer, file, behaviour), "")


def _differences(consumer: str, file: Plain, behaviour: Behaviour) -> Iterator[str]:
    if consumer == "ros":
        if set(behaviour.extra["links"]) != set(file.masses):
            yield "other links"
        return
    told: dict[str, dict[str, Any]] = behaviour.extra["told"]
    moving = {name: joint for name, joint in file.joints.items() if joint.kind in KINDS}
    if missing := moving.keys() - told.keys():
        yield f"a {moving[min(missing)].kind} joint is missing"
        return
    for name, joint in moving.items():
        yield from _of_joint(joint, told[name])
    for name, mass in _masses(consumer, file).items():
        if name not in behaviour.masses:
            yield "a link is missing"
        elif mass is not None and not _same(mass, behaviour.masses[name]):
            yield f"a mass is {behaviour.masses[name]:g}, not {mass:g}"


def _of_joint(joint: Joint, told: dict[str, Any]) -> Iterator[str]:
    if told["kind"] != KINDS[joint.kind]:
        yield f"a {joint.kind} joint is {told['kind']}"
    for name, number in joint.numbers.items():
        if number is None or name not in told or (joint.kind == "continuous" and name in {"lower", "upper"}):
            continue
        if told[name] is None or not _same(number, told[name]):
            yield f"{name} of a {joint.kind} joint is {told[name]}, not {number:g}"


def _masses(consumer: str, file: Plain) -> dict[str, float | None]:
    """The masses that a reader should have, by the names that it gives them: some add up what is fixed together."""
    bodies, held = file.bodies(), {joint.child: name for name, joint in file.joints.items()}
    moving = {head: file.mass(links) for head, links in bodies.items() if head in held}
    apart = {link: mass for link, mass in file.masses.items() if link in held}  # Nobody asks what the ground weighs.
    if consumer in {"pybullet", "drake"}:
        return apart
    if consumer == "mujoco":
        return moving if file.is_fused else apart
    if consumer == "pinocchio":
        return {held[head]: mass for head, mass in moving.items()}
    return {head: file.mass(links) for head, links in bodies.items() if head != "world"}


def _same(number: float, other: float) -> bool:
    return number == other or math.isclose(number, other, rel_tol=RELATIVE, abs_tol=ABSOLUTE)
