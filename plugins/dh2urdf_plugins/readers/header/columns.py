"""The headers of a table, whatever its format: which column is which field, in which unit, and what is wrong there."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.quantities import Dimension, QuantityError, Unit, find_unit, is_unit
from dh2urdf.source import Mark, Problem, listed, shown
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.readers.header.header_rows import headers_in
from dh2urdf_plugins.readers.header.unknown_columns import ignored, is_value
from dh2urdf_plugins.readers.header.words import Header, bounds_theta, misspelt, read_header
from dh2urdf_plugins.readers.words.fields import (
    FIELDS,
    IGNORED,
    key_of,
    keys_in,
    parts_of,
    unheld,
    vocabulary,
    words_in,
)

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from dh2urdf.table_text import CellRow

_NUMBERED = r"(?:joint|axis|link|gelenk|achse|axe|articulation|eje|asse|giunto|[ajq])?[\s_.#]*[0-9]{1,2}"
TURN_ROUND = "the joints seem to be in columns: turn the table round, so that each joint has a row"
"""What to do about a table whose header names joints."""
_MINUS = ("-", "−", "–")
SIGMA = {"0": JointType.REVOLUTE, "1": JointType.PRISMATIC, "2": JointType.FIXED}
"""The codes of Khalil and Kleinfinger, which a column σ has. Other codes mean one thing here and another there."""
_TRUTHS = {form: kind for kind in (JointType.REVOLUTE, JointType.PRISMATIC) for form in (kind.value, kind.value[0])}
"""Headers of columns of truth values, with the type that a yes means."""
_NEXT = (
    "call columns of a row theta_i and d_i, and a and alpha beside them a_{i-1} and alpha_{i-1} where they are of the "
    "link before, as those of link i are beside theta_{i+1} and d_{i+1}"
)
"""What to do about parameters of the link behind: `theta_{i+1}`."""


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
        silent: columns that name no field and are left out, as long as they have held nothing.
        modified: the column whose header means the modified convention.
        ignored: columns that their author wants to be left out.
        notices: messages about the header.
        numbers: the columns whose cells are numbers already, or all text.
        of_theta: columns of limits whose headers call them bounds of theta.
        as_written: whether names are as they are written, as in YAML.
        types: what the cells of the column of types mean besides words for types: codes under σ, truth values.
    """

    mark: Mark
    headers: list[str]
    decimal_comma: bool = False
    quoted_commas: bool = False
    fields: list[str | None] = field(default_factory=list)
    units: dict[str, Unit] = field(default_factory=dict)
    marks: list[Mark] = field(default_factory=list)
    silent: set[int] = field(default_factory=set)
    modified: int | None = None
    ignored: set[int] = field(default_factory=set)
    notices: list[Problem] = field(default_factory=list)
    numbers: frozenset[int] = frozenset()
    as_written: bool = False
    of_theta: set[int] = field(default_factory=set)
    types: dict[str, JointType] = field(default_factory=dict)

    @property
    def names(self) -> list[str]:
        """The fields that the columns hold, in their order, those that share cells one by one."""
        return [part for name in self.fields if name for part in parts_of(FIELDS[name])]

    def header_of(self, name: str) -> str:
        """The header of the column that holds a field."""
        holding = (k for k, each in enumerate(self.fields) if each and name in parts_of(FIELDS[each]))
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


def name_columns(  # noqa: C901 - a header after the other
    headers: Sequence[str], marks: Sequence[Mark], mark: Mark, convention: Convention | None = None
) -> Columns:
    """What headers say.

    Args:
        headers: the header of each column.
        marks: the place of each.
        mark: the place of all of them.
        convention: the convention that the table, or an option, declares; None where it is not known yet.

    Raises:
        TableError: everything that is wrong with them.
    """
    columns = Columns(mark, list(headers), marks=list(marks))
    problems: list[Problem] = []
    read = _as_meant(columns, convention, problems)
    first: dict[str, int] = {}
    links: dict[str, int] = {}
    meant: set[str] = set()
    for index, (text, header, place) in enumerate(zip(headers, read, marks, strict=True)):
        columns.fields.append(header.field.name if header.field else None)
        if header.field is None:
            if header.ignored:
                columns.ignored.add(index)
            elif not header.is_known and (near := misspelt(header.key)):
                meant.add(near.name)
                problems.append(_misspelt(text, near.name, place))
            else:
                columns.silent.add(index)
            continue
        name = header.field.name
        if header.field.dimension:
            _measure(columns, header, index, problems)
        keys = ("sign",) if name == "flip" else parts_of(header.field)
        twins = [key for key in keys if first.setdefault(key, index) != index]
        problems += [_twins(columns, index, first[twin], twin) for twin in twins[:1]]
        if header.link == "i-1" and name not in ("a", "alpha"):
            problems.append(_of_link_before(text, name, place))
        elif header.link and name in ("a", "alpha"):
            links[header.link] = index
    columns.modified = links.get("i-1")
    if len(links) > 1:
        problems.append(_mixed_links(columns, links))
    if columns.ignored:
        columns.notices.append(ignored([headers[k] for k in sorted(columns.ignored)], marks[min(columns.ignored)]))
    problems.extend(_missing(name, columns) for name in REQUIRED if name not in {*columns.fields, *meant})
    if problems:
        raise TableError(problems, columns.notices)
    return columns


