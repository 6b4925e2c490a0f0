"""The rows of a chain: the screws along z of neighbours add up in the joint between them.

    θ_i = ψ_(i−1) + φ_i,  d_i = e_(i−1) + b_i
    standard:  base = Z(φ_0, b_0)·S(a_0, α_0),  row i = (θ_i, d_i, a_i, α_i),          tool = Z(ψ_N, e_N)
    modified:  base = Z(φ_0, b_0),              row i = (a_(i−1), α_(i−1), θ_i, d_i),  tool = S(a_N, α_N)·Z(ψ_N, e_N)

A turn and a shift along z commute with a joint's own motion, whether it turns or slides. All else is choice.

Which way the common normals point: an exact shortest path over two directions for each link. a, α → −a, −α with a half
turn before and behind leaves the arm as it is. Of all such choices the table takes the one with the fewest constant
angles, then the fewest negative lengths, then the fewest positive θ and negative α. Data sheets have θ = 0 throughout
even if a is negative, and where a θ = ±π/2 is needed anyhow, a > 0 and θ = −π/2.
"""

from __future__ import annotations

import math
from operator import attrgetter
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from dh2urdf.manipulator import Convention
from dh2urdf.rotations import IDENTITY, RigidTransform, cos_sin, multiply, rotation_z, total
from dh2urdf_plugins.extraction.chain import decompose, x_screw, z_screw
from dh2urdf_plugins.extraction.ends import Base, Tip, bases, tip

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf_plugins.extraction.chain import Chain, LinkScrews, Precision

Cost: TypeAlias = tuple[int, int, int, int]
"""Tenths of the first criterion, and counts of negative a, positive θ and negative α."""
_ANGLE, _HALF_TURN, _HALF_TURN_AT_TIP, _NEGATIVE_LENGTH = 20, 30, 6, 10
_BASE_TURNED, _BASE_TURNED_FOR_LITTLE = 5, 25


class Numbers(NamedTuple):
    """The numbers of a row [m, rad]."""

    a: float
    alpha: float
    d: float
    theta: float


class ChainRows(NamedTuple):
    """A row for each axis of a chain, and the base and tool transforms, with the numbers that a table has."""

    rows: tuple[Numbers, ...]
    base: RigidTransform
    tool: RigidTransform


def rows_of(
    chain: Chain, convention: Convention, precision: Precision, arm_length: float, *, origins: str
) -> ChainRows:
    """The rows of a chain, its sliding axes in their places, nearly parallel links split where they have to be.

    Origins are ``file`` where each d [m] of parallel axes is to be as the file's origins have it, else ``fewest``.
    """
    links = [decompose(link, precision) for link in chain.links[1:-1]]
    last = tip(chain.links[-1], convention, precision, arm_length)
    groups = list(_groups(chain, links))
    between = [links[group.last] for group in groups[:-1]]
    best = _shortest(bases(chain.links[0], convention, precision, arm_length), groups, between, last, precision)
    thetas = [0.0] * len(chain.axes)
    for group, theta in zip(groups, best.turns, strict=True):
        thetas[group.taker] = theta
    for group, link in zip(groups, best.links, strict=False):
        links[group.last] = link
    heights = _heights(chain, links, best.base, last, precision, keep=origins == "file")
    screws = [(link.a, link.alpha) for link in links]
    screws = [*screws, last.row] if convention is Convention.STANDARD else [best.base.row, *screws]
    rows = tuple(
        Numbers(a, alpha, precision.length_of(d), theta)
        for (a, alpha), d, theta in zip(screws, heights, thetas, strict=True)
    )
    base = best.base.transform
    if best.base_turn:
        turn = rotation_z(*cos_sin(precision.angle_of(best.base_turn)))
        base = RigidTransform(multiply(base.rotation, turn), base.translation)
    base = precision.pose_of(base)
    return ChainRows(rows, base, _tool(chain, rows, base, convention, precision) if last.has_tool else IDENTITY)


def _tool(
    chain: Chain, rows: Sequence[Numbers], base: RigidTransform, convention: Convention, precision: Precision
) -> RigidTransform:
    """What is left for the tool at q = 0: it makes up for what the rows and the base lose by rounding.

    The frame of each row is followed in the frame of its axis, where its numbers are those of the arm.
    """
    behind = base.inverse @ chain.links[0]  # from the table's frame to the file's frame K at the same joint
    for row, link in zip(rows, chain.links[1:], strict=True):
        turn, normal = z_screw(row.theta, row.d), x_screw(row.a, row.alpha)
        step = turn @ normal if convention is Convention.STANDARD else normal @ turn
        behind = step.inverse @ behind @ link
    return precision.pose_of(behind)


# --- Shifts -----------------------------------------------------------------------------------------------------------


