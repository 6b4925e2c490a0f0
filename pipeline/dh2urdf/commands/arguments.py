"""Arguments of Python functions: refused where no function can use them, and as words of the command line."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from enum import Enum
from numbers import Number
from typing import Any

from dh2urdf.errors import ConfigError, RecordTypeError
from dh2urdf.manipulator import Inertia, LinkGeometry, Payload
from dh2urdf.rotations import RigidTransform
from dh2urdf.source import Mark, Messages

say = Messages(__file__)

_KINDS: dict[str, tuple[Callable[[Any], object], str]] = {
    "name": (lambda value: isinstance(value, str) and value.strip(), "a text, not empty"),
    "flag": (lambda value: isinstance(value, bool), "True or False"),
    # An empty text would be the working directory, which nobody means.
    "path": (
        lambda value: isinstance(value, (str, os.PathLike)) and isinstance(path := os.fspath(value), str) and path,
        "a text, not empty, or a pathlib.Path",
    ),
    "list": (lambda value: isinstance(value, Iterable) and not isinstance(value, (str, bytes, Mapping)), "a list"),
    "mapping": (lambda value: isinstance(value, Mapping), "a mapping, such as {'prefix': 'left_'}"),
}
"""What an argument of a kind has to be."""


def check_arguments(kind: str, mark: Mark, **given: Any) -> None:  # noqa: ANN401 - whatever is given
    """Refuse arguments that are not of a kind: a name, a flag, a path, a list, a mapping; None was left out."""
    is_one, accepted = _KINDS[kind]
    for argument, value in given.items():
        if value is not None and not is_one(value):
            raise ConfigError(
                say("argument-wrong", mark, field=argument, value=f"{value!r:.60}", kind=kind, accepted=accepted)
            )


def path_or_none(argument: str, value: Any, mark: Mark) -> str | None:  # noqa: ANN401 - whatever is given
    """A path or an address that may be left out."""
    check_arguments("path", mark, **{argument: value})
    return None if value is None else os.fspath(value)


def several(
    argument: str,
    value: Any,  # noqa: ANN401 - whatever is given
    mark: Mark,
    *,
    one: type | tuple[type, ...] = str,
    kind: str | None = None,
) -> tuple[Any, ...]:
    """Several of something, or one, which has one of the given types; each of them is of a kind."""
    given = (value,) if isinstance(value, one) else value
    check_arguments("list", mark, **{argument: given})
    given = tuple(given or ())
    for each in given if kind else ():
        check_arguments(str(kind), mark, **{argument: each})
    return given


def word_of(value: object) -> str:
    """A value as a word of the command line: JSON is YAML."""
    if isinstance(value, str):
        return value
    try:
        return json.dumps(_with_units(value), default=_plain, ensure_ascii=False)
    except (TypeError, ValueError, RecursionError) as error:  # such as of a key that is a tuple, or of a list in itself
        raise RecordTypeError(say("option-value-unwritable", Mark(file="dh2urdf"), reason=error)) from error


def words_of(options: Mapping[str, object]) -> dict[str, str]:
    """Options by name as words of the command line."""
    return {name: word_of(value) for name, value in options.items()}


def settings_of(options: Mapping[str, object] | None) -> list[str]:
    """Options as the words of ``--set``."""
    return [f"{key}={word_of(value)}" for key, value in (options or {}).items()]


def _with_units(value: Any) -> Any:  # noqa: ANN401 - whatever is given
    """A value with its records as mappings whose numbers name their units: a record is in SI units, a table is not."""
    match value:
        case RigidTransform():
            r, (x, y, z) = value.rotation, (f"{length!r} m" for length in value.translation)
            value = [[*r[0:3], x], [*r[3:6], y], [*r[6:9], z], [0, 0, 0, 1]]
        case Payload():
            com = [f"{length!r} m" for length in value.com]
            given = {"mass": f"{value.mass!r} kg", "com": com, "inertia": value.inertia}
            value = {key: _with_units(entry) for key, entry in given.items() if entry is not None}
        case Inertia():
            value = {field.name: f"{getattr(value, field.name)!r} kg·m²" for field in fields(value)}
        case LinkGeometry():
            given = {"shape": value.shape, "radius": None if value.radius is None else f"{value.radius!r} m"}
            value = {key: word for key, word in given.items() if word is not None}
        case Mapping():
            value = {key: _with_units(entry) for key, entry in value.items()}
        case list():
            value = [_with_units(entry) for entry in value]
    return value


def _plain(value: Any) -> object:  # noqa: ANN401 - what JSON has no word for
    """Arrays and numbers of numpy as lists and numbers, fractions and paths as texts, members of enums as values."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, (os.PathLike, Number)):
        return str(value)
    raise TypeError(f"a {type(value).__name__} is no value of an option or of a run file")
