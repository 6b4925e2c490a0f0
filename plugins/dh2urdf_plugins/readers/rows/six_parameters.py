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
    from collections.abc import Iterator, Mapping

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.source import Mark, Problem

say = Messages(__file__)


class Extra(NamedTuple):
    """What a row has besides a, α, d and θ.

    Attributes:
        beta: the turn about y behind the row [rad].
        gamma: the turn about z before the row [rad].
        b: the shift along z before the row [m].
        mark: the place of γ or b.
    """

    beta: float = 0.0
    gamma: float = 0.0
    b: float = 0.0
    mark: Mark | None = None


def extra_problems(extras: Mapping[str, Extra], convention: Convention | None) -> Iterator[Problem]:
    """What is wrong with γ and b of the rows of some joints."""
    for joint, extra in extras.items() if convention is Convention.STANDARD else ():
        if extra.gamma or extra.b:
            yield say("gamma-in-standard", extra.mark, joint=joint, field="gamma" if extra.gamma else "b")


def with_four_parameters(manipulator: Manipulator, extras: Mapping[str, Extra]) -> Manipulator:
    """The table with a fixed row for each β that is not 0, and for each pair of γ and b.

    The base takes γ and b of the first row, the tool takes β of the last one: neither needs a row.

    Args:
        manipulator: the table without them.
        extras: what rows have besides, by the names of their joints; none where all of it is 0.
    """
    if not extras:
        return manipulator
    table = _Table(manipulator)
    for row in manipulator.rows:
        extra = extras.get(row.joint, Extra())
        table.put_before(row, extra)
        table.put(row, extra.beta)
    notice = say("six-parameters", manipulator.mark, robot=manipulator.name, field="beta", places=table.places)
    notices = (*manipulator.notices, notice)
    return replace(manipulator, rows=tuple(table.rows), base=table.base, tool=table.tool, notices=notices)


class _Table:
    """A table of four parameters that grows: its rows, base and tool, and where the other parameters are in it."""

    def __init__(self, given: Manipulator) -> None:
        self.rows: list[DHRow] = []
        self.base, self.tool = given.base, given.tool
        self.places: list[str] = []
        self._is_standard = given.convention is Convention.STANDARD
        self._last = given.rows[-1]
        self._taken = {name for row in given.rows for name in (row.joint, row.link)}
        self._is_behind_beta = False  # whether the last row so far is the fixed one of a β

    def put_before(self, row: DHRow, extra: Extra) -> None:
        """γ and b: in the base, in the fixed row that is there already, or in one of their own."""
        if not (extra.gamma or extra.b):
            return
        if not self.rows:
            self.base @= RigidTransform(rotation_z(*cos_sin(extra.gamma)), (0.0, 0.0, extra.b))
            self.places.append("the base")
        elif self._is_behind_beta:
            self.rows[-1] = replace(self.rows[-1], theta=self.rows[-1].theta + extra.gamma, d=extra.b)
        else:
            self._put_fixed(row, "gamma", theta=extra.gamma, d=extra.b)

    def put(self, given: DHRow, beta: float) -> None:
        """A row, and β behind it."""
        # What is left of a turn about y goes to the row behind it, whose own motion it commutes with.
        left = HALF_PI if self._is_behind_beta and self._is_standard else 0.0
        row = replace(given, theta=given.theta - left) if left else given
        self._is_behind_beta = False
        if not beta:
            self.rows.append(row)
            return
        turn = RigidTransform(rotation_y(*cos_sin(beta)), ZERO)
        if given is self._last:
            self.rows.append(_with_body(row, turn))
            self.tool = turn @ self.tool
            self.places.append("the tool")
        elif self._is_standard:
            self.rows.append(_with_body(row, turn))
            self._put_fixed(row, "beta", theta=HALF_PI, alpha=beta)
        else:
            back = RigidTransform(multiply(rotation_x(*cos_sin(beta)), rotation_z(0.0, -1.0)), ZERO)
            self.rows.append(_with_body(replace(row, theta=row.theta + HALF_PI), back))
            self._put_fixed(row, "beta", theta=-HALF_PI, alpha=beta)

    def _put_fixed(self, row: DHRow, what: str, *, theta: float, d: float = 0.0, alpha: float = 0.0) -> None:
        """A fixed row without a body of its own."""
        joint, link = (free_name(f"{name}_{what}", self._taken) for name in (row.joint, row.link))
        fixed = JointType.FIXED
        made = DHRow(joint=joint, link=link, type=fixed, a=0.0, alpha=alpha, d=d, theta=theta, mass=0.0, mark=row.mark)
        self.rows.append(made)
        self.places.append(f"the fixed row {shown(joint)}")
        self._is_behind_beta = what == "beta"


def _with_body(row: DHRow, behind: RigidTransform) -> DHRow:
    """A row with its body, which is given in the frame behind the turn about y, in its own frame."""
    from dh2urdf_plugins.extraction.splitting import with_moved_body

    return with_moved_body(row, behind)
