"""Rules about MJCF, as its schema and its readers have it.

The elements and attributes are those that MuJoCo 4.0.0 prints of its own schema (`mj_printSchema`), in mjcf_schema.txt.
There, an attribute with ``!`` behind it is one that the element needs.
"""

from __future__ import annotations

import math
import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.kinematics.mass import principal_moments
from dh2urdf.manipulator import Inertia
from dh2urdf.rotations import norm
from dh2urdf.source import did_you_mean, listed, shown
from dh2urdf_check.joints import UNIT
from dh2urdf_check.models.mjcf_bounds import hits as hits_of_bounds
from dh2urdf_check.models.mjcf_compiled import MEASURES, changes_masses, hits as hits_of_compiled
from dh2urdf_check.models.mjcf_names import OF_DRAKE, hits as hits_of_names
from dh2urdf_check.models.models import (
    Hit,
    Model,
    elements_of,
    fault_of_inertia,
    inspect_model,
    numbers,
)
from dh2urdf_check.numbers import drake_numbers, mujoco_numbers
from dh2urdf_check.single_readers.mujoco import fault_of, kind_of
from dh2urdf_plugins.formats.mjcf.elements import compiler_of, include_files
from dh2urdf_plugins.formats.mjcf.reader import read_model

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from dh2urdf.stages import Expansion, Inspection

JOINTS = ("hinge", "slide", "ball", "free")
GEOMS = ("plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf")
_SIZED = ("sphere", "capsule", "ellipsoid", "cylinder", "box")
_TURNS = ("quat", "axisangle", "euler", "xyaxes", "zaxis")
"""Attributes that turn a frame."""
BODIES = ("worldbody", "body", "frame", "replicate")
"""What holds bodies, with the same elements in each."""
_OF_BODIES = {
    "frame": "name childclass pos quat axisangle xyaxes zaxis euler",
    "replicate": "count offset euler sep prefix",
    "worldbody": "",
}
_COUNT = {
    "joint": {"axis": 3, "pos": 3, "range": 2, "damping": 0, "armature": 1, "frictionloss": 1},
    "inertial": {"mass": 1, "pos": 3, "quat": 4, "diaginertia": 3, "fullinertia": 6},
    "body": {"pos": 3, "quat": 4, "euler": 3, "axisangle": 4},
    "geom": {"pos": 3, "quat": 4, "euler": 3, "fromto": 6, "mass": 1, "size": 0},
    "site": {"pos": 3, "quat": 4, "euler": 3},
}
_OF_DRAKE = {
    "joint": ("axis", "pos", "range", "damping", "armature", "ref", "group"),
    "inertial": ("mass", "pos", "quat", "diaginertia", "fullinertia"),
    "body": ("pos", "quat", "euler", "axisangle"),
    "geom": ("pos", "quat", "euler", "fromto", "size", "mass", "rgba", "group", "conaffinity", "condim"),
    "material": ("rgba",),
    "mesh": ("scale",),
    "option": ("gravity",),
    "connect": ("anchor",),
    **dict.fromkeys(OF_DRAKE, ("ctrlrange", "forcerange", "kp", "ctrllimited", "forcelimited")),
}
"""The attributes that Drake reads, as far as they are known here."""
_ODD = re.compile("nan|inf", re.IGNORECASE)
SMALLEST = 1e-15
"""Mass or moment of inertia that MuJoCo takes for 0 [kg, kg·m²]."""


def inspect_mjcf(path: Path, _expansion: Expansion | None = None) -> Inspection:
    """Findings about an MJCF.

    Raises:
        InputError: the file cannot be read.
    """
    return inspect_model(path, "mjcf", "mujoco", hits, lambda file: read_model(file).robot)


def hits(model: Model) -> Iterator[Hit]:
    """Findings about a model, with the files that it includes."""
    missing = include_files(model.root, model.path)
    yield from (Hit("missing-include", each.include, each.message) for each in missing)
    yield from _schema(model.root)
    if not model.root.get("model"):
        yield Hit("model-without-name", model.root, "the model has no name")
    yield from hits_of_names(model, complete=not missing)
    yield from hits_of_compiled(model, complete=not missing)
    for element in elements_of(model.root, *_COUNT):
        yield from _values(element)
    for element in elements_of(model.root):
        yield from _words(element)
        yield from hits_of_bounds(element, is_of_no_use=_is_of_no_use)
    yield from _joints(model.root)
    for element in elements_of(model.root, "inertial"):
        yield from _inertial(element, model.root)
    yield from _geoms(model.root)


