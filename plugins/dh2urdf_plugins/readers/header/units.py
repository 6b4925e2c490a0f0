"""Which unit a bare number of a table has: the declared one, that of its neighbours, or none that is sure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from dh2urdf.columns import COM, INERTIA, SI_UNITS
from dh2urdf.quantities import RATES, Dimension, QuantityError, Symbols, Unit, accepted_units
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf_plugins.readers.words.cells import Cell
from dh2urdf_plugins.readers.words.fields import FIELDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.quantities import Quantity
    from dh2urdf_plugins.readers.header.columns import Columns

say = Messages(__file__)
Cells: TypeAlias = Mapping[tuple[str, Dimension], Cell]

UNIT_KEYS = {
    "length": (Dimension.LENGTH,),
    "angle": (Dimension.ANGLE,),
    "mass": (Dimension.MASS,),
    "inertia": (Dimension.INERTIA,),
    "effort": (Dimension.TORQUE, Dimension.FORCE),
    "velocity": (Dimension.TURN_RATE, Dimension.SPEED),
    "acceleration": (Dimension.TURN_ACCELERATION, Dimension.ACCELERATION),
    "jerk": (Dimension.TURN_JERK, Dimension.JERK),
    "damping": (Dimension.DAMPING, Dimension.LINEAR_DAMPING),
}
"""Keys of `units`, and what they declare the unit of; of two, the first is that of joints that turn."""
KEY_OF = {dimension: key for key, dimensions in UNIT_KEYS.items() for dimension in dimensions}
"""The keys of `units` by what they declare the unit of."""
_GEOMETRY = {Dimension.LENGTH: ("a", "d"), Dimension.ANGLE: ("alpha", "theta")}
_PLURAL: dict[str, str] = {Dimension.LENGTH: "lengths", Dimension.ANGLE: "angles", Dimension.MASS: "masses"}
_PLURAL[Dimension.INERTIA] = "moments of inertia"
OF_RATES = tuple(name for name, each in FIELDS.items() if each.dimension in RATES)
"""Fields whose numbers have the unit of lengths or angles per time, where these have a sure one."""
_OF_THE_JOINT = ("offset", "lower", "upper")
_GROUPS = (*_GEOMETRY.values(), _OF_THE_JOINT, COM, (*INERTIA, "armature"), ("effort", "friction"))
"""Columns that are beside each other, and are hardly in two units."""
_MADE_OF = (
    (Dimension.INERTIA, Dimension.INERTIA, (Dimension.LENGTH, Dimension.MASS, *COM, "mass")),
    (Dimension.DAMPING, Dimension.DAMPING, (Dimension.ANGLE, Dimension.LENGTH)),
    (Dimension.LINEAR_DAMPING, Dimension.LINEAR_DAMPING, (Dimension.LENGTH,)),
    ("friction", Dimension.TORQUE, (Dimension.LENGTH,)),
    (Dimension.MASS, Dimension.MASS, (Dimension.INERTIA, *INERTIA)),
)
"""Kinds of quantities, and a field, with kinds and columns that go with them: whose units make theirs unsure."""


class Doubt(NamedTuple):
    """Why the unit of bare numbers is not sure."""

    reason: str  # half a sentence
    unit: str  # one that they may have
    dimension: Dimension | None = None  # what that measures, where a field has numbers of two kinds


@dataclass(frozen=True, slots=True, kw_only=True)
class Units:
    """What a table declares about its units and its numbers."""

    known: Mapping[Dimension, Unit] = field(default_factory=dict)  # of bare numbers; the SI unit where there is none
    columns: Mapping[str, Unit] = field(default_factory=dict)  # those that headers declare, by field
    doubts: Mapping[str, Doubt] = field(default_factory=dict)  # by dimension or by field: bare numbers are refused
    decimal_comma: bool = False  # whether a comma may stand for the decimal point
    symbols: Symbols = field(default_factory=Symbols, compare=False)
    repair_pi: bool = False  # whether an angle that is nearly a multiple of π/2 is one
    # Outside of rows, the first number of each kind that is read in the SI unit since nothing says its unit, and its
    # field.
    bare: dict[Dimension, tuple[str, Cell]] = field(default_factory=dict, compare=False)

    @property
    def angle(self) -> Unit | None:
        """The unit of angles; None where nothing declares one, which means rad."""
        return self.known.get(Dimension.ANGLE)

    def of(self, dimension: Dimension) -> Unit | None:
        """The unit of numbers of a dimension that name none."""
        base = self.known.get(RATES[dimension][0]) if dimension in RATES else None
        return self.known.get(dimension) or (base and _rate_of(base, dimension))

    def unit_of(self, name: str | None, dimension: Dimension) -> Unit | None:
        """The unit of a field's numbers that name none; None where that is the SI unit, or in doubt."""
        own = self.columns.get(name or "")
        return own or (None if self.doubt(dimension, name) else self.of(dimension))

    def doubt(self, dimension: Dimension, name: str | None = None) -> Doubt | None:
        """Why the unit of a bare number of a dimension, and perhaps of a field, is not sure; None where it is."""
        if not self.doubts or name in self.columns:
            return None
        doubt = self.doubts.get(name or "")
        if doubt and doubt.dimension not in (None, dimension) and dimension in self.known:
            doubt = None  # it is about the field's other kind of numbers, and the unit of this kind is declared
        return doubt or self.doubts.get(dimension)

    @property
    def in_functions(self) -> Unit | None:
        """The unit of a bare number in ``sin``, ``cos`` or ``tan``: degrees, where any angle of the table has them."""
        angles = [unit for unit in (self.angle, *self.columns.values()) if unit and unit.dimension is Dimension.ANGLE]
        return next((unit for unit in angles if unit.parts), angles[0] if angles else None)


