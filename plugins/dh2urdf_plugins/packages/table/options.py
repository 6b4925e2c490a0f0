"""What the stage ``table`` writes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

Format: TypeAlias = Literal["yaml", "csv", "markdown", "latex", "json", "matlab", "roboticstoolbox"]


@dataclass(frozen=True, slots=True, kw_only=True)
class TableOptions:
    """What the stage ``table`` writes."""

    formats: tuple[Format, ...] = field(
        default=(),
        metadata={
            "help": "yaml, csv, markdown, latex, json, matlab (a rigidBodyTree) or roboticstoolbox (a DHRobot), "
            "the main file first. Without formats, the suffix of the file chooses, else yaml."
        },
    )
    length_unit: Literal["m", "cm", "mm"] = field(
        default="m", metadata={"help": "Unit of lengths in yaml, csv, markdown and latex; the others are in m."}
    )
    angle_unit: Literal["rad", "deg"] = field(
        default="rad", metadata={"help": "Unit of angles in yaml, csv, markdown and latex; the others are in rad."}
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
