"""Rules about SDF, as its specification (http://sdformat.org/spec) and its readers have it."""

from __future__ import annotations

import re
from functools import partial
from typing import TYPE_CHECKING
from urllib.parse import unquote

from lxml import etree

from dh2urdf.documents import is_file, is_there
from dh2urdf.kinematics.mass import principal_moments
from dh2urdf.manipulator import Inertia
from dh2urdf.rotations import norm
from dh2urdf.row_fields import INERTIA
from dh2urdf.source import did_you_mean, shown
from dh2urdf_check.joints import UNIT
from dh2urdf_check.models.models import Hit, Model, fault_of_inertia, inspect_model, numbers
from dh2urdf_check.models.sdf_frames import hits as hits_of_frames, undefined
from dh2urdf_check.models.sdf_values import fault_of, hits as hits_of_values
from dh2urdf_check.numbers import ROUNDED, drake_numbers
from dh2urdf_plugins.formats.sdf.elements import FRAMES_SINCE, IN_MODEL, LONGEST_VERSION
from dh2urdf_plugins.formats.sdf.reader import read_model

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.stages import Expansion, Inspection

VERSIONS = tuple(f"1.{minor}" for minor in range(13))
TYPES = ("revolute", "prismatic", "fixed", "continuous", "ball", "universal", "screw", "gearbox", "revolute2")
WITH_AXIS = ("revolute", "prismatic", "continuous", "universal", "screw", "gearbox", "revolute2")
CHILDREN = {
    "joint": (
        "parent child pose axis axis2 physics sensor thread_pitch screw_thread_pitch gearbox_ratio angle "
        "gearbox_reference_body frame"
    ),
    "axis": "xyz limit dynamics mimic use_parent_model_frame initial_position",
    "limit": "lower upper effort velocity stiffness dissipation cfm erp",
    "inertial": "mass inertia pose density fluid_added_mass frame auto_inertia_params",
    "inertia": "ixx ixy ixz iyy iyz izz",
}
"""The elements in those of which a misspelt one changes how the model moves, old and new versions together."""
_OF_OTHERS = ("actor", "gripper", "plugin", "sensor", "state")
"""Elements whose content is no part of a model, although it may be called so: a contact sensor names a `collision`."""
_SCALARS = ("mass", "lower", "upper", "effort", "velocity", "radius", "length")
_VALUES = {**dict.fromkeys(_SCALARS + INERTIA, 1), "xyz": 3, "size": 3, "scale": 3, "pose": 6}
"""How many numbers there are in an element."""
_SCOPES_SINCE = (1, 8)
"""The version since which no name may have a `::`."""
_TWO_AXES = ("universal",)
_NOT_IN_DRAKE = ("gearbox", "revolute2")
_WITH_LIMITS = ("revolute", "prismatic")
_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_NOT_NEGATIVE = ("dynamics/damping", "dynamics/spring_stiffness")
"""What Drake wants not to be below 0."""
_IN = ("inertial", "inertia", "limit", "axis", "axis2", "box", "cylinder", "sphere", "capsule", "mesh", "link", "model")
_POSED = ("inertial", "link", "model", "joint", "frame", "visual", "collision", "sensor", "include", "light")
_NAMED = ("model", "link", "joint", "frame")


def inspect_sdf(path: Path, _expansion: Expansion | None = None) -> Inspection:
    """Findings about an SDF.

    Raises:
        InputError: the file cannot be read.
    """
    return inspect_model(path, "sdf", "sdf", hits, lambda file: read_model(file).robot)


def hits(model: Model) -> Iterator[Hit]:
    """Findings about the models of a file."""
    root = model.root
    version = root.get("version")
    if version is None:
        yield Hit("no-version", root, "sdf has no version")
    elif version not in VERSIONS:
        yield Hit("unknown-version", root, f"the version is {shown(version)}")
    parts = list(_parts(root))
    models = [element for element in parts if element.tag == "model"]
    if not models and root.find("world") is None and root.find("actor") is None and root.find("light") is None:
        yield Hit("no-model", root, "there is no model")
    for world in (part for part in parts if part.tag == "world"):
        yield from _same_names(world, ("model",))
    for other in [*root.iterchildren("model")][1:]:
        yield Hit("several-models", other, f"{_name(other)} is not the only one outside of a world")
    for element in models:
        yield from _model(element)
    yield from hits_of_values(root)
    for tags, rule in (
        ((*CHILDREN, "axis2"), _children),
        (tuple(_VALUES), _value),
        (("joint",), _axes),
        (("link",), _body),
        (("link",), partial(_same_names, tags=("visual", "collision"))),
        (("visual", "collision"), partial(_shape, path=model.path)),
        (("include",), partial(_include, path=model.path)),
    ):
        for element in parts:
            if element.tag in tags:
                yield from rule(element)


