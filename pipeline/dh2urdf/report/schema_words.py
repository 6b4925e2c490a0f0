"""Shorthands for JSON Schemas."""

from __future__ import annotations

from typing import Any


def object_of(properties: dict[str, Any], others: dict[str, Any] | None = None) -> dict[str, Any]:
    """An object that has some properties, and may have others, and no more."""
    every = {**properties, **(others or {})}
    return {"type": "object", "properties": every, "required": list(properties), "additionalProperties": False}


def text(description: str) -> dict[str, Any]:
    """A text."""
    return {"type": "string", "description": description}


def count(description: str) -> dict[str, Any]:
    """A whole number from 0."""
    return {"type": "integer", "minimum": 0, "description": description}


def size(description: str) -> dict[str, Any]:
    """A number from 0."""
    return {"type": "number", "minimum": 0, "description": description}


def list_of(entry: dict[str, Any], description: str) -> dict[str, Any]:
    """A list of entries of one kind."""
    return {"type": "array", "items": entry, "description": description}


def or_null(schema: dict[str, Any]) -> dict[str, Any]:
    """Something, or null."""
    return {"anyOf": [schema, {"type": "null"}]}


def axes_properties() -> dict[str, Any]:
    """What the axes of a table say."""
    joint = text("a joint")
    lengths = {name: {"type": "number"} for name in ("a1", "a2", "b", "c1", "c2", "c3", "c4")}
    opw = object_of(
        {
            **lengths,
            "offsets": list_of({"type": "number"}, "of the joints [rad]"),
            "signs": list_of({"type": "integer"}, "of the joints, 1 or -1"),
        }
    )
    return {
        "parallel": list_of(list_of(joint, "joints in a row whose axes are parallel"), "all of them"),
        "spherical_wrist": list_of(joint, "the last three joints, where their axes meet in one point"),
        "opw": {"anyOf": [opw, {"type": "null"}]},
    }
