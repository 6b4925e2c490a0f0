"""The headers of a table, whatever its format: which column is which field, in which unit, and what is wrong there.

Of the columns that name no field those with numbers, units or joint variables are refused, and those of text left out.
"""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.quantities import Dimension, QuantityError, Unit, evaluate, find_unit, is_unit, is_zero
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, listed, shown
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.readers.header.header_rows import headers_in
from dh2urdf_plugins.readers.header.words import Header, misspelt, read_header
from dh2urdf_plugins.readers.words.fields import (
    FIELDS,
    IGNORED,
    Refusal,
    flip_of,
    key_of,
    keys_in,
    unheld,
    vocabulary,
    words_in,
)

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from dh2urdf.quantities import Quantity
    from dh2urdf.table_text import CellRow
    from dh2urdf_plugins.readers.words.cells import Cell, Value
    from dh2urdf_plugins.readers.words.fields import Field

say = Messages(__file__)
Row: TypeAlias = "Sequence[Value]"
"""The cells of a row, one for each column."""

TURN_ROUND = "the joints seem to be in columns: turn the table round, so that each joint has a row"
"""What to do about a table whose header names joints."""
_SIGMA = {"0": JointType.REVOLUTE, "1": JointType.PRISMATIC, "2": JointType.FIXED}
"""The codes of Khalil and Kleinfinger, which a column σ has. Other codes mean one thing here and another there."""
_TRUTHS = {form: kind for kind in (JointType.REVOLUTE, JointType.PRISMATIC) for form in (kind.value, kind.value[0])}
"""Headers of columns of truth values, with the type that a yes means."""
_NUMBER = r"(?:[0-9]+(?:[.,][0-9]+)*|[.,][0-9]+)(?:[eE][-+]?[0-9]+(?![0-9.]))?"
_BETWEEN = frozenset("+-−–—±~〜～…/()[],;*·^²³.:%'\"")
"""Signs that stand between numbers, and around them."""
_DATE = r"\s*(?:[0-9]{4}-[0-9]{1,2}-[0-9]{1,2}|[0-9]{1,2}[./][0-9]{1,2}[./][0-9]{4})\b"
_LONGEST_VARIABLE = 40


@dataclass(slots=True)
class Columns:
    """What the header says: lists with an entry for each column, and what some of them hold."""

    mark: Mark
    headers: list[str]
    decimal_comma: bool = False  # whether a comma may stand for the decimal point
    quoted_commas: bool = False  # whether it may do so in a cell that is a text of its own, in quotes between commas
    fields: list[str | None] = field(default_factory=list)
    units: dict[str, Unit] = field(default_factory=dict)  # by field
    marks: list[Mark] = field(default_factory=list)
    silent: set[int] = field(default_factory=set)  # columns without a field, as long as they have held nothing
    modified: int | None = None  # the column whose header means the modified convention
    ignored: set[int] = field(default_factory=set)  # columns that their author wants to be left out
    numbers: frozenset[int] = frozenset()  # columns whose cells are numbers already, or all text
    as_written: bool = False  # whether names are as they are written, as in YAML
    of_theta: set[int] = field(default_factory=set)  # columns of limits that are called bounds of theta
    types: dict[str, JointType] = field(default_factory=dict)  # codes under σ, and truth values

    @property
    def names(self) -> list[str]:
        """The fields that the columns hold, in their order, those that share cells one by one."""
        return [part for name in self.fields if name for part in FIELDS[name].columns]

    def header_of(self, name: str) -> str:
        """The header of the column that holds a field."""
        pairs = zip(self.headers, self.fields, strict=True)
        return next(header for header, each in pairs if each and name in FIELDS[each].columns)


@dataclass(slots=True)
class Rows:
    """The rows of one manipulator as they are in the file."""

    name: str
    keys: list[Any] = field(default_factory=list)
    cells: list[Row] = field(default_factory=list)  # of the first `MAX_JOINTS`
    count: int = 0
    torn: bool = False  # other rows of the same manipulator stand elsewhere
    nameless: bool = False  # the column of robots is empty in some of them


def name_columns(header: CellRow, ignore: Collection[str] = (), convention: Convention | None = None) -> Columns:
    """What a header says, or everything that is wrong with it; columns of some headers are left out."""
    headers = headers_in(header)
    for name in ignore:
        if name not in headers:
            raise TableError(say("no-column-to-ignore", header.mark, field="ignore", found=name, headers=headers))
    headers = [f"{IGNORED}{text}" if text in ignore else text for text in headers]
    columns = Columns(header.mark, headers, marks=list(header.marks or [header.mark] * len(headers)))
    read = [read_header(text) for text in headers]
    _settle_names(read)
    _settle_types(columns, read)
    problems = _settle_khalil(columns, read, convention) + _take_fields(columns, read) + _links(columns, read)
    if problems:
        raise TableError(problems)
    return columns


