"""Tables of known arms: which columns, units, options and statements say what, in the dialects of every reader."""

from __future__ import annotations

import math
import random
import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from known_arms import (
    COM,
    CONTINUOUS,
    FIXED,
    LIMITS,
    PRISMATIC,
    REVOLUTE,
    TENSOR,
    KnownArm,
    KnownRow,
    known_row,
    name,
)
from known_headers import Header, make_header
from known_quantities import EMPTY, SCALES, Speller, Text, counts_degrees
from known_units import DIMENSIONS, Beside, Units, as_matrix
from known_words import INDEXED, LANGUAGES, PREVIOUS, convention_words, flip_words, type_words

if TYPE_CHECKING:
    from collections.abc import Mapping

ORDER = (
    "index",
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
    "limits",
    "mass",
    *COM,
    "com",
    *TENSOR,
    "inertia",
    "radius",
    "damping",
    "friction",
    "armature",
)


GROUPS = {"limits": LIMITS[:2], "com": COM, "inertia": TENSOR}
"""The columns whose cells hold several fields."""


@dataclass
class Column:
    """A column: its field, its header in tables of rows, and the unit that the header says.

    Attributes:
        field: the field.
        header: the header, with its unit.
        unit: the unit; None where the header says none.
        parts: the header without its unit, and the word for the unit; None where it is one of the page's symbols.
    """

    field: str
    header: str
    unit: str | None = None
    parts: Header | None = None


@dataclass
class Arm:
    """An arm as texts: the statements about all rows, and the cells by field."""

    known: KnownArm
    said: dict[str, Any]
    rows: list[dict[str, Text]]


@dataclass
class Table:
    """Some arms with the same columns, units and options.

    Attributes:
        columns: the columns in their order.
        arms: the arms.
        said: the statements about all arms, by key; the leaves are texts.
        options: the statements by options of the reader.
        convention_column: whether each row says its convention.
        language: the language of its headers.
        in_texts: whether every number has to stay the text that it is, since others show which sign is decimal.
    """

    columns: list[Column]
    arms: list[Arm]
    said: dict[str, Any] = field(default_factory=dict)
    options: dict[str, Any] = field(default_factory=dict)
    convention_column: bool = False
    language: str = LANGUAGES[0]
    in_texts: bool = False


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
    units = Units(rng, kinds, fields, plain=plain)
    table = Table([], [])
    types = {kind: rng.choice(type_words(kind)) for kind in kinds}
    groups = frozenset(
        group for group, parts in GROUPS.items() if not plain and fields.issuperset(parts) and rng.random() < 0.25
    )
    spelling = _Spelling(rng, units, fields, groups, Speller(rng, plain=plain), types, symbols=rng.random() < 0.3)
    table.convention_column = rng.random() < 0.1
    table.language = LANGUAGES[0] if plain or rng.random() < 0.5 else rng.choice(LANGUAGES)
    convention = rng.choice(["standard", "modified"])
    where = "column" if table.convention_column else rng.choice(["said", "option", "both"])
    symbols = {} if plain or rng.random() < 0.7 else INDEXED
    if symbols and convention == "modified" and where != "column" and rng.random() < 0.7:
        symbols = {**INDEXED, **PREVIOUS}
    table.columns = _columns(spelling, symbols, table.language)
    if where in ("said", "both"):
        table.said["convention"] = rng.choice(convention_words(convention))
    if where in ("option", "both"):
        table.options["convention"] = rng.choice(convention_words(convention))
    units.state(table)
    example = KnownArm("", convention, [])
    Beside(rng, units, plain=plain).state(table, example)
    table.in_texts = not plain and rng.random() < 0.2
    for number in range(count):
        known = replace(example, name=f"r{number}" if plain else name(rng, f"r{number}_"))
        if where == "column":
            known.convention = rng.choice(["standard", "modified"])
        known.rows = [known_row(rng, fields, kinds) for _ in range(rng.randint(1, 7))]
        for k, row in enumerate(known.rows, start=1):
            for what in (what for what in ("joint", "link") if what in fields):
                setattr(row, what, f"{what}{k}" if plain else name(rng, f"{what[0]}{k}_"))
        said = {"convention": rng.choice(convention_words(known.convention))} if where == "column" else {}
        rows = [spelling.row(row, k) for k, row in enumerate(known.rows, start=1)]
        columns = [column.field for column in table.columns]
        table.arms.append(Arm(known, said, _like_thousands(rng, rows, columns) if table.in_texts else rows))
    return table


def _fields(rng: random.Random, kinds: tuple[str, ...], *, plain: bool) -> frozenset[str]:
    """The fields that a table has a column of."""
    share = 0.6 if plain else rng.choice([0.2, 0.5, 0.9])
    fields = {"a", "alpha", "d"} | ({"type"} if kinds != (REVOLUTE,) or rng.random() < 0.5 else set())
    if not plain and rng.random() < 0.2:
        fields.add("index")
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


# --- Columns and cells ------------------------------------------------------------------------------------------------


