"""What a table must fulfil before an arm can be made of it, whatever read it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dh2urdf.elementwise import is_column, where
from dh2urdf.kinematics.mass import inertia_problem, is_sound, possible_inertia
from dh2urdf.manipulator import Convention, DHRow, JointType
from dh2urdf.rotations import HALF_PI, IDENTITY, nearest_quarter, quarter_turns, rounded_quarter_turn
from dh2urdf.row_fields import NUMBERS
from dh2urdf.source import Problem, did_you_mean
from dh2urdf.variations.drawn_links import GAP, is_to_compare, mesh_gap
from dh2urdf_plugins.transforms.shapes import SHAPES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.columns import ManipulatorColumns
    from dh2urdf.elementwise import Condition, Number
    from dh2urdf.kinematics.mass import Inertias
    from dh2urdf.manipulator import Inertia, LinkGeometry, Manipulator

SUSPICIOUS = 2e-3
"""Distance from a quarter turn [rad] at which an angle was probably meant to be one: 3.14 and 1.57 are nearer."""
LARGEST = 1e9
"""Size of a number [any unit] up to which a table is beyond doubt: nothing that follows from it overflows."""
PAYLOAD = "payload"
"""Name of the link that is the payload."""
_REPAIR = (
    "if it is published so, set the option inertias of the transform: `--set inertias=repair` takes the nearest that a "
    "body can have, `--set inertias=recompute` that of the drawn shape at the stated mass"
)
PAPER_ANGLES = {"0": 0.0, "pi": math.pi, "pi/2": HALF_PI, "-pi/2": -HALF_PI}
"""The set of the paper's equation (1), by the words that a table may use."""


def is_frame(row: DHRow) -> bool:
    """Whether a row is a frame without a body: a fixed one whose mass is 0."""
    return row.type is JointType.FIXED and not is_column(row.mass) and row.mass == 0.0


def is_weighed(row: DHRow) -> bool:
    """Whether a table says everything about the mass of a link."""
    return row.mass is not None and row.com is not None and row.inertia is not None


def row_problem(row: DHRow, message: str, *, field: str, found: float | None = None, **words: Any) -> Problem:  # noqa: ANN401 - those of a Problem
    """A problem of one field of a row."""
    text = None if found is None else f"{found:.12g}"
    return Problem(message=message, mark=row.mark, joint=row.joint, field=field, found=text, **words)


# --- Problems of every table ------------------------------------------------------------------------------------------


def table_problems(manipulator: Manipulator) -> list[Problem]:
    """Everything that keeps an arm from being made of a table, in the order of the rows."""
    payload, base_mass = manipulator.payload, manipulator.base_mass
    problems = [*_positive("density", manipulator.density)]
    problems += _positive("base.mass", base_mass or None)
    if payload is not None:
        problems += [*_positive("payload.mass", payload.mass), *_tensor_problems("payload.inertia", payload.inertia)]
        if any(PAYLOAD in (row.joint, row.link) for row in manipulator.rows):
            message = f"a row of the table is called {PAYLOAD}, and so is the link of the payload"
            problems.append(Problem(message=message, field="payload", accepted="another name of the row"))
    problems += _geometry_problems("geometry", manipulator.geometry)
    problems += _geometry_problems("base.geometry", manipulator.base_geometry)
    for row in manipulator.rows:
        problems += _row_problems(row)
    return problems


def _positive(name: str, value: float | None) -> Iterator[Problem]:
    if value is not None and value <= 0.0:
        message, found = f"{name} must be greater than 0", f"{value:.12g}"
        yield Problem(message=message, field=name, found=found, accepted="a number greater than 0")


def _tensor_problems(field: str, inertia: Inertia | None) -> Iterator[Problem]:
    if inertia and (broken := inertia_problem(inertia)):
        accepted = "the tensor about the centre of mass [kg·m²] of a body that exists, or nothing: then it is computed"
        yield Problem(message=broken, field=field, accepted=accepted, suggestion=_REPAIR)


def _geometry_problems(name: str, geometry: LinkGeometry) -> Iterator[Problem]:
    shape = geometry.shape
    if shape is not None and shape not in SHAPES:
        message, near = f"no link shape has the name {shape!r}", did_you_mean(shape, SHAPES)
        accepted = ", ".join(SHAPES)
        yield Problem(message=message, field=f"{name}.shape", found=shape, accepted=accepted, suggestion=near)
    yield from _positive(f"{name}.radius", geometry.radius)


