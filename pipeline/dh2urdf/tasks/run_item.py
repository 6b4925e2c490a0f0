"""What a run has to make, as it comes from inputs, cells and variations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.columns import ManipulatorGroups
from dh2urdf.late_tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.cells.cell import Cell
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Rejected
    from dh2urdf.variations.variation import Variant, Variants


class RunItem(NamedTuple):
    """Something that a run has to make.

    Attributes:
        what: the manipulator or cell, or why it cannot be read.
        source: the file it comes from.
        traceback: where its reader failed.
    """

    what: Manipulator | Cell | Rejected
    source: str
    traceback: str = ""

    @property
    def size(self) -> int:
        """One."""
        return 1

    @property
    def names(self) -> Sequence[str]:
        """Its name."""
        return (self.what.name,)

    @property
    def each(self) -> Sequence[Manipulator | Cell | Rejected]:
        """What it is."""
        return (self.what,)


class RunItems(NamedTuple):
    """Manipulators that follow each other in a run: in columns, or variants that are not made yet.

    Attributes:
        what: the manipulators.
        source: the file they come from.
    """

    what: ManipulatorGroups | Variants
    source: str

    @property
    def size(self) -> int:
        """How many they are."""
        return len(self.what)

    @property
    def names(self) -> Sequence[str]:
        """Their names."""
        return self.what.names

    @property
    def each(self) -> Iterable[Manipulator | Variant]:
        """All of them, one by one."""
        return self.what.tables() if isinstance(self.what, ManipulatorGroups) else self.what

    def cut(self, place: int) -> tuple[RunItems, RunItems]:
        """The manipulators before a place, and the others."""
        parts = self.what.part(0, place), self.what.part(place, len(self.what))
        before, after = [RunItems(part, self.source) for part in parts]
        return before, after
