"""Arguments of the functions of a program: refused where no function can use them, and as words of the command line."""

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
from dh2urdf.source import Mark, Problem

_KINDS: dict[str, tuple[Callable[[Any], object], str, str]] = {
    "name": (lambda value: isinstance(value, str) and value.strip(), "no name", "a text, not empty"),
    "flag": (lambda value: isinstance(value, bool), "neither True nor False", "True or False"),
    # An empty text would be the working directory, which nobody means.
    "path": (
        lambda value: isinstance(value, (str, os.PathLike)) and isinstance(path := os.fspath(value), str) and path,
        "no path",
        "a text, not empty, or a pathlib.Path",
    ),
    "list": (
        lambda value: isinstance(value, Iterable) and not isinstance(value, (str, bytes, Mapping)),
        "no list",
        "a list, which may be empty",
    ),
    "mapping": (lambda value: isinstance(value, Mapping), "no mapping", "a mapping"),
}
"""What an argument of a kind has to be, what it is otherwise, and what is accepted."""


def check_arguments(kind: str, mark: Mark, *, also: str = "", **given: Any) -> None:  # noqa: ANN401 - whatever is given
    """Refuse arguments that are not of a kind: a name, a flag (and no text such as ``no``), a path, a list, a mapping.

    Raises:
        ConfigError: one of them is something else.
    """
    is_one, wrong, accepted = _KINDS[kind]
    for argument, value in given.items():
        if not is_one(value):
            message = f"{argument}={value!r:.60} is {wrong}"
            raise ConfigError(Problem(message=message, mark=mark, field=argument, accepted=accepted + also))


def check_names(mark: Mark, **given: Any) -> None:  # noqa: ANN401 - whatever is given
    """Names that may be left out."""
    check_arguments("name", mark, **{argument: value for argument, value in given.items() if value is not None})


def path_or_none(argument: str, value: Any, mark: Mark) -> str | None:  # noqa: ANN401 - whatever is given
    """A path or an address that may be left out."""
    if value is None:
        return None
    check_arguments("path", mark, **{argument: value})
    path: str = os.fspath(value)
    return path


def several(argument: str, value: Any, mark: Mark, *, one: type | tuple[type, ...] = str) -> tuple[Any, ...]:  # noqa: ANN401
    """Several of something, or one, which has one of the given types."""
    if isinstance(value, one):
        return (value,)
    check_arguments("list", mark, **{argument: value})
    return tuple(value)


def mapping(argument: str, value: Any, mark: Mark, *, such_as: str) -> Mapping[str, object]:  # noqa: ANN401
    """A mapping, which is empty where none is given."""
    given: Mapping[str, object] = {} if value is None else value
    check_arguments("mapping", mark, also=f", such as {such_as}", **{argument: given})
    return given


def word_of(value: object) -> str:
    """A value as a word of the command line: JSON is YAML.

    Raises:
        RecordTypeError: it is, or holds, something that YAML has no word for.
    """
    if isinstance(value, str):
        return value
    try:
        return json.dumps(_with_units(value), default=_plain, ensure_ascii=False)
    except (TypeError, ValueError, RecursionError) as error:  # such as of a key that is a tuple, or of a list in itself
        raise error if isinstance(error, RecordTypeError) else _no_word(f"this has no words: {error}") from error


def words_of(options: Mapping[str, object]) -> dict[str, str]:
    """Options by name as words of the command line."""
    return {name: word_of(value) for name, value in options.items()}


def settings_of(options: Mapping[str, object]) -> list[str]:
    """Options as the words of ``--set``."""
    return [f"{key}={word}" for key, word in words_of(options).items()]


def _with_units(value: Any) -> Any:  # noqa: ANN401 - whatever is given
    """A value with its records as mappings whose numbers name their units: a record is in SI units, a table is not."""

    def of(unit: str, numbers: Iterable[float | None]) -> list[str | None]:
        return [None if number is None else f"{number!r} {unit}" for number in numbers]

    match value:
        case RigidTransform():
            r, lengths = value.rotation, of("m", value.translation)
            value = [[*r[0:3], lengths[0]], [*r[3:6], lengths[1]], [*r[6:9], lengths[2]], [0, 0, 0, 1]]
        case Payload():
            value = {"mass": of("kg", [value.mass])[0], "com": of("m", value.com), "inertia": value.inertia}
            value = {key: _with_units(entry) for key, entry in value.items() if entry is not None}
        case Inertia():
            names = [field.name for field in fields(value)]
            value = dict(zip(names, of("kg·m²", [getattr(value, name) for name in names]), strict=True))
        case LinkGeometry():
            given = {"shape": value.shape, "radius": of("m", [value.radius])[0]}
            value = {key: word for key, word in given.items() if word is not None}
        case Mapping():
            value = {key: _with_units(entry) for key, entry in value.items()}
        case list():
            value = [_with_units(entry) for entry in value]
    return value


def _plain(value: Any) -> object:  # noqa: ANN401 - what JSON has no word for
    """Arrays and numbers of numpy as lists and numbers, fractions and paths as texts, members of enums as their values.

    Raises:
        RecordTypeError: it is something else, whose text would be taken for a word that somebody has written.
    """
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, (os.PathLike, Number)):
        return str(value)
    raise _no_word(f"a {type(value).__name__} is no value of an option or of a run file")


def _no_word(message: str) -> RecordTypeError:
    accepted = "numbers, texts, True, False, None, paths, arrays, and lists and mappings of these"
    return RecordTypeError(Problem(message=message, mark=Mark(file="dh2urdf"), accepted=accepted))
