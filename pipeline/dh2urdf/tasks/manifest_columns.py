"""Rows of a manifest as columns: what its table has of them, which workers make of rows that they have at hand."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.late_tuples import NamedTuple
from dh2urdf.results.run import FileEntry

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.conversion.outcome import ManifestRow


class Lists(NamedTuple):
    """A column of lists.

    Attributes:
        counts: how long the list of each row is.
        entries: what is in them, one behind the other; of records a column for each key.
    """

    counts: Sequence[int]
    entries: Sequence[Any] | Mapping[str, Sequence[Any]]


Column: TypeAlias = "Sequence[Any] | Lists"
"""The values of a column, None where there is none; in an `array` where all are floats."""

PLAIN = ("name", "status", "kind", "source", "key", "keeps_kinematics")
"""What a table has of a row as it is."""
_OF_FILES = tuple(FileEntry.__annotations__)


class ManifestColumns(NamedTuple):
    """Some rows of a manifest, in columns.

    Attributes:
        size: how many rows there are.
        columns: by name; those of ``drawn`` and ``loaders`` in the order in which they have a value for the first time.
    """

    size: int
    columns: dict[str, Column]

    def part(self, start: int, stop: int) -> ManifestColumns:
        """Those from one row to before another one."""
        columns = {name: _part(column, start, stop) for name, column in self.columns.items()}
        return ManifestColumns(len(range(self.size)[start:stop]), columns)


def _part(column: Column, start: int, stop: int) -> Column:
    if not isinstance(column, Lists):
        return column[start:stop]
    inside = slice(sum(column.counts[:start]), sum(column.counts[:stop]))
    entries = column.entries
    cut = {name: own[inside] for name, own in entries.items()} if isinstance(entries, Mapping) else entries[inside]
    return Lists(column.counts[start:stop], cut)


def columns_of(rows: Sequence[ManifestRow]) -> ManifestColumns:
    """The columns of some rows, those that no row fills left out of what is drawn and of loaders."""
    every: Any = rows
    files: Any = [file for row in rows for file in row["files"]]
    proofs = [[(stage, proof) for stage, proof in row["proof"].items() if proof] for row in rows]
    errors = [_messages(row["errors"]) for row in rows]
    columns: dict[str, Column] = {name: [row[name] for row in every] for name in PLAIN}
    columns["files"] = Lists(
        [len(row["files"]) for row in rows], {name: [file.get(name) for file in files] for name in _OF_FILES}
    )
    columns["position_error"] = _packed([_largest([proof["position_error"] for _, proof in own]) for own in proofs])
    columns["angle_error"] = _packed([_largest([proof["angle_error"] for _, proof in own]) for own in proofs])
    columns["proved"] = _lists([[stage for stage, _ in own] for own in proofs])
    columns["error"] = [own[0] if own else None for own in errors]
    columns["errors"] = _lists(errors)
    columns["notices"] = _lists([_messages(row["notices"]) for row in rows])
    columns |= _by_name("drawn", [row["drawn"] for row in rows])
    columns |= _by_name("loaders", [_of_loaders(row) for row in rows])
    return ManifestColumns(len(rows), columns)


def _lists(lists: Sequence[Sequence[Any]]) -> Lists:
    return Lists(list(map(len, lists)), list(chain.from_iterable(lists)))


def _messages(problems: Iterable[Mapping[str, Any]]) -> list[str]:
    return [problem["message"] for problem in problems]


def _largest(numbers: Sequence[float | None]) -> float | None:
    """The largest number that is there; None where none is."""
    if len(numbers) == 1:
        return numbers[0]  # as nearly always
    return max([number for number in numbers if number is not None], default=None)


def _packed(column: Sequence[Any]) -> Sequence[Any]:
    """A column that takes little time on its way from a worker, where that can be."""
    return array("d", column) if {*map(type, column)} == {float} else column


def _by_name(kind: str, facts: Sequence[Mapping[str, Any]]) -> dict[str, Column]:
    """The facts of some mappings as columns."""
    if not any(facts):
        return {}
    first, *others = map(tuple, facts)
    if others.count(first) == len(others):
        columns = zip(first, zip(*[own.values() for own in facts], strict=True), strict=True)
        packed = {f"{kind}.{name}": _packed(column) for name, column in columns}
        if all(isinstance(column, array) for column in packed.values()):
            return {**packed}
    names = dict.fromkeys([name for own in facts for name, value in own.items() if value is not None])
    return {f"{kind}.{name}": _packed([own.get(name) for own in facts]) for name in names}


def _of_loaders(row: ManifestRow) -> dict[str, Any]:
    """What is known of the loaders of a run, of those too that a manipulator did not go through."""
    if not row["loaders"] and "not_loaded" not in row:
        return {}
    return dict(_leaves(row["loaders"])) | {f"{name}.verdict": why for name, why in row.get("not_loaded", {}).items()}


def _leaves(facts: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """The facts in mappings inside each other, by the names that lead to them; of lists only those of problems."""
    waiting = list(facts.items())[::-1]
    while waiting:
        name, value = waiting.pop()
        if isinstance(value, dict):
            waiting += [(f"{name}.{key}", entry) for key, entry in value.items()][::-1]
        elif not isinstance(value, list):
            yield name, value
        elif name.endswith((".findings", ".errors")):
            yield name, _messages(value)
