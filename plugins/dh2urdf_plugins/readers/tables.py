"""The manipulator that statements and rows make, or everything that is wrong with it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.manipulator import DHRow, JointType, Manipulator
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.names import name_fault, name_problems
from dh2urdf_plugins.readers.rows import MAX_PROBLEMS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf_plugins.readers.cells import Cell
    from dh2urdf_plugins.readers.rows import RowReader
    from dh2urdf_plugins.readers.statements import Statements

MAX_JOINTS = 5000
"""Joints of one manipulator [1]: a hundred times those of the longest arms that are built, and made in seconds."""
LONGEST_ARM = 100.0
"""Length of an arm that a careful person would look at twice [m]."""
MEASURABLE_ARM = 1e9
"""Length of an arm beyond which a double cannot tell micrometres apart [m]."""
HEAVIEST_LINK = 1e5
"""Mass of a link that a careful person would look at twice [kg]."""


def manipulator(
    name: Cell,
    statements: Statements,
    rows: Sequence[DHRow | None],
    reader: RowReader,
    mark: Mark,
) -> Manipulator | Rejected:
    """The manipulator that statements and rows make, or everything that is wrong with it.

    Args:
        name: its name.
        statements: what holds for all rows.
        rows: the rows; None where there is an error in one.
        reader: what read the rows, with the problems so far.
        mark: the manipulator's place.
    """
    add = reader.add
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
    if reader.names:
        for problem in name_problems(reader.names):
            add(problem)
    if arm:
        for problem in _extents(arm, statements):
            add(problem)
    problems = [problem.about(robot=name.text, mark=mark) for problem in sorted(reader.problems, key=_place)]
    if reader.errors:
        return Rejected(
            name=name.text, problems=tuple(problem for problem in problems if problem.severity == "error"), mark=mark
        )
    return statements.manipulator(name.text, tuple(arm), mark, tuple(problems))


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


def arm_length(rows: Sequence[DHRow]) -> float:
    """The length of the stretched arm at q = 0 [m]."""
    return sum(abs(row.a) + abs(row.d) for row in rows)


def _extents(rows: Sequence[DHRow], statements: Statements) -> list[Problem]:
    length = arm_length(rows)
    problems = []
    if length > MEASURABLE_ARM:
        longest = max(rows, key=lambda row: max(abs(row.a), abs(row.d)))
        field = "a" if abs(longest.a) >= abs(longest.d) else "d"
        problems.append(
            Problem(
                message=f"{field} is {getattr(longest, field):g} m, and the arm is {length:.4g} m long: positions on "
                "it cannot be computed to a micrometre",
                mark=longest.mark,
                joint=longest.joint,
                field=field,
                accepted=f"an arm of at most {MEASURABLE_ARM:g} m",
            )
        )
    elif length > LONGEST_ARM:
        problems.append(
            Problem(
                message=f"the arm is {length:.4g} m long",
                severity="notice",
                mark=rows[0].mark,
                suggestion=None
                if statements.length
                else "if its lengths are in mm, declare it: `a [mm]`, `units: {length: mm}` or `--length-unit mm`",
            )
        )
    for row in rows:
        if row.com and math.hypot(*row.com) > max(length, 1.0):
            message = (
                f"the centre of mass is {math.hypot(*row.com):.4g} m from the joint's frame, and the whole arm is "
                f"{length:.4g} m long"
            )
            problems.append(_notice(row, "com", message))
        if row.mass and row.mass > HEAVIEST_LINK:
            problems.append(_notice(row, "mass", f"the link weighs {row.mass:.4g} kg"))
        if row.radius and row.radius > max(length, 1.0):
            problems.append(_notice(row, "radius", f"the link is {row.radius:.4g} m thick"))
        if (
            row.type is JointType.PRISMATIC
            and max(map(abs, (row.limits.lower or 0, row.limits.upper or 0))) > LONGEST_ARM
        ):
            problems.append(_notice(row, "lower", "the joint slides further than 100 m"))
    return problems


def _notice(row: DHRow, field: str, message: str) -> Problem:
    return Problem(
        message=message,
        severity="notice",
        mark=row.mark,
        joint=row.joint,
        field=field,
        suggestion="is it in another unit?",
    )


def stopped(reader: RowReader) -> bool:
    """Whether a manipulator has so many errors that reading it stops; says so, then."""
    if reader.errors < MAX_PROBLEMS:
        return False
    reader.add(Problem(message=f"reading the manipulator stopped after {reader.errors} errors"))
    return True
