"""Calls of the functions of stages that work at many manipulators at once, and what they gave, checked.

Whatever they raise, or give that is not what `dh2urdf.stages` says, is a `StageError` that names the plugin.
"""

from __future__ import annotations

from operator import attrgetter, index
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.columns import LIMITS, NUMBERS, ManipulatorColumns, RobotColumns, columns_of
from dh2urdf.plugin_system.calls import Call, a_record, blaming, emitted_files
from dh2urdf.robot import Robot
from dh2urdf.rotations import is_column
from dh2urdf.stages import EmitsInColumns, TransformsInColumns

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.columns import ManipulatorGroups
    from dh2urdf.manipulator import DHRow
    from dh2urdf.stages import EmittedFile, Emitter, Transform

T = TypeVar("T")


def transform_columns(
    call: Call[Transform[Any]], columns: ManipulatorColumns
) -> list[tuple[tuple[int, ...], RobotColumns]]:
    """The robots of many manipulators, in groups with the places of their members."""
    with blaming(call):
        groups = _able(call, TransformsInColumns).transform_columns(columns, call.options)
        return _groups(groups or (), len(columns), RobotColumns)


def emit_columns(
    call: Call[Emitter[Any]], robots: RobotColumns, stems: Sequence[str]
) -> list[tuple[EmittedFile, ...]] | None:
    """The files of many robots, none of those that have to be made one by one; None where that are all of them."""
    with blaming(call):
        emitted = _able(call, EmitsInColumns).emit_columns(robots, stems, call.options)
        if emitted is None:
            return None
        emitted = list(emitted)
        if len(emitted) != len(stems):
            raise ValueError(f"emit_columns gave the files of {len(emitted)} robots, not of {len(stems)}")
        return [tuple(emitted_files(own, stem)) for own, stem in zip(emitted, stems, strict=True)]


def read_columns(call: Call[Emitter[Any]], contents: Sequence[bytes]) -> list[tuple[tuple[int, ...], Robot]]:
    """The robots that many main files describe, in groups with the places of their members."""
    with blaming(call):
        return _groups(_able(call, EmitsInColumns).read_columns(contents), len(contents), Robot)


def _able(call: Call[Any], capability: type[Any]) -> Any:  # noqa: ANN401 - a capability
    """The capability of a stage that was asked for it before."""
    return call.stage.can(capability)


def _groups(given: Sequence[Any], count: int, kind: type[T]) -> list[tuple[tuple[int, ...], T]]:
    """Raises a TypeError or ValueError where groups are not what they should be."""
    groups = [(tuple([index(member) for member in members]), a_record(made, kind)) for members, made in given]
    members = [member for own, _ in groups for member in own]
    if len(set(members)) < len(members) or not set(members) <= set(range(count)):
        raise ValueError(f"its groups are of the members {members!r:.60}, not of 0 to {count - 1}, each once at most")
    return [group for group in groups if group[0]]


def checked_groups(groups: ManipulatorGroups) -> ManipulatorGroups:
    """What a reader gave, compared with the description of `ManipulatorGroups`.

    Raises:
        ValueError: places are missing or not in order, or columns are not of the members of their group.
    """
    count = len(groups)
    found = _groups(groups.groups, count, ManipulatorColumns)
    if not count or sum([len(places) for places, _ in found]) < count:
        raise ValueError(f"its groups are not of the members 0 to {count - 1}, each once")
    for places, some in found:
        if list(places) != sorted(places) or any(
            len(part) != len(places) for part in (some.names, some.marks, some.lines)
        ):
            raise ValueError(
                f"a group of {len(places)} members has other names, marks or lines, or is in another order"
            )
        for numbers in _columns_of_rows(some.table.rows):
            if numbers.shape != (len(places),):
                raise ValueError(f"a column of a group of {len(places)} members has the shape {numbers.shape}")
    return groups


_numbers_of = attrgetter(*NUMBERS, *(f"limits.{name}" for name in LIMITS))


def _columns_of_rows(rows: Sequence[DHRow]) -> Iterator[Any]:
    """The columns among the numbers of rows: what `columns_of` finds, in a tenth of the time."""
    for row in rows:
        yield from filter(is_column, _numbers_of(row))
        if row.com is not None or row.inertia is not None:
            yield from columns_of((row.com, row.inertia))
