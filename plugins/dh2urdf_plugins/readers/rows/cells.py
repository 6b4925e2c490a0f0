"""The cells of the rows of one manipulator: by field, without typesetting, and what is wrong with them as cells.

A cell that holds several fields, such as a range or an inertia tensor, becomes the texts of its fields, which are then
read as if each were in a cell. What can be read in two ways is refused.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import COM, INERTIA
from dh2urdf.quantities import DEGREE_SIGNS, MAX_CHARACTERS, is_unit, is_zero, plain_text, unwrapped
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf_plugins.readers.header.columns import refusal, refused, stray_number
from dh2urdf_plugins.readers.header.header_rows import is_beside, is_number
from dh2urdf_plugins.readers.rows.rows import LABEL, RowReader
from dh2urdf_plugins.readers.words.bounds import MAX_TEXT
from dh2urdf_plugins.readers.words.cells import SPACES, Cell, text_of
from dh2urdf_plugins.readers.words.comment_lines import SPREADSHEET_ERROR
from dh2urdf_plugins.readers.words.fields import FIELDS, GROUPS, any_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.words.cells import Value
    from dh2urdf_plugins.readers.words.fields import Field

_DECIMAL_COMMA = (
    rf"[-+−]?[0-9]*,[0-9]+(?:[eE][-+]?[0-9]+)?\s*(?:[^\W\d_]{{1,3}}|[{DEGREE_SIGNS}])?(?:[/·][^\W\d_]{{1,3}})?"
)
_COMMA = r"[0-9],[0-9]|(?<![0-9]),[0-9]"
_GROUPED, _GROUPED_BY_POINTS = (
    rf"(?<![0-9.,])[1-9][0-9]{{0,2}}(?:{sign}[0-9]{{3}})+(?![0-9])" for sign in (",", r"\.")
)
"""A number whose commas, or points, may separate thousands."""
_BRACKETS = "[](){}<>"
_PLUS_MINUS = r"(?:±|\+\s*/?\s*-|-\s*/\s*\+)\s*(.+)"
_TO = r"\s*(?:…|\.{2,}|[~〜～至到→]|-+>|[≤<]=?[^0-9≤<]{1,9}?[0-9]{0,2}\s*[≤<]=?)\s*|\s+[-–—]\s+(?=[-+])"
"""Between two bounds, besides words: ``-170...170``, ``-170° ≤ θ1 ≤ 170°``, ``-170 – +170``."""
_SPACED = r"(?i)(-(?:(?!\s[-–—]).)*)\s+[-–—]\s+([0-9.πp](?:(?!\s[-–—]).)*)"
"""Two bounds with a dash between spaces, the first of them negative: ``-170 – 170``."""
_COMMA_INSIDE = r"(?<=[0-9]),(?=(?:[0-9]{1,2}|[0-9]{4,})(?![0-9]))"
_BOUND = r"[+-]?\s*[0-9]+(?:[.,][0-9]+)?(?:e[+-]?[0-9]+)?"
_PAIR = rf"(?i)({_BOUND}[^0-9/+,;-]*?)\s*([/÷]|\s(?=[+0-9.]))\s*({_BOUND}[^0-9/,;]*)"
_NAMED_PART = r"(?i)([a-z_]+)\s*[:=]\s*((?:[^,;=:]|,(?=[0-9]))+)"
_BEFORE_NAME = r"(?i),(?=\s*[a-z_]+\s*[:=])"
_DIAGONAL = r"(?i)diag\s*[(\[]([^()\[\]]*)[)\]]"
_UNIT_AT_END = r"[\d.)\]}iIπ]\s*([^\W\d]+[\w·/²*^]*|°)\s*$"
PARTS = {"min": "lower", "max": "upper", "lower": "lower", "upper": "upper", "x": "com_x", "y": "com_y", "z": "com_z"}
PARTS |= {"min_position": "lower", "max_position": "upper", "max_velocity": "velocity", "max_effort": "effort"}
"""The fields that the parts of a cell are called by."""
_TENSOR = ("ixx", "ixy", "ixz", "ixy", "iyy", "iyz", "ixz", "iyz", "izz")
"""The elements of an inertia tensor, row by row."""
say = Messages(__file__)


class CellReader:
    """Tells the cells of one manipulator's rows apart; what reads the rows takes the problems."""

    def __init__(self, columns: Columns, reader: RowReader) -> None:
        self.columns, self.reader = columns, reader
        headers = columns.headers
        self.strays = {k for k, header in enumerate(headers) if not header and not is_beside(k, headers)}
        self.left_out = set[int]()
        self.refused: dict[int, Problem] = {}  # the first cell of each column that is refused
        self.first_counts: dict[int, int | None] = {}  # where a column without a header begins to count
        self.comma: Cell | None = None
        self.point: Cell | None = None  # a number whose point may separate thousands
        self.is_sure = False  # whether a comma cannot separate thousands

    def read(self, row: Sequence[Value], marks: Sequence[Mark], number: int) -> dict[str, Cell] | None:
        """The cells of a row by field, or None where they cannot be told apart."""
        columns, cells = self.columns, dict[str, Cell]()
        for index, (name, value) in enumerate(zip(columns.fields, row, strict=False)):
            if index in columns.ignored:
                continue
            is_name, text = name in ("joint", "link"), text_of(value)
            as_written = is_name and columns.as_written
            cell = Cell(text if as_written else text.strip(SPACES), marks[index], index in columns.of_theta)
            if name is None:
                self._unknown(cell, index, number, cells)
                continue
            if len(cell.text) > MAX_TEXT or "\n" in cell.text:
                code = "cell-too-long" if len(cell.text) > MAX_TEXT else "cell-of-lines"
                start = shown(cell.text.partition("\n")[0])
                self._note(code, cell, name, number, count=len(cell.text), most=MAX_TEXT, start=start)
                return None
            if name == "type" and (kind := columns.types.get(cell.text.casefold())):
                cell = cell._replace(text=kind.value, typed=cell.text)
            if is_name and "#" in cell.text and re.match(SPREADSHEET_ERROR, cell.text):
                self._note("spreadsheet-error", cell, name, number)
            parts = dict.fromkeys(FIELDS[name].columns, cell)
            if name in GROUPS and cell.text:
                comma = columns.decimal_comma
                texts = split_cell(FIELDS[name], cell.text, cell.mark, joint=f"joint_{number}", decimal_comma=comma)
                if isinstance(texts, Problem):
                    self.reader.add(texts)
                    continue
                parts = {part: cell._replace(text=text) for part, text in texts.items()}
            cells |= parts if as_written else {part: self._plain(each, part, value) for part, each in parts.items()}
        return cells

    def _note(self, code: str, cell: Cell, name: str, number: int, **values: Any) -> None:  # noqa: ANN401
        about = {"joint": f"joint_{number}", "field": name, "found": cell.text[:MAX_TEXT]}
        self.reader.add(say(code, cell.mark, **about, **values))

    def _plain(self, cell: Cell, name: str, value: Value) -> Cell:
        """A cell without typesetting, without the name that it defines, and with a point where its comma was one."""
        text, field = cell.text, FIELDS[name]
        if text.isascii() and text.isalnum() and not text.lower().startswith("var"):
            return cell
        if field.dimension is None:
            text = unwrapped(text) if name in ("joint", "link", "robot") else plain_text(text)
        else:
            comma, symbols = self.columns.decimal_comma, self.reader.units.symbols
            text, problem = symbols.take_cell(plain_text(text), cell.mark, decimal_comma=comma)
            if problem:
                self.reader.add(problem)
            if isinstance(value, str):
                text = self._with_point(cell._replace(text=text))
        return cell if text == cell.text else cell._replace(text=text, typed=cell.text)

    # --- Decimal signs ------------------------------------------------------------------------------------------------

    def _with_point(self, cell: Cell) -> str:
        """The text of a number, whose decimal sign is remembered where it may be a comma.

        Between commas a number with a decimal comma is in quotes: so a German spreadsheet writes it.
        """
        text, columns = cell.text, self.columns
        in_quotes = columns.quoted_commas and "," in text and re.fullmatch(_DECIMAL_COMMA, text) is not None
        if columns.decimal_comma or in_quotes or (columns.quoted_commas and "." in text):
            if "," in text and re.search(_COMMA, text):
                self.is_sure |= not re.search(_GROUPED, text)
                self.comma = self.comma or cell
            if "." in text and re.search(_GROUPED_BY_POINTS, text):
                self.point = self.point or cell
        return text.replace(",", ".") if in_quotes else text

    # --- Columns that no field knows ----------------------------------------------------------------------------------

    def _unknown(self, cell: Cell, index: int, number: int, cells: dict[str, Cell]) -> None:
        """Notes that a column that names no field holds something, and refuses values in it."""
        if not cell.text:
            return
        header, problem = self.columns.headers[index], None
        # A number without a header may count the rows: from 0 or 1, or through all manipulators of the table.
        is_count = cell.text.isascii() and cell.text.isdigit() and len(cell.text) <= MAX_TEXT
        before = int(cell.text) - number if is_count else None
        follows = is_count and before == self.first_counts.setdefault(index, before)
        counts = follows and (before in (-1, 0) or (index in self.strays and "robot" in self.columns.fields))
        if not ("type" in self.columns.fields or cell.text.isdigit()):
            cells[f"{LABEL}{header}"] = cell  # which may be its type
        if header and len(cell.text) <= MAX_TEXT and (refusal(header).any_text or not counts):
            problem = refused(cell, header, number)
        elif index in self.strays and is_number(cell.text) and not counts:
            problem = stray_number(cell.text, cell.mark, number)
        if problem:
            self.refused.setdefault(index, problem)
        if index in self.columns.silent and not counts:
            self.left_out.add(index)

    # --- All rows -----------------------------------------------------------------------------------------------------

    def finish(self) -> None:
        """Reports what is wrong with columns and numbers of all rows, and once which columns are left out."""
        self.reader.add(*self.refused.values())
        # `1,250` alone is 1.25 in one country and 1250 in another; beside `0,3` it is 1.25. Beside decimal commas
        # `1.250` is refused for the same reason, and `304.8` is read. Other arms of the file do not matter.
        unclear = self.point if self.is_sure else self.comma
        if self.comma and unclear:
            self.reader.add(say("thousands-perhaps", unclear.mark, found=unclear.text))
        columns, left_out = self.columns, sorted(self.left_out - self.refused.keys())
        found = [index for index in left_out if columns.headers[index] != self.reader.types_from]
        if found:
            first, headers = found[0], columns.headers
            names = [shown(headers[k]) if headers[k] else f"{k + 1} (without a header)" for k in found]
            self.reader.add(say("columns-left-out", columns.marks[first], found=headers[first], names=names))
        columns.silent.difference_update(found)


