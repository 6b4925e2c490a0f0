"""Check a small sample of what was read fast: a second, careful reading of the same rows must give the same records.

The fast way (`plain_rows`) and the careful one (`rows`) are two programs for one meaning. Tests compare them over many
tables; this module compares them on the table at hand, in every run.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.manipulator import DHRow
    from dh2urdf.source import Problem
    from dh2urdf.stages import Rejected

say = Messages(__file__)

HEAD = 50
"""Rows of one manipulator that are read again at most, and rows that are read again in any file."""
EVERY = 20_000
"""One row of this many is read again: a careful row takes 30 times as long as a fast one."""


class PlainSample:
    """Chooses the manipulators that are read again: the same ones of the same file, at changing places of a batch."""

    def __init__(self) -> None:
        """Starts a file."""
        self._read = 0
        self._again = 0

    def choose(self, sizes: Sequence[int]) -> int | None:
        """The index of the manipulator that is read again, or None.

        Args:
            sizes: how many rows each manipulator of a batch has.
        """
        index = self._read % len(sizes)
        self._read += sum(sizes)
        rows = min(sizes[index], HEAD)
        if self._again + rows > HEAD + self._read // EVERY:
            return None
        self._again += rows
        return index


def compare(fast: Manipulator, careful: Manipulator | Rejected, count: int) -> None:
    """Compare two readings of one manipulator, to the last bit, marks and notices included.

    Args:
        fast: the manipulator as it was read fast.
        careful: the same rows, read with care.
        count: how many of its rows were read with care.

    Raises:
        TableError: the readings differ.
    """
    found = None
    if isinstance(careful, Manipulator):
        found = _of_rows(fast.rows, careful.rows)
        if found is None and count == len(fast.rows):
            found = _of_manipulators(fast, careful)
    elif count == len(fast.rows):  # the first rows of a longer arm may be refused as an arm of their own
        refused = careful.problems[0]
        row = next((row for row in fast.rows if row.joint == refused.joint), None)
        what = repr(row) if row else f"the manipulator {fast.name!r}"
        found = replace(refused, message=say("only-fast", row=what, reason=refused.message).message)
    if found:
        about = {"joint": found.joint, "field": found.field, "found": found.found}
        raise TableError(say("two-readings", found.mark or fast.mark, robot=fast.name, reason=found.message, **about))


def _of_rows(fast: Sequence[DHRow], careful: Sequence[DHRow]) -> Problem | None:
    """The first field of the first row that has two readings."""
    for one, other in zip(fast, careful, strict=False):
        for name in (field.name for field in fields(one)):
            first, second = repr(getattr(one, name)), repr(getattr(other, name))
            if first != second:
                return say("other-value", one.mark, joint=one.joint, field=name, fast=first, careful=second)
    return None


def _of_manipulators(fast: Manipulator, careful: Manipulator) -> Problem | None:
    """What two readings of a manipulator differ by, where it is not a row; None where they are equal."""
    for name in (field.name for field in fields(fast)):
        first, second = repr(getattr(fast, name)), repr(getattr(careful, name))
        if first != second and name == "notices":
            return say("other-notices", said="; ".join(notice.message for notice in careful.notices))
        if first != second:
            return say("other-value", field=name, fast=first, careful=second)
    return None
