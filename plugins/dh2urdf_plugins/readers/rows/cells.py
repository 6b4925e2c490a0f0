"""The cells of one row of a table: what they say, as names and numbers, and all that is wrong with them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.quantities import Dimension, Quantity, QuantityError, accepted_units, evaluate
from dh2urdf.rotations import HALF_PI, rounded_quarter_turn
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.header.units import unit_advice
from dh2urdf_plugins.readers.words.fields import FIELDS, Field
from dh2urdf_plugins.readers.words.names import name_fault

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.quantities import Unit
    from dh2urdf_plugins.readers.words.cells import Cell, Doubt, Units

FULL_TURN = 2 * math.pi
LARGEST_ANGLE = 1000 * FULL_TURN
"""Angle of a table beyond which its sum with a joint value loses what a micrometre at the tool needs [rad]."""
NEARLY = 1e-3
"""How near an angle has to be to a quarter turn to be taken for a rounded one, relative."""
ACCEPTED_ANGLE = "an angle of at most 2000π rad, or 360000°"
_TURNS = ("alpha", "theta", "offset")


class RowCells:
    """The cells of the row that is being read, and the problems of all rows so far.

    Attributes:
        units: the units of the table.
        problems: what was found so far, errors and notices.
        errors: how many of them are errors.
        bare: the first cell that was read in the SI unit since nothing says its unit, by field and by what it measures.
        foreign: the first cell that names another unit than the SI unit, by the same.
        from_zero: whether the joint variables are counted from 0: q0 in the first row.
        types_from: the header of the column without a field that turned out to hold the types.
        last: the number of the last row.
        rounded: the cells of angles that are nearly a multiple of π/2, and what was meant.
    """

    def __init__(self, units: Units) -> None:
        """Starts a manipulator in a table of these units."""
        self.units = replace(units, symbols=units.symbols.copy())  # a cell defines a name for its own manipulator
        self._angle = units.in_functions
        self.problems: list[Problem] = []
        self.errors = 0
        self.bare: dict[tuple[str, Dimension], Cell] = {}
        self.foreign: dict[tuple[str, Dimension], Cell] = {}
        self.from_zero = False
        self.types_from: str | None = None
        self.last = 0
        self.rounded: list[tuple[Cell, str]] = []
        self._foreign: set[str] = set()  # of the row: fields whose cells name another unit than the SI unit
        self._bare: set[str] = set()  # of the row: fields that are read in the SI unit since nothing says their unit
        self._cells: Mapping[str, Cell] = {}
        self._mark: Mark | None = None
        self._joint = ""
        self._number = 0
        self._unit_said: set[str] = set()  # of the row: fields whose unit somebody says, or that are refused for it
        self._read_in: dict[str, str] = {}  # of the row: the unit of every number that names none

    def add(self, problem: Problem) -> None:
        """Notes a problem."""
        self.problems.append(problem)
        self.errors += problem.severity == "error"

    def _problem(
        self,
        message: str,
        name: str,
        *,
        accepted: str | None = None,
        suggestion: str | None = None,
        notice: bool = False,
    ) -> None:
        cell = self._cells.get(name)
        self.add(
            Problem(
                message=message,
                severity="notice" if notice else "error",
                mark=self._place(name),
                joint=self._joint,
                field=name,
                found=cell.text if cell else None,
                accepted=accepted,
                suggestion=suggestion,
            )
        )

    def _error(self, message: str, name: str, *, accepted: str | None = None, suggestion: str | None = None) -> None:
        self._problem(message, name, accepted=accepted, suggestion=suggestion)

    def _notice(self, message: str, name: str, suggestion: str | None = None) -> None:
        self._problem(message, name, suggestion=suggestion, notice=True)

    # --- Words --------------------------------------------------------------------------------------------------------

    def _place(self, name: str) -> Mark | None:
        cell = self._cells.get(name)
        return cell.mark if cell else self._mark

    def _absent(self, name: str) -> bool:
        cell = self._cells.get(name)
        return cell is None or not cell.text

    def _name(self, field_name: str, default: str) -> str:
        cell = self._cells.get(field_name)
        if cell is None:
            return default
        if fault := name_fault(cell.text):
            self._error(fault[0], field_name, accepted=fault[1])
            return default
        return cell.text

    # --- Numbers ------------------------------------------------------------------------------------------------------

    def _quantity(self, name: str, *, linear: bool = False, variables: tuple[str, ...] = ()) -> Quantity:
        """What a cell says; 0 where it is empty or wrong."""
        if self._absent(name):
            return Quantity(0.0)
        text, what = self._cells[name].text, FIELDS[name]
        own = f"d{self._number - self.from_zero}"  # a name that is the variable of its row is that
        symbols = self.units.symbols.without(own) if "d" in variables else self.units.symbols
        dimension = (what.linear if linear else None) or what.dimension or Dimension.NUMBER
        unit = self.units.columns.get(name)
        foreign = unit is not None and unit.dimension is not dimension
        if unit is None:
            unit = self.units.sure(dimension, name)
        try:
            quantity = evaluate(
                text,
                dimension,
                None if foreign else unit,
                decimal_comma=self.units.decimal_comma,
                angle=self._angle,
                symbols=symbols,
            )
        except QuantityError as error:
            accepted = "1 or -1" if name == "sign" else error.accepted
            self._error(error.message, name, accepted=accepted, suggestion=error.suggestion)
            return Quantity(0.0)
        if not quantity.has_unit:
            self._read_in[name] = unit.symbol if unit else ""
        if quantity.has_unit or name in self.units.columns or self.units.sure(dimension, name):
            self._unit_said.add(name)
        self._look_at_unit(name, dimension, quantity, unit)
        if quantity.variable and not self._variable_fits(name, quantity, variables):
            return Quantity(0.0)
        if dimension is Dimension.ANGLE and name in _TURNS and abs(quantity.value) > LARGEST_ANGLE:
            self._error(f"{shown(text)} is more than a thousand turns", name, accepted=ACCEPTED_ANGLE)
            return Quantity(0.0)
        return quantity

    def _look_at_unit(self, name: str, dimension: Dimension, quantity: Quantity, unit: Unit | None) -> None:
        """Refuses a bare number whose unit is another dimension's, or not sure; remembers which cells have one."""
        if quantity.foreign:
            self.foreign.setdefault((name, dimension), self._cells[name])
            self._foreign.add(name)
        if not quantity.value or quantity.has_unit or quantity.is_radians(dimension):
            return
        if unit and not dimension.holds(unit.dimension):
            self._foreign_unit(name, FIELDS[name], dimension, unit)
        elif doubt := self.units.doubt(dimension, name):
            self._doubtful_unit(name, dimension, doubt)
        elif unit is None:
            self.bare.setdefault((name, dimension), self._cells[name])
            self._bare.add(name)

    def _foreign_unit(self, name: str, what: Field, dimension: Dimension, unit: Unit) -> None:
        kind = "prismatic" if dimension is what.linear else "revolute"
        self._error(
            f"{shown(self._cells[name].text)} is in a column of {unit.symbol}, and {name} of a {kind} joint is "
            f"{dimension}",
            name,
            accepted=f"0, or a number with its own unit: {accepted_units(dimension)}",
        )

    def _doubtful_unit(self, name: str, dimension: Dimension, doubt: Doubt) -> None:
        text = self._cells[name].text
        self._unit_said.add(name)  # so that nothing else asks for a unit
        self._error(
            f"{shown(text)} has no unit, and {doubt.reason}",
            name,
            accepted=f"0, or a number with a unit: {accepted_units(dimension)}",
            suggestion=unit_advice(doubt, dimension, text),
        )

    def _variable_fits(self, name: str, quantity: Quantity, variables: tuple[str, ...]) -> bool:
        variable = quantity.variable
        if variable is None:
            return True
        text = shown(self._cells[name].text)
        if variable.kind not in variables:
            where = {"theta": "theta of a revolute joint", "d": "d of a prismatic joint"}
            home = where.get(variable.kind, "theta of a revolute joint or in d of a prismatic one")
            self._error(
                f"{text} names the joint variable {variable.text}, which cannot be in {name} of this row",
                name,
                accepted=f"a number here; {variable.text} may be in {home}",
                suggestion=self._advice_for(name, variable.kind, variable.text),
            )
            return False
        if variable.row is not None and variable.row != self._number - self.from_zero:
            self._error(
                f"{text} names the variable of row {variable.row}, and this is row {self._number}",
                name,
                accepted=f"{variable.kind}{self._number}, or no number: rows are counted from 1, fixed ones too",
            )
            return False
        return True

    @staticmethod
    def _advice_for(name: str, kind: str, text: str) -> str | None:
        """What to do about a variable where none can be: it is the name of a length, or the joint slides."""
        slides = "give the row the type prismatic if the joint slides"
        if name != "d" or kind != "d":
            return slides if name == "d" else None
        return f"define it: `# {text} = 0.1` or `--symbol {text}=100mm`; or {slides}"

    def _optional(self, name: str, *, linear: bool = False) -> float | None:
        return None if self._absent(name) else self._quantity(name, linear=linear).value

    def _positive(self, name: str, *, linear: bool = False, or_zero: bool = False) -> float | None:
        errors = self.errors
        number = self._optional(name, linear=linear)
        if number is not None and (number < 0 if or_zero else number <= 0) and self.errors == errors:
            self._error(
                f"{shown(self._cells[name].text)} is not positive",
                name,
                accepted="a number above 0, or nothing where it is not known",
            )
        return number


def meant_by(angle: float) -> str | None:
    """The multiple of π/2 that an angle is when it is rounded, as ``-pi/2``; None where it is exact, or is none."""
    turns = rounded_quarter_turn(angle)
    if not turns or abs(angle - turns * HALF_PI) > NEARLY * abs(turns * HALF_PI):
        return None
    meant = {1: "pi/2", 2: "pi"}.get(abs(turns), f"{abs(turns)}*pi/2")
    return meant if turns > 0 else f"-{meant}"
