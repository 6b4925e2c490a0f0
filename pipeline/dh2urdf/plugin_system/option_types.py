"""What the types of an options dataclass mean, in words."""

from __future__ import annotations

from dataclasses import MISSING, asdict, fields, is_dataclass
from enum import Enum
from pathlib import Path
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

if TYPE_CHECKING:
    from collections.abc import Iterable
    from dataclasses import Field

_WORDS: dict[Any, str] = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    str: "a text",
    Path: "a path",
    dict: "a mapping",
    Any: "any value",
    NoneType: "none",
}


def describe_options(options_type: type[Any]) -> list[tuple[str, str, str, str]]:
    """Every option of a stage: its name, what it takes, what it is by default, and what it is for."""
    hints = type_hints(options_type)
    measures = measures_of(options_type)
    return [
        (
            field.name,
            option_text(hints[field.name], measures=field.name in measures),
            default_text(field),
            str(field.metadata.get("help", "")),
        )
        for field in fields(options_type)
        if field.name in hints
    ]


def type_hints(options_type: type[Any]) -> dict[str, Any]:
    """The types of the options; where they cannot be resolved, the annotations as they are written."""
    written = {field.name: field.type for field in fields(options_type) if field.init}
    try:
        hints = get_type_hints(options_type, include_extras=True)
    except NameError:  # a name that is imported for type checkers only
        return written
    return {name: hints[name] for name in written}


def measures_of(options_type: type[Any]) -> dict[str, str]:
    """What the options measure that may have units, such as `length`: the words of `dh2urdf.quantities.Dimension`."""
    return {field.name: field.metadata["measures"] for field in fields(options_type) if "measures" in field.metadata}


def members(hint: Any) -> tuple[Any, ...]:  # noqa: ANN401 - any type
    """The types of a union; of anything else, itself."""
    return get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)


def choices(hint: Any) -> list[str]:  # noqa: ANN401 - any type
    """The words that a type lists."""
    found: list[str] = []
    for member in members(hint):
        if get_origin(member) is Literal:
            found += [str(value) for value in get_args(member)]
        elif isinstance(member, type) and issubclass(member, Enum):
            found += [str(item.value) for item in member]
    return found


def option_text(hint: Any, *, measures: bool) -> str:  # noqa: ANN401 - any type
    """What an option takes, in words."""
    return type_text(hint).replace("a number", "a number with or without a unit") if measures else type_text(hint)


def type_text(hint: Any) -> str:  # noqa: ANN401 - any type
    """What a type takes, in words: ``exact or paper``, ``auto or a whole number``, ``a list of 3 numbers``."""
    if get_origin(hint) is Annotated:
        return type_text(get_args(hint)[0])
    if get_origin(hint) in (Union, UnionType):
        return _or(type_text(member) for member in members(hint) if member is not NoneType)
    if words := choices(hint):
        return _or(words)
    if hint in _WORDS:
        return _WORDS[hint]
    if is_dataclass(hint):
        return f"a mapping of {', '.join(field.name for field in fields(hint))}"
    return _list_text(hint) or _WORDS.get(get_origin(hint)) or str(getattr(hint, "__name__", hint))


def default_text(field: Field[Any]) -> str:
    """The default of an option, as a run file would write it."""
    default = field.default
    if field.default_factory is not MISSING:
        default = field.default_factory()
    if default is MISSING:
        return "required"
    if default is None:
        return "none"
    if isinstance(default, str):
        return str(default)
    if isinstance(default, float) and default.is_integer():
        return str(int(default))
    import json

    return json.dumps(
        asdict(default) if is_dataclass(default) and not isinstance(default, type) else default, default=str
    )


def _list_text(hint: Any) -> str | None:  # noqa: ANN401 - any type
    """``a list of numbers`` and the like, or None where the type is no list."""
    origin, entries = get_origin(hint), get_args(hint)
    if not (isinstance(origin, type) and issubclass(origin, (list, tuple, set, frozenset))) or not entries:
        return "a list" if hint in (list, tuple) else None
    if origin is tuple and Ellipsis not in entries:
        if len(set(entries)) == 1:
            return f"a list of {len(entries)}, each {type_text(entries[0])}"
        return f"a list of {', '.join(map(type_text, entries))}"
    return "a list" if entries[0] is Any else f"a list, each entry {type_text(entries[0])}"


def _or(words: Iterable[str]) -> str:
    *others, last = dict.fromkeys(words)
    return f"{', '.join(others)} or {last}" if others else last
