"""The headers of a table, whatever its format: which column is which field, in which unit, and what is wrong there."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.quantities import Dimension, QuantityError, Unit, find_unit, is_unit
from dh2urdf.source import Mark, Messages, Problem, listed, shown
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.readers.header.header_rows import headers_in
from dh2urdf_plugins.readers.header.unknown_columns import ignored, is_value
from dh2urdf_plugins.readers.header.words import Header, bounds_theta, misspelt, read_header
from dh2urdf_plugins.readers.words.fields import FIELDS, key_of, keys_in, parts_of, unheld, vocabulary, words_in

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from dh2urdf.table_text import CellRow

say = Messages(__file__)

_NUMBERED = r"(?:joint|axis|link|gelenk|achse|axe|articulation|eje|asse|giunto|[ajq])?[\s_.#]*[0-9]{1,2}"
TURN_ROUND = "the joints seem to be in columns: turn the table round, so that each joint has a row"
"""What to do about a table whose header names joints."""
SIGMA = {"0": JointType.REVOLUTE, "1": JointType.PRISMATIC, "2": JointType.FIXED}
"""The codes of Khalil and Kleinfinger, which a column σ has. Other codes mean one thing here and another there."""
_TRUTHS = {form: kind for kind in (JointType.REVOLUTE, JointType.PRISMATIC) for form in (kind.value, kind.value[0])}
"""Headers of columns of truth values, with the type that a yes means."""


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
            raise TableError(say("no-column-to-ignore", header.mark, field="ignore", found=name, headers=headers))
    return [f"_{text}" if text in names else text for text in headers]


def name_columns(
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
    read, problems = _Headers(columns), list[Problem]()
    read.settle(convention, problems)
    first: dict[str, int] = {}
    meant: set[str] = set()
    for index, header in enumerate(read.headers):
        text, place = headers[index], marks[index]
        columns.fields.append(header.field.name if header.field else None)
        if header.ignored:
            columns.ignored.add(index)
        elif header.field is None:
            near = None if header.is_known else misspelt(header.key)
            if near:
                meant.add(near.name)
                about: dict[str, Any] = {"meant": near.name, "fields": [*FIELDS]}
                problems.append(say("misspelt-header", place, field=text, found=text, **about))
            else:
                columns.silent.add(index)
        else:
            problems += _measure(columns, header, index)
            problems += _other_link(header, text, place)
            keys = ("sign",) if header.field.name == "flip" else parts_of(header.field)
            twins = [key for key in keys if first.setdefault(key, index) != index]
            problems += [_twins(columns, index, first[twin], twin) for twin in twins[:1]]
    problems += _links(columns, read.headers)
    if columns.ignored:
        columns.notices.append(ignored([headers[k] for k in sorted(columns.ignored)], marks[min(columns.ignored)]))
    problems += [_missing(name, columns) for name in REQUIRED if name not in {*columns.fields, *meant}]
    if problems:
        raise TableError(problems, columns.notices)
    return columns


# --- What headers mean beside each other ------------------------------------------------------------------------------


class _Headers:
    """The headers of a table, each as it is meant beside the others.

    Attributes:
        headers: what each says.
    """

    def __init__(self, columns: Columns) -> None:
        self.columns = columns
        self.headers = [read_header(text) for text in columns.headers]

    def settle(self, convention: Convention | None, problems: list[Problem]) -> None:
        """Gives headers of two meanings the one that they have in this table."""
        of_theta, joints = self._named("theta"), self._named("joint")
        parts = [k for k in of_theta if unheld(self.headers[k].key)] if len(of_theta) > 1 else []
        for index in parts if len(parts) < len(of_theta) else ():  # a constant part of theta, beside theta itself
            self._put(index, None)
        if len(joints) == 2 and not self._named("index"):  # noqa: PLR2004 - `Joint` beside `Name`
            names = [k for k in joints if any(word in self.headers[k].key for word in keys_in("rows", "names"))]
            if len(names) == 1:
                self._put(next(k for k in joints if k not in names), "index")
        self._settle_types()
        problems += self._settle_khalil(convention)

    def _named(self, name: str) -> list[int]:
        """The columns of a field."""
        return [k for k, header in enumerate(self.headers) if header.field is FIELDS[name]]

    def _put(self, index: int, name: str | None) -> None:
        self.headers[index] = self.headers[index]._replace(field=FIELDS[name] if name else None, link=None)

    def _settle_types(self) -> None:
        """Codes under σ, or truth values under `R` or `prismatic`, where no other column is called a type."""
        if any(header.key == "sigma" for header in self.headers):
            self.columns.types = SIGMA
        for index, (text, header) in enumerate(zip(self.columns.headers, self.headers, strict=True)):
            kind = None if self._named("type") else _TRUTHS.get(header.key)
            # A letter R is a length, as r is, but where another column is a.
            is_letter = text.strip().isupper() and (header.field is None or len(self._named("a")) > 1)
            if kind and (len(header.key) > 1 or is_letter):
                other = JointType.PRISMATIC if kind is JointType.REVOLUTE else JointType.REVOLUTE
                flips = vocabulary()["flips"]
                words = dict.fromkeys(words_in(flips["true"]), kind) | dict.fromkeys(words_in(flips["false"]), other)
                self.columns.types = words
                self._put(index, "type")

    def _settle_khalil(self, convention: Convention | None) -> list[Problem]:
        """Takes d for the length and r for the offset in the modified convention, where no column is called a."""
        of_a, of_d = self._named("a"), self._named("d")
        if not (len(of_a) == len(of_d) == 1 and self.headers[of_a[0]].key == "r"):
            return []
        others = {header.key for header in self.headers} & {"sigma", "gamma", "mu", "b"}
        indexed = self.headers[of_a[0]].link == self.headers[of_d[0]].link == "i"
        if convention is Convention.MODIFIED or (indexed and others):
            self._put(of_a[0], "d")
            self._put(of_d[0], "a")
        elif others or self._named("convention"):
            return [say("letter-r", self.columns.mark, field="a", found=self.columns.headers[of_a[0]])]
        return []


def _other_link(header: Header, text: str, mark: Mark) -> list[Problem]:
    """Refuses an index of another link than the row's, but for a and alpha of the link before."""
    name = header.field.name if header.field else ""
    if header.link in (None, "i") or (header.link == "i-1" and name in ("a", "alpha")):
        return []
    return [say("link-before" if header.link == "i-1" else "other-link", mark, field=name, found=text)]


