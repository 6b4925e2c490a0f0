"""The facts of a run's page about all manipulators: gathered from the rows of the manifest; few are kept."""

from __future__ import annotations

import math
from array import array
from collections import Counter
from dataclasses import dataclass, field
from itertools import chain
from typing import TYPE_CHECKING, Any, cast

from dh2urdf.kinematics.proof import TOLERANCE
from dh2urdf.quantities.units import Dimension
from dh2urdf.report.figures import Bars
from dh2urdf.results import LoadEntry, ManipulatorEntry, ProofEntry
from dh2urdf.variations.laws import DrawnValue
from dh2urdf.variations.variation import FIELDS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from dh2urdf.tasks.failure_index import FailureIndex

LISTED = 1000
"""Manipulators that the table of all lists: failures first, then the first others."""
SAMPLED = 20_000
"""Manipulators at most whose drawn values are drawn as distributions; of a longer run at least half as many."""
MOST_DRAWN = 12
"""Drawn fields that are columns of this table, or that are drawn as distributions."""
_MOST_WORDS = 12  # different texts that one field may have, in a figure
_RANKS = 2**32
_BARS = 24  # of a distribution
_LOWEST, _HIGHEST = -18, 2  # powers of ten between which errors are counted [m]; below is as good as 0

_FAILED = {"failed": "refused", "missing": "not installed"}

