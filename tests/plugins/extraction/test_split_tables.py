"""Tables of calibrated arms: links and masses of the arm's own size, and T(q) of the table."""

import math
import random
from collections.abc import Sequence

import numpy as np
import pytest

import dh2urdf
from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Manipulator
from dh2urdf.rotations import RigidTransform
from dh2urdf_plugins.extraction.splitting import with_split_links

HALF_PI = math.pi / 2
# a, alpha, d, theta: of the size that the calibration files of a UR5 have
CALIBRATED = (
    *((1e-4, HALF_PI + 1e-5, 0.0892, 0.0), (-0.0567, 0.00074, 574.24, -1.2), (0.0181, 0.00084, -507.36, 2.1)),
    *((-3e-5, HALF_PI + 2e-4, -66.77, -0.9), (2e-5, -HALF_PI - 3e-4, 0.0946, 0.0), (0.0, 0.0, 0.0823, 0.0)),
)


def arm(convention: Convention, signs: Sequence[int] = (1,) * 6, **more: object) -> Manipulator:
    """The calibrated arm; of the modified convention with a and α in the row behind."""
    numbers = list(CALIBRATED)
    if convention is Convention.MODIFIED:
        ahead = [(0.0, 0.0), *((a, alpha) for a, alpha, _, _ in numbers)]
        numbers = [(*ahead[place], d, theta) for place, (_, _, d, theta) in enumerate(numbers)]
    rows = (
        DHRow(joint=f"j{n}", link=f"l{n}", a=a, alpha=alpha, d=d, theta=theta, offset=0.1, sign=sign, **more)  # type: ignore[arg-type]
        for n, ((a, alpha, d, theta), sign) in enumerate(zip(numbers, signs, strict=True), start=1)
    )
    base = RigidTransform.from_xyz_rpy((0.1, 0.0, 0.2), (0.0, 0.3, 0.0))
    return Manipulator(name="arm", convention=convention, rows=tuple(rows), base=base)


@pytest.mark.parametrize("convention", list(Convention))
@pytest.mark.parametrize("signs", [(1,) * 6, (-1, 1, -1, -1, 1, -1)])
def test_it_is_the_arm(convention: Convention, signs: tuple[int, ...]) -> None:
    given = arm(convention, signs)
    table, notices = with_split_links(given)
    assert [row.type for row in table.rows].count(JointType.FIXED) == 2
    assert [row.joint for row in table.moving_rows] == [row.joint for row in given.rows]
    assert max(abs(number) for row in table.rows for number in (row.a, row.d)) < 1.5
    assert [notice.field for notice in notices] == ["near_parallel"] * 2
    draw = random.Random("near")  # noqa: S311 - reproducible on purpose
    q = [[draw.uniform(-3, 3) for _ in range(6)] for _ in range(20)]
    assert np.abs(table.fk(q) - given.fk(q)).max() < 5e-12


def test_bodies_stay_where_they_are() -> None:
    inertia = Inertia(ixx=0.02, iyy=0.03, izz=0.04, ixy=0.001)
    given = arm(Convention.STANDARD, mass=2.0, com=(0.1, 0.02, 0.3), inertia=inertia)
    table, _ = with_split_links(given)
    q = [0.3, -0.7, 1.1, 0.4, -0.2, 0.9]
    old, new = given.fk_all(q), table.fk_all(q)
    for row in table.moving_rows:
        one = old[row.link] @ np.array([0.1, 0.02, 0.3, 1])
        assert row.com is not None
        assert new[row.link] @ np.array([*row.com, 1]) == pytest.approx(one, abs=1e-9)
        assert row.inertia is not None
        turned = [old[row.link][:3, :3] @ _matrix(inertia) @ old[row.link][:3, :3].T]
        found = [new[row.link][:3, :3] @ _matrix(row.inertia) @ new[row.link][:3, :3].T]
        assert np.abs(np.array(turned) - np.array(found)).max() < 1e-9


def _matrix(i: Inertia) -> np.ndarray:
    return np.array([[i.ixx, i.ixy, i.ixz], [i.ixy, i.iyy, i.iyz], [i.ixz, i.iyz, i.izz]])


def test_a_table_without_such_axes_stays() -> None:
    rows = tuple(DHRow(joint=f"j{n}", link=f"l{n}", a=0.4, alpha=HALF_PI, d=0.1) for n in range(3))
    given = Manipulator(name="arm", convention=Convention.STANDARD, rows=rows)
    assert with_split_links(given) == (given, [])


def test_a_long_arm_is_asked_about_its_calibration() -> None:
    table = "# convention: standard\na, alpha, d, theta\n0.1, 0.0007, 574.24, 0\n0.1, 0.0008, -507.36, 0\n"
    assert "near_parallel=split" in str(dh2urdf.read(table, reader="csv").notices[0])
    table = table.replace("0.0007", "pi/2").replace("0.0008", "0")
    assert "if its lengths are in mm" in str(dh2urdf.read(table, reader="csv").notices[0])