# --- The schema


class _Schema:
    def __init__(self, multiplicity: str, attributes: frozenset[str], needed: frozenset[str] = frozenset()) -> None:
        self.multiplicity, self.attributes, self.needed = multiplicity, attributes, needed
        self.children: dict[str, _Schema] = {}


@cache
def schema() -> _Schema:
    """What may be in a model."""
    top = _Schema("!", frozenset())
    path = [top]
    for line in Path(__file__).with_name("mjcf_schema.txt").read_text("utf-8").splitlines():
        depth = len(line) - len(line.lstrip(" "))
        name, multiplicity, *words = line.split()
        needed = frozenset(word.rstrip("!") for word in words if word.endswith("!"))
        node = _Schema(multiplicity, frozenset(word.rstrip("!") for word in words), needed)
        del path[depth + 1 :]
        path[depth].children[name] = node
        path.append(node)
    mujoco = top.children["mujoco"]
    body = mujoco.children.pop("(world)body")
    for name in BODIES:
        holder = _Schema("*", frozenset(_OF_BODIES[name].split()) if name in _OF_BODIES else body.attributes | {"name"})
        holder.children = body.children
        (mujoco.children if name == "worldbody" else body.children)[name] = holder
    default = mujoco.children["default"]
    default.children["default"] = default
    return top


def _schema(root: etree._Element) -> Iterator[Hit]:
    waiting = [(root, schema().children["mujoco"])]
    while waiting:
        element, known = waiting.pop()
        if missing := sorted(name for name in known.needed if not (element.get(name) or "").strip()):
            yield Hit("missing-attribute", element, f"{element.tag} has no {listed(missing)}", {"mujoco"})
        for name in map(str, element.attrib):
            if name not in known.attributes and not name.startswith("{"):
                near = did_you_mean(name, known.attributes)
                message = f"{element.tag} has no attribute {shown(name)}"
                yield Hit("unknown-attribute", element, f"{message}: {near}" if near else message)
        seen = set[str]()
        for child in element:
            if not isinstance(child.tag, str):
                continue
            inner = known.children.get(child.tag)
            if inner is None:
                near = did_you_mean(child.tag, known.children)
                message = f"{element.tag} has no element {shown(child.tag)}"
                yield Hit("unknown-element", child, f"{message}: {near}" if near else message)
                continue
            if inner.multiplicity == "?" and child.tag in seen:
                yield Hit("repeated-element", child, f"a {element.tag} has a second {child.tag}")
            seen.add(child.tag)
            waiting.append((child, inner))


# --- Values


def _about(element: etree._Element) -> str:
    name = element.get("name")
    return f"{element.tag} {shown(name)}" if name else f"a {element.tag}"


def _is_default(element: etree._Element) -> bool:
    return _holder(element) == "default"


def _values(element: etree._Element) -> Iterator[Hit]:
    turns = [name for name in _TURNS if element.get(name)]
    if len(turns) > 1 and element.tag in {"body", "geom", "inertial"}:
        yield Hit("several-orientations", element, f"{_about(element)} has {turns[0]} and {turns[1]}")
    for name, count in _COUNT[element.tag].items():
        text = element.get(name)
        if name == "quat" and (quat := numbers(text, 4)) and not any(quat):
            yield Hit("quaternion-zero", element, f"quat of {_about(element)} is {shown(text or '')}")
        if text is None:
            continue
        if any(numbers(text, each) for each in ((count,) if count else (1, 2, 3))):
            if name == "damping" and _is_refused_by_drake(element, name, text):
                yield Hit("invalid-vector", element, f"{name} of {_about(element)} is {shown(text)}", {"drake"})
            continue
        rule = "invalid-number" if count == 1 else "invalid-vector"
        what = "one finite number" if count == 1 else f"{count or 'up to 3'} finite numbers"
        message = f"{name} of {_about(element)} is {shown(text)}, not {what}"
        is_taken = _is_taken(element, name, text, (count,) if count else (1, 2, 3))
        of = {"pybullet"} | (set() if is_taken else {"mujoco"})
        if name in _OF_DRAKE.get(str(element.tag), ()) and not _is_of_no_use(element, name):
            if _is_refused_by_drake(element, name, text):
                of.add("drake")
            else:
                yield Hit("misread-number", element, message)
        yield Hit(rule, element, message, of)
        if is_taken and _ODD.search(text):
            yield Hit("not-finite", element, message)


