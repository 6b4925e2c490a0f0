"""The exact variant against a description of the real arm, by other people and through another library."""

from __future__ import annotations

import importlib.metadata
import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from dh2urdf.kinematics import KinematicChain
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.rotations import RigidTransform
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.robots import alpha_swap

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator


@pytest.fixture
def description() -> Path:
    """The UR5 of the PyPI package example-robot-data."""
    try:
        files = importlib.metadata.files("example-robot-data") or ()
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("example-robot-data is not installed")
    return next(path.locate() for path in files if path.name == "ur5_robot.urdf").resolve()  # type: ignore[attr-defined,no-any-return]


@pytest.mark.parametrize("frames", ["aligned", "dh"])
def test_with_a_half_turn_at_its_base_the_table_is_the_real_ur5(
    ur5: Manipulator, description: Path, frames: str
) -> None:
    """T(base_link → tool0) of the real description is Rz(π) times the DH product of the paper's table, for every q."""
    pinocchio = pytest.importorskip("pinocchio")
    model = pinocchio.buildModelFromUrdf(str(description))
    data = model.createData()
    base, tool = model.getFrameId("base_link"), model.getFrameId("tool0")
    half_turn = RigidTransform.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, math.pi))
    chain = KinematicChain.between(alpha_swap(replace(ur5, base=half_turn), AlphaSwapOptions(frames=frames)))
    rng = np.random.default_rng(5)
    for q in (np.zeros(6), *rng.uniform(-2 * math.pi, 2 * math.pi, (50, 6))):
        pinocchio.framesForwardKinematics(model, data, q)
        real = data.oMf[base].actInv(data.oMf[tool]).homogeneous
        np.testing.assert_allclose(as_matrices(chain.forward_kinematics(list(q))), real, rtol=0, atol=1e-9)
