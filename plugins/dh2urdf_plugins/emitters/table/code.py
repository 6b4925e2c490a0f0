"""What code for MATLAB and for Python shares: numbers, names, and fixed rows."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.quantities import UNITS, format_number
from dh2urdf.source import Problem
from dh2urdf.table_text import number_in

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.rotations import RigidTransform

_NOT_A_NAME = re.compile(r"[^A-Za-z0-9]+")


def angle_code(value: float) -> str:
    """An angle [rad] as an expression of pi, where it is a simple one to the last bit: ``-3*pi/4``."""
    return number_in(value, UNITS["rad"])


def matrix_rows(transform: RigidTransform) -> list[list[str]]:
    """A rigid transform as four rows of four numbers."""
    r, t = transform
    rows = [[*map(format_number, (*r[3 * row : 3 * row + 3], t[row]))] for row in range(3)]
    return [*rows, ["0", "0", "0", "1"]]


def variables(arms: Sequence[Manipulator], reserved: Iterable[str]) -> Iterator[tuple[str, Manipulator]]:
    """The arms, each with a name of a variable: ``robot`` of a single one, else of the arm's name."""
    if len(arms) == 1:
        yield "robot", arms[0]
        return
    taken = set(reserved)
    for arm in arms:
        name = _NOT_A_NAME.sub("_", arm.name).strip("_").lower()
        name = first = name if name[:1].isalpha() else f"robot_{name}".rstrip("_")
        number = 1
        while name in taken:
            number += 1
            name = f"{first}_{number}"
        taken.add(name)
        yield name, arm


def unsaid(arms: Sequence[Manipulator], fields: Iterable[str], what: str) -> Iterator[Problem]:
    """A notice of the fields that some rows have and that code has no place for."""
    found = [
        field
        for field in fields
        if any(
            getattr(owner, field, None) is not None for arm in arms for row in arm.rows for owner in (row, row.limits)
        )
    ]
    found += [
        name
        for name, values in (
            ("base mass", [arm.base_mass for arm in arms]),
            ("payload", [arm.payload for arm in arms]),
            ("base meshes", [arm.base_visual or arm.base_collision for arm in arms]),
        )
        if any(value is not None for value in values)
    ]
    if found:
        message = f"{what} has no place for {', '.join(found)}: left out"
        yield Problem(message=message, severity="notice", suggestion="a YAML table holds everything")
