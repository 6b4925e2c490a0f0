"""JSON Schemas of run files and of tables, from the stages that are installed: editors complete and check with them.

A schema knows types, not texts: where a text is wanted, the program also takes the bare number ``007`` as its text,
and the schema asks for quotes.
"""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

from dh2urdf.conversion.one_manipulator import Sample
from dh2urdf.errors import ConfigError, UnknownStageError
from dh2urdf.meshes.conversion import ACCEPTED
from dh2urdf.meshes.files import FILE, RELATIVE
from dh2urdf.meshes.forms import MeshConversion
from dh2urdf.output.layouts import DEFAULT_SIZE, LARGEST, Form
from dh2urdf.plugin_system.calls import Call, depending_on
from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.plugin_system.option_types import type_hints
from dh2urdf.plugin_system.stage_answers import a_record
from dh2urdf.run_file.config import MAX_POSES
from dh2urdf.run_file.mesh_section import SHAPE_KEYS
from dh2urdf.run_file.records import DEFAULT_POSES
from dh2urdf.run_file.settings import DEFAULT_SAMPLE, DEFAULT_TIME_LIMIT, MOST
from dh2urdf.run_file.variation_section import LAWS, MOST_SEED, MOST_VALUES
from dh2urdf.variations.sampling import MOST_POINTS, Sampling
from dh2urdf.variations.variation import AXES, FIELDS

if TYPE_CHECKING:
    from dh2urdf.plugin_system.catalog import Catalog, Provided
    from dh2urdf.stages import Kind

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def run_schema(catalog: Catalog) -> dict[str, Any]:
    """The JSON Schema (2020-12) of a run file, for the stages that are installed."""
    options: dict[str, Any] = {}
    for kind in KINDS:
        named = _names(catalog, kind)
        for item in catalog.provided(kind):
            options |= _options_schemas(item, f"{kind}.{named[item.full_name][0]}")
    inputs = _either(_text("a table, or a pattern such as tables/*.csv"), _input(catalog))
    transform, emitter, executor = (_usual(catalog, kind) for kind in ("transform", "emitter", "executor"))
    sections = {
        "inputs": _one_or_more(inputs, "the tables that are read"),
        "cells": _one_or_more(_cell(), "robots of several arms, with one root; none by default", least=0),
        "variations": _one_or_more(_variation(), "manipulators drawn from others; none by default", least=0),
        "meshes": _one_or_more(_meshes(), "mesh files that links are seen as and touch with; none by default", least=0),
        "transform": _stage(catalog, "transform", "what makes a robot of a table", transform)
        | {"description": f"what makes a robot of a table; {transform} by default"},
        "edits": _one_or_more(
            _stage(catalog, "edit", "what changes the tables before, or the robots after"),
            "what changes the tables before the transform, or the robots after it, in order; none by default",
            least=0,
        ),
        "emitters": _one_or_more(
            _stage(catalog, "emitter", "what writes files", emitter), f"what writes files; {emitter} by default"
        ),
        "loaders": _one_or_more(
            _stage(
                catalog,
                "loader",
                "what loads the files",
                optional={
                    "type": "boolean",
                    "default": False,
                    "description": "whether a refusal, or a missing program, is a notice and fails nothing",
                },
            ),
            "what loads the files; none by default",
            least=0,
        ),
        "output": _either(_text("where the output goes"), _output())
        | {"description": "where the output goes: a folder or an address, alone or with its layout"},
        "execution": _stage(
            catalog,
            "executor",
            "what does the work",
            executor,
            time_limit={
                "type": "number",
                "exclusiveMinimum": 0,
                "default": DEFAULT_TIME_LIMIT,
                "description": "seconds that one manipulator may take, simulators aside",
            },
        )
        | {"description": f"what does the work; {executor} by default"},
        "proof": _mapping(
            {
                "poses": _whole(1, MAX_POSES)
                | {
                    "default": DEFAULT_POSES,
                    "description": "random joint vectors at which each file is compared with its table",
                },
                **_sample(Sample(), "are compared with their tables"),
            }
        )
        | {"description": "how much is compared with the tables; all by default"},
        "sample": _mapping(_sample(DEFAULT_SAMPLE, "go through expansion of xacro and simulators"))
        | {"description": "how much goes through what is slow"},
        "report": _mapping(
            {
                "html": {
                    "type": "boolean",
                    "default": True,
                    "description": "whether report.html is written, where jinja2 and matplotlib are installed",
                },
                "directory": _text(
                    "where report, manifest and index go: a folder or an address; by default that of the output, or "
                    "one beside it where the output is folders of packages"
                ),
            }
        )
        | {"description": "what is told of the run"},
    }
    return {
        "$schema": DIALECT,
        "title": "run file of dh2urdf",
        **_mapping({name: _or_null(section) for name, section in sections.items()} | {"inputs": sections["inputs"]}),
        "required": ["inputs"],
        "$defs": options,
    }


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


