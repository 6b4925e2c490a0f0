"""Reads `calibration.conf` of Universal Robots' controllers: lists of differences to the rows of the data sheet.

The file has lines such as ``delta_a = [0.0001, 0.0038, …]``, a number for each joint, in m and rad. They are added to
the rows of the standard convention (ros-industrial/universal_robot#357).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.documents import decoded, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf_plugins.calibrations.calibration import Calibration, RowDifference

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

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
