"""Values of a document as records: pydantic checks them, and what is wrong gets its place in the document.

A record is a dataclass: the options of a stage, or a section of a run file. A field may say in its metadata what it
`measures`: then texts such as ``40 mm`` are numbers in SI units. The checks are strict: ``yes`` is not true, and
``true`` is not 1. A number is a text where a text is wanted: ``007`` is the text that it is written as.
"""

from __future__ import annotations

import re
import sys
from dataclasses import MISSING, fields, replace
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, TypeVar, get_args, get_origin

from dh2urdf.documents.nodes import LARGEST_BARE
from dh2urdf.documents.text_files import tidy_path
from dh2urdf.errors import ConfigError, InputError
from dh2urdf.plugin_system.option_types import choices, keys_of, members, records_of, takes_text, type_text
from dh2urdf.source import Messages, Problem, did_you_mean, in_file_order

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pydantic import TypeAdapter, ValidationError

    from dh2urdf.documents.document import Node

say = Messages(__file__)

T = TypeVar("T")
Keys: TypeAlias = tuple[str | int, ...]
"""Keys and indices that lead from a record to a value in it."""

TOLD_BY_TYPE = frozenset(
    (
        *("string_type", "literal_error", "enum", "missing"),
        *("greater_than", "greater_than_equal", "less_than", "less_than_equal"),
    )
)
"""Errors of pydantic about which the words for the type say enough."""
REFUSED = frozenset({"value_error", "assertion_error"})
"""Errors that the record itself has raised."""


def record_of(kind: type[T], node: Node, *, whose: str, keyword: str = "option", folder: Path | None = None) -> T:
    """A record of a mapping in a document.

    Messages say whose record it is, such as ``the loader 'x'``, and call a key of it by the keyword. Paths are relative
    to the folder of the file; those without a line to the working directory.
    """
    return _Given(kind, node, whose, keyword, folder).record()


def unknown_key(  # noqa: PLR0917 - what it is about
    node: Node, key: str, known: Iterable[str], whose: str, keyword: str, keys: Keys = ()
) -> Problem:
    """The problem that a mapping has a key which is none."""
    near = did_you_mean(key, known)
    if near is None and "options" in known:
        near = "the options of a stage stand under `options:`, as in `{stage: NAME, options: {…}}`"
    return say(
        "key-unknown",
        node.key_mark(key),
        field=dotted((*keys, key)),
        found=key,
        whose=whose,
        keyword=keyword,
        choices=", ".join(known) or f"nothing: it has no {keyword}s",
        suggestion=near,
    )


_ADAPTERS: dict[Any, TypeAdapter[Any]] = {}
"""Pydantic's checks of a type: to make them takes longer than to use them."""


_NO_PLUGINS = "PYDANTIC_DISABLE_PLUGINS"


def adapter_of(kind: Any) -> TypeAdapter[Any]:  # noqa: ANN401 - a dataclass
    """Pydantic's checks of a type, and its JSON Schema.

    Pydantic would look for its own plugins in the metadata of all distributions, and fail at a broken one.
    """
    import os

    from pydantic import TypeAdapter

    if kind not in _ADAPTERS:
        before = os.environ.get(_NO_PLUGINS)
        os.environ[_NO_PLUGINS] = "__all__"
        try:
            _ADAPTERS[kind] = TypeAdapter(kind)
        finally:
            if before is None:
                del os.environ[_NO_PLUGINS]
            else:
                os.environ[_NO_PLUGINS] = before
    return _ADAPTERS[kind]


