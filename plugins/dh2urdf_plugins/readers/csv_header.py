"""The top of a CSV table: comment lines that say what columns cannot, the delimiter, and the header."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from dh2urdf.documents import Node
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention
from dh2urdf.quantities import Dimension, QuantityError, Unit, find_unit
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.cells import SPACES, Cell
from dh2urdf_plugins.readers.csv_comments import convention_in_prose, is_comment, statement
from dh2urdf_plugins.readers.fields import FIELDS, REQUIRED, UNHELD_GEOMETRY, Header, misspelt, read_header

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf_plugins.readers.cells import Units

DELIMITERS = {",": "comma", ";": "semicolon", "\t": "tab"}
MAX_HEADER = 100_000
"""Length of the header [1]."""

_FEW = 5
_KHALIL = ("sigma", "σ", "gamma", "γ", "mu", "μ", "b")
_MINUS = ("-", "−", "–")
_EXCEL_SEPARATOR = re.compile(r'\s*"?sep=(.)"?\s*', re.IGNORECASE)  # Excel's own way to name the delimiter


@dataclass(slots=True)
class Columns:
    """What the header says.

    Attributes:
        delimiter: what stands between cells.
        line: the line of the header.
        fields: the field of each column, or None.
        headers: the header of each column, as it is written.
        units: the units that headers declare, by field.
        unheld: columns of geometry that no field holds, with the reason.
        modified: the column whose header means the modified convention.
        meant: fields that misspelt headers probably mean.
        notices: columns that are left out.
    """

    delimiter: str
    line: int
    fields: list[str | None] = field(default_factory=list)
    headers: list[str] = field(default_factory=list)
    units: dict[str, Unit] = field(default_factory=dict)
    unheld: dict[int, str] = field(default_factory=dict)
    modified: int | None = None
    meant: list[str] = field(default_factory=list)
    notices: list[Problem] = field(default_factory=list)


@dataclass(slots=True)
class Top:
    """Everything above the first row.

    Attributes:
        columns: the header.
        statements: what comment lines say, by key.
        comments: comment lines that speak of the one convention or the other in prose.
    """

    columns: Columns
    statements: dict[str, Node]
    comments: list[tuple[Convention, Cell]]


def read_top(lines: Iterable[str], file: str) -> Top:
    """Everything above the first row; the lines behind the header are not touched.

    Raises:
        TableError: there is no header, or it is wrong, or a comment line is.
    """
    statements: dict[str, Node] = {}
    comments: list[tuple[Convention, Cell]] = []
    delimiter: str | None = None
    number = 0
    for number, line in enumerate(lines, start=1):
        if not line.strip(SPACES + "".join(DELIMITERS)):
            continue
        if number == 1 and (match := _EXCEL_SEPARATOR.fullmatch(line)):
            delimiter = match[1]
            continue
        long = len(line) > MAX_HEADER
        if long and not is_comment(line):
            message = f"this line should be the header, and has {len(line)} characters"
            raise TableError(
                Problem(message=message, mark=Mark(file=file, line=number), accepted=f"at most {MAX_HEADER} characters")
            )
        header = line if not is_comment(line) else None if long else commented_header(line)
        if header is not None:
            return Top(read_columns(header, number, file, delimiter), statements, comments)
        if convention := convention_in_prose(line):
            comments.append((convention, Cell(line.strip(), Mark(file=file, line=number))))
        if found := statement(line, number, file):
            key, node = found
            if key in statements:
                message = f"a comment line says {key} already, in line {statements[key].line}"
                raise TableError(Problem(message=message, mark=Mark(file=file, line=number), field=key))
            statements[key] = node
    raise TableError(
        Problem(
            message="there is no header and there are no rows" if number else "the file is empty: there is no header",
            mark=Mark(file=file),
            accepted="a header with at least the columns a, alpha and d, and one row for each joint",
        )
    )


def split(line: str, delimiter: str) -> list[str]:
    """The cells of one line."""
    return [cell.strip(SPACES) for cell in next(csv.reader([line], delimiter=delimiter), [])]


def starts_of(line: str, delimiter: str) -> list[int]:
    """The columns, in characters from 1, at which the cells of a line start."""
    starts, quoted = [0], False
    for position, character in enumerate(line):
        if character == '"':
            quoted = not quoted
        elif character == delimiter and not quoted:
            starts.append(position + 1)
    ends = [*starts[1:], len(line) + 1]
    return [
        start + len(cell) - len(cell.lstrip(SPACES)) + 1
        for start, cell in ((start, line[start : end - 1]) for start, end in zip(starts, ends, strict=True))
    ]


def delimiter_of(line: str) -> str | None:
    """The delimiter of a header: the one that makes the most fields of it."""

    def score(delimiter: str) -> tuple[int, int]:
        cells = split(line, delimiter)
        return sum(read_header(cell).field is not None for cell in cells), len(cells)

    best = max(DELIMITERS, key=score)
    fields, cells = score(best)
    return best if fields and cells > 1 else None


def commented_header(line: str) -> str | None:
    """The header that a line starting with # is, or None where it is a comment.

    The first column may be called ``#``, or the header as a whole may be commented out, as numpy writes it.
    """
    found: dict[str, set[str]] = {}
    for text in (line, line.replace("#", " ", 1)):
        headers = map(read_header, split(text, delimiter_of(text) or ","))
        found[text] = {header.field.name for header in headers if header.field}
    best = max(found, key=lambda text: len(found[text]))
    return best if found[best].issuperset(REQUIRED) else None


def read_columns(line: str, number: int, file: str, delimiter: str | None = None) -> Columns:
    """What a header says.

    Args:
        line: the header.
        number: its line.
        file: the file.
        delimiter: what stands between cells, where a line above says it.

    Raises:
        TableError: everything that is wrong with it.
    """
    delimiter = delimiter if delimiter in DELIMITERS else delimiter_of(line)
    if delimiter is None:
        raise TableError(_no_header(line, number, file))
    columns = Columns(delimiter, number)
    columns.headers = split(line, delimiter)
    problems: list[Problem] = []
    first: dict[str, int] = {}
    indexed: int | None = None
    starts = starts_of(line, delimiter)
    for index, text in enumerate(columns.headers):
        mark = Mark(file=file, line=number, column=starts[min(index, len(starts) - 1)])
        header = read_header(text)
        columns.fields.append(header.field.name if header.field else None)
        if header.field is None:
            _unknown(columns, header, index, mark, problems)
            continue
        name = header.field.name
        _measure(columns, header, text, mark, problems)
        key = "sign" if name == "flip" else name
        if key in first:
            problems.append(
                Problem(
                    message=f"two columns are {key}: {shown(columns.headers[first[key]])} and {shown(text)} (a "
                    "duplicate)",
                    mark=mark,
                    field=name,
                    found=text,
                    accepted="one column for each field",
                )
            )
        first.setdefault(key, index)
        if header.link == "i-1" and name in ("a", "alpha"):
            columns.modified = index
        elif header.link == "i-1":
            problems.append(
                Problem(
                    message=f"{shown(text)}: neither convention takes {name} of the link before",
                    mark=mark,
                    field=name,
                    found=text,
                    accepted="a_{i-1} and alpha_{i-1} (the modified convention), with d_i and theta_i",
                )
            )
        elif header.link == "i" and name in ("a", "alpha"):
            indexed = index
    if columns.modified is not None and indexed is not None:
        one, other = columns.headers[columns.modified], columns.headers[indexed]
        problems.append(
            Problem(
                message=f"{shown(one)} is of the link before and {shown(other)} of the link itself: neither convention "
                "mixes them",
                mark=Mark(file=file, line=number),
                field="convention",
                accepted="a_{i-1} and alpha_{i-1} (modified), or a_i and alpha_i (standard)",
            )
        )
    problems += _foreign_r(columns, file)
    known = {*columns.fields, *columns.meant}
    problems.extend(_missing(name, columns, file) for name in REQUIRED if name not in known)
    if problems:
        raise TableError(problems)
    return columns


def _no_header(line: str, number: int, file: str) -> Problem:
    return Problem(
        message=f"this line is no header whose columns are known: {shown(line)}",
        mark=Mark(file=file, line=number),
        found=line,
        accepted="a header with at least the columns a, alpha and d, such as `joint,type,a,alpha,d,theta`, with one "
        "delimiter: comma, semicolon or tab",
        suggestion="columns aligned with spaces or bars cannot be told apart; put commas between them"
        if "  " in line or "|" in line
        else None,
    )


def _unknown(columns: Columns, header: Header, index: int, mark: Mark, problems: list[Problem]) -> None:
    text = columns.headers[index]
    if header.key in UNHELD_GEOMETRY:
        columns.unheld[index] = UNHELD_GEOMETRY[header.key]
    elif (near := misspelt(header.key)) is not None:
        columns.meant.append(near.name)
        problems.append(
            Problem(
                message=f"no column is called {shown(text)}",
                mark=mark,
                field=header.key,
                found=text,
                accepted=_accepted_headers(),
                suggestion=f"did you mean {near.name!r}?",
            )
        )
    elif text:
        message = f"the column {shown(text)} is left out: no field is called so"
        columns.notices.append(
            Problem(message=message, severity="notice", mark=mark, found=text, accepted=_accepted_headers())
        )


def _measure(columns: Columns, header: Header, text: str, mark: Mark, problems: list[Problem]) -> None:
    """Takes the unit of a column of numbers, and refuses a header with a sign."""
    if not (header.field and header.field.dimension):
        return
    name = header.field.name
    if text.startswith(_MINUS):
        problems.append(_negated(text, name, mark))
    _declare_unit(columns, header, name, mark, problems)


def _declare_unit(columns: Columns, header: Header, name: str, mark: Mark, problems: list[Problem]) -> None:
    if header.unit is None:
        return
    field_ = FIELDS[name]
    dimensions = [dimension for dimension in (field_.dimension, field_.linear) if dimension]
    for dimension in dimensions:
        try:
            columns.units[name] = find_unit(header.unit, dimension)
        except QuantityError as error:
            problem = Problem(
                message=error.message,
                mark=mark,
                field=name,
                found=header.unit,
                accepted=error.accepted,
                suggestion=error.suggestion,
            )
        else:
            return
    if dimensions and dimensions != [Dimension.NUMBER]:
        problems.append(problem)


def _missing(name: str, columns: Columns, file: str) -> Problem:
    words = ", ".join(FIELDS[name].headers)
    others = [text for text, field_ in zip(columns.headers, columns.fields, strict=True) if text and field_ is None]
    return Problem(
        message=f"there is no column for {name} in the header",
        mark=Mark(file=file, line=columns.line),
        field=name,
        accepted=f"one of the headers {words}; its unit may follow, as in `{name} "
        f"[{'deg' if name == 'alpha' else 'mm'}]`",
        suggestion=f"no field is called {', '.join(map(shown, others[:_FEW]))}" if others else None,
    )


def _negated(text: str, name: str, mark: Mark) -> Problem:
    return Problem(
        message=f"{shown(text)} may be the negative of {name}",
        mark=mark,
        field=name,
        found=text,
        accepted=f"{name}, and its numbers with their signs",
    )


def _foreign_r(columns: Columns, file: str) -> list[Problem]:
    """Refuses `r` beside the other letters of Khalil and Kleinfinger, to whom r is what is d here, and d what is a."""
    keys = [read_header(text).key for text in columns.headers]
    letters = [text for text, key in zip(columns.headers, keys, strict=True) if key in _KHALIL]
    if "a" not in columns.fields or "d" not in columns.fields or not letters:
        return []
    index = columns.fields.index("a")
    header = columns.headers[index]
    if not header.casefold().startswith("r"):
        return []
    return [
        Problem(
            message=f"{shown(header)} beside {shown(letters[0])} may be the r of Khalil and Kleinfinger, which is d "
            "here, while their d is a",
            mark=Mark(file=file, line=columns.line),
            field="a",
            found=header,
            accepted="a for the length along x, d for the length along z",
        )
    ]


def _accepted_headers() -> str:
    return ", ".join(FIELDS)


def unit_problems(columns: Columns, declared: Iterable[tuple[Unit, Mark] | None], file: str) -> list[Problem]:
    """What is wrong with headers' units beside the units declared for the whole table."""
    problems = []
    for said in declared:
        for name, unit in columns.units.items():
            if said and unit.dimension is said[0].dimension and unit != said[0]:
                header = columns.headers[columns.fields.index(name)]
                problems.append(
                    Problem(
                        message=f"the header {shown(header)} declares {unit.symbol}, and {said[1]} declares "
                        f"{said[0].symbol}",
                        mark=Mark(file=file, line=columns.line),
                        field=name,
                        found=header,
                        accepted="one unit for a column",
                    )
                )
    return problems


