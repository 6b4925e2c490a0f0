"""What became of a run."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.output.leftovers import Leftovers

if TYPE_CHECKING:
    from dh2urdf.tasks.batch_report import BatchReport


class Result:
    """What became of a run, so far.

    Attributes:
        statuses: how many manipulators are ok, kept from an earlier run, failed or skipped.
        kinds: how many failed, by kind.
        seconds: how long the steps took, added up over all workers; `total` is the time that passed [s].
        timings: how long the steps of the first manipulators took [s].
        keeps_kinematics: whether the transform keeps T(q).
        leftovers: what became of files of the last run that this one has no part in.
    """

    def __init__(self, *, keeps_kinematics: bool = True) -> None:
        self.statuses: Counter[str] = Counter()
        self.kinds: Counter[str] = Counter()
        self.seconds: dict[str, float] = {}
        self.timings: list[dict[str, Any]] = []
        self.keeps_kinematics = keeps_kinematics
        self.leftovers = Leftovers()

    @property
    def made(self) -> int:
        """How many manipulators were worked at."""
        return sum(self.statuses.values()) - self.statuses["kept"]

    @property
    def exit_status(self) -> Literal[0, 1]:
        """0 where all is done, 1 where a manipulator failed."""
        return 1 if self.statuses["failed"] else 0

    def add(self, report: BatchReport) -> None:
        """Takes what became of a batch."""
        self.statuses += report.statuses
        self.kinds += report.kinds
        for step, seconds in report.seconds.items():
            self.seconds[step] = self.seconds.get(step, 0.0) + seconds
        self.timings += report.timings
