"""Bounds of what is read: sizes of tables, and numbers that a manipulator cannot have."""

from __future__ import annotations

import math

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
LONGEST_ARM, SHORTEST_ARM = 5.0, 0.02
"""Reach beyond which a notice asks for the unit [m]."""
FULL_TURN = 2 * math.pi
"""Angle beyond which one without a unit may be in degrees [rad]."""
LARGEST_ANGLE = 1000 * FULL_TURN
"""Angle of a table beyond which its sum with a joint value loses what a micrometre at the tool needs [rad]."""
NEARLY = 1e-3
"""How near an angle has to be to a quarter turn to be taken for a rounded one, relative."""
