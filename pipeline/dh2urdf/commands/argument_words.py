"""Arguments of a program as words of the command line: a value is written as YAML, a record with its units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from dh2urdf.manipulator import Inertia, LinkGeometry, Payload
from dh2urdf.rotations import RigidTransform

if TYPE_CHECKING:
    from collections.abc import Iterable


def word_of(value: object) -> str:
    """A value as a word of the command line: JSON is YAML."""
    if isinstance(value, str):
        return value
    import json

    return json.dumps(_with_units(value), default=_plain, ensure_ascii=False)


def words_of(options: Mapping[str, object]) -> dict[str, str]:
    """Options by name as words of the command line."""
    return {name: word_of(value) for name, value in options.items()}


def _with_units(value: Any) -> Any:  # noqa: ANN401 - whatever is given
    """A value with its records as mappings whose numbers name their units: a record is in SI units, a table is not."""
    match value:
        case RigidTransform():
            r, lengths = value.rotation, _in("m", value.translation)
            value = [[*r[0:3], lengths[0]], [*r[3:6], lengths[1]], [*r[6:9], lengths[2]], [0, 0, 0, 1]]
        case Payload():
            value = {"mass": f"{value.mass!r} kg", "com": _in("m", value.com), "inertia": value.inertia}
            value = {key: _with_units(entry) for key, entry in value.items() if entry is not None}
        case Inertia():
            value = {field.name: f"{getattr(value, field.name)!r} kg·m²" for field in fields(value)}
        case LinkGeometry():
            value = {"shape": value.shape, "radius": None if value.radius is None else f"{value.radius!r} m"}
            value = {key: word for key, word in value.items() if word is not None}
        case Mapping():
            value = {key: _with_units(entry) for key, entry in value.items()}
        case list():
            value = [_with_units(entry) for entry in value]
    return value


def _in(unit: str, numbers: Iterable[float]) -> list[str]:
    return [f"{number!r} {unit}" for number in numbers]


def _plain(value: Any) -> object:  # noqa: ANN401 - what JSON has no word for
    """Arrays and numbers of numpy as lists and numbers, all else as text."""
    return value.tolist() if hasattr(value, "tolist") else str(value)
