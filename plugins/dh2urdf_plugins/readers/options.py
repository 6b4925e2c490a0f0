"""The options of readers of tables: those that all have, and those of workbooks."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.errors import TableError

if TYPE_CHECKING:
    from dh2urdf.source import Problem


def _flag(value: str, text: str, *, repeatable: bool = False) -> Any:  # noqa: ANN401 - what dataclasses take for a default
    return field(default=None, metadata={"flag": value, "help": text, "repeatable": repeatable})


@dataclass(frozen=True, slots=True, kw_only=True)
class TableOptions:
    """What a table does not say itself; what it does say must not contradict it."""

    convention: str | None = _flag("C", "standard (classic, distal) or modified (Craig, proximal)")
    length_unit: str | None = _flag("UNIT", "unit of lengths: m, cm, mm, in …; m by default")
    angle_unit: str | None = _flag("UNIT", "unit of angles: rad or deg; rad by default")
    units: str | dict[str, Any] | list[Any] | None = _flag(
        "YAML", "units by what they measure: {length: mm, angle: deg, inertia: kg·mm²}"
    )
    base: str | dict[str, Any] | list[Any] | None = _flag(
        "YAML", "transform from base_link to the first DH frame: {xyz: [0, 0, 0.3], rpy: …}"
    )
    tool: str | dict[str, Any] | list[Any] | None = _flag(
        "YAML", "transform from the last DH frame to tool0: {xyz: [0, 0, 0.1], rpy: …}"
    )
    payload: str | dict[str, Any] | None = _flag(
        "YAML", "what the arm carries at tool0: {mass: 2.5, com: [0, 0, 0.05], inertia: …}"
    )
    symbol: str | dict[str, Any] | list[Any] | None = _flag(
        "NAME=LENGTH", "what a name in cells stands for, such as L1=91mm; repeatable", repeatable=True
    )
    ignore: str | list[Any] | None = _flag("COLUMN", "a column that is left out; repeatable", repeatable=True)
    rounded_pi: Literal["keep", "repair"] = field(
        default="keep", metadata={"flag": "R", "help": "repair reads 1.5708 in an angle as pi/2"}
    )
    in_convention: Literal["standard", "modified"] | None = field(
        default=None, metadata={"help": "the same arm in this convention, with other rows: standard or modified"}
    )
    calibration: Path | None = _flag("FILE", "differences that are added to the rows: a calibration.conf, or a table")
    columns: str | list[Any] | None = _flag(
        "NAMES", "the columns of a table without a header, in their order: theta,d,a,alpha"
    )
    table_number: int | None = _flag("N", "which of several tables in one file is read, counted from 1")
    mesh_links: bool = field(
        default=False,
        metadata={"help": "whether meshes may be links out of the table's folder, such as to shared ones"},
    )

    @property
    def column_names(self) -> list[str]:
        """What `columns` names, one by one."""
        given = self.columns.split(",") if isinstance(self.columns, str) else self.columns or []
        return [str(name).strip() for name in given]

    def __post_init__(self) -> None:
        """Refuses words that mean nothing in any table, and a calibration that is no file.

        Raises:
            TableError: the convention or a unit is unknown, or there is no such file; the caller knows its place.
        """
        from dh2urdf_plugins.readers.statements.statements import Statements

        problems: list[Problem] = []
        if self.calibration is not None:
            from dh2urdf_plugins.calibrations.calibration import unreadable

            problems += unreadable(self.calibration, "calibration")
        Statements().declare_options(given_by(self), problems.append)
        if problems:
            names = {"units.length": "length_unit", "units.angle": "angle_unit"}
            raise TableError(
                replace(problem, mark=None, field=names.get(problem.field or "", problem.field)) for problem in problems
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class XlsxOptions(TableOptions):
    """What a workbook does not say itself."""

    sheet: str | None = field(
        default=None, metadata={"help": "title of the sheet to read; every sheet with a table by default"}
    )


def ignored_columns(options: TableOptions) -> frozenset[str]:
    """The headers of the columns that are left out."""
    given = options.ignore if isinstance(options.ignore, list) else [options.ignore]
    return frozenset(str(header).strip() for header in given if header is not None)


def given_by(options: TableOptions) -> dict[str, Any]:
    """What the options say, by their names."""
    return {each.name: getattr(options, each.name) for each in fields(options)}
