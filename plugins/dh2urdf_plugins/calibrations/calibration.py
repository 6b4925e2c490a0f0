"""Differences that are added to the rows of a table, and how far they move the arm's tip.

Reads `calibration.conf` of Universal Robots' controllers: lists of differences to the rows of the data sheet. The file
has lines such as ``delta_a = [0.0001, 0.0038, …]``, a number for each joint, in m and rad. They are added to the rows
of the standard convention (ros-industrial/universal_robot#357).

The file of a calibration: `calibration.conf` of Universal Robots, or a table of differences in any table format.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

from dh2urdf.documents import LONG_PATH, check_file, decoded, read_bytes
from dh2urdf.errors import InputError, TableError
from dh2urdf.kinematics import forward_kinematics, position_error
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.provenance import Trace
from dh2urdf.quantities import is_zero
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf.stages import Reader, Traces

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.provenance import Said


FIELDS = {"a": "m", "alpha": "rad", "d": "m", "theta": "rad", "offset": ""}
"""The numbers of a row that a calibration changes, and their units; that of offset is that of the joint variable."""
FAR = 0.1
"""How far a calibration moves the tip of an arm at most, as a part of the arm's reach."""
_VECTORS = 32
_SLIDE = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RowDifference:
    """What is added to one row.

    Attributes:
        joint: name of the joint; None where the order of the rows says which is meant.
        a: [m].
        alpha: [rad].
        d: [m].
        theta: [rad].
        offset: [rad or m].
        mark: its place.
    """

    joint: str | None = None
    a: float = 0.0
    alpha: float = 0.0
    d: float = 0.0
    theta: float = 0.0
    offset: float = 0.0
    mark: Mark | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """The differences of one arm.

    Attributes:
        file: where they come from.
        differences: from the base outwards.
        of_moving_rows: whether they are those of the moving rows only, where the order says which is meant.
        notices: what there is to report of the file.
    """

    file: str
    differences: tuple[RowDifference, ...]
    of_moving_rows: bool = False
    notices: tuple[Problem, ...] = ()

    def applied(self, rows: Sequence[DHRow]) -> list[DHRow]:
        """The rows with their differences.

        Raises:
            TableError: a difference belongs to no row, or there is not one for each.
        """
        meant = dict(self._pairs(rows))
        return [_with(row, meant.get(row.joint)) for row in rows]

    def _pairs(self, rows: Sequence[DHRow]) -> Iterator[tuple[str, RowDifference]]:
        """The name of a joint with each difference."""
        names = [row.joint for row in rows if row.type is not JointType.FIXED or not self.of_moving_rows]
        if any(each.joint is None for each in self.differences):
            if len(names) != len(self.differences):
                what = "moving joints" if self.of_moving_rows else "joints"
                raise TableError(
                    Problem(
                        message=f"the calibration is of {len(self.differences)} {what}, and the table has {len(names)}",
                        mark=Mark(file=self.file),
                        field="calibration",
                        accepted="a difference for each joint, in the order of the table"
                        + ("" if self.of_moving_rows else ", or a column joint with the names of some"),
                    )
                )
            yield from zip(names, self.differences, strict=True)
            return
        for each in self.differences:
            joint = each.joint or ""
            if joint not in names:
                raise TableError(
                    Problem(
                        message=f"the calibration has a row for {shown(joint)}, which is no joint of the table",
                        mark=each.mark,
                        field="joint",
                        found=joint,
                        accepted=", ".join(names[:20]),
                        suggestion=did_you_mean(joint, names),
                    )
                )
            yield joint, each

    def notice(self, given: Manipulator, calibrated: Manipulator) -> Problem:
        """What the calibration changes: the largest difference of each number, and how far the tip moves."""
        largest = {name: max(abs(getattr(each, name)) for each in self.differences) for name in FIELDS}
        changes = [f"{name} by up to {value:.3g} {FIELDS[name]}".rstrip() for name, value in largest.items() if value]
        moved, reach = _moved(given, calibrated)
        odd = moved > FAR * reach
        return Problem(
            message=f"{shown(self.file, 200)} changes {', '.join(changes) or 'nothing'}: the tip moves by up to "
            f"{1000 * moved:.3g} mm",
            severity="notice",
            mark=Mark(file=self.file),
            field="calibration",
            suggestion="is it the calibration of this arm, in these units?" if odd else None,
        )


def _with(row: DHRow, difference: RowDifference | None) -> DHRow:
    if difference is None:
        return row
    changed = {name: getattr(row, name) + added for name in FIELDS if (added := getattr(difference, name))}
    return replace(row, **changed) if changed else row


def _moved(one: Manipulator, other: Manipulator) -> tuple[float, float]:
    """How far the tips of two arms are from each other, and the first from its base, at most [m]."""
    draw = random.Random(f"dh2urdf {len(one.moving_rows)}")  # noqa: S311 - reproducible on purpose
    moved = reach = 0.0
    for _ in range(_VECTORS):
        q = [
            draw.uniform(0.0, _SLIDE) if row.type is JointType.PRISMATIC else draw.uniform(-math.pi, math.pi)
            for row in one.moving_rows
        ]
        here, there = forward_kinematics(one, q), forward_kinematics(other, q)
        moved = max(moved, position_error(here, there))
        reach = max(reach, math.dist(here.translation, one.base.translation))
    return moved, reach