def _names(catalog: Catalog, kind: Kind) -> dict[str, list[str]]:
    """How each stage of a kind may be named, by its full name: its own name does where that chooses it."""
    chosen = {name: item.full_name for name, item in catalog.by_name(kind).items()}
    names = {item.full_name: item.stage.name for item in catalog.provided(kind)}
    return {
        full_name: [name, full_name] if chosen.get(name) == full_name else [full_name]
        for full_name, name in names.items()
    }


def _output() -> dict[str, Any]:
    names = {
        "type": "string",
        "pattern": f"^({RELATIVE}|{FILE}|package://.+)$",
        "default": RELATIVE,
        "description": "how descriptions name mesh files: relative, file or package://NAME",
    }
    convert = {"enum": list(MeshConversion), "default": MeshConversion.NEVER, "description": ACCEPTED}
    return _mapping(
        {
            "directory": _text("a folder, from that of the run file, or an address such as s3://bucket/prefix"),
            "layout": {
                "enum": [form.value for form in Form],
                "default": Form.FILES.value,
                "description": "one folder, folders of `size` manipulators, or tar shards of as many",
            },
            "size": _whole(1, LARGEST)
            | {"default": DEFAULT_SIZE, "description": "manipulators in one folder or shard"},
            "meshes": _either(names, _mapping({"names": names, "convert": convert})),
        }
    )


def _sample(default: Sample, what: str) -> dict[str, Any]:
    return {
        "first": _whole(0, MOST)
        | {"default": default.first, "description": f"so many manipulators at the beginning of the run {what}"},
        "every": _whole(1, MOST) | {"default": default.every, "description": f"of the rest every how many-th {what}"},
    }


def _stage(
    catalog: Catalog, kind: Kind, description: str, default: str | None = None, **others: dict[str, Any]
) -> dict[str, Any]:
    """A stage and its options, or its name alone; a default stage need not be named."""
    named = _names(catalog, kind)
    names = {"enum": _all_of(named), "description": description}
    call = _mapping({"stage": names, "options": {}, **others})
    conditions = [
        _if_then({"properties": {"stage": {"enum": own}}}, f"{kind}.{own[0]}", named=default not in own)
        for own in named.values()
    ]
    call |= {"allOf": conditions} if conditions else {}
    return _either(names, call if default else {**call, "required": ["stage"]})


def _usual(catalog: Catalog, kind: Kind) -> str | None:
    """The name of the stage that is taken where none is named; None where every plugin that has one is left out."""
    with suppress(UnknownStageError):
        return catalog.usual(kind).name
    return None


def _all_of(named: dict[str, list[str]]) -> list[str]:
    """All names, the short ones first: what an editor proposes."""
    return sorted({name for names in named.values() for name in names}, key=lambda name: (":" in name, name))


def _input(catalog: Catalog) -> dict[str, Any]:
    """An input: its reader is named, or goes by the suffix of the path."""
    named = _names(catalog, "reader")
    names = {"enum": _all_of(named), "description": "the reader; by the path's suffix if absent"}
    path = _text("a table, or a pattern such as tables/*.csv")
    calibration = _text("differences that are added to the rows: a calibration.conf, or a table of them")
    call = _mapping({"path": path, "stage": names, "options": {}, "calibration": calibration})
    call["required"] = ["path"]
    call["allOf"] = []
    for item in catalog.provided("reader"):
        by_name = {"properties": {"stage": {"enum": named[item.full_name]}}, "required": ["stage"]}
        suffixes = "|".join(suffix.replace(".", r"\.") for suffix in getattr(item.stage, "suffixes", ()))
        by_suffix = {"properties": {"path": {"pattern": f"({suffixes})$"}}, "not": {"required": ["stage"]}}
        condition = _either(by_name, by_suffix) if suffixes else by_name
        call["allOf"].append(_if_then(condition, f"reader.{named[item.full_name][0]}", named=False))
    return call


def _cell() -> dict[str, Any]:
    """A cell: its name and its arms."""
    number = {"type": ["number", "string"], "minLength": 1}
    vector = {"type": "array", "items": number, "minItems": 3, "maxItems": 3}
    arm = _mapping(
        {
            "name": _text("the arm's name in the cell"),
            "of": _text("the manipulator of this run that it is"),
            "prefix": {"type": "string", "description": "before the names of its links and joints; NAME_ by default"},
            "parent": _text("world, the default, or a link of another arm, such as left/tool0"),
            "xyz": vector | {"description": "where it stands on its parent [m]"},
            "rpy": vector | {"description": "how it stands there: roll, pitch, yaw [rad]"},
        }
    )
    arms = {"type": "array", "items": {**arm, "required": ["name", "of"]}, "minItems": 1}
    cell = _mapping({"name": _text("the cell's name, after which its files are named"), "arms": arms})
    return {**cell, "required": ["name", "arms"]}


