"""The same arm in the other convention or in other units: new numbers, same T(q).

The two conventions differ in where a row is cut. With S_i = Tx(a_i)·Rx(alpha_i) and J_i = Rz(theta_i)·Tz(d_i),

    standard:  base · J_1 S_1 · J_2 S_2 · … · J_N S_N · tool
    modified:  base · S_0 J_1 · S_1 J_2 · … · S_{N-1} J_N · tool

so a and alpha move by one row, and what is left over at one end goes into the tool or the base. Centres of mass and
inertias hold in DH frame i, which is S_i further in the standard convention, and are moved into the other frame.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.columns import COM, INERTIA
from dh2urdf.kinematics.mass import rotated
from dh2urdf.manipulator import Convention, Inertia, JointType
from dh2urdf.quantities import QuantityError, evaluate, number_in
from dh2urdf.quantities.number_text import format_number
from dh2urdf.quantities.units import UNITS, Unit
from dh2urdf.rotations import IDENTITY, RigidTransform, cos_sin, rotation_x
from dh2urdf.table_text import FIELDS, TableText
from dh2urdf.table_text.texts import dimension_of, table_text, transform_text, unit_of
from dh2urdf_studio.editing.edits import meaning
from dh2urdf_studio.editing.reading import read_whole

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf_studio.editing.edits import History

_VARIABLE_FIELDS = {"d", "theta", "offset", "sign"}
"""Fields of which one cell may say several: ``-q2 + pi/2`` is an angle, an offset and a sign."""
_ROUNDING = 1e-13  # relative difference of numbers that were converted and converted back
_MOVED_ROUNDING = 1e-12  # that of products of transforms
_LEFT_OF_ZERO = 1e-16  # what may be left of a 0 then
_ENTRY = re.compile(r"\b(xyz|com|radius|rpy): (\[[^]]*\]|[^,}]*)")
_NUMBER = re.compile(r"(?!0[\],]|0$)[^\[\], ][^\[\],]*")
_TRANSLATION = re.compile(r"(?<=, )(?!0\])([^\[\], ]+)(?=\], \[)")
"""The last number in a row of a matrix, but of the last row."""
_ENDS = ("base", "tool", "payload", "defaults")
_MASS_FIELDS = (*COM, *INERTIA)


def _screw(row: DHRow) -> RigidTransform:
    """Tx(a)·Rx(alpha) of a row."""
    return RigidTransform(rotation_x(*cos_sin(row.alpha)), (row.a, 0.0, 0.0))


def with_convention(
    table: TableText, manipulator: Manipulator, convention: Convention, earlier: Manipulator | None = None
) -> TableText:
    """The same arm in a convention.

    Texts of a and alpha move as they are; the base, the tool, centres of mass and inertias become numbers where they
    change. Of what the table was earlier in this convention, the first or last row has its a and alpha back where the
    base or the tool still is what came of them.
    """
    if manipulator.convention is convention:
        return replace(table, convention=str(convention))
    length, angle = UNITS[table.length_unit], UNITS[table.angle_unit]
    to_modified, rows = convention is Convention.MODIFIED, manipulator.rows
    screws: list[Mapping[str, str]] = [{k: row[k] for k in ("a", "alpha") if k in row} for row in table.rows]
    base, tool = manipulator.base, manipulator.tool
    between = [_screw(row) for row in rows]
    if to_modified:
        tool = between[-1] @ tool
        (a, alpha), base = _left_over(base, earlier, to_modified=True)
        screws = [{"a": number_in(a, length), "alpha": number_in(alpha, angle)}, *screws[:-1]]
    else:
        base = base @ between[0]
        (a, alpha), tool = _left_over(tool, earlier, to_modified=False)
        between = [*between[1:], RigidTransform(rotation_x(*cos_sin(alpha)), (a, 0.0, 0.0))]
        screws = [*screws[1:], {"a": number_in(a, length), "alpha": number_in(alpha, angle)}]
    bodies = [
        _body_texts(row, each if to_modified else each.inverse, length) for row, each in zip(rows, between, strict=True)
    ]
    shape = {"mass": manipulator.base_mass, "geometry": manipulator.base_geometry}
    return replace(
        table,
        convention=str(convention),
        base=table.base if base == manipulator.base else transform_text(base, length, angle, **shape),  # type: ignore[arg-type]  # of two types
        tool=table.tool if tool == manipulator.tool else transform_text(tool, length, angle),
        rows=tuple(
            {**{field: text for field, text in row.items() if not body or field not in _MASS_FIELDS}, **moved, **body}
            for row, moved, body in zip(table.rows, screws, bodies, strict=True)
        ),
    )


def _left_over(
    end: RigidTransform, earlier: Manipulator | None, *, to_modified: bool
) -> tuple[tuple[float, float], RigidTransform]:
    """The a and alpha at the base, or at the tool, that go into a row, and what is left of the base or tool."""
    if earlier is not None:
        row, rest = (earlier.rows[0], earlier.base) if to_modified else (earlier.rows[-1], earlier.tool)
        moved = rest @ _screw(row) if to_modified else _screw(row) @ rest
        far = (math.dist(*pair) / (math.hypot(*pair[1]) or 1.0) for pair in zip(moved, end, strict=True))
        if max(far) <= _MOVED_ROUNDING:
            return (row.a, row.alpha), rest
    x, roll = end.translation[0], end.rpy[0]
    screw = RigidTransform(rotation_x(*cos_sin(roll)), (x, 0.0, 0.0))
    return ((x, roll), IDENTITY) if screw == end and end != IDENTITY else ((0.0, 0.0), end)


def _body_texts(row: DHRow, move: RigidTransform, length: Unit) -> dict[str, str]:
    """Centre of mass and inertia of a row in another frame, where it has them."""
    texts: dict[str, str] = {}
    if move == IDENTITY:
        return texts
    if row.com is not None:
        com = (move @ RigidTransform(IDENTITY.rotation, row.com)).translation
        texts |= {f"com_{axis}": number_in(value, length) for axis, value in zip("xyz", com, strict=True)}
    if row.inertia is not None:
        turned: Inertia = rotated(row.inertia, move.rotation)
        texts |= {name: format_number(getattr(turned, name)) for name in INERTIA}
    return texts


# --- Units ------------------------------------------------------------------------------------------------------------


def with_units(table: TableText, manipulator: Manipulator, length_unit: str, angle_unit: str) -> TableText:
    """The same arm in other units; texts that name their unit stay as they are."""
    old = UNITS[table.length_unit], UNITS[table.angle_unit]
    new = UNITS[length_unit], UNITS[angle_unit]
    rows = tuple(
        {field: _in_unit(field, text, row.type, old, new) for field, text in texts.items()}
        for texts, row in zip(table.rows, manipulator.rows, strict=True)
    )
    written = table_text(manipulator, length_unit, angle_unit)
    ends = {name: getattr(written, name) if getattr(table, name) else "" for name in _ENDS}
    return replace(table, length_unit=length_unit, angle_unit=angle_unit, rows=rows, **ends)


def _in_unit(field: str, text: str, kind: JointType, old: tuple[Unit, Unit], new: tuple[Unit, Unit]) -> str:
    """A cell's text in another unit; as it is where it measures nothing, names its unit, or is no quantity."""
    dimension = dimension_of(field, kind)
    if dimension is None:
        return text
    before, after = unit_of(dimension, *old), unit_of(dimension, *new)
    try:
        quantity = evaluate(text, dimension, before, decimal_comma=True)
    except QuantityError:
        return text
    if quantity.has_unit or before == after:
        return text
    number = number_in(quantity.value, after)
    if quantity.variable is None:
        return number
    symbol = f"{'-' if quantity.sign < 0 else ''}{quantity.variable.text}"
    added = f" - {number[1:]}" if number.startswith("-") else f" + {number}"
    return symbol + (added if quantity.value else "")


