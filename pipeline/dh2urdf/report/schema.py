"""JSON Schemas (2020-12) of what a run tells, and of what commands print with `--json`.

They are made of the types in `dh2urdf.results`: a key's type, whether it is always there, and its annotations.
"""

from __future__ import annotations

import operator
from functools import partial, reduce
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, NotRequired, Union, get_args, get_origin, get_type_hints, is_typeddict

from dh2urdf import results
from dh2urdf.results import DIALECT

_WORDS = {str: "string", int: "integer", float: "number", bool: "boolean"}
_Names = dict[Any, str]
_PROBLEM: _Names = {results.ProblemEntry: "problem"}
_PARTS: _Names = {results.FileEntry: "file", results.MeshEntry: "mesh", results.ProofEntry: "proof"}
_PARTS |= {results.LoadEntry: "load", **_PROBLEM}


def _schema_of(kind: type, title: str, named: _Names) -> dict[str, Any]:
    """The schema of one type, with definitions of its parts that have a name."""
    schema = {"$schema": DIALECT, "title": title, **_object(kind, named)}
    return schema | ({"$defs": {name: _object(part, named) for part, name in named.items()}} if named else {})


report_schema = partial(
    _schema_of, results.RunReport, "report.json of dh2urdf", {results.ManipulatorEntry: "row", **_PARTS}
)
manifest_schema = partial(_schema_of, results.ManipulatorEntry, "a line of manifest.jsonl of dh2urdf", _PARTS)
plugins_schema = partial(_schema_of, results.PluginsReport, "dh2urdf plugins --json", {})
conversions_schema = partial(_schema_of, results.ConversionsReport, "dh2urdf convert --json", _PROBLEM)
info_schema = partial(_schema_of, results.InfoReport, "dh2urdf info --json", _PROBLEM)
error_schema = partial(_schema_of, results.ErrorReport, "an error of dh2urdf with --json", _PROBLEM)


def _object(kind: type, named: _Names) -> dict[str, Any]:
    """An object with the keys of a type, and no others."""
    hints = get_type_hints(kind, include_extras=True)
    optional = {key: get_args(hint)[0] for key, hint in hints.items() if get_origin(hint) is NotRequired}
    needs: dict[str, list[str]] = {}
    for key, hint in optional.items():
        if others := [note.key for note in getattr(hint, "__metadata__", ()) if isinstance(note, results.Along)]:
            needs[key] = others
    return {
        "type": "object",
        "properties": {key: _value(optional.get(key, hint), named) for key, hint in hints.items()},
        "required": [key for key in hints if key not in optional],
        "additionalProperties": False,
        **({"dependentRequired": needs} if needs else {}),
    }


def _value(hint: Any, named: _Names) -> dict[str, Any]:  # noqa: ANN401, PLR0911 - any type
    """A value of a type; keywords of a value that may be null apply to its other type."""
    kind, arguments = get_origin(hint), get_args(hint)
    if kind is Annotated:
        schema = _value(arguments[0], named)
        said = schema["anyOf"][0] if "anyOf" in schema else schema
        notes = [results.Keyword("description", note) if isinstance(note, str) else note for note in hint.__metadata__]
        said |= {note.name: note.value for note in notes if isinstance(note, results.Keyword)}
        return schema
    if NoneType in arguments:
        others = [part for part in arguments if part is not NoneType]
        return {"anyOf": [_value(reduce(operator.or_, others), named), {"type": "null"}]}
    if hint in named:
        return {"$ref": f"#/$defs/{named[hint]}"}
    if is_typeddict(hint):
        return _object(hint, named)
    if kind is Literal:
        return {"const": arguments[0]} if len(arguments) == 1 else {"enum": list(arguments)}
    if kind is list:
        return {"type": "array", "items": _value(arguments[0], named)}
    if kind is dict:
        inner = _value(arguments[1], named)
        return {"type": "object", "additionalProperties": inner} if inner else {"type": "object"}
    if kind in (Union, UnionType):
        return {"type": [_WORDS[part] for part in arguments]}
    return {} if hint is Any else {"type": _WORDS[hint]}
