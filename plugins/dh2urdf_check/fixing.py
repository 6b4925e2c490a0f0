"""Fixes in a URDF what can be fixed without asking, at its place in the text: every other byte stays as it is."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, NamedTuple
from xml.parsers import expat

from dh2urdf.columns import INERTIA
from dh2urdf.documents import read_bytes
from dh2urdf.errors import InputError
from dh2urdf.quantities import format_numbers
from dh2urdf.rotations import norm
from dh2urdf.source import Mark, Messages, Problem, free_name
from dh2urdf.stages import Repair
from dh2urdf_check.finders import numbers_of
from dh2urdf_plugins.formats.xml_files import LARGEST

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

say = Messages(__file__)

UNIT = 1e-5
"""How far the length of an axis may be from 1: what rounding to six digits makes of it."""
DENSITY = 2700.0
"""Of the ball whose inertia takes the place of 0: aluminium, as of drawn shapes [kg/m³]."""
_DECLARATION = b'<?xml version="1.0" encoding="utf-8"?>\n'
_BOM = b"\xef\xbb\xbf"
_ATTRIBUTE = re.compile(rb"""\s*([\w:.-]+)\s*=\s*("[^"<]*"|'[^'<]*')""")
_TROUBLESOME = re.compile(r"[^A-Za-z0-9_.-]+")
_NAMING = {
    "link": ("name",),
    "joint": ("name",),
    "parent": ("link",),
    "child": ("link",),
    "mimic": ("joint",),
    "gazebo": ("reference",),
}
"""The attributes that hold the name of a link or joint."""


class _Tag(NamedTuple):
    """A start tag: its name, its values, where each value is in the bytes of the file, and its place."""

    name: str
    above: tuple[str, ...]
    values: dict[str, str]
    spans: dict[str, tuple[int, int]]
    mark: Mark


class _Edit(NamedTuple):
    span: tuple[int, int]
    text: bytes
    change: Problem


def fixed(path: Path) -> Repair:
    """A URDF with what is mechanical fixed."""
    content = read_bytes(path, InputError, limit=LARGEST)
    tags = _tags(content, path)
    edits = [*_numbers(tags), *_names(tags)]
    pieces, end, told = list[bytes](), 0, dict[str, Problem]()
    for edit in sorted(edits, key=lambda edit: edit.span):
        pieces += [content[end : edit.span[0]], edit.text]
        end = edit.span[1]
        told.setdefault(edit.change.message, edit.change)
    text, changes = b"".join([*pieces, content[end:]]), list(told.values())
    if not text.removeprefix(_BOM).startswith(b"<?xml"):
        text = _DECLARATION + text.removeprefix(_BOM)
        changes.insert(0, say("declaration-fixed", Mark(file=str(path), line=1, column=1)))
    return Repair(content=text, changes=tuple(changes))


def _tags(content: bytes, path: Path) -> list[_Tag]:
    tags: list[_Tag] = []
    above: list[str] = []
    parser = expat.ParserCreate()

    def started(name: str, values: dict[str, str]) -> None:
        start = parser.CurrentByteIndex
        spans: dict[str, tuple[int, int]] = {}
        place = start + 1 + len(name.encode())
        while match := _ATTRIBUTE.match(content, place):
            spans[match[1].decode()] = (match.start(2) + 1, match.end(2) - 1)
            place = match.end()
        if set(spans) == set(values):  # Otherwise the text is not as it is read, and stays.
            mark = Mark(file=str(path), line=parser.CurrentLineNumber, column=parser.CurrentColumnNumber + 1)
            tags.append(_Tag(name, tuple(above), values, spans, mark))
        above.append(name)

    parser.StartElementHandler, parser.EndElementHandler = started, lambda _name: above.pop()
    try:
        content.decode("utf-8")
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise InputError(say("fix-not-utf-8", Mark(file=str(path)), reason=error)) from None
    return tags


def _numbers(tags: list[_Tag]) -> Iterator[_Edit]:
    """Axes of length 1, limits in order, and for the inertia 0 of a mass that of a ball."""
    mass: float | None = None
    for tag in tags:
        number = {name: found[0] for name, text in tag.values.items() if (found := numbers_of(text, 1))}
        if tag.name in {"inertial", "mass"}:
            mass = number.get("value")
        match (*tag.above, tag.name):
            case ("robot", "joint", "axis") if axis := numbers_of(tag.values.get("xyz"), 3):
                length = norm((axis[0], axis[1], axis[2]))
                if length > UNIT and abs(length - 1.0) > UNIT:
                    text = " ".join(format_numbers([value / length for value in axis]))
                    change = say("axis-fixed", tag.mark, found=tag.values["xyz"], axis=text)
                    yield _Edit(tag.spans["xyz"], text.encode(), change)
            case ("robot", "joint", "limit") if number.get("lower", -math.inf) > number.get("upper", math.inf):
                change = say("limits-fixed", tag.mark, lower=number["lower"], upper=number["upper"])
                for name, other in (("lower", "upper"), ("upper", "lower")):
                    yield _Edit(tag.spans[name], tag.values[other].encode(), change)
            case ("robot", "link", "inertial", "inertia") if mass and mass > 0.0:
                if all(number.get(name) == 0.0 for name in INERTIA):
                    # I = 2/5·m·r², with m = 4/3·π·r³·ρ.
                    moment = 0.4 * mass * (3.0 * mass / (4.0 * math.pi * DENSITY)) ** (2.0 / 3.0)
                    change = say("inertia-fixed", tag.mark, mass=mass, moment=moment)
                    for name in ("ixx", "iyy", "izz"):
                        yield _Edit(tag.spans[name], f"{moment:.9g}".encode(), change)


def _names(tags: list[_Tag]) -> Iterator[_Edit]:
    named = (tag for tag in tags if tag.above == ("robot",) and tag.name in {"link", "joint"})
    names = {tag.values["name"] for tag in named if "name" in tag.values}
    taken, renamed = set(names), dict[str, str]()
    for name in sorted(names):
        if _TROUBLESOME.search(name):
            new = _TROUBLESOME.sub("_", name).strip("_") or "unnamed"
            renamed[name] = free_name(new, taken)
    for tag in tags:
        for attribute in _NAMING.get(tag.name, ()):
            old = tag.values.get(attribute, "")
            if old in renamed:
                change = say("name-fixed", tag.mark, found=old, name=renamed[old])
                yield _Edit(tag.spans[attribute], renamed[old].encode(), change)
