"""Tables of known arms: which columns, units, options and statements say what, in the dialects of every reader."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from known_arms import (
    ANGLE,
    COM,
    CONTINUOUS,
    EMPTY,
    FIXED,
    FORCE,
    INDEXED,
    INERTIA,
    LENGTH,
    LIMITS,
    MASS,
    PREVIOUS,
    PRISMATIC,
    RATE,
    REVOLUTE,
    SCALES,
    SI,
    SLIDING,
    SPEED,
    TENSOR,
    TORQUE,
    TURNING,
    Exact,
    KnownArm,
    KnownRow,
    Placement,
    Speller,
    Text,
    angle,
    known_row,
    length,
    name,
    shift,
    turn,
    unit_words,
    words,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

DIMENSIONS = {
    **dict.fromkeys(("a", "d", *COM, "radius"), (LENGTH, LENGTH)),
    **dict.fromkeys(("alpha", "theta"), (ANGLE, ANGLE)),
    **dict.fromkeys(("offset", "lower", "upper"), (ANGLE, LENGTH)),
    "velocity": (RATE, SPEED),
    "mass": (MASS, MASS),
    **dict.fromkeys(TENSOR, (INERTIA, INERTIA)),
}
"""What the header of a column may declare: in a table of joints that turn, and in one of joints that slide."""
KEYS = {
    "length": (LENGTH,),
    "angle": (ANGLE,),
    "mass": (MASS,),
    "inertia": (INERTIA,),
    "effort": (TORQUE, FORCE),
    "velocity": (RATE, SPEED),
    "damping": (TURNING, SLIDING),
}
"""The kinds of quantity whose units a table may declare."""
ORDER = (
    "joint",
    "link",
    "type",
    "a",
    "alpha",
    "d",
    "theta",
    "offset",
    "sign",
    "flip",
    *LIMITS,
    "mass",
    *COM,
    *TENSOR,
    "radius",
    "damping",
    "friction",
    "armature",
)


@dataclass
class Column:
    """A column: its field, its header in tables of rows, and the unit that the header says."""

    field: str
    header: str
    unit: str | None = None


@dataclass
class Arm:
    """An arm as texts: what is said of all rows, and the cells by field."""

    known: KnownArm
    said: dict[str, Any]
    rows: list[dict[str, Text]]


@dataclass
class Table:
    """Some arms with the same columns, units and options.

    Attributes:
        columns: the columns in their order.
        arms: the arms.
        said: what is said of all arms, by key; the leaves are texts.
        options: what is said by options of the reader.
        convention_column: whether each row says its convention.
    """

    columns: list[Column]
    arms: list[Arm]
    said: dict[str, Any] = field(default_factory=dict)
    options: dict[str, Any] = field(default_factory=dict)
    convention_column: bool = False


def make_table(rng: random.Random, count: int, *, plain: bool = False) -> Table:
    """A table of some arms.

    Args:
        rng: the source of chance.
        count: how many arms.
        plain: whether the cells are plain numbers, as those that are read fast.
    """
    mixed = [(REVOLUTE,), (REVOLUTE, PRISMATIC), (PRISMATIC,), (REVOLUTE, CONTINUOUS, PRISMATIC, FIXED)]
    kinds = rng.choice(mixed)
    fields = _fields(rng, kinds, plain=plain)
    units = _Units(rng, kinds, fields, plain=plain)
    table = Table([], [])
    types = {kind: rng.choice(words("types", kind)) for kind in kinds}
    spelling = _Spelling(rng, units, fields, Speller(rng, plain=plain), types, symbols=rng.random() < 0.3)
    table.convention_column = rng.random() < 0.1
    convention = rng.choice(["standard", "modified"])
    where = "column" if table.convention_column else rng.choice(["said", "option", "both"])
    symbols = {} if plain or rng.random() < 0.7 else INDEXED
    if symbols and convention == "modified" and where != "column" and rng.random() < 0.7:
        symbols = {**INDEXED, **PREVIOUS}
    table.columns = _columns(rng, fields, units, spelling, symbols)
    if where in ("said", "both"):
        table.said["convention"] = rng.choice(words("conventions", convention))
    if where in ("option", "both"):
        table.options["convention"] = rng.choice(words("conventions", convention))
    units.state(table)
    shared = {what: _placement(rng, units, plain=plain) for what in ("base", "tool") if rng.random() < 0.4}
    for what, placement in shared.items():
        (table.options if rng.random() < 0.3 else table.said)[what] = placement.said
    for number in range(count):
        known = KnownArm(
            f"r{number}" if plain else name(rng, f"r{number}_"),
            rng.choice(["standard", "modified"]) if where == "column" else convention,
            [],
        )
        known.base, known.tool = shared.get("base"), shared.get("tool")
        known.rows = [known_row(rng, fields, kinds) for _ in range(rng.randint(1, 7))]
        for k, row in enumerate(known.rows, start=1):
            for what in (what for what in ("joint", "link") if what in fields):
                setattr(row, what, f"{what}{k}" if plain else name(rng, f"{what[0]}{k}_"))
        said = {"convention": rng.choice(words("conventions", known.convention))} if where == "column" else {}
        table.arms.append(Arm(known, said, [spelling.row(row, k) for k, row in enumerate(known.rows, start=1)]))
    return table


def _fields(rng: random.Random, kinds: tuple[str, ...], *, plain: bool) -> frozenset[str]:
    """The fields that a table has a column of."""
    share = 0.6 if plain else rng.choice([0.2, 0.5, 0.9])
    fields = {"a", "alpha", "d"} | ({"type"} if kinds != (REVOLUTE,) or rng.random() < 0.5 else set())
    groups: list[tuple[str, ...]] = [
        ("joint",),
        ("link",),
        ("theta",),
        ("offset",),
        ("lower", "upper"),
        ("velocity",),
        ("effort",),
    ]
    if not plain:
        groups += [
            ("sign",) if rng.random() < 0.5 else ("flip",),
            ("mass",),
            COM,
            ("radius",),
            ("damping",),
            ("friction",),
            ("armature",),
        ]
    for group in groups:
        if rng.random() < share:
            fields.update(group)
    if "mass" in fields and rng.random() < share:
        fields.update(TENSOR)
    return frozenset(fields)


# --- Units ------------------------------------------------------------------------------------------------------------


class _Units:
    """Where a table says its units, of each kind of quantity.

    ``said`` in a statement, by an ``option``, in the ``headers`` of every column, in no place but the ``cells``,
    nowhere, which means SI (``si``), or nowhere for speeds, which then follow lengths and angles (``follow``).
    """

    def __init__(self, rng: random.Random, kinds: tuple[str, ...], fields: frozenset[str], *, plain: bool) -> None:
        self.rng = rng
        self.kinds = kinds
        self.fields = fields
        # What is read fast has no units in its cells, and mostly at most one unit that is not SI.
        places = ("said", "option", "headers", "si", "si") if plain else ("said", "option", "headers", "cells", "si")
        self.place = {"length": rng.choice(places), "angle": rng.choice(places)}
        self.unit = {LENGTH: rng.choice(["m", "cm", "mm", "mm", "µm"]), ANGLE: rng.choice(["deg", "deg", "rad"])}
        for key, dimension in (("length", LENGTH), ("angle", ANGLE)):
            if self.place[key] == "si":
                self.unit[dimension] = SI[dimension]
        all_si = all(self.unit[dimension] == SI[dimension] for dimension in (LENGTH, ANGLE)) and rng.random() < 0.8
        for key in ("mass", "inertia", "effort", "damping"):
            choices = ["said"] if plain else ["said", "cells", *(["headers"] if key in ("mass", "inertia") else [])]
            self.place[key] = "si" if all_si else rng.choice(choices)
            for dimension in KEYS[key]:
                self.unit[dimension] = SI[dimension] if all_si else rng.choice(list(SCALES[dimension]))
        self._place_speeds(plain=plain)

    def _place_speeds(self, *, plain: bool) -> None:
        stated = {self.place["length"], self.place["angle"]} <= {"said", "option"}
        bare = (
            ["follow"] if stated else ["si"] if plain and {self.place["length"], self.place["angle"]} == {"si"} else []
        )
        self.place["velocity"] = self.rng.choice([*bare, "said"] if plain else [*bare, "said", "cells"])
        followed = self.place["velocity"] != "said"
        for dimension, base in ((SPEED, LENGTH), (RATE, ANGLE)):
            self.unit[dimension] = f"{self.unit[base]}/s" if followed else self.rng.choice(list(SCALES[dimension]))

    def header(self, name: str) -> str | None:
        """The unit of a column's header."""
        turns, slides = bool(set(self.kinds) & {REVOLUTE, CONTINUOUS}), PRISMATIC in self.kinds
        of_both = DIMENSIONS.get(name)
        if of_both is None or (turns and slides and of_both[0] != of_both[1]):
            return None
        dimension = of_both[slides]
        return self.unit[dimension] if self.place[key_of(dimension)] == "headers" else None

    def bare(self, name: str, dimension: str) -> str | None:
        """The unit of a bare number in a column; None where the cell has to say it."""
        place = self.place[key_of(dimension)]
        if place == "cells" or (place == "headers" and self.header(name) is None):
            return None
        return self.unit[dimension]

    def state(self, table: Table) -> None:
        """Says the units of a table above its rows, or by options."""
        said: dict[str, Any] = {}
        for key, place in self.place.items():
            spelt = [self.rng.choice(unit_words(dimension, self.unit[dimension])) for dimension in KEYS[key]]
            if place == "said" or (place == "si" and key in ("length", "angle") and self.rng.random() < 0.3):
                said[key] = spelt[0] if len(spelt) == 1 else spelt
            if place == "option" or (key in ("length", "angle") and place == "said" and self.rng.random() < 0.2):
                table.options[f"{key}_unit"] = spelt[0]
        if said:
            flat = said.keys() == {"length", "angle"} and self.rng.random() < 0.4
            table.said["units"] = ", ".join(said.values()) if flat else said


