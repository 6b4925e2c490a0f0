"""Bounds of what is read: sizes of tables, and numbers that a manipulator cannot have."""

from __future__ import annotations

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
