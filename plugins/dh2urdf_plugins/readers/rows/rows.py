"""One row of a table, as texts with their places, becomes a DH row: the same for every kind of table.

A cell becomes a number in `RowReader._quantity` and nowhere else; what is below it only compares numbers.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import COM, INERTIA, LIMITS, NUMBERS, ROW_FIELDS, SI_UNITS
from dh2urdf.manipulator import ENDS, DHRow, Inertia, JointType, Limits
from dh2urdf.quantities import Dimension, Quantity, QuantityError, accepted_units, evaluate
from dh2urdf.rotations import HALF_PI, rounded_quarter_turn
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf.table_text import REQUIRED, Said
from dh2urdf_plugins.readers.header.units import unit_advice
from dh2urdf_plugins.readers.rows.six_parameters import Extra
from dh2urdf_plugins.readers.words.bounds import FULL_TURN, LARGEST_ANGLE, MEASURABLE_ARM, NEARLY
from dh2urdf_plugins.readers.words.fields import FIELDS, flip_of, joint_type, keys_in, type_advice
from dh2urdf_plugins.readers.words.names import RowNames, name_fault

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.quantities import Unit
    from dh2urdf_plugins.readers.header.units import Units
    from dh2urdf_plugins.readers.words.cells import Cell

MAX_PROBLEMS = 1000
"""Problems of one manipulator that are collected; reading it stops there."""
LARGEST_LIMIT = 20 * math.pi
"""Bound of a revolute joint beyond which it is taken for degrees [rad]."""

_TOGETHER = (
    (("lower", "upper"), ("lower", "upper"), "both lower and upper, or neither"),
    (COM, COM, "all three, or none"),
    (INERTIA, INERTIA[:3], "ixx, iyy and izz, and ixy, ixz, iyz where they are not 0"),
    (INERTIA, ("mass",), "both, or neither: they are computed from the link's shape and density then"),
)
"""Fields, those that each of them needs, and what is accepted."""
say = Messages(__file__)


class RowReader:
    """Reads the rows of one manipulator, and collects what is wrong with it."""

    def __init__(self, units: Units, *, type_is_given: bool = True, traced: bool = False) -> None:
        self.units = replace(units, symbols=units.symbols.copy())  # a cell defines a name for its own manipulator
        self.type_is_given = type_is_given
        self.problems: list[Problem] = []  # errors and notices
        self.errors = 0
        self.names: list[RowNames] = []
        self.extras: dict[str, Extra] = {}  # what rows have besides a, α, d and θ, by the names of their joints
        self.said: list[dict[str, Said]] | None = [] if traced else None  # by the cells of each row
        # The first cell, by field and by what it measures, that is read in the SI unit since nothing says its unit; and
        # the first that names another unit than the SI unit.
        self.bare: dict[tuple[str, Dimension], Cell] = {}
        self.foreign: dict[tuple[str, Dimension], Cell] = {}
        self.rounded: list[tuple[Cell, str]] = []  # angles that are nearly a multiple of π/2, and what was meant
        self.from_zero = False  # whether the joint variables are counted from 0: q0 in the first row
        self.types_from: str | None = None  # the header of the column without a field that holds the types
        self._angle = units.in_functions
        # Of the row:
        self._cells: Mapping[str, Cell] = {}
        self._mark: Mark | None = None
        self._joint = ""
        self._number = 0
        self._units_of: dict[str, str] = {}  # the unit of every number that names none
        self._unsaid: dict[str, bool] = {}  # fields whose unit nothing says; whether only a word could say it

    def add(self, *problems: Problem) -> None:
        """Notes problems."""
        self.problems += problems
        self.errors += sum(problem.severity == "error" for problem in problems)

    def _note(self, code: str, name: str, **values: Any) -> None:  # noqa: ANN401 - what a message names
        """Notes what is wrong with a field of the row."""
        self.add(say(code, **self._at(name), **values))

    def _at(self, name: str) -> dict[str, Any]:
        """What a message about a field of the row names: the place, and what is there."""
        cell = self._cells.get(name)
        mark, found = (cell.mark, cell.text) if cell else (self._mark, None)
        return {"mark": mark, "joint": self._joint, "field": name, "found": found}

    def _says(self, *names: str) -> bool:
        """Whether any of some cells says something."""
        return any(name in self._cells and self._cells[name].text for name in names)

    # --- A row --------------------------------------------------------------------------------------------------------

    def read(self, number: int, cells: Mapping[str, Cell], mark: Mark) -> DHRow | None:
        """The row that some cells are, or None where there is an error in them."""
        before = self.errors
        self._cells, self._mark, self._number, self._units_of, self._unsaid = cells, mark, number, {}, {}
        self._joint = f"joint_{number}"
        self._joint = self._name("joint")
        link, kind = self._name("link"), self._type()
        if kind is JointType.FIXED and self._joint in ENDS:  # a frame of every description has this name
            self._joint = f"{self._joint}_joint"
        self.names.append(RowNames(self._joint, link, self._at("joint")["mark"], self._at("link")["mark"]))
        for name in REQUIRED:
            if not self._says(name):
                self._note("cell-empty", name)
        measured = [name for name in cells if FIELDS[name].dimension]
        read = {name: found for name in measured if (found := self._quantity(name, kind)) is not None}
        numbers = {name: quantity.value for name, quantity in read.items()}
        geometry, limits = self._joint_variable(read, kind), self._limits(read, kind)
        self._six_parameters(numbers)
        for given, needed, accepted in _TOGETHER:
            other = next((name for name in given if self._says(name) and kind in ROW_FIELDS[name].types), None)
            for name in needed if other else ():
                if not self._says(name):
                    self._note("part-missing", name, other=other, needs=accepted)
        if self.said is not None:
            # A type with the mark of the row follows from the variables.
            told = [
                (key, cell) for key, cell in cells.items() if cell.text and (key != "type" or cell.mark is not mark)
            ]
            units = self._units_of
            texts = {key: cell.typed or cell.text for key, cell in told}
            self.said.append({key: Said(text=texts[key], mark=cell.mark, unit=units.get(key)) for key, cell in told})
        if self.errors > before:
            return None
        return DHRow(
            joint=self._joint,
            link=link,
            type=kind,
            **{name: number for name, number in numbers.items() if name in NUMBERS} | geometry,
            limits=limits,
            com=tuple(numbers.get(name, 0.0) for name in COM) if self._says(*COM) else None,  # type: ignore[arg-type]
            inertia=Inertia(**{name: numbers.get(name, 0.0) for name in INERTIA}) if self._says(*INERTIA) else None,
            mark=mark,
        )

    def _name(self, field: str) -> str:
        cell = self._cells.get(field)
        fault = name_fault(cell.text) if cell else None
        if fault:
            self.add(Problem(code="name-unusable", message=fault[0], accepted=fault[1], **self._at(field)))
        return cell.text if cell and not fault else f"{field}_{self._number}"

    def _type(self) -> JointType:
        cell = self._cells.get("type")
        text = cell.text if cell else ""
        kind = joint_type(text)
        if text and kind is None:
            self._note("type-unknown", "type", suggestion=type_advice(text))
        elif not text and (self.type_is_given or cell):
            self._note("type-empty", "type")
        return kind or JointType.REVOLUTE

    # --- A cell -------------------------------------------------------------------------------------------------------

    def _quantity(self, name: str, kind: JointType) -> Quantity | None:
        """What a cell says; None where it is empty or wrong, or where joints of the row's type have no such number."""
        cell, row_field, errors = self._cells[name], ROW_FIELDS.get(name), self.errors
        if not cell.text:
            return None
        if row_field and kind not in row_field.types and name != "offset":
            if cell.text.strip("+-0.").casefold() not in {"", *keys_in("values", "nothing")}:
                self._note("bound-left-out" if kind is JointType.CONTINUOUS else "left-out", name)
            return None
        dimension = FIELDS[name].measures(slides=kind is JointType.PRISMATIC)
        unit, symbols = self.units.unit_of(name, dimension), self.units.symbols
        if name == "d" and kind is JointType.PRISMATIC:  # a name that is the variable of its row is that
            symbols = symbols.without(f"d{self._number - self.from_zero}")
        own = unit if unit and unit.dimension is dimension else None
        how = {"decimal_comma": self.units.decimal_comma, "angle": self._angle, "symbols": symbols}
        try:
            quantity = evaluate(cell.text, dimension, own, **how)  # type: ignore[arg-type]
        except QuantityError as error:
            accepted = "1 or -1" if name == "sign" else error.accepted
            about: Any = {"message": error.message, "accepted": accepted, "suggestion": error.suggestion}
            self.add(Problem(code="quantity-refused", **about, **self._at(name)))
            return None
        if not quantity.has_unit:
            self._look_at_unit(name, dimension, quantity, unit)
        elif quantity.foreign:
            self.foreign.setdefault((name, dimension), cell)
        self._look_at_variable(name, kind, quantity)
        if dimension is Dimension.ANGLE and self.errors == errors:
            quantity = self._angle_of(name, quantity)
        number = quantity.value
        if row_field and not (row_field.takes(number) or (name == "mass" and number == 0 and kind is JointType.FIXED)):
            self._note("not-positive" if row_field.positive else "negative", name)
        return quantity if self.errors == errors else None

    def _look_at_unit(self, name: str, dimension: Dimension, quantity: Quantity, unit: Unit | None) -> None:
        """Refuses a bare number whose unit is another dimension's, or not sure; remembers that nothing says it."""
        self._units_of[name] = unit.symbol if unit else ""
        is_sure = not quantity.value or quantity.is_radians(dimension)
        if unit is None:
            self._unsaid[name] = not is_sure
        if is_sure:
            return
        if unit and not dimension.holds(unit.dimension):
            kind = "prismatic" if dimension is FIELDS[name].linear else "revolute"
            about = {"unit": unit.symbol, "kind": kind, "what": dimension}
            self._note("unit-of-column", name, **about, units=accepted_units(dimension))
        elif doubt := self.units.doubt(dimension, name):
            advice = unit_advice(doubt, dimension, self._cells[name].text)
            self._note("unit-in-doubt", name, reason=doubt.reason, units=accepted_units(dimension), suggestion=advice)
        elif unit is None:
            self.bare.setdefault((name, dimension), self._cells[name])

    def _look_at_variable(self, name: str, kind: JointType, quantity: Quantity) -> None:
        """Refuses a joint variable where none can be, and one of another row."""
        variable = quantity.variable
        if variable is None:
            return
        home = "d" if kind is JointType.PRISMATIC else "theta"
        if name != home or kind is JointType.FIXED or variable.kind not in ("q", home):
            advice = "give the row the type prismatic if the joint slides" if name == "d" else None
            if name == variable.kind == "d":
                advice = f"define it: `# {variable.text} = 0.1` or `--symbol {variable.text}=100mm`; or {advice}"
            self._note("variable-elsewhere", name, variable=variable.text, suggestion=advice)
        elif variable.row not in (None, self._number - self.from_zero):
            own = f"{variable.kind}{self._number}"
            self._note("variable-of-another-row", name, row=variable.row, number=self._number, variable=own)

    def _angle_of(self, name: str, quantity: Quantity) -> Quantity:
        """An angle, or what it is nearly; one of more than a turn is refused where no unit is declared for it."""
        angle = quantity.value
        if name in ("lower", "upper"):
            if abs(angle) > LARGEST_LIMIT and name in self._unsaid:
                self._note("limit-in-degrees", name)
        elif abs(angle) > LARGEST_ANGLE:
            self._note("thousand-turns", name)
        elif abs(angle) > FULL_TURN and name in self._unsaid:
            self._note("angle-in-degrees", name)
        elif meant := meant_by(angle):
            self.rounded.append((self._cells[name], meant))
            if self.units.repair_pi:
                return replace(quantity, value=(rounded_quarter_turn(angle) or 0) * HALF_PI)
        return quantity

    def rounded_angles(self) -> Problem | None:
        """One notice of the angles of a table that are nearly a multiple of π/2."""
        if not self.rounded:
            return None
        cell, meant = self.rounded[0]
        count = f"; {len(self.rounded)} angles are rounded like that" if self.rounded[1:] else ""
        code = "angle-repaired" if self.units.repair_pi else "angle-rounded"
        return say(code, cell.mark, found=cell.text, meant=meant, count=count)

    # --- Numbers together ---------------------------------------------------------------------------------------------

    def _joint_variable(self, read: Mapping[str, Quantity], kind: JointType) -> dict[str, Any]:
        """Geometry and direction of the row: of a joint variable, what is added to it is the offset."""
        values = {name: read[name].value if name in read else 0.0 for name in ("a", "alpha", "d", "theta", "offset")}
        if self._says("flip"):
            turn, sign = "flip", {True: -1.0, False: 1.0, None: 0.0}[flip_of(self._cells["flip"].text)]
        else:
            turn, sign = "sign", read["sign"].value if "sign" in read else 1.0
        if sign not in (1.0, -1.0):
            self._note("direction-unknown", turn)
        direction = -1 if sign < 0 else 1
        for name, changes in (("offset", values["offset"]), (turn, direction < 0)):
            if kind is JointType.FIXED and changes:
                self._note("change-of-fixed", name, neutral={"offset": "0", "sign": "1", "flip": "false"}[name])
        home = "d" if kind is JointType.PRISMATIC else "theta"
        said = read.get(home)
        if said and said.variable:
            if said.sign < 0 and direction < 0:
                self._note("turned-twice", turn, variable=said.variable.text)
            values |= {home: 0.0, "offset": values["offset"] + said.value}
            direction *= said.sign
        differs = kind is not JointType.PRISMATIC and (values["theta"] or values["offset"] or direction < 0)
        for name in ("lower", "upper") if differs else ():
            if self._says(name) and self._cells[name].of_theta:
                self._note("bound-of-theta", name)
        return {**values, "sign": direction}

    def _six_parameters(self, numbers: Mapping[str, float]) -> None:
        """Takes what the row has of Hayati, and of Khalil and Kleinfinger."""
        beta, gamma, b = (numbers.get(name, 0.0) for name in ("beta", "gamma", "b"))
        if b and "gamma" not in self._cells:
            self._note("b-alone", "b")
        elif abs(b) > MEASURABLE_ARM:
            self._note("b-too-long", "b", metres=f"{b:.4g}", most=f"{MEASURABLE_ARM:g}")
        elif beta or gamma or b:
            self.extras[self._joint] = Extra(beta, gamma, b, self._at("gamma" if gamma else "b")["mark"])

    def _limits(self, read: Mapping[str, Quantity], kind: JointType) -> Limits:
        if kind is JointType.FIXED or not self._says(*LIMITS):
            return Limits()
        bounds = {name: read[name].value for name in LIMITS if name in read}
        if "lower" in bounds and "upper" in bounds and bounds["lower"] > bounds["upper"]:
            self._note("bounds-exchanged", "lower", upper=shown(self._cells["upper"].text))
        foreign = [name for name in ("lower", "upper", "offset") if name in read and read[name].foreign]
        if foreign and self._unsaid.get("velocity"):  # the joint's own cells name another unit than the SI unit
            rate = FIELDS["velocity"].measures(slides=kind is JointType.PRISMATIC)
            word, there = "mm/s" if rate is Dimension.SPEED else "deg/s", shown(self._cells[foreign[0]].text)
            about = {"word": word, "si": SI_UNITS[rate], "units": accepted_units(rate)}
            self._note("speed-without-unit", "velocity", other=foreign[0], there=there, **about)
        return Limits(**bounds)


def meant_by(angle: float) -> str | None:
    """The multiple of π/2 that an angle is when it is rounded, as ``-pi/2``; None where it is exact, or is none."""
    turns = rounded_quarter_turn(angle)
    if not turns or abs(angle - turns * HALF_PI) > NEARLY * abs(turns * HALF_PI):
        return None
    meant = {1: "pi/2", 2: "pi"}.get(abs(turns), f"{abs(turns)}*pi/2")
    return meant if turns > 0 else f"-{meant}"
