"""Robot descriptions of unknown origin as `dh2urdf view` shows them: with colours and with joints that follow others.

What a table has no place for keeps nothing from being seen: floating and planar joints are fixed, a URDF needs no name,
and a colour that is defined nowhere is none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.foreign_robot import ForeignRobot
    from dh2urdf.stages import Expansion
    from dh2urdf_plugins.descriptions.description import Description

# What reads is imported where a description is read: whatever writes one pays for none of it.


def foreign_urdf(path: Path) -> ForeignRobot:
    """The robot of a URDF file.

    Raises:
        TableError: it cannot be read, or is not the URDF of a robot.
    """
    from dh2urdf_plugins.descriptions.description import urdf_description

    return _foreign(urdf_description(path, colours=True))


def foreign_xacro(path: Path, expansion: Expansion | None = None) -> ForeignRobot:
    """The robot of a xacro file, expanded where it can do no harm.

    Args:
        path: the file.
        expansion: the values of its arguments, and the packages that it may read; defaults where it is None.

    Raises:
        TableError: it cannot be expanded, or what comes out is not the URDF of a robot.
    """
    from dh2urdf.stages import Expansion
    from dh2urdf_plugins.descriptions.description import xacro_description

    return _foreign(xacro_description(path, expansion or Expansion(), colours=True))


def foreign_sdf(path: Path) -> ForeignRobot:
    """The robot of the first model in an SDF file.

    Raises:
        TableError: it cannot be read, or holds no model.
    """
    from dh2urdf_plugins.descriptions.description import sdf_description

    return _foreign(sdf_description(path))


def foreign_mjcf(path: Path) -> ForeignRobot:
    """The robot of an MJCF file.

    Raises:
        TableError: it cannot be read, or is not the MJCF of an arm.
    """
    from dh2urdf_plugins.descriptions.description import mjcf_description

    return _foreign(mjcf_description(path))


def _foreign(description: Description) -> ForeignRobot:
    from dh2urdf.foreign_robot import ForeignRobot

    return ForeignRobot(
        robot=description.robot,
        followers=description.followers,
        loose=description.loose,
        folder=description.folder,
        notices=description.notices,
    )