def _take_fields(columns: Columns, read: Sequence[Header]) -> list[Problem]:
    """Takes the field of each column, and its unit; what is wrong with one, or with several of one field."""
    columns.fields = [header.field.name if header.field else None for header in read]
    problems, first, given = list[Problem](), dict[str, int](), set(columns.fields)
    for index, (text, place, header) in enumerate(zip(columns.headers, columns.marks, read, strict=True)):
        if header.ignored:
            columns.ignored.add(index)
        elif header.field:
            problems += _measure(columns, header, index)
            keys = ("sign",) if header.field.name == "flip" else header.field.columns
            if twin := next((key for key in keys if first.setdefault(key, index) != index), None):
                other = columns.headers[first[twin]]
                advice = "if one of them is added to the joint variable, call it offset" if twin == "theta" else None
                if twin == "a" and "r" in (key_of(other.casefold()), key_of(text.casefold())):
                    advice = "if r is the length along z, call it d; if it is the centre of mass, call it com"
                about = {"field": header.field.name, "found": text, "suggestion": advice}
                problems.append(say("two-columns", place, name=twin, first=other, **about))
        elif not header.is_known and (near := misspelt(header.key)):
            given.add(near.name)
            problems.append(say("misspelt-header", place, field=text, found=text, meant=near.name, fields=[*FIELDS]))
        else:
            columns.silent.add(index)
    return problems + [_missing(name, columns) for name in REQUIRED if name not in given]


# --- What headers mean beside each other ------------------------------------------------------------------------------


def _named(read: Sequence[Header], name: str) -> list[int]:
    return [index for index, header in enumerate(read) if header.field is FIELDS[name]]


def _put(read: list[Header], index: int, name: str | None) -> None:
    read[index] = read[index]._replace(field=FIELDS[name] if name else None, link=None)


def _settle_names(read: list[Header]) -> None:
    """Gives a constant part of theta beside theta, and `Joint` beside `Name`, the meaning that they have there."""
    of_theta, joints = _named(read, "theta"), _named(read, "joint")
    parts = [index for index in of_theta if unheld(read[index].key)]
    for index in parts if len(parts) < len(of_theta) else ():
        _put(read, index, None)
    numbers = [k for k in joints if not any(word in read[k].key for word in keys_in("rows", "names"))]
    if len(joints) - 1 == len(numbers) == 1 and not _named(read, "index"):
        _put(read, numbers[0], "index")


def _settle_types(columns: Columns, read: list[Header]) -> None:
    """Codes under σ, or truth values under `R` or `prismatic`, where no other column is called a type."""
    if any(header.key == "sigma" for header in read):
        columns.types = _SIGMA
    for index, (text, header) in enumerate(zip(columns.headers, read, strict=True)):
        kind = None if _named(read, "type") else _TRUTHS.get(header.key)
        # A letter R is a length, as r is, but where another column is a.
        is_letter = text.strip().isupper() and (header.field is None or len(_named(read, "a")) > 1)
        if kind and (len(header.key) > 1 or is_letter):
            (other,) = {JointType.REVOLUTE, JointType.PRISMATIC} - {kind}
            flips = vocabulary()["flips"]
            columns.types = dict.fromkeys(words_in(flips["true"]), kind)
            columns.types |= dict.fromkeys(words_in(flips["false"]), other)
            _put(read, index, "type")


def _settle_khalil(columns: Columns, read: list[Header], convention: Convention | None) -> list[Problem]:
    """Takes d for the length and r for the offset in the modified convention, where no column is called a."""
    of_a, of_d = _named(read, "a"), _named(read, "d")
    if not (len(of_a) == len(of_d) == 1 and read[of_a[0]].key == "r"):
        return []
    others = {header.key for header in read} & {"sigma", "gamma", "mu", "b"}
    indexed = read[of_a[0]].link == read[of_d[0]].link == "i"
    if convention is Convention.MODIFIED or (indexed and others):
        _put(read, of_a[0], "d")
        _put(read, of_d[0], "a")
    elif others or _named(read, "convention"):
        return [say("letter-r", columns.mark, field="a", found=columns.headers[of_a[0]])]
    return []


def _links(columns: Columns, read: Sequence[Header]) -> list[Problem]:
    """Takes the column of the link before, which means the modified convention; refuses other links and a mixture."""
    problems, links = list[Problem](), dict[str | None, int]()
    for index, (name, header) in enumerate(zip(columns.fields, read, strict=True)):
        if name in ("a", "alpha"):
            links[header.link] = index
        if name and header.link not in ((None, "i", "i-1") if name in ("a", "alpha") else (None, "i")):
            text = columns.headers[index]
            problems.append(say("other-link", columns.marks[index], field=name, found=text))
    columns.modified = links.get("i-1")
    if {"i", "i-1"} <= links.keys():
        before, own = (columns.headers[links[link]] for link in ("i-1", "i"))
        problems.append(say("mixed-links", columns.mark, field="convention", before=before, own=own))
    return problems


