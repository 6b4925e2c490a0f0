"""Whether this process belongs to dh2urdf, or to a program that calls it.

What a switch changes for the whole process - the garbage collector, warnings, the levels of loggers - is touched in a
process of our own alone: in the command line, and in the workers that a run starts.
"""

from __future__ import annotations

_OWN: list[bool] = []


def claim() -> None:
    """Says that this process does nothing but what dh2urdf was asked for."""
    _OWN.append(True)


def is_own() -> bool:
    """Whether the process does nothing but what dh2urdf was asked for."""
    return bool(_OWN)
