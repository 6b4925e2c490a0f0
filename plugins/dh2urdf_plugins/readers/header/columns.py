"""The headers of a table, whatever its format: which column is which field, in which unit, and what is wrong there."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.quantities import Dimension, QuantityError, Unit, find_unit, is_unit
from dh2urdf.source import Mark, Problem, listed, shown
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.readers.header.header_rows import headers_in
from dh2urdf_plugins.readers.header.unknown_columns import Refusal, ignored, is_number, refusal
from dh2urdf_plugins.readers.header.words import Header, bounds_theta, misspelt, parts_of, read_header
from dh2urdf_plugins.readers.words.fields import FIELDS
from dh2urdf_plugins.readers.words.unheld import IGNORED, THETA_OFFSETS
from dh2urdf_plugins.readers.words.word_keys import key_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from dh2urdf.table_text import CellRow

_INDEX_J = r"(?i)[jⱼ][\s)}\]]*(?:[\[(].*)?$"
"""The index of Khalil and Kleinfinger."""
_KHALIL = ("sigma", "gamma", "mu", "b")
_NUMBERED = r"(?:joint|axis|link|gelenk|achse|axe|articulation|eje|asse|giunto|[ajq])?[\s_.#]*[0-9]{1,2}"
TURN_ROUND = "the joints seem to be in columns: turn the table round, so that each joint has a row"
"""What to do about a table whose header names joints."""
_MINUS = ("-", "−", "–")
_NAME = ("name", "nom", "名", "adi", "nazw", "назв", "имя", "이름", "관절명")
"""What the headers of names have in them, unlike those of joints: ``Joint`` beside ``Joint name``."""


@dataclass(slots=True)
class Columns:
    """What the header says.

    Attributes:
        mark: the place of the header.
        headers: the header of each column, as it is written.
        decimal_comma: whether a comma may stand for the decimal point.
        quoted_commas: whether it may do so in a cell that is a text of its own, such as one in quotes between commas.
        fields: the field of each column, or None.
        units: the units that headers declare, by field.
        marks: the place of each header.
        unheld: columns that name no field and are refused where they hold anything.
        silent: columns that name no field and are left out, as long as they have held nothing.
        modified: the column whose header means the modified convention.
        meant: fields that misspelt headers probably mean.
        ignored: columns that their author wants to be left out.
        notices: messages about the header.
        numbers: the columns whose cells are numbers already, or all text.
        of_theta: columns of limits whose headers call them bounds of theta.
    """

    mark: Mark
    headers: list[str]
    decimal_comma: bool = False
    quoted_commas: bool = False
    fields: list[str | None] = field(default_factory=list)
    units: dict[str, Unit] = field(default_factory=dict)
    marks: list[Mark] = field(default_factory=list)
    unheld: dict[int, Refusal] = field(default_factory=dict)
    silent: set[int] = field(default_factory=set)
    modified: int | None = None
    meant: list[str] = field(default_factory=list)
    ignored: set[int] = field(default_factory=set)
    notices: list[Problem] = field(default_factory=list)
    numbers: frozenset[int] = frozenset()
    of_theta: set[int] = field(default_factory=set)

    @property
    def names(self) -> list[str]:
        """The fields that the columns hold, in their order, those that share cells one by one."""
        return [part for name in self.fields if name for part in parts_of(FIELDS[name])]

    def header_of(self, name: str) -> str:
        """The header of the column that holds a field."""
        holding = (k for k, field_ in enumerate(self.fields) if field_ and name in parts_of(FIELDS[field_]))
        return self.headers[next(holding)]


def marked_as_left_out(header: CellRow, names: Collection[str]) -> list[str]:
    """The headers of a row, with the mark of a column that is left out before some.

    Raises:
        TableError: there is no such column.
    """
    headers = headers_in(header)
    for name in names:
        if name not in headers:
            message = f"no column is called {shown(name)}, which is to be ignored"
            accepted = ", ".join(headers)
            raise TableError(Problem(message=message, mark=header.mark, field="ignore", found=name, accepted=accepted))
    return [f"_{text}" if text in names else text for text in headers]


def name_columns(headers: Sequence[str], marks: Sequence[Mark], mark: Mark) -> Columns:
    """What headers say.

    Args:
        headers: the header of each column.
        marks: the place of each.
        mark: the place of all of them.

    Raises:
        TableError: everything that is wrong with them.
    """
    columns = Columns(mark, list(headers), marks=list(marks))
    problems: list[Problem] = []
    first: dict[str, int] = {}
    indexed: int | None = None
    spare, counting = parts_beside_theta(headers), number_beside_name(headers)
    for index, (text, place) in enumerate(zip(headers, marks, strict=True)):
        header = read_header(text)
        header = header._replace(field=None) if text in spare else header
        header = header._replace(field=FIELDS["index"]) if text == counting else header
        columns.fields.append(header.field.name if header.field else None)
        if header.field is None:
            _unknown(columns, header, index, place, problems)
            continue
        name = header.field.name
        if name in ("type", "flip", "sign") and not text.isalpha():
            problems += _legend(name, text, place)
        _measure(columns, header, text, place, problems)
        keys = ("sign",) if name == "flip" else parts_of(header.field)
        twins = [key for key in keys if first.setdefault(key, index) != index]
        problems += [_twins(columns, index, first[twin], twin) for twin in twins[:1]]
        if header.link == "i-1" and name in ("a", "alpha"):
            columns.modified = index
        elif header.link == "i-1":
            problems.append(_of_link_before(text, name, place))
        elif header.link == "i" and name in ("a", "alpha"):
            indexed = index
    if columns.modified is not None and indexed is not None:
        problems.append(_mixed_links(columns, columns.modified, indexed))
    problems += _foreign_r(columns)
    if columns.ignored:
        columns.notices.append(
            ignored([headers[index] for index in sorted(columns.ignored)], marks[min(columns.ignored)])
        )
    known = {*columns.fields, *columns.meant}
    problems.extend(_missing(name, columns) for name in REQUIRED if name not in known)
    if problems:
        raise TableError(problems, columns.notices)
    return columns


def parts_beside_theta(texts: Iterable[str]) -> set[str]:
    """The headers of a constant part of theta in a table or row that has theta itself: they name no field."""
    of_theta = {text for text in texts if read_header(text).field is FIELDS["theta"]}
    parts = {text for text in of_theta if read_header(text).key in THETA_OFFSETS}
    return parts if parts < of_theta else set()


def number_beside_name(texts: Iterable[str]) -> str | None:
    """The header of joints that counts them, in a table that has their names besides: ``Joint`` beside ``Name``."""
    headers = {text: read_header(text) for text in texts}
    keys = {text: header.key for text, header in headers.items() if header.field is FIELDS["joint"]}
    if any(header.field is FIELDS["index"] for header in headers.values()):
        return None
    names = [text for text, key in keys.items() if any(key_of(word) in key for word in _NAME)]
    others = [text for text in keys if text not in names]
    return others[0] if len(names) == len(others) == 1 else None


def _legend(name: str, text: str, mark: Mark) -> list[Problem]:
    """What is wrong with a header that says what the numbers below it mean."""
    from dh2urdf_plugins.readers.words.type_codes import exchanged, exchanged_codes, exchanged_direction

    if name == "type":
        codes = exchanged_codes(text)
        return [exchanged(text, codes, mark)] if codes else []
    turned = exchanged_direction(name, text, mark)
    return [turned] if turned else []


def _of_link_before(text: str, name: str, mark: Mark) -> Problem:
    return Problem(
        message=f"{shown(text)}: neither convention takes {name} of the link before",
        mark=mark,
        field=name,
        found=text,
        accepted="a_{i-1} and alpha_{i-1} (the modified convention), with d_i and theta_i",
    )


def _mixed_links(columns: Columns, before: int, itself: int) -> Problem:
    one, other = columns.headers[before], columns.headers[itself]
    return Problem(
        message=f"{shown(one)} is of the link before and {shown(other)} of the link itself: neither convention mixes "
        "them",
        mark=columns.mark,
        field="convention",
        accepted="a_{i-1} and alpha_{i-1} (modified), or a_i and alpha_i (standard)",
    )


def _twins(columns: Columns, index: int, other: int, name: str) -> Problem:
    """A field that two columns hold."""
    text, first = columns.headers[index], columns.headers[other]
    symbol = next((each for each in (text, first) if read_header(each).key == "r"), None) if name == "a" else None
    suggestion = None
    if symbol and any(read_header(each).field is FIELDS["d"] for each in columns.headers):
        suggestion = f"if {symbol} is the centre of mass, call it com"
    elif symbol:
        suggestion = f"if {symbol} is the length along z, call it d"
    elif FIELDS[name].dimension is None:
        suggestion = f"if one of them is to be left out, begin its header with {IGNORED}: '{IGNORED}{text}'"
    return Problem(
        message=f"two columns are {name}: {shown(first)} and {shown(text)} (a duplicate)",
        mark=columns.marks[index],
        field=columns.fields[index],
        found=text,
        accepted="one column for each field",
        suggestion=suggestion,
    )


def _unknown(columns: Columns, header: Header, index: int, mark: Mark, problems: list[Problem]) -> None:
    text = columns.headers[index]
    why = refusal(text, header)
    if header.ignored:
        columns.ignored.add(index)
    elif why and why.zero:
        columns.unheld[index] = why
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
    elif why:
        columns.unheld[index] = why
    else:
        columns.silent.add(index)


def _measure(columns: Columns, header: Header, text: str, mark: Mark, problems: list[Problem]) -> None:
    """Takes the unit of a column of numbers, and refuses a header with a sign."""
    if not (header.field and header.field.dimension):
        return
    name = header.field.name
    if text.startswith(_MINUS):
        problems.append(_negated(text, name, mark))
    _declare_unit(columns, header, name, mark, problems)
    if bounds_theta(header):
        columns.of_theta.add(len(columns.fields) - 1)


_NEXT = (
    "call columns of a row theta_i and d_i, and a and alpha beside them a_{i-1} and alpha_{i-1} where they are of the "
    "link before, as those of link i are beside theta_{i+1} and d_{i+1}"
)
"""What to do about parameters of the link behind: `theta_{i+1}`."""


def _declare_unit(columns: Columns, header: Header, name: str, mark: Mark, problems: list[Problem]) -> None:
    if header.unit is None:
        return
    field_ = FIELDS[name]
    dimensions = [dimension for dimension in (field_.dimension, field_.linear) if dimension]
    problem: Problem | None = None
    for dimension in dimensions:
        try:
            unit = find_unit(header.unit, dimension)
        except QuantityError as error:
            problem = problem or Problem(
                message=error.message,
                mark=mark,
                field=name,
                found=header.unit,
                accepted=error.accepted,
                suggestion=_NEXT if header.unit.replace(" ", "").endswith("+1") else error.suggestion,
            )
        else:
            columns.units.update(dict.fromkeys(parts_of(field_), unit))
            return
    if problem and dimensions == [Dimension.NUMBER]:
        if not is_unit(header.unit):  # `sign [+-1]` is a remark
            return
        message = f"the header has the unit {shown(header.unit)}, and {name} has none"
        problem = replace(problem, message=message, accepted=f"`{name}`, with 1 or -1 in the cells")
    if problem:
        problems.append(problem)


def _missing(name: str, columns: Columns) -> Problem:
    words = ", ".join(FIELDS[name].headers)
    others = [text for text, field_ in zip(columns.headers, columns.fields, strict=True) if text and field_ is None]
    suggestion = f"no field is called {listed([shown(text) for text in others])}" if others else None
    if name == "d" and "offset" in columns.fields:
        suggestion = f"if {shown(columns.header_of('offset'))} is the length along z, call it d"
    is_row_of_field = 1 < len(others) == len(columns.headers) - 1 and all(map(is_number, others))
    if are_joints(columns.headers) or is_row_of_field:
        suggestion = TURN_ROUND
    return Problem(
        message=f"there is no column for {name} in the header",
        mark=columns.mark,
        field=name,
        accepted=f"one of the headers {words}; its unit may follow, as in `{name} "
        f"[{'deg' if name == 'alpha' else 'mm'}]`",
        suggestion=suggestion,
    )


def are_joints(headers: Sequence[str]) -> bool:
    """Whether headers are the joints of an arm, whose fields are in rows."""
    others = [text.strip().casefold() for text in headers[1:] if text.strip()]
    return len(others) > 1 and all(re.fullmatch(_NUMBERED, each) for each in others)


def _negated(text: str, name: str, mark: Mark) -> Problem:
    return Problem(
        message=f"{shown(text)} may be the negative of {name}",
        mark=mark,
        field=name,
        found=text,
        accepted=f"{name}, and its numbers with their signs",
    )


def _foreign_r(columns: Columns) -> list[Problem]:
    """Refuses `r` beside the other letters of Khalil and Kleinfinger, to whom r is what is d here, and d what is a."""
    if "a" not in columns.fields or "d" not in columns.fields:
        return []
    header, other = columns.header_of("a"), columns.header_of("d")
    if not header.casefold().startswith("r"):
        return []
    keys = [read_header(text).key for text in columns.headers]
    letters = [text for text, key in zip(columns.headers, keys, strict=True) if key in _KHALIL]
    letters += [other] if all(re.search(_INDEX_J, each) for each in (header, other)) else []
    if not letters:
        return []
    return [
        Problem(
            message=f"{shown(header)} beside {shown(letters[0])} may be the r of Khalil and Kleinfinger, which is d "
            "here, while their d is a",
            mark=columns.mark,
            field="a",
            found=header,
            accepted="a for the length along x, d for the length along z",
        )
    ]


def _accepted_headers() -> str:
    return ", ".join(FIELDS)