def _meshes() -> dict[str, Any]:
    """The meshes of a manipulator, its base's and by joint."""
    number = {"type": ["number", "string"], "minLength": 1}
    vector = {"type": "array", "items": number, "minItems": 3, "maxItems": 3}
    file = _text("a file in STL, OBJ or DAE, from the folder of the run file")
    about = {
        "file": file,
        "xyz": vector | {"description": "where it stands in the DH frame after the row [m]"},
        "rpy": vector | {"description": "how it stands there: roll, pitch, yaw [rad]"},
        "scale": _either(number, vector) | {"description": "a factor, or one for each axis"},
    }
    mesh = _either(file, {**_mapping(about), "required": ["file"]})
    shapes = _mapping(dict.fromkeys(SHAPE_KEYS, mesh))
    joints = {"type": "object", "additionalProperties": shapes, "description": "by the names of the joints"}
    of = _text("the manipulator of this run that has them; * stands for any text")
    return {**_mapping({"of": of, "base": shapes, "joints": joints}), "required": ["of"]}


def _variation() -> dict[str, Any]:
    """A variation: what is varied, how often, and by which laws."""
    variation = _mapping(
        {
            "name": _text("what the names of the variants begin with; that of the manipulator by default"),
            "of": _text("the manipulator of this run that is varied"),
            "count": _whole(1, MOST_POINTS) | {"description": "how many variants; the points of its grids by default"},
            "seed": _whole(0, MOST_SEED - 1) | {"default": 0, "description": "which of all samples"},
            "sampling": {"enum": list(Sampling), "default": Sampling.RANDOM, "description": "how the sample spreads"},
            "vary": _one_or_more(_rule(), "what varies"),
        }
    )
    return {**variation, "required": ["of", "vary"]}


def _rule() -> dict[str, Any]:
    """A field of some joints and the law of its values."""
    number: dict[str, Any] = {"type": ["number", "string"], "minLength": 1}
    pair = {"type": "array", "items": number, "minItems": 2, "maxItems": 2}
    values = {"type": "array", "items": number, "minItems": 1}
    spaced = _mapping({"from": number, "to": number, "points": _whole(2, MOST_VALUES)})
    normal = _mapping({"mean": number, "deviation": number, "bounds": pair})
    joint: dict[str, Any] = {"type": ["integer", "string"], "minimum": 1, "minLength": 1}
    joints = _either(joint, {"type": "array", "items": joint, "minItems": 1})
    laws = {
        "choices": values | {"description": "one of these, all equally likely"},
        "grid": _either(values, {**spaced, "required": ["from", "to", "points"]})
        | {"description": "each of these, with each of all other grids"},
        "uniform": pair | {"description": "any value of this range"},
        "log-uniform": pair | {"description": "any value of this range, all orders of magnitude equally likely"},
        "normal": {**normal, "required": ["deviation", "bounds"]}
        | {"description": "a normal distribution, about the nominal value unless it has a mean, cut at its bounds"},
        "scale": pair | {"description": "the nominal value times a factor of this range"},
        "offset": pair | {"description": "the nominal value plus a number of this range"},
    }
    field = {"enum": list(FIELDS), "description": "what varies"}
    about = {"description": "of which joints: all, numbers from 1, or names; the number of axes has none"}
    rule = _mapping({"joints": joints | about, "field": field, **laws})
    rule["required"] = ["field"]
    rule["oneOf"] = [{"required": [law]} for law in LAWS]
    of_the_arm = {"properties": {"field": {"const": AXES}}, "required": ["field"]}
    rule["if"], rule["then"], rule["else"] = of_the_arm, {"properties": {"joints": False}}, {"required": ["joints"]}
    return rule


def _if_then(condition: dict[str, Any], definition: str, *, named: bool) -> dict[str, Any]:
    if named:
        condition = {**condition, "required": ["stage"]}
    options = _or_null({"$ref": f"#/$defs/{definition}"})
    return {"if": condition, "then": {"properties": {"options": options}}}


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
    for option in type_hints(stage.options):
        described = schema["properties"][option]
        described.pop("title", None)
        if helps[option]:
            described["description"] = helps[option]
    definitions = {name: schema, **{f"{name}.{model}": definition for model, definition in inner.items()}}
    for definition in definitions.values():
        if definition.get("type") == "object":
            definition["additionalProperties"] = False
    return definitions


# --- Shorthands of the schema language --------------------------------------------------------------------------------


def _text(description: str) -> dict[str, Any]:
    return {"type": "string", "minLength": 1, "description": description}


def _whole(least: int, most: int) -> dict[str, Any]:
    return {"type": "integer", "minimum": least, "maximum": most}


def _mapping(properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": properties, "additionalProperties": False}


def _either(*schemas: dict[str, Any]) -> dict[str, Any]:
    return {"anyOf": list(schemas)}


def _or_null(schema: dict[str, Any]) -> dict[str, Any]:
    return _either(schema, {"type": "null"})


def _one_or_more(entry: dict[str, Any], description: str, least: int = 1) -> dict[str, Any]:
    return _either(entry, {"type": "array", "items": entry, "minItems": least}) | {"description": description}