class _Given(Generic[T]):
    """A mapping on its way to a record.

    Attributes:
        before: what stands before a message that somebody else has worded.
        problems: what is wrong.
        seen: the values by their place, each with its type and whether it may have a unit.
        wrong: the places of values whose problem is noted already.
        unknown: the keys that are none, by the place of their mapping.
        others: the names of mappings that hold the other keys of a record: nobody has written these.
    """

    def __init__(self, kind: type[T], root: Node, whose: str, keyword: str, folder: Path | None) -> None:
        self.kind, self.root, self.whose, self.keyword, self.folder = kind, root, whose, keyword, folder
        self.before = f"{whose}: " if keyword == "option" else ""
        self.problems: list[Problem] = []
        self.seen: dict[Keys, tuple[Node, Any, bool]] = {}
        self.wrong: set[Keys] = set()
        self.unknown: dict[Keys, list[str]] = {}
        self.others: set[str | int] = set()

    def record(self) -> T:
        """The record; see `record_of`."""
        if not isinstance(self.root.value, dict):
            about = {"whose": self.whose, "kind": self.root.describe(), "accepted": type_text(self.kind)}
            self._note("value-of-other-kind", self.root, (), **about)
            raise ConfigError(self.problems)
        values = self._prepared(self.root, self.kind, ())
        try:
            needs = [field for field in fields(self.kind) if field.init]  # type: ignore[arg-type]  # a dataclass
            if values or any(field.default is field.default_factory is MISSING for field in needs):
                record = self._checked(values)
            else:
                record = self.kind()  # without pydantic, whose import takes as long as the conversion of a table
        except InputError as error:  # of the record's own __post_init__
            entries = self.root.value  # Such a problem knows no places.
            owners = [(problem, (problem.field or "").partition(".")[0]) for problem in error.problems]
            self.problems += [problem.about(mark=entries.get(own, self.root).mark) for problem, own in owners]
        except ValueError as error:
            self.problems.append(self._refused(str(error), ()))
        if self.problems:
            raise ConfigError(in_file_order(self.problems))
        return record

    # --- Values for pydantic

    def _prepared(self, node: Node, hint: Any, keys: Keys, measure: str | None = None) -> Any:  # noqa: ANN401
        """A value as JSON has it: without unknown keys, measures in SI units, paths with their folder."""
        self.seen[keys] = node, hint, measure is not None
        value = node.value
        if node.text is not None and value is not None and takes_text(hint, value):
            return node.text
        if isinstance(value, dict):
            return self._prepared_entries(node, value, hint, keys, measure)
        if isinstance(value, list):
            inner = next((get_args(m) for m in members(hint) if get_origin(m) in (list, tuple)), ()) or (Any,)
            last = len(inner) - 1 - (inner[-1] is ...)
            return [
                self._prepared(entry, inner[min(index, last)], (*keys, index), measure)
                for index, entry in enumerate(value)
            ]
        if measure and node.text is not None and node.text not in choices(hint):
            value = self._in_si(node, measure, keys)
        if isinstance(value, (int, float)) and not abs(value) <= sys.float_info.max:  # true of NaN too
            return node.text  # no type takes this text for a number
        if isinstance(value, str) and self.folder and node.line and "\0" not in value and Path in members(hint):
            return str(tidy_path(self.folder / value))
        return value

    def _prepared_entries(
        self,
        node: Node,
        entries: dict[str, Node],
        hint: Any,  # noqa: ANN401 - a type
        keys: Keys,
        measure: str | None,
    ) -> dict[str, Any]:
        """The entries of a mapping, by the keys of the record that they are for."""
        known = {name: key for record in records_of(hint) for name, key in keys_of(record).items()}
        each = next((get_args(member)[1] for member in members(hint) if get_origin(member) is dict), Any)
        made: dict[str, Any] = {}
        for name in [name for name, key in known.items() if key.others]:
            own = known.pop(name)
            others = replace(node, value={key: entry for key, entry in entries.items() if key not in known})
            made[name] = self._prepared(others, own.hint, (*keys, name), own.measures)
            entries = {key: entry for key, entry in entries.items() if key in known}
            self.others.add(name)
        for key, entry in entries.items():
            if key in known:
                made[key] = self._prepared(entry, known[key].hint, (*keys, key), known[key].measures)
            elif known or records_of(hint):
                self.unknown.setdefault(keys, []).append(key)
                self.problems.append(unknown_key(node, key, known, self.whose, self.keyword, keys))
            else:
                made[key] = self._prepared(entry, each, (*keys, key), measure)
        return made

    def _in_si(self, node: Node, measure: str, keys: Keys) -> Any:  # noqa: ANN401 - any value
        """What a text or a large number measures."""
        value = node.value
        is_large = type(value) in (int, float) and not abs(value) <= LARGEST_BARE.get(measure, inf)  # type: ignore[arg-type]
        if not isinstance(value, str) and not is_large:
            return value
        from dh2urdf.documents.measures import measured
        from dh2urdf.quantities import Dimension, QuantityError

        try:
            return measured(node, {each.plain: each for each in Dimension}[measure])
        except QuantityError as error:
            self.wrong.add(keys)
            about = {"accepted": error.accepted, "suggestion": error.suggestion}
            self._note("quantity-refused", node, keys, reason=f"{self.before}{error.message}", **about)
            return 0.0

    def _checked(self, values: Any) -> T:  # noqa: ANN401 - as JSON has it
        """The record as pydantic makes it; what is wrong with the values is among the problems."""
        import json

        from pydantic import ValidationError

        adapter: TypeAdapter[T] = adapter_of(self.kind)
        try:
            # As JSON, since its strict mode takes a list for a tuple and a word for a path or an enumeration.
            return adapter.validate_json(json.dumps(values), strict=True)
        except ValidationError as error:
            self._note_errors(error)
            raise ConfigError([]) from None

    # --- What is wrong

    def _note_errors(self, found: ValidationError) -> None:
        """Note one problem for each value; pydantic reports a union once for each of its types."""
        by_place: dict[Keys, list[Any]] = {}
        for one in found.errors(include_url=False):
            location = one["loc"]  # which may go on with names of types
            places = (location[:depth] for depth in range(len(location), -1, -1))
            by_place.setdefault(next(each for each in places if each in self.seen), []).append(one)
        for keys, errors in by_place.items():
            node = self.seen[keys][0]
            refused = [one["ctx"]["error"] for one in errors if one["type"] in REFUSED]
            missing = [one["loc"][-1] for one in errors if one["type"] == "missing" and isinstance(one["loc"][-1], str)]
            # Of a list with wrong entries, pydantic also reports that too few are left.
            is_told = keys in self.wrong or (node.value and all(one["type"] == "too_short" for one in errors))
            if missing:
                self._note_missing(keys, dict.fromkeys(missing))
            elif refused:
                self.problems.append(self._refused(str(refused[0]), keys))
            elif not is_told:
                self._note_wrong(keys, errors)

    def _note_missing(self, keys: Keys, names: Iterable[str]) -> None:
        """Note keys that must be there; a key that is written in a wrong way is an unknown one, which says enough."""
        node, hint, _ = self.seen[keys]
        known = {name: key for record in records_of(hint) for name, key in keys_of(record).items()}
        for name in names:
            if not any(did_you_mean(word, [name]) for word in self.unknown.get(keys, ())):
                accepted = ": ".join(filter(None, (type_text(known[name].hint), known[name].help)))
                about = {"whose": self.whose, "keyword": self.keyword, "accepted": accepted}
                self._note("key-missing", node, (*keys, name), **about)

    def _note_wrong(self, keys: Keys, errors: list[Any]) -> None:
        node, hint, measures = self.seen[keys]
        accepted = type_text(hint, measures=measures)
        for one in errors:
            if one["type"] not in TOLD_BY_TYPE and one.get("ctx") and one["msg"].startswith("Input should be "):
                accepted += ", " + one["msg"].removeprefix("Input should be ")
        near = did_you_mean(node.text, choices(hint)) if node.text else None
        about = {"whose": self.whose, "kind": node.describe(), "accepted": accepted, "suggestion": near}
        self._note("value-of-other-kind", node, keys, **about)

    def _refused(self, reason: str, keys: Keys) -> Problem:
        """What the record itself refuses: the key that its message speaks of is the place."""
        entries: Any = self.root.value
        words = set(re.findall(r"\w+", reason))
        keys = keys or tuple([name for name in entries if name in words][:1])
        node = self.seen[keys][0]
        about = {"whose": self.whose, "keyword": self.keyword, "reason": reason}
        code = "value-refused" if keys else "record-refused"
        return say(code, node.mark, field=self._field(keys), found=node.text, **about)

    def _field(self, keys: Keys) -> str | None:
        return dotted(tuple([key for key in keys if key not in self.others])) or None

    def _note(self, code: str, node: Node, keys: Keys, **values: Any) -> None:  # noqa: ANN401 - of a message
        self.problems.append(say(code, node.mark, field=self._field(keys), found=node.text, **values))


def dotted(keys: Keys) -> str:
    """A place as messages name it: ``bodies.1.radius``."""
    return ".".join(map(str, keys))
