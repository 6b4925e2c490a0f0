"""JSON Schemas (2020-12) of what a run tells, and of the list of plugins."""

from __future__ import annotations

from typing import Any

from dh2urdf.registry import KINDS
from dh2urdf.report.json import REPORTED, SCHEMA
from dh2urdf.report.plugins import SCHEMA as PLUGINS_SCHEMA
from dh2urdf.schema import DIALECT


def report_schema() -> dict[str, Any]:
    """The schema of `report.json`."""
    report = _object(
        {
            "schema": {"const": SCHEMA, "description": "name and version of this form"},
            "version": _text("version of dh2urdf that wrote it"),
            "exit_status": {"enum": [0, 1], "description": "0 where all is done, 1 where a manipulator failed"},
            "manipulators": _list({"$ref": "#/$defs/row"}, f"the first rows of the manifest, {REPORTED} at most"),
            "left_out": _count("how many more rows the manifest has"),
        }
    )
    return {"$schema": DIALECT, "title": "report.json of dh2urdf", **report, "$defs": {"row": _row(), **_parts()}}


def manifest_schema() -> dict[str, Any]:
    """The schema of a line of `manifest.jsonl`."""
    return {"$schema": DIALECT, "title": "a line of manifest.jsonl of dh2urdf", **_row(), "$defs": _parts()}


def plugins_schema() -> dict[str, Any]:
    """The schema of what `dh2urdf plugins --json` prints."""
    plugin = {
        "plugin": _text("the plugin's entry point, such as my_lab = my_lab.plugin"),
        "distribution": _text("name and version of the distribution that provides it"),
    }
    kind = {"enum": list(KINDS), "description": "the kind of stage"}
    option = _object(
        {
            "name": _text("the option's name in a run file"),
            "type": _text("what it takes, in words"),
            "default": _text("what it is where nobody says it, in words"),
            "help": _text("what it is for"),
        }
    )
    stage = _object(
        {
            "kind": kind,
            "name": _text("the stage's name in a run file"),
            "summary": _text("what it does, in one line"),
            **plugin,
            "options": _list(option, "its options"),
        }
    )
    clash = _object(
        {
            "kind": kind,
            "name": _text("a name that several plugins claim"),
            "distributions": _list({"type": "string"}, "who claims it: name and version of each distribution"),
            "choices": _list({"type": "string"}, "how each is said without doubt: distribution:name"),
        }
    )
    refused = {**plugin, "reason": _text("why it cannot be used")}
    failed = _object({**refused, "traceback": _text("where it failed")})
    report = _object(
        {
            "schema": {"const": PLUGINS_SCHEMA, "description": "name and version of this form"},
            "version": _text("version of dh2urdf that wrote it"),
            "interface": _text("version of the plugin interface, major.minor"),
            "stages": _list(stage, "every stage that is installed, by kind and name"),
            "clashes": _list(clash, "names that are no use without the distribution before them"),
            "broken": _list(failed, "plugins, or parts of plugins, that failed"),
            "incompatible": _list(_object(refused), "plugins for another version of the interface"),
            "left_out": _list(_object(plugin), "plugins that the command line leaves out"),
        }
    )
    return {"$schema": DIALECT, "title": "dh2urdf plugins --json", **report}


def _row() -> dict[str, Any]:
    return _object(
        {
            "name": _text("the manipulator's, the cell's or the variant's name"),
            "status": {"enum": ["ok", "failed", "skipped"], "description": "skipped where a run only looked"},
            "kind": _or_null(_text("of what kind the failure is: table, manipulator, transform, proof, loader, …")),
            "source": _text("the file it comes from; of a cell or variant the run file"),
            "key": _text("a hash of what its files depend on, by which a resumed run knows them"),
            "drawn": {
                "type": "object",
                "additionalProperties": {"type": ["number", "string"]},
                "description": "what was drawn for a variant [SI], by field and number of the joint: a_2",
            },
            "keeps_kinematics": {
                "type": "boolean",
                "description": "whether the transform keeps T(q): where it does not, differences fail nothing",
            },
            "files": _list({"$ref": "#/$defs/file"}, "the files that were written"),
            "proof": {
                "type": "object",
                "additionalProperties": _or_null({"$ref": "#/$defs/proof"}),
                "description": "by emitter, how far its main file is from the DH product; null where nobody looked",
            },
            "loaders": {
                "type": "object",
                "additionalProperties": {"$ref": "#/$defs/load"},
                "description": "by loader, what the simulator says",
            },
            "notices": _list({"$ref": "#/$defs/problem"}, "what a careful person would want to know"),
            "errors": _list({"$ref": "#/$defs/problem"}, "why it failed"),
        }
    )


