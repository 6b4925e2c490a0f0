"""The stage ``table``: the DH tables of a robot. What writes and reads them is imported when it is called."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from dh2urdf.stages import Emitter, GivesNotices, OtherFiles, ReadsBack
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.options import option

Format: TypeAlias = Literal["yaml", "csv", "markdown", "latex", "json", "matlab", "roboticstoolbox"]


@dataclass(frozen=True, slots=True, kw_only=True)
class TableOptions:
    """What the stage ``table`` writes."""

    formats: tuple[Format, ...] = option(
        "yaml, csv, markdown, latex, json, matlab (a rigidBodyTree) or roboticstoolbox (a DHRobot), "
        "the main file first. Without formats, the suffix of the file chooses, else yaml.",
        (),
    )
    length_unit: Literal["m", "cm", "mm"] = option(
        "Unit of lengths in yaml, csv, markdown and latex; the others are in m.", "m"
    )
    angle_unit: Literal["rad", "deg"] = option(
        "Unit of angles in yaml, csv, markdown and latex; the others are in rad.", "rad"
    )


SUFFIXES: dict[Format, str] = {
    "yaml": ".yaml",
    "csv": ".csv",
    "markdown": ".md",
    "latex": ".tex",
    "json": ".json",
    "matlab": ".m",
    "roboticstoolbox": ".py",
}
"""The suffix of the files of each format."""

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
        ReadsBack(Late(f"{__name__}.reader:read_table"), of_tables=True),
        OtherFiles(one_file=one_file, for_suffix=for_suffix),
        GivesNotices(Late(f"{_FILES}:notices_of_tables")),
    ),
)
