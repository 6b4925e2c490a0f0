"""What simulators report about a whole run: how many manipulators each was given, and findings of several of them.

All comes from the rows of the manifest, so that a run that was resumed, or made by many workers, tells the same.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.results import ProblemEntry
from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.conversion.one_manipulator import Recipe
    from dh2urdf.results import CoverageEntry, ManipulatorEntry, SimulatorNotice

MOST_NOTICES = 200
"""Different notices of simulators that are counted one by one; the manifest has the others too."""

_QUOTED = re.compile(r"'[^']*'")
_NUMBER = re.compile(r"[-+]?\b\d[\w.+-]*")
_SEVERAL = re.compile(r"…(?:(?:, | and )…| …)+")


@dataclass(slots=True)
class _Group:
    """A notice that is alike for several manipulators."""

    first: str
    problem: ProblemEntry
    manipulators: int = 0


class Verdicts:
    """Gathers what loaders say while the rows of the manifest pass by."""

    def __init__(self, loaders: Mapping[str, bool]) -> None:
        """Begin with nothing.

        Args:
            loaders: the loaders that the run names, and whether each is optional.
        """
        self._coverage: dict[str, CoverageEntry] = {
            name: {
                "simulator": None,
                "of": 0,
                "passed": 0,
                "failed": 0,
                "missing": 0,
                "not_in_sample": 0,
                "no_file": 0,
                "optional": optional,
            }
            for name, optional in loaders.items()
        }
        self._groups: dict[tuple[str, str], _Group] = {}

    @classmethod
    def of(cls, recipe: Recipe) -> Verdicts:
        """Those of the loaders of a run."""
        return cls({call.stage.name: call.stage.name in recipe.optional for call in recipe.loaders})

    def add(self, row: ManipulatorEntry) -> None:
        """Takes one row of the manifest."""
        unasked = row.get("not_loaded", {})
        for name, entry in self._coverage.items():
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
                if (name, kind) not in self._groups and len(self._groups) >= MOST_NOTICES:
                    continue
                group = self._groups.setdefault((name, kind), _Group(row["name"], problem))
                group.manipulators += 1

    def coverage(self) -> dict[str, CoverageEntry]:
        """How many manipulators each loader was given, and what came of it."""
        return self._coverage

    def notices(self) -> list[SimulatorNotice]:
        """What the loaders noticed, loader by loader, the most frequent first."""
        order = list(self._coverage)
        found = sorted(self._groups.items(), key=lambda item: (order.index(item[0][0]), -item[1].manipulators))
        return [
            {
                "loader": name,
                "manipulators": group.manipulators,
                "first": group.first,
                "place": _place(group.problem),
                "joint": group.problem["joint"],
                "message": group.problem["message"],
            }
            for (name, _), group in found
        ]


def alike(message: str) -> str:
    """What a message has in common with those that name other joints, links and numbers."""
    return _SEVERAL.sub("…", _NUMBER.sub("…", _QUOTED.sub("…", message)))


def coverage_line(coverage: Mapping[str, CoverageEntry]) -> str:
    """How many manipulators each simulator was given, in one line: ``drake 104 of 287 (sample)``."""
    return ", ".join(f"{name} {covered(entry)}" for name, entry in coverage.items())


def covered(entry: CoverageEntry) -> str:
    """How many manipulators a loader judged, and why not all."""
    notes = []
    if entry["failed"]:
        notes.append(f"{entry['failed']:,} refused")
    if entry["missing"]:
        notes.append("not installed")
    if entry["not_in_sample"]:
        notes.append("sample")
    if entry["no_file"]:
        notes.append(f"{entry['no_file']:,} without a file")
    told = f" ({'; '.join(notes)})" if notes else ""
    return f"{entry['passed'] + entry['failed']:,} of {entry['of']:,}{told}"


def notice_line(notice: SimulatorNotice) -> str:
    """What a simulator noticed of some manipulators, in one sentence."""
    count = notice["manipulators"]
    what = notice["first"] if count == 1 else f"{count:,} manipulators, first {notice['first']}"
    joint = f"joint {notice['joint']!r}" if notice["joint"] else None
    where = ", ".join(filter(None, (notice["place"], joint)))
    return f"{what}{f' ({where})' if where else ''}: {notice['message']}"


def _place(problem: ProblemEntry) -> str | None:
    """The place of a problem, as messages name it."""
    if problem["file"] is None:
        return None
    return str(Mark(file=problem["file"], line=problem["line"], column=problem["column"], place=problem["place"]))
