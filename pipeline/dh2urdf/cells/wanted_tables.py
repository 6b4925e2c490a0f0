"""Picks the tables that a run's cells and variations are made of out of all that pass by."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from dh2urdf.columns import ManipulatorGroups
from dh2urdf.manipulator import Manipulator
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, shown
from dh2urdf.stages import Rejected

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

say = Messages(__file__)

REMEMBERED = 1000
"""Names of manipulators that a message may suggest; a run may have a million."""
SHOWN_NAMES = 20
"""Names that a message lists."""


class WantedTables:
    """Keeps the manipulators of some names, and no others.

    Args:
        names: the names that are wanted.
        cells: names of the cells of the run, of which nothing is made.
        variations: names of its variations, of whose variants nothing is made, with what each is made of.
    """

    def __init__(
        self, names: Iterable[str], cells: Iterable[str] = (), variations: Mapping[str, str] = MappingProxyType({})
    ) -> None:
        self._cells, self._variations = frozenset(cells), variations
        self._wanted: dict[str, list[Manipulator | Rejected]] = {name: [] for name in names}
        self._names: list[str] = []

    def see(self, item: Manipulator | ManipulatorGroups | Rejected) -> None:
        """Takes notice of what a reader gave."""
        names = item.names if isinstance(item, ManipulatorGroups) else [item.name]
        if not self._wanted.keys().isdisjoint(names):
            for each in item.tables() if isinstance(item, ManipulatorGroups) else [item]:
                if each.name in self._wanted:  # Of too many, two are enough to say so.
                    self._wanted[each.name] = [*self._wanted[each.name][:1], each]
        self._names += names[: REMEMBERED - len(self._names)]

    def table(self, name: str, user: str, mark: Mark | None) -> Manipulator | tuple[Problem, ...]:
        """The manipulator of a name, once everything has been seen; why not, where there is none.

        Args:
            name: one of the names that are wanted.
            user: what is made of it, as messages call it: ``the arm 'left'``.
            mark: where the name is in the run file.
        """
        items = self._wanted[name]
        match items:
            case [Manipulator() as table]:
                return table
            case _:
                return tuple(self._problems(name, user, mark, items))

    def _problems(
        self, name: str, user: str, mark: Mark | None, items: Sequence[Manipulator | Rejected]
    ) -> Iterator[Problem]:
        made = {"user": user, "name": name}
        match items:
            case []:
                names = list(dict.fromkeys(self._names))
                other = self._made(name)
                if other:
                    yield say("made-of-no-input", mark, field="of", found=name, other=other, **made)
                else:
                    few = [*names[:SHOWN_NAMES], *(["…"] if len(names) > SHOWN_NAMES else [])]
                    near = did_you_mean(name, names)
                    yield say("made-of-nothing", mark, field="of", found=name, names=few, suggestion=near, **made)
            case [Rejected(problems=problems)]:
                yield cannot_be_made(name, user, mark)
                yield from problems
            case _:
                marks = " and ".join(str(item.mark) for item in items if item.mark)
                where = f"they are at {marks}" if marks else None
                yield say("made-of-several", mark, field="of", found=name, suggestion=where, **made)

    def _made(self, name: str) -> str | None:
        """What of the run itself has a name: a cell, a variation, or a variant, as `v_1` of `v`."""
        of, _, number = name.rpartition("_")
        if name in self._cells:
            return "a cell"
        if self._variations.get(name, name) != name:  # A variation without a name has that of what it is made of.
            return "a variation"
        return f"a variant of {shown(of)}" if of in self._variations and number.isdecimal() else None


def cannot_be_made(name: str, user: str, mark: Mark | None) -> Problem:
    """The sentence before the reasons why nothing can be made of a table."""
    return say("not-made", mark, field="of", found=name, user=user)
