"""Manipulability, singular values and margins, against models whose values are known."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import dh2urdf
from dh2urdf import Convention, DHRow, JointType, Limits, Manipulator
from dh2urdf.kinematics.inverse import dexterity

TABLES = Path(__file__).parents[3] / "configs" / "tables"


def row(number: int, a: float, kind: JointType, limits: Limits) -> DHRow:
    return DHRow(joint=f"j{number}", link=f"l{number}", type=kind, a=a, alpha=0.0, d=0.0, limits=limits)


def two_links(upper: float | None = None) -> Manipulator:
    kind = JointType.CONTINUOUS if upper is None else JointType.REVOLUTE
    limits = Limits() if upper is None else Limits(lower=-1.0, upper=upper)
    rows = tuple(row(number, a, kind, limits) for number, a in enumerate((0.5, 0.3)))
    return Manipulator(name="planar", convention=Convention.STANDARD, rows=rows)


@pytest.mark.parametrize("elbow", [0.4, -1.2, math.pi / 2, math.pi])
def test_of_two_links(elbow: float) -> None:
    """The Jacobian of a planar arm has the columns of lever arms; its singular values follow by hand."""
    found = dexterity(two_links(), [0.7, elbow])
    lever = np.array([[0.5 * math.sin(elbow), 0.3 + 0.5 * math.cos(elbow), 1.0], [0.0, 0.3, 1.0]])
    small, large = np.sqrt(np.linalg.eigvalsh(lever @ lever.T).clip(0.0))
    assert found.manipulability == pytest.approx(small * large, abs=1e-15)
    assert found.smallest_singular_value == pytest.approx(small, abs=1e-15)
    assert found.margins == {}


def test_of_a_ur5_at_its_singularities() -> None:
    """Wrist (q5 = 0), elbow (q3 = 0): a singular value is 0; elsewhere none is."""
    arm = dh2urdf.read(TABLES / "ur5.csv")
    for q in ([0.3, -1.0, 0.9, 0.2, 0.0, 0.4], [0.3, -1.0, 0.0, 0.2, 0.7, 0.4]):
        found = dexterity(arm, q)
        assert found.smallest_singular_value < 1e-15
        assert found.manipulability < 1e-15
    assert dexterity(arm, [0.3, -1.0, 0.9, 0.2, 0.7, 0.4]).smallest_singular_value > 0.05


def test_of_seven_joints() -> None:
    """The root of det(J Jᵀ), after Yoshikawa."""
    arm = dh2urdf.read(TABLES / "panda.yaml")
    q = [0.1, 0.2, 0.3, -1.2, 0.4, 1.5, 0.6]
    jacobian = arm.jacobian(q)
    assert dexterity(arm, q).manipulability == pytest.approx(math.sqrt(np.linalg.det(jacobian @ jacobian.T)), rel=1e-9)


def test_margins_are_those_of_the_nearer_limit() -> None:
    """Negative outside; by name or by position."""
    arm = two_links(upper=2.0)
    assert dexterity(arm, [0.0, 1.5]).margins == {"j0": 1.0, "j1": 0.5}
    assert dexterity(arm, {"j0": -1.25, "j1": 2.5}).margins == {"j0": -0.25, "j1": -0.5}
