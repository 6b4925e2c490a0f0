"""The meshes that a run file gives to manipulators."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.manipulator import Manipulator
from dh2urdf.source import Messages, did_you_mean
from dh2urdf.stages import Rejected

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.run_file.mesh_section import MeshCall

say = Messages(__file__)

SHOWN_NAMES = 1000


class MeshGiver:
    """Gives the manipulators of a run their meshes, and knows whose were never seen."""

    def __init__(self, calls: Sequence[MeshCall]) -> None:
        self._waiting = dict(enumerate(calls))
        self._calls = calls
        self._names: list[str] = []

    def give(self, item: Manipulator | Rejected) -> Manipulator | Rejected:
        """What a reader gave, with its meshes."""
        for number, call in enumerate(self._calls):
            if call.fits(item.name):
                self._waiting.pop(number, None)
                if isinstance(item, Manipulator):
                    item = call.given_to(item)
        if self._waiting and len(self._names) < SHOWN_NAMES:
            self._names.append(item.name)
        return item

    def left_over(self) -> Iterator[Rejected]:
        """Once all have been seen: the meshes that nobody has got."""
        for call in self._waiting.values():
            near = did_you_mean(call.of, self._names)
            problem = say(
                "meshes-for-nobody", call.mark, field="meshes", found=call.of, names=self._names, suggestion=near
            )
            yield Rejected(name=call.of, problems=(problem,), mark=call.mark)
