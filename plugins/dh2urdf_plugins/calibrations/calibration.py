"""Differences that are added to the rows of a table, and how far they move the arm's tip."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.kinematics import forward_kinematics, position_error
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.manipulator import JointType
from dh2urdf.source import Mark, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.manipulator import DHRow, Manipulator

FIELDS = {"a": "m", "alpha": "rad", "d": "m", "theta": "rad", "offset": ""}
"""The numbers of a row that a calibration changes, and their units; that of offset is that of the joint variable."""
FAR = 0.1
"""How far a calibration moves the tip of an arm at most, as a part of the arm's reach."""
_VECTORS = 32
_SLIDE = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RowDifference:
    """What is added to one row.

    Attributes:
        joint: name of the joint; None where the order of the rows says which is meant.
        a: [m].
        alpha: [rad].
        d: [m].
        theta: [rad].
        offset: [rad or m].
        mark: its place.
    """

    joint: str | None = None
    a: float = 0.0
    alpha: float = 0.0
    d: float = 0.0
    theta: float = 0.0
    offset: float = 0.0
    mark: Mark | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """The differences of one arm.

    Attributes:
        file: where they come from.
        differences: from the base outwards.
        of_moving_rows: whether they are those of the moving rows only, where the order says which is meant.
        notices: what there is to report of the file.
    """

    file: str
    differences: tuple[RowDifference, ...]
    of_moving_rows: bool = False
    notices: tuple[Problem, ...] = ()

    def applied(self, rows: Sequence[DHRow]) -> list[DHRow]:
        """The rows with their differences.

        Raises:
            TableError: a difference belongs to no row, or there is not one for each.
        """
        meant = dict(self._pairs(rows))
        return [_with(row, meant.get(row.joint)) for row in rows]

    def _pairs(self, rows: Sequence[DHRow]) -> Iterator[tuple[str, RowDifference]]:
        """The name of a joint with each difference."""
        names = [row.joint for row in rows if row.type is not JointType.FIXED or not self.of_moving_rows]
        if any(each.joint is None for each in self.differences):
            if len(names) != len(self.differences):
                what = "moving joints" if self.of_moving_rows else "joints"
                raise TableError(
                    Problem(
                        message=f"the calibration is of {len(self.differences)} {what}, and the table has {len(names)}",
                        mark=Mark(file=self.file),
                        field="calibration",
                        accepted="a difference for each joint, in the order of the table"
                        + ("" if self.of_moving_rows else ", or a column joint with the names of some"),
                    )
                )
            yield from zip(names, self.differences, strict=True)
            return
        for each in self.differences:
            joint = each.joint or ""
            if joint not in names:
                raise TableError(
                    Problem(
                        message=f"the calibration has a row for {shown(joint)}, which is no joint of the table",
                        mark=each.mark,
                        field="joint",
                        found=joint,
                        accepted=", ".join(names[:20]),
                        suggestion=did_you_mean(joint, names),
                    )
                )
            yield joint, each

    def notice(self, given: Manipulator, calibrated: Manipulator) -> Problem:
        """What the calibration changes: the largest difference of each number, and how far the tip moves."""
        largest = {name: max(abs(getattr(each, name)) for each in self.differences) for name in FIELDS}
        changes = [f"{name} by up to {value:.3g} {FIELDS[name]}".rstrip() for name, value in largest.items() if value]
        moved, reach = _moved(given, calibrated)
        odd = moved > FAR * reach
        return Problem(
            message=f"{shown(self.file, 200)} changes {', '.join(changes) or 'nothing'}: the tip moves by up to "
            f"{1000 * moved:.3g} mm",
            severity="notice",
            mark=Mark(file=self.file),
            field="calibration",
            suggestion="is it the calibration of this arm, in these units?" if odd else None,
        )


def _with(row: DHRow, difference: RowDifference | None) -> DHRow:
    if difference is None:
        return row
    changed = {name: getattr(row, name) + added for name in FIELDS if (added := getattr(difference, name))}
    return replace(row, **changed) if changed else row


def _moved(one: Manipulator, other: Manipulator) -> tuple[float, float]:
    """How far the tips of two arms are from each other, and the first from its base, at most [m]."""
    draw = random.Random(f"dh2urdf {len(one.moving_rows)}")  # noqa: S311 - reproducible on purpose
    moved = reach = 0.0
    for _ in range(_VECTORS):
        q = [
            draw.uniform(0.0, _SLIDE) if row.type is JointType.PRISMATIC else draw.uniform(-math.pi, math.pi)
            for row in one.moving_rows
        ]
        here, there = forward_kinematics(one, q), forward_kinematics(other, q)
        moved = max(moved, position_error(here, there))
        reach = max(reach, math.dist(here.translation, one.base.translation))
    return moved, reach
