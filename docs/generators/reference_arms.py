"""The published arms of tests/reference/robots.json as records: the tests compare with them, the gallery draws them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.manipulator import Convention, DHRow, JointType, Limits, Manipulator
from dh2urdf.rotations import IDENTITY, RigidTransform

if TYPE_CHECKING:
    from collections.abc import Sequence

FILE = Path(__file__).parents[2] / "tests" / "reference" / "robots.json"


class ReferenceRobot(NamedTuple):
    """A published table, and where its publisher's own library has its end effector.

    Attributes:
        id: its name in robots.json.
        manipulator: the table.
        q: joint vectors.
        poses: the 4x4 matrix T(base_link → tool0) at each, as nested lists.
        title: the name that its publisher gives it.
    """

    id: str
    manipulator: Manipulator
    q: Sequence[Sequence[float]]
    poses: Sequence[Sequence[Sequence[float]]]
    title: str


def load_reference_robots() -> list[ReferenceRobot]:
    """All published arms, in the order of the file."""
    records = json.loads(FILE.read_text("utf-8"))["robots"]
    return [
        ReferenceRobot(record["id"], _manipulator(record), record["q"], record["T_ee"], record["name"])
        for record in records
    ]


def _manipulator(record: dict[str, Any]) -> Manipulator:
    """A manipulator as robots.json has it; without its masses, some of which no body can have."""
    return Manipulator(
        name=record["id"],
        convention=Convention(record["convention"]),
        rows=tuple(_row(number, row) for number, row in enumerate(record["rows"], start=1)),
        base=_rigid(record["base"]),
        tool=_rigid(record["tool"]),
    )


def _row(number: int, row: dict[str, Any]) -> DHRow:
    lower, upper = row["qlim"] or (None, None)
    return DHRow(
        joint=f"joint_{number}",
        link=f"link_{number}",
        type=JointType(row["type"]),
        a=row["a"],
        alpha=row["alpha"],
        d=row["d"],
        theta=row["theta"],
        offset=row["offset"],
        sign=-1 if row["flip"] else 1,
        limits=Limits(lower=lower, upper=upper),
    )


def _rigid(matrix: list[list[float]] | None) -> RigidTransform:
    if matrix is None:
        return IDENTITY
    (a, b, c, x), (d, e, f, y), (g, h, i, z), _ = matrix
    return RigidTransform((a, b, c, d, e, f, g, h, i), (x, y, z))
