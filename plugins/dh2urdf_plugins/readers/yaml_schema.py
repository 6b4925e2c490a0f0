"""JSON Schema of a table as YAML, for editors: its keys and words are those that the reader knows.

A schema cannot know what the run's options say, so the convention and the units may be absent; it knows no expression
either, so any text may stand for a number.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from dh2urdf.units import UNITS, Dimension
from dh2urdf_plugins.readers.fields import (
    COM_FIELDS,
    CONVENTION_CHOICES,
    FIELDS,
    INERTIA_FIELDS,
    REQUIRED,
    TYPE_CHOICES,
)
from dh2urdf_plugins.readers.meshes import MESH_KEYS
from dh2urdf_plugins.readers.shapes import SHAPES

if TYPE_CHECKING:
    from collections.abc import Iterable

_LIMITS = ("lower", "upper", "velocity", "effort")
_OF_A_JOINT = tuple(name for name in FIELDS if name not in ("robot", "convention", "index"))
_IN_A_GROUP = (*_LIMITS, *COM_FIELDS, *INERTIA_FIELDS)
"""Fields that an editor offers in `limits`, `com` and `inertia`; the reader takes them in the joint itself too."""

_NUMBER = {"type": ["number", "string"]}
_NUMBER_OR_NONE = {"type": ["number", "string", "null"]}
_NAME = {"type": ["string", "number", "boolean"]}
_BETWEEN_LETTERS = r"[\s_.{}-]*"
"""What the reader overlooks in a key or word."""


def table_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of a table, or of a list of them under `robots`."""
    table = {"$ref": "#/$defs/table"}
    robots = _mapping({"robots": {"type": "array", "items": table, "minItems": 1}})
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Denavit-Hartenberg table of dh2urdf",
        "if": {"required": ["robots"]},
        "then": {**robots, "required": ["robots"]},
        "else": table,
        "$defs": {
            "table": _table(),
            "joint": _joint(),
            "transform": {"anyOf": [_origin(), _list_of(_list_of(_NUMBER, 4), 4)]},
            "mesh": {"anyOf": [{"type": "string", "minLength": 1}, _mesh()]},
            "geometry": _mapping({"shape": {"enum": list(SHAPES)}, "radius": _NUMBER}),
        },
    }


def _table() -> dict[str, Any]:
    geometry = {"$ref": "#/$defs/geometry"}
    units = {
        "anyOf": [
            _mapping({"length": _words(_units(Dimension.LENGTH)), "angle": _words(_units(Dimension.ANGLE))}),
            {"type": "string"},
        ]
    }
    joint = _joint()
    shared = {key: value for key, value in joint["properties"].items() if key not in MESH_KEYS}
    defaults = {**shared, "geometry": geometry, "density": _NUMBER}
    return {
        **_mapping(
            {
                "name": {**_NAME, "description": "name of the manipulator; the file's name if absent"},
                "convention": {
                    **_words(CONVENTION_CHOICES),
                    "description": "standard or modified; never guessed",
                },
                "units": units,
                "base": {
                    "anyOf": [_origin(mass=_NUMBER, geometry=geometry, **_meshes()), {"$ref": "#/$defs/transform"}],
                    "description": "base_link to the first DH frame",
                },
                "tool": {"$ref": "#/$defs/transform", "description": "last DH frame to tool0"},
                "defaults": {**joint, "properties": defaults},
                "visuals": {"enum": ["all", "none"], "description": "whether links are seen"},
                "collisions": {"enum": ["all", "none"], "description": "whether links touch"},
                "joints": {"type": "array", "items": {"$ref": "#/$defs/joint"}, "minItems": 1},
            }
        ),
        "required": ["joints"],
        "allOf": [_everywhere(name) for name in REQUIRED],
    }


def _joint() -> dict[str, Any]:
    """A joint: the keys that an editor offers, and the other names that tables give them."""
    limits = dict.fromkeys(("lower", "upper", "velocity", "effort"), _NUMBER_OR_NONE)
    tensor = _either(_mapping(dict.fromkeys(INERTIA_FIELDS, _NUMBER)), _list_of(_list_of(_NUMBER, 3), 3))
    offered = {"name" if name == "joint" else name: _value(name) for name in _OF_A_JOINT if name not in _IN_A_GROUP}
    others = {_any_form(FIELDS[name].headers): _value(name) for name in _OF_A_JOINT}
    return {
        **_mapping(
            {**offered, "limits": _mapping(limits), "com": _list_of(_NUMBER, 3), "inertia": tensor, **_meshes()}
        ),
        "patternProperties": others,
    }


def _meshes() -> dict[str, Any]:
    """The keys that hold meshes."""
    about = {"visual": "what is seen", "collision": "what touches", "mesh": "what is seen and touches"}
    return {key: {"$ref": "#/$defs/mesh", "description": f"a mesh file as {about[key]}"} for key in MESH_KEYS}


def _mesh() -> dict[str, Any]:
    file = {"type": "string", "minLength": 1, "description": "a path from the table's folder: STL, OBJ or DAE"}
    scale = _either(_NUMBER, _list_of(_NUMBER, 3))
    return {**_origin(file=file, scale=scale), "required": ["file"]}


def _value(name: str) -> dict[str, Any]:
    if name in ("joint", "link"):
        return _NAME
    if name == "type":
        return _either(_words(TYPE_CHOICES), {"enum": [0, 1]})
    if name == "flip":
        return {"type": ["boolean", "string"]}
    return _NUMBER if name in REQUIRED else _NUMBER_OR_NONE


def _everywhere(name: str) -> dict[str, Any]:
    """A field that every joint has, unless the defaults have it."""
    some_form = {"patternProperties": {_any_form(FIELDS[name].headers): False}}  # valid where no such key is
    has = {"not": some_form}
    return {
        "if": {"properties": {"defaults": some_form}},
        "then": {"properties": {"joints": {"items": has}}},
    }


def _origin(**more: Any) -> dict[str, Any]:  # noqa: ANN401 - schemas
    return _mapping({"xyz": _list_of(_NUMBER, 3), "rpy": _list_of(_NUMBER, 3), **more})


def _units(dimension: Dimension) -> list[str]:
    return [word for word, unit in UNITS.items() if unit.dimension is dimension]


# --- Shorthands of the schema language --------------------------------------------------------------------------------


def _words(words: Iterable[str]) -> dict[str, Any]:
    words = list(words)
    return {"type": "string", "pattern": _any_form(words), "examples": words}


def _any_form(words: Iterable[str]) -> str:
    """A pattern for words in any case and with any separators; JSON Schema's patterns have no flag for case."""
    letters = (re.sub(_BETWEEN_LETTERS, "", word) for word in words)
    forms = "|".join(_BETWEEN_LETTERS.join(map(_any_case, word)) for word in letters)
    return f"^{_BETWEEN_LETTERS}({forms}){_BETWEEN_LETTERS}$"


def _any_case(letter: str) -> str:
    forms = sorted({letter, letter.upper(), letter.lower()})
    return f"[{''.join(forms)}]" if len(forms) > 1 else re.sub(r"([.^$*+?()|{}\[\]\\])", r"\\\1", letter)


def _mapping(properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": properties, "additionalProperties": False}


def _list_of(entry: dict[str, Any], length: int) -> dict[str, Any]:
    return {"type": "array", "items": entry, "minItems": length, "maxItems": length}


def _either(*schemas: dict[str, Any]) -> dict[str, Any]:
    return {"anyOf": list(schemas)}
