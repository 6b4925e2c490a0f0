"""JSON Schema of a table as YAML, for editors: its keys and words are those that the reader knows.

A schema cannot know what the run's options say, so the convention and the units may be absent; it knows no expression
either, so any text may stand for a number.
"""

from __future__ import annotations

import re
import unicodedata
from typing import TYPE_CHECKING, Any

from dh2urdf.quantities import DEGREE_SIGNS, UNITS
from dh2urdf.row_fields import COM, INERTIA, LIMITS
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.readers.header.units import UNIT_KEYS
from dh2urdf_plugins.readers.header.words import SHORTEST_CORE
from dh2urdf_plugins.readers.sources.documents import NOT_IN_A_JOINT
from dh2urdf_plugins.readers.statements.values import MESH_KEYS, SHAPES
from dh2urdf_plugins.readers.words.fields import (
    FIELDS,
    GROUPS,
    IGNORED,
    convention_words,
    key_of,
    spellings,
    type_words,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf_plugins.readers.words.fields import Field

_OF_A_JOINT = tuple(name for name in FIELDS if name not in NOT_IN_A_JOINT)
_IN_A_GROUP = (*LIMITS, *COM, *INERTIA, *GROUPS)
"""Fields that an editor offers in `limits`, `com` and `inertia`; the reader takes them in the joint itself too."""

_BETWEEN_FACTORS = r"[\s·⋅*^.-]*"
"""What the reader overlooks in a unit."""
_OTHER_FORMS = {"2": "[2²]", "3": "[3³]", "°": f"[{DEGREE_SIGNS}]", "μ": "[μµ]", "/": "/"}

_NUMBER = {"type": ["number", "string"]}
_NUMBER_OR_NONE = {"type": ["number", "string", "null"]}
_NAME = {"type": ["string", "number", "boolean"]}
_BETWEEN_LETTERS = r"[\s_.*{}'’-]*"
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
            "payload": _payload(),
            "geometry": _mapping({"shape": {"enum": list(SHAPES)}, "radius": _NUMBER}),
        },
    }