def _row_problems(row: DHRow) -> Iterator[Problem]:
    if row.type is not JointType.FIXED and (row.limits.lower is None) is not (row.limits.upper is None):
        there, missing = ("upper", "lower") if row.limits.lower is None else ("lower", "upper")
        message = f"the limit {there} is given without {missing}"
        yield row_problem(row, message, field=f"limits.{missing}", accepted="both of lower and upper, or neither")
    for name in ("mass", "radius"):
        if (value := getattr(row, name)) is not None and value <= 0.0 and not (name == "mass" and is_frame(row)):
            message = f"{name} must be greater than 0"
            accepted = "a number greater than 0, or nothing: then it is computed"
            yield row_problem(row, message, field=name, found=value, accepted=accepted)
    yield from (replace(each, joint=row.joint, mark=row.mark) for each in _tensor_problems("inertia", row.inertia))


def with_inertias(manipulator: Manipulator, how: Inertias, floor: float | None) -> tuple[Manipulator, list[Problem]]:
    """The manipulator with the inertias that are used (`possible_inertia`), and a notice of each other one."""
    notices, rows = [], []
    for row in manipulator.rows:
        if row.inertia is not None:
            used, message = possible_inertia(row.inertia, how, floor)
            if message:
                notices.append(row_problem(row, message, field="inertia", severity="notice"))
                row = replace(row, inertia=used)  # noqa: PLW2901 - the row as it is used
        rows.append(row)
    payload = manipulator.payload
    if payload and payload.inertia:
        used, message = possible_inertia(payload.inertia, how, floor)
        if message:
            notices.append(Problem(message=message, field="payload.inertia", severity="notice"))
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
        for name in _angles_of(row)
        if row.mark is None and is_suspicious(getattr(row, name))
    ]
    if found:
        (row, name), more = found[0], len(found) - 1
        value: float = getattr(row, name)
        turns, _ = nearest_quarter(value)
        meant = {1: "pi/2", -1: "-pi/2", 2: "pi", -2: "-pi"}.get(turns, f"{turns}*pi/2")
        others = f"; {more} more angle{' is' if more == 1 else 's are'} rounded like that" if more else ""
        message = f"{name} is {value:.12g}, which is kept as given; {meant} was probably meant{others}"
        yield row_problem(row, message, field=name, found=value, severity="notice")


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


# --- Many tables ------------------------------------------------------------------------------------------------------


def sure_tables(columns: ManipulatorColumns) -> Condition:
    """Which of many tables are beyond doubt: `table_problems` and `angle_notices` have nothing to report about them.

    The tests are sufficient ones, and cheap. What all have alike is judged by one of them.
    """
    import numpy as np

    sure = np.ones(len(columns), dtype=bool)
    with np.errstate(all="ignore"):
        compares = is_to_compare(columns.table)
        for row in columns.table.rows:
            sure &= _is_sure(row)
            if compares:
                sure &= mesh_gap(row) < GAP
    if sure.any():
        one = columns.pick(int(sure.argmax()))
        sure &= not table_problems(one) and not any(angle_notices(one))
    return sure


def _is_sure(row: DHRow) -> Condition:
    """Whether nothing is known of the numbers of a row, as far as they are columns."""
    limits = (row.limits.lower, row.limits.upper, row.limits.velocity, row.limits.effort)
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
    exact, convention = "the exact variant takes it", manipulator.convention
    if convention is not Convention.STANDARD:
        message = "the paper's variant takes the standard convention only"
        yield Problem(message=message, field="convention", found=convention, accepted="standard", suggestion=exact)
    for row in manipulator.rows:
        word, value = nearest_paper_angle(row.alpha)
        turns = quarter_turns(row.alpha)
        if abs(row.alpha - value) > snap:
            # The word of the paper's set for the same turn as an angle outside it, such as pi for -pi.
            same = exact if turns is None else f"{('0', 'pi/2', 'pi', '-pi/2')[turns % 4]} is the same turn"
            message = f"alpha is {row.alpha:.12g}, which is not in the set of the paper's variant"
            accepted = ", ".join(PAPER_ANGLES)
            yield row_problem(row, message, field="alpha", found=row.alpha, accepted=accepted, suggestion=same)
        elif turns is None:
            message = f"alpha is {row.alpha:.12g} and was taken for {word}"
            yield row_problem(row, message, field="alpha", found=row.alpha, severity="notice")
        for name, allowed in (("theta", 0.0), ("offset", 0.0), ("sign", 1)):
            if (found := getattr(row, name)) != allowed:
                message = f"{name} is {found:.12g}, and the paper's variant has no place for it"
                yield row_problem(row, message, field=name, found=found, accepted=f"{allowed:.12g}", suggestion=exact)
        if row.com is not None or row.inertia is not None:
            message = "com and inertia hold in DH frames, which the paper's chain does not have; its boxes' are written"
            yield row_problem(row, message, field="com", severity="notice")
    for name in ("payload", "base", "tool"):
        if getattr(manipulator, name) not in (None, IDENTITY):
            message = f"the paper's variant has no place for a {name}"
            yield Problem(message=message, field=name, accepted=f"no {name}", suggestion=exact)
