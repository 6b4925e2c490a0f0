"""The numbers of an extracted table: zeros where zeros can be, exact parts of π, and else the shortest decimals."""

from __future__ import annotations

import math

from dh2urdf.late_dataclasses import dataclass
from dh2urdf.rotations import IDENTITY, RigidTransform

_PARTS_OF_PI = (2, 4, 6)
_HALVES = (9.5, 8.5, 7.5, 6.5, 5.5, 4.5, 3.5, 2.5, 1.5, 0.5)
_DIGITS = 17


@dataclass(frozen=True, slots=True)
class Precision:
    """How far a written number may be from the one that was computed.

    Attributes:
        length: of lengths [m].
        angle: of angles [rad].
    """

    length: float
    angle: float

    @classmethod
    def of(cls, tolerance: float, arm_length: float) -> Precision:
        """The precision with which one number may use a quarter of a tolerance at the tip [m, rad]."""
        return cls(between_decimals(tolerance / 4), between_decimals(tolerance / (4 * max(1.0, arm_length))))

    def finer(self) -> Precision:
        """An eighth of it."""
        return Precision(between_decimals(self.length / 8), between_decimals(self.angle / 8))

    def pose_of(self, pose: RigidTransform) -> RigidTransform:
        """A transform of the numbers that a table has."""
        if pose == IDENTITY:
            return pose
        x, y, z = (self.length_of(value) for value in pose.translation)
        roll, pitch, yaw = (self.angle_of(value) for value in pose.rpy)
        return RigidTransform.from_xyz_rpy((x, y, z), (roll, pitch, yaw))

    def length_of(self, value: float) -> float:
        """A length as the table has it [m]."""
        return decimal_of(value, self.length)

    def angle_of(self, value: float) -> float:
        """An angle as the table has it [rad], in (−π, π]."""
        angle = math.remainder(value, math.tau)
        while (written := self._angle(angle)) != angle:
            angle = written
        return angle

    def _angle(self, angle: float) -> float:
        if abs(abs(angle) - math.pi) <= self.angle:
            return math.pi
        for part in _PARTS_OF_PI:
            multiple = round(angle * part / math.pi)
            exact = multiple * math.pi / part
            if abs(exact - angle) <= self.angle:
                return exact
        return decimal_of(angle, self.angle)


def decimal_of(value: float, tolerance: float) -> float:
    """The decimal with the fewest places within a tolerance of a number; that of the decimal is the decimal itself."""
    while (written := _shortest(value, tolerance)) != value:
        value = written
    return value


def _shortest(value: float, tolerance: float) -> float:
    if abs(value) <= tolerance:
        return 0.0
    places = max(0, -math.ceil(math.log10(2 * max(tolerance, 1e-300))) - 1)
    while places < _DIGITS:
        written = round(value, places)
        if abs(written - value) <= tolerance:
            while places and abs((fewer := round(value, places - 1)) - value) <= tolerance:
                places, written = places - 1, fewer
            return written + 0.0
        places += 1
    return value


def between_decimals(tolerance: float) -> float:
    """The largest tolerance (k + ½)·10ⁿ that is not above another one.

    With such a tolerance a rounded number is rounded no further: a decimal of fewer places that is too far from a
    number is also too far from what the number becomes.
    """
    if tolerance <= 0.0:
        return 0.0
    power = math.floor(math.log10(tolerance))
    for exponent in (power, power - 1):
        for half in _HALVES:
            candidate = half * 10.0**exponent
            if candidate <= tolerance * (1 + 1e-12):
                return candidate
    return tolerance
