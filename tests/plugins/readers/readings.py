"""What the readers make of a table that is given as text, for the tests of published tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.source import Problem
    from dh2urdf.stages import Rejected

    Read = Callable[..., list[Manipulator | Rejected]]
    ReadOne = Callable[..., Manipulator]

STANDARD = "# convention: standard\n"


def problems_of(read: Read, text: str, suffix: str = ".csv") -> tuple[Problem, ...]:
    """What is wrong with a table of one manipulator."""
    try:
        (rejected,) = read(text, suffix)
    except TableError as error:
        return tuple(error.problems)
    assert not isinstance(rejected, Manipulator)
    return rejected.problems


def notices_of(arm: Manipulator) -> str:
    """What is said of an arm that is accepted."""
    return "\n".join(map(str, arm.notices))
