"""What a table must fulfil before an arm can be made of it, whatever read it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import LIMITS, NUMBERS
from dh2urdf.kinematics.mass import inertia_problem, is_sound, possible_inertia
from dh2urdf.manipulator import Convention, DHRow, JointType
from dh2urdf.rotations import HALF_PI, IDENTITY, is_column, nearest_quarter, quarter_turns, rounded_quarter_turn, where
from dh2urdf.source import Messages, Problem, did_you_mean
from dh2urdf.variations.drawn_links import GAP, is_to_compare, mesh_gap
from dh2urdf_plugins.transforms.limits import leaves_limits
from dh2urdf_plugins.transforms.shapes import SHAPES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.columns import ManipulatorColumns
    from dh2urdf.kinematics.mass import Inertias
    from dh2urdf.manipulator import LinkGeometry, Manipulator
    from dh2urdf.rotations import Condition, Number

say = Messages(__file__)

SUSPICIOUS = 2e-3
"""Distance from a quarter turn [rad] at which an angle was probably meant to be one: 3.14 and 1.57 are nearer."""
LARGEST = 1e9
"""Size of a number [any unit] up to which a table is beyond doubt: nothing that follows from it overflows."""
PAYLOAD = "payload"
"""Name of the link that is the payload."""
PAPER_ANGLES = {"0": 0.0, "pi": math.pi, "pi/2": HALF_PI, "-pi/2": -HALF_PI}
"""The set of the paper's equation (1), by the words that a table may use."""


def is_frame(row: DHRow) -> bool:
    """Whether a row is a frame without a body: a fixed one whose mass is 0."""
    return row.type is JointType.FIXED and not is_column(row.mass) and row.mass == 0.0


def is_weighed(row: DHRow) -> bool:
    """Whether a table says everything about the mass of a link."""
    return row.mass is not None and row.com is not None and row.inertia is not None


def row_problem(row: DHRow, code: str, *, field: str, found: float | None = None, **words: Any) -> Problem:  # noqa: ANN401 - of a message
    """A problem of one field of a row."""
    text = None if found is None else f"{found:.12g}"
    return say(code, row.mark, joint=row.joint, field=field, found=text, **words)


# --- Problems of every table ------------------------------------------------------------------------------------------


def table_problems(manipulator: Manipulator) -> list[Problem]:
    """Everything that keeps an arm from being made of a table, in the order of the rows."""
    payload, base_mass = manipulator.payload, manipulator.base_mass
    problems = [*_positive("density", manipulator.density)]
    problems += _positive("base.mass", base_mass or None)
    if payload is not None:
        problems += _positive("payload.mass", payload.mass)
        if payload.inertia and (broken := inertia_problem(payload.inertia)):
            problems.append(say("inertia-of-no-body", field="payload.inertia", reason=broken))
        if any(PAYLOAD in (row.joint, row.link) for row in manipulator.rows):
            problems.append(say("payload-name-taken", field="payload", name=PAYLOAD))
    problems += _geometry_problems("geometry", manipulator.geometry)
    problems += _geometry_problems("base.geometry", manipulator.base_geometry)
    for row in manipulator.rows:
        if row.type is not JointType.FIXED and (row.limits.lower is None) is not (row.limits.upper is None):
            there, missing = ("upper", "lower") if row.limits.lower is None else ("lower", "upper")
            field = f"limits.{missing}"
            problems.append(row_problem(row, "limit-alone", field=field, there=there, missing=missing))
        for name in ("mass", "radius"):
            if (value := getattr(row, name)) is not None and value <= 0.0 and not (name == "mass" and is_frame(row)):
                problems.append(row_problem(row, "not-above-0", field=name, found=value, what=name))
        if row.inertia and (broken := inertia_problem(row.inertia)):
            problems.append(row_problem(row, "inertia-of-no-body", field="inertia", reason=broken))
    return problems


def _positive(name: str, value: float | None) -> Iterator[Problem]:
    if value is not None and value <= 0.0:
        yield say("not-above-0", field=name, found=f"{value:.12g}", what=name)


def _geometry_problems(name: str, geometry: LinkGeometry) -> Iterator[Problem]:
    shape = geometry.shape
    if shape is not None and shape not in SHAPES:
        near = did_you_mean(shape, SHAPES)
        yield say("shape-unknown", field=f"{name}.shape", found=shape, shapes=tuple(SHAPES), suggestion=near)
    yield from _positive(f"{name}.radius", geometry.radius)


def with_inertias(manipulator: Manipulator, how: Inertias, floor: float | None) -> tuple[Manipulator, list[Problem]]:
    """The manipulator with the inertias that are used (`possible_inertia`), and a notice of each other one."""
    notices, rows = [], []
    for row in manipulator.rows:
        if row.inertia is not None:
            used, message = possible_inertia(row.inertia, how, floor)
            if message:
                notices.append(row_problem(row, "inertia-replaced", field="inertia", reason=message))
                row = replace(row, inertia=used)  # noqa: PLW2901 - the row as it is used
        rows.append(row)
    payload = manipulator.payload
    if payload and payload.inertia:
        used, message = possible_inertia(payload.inertia, how, floor)
        if message:
            notices.append(say("inertia-replaced", field="payload.inertia", reason=message))
            payload = replace(payload, inertia=used)
    return (replace(manipulator, rows=tuple(rows), payload=payload) if notices else manipulator), notices


# --- Angles -----------------------------------------------------------------------------------------------------------


