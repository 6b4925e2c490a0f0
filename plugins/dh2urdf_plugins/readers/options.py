"""The options of readers of tables: those that all have, and those of workbooks."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.errors import TableError
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from dh2urdf.source import Problem


@dataclass(frozen=True, slots=True, kw_only=True)
class TableOptions:
    """What a table does not say itself; what it does say must not contradict it."""

    convention: str | None = option("standard (classic, distal) or modified (Craig, proximal)", None, flag="C")
    length_unit: str | None = option("unit of lengths: m, cm, mm, in …; m by default", None, flag="UNIT")
    angle_unit: str | None = option("unit of angles: rad or deg; rad by default", None, flag="UNIT")
    units: str | dict[str, Any] | list[Any] | None = option(
        "units by what they measure: {length: mm, angle: deg, inertia: kg·mm²}", None, flag="YAML"
    )
    base: str | dict[str, Any] | list[Any] | None = option(
        "transform from base_link to the first DH frame: {xyz: [0, 0, 0.3], rpy: …}", None, flag="YAML"
    )
    tool: str | dict[str, Any] | list[Any] | None = option(
        "transform from the last DH frame to tool0: {xyz: [0, 0, 0.1], rpy: …}", None, flag="YAML"
    )
    payload: str | dict[str, Any] | None = option(
        "what the arm carries at tool0: {mass: 2.5, com: [0, 0, 0.05], inertia: …}", None, flag="YAML"
    )
    symbol: str | dict[str, Any] | list[Any] | None = option(
        "what a name in cells stands for, such as L1=91mm; repeatable", None, flag="NAME=LENGTH", repeatable=True
    )
    ignore: str | list[Any] | None = option(
        "a column that is left out; repeatable", None, flag="COLUMN", repeatable=True
    )
    rounded_pi: Literal["keep", "repair"] = option("repair reads 1.5708 in an angle as pi/2", "keep", flag="R")
    in_convention: Literal["standard", "modified"] | None = option(
        "the same arm in this convention, with other rows: standard or modified", None
    )
    calibration: Path | None = option(
        "differences that are added to the rows: a calibration.conf, or a table", None, flag="FILE"
    )
    columns: str | list[Any] | None = option(
        "the columns of a table without a header, in their order: theta,d,a,alpha", None, flag="NAMES"
    )
    table_number: int | None = option("which of several tables in one file is read, counted from 1", None, flag="N")
    mesh_links: bool = option("whether meshes may be links out of the table's folder, such as to shared ones", False)

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

    sheet: str | None = option("title of the sheet to read; every sheet with a table by default", None)


def ignored_columns(options: TableOptions) -> frozenset[str]:
    """The headers of the columns that are left out."""
    given = options.ignore if isinstance(options.ignore, list) else [options.ignore]
    return frozenset(str(header).strip() for header in given if header is not None)


def given_by(options: TableOptions) -> dict[str, Any]:
    """What the options say, by their names."""
    return {each.name: getattr(options, each.name) for each in fields(options)}