# --- What is wrong with one -------------------------------------------------------------------------------------------


def _measure(columns: Columns, header: Header, index: int) -> list[Problem]:
    """Takes the unit of a column of numbers, and refuses a header with a sign."""
    text, mark, held = columns.headers[index], columns.marks[index], header.field
    if held is None or held.dimension is None:
        return []
    problems = [say("header-with-sign", mark, field=held.name, found=text)] if text.startswith(("-", "−", "–")) else []
    if held.name in ("lower", "upper", "limits") and "theta" in header.key:
        columns.of_theta.add(index)
    unit = _unit(header.unit, held) if header.unit else None
    if isinstance(unit, Unit):
        columns.units |= dict.fromkeys(held.columns, unit)
    elif unit and (held.dimension is not Dimension.NUMBER or is_unit(header.unit or "")):  # `sign [+-1]` has a remark
        about = {"reason": unit.message, "accepted": unit.accepted, "suggestion": unit.suggestion}
        problems.append(say("unit-of-header", mark, field=held.name, found=header.unit, **about))
    return problems


def _unit(text: str, held: Field) -> Unit | QuantityError:
    """The unit that a text is in a column of a field, or why it is none."""
    try:
        return find_unit(text, held.measures())
    except QuantityError as error:
        with suppress(QuantityError):
            return find_unit(text, held.measures(slides=True))
        return error


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
    """Whether headers are the joints of an arm, whose fields are in rows: words for a joint or none, and a number."""
    others = [re.fullmatch(r"(.*?)[0-9]{1,2}", text.strip()) for text in headers[1:] if text.strip()]
    words = keys_in("rows", "joints") | {""}
    return len(others) > 1 and all(match and key_of(match[1].casefold().strip(" #")) in words for match in others)


# --- Columns that no field knows --------------------------------------------------------------------------------------


@lru_cache(maxsize=1024)
def refusal(text: str) -> Refusal:
    """Why a column of a header that names no field is refused where it holds a value."""
    header = read_header(text)
    if meaning := unheld(header.key):
        return meaning._replace(reason=f"is {meaning.reason}, which no column holds")
    fields = FIELDS.values() if header.unit else ()
    names = [each.name for each in fields if each.dimension and isinstance(_unit(header.unit or "", each), Unit)]
    near = misspelt(header.key) if header.key else None
    likely = f"did you mean {near.name!r}?" if near else did_you_mean(text, FIELDS) if len(text) > len("id") else None
    accepted = f"one of the columns {', '.join(names or FIELDS)}" + (f"; {likely}" if likely else "")
    return Refusal("is no field" if text else "has no header", accepted, any_text=False)


def refused(cell: Cell, header: str, number: int) -> Problem | None:
    """What is wrong with a cell of such a column, in the row of a number; None where it says nothing."""
    why, text = refusal(header), cell.text.strip()
    is_no = flip_of(text) is False or is_zero(text)
    if not text or is_no != why.if_no or (why.counts and re.match(rf"(?i)j?{number}\b", text)):
        return None
    said = None if why.any_text else _expression(text)
    variable = said.variable if said and not said.value and said.sign > 0 else None
    is_own = variable is not None and variable.row == number and variable.kind != "d"  # `q1` in the first row
    if not why.any_text and (is_own or not is_value(text)):
        return None
    about = {"reason": why.reason, "accepted": why.accepted, "ignoring": IGNORED + header}
    return say("unknown-column", cell.mark, joint=f"joint_{number}", field=header, found=cell.text, **about)


def is_value(text: str) -> bool:
    """Whether a cell is a number, several, a quantity, or a joint variable, and no text with a number in it."""
    if re.match(_DATE, text):
        return False
    others = re.findall(r"[^\W\d_]+|\S", re.sub(_NUMBER, " ", text)) if re.search("[0-9]", text) else [text]
    if all(word in _BETWEEN or is_unit(word) or word.casefold() in keys_in("rows", "ranges") for word in others):
        return any(map(str.isdigit, text))
    return _expression(text) is not None


def _expression(text: str) -> Quantity | None:
    """The angle or the length that a cell says, or the numbered joint variable; None where it says none."""
    if len(text) <= _LONGEST_VARIABLE and re.search(r"[0-9π]|(?i:^\s*-?pi\s*$)", text):
        for dimension in (Dimension.ANGLE, Dimension.LENGTH):
            with suppress(QuantityError):
                return evaluate(text, dimension, decimal_comma=True)
    return None


def stray_number(text: str, mark: Mark, number: int) -> Problem:
    """A number in a column without a header: it belongs to the table, and may be any field."""
    return say("stray-number", mark, joint=f"joint_{number}", found=text)
