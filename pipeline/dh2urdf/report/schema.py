"""JSON Schemas (2020-12) of what a run tells, and of the list of plugins."""

from __future__ import annotations

from typing import Any

from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.report.json import SCHEMA
from dh2urdf.report.ledger import REPORTED
from dh2urdf.report.plugins import SCHEMA as PLUGINS_SCHEMA
from dh2urdf.report.schema_words import axes_properties, count, list_of, object_of, or_null, size, text
from dh2urdf.run_file.schema import DIALECT


def report_schema() -> dict[str, Any]:
    """The schema of `report.json`."""
    report = object_of(
        {
            "schema": {"const": SCHEMA, "description": "name and version of this form"},
            "version": text("version of dh2urdf that wrote it"),
            "exit_status": {"enum": [0, 1], "description": "0 where all is done, 1 where a manipulator failed"},
            "reproduction": _reproduction(),
            "coverage": {
                "type": "object",
                "additionalProperties": _coverage(),
                "description": "by loader, how many manipulators of the run it was given, and what came of it",
            },
            "simulator_notices": list_of(_simulator_notice(), "what loaders noticed, alike notices counted together"),
            "manipulators": list_of({"$ref": "#/$defs/row"}, f"the first rows of the manifest, {REPORTED} at most"),
            "left_out": count("how many more rows the manifest has"),
            "axes": list_of(_arm_axes(), "what the axes of the tables of these manipulators say of their kinematics"),
        }
    )
    return {"$schema": DIALECT, "title": "report.json of dh2urdf", **report, "$defs": {"row": _row(), **_parts()}}


def _arm_axes() -> dict[str, Any]:
    return object_of(
        {
            "name": text("the manipulator or cell"),
            "arms": list_of(text("an arm"), "the arms of a cell that have this table"),
            **axes_properties(),
        }
    )


def manifest_schema() -> dict[str, Any]:
    """The schema of a line of `manifest.jsonl`."""
    return {"$schema": DIALECT, "title": "a line of manifest.jsonl of dh2urdf", **_row(), "$defs": _parts()}


def plugins_schema() -> dict[str, Any]:
    """The schema of what `dh2urdf plugins --json` prints."""
    plugin = {
        "plugin": text("the plugin's entry point, such as my_lab = my_lab.plugin"),
        "distribution": text("name and version of the distribution that provides it"),
    }
    kind = {"enum": list(KINDS), "description": "the kind of stage"}
    option = object_of(
        {
            "name": text("the option's name in a run file"),
            "type": text("what it takes, in words"),
            "default": text("what it is where nobody says it, in words"),
            "help": text("what it is for"),
        }
    )
    stage = object_of(
        {
            "kind": kind,
            "name": text("the stage's name in a run file"),
            "summary": text("what it does, in one line"),
            **plugin,
            "options": list_of(option, "its options"),
        }
    )
    clash = object_of(
        {
            "kind": kind,
            "name": text("a name that several plugins claim"),
            "distributions": list_of({"type": "string"}, "who claims it: name and version of each distribution"),
            "choices": list_of({"type": "string"}, "how each is said without doubt: distribution:name"),
        }
    )
    shadowed = object_of(
        {
            "kind": kind,
            "name": text("a name that means another plugin's stage"),
            **plugin,
            "winner": text("name and version of the distribution whose stage the name means"),
            "choice": text("how this stage is said without doubt: distribution:name"),
        }
    )
    refused = {**plugin, "reason": text("why it cannot be used")}
    failed = object_of({**refused, "traceback": text("where it failed")})
    report = object_of(
        {
            "schema": {"const": PLUGINS_SCHEMA, "description": "name and version of this form"},
            "version": text("version of dh2urdf that wrote it"),
            "interface": text("version of the plugin interface, major.minor"),
            "stages": list_of(stage, "every stage that is installed, by kind and name"),
            "clashes": list_of(clash, "names that are no use without the distribution before them"),
            "shadowed": list_of(shadowed, "stages whose names alone mean the stages of other plugins"),
            "broken": list_of(failed, "plugins, or parts of plugins, that failed"),
            "incompatible": list_of(object_of(refused), "plugins for another version of the interface"),
            "left_out": list_of(object_of(plugin), "plugins that the command line leaves out"),
        }
    )
    return {"$schema": DIALECT, "title": "dh2urdf plugins --json", **report}


