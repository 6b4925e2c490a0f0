"""Parallel axes, spherical wrists and OPW parameters, held against published arms and the model's own equations."""

import math
import random
from dataclasses import replace

import numpy as np
import pytest
from plain_frames import turn

from dh2urdf.columns import in_columns
from dh2urdf.kinematics.chain import screws_of_table
from dh2urdf.kinematics.facts import KinematicFacts, OpwParameters, kinematic_facts, kinematic_facts_of_columns
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator

HALF_PI, PI = math.pi / 2, math.pi


def arm(*rows: tuple[float, float, float, float], signs: tuple[int, ...] = (1,) * 6) -> Manipulator:
    """An arm of the standard convention, from θ, d, a and α of each row."""
    made = (
        DHRow(joint=f"j{number}", link=f"l{number}", theta=theta, d=d, a=a, alpha=alpha, sign=sign)
        for number, ((theta, d, a, alpha), sign) in enumerate(zip(rows, signs, strict=False), start=1)
    )
    return Manipulator(name="arm", convention=Convention.STANDARD, rows=tuple(made))


# The rows of the makers' data sheets.
IRB_2400 = arm(
    *((0, 0.615, 0.1, -HALF_PI), (-HALF_PI, 0, 0.705, 0), (0, 0, 0.135, -HALF_PI)),
    *((0, 0.755, 0, HALF_PI), (0, 0, 0, -HALF_PI), (PI, 0.085, 0, 0)),
)
UR5 = arm(
    *((0, 0.089159, 0, HALF_PI), (0, 0, -0.425, 0), (0, 0, -0.39225, 0)),
    *((0, 0.10915, 0, HALF_PI), (0, 0.09465, 0, -HALF_PI), (0, 0.0823, 0, 0)),
)


def opw_pose(opw: OpwParameters, q: list[float]) -> np.ndarray:
    """The pose by the equations of Brandstötter et al., as the solvers of that kind write them."""
    t = [sign * value - offset for sign, value, offset in zip(opw.signs, q, opw.offsets, strict=True)]
    psi, k = math.atan2(opw.a2, opw.c3), math.hypot(opw.a2, opw.c3)
    x = opw.c2 * math.sin(t[1]) + k * math.sin(t[1] + t[2] + psi) + opw.a1
    z = opw.c2 * math.cos(t[1]) + k * math.cos(t[1] + t[2] + psi)
    centre = np.array(
        [x * math.cos(t[0]) - opw.b * math.sin(t[0]), x * math.sin(t[0]) + opw.b * math.cos(t[0]), z + opw.c1]
    )
    pose = turn("z", t[0]) @ turn("y", t[1] + t[2]) @ turn("z", t[3]) @ turn("y", t[4]) @ turn("z", t[5])
    pose[:3, 3] = centre + opw.c4 * pose[:3, 2]
    return pose


class TestOpw:
    def test_an_industrial_arm(self) -> None:
        """The parameters that ROS-Industrial's configurations have for this arm."""
        facts = kinematic_facts(IRB_2400)
        assert facts.parallel == (("j2", "j3"),)
        assert facts.spherical_wrist == ("j4", "j5", "j6")
        opw = facts.opw
        assert opw is not None
        lengths = (opw.a1, opw.a2, opw.b, opw.c1, opw.c2, opw.c3, opw.c4)
        assert lengths == pytest.approx((0.1, -0.135, 0, 0.615, 0.705, 0.755, 0.085), abs=1e-12)
        assert opw.offsets[:5] == pytest.approx((0, 0, -HALF_PI, 0, 0), abs=1e-12)
        assert opw.signs == (1,) * 6

    @pytest.mark.parametrize("signs", [(1,) * 6, (-1, 1, -1, -1, 1, -1), (1, -1, 1, -1, -1, 1)])
    def test_the_model_is_the_arm(self, signs: tuple[int, ...]) -> None:
        """At random joint vectors, whichever way the joints count."""
        turned = arm(*((row.theta, row.d, row.a, row.alpha) for row in IRB_2400.rows), signs=signs)
        opw = kinematic_facts(turned).opw
        assert opw is not None
        draw = random.Random("opw")  # noqa: S311 - reproducible on purpose
        for _ in range(20):
            q = [draw.uniform(-3, 3) for _ in range(6)]
            assert np.abs(opw_pose(opw, q) - turned.fk(q)).max() < 1e-12


def test_parallel_axes() -> None:
    assert kinematic_facts(UR5).parallel == (("j2", "j3", "j4"),)
    assert kinematic_facts(UR5).spherical_wrist == ()


@pytest.mark.parametrize("convention", list(Convention))
def test_axes_are_where_the_joints_turn(convention: Convention) -> None:
    """Against the poses at a small turn: the axis does not move, and the rest turns about it."""
    rows = tuple(
        DHRow(joint=f"j{n}", link=f"l{n}", a=0.1 * n, alpha=0.4 * n, d=0.2, theta=0.3 * n, sign=(-1) ** n)
        for n in range(1, 5)
    )
    table = Manipulator(name="arm", convention=convention, rows=rows)
    q, step = [0.2, -0.5, 0.8, 1.1], 1e-6
    for joint, line in enumerate(screws_of_table(table, q)):
        moved = list(q)
        moved[joint] += step
        turn = np.array(table.fk(moved)) @ np.linalg.inv(table.fk(q))
        skew = (turn[:3, :3] - turn[:3, :3].T) / (2 * step)
        assert np.array([skew[2, 1], skew[0, 2], skew[1, 0]]) == pytest.approx(line.direction, abs=1e-6)
        point = np.array([*line.point, 1.0])
        assert turn @ point == pytest.approx(point, abs=1e-12)


@pytest.mark.parametrize("convention", list(Convention))
def test_many_arms_have_the_facts_of_each(convention: Convention) -> None:
    """Side by side, of lengths of their own: some with a wrist, some bent, some with a sliding joint, some with none."""
    draw = random.Random("facts")  # noqa: S311 - reproducible on purpose

    def like(model: Manipulator, name: str, bend: float, *rows: DHRow) -> Manipulator:
        """An arm with other lengths, whose last row but one may be bent."""
        made = [replace(row, a=row.a * draw.uniform(0.5, 2), d=row.d * draw.uniform(0.5, 2)) for row in model.rows]
        made[-2] = replace(made[-2], a=bend)
        return replace(model, name=name, convention=convention, rows=(*made, *rows))

    slide = DHRow(joint="slide", link="slider", type=JointType.PRISMATIC, a=0.0, alpha=0.0, d=0.1)
    arms = [like(model, f"{k}", k % 3 * 1e-3, *[slide] * (k % 2)) for model in (IRB_2400, UR5) for k in range(12)]
    still = [DHRow(joint=f"j{n}", link=f"l{n}", type=JointType.FIXED, a=0.0, alpha=0.0, d=float(n)) for n in (1, 2)]
    arms += [Manipulator(name=f"still {row.d}", convention=convention, rows=(row,)) for row in still]
    found: dict[int, KinematicFacts] = {}
    for members, tables in in_columns(arms):
        found.update(zip(members, kinematic_facts_of_columns(tables), strict=True))
    assert [found[place] for place in range(len(arms))] == list(map(kinematic_facts, arms))
    wrists = {bool(facts.spherical_wrist) for facts in found.values()}
    if convention is Convention.STANDARD:  # The rows are those of another arm in the other one.
        assert wrists == {True, False}
        assert any(facts.opw for facts in found.values())
