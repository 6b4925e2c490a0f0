"""The stage ``xacro``: macros over a table. What writes and reads them is imported when it is called."""

from __future__ import annotations

from dataclasses import dataclass, replace

from dh2urdf.stages import Emitter, GivesNotices, OtherFiles, ReadsBack, ReadsForeign
from dh2urdf_plugins.formats import checks, foreign_xacro, read_xacro
from dh2urdf_plugins.formats.urdf import PROFILE_HELP, VERSION_HELP, ProfileName, UrdfVersion, notices
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.options import option


@dataclass(frozen=True, slots=True, kw_only=True)
class XacroOptions:
    """How a xacro is laid out."""

    single_file: bool = option("write the macro and its call into one file instead of two", False)
    profile: ProfileName = option(PROFILE_HELP, "portable", flag="P")
    version: UrdfVersion = option(VERSION_HELP, "1.0")


def one_file(options: XacroOptions) -> XacroOptions:
    """The options that write one file, for standard output."""
    return replace(options, single_file=True)


EMITTER = Emitter(
    name="xacro",
    summary="a xacro macro with the table as its properties, and a file that calls it",
    suffixes=(".urdf.xacro", ".xacro"),
    options=XacroOptions,
    emit=Late(f"{__name__}.writer:xacro_files"),
    capabilities=(
        ReadsBack(read_xacro, is_costly=True, floats_by_root=True),
        ReadsForeign(foreign_xacro, has_macros=True, can_attach=True),
        OtherFiles(other_endings=("_macro.xacro", "_parts.xacro"), one_file=one_file),
        *checks("inspection:inspect_xacro", "files:xacros"),
        GivesNotices(notices),
    ),
)