def key_of(dimension: str) -> str:
    """The kind of a quantity, as tables call it."""
    return next(key for key, dimensions in KEYS.items() if dimension in dimensions)


def _placement(rng: random.Random, units: _Units, *, plain: bool) -> Placement:
    """A base or a tool, as xyz and rpy or as a matrix.

    A number whose unit nothing says is bare beside bare rows only: rows may all name their unit in other tables.
    """
    speller = Speller(rng)
    sure = ("said", "option", "si") if plain else ("said", "option")
    xyz = [length(rng) for _ in "xyz"]
    rpy = [angle(rng) for _ in "xyz"]
    if rng.random() < 0.3:
        rpy = [Exact(angle.number * 0, ANGLE) for angle in rpy]
    x, y, z = (number.si for number in xyz)
    roll, pitch, yaw = (number.si for number in rpy)
    matrix = shift(x, y, z) @ turn("z", yaw) @ turn("y", pitch) @ turn("x", roll)

    def leaf(number: Exact, dimension: str) -> str:
        unit = units.unit[dimension] if units.place[key_of(dimension)] in sure else None
        return speller.text(number, unit).bare

    lengths = [leaf(number, LENGTH) for number in xyz]
    if rng.random() < 0.25:
        elements = [[repr(float(matrix[i, j])) for j in range(3)] + [lengths[i]] for i in range(3)]
        return Placement([*elements, ["0", "0", "0", "1"]], matrix)
    said: dict[str, Any] = {"xyz": lengths}
    if any(number.number for number in rpy) or rng.random() < 0.5:
        said["rpy"] = [leaf(number, ANGLE) for number in rpy]
    return Placement(said, matrix)