# --- Cells that hold several fields: a range, a centre of mass, an inertia tensor -------------------------------------


def split_cell(
    field: Field, text: str, mark: Mark | None = None, *, joint: str | None = None, decimal_comma: bool = False
) -> dict[str, str] | Problem:
    """The texts of the fields that a cell holds, or what is wrong with it; none where it is empty.

    A decimal comma separates only with a space behind it.
    """
    about: dict[str, Any] = {"mark": mark, "joint": joint, "field": field.name, "found": text}
    plain = text.replace("−", "-").strip()
    if plain.startswith("["):
        plain = plain.replace('"', "")  # texts of a list in YAML
    if not plain:
        return {}
    if len(plain) > MAX_CHARACTERS:
        return say("cell-too-long", **about, count=len(plain), most=MAX_CHARACTERS)
    inner = plain.strip(_BRACKETS)  # parts that are called by their names: `min: -170, max: 170`, `x=0, y=0, z=0.1`
    texts = inner.split(";") if ";" in plain else re.split(_BEFORE_NAME, inner)
    pairs = [match.groups() for part in texts if (match := re.fullmatch(_NAMED_PART, part.strip()))]
    named = {PARTS.get(name.lower(), name.lower()): value.strip() for name, value in pairs}
    if len(named) == len(texts) and set(named) <= set(field.parts):
        return named
    read = {"limits": _bounds, "com": _vector, "inertia": _tensor}[field.name]
    return read(plain, about, decimal_comma=decimal_comma)