def _links(columns: Columns, headers: Sequence[Header]) -> list[Problem]:
    """Takes the column that means the modified convention, and refuses a mixture of both."""
    links = {header.link: k for k, header in enumerate(headers) if columns.fields[k] in ("a", "alpha")}
    columns.modified = links.get("i-1")
    if not {"i", "i-1"} <= links.keys():
        return []
    before, own = (columns.headers[links[link]] for link in ("i-1", "i"))
    return [say("mixed-links", columns.mark, field="convention", before=before, own=own)]


# --- What is wrong with one -------------------------------------------------------------------------------------------


def _twins(columns: Columns, index: int, other: int, name: str) -> Problem:
    """A field that two columns hold."""
    text, first = columns.headers[index], columns.headers[other]
    advice = "if one of them is added to the joint variable, call it offset" if name == "theta" else None
    if name == "a" and "r" in (key_of(each.casefold()) for each in (text, first)):
        advice = "if r is the length along z, call it d; if it is the centre of mass, call it com"
    about = {"field": columns.fields[index], "found": text, "suggestion": advice}
    return say("two-columns", columns.marks[index], name=name, first=first, **about)


def _measure(columns: Columns, header: Header, index: int) -> list[Problem]:
    """Takes the unit of a column of numbers, and refuses a header with a sign."""
    text, mark, measured = columns.headers[index], columns.marks[index], header.field
    if measured is None or measured.dimension is None:
        return []
    name = measured.name
    problems = [say("header-with-sign", mark, field=name, found=text)] if text.startswith(("-", "−", "–")) else []
    if bounds_theta(header):
        columns.of_theta.add(index)
    faults = []
    for dimension in filter(None, (measured.dimension, measured.linear)) if header.unit else ():
        try:
            unit = find_unit(header.unit or "", dimension)
        except QuantityError as error:
            faults.append(error)
        else:
            columns.units.update(dict.fromkeys(parts_of(measured), unit))
            return problems
    if faults and measured.dimension is Dimension.NUMBER:
        is_remark = not is_unit(header.unit or "")  # `sign [+-1]`
        return problems if is_remark else [*problems, say("unit-of-number", mark, field=name, found=header.unit)]
    for fault in faults[:1]:
        about = {"reason": fault.message, "accepted": fault.accepted, "suggestion": fault.suggestion}
        problems.append(say("unit-of-header", mark, field=name, found=header.unit, **about))
    return problems


def _missing(name: str, columns: Columns) -> Problem:
    others = [text for text, held in zip(columns.headers, columns.fields, strict=True) if text and held is None]
    advice = f"no field is called {listed([shown(text) for text in others])}" if others else None
    if name == "d" and "offset" in columns.fields:
        advice = f"if {shown(columns.header_of('offset'))} is the length along z, call it d"
    is_row_of_field = 1 < len(others) == len(columns.headers) - 1 and all(map(is_value, others))
    if are_joints(columns.headers) or is_row_of_field:
        advice = TURN_ROUND
    about: dict[str, Any] = {"headers": [*FIELDS[name].headers], "unit": "deg" if name == "alpha" else "mm"}
    return say("missing-column", columns.mark, field=name, suggestion=advice, **about)


def are_joints(headers: Sequence[str]) -> bool:
    """Whether headers are the joints of an arm, whose fields are in rows."""
    others = [text.strip().casefold() for text in headers[1:] if text.strip()]
    return len(others) > 1 and all(re.fullmatch(_NUMBERED, each) for each in others)
