"""The stage ``xacro``: macros over a table. What writes and reads them is imported when it is called."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from dh2urdf.stages import EmittedFile, Emitter, GivesNotices, OtherFiles, ReadsBack, ReadsForeign
from dh2urdf_plugins.formats import checks, foreign_xacro, read_xacro
from dh2urdf_plugins.formats.urdf import PROFILE_HELP, ProfileName, notices

if TYPE_CHECKING:
    from dh2urdf.robot import Robot


@dataclass(frozen=True, slots=True, kw_only=True)
class XacroOptions:
    """How a xacro is laid out."""

    single_file: bool = field(
        default=False, metadata={"help": "write the macro and its call into one file instead of two"}
    )
    profile: ProfileName = field(default="portable", metadata={"flag": "P", "help": PROFILE_HELP})


def emit(robot: Robot, stem: str, options: XacroOptions) -> tuple[EmittedFile, ...]:
    """The macro of a robot and the file that calls it; the latter comes first, for it is the one to open.

    Raises:
        EmitterError: XML cannot hold one of its names, a parameter's name is not one of a xacro property, or the robot
            lacks what URDF requires.
    """
    from dh2urdf_plugins.formats.xacro.writer import xacro_files

    return xacro_files(robot, stem, options.profile, single_file=options.single_file)


def one_file(options: XacroOptions) -> XacroOptions:
    """The options that write one file, for standard output."""
    return replace(options, single_file=True)


EMITTER = Emitter(
    name="xacro",
    summary="a xacro macro with the table as its properties, and a file that calls it",
    suffixes=(".urdf.xacro", ".xacro"),
    options=XacroOptions,
    emit=emit,
    capabilities=(
        ReadsBack(read_xacro, is_costly=True),
        ReadsForeign(foreign_xacro, has_macros=True),
        OtherFiles(other_endings=("_macro.xacro",), one_file=one_file),
        *checks("inspection:inspect_xacro", "whole_files:xacros"),
        GivesNotices(notices),
    ),
)
