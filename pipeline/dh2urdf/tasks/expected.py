"""How many manipulators a run will have, told from how far its inputs have been read."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.columns import ManipulatorGroups
from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected

if TYPE_CHECKING:
    from dh2urdf.run_file.plan import Plan


class Expected:
    """How many manipulators a run will have, as far as is known while its inputs are being read.

    Attributes:
        total: how many; None as long as there is no saying.
    """

    def __init__(self, plan: Plan) -> None:
        self.total: int | None = None
        self._inputs = max(1, len(plan.inputs))
        self._read = 0
        self._lines: dict[str, int] = {}
        counts = [call.count for call in plan.variations]
        self._besides = None if None in counts else len(plan.cells) + sum(filter(None, counts))

    def see(self, count: int, what: object, source: str) -> None:
        """Takes notice of how far the reading has come."""
        if self._besides is None or not isinstance(what, Manipulator | ManipulatorGroups | Rejected):
            return
        mark = what.marks[-1] if isinstance(what, ManipulatorGroups) else what.mark
        lines = self._lines_of(source)
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

    def finish(self, count: int) -> None:
        """Everything has been read."""
        self.total = count

    def _lines_of(self, source: str) -> int:
        """Lines of a file; 0 where it is none of text."""
        if source not in self._lines:
            self._lines = {source: _count_lines(Path(source))}
        return self._lines[source]


def _count_lines(path: Path) -> int:
    try:
        with path.open("rb") as file:
            blocks = iter(partial(file.read, 1 << 20), b"")
            first = next(blocks, b"")
            return 0 if b"\0" in first else first.count(b"\n") + sum(block.count(b"\n") for block in blocks)
    except OSError:
        return 0  # Its reader says why.
