"""What simulators report about a whole run: how many manipulators each was given, and findings of several of them.

All comes from the rows of the manifest, so that a run that was resumed, or made by many workers, tells the same.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.conversion.one_manipulator import Recipe
    from dh2urdf.results import CoverageEntry, ManipulatorEntry, SimulatorNotice

MOST_NOTICES = 200
"""Different notices of simulators that are counted one by one; the manifest has the others too."""
_COUNTS = ("of", "passed", "failed", "missing", "not_in_sample", "no_file")
_QUOTED = re.compile(r"'[^']*'")
_NUMBER = re.compile(r"[-+]?\b\d[\w.+-]*")
_SEVERAL = re.compile(r"…(?:(?:, | and )…| …)+")


class Verdicts:
    """Gathers what loaders say while the rows of the manifest pass by.

    Args:
        loaders: the loaders that the run names, and whether each is optional.

    Attributes:
        coverage: how many manipulators each loader was given, and what came of it.
    """

    def __init__(self, loaders: Mapping[str, bool]) -> None:
        none: Any = {"simulator": None, **dict.fromkeys(_COUNTS, 0)}
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
                    file, line, column = problem["file"], problem["line"], problem["column"]
                    mark = Mark(file=file, line=line, column=column, place=problem["place"]) if file else None
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


def alike(message: str) -> str:
    """What a message has in common with those that name other joints, links and numbers."""
    return _SEVERAL.sub("…", _NUMBER.sub("…", _QUOTED.sub("…", message)))


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
