"""Calls of the functions of stages that work at many manipulators at once, and what they gave, checked.

Whatever they raise, or give that is not what `dh2urdf.stages` says, is a `StageError` that names the plugin.
"""

from __future__ import annotations

from operator import index
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.columns import RobotColumns
from dh2urdf.plugin_system.calls import Call, blaming
from dh2urdf.plugin_system.stage_answers import a_record, emitted_files
from dh2urdf.robot import Robot

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.columns import ManipulatorColumns
    from dh2urdf.stages import EmittedFile, Emitter, Transform

T = TypeVar("T")


def transform_columns(
    call: Call[Transform[Any]], columns: ManipulatorColumns
) -> list[tuple[tuple[int, ...], RobotColumns]]:
    """The robots of many manipulators, in groups with the places of their members.

    Raises:
        ManipulatorError: the transform refuses them, or is at fault.
    """
    with blaming(call):
        groups = call.stage.transform_columns(columns, call.options)  # type: ignore[misc] # asked before
        return _groups(groups or (), len(columns), RobotColumns)


def emit_columns(
    call: Call[Emitter[Any]], robots: RobotColumns, stems: Sequence[str]
) -> list[tuple[EmittedFile, ...]] | None:
    """The files of many robots, none of those that have to be made one by one; None where that are all of them.

    Raises:
        ManipulatorError: the emitter refuses them, or is at fault.
    """
    with blaming(call):
        emitted = call.stage.emit_columns(robots, stems, call.options)  # type: ignore[misc] # asked before
        if emitted is None:
            return None
        files = [tuple(emitted_files(own)) for own in emitted]
        if len(files) != len(stems):
            raise ValueError(f"emit_columns gave the files of {len(files)} robots, not of {len(stems)}")
        return files


def read_columns(call: Call[Emitter[Any]], contents: Sequence[bytes]) -> list[tuple[tuple[int, ...], Robot]]:
    """The robots that many main files describe, in groups with the places of their members.

    Raises:
        ManipulatorError: the emitter is at fault.
    """
    with blaming(call):
        return _groups(call.stage.read_columns(contents), len(contents), Robot)  # type: ignore[misc] # asked before


def _groups(given: Sequence[Any], count: int, kind: type[T]) -> list[tuple[tuple[int, ...], T]]:
    """Raises a TypeError or ValueError where groups are not what they should be."""
    groups = [(tuple([index(member) for member in members]), a_record(made, kind)) for members, made in given]
    members = [member for own, _ in groups for member in own]
    if len(set(members)) < len(members) or not set(members) <= set(range(count)):
        raise ValueError(f"its groups are of the members {members!r:.60}, not of 0 to {count - 1}, each once at most")
    return groups
