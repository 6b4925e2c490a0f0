"""Rows of six parameters as rows of four and fixed rows between them: the same T(q).

    Hayati:  row · Ry(β),  with Ry(β) = Rz(π/2) · Rx(β) · Rz(−π/2)
    Khalil:  Z(γ, b) · S(a, α) · Z(θ, d)

S. Hayati and M. Mirmirani, Improving the absolute positioning accuracy of robot manipulators (1985), for rows of axes
that are nearly parallel; W. Khalil and J. Kleinfinger, A new geometric notation for open and closed-loop robots (1986),
whose rows are those of the modified convention where γ and b are 0.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.manipulator import Convention, DHRow, JointType
from dh2urdf.rotations import HALF_PI, ZERO, RigidTransform, cos_sin, multiply, rotation_x, rotation_y, rotation_z
from dh2urdf.source import Messages, free_name, shown

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.source import Mark

say = Messages(__file__)


class Extra(NamedTuple):
    """What a row has besides a, α, d and θ."""

    beta: float = 0.0  # the turn about y behind the row [rad]
    gamma: float = 0.0  # the turn about z before the row [rad]
    b: float = 0.0  # the shift along z before the row [m]
    mark: Mark | None = None  # the place of γ or b


def with_four_parameters(manipulator: Manipulator, extras: Mapping[str, Extra]) -> Manipulator:
    """The table with a fixed row for each β that is not 0, and for each pair of γ and b.

    The base takes γ and b of the first row, the tool takes β of the last one: neither needs a row.
    """
    if not extras:
        return manipulator
    from dh2urdf_plugins.extraction.splitting import with_moved_body

    is_standard, base, tool = manipulator.convention is Convention.STANDARD, manipulator.base, manipulator.tool
    taken = {name for row in manipulator.rows for name in (row.joint, row.link)}
    rows, places, is_behind_beta = list[DHRow](), list[str](), False

    def put_fixed(row: DHRow, what: str, *, theta: float, d: float = 0.0, alpha: float = 0.0) -> None:
        joint, link = (free_name(f"{name}_{what}", taken) for name in (row.joint, row.link))
        kind, mark = JointType.FIXED, row.mark  # without a body of its own
        rows.append(DHRow(joint=joint, link=link, type=kind, a=0.0, alpha=alpha, d=d, theta=theta, mass=0.0, mark=mark))
        places.append(f"the fixed row {shown(joint)}")

    for given in manipulator.rows:
        beta, gamma, b, _ = extras.get(given.joint, Extra())
        if is_behind_beta and (gamma or b):
            rows[-1] = replace(rows[-1], theta=rows[-1].theta + gamma, d=b)
        elif rows and (gamma or b):
            put_fixed(given, "gamma", theta=gamma, d=b)
        elif gamma or b:
            base @= RigidTransform(rotation_z(*cos_sin(gamma)), (0.0, 0.0, b))
            places.append("the base")
        # What is left of a turn about y goes to the row behind it, whose own motion it commutes with.
        row = replace(given, theta=given.theta - HALF_PI) if is_behind_beta and is_standard else given
        is_behind_beta = bool(beta) and given is not manipulator.rows[-1]
        turn = RigidTransform(rotation_y(*cos_sin(beta)), ZERO)
        if is_behind_beta and not is_standard:  # the body is given in the frame behind the turn about y
            back = RigidTransform(multiply(rotation_x(*cos_sin(beta)), rotation_z(0.0, -1.0)), ZERO)
            rows.append(with_moved_body(replace(row, theta=row.theta + HALF_PI), back))
        else:
            rows.append(with_moved_body(row, turn) if beta else row)
        if is_behind_beta:
            put_fixed(row, "beta", theta=HALF_PI if is_standard else -HALF_PI, alpha=beta)
        elif beta:
            tool = turn @ tool
            places.append("the tool")
    notice = say("six-parameters", manipulator.mark, robot=manipulator.name, field="beta", places=places)
    notices = (*manipulator.notices, notice)
    return replace(manipulator, rows=tuple(rows), base=base, tool=tool, notices=notices)