def _parts(element: etree._Element) -> Iterator[etree._Element]:
    """The elements of models and worlds, in the order of the file; of a sensor only the pose."""
    yield element
    for child in element.iterchildren(etree.Element):
        if child.tag == "sensor":
            yield from child.iterchildren("pose")
        elif child.tag not in _OF_OTHERS and not {":", "{"} & set(child.tag):
            yield from _parts(child)


def _name(element: etree._Element) -> str:
    return f"{element.tag} {shown(element.get('name') or '')}"


def _text(element: etree._Element, path: str) -> str:
    return (element.findtext(path) or "").strip()


def _is_static(model: etree._Element | None) -> bool:
    return model is not None and _text(model, "static").lower() in {"1", "true"}


def _model(model: etree._Element) -> Iterator[Hit]:
    """Names, and what the joints and frames of a model declare about each other."""
    if not model.get("name"):
        yield Hit("missing-name", model, "a model has no name")
    parts = [child for child in model if child.tag in _NAMED]
    has_more = model.find("include") is not None
    if not has_more and model.find("link") is None and model.find("model") is None and not _is_static(model):
        yield Hit("no-link", model, f"{_name(model)} has no link")
    kinds: dict[str, str] = {}
    by_name: dict[str, etree._Element] = {}
    for part in parts:
        name = part.get("name")
        if not name:
            yield Hit("missing-name", part, f"a {part.tag} has no name")
        elif name == "world" or re.fullmatch(r"__.*__", name) or ("::" in name and not _is_before(part, _SCOPES_SINCE)):
            yield Hit("reserved-name", part, f"{_name(part)} has a name that is reserved")
        elif name in kinds:
            rule = "duplicate-name" if kinds[name] == part.tag == "link" else "shared-name"
            yield Hit(rule, part, f"{_name(part)} has the name of a {kinds[name]}")
        kinds.setdefault(name or "", part.tag)
        by_name.setdefault(name or "", part)
    if "::" in (model.get("name") or "") and not _is_before(model, _SCOPES_SINCE):
        yield Hit("reserved-name", model, f"{_name(model)} has `::` in its name")
    yield from _joints(model, kinds, has_more=has_more)
    yield from hits_of_frames(model, by_name, has_more=has_more)
    frames = {*kinds, "__model__"}
    for part in parts:
        yield from _frames(part, frames, has_more=has_more)


def _frames(part: etree._Element, frames: set[str], *, has_more: bool) -> Iterator[Hit]:
    """What a part of a model is placed by."""
    for element, attribute in ((part.find("pose"), "relative_to"), (part, "attached_to")):
        target = element.get(attribute) if element is not None else None
        if element is None or not target:
            continue
        missing = list(undefined(element, attribute, target, frames, has_more=has_more))
        yield from missing
        if not missing and attribute == "relative_to" and part.tag == "link" and target != "__model__":
            yield Hit("relative-pose", element, f"the pose of {_name(part)} is relative to {shown(target)}")


def _joints(model: etree._Element, kinds: dict[str, str], *, has_more: bool) -> Iterator[Hit]:
    parents: dict[str, str] = {}
    for joint in model.findall("joint"):
        about, kind = _name(joint), joint.get("type") or ""
        if kind not in TYPES:
            near = did_you_mean(kind, TYPES)
            message = f"{about} has the type {shown(kind)}"
            yield Hit("unknown-joint-type", joint, f"{message}: {near}" if near else message)
        for end in ("parent", "child"):
            element, target = joint.find(end), _text(joint, end)
            if element is None or not target:
                yield Hit("missing-parent-or-child", joint, f"{about} has no {end}")
            elif target == "world" and end == "parent":
                yield Hit("world-parent", element, f"the parent of {about} is the world")
            elif target == "__model__" or kinds.get(target) == "model":
                message = f"the {end} of {about} is {shown(target)}, the frame of a model"
                yield Hit("undefined-link", element, message, {"gazebo", "pybullet"})
            elif target not in kinds and "::" not in target and not has_more:
                near = did_you_mean(target, kinds)
                message = f"the {end} of {about} is {shown(target)}, which is not there"
                of = {"drake", "pybullet"} if _is_nested(model) else None  # sdformat does not look in nested models.
                yield Hit("undefined-link", element, f"{message}: {near}" if near else message, of)
        yield from _limits_of_drake(joint, model, kinds, has_more=has_more)
        parent, child = _text(joint, "parent"), _text(joint, "child")
        if child and parent:
            yield from _tree(joint, parent, child, parents)


