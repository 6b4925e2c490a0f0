"""Robot descriptions of unknown origin as `dh2urdf view` shows them: with colours and with joints that follow others.

What a table has no place for keeps nothing from being seen: floating and planar joints are fixed, a URDF needs no name,
and a colour that is defined nowhere is none.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.foreign_robot import ForeignRobot
    from dh2urdf.stages import Expansion

# What reads is imported where a description is read: whatever writes one pays for none of it.


def _foreign(form: str, path: Path, expansion: Expansion | None = None) -> ForeignRobot:
    """The robot of a file; of an SDF, that of the first model. A xacro is expanded where it can do no harm.

    Args:
        form: ``urdf``, ``xacro``, ``sdf`` or ``mjcf``.
        path: the file.
        expansion: of a xacro, the values of its arguments and the packages that it may read; defaults where it is None.

    Raises:
        TableError: it cannot be read or expanded, or does not describe a robot.
    """
    from dh2urdf.foreign_robot import ForeignRobot
    from dh2urdf.stages import Expansion
    from dh2urdf_plugins.descriptions import description

    match form:
        case "urdf":
            found = description.urdf_description(path, colours=True)
        case "xacro":
            found = description.xacro_description(path, expansion or Expansion(), colours=True)
        case "sdf":
            found = description.sdf_description(path)
        case _:
            found = description.mjcf_description(path)
    return ForeignRobot(
        robot=found.robot,
        followers=found.followers,
        loose=found.loose,
        folder=found.folder,
        notices=found.notices,
    )


foreign_urdf, foreign_xacro, foreign_sdf, foreign_mjcf = (
    partial(_foreign, form) for form in ("urdf", "xacro", "sdf", "mjcf")
)
"""What reads a file of each format."""
