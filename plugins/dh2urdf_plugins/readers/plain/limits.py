"""The limits of joints about which there is nothing to say."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, Any

from dh2urdf.manipulator import JointType, Limits, new_limits
from dh2urdf.row_fields import LIMITS
from dh2urdf_plugins.readers.plain.numbers import PlainNumbers
from dh2urdf_plugins.readers.rows.rows import LARGEST_LIMIT, NO_LIMITS
from dh2urdf_plugins.readers.words.bounds import REMEMBERED

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf_plugins.readers.words.cells import Units

_LARGEST = {JointType.REVOLUTE: LARGEST_LIMIT, JointType.PRISMATIC: sys.float_info.max}
"""The largest bound that needs no word, by the type of a joint; the other types have no bounds."""


class PlainLimits:
    """Reads the limits of rows, where they are plain."""

    def __init__(self, columns: Mapping[str, int], units: Units, kinds: Mapping[str, JointType]) -> None:
        """Takes the columns and the units of a table, and the types that its words mean."""
        self.kinds = kinds
        self.columns = {name: columns[name] for name in LIMITS if name in columns}
        self.numbers = {name: PlainNumbers(name, units) for name in self.columns}
        self.known: dict[tuple[Any, ...], Limits] = {}

    def read(self, words: Sequence[str], columns: Sequence[Sequence[Any]]) -> list[Limits] | None:
        """The limits of the joints, or None where there is anything to say about one of them.

        Args:
            words: what the table calls the type of each joint.
            columns: the cells of the table by column.
        """
        if not self.columns:
            return [NO_LIMITS] * len(words)
        keys = list(zip(words, *(columns[index] for index in self.columns.values()), strict=True))
        try:
            return list(map(self.known.__getitem__, keys))  # the robots of a table mostly share a few
        except KeyError:
            if len(self.known) > REMEMBERED:
                self.known.clear()
        missing = set(keys) - self.known.keys()
        asked = keys if 2 * len(missing) > len(keys) else list(missing)
        types, *cells = zip(*asked, strict=True)
        found: dict[str, list[float | None]] = dict.fromkeys(LIMITS, [None] * len(asked))
        slides = JointType.PRISMATIC in map(self.kinds.__getitem__, set(types))
        for (name, numbers), column in zip(self.numbers.items(), cells, strict=True):
            read = numbers.read_some(column)
            if read is None or (slides and numbers.has_expressions):
                return None  # a multiple of π is no length
            found[name] = read
        if not self._are_plain(types, found):
            return None
        limits = [
            new_limits(lower=low, upper=high, velocity=fast, effort=strong)
            for low, high, fast, strong in zip(*found.values(), strict=True)
        ]
        if asked is keys:  # most joints have limits of their own, which need not be remembered
            return limits
        self.known.update(zip(asked, limits, strict=True))
        return list(map(self.known.__getitem__, keys))

    def _are_plain(self, types: Sequence[str], found: Mapping[str, list[float | None]]) -> bool:
        """Whether limits [SI] are such as joints of some types have."""
        rates = {number for name in ("velocity", "effort") for number in found[name] if number is not None}
        if not all(0 < number < math.inf for number in rates):
            return False
        largest = {word: _LARGEST.get(self.kinds[word]) for word in set(types)}
        for word, low, high in zip(types, found["lower"], found["upper"], strict=True):
            if low is None and high is None:
                continue
            bound = largest[word]
            if low is None or high is None or bound is None or not -bound <= low <= high <= bound:
                return False
        still = {word for word in largest if self.kinds[word] is JointType.FIXED}
        fixed = [index for index, word in enumerate(types) if word in still] if still else []
        return all(found[name][index] is None for name in found for index in fixed)
