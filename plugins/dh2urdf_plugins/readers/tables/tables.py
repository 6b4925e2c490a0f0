"""The manipulator that statements and rows make, or everything that is wrong with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.header.units import bare_beside_cells
from dh2urdf_plugins.readers.rows.joint_rows import settle
from dh2urdf_plugins.readers.rows.rows import MAX_PROBLEMS
from dh2urdf_plugins.readers.rows.six_parameters import extra_problems, with_four_parameters
from dh2urdf_plugins.readers.statements.plausibility import arm_length, size_notice
from dh2urdf_plugins.readers.words.bounds import MAX_JOINTS, MEASURABLE_ARM
from dh2urdf_plugins.readers.words.names import name_fault, name_problems

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.table_text import Trace
    from dh2urdf_plugins.readers.rows.rows import RowReader
    from dh2urdf_plugins.readers.statements.statements import Statements
    from dh2urdf_plugins.readers.words.cells import Cell


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
    add = reader.add
    if trace is not None:
        trace.rows, trace.table = tuple(reader.said or ()), statements.traced(name)
    if fault := name_fault(name.text):
        add(Problem(message=fault[0], mark=name.mark, field="name", found=name.text, accepted=fault[1]))
    if statements.convention is None and not any(problem.field == "convention" for problem in reader.problems):
        add(
            Problem(
                message="the table does not say which Denavit-Hartenberg convention it is written in, and that is "
                "never guessed",
                mark=mark,
                field="convention",
                accepted="standard (classic, distal): A = Rz(theta) Tz(d) Tx(a) Rx(alpha); modified (Craig, "
                "proximal): A = Rx(alpha) Tx(a) Rz(theta) Tz(d), where a row has a and alpha of the link before",
                suggestion="write `# convention: standard` above a CSV header, `convention: standard` in YAML, or "
                "give `--convention standard`",
            )
        )
    arm = [row for row in rows if row]
    if not rows:
        add(Problem(message="there are no joints: a manipulator has one row for each", mark=mark, field="joints"))
    for problem in _problems_of_all_rows(reader, statements):
        add(problem)
    if statements.calibration and arm and not reader.errors:
        arm = _calibrated(arm, statements, mark, add)
    _look_at_sizes(arm, statements, reader)
    problems = [problem.about(robot=name.text, mark=mark) for problem in sorted(reader.problems, key=_place)]
    if reader.errors:
        errors, notices = (
            tuple(problem for problem in problems if problem.severity == severity) for severity in ("error", "notice")
        )
        return Rejected(name=name.text, problems=errors, mark=mark, notices=notices)
    found = statements.manipulator(name.text, tuple(arm), mark, tuple(problems))
    if statements.in_convention is None:
        return _in_four_parameters(found, reader, trace)
    from dh2urdf_plugins.extraction.splitting import in_convention

    return in_convention(with_four_parameters(found, reader.extras), statements.in_convention)


def _problems_of_all_rows(reader: RowReader, statements: Statements) -> Iterator[Problem]:
    if reader.names:
        yield from name_problems(reader.names)
    if rounded := reader.rounded_angles():
        yield rounded
    yield from bare_beside_cells(reader.units, reader.foreign, reader.bare)
    yield from extra_problems(reader.extras, statements.convention and statements.convention[0])


def _in_four_parameters(given: Manipulator, reader: RowReader, trace: Trace | None) -> Manipulator:
    """A table of rows of six parameters as one of four, and what its cells say beside its new rows."""
    found = with_four_parameters(given, reader.extras)
    if trace is not None and found is not given:
        said = dict(zip([row.joint for row in given.rows], trace.rows, strict=True))
        trace.rows = tuple(said.get(row.joint, {}) for row in found.rows)
    return found


def _calibrated(rows: list[DHRow], statements: Statements, mark: Mark, add: Callable[[Problem], None]) -> list[DHRow]:
    """The rows with the differences of a calibration."""
    if statements.calibration is None or statements.convention is None:
        return rows
    try:
        calibration = statements.calibration.read(statements.convention[0])
        calibrated = calibration.applied(rows)
    except TableError as error:
        for problem in error.problems:
            add(problem)
        return rows
    given, found = (statements.manipulator("calibrated", tuple(arm), mark) for arm in (rows, calibrated))
    for notice in (*calibration.notices, calibration.notice(given, found)):
        add(notice)
    return calibrated


def _place(problem: Problem) -> tuple[bool, int, int]:
    mark = problem.mark
    elsewhere = mark is None or mark.line is None
    return elsewhere, (mark and mark.line) or 0, (mark and mark.column) or 0


def too_many_joints(count: int, mark: Mark) -> Problem:
    """What is wrong with a manipulator of more joints than are read."""
    return Problem(
        message=f"the manipulator has {count:,} joints",
        mark=mark,
        field="joints",
        accepted=f"at most {MAX_JOINTS:,} joints in one manipulator",
        suggestion="a table of several manipulators has a column robot",
    )


def _look_at_sizes(rows: Sequence[DHRow], statements: Statements, reader: RowReader) -> None:
    """Refuses an arm too long to be computed with, and notes what is hardly meant."""
    length = arm_length(rows)
    if length > MEASURABLE_ARM:
        longest = max(rows, key=lambda row: max(abs(row.a), abs(row.d)))
        field = "a" if abs(longest.a) >= abs(longest.d) else "d"
        reader.add(
            Problem(
                message=f"{field} is {getattr(longest, field):g} m, and the arm is {length:.4g} m long: positions on "
                "it cannot be computed to a micrometre",
                mark=longest.mark,
                joint=longest.joint,
                field=field,
                accepted=f"an arm of at most {MEASURABLE_ARM:g} m",
            )
        )
    if not reader.errors and (notice := size_notice(rows, reader.units, statements.base, statements.tool)):
        reader.add(notice)


def read_rows(rows: Sequence[tuple[dict[str, Cell] | None, Mark]], reader: RowReader) -> list[DHRow | None]:
    """The rows of a manipulator; None for each in which there is an error.

    Args:
        rows: the cells of each row by field, and its place; None where they cannot be told apart.
        reader: what reads them.
    """
    read: list[DHRow | None] = []
    for number, (cells, mark) in enumerate(rows, start=settle(rows, reader)):
        row = None if cells is None else reader.read(number, cells, mark)
        read.append(row)
        if stopped(reader):
            break
    return read


def stopped(reader: RowReader) -> bool:
    """Whether a manipulator has so many errors that reading it stops; reports that, then."""
    if reader.errors < MAX_PROBLEMS:
        return False
    reader.add(Problem(message=f"reading the manipulator stopped after {reader.errors} errors"))
    return True
