"""Differences that are added to the rows of a table, and how far they move the arm's tip.

A file of differences is a table in any table format, or `calibration.conf` of Universal Robots' controllers. That has
lines such as ``delta_a = [0.0001, 0.0038, …]``, a number for each joint, in m and rad, which are added to the rows of
the standard convention (ros-industrial/universal_robot#357).
"""

from __future__ import annotations

import math
import random
from contextlib import suppress
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.documents import LONG_PATH, check_file, decoded, read_bytes
from dh2urdf.errors import InputError, TableError
from dh2urdf.kinematics import forward_kinematics, position_error
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.quantities import is_zero
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, shown
from dh2urdf.stages import Reader, Traces
from dh2urdf.table_text import Trace

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

say = Messages(__file__)


FIELDS = {"a": "m", "alpha": "rad", "d": "m", "theta": "rad", "offset": ""}
"""The numbers of a row that a calibration changes, and their units; that of offset is that of the joint variable."""
FAR = 0.1  # how far a calibration moves the tip of an arm at most, as a part of the arm's reach
_VECTORS = 32


class Calibration(NamedTuple):
    """The differences of one arm: what is added to the numbers of each row, from the base outwards, with its place."""

    file: str  # where they come from
    differences: tuple[tuple[dict[str, float], Mark | None], ...]
    joints: tuple[str, ...] | None = None  # the names of the rows' joints; None where the order says which is meant
    of_moving_rows: bool = False  # whether they are those of the moving rows only, where the order says which is meant
    notices: tuple[Problem, ...] = ()  # what there is to report of the file

    def applied(self, rows: Sequence[DHRow]) -> list[DHRow]:
        """The rows with their differences."""
        names = [row.joint for row in rows if row.type is not JointType.FIXED or not self.of_moving_rows]
        joints = names if self.joints is None else self.joints
        if len(joints) != len(self.differences):
            what = "moving joints" if self.of_moving_rows else "joints"
            counts = {"count": str(len(self.differences)), "joints": str(len(names))}
            mark = Mark(file=self.file)
            raise TableError(say("calibration-of-other-count", mark, field="calibration", what=what, **counts))
        for joint, (_, place) in zip(joints, self.differences, strict=True):
            if joint not in names:
                about: dict[str, Any] = {"names": names[:20], "suggestion": did_you_mean(joint, names)}
                raise TableError(say("calibration-joint-unknown", place, field="joint", found=joint, **about))
        added = {joint: numbers for joint, (numbers, _) in zip(joints, self.differences, strict=True)}
        return [
            replace(row, **{name: getattr(row, name) + value for name, value in added[row.joint].items() if value})
            if row.joint in added
            else row
            for row in rows
        ]

    def notice(self, given: Manipulator, calibrated: Manipulator) -> Problem:
        """What the calibration changes: the largest difference of each number, and how far the tip moves."""
        largest = {name: max(abs(each.get(name, 0.0)) for each, _ in self.differences) for name in FIELDS}
        changes = [f"{name} by up to {value:.3g} {FIELDS[name]}".rstrip() for name, value in largest.items() if value]
        draw = random.Random(f"dh2urdf {len(given.actuated_rows)}")  # noqa: S311 - reproducible on purpose
        moved = reach = 0.0  # How far the tips are from each other, and the given one from its base, at most [m].
        for _ in range(_VECTORS):
            ranges = [
                (0.0, 1.0) if row.type is JointType.PRISMATIC else (-math.pi, math.pi) for row in given.actuated_rows
            ]
            q = [draw.uniform(*ends) for ends in ranges]
            here, there = forward_kinematics(given, q), forward_kinematics(calibrated, q)
            moved = max(moved, position_error(here, there))
            reach = max(reach, math.dist(here.translation, given.base.translation))
        return say(
            "calibration-moves-far" if moved > FAR * reach else "calibration-changes",
            Mark(file=self.file),
            field="calibration",
            file=self.file,
            changes=", ".join(changes) or "nothing",
            moved=1000 * moved,
        )


LISTS = {"delta_a": "a", "delta_alpha": "alpha", "delta_d": "d", "delta_theta": "theta"}
"""The lists that are read, and the numbers of a row that they belong to."""
LARGEST_CALIBRATION = 2**20  # size of the largest file that is read [B]: a real one has 2 kB
_LINEARISED = "2"
_EXAMPLE = "[0.0001, -0.2, 0, 0, 0, 0]"


