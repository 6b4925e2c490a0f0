"""Arguments of a program as words of the command line: a value is written as YAML, a record with its units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from enum import Enum
from numbers import Number
from os import PathLike
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import RecordTypeError
from dh2urdf.manipulator import Inertia, LinkGeometry, Payload
from dh2urdf.rotations import RigidTransform
from dh2urdf.source import Mark, Problem

if TYPE_CHECKING:
    from collections.abc import Iterable


def word_of(value: object) -> str:
    """A value as a word of the command line: JSON is YAML.

    Raises:
        RecordTypeError: it is, or holds, something that YAML has no word for.
    """
    if isinstance(value, str):
        return value
    import json

    try:
        return json.dumps(_with_units(value), default=_plain, ensure_ascii=False)
    except (TypeError, ValueError, RecursionError) as error:  # such as of a key that is a tuple, or of a list in itself
        raise error if isinstance(error, RecordTypeError) else _no_word(f"this has no words: {error}") from error


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
    """Arrays and numbers of numpy as lists and numbers, fractions and paths as texts, members of enums as their values.

    Raises:
        RecordTypeError: it is something else, whose text would be taken for a word that somebody has written.
    """
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, (PathLike, Number)):
        return str(value)
    raise _no_word(f"a {type(value).__name__} is no value of an option or of a run file")


def _no_word(message: str) -> RecordTypeError:
    accepted = "numbers, texts, True, False, None, paths, arrays, and lists and mappings of these"
    return RecordTypeError(Problem(message=message, mark=Mark(file="dh2urdf"), accepted=accepted))
