"""The table of a manipulator as a file, which is read back before anybody gets it: the same arm to the last bit."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.errors import InputError, RecordValueError
from dh2urdf.output.spooled import spooled
from dh2urdf.output.whole_files import write_whole
from dh2urdf.plugin_system.calls import Call, blaming, default_call
from dh2urdf.plugin_system.catalog import load
from dh2urdf.plugin_system.stage_answers import a_whole_record
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import Rejected
from dh2urdf.table_text import WrittenTable, table_text

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Reader
    from dh2urdf.table_text import TableText


def in_format(table: TableText, call: Call[Reader[Any]]) -> WrittenTable:
    """A table as a file in the format of a reader.

    Raises:
        InputError: the reader only reads.
        StageError: the reader is at fault.
    """
    if call.stage.write is None:
        raise InputError(
            Problem(message=f"the reader {call.stage.name!r} does not write tables", found=call.stage.name)
        )
    with blaming(call, "write"):
        return a_whole_record(call.stage.write(table), WrittenTable)


def write_table(manipulator: Manipulator, format_name: str, out: str | os.PathLike[str] | None, function: str) -> str:
    """The table of a manipulator in the format of a reader.

    Args:
        manipulator: the arm.
        format_name: name of the reader.
        out: the file to write; None writes none.
        function: what was called, for messages.

    Returns:
        The table, as text.

    Raises:
        RecordValueError: the format has no place for something that the manipulator says.
        OutputError: the file cannot be written.
    """
    catalog = load()
    reader: Reader[Any] = catalog.get("reader", format_name)
    call = default_call(catalog, reader)
    content = in_format(table_text(manipulator), call).content
    with spooled(content, function, reader.suffixes[0]) as path:
        (again,) = read_items(call, path)
    if isinstance(again, Rejected):
        raise RecordValueError(again.problems)
    if again != manipulator:
        raise RecordValueError(
            Problem(
                message=f"a table as {format_name} cannot say this as it is",
                mark=Mark(file=function),
                robot=manipulator.name,
                field=place,
                found=str(value),
            )
            for place, value in _different(manipulator, again, "")
        )
    if out is not None:
        write_whole(Path(out), content)
    return content.decode()


def _different(given: Any, again: Any, place: str) -> Iterator[tuple[str, Any]]:  # noqa: ANN401 - records and their parts
    """The places in which two records differ, and what the first has there."""
    if given == again:
        return
    if is_dataclass(given) and type(given) is type(again):
        for field in fields(given):
            if field.compare:
                inner = f"{place}.{field.name}" if place else field.name
                yield from _different(getattr(given, field.name), getattr(again, field.name), inner)
    elif type(given) is tuple and type(again) is tuple and len(given) == len(again):
        for number, (left, right) in enumerate(zip(given, again, strict=True)):
            yield from _different(left, right, f"{place}[{number}]")
    else:
        yield place, given