def _rate_of(unit: Unit, rate: Dimension) -> Unit:
    """A unit of length or angle per time, of a dimension."""
    return replace(unit, symbol=f"{unit.symbol}{RATES[rate][1]}", dimension=rate)


def group_of(name: str) -> tuple[str, ...]:
    """The fields beside a field that hardly have another unit, and the field itself."""
    return next((group for group in _GROUPS if name in group), (name,))


# --- The units of a table ---------------------------------------------------------------------------------------------


def table_units(stated: Mapping[Dimension, Unit], columns: Columns | None = None) -> Units:
    """The units of the bare numbers of a table."""
    headers, fields = (columns.units, columns.fields) if columns else ({}, [])
    known, doubts = dict(stated), dict[str, Doubt]()
    for dimension, names in _GEOMETRY.items():
        units = {name: headers.get(name) for name in names if name in fields}
        foreign = next((unit for unit in units.values() if unit and not unit.is_si), None)
        if foreign is None or dimension in stated:
            continue
        if all(unit == foreign for unit in units.values()):
            known[dimension] = foreign
        else:
            said = " and ".join(_unit_of(name, unit) for name, unit in units.items())
            doubts[dimension] = Doubt(said, foreign.symbol)
    doubts |= _of_kinds(known, headers, stated, doubts)
    if columns:
        doubts |= _beside(columns, Units(known=known), stated)
    return Units(known=known, columns=headers, doubts=doubts, decimal_comma=bool(columns and columns.decimal_comma))


def _unit_of(what: str, unit: Unit | None) -> str:
    return f"the unit of {what} is {unit.symbol}" if unit else f"{what} has none"


def _of_kinds(
    known: Mapping[Dimension, Unit],
    headers: Mapping[str, Unit],
    stated: Mapping[Dimension, Unit],
    doubts: Mapping[str, Doubt],
) -> dict[str, Doubt]:
    """Why the unit of a whole kind of quantities is in doubt: it may go with another that is not the SI unit."""
    reasons = {what: doubt.reason for what, doubt in doubts.items()}
    for what, unit in chain[tuple[str, Unit]](known.items(), headers.items()):
        if not (unit.is_si or unit.symbol.startswith("kg")):
            reasons.setdefault(what, _unit_of(_PLURAL.get(what, what), unit))
    found: dict[str, Doubt] = {}
    for what, measured, parts in _MADE_OF:
        why = next((reasons[part] for part in parts if part in reasons), None)
        if why and measured not in stated:
            found[what] = Doubt(why, SI_UNITS[measured])
    for rate, (base, _) in RATES.items():
        if base in doubts and rate not in stated:
            found[rate] = Doubt(doubts[base].reason, SI_UNITS[rate])
    for key, kinds in UNIT_KEYS.items():  # what declares the unit of one kind of joints leaves open that of the other
        declared = [stated[kind] for kind in kinds if kind in stated]
        for left in kinds if declared else ():
            if left not in stated:
                found[left] = Doubt(f"`units` declares {declared[0].symbol} for {key}", SI_UNITS[left])
    return found


