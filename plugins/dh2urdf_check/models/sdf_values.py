"""Rules about the values in an SDF: what each element may contain, and which attributes it needs.

The elements and their kinds are those of version 1.9 as sdformat 12.3 prints it (``ign sdf --describe 1.9``), in
sdf_values.txt: by kind, the elements with what holds them. Where a number has a least and a greatest value, they are
behind the kind; a `!` means that the element may not be blank. What else is blank is the default.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.source import did_you_mean, shown
from dh2urdf_check.models.models import Hit, numbers
from dh2urdf_check.numbers import SENSORS, drake_number, drake_numbers, ends_stod

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

_ALL = ("gazebo", "drake")
_NEEDED: dict[str, dict[str, tuple[str, ...]]] = {
    "link": {
        **dict.fromkeys(("visual", "collision", "projector", "battery"), ("name",)),
        **dict.fromkeys(("sensor", "light", "particle_emitter"), ("name", "type")),
    },
    "joint": {"sensor": ("name", "type")},
    "model": {"gripper": ("name",)},
    "world": {
        **dict.fromkeys(("actor", "road", "population"), ("name",)),
        "physics": ("type",),
        "light": ("name", "type"),
    },
    "sdf": {"world": ("name",), "light": ("name", "type"), "actor": ("name",)},
}
"""Attributes that an element needs, by what holds it; those of links, joints and frames have rules of their own."""
_OF_PLUGIN = ("name", "filename")
_TYPES = {
    "sensor": SENSORS.split(),
    "light": ["point", "spot", "directional"],
    "particle_emitter": ["point", "box", "cylinder", "ellipsoid"],
}
_IN_DRAKE = ("air_speed", "wideanglecamera")
"""Types of sensors of later versions."""
_NAMED_APART = ("sensor", "light")
"""What shares a name with no other of its kind in one link, joint or world."""
_READ_BY_ALL = ("pose", "xyz", "size", "scale")
"""Vectors that PyBullet reads, too."""
_WHOLE = re.compile(r"\s*[-+]?[0-9]+", re.ASCII)
_LARGEST = {"whole": 2**31 - 1, "count": 2**64 - 1}
_TRUTH = {"1", "0", "true", "false"}
_WANTED = {
    "truth": "`true` or `false`",
    "number": "a number",
    "whole": "a whole number",
    "count": "a whole number",
    "colour": "3 or 4 numbers from 0 to 1",
}
_RANGE = "from "
_COLOUR = (3, 4)
_SHAPES, _SIZES = ("sphere", "cylinder", "capsule", "cone"), ("radius", "length")


@cache
def _kinds() -> dict[tuple[str, str], str]:
    """The kind of an element, by what holds it and its own name."""
    lines = Path(__file__).with_name("sdf_values.txt").read_text("utf-8").splitlines()
    return {
        (holder, name): kind
        for kind, _, elements in (line.partition(": ") for line in lines)
        for holder, _, name in (element.partition("/") for element in elements.split())
    }


def hits(root: etree._Element) -> Iterator[Hit]:
    """Findings about the elements that sdformat reads: all but what a plugin has, and those with a prefix."""
    waiting = [root]
    for element in waiting:
        yield from _needs(element)
        if element.tag == "plugin":
            continue
        seen = set[tuple[str, str]]()
        for child in element:
            if not isinstance(child.tag, str) or {":", "{"} & set(child.tag):
                continue
            waiting.append(child)
            if kind := _kinds().get((str(element.tag), child.tag)):
                yield from _value(child, str(element.tag), kind)
            name = (child.tag, child.get("name") or "")
            if child.tag in _NAMED_APART and name in seen:
                message = f"{child.tag} {shown(name[1])} has the name of another {child.tag}"
                yield Hit("duplicate-part", child, message)
            seen.add(name)


def fault_of(element: etree._Element, holder: str) -> str:
    """What sdformat wants the text of an element to be; empty where it reads it."""
    kind, text = _kinds().get((holder, str(element.tag)), ""), (element.text or "").strip()
    if not kind or not text:
        return "blank" if kind.endswith("!") else ""
    word, _, bounds = kind.removesuffix("!").partition(" ")
    if word == "pose":
        word = "7" if element.get("rotation_format") == "quat_xyzw" else "6"
        words = text.split()
        is_read = len(words) == int(word) and all(
            _is_read(each) and each.lstrip("+-")[:1].lower() not in {"n", "i"} for each in words
        )
    elif word == "colour":
        words = text.split()
        is_read = len(words) in _COLOUR and all(map(_is_read, words))
        is_read = is_read and all(0.0 <= part <= 1.0 for each in words for part in drake_numbers(each))
    elif word.isdecimal():
        is_read = len(drake_numbers(text)) >= int(word)
    elif word == "truth":
        is_read = text.lower() in _TRUTH
    elif text in {"true", "false"}:
        return ""
    else:
        whole = _WHOLE.match(text)
        is_read = _is_read(text) if word == "number" else whole is not None and abs(int(whole[0])) <= _LARGEST[word]
        if is_read:
            return _outside(text, bounds)
    return "" if is_read else _WANTED.get(word) or f"{word} finite numbers"


def _is_read(word: str) -> bool:
    return not ends_stod(word)


def _outside(text: str, bounds: str) -> str:
    least, _, most = bounds.partition("-")
    value = drake_number(" ".join(text.split()[:1]))
    if value is None or not ((least and value < float(least)) or (most and value > float(most))):
        return ""
    return f"{_RANGE}{least} to {most}" if most else f"{_RANGE}{least} on"


def _value(element: etree._Element, holder: str, kind: str) -> Iterator[Hit]:
    text, fault = (element.text or "").strip(), fault_of(element, holder)
    if fault:
        is_range = fault.startswith(_RANGE)
        several = kind[0].isdecimal() or kind.startswith(("pose", "colour"))
        rule = "out-of-range" if is_range else "invalid-vector" if several and text else "unreadable-value"
        rule = "colour-out-of-range" if fault == _WANTED["colour"] and text else rule
        wanted = "and it needs a value" if fault == "blank" else f"not {fault}"
        of = None if rule == "invalid-vector" and element.tag in _READ_BY_ALL else _ALL
        yield Hit(rule, element, f"{element.tag} of {holder} is {shown(text)}, {wanted}", of)
    quaternion = numbers(text, 7) if (element.tag, element.get("rotation_format")) == ("pose", "quat_xyzw") else None
    if quaternion and not any(quaternion[3:]):
        yield Hit("quaternion-zero", element, f"pose of {holder} is {shown(text)}")
    if holder in _SHAPES and element.tag in _SIZES and text.lower().lstrip("+-")[:3] in {"nan", "inf"}:
        yield Hit("impossible-number", element, f"{element.tag} of {holder} is {shown(text)}")


def _needs(element: etree._Element) -> Iterator[Hit]:
    tag = str(element.tag)
    holder = element.getparent()
    needed = _NEEDED.get(str(holder.tag), {}).get(tag, ()) if holder is not None else ()
    if tag == "noise" and element.find("type") is None:  # Old versions have an element.
        needed = ("type",)
    for name in _OF_PLUGIN if tag == "plugin" else needed:
        if not (element.get(name) or "").strip():
            of = {"gazebo"} if (tag, name) == ("plugin", "name") else None
            yield Hit("missing-attribute", element, f"a {tag} has no {name}", of)
    kind = (element.get("type") or "").strip()
    if kind and kind not in (known := _TYPES.get(tag, [kind])):
        near = did_you_mean(kind, known)
        message = f"{tag} {shown(element.get('name') or '')} has the type {shown(kind)}"
        of = {"gazebo"} if kind in _IN_DRAKE else None
        yield Hit("unknown-type", element, f"{message}: {near}" if near else message, of)
    above = holder.getparent() if holder is not None and holder.tag == "material" else None
    in_visual = above is not None and above.tag == "visual"
    if in_visual and tag == "script":
        for name in ("name", "uri"):
            if not (element.findtext(name) or "").strip():
                yield Hit("missing-attribute", element, f"a script of a material has no {name}")
    if in_visual and tag == "shader" and "normal_map" in kind and element.find("normal_map") is None:
        yield Hit("missing-attribute", element, f"a shader of the type {kind} has no normal_map")
    if (
        tag == "mesh"
        and holder is not None
        and holder.tag == "geometry"
        and not (element.findtext("uri") or "").strip()
    ):
        of = {"drake"} if element.find("uri") is None else None
        yield Hit("missing-attribute", element, "a mesh has no uri", of)
