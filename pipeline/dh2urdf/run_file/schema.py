"""JSON Schemas of run files and of tables, from the stages that are installed: editors complete and check with them.

A schema knows types, not texts: where a text is wanted, the program also takes the bare number ``007`` as its text,
and the schema asks for quotes.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import fields
from types import NoneType
from typing import TYPE_CHECKING, Any, TypeAlias, get_args, get_origin

from dh2urdf.errors import ConfigError, UnknownStageError
from dh2urdf.plugin_system.calls import Call, a_record, depending_on
from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.plugin_system.option_types import NUMBER, keys_of, members, records_of
from dh2urdf.plugin_system.validator import adapter_of
from dh2urdf.results import DIALECT
from dh2urdf.run_file import sections as keys
from dh2urdf.source import Messages
from dh2urdf.stages import HasSchema

if TYPE_CHECKING:
    from dh2urdf.plugin_system.catalog import Catalog, Provided
    from dh2urdf.stages import Kind

say = Messages(__file__)

JsonSchema: TypeAlias = dict[str, Any]
NULL = {"type": "null"}
KIND_OF: dict[str, Kind] = {
    "inputs": "reader",
    "transform": "transform",
    "edits": "edit",
    "emitters": "emitter",
    "loaders": "loader",
    "execution": "executor",
}
"""The kind of the stages in a section."""


def run_schema(catalog: Catalog) -> JsonSchema:
    """The JSON Schema (2020-12) of a run file, for the stages that are installed."""
    options: JsonSchema = {}
    for kind in KINDS:
        named = stage_names(catalog, kind)
        for item in catalog.provided(kind):
            options |= _options_schemas(item, f"{kind}.{named[item.full_name][0]}")
    schema = section_schema(keys.RunFile)
    sections = schema["properties"]
    for section, kind in KIND_OF.items():
        entry = sections[section]["anyOf"][0]
        _add_stages(entry["anyOf"] if "anyOf" in entry else sections[section]["anyOf"], section, kind, catalog)
        if section in {"transform", "emitters", "execution"}:
            sections[section]["description"] += f"; {usual_name(catalog, kind)} by default"
    sections |= {name: {"anyOf": [each, NULL]} for name, each in sections.items() if name not in schema["required"]}
    return {"$schema": DIALECT, "title": "run file of dh2urdf", **schema, "$defs": options}


def table_schema(catalog: Catalog) -> JsonSchema:
    """The JSON Schema (2020-12) of a table, as the readers that have one give it."""
    schemas = {}
    for item in catalog.provided("reader"):
        if its := item.stage.can(HasSchema):
            with depending_on(Call(stage=item.stage, options=None, plugin=item.plugin), "schema"):
                schemas[item.full_name] = a_record(its.schema(), dict)
    if not schemas:
        raise ConfigError(say("no-schema-of-tables"))
    if len(schemas) == 1:
        return next(iter(schemas.values()))
    # An $id of its own lets the references inside each schema go to its own definitions.
    return {
        "$schema": DIALECT,
        "anyOf": [{**schema, "$id": f"urn:dh2urdf:table:{name}"} for name, schema in schemas.items()],
    }


# --- Sections ---------------------------------------------------------------------------------------------------------


def section_schema(kind: type[Any]) -> JsonSchema:
    """The JSON Schema of a section as people write it, with its short form and without references."""
    defaults = {field.name: field.default for field in fields(kind)}
    properties = {}
    for name, key in keys_of(kind).items():
        properties[name] = _value(key.hint)
        if key.help:
            properties[name]["description"] = key.help
        if isinstance(default := defaults.get(name), (str, int, float)):
            properties[name]["default"] = getattr(default, "value", default)
        if key.measures:
            _take_texts(properties[name])
    if issubclass(kind, keys.LawSection):
        told = {"description": properties["grid"].pop("description")}
        spaced = {"anyOf": [properties["grid"], section_schema(keys.SpacedSection)], **told}
        properties |= {"grid": spaced, "normal": properties["normal"] | section_schema(keys.NormalSection)}
    mapping: JsonSchema = {"type": "object", "properties": properties, "additionalProperties": False}
    if needed := [name for name, key in keys_of(kind).items() if key.is_needed]:
        mapping["required"] = needed
    mapping |= keys.LAW_ALSO if issubclass(kind, keys.LawSection) else {}
    mapping |= keys.RULE_ALSO if kind is keys.RuleSection else {}
    return {"anyOf": [properties[keys.SHORT_FORMS[kind]], mapping]} if kind in keys.SHORT_FORMS else mapping


def _value(hint: Any) -> JsonSchema:  # noqa: ANN401 - a type
    """The JSON Schema of a value: a record is a section, pydantic knows the others, and none needs no words."""
    (kind, *others) = [member for member in members(hint) if member is not NoneType]
    if others and records_of(hint):
        return {"anyOf": [_value(member) for member in (kind, *others)]}
    inner = get_args(kind)
    if get_origin(kind) is tuple and records_of(inner[0]):
        entry, least = section_schema(inner[0]), adapter_of(hint).json_schema().get("minItems", 0)
        return {"anyOf": [entry, {"type": "array", "items": entry, "minItems": least}]}
    if get_origin(kind) is dict and records_of(inner[1]):
        return {"type": "object", "additionalProperties": section_schema(inner[1])}
    if records_of(kind):
        return section_schema(kind)
    schema = adapter_of(hint).json_schema()
    kinds = [each for each in schema.pop("anyOf", ()) if each != NULL]
    schema |= kinds[0] if len(kinds) == 1 else {"anyOf": kinds} if kinds else {}
    return {key: value for key, value in schema.items() if key not in {"title", "description"}}


# --- Stages -----------------------------------------------------------------------------------------------------------


def _add_stages(forms: list[JsonSchema], section: str, kind: Kind, catalog: Catalog) -> None:
    """Name the stages that are installed, each with its options, in the short form and the long form of a stage."""
    call = forms[1]
    named = stage_names(catalog, kind)
    own = call["properties"]["stage"].get("description") if kind == "reader" else None
    # An editor proposes the short names first.
    names = sorted({name for names in named.values() for name in names}, key=lambda name: (":" in name, name))
    call["properties"]["stage"] = stage = {"enum": names, "description": own or keys.SECTIONS[section].help}
    is_needed = {"required": ["stage"]}
    usual = None if kind == "reader" or "required" in call else usual_name(catalog, kind)
    conditions: list[JsonSchema] = []
    for item in catalog.provided(kind):
        own_names = named[item.full_name]
        condition: JsonSchema = {"properties": {"stage": {"enum": own_names}}}
        condition |= {} if usual in own_names else is_needed
        if suffixes := "|".join(suffix.replace(".", r"\.") for suffix in getattr(item.stage, "suffixes", ())):
            by_suffix = {"properties": {"path": {"pattern": f"({suffixes})$"}}, "not": is_needed}
            condition = {"anyOf": [condition, by_suffix]} if kind == "reader" else condition
        options = {"anyOf": [{"$ref": f"#/$defs/{kind}.{own_names[0]}"}, NULL]}
        conditions.append({"if": condition, "then": {"properties": {"options": options}}})
    if conditions or kind == "reader":
        call["allOf"] = conditions
    if kind != "reader":
        forms[0] = stage
        call |= is_needed if usual is None else {}


def stage_names(catalog: Catalog, kind: Kind) -> dict[str, list[str]]:
    """How each stage of a kind may be named, by its full name: its own name does where that chooses it."""
    chosen = {name: item.full_name for name, item in catalog.by_name(kind).items()}
    names = {item.full_name: item.stage.name for item in catalog.provided(kind)}
    return {
        full_name: [name, full_name] if chosen.get(name) == full_name else [full_name]
        for full_name, name in names.items()
    }


def usual_name(catalog: Catalog, kind: Kind) -> str | None:
    """The name of the stage that is taken where none is named; None where every plugin that has one is left out."""
    with suppress(UnknownStageError):
        return catalog.usual(kind).name
    return None


def _options_schemas(item: Provided, name: str) -> JsonSchema:
    """The definitions that a stage's options need, their own first."""
    from pydantic.errors import PydanticUserError

    stage = item.stage
    try:
        schema = adapter_of(stage.options).json_schema(ref_template=f"#/$defs/{name}.{{model}}")
    except (PydanticUserError, NameError):  # The program refuses such a stage when it is used; a schema says nothing.
        return {name: {"type": "object"}}
    inner = schema.pop("$defs", {})
    schema.pop("title", None)
    schema["description"] = stage.summary
    for option, key in keys_of(stage.options).items():
        described = schema["properties"][option]
        described.pop("title", None)
        if key.help:
            described["description"] = key.help
        if key.measures:
            _take_texts(described)
        if key.others:
            del schema["properties"][option]
            schema["additionalProperties"] = described["additionalProperties"] | {"description": key.help}
    definitions = {name: schema, **{f"{name}.{model}": definition for model, definition in inner.items()}}
    for definition in definitions.values():
        if definition.get("type") == "object":
            definition.setdefault("additionalProperties", False)
    return definitions


def _take_texts(schema: JsonSchema) -> None:
    """Let what takes a number take the text of an expression with units, too."""
    if schema.get("type") == "number":
        schema |= NUMBER
    inner = (schema.get("items"), schema.get("additionalProperties"))
    for part in (*schema.get("anyOf", ()), *schema.get("prefixItems", ()), *inner):
        if isinstance(part, dict):
            _take_texts(part)