def _beside(columns: Columns, units: Units, stated: Mapping[Dimension, Unit]) -> dict[str, Doubt]:
    """Columns without a unit beside one whose header has another unit than the numbers would be read in."""
    found: dict[str, Doubt] = {}
    for name in columns.names:
        others = () if name in columns.units else _OF_THE_JOINT if name in OF_RATES else group_of(name)
        for other in filter(columns.units.__contains__, others):
            said = columns.units[other]
            kinds = [each for each in (FIELDS[name].dimension, FIELDS[name].linear) if each in RATES]
            rate = next((each for each in kinds if RATES[each][0] is said.dimension), None)
            unit = _rate_of(said, rate) if rate else said
            read = units.of(unit.dimension)
            is_read = unit == read or (read is None and unit.is_si) or unit.dimension in stated
            if unit.dimension in (FIELDS[name].dimension, FIELDS[name].linear) and not is_read:
                found.setdefault(name, Doubt(_unit_of(other, said), unit.symbol, unit.dimension))
    return found


# --- Numbers without a unit -------------------------------------------------------------------------------------------


def unit_advice(doubt: Doubt, dimension: Dimension, text: str) -> str:
    """How to say the unit of a number that has none."""
    key = KEY_OF.get(dimension)
    unit = doubt.unit if doubt.dimension in (None, dimension) else SI_UNITS.get(dimension, doubt.unit)
    return f"name its unit: '{text.strip()} {unit}'" + (f", or `units: {{{key}: {unit}}}`" if key else "")


def refuse_doubt(quantity: Quantity, name: str, cell: Cell, dimension: Dimension, units: Units) -> None:
    """Refuses a bare number outside of rows where its unit is not sure, and remembers it where nothing says it."""
    if not quantity.value or quantity.has_unit or quantity.is_radians(dimension):
        return
    if doubt := units.doubt(dimension):
        accepted = f"0, or a number with a unit: {accepted_units(dimension)}"
        message = f"{shown(cell.text)} has no unit, and {doubt.reason}"
        raise QuantityError(message, accepted, unit_advice(doubt, dimension, cell.text))
    if units.of(dimension) is None:
        units.bare.setdefault(dimension, (name, cell))


def bare_beside_cells(units: Units, foreign: Cells, bare: Cells) -> Iterator[Problem]:
    """What is wrong with the first bare number of each field, where other cells of its kind name another unit.

    One in a row is worth a notice, beside such a cell of its column or of one beside it. One outside of rows is refused
    where all lengths, or all angles, of rows name such a unit.
    """
    seen = set[tuple[tuple[str, ...], Dimension]]()
    for (name, dimension), cell in bare.items():
        group, text = group_of(name), cell.text
        named = next((each for each in (name, *group) if (each, dimension) in foreign), None)
        if named and (group, dimension) not in seen:
            seen.add((group, dimension))
            about = {"named": named, "other": foreign[named, dimension].text, "unit": SI_UNITS[dimension]}
            yield say("bare-beside-cells", cell.mark, field=name, found=text, number=text.strip(), **about)
    for dimension, names in _GEOMETRY.items():
        named = next((name for name in names if (name, dimension) in foreign), None)
        if dimension in units.bare and named and not any((name, dimension) in bare for name in names):
            name, number = units.bare[dimension]
            about = {"named": named, "other": foreign[named, dimension].text, "key": KEY_OF[dimension]}
            about["units"] = accepted_units(dimension)
            yield say("bare-outside-rows", number.mark, field=name, found=number.text, **about)


def unit_problems(columns: Columns, declared: Iterable[tuple[Unit, Mark]]) -> list[Problem]:
    """What is wrong with headers' units beside the units declared for the whole table."""
    found = []
    for said, place in declared:
        for name, unit in columns.units.items():
            if unit.dimension is said.dimension and unit != said:
                about: dict[str, Any] = {"unit": unit.symbol, "place": place, "said": said.symbol}
                found.append(say("unit-twice", columns.mark, field=name, found=columns.header_of(name), **about))
    return found
