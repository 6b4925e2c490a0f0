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
from dh2urdf.source import Problem, free_name, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.source import Mark

_BACK = rotation_z(0.0, -1.0)


class Extra(NamedTuple):
    """What a row has besides a, α, d and θ.

    Attributes:
        beta: the turn about y behind the row [rad].
        gamma: the turn about z before the row [rad].
        b: the shift along z before the row [m].
        mark: the place of γ or b.
    """

    beta: float
    gamma: float
    b: float
    mark: Mark | None

    @property
    def before(self) -> bool:
        """Whether there is anything before the row."""
        return bool(self.gamma or self.b)


NOTHING = Extra(0.0, 0.0, 0.0, None)


def extra_problems(extras: Mapping[str, Extra], convention: Convention | None) -> Iterator[Problem]:
    """What is wrong with γ and b of the rows of some joints."""
    if convention is not Convention.STANDARD:
        return
    for joint, extra in extras.items():
        if extra.before:
            yield Problem(
                message="gamma and b stand before a row of the modified convention, and these rows are standard",
                mark=extra.mark,
                joint=joint,
                field="gamma" if extra.gamma else "b",
                accepted="0 in gamma and b, or the modified convention: "
                "A = Rz(gamma) Tz(b) Rx(alpha) Tx(a) Rz(theta) Tz(d)",
            )


def with_four_parameters(manipulator: Manipulator, extras: Mapping[str, Extra]) -> Manipulator:
    """The table with a fixed row for each β that is not 0, and for each pair of γ and b.

    The base takes γ and b of the first row, the tool takes β of the last one: neither needs a row.

    Args:
        manipulator: the table without them.
        extras: what rows have besides, by the names of their joints.
    """
    if not any(extra.beta or extra.before for extra in extras.values()):
        return manipulator
    table = _Table(manipulator, extras)
    for row in manipulator.rows:
        table.take(row)
    notice = Problem(
        message=f"beta, gamma and b are part of {', '.join(table.places)}",
        severity="notice",
        mark=manipulator.mark,
        robot=manipulator.name,
        field="beta",
    )
    return replace(
        manipulator,
        rows=tuple(table.rows),
        base=table.base,
        tool=table.tool,
        notices=(*manipulator.notices, notice),
    )


class _Table:
    """A table of four parameters that grows.

    Attributes:
        rows: the rows so far.
        base: its base.
        tool: its tool.
        places: where the other parameters are now.
    """

    def __init__(self, manipulator: Manipulator, extras: Mapping[str, Extra]) -> None:
        self.given, self.extras = manipulator, extras
        self.is_standard = manipulator.convention is Convention.STANDARD
        self.rows: list[DHRow] = []
        self.base, self.tool = manipulator.base, manipulator.tool
        self.places: list[str] = []
        self._taken = {name for row in manipulator.rows for name in (row.joint, row.link)}
        self._behind: DHRow | None = None  # the fixed row that is the last one so far, of a β

    def take(self, given: DHRow) -> None:
        """Adds a row, with what is before and behind it."""
        extra = self.extras.get(given.joint, NOTHING)
        if extra.before:
            self._put_before(given, extra)
        # What is left of a turn about y goes to the row behind it, whose own motion it commutes with.
        row = replace(given, theta=given.theta - HALF_PI) if self._behind and self.is_standard else given
        self._behind = None
        if not extra.beta:
            self.rows.append(row)
            return
        turn = RigidTransform(rotation_y(*cos_sin(extra.beta)), ZERO)
        if given is self.given.rows[-1]:
            self.rows.append(_with_body(row, turn))
            self.tool = turn @ self.tool
            self.places.append("the tool")
        elif self.is_standard:
            self.rows.append(_with_body(row, turn))
            self._behind = self._fixed(row, "beta", theta=HALF_PI, alpha=extra.beta)
        else:
            back = RigidTransform(multiply(rotation_x(*cos_sin(extra.beta)), _BACK), ZERO)
            self.rows.append(_with_body(replace(row, theta=row.theta + HALF_PI), back))
            self._behind = self._fixed(row, "beta", theta=-HALF_PI, alpha=extra.beta)

    def _put_before(self, row: DHRow, extra: Extra) -> None:
        """γ and b: in the base, in the fixed row that is there already, or in one of their own."""
        if not self.rows:
            self.base @= RigidTransform(rotation_z(*cos_sin(extra.gamma)), (0.0, 0.0, extra.b))
            self.places.append("the base")
        elif self._behind is not None:
            self.rows[-1] = replace(self._behind, theta=self._behind.theta + extra.gamma, d=extra.b)
        else:
            self._fixed(row, "gamma", theta=extra.gamma, d=extra.b)

    def _fixed(self, row: DHRow, what: str, *, theta: float, d: float = 0.0, alpha: float = 0.0) -> DHRow:
        """Adds a fixed row without a body of its own."""
        joint, link = (free_name(f"{name}_{what}", self._taken) for name in (row.joint, row.link))
        fixed = JointType.FIXED
        made = DHRow(joint=joint, link=link, type=fixed, a=0.0, alpha=alpha, d=d, theta=theta, mass=0.0, mark=row.mark)
        self.rows.append(made)
        self.places.append(f"the fixed row {shown(joint)}")
        return made


def _with_body(row: DHRow, behind: RigidTransform) -> DHRow:
    """A row with its body, which is given in the frame behind the turn about y, in its own frame."""
    from dh2urdf_plugins.extraction.splitting import with_moved_body

    return with_moved_body(row, behind)
