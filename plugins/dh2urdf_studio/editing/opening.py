"""Opening a file: its manipulators as tables to edit, with the texts of their author where that is possible."""

from __future__ import annotations

import os
import tempfile
from contextlib import contextmanager
from dataclasses import fields, replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.errors import Dh2UrdfError, InputError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.run_file.config import RUN_SUFFIXES, is_run_file
from dh2urdf.source import Mark, Problem, listed, shown
from dh2urdf.stage_calls.answers import several_records
from dh2urdf.stage_calls.calls import blaming, default_call
from dh2urdf.stages import ReadsDescriptions, Rejected, WritesTables
from dh2urdf.table_text import FIELDS, TableText, table_text
from dh2urdf_studio.editing.reading import read_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stage_calls.calls import Call
    from dh2urdf.stages import Reader

MOST_NAMES = 5
"""Names that a notice has of manipulators that cannot be read."""


class Opened(NamedTuple):
    """A manipulator of a file.

    Attributes:
        table: it as a table to edit.
        lost: what else the file contains, which such a table has no place for: meshes, for one.
        notices: what the reader noticed of the file, and cannot notice of the table: an ignored column, for one.
    """

    table: TableText
    lost: tuple[str, ...] = ()
    notices: tuple[str, ...] = ()


def open_tables(
    path: Path, catalog: Catalog, most: int | None = None, *, wanted: str | None = None
) -> tuple[Opened, ...]:
    """The manipulators of a file that can be read; what is wrong with the others is among the notices.

    Their texts are those of the file where the reader tells them and they read as the same arm; else the texts of the
    numbers that were read. Tables that do not say their convention are opened as they stand, for a person to say it.

    Args:
        path: the file.
        catalog: the installed stages.
        most: how many manipulators are read; None reads all of them.
        wanted: the name of a manipulator that has to be among them, if the file has it.

    Raises:
        InputError: the file cannot be read, or none of its manipulators can, or not the one that is wanted.
    """
    if path.suffix.lower() in RUN_SUFFIXES and is_run_file(path):
        raise InputError(
            Problem(
                message="this is a run file, not a table",
                mark=Mark(file=str(path)),
                suggestion="open a table that it names; `dh2urdf view` shows its robots",
            )
        )
    reader = catalog.reader_for(path)
    items = list(islice(_items(path, default_call(catalog, reader)), most))
    arms = [item for item in items if isinstance(item, Manipulator)]
    rejected = [item for item in items if isinstance(item, Rejected)]
    typed = _typed(path, reader, catalog, most)
    if arms:
        if bad := [item for item in rejected if item.name == wanted]:
            raise InputError(bad[0].problems, bad[0].notices)
        return tuple(_with_notice_of(rejected, (_opened(arm, typed.get(arm.name), catalog) for arm in arms)))
    of_any = list(islice(_of_any_convention(path, default_call(catalog, reader), rejected), most))
    if arms := [item for item in of_any if isinstance(item, Manipulator)]:
        bad = [item for item in of_any if isinstance(item, Rejected)]
        opened = (_without_convention(_opened(arm, typed.get(arm.name), catalog)) for arm in arms)
        return tuple(_with_notice_of(bad, opened))
    if unsaid := [table for item in rejected if (table := _unsaid(item, typed.get(item.name), catalog))]:
        return tuple(map(Opened, unsaid))
    # A person chooses the convention on the page: where something else is wrong, its absence is not.
    rejected = [item for item in of_any if isinstance(item, Rejected)] or rejected
    raise InputError(
        [problem for item in rejected for problem in item.problems],
        [notice for item in rejected for notice in item.notices],
    )


def _with_notice_of(rejected: Sequence[Rejected], opened: Iterable[Opened]) -> Iterator[Opened]:
    """Opened manipulators with a notice of those in their file that cannot be read."""
    if not rejected:
        yield from opened
        return
    names = listed([shown(item.name)[1:-1] for item in rejected], MOST_NAMES)
    told = f"The file also has {names}, which cannot be read: {rejected[0].problems[0]}"
    yield from (each._replace(notices=(*each.notices, told)) for each in opened)


