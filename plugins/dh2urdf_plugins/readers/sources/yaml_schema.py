"""JSON Schema of a table as YAML, for editors: its keys and words are those that the reader knows.

`table_schema.yaml` is the schema without the vocabulary. A schema cannot know the options of a run, so the convention
and the units may be absent; it knows no expression either, so any text may be a number.
"""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from dh2urdf.columns import COM, INERTIA, LIMITS
from dh2urdf.quantities import DEGREE_SIGNS, UNITS
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.readers.header.units import UNIT_KEYS
from dh2urdf_plugins.readers.header.words import SHORTEST_CORE
from dh2urdf_plugins.readers.sources.documents import NOT_IN_A_JOINT
from dh2urdf_plugins.readers.statements.values import MESH_KEYS, SHAPES
from dh2urdf_plugins.readers.words.fields import FIELDS, GROUPS, IGNORED, key_of, keys_of, words_for

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf_plugins.readers.words.fields import Field

_KINDS = dict.fromkeys(("joint", "link"), "name") | dict.fromkeys(REQUIRED, "number")
_KINDS |= {name: name for name in ("type", "flip", "follows", *GROUPS)}
"""The definition of each field's value; that of the others is a number, or none."""
_BETWEEN_FACTORS = r"[\s·⋅*^.-]*"
"""What the reader overlooks in a unit."""
_OTHER_FORMS = {"2": "[2²]", "3": "[3³]", "°": f"[{DEGREE_SIGNS}]", "μ": "[μµ]", "/": "/"}
_BETWEEN_LETTERS = r"[\s_.*{}'’-]*"
"""What the reader overlooks in a key or word."""


def table_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of a table, or of a list of them under `robots`."""
    schema: dict[str, Any] = yaml.safe_load(Path(__file__).with_name("table_schema.yaml").read_text("utf-8"))
    known = schema["$defs"]
    joint, table = known["joint"], known["table"]
    names = [name for name in FIELDS if name not in NOT_IN_A_JOINT]
    values = {name: {"$ref": f"#/$defs/{_KINDS.get(name, 'number_or_none')}"} for name in names}
    # An editor offers the parts of limits, com and inertia there alone; the reader accepts them in the joint, too.
    offered = [name for name in names if name not in (*LIMITS, *COM, *INERTIA, *GROUPS)]
    joint["properties"] = {"name" if name == "joint" else name: values[name] for name in offered} | joint["properties"]
    joint["patternProperties"] = {header_pattern(FIELDS[name]): values[name] for name in names} | {f"^{IGNORED}": {}}
    shared = {key: value for key, value in joint["properties"].items() if key not in MESH_KEYS}
    defaults = table["properties"]["defaults"]
    defaults["properties"] = shared | defaults["properties"]
    defaults["patternProperties"] = joint["patternProperties"]
    table["properties"]["convention"] |= _words(words_for("conventions"))
    table["properties"]["units"]["anyOf"][0]["properties"] = {key: _unit_words(key) for key in UNIT_KEYS}
    table["allOf"] = []
    for name in REQUIRED:  # which every joint has, unless the defaults have it
        some_form = {"patternProperties": {header_pattern(FIELDS[name]): False}}  # valid where no such key is
        missing = {"properties": {"joints": {"items": {"not": some_form}}}}
        table["allOf"].append({"if": {"properties": {"defaults": some_form}}, "then": missing})
    known["type"]["anyOf"][0] = _words(words_for("types"))
    known["geometry"]["properties"]["shape"] = {"enum": list(SHAPES)}
    return schema


def _unit_words(key: str) -> dict[str, Any]:
    """A unit, or one for each of the dimensions that a key has."""
    known = [word for word, unit in UNITS.items() if unit.dimension in UNIT_KEYS[key]]
    letters = ([_OTHER_FORMS.get(letter) or _any_case(letter) for letter in word] for word in known)
    forms = "|".join(map(_BETWEEN_FACTORS.join, letters)).replace("/s", "/s(ec)?")
    words = {"type": "string", "pattern": f"^\\s*({forms})\\s*$", "examples": known}
    several = len(UNIT_KEYS[key])
    return {"anyOf": [words, {"type": "array", "items": words, "maxItems": several}]} if several > 1 else words


# --- Patterns of words ------------------------------------------------------------------------------------------------


def _spellings(field: Field) -> list[str]:
    """The headers of a field: each as it is written, and with ``ae`` for ``ä``."""
    return [form for word in field.words for form in dict.fromkeys((word, *sorted(keys_of(word))))]


def header_pattern(field: Field) -> str:
    """A pattern for the keys that are read as a field, with the words that may stand around its headers."""
    if not field.around:
        return _any_form(_spellings(field))
    cores = [word for word in _spellings(field) if len(key_of(word)) >= SHORTEST_CORE]
    around = f"(?:(?:{_forms(field.around)}){_BETWEEN_LETTERS})*"
    exact = _forms(_spellings(field))
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
