"""Arguments of the functions of a program, refused where they are nothing that a function can use.

Each function has the name of an argument, what is given for it and the place for messages, and raises a ConfigError.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import ConfigError
from dh2urdf.source import Problem

if TYPE_CHECKING:
    from dh2urdf.source import Mark


def a_name(argument: str, value: Any, mark: Mark) -> str:  # noqa: ANN401 - whatever is given
    """A name: a text that is not empty."""
    if not isinstance(value, str) or not value.strip():
        raise _wrong(argument, value, mark, "no name", "a text, not empty")
    return value


def check_names(mark: Mark, **given: Any) -> None:  # noqa: ANN401 - whatever is given
    """Names that may be left out."""
    for argument, value in given.items():
        if value is not None:
            a_name(argument, value, mark)


def check_flags(mark: Mark, **given: Any) -> None:  # noqa: ANN401 - whatever is given
    """Flags: True or False, and no text such as ``no``, which would be true."""
    for argument, value in given.items():
        if not isinstance(value, bool):
            raise _wrong(argument, value, mark, "neither True nor False", "True or False")


def a_path(argument: str, value: Any, mark: Mark, *, also: str = "") -> str:  # noqa: ANN401 - whatever is given
    """A path or an address. An empty text would be the working directory, which nobody means."""
    path = os.fspath(value) if isinstance(value, (str, os.PathLike)) else None
    if not isinstance(path, str) or not path:
        raise _wrong(argument, value, mark, "no path", f"a text, not empty, or a pathlib.Path{also}")
    return path


def path_or_none(argument: str, value: Any, mark: Mark) -> str | None:  # noqa: ANN401 - whatever is given
    """A path that may be left out."""
    return None if value is None else a_path(argument, value, mark)


def several(argument: str, value: Any, mark: Mark, *, one: type | tuple[type, ...] = str) -> tuple[Any, ...]:  # noqa: ANN401
    """Several of something, or one, which has one of the given types."""
    if isinstance(value, one):
        return (value,)
    if isinstance(value, (str, bytes, Mapping)) or not isinstance(value, Iterable):
        raise _wrong(argument, value, mark, "no list", "a list, which may be empty")
    return tuple(value)


def mapping(argument: str, value: Any, mark: Mark, *, such_as: str) -> Mapping[str, object]:  # noqa: ANN401
    """A mapping, which is empty where none is given."""
    if value is not None and not isinstance(value, Mapping):
        raise _wrong(argument, value, mark, "no mapping", f"a mapping, such as {such_as}")
    return value or {}


def _wrong(argument: str, value: object, mark: Mark, what: str, accepted: str) -> ConfigError:
    message = f"{argument}={value!r:.60} is {what}"
    return ConfigError(Problem(message=message, mark=mark, field=argument, accepted=accepted))
