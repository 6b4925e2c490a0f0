"""JSON Schemas (2020-12) of what a run tells, and of what commands print with `--json`.

They are made of the types in `dh2urdf.results`: a key's type, whether it is always there, and its annotations.
"""

from __future__ import annotations

import operator
from functools import reduce
from types import NoneType, UnionType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Literal,
    NotRequired,
    Union,
    get_args,
    get_origin,
    get_type_hints,
    is_typeddict,
)

from dh2urdf import results
from dh2urdf.run_file.schema import DIALECT

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

_WORDS = {str: "string", int: "integer", float: "number", bool: "boolean"}
_PROBLEM = {results.ProblemEntry: "problem"}
_PARTS = {
    results.FileEntry: "file",
    results.MeshEntry: "mesh",
    results.ProofEntry: "proof",
    results.LoadEntry: "load",
    results.ProblemEntry: "problem",
}


def report_schema() -> dict[str, Any]:
    """The schema of `report.json`."""
    return _schema_of(results.RunReport, "report.json of dh2urdf", {results.ManipulatorEntry: "row", **_PARTS})


def manifest_schema() -> dict[str, Any]:
    """The schema of a line of `manifest.jsonl`."""
    return _schema_of(results.ManipulatorEntry, "a line of manifest.jsonl of dh2urdf", _PARTS)


def plugins_schema() -> dict[str, Any]:
    """The schema of what `dh2urdf plugins --json` prints."""
    return _schema_of(results.PluginsReport, "dh2urdf plugins --json", {})


def conversions_schema() -> dict[str, Any]:
    """The schema of what `dh2urdf convert --json` prints."""
    return _schema_of(results.ConversionsReport, "dh2urdf convert --json", _PROBLEM)


def info_schema() -> dict[str, Any]:
    """The schema of what `dh2urdf info --json` prints."""
    return _schema_of(results.InfoReport, "dh2urdf info --json", _PROBLEM)


def error_schema() -> dict[str, Any]:
    """The schema of what a command with `--json` prints where it fails."""
    return _schema_of(results.ErrorReport, "an error of dh2urdf with --json", _PROBLEM)


def _schema_of(kind: type, title: str, named: Mapping[Any, str]) -> dict[str, Any]:
    """The schema of one type, with definitions of its parts that have a name."""
    schema = {"$schema": DIALECT, "title": title, **_object(kind, named)}
    return schema | ({"$defs": {name: _object(part, named) for part, name in named.items()}} if named else {})


def _object(kind: type, named: Mapping[Any, str]) -> dict[str, Any]:
    """An object with the keys of a type, and no others."""
    hints = get_type_hints(kind, include_extras=True)
    along = {key: list(_along(hint)) for key, hint in hints.items()}
    needs = {key: others for key, others in along.items() if others}
    return {
        "type": "object",
        "properties": {key: _value(hint, named) for key, hint in hints.items()},
        "required": [key for key, hint in hints.items() if get_origin(hint) is not NotRequired],
        "additionalProperties": False,
        **({"dependentRequired": needs} if needs else {}),
    }


def _along(hint: Any) -> Iterable[str]:  # noqa: ANN401 - any type
    """The keys without which a key is not there."""
    (inner,) = get_args(hint) if get_origin(hint) is NotRequired else (hint,)
    return (note.key for note in getattr(inner, "__metadata__", ()) if isinstance(note, results.Along))


def _value(hint: Any, named: Mapping[Any, str]) -> dict[str, Any]:  # noqa: ANN401 - any type
    """A value of a type; keywords of a value that may be null apply to its other type."""
    kind, arguments = get_origin(hint), get_args(hint)
    if kind is NotRequired:
        return _value(arguments[0], named)
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
    return _plain(hint, kind, arguments, named)


def _plain(hint: Any, kind: Any, arguments: tuple[Any, ...], named: Mapping[Any, str]) -> dict[str, Any]:  # noqa: ANN401
    """A word, a list, a mapping of any keys, or a number or text."""
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
