"""Numbers as each reader makes them of a text, and what becomes of a file where a text is none."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics.mass import principal_moments
from dh2urdf.manipulator import Inertia
from dh2urdf.row_fields import INERTIA
from dh2urdf.source import shown
from dh2urdf_check.document.description import MOVING, SHAPES, Hit
from dh2urdf_check.document.tree import numbers_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.document.description import Description, JointNode
    from dh2urdf_check.document.tree import Element

_DECIMAL = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_WHOLE = re.compile(rf"\s*({_DECIMAL})", re.ASCII)
_STREAM = re.compile(rf"\s*({_DECIMAL})(?![0-9]*[eE][-+]?(?![0-9]))", re.ASCII)
_HEXADECIMAL = r"0x(?:[0-9a-f]+\.?[0-9a-f]*|\.[0-9a-f]+)(?:p[-+]?[0-9]+)?"
_STRTOD = re.compile(
    rf"{_DECIMAL}|[-+]?(?:nan(?:\([0-9a-z_]*\))?|inf|infinity|{_HEXADECIMAL})", re.ASCII | re.IGNORECASE
)
XACRO = re.compile(r"\$[{(]")

_URDFDOM = frozenset({"pinocchio", "ros", "gazebo"})
"""The readers that have urdfdom."""
_ALL = frozenset({"pybullet", "mujoco", "drake"}) | _URDFDOM
_READ_BY_COPPELIASIM = frozenset({"mass", "inertia", "limit", "cylinder", "sphere"})
"""The elements of which CoppeliaSim reads single numbers."""
ROUNDED = 1e-9
"""By what share of the largest a principal moment may be off."""
SMALLEST_MOMENT = 1e-14
"""Principal moment that MuJoCo takes for 0 [kg·m²]."""


def urdfdom_numbers(text: str, count: int) -> tuple[float, ...] | None:
    """Numbers as urdfdom takes them: decimal, finite, with blanks between them; None where it refuses them."""
    words = [text] if count == 1 else [word for word in text.split(" ") if word]
    matches = [_WHOLE.fullmatch(word) for word in words]
    numbers = tuple(float(match[1]) for match in matches if match)
    return numbers if len(numbers) == len(words) == count and all(map(math.isfinite, numbers)) else None


def drake_numbers(text: str) -> tuple[float, ...]:
    """The numbers that a text begins with: what follows them is ignored."""
    numbers: list[float] = []
    at = 0
    while (match := _STREAM.match(text, at)) and math.isfinite(number := float(match[1])):
        numbers.append(number)
        at = match.end()
    return tuple(numbers)


def drake_number(text: str | None) -> float | None:
    """The number that a text begins with; None where Drake refuses the text."""
    numbers = drake_numbers(text or "")
    return numbers[0] if len(numbers) == 1 else None


def drake_scale(text: str) -> tuple[float, ...]:
    """The factors of a mesh: three where there is a blank in the text, else one; none where it refuses the text."""
    numbers = drake_numbers(text)
    return numbers if len(numbers) == (3 if re.search(r"\s", text) else 1) else ()


def mujoco_numbers(text: str, count: int) -> tuple[float, ...] | None:
    """Numbers as MuJoCo takes them: also hexadecimal, infinite and NaN; None where it refuses them."""
    words = text.split()
    if len(words) != count or not all(_STRTOD.fullmatch(word) for word in words):
        return None
    numbers = tuple(map(_of_strtod, words))
    overflows = any(math.isinf(n) and "i" not in word.lower() for n, word in zip(numbers, words, strict=True))
    return None if overflows else numbers


def _of_strtod(word: str) -> float:
    """The value of a word that `_STRTOD` matches."""
    try:
        return float.fromhex(word) if "x" in word.lower() else float(word.partition("(")[0])
    except OverflowError:
        return math.inf


class _Place(NamedTuple):
    """Numbers that readers read.

    Attributes:
        element: where they stand.
        attribute: the attribute.
        size: how many numbers it needs.
        inside: the element that urdfdom leaves out where it cannot read them: of a joint, that is the robot.
        readers: who reads them.
        required: whether MuJoCo refuses an empty text.
        no_body: whether MuJoCo reads the numbers, and refuses the body that they make.
    """

    element: Element
    attribute: str
    size: int
    inside: str
    readers: frozenset[str] = _ALL
    required: bool = False
    no_body: bool = False


def hits(description: Description) -> Iterator[Hit]:
    """Findings about every number."""
    for place in _places(description):
        text = place.element.get(place.attribute)
        if text is None:
            continue
        if None in {numbers_of(text, place.size), urdfdom_numbers(text, place.size)}:
            yield from _said(place, text)
        if (
            place.size == 1
            and text != text.strip()
            and numbers_of(text, 1)
            and place.element.tag in _READ_BY_COPPELIASIM
        ):
            message = f"{place.attribute} of {place.element.tag} is {shown(text)}, with blanks around the number"
            yield Hit("misread-number", place.element, message, {"coppeliasim"})


def _said(place: _Place, text: str) -> Iterator[Hit]:
    element, count = place.element, place.size
    refused = set()
    is_unread = mujoco_numbers(text, count) is None and (place.required or text.strip())
    if "mujoco" in place.readers and (is_unread or place.no_body):
        refused.add("mujoco")
    is_scale = place.attribute == "scale"
    if "drake" in place.readers and not (drake_scale(text) if is_scale else len(drake_numbers(text)) == count):
        refused.add("drake")
    is_urdfdom = urdfdom_numbers(text, count) is None
    if is_urdfdom and place.inside == "joint":
        refused |= _URDFDOM
    if "pybullet" in place.readers and element.tag == "axis" and len([w for w in text.split(" ") if w]) < count:
        refused.add("pybullet")
    what = "one finite number" if count == 1 else f"{count} finite numbers"
    message = f"{place.attribute} of {element.tag} is {shown(text)}, not {what}"
    kind = "number" if count == 1 else "vector"
    if numbers_of(text, count) is not None:
        message = f"{place.attribute} of {element.tag} is {shown(text)}: urdfdom takes blanks between numbers alone"
        refused &= _URDFDOM
    is_read = kind == "vector" and numbers_of(text, count) is None and place.readers != {"mujoco"}
    altering = {"coppeliasim"} if is_read else set()
    if kind == "number" and numbers_of(text, count) is None and "pybullet" in place.readers:
        yield Hit("invalid-number", element, message, (refused & place.readers) | {"coppeliasim"})
    elif refused := refused & place.readers:
        yield Hit(f"invalid-{kind}", element, message, refused | altering)
    if misread := (place.readers - refused) - (set() if is_urdfdom else _URDFDOM):
        misread &= _URDFDOM if numbers_of(text, count) is not None else _ALL
        if misread:
            yield Hit(f"misread-{kind}", element, message, misread if refused else misread | altering)


def _places(description: Description) -> Iterator[_Place]:
    compiler = description.root.first("mujoco", "compiler")
    draws = compiler is not None and compiler.get("discardvisual") == "false"
    yield from _of_materials(description)
    moved = {joint.child for joint in description.joints if joint.kind in MOVING}
    for link in description.root.all("link"):
        if inertial := link.first("inertial"):
            yield from _of_inertial(inertial, moves=link.get("name") in moved)
        for shape in (*link.all("visual"), *link.all("collision")):
            for place in _of_shape(shape):
                hidden = shape.tag == "visual" and not draws and place.inside != "material"
                yield place._replace(readers=place.readers - {"mujoco"}) if hidden else place
    for joint in description.joints:
        yield from _of_joint(joint)


def _of_inertial(inertial: Element, *, moves: bool) -> Iterator[_Place]:
    """Seen: MuJoCo wants the mass of a body that moves to be above 0, and its angles and its inertia to be finite."""
    for place in _of_origin(inertial, "inertial"):
        numbers = mujoco_numbers(place.element.get("rpy") or "", 3) or ()
        yield place._replace(no_body=moves and place.attribute == "rpy" and not all(map(math.isfinite, numbers)))
    if mass := inertial.first("mass"):
        value = mujoco_numbers(mass.get("value") or "", 1)
        no_body = moves and value is not None and not value[0] > 0.0
        yield _Place(mass, "value", 1, "inertial", required=True, no_body=no_body)
    if inertia := inertial.first("inertia"):
        read = [mujoco_numbers(inertia.get(name) or "", 1) for name in INERTIA]
        tensor = tuple(numbers[0] for numbers in read if numbers)
        is_wrong = len(tensor) == len(INERTIA) and is_no_inertia(tensor, moves=moves)
        for name in INERTIA:
            yield _Place(inertia, name, 1, "inertial", required=True, no_body=is_wrong)


def is_no_inertia(tensor: tuple[float, ...], *, moves: bool) -> bool:
    """Whether MuJoCo refuses a tensor, of which it reads all six elements."""
    if not all(map(math.isfinite, tensor)):
        return moves
    low, middle, high = principal_moments(Inertia(**dict(zip(INERTIA, tensor, strict=True))))
    return any(tensor) and (low < SMALLEST_MOMENT or low + middle < high * (1.0 - ROUNDED))


def _of_shape(shape: Element) -> Iterator[_Place]:
    yield from _of_origin(shape, "shape")
    if geometry := shape.first("geometry"):
        yield from _of_geometry(geometry)
    if shape.tag == "visual" and (material := shape.first("material")):
        yield from _of_material(material)


def _of_origin(parent: Element, inside: str) -> Iterator[_Place]:
    if origin := parent.first("origin"):
        for name in ("xyz", "rpy"):
            yield _Place(origin, name, 3, inside)


def _of_material(material: Element) -> Iterator[_Place]:
    if colour := material.first("color"):
        yield _Place(colour, "rgba", 4, "material", required=True)


def _of_materials(description: Description) -> Iterator[_Place]:
    """Those of the robot, and, for MuJoCo, the first of each name wherever it is; visuals yield their own."""
    own = description.root.all("material")
    visuals = [visual for link in description.root.all("link") for visual in link.all("visual")]
    elsewhere = {id(material) for visual in visuals if (material := visual.first("material"))}
    seen = set[str | None]({None})
    for material in (element for element in description.root.walk() if element.tag == "material"):
        readers = _ALL - {"mujoco"} if material in own else frozenset()
        if (name := material.get("name")) not in seen:
            readers |= {"mujoco"}
        if material.first("color"):
            seen.add(name)
        if readers and id(material) not in elsewhere:
            for place in _of_material(material):
                yield place._replace(readers=readers)


def _of_geometry(geometry: Element) -> Iterator[_Place]:
    for index, body in enumerate(geometry.children):
        readers = frozenset({"mujoco", "drake"}) if index else _ALL
        for name in SHAPES.get(body.tag, ()):
            if body.tag != "mesh":
                yield _Place(body, name, 3 if name == "size" else 1, "shape", readers, required=True)
        if body.tag == "mesh":
            yield _Place(body, "scale", 3, "shape", readers, required=True)


def _of_joint(joint: JointNode) -> Iterator[_Place]:
    for place in _in_joint(joint.element):
        yield place._replace(readers=place.readers - {"drake"}) if joint.is_left_out_by_drake else place


def _in_joint(joint: Element) -> Iterator[_Place]:
    kind = joint.get("type")
    at_rest = {"mujoco"} if kind == "fixed" else set()
    yield from _of_origin(joint, "joint")
    if axis := joint.first("axis"):
        readers = _ALL if kind not in {"fixed", "floating"} else frozenset({"mujoco"})
        yield _Place(axis, "xyz", 3, "joint", readers, required=True)
    if limit := joint.first("limit"):
        moving = kind not in {"fixed", "floating"}
        readers = _ALL if moving else _URDFDOM
        for name in ("lower", "upper", "effort", "velocity"):
            yield _Place(limit, name, 1, "joint", readers - {"mujoco"} if name == "velocity" else readers)
    if dynamics := joint.first("dynamics"):
        for name in ("damping", "friction"):
            yield _Place(dynamics, name, 1, "joint", _ALL - at_rest)
    if mimic := joint.first("mimic"):
        for name in ("multiplier", "offset"):
            yield _Place(mimic, name, 1, "joint", _ALL - at_rest)
    if safety := joint.first("safety_controller"):
        for name in ("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"):
            yield _Place(safety, name, 1, "joint", _URDFDOM)