def _row() -> dict[str, Any]:
    return object_of(
        {
            "name": text("the manipulator's, the cell's or the variant's name"),
            "status": {"enum": ["ok", "failed", "skipped"], "description": "skipped where a run only looked"},
            "kind": or_null(text("of what kind the failure is: table, manipulator, transform, proof, loader, …")),
            "source": text("the file it comes from; of a cell or variant the run file"),
            "key": text("a hash of what its files depend on, by which a resumed run knows them"),
            "drawn": {
                "type": "object",
                "additionalProperties": {"type": ["number", "string"]},
                "description": "what was drawn for a variant [SI], by field and number of the joint: a_2",
            },
            "keeps_kinematics": {
                "type": "boolean",
                "description": "whether the transform keeps T(q): where it does not, differences fail nothing",
            },
            "files": list_of({"$ref": "#/$defs/file"}, "the files that were written"),
            "proof": {
                "type": "object",
                "additionalProperties": or_null({"$ref": "#/$defs/proof"}),
                "description": "by emitter, how far its main file is from the DH product; null where nobody looked",
            },
            "loaders": {
                "type": "object",
                "additionalProperties": {"$ref": "#/$defs/load"},
                "description": "by loader, what the simulator says",
            },
            "notices": list_of({"$ref": "#/$defs/problem"}, "what a careful person would want to know"),
            "errors": list_of({"$ref": "#/$defs/problem"}, "why it failed"),
        },
        {
            "meshes": list_of({"$ref": "#/$defs/mesh"}, "the copies of meshes that its files name"),
            "not_loaded": {
                "type": "object",
                "additionalProperties": {"enum": ["not in the sample", "no file"]},
                "description": "the loaders of the run that it did not go through, and why",
            },
        },
    )


def _reproduction() -> dict[str, Any]:
    described = {"type": "string"}
    entry = object_of(
        {
            "path": text("a file that the run read: its run file, or a table"),
            "sha256": or_null({"type": "string", "pattern": "^[0-9a-f]{64}$", "description": "the hash of its bytes"}),
        }
    )
    variation = object_of(
        {
            "name": text("what the names of its variants begin with"),
            "of": text("the manipulator that is varied"),
            "count": or_null(count("how many variants; null for as many as its grids have points")),
            "seed": {"type": "integer", "description": "which of all samples"},
            "sampling": text("how the sample spreads"),
        }
    )
    stage = object_of(
        {
            "kind": {"enum": list(KINDS), "description": "the kind of stage"},
            "stage": text("the stage's name"),
            "options": {"type": "object", "description": "all options of the stage, with their defaults"},
        }
    )
    return object_of(
        {
            "command": or_null(text("the command that makes the same files; null where a program began the run")),
            "inputs": list_of(entry, "the run file and the tables, the first thousand"),
            "inputs_left_out": count("how many more there are"),
            "versions": {"type": "object", "additionalProperties": described, "description": "of all that had a part"},
            "variations": list_of(variation, "what was drawn"),
            "stages": list_of(stage, "transform, edits, emitters and loaders, in their order"),
            "joint_vectors": text("at which joint vectors files and simulators were compared with the tables"),
            "citation": text("how to cite dh2urdf"),
        }
    )


def _coverage() -> dict[str, Any]:
    return object_of(
        {
            "simulator": or_null(text("name and version of the simulator; null where it judged none")),
            "of": count("manipulators of the run"),
            "passed": count("whose file the simulator loaded as the arm that was written"),
            "failed": count("whose file it refused, or holds as another arm, or that ended it"),
            "missing": count("for which it was not installed"),
            "not_in_sample": count("which the sample of the run left out"),
            "no_file": count("which failed before there was a file"),
            "optional": {"type": "boolean", "description": "whether its failures are notices"},
        }
    )


def _simulator_notice() -> dict[str, Any]:
    return object_of(
        {
            "loader": text("the loader"),
            "manipulators": count("of how many manipulators it says so"),
            "first": text("the first of these"),
            "place": or_null(text("the place in a file that it is about, of the first")),
            "joint": or_null({"type": "string", "description": "the joint that it is about, of the first"}),
            "message": text("what it says of the first; of the others it names other joints and numbers"),
        }
    )


