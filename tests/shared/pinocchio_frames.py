"""Where Pinocchio has the links of a URDF: what poses of the project are compared with."""

from collections.abc import Callable, Mapping
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest
from plain_frames import Matrix


def pinocchio_frames(path: Path, **more: bool) -> Callable[[Mapping[str, float], str], Matrix]:
    """T(world → link) by Pinocchio, as a function of the joint values [rad or m] and the link's name.

    `mimic=True` gives the joints that follow others no values of their own.
    """
    pinocchio = pytest.importorskip("pinocchio")
    try:
        model = pinocchio.buildModelFromUrdf(str(path), **more)
    except TypeError:
        pytest.skip("this Pinocchio has no mimic joints")
    data = model.createData()

    def frame(values: Mapping[str, float], link: str) -> Matrix:
        q = pinocchio.neutral(model)
        for name, value in values.items():
            joint = model.joints[model.getJointId(name)]  # A continuous joint has the cosine and the sine of its angle.
            q[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else (cos(value), sin(value))
        pinocchio.framesForwardKinematics(model, data, q)
        return np.array(data.oMf[model.getFrameId(link)].homogeneous)

    return frame