_UNITS = {
    Dimension.LENGTH: "m",
    Dimension.ANGLE: "rad",
    Dimension.SPEED: "m/s",
    Dimension.TURN_RATE: "rad/s",
    Dimension.MASS: "kg",
    Dimension.TORQUE: "N·m",
    Dimension.FORCE: "N",
    Dimension.DAMPING: "N·m·s/rad",
    Dimension.LINEAR_DAMPING: "N·s/m",
    Dimension.INERTIA: "kg·m²",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """How one file or simulator of a manipulator agrees with the DH product.

    Attributes:
        name: of the emitter or loader.
        is_simulator: which of them.
        facts: the proof or the loader's report; None where the file was not looked at.
        keeps_kinematics: whether the transform keeps T(q).
    """

    name: str
    is_simulator: bool
    facts: ProofEntry | LoadEntry | None
    keeps_kinematics: bool

    @property
    def position_error(self) -> float | None:
        """The largest position error [m]."""
        return self.facts["position_error"] if self.facts else None

    @property
    def angle_tolerance(self) -> float | None:
        """What the angle error may be [rad]."""
        if self.facts is None:
            return None
        return cast("LoadEntry", self.facts)["angle_tolerance"] if self.is_simulator else TOLERANCE

    @property
    def verdict(self) -> str:
        """``same arm``, ``other arm``, ``not measured``, or ``differs`` where the transform does not promise more.

        Of a simulator that gave no report it is ``refused`` or ``not installed``.
        """
        if self.is_simulator and (failed := _FAILED.get(cast("LoadEntry", self.facts)["verdict"])):
            return failed
        if self.facts is None or self.facts["position_error"] is None or self.facts["tolerance"] is None:
            return "not measured"
        angle = self.facts["angle_error"] or 0.0
        if self.facts["position_error"] <= self.facts["tolerance"] and angle <= (self.angle_tolerance or 0.0):
            return "same arm"
        return "other arm" if self.keeps_kinematics else "differs"


def checks(row: ManipulatorEntry) -> Iterator[Check]:
    """How the files of a manipulator and the simulators agree with the DH product."""
    keeps = row["keeps_kinematics"]
    for name, proof in row["proof"].items():
        yield Check(name=name, is_simulator=False, facts=proof, keeps_kinematics=keeps)
    for name, load in row["loaders"].items():
        yield Check(name=name, is_simulator=True, facts=load, keeps_kinematics=keeps)


@dataclass(slots=True)
class Errors:
    """The position errors that one emitter's files or one simulator had in a run.

    Attributes:
        is_simulator: which of them.
        simulator: the simulator's name and version.
        measured: how many manipulators were looked at.
        largest: the largest error [m].
        of: the manipulator that had it.
        tolerance: what it may be [m].
    """

    is_simulator: bool
    simulator: str = ""
    measured: int = 0
    largest: float = 0.0
    of: str = ""
    tolerance: float | None = None
    counts: Counter[int] = field(default_factory=Counter)

    def add(self, name: str, facts: ProofEntry | LoadEntry) -> None:
        """Takes what is known of one manipulator."""
        if self.is_simulator:
            load = cast("LoadEntry", facts)
            if load["verdict"] == "passed":
                self.simulator = f"{load['simulator']} {load['version']}"
        error = facts["position_error"]
        if error is None:
            return
        self.measured += 1
        if self.measured == 1 or error > self.largest:
            self.largest, self.of, self.tolerance = error, name, facts["tolerance"]
        power = math.floor(2.0 * math.log10(error)) if error > 0.0 else 2 * _LOWEST
        self.counts[min(max(power, 2 * _LOWEST), 2 * _HIGHEST - 1)] += 1


@dataclass(slots=True)
class Draw:
    """What was drawn for one field of one joint.

    Attributes:
        key: such as ``a_2``.
        values: numbers, or text.
        ranks: of the manipulators that have them; see `Overview`.
    """

    key: str
    values: list[DrawnValue] = field(default_factory=list)
    ranks: array[int] = field(default_factory=lambda: array("I"))

    @property
    def unit(self) -> str:
        """Its unit, or both where that depends on the type of the joint."""
        field = FIELDS.get(self.key.rpartition("_")[0])
        return " or ".join(_UNITS.get(what, "SI") for what in (field.dimension, field.linear) if what) if field else ""

    def add(self, value: DrawnValue, rank: int) -> None:
        """Takes a value of a manipulator."""
        self.values.append(value)
        self.ranks.append(rank)

    def thin(self, most: int) -> None:
        """Leaves the manipulators of the lower ranks."""
        self.values = [value for value, rank in zip(self.values, self.ranks, strict=True) if rank < most]
        self.ranks = array("I", [rank for rank in self.ranks if rank < most])

    def bars(self) -> Bars | None:
        """Its distribution; None where there is none to draw."""
        import numpy as np

        if words := Counter(value for value in self.values if isinstance(value, str)):
            common = words.most_common(_MOST_WORDS)
            return Bars(title=self.key, edges=tuple(w for w, _ in common), counts=tuple(count for _, count in common))
        values = np.array(self.values)
        if not values.size or not 0.0 < np.ptp(values) < math.inf:
            return None
        counts, edges = np.histogram(values, bins=_BARS)
        return Bars(title=self.key, edges=tuple(edges.tolist()), counts=tuple(counts.tolist()), unit=self.unit)


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A line of the table of all manipulators.

    Attributes:
        number: its number in the run, from 1.
        name: its name.
        status: what became of it.
        source: the file it comes from.
        reason: the kind of its failure and the first error.
        errors: position errors by emitter and loader [m].
        verdicts: what came of each loader, or why it was not asked.
        stays: whether it holds still in all simulators that tried.
        remarks: notices and findings.
        drawn: what was drawn for it.
    """

    number: int
    name: str
    status: str
    source: str
    reason: str
    errors: dict[str, float | None]
    verdicts: dict[str, str]
    stays: bool | None
    remarks: int
    drawn: dict[str, Any]


class Overview:
    """Findings about a whole run.

    Of a long run it keeps what was drawn for a sample only. Each manipulator has a rank, and the lowest ranks are kept:
    multiples of the golden ratio, which are spread evenly, also where a grid repeats itself.

    Attributes:
        index: what failed and why.
        count: how many manipulators there are.
        statuses: how many are ok, failed or skipped.
        first: the rows of the first ones.
        errors: position errors by emitter and loader.
        drawn: what was drawn, by field and joint; of a long run a sample.
        sampled: of how many manipulators.
        files: how many files were written.
        size: and how long they are [B].
        remarks: notices and findings.
    """

    def __init__(self, most: int, index: FailureIndex) -> None:
        """Begin with nothing.

        Args:
            most: how many of the first rows to keep.
            index: gets the same rows.
        """
        self.index = index
        self.count = self.files = self.size = self.remarks = self.sampled = 0
        self.statuses: Counter[str] = Counter()
        self.first: list[ManipulatorEntry] = []
        self.errors: dict[str, Errors] = {}
        self.drawn: dict[str, Draw] = {}
        self._most = most
        self._ranks_kept = _RANKS
        self._failed: list[Entry] = []
        self._others: list[Entry] = []

    def add(self, row: ManipulatorEntry) -> None:
        """Takes one row of the manifest."""
        self.count += 1
        self.statuses[row["status"]] += 1
        self.files += len(row["files"])
        self.size += sum([file["bytes"] for file in row["files"]])
        remarks = len(row["notices"]) + sum([len(load["findings"]) for load in row["loaders"].values()])
        self.remarks += remarks
        if self.count <= self._most:
            self.first.append(row)
        for check in checks(row):
            if check.name not in self.errors:
                self.errors[check.name] = Errors(is_simulator=check.is_simulator)
            if check.facts:
                self.errors[check.name].add(row["name"], check.facts)
        self._sample(row["drawn"])
        entries = self._failed if row["status"] == "failed" else self._others
        if len(entries) < LISTED:
            entries.append(self._entry(row, remarks))

    def _sample(self, drawn: Mapping[str, DrawnValue]) -> None:
        rank = self.count * 2654435769 % _RANKS
        for key in drawn if len(self.drawn) < MOST_DRAWN else ():
            if key not in self.drawn and len(self.drawn) < MOST_DRAWN:
                self.drawn[key] = Draw(key)
        if rank >= self._ranks_kept:
            return
        self.sampled += 1
        for key, draw in self.drawn.items():
            if key in drawn:
                draw.add(drawn[key], rank)
        if self.sampled > SAMPLED:
            self._ranks_kept //= 2
            self.sampled = sum(number * 2654435769 % _RANKS < self._ranks_kept for number in range(1, self.count + 1))
            for draw in self.drawn.values():
                draw.thin(self._ranks_kept)

    def _entry(self, row: ManipulatorEntry, remarks: int) -> Entry:
        told = row["errors"][0]["message"] if row["errors"] else ""
        stays = [load["hold"]["stayed"] for load in row["loaders"].values() if "stayed" in load["hold"]]
        return Entry(
            number=self.count,
            name=row["name"],
            status=row["status"],
            source=row["source"],
            reason=f"{row['kind']}: {told}" if row["kind"] else told,
            errors={check.name: check.position_error for check in checks(row)},
            verdicts={name: load["verdict"] for name, load in row["loaders"].items()} | dict(row.get("not_loaded", {})),
            stays=all(stays) if stays else None,
            remarks=remarks,
            drawn={key: row["drawn"][key] for key in row["drawn"] if key in self.drawn},
        )

    @property
    def entries(self) -> list[Entry]:
        """The lines of the table of all, failures first."""
        return [*self._failed, *self._others][:LISTED]

    @property
    def distributions(self) -> list[Bars]:
        """The distributions of what was drawn."""
        return [bars for draw in self.drawn.values() if (bars := draw.bars())]

    @property
    def error_distributions(self) -> list[Bars]:
        """The distributions of the position errors, on one logarithmic scale."""
        powers = list(chain.from_iterable(errors.counts for errors in self.errors.values()))
        if not powers:
            return []
        span = range(min(powers), max(powers) + 1)
        return [
            Bars(
                title=name,
                edges=tuple(10.0 ** (power / 2.0) for power in (*span, span.stop)),
                counts=tuple(errors.counts[power] for power in span),
                unit="position error [m]",
                logarithmic=True,
            )
            for name, errors in self.errors.items()
            if errors.counts
        ]
