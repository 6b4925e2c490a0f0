"""The units of known tables: where each kind of quantity says its own, and what is beside the rows in them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from known_arms import (
    COM,
    CONTINUOUS,
    PRISMATIC,
    REVOLUTE,
    TENSOR,
    KnownArm,
    KnownPayload,
    KnownShape,
    Placement,
    angle,
    hundredths,
    length,
    payload,
    shape,
    shift,
    turn,
)
from known_quantities import (
    ANGLE,
    DENSITY,
    FORCE,
    INERTIA,
    LENGTH,
    MASS,
    RATE,
    SCALES,
    SI,
    SLIDING,
    SPEED,
    TORQUE,
    TURNING,
    Exact,
    Speller,
)
from known_words import unit_words

if TYPE_CHECKING:
    import random

    from known_tables import Table

DIMENSIONS = {
    **dict.fromkeys(("a", "d", *COM, "com", "radius"), (LENGTH, LENGTH)),
    **dict.fromkeys(("alpha", "theta"), (ANGLE, ANGLE)),
    **dict.fromkeys(("offset", "lower", "upper", "limits"), (ANGLE, LENGTH)),
    "velocity": (RATE, SPEED),
    **dict.fromkeys(("effort", "friction"), (TORQUE, FORCE)),
    "damping": (TURNING, SLIDING),
    "armature": (INERTIA, MASS),
    "mass": (MASS, MASS),
    **dict.fromkeys((*TENSOR, "inertia"), (INERTIA, INERTIA)),
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


class Units:
    """Where a table says its units, of each kind of quantity.

    ``said`` in a statement, by an ``option``, in the ``headers`` of every column, in no place but the ``cells``,
    nowhere, which means SI (``si``), or nowhere for speeds, which then follow lengths and angles (``follow``).
    """

    def __init__(self, rng: random.Random, kinds: tuple[str, ...], fields: frozenset[str], *, plain: bool) -> None:
        self.rng = rng
        self.plain = plain
        self.kinds = kinds
        self.fields = fields
        # What is read fast has no units in its cells, and mostly at most one unit that is not SI.
        places = ("said", "option", "headers", "si", "si") if plain else ("said", "option", "headers", "cells", "si")
        self.place = {"length": rng.choice(places), "angle": rng.choice(places)}
        self.unit = {LENGTH: rng.choice(["m", "cm", "mm", "mm", "µm"]), ANGLE: rng.choice(["deg", "deg", "rad"])}
        if not plain and rng.random() < 0.2:
            self.unit = {LENGTH: rng.choice(["in", "ft", "mil"]), ANGLE: rng.choice(["deg", "rev"])}
        for key, dimension in (("length", LENGTH), ("angle", ANGLE)):
            if self.place[key] == "si":
                self.unit[dimension] = SI[dimension]
        all_si = all(self.unit[dimension] == SI[dimension] for dimension in (LENGTH, ANGLE)) and rng.random() < 0.8
        for key in ("mass", "inertia", "effort", "damping"):
            choices = ["said"] if plain else ["said", "cells", "headers"]
            self.place[key] = "si" if all_si else rng.choice(choices)
            for dimension in KEYS[key]:
                self.unit[dimension] = SI[dimension] if all_si else rng.choice(list(SCALES[dimension]))
        self._place_speeds(plain=plain)

    def _place_speeds(self, *, plain: bool) -> None:
        stated = {self.place["length"], self.place["angle"]} <= {"said", "option"} and self.unit[LENGTH] != "mil"
        bare = (
            ["follow"] if stated else ["si"] if plain and {self.place["length"], self.place["angle"]} == {"si"} else []
        )
        self.place["velocity"] = self.rng.choice([*bare, "said"] if plain else [*bare, "said", "cells", "headers"])
        followed = self.place["velocity"] not in ("said", "headers")
        for dimension, base in ((SPEED, LENGTH), (RATE, ANGLE)):
            unit = f"{self.unit[base]}/s"
            followed = followed and unit in SCALES[dimension]
            self.unit[dimension] = unit if followed else self.rng.choice(list(SCALES[dimension]))

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
        others = {key: said.pop(key) for key in sorted(said.keys() - {"length", "angle"}) if self.rng.random() < 0.1}
        if others:
            table.options["units"] = others
        if said:
            flat = said.keys() == {"length", "angle"} and not others and self.rng.random() < 0.4
            table.said["units"] = ", ".join(said.values()) if flat else said


def key_of(dimension: str) -> str:
    """The kind of a quantity, as tables call it."""
    return next(key for key, dimensions in KEYS.items() if dimension in dimensions)


class Beside:
    """Writes what is beside the rows: base, tool, payload, and what holds for all links."""

    def __init__(self, rng: random.Random, units: Units, *, plain: bool) -> None:
        """Takes a source of chance, where the table says its units, and whether its rows are all bare."""
        self.rng = rng
        self.plain = plain
        self.units = units
        self.speller = Speller(rng)

    def leaf(self, number: Exact) -> str:
        """A number, which says its unit where no statement, and no option, holds for it.

        A length or an angle whose unit nothing says is bare beside bare rows only: rows may all name their unit in
        other tables.
        """
        beside_named = number.dimension in (LENGTH, ANGLE) and not self.plain
        sure = ("said", "option", *(() if beside_named else ("si",)))
        said = self.units.place.get(key_of(number.dimension)) in sure
        return self.speller.text(number, self.units.unit[number.dimension] if said else None).bare

    def placement(self) -> Placement:
        """A base or a tool, as xyz and rpy or as a matrix."""
        rng = self.rng
        xyz = [length(rng) for _ in "xyz"]
        rpy = [angle(rng) for _ in "xyz"]
        if rng.random() < 0.3:
            rpy = [Exact(angle.number * 0, ANGLE) for angle in rpy]
        x, y, z = (number.si for number in xyz)
        roll, pitch, yaw = (number.si for number in rpy)
        matrix = shift(x, y, z) @ turn("z", yaw) @ turn("y", pitch) @ turn("x", roll)
        lengths = [self.leaf(number) for number in xyz]
        if rng.random() < 0.25:
            elements = [[repr(float(matrix[i, j])) for j in range(3)] + [lengths[i]] for i in range(3)]
            return Placement([*elements, ["0", "0", "0", "1"]], matrix)
        said: dict[str, Any] = {"xyz": lengths}
        if any(number.number for number in rpy) or rng.random() < 0.5:
            said["rpy"] = [self.leaf(number) for number in rpy]
        return Placement(said, matrix)

    def payload(self, carried: KnownPayload) -> dict[str, Any]:
        """A payload, whose inertia is six numbers or a matrix."""
        said: dict[str, Any] = {"mass": self.leaf(carried.mass)}
        if any(number.number for number in carried.com) or self.rng.random() < 0.5:
            said["com"] = [self.leaf(number) for number in carried.com]
        if carried.inertia:
            parts = {name: self.leaf(number) for name, number in carried.inertia.items()}
            said["inertia"] = as_matrix(parts) if self.rng.random() < 0.4 else parts
        return said

    def shape(self, known: KnownShape) -> dict[str, str]:
        """A shape of links."""
        radius = {"radius": self.leaf(known.radius)} if known.radius else {}
        return ({"shape": known.shape} if known.shape else {}) | radius

    def state(self, table: Table, example: KnownArm) -> None:
        """Says it of all arms of a table, above the rows or by options, and puts it into an example of them."""
        rng = self.rng
        for what in ("base", "tool"):
            if rng.random() < 0.4:
                placement = self.placement()
                setattr(example, what, placement)
                (table.options if rng.random() < 0.3 else table.said)[what] = placement.said
        if rng.random() < 0.15 and "base" not in table.options:
            self._body(table.said, example)
        if rng.random() < 0.15:
            example.shape = shape(rng)
            example.density = Exact(hundredths(rng, 50000, 900000), DENSITY) if rng.random() < 0.6 else None
            density = {"density": self.speller.text(example.density, None).full} if example.density else {}
            table.said["defaults"] = {"geometry": self.shape(example.shape), **density}
        if rng.random() < 0.2:
            example.payload = payload(rng)
            (table.options if rng.random() < 0.3 else table.said)["payload"] = self.payload(example.payload)

    def _body(self, said: dict[str, Any], example: KnownArm) -> None:
        """Says what is at the base, beside where it stands."""
        base = said.get("base", {})
        if isinstance(base, list):  # a matrix has no place for it
            return
        base = dict(base)
        if self.rng.random() < 0.7:
            example.base_mass = Exact(
                self.rng.choice([hundredths(self.rng, 1, 2000), hundredths(self.rng, 0, 0)]), MASS
            )
            base["mass"] = self.leaf(example.base_mass)
        if self.rng.random() < 0.6 or not base:
            example.base_shape = shape(self.rng)
            base["geometry"] = self.shape(example.base_shape)
        said["base"] = base


def as_matrix(parts: dict[str, str]) -> list[list[str]]:
    """A tensor as a matrix of texts."""
    xx, yy, zz, xy, xz, yz = (parts[name] for name in TENSOR)
    return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
