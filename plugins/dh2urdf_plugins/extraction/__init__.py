"""The mathematics of the way back: the Denavit-Hartenberg table of a chain of joints."""

TOLERANCE = 1e-9
"""How far the tip of a table may be from the file's, unless somebody wants it nearer or less near [m, rad]."""