def undeclared_units(columns: Columns, units: Units, file: str) -> list[Problem]:
    """Notices of columns without a unit beside columns that have another one than the SI unit."""
    notices = _followers(columns, units, file)
    for dimension, names, si in ((Dimension.LENGTH, ("a", "d"), "m"), (Dimension.ANGLE, ("alpha", "theta"), "rad")):
        foreign = {columns.units[name].symbol for name in names if name in columns.units} - {si}
        notices += [
            Problem(
                message=f"{name} has no unit and is read in {si}, while another {dimension.plain} is in {min(foreign)}",
                severity="notice",
                mark=Mark(file=file, line=columns.line),
                field=name,
                suggestion=f"declare it: `{name} [{min(foreign)}]`",
            )
            for name in names
            if not units.of(dimension) and foreign and name in columns.fields and name not in columns.units
        ]
    return notices


_GEOMETRY = {Dimension.LENGTH: ("a", "d"), Dimension.ANGLE: ("alpha", "theta")}
_RATES = {Dimension.LENGTH: Dimension.SPEED, Dimension.ANGLE: Dimension.TURN_RATE}


def headers_unit(columns: Columns, dimension: Dimension) -> Unit | None:
    """The unit that the headers of all columns of geometry declare; None where one has none, they differ, or it is SI.

    Offsets, limits, centres of mass and radii without a unit of their own follow it.
    """
    units = [columns.units.get(name) for name in _GEOMETRY[dimension] if name in columns.fields]
    unit = units[0] if units and all(unit == units[0] for unit in units) else None
    return unit if unit and (unit.power or unit.degrees) else None


def _followers(columns: Columns, units: Units, file: str) -> list[Problem]:
    """A notice of the columns that follow the unit of others."""
    followed = {
        dimension: unit
        for dimension in _GEOMETRY
        if not units.of(dimension) and (unit := headers_unit(columns, dimension))
    }
    measured = {name: {FIELDS[name].dimension, FIELDS[name].linear} for name in columns.fields if name}
    names = [
        name
        for name, dimensions in measured.items()
        if name not in columns.units and any({dimension, _RATES[dimension]} & dimensions for dimension in followed)
    ]
    if not names:
        return []
    return [
        Problem(
            message=f"no unit is declared for {', '.join(names)}: the units of the geometry hold, "
            f"{' and '.join(unit.symbol for unit in followed.values())}",
            severity="notice",
            mark=Mark(file=file, line=columns.line),
            field=names[0],
            suggestion="declare the unit in each header",
        )
    ]
