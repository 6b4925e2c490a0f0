"""Reads written files back, for the proof: by code that shares nothing with what wrote them.

The functions here are those that the records of emitters name. Each imports its reader when it is called.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from dh2urdf.robot import Robot
    from dh2urdf.stages import Expansion


def read_urdfs(contents: Sequence[bytes]) -> list[tuple[list[int], Robot]]:
    """The joints of many URDFs, in groups whose members differ in numbers only."""
    from dh2urdf_plugins.read_back.urdf_scanner import scan_columns

    return scan_columns(contents)


def read_foreign_xacro(path: Path, expansion: Expansion | None = None) -> Robot:
    """The robot of a xacro of unknown origin.

    Raises:
        ProofError: xacro cannot expand the file, something in it is refused, or what comes out is no robot's URDF.
    """
    from dh2urdf_plugins.read_back import xacro_reader

    return xacro_reader.read_foreign_xacro(path, expansion)


def _read(form: str, path: Path) -> Robot:
    """The robot of a file; of a xacro, one that dh2urdf wrote; of a table, the one table of its file.

    Raises:
        ProofError: the file cannot be read, xacro cannot expand it, or it does not describe a manipulator.
        InputError: no reader of tables reads the file.
    """
    match form:
        case "urdf":
            from dh2urdf_plugins.read_back.urdf_reader import read_urdf as read
        case "xacro":
            from dh2urdf_plugins.read_back.xacro_reader import read_xacro as read
        case "sdf":
            from dh2urdf_plugins.read_back.sdf.reader import read_sdf as read
        case "mjcf":
            from dh2urdf_plugins.read_back.mjcf.reader import read_mjcf as read
        case _:
            from dh2urdf_plugins.read_back.table_reader import read_table as read
    return read(path)


read_urdf, read_xacro, read_sdf, read_mjcf, read_table = (
    partial(_read, form) for form in ("urdf", "xacro", "sdf", "mjcf", "table")
)
