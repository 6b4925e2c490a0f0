"""The file of a calibration: `calibration.conf` of Universal Robots, or a table of differences in any table format."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from dh2urdf.documents import LONG_PATH, check_file
from dh2urdf.errors import InputError, TableError
from dh2urdf.manipulator import DHRow, Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.provenance import Trace
from dh2urdf.quantities import is_zero
from dh2urdf.source import Mark, Problem, shown
from dh2urdf.stages import Reader
from dh2urdf_plugins.calibrations.calibration import FIELDS, Calibration, RowDifference
from dh2urdf_plugins.calibrations.ur_conf import read_ur_conf

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from dh2urdf.manipulator import Convention
    from dh2urdf.provenance import Said

CONF = ".conf"
_ALLOWED = {"joint", "link", "type", "mark", *FIELDS}


def unreadable(path: Path, field: str) -> list[Problem]:
    """What keeps a file from being read, as what is wrong with the option that names it."""
    try:
        check_file(path)
    except InputError as error:
        name = shown(str(path), LONG_PATH)
        return [replace(each, message=f"{name}: {each.message}", field=field) for each in error.problems]
    return []


class CalibrationFile:
    """A file of differences, which is read once for each convention of a table."""

    def __init__(self, path: Path, units: Mapping[str, Any]) -> None:
        """Remembers the file.

        Args:
            path: the file.
            units: the units of numbers that name none, as options of a reader of tables.
        """
        self.path = path
        self._units = units
        self._read: dict[Convention, Calibration] = {}

    def read(self, convention: Convention) -> Calibration:
        """The differences.

        Args:
            convention: that of the table that they are added to.

        Raises:
            TableError: the file cannot be read, or holds something else.
        """
        if convention not in self._read:
            is_conf = self.path.suffix.lower() == CONF
            self._read[convention] = read_ur_conf(self.path, convention) if is_conf else self._table(convention)
        return self._read[convention]

    def _table(self, convention: Convention) -> Calibration:
        """A table whose rows are differences."""
        reader = self._reader()
        known = {each.name for each in fields(reader.options)}
        given = {"convention": str(convention), **self._units}
        options = reader.options(**{name: value for name, value in given.items() if name in known})
        trace, file = Trace(), str(self.path)
        if reader.trace is None:
            raise TypeError(reader.name)
        found = []
        for item in reader.trace(self.path, options, trace):
            if not isinstance(item, Manipulator):
                raise TableError(item.problems)
            found.append((item, trace.rows))
        if len(found) != 1:
            message = f"the calibration has {len(found)} manipulators"
            raise TableError(
                Problem(message=message, mark=Mark(file=file), field="calibration", accepted="the rows of one arm")
            )
        (arm, cells) = found[0]
        _refuse_six_parameters(cells)
        _refuse_others(arm)
        named = any("joint" in row for row in cells)
        return Calibration(
            file=file,
            differences=tuple(
                RowDifference(
                    joint=row.joint if named else None, **{name: getattr(row, name) for name in FIELDS}, mark=row.mark
                )
                for row in arm.rows
            ),
        )

    def _reader(self) -> Reader[Any]:
        """The reader of tables by the file's suffix.

        Raises:
            TableError: there is none.
        """
        catalog = load()
        try:
            reader = catalog.reader_for(self.path)
        except InputError:
            reader = None
        if reader is not None and reader.trace is not None:
            return reader
        stages = [provided.stage for provided in catalog.provided("reader")]
        suffixes = [suffix for each in stages if isinstance(each, Reader) and each.trace for suffix in each.suffixes]
        raise TableError(
            Problem(
                message=f"no calibration is known with the name {shown(self.path.name)}",
                mark=Mark(file=str(self.path)),
                field="calibration",
                found=self.path.suffix or None,
                accepted=f"{CONF} of Universal Robots, or a table of differences: {', '.join(suffixes)}",
            )
        )


def _refuse_six_parameters(cells: Iterable[Mapping[str, Said]]) -> None:
    """Refuses differences of what no row of a table has.

    Raises:
        TableError: a row has such a number.
    """
    for row in cells:
        for name in ("beta", "gamma", "b"):
            if name in row and not is_zero(row[name].text or ""):
                raise TableError(
                    Problem(
                        message=f"a row of differences has {name}, which no row of a table keeps",
                        mark=row[name].mark,
                        field=name,
                        found=row[name].text,
                        accepted=f"{', '.join(FIELDS)}, with joint to name the row",
                        suggestion=f"write {name} into the table itself: fixed rows are made of it there",
                    )
                )


def _refuse_others(arm: Manipulator) -> None:
    """Refuses a row of differences that has anything else.

    Raises:
        TableError: a row has a field that is no difference.
    """
    usual: dict[str, object] = {each.name: each.default for each in fields(DHRow) if each.name not in _ALLOWED}
    for row in arm.rows:
        for name, default in usual.items():
            if getattr(row, name) != default:
                raise TableError(
                    Problem(
                        message=f"a row of differences has {name}, which no calibration changes",
                        mark=row.mark,
                        joint=row.joint,
                        field=name,
                        accepted=f"{', '.join(FIELDS)}, with joint to name the row",
                    )
                )