def _parts() -> dict[str, Any]:
    return {"file": _file(), "proof": _proof(), "load": _load(), "problem": _problem()}


def _file() -> dict[str, Any]:
    sharded = {
        "shard": _text("the tar file that it is in"),
        "offset": _count("where its bytes begin in the tar file [B]"),
    }
    file = _object(
        {
            "path": _text("its name in the output, or in its shard"),
            "stage": _text("the emitter"),
            "bytes": _count("its size [B]"),
            "sha256": {"type": "string", "pattern": "^[0-9a-f]{64}$", "description": "the hash of its bytes"},
        },
        sharded,
    )
    return {**file, "dependentRequired": {"shard": ["offset"], "offset": ["shard"]}}


def _proof() -> dict[str, Any]:
    return _object(
        {
            "position_error": _or_null(_size("largest distance of a tool0 from the DH product [m]; null: not finite")),
            "angle_error": _or_null(_size("largest angle between them [rad]; null: not finite")),
            "q": _list({"type": "number"}, "the joint vector of the largest position error [rad or m]"),
            "tolerance": _size("what the position error may be [m]"),
            "poses": _count("joint vectors that were compared"),
        },
        {
            "tip": _text("of a cell: the frame of the largest position error"),
            "tips": {
                "type": "object",
                "additionalProperties": _or_null({"type": "number"}),
                "description": "of a cell: the largest position error of every arm's tool0 [m]",
            },
        },
    )


def _load() -> dict[str, Any]:
    return _object(
        {
            "simulator": _text("its name"),
            "version": _text("its version"),
            "joints": _list({"type": "object"}, "the moving joints it found: name, type, axis, limits, as it has them"),
            "mass": _or_null({"type": "number", "description": "mass of the arm as it holds it [kg]"}),
            "mass_error": _or_null(_size("largest difference of one link's mass [kg]")),
            "inertia_error": _or_null(_size("largest difference of an element of one link's inertia [kg·m²]")),
            "position_error": _or_null(_size("largest distance of a tool0 from the DH product [m]")),
            "angle_error": _or_null(_size("largest angle between them [rad]")),
            "tolerance": _or_null(_size("what the position error may be: the simulator's arithmetic [m]")),
            "angle_tolerance": _or_null(_size("what the angle error may be [rad]")),
            "q": _list({"type": "number"}, "the joint vector of the largest position error [rad or m]"),
            "poses": _count("joint vectors that were measured"),
            "hold": {
                "type": "object",
                "properties": {"stayed": {"type": "boolean", "description": "whether the arm stayed in place"}},
                "description": "the hold test under gravity: seconds, largest displacement, contacts within the arm; "
                "empty where there was none",
            },
            "findings": _list({"$ref": "#/$defs/problem"}, "what a person should know"),
            "output": {"type": "string", "description": "what the simulator printed"},
            "picture": _or_null(_text("name of the picture that it took")),
        }
    )


def _problem() -> dict[str, Any]:
    return _object(
        {
            "file": _or_null(_text("the file where it was said")),
            "line": _or_null({"type": "integer", "minimum": 1}),
            "column": _or_null({"type": "integer", "minimum": 1}),
            "joint": _or_null({"type": "string", "description": "the joint concerned"}),
            "field": _or_null({"type": "string", "description": "the field concerned, such as alpha"}),
            "found": _or_null({"type": "string", "description": "the text that was found"}),
            "accepted": _or_null({"type": "string", "description": "what is accepted in its place"}),
            "message": _text("what is wrong, and what to do"),
        }
    )


# --- Shorthands of the schema language --------------------------------------------------------------------------------


def _object(properties: dict[str, Any], others: dict[str, Any] | None = None) -> dict[str, Any]:
    """An object that has some properties, and may have others, and no more."""
    every = {**properties, **(others or {})}
    return {"type": "object", "properties": every, "required": list(properties), "additionalProperties": False}


def _text(description: str) -> dict[str, Any]:
    return {"type": "string", "description": description}


def _count(description: str) -> dict[str, Any]:
    return {"type": "integer", "minimum": 0, "description": description}


def _size(description: str) -> dict[str, Any]:
    return {"type": "number", "minimum": 0, "description": description}


def _list(entry: dict[str, Any], description: str) -> dict[str, Any]:
    return {"type": "array", "items": entry, "description": description}


def _or_null(schema: dict[str, Any]) -> dict[str, Any]:
    return {"anyOf": [schema, {"type": "null"}]}
