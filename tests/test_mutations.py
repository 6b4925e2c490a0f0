"""Good tables, damaged: what is still read says what the damaged text says, to a reader that shares nothing with ours.

The tables are those of `random_dialects`: random arms in random random_dialects. The oracle below
is a reader of its own: the standard library's csv module, exact fractions, arithmetic by Python's own grammar, and the
words of the random_dialects. It is sure of what it reads, or says that it is not. Of every damaged table it must hold that

- it is refused, with an error that can be read; or
- the oracle is sure of it, and reads the same arm, number by number; or
- the oracle does not know the words of a header, of a comment or of a type any more: then a notice says that a column is
  left out, or the arm is that of the text without one of the slips, which cannot be meant otherwise (`#C onvention`).

Nothing else is accepted, and nothing is raised but a `TableError`.
"""

import ast
import codecs
import csv
import io
import math
import operator
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from typing import Any

import pytest
import random_dialects
from hypothesis import assume, event, given, settings, strategies as st

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, JointType, Manipulator
from dh2urdf.stages import Rejected

BOMS = {codecs.BOM_UTF8: "utf-8", codecs.BOM_UTF16_LE: "utf-16-le", codecs.BOM_UTF16_BE: "utf-16-be"}


@dataclass(frozen=True)
class Table:
    """A good table: its text, and how it was coded."""

    text: str
    bom: bytes
    encoding: str
    convention: Convention
    rows: int

    def coded(self, text: str) -> bytes:
        return self.bom + text.encode(self.encoding, "surrogatepass")


@st.composite
def tables(draw: st.DrawFn) -> Table:
    rows, convention, content = draw(random_dialects.dialects())
    bom, encoding = next(((bom, name) for bom, name in BOMS.items() if content.startswith(bom)), (b"", "utf-8"))
    text = re.sub("\r\n?", "\n", content[len(bom) :].decode(encoding))
    return Table(text, bom, encoding, convention, len(rows))


# --- The oracle -------------------------------------------------------------------------------------------------------


class UnsureError(Exception):
    """The oracle does not say what a text means."""


class UnknownWordError(UnsureError):
    """What is said in words is said in no words of the dialects any more."""


def plain(word: str) -> str:
    """A header without case and separators."""
    return re.sub(r"[\s_.*{}$\\−-]", "", word.casefold())


def with_index(word: str) -> str:
    """The same of a parameter of the link before, whose index has a sign."""
    return re.sub(r"[\s_.{}()$\\]", "", word.casefold()).replace("−", "-")


HEADERS = {plain(word): field for field, words in random_dialects.HEADERS.items() for word in words}
PREVIOUS = {with_index(word): field for field, words in random_dialects.PREVIOUS.items() for word in words}
PREVIOUS |= {word.replace("i-1", "-1"): field for word, field in PREVIOUS.items()}  # which can mean nothing else
TYPES = {word.casefold(): kind for kind, words in random_dialects.TYPES.items() for word in words}
CONVENTIONS = {"standard": Convention.STANDARD, "dh": Convention.STANDARD, "classic": Convention.STANDARD}
CONVENTIONS |= {"mdh": Convention.MODIFIED, "craig": Convention.MODIFIED}
CONVENTION = re.compile(r"[\W_]*" + r"[\W_]*".join("convention") + r"[\W_]+(.*)", re.IGNORECASE)
"""What nothing else can be either: `#C onvention standard`."""
LENGTHS = {"m": 0, "cm": -2, "mm": -3, "µm": -6, "μm": -6}
ANGLES = {"deg", "°"}
HEADER = re.compile(r"(?P<name>.+?)[\s−-]*(?:[\[(](?P<unit>[^\[\]()]*)[\])]|(?P<loose>°))?")
QUANTITY = re.compile(r"(?P<number>.*?)\s*(?P<unit>mm|cm|[µμ]m|m|deg|°|rad)?", re.IGNORECASE)


@dataclass(frozen=True)
class Number:
    """An exact number of a unit."""

    value: Fraction
    unit: str | None

    def si(self, default: str | None, *, linear: bool) -> float:
        unit = self.unit or default
        if unit is None or unit == ("m" if linear else "rad"):
            return float(self.value)
        if linear and unit in LENGTHS:
            return float(self.value * Fraction(10) ** LENGTHS[unit])
        if not linear and unit in ANGLES:
            return float(self.value / 90) * (math.pi / 2)
        raise UnsureError(f"{unit} of another dimension")