def _readable(converted: TableText, before: TableText, catalog: Catalog) -> TableText:
    """A converted table with units behind the numbers that the reader refuses without them.

    Metres and radians are declared nowhere in a table, and beside cells in other units a bare number is in doubt.
    """
    arm = read_whole(before, catalog).manipulator
    length, angle = UNITS[converted.length_unit], UNITS[converted.angle_unit]
    named, done = converted, set[tuple[int | None, str | None]]()
    while places := {(problem.row, problem.field) for problem in read_whole(named, catalog).errors}:
        if arm is None or places & done:
            return converted
        done |= places  # there may be others, which the reader sees once these are right
        rows = [dict(row) for row in named.rows]
        ends: dict[str, str] = {}
        for row, field in places:
            if row is None and field in _ENDS:
                ends[field] = _with_units_in(getattr(named, field), length, angle)
            elif row is not None and field in rows[row] and (dimension := dimension_of(field, arm.rows[row].type)):
                rows[row][field] += f" {unit_of(dimension, length, angle).symbol}"
        named = replace(named, rows=tuple(rows), **ends)
    return named


def _with_units_in(text: str, length: Unit, angle: Unit) -> str:
    """A transform, payload or geometry of `table_text` with units behind its numbers."""

    def entry(found: re.Match[str]) -> str:
        unit = angle if found[1] == "rpy" else length
        return found[1] + ": " + _NUMBER.sub(lambda number: f"{number[0]} {unit.symbol}", found[2])

    return _TRANSLATION.sub(rf"\1 {length.symbol}", _ENTRY.sub(entry, text))


# --- And back ---------------------------------------------------------------------------------------------------------


def as_typed(converted: TableText, history: History, catalog: Catalog) -> TableText:
    """A converted table with the texts that a person has typed in its convention and units, where they are its numbers.

    The newest table of the same convention and units in its past is the one that was typed.
    """
    converted = _readable(converted, history.table, catalog)
    old = next((each for each in history.earlier if meaning(each) == meaning(converted)), None)
    if old is None or len(old.rows) != len(converted.rows):
        return converted
    now, was = (read_whole(each, catalog).manipulator for each in (converted, old))
    if now is None or was is None:
        return converted
    one, other = (table_text(each, converted.length_unit, converted.angle_unit) for each in (now, was))
    ends = {name: getattr(old, name) for name in _ENDS if getattr(one, name) == getattr(other, name)}
    rows = []
    for row, new, before, number, old_number in zip(
        now.rows, converted.rows, old.rows, one.rows, other.rows, strict=True
    ):
        others = {field for field in FIELDS if not _is_same(number.get(field), old_number.get(field))}
        others |= _VARIABLE_FIELDS if others & _VARIABLE_FIELDS else set()
        quantities = {field for field in FIELDS if field in _MASS_FIELDS or dimension_of(field, row.type) is not None}
        texts = {field: (before if field in quantities - others else new).get(field, "") for field in FIELDS}
        rows.append({field: text for field, text in texts.items() if text})
    return _readable(replace(converted, **ends, rows=tuple(rows)), history.table, catalog)


def _is_same(one: str | None, other: str | None) -> bool:
    """Whether two texts are one number, rounding aside."""
    try:
        return one == other or math.isclose(
            float(one or ""), float(other or ""), rel_tol=_ROUNDING, abs_tol=_LEFT_OF_ZERO
        )
    except ValueError:  # an expression or a name
        return False
