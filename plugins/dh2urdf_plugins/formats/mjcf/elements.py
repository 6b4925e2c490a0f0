"""What every reader of MJCF asks of its elements: default classes, frames, numbers and places.

From MuJoCo's documentation (https://mujoco.readthedocs.io/en/stable/XMLreference.html and, for orientations, frames and
defaults, modeling.html): angles are in degrees unless the file says radians, Euler angles follow ``eulerseq`` (capital
letters: about fixed axes), attributes may come from default classes, and a ``frame`` moves what is in it.

The files that an MJCF includes, put where it includes them.
"""

from __future__ import annotations

import math
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.documents import is_file, read_bytes
from dh2urdf.errors import InputError, ProofError
from dh2urdf.kinematics import axis_rotation
from dh2urdf.rotations import (
    IDENTITY_ROTATION,
    ZERO,
    RigidTransform,
    Rotation,
    Vec3,
    add,
    cross,
    dot,
    multiply,
    norm,
    scale,
    subtract,
)
from dh2urdf.source import Messages
from dh2urdf_plugins.formats.xml_files import FILE, LARGEST, FileElements, mark_of, tree_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

say = Messages(__file__)


_AXES: dict[str, Vec3] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
SMALLEST = 1e-7
"""Length from which on MuJoCo takes a vector for a direction."""
_DEEPEST = 100
"""Frames around each other that are read: each element multiplies all of them."""
_ORIENTATIONS = {"quat": 4, "axisangle": 4, "xyaxes": 6, "zaxis": 3, "euler": 3}
"""The attributes of an orientation and how many numbers each has; the first that is there counts."""


