"""What became of a batch, as its worker tells it: its part of the manifest, and what a person should know at once."""

from __future__ import annotations

from collections import Counter
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any

from dh2urdf.conversion.outcome import ManifestRow, Outcome
from dh2urdf.errors import SCREENFUL
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.source import Problem, in_file_order
from dh2urdf.tasks.manifest_columns import ManifestColumns

if TYPE_CHECKING:
    from collections.abc import Sequence


TIMED = 1000
"""Manipulators of a run whose durations are listed one by one; those of the others are added up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchReport:
    """What became of a batch.

    Attributes:
        first: number of its first manipulator in the run.
        rows: its part of the manifest, a line of JSON for each.
        told: its rows as data: those of failures, or all, where there are loaders or a page is made of them.
        columns: what a table of the manifest has of its part; None where there is no table.
        statuses: how many are ok, kept from an earlier run, failed or skipped.
        kinds: how many failed, by kind.
        problems: what was noticed and what failed, a screenful of each; what is noticed of many is there once.
        severities: how many notices and errors there are.
        tracebacks: where stages failed, a screenful.
        was_read: whether there was a manipulator at all.
        keeps_kinematics: whether the transform keeps T(q).
        seconds: how long the steps took, added up [s].
        timings: how long the steps of each took, of a run's first manipulators [s].
        printed: the lines that plugins printed in the worker.
    """

    first: int
    rows: bytes
    statuses: Counter[str]
    kinds: Counter[str]
    told: tuple[ManifestRow, ...] = ()
    columns: ManifestColumns | None = None
    problems: tuple[Problem, ...] = ()
    severities: Counter[str] = field(default_factory=Counter)
    tracebacks: tuple[str, ...] = ()
    was_read: bool = True
    seconds: dict[str, float] = field(default_factory=dict)
    timings: tuple[dict[str, Any], ...] = ()
    printed: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        """How many manipulators it is about."""
        return sum(self.statuses.values())


def is_new(problem: Problem, said: set[Problem]) -> bool:
    """Whether a message is still to be reported; a notice without a place is the same for all manipulators of a run.

    Args:
        problem: the message.
        said: the notices of that kind that were reported; this one is added.
    """
    if problem.severity != "notice" or problem.mark is not None:
        return True
    words = replace(problem, robot=None)
    is_known = words in said
    said.add(words)
    return not is_known


class Tally:
    """Adds up what became of the manipulators of a batch."""

    def __init__(self, first: int) -> None:
        self._first = first
        self.statuses: Counter[str] = Counter()
        self._kinds: Counter[str] = Counter()
        self._severities: Counter[str] = Counter()
        self._problems: list[Problem] = []
        self._said: set[Problem] = set()
        self._tracebacks: list[str] = []
        self._timings: list[dict[str, Any]] = []
        self._was_read = False

    def note(self, outcome: Outcome) -> None:
        """Takes an outcome."""
        self.statuses[outcome.status] += 1
        if outcome.kind:
            self._kinds[outcome.kind] += 1
        if outcome.loads or outcome.notices or outcome.errors:
            self._note_problems(outcome)
        if outcome.traceback and len(self._tracebacks) < SCREENFUL:
            self._tracebacks.append(outcome.traceback)
        if self._first < TIMED and outcome.seconds:
            self._timings.append({"name": outcome.name, **outcome.seconds})
        self._was_read = self._was_read or outcome.was_read

    def _note_problems(self, outcome: Outcome) -> None:
        # What simulators notice is alike for many manipulators: the end of a run reports it, grouped.
        findings = [finding for load in outcome.loads.values() for finding in load.report.findings]
        graver = [finding for finding in findings if finding.severity == "error"]
        problems = (*outcome.notices, *graver, *outcome.errors)
        for problem in problems if outcome.was_read else in_file_order(problems):
            self._severities[problem.severity] += 1
            if self._severities[problem.severity] <= SCREENFUL and is_new(problem, self._said):
                self._problems.append(problem)

    def keep(self) -> None:
        """Takes a manipulator that is kept from an earlier run."""
        self.statuses["kept"] += 1
        self._was_read = True

    def report(
        self, rows: bytes, told: Sequence[ManifestRow], columns: ManifestColumns | None, seconds: dict[str, float]
    ) -> BatchReport:
        """The report of the batch."""
        return BatchReport(
            first=self._first,
            rows=rows,
            told=tuple(told),
            columns=columns,
            statuses=self.statuses,
            kinds=self._kinds,
            problems=tuple(self._problems),
            severities=self._severities,
            tracebacks=tuple(self._tracebacks),
            was_read=self._was_read,
            seconds=dict(seconds),
            timings=tuple(self._timings),
        )
