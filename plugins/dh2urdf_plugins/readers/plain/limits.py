"""The limits of joints about which there is nothing to say."""

from __future__ import annotations

import math
from itertools import chain
from operator import le
from typing import TYPE_CHECKING, Any

from dh2urdf.manipulator import JointType, Limits, new_limits
from dh2urdf.quantities import Dimension
from dh2urdf.row_fields import LIMITS
from dh2urdf_plugins.readers.plain.numbers import (
    PlainNumbers,
    is_declared,
    names_foreign_unit,
    plain_quantity,
)
from dh2urdf_plugins.readers.rows.rows import LARGEST_LIMIT, NO_LIMITS
from dh2urdf_plugins.readers.words.bounds import REMEMBERED
from dh2urdf_plugins.readers.words.cells import SPACES, text_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf_plugins.readers.words.cells import Units, Value

_SAME_AS = {"upper": "lower"}
"""A column that hardly has another unit than the one beside it."""
_FEW = 20
"""New limits among some rows that are read one by one; of more, all are read by column."""


class PlainLimits:
    """Reads the limits of rows, where they are plain."""

    def __init__(self, columns: Mapping[str, int], units: Units, kinds: Mapping[str, JointType]) -> None:
        """Takes the columns and the units of a table, and the types that its words mean."""
        self.units = units
        self.kinds = kinds
        self.columns = {name: columns[name] for name in LIMITS if name in columns}
        self.numbers = {name: PlainNumbers(name, units) for name in self.columns}
        self.bounds = tuple(LARGEST_LIMIT for name in ("lower", "upper"))
        # A speed of joints that turn, or that slide, has no unit but that of its cell.
        self.bare_speed = {linear: is_bare_speed(units, columns, linear=linear) for linear in (False, True)}
        self.known: dict[tuple[Any, ...], Limits] = {}
        self._undeclared = {
            linear: {name for name in self.columns if not is_declared(units, name, linear=linear)}
            for linear in (False, True)
        }
        self.named = set[tuple[str, bool]]()  # columns of which a cell names a unit, of joints that turn or slide
        self._bare = set[tuple[str, bool]]()  # those of which one names none

    def read(self, words: Sequence[str], columns: Sequence[Sequence[Any]]) -> list[Limits] | None:
        """The limits of the joints, or None where there is anything to say about one of them.

        Args:
            words: what the table calls the type of each joint.
            columns: the cells of the table by column.
        """
        if not self.columns:
            return [NO_LIMITS] * len(words)
        known = self.known
        keys = list(zip(words, *(columns[index] for index in self.columns.values()), strict=True))
        try:
            return list(map(known.__getitem__, keys))  # the robots of a table mostly share a few
        except KeyError:
            pass
        if len(known) > REMEMBERED:
            known.clear()
        missing = set(keys) - known.keys()
        if len(missing) > _FEW and (numbers := self._decimals(columns)):
            return self._by_column({self.kinds[word] for word in set(words)}, numbers)
        for key in missing:
            if (limits := self._one(*key)) is None:
                return None
            known[key] = limits
        return list(map(known.__getitem__, keys))

    def _decimals(self, columns: Sequence[Sequence[Any]]) -> dict[str, list[float]] | None:
        """The columns as numbers, where they hold nothing else."""
        read: dict[str, list[float]] = {}
        for name, index in self.columns.items():
            if (numbers := self.numbers[name].decimals(columns[index])) is None:
                return None
            read[name] = numbers
        return read

    def _by_column(self, kinds: set[JointType], numbers: dict[str, list[float]]) -> list[Limits] | None:
        """Limits of which every joint has its own."""
        if kinds & {JointType.FIXED, JointType.CONTINUOUS} or not math.isfinite(sum(map(sum, numbers.values()))):
            return None
        lower, upper, velocity, effort = map(numbers.get, LIMITS)
        smallest, largest = (math.inf, math.inf) if kinds == {JointType.PRISMATIC} else self.bounds
        if lower and upper:
            if not (-smallest <= min(lower) and max(upper) <= largest and all(map(le, lower, upper))):
                return None
        elif lower or upper:
            return None
        if min(chain(velocity or (), effort or ()), default=1.0) <= 0:
            return None
        count = max(map(len, numbers.values()))
        nothing = [None] * count
        bounds = zip(lower or nothing, upper or nothing, velocity or nothing, effort or nothing, strict=True)
        return [new_limits(lower=low, upper=high, velocity=fast, effort=strong) for low, high, fast, strong in bounds]

    def _one(self, word: str, *cells: Value) -> Limits | None:
        """The limits that some cells say to a joint of some type."""
        kind = self.kinds[word]
        linear = kind is JointType.PRISMATIC
        values: dict[str, float] = {}
        for name, text in zip(self.columns, map(text_of, cells), strict=True):
            if text.strip(SPACES):
                if (value := plain_quantity(text, self.units, name, linear=linear)) is None:
                    return None
                values[name] = value
                if value and name in self._undeclared[linear]:
                    named = names_foreign_unit(text, name, linear=linear)
                    (self.named if named else self._bare).add((_SAME_AS.get(name, name), linear))
        if not values:
            return NO_LIMITS
        if self._are_in_doubt(cells, linear=linear):
            return None
        lower, upper, velocity, effort = map(values.get, LIMITS)
        smallest, largest = (math.inf, math.inf) if linear else self.bounds
        bounded = lower is not None and upper is not None and -smallest <= lower <= upper <= largest
        free = lower is None and upper is None
        if kind is JointType.FIXED or not (free or (bounded and kind is not JointType.CONTINUOUS)):
            return None
        if any(number is not None and number <= 0 for number in (velocity, effort)):
            return None
        return Limits(lower=lower, upper=upper, velocity=velocity, effort=effort)

    def _are_in_doubt(self, cells: Sequence[Value], *, linear: bool) -> bool:
        """Whether other cells name a unit where a number among the limits names none."""
        if not self.named.isdisjoint(self._bare):
            self.known.clear()  # so that all limits to come are in doubt
            return True
        return self.bare_speed[linear] and any(
            names_foreign_unit(text_of(cell), name, linear=linear)
            for name, cell in zip(self.columns, cells, strict=True)
            if name in ("lower", "upper")
        )


def is_bare_speed(units: Units, columns: Mapping[str, int], *, linear: bool) -> bool:
    """Whether a table has speeds whose unit nothing but their cells can say."""
    dimension = Dimension.SPEED if linear else Dimension.TURN_RATE
    return "velocity" in columns and "velocity" not in units.columns and units.of(dimension) is None