def _limits_of_drake(
    joint: etree._Element, model: etree._Element, kinds: dict[str, str], *, has_more: bool
) -> Iterator[Hit]:
    """What Drake knows no joint for."""
    kind, about, mimic = joint.get("type") or "", _name(joint), joint.find("axis/mimic")
    leader = mimic.get("joint") if mimic is not None else None
    is_missing = leader == joint.get("name") or kinds.get(leader or "") != "joint"
    if mimic is not None and is_missing and not has_more and not _is_nested(model):
        message = f"{about} mimics {shown(leader or '')}, which is no other joint"
        yield Hit("undefined-link", mimic, message, {"drake"})
    if kind in _NOT_IN_DRAKE or (_is_static(model) and kind != "fixed"):
        what = "is of a static model, and " if kind not in _NOT_IN_DRAKE else ""
        of = {"drake"} if what else None
        yield Hit("unsupported-joint-type", joint, f"{about} {what}has the type {shown(kind)}", of)


def _is_nested(model: etree._Element) -> bool:
    return any(True for _ in model.iterancestors("model"))


def _tree(joint: etree._Element, parent: str, child: str, parents: dict[str, str]) -> Iterator[Hit]:
    """Says where a joint closes a chain; `parents` has a link above each link so far, shortened on the way."""
    if child in parents:
        yield Hit("several-parents", joint, f"{_name(joint)} holds link {shown(child)}, which another joint holds")
        return
    top, way = parent, list[str]()
    while top in parents:
        way.append(top)
        top = parents[top]
    parents.update(dict.fromkeys(way, top))
    if child == top:  # Nothing holds it so far.
        yield Hit("cycle", joint, f"{_name(joint)} closes a circle")
        return
    parents[child] = parent


def _children(element: etree._Element) -> Iterator[Hit]:
    known = CHILDREN["axis" if element.tag == "axis2" else element.tag].split()
    holder = element.getparent()
    if holder is None or (element.tag == "limit" and holder.tag not in {"axis", "axis2"}):
        return
    for child in element:
        if child.tag == IN_MODEL and not _is_before(element, FRAMES_SINCE):
            yield Hit("unknown-element", child, f"since version 1.7 there is no {IN_MODEL}")
        elif isinstance(child.tag, str) and child.tag not in known and not {":", "{"} & set(child.tag):
            near = did_you_mean(child.tag, known)
            message = f"a {element.tag} has no element {shown(child.tag)}"
            yield Hit("unknown-element", child, f"{message}: {near}" if near else message)


def _is_before(element: etree._Element, version: tuple[int, ...]) -> bool:
    own = next(element.iterancestors("sdf")).get("version") or VERSIONS[-1]
    return tuple(map(int, re.findall(r"[0-9]+", own[:LONGEST_VERSION]))) < version


def _value(element: etree._Element) -> Iterator[Hit]:
    parent = element.getparent()
    if parent is None or parent.tag not in (_POSED if element.tag == "pose" else _IN):
        return
    if element.tag == "pose" and element.get("rotation_format"):
        return
    is_read = not fault_of(element, str(parent.tag))
    count, text = _VALUES[element.tag], (element.text or "").strip()
    if element.tag == "pose" and not text:
        return
    if (
        numbers(text, count) is None
        and text.lower().lstrip("+-") not in {"inf", "infinity"}
        and (is_read or count == 1)
    ):
        what = "one finite number" if count == 1 else f"{count} finite numbers"
        message = f"{element.tag} of {parent.tag} is {shown(text)}, not {what}"
        yield Hit("invalid-number", element, message, None if is_read else {"pybullet"})


def _axes(joint: etree._Element) -> Iterator[Hit]:
    kind, about = joint.get("type") or "", _name(joint)
    if kind in WITH_AXIS and joint.find("axis") is None:
        yield Hit("missing-axis", joint, f"{about} has no axis")
    elif kind in _TWO_AXES and joint.find("axis2") is None:
        yield Hit("missing-axis", joint, f"{about} has no axis2", {"drake"})
    for axis in (child for child in joint if child.tag in {"axis", "axis2"}):
        yield from _axis(axis, kind, about)


def _axis(axis: etree._Element, kind: str, about: str) -> Iterator[Hit]:
    yield from _ends(axis, kind, about)
    xyz = axis.find("xyz")
    if xyz is None:
        yield Hit("missing-axis-direction", axis, f"the axis of {about} has no xyz")
    elif direction := numbers(xyz.text, 3):
        length = norm((direction[0], direction[1], direction[2]))
        if length < UNIT:
            yield Hit("axis-zero", xyz, f"the axis of {about} has the length 0")
        elif abs(length - 1.0) > UNIT:
            yield Hit("axis-not-unit", xyz, f"the axis of {about} has the length {length:.6g}")


