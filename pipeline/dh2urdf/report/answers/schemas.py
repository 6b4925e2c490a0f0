"""JSON Schemas (2020-12) of what commands print with `--json`."""

from __future__ import annotations

from typing import Any

from dh2urdf.manipulator import Convention, JointType
from dh2urdf.report.answers.conversions import FILLED_IN, SCHEMA as CONVERSIONS
from dh2urdf.report.answers.errors import SCHEMA as ERROR
from dh2urdf.report.answers.info import CELL, COMPUTED, DEFAULT, SCHEMA as INFO
from dh2urdf.report.schema import problem_schema, proof_schema
from dh2urdf.report.schema_words import axes_properties, count, list_of, object_of, or_null, text
from dh2urdf.run_file.schema import DIALECT

PROBLEM = {"$ref": "#/$defs/problem"}


def error_schema() -> dict[str, Any]:
    """The schema of what a command with `--json` prints where it fails."""
    report = object_of(
        {
            "schema": {"const": ERROR, "description": "name and version of this form"},
            "version": text("version of dh2urdf"),
            "exit_status": count("the status with which the command ends"),
            "kind": text("of what kind the failure is: table, config, usage, output, interrupted, …"),
            "errors": list_of(PROBLEM, "what is wrong"),
            "notices": list_of(PROBLEM, "what a careful person would look at besides"),
        }
    )
    defs = {"problem": problem_schema()}
    return {"$schema": DIALECT, "title": "an error of dh2urdf with --json", **report, "$defs": defs}


def info_schema() -> dict[str, Any]:
    """The schema of what `dh2urdf info --json` prints."""
    report = object_of(
        {
            "schema": {"const": INFO, "description": "name and version of this form"},
            "version": text("version of dh2urdf"),
            "exit_status": {
                "enum": [0, 1],
                "description": "0 where all is well, 1 where an arm is refused",
            },
            "source": text("the table"),
            "manipulators": list_of(_brief(), "the manipulators of the table, in short; only the one that is shown"),
            "detail": or_null(_detail()),
        }
    )
    return {"$schema": DIALECT, "title": "dh2urdf info --json", **report, "$defs": {"problem": problem_schema()}}


def _brief() -> dict[str, Any]:
    return object_of(
        {
            "name": text("the manipulator's name"),
            "place": or_null(text("where it begins")),
            "convention": or_null({"enum": list(Convention)}),
            "joints": or_null(count("its rows")),
            "moving": or_null(count("its joints that move")),
            "notices": list_of(PROBLEM, "what a careful person would want to know"),
            "errors": list_of(PROBLEM, "why it cannot be read"),
        }
    )


def _detail() -> dict[str, Any]:
    place = or_null(text("the cell, such as arm.csv:4:12; null where the table does not say it"))
    number = {"type": "number"}
    placement = object_of(
        {
            "xyz": list_of(number, "translation [m]"),
            "rpy": list_of(number, "roll, pitch and yaw [rad]"),
            "from": {"enum": [CELL, DEFAULT]},
            "place": place,
        }
    )
    distance = object_of(
        {
            "bound": or_null({**number, "description": "no joint values within the limits lead further"}),
            "unit": {"const": "m"},
            "of": text("of what from what"),
            "without_limits": list_of({"type": "string"}, "prismatic joints without limits: there is no bound"),
        }
    )
    mass = object_of(
        {
            "total": or_null({**number, "description": "mass of the robot"}),
            "unit": {"const": "kg"},
            "computed": list_of({"type": "string"}, "links whose mass is computed from their shapes"),
        }
    )
    return object_of(
        {
            "name": text("the manipulator's name"),
            "place": or_null(text("where it begins")),
            "convention": object_of({"value": {"enum": list(Convention)}, "place": place}),
            "base": placement,
            "tool": placement,
            "units": list_of(_unit(place), "the units that the table states for all rows"),
            "stated": {
                "type": "object",
                "additionalProperties": object_of({"value": {}, "place": place}),
                "description": "what else the table says of the whole arm, by key [SI]",
            },
            "joints": list_of(_joint(place), "the joints, from the base outwards"),
            "pose_at_zero": list_of(list_of(number, "a row"), "T(base_link to tool0) where every joint value is 0"),
            "largest_distance": distance,
            "axes": object_of(axes_properties()),
            "mass": mass,
            "notices": list_of(PROBLEM, "what a careful person would want to know"),
            "errors": list_of(PROBLEM, "why no robot can be made of it"),
        }
    )


def _unit(place: dict[str, Any]) -> dict[str, Any]:
    return object_of({"of": text("what it measures"), "unit": text("the unit"), "place": place})


def _joint(place: dict[str, Any]) -> dict[str, Any]:
    field = object_of(
        {
            "field": text("what the project calls the field: a, alpha, lower, com_x, ixx, …"),
            "value": {"type": ["number", "string"], "description": "the value in SI units, or a word"},
            "unit": text("the unit of the value; empty for words and plain numbers"),
            "from": {
                "enum": [CELL, DEFAULT, COMPUTED],
                "description": "whether the table says it, it is a default, or the transform computes it",
            },
            "typed": or_null(text("the cell as it is typed")),
            "read_in": or_null(text("the unit in which a number without a unit is read")),
            "place": place,
        }
    )
    return object_of(
        {
            "name": text("the joint's name"),
            "link": text("the link that it moves"),
            "type": {"enum": list(JointType)},
            "place": or_null(text("the row")),
            "fields": list_of(field, "every field that has a value"),
        }
    )


def conversions_schema() -> dict[str, Any]:
    """The schema of what `dh2urdf convert --json` prints."""
    joint = object_of({"name": text("the joint's name"), "type": {"enum": list(JointType)}})
    file = object_of(
        {
            "path": text("the file"),
            "stage": text("the emitter"),
            "bytes": count("its size [B]"),
            "sha256": {"type": "string", "pattern": "^[0-9a-f]{64}$", "description": "the hash of its bytes"},
        },
        {"content": {"type": "string", "description": "the text of the file, where it was not written"}},
    )
    filled = {what.replace(" ", "_"): list_of({"type": "string"}, f"whose {what}") for what in FILLED_IN}
    conversion = object_of(
        {
            "source": text("the table"),
            "status": {"enum": ["ok", "failed"]},
            "kind": or_null(text("of what kind the failure is, such as table or proof")),
            "name": or_null(text("the manipulator's name")),
            "convention": or_null({"enum": list(Convention)}),
            "joints": list_of(joint, "the joints, from the base outwards"),
            "files": list_of(file, "the files that were written; the first one is the description"),
            "keeps_kinematics": {
                "type": "boolean",
                "description": "whether the transform keeps T(q): where it does not, differences fail nothing",
            },
            "proof": {
                "type": "object",
                "additionalProperties": or_null(proof_schema()),
                "description": "by emitter, how far the file is from the DH product; null where it cannot be read back",
            },
            "filled_in": {
                **object_of({}, filled),
                "description": "the joints or links for which the table says nothing, by what was filled in",
            },
            "notices": list_of(PROBLEM, "what a careful person would want to know"),
            "errors": list_of(PROBLEM, "why it failed"),
        }
    )
    report = object_of(
        {
            "schema": {"const": CONVERSIONS, "description": "name and version of this form"},
            "version": text("version of dh2urdf"),
            "exit_status": {"enum": [0, 1], "description": "0 where all is done, 1 where a table failed"},
            "conversions": list_of(conversion, "what became of each table, in the order of the command line"),
        }
    )
    defs = {"problem": problem_schema()}
    return {"$schema": DIALECT, "title": "dh2urdf convert --json", **report, "$defs": defs}
