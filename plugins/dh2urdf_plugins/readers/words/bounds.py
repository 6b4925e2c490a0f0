"""Bounds of what is read: numbers that a manipulator cannot have, and such as a careful person would look at twice.

The second leave room for whatever is built. A number beyond one of them is mostly in another unit than the table says.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.rotations import HALF_PI

if TYPE_CHECKING:
    from dh2urdf.manipulator import Limits

MAX_JOINTS = 5000
"""Joints of one manipulator: a hundred times those of the longest arms that are built, and made in seconds."""
MAX_COLUMNS = 1000
"""Columns of a table: each field has one at most, and there are fewer than a hundred."""
MAX_TEXT = 1000
"""Characters of a header and of a cell that is read; a comment that is longer is prose, which nothing looks at."""
REMEMBERED = 10_000
"""Texts, or sets of texts, whose meaning is remembered."""
MEASURABLE_ARM = 1e9
"""Length of an arm beyond which a double cannot tell micrometres apart [m]."""

LONGEST_ARM = 100.0
"""Length of an arm that a careful person would look at twice [m]."""
LONG_ARM = 50.0
"""The same of an arm whose rows are longer than `LONG_ROW` on average [m]."""
LONG_ROW = 2.0
"""Length of a row, a + d [m]: the space station's arm has 8 m in its longest, and 18 m in all seven."""
NEARLY_PARALLEL = 0.01
"""Angle between axes that are parallel but for a calibration [rad]."""
SHORTEST_ARM = 0.01
"""Length of an arm below which it may be one whose numbers are metres in a table of millimetres [m]."""
SMALLEST_LENGTH = 0.002
"""Below this all of a column of lengths in another unit than m may be in m after all [m]."""
FASTEST_TURN = 60.0
"""Speed of a joint that turns [rad/s]: the fastest axes of SCARA robots reach 52."""
FASTEST_SLIDE = 20.0
"""Speed of a joint that slides [m/s]."""
STRONGEST = 5e4
"""Torque or force of a joint [N·m or N]."""
WIDEST_LIMIT = 20 * math.pi
"""Bound of a joint that turns [rad]."""
NARROWEST_RANGE = 0.25
"""Range of a joint that turns, below which no joint of an arm may have a wider one [rad]."""
HEAVIEST_LINK = 1e5
"""Mass of a link, whatever the arm's size [kg]."""
HEAVY, LIGHT = 100.0, 0.02
"""Mass of a link over the square of the arm's length, at most and, of the heaviest, at least [kg/m²]."""
SMALLEST_GYRATION = 5e-4
"""Radius of gyration of a link [m]."""
THINNEST = 1e-3
"""Radius of a link [m]."""
DENSITIES = (10.0, 25_000.0)
"""Density of a link, from that of foam to that of osmium [kg/m³]."""

SHORTEST_STROKE = 1e-3
"""Range of a joint that slides [m]."""
RESISTANCES = {"damping": (1e4, 1e6), "friction": (1e4, 1e5), "armature": (1e4, 1e5)}
"""What a joint that turns, and one that slides, resists with at most [N·m·s/rad, N·m, kg·m²; N·s/m, N, kg]."""

SMALL_ANGLE = 7.0 / 90 * HALF_PI
"""More than the number of a full turn in rad, taken for degrees [rad]."""
_ROUND_ANGLES = tuple(math.pi * part for part in (1 / 6, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 5 / 6, 1, 3 / 2, 2))
_AS_ROUNDED = 1e-3
_ROUND_DEGREES, _AS_LIMITS_ARE_ROUNDED = 5.0, 5e-4


def are_radians(angle: float) -> bool:
    """Whether an angle that was read in degrees [rad] has the number of a simple part of π, as 1.5708 and 0.785."""
    if not 0 < abs(angle) < SMALL_ANGLE:
        return False
    number = abs(angle) / HALF_PI * 90
    return any(abs(number - wanted) <= _AS_ROUNDED * wanted for wanted in _ROUND_ANGLES)


def are_limits_in_radians(limits: Limits) -> bool:
    """Whether limits that were read in degrees [rad] have the numbers of round degrees in rad, as ±2.967 for ±170°."""
    bounds = (limits.lower or 0.0, limits.upper or 0.0)
    return all(abs(bound) < SMALL_ANGLE for bound in bounds) and any(map(_is_round, bounds))


def _is_round(angle: float) -> bool:
    """Whether the number that an angle has in degrees is, in rad, a multiple of 5°."""
    degrees = math.degrees(angle / HALF_PI * 90)
    round_one = _ROUND_DEGREES * round(degrees / _ROUND_DEGREES)
    return bool(round_one) and abs(degrees - round_one) <= _AS_LIMITS_ARE_ROUNDED * abs(round_one)
