"""The four elementary motions of a row, one after the other: from the frame before it to the frame after it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics.chain import dh_frames, joint_variables
from dh2urdf.manipulator import Convention
from dh2urdf.rotations import IDENTITY, ZERO, RigidTransform, add, cos_sin, rotation_x, rotation_z, scale
from dh2urdf_studio.drawing.strokes import Stroke

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.manipulator import DHRow, Manipulator

NAMES = {"theta": "Rz(θ)", "d": "Tz(d)", "a": "Tx(a)", "alpha": "Rx(α)"}
"""The elementary motions by the parameter that is their size."""
_ORDER = {
    Convention.STANDARD: ("theta", "d", "a", "alpha"),
    Convention.MODIFIED: ("alpha", "a", "theta", "d"),
}


class Motion(NamedTuple):
    """A turn or a shift.

    Attributes:
        field: the parameter.
        size: its value [rad or m].
    """

    field: str
    size: float

    def part(self, share: float) -> RigidTransform:
        """A share of it, from 0 to 1."""
        size = share * self.size
        match self.field:
            case "theta":
                return RigidTransform(rotation_z(*cos_sin(size)), ZERO)
            case "alpha":
                return RigidTransform(rotation_x(*cos_sin(size)), ZERO)
            case "d":
                return RigidTransform(IDENTITY.rotation, (0.0, 0.0, size))
        return RigidTransform(IDENTITY.rotation, (size, 0.0, 0.0))


def order(convention: Convention) -> tuple[str, ...]:
    """The parameters of a row in the order of its motions."""
    return _ORDER[convention]


def motions(convention: Convention, row: DHRow, q: float) -> tuple[Motion, ...]:
    """The four motions of a row at a joint value [rad or m]; their product is A(q)."""
    theta, d = joint_variables(row, q)
    sizes = {"theta": theta, "d": d, "a": row.a, "alpha": row.alpha}
    return tuple(Motion(field, sizes[field]) for field in order(convention))


def so_far(steps: Sequence[Motion], progress: float) -> RigidTransform:
    """The product of the motions that are done, and of the share of the one under way.

    Args:
        steps: the motions of a row.
        progress: from 0, before the first, to the number of motions, after the last.
    """
    done = IDENTITY
    for number, step in enumerate(steps):
        done = done @ step.part(min(max(progress - number, 0.0), 1.0))
    return done


def moving_frame(
    table: Manipulator, number: int, q: Mapping[str, float], progress: float, size: float
) -> Iterator[Stroke]:
    """The axes of the frame on its way through a row, as arrows.

    Args:
        table: the table.
        number: number of the row, counted from 0.
        q: joint values by name [rad or m].
        progress: how far it is, in motions.
        size: length of the arrows [m].
    """
    row = table.rows[number]
    before = dh_frames(table, [q.get(each.joint, 0.0) for each in table.moving_rows])[number]
    r, origin = before @ so_far(motions(table.convention, row, q.get(row.joint, 0.0)), progress)
    for place, name in enumerate("xyz"):
        direction = (r[place], r[place + 3], r[place + 6])
        yield Stroke(row=number, field=name, points=(origin, add(origin, scale(size, direction))), label=name)
