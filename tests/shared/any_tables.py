"""Strategies for tables of any kind, which property tests share."""

import math
from dataclasses import replace

from hypothesis import strategies as st

from dh2urdf.manipulator import Convention, DHRow, Follower, JointType, Limits, Manipulator
from dh2urdf.rotations import IDENTITY, RigidTransform

LENGTHS = st.sampled_from([0.0, 0.0, 0.3, -0.425]) | st.floats(-2, 2)
"""Any length [m], down to the smallest float."""
SEEN_LENGTHS = st.just(0.0) | st.floats(0.001, 2) | st.floats(-2, -0.001)
"""Lengths [m] that are none or at least a millimetre."""
ANGLES = st.sampled_from([k * math.pi / 2 for k in range(-4, 5)]) | st.floats(-2 * math.pi, 2 * math.pi)
"""Any angle [rad], every other one a multiple of a quarter turn."""
BOUNDS = st.none() | st.tuples(st.floats(-6, 6), st.floats(-6, 6)).map(sorted)


def transforms(lengths: st.SearchStrategy[float] = LENGTHS) -> st.SearchStrategy[RigidTransform]:
    """Rigid transforms, the identity among them."""
    angles = st.tuples(ANGLES, ANGLES, ANGLES)
    return st.just(IDENTITY) | st.builds(RigidTransform.from_xyz_rpy, st.tuples(lengths, lengths, lengths), angles)


@st.composite
def dh_rows(
    draw: st.DrawFn, number: int, lengths: st.SearchStrategy[float] = LENGTHS, *, limits: bool = False
) -> DHRow:
    """The row with this number: any joint type, any geometry; with `limits`, any or none."""
    kind = draw(st.sampled_from(JointType))
    moves = kind is not JointType.FIXED
    bounded = limits and kind in (JointType.REVOLUTE, JointType.PRISMATIC)
    lower, upper = (draw(BOUNDS) if bounded else None) or (None, None)
    return DHRow(
        joint=f"joint_{number}",
        link=f"link_{number}",
        type=kind,
        a=draw(lengths),
        alpha=draw(ANGLES),
        d=draw(lengths),
        theta=draw(ANGLES),
        offset=draw(ANGLES) if moves else 0.0,
        sign=draw(st.sampled_from([1, -1])) if moves else 1,
        limits=Limits(lower=lower, upper=upper),
    )


@st.composite
def with_followers(draw: st.DrawFn, rows: list[DHRow]) -> tuple[DHRow, ...]:
    """The rows, some of which follow others of their kind, before or behind them: chains of followers among them."""
    able = dict[bool, list[str]]()  # joints that others may follow, by whether they slide
    found = {row.joint: row for row in rows}
    for row in draw(st.permutations([row for row in rows if row.type is not JointType.FIXED])):
        leaders = able.setdefault(row.type is JointType.PRISMATIC, [])
        if leaders and draw(st.integers(0, 2)) == 0:
            leader, multiplier = draw(st.sampled_from(leaders)), draw(st.sampled_from([-1.0, 0.5, 1.0, -1.25]))
            law = Follower(leader, multiplier, draw(st.sampled_from([0.0, 0.25, -1.5])))
            found[row.joint] = replace(row, follows=law)
        leaders.append(row.joint)
    return tuple(found.values())


@st.composite
def manipulators(
    draw: st.DrawFn, most: int = 12, lengths: st.SearchStrategy[float] = LENGTHS, *, limits: bool = False
) -> Manipulator:
    """Tables of 1 to `most` rows in both conventions: fixed rows anywhere, any signs, followers, base and tool."""
    rows = [draw(dh_rows(number, lengths, limits=limits)) for number in range(1, draw(st.integers(1, most)) + 1)]
    return Manipulator(
        name="any",
        convention=draw(st.sampled_from(Convention)),
        rows=draw(with_followers(rows)),
        base=draw(transforms(lengths)),
        tool=draw(transforms(lengths)),
    )