def number(text: str, *, comma: bool) -> Number:
    """What a cell says."""
    match = QUANTITY.fullmatch(text.strip(" \t\u00a0"))
    if not match or not match["number"]:
        raise UnsureError(f"no number: {text!r}")
    sum_ = match["number"].replace("−", "-")
    if comma:
        sum_ = re.sub(r"(?<![0-9.,])([0-9]*),([0-9]+)(?![0-9.,])", r"\1.\2", sum_)
    sum_ = re.sub(r"\s", " ", sum_)
    if not re.fullmatch(r"[-+*/(). 0-9eE]+", sum_) or re.search(r"[0-9.]\s+[0-9.]|\*\s*\*|/\s*/|[-+]\s*[-+]", sum_):
        raise UnsureError(f"no arithmetic: {text!r}")
    sum_ = re.sub(r"(?<![0-9.])0+(?=[0-9])", "", sum_)  # to Python, 007 is no number
    try:
        return Number(exact(ast.parse(sum_.strip(), mode="eval").body), match["unit"] and match["unit"].lower())
    except (SyntaxError, ZeroDivisionError) as error:
        raise UnsureError(f"no arithmetic: {text!r}") from error


OPERATORS: dict[type[ast.AST], Callable[..., Fraction]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


def exact(node: ast.AST) -> Fraction:
    """The value of an arithmetic expression."""
    match node:
        case ast.Constant(value=float() | int() as value) if math.isfinite(value) and abs(value) < 1e30:
            return Fraction(str(value))
        case ast.UnaryOp(op=sign, operand=operand) if type(sign) in OPERATORS:
            return OPERATORS[type(sign)](exact(operand))
        case ast.BinOp(left=left, op=sign, right=right) if type(sign) in OPERATORS:
            return OPERATORS[type(sign)](exact(left), exact(right))
    raise UnsureError("no arithmetic")


@dataclass
class Reading:
    """What the oracle makes of a table."""

    convention: Convention
    rows: list[dict[str, Any]]


def oracle(text: str, *, convention: Convention | None = None) -> Reading:
    lines = text.split("\n")
    top = 0
    for top, line in enumerate(lines):  # noqa: B007 - where the loop ends is what matters
        if match := CONVENTION.match(line):
            convention = CONVENTIONS.get(plain(match[1].split("#")[0]))
        elif is_commented_header(line) or (not line.lstrip().startswith("#") and names_geometry(line)):
            break
    top_line = lines[top].lstrip(" #") if is_commented_header(lines[top]) else lines[top]
    header, delimiter = max(
        (([cell.strip(' "') for cell in next(csv.reader([top_line], delimiter=sign))], sign) for sign in ",;\t"),
        key=lambda found: len(found[0]),
    )
    unknown = list(map(is_unknown, header))
    fields, units = zip(*(named("" if no else cell) for cell, no in zip(header, unknown, strict=True)), strict=True)
    if any("i-1" in str(field) for field in fields):
        convention = Convention.MODIFIED if convention in (None, Convention.MODIFIED) else None
        fields = tuple(str(field).removesuffix(" of i-1") if field else None for field in fields)
    if convention is None or len(set(filter(None, fields))) != len(list(filter(None, fields))):
        raise UnknownWordError("no convention, or two of one field")
    if not {"a", "alpha", "d"} <= set(fields):
        raise UnknownWordError("no geometry")
    all_units = with_followers(dict(zip(fields, units, strict=True)))
    needed = max(k for k, cell in enumerate(header, start=1) if cell)
    rows = []
    body = "\n".join("" if line.lstrip().startswith("#") else line for line in lines[top + 1 :])
    for cells in csv.reader(io.StringIO(body), delimiter=delimiter):
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) < needed or any(cell.strip() for cell in cells[len(header) :]):
            raise UnsureError("a ragged row")
        refuse_unknown(unknown, cells)
        said = {field: cell.strip(" \t\u00a0") for field, cell in zip(fields, cells, strict=False) if field}
        rows.append(meaning(said, all_units, comma=delimiter != ","))
    return Reading(convention, rows)


def with_followers(units: dict[str | None, str | None]) -> dict[str | None, str | None]:
    """The units of the columns; offsets and limits without one follow where all of the geometry has the same."""
    for pair, following in ((("a", "d"), "linear"), (("alpha", "theta"), "angular")):
        said = {units.get(name) for name in pair if name in units}
        units[following] = said.pop() if len(said) == 1 else None
    return units