def _as_meant(columns: Columns, convention: Convention | None, problems: list[Problem]) -> list[Header]:
    """What each header says beside the others: the letters of Khalil and Kleinfinger, a number beside a name, types."""
    texts = columns.headers
    read, counting = list(map(read_header, texts)), number_beside_name(texts)
    beside = parts_beside_theta(texts)
    read = [header._replace(field=None) if text in beside else header for text, header in zip(texts, read, strict=True)]
    held = [header.field.name if header.field else None for header in read]
    letters = [k for k, header in enumerate(read) if header.key == "r" and held[k] == "a"]
    # A column R of truth values: r is no second length beside one that is called a.
    for index, (text, header) in enumerate(zip(texts, read, strict=True)):
        kind = _TRUTHS.get(header.key) if "type" not in held else None
        is_letter = text.strip().isupper() and (held[index] is None or held.count("a") > 1)
        if kind and (len(header.key) > 1 or is_letter):
            other = JointType.PRISMATIC if kind is JointType.REVOLUTE else JointType.REVOLUTE
            flips = vocabulary()["flips"]
            columns.types = dict.fromkeys(words_in(flips["true"]), kind) | dict.fromkeys(
                words_in(flips["false"]), other
            )
            read[index] = header._replace(field=FIELDS["type"])
            letters = [k for k in letters if k != index]
            held[index] = "type"
    if letters and held.count("d") == 1 and held.count("a") == len(letters) == 1:
        of_a, of_d = letters[0], held.index("d")
        others = {header.key for header in read} & {"sigma", "gamma", "mu", "b"}
        if convention is Convention.MODIFIED or (read[of_a].link == read[of_d].link == "i" and others):
            read[of_a], read[of_d] = (
                read[k]._replace(field=FIELDS[name], link=None) for k, name in ((of_a, "d"), (of_d, "a"))
            )
        elif others or "convention" in held:
            problems.append(_foreign_r(columns, texts[of_a]))
    if any(header.key == "sigma" for header in read):
        columns.types = SIGMA
    return [h._replace(field=FIELDS["index"]) if t == counting else h for h, t in zip(read, texts, strict=True)]


def parts_beside_theta(texts: Iterable[str]) -> set[str]:
    """The headers of a constant part of theta in a table or row that has theta itself: they name no field."""
    of_theta = {text for text in texts if read_header(text).field is FIELDS["theta"]}
    parts = {text for text in of_theta if unheld(read_header(text).key)}
    return parts if parts < of_theta else set()


def number_beside_name(texts: Iterable[str]) -> str | None:
    """The header of joints that counts them, in a table that has their names besides: ``Joint`` beside ``Name``."""
    headers = {text: read_header(text) for text in texts}
    keys = {text: header.key for text, header in headers.items() if header.field is FIELDS["joint"]}
    if len(keys) != 2 or any(header.field is FIELDS["index"] for header in headers.values()):  # noqa: PLR2004
        return None
    names = [text for text, key in keys.items() if any(word in key for word in keys_in("rows", "names"))]
    others = [text for text in keys if text not in names]
    return others[0] if len(names) == len(others) == 1 else None


def _misspelt(text: str, name: str, mark: Mark) -> Problem:
    return Problem(
        message=f"no column is called {shown(text)}",
        mark=mark,
        field=text,
        found=text,
        accepted=", ".join(FIELDS),
        suggestion=f"did you mean {name!r}? To ignore this column, start its header with `{IGNORED}`",
    )


