"""Options of a stage: from what a person wrote to an instance of the stage's options dataclass.

A run file gives nodes, the command line gives words; both come through `make_options`. Words, truth values and
numbers are checked here; anything else is left to pydantic, whose import alone costs as much as converting a table, and
which finds everything that is wrong at once. The checks are strict: ``yes`` is not true, and ``true`` is not 1.
"""

from __future__ import annotations

import math
import re
import sys
from dataclasses import MISSING, fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeAlias, TypeVar, get_args, get_origin

from dh2urdf.documents.document import Node, expect_mapping, load_yaml
from dh2urdf.documents.nodes import LARGEST_BARE
from dh2urdf.documents.text_files import tidy_path
from dh2urdf.errors import BrokenPluginError, ConfigError, InputError
from dh2urdf.plugin_system.discovery import UNKNOWN, reason_of, traceback_of
from dh2urdf.plugin_system.option_types import (
    choices,
    describe_options,
    measures_of,
    members,
    option_text,
    type_hints,
    type_text,
)
from dh2urdf.source import Mark, Problem, did_you_mean, in_file_order

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from dh2urdf.plugin_system.discovery import Plugin

__all__ = ["COMMAND_LINE", "describe_options", "make_options", "word_node"]

O = TypeVar("O")  # noqa: E741 - the options type of a stage
_Keys: TypeAlias = tuple[str | int, ...]
"""Keys and indices that lead from the options to a value in them."""

COMMAND_LINE = Mark(file="command line")
_UNDECIDED = object()
_LARGEST = 2**53
"""Whole numbers up to this are doubles, too."""
_TEXT_MAY_DO = frozenset({"string_type", "literal_error", "enum"})
"""Errors of pydantic that a value's own text may fix: where a text is wanted, the number 007 is the text ``007``."""


def make_options(
    options_type: type[O],
    given: Node | Mapping[str, str] | None = None,
    *,
    mark: Mark | None = None,
    where: str,
    plugin: Plugin | None = None,
    folder: Path | None = None,
) -> O:
    """The options of a stage, checked.

    Args:
        options_type: the stage's options dataclass.
        given: what the user wrote: a mapping in a file, or words of the command line by option.
        mark: where the stage is named, for what has no place of its own, such as a word.
        where: the stage, for messages, such as ``emitter 'urdf'``.
        plugin: who provides the stage, for messages.
        folder: that of the file that `given` is in, which paths are relative to; those of the command line are relative
            to the working directory.

    Raises:
        ConfigError: options are unknown, missing or not what they should be; all problems are reported at once.
        BrokenPluginError: the stage's options type itself does not work.
    """
    try:
        if isinstance(given, Node):
            expect_mapping(given, f"the options of the {where}")
            return _GivenOptions(options_type, given, given.mark, where, folder).options()
        place = mark or COMMAND_LINE
        words = {name: word_node(word, place.file) for name, word in (given or {}).items()}
        return _GivenOptions(options_type, Node(words, place.file, 0, 0), place, where).options()
    except (InputError, KeyboardInterrupt):
        raise
    except BaseException as error:
        told = reason_of(error).partition("; ")[0]
        reason = f"the options type {options_type.__name__} of the {where} does not work: {told}"
        name, whose = (plugin.name, plugin.distribution) if plugin else (options_type.__module__, UNKNOWN)
        raise BrokenPluginError(name, whose, reason, traceback_of(error)) from error


def word_node(word: str, file: str = COMMAND_LINE.file) -> Node:
    """A word of the command line as a value: it is read as YAML, and is a text where it is none."""
    try:
        node = load_yaml(word, file)
    except InputError:
        return Node(word, file, 0, 0, word)
    if node.text is not None and not node.quoted and node.text != word.strip():
        return Node(word, file, 0, 0, word)  # `a #b`: nobody writes comments there
    if node.text is None:
        node.text = word  # for options that are texts with an inner form, such as a transform
    waiting = [node]
    while waiting:
        inner = waiting.pop()
        inner.line = inner.column = 0  # The command line has no places.
        inner.key_places = {}
        if isinstance(inner.value, dict):
            waiting += inner.value.values()
        elif isinstance(inner.value, list):
            waiting += inner.value
    return node


