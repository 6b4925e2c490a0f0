"""The hand of tests/plugins/edits: a finger that turns, and one that follows it and slides, by products of plain frames."""

from pathlib import Path

import numpy as np
from plain_frames import Matrix, rpy, shift, turn

HAND = Path(__file__).parents[1] / "plugins" / "edits" / "hand.urdf"
TWO_JOINTS = "# convention: standard\nname, a, alpha, d\none, 0.4, pi/2, 0.1\ntwo, 0.3, 0, 0\n"
"""The table of an arm that holds the hand."""


def hand_frames(left: float) -> dict[str, Matrix]:
    """T(base_link → link) of every link, where the joint that leads has a value [rad]."""
    return {
        "base_link": np.eye(4),
        "left_finger": shift(0.0, 0.01, 0.05) @ turn("y", 0.4) @ turn("x", left),
        "right_finger": shift(0.0, -0.01, 0.05) @ rpy(0.1, -0.2, 1.3) @ shift(0.0, *(0.001 - 0.05 * left) * FINGER),
        "tool0": shift(z=0.1),
    }


FINGER = np.array([0.6, 0.8])
"""y and z of the axis along which the right finger slides."""