LISTS = {"delta_a": "a", "delta_alpha": "alpha", "delta_d": "d", "delta_theta": "theta"}
"""The lists that are read, and the numbers of a row that they belong to."""
LARGEST_CALIBRATION = 2**20
"""Size of the largest file that is read [B]: a real one has 2 kB."""
_LINEARISED = 2.0
_EXAMPLE = "[0.0001, -0.2, 0, 0, 0, 0]"


def read_ur_conf(path: Path, convention: Convention) -> Calibration:
    """The differences of a `calibration.conf`.

    Args:
        path: the file.
        convention: that of the table.

    Raises:
        TableError: the file cannot be read, a list is missing or wrong, or the table is of the other convention.
    """
    file = str(path)
    if convention is not Convention.STANDARD:
        raise TableError(
            Problem(
                message="the differences of a calibration.conf belong to rows of the standard convention, and the "
                f"convention of the table is {convention}",
                mark=Mark(file=file),
                field="convention",
                accepted="a table of the standard convention, such as that of the data sheet",
            )
        )
    entries = dict(_entries(decoded(read_bytes(path, TableError, limit=LARGEST_CALIBRATION), file, TableError), file))
    if missing := [name for name in LISTS if name not in entries]:
        raise TableError(
            Problem(
                message=f"the calibration does not have {', '.join(missing)}",
                mark=Mark(file=file),
                field=missing[0],
                accepted=f"{', '.join(f'{name} = {_EXAMPLE}' for name in missing[:1])}, a number for each joint",
                suggestion=did_you_mean(missing[0], entries.keys() - LISTS.keys()),
            )
        )
    lists = {field: _numbers(name, *entries[name]) for name, field in LISTS.items()}
    count = len(lists["a"])
    for name, field in LISTS.items():
        if len(lists[field]) != count:
            text, mark = entries[name]
            raise TableError(
                Problem(
                    message=f"{name} has {len(lists[field])} numbers, and delta_a has {count}",
                    mark=mark,
                    field=name,
                    found=text,
                    accepted="lists of one length: a number for each joint",
                )
            )
    return Calibration(
        file=file,
        differences=tuple(
            RowDifference(a=a, alpha=alpha, d=d, theta=theta, mark=entries["delta_a"][1])
            for a, alpha, d, theta in zip(*(lists[name] for name in ("a", "alpha", "d", "theta")), strict=True)
        ),
        of_moving_rows=True,
        notices=tuple(_status(entries)),
    )


def _entries(text: str, file: str) -> Iterator[tuple[str, tuple[str, Mark]]]:
    """The keys of the file with their values; sections and comments are left out.

    Raises:
        TableError: a line has no value, or a list is there twice.
    """
    seen: dict[str, Mark] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        content = line.partition("#")[0].strip()
        if not content or (content[0] == "[" and content[-1] == "]"):
            continue
        mark = Mark(file=file, line=number)
        key, equals, value = (part.strip() for part in content.partition("="))
        if not equals:
            message = f"{shown(content)} is no line of a calibration"
            raise TableError(Problem(message=message, mark=mark, found=content, accepted="`key = value`"))
        if key in LISTS and key in seen:
            message = f"{key} is given twice, the first time at {seen[key]}"
            raise TableError(Problem(message=message, mark=mark, field=key, accepted="each list once"))
        seen[key] = mark
        yield key, (value, mark)


def _numbers(name: str, text: str, mark: Mark) -> list[float]:
    words = text[1:-1].split(",") if text[:1] == "[" and text[-1:] == "]" else []
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    if not numbers or not all(map(math.isfinite, numbers)):
        raise TableError(
            Problem(
                message=f"{name} is no list of numbers",
                mark=mark,
                field=name,
                found=text,
                accepted=f"a finite number for each joint: `{name} = {_EXAMPLE}`",
            )
        )
    return numbers


def _status(entries: dict[str, tuple[str, Mark]]) -> Iterator[Problem]:
    """A notice of a file that the controller does not take for a finished calibration."""
    if (found := entries.get("calibration_status")) and found[0] != f"{_LINEARISED:.0f}":
        text, mark = found
        yield Problem(
            message=f"calibration_status is {text}: the controller does not use this calibration as it is",
            severity="notice",
            mark=mark,
            field="calibration_status",
            found=text,
            accepted="2, linearised",
        )


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
        traces = reader.can(Traces)
        if traces is None:
            raise TypeError(reader.name)
        found = []
        for item in traces.trace(self.path, options, trace):
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
        if reader is not None and reader.can(Traces) is not None:
            return reader
        stages = [provided.stage for provided in catalog.provided("reader")]
        able = [each for each in stages if isinstance(each, Reader) and each.can(Traces) is not None]
        suffixes = [suffix for each in able for suffix in each.suffixes]
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