def read_ur_conf(path: Path, convention: Convention) -> Calibration:
    """The differences of a `calibration.conf`, for a table of a convention."""
    file = str(path)
    if convention is not Convention.STANDARD:
        mark = Mark(file=file)
        raise TableError(say("calibration-convention", mark, field="convention", convention=str(convention)))
    entries = _entries(decoded(read_bytes(path, TableError, limit=LARGEST_CALIBRATION), file, TableError), file)
    lists: dict[str, list[float]] = {}
    for name, field in LISTS.items():
        if name not in entries:
            near = did_you_mean(name, entries.keys() - LISTS.keys())
            mark = Mark(file=file)
            raise TableError(say("calibration-list-missing", mark, field=name, example=_EXAMPLE, suggestion=near))
        text, mark = entries[name]
        lists[field] = _numbers(text)
        if not lists[field]:
            raise TableError(say("calibration-no-numbers", mark, field=name, found=text, example=_EXAMPLE))
        if (count := len(lists[field])) != len(lists["a"]):
            wanted = len(lists["a"])
            raise TableError(say("calibration-counts", mark, field=name, found=text, count=count, wanted=wanted))
    notices: tuple[Problem, ...] = ()
    if (status := entries.get("calibration_status")) and status[0] != _LINEARISED:
        text, mark = status
        notices = (say("calibration-status", mark, field="calibration_status", found=text),)
    rows = zip(*lists.values(), strict=True)
    differences = tuple((dict(zip(lists, row, strict=True)), entries["delta_a"][1]) for row in rows)
    return Calibration(file, differences, of_moving_rows=True, notices=notices)


def _entries(text: str, file: str) -> dict[str, tuple[str, Mark]]:
    """The keys of the file with their values; sections and comments are left out."""
    entries: dict[str, tuple[str, Mark]] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        content, mark = line.partition("#")[0].strip(), Mark(file=file, line=number)
        key, equals, value = (part.strip() for part in content.partition("="))
        if not content or (content[0] == "[" and content[-1] == "]"):
            continue
        if not equals:
            raise TableError(say("calibration-line-wrong", mark, field=content, found=content))
        if key in LISTS and key in entries:
            raise TableError(say("calibration-list-twice", mark, field=key, first=entries[key][1]))
        entries[key] = value, mark
    return entries


def _numbers(text: str) -> list[float]:
    """The finite numbers of a list; none of anything else."""
    try:
        numbers = [float(word) for word in text[1:-1].split(",")] if text[:1] + text[-1:] == "[]" else []
    except ValueError:
        return []
    return numbers if all(map(math.isfinite, numbers)) else []


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
    """A file of differences, which is read once for each convention of a table; `units` are those of bare numbers."""

    def __init__(self, path: Path, units: Mapping[str, Any]) -> None:
        self.path, self._units = path, units
        self._read: dict[Convention, Calibration] = {}

    def read(self, convention: Convention) -> Calibration:
        """The differences, for a table of a convention."""
        if convention not in self._read:
            is_conf = self.path.suffix.lower() == CONF
            self._read[convention] = read_ur_conf(self.path, convention) if is_conf else self._table(convention)
        return self._read[convention]

    def _table(self, convention: Convention) -> Calibration:
        """A table whose rows are differences."""
        reader, traces = self._reader()
        known = {each.name for each in fields(reader.options)}
        given = {"convention": str(convention), **self._units}
        options = reader.options(**{name: value for name, value in given.items() if name in known})
        trace, found = Trace(), []
        for item in traces.trace(self.path, options, trace):
            if not isinstance(item, Manipulator):
                raise TableError(item.problems)
            found.append((item, trace.rows))
        if len(found) != 1:
            file = Mark(file=str(self.path))
            raise TableError(say("calibration-of-several", file, field="calibration", count=len(found)))
        ((arm, cells),) = found
        usual = {each.name: each.default for each in fields(DHRow) if each.name not in _ALLOWED}
        for said, row in zip(cells, arm.rows, strict=False):
            others = [name for name in ("beta", "gamma", "b") if name in said and not is_zero(said[name].text or "")]
            others += [name for name, default in usual.items() if getattr(row, name) != default]
            for name in others:
                mark = said[name].mark if name in said else row.mark
                raise TableError(say("calibration-field-wrong", mark, field=name, fields=tuple(FIELDS)))
        return Calibration(
            file=str(self.path),
            differences=tuple(({name: getattr(row, name) for name in FIELDS}, row.mark) for row in arm.rows),
            joints=tuple(row.joint for row in arm.rows) if any("joint" in row for row in cells) else None,
        )

    def _reader(self) -> tuple[Reader[Any], Traces]:
        """The reader of tables by the file's suffix, and what reports the places of its cells."""
        catalog = load()
        with suppress(InputError):
            reader = catalog.reader_for(self.path)
            if (traces := reader.can(Traces)) is not None:
                return reader, traces
        stages = [provided.stage for provided in catalog.provided("reader")]
        able = [each for each in stages if isinstance(each, Reader) and each.can(Traces) is not None]
        suffixes = ", ".join(suffix for each in able for suffix in each.suffixes)
        about = {"name": self.path.name, "conf": CONF, "suffixes": suffixes}
        mark, found = Mark(file=str(self.path)), self.path.suffix or None
        raise TableError(say("calibration-of-no-format", mark, field="calibration", found=found, **about))
