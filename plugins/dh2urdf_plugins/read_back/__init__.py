"""Reads written files back, for the proof: by code that shares nothing with what wrote them.

The functions here are those that the records of emitters name. Each imports its reader when it is called.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from dh2urdf.robot import Robot
    from dh2urdf.stages import Expansion


def read_urdf(path: Path) -> Robot:
    """The robot of a URDF.

    Raises:
        ProofError: the file cannot be read, or is not the URDF of a robot.
    """
    from dh2urdf_plugins.read_back import urdf_reader

    return urdf_reader.read_urdf(path)


def read_urdfs(contents: Sequence[bytes]) -> list[tuple[list[int], Robot]]:
    """The joints of many URDFs, in groups whose members differ in numbers only."""
    from dh2urdf_plugins.read_back.urdf_scanner import scan_columns

    return scan_columns(contents)


def read_xacro(path: Path) -> Robot:
    """The robot of a xacro that dh2urdf wrote.

    Raises:
        ProofError: xacro cannot expand the file, or what comes out is not the URDF of a robot.
    """
    from dh2urdf_plugins.read_back import xacro_reader

    return xacro_reader.read_xacro(path)


def read_foreign_xacro(path: Path, expansion: Expansion | None = None) -> Robot:
    """The robot of a xacro of unknown origin.

    Raises:
        ProofError: xacro cannot expand the file, something in it is refused, or what comes out is no robot's URDF.
    """
    from dh2urdf_plugins.read_back import xacro_reader

    return xacro_reader.read_foreign_xacro(path, expansion)


def read_sdf(path: Path) -> Robot:
    """The robot of an SDF.

    Raises:
        ProofError: the file cannot be read, or is not the SDF of a manipulator.
    """
    from dh2urdf_plugins.read_back.sdf import reader

    return reader.read_sdf(path)


def read_mjcf(path: Path) -> Robot:
    """The robot of an MJCF.

    Raises:
        ProofError: the file cannot be read, or is not the MJCF of a manipulator.
    """
    from dh2urdf_plugins.read_back.mjcf import reader

    return reader.read_mjcf(path)


def read_table(path: Path) -> Robot:
    """The robot of the one table of a file.

    Raises:
        InputError: no reader of tables reads the file.
        ProofError: the table is wrong.
    """
    from dh2urdf_plugins.read_back import table_reader

    return table_reader.read_table(path)