class _GivenOptions(Generic[O]):
    """Options on their way from what was written to an instance of their type."""

    def __init__(self, options_type: type[O], given: Node, mark: Mark, where: str, folder: Path | None = None) -> None:
        self.type = options_type
        self.given = given
        self.folder = folder
        self.mark = mark
        self.where = where

    def options(self) -> O:
        """The instance; see `make_options`."""
        problems = list(self._unknown(self.type, self.given))
        entries = self._entries()
        hints = type_hints(self.type) if entries else {}
        nodes = {name: self._placed(hints[name], node) for name, node in entries.items() if name in hints}
        measures = measures_of(self.type)
        misfits: list[Problem] = []
        for name in nodes.keys() & measures.keys():
            nodes[name] = self._in_si(nodes[name], hints[name], measures[name], (name,), misfits)
        if misfits:
            raise ConfigError(in_file_order([*problems, *misfits]))
        try:
            values = {name: _decided(hints[name], node) for name, node in nodes.items()}
            if _UNDECIDED in values.values() or self._required() - set(values):
                options = self._validated(nodes)
            else:
                options = self.type(**values)
        except InputError as error:  # from here, or from the type's own __post_init__
            problems += [problem.about(mark=self._mark_of(problem.field)) for problem in error.problems]
        except ValueError as error:
            problems.append(self._refused(str(error), ()))
        if problems:
            raise ConfigError(in_file_order(problems))
        return options

    def _placed(self, hint: Any, node: Node) -> Node:  # noqa: ANN401 - any type
        """The value of an option, where it is a path with its folder before it."""
        if (
            not self.folder
            or not node.line
            or not isinstance(node.value, str)
            or "\0" in node.value
            or Path not in members(hint)
        ):
            return node
        path = str(tidy_path(self.folder / node.value))
        return Node(path, node.file, node.line, node.column, path)

    def _in_si(self, node: Node, hint: Any, measure: str, keys: _Keys, misfits: list[Problem]) -> Node:  # noqa: ANN401
        """The value of an option that measures something: its texts as numbers; what is none is among the misfits."""
        value: Any = node.value
        if isinstance(value, list):
            entries = [self._in_si(each, hint, measure, (*keys, k), misfits) for k, each in enumerate(value)]
            return Node(entries, node.file, node.line, node.column)
        is_odd = type(value) in (int, float) and not abs(value) <= LARGEST_BARE.get(measure, math.inf)
        if not (isinstance(value, str) or is_odd) or node.text in choices(hint):
            return node
        from dh2urdf.documents.measures import measured
        from dh2urdf.quantities import Dimension, QuantityError

        try:
            value = measured(node, {each.plain: each for each in Dimension}[measure])
        except QuantityError as error:
            misfits.append(
                Problem(
                    message=f"the {self.where}: {error.message}",
                    mark=node.mark if node.line else self.mark,
                    field=_dotted(keys),
                    found=node.text,
                    accepted=error.accepted,
                    suggestion=error.suggestion,
                )
            )
        return Node(value, node.file, node.line, node.column, node.text)

    def _entries(self) -> dict[str, Node]:
        return self.given.value if isinstance(self.given.value, dict) else {}

    def _mark_of(self, field: str | None) -> Mark:
        """Where an option stands; where it stands nowhere, the place of all."""
        node = self._entries().get((field or "").partition(".")[0])
        return node.mark if node and node.line else self.mark

    def _required(self) -> set[str]:
        return {
            field.name
            for field in fields(self.type)  # type: ignore[arg-type] # an options type is a dataclass
            if field.init and field.default is MISSING and field.default_factory is MISSING
        }

    def _validated(self, nodes: dict[str, Node]) -> O:
        """The instance as pydantic makes it.

        Raises:
            ConfigError: with everything that pydantic finds wrong.
        """
        import json

        from pydantic import TypeAdapter, ValidationError

        adapter = TypeAdapter(self.type)
        values = {name: _json_value(node) for name, node in nodes.items()}
        put_right = [True]
        while any(put_right):
            try:
                # As JSON, since its strict mode takes a list for a tuple and a word for a path or an enumeration.
                return adapter.validate_json(json.dumps(values), strict=True)
            except ValidationError as error:
                found = error.errors(include_url=False)
            put_right = [_put_text(values, *self._follow(one["loc"])) for one in found if one["type"] in _TEXT_MAY_DO]
        by_place: dict[_Keys, list[Any]] = {}
        for one in found:
            by_place.setdefault(self._follow(one["loc"])[0], []).append(one)
        raise ConfigError(self._problem(keys, errors) for keys, errors in by_place.items())

    # --- What is wrong

    def _unknown(self, hint: Any, node: Node, keys: _Keys = ()) -> Iterator[Problem]:  # noqa: ANN401 - any type
        """Keys that no field has, here and in options that are dataclasses themselves."""
        value = node.value
        if isinstance(value, list):
            for entry_hint in (get_args(member)[0] for member in members(hint) if get_origin(member) in (list, tuple)):
                for index, entry in enumerate(value):
                    yield from self._unknown(entry_hint, entry, (*keys, index))
        if not value or not isinstance(value, dict) or not (records := _records(hint)):
            return
        known = {name: hint for record in records for name, hint in type_hints(record).items()}
        for key, entry in value.items():
            if key in known:
                yield from self._unknown(known[key], entry, (*keys, key))
                continue
            yield Problem(
                message=f"the {self.where} has no such option",
                mark=node.key_mark(key),
                field=_dotted((*keys, key)),
                found=key,
                accepted=", ".join(known) or "nothing: it has no options",
                suggestion=did_you_mean(key, known),
            )

    def _follow(self, location: _Keys) -> tuple[_Keys, Node]:
        """The value that an error of pydantic is about; its location may go on with names of types."""
        node = self.given
        for depth, key in enumerate(location):
            if isinstance(node.value, dict) and key in node.value:
                node = node.value[str(key)]
            elif isinstance(node.value, list) and isinstance(key, int) and key < len(node.value):
                node = node.value[key]
            else:
                return location[:depth], node
        return location, node

    def _hint(self, keys: _Keys) -> Any:  # noqa: ANN401 - any type
        """The type of an option, or of a field in it."""
        hint: Any = self.type
        for key in keys:
            known = {name: hint for record in _records(hint) for name, hint in type_hints(record).items()}
            if key not in known:
                break
            hint = known[str(key)]
        return hint

    def _problem(self, keys: _Keys, errors: list[Any]) -> Problem:
        """One problem for all that pydantic reports about one value; pydantic reports a union once per member."""
        _, node = self._follow(keys)
        missing = [one["loc"] for one in errors if one["type"] == "missing" and isinstance(one["loc"][-1], str)]
        if missing:
            absent = (*keys, missing[0][-1])
            return Problem(
                message=f"the {self.where} needs this option",
                mark=node.mark if node.line else self.mark,
                field=_dotted(absent),
                accepted=type_text(self._hint(absent)),
            )
        for one in errors:
            if one["type"] in ("value_error", "assertion_error"):
                return self._refused(str(one["ctx"]["error"]), keys)
        hint = self._hint(keys)
        accepted = option_text(hint, measures=bool(keys) and keys[0] in measures_of(self.type))
        for one in errors:
            if one.get("ctx") and one["type"] not in _TEXT_MAY_DO and one["msg"].startswith("Input should be "):
                accepted += ", " + one["msg"].removeprefix("Input should be ")
        return Problem(
            message=f"the {self.where} cannot take {node.describe()} here",
            mark=node.mark,
            field=_dotted(keys),
            found=node.text,
            accepted=accepted,
            suggestion=did_you_mean(node.text, choices(hint)) if node.text else None,
        )

    def _refused(self, reason: str, keys: _Keys) -> Problem:
        """What the options type itself refuses: the option that its message speaks of is the place."""
        words = set(re.findall(r"\w+", reason))
        named = [name for name in self._entries() if name in words]
        if not keys and named:
            keys = (named[0],)
        _, node = self._follow(keys)
        return Problem(
            message=f"the {self.where} refuses its options: {reason}" if not keys else f"the {self.where}: {reason}",
            mark=node.mark if keys else self.mark,
            field=_dotted(keys) or None,
            found=node.text,
        )