def _items(path: Path, call: Call[Reader[Any]]) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a file; of a description with several chains, of which none is the usual one, all of them."""
    try:
        yield from read_items(call, path)
    except InputError as error:
        if call.stage.can(ReadsDescriptions) is None or not any(
            problem.field == "tip_link" for problem in error.problems
        ):
            raise
        yield from read_items(replace(call, options=replace(call.options, tip_link="*")), path)


def tables_of(name: str, content: bytes, catalog: Catalog, most: int | None = None) -> tuple[Opened, ...] | str:
    """The tables of a file by its name and bytes, or what is wrong with it, without the folder that it was read in."""
    with given_file(name, content) as path:
        try:
            opened = open_tables(path, catalog, most)
        except Dh2UrdfError as error:
            return _without_folder(str(error), path)
        return tuple(
            each._replace(notices=tuple(_without_folder(notice, path) for notice in each.notices)) for each in opened
        )


@contextmanager
def given_file(name: str, content: bytes) -> Iterator[Path]:
    """A file that a browser sent, in a folder of its own, until the end of the block."""
    with tempfile.TemporaryDirectory(prefix="dh2urdf-") as folder:
        path = Path(folder) / Path(name).name
        path.write_bytes(content)
        yield path


def _without_folder(text: str, path: Path) -> str:
    return text.replace(f"{path.parent}{os.sep}", "")


def _typed(path: Path, reader: Reader[Any], catalog: Catalog, most: int | None) -> dict[str, TableText]:
    writes = reader.can(WritesTables)
    if writes is None or writes.texts is None:
        return {}
    try:
        with blaming(default_call(catalog, reader), "texts"):
            return {table.name: table for table in several_records(islice(writes.texts(path), most), TableText)}
    except InputError:  # It can be read, if not so: then its numbers are what there is.
        return {}


def _opened(arm: Manipulator, typed: TableText | None, catalog: Catalog) -> Opened:
    """A table as it was typed, names and types filled in, if that reads as the arm; else the texts of its numbers."""
    if typed is not None:
        completed = _completed(
            replace(typed, convention=typed.convention or arm.convention.value),
            [(row.joint, row.type.value) for row in arm.rows],
        )
        again = read_whole(completed, catalog).manipulator
        if again == arm:
            return Opened(completed, notices=_unseen(arm, again))
    table = table_text(_without_meshes(arm))
    again = read_whole(table, catalog).manipulator
    return Opened(table, tuple(_lost(arm, again)) if again else (), _unseen(arm, again))


def _unseen(arm: Manipulator, again: Manipulator | None) -> tuple[str, ...]:
    """What the reader noticed of an arm, and nobody would see on the page."""
    seen = {notice.message for notice in again.notices} if again else ()
    return tuple(str(notice) for notice in arm.notices if notice.message not in seen)


def _without_meshes(arm: Manipulator) -> Manipulator:
    """An arm without what the page does not show: it could not move a mesh along with the frames of a table."""
    rows = [replace(row, visual=None, collision=None) for row in arm.rows]
    meshes: dict[str, Any] = dict.fromkeys(("base_visual", "base_collision", "visuals", "collisions"))
    return replace(arm, rows=tuple(rows), **meshes)


def _unsaid(rejected: Rejected, typed: TableText | None, catalog: Catalog) -> TableText | None:
    """A table as it was typed that does not say its convention, if as much is wrong with it as with the file."""
    if typed is None or typed.convention or not typed.rows or not _is_unsaid(rejected):
        return None
    table = _completed(typed, [(f"joint_{number}", "revolute") for number in range(1, len(typed.rows) + 1)])
    return table if len(read_whole(table, catalog).errors) == len(rejected.problems) else None


def _of_any_convention(
    path: Path, call: Call[Reader[Any]], rejected: Sequence[Rejected]
) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a file that names no convention, where no table can hold its texts, or what else is wrong.

    Lengths of two units are an example. The numbers of a row are the same in both conventions.
    """
    if any(map(_is_unsaid, rejected)) and hasattr(call.options, "convention"):
        yield from _items(path, replace(call, options=replace(call.options, convention=Convention.STANDARD.value)))


def _is_unsaid(rejected: Rejected) -> bool:
    """Whether a table is rejected, among others, since it does not say its convention."""
    return any(problem.field == "convention" for problem in rejected.problems)


def _without_convention(opened: Opened) -> Opened:
    return opened._replace(table=replace(opened.table, convention=""))


def _completed(typed: TableText, joints: Iterable[tuple[str, str]]) -> TableText:
    """A table with the names and types of its joints, where it says none."""
    pairs = zip(joints, typed.rows, strict=False)
    rows = [{"joint": joint, "type": kind, **texts} for (joint, kind), texts in pairs]
    return replace(typed, rows=tuple({field: row[field] for field in FIELDS if field in row} for row in rows))


def _lost(arm: Manipulator, again: Manipulator) -> Iterator[str]:
    """What an arm says that is otherwise, or not there, when its table is read again."""
    yield from _different(replace(arm, rows=again.rows), again)
    for row, other in zip(arm.rows, again.rows, strict=True):
        yield from (f"{name} of {row.joint}" for name in _different(row, other))


def _different(one: Any, other: Any) -> Iterator[str]:  # noqa: ANN401 - two records of a kind
    names = (field.name for field in fields(one) if field.compare)
    return (name for name in names if getattr(one, name) != getattr(other, name))
