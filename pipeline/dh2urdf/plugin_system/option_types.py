"""What the types of an options dataclass mean, in words."""

from __future__ import annotations

from dataclasses import MISSING, asdict, fields, is_dataclass
from enum import Enum
from pathlib import Path
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

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
_BOUNDS = {"gt": "greater than", "ge": "from", "lt": "below", "le": "to"}


NUMBER: dict[str, Any] = {"type": ["number", "string"], "minLength": 1}
"""The JSON Schema of a number, or of the text of an expression."""


class Words(NamedTuple):
    """What a type takes, in words: in the metadata of an annotated type."""

    text: str


class WrittenNumber(NamedTuple):
    """What a text takes that may be a bare number, too, and stays as it is written: ``+0.1`` keeps its sign."""

    text: str

    def __get_pydantic_json_schema__(self, _core: object, _handler: object) -> dict[str, Any]:
        return dict(NUMBER)


class Key(NamedTuple):
    """A key of a record: its type, whether it has no default, what it is for, and the word for its `Dimension`.

    A mapping with a word for `others`, such as ``JOINT``, holds all keys of the record that are none of its own.
    """

    hint: Any
    is_needed: bool
    help: str
    measures: str | None
    others: str | None = None


def keys_of(kind: Any) -> dict[str, Key]:  # noqa: ANN401 - a dataclass
    """The keys of a record, by the names that people write."""
    hints = type_hints(kind)
    keys = {}
    for field in fields(kind):
        if field.init:
            hint, data = hints[field.name], field.metadata
            aliases = [alias for part in getattr(hint, "__metadata__", ()) if (alias := getattr(part, "alias", None))]
            is_needed = field.default is MISSING and field.default_factory is MISSING
            name = str([*aliases, field.name][0])
            keys[name] = Key(hint, is_needed, str(data.get("help", "")), data.get("measures"), data.get("others"))
    return keys


def describe_options(options_type: type[Any]) -> list[tuple[str, str, str, str]]:
    """Every option of a stage: its name, what it takes, what it is by default, and what it is for."""
    defaults = [default_text(field) for field in fields(options_type) if field.init]
    return [
        (key.others or name, type_text(key.hint, measures=key.measures is not None), default, key.help)
        for (name, key), default in zip(keys_of(options_type).items(), defaults, strict=True)
    ]


def type_hints(options_type: type[Any]) -> dict[str, Any]:
    """The types of the options; where they cannot be resolved, the annotations as they are written."""
    written = {field.name: field.type for field in fields(options_type) if field.init}
    try:
        hints = get_type_hints(options_type, include_extras=True)
    except NameError:  # a name that is imported for type checkers only
        return written
    return {name: hints[name] for name in written}


def members(hint: Any) -> tuple[Any, ...]:  # noqa: ANN401 - any type
    """The types of a union; of anything else, itself."""
    if get_origin(hint) is Annotated:
        return members(get_args(hint)[0])
    if get_origin(hint) in (Union, UnionType):
        return tuple(inner for member in get_args(hint) for inner in members(member))
    return (hint,)


def records_of(hint: Any) -> list[type[Any]]:  # noqa: ANN401 - any type
    """The dataclasses among the types of a union."""
    return [member for member in members(hint) if isinstance(member, type) and is_dataclass(member)]


def choices(hint: Any) -> list[str]:  # noqa: ANN401 - any type
    """The words that a type lists."""
    found: list[str] = []
    for member in members(hint):
        if get_origin(member) is Literal:
            found += [str(value) for value in get_args(member)]
        elif isinstance(member, type) and issubclass(member, Enum):
            found += [str(item.value) for item in member]
    return found


def takes_text(hint: Any, value: object) -> bool:  # noqa: ANN401 - any type
    """Whether a value is meant as the text that it is written as: `007` where only a text is accepted."""
    kinds = {get_origin(kind) or kind for kind in members(hint)}
    if isinstance(value, str) or (isinstance(value, dict) and records_of(hint)):
        return False
    own: dict[type, set[Any]] = {float: {float}, int: {int, float}, list: {list, tuple, set, frozenset}}
    has_own = Any in kinds or not kinds.isdisjoint(own.get(type(value), {type(value)}))
    is_text = Literal in kinds or bool(choices(hint)) or not kinds.isdisjoint({str, Path})
    return is_text and not has_own


def type_text(hint: Any, *, measures: bool = False) -> str:  # noqa: ANN401 - any type
    """What a type takes, in words: ``exact or paper``, ``auto or a whole number``, ``a list of 3, each a number``.

    `measures` is whether its numbers may have a unit.
    """
    if measures:
        return type_text(hint).replace("a number", "a number with or without a unit")
    if get_origin(hint) is Annotated:
        said = next((part.text for part in hint.__metadata__ if isinstance(part, Words | WrittenNumber)), None)
        return said or type_text(get_args(hint)[0]) + _bounds_text(hint.__metadata__)
    if get_origin(hint) in (Union, UnionType):
        return _or(type_text(member) for member in get_args(hint) if member is not NoneType)
    if words := choices(hint):
        return _or(words)
    mapping = f"a mapping of {', '.join(keys_of(hint))}" if is_dataclass(hint) else None
    if get_origin(hint) is dict and (entry := get_args(hint)[1]) is not Any:
        mapping = f"a mapping, each entry {type_text(entry)}"
    known = _WORDS.get(hint) or mapping or _list_text(hint) or _WORDS.get(get_origin(hint))
    return known or str(getattr(hint, "__name__", hint))


def _bounds_text(metadata: tuple[Any, ...]) -> str:
    """The bounds of a number, as pydantic's `Field` or `annotated_types` have them: `` from 1 to 10``."""
    parts = [part for each in metadata for part in getattr(each, "metadata", (each,))]
    bounds = [(words, getattr(part, name, None)) for part in parts for name, words in _BOUNDS.items()]
    return "".join(f" {words} {bound}" for words, bound in bounds if bound is not None)


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