class Elements(FileElements):
    """The elements of a model."""

    def __init__(self, root: etree._Element, file: str) -> None:
        """Reads the compiler and the default classes."""
        super().__init__(file)
        self.root = root
        self.compiler = compiler_of(root)
        # An angle as it is written, times this, is in rad.
        self.angle = 1.0 if self.compiler.get("angle") == "radian" else math.pi / 180.0
        self._gives_classes = any(root.find(f".//{path}") is not None for path in ("*[@childclass]", "frame[@class]"))
        self._defaults: dict[str, dict[str, dict[str, str]]] = {"main": {}}  # attributes by class and by tag
        for element in root.iter("default"):  # Outer classes first.
            parent = element.getparent()
            outer = parent.get("class", "main") if parent is not None and parent.tag == "default" else "main"
            given = dict(self._defaults.get(outer, {}))
            for each in element.iterchildren(etree.Element):
                if each.tag != "default":
                    given[each.tag] = _over(given.get(each.tag, {}), _attributes(each))
            self._defaults[element.get("class") or "main"] = given

    def attributes(self, element: etree._Element, *kin: str) -> dict[str, str]:
        """The attributes of an element, those of its class included; all actuators are kin, and share defaults."""
        name = element.get("class")
        above = element.getparent() if self._gives_classes else None
        while name is None and above is not None:
            # MuJoCo takes the class of a frame for the class of what is in it, too.
            name = above.get("childclass") or (above.get("class") if above.tag == "frame" else None)
            above = above.getparent()
        if (name := name or "main") not in self._defaults:
            raise self.error(element, "default-class-unknown", name=name)
        defaults = self._defaults[name]
        given = defaults.get(str(element.tag), {})
        for tag in kin:
            given = _over(given, defaults.get(tag, {}))
        return _over(given, _attributes(element))

    def is_active(self, constraint: etree._Element) -> bool:
        """Whether a constraint holds at first."""
        return self.attributes(constraint, "equality").get("active") != "false"

    # Frames

    def held(self, body: etree._Element, *tags: str) -> Iterator[etree._Element]:
        """The elements of a body with some names, in the order of the file; those in its frames, too."""
        waiting = [*body.iterchildren(*tags, "frame")][::-1]
        while waiting:
            element = waiting.pop()
            if element.tag == "frame":
                waiting += [*element.iterchildren(*tags, "frame")][::-1]
            else:
                yield element

    def pose(self, element: etree._Element) -> RigidTransform:
        """The frame of a body, site, shape or centre of mass in the body that holds it."""
        return self.around(element, self.own_pose(element, self.attributes(element)))

    def around(self, element: etree._Element, pose: RigidTransform) -> RigidTransform:
        """A pose in the frames around an element, in the body that holds it."""
        frames = [*takewhile(lambda above: above.tag == "frame", element.iterancestors())]
        if len(frames) > _DEEPEST:
            raise self.error(element, "frames-too-deep", most=_DEEPEST)
        for frame in frames:
            pose = self.own_pose(frame, _attributes(frame)) @ pose
        return pose

    def own_pose(self, element: etree._Element, attributes: dict[str, str]) -> RigidTransform:
        """The frame of an element in what is around it."""
        if "fromto" in attributes:
            return self.between_ends(element, attributes)[0]
        return RigidTransform(self._rotation(element, attributes), self.vector(element, attributes, "pos", ZERO))

    def between_ends(self, element: etree._Element, attributes: dict[str, str]) -> tuple[RigidTransform, float]:
        """The frame of a shape or site that is given by its ends, and half of its length [m]."""
        numbers = self.numbers(element, attributes, "fromto", (0.0,) * 6)
        start, end = (numbers[0], numbers[1], numbers[2]), (numbers[3], numbers[4], numbers[5])
        along = subtract(start, end)
        if not (length := norm(along)):
            raise self.error(element, "fromto-of-one-point", tag=element.tag)
        return RigidTransform(z_rotation(scale(1.0 / length, along)), scale(0.5, add(start, end))), 0.5 * length

    def _rotation(self, element: etree._Element, attributes: dict[str, str]) -> Rotation:
        name = next((name for name in _ORIENTATIONS if name in attributes), None)
        if name is None:
            return IDENTITY_ROTATION
        numbers = self.numbers(element, attributes, name, (0.0,) * _ORIENTATIONS[name])
        x, y, z, *rest = numbers
        match name:
            case "quat":
                return self.quaternion(element, (y, z, rest[0], x))
            case "axisangle":
                return axis_rotation(self._unit(element, name, (x, y, z)), rest[0] * self.angle)
            case "xyaxes":
                along = (rest[0], rest[1], rest[2])
                x_axis = self._unit(element, name, (x, y, z))
                y_axis = self._unit(element, name, subtract(along, scale(dot(x_axis, along), x_axis)))
                (a, b, c), (d, e, f), (g, h, i) = x_axis, y_axis, cross(x_axis, y_axis)
                return (a, d, g, b, e, h, c, f, i)
            case "zaxis":
                return z_rotation(self._unit(element, name, (x, y, z)))
        rotation, sequence = IDENTITY_ROTATION, self.compiler.get("eulerseq") or "xyz"
        if len(sequence) != len(_AXES) or not set(sequence.lower()) <= _AXES.keys():
            raise self.error(element, "eulerseq-wrong", sequence=sequence)
        for word, angle in zip(sequence, numbers, strict=True):
            turn = axis_rotation(_AXES[word.lower()], angle * self.angle)
            # About axes that turn along, or about those that stand still.
            rotation = multiply(rotation, turn) if word.islower() else multiply(turn, rotation)
        return rotation

    def _unit(self, element: etree._Element, name: str, vector: Vec3) -> Vec3:
        if (length := norm(vector)) < SMALLEST:
            raise self.error(element, "vector-of-length-0", name=name, tag=element.tag)
        return vector if length == 1.0 else scale(1.0 / length, vector)

    # Numbers

    def vector(self, element: etree._Element, attributes: dict[str, str], name: str, default: Vec3) -> Vec3:
        """Three numbers."""
        x, y, z = self.numbers(element, attributes, name, default)
        return (x, y, z)

    def numbers(
        self, element: etree._Element, attributes: dict[str, str], name: str, default: Sequence[float], most: int = 0
    ) -> Sequence[float]:
        """As many numbers as the default has, which they are where there is no such attribute; `most` as in `read`."""
        text = attributes.get(name)
        return default if text is None else self.read(element, name, text, len(default), most)

    def limits(
        self, element: etree._Element, attributes: dict[str, str], name: str, limited: str
    ) -> Sequence[float] | None:
        """The ends of a range that counts: by the attribute `limited`, else where the lower end is below the upper."""
        if name not in attributes:
            return None
        lower, upper = self.numbers(element, attributes, name, (0.0, 0.0))
        word = attributes.get(limited, "auto")
        is_clear = word == "auto" and lower < upper and self.compiler.get("autolimits") != "false"
        return (lower, upper) if word == "true" or is_clear else None


