"""Which names were seen before, of any number of them, by a hash of 8 bytes for each."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


class NameSet:
    """A set of names that only grows.

    Of a million names, two have the same hash once in forty million runs: a name then counts as known that is new.
    """

    def __init__(self) -> None:
        self._hashes: set[int] = set()

    def known(self, names: Iterable[str]) -> set[str]:
        """Return those of some names that were added before."""
        return {name for name in names if hash(name) in self._hashes}

    def add(self, names: Iterable[str]) -> None:
        """Remember some names."""
        self._hashes.update(map(hash, names))
