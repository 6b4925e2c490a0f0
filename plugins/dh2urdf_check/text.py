"""Rules about the text: its lines, the elements in it, and the numbers in these."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.source import did_you_mean, shown
from dh2urdf_check.document.description import ALL, Hit
from dh2urdf_check.document.tree import Element
from dh2urdf_check.numbers import XACRO

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.document.description import Description

LONGEST_LINE = 8191
"""Bytes of a line that PyBullet reads at once."""

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
    "material": ("color", "texture"),
    "visual": _SHAPE,
    "collision": _SHAPE,
    "geometry": ("box", "cylinder", "sphere", "mesh", "capsule", "plane", "cdf"),
}
"""The elements in each element, with the extensions that a consumer of the table reads."""
ONCE = {
    "link": ("inertial",),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic"),
    "inertial": ("origin", "mass", "inertia"),
    "material": ("color", "texture"),
    "visual": ("origin", "material"),
    "collision": ("origin",),
}
_OF_NUMBERS = frozenset(
    {
        *("xyz", "rpy", "size", "scale", "rgba", "lower", "upper", "effort", "velocity", "damping", "friction"),
        *("multiplier", "offset", "value", "ixx", "ixy", "ixz", "iyy", "iyz", "izz", "radius", "length"),
    }
)
"""Attributes that hold numbers."""
_VERSION = re.compile(r"\s*0*1\.0+")
_CARRIAGE_RETURN = re.compile(rb"\r(?!\n)")
_READ = ("link", "joint", "material")


def hits(description: Description) -> Iterator[Hit]:
    """Findings about the text."""
    yield from _lines(description)
    if not description.content.lstrip(b"\xef\xbb\xbf").startswith(b"<?xml") and description.content[:2] not in {
        b"\xff\xfe",
        b"\xfe\xff",
    }:
        yield Hit("no-xml-declaration", description.root, "the file does not begin with <?xml")
    yield from _of_xacro(description.root)
    version = description.root.get("version")
    if version is not None and not _VERSION.fullmatch(version):
        of = ALL - {"pinocchio"} if version in {"1.1", "1.2"} else None
        yield Hit("unknown-version", description.root, f"the version of the robot is {shown(version)}", of)
    if found := _CARRIAGE_RETURN.search(description.content):
        line = description.content.count(b"\n", 0, found.start()) + 1
        yield Hit("carriage-returns", line, "the line ends with a carriage return alone")
    compiler = description.root.first("mujoco", "compiler")
    draws = compiler is not None and compiler.get("discardvisual") == "false"
    for element in _elements(description.root):
        for hit in _wrong_children(element):
            is_mimic = isinstance(hit.at, Element) and hit.at.tag == "mimic" and element.get("type") == "fixed"
            is_material = isinstance(hit.at, Element) and hit.at.tag == "material"
            in_hidden = element.tag == "visual" and not draws and not is_material
            hidden = hit.rule == "repeated-element" and (in_hidden or is_mimic)
            yield hit._replace(of=ALL - {"mujoco"}) if hidden else hit
    extensions = description.root.all("mujoco")
    if len(extensions) > 1:
        yield Hit("repeated-element", extensions[1], "the robot has a second mujoco", {"mujoco"})
    for extension in extensions:
        tags = [child.tag for child in extension.children]
        if again := next((child for i, child in enumerate(extension.children) if child.tag in tags[:i]), None):
            yield Hit("repeated-element", again, f"a mujoco has a second {again.tag}", {"mujoco"})


def _lines(description: Description) -> Iterator[Hit]:
    for number, line in enumerate(description.content.split(b"\n"), start=1):
        if len(line) > LONGEST_LINE:
            yield Hit("long-line", number, f"the line has {len(line):,} bytes")


def _of_xacro(root: Element) -> Iterator[Hit]:
    """Said once of elements, which readers pass over, and once of expressions, which are no numbers."""
    for element in root.walk():
        if element.tag.startswith("xacro:"):
            yield Hit("xacro-element", element, f"the element {shown(element.tag)} is one of xacro")
            break
    for element in root.walk():
        for name, text in element.attributes.items():
            if XACRO.search(text) and name in _OF_NUMBERS:
                yield Hit("unexpanded-xacro", element, f"{name} of {shown(element.tag)} is {shown(text)}")
                return


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
        # Prefixes are extensions; of a robot anything may be one, and of a geometry a rule of its own speaks.
        if child.tag in known or ":" in child.tag or element.tag == "geometry":
            continue
        near = did_you_mean(child.tag, known)
        if element.tag == "robot" and not near:
            continue
        message = f"a {element.tag} has no element {shown(child.tag)}"
        yield Hit("unknown-element", child, f"{message}: {near}" if near else message)