def z_rotation(axis: Vec3) -> Rotation:
    """The smallest rotation that takes the z-axis to a unit vector; about x to one that points down."""
    x, y, z = axis
    if (sine := math.hypot(x, y)) < SMALLEST:
        return IDENTITY_ROTATION if z > 0.0 else (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0)
    return axis_rotation((-y / sine, x / sine, 0.0), math.atan2(sine, z))


def compiler_of(root: etree._Element) -> dict[str, str]:
    """The attributes of the compiler of a model; a model of several files may have several, each over those before."""
    found: dict[str, str] = {}
    for element in root.iterchildren("compiler"):
        found |= _attributes(element)
    return found


def _attributes(element: etree._Element) -> dict[str, str]:
    return dict(element.items())  # type: ignore[arg-type]  # they are texts, as lxml parsed them


def _over(given: dict[str, str], own: dict[str, str]) -> dict[str, str]:
    """The attributes of a class with an element's own over them: an orientation takes the place of any other."""
    if not given:
        return own
    if _ORIENTATIONS.keys() & given and _ORIENTATIONS.keys() & own:
        given = {name: value for name, value in given.items() if name not in _ORIENTATIONS}
    return {**given, **own}


_MOST = 1000


class Missing(NamedTuple):
    """A file that could not be included: the element that names it, and what is wrong."""

    include: etree._Element
    message: str


def include_files(root: etree._Element, path: Path) -> list[Missing]:
    """Puts the elements of included files in the place of what includes them, as MuJoCo does.

    A path leads from the folder of the main file, else from that of the file that includes it. It stays in the main
    file's folder or in one beside it, and each file is included once. What cannot be included is taken out, and
    returned.
    """
    missing: list[Missing] = []
    taken = {path.resolve()}
    waiting = [*_includes_in(root)][::-1]
    while waiting:
        include = waiting.pop()
        own = mark_of(include, str(path)).file
        try:
            file = _file(include, path, Path(own).parent, taken)
            included = tree_of(read_bytes(file, InputError, limit=LARGEST), str(file), is_deep=True)
            waiting += [*_includes_in(included)][::-1]
            for child in list(included):
                child.set(FILE, str(file))
                include.addprevious(child)
        except (InputError, ProofError) as error:
            missing.append(Missing(include, error.problems[0].message))
        include.set(FILE, own)  # It is taken out, and messages may name its place.
        if (parent := include.getparent()) is not None:
            parent.remove(include)
    return missing


def _includes_in(root: etree._Element) -> Iterator[etree._Element]:
    """The elements that include files, in their order; one in another goes with that."""
    return (each for each in root.iter("include") if next(each.iterancestors("include"), None) is None)


def _file(include: etree._Element, path: Path, beside: Path, taken: set[Path]) -> Path:
    """The file that an element includes; it counts as taken from now on."""
    name = (include.get("file") or "").replace("\\", "/")
    file = next((each for folder in (path.parent, beside) if is_file(each := folder / name)), None)
    if file is None:
        raise InputError(say("include-missing", name=name))
    code = None
    if not file.resolve().is_relative_to(path.resolve().parent.parent):
        code = "include-outside"
    elif file.resolve() in taken:
        code = "include-twice"
    elif len(taken) > _MOST:
        code = "includes-too-many"
    if code:
        raise InputError(say(code, name=name, most=_MOST))
    taken.add(file.resolve())
    return file
