"""What the readers report about a table that is being typed: the manipulator, or a message for every wrong cell.

The table is written as a file and read by the reader of that format, so that the studio accepts what the command line
accepts, and has the same message for a wrong cell.
"""

from __future__ import annotations

import re
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.commands.choices import edit_calls
from dh2urdf.conversion.one_manipulator import in_format, read_items
from dh2urdf.conversion.robots import make_robot
from dh2urdf.errors import Dh2UrdfError, InputError, ManipulatorError
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system.calls import call_of, default_call
from dh2urdf.plugin_system.option_types import choices, type_hints
from dh2urdf.source import Mark, Messages, Problem, in_file_order
from dh2urdf.stages import Compares, Rejected
from dh2urdf.table_text import ANGLE_UNITS, FIELDS, LENGTH_UNITS, STATEMENTS, TableText, WrittenTable
from dh2urdf_studio.editing.edits import begun

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.plugin_system.calls import Call
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.robot import Robot
    from dh2urdf.stages import Edit, Transform

say = Messages(__file__)

STUDIO = Mark(file="dh2urdf studio")
_UNIT = re.compile(r"(?:length|angle)(?:-unit|:) ?(\w+)")
"""A unit in a reader's advice, which says how to declare it in a file or on the command line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CellProblem:
    """A problem of a reader's, and the cell that it is about."""

    problem: Problem
    row: int | None = None  # its number, counted from 0; None where it is about the whole table
    field: str | None = None  # or the attribute of `TableText`; None where it is about a whole row or table
    edit: int | None = None  # the number of the edit of the arm that it is about, counted from 0

    @property
    def text(self) -> str:
        """What is wrong and what to do, without the place in a file that nobody has seen."""
        if self.edit is not None:  # A file that an edit names is there.
            return str(self.problem)
        accepted = self.problem.accepted and f"accepted: {self.problem.accepted}"
        return "\n".join(filter(None, (self.problem.message, accepted, self.problem.suggestion)))

    def units(self, table: TableText) -> list[str]:
        """The units that are an answer: those that the reader asks about, and of a notice the table's own."""
        named = dict.fromkeys(_UNIT.findall(self.problem.suggestion or ""))
        for units, own in ((LENGTH_UNITS, table.length_unit), (ANGLE_UNITS, table.angle_unit)):
            if asked := [unit for unit in named if unit in units and unit != own]:
                return [*asked, own] if self.problem.severity == "notice" else asked
        return []


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """What a reader makes of a table."""

    table: TableText
    manipulator: Manipulator | None = None  # of the rows that have been begun; None where something is wrong with them
    problems: tuple[CellProblem, ...] = ()  # errors and notices, in the order of the table
    waiting: int = 0  # how many rows at the end nobody has begun to fill in

    @property
    def errors(self) -> tuple[CellProblem, ...]:
        """The problems that keep an arm from being made."""
        return tuple(found for found in self.problems if found.problem.severity == "error")

    @property
    def is_whole(self) -> bool:
        """Whether all rows are one arm."""
        return self.manipulator is not None and not self.waiting


def read(table: TableText, catalog: Catalog) -> Reading:
    """What the reader reports about a table, as far as its rows have been begun."""
    count = begun(table)
    if not count:
        return Reading(table=table, waiting=len(table.rows))
    reading = read_whole(replace(table, rows=table.rows[:count]), catalog)
    return replace(reading, table=table, waiting=len(table.rows) - count)


def read_whole(table: TableText, catalog: Catalog) -> Reading:
    """What the reader reports about all rows of a table."""
    reader = catalog.cell_reader()
    if blank := [number for number, row in enumerate(table.rows) if not row]:
        problems = [say("row-empty", number=number + 1) for number in blank]
        found = tuple(CellProblem(problem=each, row=row) for each, row in zip(problems, blank, strict=True))
        return Reading(table=table, problems=found)
    written = in_format([table], default_call(catalog, reader))
    with tempfile.TemporaryDirectory(prefix="dh2urdf-") as folder:
        path = Path(folder) / f"table{reader.suffixes[0]}"
        path.write_bytes(written.content)
        try:
            (item,) = read_items(default_call(catalog, reader), path)
        except InputError as error:
            item = Rejected(name=table.name, problems=error.problems, notices=error.notices)
    manipulator, errors = (item, ()) if isinstance(item, Manipulator) else (None, item.problems)
    said = (_without_path(problem, path, written) for problem in in_file_order((*item.notices, *errors)))
    found = tuple(_located(each, written, table) for each in said)
    return Reading(table=table, manipulator=manipulator, problems=found)


