"""Cells that hold several fields: a range, a centre of mass, an inertia tensor.

Each becomes the texts of its fields, which are then read as if each were in a cell. What can be read in
two ways is refused.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import COM, INERTIA
from dh2urdf.quantities import MAX_CHARACTERS, is_unit, is_zero
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf_plugins.readers.words.fields import any_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf_plugins.readers.words.fields import Field

_BRACKETS = "[](){}<>"
_PLUS_MINUS = r"(?:±|\+\s*/?\s*-|-\s*/\s*\+)\s*(.+)"
_TO = r"\s*(?:…|\.{2,}|[~〜～至到→]|-+>|[≤<]=?[^0-9≤<]{1,9}?[0-9]{0,2}\s*[≤<]=?)\s*|\s+[-–—]\s+(?=[-+])"
"""Between two bounds, besides words: ``-170...170``, ``-170° ≤ θ1 ≤ 170°``, ``-170 – +170``."""
_SPACED = r"(?i)(-(?:(?!\s[-–—]).)*)\s+[-–—]\s+([0-9.πp](?:(?!\s[-–—]).)*)"
"""Two bounds with a dash between spaces, the first of them negative: ``-170 – 170``."""
_DECIMAL_COMMA = r"(?<=[0-9]),(?=(?:[0-9]{1,2}|[0-9]{4,})(?![0-9]))"
_NUMBER = r"[+-]?\s*[0-9]+(?:[.,][0-9]+)?(?:e[+-]?[0-9]+)?"
_PAIR = rf"(?i)({_NUMBER}[^0-9/+,;-]*?)\s*([/÷]|\s(?=[+0-9.]))\s*({_NUMBER}[^0-9/,;]*)"
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
        size = re.sub("(?<=[0-9]),(?=[0-9])" if decimal_comma else _DECIMAL_COMMA, ".", match[1])
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