def _parts() -> dict[str, Any]:
    return {"file": _file(), "mesh": _mesh(), "proof": proof_schema(), "load": _load(), "problem": problem_schema()}


def _file() -> dict[str, Any]:
    sharded = {
        "shard": text("the tar file that it is in"),
        "offset": count("where its bytes begin in the tar file [B]"),
    }
    file = object_of(
        {
            "path": text("its name in the output, or in its shard"),
            "stage": text("the emitter"),
            "bytes": count("its size [B]"),
            "sha256": {"type": "string", "pattern": "^[0-9a-f]{64}$", "description": "the hash of its bytes"},
        },
        sharded,
    )
    return {**file, "dependentRequired": {"shard": ["offset"], "offset": ["shard"]}}


def _mesh() -> dict[str, Any]:
    return object_of(
        {
            "path": text("its name in the output"),
            "sha256": {"type": "string", "pattern": "^[0-9a-f]{64}$", "description": "the hash of its bytes"},
        }
    )


def proof_schema() -> dict[str, Any]:
    """The schema of what is known of a proof."""
    return object_of(
        {
            "position_error": or_null(size("largest distance of a tool0 from the DH product [m]; null: not finite")),
            "angle_error": or_null(size("largest angle between them [rad]; null: not finite")),
            "q": list_of({"type": "number"}, "the joint vector of the largest position error [rad or m]"),
            "tolerance": size("what the position error may be [m]"),
            "poses": count("joint vectors that were compared"),
        },
        {
            "tip": text("of a cell: the frame of the largest position error"),
            "tips": {
                "type": "object",
                "additionalProperties": or_null({"type": "number"}),
                "description": "of a cell: the largest position error of every arm's tool0 [m]",
            },
        },
    )


def _load() -> dict[str, Any]:
    return object_of(
        {
            "verdict": {
                "enum": ["passed", "failed", "missing"],
                "description": "failed: it refused the file, holds another arm or crashed; missing: not installed",
            },
            "optional": {"type": "boolean", "description": "whether a failure of the loader is a notice"},
            "errors": list_of({"$ref": "#/$defs/problem"}, "why it failed; nothing is measured then"),
            "simulator": text("its name; of a loader that failed the loader's"),
            "version": {"type": "string", "description": "its version; empty where the loader failed"},
            "joints": list_of(
                {"type": "object"}, "the moving joints it found: name, type, axis, limits, as it has them"
            ),
            "mass": or_null({"type": "number", "description": "mass of the arm as it holds it [kg]"}),
            "mass_error": or_null(size("largest difference of one link's mass [kg]")),
            "inertia_error": or_null(size("largest difference of an element of one link's inertia [kg·m²]")),
            "position_error": or_null(size("largest distance of a tool0 from the DH product [m]")),
            "angle_error": or_null(size("largest angle between them [rad]")),
            "tolerance": or_null(size("what the position error may be: the simulator's arithmetic [m]")),
            "angle_tolerance": or_null(size("what the angle error may be [rad]")),
            "q": list_of({"type": "number"}, "the joint vector of the largest position error [rad or m]"),
            "poses": count("joint vectors that were measured"),
            "hold": {
                "type": "object",
                "properties": {"stayed": {"type": "boolean", "description": "whether the arm stayed in place"}},
                "description": "the hold test under gravity: seconds, largest displacement, contacts within the arm; "
                "empty where there was none",
            },
            "findings": list_of({"$ref": "#/$defs/problem"}, "what a person should know"),
            "output": {"type": "string", "description": "what the simulator printed"},
            "picture": or_null(text("name of the picture that it took")),
        }
    )


def problem_schema() -> dict[str, Any]:
    """The schema of a problem, as an entry of `errors` or `notices`."""
    return object_of(
        {
            "file": or_null(text("the file where it was said")),
            "line": or_null({"type": "integer", "minimum": 1}),
            "column": or_null({"type": "integer", "minimum": 1}),
            "place": or_null(text("the place as the file's format names it, such as Sheet2!C4")),
            "joint": or_null({"type": "string", "description": "the joint concerned"}),
            "field": or_null({"type": "string", "description": "the field concerned, such as alpha"}),
            "found": or_null({"type": "string", "description": "the text that was found"}),
            "accepted": or_null({"type": "string", "description": "what is accepted in its place"}),
            "message": text("what is wrong, and what to do"),
        }
    )
