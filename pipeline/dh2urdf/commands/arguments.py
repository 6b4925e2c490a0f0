"""Arguments of the functions of a program, refused where they are nothing that a function can use.

Each function has the place for messages, and raises a ConfigError that names the argument.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import ConfigError
from dh2urdf.source import Problem

if TYPE_CHECKING:
    from dh2urdf.source import Mark

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
    """Arguments of a kind: a name, a path, a list or a mapping; or a flag, and no text such as ``no``."""
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
