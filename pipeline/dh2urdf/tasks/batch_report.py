"""What became of a batch, as its worker tells it: its part of the manifest, and what a person should know at once."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from typing import Any

from dh2urdf.conversion.outcome import ManifestRow, Outcome
from dh2urdf.errors import SCREENFUL
from dh2urdf.source import Problem, in_file_order
from dh2urdf.tasks.manifest_table import TableRows

TIMED = 1000
"""Manipulators of a run whose durations are listed one by one; those of the others are added up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchReport:
    """What became of a batch: a worker adds up what became of its manipulators.

    Attributes:
        first: number of its first manipulator in the run.
        rows: its part of the manifest, a line of JSON for each.
        told: its rows as data: those of failures, or all, where there are loaders or a page is made of them.
        table: what a table of the manifest has of its part; None where there is no table.
        statuses: how many are ok, kept from an earlier run, failed or skipped.
        kinds: how many failed, by kind.
        problems: what was noticed and what failed, a screenful of each; what is noticed of many is there once.
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
    told: list[ManifestRow] = field(default_factory=list)
    table: TableRows | None = None
    problems: list[Problem] = field(default_factory=list)
    severities: Counter[str] = field(default_factory=Counter)
    tracebacks: list[str] = field(default_factory=list)
    unread: list[str] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)
    timings: list[dict[str, Any]] = field(default_factory=list)
    printed: tuple[str, ...] = ()
    _said: set[Problem] = field(default_factory=set, repr=False)

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
        if outcome.loads or outcome.notices or outcome.errors:
            self._note_problems(outcome)
        if outcome.traceback and len(self.tracebacks) < SCREENFUL:
            self.tracebacks.append(outcome.traceback)
        if self.first < TIMED and outcome.seconds:
            self.timings.append({"name": outcome.name, **outcome.seconds})
        if not outcome.was_read:
            self.unread.append(outcome.name)

    def _note_problems(self, outcome: Outcome) -> None:
        # What simulators notice is alike for many manipulators: the end of a run reports it, grouped.
        findings = [finding for load in outcome.loads.values() for finding in load.report.findings]
        graver = [finding for finding in findings if finding.severity == "error"]
        problems = (*outcome.notices, *graver, *outcome.errors)
        for problem in problems if outcome.was_read else in_file_order(problems):
            self.severities[problem.severity] += 1
            if self.severities[problem.severity] <= SCREENFUL and is_new(problem, self._said):
                self.problems.append(problem)

    def keep(self) -> None:
        """Takes a manipulator that is kept from an earlier run."""
        self.statuses["kept"] += 1


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
