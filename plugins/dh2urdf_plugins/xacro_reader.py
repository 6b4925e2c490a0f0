"""Reads a xacro into a robot, as the real xacro expands it: one of our own in this process, a stranger's in a fence."""

from __future__ import annotations

import contextlib
import io
import threading
from typing import TYPE_CHECKING

from dh2urdf.errors import ProofError
from dh2urdf.source import Mark, Problem
from dh2urdf_plugins.urdf_reader import parse_urdf
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from dh2urdf.robot import Robot


_ONE_AT_A_TIME = threading.Lock()
"""xacro keeps what it is at in variables of its module: two threads would expand into each other."""


def read_xacro(path: Path) -> Robot:
    """The robot of a xacro file, expanded with the defaults of its arguments.

    Raises:
        ProofError: xacro cannot expand the file, or what comes out is not the URDF of a robot.
    """
    return parse_urdf(expand(path), f"{path} (expanded)")


def read_foreign_xacro(path: Path) -> Robot:
    """The robot of a xacro file of unknown origin, expanded where it can do no harm.

    Raises:
        ProofError: xacro cannot expand the file, something in it is refused, or what comes out is no robot's URDF.
    """
    return parse_urdf(expand_foreign(path), f"{path} (expanded)")


def expand(path: Path, arguments: Mapping[str, str] | None = None) -> bytes:
    """The text that the real xacro makes of a file that this project wrote.

    It evaluates the expressions of the file as Python does, in this process: `expand_foreign` is for all other files.

    Args:
        path: the file.
        arguments: values of its ``xacro:arg`` elements.

    Raises:
        ProofError: xacro cannot expand the file.
    """
    import xacro

    printed = io.StringIO()
    with _ONE_AT_A_TIME:
        folder_before = xacro.root_dir
        # xacro takes the whole path of an included file for a pattern, brackets in a folder's name included; with the
        # folder as its root directory, it sees the file names alone.
        xacro.root_dir = str(path.parent)
        try:
            with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
                document = xacro.process_file(path.name, mappings=dict(arguments or {}))
        except Exception as error:  # xacro evaluates Python: anything may come out.
            said = " ".join(str(error).split()) or repr(error)
            raise ProofError(Problem(message=f"xacro cannot expand it: {said}", mark=Mark(file=str(path)))) from error
        finally:
            xacro.root_dir = folder_before
    text: bytes = document.documentElement.toprettyxml(indent="  ", encoding="utf-8")
    return text
