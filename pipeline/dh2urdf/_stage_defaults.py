"""What the functions of a stage's record do where a plugin gives none, and constants of stages."""

from __future__ import annotations

PACKAGE_FILE = "package.xml"
"""What the folder of a ROS package holds."""
LOAD_TIME_LIMIT = 300.0
"""How long a loader may take where its record names no other time [s]."""


def always(_options: object) -> bool:
    """Whatever the options are."""
    return True


def load_time_limit(_options: object) -> float:
    """Five minutes."""
    return LOAD_TIME_LIMIT


def option_poses(options: object) -> int:
    """The field `poses` of the options, or 25."""
    return int(getattr(options, "poses", 25))


def option_picture(options: object) -> bool:
    """The field `picture` of the options, or no."""
    return bool(getattr(options, "picture", False))


def nothing(_request: object, _output: str) -> tuple[()]:
    """No findings."""
    return ()


def all_there(_options: object) -> None:
    """Misses no package."""