def _located(problem: Problem, written: WrittenTable, table: TableText) -> CellProblem:
    row, field = written.at(problem.mark)
    whole, _, part = (problem.field or "").partition(".")
    if whole in STATEMENTS:
        return CellProblem(problem=problem, field=whole)
    if row is None and problem.joint is not None:
        row = next((index for index, texts in enumerate(table.rows) if texts.get("joint") == problem.joint), None)
    said = part or whole  # `limits.lower` is the field lower
    return CellProblem(problem=problem, row=row, field=said if field is None and said in FIELDS else field)


def _without_path(problem: Problem, path: Path, written: WrittenTable) -> Problem:
    """A problem that speaks of rows, and not of lines of a file that nobody has seen."""
    pattern = re.compile(rf"{re.escape(str(path))}(?::(\d+))?(?::\d+)?")

    def said(match: re.Match[str]) -> str:
        row, _ = written.at(Mark(file=str(path), line=int(match[1]))) if match[1] else (None, None)
        return "the table" if row is None else f"row {row + 1}"

    names = ("message", "accepted", "suggestion")
    texts = {name: pattern.sub(said, text) for name in names if (text := getattr(problem, name))}
    return replace(problem, **texts)  # type: ignore[arg-type]  # all are texts


def make(
    manipulator: Manipulator,
    variant: str,
    table: TableText,
    catalog: Catalog,
    arm_edits: Sequence[Call[Edit[Any]]] = (),
) -> tuple[Robot | None, tuple[CellProblem, ...]]:
    """The robot of a manipulator as a variant of the transform makes it, edited; None, and why there is none."""
    try:
        return make_robot(manipulator, transform_call(catalog, variant), arm_edits), ()
    except Dh2UrdfError as error:
        if not arm_edits and not isinstance(error, ManipulatorError):
            raise
        problems = problems_of(error)
    if arm_edits:  # Where the ones before it go well, it is the last edit that fails.
        _, earlier = make(manipulator, variant, table, catalog, arm_edits[:-1])
        return None, earlier or tuple(_of_edit(len(arm_edits) - 1, each, manipulator.mark) for each in problems)
    written = in_format([table], default_call(catalog, catalog.cell_reader()))
    return None, tuple(_located(problem, written, table) for problem in problems)


def made_edits(
    texts: Sequence[str], catalog: Catalog, earlier: Mapping[str, Call[Edit[Any]]]
) -> tuple[dict[str, Call[Edit[Any]]], tuple[CellProblem, ...]]:
    """Some edits as `dh2urdf convert --edit` has them, by their texts, and what is wrong with the others.

    Those that were made earlier stay as they are: a file that one of them has read is not read again.
    """
    made, found = {}, list[CellProblem]()
    for number, text in enumerate(texts):
        try:
            made[text] = earlier.get(text) or edit_call(text, catalog)
        except Dh2UrdfError as error:
            found += [_of_edit(number, each, STUDIO) for each in problems_of(error)]
    return made, tuple(found)


def edit_call(text: str, catalog: Catalog) -> Call[Edit[Any]]:
    """An edit of the arm, given its text; an `InputError` where it is wrong."""
    (call,) = edit_calls([text], STUDIO, catalog)
    return call


def _of_edit(number: int, problem: Problem, nowhere: Mark | None) -> CellProblem:
    """A problem of an edit; what is in the table, or on the page, is in no file that a person knows."""
    is_there = problem.mark and problem.mark.file != (nowhere and nowhere.file)
    return CellProblem(problem=replace(problem, robot=None, mark=problem.mark if is_there else None), edit=number)


def problems_of(error: Dh2UrdfError) -> tuple[Problem, ...]:
    """What an error lists, or itself."""
    listed = error.problems if isinstance(error, (InputError, ManipulatorError)) else ()
    return listed or (Problem(message=str(error)),)


def variants(catalog: Catalog) -> tuple[str, ...]:
    """The variants of the usual transform that are shown side by side, the usual one first; one where it has no two."""
    stage = catalog.usual("transform")
    compares = stage.can(Compares)
    names = choices(type_hints(stage.options)[compares.option]) if compares else []
    return tuple(names[:2]) or (stage.name,)


def transform_call(catalog: Catalog, variant: str) -> Call[Transform[Any]]:
    """The transform with a variant, as the command line would call it."""
    stage = catalog.usual("transform")
    compares = stage.can(Compares)
    return call_of(catalog, stage, {compares.option: variant} if compares else {})
