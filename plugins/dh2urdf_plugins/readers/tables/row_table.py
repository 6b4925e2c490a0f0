"""A table with one row per joint, one manipulator or a million behind each other: the same for every file of rows.

The file is never held as a whole: its rows come in batches, and the rows of one manipulator are read together, by
`plain.rows` where nothing about them is remarkable, and with all care where something is. A sample of the former is
read in both ways, and compared.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from functools import cached_property
from itertools import groupby
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import ManipulatorColumns, ManipulatorGroups
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.output import NameSet
from dh2urdf.quantities import UNITS, Dimension
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf.stages import Rejected
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.readers.comments.declared import declare, declare_types
from dh2urdf_plugins.readers.header.columns import Row, Rows
from dh2urdf_plugins.readers.header.header_rows import unit_in
from dh2urdf_plugins.readers.header.units import unit_problems
from dh2urdf_plugins.readers.options import given_by
from dh2urdf_plugins.readers.rows.cells import CellReader
from dh2urdf_plugins.readers.rows.rows import MAX_PROBLEMS, Cells, JointRows, RowReader
from dh2urdf_plugins.readers.rows.six_parameters import with_four_parameters
from dh2urdf_plugins.readers.statements.statements import KINDS, Statements
from dh2urdf_plugins.readers.words.bounds import LONGEST_ARM, MAX_JOINTS, MEASURABLE_ARM, SHORTEST_ARM
from dh2urdf_plugins.readers.words.cells import SPACES, Cell, text_of
from dh2urdf_plugins.readers.words.names import MAX_NAME

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.documents import Node
    from dh2urdf.table_text import Trace
    from dh2urdf_plugins.readers.comments.top import Top
    from dh2urdf_plugins.readers.options import TableOptions
    from dh2urdf_plugins.readers.plain.rows import PlainRows
    from dh2urdf_plugins.readers.tables.cell_rows import CellRows
    from dh2urdf_plugins.readers.words.comment_lines import Comment

_USUAL = (0.2, 3.0)
"""Reach of the arms that people build [m]."""
_NEARLY_PARALLEL = 0.01
"""Angle between the axes of neighbours that a calibration finds where the drawing has parallel ones [rad]."""
say = Messages(__file__)


class RowTable:
    """One file that is being read; with a trace, or as one manipulator, which is a record, it is read with care."""

    def __init__(
        self,
        name: Cell,
        options: TableOptions,
        top: Top,
        source: CellRows,
        trace: Trace | None = None,
        *,
        one: bool = False,
    ) -> None:
        self.whole, self.one, self.source, self.trace = name.mark, one, source, trace
        self.columns = columns = source.start(top.columns)
        self.statements, self.sentences, self.seen = Statements(), top.sentences, NameSet()
        self._define(top.comments, top.statements.get("symbols"))
        self.notices: list[Problem] = []
        self.name = self._state(top.statements, options) or name
        self.units = self.statements.units()
        place = {name: index for index, name in enumerate(columns.fields) if name}
        self.robot_column, self.convention_column = place.get("robot"), place.get("convention")
        self.has_type = "type" in place
        self.with_care = one or (trace, options.calibration, options.in_convention) != (None,) * 3

    @cached_property
    def plain(self) -> PlainRows:
        """What reads rows fast; most tables of one manipulator are read with care, and never import it."""
        from dh2urdf_plugins.readers.plain.rows import PlainRows

        return PlainRows(self.columns, self.units, self._careful)

    def _define(self, comments: list[Comment], said: Node | None = None) -> None:
        """Takes the names for lengths that a statement and comments define, and forgets the comments."""
        symbols, problems = self.statements.symbols, list[Problem]()
        if said:
            self.statements.declare_symbols(said, problems.append)
        for note in comments:
            problems += symbols.take_line(note.line, note.whole, decimal_comma=self.columns.decimal_comma)
        comments.clear()
        if problems:
            raise TableError(problems)

    def _state(self, said: Mapping[str, Node], options: TableOptions) -> Cell | None:
        """Reads what table, headers and options declare about all rows; returns the name in the table."""
        columns, statements, problems = self.columns, self.statements, list[Problem]()
        given, add = given_by(options), problems.append
        if units := said.get("units"):
            statements.declare_units(units, add)
        if convention := said.get("convention"):
            statements.declare_convention(Cell(convention.text or "", convention.mark), add)
        if columns.modified is not None:
            header = Cell(columns.headers[columns.modified], columns.mark)
            statements.declare_implied_convention(Convention.MODIFIED, header, add)
        statements.declare_options(given, add)
        problems += unit_problems(columns, statements.stated.values())
        statements.columns = columns
        declare(self.sentences, statements, add, by_row="convention" in columns.fields)
        for what in KINDS:
            if node := said.get(what):
                statements.declare(what, node, add)
        statements.declare_option_transforms(given, add)
        errors = [problem for problem in problems if problem.severity == "error"]
        self.notices += (problem for problem in problems if problem.severity == "notice")
        if errors:
            raise TableError(errors, self.notices)
        name = said.get("name")
        return Cell("" if name.value is None else name.text or "", name.mark) if name else None

    # --- Manipulators -------------------------------------------------------------------------------------------------

    def manipulators(self) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
        """Reads all rows; what is read fast comes in columns."""
        any_rows = False
        for groups in self._groups():
            self._define(self.source.below)
            # The first one has the notices of the file, and that of columns that are left out.
            while groups and (self.notices or self.with_care or (self.columns.silent and not any_rows)):
                yield self._careful(groups.pop(0))
                any_rows = True
            any_rows |= bool(groups)
            yield from self._any(groups)
        if not any_rows:
            yield self._careful(Rows(self.name.text))

    def _groups(self) -> Iterator[list[Rows]]:
        """The rows of manipulators that are complete, batch by batch."""
        rows = Rows(self.name.text)
        for keys, batch in self.source.batches():
            finished, start = list[Rows](), 0
            for value, some in groupby(batch, self._robot_of):
                name, cells = text_of(value).strip(SPACES), list(some)
                if not name and rows.keys:  # a cell that a spreadsheet has merged with the one above, perhaps
                    rows.nameless = True
                elif name != rows.name and rows.keys:
                    finished.append(rows)
                    rows = Rows(name)
                rows.name = name or rows.name if rows.keys else name
                room = max(0, MAX_JOINTS - len(rows.cells))  # as many as are needed to see that there are too many
                rows.keys += keys[start : start + min(room, len(cells))]
                rows.cells += cells[:room]
                rows.count += len(cells)
                start += len(cells)
            yield self._torn(finished, rows)
        yield self._torn([rows])

    def _robot_of(self, cells: Row) -> Any:  # noqa: ANN401 - a text, or a number
        """What names the manipulator of a row; one that is too short is refused later, and until then has no name."""
        column = self.robot_column
        return self.name.text if column is None else cells[column] if len(cells) > column else ""

    def _torn(self, groups: list[Rows], *unfinished: Rows) -> list[Rows]:
        """Marks the manipulators whose rows do not all stand together, as far as a batch shows it in time."""
        groups = [rows for rows in groups if rows.keys]
        count = Counter(rows.name for rows in (*groups, *unfinished))
        names = [rows.name for rows in groups if self.robot_column is not None]
        known = self.seen.known(names)
        for rows in groups if names else ():
            rows.torn = count[rows.name] > 1 or rows.name in known
        self.seen.add(names)
        return groups

    # --- The fast way -------------------------------------------------------------------------------------------------

    def _any(self, groups: list[Rows]) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
        """Reads manipulators fast where all are plain, and else one half of them after the other."""
        if len(groups) == 1:
            yield self._careful(groups[0])
        elif groups and (plain := self._plain(groups)):
            yield plain
        elif groups:
            half = len(groups) // 2
            yield from self._any(groups[:half])
            yield from self._any(groups[half:])

    def _plain(self, groups: list[Rows]) -> ManipulatorGroups | None:
        """Manipulators about which there is nothing to say, read fast; None where there may be something."""
        for rows in groups:
            usual = rows.name and len(rows.name) <= MAX_NAME and rows.name.isascii() and rows.name.isprintable()
            if rows.torn or rows.nameless or rows.count > MAX_JOINTS or not usual:
                return None
        if (read := self.plain.read(groups)) is None:
            return None
        marks = [[row.mark for row in rows.keys] for rows in groups]
        lines = [tuple([at.line if not at.place else (at.line, at.column, at.place) for at in own]) for own in marks]
        arms = ManipulatorGroups(
            groups=tuple(
                (
                    tuple(members),
                    ManipulatorColumns.like(
                        arm,
                        rows=arm.rows,
                        names=[groups[member].name for member in members],
                        marks=[marks[member][0] for member in members],
                        lines=[lines[member] for member in members],
                    ),
                )
                for members, arm in read
            )
        )
        if (index := self.plain.sample.choose([len(rows.cells) for rows in groups])) is not None:
            from dh2urdf_plugins.readers.plain.rows import HEAD, compare

            rows = groups[index]
            head = Rows(rows.name, rows.keys[:HEAD], rows.cells[:HEAD], min(rows.count, HEAD))
            (arm,) = arms.part(index, index + 1).tables()
            compare(arm, self._careful(head), head.count)
        return arms

    # --- With care ----------------------------------------------------------------------------------------------------

    def _careful(self, rows: Rows) -> Manipulator | Rejected:
        """A manipulator, or everything that is wrong with it."""
        reader = RowReader(self.units, type_is_given=self.has_type and not self.one, traced=self.trace is not None)
        reader.add(*self.notices)
        self.notices = []  # messages about the file go with the first manipulator, once
        name, mark = self.name, rows.keys[0].mark if rows.keys and not self.one else self.whole
        if self.robot_column is not None and rows.keys:
            marks = self.source.row(rows.keys[0], rows.cells[0], 1)[0].marks or [mark]
            name = Cell(rows.name, marks[min(self.robot_column, len(marks) - 1)])
        if rows.count > MAX_JOINTS:
            too_many = too_many_joints(rows.count, mark).about(robot=rows.name)
            return Rejected(name=rows.name, problems=(too_many,), mark=mark, notices=tuple(reader.problems))
        if rows.torn:
            reader.add(say("robot-torn", name.mark, field="robot", found=name.text))
        statements, cells = replace(self.statements), CellReader(self.columns, reader)
        read = self._read_rows(rows, statements, cells)
        cells.finish()
        if self.robot_column is None and not reader.errors and (unused := statements.symbols.unused()):
            reader.add(unused)
        return _manipulator(name, statements, read, reader, mark, trace=self.trace)

    def _read_rows(self, rows: Rows, statements: Statements, cell_reader: CellReader) -> list[DHRow | None]:
        """The rows, None for each in which there is an error; and what they declare about the convention."""
        reader, found = cell_reader.reader, list[tuple[Cells | None, Mark]]()
        for key, row in zip(rows.keys, rows.cells, strict=True):
            mark, number = key.mark, len(found) + 1
            if problem := self._no_joint(list(map(text_of, row)), mark, number):
                reader.add(problem)
                continue
            placed, wrong = self.source.row(key, row, number)
            problems = list(wrong)
            reader.add(*problems)
            cells = None if problems else cell_reader.read(row, placed.marks or [], number)
            if cells and self.one:  # what a record does not have is not empty
                cells = {name: cell for name, cell in cells.items() if cell.text or cell.mark != mark}
            found.append((cells, mark))
            if cells and (said := cells.pop("robot", None)) and not said.text and rows.name:
                about = {"joint": f"joint_{number}", "field": "robot", "found": said.text}
                reader.add(say("robot-unsaid", said.mark, **about, number=number, above=shown(rows.name)))
            if cells and (convention := cells.pop("convention", None)):
                statements.declare_convention(convention, reader.add)
            if _is_enough(reader):
                return [None]
        if rows.keys and not found:
            return [None]
        declare_types(self.sentences, found, reader.add)
        read: list[DHRow | None] = []
        first = JointRows(found, reader).first
        named = [cells["joint"].text if cells and "joint" in cells else "" for cells, _ in found]
        reader.joints = [name or f"joint_{number}" for number, name in enumerate(named, start=first)]
        for number, (cells, mark) in enumerate(found, start=first):
            read.append(None if cells is None else reader.read(number, cells, mark))
            if _is_enough(reader):
                break
        return read

    def _no_joint(self, texts: Sequence[str], mark: Mark, number: int) -> Problem | None:
        """What is wrong with a row that is no joint: it holds units, or is the header again; it does not count."""
        columns, texts, joint = self.columns, [text.strip(SPACES) for text in texts], f"joint_{number}"
        named = dict(zip(columns.fields, texts, strict=False)) if number == 1 else {}
        if named and all(unit_in(named.get(name, "")) for name in REQUIRED):
            header, unit = columns.header_of("a"), unit_in(named["a"])
            return say("row-of-units", mark, joint=joint, field="a", found=unit, header=header, unit=unit)
        again = texts[: len(columns.headers)] == columns.headers
        return say("header-again", mark, joint=joint, number=number, place=columns.mark.in_file) if again else None


def _is_enough(reader: RowReader) -> bool:
    """Whether a manipulator has so many errors that reading it stops; reports that, then."""
    if reader.errors < MAX_PROBLEMS:
        return False
    reader.add(say("stopped", errors=reader.errors))
    return True


# --- The manipulator of rows ------------------------------------------------------------------------------------------


def _manipulator(
    name: Cell,
    statements: Statements,
    rows: Sequence[DHRow | None],
    reader: RowReader,
    mark: Mark,
    *,
    trace: Trace | None = None,
) -> Manipulator | Rejected:
    """The manipulator that statements and rows make, or everything that is wrong with it."""
    if trace is not None:
        trace.rows, trace.table = tuple(reader.said or ()), statements.traced(name)
    reader.is_name(name.text, mark=name.mark, field="name", found=name.text)
    if statements.convention is None and not any(problem.field == "convention" for problem in reader.problems):
        reader.add(say("convention-unsaid", mark, field="convention"))
    if not rows:
        reader.add(say("no-joints", mark, field="joints"))
    arm = [row for row in rows if row]
    reader.finish(arm, statements.convention and statements.convention[0])
    if statements.calibration and statements.convention and arm and not reader.errors:
        try:
            calibration = statements.calibration.read(statements.convention[0])
            calibrated = calibration.applied(arm)
        except TableError as error:
            reader.add(*error.problems)
        else:
            given, found = (statements.manipulator("calibrated", tuple(rows), mark) for rows in (arm, calibrated))
            reader.add(*calibration.notices, calibration.notice(given, found))
            arm = calibrated
    _look_at_sizes(arm, statements, reader)
    problems = [problem.about(robot=name.text, mark=mark) for problem in sorted(reader.problems, key=_place)]
    if reader.errors:
        errors = tuple(problem for problem in problems if problem.severity == "error")
        notices = tuple(problem for problem in problems if problem.severity == "notice")
        return Rejected(name=name.text, problems=errors, mark=mark, notices=notices)
    made = statements.manipulator(name.text, tuple(arm), mark, tuple(problems))
    found = with_four_parameters(made, reader.extras)
    if statements.in_convention is not None:
        from dh2urdf_plugins.extraction.splitting import in_convention

        return in_convention(found, statements.in_convention)
    if trace is not None and found is not made:  # what cells say goes with the rows that they became
        own = dict(zip([row.joint for row in made.rows], trace.rows, strict=True))
        trace.rows = tuple(own.get(row.joint, {}) for row in found.rows)
    return found


def _place(problem: Problem) -> tuple[bool, int, int]:
    """The key by which problems are in the order of the file, those of the whole table behind all others."""
    mark = problem.mark
    return (False, mark.line, mark.column or 0) if mark and mark.line is not None else (True, 0, 0)


def far_away(placed: Mapping[str, Any]) -> str | None:
    """Which of base and tool is further away than arms are long; None where neither is."""
    where = ((what, placed[what].translation) for what in ("base", "tool") if placed.get(what))
    return next((what for what, translation in where if math.hypot(*translation) > LONGEST_ARM), None)


def _look_at_sizes(rows: Sequence[DHRow], statements: Statements, reader: RowReader) -> None:
    """Refuses an arm too long to be computed with, and asks for the unit of one of an unusual size."""
    length = sum(abs(row.a) + abs(row.d) for row in rows)  # of the stretched arm at q = 0
    if length > MEASURABLE_ARM:
        row = max(rows, key=lambda row: max(abs(row.a), abs(row.d)))
        name, metres = ("a", row.a) if abs(row.a) >= abs(row.d) else ("d", row.d)
        sizes: dict[str, Any] = {"metres": f"{metres:g}", "length": f"{length:.4g}", "most": f"{MEASURABLE_ARM:g}"}
        reader.add(say("too-long", row.mark, joint=row.joint, field=name, **sizes))
    if reader.errors:
        return
    if what := far_away(statements.values):  # this and the size of the arm are the same question
        reader.add(say("base-or-tool-far-away", field=what, limit=f"{LONGEST_ARM:g}"))
        return
    slides = [row.limits for row in rows if row.type is JointType.PRISMATIC]
    reach = length + sum(max(abs(limits.lower or 0), abs(limits.upper or 0)) for limits in slides)
    if not reach or (reach >= SHORTEST_ARM and length <= LONGEST_ARM):
        return
    reach = length if length > LONGEST_ARM else reach
    number = max(range(len(rows)), key=lambda place: abs(rows[place].d))
    beside = rows[max(0, number - 1) : number + 2]  # the joint of the longest d, and its neighbours
    is_calibrated = any(0.0 < abs(math.remainder(row.alpha, math.pi)) < _NEARLY_PARALLEL for row in beside)
    units = reader.units
    read = units.columns.get("a") or units.columns.get("d") or units.of(Dimension.LENGTH) or UNITS["m"]
    usual = {name: UNITS[name].si(reach / read.si(1.0)) for name in ("cm", "inch", "mm", "m")}
    usual = {name: size for name, size in usual.items() if _USUAL[0] <= size <= _USUAL[1]}
    notice = say(
        "size-of-a-calibrated-arm" if length > LONGEST_ARM and is_calibrated else "size",
        rows[0].mark,
        size=f"{reach:.4g} m" if reach >= 1 else f"{1000 * reach:.4g} mm",
        read=read.symbol,
        sizes=[f"{name} ({size:.3g} m)" for name, size in usual.items()] or "another unit",
        unit=next(iter(usual), "mm"),
    )
    reader.add(notice)


def too_many_joints(count: int, mark: Mark) -> Problem:
    """What is wrong with a manipulator of more joints than are read."""
    return say("too-many-joints", mark, field="joints", count=f"{count:,}", most=f"{MAX_JOINTS:,}")
