"""JSON Schemas of run files and of tables, from the stages that are installed: editors complete and check with them.

A schema knows types, not texts: where a text is wanted, the program also takes the bare number ``007`` as its text,
and the schema asks for quotes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import ConfigError
from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.plugin_system.option_types import measures_of, type_hints
from dh2urdf.run_file.sections import RUN_FILE
from dh2urdf.run_file.stage_records import stage_names, usual_name
from dh2urdf.run_file.value_types import NUMBER
from dh2urdf.stage_calls.answers import a_record
from dh2urdf.stage_calls.calls import Call, depending_on

if TYPE_CHECKING:
    from dh2urdf.plugin_system.catalog import Catalog, Provided
    from dh2urdf.stages import Kind

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def run_schema(catalog: Catalog) -> dict[str, Any]:
    """The JSON Schema (2020-12) of a run file, for the stages that are installed."""
    options: dict[str, Any] = {}
    for kind in KINDS:
        named = stage_names(catalog, kind)
        for item in catalog.provided(kind):
            options |= _options_schemas(item, f"{kind}.{named[item.full_name][0]}")
    schema = RUN_FILE.schema(catalog)
    sections = schema["properties"]
    usual: dict[str, Kind] = {"transform": "transform", "emitters": "emitter", "execution": "executor"}
    for section, kind in usual.items():
        sections[section]["description"] += f"; {usual_name(catalog, kind)} by default"
    for section, description in sections.items():
        if section not in schema["required"]:
            sections[section] = {"anyOf": [description, {"type": "null"}]}
    return {"$schema": DIALECT, "title": "run file of dh2urdf", **schema, "$defs": options}


def table_schema(catalog: Catalog) -> dict[str, Any]:
    """The JSON Schema (2020-12) of a table, as the readers that have one give it.

    Raises:
        ConfigError: no reader has one.
    """
    schemas = {}
    for item in catalog.provided("reader"):
        reader: Any = item.stage
        if reader.schema:
            with depending_on(Call(stage=reader, options=None, plugin=item.plugin), "schema"):
                schemas[item.full_name] = a_record(reader.schema(), dict)
    if not schemas:
        raise ConfigError("no reader that is installed has a schema of its tables")
    if len(schemas) == 1:
        return next(iter(schemas.values()))
    # An $id of its own lets the references inside each schema go to its own definitions.
    return {
        "$schema": DIALECT,
        "anyOf": [{**schema, "$id": f"urn:dh2urdf:table:{name}"} for name, schema in schemas.items()],
    }


def _options_schemas(item: Provided, name: str) -> dict[str, Any]:
    """The definitions that a stage's options need, their own first."""
    from pydantic import TypeAdapter
    from pydantic.errors import PydanticUserError

    stage = item.stage
    try:
        schema = TypeAdapter(stage.options).json_schema(ref_template=f"#/$defs/{name}.{{model}}")
    except (PydanticUserError, NameError):  # The program refuses such a stage when it is used; a schema says nothing.
        return {name: {"type": "object"}}
    inner = schema.pop("$defs", {})
    schema.pop("title", None)
    schema["description"] = stage.summary
    helps = {field.name: field.metadata.get("help") for field in stage.options.__dataclass_fields__.values()}
    measures = measures_of(stage.options)
    for option in type_hints(stage.options):
        described = schema["properties"][option]
        described.pop("title", None)
        if helps[option]:
            described["description"] = helps[option]
        if option in measures:
            _take_texts(described)
    definitions = {name: schema, **{f"{name}.{model}": definition for model, definition in inner.items()}}
    for definition in definitions.values():
        if definition.get("type") == "object":
            definition["additionalProperties"] = False
    return definitions


def _take_texts(schema: dict[str, Any]) -> None:
    """Let what takes a number take the text of an expression with units, too."""
    if schema.get("type") == "number":
        schema |= NUMBER
    for part in (*schema.get("anyOf", ()), *schema.get("prefixItems", ()), schema.get("items")):
        if isinstance(part, dict):
            _take_texts(part)