def _of_link_before(text: str, name: str, mark: Mark) -> Problem:
    return Problem(
        message=f"{shown(text)}: neither convention takes {name} of the link before",
        mark=mark,
        field=name,
        found=text,
        accepted="a_{i-1} and alpha_{i-1} (the modified convention), with d_i and theta_i",
    )


def _mixed_links(columns: Columns, links: Mapping[str, int]) -> Problem:
    one, other = (shown(columns.headers[links[link]]) for link in ("i-1", "i"))
    return Problem(
        message=f"{one} is of the link before and {other} of the link itself: neither convention mixes them",
        mark=columns.mark,
        field="convention",
        accepted="a_{i-1} and alpha_{i-1} (modified), or a_i and alpha_i (standard)",
    )


def _foreign_r(columns: Columns, header: str) -> Problem:
    return Problem(
        message=f"{shown(header)} may be the r of Khalil and Kleinfinger, which is d here, while their d is a",
        mark=columns.mark,
        field="a",
        found=header,
        accepted="a for the length along x, d for the length along z",
    )


def _twins(columns: Columns, index: int, other: int, name: str) -> Problem:
    """A field that two columns hold."""
    text, first = columns.headers[index], columns.headers[other]
    suggestion = f"to ignore a column, start its header with `{IGNORED}`: '{IGNORED}{text}'"
    if name == "theta":
        suggestion = "if one of them is added to the joint variable, call it offset"
    elif name == "a" and "r" in (key_of(each.casefold()) for each in (text, first)):
        suggestion = "if r is the length along z, call it d; if it is the centre of mass, call it com"
    return Problem(
        message=f"two columns are {name}: {shown(first)} and {shown(text)} (a duplicate)",
        mark=columns.marks[index],
        field=columns.fields[index],
        found=text,
        accepted="one column for each field",
        suggestion=suggestion,
    )


def _measure(columns: Columns, header: Header, index: int, problems: list[Problem]) -> None:
    """Takes the unit of a column of numbers, and refuses a header with a sign."""
    text, mark = columns.headers[index], columns.marks[index]
    if not header.field:
        return
    if text.startswith(_MINUS):
        message, accepted = (
            f"{shown(text)} may be the negative of {header.field.name}",
            f"{header.field.name}, and its numbers with their signs",
        )
        problems.append(Problem(message=message, mark=mark, field=header.field.name, found=text, accepted=accepted))
    if bounds_theta(header):
        columns.of_theta.add(index)
    if header.unit is None:
        return
    faults = []
    for dimension in filter(None, (header.field.dimension, header.field.linear)):
        try:
            unit = find_unit(header.unit, dimension)
        except QuantityError as error:
            faults.append(error)
        else:
            columns.units.update(dict.fromkeys(parts_of(header.field), unit))
            return
    problem = Problem(
        message=faults[0].message,
        mark=mark,
        field=header.field.name,
        found=header.unit,
        accepted=faults[0].accepted,
        suggestion=_NEXT if header.unit.replace(" ", "").endswith("+1") else faults[0].suggestion,
    )
    if header.field.dimension is Dimension.NUMBER:
        if not is_unit(header.unit):  # `sign [+-1]` is a remark
            return
        message = f"the header has the unit {shown(header.unit)}, and {header.field.name} has none"
        problem = replace(problem, message=message, accepted=f"`{header.field.name}`, with 1 or -1 in the cells")
    problems.append(problem)


def _missing(name: str, columns: Columns) -> Problem:
    others = [text for text, held in zip(columns.headers, columns.fields, strict=True) if text and held is None]
    suggestion = f"no field is called {listed([shown(text) for text in others])}" if others else None
    if name == "d" and "offset" in columns.fields:
        suggestion = f"if {shown(columns.header_of('offset'))} is the length along z, call it d"
    is_row_of_field = 1 < len(others) == len(columns.headers) - 1 and all(map(is_value, others))
    if are_joints(columns.headers) or is_row_of_field:
        suggestion = TURN_ROUND
    return Problem(
        message=f"there is no column for {name} in the header",
        mark=columns.mark,
        field=name,
        accepted=f"one of the headers {', '.join(FIELDS[name].headers)}; its unit may follow, as in `{name} "
        f"[{'deg' if name == 'alpha' else 'mm'}]`",
        suggestion=suggestion,
    )


def are_joints(headers: Sequence[str]) -> bool:
    """Whether headers are the joints of an arm, whose fields are in rows."""
    others = [text.strip().casefold() for text in headers[1:] if text.strip()]
    return len(others) > 1 and all(re.fullmatch(_NUMBERED, each) for each in others)
