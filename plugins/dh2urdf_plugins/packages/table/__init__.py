"""The stage ``table``: the DH tables of a robot. What writes and reads them is imported when it is called."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.stages import Emitter, GivesNotices, OtherFiles, ReadsBack
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.packages.table.options import SUFFIXES, TableOptions

if TYPE_CHECKING:
    from dh2urdf_plugins.packages.table.options import Format

_FILES = f"{__name__}.files"


def for_suffix(options: TableOptions, suffix: str) -> TableOptions:
    """The options that make a main file of what its suffix names."""
    named: Format = next((name for name, known in SUFFIXES.items() if known == suffix), "yaml")
    return replace(options, formats=(named, *(name for name in options.formats if name != named)))


def one_file(options: TableOptions) -> TableOptions:
    """The options that write the first format alone, for standard output."""
    return replace(options, formats=options.formats[:1])


EMITTER = Emitter(
    name="table",
    summary="the DH table: YAML, CSV, JSON, Markdown, LaTeX, and code for MATLAB and Robotics Toolbox for Python",
    suffixes=(*SUFFIXES.values(), ".yml"),
    options=TableOptions,
    emit=Late(f"{_FILES}:tables_of"),
    capabilities=(
        ReadsBack(Late(f"{__name__}.reader:read_table")),
        OtherFiles(one_file=one_file, for_suffix=for_suffix),
        GivesNotices(Late(f"{_FILES}:notices_of_tables")),
    ),
)
