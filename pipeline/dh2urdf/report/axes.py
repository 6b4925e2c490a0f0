"""What the axes of a table declare about its kinematics, as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.kinematics.facts import KinematicFacts, kinematic_facts, kinematic_facts_of_columns
from dh2urdf.report.first_manipulators import tables_of

if TYPE_CHECKING:
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.results import ArmAxes, AxesEntry, OpwEntry
    from dh2urdf.tasks.batch import Batch


class AxesOfRun:
    """Gathers the axes of a run's first manipulators, as their batches go to the workers.

    Attributes:
        entries: what was found; none of a table that could not be read.
    """

    def __init__(self, most: int) -> None:
        """Begin.

        Args:
            most: of how many manipulators at most.
        """
        self._left = most
        self.entries: list[ArmAxes] = []

    def see(self, batch: Batch) -> None:
        """Take notice of a batch; batches come in the order of the run."""
        if not self._left:
            return
        groups, singles = batch.first_groups(self._left)
        found: dict[int, list[tuple[tuple[str, ...], AxesEntry]]] = {
            place: [(arms, axes_entry(table)) for arms, table in tables_of(what)] for place, what in singles.items()
        }
        for places, tables in groups:
            for place, facts in zip(places, kinematic_facts_of_columns(tables), strict=True):
                found[place] = [((), _entry(facts))]
        for place in sorted(found):
            self.entries += [{"name": batch.names[place], "arms": list(arms), **entry} for arms, entry in found[place]]
        self._left = max(0, self._left - len(batch))


def axes_entry(manipulator: Manipulator) -> AxesEntry:
    """The facts of a table's axes [m, rad]."""
    return _entry(kinematic_facts(manipulator))


def _entry(facts: KinematicFacts) -> AxesEntry:
    opw: OpwEntry | None = None
    if (found := facts.opw) is not None:
        opw = {
            "a1": found.a1,
            "a2": found.a2,
            "b": found.b,
            "c1": found.c1,
            "c2": found.c2,
            "c3": found.c3,
            "c4": found.c4,
            "offsets": list(found.offsets),
            "signs": list(found.signs),
        }
    return {
        "parallel": [list(names) for names in facts.parallel],
        "spherical_wrist": list(facts.spherical_wrist),
        "opw": opw,
    }
