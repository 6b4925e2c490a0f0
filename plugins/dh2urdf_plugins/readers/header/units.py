"""Which unit a bare number of a table has: the declared one, that of its neighbours, or none that is sure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.quantities import Dimension, QuantityError, accepted_units
from dh2urdf.row_fields import COM, INERTIA, ROW_FIELDS
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf_plugins.readers.words.cells import Doubt, Units, rate_of
from dh2urdf_plugins.readers.words.fields import FIELDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from typing import TypeAlias

    from dh2urdf.quantities import Quantity, Unit
    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.words.cells import Cell

    Cells: TypeAlias = Mapping[tuple[str, Dimension], Cell]

say = Messages(__file__)

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
_MADE_OF = (
    (Dimension.INERTIA, Dimension.INERTIA, (Dimension.LENGTH, Dimension.MASS)),
    (Dimension.DAMPING, Dimension.DAMPING, (Dimension.ANGLE, Dimension.LENGTH)),
    (Dimension.LINEAR_DAMPING, Dimension.LINEAR_DAMPING, (Dimension.LENGTH,)),
    ("friction", Dimension.TORQUE, (Dimension.LENGTH,)),
)
"""Kinds of quantities, and a field, with what is in their units: where that is not in SI units, theirs are not sure."""
_OF_TWO_KINDS = [
    (key, one, other) for key, both in UNIT_KEYS.items() for one, other in ((both, both[::-1]) if len(both) > 1 else ())
]
"""Keys of `units` that may declare the unit of one kind of joints, and what they leave open then."""
_RATES = {Dimension.SPEED: Dimension.LENGTH, Dimension.TURN_RATE: Dimension.ANGLE}
"""What has the unit of lengths or angles per second, where these have a sure one."""


def group_of(name: str) -> tuple[str, ...]:
    """The fields beside a field that hardly have another unit, and the field itself."""
    return next((group for group in _GROUPS if name in group), (name,))


def table_units(stated: Mapping[Dimension, Unit], columns: Columns | None = None) -> Units:
    """The units of the bare numbers of a table.

    Args:
        stated: what the table and the options declare.
        columns: its headers, where it has some.
    """
    if columns is None:
        return Units(known=stated, doubts=_of_kinds(stated, {}, stated, {}))
    known, doubts = dict(stated), dict[str, Doubt]()
    for dimension, names in _GEOMETRY.items():
        units = {name: columns.units.get(name) for name in names if name in columns.fields}
        foreign = next((unit for unit in units.values() if unit and not unit.is_si), None)
        if foreign is None or dimension in stated:
            continue
        if all(unit == foreign for unit in units.values()):
            known[dimension] = foreign
        else:
            said = " and ".join(_unit_of(name, unit) for name, unit in units.items())
            doubts[dimension] = Doubt(said, foreign.symbol)
    doubts |= _of_kinds(known, columns.units, stated, doubts)
    doubts |= _beside(columns, Units(known=known), stated)
    return Units(known=known, columns=columns.units, doubts=doubts, decimal_comma=columns.decimal_comma)


def _unit_of(what: str, unit: Unit | None) -> str:
    return f"the unit of {what} is {unit.symbol}" if unit else f"{what} has none"


def _of_kinds(
    known: Mapping[Dimension, Unit],
    headers: Mapping[str, Unit],
    stated: Mapping[Dimension, Unit],
    doubts: Mapping[str, Doubt],
) -> dict[str, Doubt]:
    """Why the unit of a whole kind of quantities is in doubt: it may go with another that is not the SI unit."""
    foreign = {str(what): _unit_of(word, unit) for what, word in _PLURAL.items() if (unit := _foreign(known, what))}
    foreign |= {what: doubt.reason for what, doubt in doubts.items()}
    bodies = [_unit_of(name, unit) for name in (*COM, "mass") if (unit := _foreign(headers, name))]
    found: dict[str, Doubt] = {}
    for what, measured, parts in _MADE_OF:
        reasons = [foreign[part] for part in parts if part in foreign]
        reasons += bodies if what is Dimension.INERTIA else []
        if reasons and measured not in stated:
            found[what] = Doubt(reasons[0], SI[measured])
    for rate, base in _RATES.items():
        if base in doubts and rate not in stated:
            found[rate] = Doubt(doubts[base].reason, SI[rate])
    of_inertia = filter(None, (stated.get(Dimension.INERTIA), *map(headers.get, INERTIA)))
    other = next((unit for unit in of_inertia if not unit.symbol.startswith("kg")), None)
    if other and Dimension.MASS not in stated:
        found[Dimension.MASS] = Doubt(_unit_of("moments of inertia", other), other.symbol.partition("·")[0])
    for key, one, left in _OF_TWO_KINDS:
        if one in stated and left not in stated:
            found[left] = Doubt(f"`units` declares {stated[one].symbol} for {key}", SI[left])
    return found


def _foreign(units: Mapping[Any, Unit], name: str) -> Unit | None:
    """A unit that is not the SI unit."""
    unit = units.get(name)
    return None if unit is None or unit.is_si else unit


def _beside(columns: Columns, units: Units, stated: Mapping[Dimension, Unit]) -> dict[str, Doubt]:
    """Columns without a unit beside one whose header has another unit than the numbers would be read in."""
    found: dict[str, Doubt] = {}
    for name in columns.names:
        rate = name == "velocity"
        for other in () if name in columns.units else _OF_THE_JOINT if rate else group_of(name):
            said = columns.units.get(other)
            unit = rate_of(said) if said and rate else said
            if said is None or unit is None or unit.dimension in stated:
                continue
            read = units.of(unit.dimension)
            is_read = unit == read or (read is None and unit.is_si)
            if unit.dimension in (FIELDS[name].dimension, FIELDS[name].linear) and not is_read:
                found.setdefault(name, Doubt(_unit_of(other, said), unit.symbol, unit.dimension))
    return found


# --- Numbers without a unit -------------------------------------------------------------------------------------------


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
        accepted = f"0, or a number with a unit: {accepted_units(dimension)}"
        message = f"{shown(text)} has no unit, and {doubt.reason}"
        raise QuantityError(message, accepted, unit_advice(doubt, dimension, text))


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
        group, text = group_of(name), cell.text
        named = next((each for each in (name, *group) if (each, dimension) in foreign), None)
        if named and (group, dimension) not in seen:
            seen.add((group, dimension))
            about = {"named": named, "other": foreign[named, dimension].text, "unit": SI[dimension]}
            yield say("bare-beside-cells", cell.mark, field=name, found=text, number=text.strip(), **about)
    for dimension, names in _GEOMETRY.items():
        cells = {name: foreign[name, dimension] for name in names if (name, dimension) in foreign}
        if dimension not in units.bare or not cells or any((name, dimension) in bare for name in names):
            continue
        field, number = units.bare[dimension]
        named, cell = next(iter(cells.items()))
        about = {"named": named, "other": cell.text, "units": accepted_units(dimension), "key": KEY_OF[dimension]}
        yield say("bare-outside-rows", number.mark, field=field, found=number.text, **about)


def unit_problems(columns: Columns, declared: Iterable[tuple[Unit, Mark]]) -> list[Problem]:
    """What is wrong with headers' units beside the units declared for the whole table."""
    return [
        say(
            "unit-twice",
            columns.mark,
            field=name,
            found=columns.header_of(name),
            unit=unit.symbol,
            place=place,
            said=said.symbol,
        )
        for said, place in declared
        for name, unit in columns.units.items()
        if unit.dimension is said.dimension and unit != said
    ]