def angle_notices(manipulator: Manipulator) -> Iterator[Problem]:
    """One notice of all angles that are kept as given although a quarter turn was probably meant.

    The rows of a table were looked at by its reader: they have a mark.
    """
    found = [
        (row, name)
        for row in manipulator.rows
        if row.mark is None
        for name in _angles_of(row)
        if is_suspicious(getattr(row, name))
    ]
    if found:
        (row, name), more = found[0], len(found) - 1
        value: float = getattr(row, name)
        turns, _ = nearest_quarter(value)
        meant = {1: "pi/2", -1: "-pi/2", 2: "pi", -2: "-pi"}.get(turns, f"{turns}*pi/2")
        others = f"; {more} more angle{' is' if more == 1 else 's are'} rounded like that" if more else ""
        yield row_problem(row, "angle-rounded", field=name, found=value, meant=meant, others=others)


def _angles_of(row: DHRow) -> tuple[str, ...]:
    """The names of the numbers of a row that are angles; the offset of a prismatic joint is a length."""
    turns = row.type in (JointType.REVOLUTE, JointType.CONTINUOUS)
    return ("alpha", "theta", "offset") if turns else ("alpha", "theta")


def is_suspicious(angle: Number) -> Condition:
    """Whether an angle [rad] was probably rounded from a quarter turn, and is none; takes columns."""
    turns, is_whole = nearest_quarter(angle)
    near: Condition = where(is_whole, False, (turns != 0) & (abs(angle - turns * HALF_PI) < SUSPICIOUS))
    if not is_column(near):
        return near and rounded_quarter_turn(angle) is not None
    near[near] = [rounded_quarter_turn(float(each)) is not None for each in angle[near]]
    return near


# --- Followers --------------------------------------------------------------------------------------------------------


def follower_notices(manipulator: Manipulator) -> Iterator[Problem]:
    """A notice of each follower whose law leads it beyond limits that its row has."""
    laws = manipulator.followers
    for row in manipulator.rows:
        if row.joint in laws and leaves_limits(row, laws[row.joint], manipulator):
            limits, leader = row.limits, laws[row.joint].leader
            about: dict[str, Any] = {"lower": limits.lower, "upper": limits.upper, "leader": leader}
            yield row_problem(row, "law-leaves-limits", field="limits", **about)


# --- Many tables ------------------------------------------------------------------------------------------------------


def sure_tables(columns: ManipulatorColumns) -> Condition:
    """Which of many tables are beyond doubt: the functions above have nothing to report about them.

    The tests are sufficient ones, and cheap. What all have alike is judged by one of them.
    """
    import numpy as np

    sure = np.ones(len(columns), dtype=bool)
    with np.errstate(all="ignore"):
        compares, laws = is_to_compare(columns.table), columns.table.followers
        for row in columns.table.rows:
            sure &= _is_sure(row)
            if row.joint in laws:
                sure &= np.logical_not(leaves_limits(row, laws[row.joint], columns.table))
            if compares:
                sure &= mesh_gap(row) < GAP
    if sure.any():
        one = columns.pick(int(sure.argmax()))
        sure &= not table_problems(one) and not any(angle_notices(one))
    return sure


def _is_sure(row: DHRow) -> Condition:
    """Whether nothing is known of the numbers of a row, as far as they are columns."""
    limits = (getattr(row.limits, name) for name in LIMITS)
    sure: Condition = True
    for number in (*(getattr(row, name) for name in NUMBERS), *limits, *(row.com or ())):
        if number is not None:
            sure &= abs(number) <= LARGEST
    for angle in (getattr(row, name) for name in _angles_of(row)):
        if is_column(angle):
            sure &= ~is_suspicious(angle)
    for size in (row.mass, row.radius):
        if size is not None:
            sure &= size > 0.0
    if row.type is JointType.FIXED:
        sure &= row.offset == 0.0
    return sure if row.inertia is None else sure & is_sound(row.inertia)


# --- The paper's variant ----------------------------------------------------------------------------------------------


def nearest_paper_angle(alpha: float) -> tuple[str, float]:
    """The angle of the paper's set that is nearest to α, in a table's word and in rad."""
    return min(PAPER_ANGLES.items(), key=lambda item: abs(item[1] - alpha))


def paper_problems(manipulator: Manipulator, snap: float) -> Iterator[Problem]:
    """What the paper's algorithm has no place for; an α within `snap` of its set is a notice."""
    convention = manipulator.convention
    if convention is not Convention.STANDARD:
        yield say("paper-convention", field="convention", found=convention)
    for row in manipulator.rows:
        word, value = nearest_paper_angle(row.alpha)
        turns = quarter_turns(row.alpha)
        if abs(row.alpha - value) > snap:
            # The word of the paper's set for the same turn as an angle outside it, such as pi for -pi.
            same = None if turns is None else f"{('0', 'pi/2', 'pi', '-pi/2')[turns % 4]} is the same turn"
            about = {"angles": tuple(PAPER_ANGLES), "suggestion": same}
            yield row_problem(row, "paper-alpha", field="alpha", found=row.alpha, **about)
        elif turns is None:
            yield row_problem(row, "paper-alpha-taken", field="alpha", found=row.alpha, word=word)
        for name, allowed in (("theta", 0.0), ("offset", 0.0), ("sign", 1)):
            if (found := getattr(row, name)) != allowed:
                yield row_problem(row, "paper-number", field=name, found=found, allowed=allowed)
        if row.com is not None or row.inertia is not None:
            yield row_problem(row, "paper-masses", field="com")
    for name in ("payload", "base", "tool"):
        if getattr(manipulator, name) not in (None, IDENTITY):
            yield say("paper-part", field=name)
