"""The rows of a manipulator, as texts with their places, become DH rows: the same for every kind of table.

`JointRows` sees what one row alone does not show. Numbers in a column of names are names only together; a row without
a joint variable is fixed only where the other rows have one. `RowReader` reads row by row: a cell becomes a number in
`RowReader._quantity` and nowhere else; what is below it only compares numbers.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import COM, INERTIA, LIMITS, NUMBERS, ROW_FIELDS, SI_UNITS
from dh2urdf.manipulator import ENDS, Convention, DHRow, Follower, Inertia, JointType, Limits, leader_problems
from dh2urdf.quantities import RATES, Dimension, Quantity, QuantityError, accepted_units, evaluate
from dh2urdf.rotations import HALF_PI, rounded_quarter_turn
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf.table_text import REQUIRED, Said
from dh2urdf_plugins.readers.header.units import OF_RATES, bare_beside_cells, unit_advice
from dh2urdf_plugins.readers.rows.six_parameters import Extra
from dh2urdf_plugins.readers.words.bounds import FULL_TURN, LARGEST_ANGLE, MEASURABLE_ARM, NEARLY
from dh2urdf_plugins.readers.words.cells import Cell
from dh2urdf_plugins.readers.words.fields import FIELDS, flip_of, is_no_joint, joint_type, keys_in, type_advice
from dh2urdf_plugins.readers.words.names import RowNames, name_fault, name_problems

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.quantities import Unit
    from dh2urdf_plugins.readers.header.units import Units

LABEL = ":"
"""What the key of a cell in a column that no field knows begins with; the header is behind it."""
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
Cells = dict[str, Cell]
_NUMBER = r"([0-9]{1,9})(?:\.0+)?"
"""A name that is the number of a row."""
_AXIS = r"(?i)[-+−–]?\s*[xyz]\s*[-+−–]?"
"""A name that is an axis of a frame."""
_LABELLED = rf"(?:[^\W\d_]{{1,12}}[\s_.#-]*)?{_NUMBER}\s*[*†‡§]?(?:\s*[\W_].*)?"
_MEANT_VARIABLE = r"(?i)(?<![a-zA-Z])(?:q|θ|ϑ|th|theta)[\W_]{0,3}[0-9ij₀-₉]"
"""A joint variable, in a cell that cannot be read: ``θ2 - θ1``."""
_LAW = r"(?:(?P<factor>.+?)\s*[*·×]\s*|(?P<sign>[-+−])\s*)?(?P<joint>{names}|[^\W\d][^\s*+·×]*)\s*(?P<added>[-+−].+)?"
"""A cell that says whom a joint follows."""
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
        self.joints: Sequence[str] = ()  # the names of all joints, which a row may follow
        self.laws: dict[str, Cell] = {}  # the cells that say whom a joint follows, by its name
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

    def is_name(self, text: str, **about: Any) -> bool:  # noqa: ANN401 - the place, and what is there
        """Whether a text is a name; notes why it is none."""
        fault = name_fault(text)
        if fault:
            self.add(Problem(code="name-unusable", message=fault[0], accepted=fault[1], **about))
        return fault is None

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

    def finish(self, rows: Sequence[DHRow], convention: Convention | None) -> None:
        """Reports what is wrong with all rows together, in a convention."""
        self.add(*(name_problems(self.names) if self.names else ()))
        for each in leader_problems(rows) if self.laws and not self.errors else ():
            self.add(replace(each, mark=self.laws[str(each.joint)].mark))
        for cell, meant in self.rounded[:1]:  # one notice for all of them
            count = f"; {len(self.rounded)} angles are rounded like that" if self.rounded[1:] else ""
            code = "angle-repaired" if self.units.repair_pi else "angle-rounded"
            self.add(say(code, cell.mark, found=cell.text, meant=meant, count=count))
        self.add(*bare_beside_cells(self.units, self.foreign, self.bare))
        for joint, extra in self.extras.items() if convention is Convention.STANDARD else ():
            if extra.gamma or extra.b:
                field = "gamma" if extra.gamma else "b"
                self.add(say("gamma-in-standard", extra.mark, joint=joint, field=field))

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
        geometry, limits, law = self._joint_variable(read, kind), self._limits(read, kind), self._law(kind)
        self._six_parameters(numbers)
        for given, needed, accepted in _TOGETHER:
            other = next((name for name in given if self._says(name) and kind in ROW_FIELDS[name].types), None)
            for name in needed if other else ():
                if not self._says(name):
                    self._note("part-missing", name, other=other, needs=accepted)
        if self.said is not None:
            self.said.append(
                {
                    key: Said(text=cell.typed or cell.text, mark=cell.mark, unit=self._units_of.get(key))
                    for key, cell in cells.items()
                    if cell.text and (key != "type" or cell.mark is not mark)  # else it follows from the variables
                }
            )
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
            follows=law,
            mark=mark,
        )

    def _name(self, field: str) -> str:
        cell = self._cells.get(field)
        return cell.text if cell and self.is_name(cell.text, **self._at(field)) else f"{field}_{self._number}"

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

    def _law(self, kind: JointType) -> Follower | None:
        """Whom the joint follows, and how: ``j2``, ``-j2``, ``-1 * j2 + 90 deg``."""
        text = self._cells["follows"].text if self._says("follows") else ""
        if text.casefold().strip("-–— ") in {"", *keys_in("values", "nothing")}:
            return None
        if kind is JointType.FIXED:
            self._note("change-of-fixed", "follows", neutral="empty")
            return None
        names = "|".join(map(re.escape, sorted(self.joints, key=len, reverse=True)))
        if (match := re.fullmatch(_LAW.format(names=names), text)) is None:
            self._note("law-unclear", "follows")
            return None
        self.laws[self._joint] = self._cells["follows"]
        factor, joint, added = match["factor"] or f"{match['sign'] or ''}1", match["joint"], match["added"] or "0"
        dimension = Dimension.LENGTH if kind is JointType.PRISMATIC else Dimension.ANGLE
        unit, known = self.units.unit_of("offset", dimension), {"symbols": self.units.symbols, "angle": self._angle}
        try:
            multiplier = evaluate(factor, Dimension.NUMBER, **known)  # type: ignore[arg-type]
            offset = evaluate(added, dimension, unit, **known)  # type: ignore[arg-type]
        except QuantityError as error:
            self._note("law-unread", "follows", reason=error.message)
            return None
        if multiplier.variable or offset.variable:
            self._note("law-unclear", "follows")
        if not offset.has_unit:
            self._look_at_unit("follows", dimension, offset, unit)
        return Follower(joint, multiplier.value, offset.value)

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
        for name in OF_RATES if foreign else ():
            if self._unsaid.get(name):  # the joint's own cells name another unit than the SI unit
                rate = FIELDS[name].measures(slides=kind is JointType.PRISMATIC)
                base, per = RATES[rate]
                word = f"{'mm' if base is Dimension.LENGTH else 'deg'}{per}"
                about = {"word": word, "si": SI_UNITS[rate], "units": accepted_units(rate)}
                there = shown(self._cells[foreign[0]].text)
                self._note("speed-without-unit", name, other=foreign[0], there=there, **about)
        return Limits(**bounds)


def meant_by(angle: float) -> str | None:
    """The multiple of π/2 that an angle is when it is rounded, as ``-pi/2``; None where it is exact, or is none."""
    turns = rounded_quarter_turn(angle)
    if not turns or abs(angle - turns * HALF_PI) > NEARLY * abs(turns * HALF_PI):
        return None
    meant = {1: "pi/2", 2: "pi"}.get(abs(turns), f"{abs(turns)}*pi/2")
    return meant if turns > 0 else f"-{meant}"


# --- All rows of a manipulator ----------------------------------------------------------------------------------------


class JointRows:
    """The rows of one manipulator, which get their types and names as far as only all rows together show them.

    The cells of each row are changed; they are None where they cannot be told apart.
    """

    def __init__(self, rows: Sequence[tuple[Cells | None, Mark]], reader: RowReader) -> None:
        self.rows = {place: cells for place, (cells, _) in enumerate(rows) if cells is not None}
        self.marks = [mark for _, mark in rows]
        self.reader = reader
        self._take_types()
        self._leave_out_axes()
        self.indexes = {place: cells.pop("index") for place, cells in self.rows.items() if "index" in cells}
        self._take_indexes_for_names()
        found = {place: _variables_in(cells, reader) for place, cells in self.rows.items()}
        variables = {place: next(iter(row.values())) for place, row in found.items() if row}
        numbers = [(place, number) for place, number in variables.items() if number]
        self.variables, self.count_from_second = variables, bool(numbers) and all(k == number for k, number in numbers)
        reader.from_zero = 0 in variables and len(variables) > 1 and all(k == row for k, row in variables.items())
        one_each = not reader.type_is_given and all(len(row) <= 1 for row in found.values())
        for place, cells in self.rows.items():
            if not ("type" in cells and cells["type"].text):
                self._settle_type(place, cells, slides=one_each and "d" in found[place])
        index, is_fixed = self.indexes.get(0), _type_of(self.rows.get(0, {})) is JointType.FIXED
        is_base = (_number_in(index.text) == 0 or is_no_joint(index.text)) if index else self.count_from_second
        self.first = 0 if is_fixed and is_base else 1  # 0: the base, and joints are counted from the next row
        self._check_indexes()
        self._name_by_number("joint")
        self._name_by_number("link")

    # --- Types --------------------------------------------------------------------------------------------------------

    def _take_types(self) -> None:
        """Takes a column for one of types, where all its cells are words for types and there is no other."""
        rows = self.rows.values()
        others = {key: None for cells in rows for key in cells if key == "joint" or key.startswith(LABEL)}
        for key in () if any("type" in cells for cells in rows) else others:
            named = [cells[key] for cells in rows if key in cells]
            words = {cell.text.casefold() for cell in named}
            letters = len(words) == len(named) and max(map(len, words)) == 1 and "p" not in words  # axes A, B, C
            if len(named) < len(rows) or letters or None in map(joint_type, words) or any(map(str.isdigit, words)):
                continue
            for cells in rows:
                cells["type"] = cells.pop(key)
            self.reader.types_from = key.removeprefix(LABEL)
            what = "the column of joints" if key == "joint" else f"the column {shown(key[1:])}"
            self.reader.add(say("types-taken", named[0].mark, field="type", what=what, first=shown(named[0].text)))
            break
        for cells in rows:
            for key in [key for key in cells if key.startswith(LABEL)]:
                del cells[key]

    def _settle_type(self, place: int, cells: Cells, *, slides: bool) -> None:
        """Gives a row without a type its type where that is sure, and refuses it where it hardly is a joint."""
        name = next((cells[key].text for key in ("joint", "link") if key in cells), "")
        index = self.indexes[place].text if place in self.indexes else ""
        kind, refusal = JointType.REVOLUTE, ""
        no_joint = is_no_joint(name) or is_no_joint(index)
        if slides and "theta" in cells and cells["theta"].text:
            kind = JointType.PRISMATIC
        elif self.variables and place not in self.variables:
            is_base = place == 0 and self.count_from_second and _number_in(index or name) == 0
            kind, refusal = (JointType.FIXED, "") if no_joint or is_base else (kind, "row-without-variable")
        elif no_joint and not self.variables and not self.reader.type_is_given:
            refusal = "row-no-joint"
        else:
            return
        if refusal:
            about = {"joint": f"joint_{place + 1}", "field": "type", "row": shown(name or index)}
            self.reader.add(say(refusal, self.marks[place], **about, number=place + 1))
        cells["type"] = Cell(kind.value, self.marks[place])

    # --- Numbers and names --------------------------------------------------------------------------------------------

    def _leave_out_axes(self) -> None:
        """Leaves out a column of joints that has axes of frames: ``Z``, ``Y``, ``Y``."""
        named = [cells["joint"].text.casefold() for cells in self.rows.values() if "joint" in cells]
        if len(set(named)) < len(self.rows) and all(re.fullmatch(_AXIS, name) for name in named):
            for cells in self.rows.values():
                cells.pop("joint", None)

    def _take_indexes_for_names(self) -> None:
        """Takes the column of numbers for one of names, where it has names and no other column has."""
        texts = [index.text for index in self.indexes.values()]
        has_names = any("joint" in cells for cells in self.rows.values())
        if has_names or len(texts) < len(self.rows) or any(text.isdecimal() for text in texts[:2]):
            return
        for place, cells in self.rows.items():
            cells["joint"] = self.indexes.pop(place)

    def _check_indexes(self) -> None:
        """Refuses a row whose index is not its number, counted from 0 or 1."""
        if 0 not in self.indexes or not re.search("[0-9]", "".join(index.text for index in self.indexes.values())):
            return
        first = 0 if _number_in(self.indexes[0].text) == 0 else self.first
        for place, index in self.indexes.items():
            stands = is_no_joint(index.text) and _type_of(self.rows[place]) is JointType.FIXED
            if _number_in(index.text) != place + first and not stands:
                self._refuse_number(place, "index", index, place + first)

    def _refuse_number(self, place: int, field: str, cell: Cell, number: int) -> None:
        about = {"joint": f"joint_{place + 1}", "field": field, "text": cell.text}
        self.reader.add(say("number-wrong", cell.mark, **about, number=number))

    def _name_by_number(self, field: str) -> None:
        """Makes names of numbers: a column of joints that holds 1, 2, 3 counts them."""
        cells = {place: row[field] for place, row in self.rows.items() if field in row}
        matches = {place: re.fullmatch(_NUMBER, cell.text) for place, cell in cells.items()}
        numbers = {place: int(match[1]) for place, match in matches.items() if match}
        base = self.first == 0 and 0 in cells
        if not cells or len(numbers) < len(cells) - (base and 0 not in numbers):
            return
        counts = list(numbers.values())
        ids = counts[0] > 1 and all(left < right for left, right in pairwise(counts))  # of motors, say
        first = 0 if counts[0] == 0 else self.first
        for place, number in numbers.items():
            cell = cells[place]
            if not ids and number != place + first:
                self._refuse_number(place, field, cell, place + first)
            self.rows[place][field] = cell._replace(text=f"{field}_{cell.text.partition('.')[0]}", typed=cell.text)


def _number_in(text: str) -> int | None:
    """The number of a row, perhaps behind a word or before one: ``J1``, ``Axis 1``, ``1 (base)``."""
    match = re.fullmatch(_LABELLED, text)
    return int(match[1]) if match else None


def _variables_in(cells: Mapping[str, Cell], reader: RowReader) -> dict[str, int | None]:
    """The numbers of the joint variables that a row names, by the cell: None for one without a number."""
    found: dict[str, int | None] = {}
    for name, dimension in (("theta", Dimension.ANGLE), ("d", Dimension.LENGTH)):
        text = cells[name].text if name in cells else ""
        if not any(map(str.isalpha, text)):
            continue
        try:
            variable = evaluate(text, dimension, decimal_comma=True, symbols=reader.units.symbols).variable
        except QuantityError:
            if name == "theta" and re.search(_MEANT_VARIABLE, text):
                found[name] = None  # the cell is refused, and lacks no variable besides
        else:
            found |= {name: variable.row} if variable else {}
    return found


def _type_of(cells: Cells) -> JointType | None:
    cell = cells.get("type")
    return joint_type(cell.text) if cell and cell.text else None
