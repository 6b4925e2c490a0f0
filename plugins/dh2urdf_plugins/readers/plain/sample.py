"""Check a small sample of what was read fast: a second, careful reading of the same rows must give the same records.

The fast way (`plain_rows`) and the careful one (`rows`) are two programs for one meaning. Tests compare them over many
tables; this module compares them on the table at hand, in every run.
"""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.source import Problem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.manipulator import DHRow
    from dh2urdf.stages import Rejected

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
    problem = None
    if isinstance(careful, Manipulator):
        problem = _of_rows(fast.rows, careful.rows)
        if problem is None and count == len(fast.rows):
            problem = _of_manipulators(fast, careful)
    elif count == len(fast.rows):  # the first rows of a longer arm may be refused as an arm of their own
        refused = careful.problems[0]
        problem = Problem(
            message=f"the fast reading accepts {_row(fast, refused.joint)}, and the careful one refuses it: "
            f"{refused.message}",
            mark=refused.mark,
            joint=refused.joint,
            field=refused.field,
            found=refused.found,
        )
    if problem is None:
        return
    raise TableError(
        Problem(
            message=problem.message,
            mark=problem.mark or fast.mark,
            robot=fast.name,
            joint=problem.joint,
            field=problem.field,
            found=problem.found,
            accepted="two equal readings of every row",
            suggestion="this is a fault of dh2urdf, not of the table, and no robot of this file is safe to use: report "
            "this message to the makers of dh2urdf, with this row and all lines above the first row",
        )
    )


def _row(arm: Manipulator, joint: str | None) -> str:
    row = next((row for row in arm.rows if row.joint == joint), None)
    return repr(row) if row else f"the manipulator {arm.name!r}"


def _of_rows(fast: Sequence[DHRow], careful: Sequence[DHRow]) -> Problem | None:
    """The first field of the first row that has two readings."""
    for one, other in zip(fast, careful, strict=False):
        for field in fields(one):
            found, wanted = (repr(getattr(row, field.name)) for row in (one, other))
            if found != wanted:
                message = f"the fast reading of {field.name} is {found}, and the careful reading is {wanted}"
                return Problem(message=message, mark=one.mark, joint=one.joint, field=field.name)
    return None


def _of_manipulators(fast: Manipulator, careful: Manipulator) -> Problem | None:
    """What two readings of a manipulator differ by, where it is not a row; None where they are equal."""
    parts = []
    for field in fields(fast):
        found, wanted = (getattr(arm, field.name) for arm in (fast, careful))
        if repr(found) != repr(wanted):
            message = f"the fast reading of {field.name} is {found!r}, and the careful reading is {wanted!r}"
            if field.name == "notices":
                said = "; ".join(notice.message for notice in wanted)
                message = f"the fast reading has no notice, and the careful reading has: {said}"
            parts.append(message)
    return Problem(message="; ".join(parts)) if parts else None
