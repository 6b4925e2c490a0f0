"""Reads a run file as its keys are declared, and gathers all that is wrong with it instead of stopping at the first.

A `Record` declares the keys of a mapping and what is made of their values, `Many` a list. Both read nodes, and have the
JSON Schema of what they read. What is made may refuse its values by a `ConfigError`: its problems get the places of the
keys that they name.
"""

from __future__ import annotations

import inspect
from contextlib import contextmanager
from dataclasses import field as attribute, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, TypeVar

from dh2urdf.documents.document import Node
from dh2urdf.errors import ConfigError
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.source import Mark, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from dh2urdf.plugin_system.catalog import Catalog

T = TypeVar("T")
JsonSchema: TypeAlias = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Validator:
    """What is wrong with a run file, and where its paths begin.

    Attributes:
        problems: what is wrong; whatever reads a value adds to it.
        folder: the folder of the run file.
        changes: the file that marks name where a value is a change of the run file.
    """

    problems: list[Problem] = attribute(default_factory=list)
    folder: Path = Path()
    changes: str = ""

    def folder_of(self, node: Node) -> Path:
        """The folder of a path in the run file is that of the file, of one in a change the working directory."""
        return Path() if node.file == self.changes else self.folder

    def add_problem(
        self,
        message: str,
        node: Node,
        field: str,
        *,
        mark: Mark | None = None,
        found: str | None = None,
        accepted: str | None = None,
        suggestion: str | None = None,
    ) -> None:
        """Note a problem, at the node unless `mark` says where."""
        self.problems.append(
            Problem(
                message=message,
                mark=mark or node.mark,
                field=field or None,
                found=found or node.text,
                accepted=accepted,
                suggestion=suggestion,
            )
        )

    @contextmanager
    def noting(self, node: Node, field: str) -> Iterator[None]:
        """Note the problems of a `ConfigError`: at the key of a mapping that a problem names, or at the node."""
        try:
            yield
        except ConfigError as error:
            for problem in error.problems:
                at = node.value.get(problem.field or "", node) if isinstance(node.value, dict) else node
                self.problems.append(
                    replace(
                        problem,
                        mark=problem.mark or at.mark,
                        field=f"{field}.{problem.field}" if problem.field else field,
                        found=problem.found or at.text,
                    )
                )


@contextmanager
def naming(field: str) -> Iterator[None]:
    """Name the key that the problems of a `ConfigError` are about."""
    try:
        yield
    except ConfigError as error:
        raise ConfigError([replace(problem, field=field) for problem in error.problems]) from None


class ValueType(Generic[T]):
    """What a key of a run file accepts.

    Attributes:
        null_is_absent: whether an empty value is the same as none.
    """

    def __init__(
        self,
        take: Callable[[Node, str, Validator], T | None],
        keywords: JsonSchema | Callable[[Catalog], JsonSchema],
        *,
        null_is_absent: bool = False,
    ) -> None:
        """Declare it.

        Args:
            take: gives the value of a node; None where it has told the validator what is wrong with it.
            keywords: its JSON Schema, which may depend on the stages that are installed.
            null_is_absent: whether an empty value is the same as none.
        """
        self.null_is_absent = null_is_absent
        self._take, self._keywords = take, keywords

    def read(self, node: Node, field: str, to: Validator) -> T | None:
        """The value; None where the validator got a problem with it."""
        return self._take(node, field, to)

    def schema(self, catalog: Catalog) -> JsonSchema:
        """The JSON Schema of what it accepts."""
        return self._keywords(catalog) if callable(self._keywords) else dict(self._keywords)

    def long_form(self, node: Node) -> Node:
        """The value in its long form, where it has a short one, and so all values in it."""
        return node


class Key(NamedTuple):
    """A key of a mapping.

    Attributes:
        kind: what it accepts.
        help: what it is for.
        missing: what is wrong where it is absent, and what is accepted; None where it may be absent.
        is_vital: whether nothing can be made of a mapping in which there is a problem with its value.
    """

    kind: ValueType[Any]
    help: str = ""
    missing: tuple[str, str] | None = None
    is_vital: bool = True


