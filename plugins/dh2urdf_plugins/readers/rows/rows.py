"""One row of a table, as texts with their places, becomes a DH row: the same for every kind of table."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from dh2urdf.manipulator import ENDS, DHRow, Inertia, JointType, Limits
from dh2urdf.quantities import Dimension, accepted_units
from dh2urdf.rotations import HALF_PI, rounded_quarter_turn
from dh2urdf.row_fields import COM, INERTIA, NUMBERS, ROW_FIELDS
from dh2urdf.source import Mark, Problem, shown
from dh2urdf.table_text import REQUIRED, Said
from dh2urdf_plugins.readers.header.units import SI
from dh2urdf_plugins.readers.rows.cells import FULL_TURN, RowCells, meant_by
from dh2urdf_plugins.readers.rows.six_parameters import Extra
from dh2urdf_plugins.readers.words.bounds import MEASURABLE_ARM
from dh2urdf_plugins.readers.words.fields import ACCEPTED_FLIPS, ACCEPTED_TYPES, flip_of, joint_type, type_advice
from dh2urdf_plugins.readers.words.names import RowNames

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf_plugins.readers.words.cells import Cell, Units

MAX_PROBLEMS = 1000
"""Problems of one manipulator that are collected; reading it stops there."""
LARGEST_LIMIT = 20 * math.pi
"""Bound of a revolute joint beyond which it is taken for degrees [rad]."""

_ROTARY_VARIABLES = ("q", "theta")
_LINEAR_VARIABLES = ("q", "d")
_OTHERS = tuple(name for name in NUMBERS if name not in {"a", "alpha", "d", "theta", "offset", "mass", "radius"})
"""The numbers of a row that have to do with no other number of it."""


class RowReader(RowCells):
    """Reads the rows of one manipulator and collects what is wrong with them.

    Attributes:
        type_is_given: whether the table has types at all, so that an empty one is worth a notice.
        names: the names of the rows so far.
        extras: what rows have besides a, α, d and θ, by the names of their joints.
        said: what the cells of the rows so far say, where a trace is wanted; None where it is not.
    """

    def __init__(self, units: Units, *, type_is_given: bool = True, traced: bool = False) -> None:
        """Starts a manipulator; see the attributes."""
        super().__init__(units)
        self.said: list[dict[str, Said]] | None = [] if traced else None
        self.type_is_given = type_is_given
        self.names: list[RowNames] = []
        self.extras: dict[str, Extra] = {}

    def read(self, number: int, cells: Mapping[str, Cell], mark: Mark) -> DHRow | None:
        """The row that some cells are, or None where there is an error in them.

        Args:
            number: the row's number, counted from 1.
            cells: the texts, by name of the field; an empty one was left out by the user.
            mark: the row's place.
        """
        before = self.errors
        self._cells, self._mark, self._number, self._read_in = cells, mark, number, {}
        self._foreign, self._bare, self._unit_said = set(), set(), set()
        self._joint = f"joint_{number}"
        self._joint = self._name("joint", self._joint)
        link = self._name("link", f"link_{number}")
        kind = self._type()
        if kind is JointType.FIXED and self._joint in ENDS:  # a frame of every description has this name
            self._joint = f"{self._joint}_joint"
        self.names.append(RowNames(self._joint, link, self._place("joint"), self._place("link")))
        for name in REQUIRED:
            if self._absent(name):
                cell = cells.get(name)
                message = f"there is no {name}" if cell is None else f"{name} is empty"
                self._error(message, name, accepted="a number, 0 included: nothing is filled in for geometry")
        a = self._quantity("a").value
        alpha = self._turn("alpha")
        d, theta, offset, sign = self._joint_variable(kind)
        self._six_parameters()
        if kind is not JointType.PRISMATIC and (theta or offset or sign < 0):
            self._refuse_bounds_of_theta()
        others: dict[str, Any] = {name: self._number_of_its_own(name, kind) for name in _OTHERS}
        row = partial(  # What is wrong with an argument is known when all of them are there.
            DHRow,
            joint=self._joint,
            link=link,
            type=kind,
            a=a,
            alpha=alpha,
            d=d,
            theta=theta,
            offset=offset,
            sign=sign,
            limits=self._limits(kind),
            mass=self._positive("mass", or_zero=kind is JointType.FIXED),
            com=self._com(),
            inertia=self._inertia(),
            radius=self._positive("radius"),
            **others,
            mark=mark,
        )
        if self.said is not None:
            self.said.append(
                {
                    name: Said(text=cell.text, mark=cell.mark, unit=self._read_in.get(name))
                    for name, cell in cells.items()
                    if cell.text and not (name == "type" and cell.mark is mark)  # it follows from the variables
                }
            )
        if number == self.last and self.rounded:
            self._note_rounded()
        return row() if self.errors == before else None

    # --- Words --------------------------------------------------------------------------------------------------------

    def _type(self) -> JointType:
        cell = self._cells.get("type")
        if cell and cell.text:
            kind = joint_type(cell.text)
            if kind is None:
                advice = type_advice(cell.text)
                self._error(
                    f"{shown(cell.text)} is no type of joint", "type", accepted=ACCEPTED_TYPES, suggestion=advice
                )
            return kind or JointType.REVOLUTE
        if self.type_is_given or cell:
            self._notice("the type is empty; the joint is taken as revolute", "type")
        return JointType.REVOLUTE

    # --- Geometry -----------------------------------------------------------------------------------------------------

    def _turn(self, name: str) -> float:
        return self._looked_at(name, self._quantity(name).value)

    def _looked_at(self, name: str, angle: float) -> float:
        """An angle of a row; one of more than a full turn is refused where no unit is declared for it."""
        if abs(angle) > FULL_TURN and name not in self._unit_said:
            self._error(
                f"{shown(self._cells[name].text)} is more than a full turn in rad, and no unit is declared for it",
                name,
                accepted="at most 2π rad where no unit is declared",
                suggestion=f"if these are degrees, say so: `{name} [deg]` in the header, `units: {{angle: deg}}`, "
                "or `--angle-unit deg`",
            )
        elif meant := meant_by(angle):
            self.rounded.append((self._cells[name], meant))
            if self.units.repair_pi:
                return (rounded_quarter_turn(angle) or 0) * HALF_PI
        return angle

    def _note_rounded(self) -> None:
        """One notice of the angles of a table that are nearly a multiple of π/2."""
        cell, meant = self.rounded[0]
        count = f"; {len(self.rounded)} angles are rounded like that" if self.rounded[1:] else ""
        kept = "is read as" if self.units.repair_pi else "is kept as it is, and is nearly"
        advice = None if self.units.repair_pi else f"write {meant}, or `--rounded-pi repair` for all of them"
        self.add(
            Problem(
                message=f"{shown(cell.text)} {kept} {meant}{count}",
                severity="notice",
                mark=cell.mark,
                found=cell.text,
                suggestion=advice,
            )
        )

    def _six_parameters(self) -> None:
        """Takes what the row has of Hayati, and of Khalil and Kleinfinger."""
        if all(self._absent(name) for name in ("beta", "gamma", "b")):
            return
        beta, gamma, b = self._turn("beta"), self._turn("gamma"), self._quantity("b").value
        if b and "gamma" not in self._cells:
            self._error(
                f"b is {shown(self._cells['b'].text)}: it may be a length of Khalil and Kleinfinger, or a friction",
                "b",
                accepted="b beside gamma, which may be 0; or damping, the friction as the joint feels it",
            )
        elif abs(b) > MEASURABLE_ARM:
            self._error(f"b is {b:.4g} m", "b", accepted=f"at most {MEASURABLE_ARM:g} m")
        elif beta or gamma or b:
            self.extras[self._joint] = Extra(beta, gamma, b, self._place("gamma" if gamma else "b"))

    def _joint_variable(self, kind: JointType) -> tuple[float, float, float, int]:
        """d, theta, offset and sign of the row [SI]."""
        linear = kind is JointType.PRISMATIC
        moves = kind is not JointType.FIXED
        d = self._quantity("d", variables=_LINEAR_VARIABLES if linear else ())
        theta = self._quantity("theta", variables=_ROTARY_VARIABLES if moves and not linear else ())
        offset = self._quantity("offset", linear=linear).value
        sign = self._sign()
        theta = replace(theta, value=self._looked_at("theta", theta.value))
        offset = offset if linear else self._looked_at("offset", offset)
        if not moves and offset:
            self._error("a fixed joint has no variable that an offset could be added to", "offset", accepted="0")
        if not moves and sign < 0:
            name = "flip" if "flip" in self._cells else "sign"
            self._error("a fixed joint has no direction that could be turned", name, accepted="1, or flip false")
        said = d if linear else theta
        if said.variable is None:
            return d.value, theta.value, offset, sign
        if said.sign < 0 and sign < 0:
            self._error(
                f"the direction is turned twice: here, and by {shown(said.variable.text)} with a minus",
                "flip" if "flip" in self._cells else "sign",
                accepted="one of the two",
            )
        offset, sign = offset + said.value, sign * said.sign
        return (0.0, theta.value, offset, sign) if linear else (d.value, 0.0, offset, sign)

    def _sign(self) -> int:
        if not self._absent("flip"):
            flip = flip_of(self._cells["flip"].text)
            if flip is None:
                text = shown(self._cells["flip"].text)
                self._error(f"{text} is neither true nor false", "flip", accepted=ACCEPTED_FLIPS)
            return -1 if flip else 1
        if self._absent("sign"):
            return 1
        errors = self.errors
        sign = self._quantity("sign").value
        if sign not in (1, -1) and self.errors == errors:
            self._error(f"{shown(self._cells['sign'].text)} is no direction", "sign", accepted="1 or -1")
        return -1 if sign < 0 else 1

    # --- Limits -------------------------------------------------------------------------------------------------------

    def _limits(self, kind: JointType) -> Limits:
        names = ("lower", "upper", "velocity", "effort")
        if all(self._absent(name) for name in names):
            return NO_LIMITS
        linear = kind is JointType.PRISMATIC
        if kind is JointType.FIXED:
            self._not_for("a fixed joint does not move", names)
            return NO_LIMITS
        velocity, effort = self._positive("velocity", linear=linear), self._positive("effort", linear=linear)
        if kind is JointType.CONTINUOUS:
            self._not_for("a continuous joint has no bounds", ("lower", "upper"))
            self._speed_beside(linear=linear)
            return Limits(velocity=velocity, effort=effort)
        errors = self.errors
        lower, upper = (self._optional(name, linear=linear) for name in ("lower", "upper"))
        for name, number, other in (("lower", lower, upper), ("upper", upper, lower)):
            if number is None and other is not None:
                have = "upper" if name == "lower" else "lower"
                self._error(f"there is {have} and no {name}", name, accepted="both lower and upper, or neither")
            elif number is not None and not linear and abs(number) > LARGEST_LIMIT:
                self._limit_in_degrees(name)
        if lower is not None and upper is not None and lower > upper and self.errors == errors:
            found = f"{shown(self._cells['lower'].text)} is above upper, {shown(self._cells['upper'].text)}"
            self._error(f"lower, {found}", "lower", accepted="lower at most upper", suggestion="are they exchanged?")
        self._speed_beside(linear=linear)
        return Limits(lower=lower, upper=upper, velocity=velocity, effort=effort)

    def _speed_beside(self, *, linear: bool) -> None:
        """Refuses a speed without a unit where the joint's own cells name another than the SI unit."""
        cell = self._cells.get("velocity")
        beside = next((name for name in ("lower", "upper", "offset") if name in self._foreign), None)
        if beside is None or cell is None or "velocity" not in self._bare:
            return
        dimension = Dimension.SPEED if linear else Dimension.TURN_RATE
        self._error(
            f"{shown(cell.text)} has no unit, and {beside} is {shown(self._cells[beside].text)}",
            "velocity",
            accepted=f"a number with a unit: {accepted_units(dimension)}",
            suggestion=f"write '{cell.text} {'mm/s' if linear else 'deg/s'}' or '{cell.text} {SI[dimension]}'",
        )

    def _refuse_bounds_of_theta(self) -> None:
        for name in ("lower", "upper"):
            if not self._absent(name) and self._cells[name].of_theta:
                self._error(
                    f"{shown(self._cells[name].text)} may bound theta or the joint variable q, which differ here",
                    name,
                    accepted="columns lower and upper, which bound q: before sign, offset and theta are applied",
                )

    def _limit_in_degrees(self, name: str) -> None:
        if name not in self._unit_said:
            self._error(
                f"{shown(self._cells[name].text)} is more than ten turns in rad, and no unit is declared for it",
                name,
                accepted="at most 20π rad where no unit is declared",
                suggestion=f"if these are degrees, say so: `{name} [deg]` in the header, `units: {{angle: deg}}`, or "
                "`--angle-unit deg`; if the joint turns without end, give it the type continuous",
            )

    def _not_for(self, reason: str, names: tuple[str, ...]) -> None:
        for name in names:
            if not self._absent(name) and self._cells[name].text.strip("+-0.") not in ("", "n/a", "none"):
                self._notice(f"{reason}; {name} {shown(self._cells[name].text)} is left out", name)

    def _number_of_its_own(self, name: str, kind: JointType) -> float | None:
        """A number that has to do with no other number of the row."""
        field = ROW_FIELDS[name]
        if kind is JointType.FIXED and kind not in field.types:
            self._not_for("a fixed joint does not move", (name,))
            return None
        is_linear = kind is JointType.PRISMATIC
        if field.positive:
            return self._positive(name, linear=is_linear)
        number = self._optional(name, linear=is_linear)
        if number is not None and not field.takes(number):
            self._error(f"{shown(self._cells[name].text)} is negative", name, accepted="0 or more")
        return number

    # --- Mass properties ----------------------------------------------------------------------------------------------

    def _com(self) -> tuple[float, float, float] | None:
        if all(self._absent(name) for name in COM):
            return None
        for name in COM:
            if self._absent(name):
                self._error(f"a part of the centre of mass is given, and {name} is not", name, accepted="all three")
        x, y, z = (self._quantity(name).value for name in COM)
        return (x, y, z)

    def _inertia(self) -> Inertia | None:
        if all(self._absent(name) for name in INERTIA):
            return None
        for name in INERTIA[:3]:
            if self._absent(name):
                message = f"a part of the inertia tensor is given, and {name} is not"
                self._error(message, name, accepted="ixx, iyy and izz, and ixy, ixz, iyz where they are not 0")
        if self._absent("mass"):
            self._error(
                "an inertia tensor is given and no mass",
                "mass",
                accepted="both, or neither: they are computed from the link's shape and density then",
            )
        return Inertia(**{name: self._quantity(name).value for name in INERTIA})


NO_LIMITS = Limits()