def _table() -> dict[str, Any]:
    geometry = {"$ref": "#/$defs/geometry"}
    units = {
        "anyOf": [
            _mapping({key: _unit_words(key) for key in UNIT_KEYS}),
            {"type": "string"},
            {"type": "array", "items": {"type": "string"}, "minItems": 1},
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
                    **_words(convention_words()),
                    "description": "standard or modified; never guessed",
                },
                "units": units,
                "base": {
                    "anyOf": [_origin(mass=_NUMBER, geometry=geometry, **_meshes()), {"$ref": "#/$defs/transform"}],
                    "description": "base_link to the first DH frame",
                },
                "tool": {"$ref": "#/$defs/transform", "description": "last DH frame to tool0"},
                "payload": {"$ref": "#/$defs/payload", "description": "what the arm carries at tool0"},
                "defaults": {**joint, "properties": defaults},
                "symbols": {"type": "object", "description": "what names in cells stand for: {L1: 91 mm}"},
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
    offered = {"name" if name == "joint" else name: _value(name) for name in _OF_A_JOINT if name not in _IN_A_GROUP}
    groups = {name: _group(name) for name in GROUPS}
    others = {header_pattern(FIELDS[name]): groups.get(name) or _value(name) for name in _OF_A_JOINT}
    return {
        **_mapping({**offered, **groups, **_meshes()}),
        "patternProperties": {**others, f"^{IGNORED}": {}},
    }


def _group(name: str) -> dict[str, Any]:
    """Several fields at once: as a mapping, as a list, or as the text of a cell."""
    text = {"type": ["string", "null"]}
    if name == "limits":
        bounds = _mapping(dict.fromkeys((*LIMITS, "min", "max"), _NUMBER_OR_NONE))
        return _either(bounds, _list_of(_NUMBER_OR_NONE, 2), text)
    if name == "com":
        return _either(_mapping(dict.fromkeys("xyz", _NUMBER)), _list_of(_NUMBER, 3), text)
    return _either(_mapping(dict.fromkeys(INERTIA, _NUMBER)), _list_of(_list_of(_NUMBER, 3), 3), text)


def _payload() -> dict[str, Any]:
    about = {"mass": _NUMBER, "com": _list_of(_NUMBER, 3), "inertia": _tensor()}
    return {**_mapping(about), "required": ["mass"]}


def _tensor() -> dict[str, Any]:
    """The six numbers of an inertia tensor, or its matrix."""
    return _either(_mapping(dict.fromkeys(INERTIA, _NUMBER)), _list_of(_list_of(_NUMBER, 3), 3))


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
        return _either(_words(type_words()), {"enum": [0, 1, 2]})
    if name == "flip":
        return {"type": ["boolean", "string"]}
    return _NUMBER if name in REQUIRED else _NUMBER_OR_NONE


def _everywhere(name: str) -> dict[str, Any]:
    """A field that every joint has, unless the defaults have it."""
    some_form = {"patternProperties": {header_pattern(FIELDS[name]): False}}  # valid where no such key is
    has = {"not": some_form}
    return {
        "if": {"properties": {"defaults": some_form}},
        "then": {"properties": {"joints": {"items": has}}},
    }


def _origin(**more: Any) -> dict[str, Any]:  # noqa: ANN401 - schemas
    matrix = {**_list_of(_list_of(_NUMBER, 4), 4), "description": "in place of xyz and rpy"}
    return _mapping({"xyz": _list_of(_NUMBER, 3), "rpy": _list_of(_NUMBER, 3), "matrix": matrix, **more})


def _unit_words(key: str) -> dict[str, Any]:
    """A unit, or one for each of the dimensions that a key has."""
    known = [word for word, unit in UNITS.items() if unit.dimension in UNIT_KEYS[key]]
    forms = "|".join(_BETWEEN_FACTORS.join(map(_any_form_of_letter, word)) for word in known)
    words = {"type": "string", "pattern": f"^\\s*({forms.replace('/s', '/s(ec)?')})\\s*$", "examples": known}
    several = len(UNIT_KEYS[key])
    return _either(words, {"type": "array", "items": words, "maxItems": several}) if several > 1 else words


# --- Shorthands of the schema language --------------------------------------------------------------------------------


def header_pattern(field: Field) -> str:
    """A pattern for the keys that are read as a field, with the words that may stand around its headers."""
    if not field.around:
        return _any_form(spellings(field))
    cores = [word for word in spellings(field) if len(key_of(word)) >= SHORTEST_CORE]
    around = f"(?:(?:{_forms(field.around)}){_BETWEEN_LETTERS})*"
    exact = _forms(spellings(field))
    return f"^{_BETWEEN_LETTERS}(?:{exact}|{around}(?:{_forms(cores)}){_BETWEEN_LETTERS}{around}){_BETWEEN_LETTERS}$"


def _words(words: Iterable[str]) -> dict[str, Any]:
    words = list(words)
    return {"type": "string", "pattern": _any_form(words), "examples": words}


def _any_form(words: Iterable[str]) -> str:
    """A pattern for words in any case and with any separators; JSON Schema's patterns have no flag for case."""
    return f"^{_BETWEEN_LETTERS}({_forms(words)}){_BETWEEN_LETTERS}$"


def _forms(words: Iterable[str]) -> str:
    letters = dict.fromkeys(re.sub(_BETWEEN_LETTERS, "", word) for word in words)
    return "|".join(_BETWEEN_LETTERS.join(map(_any_case, word)) for word in letters)


def _any_case(letter: str) -> str:
    """A letter in either case, with or without its accent."""
    plain = unicodedata.normalize("NFD", letter)[0]
    forms = sorted({form for each in (letter, plain) for form in (each, each.upper(), each.lower())})
    return f"[{''.join(forms)}]" if len(forms) > 1 else re.sub(r"([.^$*+?()|{}\[\]\\])", r"\\\1", letter)


def _any_form_of_letter(letter: str) -> str:
    return _OTHER_FORMS.get(letter) or _any_case(letter)


def _mapping(properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": properties, "additionalProperties": False}


def _list_of(entry: dict[str, Any], length: int) -> dict[str, Any]:
    return {"type": "array", "items": entry, "minItems": length, "maxItems": length}


def _either(*schemas: dict[str, Any]) -> dict[str, Any]:
    return {"anyOf": list(schemas)}
