"""The types of plain data say what the JSON Schemas say: every key, its type, and whether it is always there."""

from __future__ import annotations

import subprocess
import sys
from types import NoneType, UnionType
from typing import Any, Literal, NotRequired, Union, get_args, get_origin, get_type_hints, is_typeddict

import pytest

from dh2urdf import results
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.report.answers.schemas import conversions_schema, error_schema, info_schema
from dh2urdf.report.schema import manifest_schema, plugins_schema, report_schema

PLAIN = {"string": str, "integer": int, "number": float, "boolean": bool}
REPORTS = {
    results.RunReport: report_schema,
    results.ManipulatorEntry: manifest_schema,
    results.PluginsReport: plugins_schema,
    results.ErrorReport: error_schema,
    results.InfoReport: info_schema,
    results.ConversionsReport: conversions_schema,
}


def differences(hint: Any, schema: dict[str, Any], defs: dict[str, Any], place: str) -> list[str]:
    """Where a type and a schema do not say the same."""
    if "$ref" in schema:
        schema = defs[schema["$ref"].rpartition("/")[2]]
    if get_origin(hint) is NotRequired:
        (hint,) = get_args(hint)
    wrong = [f"{place}: {hint} and {schema}"]
    if "anyOf" in schema:
        *others, null = schema["anyOf"]
        parts = [part for part in get_args(hint) if part is not NoneType]
        if len(others) != 1 or null != {"type": "null"} or len(parts) != len(get_args(hint)) - 1:
            return wrong
        return differences(parts[0] if len(parts) == 1 else Union[tuple(parts)], others[0], defs, place)  # noqa: UP007
    if is_typeddict(hint):
        return differences_of_keys(hint, schema, defs, place) if "properties" in schema else wrong
    inner, of_inner = inner_of(hint, schema)
    if inner is not None and of_inner is not None:
        return differences(inner, of_inner, defs, f"{place}.*")
    return [] if is_simply(hint, schema) else wrong


def inner_of(hint: Any, schema: dict[str, Any]) -> tuple[Any, dict[str, Any] | None]:
    """The type and the schema of what is in a list or in a mapping from texts; None in place of any other."""
    kind, arguments = get_origin(hint), get_args(hint)
    if kind is list and schema.get("type") == "array":
        return arguments[0], schema["items"]
    if kind is dict and arguments[0] is str and schema.get("type") == "object":
        return arguments[1], schema.get("additionalProperties")
    return None, None


def is_simply(hint: Any, schema: dict[str, Any]) -> bool:
    """Whether a type that has no others in it is that of a schema."""
    kind = schema.get("type")
    if "const" in schema or "enum" in schema:
        words = schema.get("enum", [schema.get("const")])
        return get_origin(hint) is Literal and sorted(map(str, get_args(hint))) == sorted(map(str, words))
    if isinstance(kind, list):
        return get_origin(hint) in (UnionType, Union) and set(get_args(hint)) == {PLAIN[word] for word in kind}
    if kind == "object":  # whose keys nobody lists
        return get_origin(hint) is dict and get_args(hint) == (str, Any)
    return hint is (PLAIN.get(kind) if kind else Any)


def differences_of_keys(hint: Any, schema: dict[str, Any], defs: dict[str, Any], place: str) -> list[str]:
    hints = get_type_hints(hint, include_extras=True)
    found = [f"{place}.{key} is in one of them" for key in hints.keys() ^ schema["properties"].keys()]
    required = {key for key, each in hints.items() if get_origin(each) is not NotRequired}
    found += [f"{place}.{key} is required in one of them" for key in required ^ set(schema["required"])]
    assert schema["additionalProperties"] is False
    for key in hints.keys() & schema["properties"].keys():
        found += differences(hints[key], schema["properties"][key], defs, f"{place}.{key}")
    return found


@pytest.mark.parametrize("report", REPORTS, ids=lambda report: report.__name__)
def test_a_type_says_what_its_schema_says(report: Any) -> None:
    """At every depth."""
    schema = REPORTS[report]()
    assert differences(report, schema, schema.get("$defs", {}), report.__name__) == []


@pytest.mark.parametrize(
    ("key", "changed"),
    [
        ("left_out", {"type": "string"}),
        ("left_out", {"anyOf": [{"type": "integer"}, {"type": "null"}]}),
        ("version", {"enum": ["1"]}),
        ("exit_status", {"enum": [0, 1, 2]}),
        ("manipulators", {"type": "array", "items": {"type": "string"}}),
        ("manipulators", {"type": "object", "additionalProperties": {"$ref": "#/$defs/row"}}),
        ("more", {"type": "string"}),
    ],
)
def test_a_difference_is_found(key: str, changed: dict[str, Any]) -> None:
    """A schema with another key, another type or another word is not the type's."""
    schema = report_schema()
    schema["properties"][key] = changed
    assert differences(results.RunReport, schema, schema["$defs"], "report")
    schema = report_schema()
    schema["required"].remove("left_out")
    assert differences(results.RunReport, schema, schema["$defs"], "report") == [
        "report.left_out is required in one of them"
    ]


def test_names_are_those_of_the_records() -> None:
    """The words for conventions, joint types and kinds of stages."""
    assert get_args(results.ConventionName) == tuple(Convention)
    assert get_args(results.JointTypeName) == tuple(JointType)
    assert get_args(results.KindName) == KINDS


def test_importing_dh2urdf_does_not_import_them() -> None:
    """They are there for type checkers, and for those who ask."""
    code = "import sys, dh2urdf; dh2urdf.read; dh2urdf.run; print('dh2urdf.results' in sys.modules); dh2urdf.results"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.split() == ["False"]