class Record(ValueType[T]):
    """A mapping of known keys, of which a record is made."""

    def __init__(
        self,
        make: Callable[..., T],
        keys: Mapping[str, Key],
        *,
        short: str | None = None,
        marks: Mapping[str, tuple[str, ...]] | None = None,
        elsewhere: Mapping[str, tuple[str, str]] | None = None,
        also: JsonSchema | None = None,
        null_is_absent: bool = False,
    ) -> None:
        """Declare a mapping.

        Args:
            make: makes the record of the values, by the names of the keys; absent ones are left to its defaults.
            keys: the keys, in the order in which messages list them.
            short: the key that a text alone is the value of.
            marks: arguments of `make` that are places: that of the first of these keys which is there, of the mapping
                itself for an empty name.
            elsewhere: keys that belong into another section: the message about each, and what is accepted.
            also: more keywords of its JSON Schema.
            null_is_absent: whether an empty value is the same as none.
        """
        super().__init__(self._record, self._mapping, null_is_absent=null_is_absent)
        self.make, self.keys, self.short = make, keys, short
        self.marks, self.elsewhere, self.also = marks or {}, elsewhere or {}, also or {}
        self._arguments = inspect.signature(make).parameters

    def _record(self, node: Node, field: str, to: Validator) -> T | None:
        """The record; None where it cannot be made."""
        node = self._written_out(node)
        if not isinstance(node.value, dict):
            accepted = f"a mapping of {', '.join(self.keys)}"
            to.add_problem(f"this cannot be {node.describe()}", node, field, accepted=accepted)
            return None
        unknown = [name for name in node.value if name not in self.keys]
        for name in unknown:
            self._refuse(name, node, field, to)
        values: dict[str, Any] = {}
        is_made = True
        for name, key in self.keys.items():
            before = len(to.problems)
            place, given = f"{field}.{name}".lstrip("."), node.value.get(name)
            if given is not None and not (given.value is None and key.kind.null_is_absent):
                if (value := key.kind.read(given, place, to)) is not None:
                    values[name] = value
                is_made = is_made and not (key.is_vital and len(to.problems) > before)
            elif key.missing and not any(did_you_mean(other, [name]) for other in unknown):
                to.add_problem(key.missing[0], node, place, accepted=key.missing[1])
        if not is_made or any(key.missing and name not in values for name, key in self.keys.items()):
            return None
        return self._made(values, node, field, to)

    def _refuse(self, key: str, node: Node, field: str, to: Validator) -> None:
        """Says that there is no such key here."""
        message, accepted = self.elsewhere.get(key, (f"a run file has no {shown(key)} here", ", ".join(self.keys)))
        near = None if key in self.elsewhere else did_you_mean(key, self.keys)
        if near is None and "options" in self.keys:
            near = "the options of a stage stand under `options:`"
            if isinstance(node.value, dict) and "stage" not in node.value and isinstance(node.value[key].value, dict):
                near += f", as in `{{stage: {shown(key)[1:-1]}, options: {{…}}}}`"
        place = f"{field}.{key}".lstrip(".")
        to.add_problem(message, node, place, mark=node.key_mark(key), found=key, accepted=accepted, suggestion=near)

    def _made(self, values: dict[str, Any], node: Node, field: str, to: Validator) -> T | None:
        given = {"": node} | ({key: node.value[key] for key in values} if isinstance(node.value, dict) else {})
        places = {name: [given[key].mark for key in keys if key in given] for name, keys in self.marks.items()}
        with to.noting(node, field):
            return self.make(**values, **{name: marks[0] if marks else None for name, marks in places.items()})
        return None

    def _mapping(self, catalog: Catalog) -> JsonSchema:
        """A mapping, or what its short form accepts."""
        properties: dict[str, Any] = {}
        for name, key in self.keys.items():
            properties[name] = key.kind.schema(catalog) | ({"description": key.help} if key.help else {})
            default = self._arguments[name].default if name in self._arguments else None
            if isinstance(default, (bool, int, float, str)):
                properties[name] |= {"default": default}
        mapping = {"type": "object", "properties": properties, "additionalProperties": False, **self.also}
        if needed := [name for name, key in self.keys.items() if key.missing]:
            mapping["required"] = [*needed, *self.also.get("required", ())]
        return {"anyOf": [properties[self.short], mapping]} if self.short else mapping

    def long_form(self, node: Node) -> Node:
        """A mapping for a text alone, and the same for the mappings in it; a list in it stays as it is written."""
        node = self._written_out(node)
        if not isinstance(node.value, dict):
            return node
        inner = {
            name: key.kind.long_form(node.value[name])
            for name, key in self.keys.items()
            if name in node.value and isinstance(key.kind, Record)
        }
        return mapping_node({**node.value, **inner}, node)

    def _written_out(self, node: Node) -> Node:
        is_short = self.short and not isinstance(node.value, (dict, list)) and node.value is not None
        return mapping_node({self.short: node}, node) if self.short and is_short else node