# --- Bounds -----------------------------------------------------------------------------------------------------------


def _bounds(text: str, about: Mapping[str, Any], *, decimal_comma: bool) -> dict[str, str] | Problem:
    before, between = (any_of("rows", line) for line in ("before_bounds", "between_bounds"))
    inner, unit = _without_brackets(re.sub(rf"(?i)^(?:{before})\s+(?=[-+0-9])", "", text, count=1))
    pair = re.split(rf"{_TO}|\s+(?:{between})\s+", inner)
    if match := re.fullmatch(_PLUS_MINUS, inner):
        # Between commas a cell in quotes may have one, too; there three digits behind it may be thousands.
        size = re.sub("(?<=[0-9]),(?=[0-9])" if decimal_comma else _COMMA_INSIDE, ".", match[1])
        is_one = re.search(r"[\w(]", size) and not re.search(r"[+±,;…~]|-|\.\.", size)  # and no `±∞`
        pair = [f"-{match[1]}", match[1]] if is_one else []
    elif len(pair) == 1 and (match := re.fullmatch(_SPACED, inner)):
        pair = [match[1], match[2]]
    elif len(pair) == 1 and (match := re.fullmatch(_PAIR, inner)):
        pair = [match[1].strip(), match[3].strip()]
        if match[2] == "/" and pair[0][:1].isdigit() and pair[1][:1].isdigit() and pair[0].strip("0.,"):
            return say("range-or-travel", **about, text=shown(text), lower=pair[0], upper=pair[1])
        if match[2].isspace() and not (pair[0].startswith("-") or pair[1].startswith("+")):  # `10 20`
            pair = []
    elif len(pair) == 1 and re.search("[,;|]", inner):
        pair = _items(inner, decimal_comma=decimal_comma)
    if len(pair) != len(("lower", "upper")) or not all(item.strip() for item in pair):
        return say("range-unclear", **about, text=shown(text))
    lower, upper = (item.strip() for item in pair)
    if lower.startswith("+") and upper.startswith("-"):
        lower, upper = upper, lower  # `+170/-170`, as makers write it
    of_lower, of_upper = unit_at_end(lower), unit_at_end(upper)  # of which one may be that of both
    return {"lower": _with_unit(lower, unit or of_upper), "upper": _with_unit(upper, unit or of_lower)}


