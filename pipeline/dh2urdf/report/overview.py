"""The facts of a run's page about all manipulators: gathered from the rows of the manifest; few are kept."""

from __future__ import annotations

import math
import random
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.cells.cell import PLACES
from dh2urdf.columns import SI_UNITS
from dh2urdf.kinematics.proof import TOLERANCE
from dh2urdf.report.figures import Bars
from dh2urdf.report.verdicts import holds_still
from dh2urdf.variations.variation import FIELDS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.results import ManipulatorEntry
    from dh2urdf.variations.laws import DrawnValue

LISTED = 1000  # manipulators that the table of all lists: failures first, then the first others
SAMPLED = 20_000  # manipulators at most whose drawn values are drawn as distributions
MOST_DRAWN = 12  # drawn fields that are columns of this table, or that are drawn as distributions
_MOST_WORDS = 12  # different texts that one field may have, in a figure
_BARS = 24  # of a distribution
_LOWEST, _HIGHEST = -18, 2  # powers of ten between which errors are counted [m]; below is as good as 0


class Check(NamedTuple):
    """How a file of an emitter, or a loader's simulator, agrees with the DH product.

    The verdict is ``same arm``, ``other arm``, ``not measured``, or ``differs`` where the transform does not promise
    more; of a simulator that gave no report ``refused`` or ``not installed``.
    """

    name: str
    is_simulator: bool
    facts: Any  # the proof or the loader's report; None where the file was not looked at
    position_error: float | None  # the largest one [m]
    angle_tolerance: float | None  # [rad]
    verdict: str


def checks(row: ManipulatorEntry) -> Iterator[Check]:
    """How the files of a manipulator and the simulators agree with the DH product."""
    asked: list[tuple[str, Any]] = [*row["proof"].items(), *row["loaders"].items()]
    for number, (name, facts) in enumerate(asked):
        is_simulator = number >= len(row["proof"])
        allowed = (facts["angle_tolerance"] if is_simulator else TOLERANCE) if facts else None
        failed = {"failed": "refused", "missing": "not installed"}.get(facts["verdict"]) if is_simulator else None
        error = facts["position_error"] if facts else None
        if error is None or facts["tolerance"] is None:
            verdict = "not measured"
        elif error <= facts["tolerance"] and (facts["angle_error"] or 0.0) <= (allowed or 0.0):
            verdict = "same arm"
        else:
            verdict = "other arm" if row["keeps_kinematics"] else "differs"
        yield Check(name, is_simulator, facts, error, allowed, failed or verdict)


@dataclass(slots=True)
class Errors:
    """The position errors that one emitter's files or one simulator had in a run."""

    measured: int = 0  # how many manipulators were looked at
    largest: float = 0.0  # [m]
    counts: Counter[int] = field(default_factory=Counter)  # of errors, by their half powers of ten

    def add(self, error: float | None) -> None:
        """Add the error of one manipulator [m]; None where it was not measured."""
        if error is not None:
            self.measured += 1
            self.largest = max(self.largest, error)
            power = math.floor(2.0 * math.log10(error)) if error > 0.0 else 2 * _LOWEST
            self.counts[min(max(power, 2 * _LOWEST), 2 * _HIGHEST - 1)] += 1


class Overview:
    """Findings about a whole run, and its first rows, as many as are asked for.

    Of a long run it keeps what was drawn for a random sample only, which is the same each time.
    """

    def __init__(self, most: int) -> None:
        self.count = self.files = self.size = self.remarks = 0  # manipulators, files, their bytes, notices and findings
        self.statuses: Counter[str] = Counter()
        self.first: list[ManipulatorEntry] = []
        self.errors: dict[str, Errors] = {}  # by emitter and loader
        self.drawn: list[str] = []  # the fields that were drawn, such as ``a_2``
        self._most = most
        self._sample: list[tuple[DrawnValue | None, ...]] = []
        self._random = random.Random(0)  # noqa: S311 - nothing depends on it but a drawing
        self._failed: list[dict[str, Any]] = []
        self._others: list[dict[str, Any]] = []

    def add(self, row: ManipulatorEntry) -> None:
        """Add a row of the manifest."""
        self.count += 1
        self.statuses[row["status"]] += 1
        self.files += len(row["files"])
        self.size += sum([file["bytes"] for file in row["files"]])
        remarks = len(row["notices"]) + sum([len(load["findings"]) for load in row["loaders"].values()])
        self.remarks += remarks
        if self.count <= self._most:
            self.first.append(row)
        found = list(checks(row))
        for check in found:
            self.errors.setdefault(check.name, Errors()).add(check.position_error)
        if drawn := row["drawn"]:
            self.drawn += [key for key in drawn if key not in self.drawn][: MOST_DRAWN - len(self.drawn)]
            place = self.count - 1
            if place >= SAMPLED:  # Algorithm R (Vitter 1985): every manipulator is in the sample with the same chance.
                place = self._random.randrange(self.count)
            if place < SAMPLED:
                self._sample[place : place + 1] = [tuple(drawn.get(key) for key in self.drawn)]
        entries = self._failed if row["status"] == "failed" else self._others
        if len(entries) < LISTED:
            told = {
                "errors": {check.name: check.position_error for check in found},
                "remarks": remarks,
                "stays": holds_still(row),
            }
            entries.append({"number": self.count, "row": row, **told})

    @property
    def sampled(self) -> int:
        """How many manipulators the distributions of drawn values are of."""
        return min(self.count, SAMPLED)

    @property
    def entries(self) -> list[dict[str, Any]]:
        """The lines of the table of all, failures first."""
        return [*self._failed, *self._others][:LISTED]

    @property
    def distributions(self) -> list[Bars]:
        """The distributions of what was drawn."""
        import numpy as np

        found = []
        for column, key in enumerate(self.drawn):
            drawn = [row[column] for row in self._sample if len(row) > column and row[column] is not None]
            if words := Counter(value for value in drawn if isinstance(value, str)):
                common = words.most_common(_MOST_WORDS)
                found.append(Bars(title=key, edges=[word for word, _ in common], counts=[count for _, count in common]))
            elif drawn and 0.0 < np.ptp(drawn) < math.inf:  # type: ignore[arg-type]  # numbers
                counts, edges = np.histogram(drawn, bins=_BARS)  # type: ignore[arg-type]
                field = key.rpartition("/")[2]  # behind the arm of a cell
                about = PLACES.get(field) or FIELDS.get(field.rpartition("_")[0])
                units = [SI_UNITS.get(what, "SI") for what in (about.dimension, about.linear) if what] if about else []
                found.append(Bars(title=key, edges=edges.tolist(), counts=counts.tolist(), unit=" or ".join(units)))
        return found

    @property
    def error_distributions(self) -> list[Bars]:
        """The distributions of the position errors, on one logarithmic scale."""
        powers = [power for errors in self.errors.values() for power in errors.counts]
        span = range(min(powers, default=0), max(powers, default=0) + 1)
        return [
            Bars(
                title=name,
                edges=[10.0 ** (power / 2.0) for power in (*span, span.stop)],
                counts=[errors.counts[power] for power in span],
                unit="position error [m]",
                logarithmic=True,
            )
            for name, errors in self.errors.items()
            if errors.counts
        ]