class Distinct(NamedTuple):
    """A name that no two entries of a list have in common.

    Attributes:
        name: the attribute of an entry that has it, or None.
        message: what is wrong with two of a name.
        accepted: what is accepted.
        key: two names are the same where this is.
    """

    name: str
    message: str
    accepted: str
    key: Callable[[str], str] = str


class Many(ValueType[tuple[T, ...]]):
    """A list of entries of one kind."""

    def __init__(
        self,
        entry: ValueType[T],
        *,
        empty: tuple[str, str] | None = None,
        takes_one: bool = True,
        distinct: Distinct | None = None,
    ) -> None:
        """Declare a list.

        Args:
            entry: what each entry is.
            empty: what is wrong with an empty list, and what is accepted; None where it may be empty.
            takes_one: whether an entry alone stands for a list of it.
            distinct: what no two entries have in common.
        """
        super().__init__(self._list, self._array)
        self.entry, self.empty, self.takes_one, self.distinct = entry, empty, takes_one, distinct

    def _entries(self, node: Node) -> list[Node]:
        return node.value if isinstance(node.value, list) else [node] if self.takes_one else []

    def _list(self, node: Node, field: str, to: Validator) -> tuple[T, ...]:
        """The entries that can be made."""
        entries = self._entries(node)
        if self.empty and not entries:
            to.add_problem(self.empty[0], node, field, accepted=self.empty[1])
        taken: list[T] = []
        first: dict[str, Node] = {}
        for index, each in enumerate(entries):
            place = f"{field}.{index}"
            if (value := self.entry.read(each, place, to)) is None:
                continue
            if self.distinct and (name := getattr(value, self.distinct.name)):
                other = first.setdefault(self.distinct.key(name), each)
                if other is not each:
                    message, where = self.distinct.message.format(shown(name)), f"the first is at {other.mark}"
                    to.add_problem(message, each, place, found=name, accepted=self.distinct.accepted, suggestion=where)
                    continue
            taken.append(value)
        return tuple(taken)

    def _array(self, catalog: Catalog) -> JsonSchema:
        """A list, or an entry alone."""
        entry = self.entry.schema(catalog)
        entries = {"type": "array", "items": entry, "minItems": 1 if self.empty else 0}
        return {"anyOf": [entry, entries]} if self.takes_one else entries

    def long_form(self, node: Node) -> Node:
        """A list for an entry alone; its entries in their long form."""
        entries = [self.entry.long_form(entry) for entry in self._entries(node)]
        return Node(entries, node.file, node.line, node.column) if entries else node


def mapping_node(entries: dict[str, Node], at: Node) -> Node:
    """A mapping that stands where another value does."""
    return Node(entries, at.file, at.line, at.column, key_places=at.key_places)