def names_geometry(line: str) -> bool:
    """Whether a line is a header, and no title above it: it names two of a, alpha, d and theta."""
    cells = [cell.strip(' "') for cell in re.split("[,;\t]", line)]
    words = [match["name"] if (match := HEADER.fullmatch(cell)) else "" for cell in cells]
    fields = {PREVIOUS.get(with_index(word), HEADERS.get(plain(word))) for word in (*words, *cells)}
    return len(fields & {"a", "alpha", "d", "theta"}) > 1


def is_commented_header(line: str) -> bool:
    """Whether a line is a header behind a #, as numpy writes it."""
    if not line.lstrip().startswith("#"):
        return False
    words = [cell.strip(' "') for cell in re.split("[,;\t]", line.lstrip(" #"))]
    return sum(plain(match["name"]) in HEADERS for word in words if (match := HEADER.fullmatch(word))) >= 3


def named(cell: str) -> tuple[str | None, str | None]:
    """The field and the unit of a header."""
    if not cell:
        return None, None
    if with_index(cell) in PREVIOUS:
        return f"{PREVIOUS[with_index(cell)]} of i-1", None
    match = HEADER.fullmatch(cell)
    word = match["name"] if match else ""
    unit = re.sub(r"[\s.*$]", "", match["unit"] or match["loose"] or "").casefold() or None if match else None
    unit = "deg" if unit == "°" else unit
    if unit not in (None, "rad", *LENGTHS, *ANGLES):
        raise UnsureError(f"no unit: {unit}")
    if with_index(word) in PREVIOUS:
        return f"{PREVIOUS[with_index(word)]} of i-1", unit
    if plain(word) not in HEADERS:
        raise UnknownHeaderError(cell)
    return HEADERS[plain(word)], unit


def is_unknown(cell: str) -> bool:
    """Whether a header is no word of the random_dialects."""
    try:
        named(cell)
    except UnknownHeaderError:
        return True
    return False


def refuse_unknown(unknown: list[bool], cells: list[str]) -> None:
    """An empty column has nothing to lose; in another one there is something of which the oracle knows nothing."""
    for cell, is_lost in zip(cells, unknown, strict=False):
        if is_lost and cell.strip():
            raise UnknownHeaderError(cell)


class UnknownHeaderError(UnknownWordError):
    """A header is no word of the dialects any more."""


def meaning(said: dict[str, str], units: dict[str | None, str | None], *, comma: bool) -> dict[str, Any]:
    word = said.get("type") or "R"
    kind = TYPES.get(plain(word) if re.search("[a-zA-Z]", word) else word)
    if kind is None:
        raise UnknownWordError("no type")
    slides = kind is JointType.PRISMATIC

    def value(field: str, *, linear: bool) -> float:
        text = said.get(field, "0") or "0"
        if field == ("d" if slides else "theta") and kind is not JointType.FIXED:
            text = re.sub(r"^\s*q(?=\s*[-+−])", "", text)  # the joint variable, and what is added to it
        follows = field in ("offset", "lower", "upper") and not units.get(field)
        unit = units["linear" if linear else "angular"] if follows else units.get(field)
        return number(text, comma=comma).si(unit, linear=linear)

    row: dict[str, Any] = {"joint": said.get("joint"), "type": kind}
    if not all(said[field] for field in ("a", "alpha", "d")):
        raise UnsureError("geometry is missing")
    row |= {field: value(field, linear=True) for field in ("a", "d")}
    row |= {field: value(field, linear=False) for field in ("alpha", "theta")}
    row |= {"offset": value("offset", linear=slides), "sign": number(said.get("sign") or "1", comma=comma).value}
    if kind in (JointType.REVOLUTE, JointType.PRISMATIC) and (said.get("lower") or said.get("upper")):
        row |= {field: value(field, linear=slides) for field in ("lower", "upper")}
    return row


def same(arm: Manipulator, reading: Reading) -> None:
    """The arm is the one that the oracle reads."""
    assert arm.convention is reading.convention
    assert len(arm.rows) == len(reading.rows)
    for row, wanted in zip(arm.rows, reading.rows, strict=True):
        found: dict[str, Any] = {
            name: getattr(row, name) for name in ("type", "a", "d", "alpha", "theta", "offset", "sign")
        }
        found |= {name: getattr(row.limits, name) for name in ("lower", "upper")}
        for name, value in wanted.items():
            if name == "joint":
                assert value in (None, row.joint)
            elif name == "type":
                assert found[name] is value
            else:
                assert found[name] == pytest.approx(value, rel=1e-12, abs=1e-15), f"{name} of {row.joint}"


