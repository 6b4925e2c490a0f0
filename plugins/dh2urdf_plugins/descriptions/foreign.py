"""Robot descriptions of unknown origin as `dh2urdf view` shows them: with colours, and joints that follow others."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.stages import Expansion
    from dh2urdf.stages.foreign_robot import ForeignRobot


def _foreign(form: str, path: Path, expansion: Expansion | None = None) -> ForeignRobot:
    """The robot of a file, see `dh2urdf_plugins.descriptions.description.describe`.

    Floating and planar joints are fixed, a URDF needs no name, and a colour that is defined nowhere is none.
    """
    from dh2urdf.stages.foreign_robot import ForeignRobot
    from dh2urdf_plugins.descriptions.description import describe

    found = describe(form, path, expansion, colours=True)
    parts = {name: getattr(found, name) for name in ("robot", "followers", "loose", "folder")}
    return ForeignRobot(**parts, notices=tuple(found.notices))


foreign_urdf, foreign_xacro, foreign_sdf, foreign_mjcf = (
    partial(_foreign, form) for form in ("urdf", "xacro", "sdf", "mjcf")
)
"""What reads a file of each format as it is shown."""