def _heights(
    chain: Chain, links: Sequence[LinkScrews], base: Base, last: Tip, precision: Precision, *, keep: bool
) -> list[float]:
    """D of every axis [m]; the sum of a run of parallel axes goes to one of them, unless all are kept."""
    heights = [0.0] * len(chain.axes)
    heights[0] += base.shift
    heights[-1] += last.shift
    for number, link in enumerate(links):
        heights[number] += link.b
        heights[number + 1] += link.e
    first, directions = 0, [1]
    for number in range(len(chain.axes)):
        if number < len(links) and links[number].parallel:
            directions.append(directions[-1] * links[number].parallel)
            continue
        run = range(first, number + 1)
        if not keep:
            shift = total(direction * heights[each] for direction, each in zip(directions, run, strict=True))
            shifted = [each for each in run if abs(heights[each]) > precision.length]
            is_inside = first > 0 and number < len(chain.axes) - 1
            if len(run) > 2 and is_inside and all(chain.axes[each].turns for each in run):  # noqa: PLR2004
                taker = number
            else:
                taker = shifted[0] if len(shifted) == 1 else first if first == 0 else number
            for each in run:
                heights[each] = 0.0
            heights[taker] = directions[taker - first] * shift
        first, directions = number + 1, [1]
    return heights


# --- Turns ------------------------------------------------------------------------------------------------------------


class _Group(NamedTuple):
    """Axes on one line, which have one turn to give away."""

    last: int  # number of the last axis
    taker: int  # the axis whose θ is the turn
    inner: float  # what the links between them turn, seen along the first axis [rad]
    direction: int  # 1 where the taker points as the first axis does, else −1
    last_direction: int  # the same of the last axis


def _groups(chain: Chain, links: Sequence[LinkScrews]) -> Iterator[_Group]:
    """The axes, by the lines that they are on."""
    first, inner, directions = 0, 0.0, [1]
    for number in range(len(chain.axes)):
        if number < len(links) and links[number].is_collinear:
            link = links[number]
            inner += directions[-1] * (link.phi + link.parallel * link.psi)
            directions.append(directions[-1] * link.parallel)
            continue
        taker = next((each for each in range(first, number + 1) if not chain.axes[each].turns), first)
        yield _Group(number, taker, inner, directions[taker - first], directions[-1])
        first, inner, directions = number + 1, 0.0, [1]


class _Path(NamedTuple):
    """Choices so far: of the first link, of the links' normals, of θ of each group's taker, of a turn of the base."""

    cost: Cost
    base: Base
    psi: float
    links: tuple[LinkScrews, ...] = ()
    turns: tuple[float, ...] = ()
    base_turn: float = 0.0

    def through(
        self, group: _Group, phi: float | None, row: tuple[float, float], precision: Precision, half_turn: int
    ) -> _Path:
        """The path through a group of axes to what is behind it: φ, then a row's a and α."""
        theta = rest = 0.0
        if phi is not None:
            turn = self.psi + group.inner + group.last_direction * phi
            if self.base.is_turned and not self.turns:
                rest = turn
            else:
                theta = precision.angle_of(group.direction * turn)
        a, alpha = row
        constant = 0 if theta == 0.0 else half_turn if theta == math.pi else _ANGLE
        beside = _NEGATIVE_LENGTH if a < 0.0 and theta and group.taker == group.last else 0
        first, second, third, fourth = self.cost
        cost = first + constant + beside, second + (a < 0.0), third + (theta > 0.0), fourth + (alpha < 0.0)
        return self._replace(cost=cost, turns=(*self.turns, theta), base_turn=self.base_turn + rest)


def _shortest(
    bases: Sequence[Base], groups: Sequence[_Group], links: Sequence[LinkScrews], tip: Tip, precision: Precision
) -> _Path:
    """The best directions of the links between the groups: one fewer than there are groups."""
    cost = attrgetter("cost")

    def search(base_turned: int) -> _Path:
        paths = [
            _Path((base_turned * base.is_turned, int(base.row[0] < 0.0), 0, int(base.row[1] < 0.0)), base, base.turn)
            for base in bases
        ]
        for group, link in zip(groups[:-1], links, strict=True):
            # Of all paths to one direction of a link, only the best goes on.
            reached = []
            for way in (link, link.flipped):
                row = way.a, way.alpha
                best = min((path.through(group, way.phi, row, precision, _HALF_TURN) for path in paths), key=cost)
                reached.append(best._replace(psi=way.psi, links=(*best.links, way)))
            paths = reached
        end = groups[-1]
        half_turn = _HALF_TURN_AT_TIP if end.taker == end.last else _HALF_TURN
        return min((path.through(end, tip.turn, tip.row, precision, half_turn) for path in paths), key=cost)

    best = search(_BASE_TURNED)
    if best.base.is_turned and best.cost[0] > _BASE_TURNED:
        best = search(_BASE_TURNED_FOR_LITTLE)
    return best
