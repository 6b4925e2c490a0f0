"""A frame on its way through a row, and common normals: against textbooks, tables, and a search for nearest points."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from dh2urdf.conversion.robots import make_robot
from dh2urdf.kinematics import dh_frames, row_transform
from dh2urdf.kinematics.chain import Screw, as_matrices
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.plugin_system import Catalog
from dh2urdf.plugin_system.calls import default_call
from dh2urdf.rotations import RigidTransform
from dh2urdf_studio.drawing.strokes import (
    ORDER,
    Position,
    common_normal,
    moving_frame,
    robot_normals,
    row_normals,
    so_far,
    table_normals,
    where_x_is,
)
from dh2urdf_studio.editing.opening import gallery_table
from dh2urdf_studio.editing.session import Session

PLACE = RigidTransform.from_xyz_rpy((0.3, -0.2, 0.5), (0.4, -0.3, 1.1))


def some_table(convention: Convention, seed: int) -> Manipulator:
    """Five skew axes: turning, sliding and fixed."""
    random = np.random.default_rng(seed)
    types = [JointType.REVOLUTE, JointType.PRISMATIC, JointType.REVOLUTE, JointType.FIXED, JointType.REVOLUTE]
    rows = []
    for number, kind in enumerate(types):
        a, alpha, d, theta = (float(x) for x in random.uniform(-1, 1, 4))
        rows.append(DHRow(joint=f"j{number}", link=f"l{number}", type=kind, a=a, alpha=alpha, d=d, theta=theta))
    return Manipulator(name="some", convention=convention, rows=tuple(rows), base=PLACE)


def column(pose: RigidTransform, axis: int) -> NDArray[np.float64]:
    return np.array(pose.rotation).reshape(3, 3)[:, axis]


@pytest.mark.parametrize("convention", list(Convention))
@pytest.mark.parametrize("seed", range(5))
def test_the_feet_are_where_the_table_has_its_frames(convention: Convention, seed: int) -> None:
    """From the lines of the axes alone: a, α, and the origins of the frames, to rounding."""
    table = some_table(convention, seed)
    frames = dh_frames(table, [0.2, -0.3, 0.4, 0.5])
    for number, (normal, row) in enumerate(zip(row_normals(table, frames, 1e-9), table.rows, strict=True)):
        assert normal.position is Position.SKEW
        assert normal.direction is not None
        is_standard = convention is Convention.STANDARD
        frame = frames[number + is_standard]
        sign = 1.0 if row.a > 0.0 else -1.0
        assert normal.direction == pytest.approx(sign * column(frame, 0), abs=1e-9)
        assert normal.angle == pytest.approx(sign * row.alpha, abs=1e-9)
        assert math.dist(normal.start, normal.end) == pytest.approx(abs(row.a), abs=1e-9)
        assert (normal.end if is_standard else normal.start) == pytest.approx(frame.translation, abs=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_the_feet_are_the_nearest_points(seed: int) -> None:
    """Of two lines anywhere, by least squares; the order of the lines turns the direction round."""
    random = np.random.default_rng(seed)
    lines = []
    for _ in range(2):
        direction = random.normal(size=3)
        direction /= np.linalg.norm(direction)
        lines.append(Screw(tuple(direction.tolist()), tuple(random.normal(size=3).tolist())))
    one, other = lines
    normal, back = common_normal(one, other, one.point, 1e-9), common_normal(other, one, other.point, 1e-9)
    matrix = np.stack([one.direction, np.negative(other.direction)], axis=1)
    (along, onward), *_ = np.linalg.lstsq(matrix, np.subtract(other.point, one.point), rcond=None)
    assert normal.start == pytest.approx(np.add(one.point, along * np.array(one.direction)), abs=1e-9)
    assert normal.end == pytest.approx(np.add(other.point, onward * np.array(other.direction)), abs=1e-9)
    assert (back.start, back.end) == (pytest.approx(normal.end), pytest.approx(normal.start))
    assert back.angle == pytest.approx(normal.angle)


UR5 = [
    ("z<sub>0</sub> and z<sub>1</sub> meet in a point: a is 0, and x<sub>1</sub> is along", Position.MEETING),
    ("parallel: they have a common normal at every point, and any of them is right", Position.PARALLEL),
    ("This table takes the one through the origin of {3}; d follows from that choice", Position.PARALLEL),
    ("z<sub>3</sub> and z<sub>4</sub> meet in a point: a is 0, and x<sub>4</sub> is along", Position.MEETING),
    ("x<sub>5</sub> is against z<sub>4</sub> × z<sub>5</sub>", Position.MEETING),
    ("z<sub>5</sub> and z<sub>6</sub> are one line: a is 0, and x<sub>6</sub> may have any", Position.ONE_LINE),
]


def test_parallel_axes_and_axes_that_meet(catalog: Catalog) -> None:
    """Each row of a UR5 has the words for how its axes lie, and the normal that the table takes."""
    session = Session(catalog, gallery_table("ur5.csv", catalog))
    assert session.arm is not None
    table = session.arm.manipulator
    session.move({row.joint: 0.4 * number - 0.7 for number, row in enumerate(table.moving_rows)})
    frames = dh_frames(table, [session.q[row.joint] for row in table.moving_rows])
    for number, ((words, position), normal) in enumerate(zip(UR5, row_normals(table, frames, 1e-9), strict=True)):
        assert words in where_x_is(table, session.q, number)
        assert normal.position is position
        assert normal.end == pytest.approx(frames[number + 1].translation, abs=1e-9)
        if position is Position.MEETING:
            product = np.cross(column(frames[number], 2), column(frames[number + 1], 2))
            assert normal.direction == pytest.approx(product, abs=1e-9)


@pytest.mark.parametrize("convention", list(Convention))
def test_what_is_drawn(convention: Convention) -> None:
    """Axes through both feet, each a and d with its index and its length; of one row, its own alone."""
    table = some_table(convention, 2)
    q = {row.joint: 0.1 for row in table.moving_rows}
    frames = dh_frames(table, [0.1] * 4)
    drawn = list(table_normals(table, q, reach=2.0))
    of = {
        field: [stroke for stroke in drawn if stroke.field == field] for field in ("line", "normal", "offset", "foot")
    }
    assert {field: len(found) for field, found in of.items()} == {"line": 6, "normal": 5, "offset": 5, "foot": 10}
    first = 1 if convention is Convention.STANDARD else 0
    for number, row in enumerate(table.rows):
        assert of["normal"][number].label == f"|a{'₀₁₂₃₄₅'[number + first]}| = {abs(row.a):.4g} m"
        d = row.d + (0.1 if row.type is JointType.PRISMATIC else 0.0)
        assert of["offset"][number].label == f"|d{'₀₁₂₃₄₅'[number + 1]}| = {abs(d):.4g} m"
        ends = [frames[number + 1 - first], frames[number + 1]]
        assert math.dist(*of["offset"][number].points) == pytest.approx(abs(d), abs=1e-9)
        assert of["offset"][number].points[-1] in [pytest.approx(end.translation, abs=1e-8) for end in ends] or first
    for frame, line in zip(frames, of["line"], strict=True):
        ends = np.array(line.points)
        away = np.cross(ends - frame.translation, column(frame, 2))
        assert np.abs(away).max() < 1e-9
    alone = list(table_normals(table, q, reach=2.0, only=2))
    assert {stroke.row for stroke in alone} == {None, 2}
    assert [stroke for stroke in drawn if stroke.row == 2] == [stroke for stroke in alone if stroke.row == 2]
    assert sum(stroke.field == "line" for stroke in alone) == 2


def test_a_description_has_the_same_normals(catalog: Catalog) -> None:
    """Of the robot of a table, without the table: the normals between the axes of its joints."""
    rows = [DHRow(joint=f"j{n}", link=f"l{n}", a=0.2 + n, alpha=0.4 + 0.3 * n, d=0.1 * n, theta=0.0) for n in range(4)]
    table = Manipulator(name="skew", convention=Convention.STANDARD, rows=tuple(rows))
    robot = make_robot(table, default_call(catalog, catalog.usual("transform")))
    q = {"j0": 0.3, "j1": -0.5, "j2": 0.8, "j3": 0.1}

    def normals(drawn: Any) -> list[Any]:
        return [stroke.points for stroke in drawn if stroke.field == "normal"]

    found = normals(robot_normals(robot, q, place=PLACE, reach=1.0))
    expected = normals(table_normals(table, q, place=PLACE, reach=1.0))[:3]  # the fourth leads to no joint
    assert np.array(found) == pytest.approx(np.array(expected), abs=1e-9)


# --- A frame on its way -----------------------------------------------------------------------------------------------

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
