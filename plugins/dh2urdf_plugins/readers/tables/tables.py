"""The manipulator that statements and rows make, or everything that is wrong with it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Messages, Problem
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.header.units import bare_beside_cells
from dh2urdf_plugins.readers.rows.six_parameters import extra_problems, with_four_parameters
from dh2urdf_plugins.readers.statements.plausibility import arm_length, size_notice
from dh2urdf_plugins.readers.words.bounds import MAX_JOINTS, MEASURABLE_ARM
from dh2urdf_plugins.readers.words.names import name_fault, name_problems

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.table_text import Trace
    from dh2urdf_plugins.readers.rows.rows import RowReader
    from dh2urdf_plugins.readers.statements.statements import Statements
    from dh2urdf_plugins.readers.words.cells import Cell

say = Messages(__file__)


def manipulator(
    name: Cell,
    statements: Statements,
    rows: Sequence[DHRow | None],
    reader: RowReader,
    mark: Mark,
    *,
    trace: Trace | None = None,
) -> Manipulator | Rejected:
    """The manipulator that statements and rows make, or everything that is wrong with it.

    Args:
        name: its name.
        statements: what holds for all rows.
        rows: the rows; None where there is an error in one.
        reader: what read the rows, with the problems so far.
        mark: the manipulator's place.
        trace: takes what the cells say, where it is wanted.
    """
    if trace is not None:
        trace.rows, trace.table = tuple(reader.said or ()), statements.traced(name)
    if fault := name_fault(name.text):
        reader.add(Problem(message=fault[0], mark=name.mark, field="name", found=name.text, accepted=fault[1]))
    if statements.convention is None and not any(problem.field == "convention" for problem in reader.problems):
        reader.add(say("convention-unsaid", mark, field="convention"))
    if not rows:
        reader.add(say("no-joints", mark, field="joints"))
    arm = [row for row in rows if row]
    for problem in _problems_of_all_rows(reader, statements):
        reader.add(problem)
    if statements.calibration and arm and not reader.errors:
        arm = _calibrated(arm, statements, mark, reader)
    _look_at_sizes(arm, statements, reader)
    problems = [problem.about(robot=name.text, mark=mark) for problem in sorted(reader.problems, key=_place)]
    if reader.errors:
        errors = tuple(problem for problem in problems if problem.severity == "error")
        notices = tuple(problem for problem in problems if problem.severity == "notice")
        return Rejected(name=name.text, problems=errors, mark=mark, notices=notices)
    given = statements.manipulator(name.text, tuple(arm), mark, tuple(problems))
    found = with_four_parameters(given, reader.extras)
    if statements.in_convention is not None:
        from dh2urdf_plugins.extraction.splitting import in_convention

        return in_convention(found, statements.in_convention)
    if trace is not None and found is not given:  # what cells say goes with the rows that they became
        said = dict(zip([row.joint for row in given.rows], trace.rows, strict=True))
        trace.rows = tuple(said.get(row.joint, {}) for row in found.rows)
    return found


def _problems_of_all_rows(reader: RowReader, statements: Statements) -> Iterator[Problem]:
    if reader.names:
        yield from name_problems(reader.names)
    if rounded := reader.rounded_angles():
        yield rounded
    yield from bare_beside_cells(reader.units, reader.foreign, reader.bare)
    yield from extra_problems(reader.extras, statements.convention and statements.convention[0])


def _calibrated(rows: list[DHRow], statements: Statements, mark: Mark, reader: RowReader) -> list[DHRow]:
    """The rows with the differences of a calibration."""
    if statements.calibration is None or statements.convention is None:
        return rows
    try:
        calibration = statements.calibration.read(statements.convention[0])
        calibrated = calibration.applied(rows)
    except TableError as error:
        for problem in error.problems:
            reader.add(problem)
        return rows
    given, found = (statements.manipulator("calibrated", tuple(arm), mark) for arm in (rows, calibrated))
    for notice in (*calibration.notices, calibration.notice(given, found)):
        reader.add(notice)
    return calibrated


def _place(problem: Problem) -> tuple[bool, int, int]:
    mark = problem.mark
    elsewhere = mark is None or mark.line is None
    return elsewhere, (mark and mark.line) or 0, (mark and mark.column) or 0


def _look_at_sizes(rows: Sequence[DHRow], statements: Statements, reader: RowReader) -> None:
    """Refuses an arm too long to be computed with, and notes what is hardly meant."""
    length = arm_length(rows)
    if length > MEASURABLE_ARM:
        row = max(rows, key=lambda row: max(abs(row.a), abs(row.d)))
        field, metres = ("a", row.a) if abs(row.a) >= abs(row.d) else ("d", row.d)
        sizes: dict[str, Any] = {"metres": f"{metres:g}", "length": f"{length:.4g}", "most": f"{MEASURABLE_ARM:g}"}
        reader.add(say("too-long", row.mark, joint=row.joint, field=field, **sizes))
    if not reader.errors and (notice := size_notice(rows, reader.units, statements.values)):
        reader.add(notice)


def too_many_joints(count: int, mark: Mark) -> Problem:
    """What is wrong with a manipulator of more joints than are read."""
    return say("too-many-joints", mark, field="joints", count=f"{count:,}", most=f"{MAX_JOINTS:,}")