def _ends(axis: etree._Element, kind: str, about: str) -> Iterator[Hit]:
    """What is wrong with limits, damping and stiffness."""
    if kind in {"revolute", "prismatic"} and axis.find("limit") is None:
        yield Hit("missing-limit", axis, f"{about} is {kind} and has no limit")
    ends = [numbers(_text(axis, f"limit/{end}"), 1) for end in ("lower", "upper")]
    for path in _NOT_NEGATIVE:
        if (value := drake_numbers(_text(axis, path))) and value[0] < 0.0:
            yield Hit("impossible-number", axis, f"{path.rpartition('/')[2]} of {about} is {value[0]:g}")
    if kind in _WITH_LIMITS and any(
        _text(axis, f"limit/{end}").lower().lstrip("+-")[:3] == "nan" for end in ("lower", "upper")
    ):
        yield Hit("swapped-limits", axis, f"a limit of {about} is not a number", {"drake"})
    if ends[0] and ends[1] and ends[0] > ends[1]:
        yield Hit("swapped-limits", axis[-1], f"{about} has lower {ends[0][0]:g} and upper {ends[1][0]:g}")


def _body(link: etree._Element) -> Iterator[Hit]:
    inertial = link.find("inertial")
    if inertial is None:
        if not _is_static(link.getparent()):
            yield Hit("missing-inertial", link, f"{_name(link)} has no inertial")
        return
    mass = numbers(_text(inertial, "mass"), 1)
    if mass and mass[0] <= 0.0:
        rule = "zero-mass" if mass[0] == 0.0 else "negative-mass"
        yield Hit(rule, next(inertial.iterfind("mass")), f"the mass of {_name(link)} is {mass[0]:g}")
    inertia = inertial.find("inertia")
    if inertia is None:
        return
    default = {"ixx": "1", "iyy": "1", "izz": "1"}
    moments = [numbers(_text(inertia, name) or default.get(name, "0"), 1) for name in _MOMENTS]
    values = [moment[0] for moment in moments if moment]
    if len(values) < len(moments) or (mass and mass[0] == 0.0 and not any(values)):
        return
    if fault := fault_of_inertia(values):
        what = "breaks the triangle inequality" if "triangle" in fault else "is not positive definite"
        low = principal_moments(Inertia(**dict(zip(_MOMENTS, values, strict=True))))[0]
        # sdformat takes a moment of 0.
        of = {"drake", "pybullet"} if "triangle" not in fault and low > -ROUNDED else None
        yield Hit(fault, inertia, f"the inertia of {_name(link)} {what}", of)


def _same_names(holder: etree._Element, tags: Sequence[str]) -> Iterator[Hit]:
    """Things of one kind that have one name."""
    taken = set[tuple[str, str]]()
    for each in holder.iterchildren(*tags):
        known = (str(each.tag), each.get("name") or "")
        if known in taken:
            yield Hit("duplicate-part", each, f"{_name(each)} of {_name(holder)} has the name of another {each.tag}")
        taken.add(known)


def _shape(shape: etree._Element, path: Path) -> Iterator[Hit]:
    geometry = shape.find("geometry")
    link = shape.getparent()
    about = f"{_name(shape)} of {_name(link) if link is not None else 'nothing'}"
    if geometry is None or not len(geometry):
        yield Hit("missing-geometry", shape, f"{about} has no geometry")
        return
    for element in geometry.iter("size", "radius", "length"):
        size, holder = numbers(element.text, 3 if element.tag == "size" else 1), element.getparent()
        if size and min(size) <= 0.0 and holder is not None and holder.tag != "plane":
            text = shown((element.text or "").strip())
            yield Hit("size-not-positive", element, f"{element.tag} of {about} is {text}")
    for element in geometry.iterfind("mesh/uri"):
        address = (element.text or "").strip()
        if "://" not in address and address and not is_file(path.parent / unquote(address)):
            yield Hit("missing-mesh", element, f"the mesh {shown(address)} of {about} is not there")


def _include(include: etree._Element, path: Path) -> Iterator[Hit]:
    if not (address := _text(include, "uri")):
        yield Hit("missing-include", include, "an include has no uri")
        return
    name = address.partition("://")[2] or address
    folders = (path.parent, path.parent.parent)
    if not address.startswith(("http", "package")) and not any(is_there(folder / name) for folder in folders):
        at = include.find("uri")
        yield Hit("missing-include", include if at is None else at, f"{shown(address)} is not beside the file")
