"""What a run's page says of all its manipulators: gathered while the rows of the manifest pass by; few are kept."""

from __future__ import annotations

import math
from array import array
from collections import Counter
from dataclasses import dataclass, field
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO

import orjson

from dh2urdf.manifest import Index
from dh2urdf.outcome import Row
from dh2urdf.proof import TOLERANCE
from dh2urdf.report.figures import Bars
from dh2urdf.units import Dimension
from dh2urdf.variations import FIELDS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.laws import Value

LISTED = 1000
"""Manipulators that the table of all lists [1]: failures first, then the first others."""
SAMPLED = 20_000
"""Manipulators of a longer run whose drawn values are drawn as distributions [1]."""
MOST_DRAWN = 12
"""Drawn fields that are columns of this table, or that are drawn as distributions [1]."""
_MOST_WORDS = 12  # different texts that one field may have, in a figure
_BARS = 24  # of a distribution
_LOWEST, _HIGHEST = -18, 2  # powers of ten between which errors are counted [m]; below is as good as 0

_UNITS = {
    Dimension.LENGTH: "m",
    Dimension.ANGLE: "rad",
    Dimension.SPEED: "m/s",
    Dimension.TURN_RATE: "rad/s",
    Dimension.MASS: "kg",
    Dimension.EFFORT: "N·m or N",
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
    facts: Row | None
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
        return self.facts["angle_tolerance"] if self.is_simulator else TOLERANCE

    @property
    def verdict(self) -> str:
        """``same arm``, ``other arm``, ``not measured``, or ``differs`` where the transform does not promise more."""
        if self.facts is None or self.facts["position_error"] is None or self.facts["tolerance"] is None:
            return "not measured"
        angle = self.facts["angle_error"] or 0.0
        if self.facts["position_error"] <= self.facts["tolerance"] and angle <= (self.angle_tolerance or 0.0):
            return "same arm"
        return "other arm" if self.keeps_kinematics else "differs"


def checks(row: Row) -> Iterator[Check]:
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

    def add(self, name: str, facts: Row) -> None:
        """Takes what is known of one manipulator."""
        if self.is_simulator:
            self.simulator = f"{facts['simulator']} {facts['version']}"
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
        numbers: the values.
        words: how often each text was drawn, where it is no number.
    """

    key: str
    numbers: array[float] = field(default_factory=lambda: array("d"))
    words: Counter[str] = field(default_factory=Counter)

    @property
    def unit(self) -> str:
        """Its unit, or both where that depends on the type of the joint."""
        field = FIELDS.get(self.key.rpartition("_")[0])
        return " or ".join(_UNITS.get(what, "SI") for what in (field.dimension, field.linear) if what) if field else ""

    def add(self, value: Value) -> None:
        """Takes a value."""
        if isinstance(value, str):
            self.words[value] += 1
        else:
            self.numbers.append(value)

    def bars(self) -> Bars | None:
        """Its distribution; None where there is none to draw."""
        import numpy as np

        if self.words:
            words = self.words.most_common(_MOST_WORDS)
            return Bars(title=self.key, edges=tuple(w for w, _ in words), counts=tuple(count for _, count in words))
        values = np.array(self.numbers)
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
    stays: bool | None
    remarks: int
    drawn: dict[str, Any]


class Overview:
    """What there is to say of a whole run.

    Attributes:
        count: how many manipulators it has.
        statuses: how many are ok, failed or skipped.
        first: the rows of the first ones.
        errors: position errors by emitter and loader.
        drawn: what was drawn, by field and joint; of a long run a sample.
        files: how many files were written.
        size: and how long they are [B].
        remarks: notices and findings.
        index: what failed and why, as `index.json` has it.
    """

    def __init__(self, rows: BinaryIO, most: int) -> None:
        rows.seek(0)
        self._share = SAMPLED * 2**32 // max(SAMPLED, sum(1 for _ in rows))
        self.count = 0
        self.statuses: Counter[str] = Counter()
        self.first: list[Row] = []
        self.errors: dict[str, Errors] = {}
        self.drawn: dict[str, Draw] = {}
        self.files = self.size = self.remarks = 0
        self._failed: list[Entry] = []
        self._others: list[Entry] = []
        index = Index()
        rows.seek(0)
        for line in rows:
            row = orjson.loads(line)
            self._add(row)
            index.add(row)
            if len(self.first) < most:
                self.first.append(row)
        self.index = index.as_json()

    def _add(self, row: Row) -> None:
        self.count += 1
        self.statuses[row["status"]] += 1
        self.files += len(row["files"])
        self.size += sum(file["bytes"] for file in row["files"])
        remarks = len(row["notices"]) + sum(len(load["findings"]) for load in row["loaders"].values())
        self.remarks += remarks
        for check in checks(row):
            if check.name not in self.errors:
                self.errors[check.name] = Errors(is_simulator=check.is_simulator)
            if check.facts:
                self.errors[check.name].add(row["name"], check.facts)
        # Multiples of the golden ratio are spread evenly, also where a grid repeats itself.
        is_sampled = self.count * 2654435769 % 2**32 < self._share
        for key, value in row["drawn"].items():
            if key not in self.drawn and len(self.drawn) < MOST_DRAWN:
                self.drawn[key] = Draw(key)
            if is_sampled and key in self.drawn:
                self.drawn[key].add(value)
        entries = self._failed if row["status"] == "failed" else self._others
        if len(entries) < LISTED:
            entries.append(self._entry(row, remarks))

    def _entry(self, row: Row, remarks: int) -> Entry:
        told = row["errors"][0]["message"] if row["errors"] else ""
        stays = [load["hold"]["stayed"] for load in row["loaders"].values() if "stayed" in load["hold"]]
        return Entry(
            number=self.count,
            name=row["name"],
            status=row["status"],
            source=row["source"],
            reason=f"{row['kind']}: {told}" if row["kind"] else told,
            errors={check.name: check.position_error for check in checks(row)},
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
