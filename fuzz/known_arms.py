"""Arms whose meaning is known: random rows with their kinematics, and the texts that say them in a table.

The meaning is computed here, from exact fractions and from the definition of the two conventions, with numpy's 4x4
products. Nothing of dh2urdf is used: the words come from the tables of `docs/tables.md`, which are what a user is
promised, and everything else is written below.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import random

DOCS = Path(__file__).parents[1] / "docs" / "tables.md"
Matrix = Any
"""A rigid transform [4x4, m]."""


# --- Words ------------------------------------------------------------------------------------------------------------


@cache
def documented(table: str) -> tuple[tuple[str, ...], ...]:
    """The rows of a table of the documentation."""
    lines = DOCS.read_text(encoding="utf-8").partition(f"<!-- table {table} -->\n")[2].splitlines()[2:]
    rows = []
    for line in lines:
        if not line.startswith("|"):
            break
        rows.append(tuple(cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1]))
    return tuple(rows)


@cache
def words(table: str, kind: str) -> tuple[str, ...]:
    """The words that the documentation lists for a field, a type or a convention."""
    (found,) = (
        re.findall("`([^`]+)`", row[-1 if table == "conventions" else 1]) for row in documented(table) if row[0] == kind
    )
    return tuple(found)


@cache
def unit_words(dimension: str, unit: str) -> tuple[str, ...]:
    """The words of a unit of a dimension."""
    return tuple(
        word for row in documented("units") if row[:2] == (dimension, unit) for word in re.findall("`([^`]+)`", row[2])
    )


INDEXED = {
    "a": ("a_i", "aᵢ", "$a_i$", "a(i)", "a_{i}"),
    "alpha": ("alpha_i", "αᵢ", r"$\alpha_i$", "α_{i}"),
    "d": ("d_i", "dᵢ", "$d_{i}$"),
    "theta": ("theta_i", "θᵢ", r"\theta_i"),
}
"""Symbols of geometry with the index of their link."""
PREVIOUS = {
    "a": ("a_{i-1}", "aᵢ₋₁", "a(i-1)", "a_i-1"),
    "alpha": ("alpha_{i-1}", "αᵢ₋₁", "α_{i−1}", "alpha_im1"),
}
"""Symbols of the link before, which only the modified convention has."""


# --- Quantities -------------------------------------------------------------------------------------------------------

LENGTH, ANGLE, SPEED, RATE, NUMBER = "a length", "an angle", "a speed", "an angular speed", ""
MASS, INERTIA, TORQUE, FORCE = "a mass", "a moment of inertia", "a torque", "a force"
TURNING, SLIDING = "a rotational damping", "a linear damping"


def _scales() -> dict[str, dict[str, Fraction]]:
    """Units by what they measure, in SI units; of those that count degrees, in degrees."""
    lengths = {"m": Fraction(1), "cm": Fraction(1, 100), "mm": Fraction(1, 1000), "µm": Fraction(1, 10**6)}
    masses = {"kg": Fraction(1), "g": Fraction(1, 1000), "t": Fraction(1000)}
    areas = {name: lengths[name] ** 2 for name in ("m", "cm", "mm")}
    return {
        LENGTH: lengths,
        ANGLE: {"rad": Fraction(1), "deg": Fraction(1)},
        SPEED: {f"{name}/s": size for name, size in lengths.items()},
        RATE: {"rad/s": Fraction(1), "deg/s": Fraction(1)},
        MASS: masses,
        INERTIA: {f"{name}·{side}²": masses[name] * area for name in ("kg", "g") for side, area in areas.items()},
        TORQUE: {"Nm": Fraction(1), "kNm": Fraction(1000), "mNm": Fraction(1, 1000), "N·mm": Fraction(1, 1000)},
        FORCE: {"N": Fraction(1), "kN": Fraction(1000), "mN": Fraction(1, 1000)},
        TURNING: {"N·m·s/rad": Fraction(1), "N·mm·s/rad": Fraction(1, 1000)},
        SLIDING: {"N·s/m": Fraction(1), "N·s/mm": Fraction(1000)},
    }


SCALES = _scales()
SI = {dimension: next(iter(units)) for dimension, units in SCALES.items()}
"""The SI unit of each kind."""


@dataclass(frozen=True)
class Exact:
    """A quantity without rounding.

    Attributes:
        number: how many SI units; of an angle in degrees, how many degrees.
        dimension: what it measures.
        degrees: whether the number counts degrees.
    """

    number: Fraction
    dimension: str
    degrees: bool = False

    @property
    def si(self) -> float:
        """The SI number."""
        return math.pi * float(self.number / 180) if self.degrees else float(self.number)


@dataclass(frozen=True)
class Text:
    """A cell.

    Attributes:
        bare: what stands in a column whose header may have a unit.
        full: the same where nothing outside the cell has one.
    """

    bare: str
    full: str


EMPTY = Text("", "")


def decimal(number: Fraction) -> str:
    """A decimal number, digit by digit; never one whose point may separate thousands."""
    digits, scale = abs(number), 0
    while digits.denominator != 1:
        digits, scale = digits * 10, scale + 1
        if scale > 40:
            raise ValueError(f"{number} is no decimal number")
    text = str(digits.numerator).rjust(scale + 1, "0")
    text = f"{text[:-scale]}.{text[-scale:]}" if scale else text
    if re.fullmatch(r"[1-9][0-9]{0,2}\.[0-9]{3}", text):
        text += "0"
    return f"-{text}" if number < 0 else text


class Speller:
    """Writes quantities in the many ways in which tables have them."""

    def __init__(self, rng: random.Random, *, plain: bool = False) -> None:
        """Takes a source of chance; `plain` numbers are the shortest decimal ones, without units of their own."""
        self.rng = rng
        self.plain = plain

    def text(self, value: Exact, unit: str | None) -> Text:
        """A cell that says a quantity.

        Args:
            value: the quantity.
            unit: the unit of a bare number there; None where nothing says one, and the cell has to.
        """
        explicit = unit is None or (not self.plain and bool(value.dimension) and self.rng.random() < 0.15)
        if unit is None or explicit or (unit.startswith("deg") and not value.degrees):
            unit, explicit = self.unit_for(value), True
        number = self.number(value, unit)
        full = self.with_unit(number, unit, value.dimension) if value.dimension else number
        return Text(full if explicit else number, full)

    def variable(self, symbol: str, sign: int, value: Exact, unit: str | None) -> Text:
        """A cell that says the joint variable, with its sign, and what is added to it."""
        minus = "-" if sign < 0 else ""
        if not value.number:
            return Text(minus + symbol, minus + symbol)
        size = Exact(abs(value.number), value.dimension, value.degrees)
        plus = "-" if value.number < 0 else "+"
        text = Speller(self.rng, plain=True).text(size, unit)
        if plus == "+" and self.rng.random() < 0.4:
            after = f"- {symbol}" if sign < 0 else f"+ {symbol}"
            return Text(f"{text.bare} {after}", f"{text.full} {after}")
        return Text(f"{minus}{symbol} {plus} {text.bare}", f"{minus}{symbol} {plus} {text.full}")

    def unit_for(self, value: Exact) -> str:
        """Some unit in which a quantity can be written."""
        if value.dimension in (ANGLE, RATE):
            degrees = value.degrees and self.rng.random() < 0.8
            return ("deg" if degrees else "rad") + ("/s" if value.dimension == RATE else "")
        return self.rng.choice(list(SCALES[value.dimension]))

    def number(self, value: Exact, unit: str) -> str:
        """A number of a unit, as a decimal number or an expression."""
        rng = self.rng
        if value.degrees and not unit.startswith("deg"):
            turns = value.number / 180
            if self.plain or turns == 0 or rng.random() < 0.3:
                return repr(value.si).removesuffix(".0")
            over = f"/{turns.denominator}" if turns.denominator > 1 else ""
            pi = rng.choice(["pi", "π", "np.pi"])
            return {1: pi, -1: f"-{pi}"}.get(turns.numerator, f"{turns.numerator}*{pi}") + over
        number = value.number / SCALES.get(value.dimension, {}).get(unit, Fraction(1))
        text = decimal(number)
        if self.plain or rng.random() < 0.6:
            return text
        forms = [f"{text}0" if "." in text else f"{text}.0", f"{decimal(number * 1000)}e-3", text.replace("-", "−")]
        forms += [re.sub(r"^(-?)0\.", r"\1.", text), f"2*{decimal(number / 2)}" if number > 0 else text]
        forms += [f"{decimal(number / 4)} + {decimal(number * 3 / 4)}" if number > 0 else f"+{text}".replace("+-", "-")]
        # Never a point, or a comma, that may separate thousands.
        return re.sub(r"(?<![0-9.])([1-9][0-9]{0,2}\.[0-9]{3})(?![0-9])", r"\g<1>0", rng.choice(forms))

    def with_unit(self, number: str, unit: str, dimension: str) -> str:
        """A number with its unit behind it."""
        word = self.rng.choice(unit_words(dimension, unit) or (unit,))
        if " + " in number:
            number = f"({number})"
        tight = number[-1].isdigit() and "/" not in number and self.rng.random() < 0.3
        return f"{number}{'' if tight else ' '}{word}"


# --- Arms -------------------------------------------------------------------------------------------------------------

REVOLUTE, PRISMATIC, CONTINUOUS, FIXED = "revolute", "prismatic", "continuous", "fixed"


@dataclass
class KnownRow:
    """A row: its names, its type, and its exact numbers by field; the symbol is part of theta, or of d."""

    joint: str | None
    link: str | None
    type: str
    sign: int = 1
    numbers: dict[str, Exact] = field(default_factory=dict)

    def si(self, name: str) -> float | None:
        """A field in SI units; None where it is not said."""
        return self.numbers[name].si if name in self.numbers else None


@dataclass
class Placement:
    """A base or a tool: what a table says, and what that means."""

    said: Any
    matrix: Matrix


@dataclass
class KnownArm:
    """An arm, and what it means."""

    name: str
    convention: str
    rows: list[KnownRow]
    base: Placement | None = None
    tool: Placement | None = None

    def fk(self, q: list[float]) -> Matrix:
        """T(base_link -> tool0) by the definition of the convention, for the joint values of the rows that move."""
        values = iter(q)
        pose = np.eye(4) if self.base is None else self.base.matrix
        for row in self.rows:
            a, alpha, d, theta, offset = (row.si(name) or 0.0 for name in ("a", "alpha", "d", "theta", "offset"))
            if row.type == PRISMATIC:
                d += offset + row.sign * next(values)
            elif row.type != FIXED:
                theta += offset + row.sign * next(values)
            link, joint = shift(x=a) @ turn("x", alpha), turn("z", theta) @ shift(z=d)
            pose = pose @ (joint @ link if self.convention == "standard" else turn("x", alpha) @ shift(x=a) @ joint)
        return pose if self.tool is None else pose @ self.tool.matrix

    @property
    def moving(self) -> int:
        """How many rows move."""
        return sum(row.type != FIXED for row in self.rows)


def shift(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Matrix:
    """A translation [m]."""
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def turn(axis: str, angle: float) -> Matrix:
    """A rotation about an axis [rad]."""
    pose = np.eye(4)
    one, other = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    pose[one, one] = pose[other, other] = math.cos(angle)
    pose[one, other], pose[other, one] = -math.sin(angle), math.sin(angle)
    return pose


def length(rng: random.Random, *, bound: int = 1500) -> Exact:
    """A length of up to so many mm, and now and then of a few, in whole tenths of a millimetre or in µm."""
    step = rng.choice([1, 10, 100, 100, 1000])
    bound = rng.choice([bound, bound, 6])
    number = rng.randint(-bound * 1000 // step, bound * 1000 // step) * step
    return Exact(Fraction(rng.choice([0, number, number]), 10**6), LENGTH)


def angle(rng: random.Random) -> Exact:
    """An angle of at most half a turn, in degrees or in radians."""
    if rng.random() < 0.7:
        usual = [Fraction(degrees) for degrees in (0, 90, -90, 180, 45, -30)]
        return Exact(rng.choice([*usual, hundredths(rng, -17999, 17999)]), ANGLE, degrees=True)
    return Exact(Fraction(rng.randint(-300, 300), 100), ANGLE)


def hundredths(rng: random.Random, low: int, high: int) -> Fraction:
    """A number of so many hundredths."""
    return Fraction(rng.randint(low, high), 100)


LIMITS = ("lower", "upper", "velocity", "effort")
COM = ("com_x", "com_y", "com_z")
TENSOR = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def known_row(rng: random.Random, fields: frozenset[str], kinds: tuple[str, ...]) -> KnownRow:
    """A row that says something of the given fields."""
    kind = rng.choice(kinds)
    row = KnownRow(None, None, kind)
    numbers = row.numbers
    numbers |= {"a": length(rng), "alpha": angle(rng), "d": length(rng)}
    if "theta" in fields:
        numbers["theta"] = angle(rng)
    if kind == FIXED:
        pass
    elif kind == PRISMATIC:
        _of_the_joint(rng, row, fields, LENGTH, SPEED)
    else:
        _of_the_joint(rng, row, fields, ANGLE, RATE)
    _of_the_link(rng, row, fields)
    return row


def _of_the_joint(rng: random.Random, row: KnownRow, fields: frozenset[str], dimension: str, rate: str) -> None:
    """What a joint that moves says of its variable."""
    degrees, linear = dimension == ANGLE and rng.random() < 0.7, dimension == LENGTH
    numbers = row.numbers
    if "offset" in fields:
        numbers["offset"] = length(rng) if linear else angle(rng)
    if {"sign", "flip"} & fields:
        row.sign = rng.choice([1, -1])
    if "lower" in fields and row.type != CONTINUOUS and rng.random() < 0.8:
        largest = 17900 if degrees else 310
        for name, low, high in (("lower", -largest, 0), ("upper", 1, largest)):
            numbers[name] = Exact(hundredths(rng, low, high), dimension, degrees)
            if linear:
                numbers[name] = Exact(abs(length(rng).number) * (1 if high > 1 else -1), dimension)
    if "velocity" in fields and rng.random() < 0.8:
        numbers["velocity"] = Exact(hundredths(rng, 10, 9000 if degrees else 300), rate, degrees)
    for name, quantity in (
        ("effort", FORCE if linear else TORQUE),
        ("damping", SLIDING if linear else TURNING),
        ("friction", FORCE if linear else TORQUE),
        ("armature", MASS if linear else INERTIA),
    ):
        if name in fields and rng.random() < 0.8:
            numbers[name] = Exact(hundredths(rng, 1, 9999), quantity)


def _of_the_link(rng: random.Random, row: KnownRow, fields: frozenset[str]) -> None:
    """What a row says of the link that it moves."""
    numbers = row.numbers
    if "mass" in fields and rng.random() < 0.8:
        numbers["mass"] = Exact(hundredths(rng, 10, 2000), MASS)
        if "ixx" in fields and rng.random() < 0.8:
            x, y, z = (hundredths(rng, 10, 100) for _ in "xyz")  # masses on the axes make a tensor that bodies have
            moments = (y + z, x + z, x + y, *(Fraction(rng.randint(-9, 9), 1000) for _ in "xyz"))
            numbers |= {name: Exact(number, INERTIA) for name, number in zip(TENSOR, moments, strict=True)}
    if "com_x" in fields and rng.random() < 0.8:
        numbers |= {name: length(rng, bound=200) for name in COM}
    if "radius" in fields and rng.random() < 0.8:
        numbers["radius"] = Exact(Fraction(rng.randint(10, 90), 1000), LENGTH)


_VISIBLE = "abcdefgXYZ_éßäØ漢Ω0123456789 -+.$<&,;'\"\t"


def name(rng: random.Random, stem: str) -> str:
    """A name that cannot be mistaken for anything else, with characters that have to be quoted or kept."""
    middle = "".join(rng.choice(_VISIBLE) for _ in range(rng.randint(0, 6))).replace("\t", "")
    return f"{stem}{middle}n"