@dataclass
class _Spelling:
    """How the rows of one table are written."""

    rng: random.Random
    units: Units
    fields: frozenset[str]
    groups: frozenset[str]
    speller: Speller
    types: dict[str, str]
    symbols: bool

    def row(self, row: KnownRow, number: int) -> dict[str, Text]:
        """The cells of a row by field."""
        cells = {key: Text(text, text) for key, text in (("joint", row.joint), ("link", row.link)) if text is not None}
        if "index" in self.fields:
            cells["index"] = _same(str(number))
        if "type" in self.fields:
            cells["type"] = Text(self.types[row.type], self.types[row.type])
        for key, value in row.numbers.items():
            cells[key] = self.speller.text(value, self.units.bare(key, value.dimension))
        for group in sorted(self.groups):
            self._group(group, row, cells)
        if row.type != FIXED:
            self._variable(row, number, cells)
        if "sign" in self.fields and "sign" not in cells:
            cells["sign"] = _same(str(row.sign) if row.sign < 0 or self.rng.random() < 0.8 else "")
        if "flip" in self.fields and "flip" not in cells:
            cells["flip"] = _same(self.rng.choice(flip_words(turned=row.sign < 0)))
        return {key: cells.get(key, EMPTY) for key in self.fields | self.groups}

    def _group(self, group: str, row: KnownRow, cells: dict[str, Text]) -> None:
        """Writes several fields into one cell, and alike into those of their own, which other dialects have."""
        parts = GROUPS[group]
        if parts[0] not in row.numbers:
            return
        exact = [row.numbers[part] for part in parts]
        dimension, degrees = exact[0].dimension, exact[0].degrees
        unit = bare = self.units.bare(group, dimension)
        if unit is None or (counts_degrees(unit) and not degrees):
            unit, bare = self.speller.unit_for(exact[0]), None
        plain = Speller(self.rng, plain=True)
        texts = [plain.number(number, unit) for number in exact]
        full = [plain.with_unit(text, unit, dimension) for text in texts]
        cells |= {
            part: Text(with_unit if bare is None else text, with_unit)
            for part, text, with_unit in zip(parts, texts, full, strict=True)
        }
        word = full[0].removeprefix(texts[0]).strip()
        write = {"limits": self._range, "com": self._vector, "inertia": self._tensor}[group]
        if bare is not None and self.rng.random() < 0.7:
            cells[group] = _same(write(texts))
        elif self.rng.random() < 0.5:
            cells[group] = _same(write(full))
        else:
            cells[group] = _same(f"{write(texts, closed=True)} {word}")

    def _range(self, texts: list[str], *, closed: bool = False) -> str:
        """Two bounds in one cell, the second of which is not negative; `closed` where a unit follows both."""
        lower, upper = texts
        forms = [f"{lower}…{upper}", f"{lower}..{upper}", f"{lower} to {upper}", f"[{lower}, {upper}]"]
        if lower == f"-{upper}":
            forms += [f"±{upper}", f"+/-{upper}"] * 2
        if lower.startswith("-"):
            forms += [f"{lower} bis +{upper}", f"{lower}/+{upper}", f"{lower} ÷ +{upper}"]
        return self.rng.choice(forms if closed else [*forms, f"min: {lower}, max: {upper}"])

    def _vector(self, texts: list[str], *, closed: bool = False) -> str:
        return self.rng.choice(["[{}]", "({})"] if closed else ["[{}]", "({})", "{}"]).format(
            self.rng.choice(["; ", ", "]).join(texts)
        )

    def _tensor(self, texts: list[str], *, closed: bool = False) -> str:
        if not closed and set(texts[3:]) == {"0"}:
            return f"diag({', '.join(texts[:3])})"
        return "[" + ", ".join(f"[{', '.join(row)}]" for row in as_matrix(dict(zip(TENSOR, texts, strict=True)))) + "]"

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
        if unit is not None and counts_degrees(unit) and not value.degrees:
            unit = None
        cells[home] = self.speller.variable(self.rng.choice(symbols), sign, value, unit)


def _same(text: str) -> Text:
    return Text(text, text)


_SURE = re.compile(r"-?(0\.[0-9]+|[0-9]+\.([0-9]{1,2}|[0-9]{4,}))")
"""A number whose point can only be a decimal one."""
_DECIMALS = re.compile(r"(-?[1-9][0-9]{0,2})(?:(\.[0-9]{3})0)?( ?(?:[^\W\d]+|°))?")
"""A number of three decimals and a needless fourth one, or of none, with its unit."""


def _like_thousands(rng: random.Random, rows: list[dict[str, Text]], columns: list[str]) -> list[dict[str, Text]]:
    """The rows of an arm with numbers such as `1.250`, where another one shows that a point is the decimal sign."""
    numbers = [column for column in columns if column in DIMENSIONS and column not in GROUPS]
    texts = [row[column].bare for row in rows for column in numbers]
    if not any(_SURE.fullmatch(text) and not _DECIMALS.fullmatch(text) for text in texts):
        return rows

    def like(text: str) -> str:
        match = _DECIMALS.fullmatch(text)
        if match is None:
            return text
        return f"{match[1]}{match[2] or '.000'}{match[3] or ''}"

    return [
        row | {column: Text(like(row[column].bare), like(row[column].full)) for column in numbers if rng.random() < 0.3}
        for row in rows
    ]


def _columns(spelling: _Spelling, symbols: Mapping[str, tuple[str, ...]], language: str) -> list[Column]:
    """The columns in some order, with headers in the documented words, or symbols in the place of some of them."""
    rng, units = spelling.rng, spelling.units
    in_groups = {part for group in spelling.groups for part in GROUPS[group]}
    order = [key for key in ORDER if key in (spelling.fields | spelling.groups) - in_groups]
    if rng.random() < 0.5:
        rng.shuffle(order)
    columns = []
    for key in order:
        unit = units.header(key)
        dimension = next((kind for kind in DIMENSIONS.get(key, ()) if unit in SCALES[kind]), None)
        header = make_header(
            rng,
            key,
            symbols.get(key),
            (dimension, unit) if dimension and unit else None,
            language,
            plain=spelling.speller.plain,
        )
        columns.append(Column(key, header.text, unit, header))
    return columns


def home_positions(rng: random.Random, arm: KnownArm) -> list[list[float]]:
    """Two joint vectors: zero, and one at random."""
    return [[0.0] * arm.moving, [rng.uniform(-math.pi, math.pi) for _ in range(arm.moving)]]
