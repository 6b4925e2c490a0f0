"""A frame on its way through a row: the elementary motions, and their product."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from dh2urdf.kinematics import dh_frames, row_transform
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.rotations import RigidTransform
from dh2urdf_studio.drawing.strokes import ORDER, moving_frame, so_far

if TYPE_CHECKING:
    from numpy.typing import NDArray

ROW = DHRow(joint="j", link="l", a=0.4, alpha=-0.7, d=0.2, theta=0.3, offset=0.1, sign=-1)
SLIDE = DHRow(joint="s", link="m", type=JointType.PRISMATIC, a=0.1, alpha=0.5, d=0.3, theta=-0.9)


def elementary(field: str, size: float) -> NDArray[np.float64]:
    """The matrices of the textbooks."""
    matrix = np.eye(4)
    c, s = np.cos(size), np.sin(size)
    if field == "theta":
        matrix[:2, :2] = [[c, -s], [s, c]]
    elif field == "alpha":
        matrix[1:3, 1:3] = [[c, -s], [s, c]]
    else:
        matrix[{"a": 0, "d": 2}[field], 3] = size
    return matrix


@pytest.mark.parametrize("convention", list(Convention))
@pytest.mark.parametrize("row", [ROW, SLIDE])
def test_the_product_is_the_row(convention: Convention, row: DHRow) -> None:
    """At the end it is A(q); in between the motions of the textbook's order, the last one in part."""
    names = ("theta", "d", "a", "alpha") if convention is Convention.STANDARD else ("alpha", "a", "theta", "d")
    assert ORDER[convention] == names
    assert so_far(convention, row, 0.35, 0.0) == RigidTransform(
        (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0)
    )
    whole = as_matrices(row_transform(convention, row, 0.35))
    assert np.abs(as_matrices(so_far(convention, row, 0.35, 4.0)) - whole).max() < 1e-15
    sizes = {"theta": row.theta, "d": row.d, "a": row.a, "alpha": row.alpha}
    sizes["d" if row is SLIDE else "theta"] += row.offset + row.sign * 0.35
    expected = elementary(names[0], sizes[names[0]]) @ elementary(names[1], 0.25 * sizes[names[1]])
    assert np.abs(as_matrices(so_far(convention, row, 0.35, 1.25)) - expected).max() < 1e-15


@pytest.mark.parametrize("convention", list(Convention))
def test_the_frame_goes_from_frame_to_frame(convention: Convention) -> None:
    """It begins as the frame before the row and ends as the one after it, at whatever pose; its arrows have one length."""
    table = Manipulator(name="arm", convention=convention, rows=(SLIDE, ROW))
    q = {"j": 0.35, "s": -0.2}
    frames = dh_frames(table, (-0.2, 0.35))
    for number in range(2):
        for progress, there in ((0.0, frames[number]), (4.0, frames[number + 1])):
            arrows = list(moving_frame(table, number, q, progress, 0.5))
            assert [(arrow.row, arrow.field) for arrow in arrows] == [(number, name) for name in "xyz"]
            assert all(arrow.points[0] == pytest.approx(there.translation, abs=1e-15) for arrow in arrows)
            directions = np.array([np.subtract(end, start) for start, end in (arrow.points for arrow in arrows)])
            assert np.abs(directions.T - 0.5 * np.reshape(there.rotation, (3, 3))).max() < 1e-15