# --- Columns and cells ------------------------------------------------------------------------------------------------


@dataclass
class _Spelling:
    """How the rows of one table are written."""

    rng: random.Random
    units: _Units
    fields: frozenset[str]
    speller: Speller
    types: dict[str, str]
    symbols: bool

    def row(self, row: KnownRow, number: int) -> dict[str, Text]:
        """The cells of a row by field."""
        cells = {key: Text(text, text) for key, text in (("joint", row.joint), ("link", row.link)) if text is not None}
        if "type" in self.fields:
            cells["type"] = Text(self.types[row.type], self.types[row.type])
        for key, value in row.numbers.items():
            cells[key] = self.speller.text(value, self.units.bare(key, value.dimension))
        if row.type != FIXED:
            self._variable(row, number, cells)
        if "sign" in self.fields and "sign" not in cells:
            cells["sign"] = _same(str(row.sign) if row.sign < 0 or self.rng.random() < 0.8 else "")
        if "flip" in self.fields and "flip" not in cells:
            cells["flip"] = _same(self.rng.choice(["true", "yes", "1"] if row.sign < 0 else ["false", "no", "0"]))
        return {key: cells.get(key, EMPTY) for key in self.fields}

    def _variable(self, row: KnownRow, number: int, cells: dict[str, Text]) -> None:
        """Writes the joint variable into theta, or into d, with the sign if there is no other place for it."""
        home = "d" if row.type == PRISMATIC else "theta"
        # Without types, a row that has no variable beside rows that have one may be a fixed one, and is refused.
        writes = self.rng.random() < 0.3 if "type" in self.fields else self.symbols
        if self.speller.plain or home not in self.fields or not writes:
            return
        symbols = ["q", f"q{number}", f"q_{number}", "q_i"]
        symbols += [f"d{number}"] if home == "d" else [f"theta{number}", f"θ{number}", f"θ_{number}"]
        sign = 1
        if row.sign < 0 and self.rng.random() < 0.5:
            sign = -1
            cells |= {key: _same(text) for key, text in (("sign", "1"), ("flip", "no")) if key in self.fields}
        value = row.numbers[home]
        unit = self.units.bare(home, value.dimension)
        if unit is not None and unit.startswith("deg") and not value.degrees:
            unit = None
        cells[home] = self.speller.variable(self.rng.choice(symbols), sign, value, unit)


