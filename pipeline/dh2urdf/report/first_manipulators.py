"""What a run's page shows in full: the tables of its first manipulators, and their robots.

The tables are picked out as they go to the workers, and the robots are made of them once more at the end: so a run that
was resumed, and made none of them itself, has the same page.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.cells.cell import Cell
from dh2urdf.conversion.outcome import ManifestRow
from dh2urdf.conversion.robots import make_item
from dh2urdf.errors import ManipulatorError
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.manipulator import Manipulator
from dh2urdf.robot import Joint, Link, Robot

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.conversion.one_manipulator import Recipe
    from dh2urdf.manipulator import DHRow
    from dh2urdf.tasks.batch import Batch, Single

FULL = 24
"""Manipulators of a run that is shown in full."""
EXAMPLES = 6
"""Manipulators that are shown in full of a longer run: its first ones."""


class FirstManipulators:
    """Keeps what a run's first manipulators are made of.

    Args:
        most: how many at most.
    """

    def __init__(self, most: int = FULL) -> None:
        self._most = most
        self._found: list[Single] = []

    def see(self, batch: Batch) -> None:
        """Takes notice of a batch; batches come in the order of the run."""
        self._found += batch.begin(self._most - len(self._found))

    def shown(self, count: int) -> list[Single]:
        """Those that are shown of a run of so many manipulators."""
        return self._found if count <= self._most else self._found[:EXAMPLES]


class ArmTable(NamedTuple):
    """The table of an arm that a manipulator or cell has.

    Attributes:
        arms: the names of the arms of a cell that are this one.
        table: the table.
    """

    arms: tuple[str, ...]
    table: Manipulator


def tables_of(what: object) -> list[ArmTable]:
    """The tables of a manipulator or cell, each once; none of what could not be read."""
    match what:
        case Manipulator() as table:
            return [ArmTable((), table)]
        case Cell(call=call, manipulators=manipulators):
            return [
                ArmTable(tuple(arm.name for arm in call.arms if arm.of == name), table)
                for name, table in manipulators.items()
            ]
    return []


class Mass(NamedTuple):
    """The mass properties of a link.

    Attributes:
        link: the link, which has an inertial.
        given: which of mass, centre of mass and inertia the table says; the transform computes the others.
        drawn: whether the mass was drawn.
    """

    link: Link
    given: tuple[str, ...]
    drawn: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class DetailedManipulator:
    """A manipulator or cell that is shown in full.

    Attributes:
        number: its number in the run, from 1.
        row: its row of the manifest.
        what: its table or tables; None where they could not be read.
        robot: its robot; None where it has no files.
        expected: what the tables declare about it.
    """

    number: int
    row: ManifestRow
    what: Manipulator | Cell | None
    robot: Robot | None = None
    expected: ExpectedPoses | None = None

    @classmethod
    def of(cls, number: int, row: ManifestRow, what: Single, recipe: Recipe) -> DetailedManipulator:
        """What is shown of a manipulator whose row is known.

        Of one without files no robot is made again: what it did to a worker it would do to the run.
        """
        if not isinstance(what, Manipulator | Cell):
            return cls(number=number, row=row, what=None)
        try:
            robot, expected = make_item(what, recipe.transform, recipe.edits) if row["files"] else (None, None)
        except ManipulatorError:  # A transform with changing results is reported already.
            robot = expected = None
        return cls(number=number, row=row, what=what, robot=robot, expected=expected)

    @property
    def key(self) -> str:
        """A word of its own in the page."""
        return f"m{self.number}"

    @property
    def is_cell(self) -> bool:
        """Whether it is a cell."""
        return isinstance(self.what, Cell)

    @property
    def tables(self) -> list[ArmTable]:
        """Its tables, each once."""
        return tables_of(self.what)

    @property
    def masses(self) -> list[Mass]:
        """The links of its robot that have a mass."""
        rows = dict(self._rows())
        masses = []
        for link in self.robot.links if self.robot else ():
            if link.inertial and link.inertial.mass:
                number, row = rows.get(link.name, (0, None))
                parts = ("mass", "com", "inertia")
                given = tuple(part for part in parts if row is not None and getattr(row, part) is not None)
                masses.append(Mass(link, given, f"mass_{number}" in self.row["drawn"]))
        return masses

    def computed(self, joint: Joint) -> list[str]:
        """Which limits of a joint the transform computed, as its table does not say them."""
        row = dict(self._rows()).get(joint.child, (0, None))[1]
        given = row.limits if row is not None else None
        names = ("lower", "upper", "velocity", "effort")
        has = [name for name in names if getattr(joint.limits, name) is not None]
        return [name for name in has if given is None or getattr(given, name) is None]

    @property
    def frames(self) -> list[str]:
        """The links of its robot that have no mass."""
        links = self.robot.links if self.robot else ()
        return [link.name for link in links if not (link.inertial and link.inertial.mass)]

    def _rows(self) -> Iterator[tuple[str, tuple[int, DHRow]]]:
        """The rows of its tables, with their numbers from 1, by the names of the links in its robot."""
        if isinstance(self.what, Cell):
            for arm in self.what.call.arms:
                for number, row in enumerate(self.what.manipulators[arm.of].rows, start=1):
                    yield arm.prefix + row.link, (number, row)
        elif self.what:
            for number, row in enumerate(self.what.rows, start=1):
                yield row.link, (number, row)