def _is_taken(element: etree._Element, name: str, text: str, counts: tuple[int, ...]) -> bool:
    """Whether MuJoCo takes a text that is not finite numbers: it reads nan, inf and 0x10, and blanks as nothing."""
    in_inertial = element.tag == "inertial"
    if not text.strip():
        return not in_inertial or name in {"quat", "diaginertia"}
    read = next((found for count in counts if (found := mujoco_numbers(text, count))), None)
    if read is None or (name == "fromto" and any(map(math.isnan, read))):
        return False
    if not in_inertial or name in {"pos", "quat"}:
        return True
    if name == "mass":
        return read[0] > 0.0 or not _moves(element)
    if name == "diaginertia" and set(read) == {math.inf}:
        return True
    return math.inf not in read and not _moves(element)


def _moves(inertial: etree._Element) -> bool:
    body = inertial.getparent()
    return body is not None and any(child.tag in {"joint", "freejoint"} for child in body)


def _words(element: etree._Element) -> Iterator[Hit]:
    """Words and counts of numbers that a reader does not take."""
    for name, text in ((str(name), str(text)) for name, text in element.attrib.items()):
        if name in _COUNT.get(str(element.tag), ()):
            continue
        fault = fault_of(str(element.tag), name, text)
        of = {"mujoco"} if fault else set[str]()
        if _is_refused_by_drake(element, name, text):
            of.add("drake")
        if name == "limited" and element.tag == "joint" and fault:
            of |= {"drake", "pybullet"}
        if of:
            yield Hit("unknown-word", element, fault or f"{name} of {element.tag} is {shown(text)}", of)


def _is_refused_by_drake(element: etree._Element, name: str, text: str) -> bool:
    """Whether Drake reads an attribute, and refuses a text: it reads the numbers that the text begins with."""
    if name not in _OF_DRAKE.get(str(element.tag), ()) or _is_of_no_use(element, name):
        return False
    kind, read = kind_of(str(element.tag), name), len(drake_numbers(text))
    if name == "size":
        return read < MEASURES.get(element.get("type", "sphere"), 0)
    if "|" in kind and name != "condim":
        return text not in kind.split("|")
    return read != (1 if name in {"damping", "condim"} else int(kind.removeprefix("whole ")))


def _is_of_no_use(element: etree._Element, name: str) -> bool:
    """Whether Drake passes over the mass of a geom, since the body has its own."""
    body = element.getparent()
    return (element.tag, name) == ("geom", "mass") and body is not None and body.find("inertial") is not None


def _joints(root: etree._Element) -> Iterator[Hit]:
    joints = [joint for joint in elements_of(root, "joint") if _holder(joint) in {*BODIES, "default"}]
    only_range = [joint for joint in joints if joint.get("range") and joint.get("limited") in {None, "auto"}]
    if only_range:
        count = "a joint has" if len(only_range) == 1 else f"{len(only_range)} joints have"
        yield Hit("range-without-limited", only_range[0], f'{count} a range and no limited="true"')
    for joint in joints:
        about, kind = _about(joint), joint.get("type")
        if kind is not None and kind not in JOINTS:
            near = did_you_mean(kind, JOINTS)
            message = f"{about} has the type {shown(kind)}"
            yield Hit("unknown-joint-type", joint, f"{message}: {near}" if near else message)
        if not joint.get("name") and not _is_default(joint):
            yield Hit("nameless-joint", joint, "a joint has no name")
        if axis := numbers(joint.get("axis"), 3):
            length = norm((axis[0], axis[1], axis[2]))
            if length < UNIT:
                yield Hit("axis-zero", joint, f"the axis of {about} has the length 0")
            elif abs(length - 1.0) > UNIT:
                yield Hit("axis-not-unit", joint, f"the axis of {about} has the length {length:.6g}")
        yield from _range(joint, root)


def _range(joint: etree._Element, root: etree._Element) -> Iterator[Hit]:
    about = _about(joint)
    by_range = compiler_of(root).get("autolimits") != "false"
    ends = numbers(joint.get("range"), 2)
    if ends and ends[0] > ends[1] and by_range and joint.get("limited") in {None, "auto"}:
        yield Hit("swapped-range", joint, f"the range of {about} is {shown(joint.get('range') or '')}")
    is_one_value = joint.get("type") in {None, "hinge", "slide"} and not _is_default(joint)
    if ends and ends[0] >= ends[1] and joint.get("limited") == "true" and is_one_value:
        rule = "swapped-limits" if ends[0] > ends[1] else "equal-limits"
        yield Hit(rule, joint, f"{about} is limited, and its range is {shown(joint.get('range') or '')}")
    if (
        joint.get("limited") == "true"
        and not (joint.get("range") or "").strip()
        and not _may_inherit(joint, "range", root)
    ):
        yield Hit("limited-without-range", joint, f"{about} is limited and has no range")