def unit_at_end(text: str) -> str | None:
    """The unit at the end of a number, if there is one."""
    match = re.search(_UNIT_AT_END, text)
    return match[1] if match and is_unit(match[1]) else None


# --- Lists ------------------------------------------------------------------------------------------------------------


def _without_brackets(text: str) -> tuple[str, str | None]:
    """A text without the brackets around it, and the unit that is behind them."""
    match = re.fullmatch(r"([\[({<].*[\])}>])\s*([^\[\](){}<>]*)", text)
    if match is None or (match[2] and not is_unit(match[2])):
        return text, None
    return match[1][1:-1].strip(), match[2] or None


def _items(text: str, *, decimal_comma: bool) -> list[str]:
    """The items of a list: by semicolons, commas, bars, or spaces; beside a decimal point each comma separates."""
    comma = r",\s+|,$" if decimal_comma and not re.search(r"\d\.\d", text) else ","
    for separator in (";", r"\|", comma):
        if re.search(separator, text):
            return [item.strip() for item in re.split(separator, text.strip().rstrip(",;|")) if item.strip()]
    items = text.split()
    # Between spaces there may be sums, whose signs stand alone.
    return items if all(item.strip("+-*/") for item in items) else [text]


def _with_unit(item: str, unit: str | None) -> str:
    return f"{item} {unit}" if unit and not unit_at_end(item) else item


def _vector(text: str, about: Mapping[str, Any], *, decimal_comma: bool) -> dict[str, str] | Problem:
    inner, unit = _without_brackets(text)
    items = _items(inner, decimal_comma=decimal_comma)
    if len(items) != len(COM):
        return say("com-not-three", **about, text=shown(text), count=len(items))
    return {name: _with_unit(item, unit) for name, item in zip(COM, items, strict=True)}


def _tensor(text: str, about: Mapping[str, Any], *, decimal_comma: bool) -> dict[str, str] | Problem:
    if match := re.fullmatch(_DIAGONAL, text):
        items = _items(match[1], decimal_comma=decimal_comma)
        if len(items) == len(COM):
            return dict(zip(INERTIA, [*items, "0", "0", "0"], strict=True))
    inner, unit = _without_brackets(text)
    between, around = r"\]\s*[,;]?\s*\[|\)\s*[,;]?\s*\(|;", _BRACKETS
    if inner.startswith("["):  # then round brackets are those of expressions
        between, around = r"\]\s*[,;]?\s*\[", "[]"
    rows = [row.strip(around + " ,;") for row in re.split(between, inner)]
    items = [item for row in rows if row for item in _items(row, decimal_comma=decimal_comma)]
    if len(items) != len(_TENSOR):
        return say("inertia-no-matrix", **about, text=shown(text), count=len(items))
    parts: dict[str, str] = {}
    for name, item in zip(_TENSOR, (_with_unit(item, unit) for item in items), strict=True):
        if parts.setdefault(name, item) != item and not is_zero(f"{item} - ({parts[name]})"):
            return say("inertia-not-symmetric", **about, name=name, one=shown(parts[name]), other=shown(item))
    return parts
