from __future__ import annotations

import math

import numpy as np
import pytest

from dh2urdf.kinematics import joint_motion
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Joint

AXIS = (2 / 7, 3 / 7, 6 / 7)


@pytest.mark.parametrize("kind", [JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC, JointType.FIXED])
def test_a_joint_turns_about_its_axis_or_slides_along_it(kind: JointType) -> None:
    """Compared with the power series of the matrix exponential; a fixed joint does nothing."""
    found = joint_motion(Joint(name="j", type=kind, parent="a", child="b", axis=AXIS), 0.7)
    turns, slides = kind in (JointType.REVOLUTE, JointType.CONTINUOUS), kind is JointType.PRISMATIC
    x, y, z = AXIS
    K = 0.7 * turns * np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    series = sum((np.linalg.matrix_power(K, n) / math.factorial(n) for n in range(20)), np.zeros((3, 3)))
    np.testing.assert_allclose(np.reshape(found.rotation, (3, 3)), series, atol=1e-15)
    np.testing.assert_allclose(found.translation, 0.7 * slides * np.array(AXIS), atol=1e-16)