def _holder(element: etree._Element) -> str:
    parent = element.getparent()
    return str(parent.tag) if parent is not None else ""


def _may_inherit(element: etree._Element, attribute: str, root: etree._Element) -> bool:
    """Whether a default has an attribute for elements of a kind; which class is meant does not matter here."""
    return _is_default(element) or any(
        _is_default(other) and other.get(attribute) for other in elements_of(root, element.tag)
    )


def _inertial(inertial: etree._Element, root: etree._Element) -> Iterator[Hit]:
    body = inertial.getparent()
    if body is None or body.tag != "body":
        return
    about = _about(body)
    mass = numbers(inertial.get("mass"), 1)
    if inertial.get("mass") is None:
        yield Hit("missing-mass", inertial, f"the inertial of {about} has no mass")
    if inertial.get("pos") is None:
        yield Hit("missing-inertial-pos", inertial, f"the inertial of {about} has no pos")
    tensors = [name for name in ("diaginertia", "fullinertia") if inertial.get(name)]
    turns = [name for name in _TURNS if inertial.get(name)]
    if "fullinertia" in tensors and len(tensors + turns) > 1:
        others = [name for name in tensors + turns if name != "fullinertia"]
        yield Hit(
            "several-orientations", inertial, f"the inertial of {about} has fullinertia and {others[0]}", {"mujoco"}
        )
    if changes_masses(compiler_of(root)):
        return
    moves = _moves(inertial)
    if not tensors:
        minding = {"drake", "mujoco"} if moves else {"drake"}
        yield Hit("missing-attribute", inertial, f"the inertial of {about} has no diaginertia or fullinertia", minding)
    if mass and mass[0] < SMALLEST and moves:
        of = None if mass[0] <= 0.0 else {"mujoco"}
        yield Hit("mass-not-positive", inertial, f"the mass of {about} is {mass[0]:g}", of)
    yield from _inertia(inertial, about, moves=moves)


def _inertia(inertial: etree._Element, about: str, *, moves: bool) -> Iterator[Hit]:
    """MuJoCo minds moments of 0 or less in a body that moves, and in each of which six are written."""
    full, diagonal = (
        mujoco_numbers(inertial.get(name) or "", n) for name, n in (("fullinertia", 6), ("diaginertia", 3))
    )
    moments = full or (*(diagonal or (math.nan,)), 0.0, 0.0, 0.0)
    if not all(map(math.isfinite, moments)):
        return
    rule = fault_of_inertia(moments)
    xx, yy, zz, xy, xz, yz = moments
    low = principal_moments(Inertia(ixx=xx, iyy=yy, izz=zz, ixy=xy, ixz=xz, iyz=yz))[0]
    of = set[str]() if low < SMALLEST and not moves and not full else {"mujoco"}
    if (rule and "triangle" in rule) or low < -SMALLEST:
        what = "breaks the triangle inequality" if rule and "triangle" in rule else "is not positive definite"
        is_read = numbers(inertial.get("fullinertia" if full else "diaginertia"), len(full or diagonal or ()))
        rule = rule or "inertia-not-positive-definite"
        yield Hit(rule, inertial, f"the inertia of {about} {what}", of | ({"drake"} if is_read else set()))
    elif low < SMALLEST and of:
        yield Hit("inertia-not-positive-definite", inertial, f"a moment of inertia of {about} is {low:g}", of)


def _geoms(root: etree._Element) -> Iterator[Hit]:
    for geom in elements_of(root, "geom"):
        if _holder(geom) not in {*BODIES, "default"}:
            continue
        kind = geom.get("type")
        if kind is not None and kind not in GEOMS:
            near = did_you_mean(kind, GEOMS)
            message = f"{_about(geom)} has the type {shown(kind)}"
            yield Hit("unknown-geom-type", geom, f"{message}: {near}" if near else message)
        elif (
            kind in _SIZED
            and not (geom.get("size") or "").strip()
            and not geom.get("mesh")
            and not _may_inherit(geom, "size", root)
        ):
            yield Hit("missing-size", geom, f"{_about(geom)} of type {kind} has no size")
