"""Which names were seen before, of any number of them, in 8 bytes for each."""

from __future__ import annotations

from itertools import compress
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

RECENT = 30_000
"""Hashes in a set of Python's, some 3 MB: most runs have fewer names, and need no numpy."""


class NameSet:
    """A set of names that only grows, held as hashes of 8 bytes.

    Of a million names, two have the same hash once in forty million runs: a name then counts as known that is new. In
    batches a name costs some 0.5 µs.
    """

    def __init__(self, recent: int = RECENT) -> None:
        """Starts without a name; `recent` is how many hashes wait to be sorted into columns."""
        self._limit = recent
        self._recent: set[int] = set()
        self._columns: list[Any] = []  # sorted, each at least twice as long as the next

    def known(self, names: Collection[str]) -> set[str]:
        """Return those of some names that were added before."""
        found = {name for name in names if hash(name) in self._recent}
        if self._columns:
            import numpy as np

            wanted = np.fromiter(map(hash, names), np.int64, len(names))
            for column in self._columns:
                places = np.minimum(column.searchsorted(wanted), len(column) - 1)
                found.update(compress(names, column[places] == wanted))
        return found

    def add(self, names: Iterable[str]) -> None:
        """Remember some names."""
        self._recent.update(map(hash, names))
        if len(self._recent) > self._limit:
            import numpy as np

            column = np.sort(np.fromiter(self._recent, np.int64, len(self._recent)))
            while self._columns and len(self._columns[-1]) < 2 * len(column):
                column = np.sort(np.concatenate((self._columns.pop(), column)))
            self._columns.append(column)
            self._recent.clear()
