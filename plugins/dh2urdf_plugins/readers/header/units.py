"""Which unit a bare number of a table has: the declared one, that of its neighbours, or none that is sure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.quantities import Dimension, QuantityError, accepted_units
from dh2urdf.row_fields import COM, INERTIA, ROW_FIELDS
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.words.cells import Doubt, Units, rate_of
from dh2urdf_plugins.readers.words.fields import FIELDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from typing import TypeAlias

    from dh2urdf.quantities import Quantity, Unit
    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.words.cells import Cell

    Cells: TypeAlias = Mapping[tuple[str, Dimension], Cell]

UNIT_KEYS = {
    "length": (Dimension.LENGTH,),
    "angle": (Dimension.ANGLE,),
    "mass": (Dimension.MASS,),
    "inertia": (Dimension.INERTIA,),
    "effort": (Dimension.TORQUE, Dimension.FORCE),
    "velocity": (Dimension.TURN_RATE, Dimension.SPEED),
    "damping": (Dimension.DAMPING, Dimension.LINEAR_DAMPING),
}
"""Keys of `units`, and what they declare the unit of; of two, the first is that of joints that turn."""
KEY_OF = {dimension: key for key, dimensions in UNIT_KEYS.items() for dimension in dimensions}
"""The keys of `units` by what they declare the unit of."""
SI = {
    Dimension.LENGTH: "m",
    Dimension.ANGLE: "rad",
    Dimension.SPEED: "m/s",
    Dimension.TURN_RATE: "rad/s",
    Dimension.MASS: "kg",
    Dimension.FORCE: "N",
    Dimension.TORQUE: "Nm",
    Dimension.DAMPING: "N·m·s/rad",
    Dimension.LINEAR_DAMPING: "N·s/m",
    Dimension.INERTIA: "kg·m²",
}
_GEOMETRY = {Dimension.LENGTH: ("a", "d"), Dimension.ANGLE: ("alpha", "theta")}
_PLURAL = {Dimension.LENGTH: "lengths", Dimension.ANGLE: "angles", Dimension.MASS: "masses"}
_OF_THE_JOINT = ("offset", "lower", "upper")
_GROUPS = (
    ("a", "d"),
    ("alpha", "theta"),
    _OF_THE_JOINT,
    COM,
    *(
        tuple(name for name, field in ROW_FIELDS.items() if field.dimension is dimension)
        for dimension in (Dimension.INERTIA, Dimension.TORQUE)
    ),
)
"""Columns that are beside each other, and are hardly in two units."""


def group_of(name: str) -> tuple[str, ...]:
    """The fields beside a field that hardly have another unit, and the field itself."""
    return next((group for group in _GROUPS if name in group), (name,))


def table_units(stated: Mapping[Dimension, Unit], columns: Columns | None = None) -> Units:
    """The units of the bare numbers of a table.

    Args:
        stated: what the table and the options declare.
        columns: its headers, where it has some.
    """
    known = dict(stated)
    doubts: dict[str, Doubt] = {}
    if columns:
        for dimension in _GEOMETRY:
            if dimension not in stated:
                unit, doubt = _of_geometry(columns, dimension)
                known |= {dimension: unit} if unit else {}
                doubts |= {dimension: doubt} if doubt else {}
    units = Units(known=known, columns=columns.units if columns else {})
    doubts |= _of_kinds(units, stated, doubts)
    if columns:
        doubts |= _beside(columns, units, stated)
    return Units(
        known=known,
        columns=units.columns,
        doubts=doubts,
        decimal_comma=columns.decimal_comma if columns else False,
    )


def _of_geometry(columns: Columns, dimension: Dimension) -> tuple[Unit | None, Doubt | None]:
    """The unit that the headers of all columns of geometry declare, where it is not SI; or why there is none."""
    names = [name for name in _GEOMETRY[dimension] if name in columns.fields]
    units = [columns.units.get(name) for name in names]
    foreign = next((unit for unit in units if unit and not unit.is_si), None)
    if foreign is None:
        return None, None
    if all(unit == foreign for unit in units):
        return foreign, None
    said = map(_unit_of, names, units)
    return None, Doubt(" and ".join(said), foreign.symbol)


def _unit_of(what: str, unit: Unit | None) -> str:
    return f"the unit of {what} is {unit.symbol}" if unit else f"{what} has none"


def _of_kinds(units: Units, stated: Mapping[Dimension, Unit], doubts: Mapping[str, Doubt]) -> dict[str, Doubt]:
    """Why the unit of a whole kind of quantities is in doubt: it may go with another that is not the SI unit."""
    found: dict[str, Doubt] = {}

    def because(*dimensions: Dimension) -> str | None:
        for dimension in dimensions:
            unit = units.known.get(dimension)
            if dimension in doubts:
                return doubts[dimension].reason
            if unit and not unit.is_si:
                return _unit_of(_PLURAL[dimension], unit)
        return None

    def doubt(what: Dimension | str, reason: str | None, unit: str) -> None:
        if reason and what not in stated:
            found[what] = Doubt(reason, unit)

    length, angle = Dimension.LENGTH, Dimension.ANGLE
    headers = {name: unit for name, unit in units.columns.items() if not unit.is_si}
    of_bodies = next((_unit_of(name, headers[name]) for name in (*COM, "mass") if name in headers), None)
    doubt(Dimension.INERTIA, because(length, Dimension.MASS) or of_bodies, SI[Dimension.INERTIA])
    doubt(Dimension.DAMPING, because(angle, length), SI[Dimension.DAMPING])
    doubt(Dimension.LINEAR_DAMPING, because(length), SI[Dimension.LINEAR_DAMPING])
    doubt("friction", None if Dimension.TORQUE in stated else because(length), SI[Dimension.TORQUE])
    doubt(Dimension.SPEED, because(length) if length in doubts else None, SI[Dimension.SPEED])
    doubt(Dimension.TURN_RATE, because(angle) if angle in doubts else None, SI[Dimension.TURN_RATE])
    doubt(Dimension.MASS, *_of_masses(units, stated))
    for key, both in UNIT_KEYS.items():
        for dimension, other in (both, both[::-1]) if len(both) > 1 else ():
            if dimension in stated:
                doubt(other, f"`units` declares {stated[dimension].symbol} for {key}", SI[other])
    return found


def _of_masses(units: Units, stated: Mapping[Dimension, Unit]) -> tuple[str | None, str]:
    """Why masses may not be in kg, and in what: moments of inertia are in a unit of another mass."""
    for unit in (stated.get(Dimension.INERTIA), *(units.columns.get(name) for name in INERTIA)):
        if unit and not unit.symbol.startswith("kg"):
            return _unit_of("moments of inertia", unit), unit.symbol.partition("·")[0]
    return None, SI[Dimension.MASS]


def _beside(columns: Columns, units: Units, stated: Mapping[Dimension, Unit]) -> dict[str, Doubt]:
    """Columns without a unit beside one whose header has another unit than the numbers would be read in."""
    found: dict[str, Doubt] = {}
    for name in columns.names:
        if name in columns.units:
            continue
        rate = name == "velocity"
        group = _OF_THE_JOINT if rate else next((group for group in _GROUPS if name in group), ())
        for other in group:
            unit = columns.units.get(other)
            unit = rate_of(unit) if unit and rate else unit
            if unit and unit.dimension not in stated and unit.dimension in _dimensions(name):
                read = units.of(unit.dimension)
                if unit != read and not (read is None and unit.is_si):
                    doubt = Doubt(_unit_of(other, columns.units[other]), unit.symbol, unit.dimension)
                    found.setdefault(name, doubt)
    return found


def _dimensions(name: str) -> tuple[Dimension | None, ...]:
    return FIELDS[name].dimension, FIELDS[name].linear


def unit_advice(doubt: Doubt, dimension: Dimension, text: str) -> str:
    """How to say the unit of a number that has none."""
    key = KEY_OF.get(dimension)
    unit = doubt.unit if doubt.dimension in (None, dimension) else SI.get(dimension, doubt.unit)
    return f"name its unit: '{text.strip()} {unit}'" + (f", or `units: {{{key}: {unit}}}`" if key else "")


def refuse_doubt(quantity: Quantity, name: str, cell: Cell, dimension: Dimension, units: Units) -> None:
    """Refuse a number that stands outside of rows where its unit is not sure, and remember it where nothing says it.

    Args:
        quantity: the value of the cell.
        name: its field.
        cell: its text and its place.
        dimension: what it measures.
        units: the units of the table.

    Raises:
        QuantityError: it names no unit, is not 0, and its unit is in doubt.
    """
    if not quantity.value or quantity.has_unit or quantity.is_radians(dimension):
        return
    doubt, text = units.doubt(dimension), cell.text
    if doubt is None and units.of(dimension) is None:
        units.bare.setdefault(dimension, (name, cell))
    if doubt:
        raise QuantityError(
            f"{shown(text)} has no unit, and {doubt.reason}",
            f"0, or a number with a unit: {accepted_units(dimension)}",
            unit_advice(doubt, dimension, text),
        )


def bare_beside_cells(units: Units, foreign: Cells, bare: Cells) -> Iterator[Problem]:
    """What is wrong with bare numbers outside of rows where all lengths, or all angles, of rows name another unit.

    Bare numbers of rows are worth a notice where other cells of their column, or of one beside it, name such a unit.

    Args:
        units: the units of the table, with the bare numbers outside of rows.
        foreign: the first cell that names another unit than the SI unit, by field and by what it measures.
        bare: the first cell that has no unit and is read in the SI unit, by the same.
    """
    seen = set[tuple[tuple[str, ...], Dimension]]()
    for (name, dimension), cell in bare.items():
        group = group_of(name)
        named = next((each for each in (name, *group) if (each, dimension) in foreign), None)
        if named is None or (group, dimension) in seen:
            continue
        seen.add((group, dimension))
        system, other = SI[dimension], foreign[named, dimension].text
        yield Problem(
            message=f"{shown(cell.text)} has no unit and is read in {system}, and {named} is {shown(other)} elsewhere",
            severity="notice",
            mark=cell.mark,
            field=name,
            found=cell.text,
            suggestion=f"write its unit behind it: '{cell.text.strip()} {system}' if that is meant",
        )
    for dimension, names in _GEOMETRY.items():
        cells = {name: foreign[name, dimension] for name in names if (name, dimension) in foreign}
        if dimension not in units.bare or not cells or any((name, dimension) in bare for name in names):
            continue
        field, number = units.bare[dimension]
        named, cell = next(iter(cells.items()))
        yield Problem(
            message=f"{shown(number.text)} has no unit, and {named} is {shown(cell.text)} in the rows",
            mark=number.mark,
            field=field,
            found=number.text,
            accepted=f"0, or a number with a unit: {accepted_units(dimension)}",
            suggestion="write the unit behind the number, as in the rows, or declare it: "
            f"`units: {{{KEY_OF[dimension]}: …}}`",
        )


# --- Messages about headers -------------------------------------------------------------------------------------------


def unit_problems(columns: Columns, declared: Iterable[tuple[Unit, Mark]]) -> list[Problem]:
    """What is wrong with headers' units beside the units declared for the whole table."""
    problems = []
    for said, place in declared:
        for name, unit in columns.units.items():
            if unit.dimension is said.dimension and unit != said:
                header = columns.header_of(name)
                problems.append(
                    Problem(
                        message=f"the header {shown(header)} declares {unit.symbol}, and {place} declares "
                        f"{said.symbol}",
                        mark=columns.mark,
                        field=name,
                        found=header,
                        accepted="one unit for a column",
                    )
                )
    return problems
