"""How many manipulators a run will have, and how many of them a worker takes at once.

What a batch costs besides its manipulators, some 10 ms, is the less for each the more there are. But a short run is to
keep every worker busy, and at its end none is to wait long for another: so batches grow from one, and where they have
become large, each is a part of what is left, shared by the workers (guided self-scheduling: Polychronopoulos and Kuck,
IEEE Transactions on Computers C-36(12), 1987).
"""

from __future__ import annotations

from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.columns import ManipulatorGroups
from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected

if TYPE_CHECKING:
    from dh2urdf.run_file.plan import Plan

SMALL = 16
"""Manipulators of a batch at most, where each takes long."""
LARGE = 500
"""Manipulators of a batch at most, as long as it is not known how many are left."""
JOINTS = 24_000
"""Joints of a larger batch at most: its worker holds the descriptions of them all, some 2 kB for each joint."""
PARTS = 64
"""Into so many parts what is left is cut where the number of workers is not known."""


class BatchSizes:
    """The sizes of the batches of a run, one after the other."""

    def __init__(self, plan: Plan) -> None:
        self._recipe = plan.recipe
        self._whole = plan.layout.whole
        workers = getattr(plan.executor.options, "workers", None)
        if not isinstance(workers, int):
            self._parts = PARTS
        else:
            self._parts = 1 if workers == 1 else 2 * workers
        self._size = self._axes = 1
        self._taken = 0

    def next(self, total: int | None) -> int:
        """The size of the next batch; where there are shards, that of one or more of them.

        Args:
            total: how many manipulators the run will probably have; None where there is no saying.
        """
        largest = LARGE if self._is_quick else SMALL
        if total is not None and self._is_quick:
            largest = max(LARGE, min((total - self._taken) // self._parts, JOINTS // self._axes))
        return self._whole * max(1, min(self._size, largest) // self._whole)

    def see(self, count: int, joints: int) -> None:
        """Take notice of a batch, behind which the next one may be larger.

        Args:
            count: manipulators in it.
            joints: the joints of those that can be made at once.
        """
        if self._taken:  # An executor looks at the first two before it takes processes for them.
            self._size = 2 * count if self._is_quick else count + 1
        self._axes = max(1, joints // count)
        self._taken += count

    @property
    def _is_quick(self) -> bool:
        """Whether manipulators are made many at once, and simulators load few of them."""
        recipe = self._recipe
        loads = recipe.loaders and (self._taken < recipe.sample.first or recipe.sample.every < SMALL)
        return recipe.makes_many_at_once and not loads


class Expected:
    """How many manipulators a run will have, as far as is known while its inputs are being read.

    Attributes:
        total: how many; None as long as there is no saying.
    """

    def __init__(self, plan: Plan) -> None:
        self.total: int | None = None
        self._inputs = max(1, len(plan.inputs))
        self._read = 0
        counts = [call.count for call in plan.variations]
        self._besides = None if None in counts else len(plan.cells) + sum(filter(None, counts))

    def see(self, count: int, what: object, source: str) -> None:
        """Take notice of how far the reading has come."""
        if self._besides is None or not isinstance(what, Manipulator | ManipulatorGroups | Rejected):
            return
        mark = what.marks[-1] if isinstance(what, ManipulatorGroups) else what.mark
        lines = _lines_of(source)
        part = mark.line / lines if mark and mark.line and mark.line <= lines else 0.0
        if (fraction := (self._read + part) / self._inputs) > 0.0:
            self.total = round(count / fraction) + self._besides

    def finish_input(self) -> None:
        """One more input is read."""
        self._read += 1

    def finish_inputs(self, count: int) -> None:
        """All inputs are read, with so many manipulators."""
        if self._besides is not None:
            self.total = count + self._besides


@lru_cache(maxsize=1)
def _lines_of(source: str) -> int:
    """Lines of a file; 0 where it is none of text."""
    try:
        with Path(source).open("rb") as file:
            blocks = iter(partial(file.read, 1 << 20), b"")
            first = next(blocks, b"")
            return 0 if b"\0" in first else first.count(b"\n") + sum(block.count(b"\n") for block in blocks)
    except OSError:
        return 0  # Its reader says why.
