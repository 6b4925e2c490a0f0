"""What failed in a run, and what simulators report: how many manipulators each was given, and what it found.

All comes from the rows of the manifest, so that a run that was resumed, or made by many workers, tells the same.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from dh2urdf.source import Problem, alike, pattern

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.conversion.one_manipulator import Recipe
    from dh2urdf.results import CoverageEntry, ManipulatorEntry, SimulatorNotice

MOST_NOTICES = 200
"""Different notices of simulators that are counted one by one; the manifest has the others too."""
_COUNTS = ("of", "passed", "failed", "missing", "not_in_sample", "no_file")

MAX_REASONS, MAX_NAMES = 100, 1000
"""Reasons of one kind of failure that the index tells apart, and names that it lists."""


class Verdicts:
    """Gathers what the loaders of a run say, each optional or not, while the rows of the manifest pass by."""

    def __init__(self, loaders: Mapping[str, bool]) -> None:
        none: Any = {"simulator": None, **dict.fromkeys(_COUNTS, 0)}
        # How many manipulators each loader was given, and what came of it.
        self.coverage: dict[str, CoverageEntry] = {
            name: none | {"optional": optional} for name, optional in loaders.items()
        }
        self._notices: dict[tuple[str, str], SimulatorNotice] = {}

    @classmethod
    def of(cls, recipe: Recipe) -> Verdicts:
        """Those of the loaders of a run."""
        return cls({call.stage.name: call.stage.name in recipe.optional for call in recipe.loaders})

    def add(self, row: ManipulatorEntry) -> None:
        """Add a row of the manifest."""
        unasked = row.get("not_loaded", {})
        for name, entry in self.coverage.items():
            entry["of"] += 1
            if name not in row["loaders"]:
                entry["not_in_sample" if unasked.get(name) == "not in the sample" else "no_file"] += 1
                continue
            load = row["loaders"][name]
            entry[load["verdict"]] += 1
            if load["verdict"] == "passed":
                entry["simulator"] = f"{load['simulator']} {load['version']}"
            problems = [*load["findings"], *(load["errors"] if load["optional"] else ())]
            # One manipulator counts once, however often its simulator says a thing.
            for kind, problem in {alike(problem["message"]): problem for problem in problems[::-1]}.items():
                if (name, kind) in self._notices:
                    self._notices[name, kind]["manipulators"] += 1
                elif len(self._notices) < MOST_NOTICES:
                    mark = Problem.from_json(problem, "notice").mark
                    self._notices[name, kind] = {
                        "loader": name,
                        "manipulators": 1,
                        "first": row["name"],
                        "place": str(mark) if mark else None,
                        "joint": problem["joint"],
                        "message": problem["message"],
                    }

    def notices(self) -> list[SimulatorNotice]:
        """What the loaders noticed, loader by loader, the most frequent first."""
        order = list(self.coverage)
        return sorted(self._notices.values(), key=lambda each: (order.index(each["loader"]), -each["manipulators"]))


def holds_still(row: ManipulatorEntry) -> bool | None:
    """Whether an arm stayed in place in every simulator that looked; None where none did."""
    stays = [load["hold"]["stayed"] for load in row["loaders"].values() if "stayed" in load["hold"]]
    return all(stays) if stays else None


def coverage_line(coverage: Mapping[str, CoverageEntry]) -> str:
    """How many manipulators each simulator was given, in one line: ``drake 104 of 287 (sample)``."""
    return ", ".join(f"{name} {covered(entry)}" for name, entry in coverage.items())


def covered(entry: CoverageEntry) -> str:
    """How many manipulators a loader judged, and why not all."""
    notes = {
        f"{entry['failed']:,} refused": entry["failed"],
        "not installed": entry["missing"],
        "sample": entry["not_in_sample"],
        f"{entry['no_file']:,} without a file": entry["no_file"],
    }
    told = "; ".join(note for note, count in notes.items() if count)
    return f"{entry['passed'] + entry['failed']:,} of {entry['of']:,}{f' ({told})' if told else ''}"


def notice_line(notice: SimulatorNotice) -> str:
    """What a simulator noticed of some manipulators, in one sentence."""
    count = notice["manipulators"]
    what = notice["first"] if count == 1 else f"{count:,} manipulators, first {notice['first']}"
    joint = f"joint {notice['joint']!r}" if notice["joint"] else None
    where = ", ".join(filter(None, (notice["place"], joint)))
    return f"{what}{f' ({where})' if where else ''}: {notice['message']}"


# --- What failed ------------------------------------------------------------------------------------------------------


class FailureIndex:
    """What failed in a run, and why, by kind: gathered while the rows of its manifest pass by."""

    def __init__(self) -> None:
        self._statuses: Counter[str] = Counter()
        self._failures: dict[str, dict[str, Any]] = {}

    def add(self, row: ManipulatorEntry) -> None:
        """Take one row of the manifest."""
        self._statuses[row["status"]] += 1
        if row["status"] != "failed":
            return
        none: dict[str, Any] = {"count": 0, "reasons": {}, "other_reasons": 0, "names": []}
        found = self._failures.setdefault(row["kind"] or "", none)
        found["count"] += 1
        if found["count"] <= MAX_NAMES:
            found["names"].append(row["name"])
        message = row["errors"][0]["message"] if row["errors"] else ""
        reason, reasons = pattern(message), found["reasons"]
        if reason in reasons or len(reasons) < MAX_REASONS:
            reasons.setdefault(reason, {"count": 0, "pattern": reason, "example": message})["count"] += 1
        else:
            found["other_reasons"] += 1

    def as_json(self) -> dict[str, Any]:
        """Return the index as plain data, the commonest kinds and reasons first; docs/report.md has its form."""
        failures = {
            kind: {**found, "reasons": sorted(found["reasons"].values(), key=lambda reason: -reason["count"])}
            for kind, found in sorted(self._failures.items(), key=lambda item: -item[1]["count"])
        }
        counts = {status: self._statuses[status] for status in ("ok", "failed")}
        return {"manipulators": self._statuses.total(), **counts, "failures": failures}
