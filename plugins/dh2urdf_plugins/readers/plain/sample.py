"""Check a small sample of what was read fast: a second, careful reading of the same rows must give the same records.

The fast way (`plain_rows`) and the careful one (`rows`) are two programs for one meaning. Tests compare them over many
tables; this module compares them on the table at hand, in every run.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.stages import Rejected

say = Messages(__file__)

HEAD = 50
"""Rows of one manipulator that are read again at most, and rows that are read again in any file."""
EVERY = 20_000
"""One row of this many is read again: a careful row takes 30 times as long as a fast one."""


class PlainSample:
    """Chooses the manipulators of a file that are read again: always the same ones, at changing places of a batch."""

    _read = _again = 0

    def choose(self, sizes: Sequence[int]) -> int | None:
        """The index of the manipulator that is read again, or None."""
        index = self._read % len(sizes)
        self._read += sum(sizes)
        rows = min(sizes[index], HEAD)
        if self._again + rows > HEAD + self._read // EVERY:
            return None
        self._again += rows
        return index


def compare(fast: Manipulator, careful: Manipulator | Rejected, count: int) -> None:
    """Refuses two readings of one manipulator that differ in a bit, in a mark or in a notice.

    Some rows were read with care, or all; the first rows of a longer arm may be refused as an arm.
    """
    is_whole = count == len(fast.rows)
    if isinstance(careful, Manipulator):
        pairs: list[tuple[Any, Any]] = [*zip(fast.rows, careful.rows, strict=False)]
        for one, other in [*pairs, (fast, careful)] if is_whole else pairs:
            for name in (field.name for field in fields(one)):
                readings = [repr(getattr(record, name)) for record in (one, other)]
                if readings[0] != readings[1]:
                    about = {"field": name, "fast": readings[0], "careful": readings[1]}
                    about |= {"joint": one.joint} if one is not fast else {}
                    raise TableError(say("two-readings", one.mark, robot=fast.name, **about))
    elif is_whole:
        refused = careful.problems[0]
        row = next((row for row in fast.rows if row.joint == refused.joint), fast)
        problem = say("only-fast", refused.mark, robot=fast.name, reason=refused.message, row=repr(row))
        raise TableError(replace(problem, joint=refused.joint, field=refused.field, found=refused.found))
