"""Arms whose meaning is known: random rows with their kinematics.

The meaning is computed here, from exact fractions and from the definition of the two conventions, with numpy's 4x4
products. Nothing of dh2urdf is used: the words come from the tables of `docs/tables.md`, which are what a user is
promised (`known_words.py`), and everything else is written below and in `known_quantities.py`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from known_quantities import ANGLE, FORCE, INERTIA, LENGTH, MASS, RATE, SLIDING, SPEED, TORQUE, TURNING, Exact

if TYPE_CHECKING:
    import random

Matrix = Any
"""A rigid transform [4x4, m]."""

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
class KnownPayload:
    """What an arm carries: its mass, the centre of mass in tool0, and the inertia about it, if it is given."""

    mass: Exact
    com: list[Exact]
    inertia: dict[str, Exact] | None


@dataclass
class KnownShape:
    """A shape of links or of the base: its word and its radius, where they are given."""

    shape: str | None = None
    radius: Exact | None = None


@dataclass
class KnownArm:
    """An arm, and what it means; the density is in kg/m³."""

    name: str
    convention: str
    rows: list[KnownRow]
    base: Placement | None = None
    tool: Placement | None = None
    base_mass: Exact | None = None
    base_shape: KnownShape = field(default_factory=KnownShape)
    shape: KnownShape = field(default_factory=KnownShape)
    density: Exact | None = None
    payload: KnownPayload | None = None

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
    """What a joint that moves declares about its variable."""
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
        if rng.random() < 0.4:  # to both sides alike
            numbers["lower"] = Exact(-numbers["upper"].number, dimension, degrees)
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
    """What a row declares about the link that it moves."""
    numbers = row.numbers
    if "mass" in fields and rng.random() < 0.8:
        numbers["mass"] = Exact(hundredths(rng, 10, 2000), MASS)
        if "ixx" in fields and rng.random() < 0.8:
            numbers |= tensor(rng)
    if "com_x" in fields and rng.random() < 0.8:
        numbers |= {name: length(rng, bound=200) for name in COM}
    if "radius" in fields and rng.random() < 0.8:
        numbers["radius"] = Exact(Fraction(rng.randint(10, 90), 1000), LENGTH)


def tensor(rng: random.Random) -> dict[str, Exact]:
    """A tensor that bodies have: of masses on the axes, and with small products or none."""
    x, y, z = (hundredths(rng, 10, 100) for _ in "xyz")
    largest = rng.choice([0, 9])
    moments = (y + z, x + z, x + y, *(Fraction(rng.randint(-largest, largest), 1000) for _ in "xyz"))
    return {name: Exact(number, INERTIA) for name, number in zip(TENSOR, moments, strict=True)}


def payload(rng: random.Random) -> KnownPayload:
    """Something that an arm carries."""
    com = [length(rng, bound=200) for _ in COM]
    return KnownPayload(Exact(hundredths(rng, 1, 2000), MASS), com, tensor(rng) if rng.random() < 0.7 else None)


def shape(rng: random.Random) -> KnownShape:
    """A shape of links."""
    found = KnownShape(rng.choice(["cylinder", "box", "capsule"]))
    if rng.random() < 0.7:
        found.radius = Exact(Fraction(rng.randint(10, 90), 1000), LENGTH)
    return found


_VISIBLE = "abcdefgXYZ_éßäØ漢Ω0123456789 -+.$<&,;'\"\t"


def name(rng: random.Random, stem: str) -> str:
    """A name that cannot be mistaken for anything else, with characters that have to be quoted or kept."""
    middle = "".join(rng.choice(_VISIBLE) for _ in range(rng.randint(0, 6))).replace("\t", "")
    return f"{stem}{middle}n"