def _records(hint: Any) -> list[type[Any]]:  # noqa: ANN401 - any type
    """The dataclasses among the types of a union."""
    return [member for member in members(hint) if isinstance(member, type) and is_dataclass(member)]


def _decided(hint: Any, node: Node) -> Any:  # noqa: ANN401 - any type
    """The value of an option that is plainly a word, a truth value or a number, or that it is undecided."""
    for member in members(hint):
        if get_origin(member) is Literal and node.text in get_args(member) and node.value is not None:
            return node.text
        if member is bool and isinstance(node.value, bool):
            return node.value
        if member is str and isinstance(node.value, str):
            return node.value
        if type(node.value) is int and abs(node.value) <= _LARGEST and member in (int, float):
            return node.value if int in members(hint) else float(node.value)
        if member is float and isinstance(node.value, float) and math.isfinite(node.value):
            return node.value
    return _UNDECIDED


def _json_value(node: Node) -> Any:  # noqa: ANN401 - any value
    """A value for JSON; a number beyond the largest double stays a text, which no option takes for a number."""
    if isinstance(node.value, dict):
        return {key: _json_value(entry) for key, entry in node.value.items()}
    if isinstance(node.value, list):
        return [_json_value(entry) for entry in node.value]
    if isinstance(node.value, (int, float)) and not abs(node.value) <= sys.float_info.max:  # true of NaN too
        return node.text
    return node.value


def _put_text(values: Any, keys: _Keys, node: Node) -> bool:  # noqa: ANN401 - any value
    """Puts a value's own text in its place; says whether that changes anything."""
    if node.text is None or node.value is None or not keys:
        return False
    for key in keys[:-1]:
        values = values[key]
    changes = values[keys[-1]] != node.text
    values[keys[-1]] = node.text
    return bool(changes)


def _dotted(keys: _Keys) -> str:
    return ".".join(str(key) for key in keys)
