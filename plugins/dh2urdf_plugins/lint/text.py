"""Rules about the text: its lines, the elements in it, and the numbers in these."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.source import did_you_mean, shown
from dh2urdf_plugins.lint.description import Hit

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_plugins.lint.description import Description
    from dh2urdf_plugins.lint.tree import Element

LONGEST_LINE = 8191
"""Bytes of a line that PyBullet reads at once [1]."""

_SHAPE = ("origin", "geometry", "material", "verbose", "group")
CHILDREN = {
    "robot": (
        "link",
        "joint",
        "material",
        "transmission",
        "gazebo",
        "mujoco",
        "sensor",
        "ros2_control",
        "group",
        "version",
    ),
    "link": ("inertial", "visual", "collision", "sensor", "contact", "self_collision_checking", "audio_source"),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration", "safety_controller"),
    "inertial": ("origin", "mass", "inertia"),
    "visual": _SHAPE,
    "collision": _SHAPE,
    "geometry": ("box", "cylinder", "sphere", "mesh", "capsule", "plane", "cdf"),
}
"""The elements in each element, with the extensions that a consumer of the table reads."""
ONCE = {
    "link": ("inertial",),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic"),
    "inertial": ("origin", "mass", "inertia"),
    "visual": ("origin", "geometry"),
    "collision": ("origin", "geometry"),
}
NUMBERS = {
    "origin": {"xyz": 3, "rpy": 3},
    "axis": {"xyz": 3},
    "limit": {"lower": 1, "upper": 1, "effort": 1, "velocity": 1},
    "dynamics": {"damping": 1, "friction": 1},
    "mimic": {"multiplier": 1, "offset": 1},
    "mass": {"value": 1},
    "inertia": {"ixx": 1, "ixy": 1, "ixz": 1, "iyy": 1, "iyz": 1, "izz": 1},
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "mesh": {"scale": 3},
    "color": {"rgba": 4},
}
_READ = ("link", "joint", "material")
_XACRO = re.compile(r"\$[{(]")


def hits(description: Description) -> Iterator[Hit]:
    """What there is to say of the text."""
    yield from _lines(description)
    if not description.content.lstrip(b"\xef\xbb\xbf").startswith(b"<?xml") and description.content[:2] not in {
        b"\xff\xfe",
        b"\xfe\xff",
    }:
        yield Hit("no-xml-declaration", description.root, "the file does not begin with <?xml")
    if is_xacro := next(_of_xacro(description.root), None):
        yield is_xacro
    for element in _elements(description.root):
        yield from _wrong_children(element)
        yield from _wrong_numbers(element)


def _lines(description: Description) -> Iterator[Hit]:
    for number, line in enumerate(description.content.split(b"\n"), start=1):
        if len(line) > LONGEST_LINE:
            yield Hit("long-line", number, f"the line has {len(line):,} bytes")


def _of_xacro(root: Element) -> Iterator[Hit]:
    for element in root.walk():
        if element.tag.startswith("xacro:"):
            yield Hit("unexpanded-xacro", element, f"the element {shown(element.tag)} is one of xacro")
        for name, text in element.attributes.items():
            if _XACRO.search(text):
                yield Hit("unexpanded-xacro", element, f"{name} of {shown(element.tag)} is {shown(text)}")


def _elements(root: Element) -> Iterator[Element]:
    """The root, and everything in what readers read of it: extensions have elements of their own."""
    yield root
    for child in root.children:
        if child.tag in _READ:
            yield from child.walk()


def _wrong_children(element: Element) -> Iterator[Hit]:
    known = CHILDREN.get(element.tag)
    if known is None:
        return
    seen: set[str] = set()
    for child in element.children:
        if child.tag in seen and child.tag in ONCE.get(element.tag, ()):
            yield Hit("repeated-element", child, f"a {element.tag} has a second {child.tag}")
        seen.add(child.tag)
        near = did_you_mean(child.tag, known)
        # Prefixes are extensions; of a robot anything may be one, and of a geometry a rule of its own speaks.
        if child.tag in known or ":" in child.tag or element.tag == "geometry" or (element.tag == "robot" and not near):
            continue
        message = f"a {element.tag} has no element {shown(child.tag)}"
        yield Hit("unknown-element", child, f"{message}: {near}" if near else message)


def _wrong_numbers(element: Element) -> Iterator[Hit]:
    for name, count in NUMBERS.get(element.tag, {}).items():
        text = element.get(name)
        if text is None or _XACRO.search(text) or element.numbers(name, count) is not None:
            continue
        what = "one finite number" if count == 1 else f"{count} finite numbers"
        rule = "invalid-number" if count == 1 else "invalid-vector"
        yield Hit(rule, element, f"{name} of {element.tag} is {shown(text)}, not {what}")
