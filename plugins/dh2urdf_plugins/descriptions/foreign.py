"""Robot descriptions of unknown origin as `dh2urdf view` shows them: with colours, and joints that follow others."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.stages import Expansion
    from dh2urdf.stages.foreign_robot import ForeignRobot


def _foreign(form: str, path: Path, expansion: Expansion | None = None) -> ForeignRobot:
    """The robot of a file of unknown origin, as `dh2urdf view` shows it: with colours and joints that follow others.

    Floating and planar joints are fixed, a URDF needs no name, and a colour that is defined nowhere is none.

    Args:
        form: ``urdf``, ``xacro``, ``sdf`` or ``mjcf``.
        path: the file.
        expansion: of a xacro, the values of its arguments and the packages that it may read; defaults where it is None.

    Raises:
        TableError: it cannot be read or expanded, or does not describe a robot.
    """
    from dh2urdf.stages.foreign_robot import ForeignRobot
    from dh2urdf_plugins.descriptions.description import describe

    found = describe(form, path, expansion, colours=True)
    return ForeignRobot(
        robot=found.robot,
        followers=found.followers,
        loose=found.loose,
        folder=found.folder,
        notices=tuple(found.notices),
    )


foreign_urdf, foreign_xacro, foreign_sdf, foreign_mjcf = (
    partial(_foreign, form) for form in ("urdf", "xacro", "sdf", "mjcf")
)
"""What reads a file of each format as it is shown."""
