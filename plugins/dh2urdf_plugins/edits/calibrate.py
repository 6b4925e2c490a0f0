"""The edit ``calibrate``: differences between an arm and its data sheet, which are added to the rows of its table."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.errors import EditError, TableError
from dh2urdf.source import Messages
from dh2urdf.stages import Edit
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from dh2urdf.manipulator import Manipulator
    from dh2urdf_plugins.calibrations.calibration import CalibrationFile

say = Messages(__file__)


@dataclass(frozen=True, kw_only=True)
class CalibrateOptions:
    """The file of the differences."""

    file: Path | None = option(
        "calibration.conf of a UR, or a table of differences in a format of tables; required", None
    )
    length_unit: str | None = option(
        "unit of lengths that the table of differences does not declare; m by default", None
    )
    angle_unit: str | None = option(
        "unit of angles that the table of differences does not declare; rad by default", None
    )

    def __post_init__(self) -> None:
        if self.file is None:
            return
        from dh2urdf_plugins.calibrations.calibration import unreadable

        if problems := unreadable(self.file, "file"):
            raise TableError(replace(each, mark=None) for each in problems)

    @cached_property
    def calibration(self) -> CalibrationFile | None:
        """The file, which is read once for all arms of a process."""
        from dh2urdf_plugins.calibrations.calibration import CalibrationFile

        units = {"length_unit": self.length_unit, "angle_unit": self.angle_unit}
        return None if self.file is None else CalibrationFile(self.file, units)


def edit_table(manipulator: Manipulator, options: CalibrateOptions) -> Manipulator:
    """The manipulator with the differences in its rows, and a notice of how far they move its tip."""
    if options.calibration is None:
        raise EditError(say("calibrate-without-file", robot=manipulator.name, field="edits"))
    try:
        calibration = options.calibration.read(manipulator.convention)
        rows = calibration.applied(manipulator.rows)
    except TableError as error:
        raise EditError(problem.about(robot=manipulator.name) for problem in error.problems) from None
    calibrated = replace(manipulator, rows=tuple(rows))
    notices = (*calibration.notices, calibration.notice(manipulator, calibrated))
    return replace(calibrated, notices=(*manipulator.notices, *notices))


EDIT = Edit(
    name="calibrate",
    summary="differences between an arm and its data sheet, from calibration.conf of a UR or from a table",
    options=CalibrateOptions,
    edit_table=edit_table,
)
