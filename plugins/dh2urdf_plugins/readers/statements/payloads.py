"""What an arm carries at its tool: mass, centre of mass and inertia, as ``payload: {mass, com, inertia}``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.manipulator import Inertia, Payload
from dh2urdf.quantities import Dimension
from dh2urdf.row_fields import INERTIA
from dh2urdf.source import Problem
from dh2urdf_plugins.readers.statements.placements import TransformReader
from dh2urdf_plugins.readers.statements.shapes import ShapeReader, refuse_unknown_keys

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.documents import Node
    from dh2urdf_plugins.readers.words.cells import Units

KEYS = ("mass", "com", "inertia")
ACCEPTED = "{mass: 2.5, com: [0, 0, 0.05], inertia: {ixx: 0.01, iyy: 0.01, izz: 0.004}}"
ACCEPTED_TENSOR = "{ixx: …, iyy: …, izz: …, ixy: …, ixz: …, iyz: …}, or three rows of three"
_SIZE = 3
_MATRIX = ("ixx", "ixy", "ixz", "ixy", "iyy", "iyz", "ixz", "iyz", "izz")


class PayloadReader:
    """Reads a payload and hands over what is wrong with it."""

    def __init__(self, units: Units, add: Callable[[Problem], None]) -> None:
        """Takes the units of numbers, and what is called with every problem."""
        self.units = units
        self.errors = 0
        self._add = add
        self.numbers = TransformReader(units, self.add)

    def add(self, problem: Problem) -> None:
        """Hands over a problem."""
        self.errors += problem.severity == "error"
        self._add(problem)

    def read(self, node: Node) -> Payload | None:
        """The payload that a mapping says, or None where something is wrong with it."""
        if not isinstance(node.value, dict):
            self._error(node, "payload", f"payload is {node.describe()}", ACCEPTED)
            return None
        refuse_unknown_keys(node, KEYS, "payload", self.add)
        mass = None
        if said := node.value.get("mass"):
            mass = ShapeReader(self.units, self.add).positive(said, "payload.mass", Dimension.MASS)
        else:
            self._error(node, "payload.mass", "the payload has no mass", ACCEPTED)
        com = self.numbers.vector(node.value.get("com"), "payload.com", Dimension.LENGTH)
        tensor = self._tensor(node.value["inertia"]) if "inertia" in node.value else None
        if self.errors or mass is None or com is None:
            return None
        return Payload(mass=mass, com=com, inertia=tensor)

    def _tensor(self, node: Node) -> Inertia | None:
        before = self.errors
        entries: dict[str, float] = {}
        for name, item in self._entries(node):
            number = self.numbers.number(item, f"payload.inertia.{name}", Dimension.INERTIA)
            if number is not None and entries.setdefault(name, number) != number:
                message = f"the inertia tensor is not symmetric: {name} is {entries[name]:.9g} and here {number:.9g}"
                self._error(item, "payload.inertia", message, "a symmetric matrix")
        for name in INERTIA[:3] if self.errors == before else ():
            if name not in entries:
                message = f"a part of the payload's inertia is given, and {name} is not"
                self._error(node, f"payload.inertia.{name}", message, ACCEPTED_TENSOR)
        if self.errors != before:
            return None
        return Inertia(**entries)

    def _entries(self, node: Node) -> list[tuple[str, Node]]:
        if isinstance(node.value, dict):
            refuse_unknown_keys(node, INERTIA, "payload.inertia", self.add)
            return [(name, node.value[name]) for name in INERTIA if name in node.value]
        rows = [row.value for row in node.value] if isinstance(node.value, list) else []
        items = [item for row in rows if isinstance(row, list) and len(row) == _SIZE for item in row]
        if len(rows) != _SIZE or len(items) != len(_MATRIX):
            found = f"a list of {len(rows)}" if isinstance(node.value, list) else node.describe()
            self._error(node, "payload.inertia", f"payload.inertia is {found}", ACCEPTED_TENSOR)
            return []
        return list(zip(_MATRIX, items, strict=True))

    def _error(self, node: Node, field: str, message: str, accepted: str) -> None:
        self.add(Problem(message=message, mark=node.mark, field=field, found=node.text, accepted=accepted))