# --- What must hold of every damaged table ----------------------------------------------------------------------------


def read(content: bytes) -> list[Manipulator | Rejected] | None:
    """What our reader gives; None where it refuses the file, whose error must be one that can be read."""
    try:
        items: list[Manipulator | Rejected] = random_dialects.read(content)
    except TableError as error:
        assert error.problems
        assert all(problem.severity == "error" and problem.message for problem in error.problems)
        return None
    return items


def check(content: bytes, text: str, others: Iterable[str] = ()) -> None:
    """What must hold of a damaged table.

    Args:
        content: the file.
        text: its text.
        others: the texts without some of the slips.
    """
    items = read(content)
    if items is None:
        event("refused as a file")
        return
    (arm,) = items  # the dialects have no column of manipulators
    if not isinstance(arm, Manipulator):
        assert arm.problems
        event("refused")
        return
    try:
        same(arm, oracle(text))
    except UnknownWordError as error:
        if isinstance(error, UnknownHeaderError) and any("left out" in notice.message for notice in arm.notices):
            event("accepted, with a column left out")
            return
        assert any(is_read_as(arm, other) for other in others), f"accepted without a word: {error}"
        event("accepted, as without a slip")
        return
    event("accepted, and the same to the oracle")


def is_read_as(arm: Manipulator, text: str) -> bool:
    """Whether the arm is the one that the oracle reads in another text."""
    try:
        same(arm, oracle(text))
    except (UnsureError, AssertionError):
        return False
    return True


@given(tables())
@settings(max_examples=100)
def test_the_oracle_reads_every_good_table(table: Table) -> None:
    """Where nothing is damaged, the oracle is sure, and reads what our reader reads."""
    (arm,) = read(table.coded(table.text)) or [None]
    assert isinstance(arm, Manipulator)
    same(arm, oracle(table.text))
    assert len(arm.rows) == table.rows


INSERTED = "0123456789.,;\t\"' -+*/()eEµ°#\n[]{}:_RPq\u00a0\u2212\ufeff\u200b\x00\x1b٣½²"
SLIP = st.sampled_from(["lose", "double", "swap", "replace", "insert"])


def damaged(text: str, slips: Iterable[tuple[int, str, str]]) -> str:
    """A text with slips: where, which, and the character of those that put one in."""
    for where, slip, character in sorted(slips, reverse=True):
        before, here, after = text[:where], text[where : where + 1], text[where + 1 :]
        middle = {
            "lose": "",
            "double": here * 2,
            "swap": after[:1] + here,
            "replace": character,
            "insert": here + character,
        }[slip]
        text = before + middle + (after[1:] if slip == "swap" else after)
    return text


@pytest.mark.long
@given(tables(), st.data())
@settings(max_examples=100)
def test_characters_lost_doubled_swapped_or_replaced(table: Table, data: st.DataObject) -> None:
    """One to three slips of a keyboard, a scanner or an editor, anywhere in the text."""
    places = st.integers(0, max(0, len(table.text) - 2))
    slips = data.draw(st.lists(st.tuples(places, SLIP, st.sampled_from(INSERTED)), min_size=1, max_size=3))
    text = damaged(table.text, slips)
    assume(not text.startswith("\ufeff"))  # a second mark of the encoding
    fewer = (damaged(table.text, some) for count in range(len(slips)) for some in combinations(slips, count))
    check(table.coded(text), text, fewer)


def rewritten(table: Table, change: Callable[[list[list[str]]], None]) -> str:
    """The table with its header and rows changed as cells; what is above stays."""
    lines = table.text.split("\n")
    start = next(k for k, line in enumerate(lines) if line.strip() and not line.startswith("#"))
    delimiter = max(",;\t", key=lambda sign: len(next(csv.reader([lines[start]], delimiter=sign))))
    body = [line for line in lines[start:] if line.strip(delimiter) and not line.startswith("#")]
    cells = list(csv.reader(body, delimiter=delimiter))
    change(cells)
    text = io.StringIO()
    csv.writer(text, delimiter=delimiter, lineterminator="\n").writerows(cells)
    return "\n".join([*lines[:start], text.getvalue()])