def _same(text: str) -> Text:
    return Text(text, text)


def _columns(
    rng: random.Random,
    fields: frozenset[str],
    units: _Units,
    spelling: _Spelling,
    symbols: Mapping[str, tuple[str, ...]],
) -> list[Column]:
    """The columns in some order, with headers in the documented words, or symbols in the place of some of them."""
    order = [key for key in ORDER if key in fields]
    if rng.random() < 0.5:
        rng.shuffle(order)
    columns = []
    for key in order:
        choices = [word for word in words("headers", key) if word != "#"]
        if spelling.speller.plain:
            choices = choices[:1]
        if key == "a":  # r beside sigma is another paper's letter
            choices = [word for word in choices if word != "r"]
        header = rng.choice(symbols.get(key, choices))
        if key not in symbols and rng.random() < 0.2:
            header = rng.choice(
                [header.upper() if header.isascii() else header, header.title(), header.replace(" ", "_")]
            )
        unit = units.header(key)
        if unit is not None:
            dimension = next(kind for kind in DIMENSIONS[key] if unit in SCALES[kind])
            form = rng.choice(["{} [{}]", "{} ({})", "{}[{}]"])
            header = form.format(header, rng.choice(unit_words(dimension, unit)))
        columns.append(Column(key, header, unit))
    return columns


def home_positions(rng: random.Random, arm: KnownArm) -> list[list[float]]:
    """Two joint vectors: zero, and one at random."""
    return [[0.0] * arm.moving, [rng.uniform(-math.pi, math.pi) for _ in range(arm.moving)]]
