"""What became of a batch, as its worker tells it, and of a whole run: counts, durations, and what to tell at once."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.errors import SCREENFUL
from dh2urdf.output.journal import Leftovers
from dh2urdf.source import Cause, Problem, in_file_order

if TYPE_CHECKING:
    from dh2urdf.conversion.outcome import Outcome

TIMED = 1000
"""Manipulators of a run whose durations are listed one by one; those of the others are added up."""
MOST_CAUSES = 200
"""Causes of notices, and of failures, that are kept apart; the manifest has the others too."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchReport:
    """What became of a batch: a worker adds up what became of its manipulators.

    Attributes:
        first: number of its first manipulator in the run.
        rows: its part of the manifest, a line of JSON for each.
        statuses: how many are ok, kept from an earlier run, failed or planned.
        kinds: how many failed, by kind.
        problems: what was noticed and what failed, a screenful of each.
        causes: the same of all of its manipulators, those together that have one cause.
        severities: how many notices and errors there are.
        tracebacks: where stages failed, a screenful.
        unread: the names of those of which there was no manipulator at all.
        seconds: how long the steps took, added up [s].
        timings: how long the steps of each took, of a run's first manipulators [s].
        printed: the lines that plugins printed in the worker.
    """

    first: int
    rows: bytes = b""
    statuses: Counter[str] = field(default_factory=Counter)
    kinds: Counter[str] = field(default_factory=Counter)
    problems: list[Problem] = field(default_factory=list)
    causes: dict[tuple[str | None, ...], Cause[Problem]] = field(default_factory=dict)
    severities: Counter[str] = field(default_factory=Counter)
    tracebacks: list[str] = field(default_factory=list)
    unread: list[str] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)
    timings: list[dict[str, Any]] = field(default_factory=list)
    printed: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        """How many manipulators it is about."""
        return sum(self.statuses.values())

    @property
    def was_read(self) -> bool:
        """Whether there was a manipulator at all."""
        return self.count > len(self.unread)

    def note(self, outcome: Outcome) -> None:
        """Takes an outcome."""
        self.statuses[outcome.status] += 1
        if outcome.kind:
            self.kinds[outcome.kind] += 1
        # What simulators notice is alike for many manipulators: the end of a run reports it, grouped.
        findings = [finding for load in outcome.loads.values() for finding in load.report.findings]
        graver = [finding for finding in findings if finding.severity == "error"]
        problems = (*outcome.notices, *graver, *outcome.errors)
        for problem in problems if outcome.was_read else in_file_order(problems):
            self.severities[problem.severity] += 1
            if self.severities[problem.severity] <= SCREENFUL:
                self.problems.append(problem)
            add_cause(self.causes, problem.cause, Cause(problem))
        if outcome.traceback and len(self.tracebacks) < SCREENFUL:
            self.tracebacks.append(outcome.traceback)
        if self.first < TIMED and outcome.seconds:
            self.timings.append({"name": outcome.name, **outcome.seconds})
        if not outcome.was_read:
            self.unread.append(outcome.name)


def add_cause(
    causes: dict[tuple[str | None, ...], Cause[Problem]], key: tuple[str | None, ...], cause: Cause[Problem]
) -> bool:
    """Add problems of one cause to the causes so far, as long as these are few; whether it is a new cause."""
    if key in causes:
        causes[key].add([cause.first, *cause.others], cause.dropped)
    elif sum(each[0] == key[0] for each in causes) < MOST_CAUSES:  # A key begins with the severity.
        causes[key] = Cause(cause.first, cause.others, cause.dropped)
        return True
    return False


class Result:
    """What became of a run, so far.

    Attributes:
        statuses: how many manipulators are ok, kept from an earlier run, failed or planned.
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
        """Take what became of a batch."""
        self.statuses += report.statuses
        self.kinds += report.kinds
        self.seconds |= {step: self.seconds.get(step, 0.0) + taken for step, taken in report.seconds.items()}
        self.timings += report.timings