def swap(things: list[Any], one: int, other: int) -> None:
    things[one], things[other] = things[other], things[one]


def each(cells: list[list[str]], change: Callable[[list[str]], object]) -> None:
    for line in cells:
        change(line)


Slip = Callable[[list[list[str]], int, int, int], object]
SLIPS: dict[str, Slip] = {
    "lose a row": lambda cells, row, _column, _other: cells.pop(row),
    "double a row": lambda cells, row, _column, _other: cells.insert(row, list(cells[row])),
    "swap rows": lambda cells, row, _column, _other: swap(cells, row, -1),
    "lose a column": lambda cells, _row, column, _other: each(cells, lambda line: line.pop(column)),
    "double a column": lambda cells, _row, column, _other: each(cells, lambda line: line.insert(column, line[column])),
    "swap columns": lambda cells, _row, column, other: each(cells, lambda line: swap(line, column, other)),
    "swap headers": lambda cells, _row, column, other: swap(cells[0], column, other),
    "lose a cell": lambda cells, row, column, _other: cells[row].pop(column),
    "empty a cell": lambda cells, row, column, _other: operator.setitem(cells[row], column, ""),
    "push cells aside": lambda cells, row, column, _other: cells[row].insert(column, ""),
    "copy a cell": lambda cells, row, column, other: operator.setitem(cells[row], column, cells[row][other]),
}


@pytest.mark.long
@given(tables(), st.sampled_from(sorted(SLIPS)), st.data())
@settings(max_examples=300)
def test_cells_rows_and_columns_lost_doubled_or_swapped(table: Table, slip: str, data: st.DataObject) -> None:
    """What a slip in a spreadsheet does: a row or a column too many or too few, two exchanged, a cell pushed aside."""

    def change(cells: list[list[str]]) -> None:
        columns = st.integers(0, len(cells[0]) - 1)
        row = data.draw(st.integers(0, len(cells) - 1), label="row")
        SLIPS[slip](cells, row, data.draw(columns, label="column"), data.draw(columns, label="other column"))

    text = rewritten(table, change)
    check(table.coded(text), text)


@pytest.mark.long
@given(
    tables(), st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "latin-1", "utf-7"])
)
@settings(max_examples=100)
def test_a_file_in_another_encoding(table: Table, encoding: str) -> None:
    """The same text in another encoding is the same arm, or it is refused: letters never become other letters."""
    content = table.text.encode(encoding, "replace")
    if encoding in ("latin-1", "utf-7") and not table.text.isascii():
        items = read(content)
        if encoding == "latin-1":
            assert items is None or content.isascii()
        return
    items = read(content)
    if encoding == "utf-32":
        assert items is None
    elif items is not None:
        (arm,) = items
        assert isinstance(arm, Manipulator)
        same(arm, oracle(table.text))
    else:
        assert encoding in ("utf-16-le", "utf-16-be"), "only UTF-16 without its mark is refused"


@pytest.mark.long
@given(tables(), st.data())
@settings(max_examples=100)
def test_separators_of_thousands_are_never_decimal_points(table: Table, data: st.DataObject) -> None:
    """A length with groups of three digits, as ten countries write them, is refused, or is the number that is meant."""
    whole = data.draw(st.integers(1_000, 9_999_999))
    group = data.draw(st.sampled_from([",", ".", "'", "’", " ", "\u00a0", "\u202f", "_"]))
    point = data.draw(st.sampled_from(["", ".", ","]).filter(lambda point: point != group))
    text = f"{whole:,}".replace(",", group) + (f"{point}5" if point else "")
    decimals: list[str] = []

    def change(cells: list[list[str]]) -> None:
        column = next(k for k, cell in enumerate(cells[0]) if named(cell)[0] in ("d", "d of i-1"))
        cells[1][column] = text
        decimals.extend(re.sub("^j.*", "", cell.strip()) for line in cells[1:] for cell in line)

    written = rewritten(table, change)
    items = read(table.coded(written))
    arm = items[0] if items else None
    if not isinstance(arm, Manipulator):
        return
    # One separator with three digits behind it is a decimal sign, and then the only one of the table.
    assert not point
    assert group in ".,"
    assert text.count(group) == 1
    assert ("," if group == "." else ".") not in "".join(cell for cell in decimals if not cell.isalpha())
    same(arm, oracle(written))
