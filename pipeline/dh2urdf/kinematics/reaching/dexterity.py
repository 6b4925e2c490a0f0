"""How well an arm can move from a joint vector: manipulability, singular values, margins of the limits.

Source: Yoshikawa, Manipulability of Robotic Mechanisms, IJRR 4(2), 1985. Lengths are in m, and are not weighed against
angles.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics.joint_vectors import JointNames, joint_values
from dh2urdf.kinematics.pose_arrays import table_jacobian
from dh2urdf.source import shown

if TYPE_CHECKING:
    from dh2urdf.manipulator import JointVectors, Manipulator


class Dexterity(NamedTuple):
    """What an arm can do from a joint vector.

    Attributes:
        manipulability: the product of the singular values of the Jacobian of tool0, lengths in m.
        smallest_singular_value: 0 at a singularity.
        margins: by joint, how far its value is from the nearer limit [rad or m]; negative outside. Joints without
            limits are left out.
    """

    manipulability: float
    smallest_singular_value: float
    margins: dict[str, float]


def dexterity(manipulator: Manipulator, q: JointVectors) -> Dexterity:
    """What an arm can do from a joint vector.

    Args:
        manipulator: the arm.
        q: one value per moving joint, or a mapping from their names [rad or m].

    Raises:
        RecordError: q is no joint vector of the arm.
    """
    import numpy as np

    rows = manipulator.moving_rows
    joints = tuple(row.joint for row in rows)
    whose = f"manipulator {shown(manipulator.name)}"
    values, _ = joint_values(q, JointNames(wanted=joints, moving=joints, whose=whose, function="dexterity()"))
    singular = np.linalg.svd(np.asarray(table_jacobian(manipulator, values, full=False)), compute_uv=False)
    margins = {}
    for row, value in zip(rows, values, strict=True):
        ends = [value - row.limits.lower] if row.limits.lower is not None else []
        ends += [row.limits.upper - value] if row.limits.upper is not None else []
        if ends:
            margins[row.joint] = float(min(ends))
    return Dexterity(float(np.prod(singular)), float(singular.min(initial=np.inf)) if joints else 0.0, margins)
