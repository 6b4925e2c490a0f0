"""A table with one row per joint, one manipulator or a million behind each other: the same for every file of rows.

The file is never held as a whole: its rows come in batches, and the rows of one manipulator are read together, by
`plain_rows` where nothing about them is remarkable, and with all care where something is.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import chain, groupby
from operator import itemgetter
from typing import TYPE_CHECKING, Protocol, TypeAlias

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.quantities import Dimension
from dh2urdf.seen import SeenNames
from dh2urdf.source import Mark, Problem, shown
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.cells import SPACES, Cell, Units, text_of
from dh2urdf_plugins.readers.fields import convention_of
from dh2urdf_plugins.readers.headers import headers_unit, undeclared_units, unit_problems
from dh2urdf_plugins.readers.names import MAX_NAME
from dh2urdf_plugins.readers.plain_rows import PlainRows
from dh2urdf_plugins.readers.records import make_manipulators
from dh2urdf_plugins.readers.rows import RowReader
from dh2urdf_plugins.readers.statements import Statements, TableOptions
from dh2urdf_plugins.readers.table_cells import TableCells, check_index
from dh2urdf_plugins.readers.tables import MAX_JOINTS, manipulator, stopped, too_many_joints

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.documents import Node
    from dh2urdf.manipulator import DHRow
    from dh2urdf_plugins.readers.cells import Value
    from dh2urdf_plugins.readers.headers import Columns

Row: TypeAlias = "Sequence[Value]"
"""The cells of a row, one for each column."""


class RowSource(Protocol):
    """A file of rows, as its format gives them.

    Attributes:
        notices: what is to be said of the rows so far, beyond what stands in them.
    """

    notices: list[Problem]

    def batches(self) -> Iterator[tuple[Sequence[int], Sequence[Row]]]:
        """Some hundred rows at a time, and the number of the line at which each starts."""

    def mark(self, line: int) -> Mark:
        """The place of a row."""

    def marks(self, line: int, texts: Sequence[str]) -> Sequence[Mark]:
        """The place of each cell of a row."""

    def row_problem(self, line: int, texts: Sequence[str], number: int) -> Problem | None:
        """Why the cells of a row, whose number within its manipulator is given, are not those of the columns."""


class _Rows:
    """The rows of one manipulator as they stand in the file.

    Attributes:
        name: the manipulator's name.
        lines: the line of each row.
        cells: the cells of each row; of more than are read, some are left out.
        count: how many rows there are.
        torn: whether other rows of the same manipulator stand elsewhere.
        nameless: whether the robot column is empty in some of them.
    """

    __slots__ = ("cells", "count", "lines", "name", "nameless", "torn")

    def __init__(self, name: str, lines: Iterable[int] = (), cells: Iterable[Row] = ()) -> None:
        self.name = name
        self.lines = list(lines)
        self.cells = list(cells)
        self.count = len(self.cells)
        self.torn = False
        self.nameless = False

    def extend(self, lines: Sequence[int], cells: Sequence[Row]) -> None:
        """Adds rows, as many as are needed to see that there are too many."""
        room = max(0, MAX_JOINTS - len(self.cells))
        self.lines.extend(lines[:room])
        self.cells.extend(cells[:room])
        self.count += len(cells)


class RowTable:
    """One file that is being read.

    Attributes:
        statements: what the table and the options say of all rows.
        notices: what is to be said with the next manipulator.
    """

    def __init__(
        self, path: Path, options: TableOptions, columns: Columns, said: Mapping[str, Node], source: RowSource
    ) -> None:
        """Takes what stands above the rows.

        Args:
            path: the file.
            options: what the table does not say itself.
            columns: its headers.
            said: what it says of all rows, by key.
            source: its rows.

        Raises:
            TableError: what is said contradicts itself, or means nothing.
        """
        self.path = path
        self.file = str(path)
        self.source = source
        self.columns = columns
        self.statements = Statements()
        self.notices: list[Problem] = [*columns.notices]
        self.name = self._state(said, options)
        units = self.statements.units()
        self.notices += undeclared_units(columns, units)
        self.units = Units(
            length=units.length or headers_unit(columns, Dimension.LENGTH),
            angle=units.angle or headers_unit(columns, Dimension.ANGLE),
            columns=columns.units,
            decimal_comma=columns.decimal_comma,
        )
        self.robot_column = self._column("robot")
        self.convention_column = self._column("convention")
        self.plain_table = self.statements.convention is not None or self.convention_column is not None
        self.has_type = "type" in columns.fields
        self.cells = TableCells(columns)
        self.remarked = 0
        self.plain = PlainRows(columns, self.units, source.mark(0))
        self.seen = SeenNames()

    def _column(self, name: str) -> int | None:
        return self.columns.fields.index(name) if name in self.columns.fields else None

    def _state(self, said: Mapping[str, Node], options: TableOptions) -> Cell:
        """Takes what the table, its headers and the options say of all rows; gives the manipulator's name."""
        columns, problems = self.columns, list[Problem]()
        if units := said.get("units"):
            self.statements.say_units(units, problems.append)
        if convention := said.get("convention"):
            self.statements.say_convention(Cell(convention.text or "", convention.mark), problems.append)
        if columns.modified is not None:
            header = Cell(columns.headers[columns.modified], columns.mark)
            if self.statements.convention is None and options.convention is None:
                message = f"the header {shown(header.text)} means the modified (Craig) convention"
                self.notices.append(
                    Problem(message=message, severity="notice", mark=header.mark, field="convention", found=header.text)
                )
            self.statements.say_which(Convention.MODIFIED, header, problems.append)
        self.statements.say_options(options, problems.append)
        problems += unit_problems(columns, (self.statements.length, self.statements.angle))
        for what in ("base", "tool"):
            if node := said.get(what):
                self.statements.say_transform(node, what, problems.append)
        self.statements.say_option_transforms(options, problems.append)
        if defaults := said.get("defaults"):
            self.statements.say_defaults(defaults, problems.append)
        errors = [problem for problem in problems if problem.severity == "error"]
        if errors:
            raise TableError(errors)
        self.notices += problems
        name = said.get("name")
        return Cell(name.text or "", name.mark) if name else Cell(self.path.stem, Mark(file=self.file))

    # --- Rows ---------------------------------------------------------------------------------------------------------

    def manipulators(self) -> Iterator[Manipulator | Rejected]:
        """Reads all rows."""
        any_rows = False
        for groups in self._groups():
            any_rows = any_rows or bool(groups)
            self.notices += self.source.notices[self.remarked :]
            self.remarked = len(self.source.notices)
            while groups and (self.notices or not self.plain_table):
                yield self._careful(groups.pop(0))
            yield from self._plain(groups) or map(self._any, groups)
        if not any_rows:
            yield self._careful(_Rows(self.name.text))

    def _groups(self) -> Iterator[list[_Rows]]:
        """The rows of manipulators that are complete, batch by batch."""
        rows = _Rows(self.name.text)
        for lines, batch in self.source.batches():
            finished = []
            for name, some_lines, some_rows in self._by_robot(lines, batch):
                if not name and rows.lines:  # a cell that a spreadsheet has merged with the one above, perhaps
                    rows.nameless = True
                elif name != rows.name or not rows.lines:
                    finished.append(rows)
                    rows = _Rows(name, some_lines, some_rows)
                    continue
                rows.extend(some_lines, some_rows)
            yield self._whole(finished, rows)
        yield self._whole([rows])

    def _by_robot(
        self, lines: Sequence[int], batch: Sequence[Row]
    ) -> Iterator[tuple[str, Sequence[int], Sequence[Row]]]:
        """Runs of rows with the same name of the manipulator."""
        column = self.robot_column
        if column is None:
            yield self.name.text, lines, batch
            return
        key: Callable[[Row], Value] = itemgetter(column)
        if batch and min(map(len, batch)) <= column:

            def key(cells: Row) -> Value:
                """A short row is refused later; until then it goes without a name."""
                return cells[column] if len(cells) > column else ""

        start = 0
        for name, some in groupby(batch, key):
            rows = list(some)
            yield text_of(name).strip(SPACES), lines[start : start + len(rows)], rows
            start += len(rows)

    def _whole(self, groups: list[_Rows], *unfinished: _Rows) -> list[_Rows]:
        """Marks the manipulators whose rows do not all stand together, as far as a batch shows it in time."""
        groups = [rows for rows in groups if rows.lines]
        if self.robot_column is not None:
            count = Counter(rows.name for rows in (*groups, *unfinished))
            names = [rows.name for rows in groups]
            known = self.seen.known(names)
            for rows in groups:
                rows.torn = count[rows.name] > 1 or rows.name in known
            self.seen.add(names)
        return groups

    def _any(self, rows: _Rows) -> Manipulator | Rejected:
        plain = self._plain([rows])
        return plain[0] if plain else self._careful(rows)

    def _plain(self, groups: list[_Rows]) -> list[Manipulator] | None:
        """Manipulators about which there is nothing to say, read fast; None where there may be something."""
        for rows in groups:
            name = rows.name
            if (
                rows.torn
                or rows.nameless
                or rows.count > MAX_JOINTS
                or not name
                or len(name) > MAX_NAME
                or not (name.isascii() and name.isprintable())
            ):
                return None
        cells = list(chain.from_iterable(rows.cells for rows in groups))
        lines = chain.from_iterable(rows.lines for rows in groups)
        if not cells or (read := self.plain.read(cells, lines, [len(rows.lines) for rows in groups])) is None:
            return None
        if (statements := self._agreed(cells)) is None:
            return None
        model = statements.manipulator("", (), None)
        return make_manipulators(model, zip([rows.name for rows in groups], read, strict=True))

    def _agreed(self, cells: list[Row]) -> Statements | None:
        """What holds for all of some rows, the convention included; None where they say several, or an unknown one."""
        if self.convention_column is None:
            return self.statements
        said = {text_of(row[self.convention_column]) for row in cells}
        conventions = {None if "\n" in word else convention_of(word.strip(SPACES)) for word in said}
        stated = self.statements.convention
        (convention, *others) = conventions
        if others or convention is None or (stated and stated[0] is not convention):
            return None
        return replace(self.statements, convention=(convention, Mark(file=self.file)))

    # --- Rows, with care ----------------------------------------------------------------------------------------------

    def _careful(self, rows: _Rows) -> Manipulator | Rejected:
        """A manipulator, or everything that is wrong with it."""
        reader = RowReader(self.units, type_is_given=self.has_type)
        for notice in self.notices:
            reader.add(notice)
        mark = self.source.mark(rows.lines[0]) if rows.lines else Mark(file=self.file)
        name = self.name
        if self.robot_column is not None and rows.lines:
            marks = self.source.marks(rows.lines[0], list(map(text_of, rows.cells[0])))
            name = Cell(rows.name, marks[min(self.robot_column, len(marks) - 1)])
        if rows.count > MAX_JOINTS:
            too_many = too_many_joints(rows.count, mark).about(robot=rows.name)
            return Rejected(name=rows.name, problems=(too_many,), mark=mark)
        if rows.torn:
            reader.add(_torn(name))
        statements = replace(self.statements)
        read = self._read_rows(rows, statements, reader)
        if problem := self.cells.ambiguous_number():
            reader.add(problem)
        self.plain_table &= not self.cells.has_decimal_commas
        result = manipulator(name, statements, read, reader, mark)
        if isinstance(result, Manipulator):
            self.notices = []  # what is to be said of the file is said once, with the first manipulator
        return result

    def _read_rows(self, rows: _Rows, statements: Statements, reader: RowReader) -> list[DHRow | None]:
        """The rows as far as they can be read, and what they say of the convention."""
        read: list[DHRow | None] = []
        numbered = self._numbered(rows)
        for number, (line, row) in enumerate(zip(rows.lines, rows.cells, strict=True), start=1):
            mark, texts = self.source.mark(line), list(map(text_of, row))
            if problem := self.source.row_problem(line, texts, number):
                reader.add(problem)
                read.append(None)
                continue
            cells = self.cells.read(texts, self.source.marks(line, texts), mark, number, reader)
            if cells is None:
                read.append(None)
                continue
            if (robot := cells.pop("robot", None)) and not robot.text and rows.name:
                reader.add(_nameless(robot, rows.name, number))
            if convention := cells.pop("convention", None):
                statements.say_convention(convention, reader.add)
            index = cells.pop("index", None)
            if index and numbered:
                check_index(index, number, reader)
            elif index:
                cells["joint"] = index
            read.append(reader.read(number, cells, mark))
            if stopped(reader):
                break
        return read

    def _numbered(self, rows: _Rows) -> bool:
        """Whether the index column holds numbers; where there is no joint column it may hold names instead."""
        column = self._column("index")
        if column is None or "joint" in self.columns.fields or not rows.cells or len(rows.cells[0]) <= column:
            return True
        return text_of(rows.cells[0][column]).strip(SPACES).isdecimal()


def _nameless(robot: Cell, name: str, number: int) -> Problem:
    return Problem(
        message=f"row {number} does not say which manipulator it belongs to; the row above says {shown(name)}",
        mark=robot.mark,
        joint=f"joint_{number}",
        field="robot",
        found=robot.text,
        accepted="the name of the manipulator in every row",
        suggestion="a spreadsheet that has merged cells leaves all but the first of them empty",
    )


def _torn(name: Cell) -> Problem:
    return Problem(
        message=f"rows of {shown(name.text)} stand in several places of the file",
        mark=name.mark,
        field="robot",
        found=name.text,
        accepted="all rows of a manipulator together",
    )
