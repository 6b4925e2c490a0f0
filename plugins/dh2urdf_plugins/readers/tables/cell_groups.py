"""Cells that hold several fields: a range, a centre of mass, an inertia tensor.

Each becomes the texts of its fields, which are then read as if each were in a cell. What can be read in
two ways is refused.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.quantities import MAX_CHARACTERS, is_unit
from dh2urdf.row_fields import COM, INERTIA
from dh2urdf.source import shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf_plugins.readers.words.fields import Field

TENSOR = (("ixx", "ixy", "ixz"), ("ixy", "iyy", "iyz"), ("ixz", "iyz", "izz"))
"""The fields of an inertia tensor, row by row."""
ACCEPTED = {
    "limits": "two bounds, such as '±170', '-170..170', '-190/+45', '-170 to 170' or '[-170, 170]', or the columns "
    "lower and upper",
    "com": "three numbers, such as '[0, -0.02, 0.1]', or the columns com_x, com_y, com_z",
    "inertia": "a matrix, such as '[[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.2]]', or 'diag(0.1, 0.1, 0.2)', or the columns "
    "ixx, iyy, izz, ixy, ixz, iyz",
}
"""What a cell of several fields accepts, by field."""

_BRACKETS = "[](){}<>"
_PLUS_MINUS = r"(?:±|\+\s*/?\s*-|-\s*/\s*\+)\s*(.+)"
_TO = (
    r"\s*(?:…|\.{2,}|[~〜～至到→]|-+>|[≤<]=?[^0-9≤<]{1,9}?[0-9]{0,2}\s*[≤<]=?)\s*|\s+[-–—]\s+(?=[-+])"
    r"|\s+(?:to|bis|up to|jusqu'à|à|a|hasta|fino a|até|до|do)\s+"
)
"""Between two bounds: ``-170 to 170``, ``-170° ≤ θ1 ≤ 170°``, ``-170 – +170``."""
_SPACED = r"(?i)(-(?:(?!\s[-–—]).)*)\s+[-–—]\s+([0-9.πp](?:(?!\s[-–—]).)*)"
"""Two bounds with a dash between spaces, the first of them negative: ``-170 – 170``."""
_FROM = r"(?i)^(?:from|von|de|desde|da|od|от)\s+(?=[-+0-9])"
_DECIMAL_COMMA = r"(?<=[0-9]),(?=(?:[0-9]{1,2}|[0-9]{4,})(?![0-9]))"
_NUMBER = r"[+-]?\s*[0-9]+(?:[.,][0-9]+)?(?:e[+-]?[0-9]+)?"
_PAIR = rf"(?i)({_NUMBER}[^0-9/+,;-]*?)\s*([/÷]|\s(?=[+0-9.]))\s*({_NUMBER}[^0-9/,;]*)"
_DASHED = r"([+-]?\s*[0-9][^+–—-]*)[–—-]\s*([0-9][^+–—-]*)"
_NAMED_PART = r"(?i)([a-z_]+)\s*[:=]\s*((?:[^,;=:]|,(?=[0-9]))+)"
_BEFORE_NAME = r"(?i),(?=\s*[a-z_]+\s*[:=])"
"""A comma between parts that are named; any other one is a decimal sign."""
_DIAGONAL = r"(?i)diag\s*[(\[]([^()\[\]]*)[)\]]"
_UNIT_AT_END = r"[\d.)\]}iIπ]\s*([^\W\d]+[\w·/²*^]*|°)\s*$"
PARTS = {"min": "lower", "max": "upper", "lower": "lower", "upper": "upper", "x": "com_x", "y": "com_y", "z": "com_z"}
PARTS |= {"min_position": "lower", "max_position": "upper", "max_velocity": "velocity", "max_effort": "effort"}
"""The fields that the parts of a cell are called by."""
_ORDERS = "ixx, ixy, ixz, iyy, iyz, izz (URDF), ixx, iyy, izz, ixy, iyz, ixz (the toolboxes)"


class GroupError(NamedTuple):
    """Why a cell is not the fields that it should hold.

    Attributes:
        message: what is wrong.
        suggestion: what to do.
    """

    message: str
    suggestion: str | None = None


def split_cell(field: Field, text: str, *, decimal_comma: bool = False) -> dict[str, str] | GroupError:
    """The texts of the fields that a cell holds; none where it is empty.

    Args:
        field: the field of the cell, which has parts.
        text: the cell.
        decimal_comma: whether a comma may stand for the decimal point, and so separates only with a space behind it.
    """
    plain = text.replace("−", "-").strip()
    if plain.startswith("["):
        plain = plain.replace('"', "")  # texts of a list in YAML
    if not plain:
        return {}
    if len(plain) > MAX_CHARACTERS:
        return GroupError(f"{shown(plain)} has {len(plain)} characters", f"write at most {MAX_CHARACTERS} characters")
    if named := _named_parts(field, plain):
        return named
    if field.name == "limits":
        return _bounds(plain, decimal_comma=decimal_comma)
    if field.name == "com":
        return _vector(plain, decimal_comma=decimal_comma)
    return _tensor(plain, decimal_comma=decimal_comma)


def _named_parts(field: Field, text: str) -> dict[str, str] | None:
    """Parts that are called by their names: ``min: -170, max: 170``, ``x=0, y=0, z=0.1``."""
    inner = text.strip(_BRACKETS)
    texts = inner.split(";") if ";" in text else re.split(_BEFORE_NAME, inner)
    pairs = [match.groups() for part in texts if (match := re.fullmatch(_NAMED_PART, part.strip()))]
    names = [PARTS.get(name.lower(), name.lower()) for name, _ in pairs]
    if len(pairs) < len(texts) or len(set(names)) < len(names) or not set(names) <= set(field.parts):
        return None
    return {name: value.strip() for name, (_, value) in zip(names, pairs, strict=True)}


# --- Bounds -----------------------------------------------------------------------------------------------------------


def _bounds(text: str, *, decimal_comma: bool) -> dict[str, str] | GroupError:
    inner, unit = _without_brackets(re.sub(_FROM, "", text, count=1))
    if match := re.fullmatch(_PLUS_MINUS, inner):
        # Between commas a cell in quotes may have one, too; there three digits behind it may be thousands.
        size = re.sub("(?<=[0-9]),(?=[0-9])" if decimal_comma else _DECIMAL_COMMA, ".", match[1])
        if re.search(r"[+±,;…~]|-|\.\.", size) or not re.search(r"[\w(]", size):  # `±∞`
            return _not_two(text)
        return _both(f"-{match[1]}", match[1], unit)
    pair = re.split(_TO, inner)
    if len(pair) == 1 and (match := re.fullmatch(_SPACED, inner)):
        pair = [match[1], match[2]]
    if len(pair) == 1 and (match := re.fullmatch(_PAIR, inner)):
        pair = [match[1], match[3]]
        if doubt := _doubt(match, text):
            return doubt
    if len(pair) == 1 and re.search("[,;|]", inner):
        pair = _items(inner, decimal_comma=decimal_comma)
    if len(pair) != len(("lower", "upper")) or not all(item.strip() for item in pair):
        return _not_two(text)
    lower, upper = (item.strip() for item in pair)
    if lower.startswith("+") and upper.startswith("-"):
        lower, upper = upper, lower  # `+170/-170`, as makers write it
    return _both(lower, upper, unit)


def _doubt(pair: re.Match[str], text: str) -> GroupError | None:
    """Why two numbers with a sign or a space between them may be no bounds: ``10 20``, ``170/170``."""
    lower, sign, upper = pair[1].strip(), pair[2], pair[3].strip()
    if sign.isspace():
        return None if lower.startswith("-") or upper.startswith("+") else _not_two(text)
    if sign != "/" or not (lower[:1].isdigit() and upper[:1].isdigit() and lower.strip("0.,")):
        return None
    return GroupError(
        f"{shown(text)} may be two bounds, or how far the joint moves to both sides",
        f"write '-{lower}/+{upper}' or '{lower} to {upper}'",
    )


def _both(lower: str, upper: str, unit: str | None) -> dict[str, str]:
    """Two bounds, of which one may name the unit of both."""
    of_lower, of_upper = unit_at_end(lower), unit_at_end(upper)
    behind = unit or (of_upper if not of_lower else None)
    lower = f"{lower} {behind}" if behind and not of_lower else lower
    behind = unit or (of_lower if not of_upper else None)
    upper = f"{upper} {behind}" if behind and not of_upper else upper
    return {"lower": lower, "upper": upper}


def _not_two(text: str) -> GroupError:
    if re.fullmatch(r"[0-9]+(?:[.,][0-9]+)?[^0-9]{0,4}", text):
        return GroupError(
            f"{shown(text)} is one number, and a range has two",
            f"write '±{text}' if the joint moves so far to both sides, or '0..{text}' if it starts at 0",
        )
    dash = re.fullmatch(_DASHED, text)
    return GroupError(
        f"{shown(text)} cannot be read as two bounds",
        f"a dash may be a minus: write '{dash[1].strip()} to {dash[2].strip()}' if it means that" if dash else None,
    )


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
    """The items of a list: by semicolons, commas, bars, or spaces alone."""
    comma = r",\s+|,$" if decimal_comma else ","
    for separator in (";", r"\|", comma):
        if re.search(separator, text):
            return [item.strip() for item in re.split(separator, text.strip().rstrip(",;|")) if item.strip()]
    items = text.split()
    # Between spaces there may be sums, whose signs stand alone.
    return items if all(item.strip("+-*/") for item in items) else [text]


def _vector(text: str, *, decimal_comma: bool) -> dict[str, str] | GroupError:
    inner, unit = _without_brackets(text)
    items = _items(inner, decimal_comma=decimal_comma)
    if len(items) != len(COM):
        count = "one number" if len(items) == 1 else f"{len(items)} numbers"
        return GroupError(f"{shown(text)} holds {count}, and a centre of mass has three")
    return {name: _with_unit(item, unit) for name, item in zip(COM, items, strict=True)}


def _with_unit(item: str, unit: str | None) -> str:
    return f"{item} {unit}" if unit and not unit_at_end(item) else item


# --- Tensors ----------------------------------------------------------------------------------------------------------


def _tensor(text: str, *, decimal_comma: bool) -> dict[str, str] | GroupError:
    if match := re.fullmatch(_DIAGONAL, text):
        items = _items(match[1], decimal_comma=decimal_comma)
        if len(items) == len(TENSOR):
            return dict(zip(INERTIA, [*items, "0", "0", "0"], strict=True))
    inner, unit = _without_brackets(text)
    between, around = r"\]\s*[,;]?\s*\[|\)\s*[,;]?\s*\(|;", _BRACKETS
    if inner.startswith("["):  # then round brackets are those of expressions
        between, around = r"\]\s*[,;]?\s*\[", "[]"
    rows = [row.strip(around + " ,;") for row in re.split(between, inner)]
    items = [item for row in rows if row for item in _items(row, decimal_comma=decimal_comma)]
    size = len(TENSOR)
    if len(items) != size * size:
        return _no_matrix(text, len(items))
    return _tensor_parts([[_with_unit(item, unit) for item in items[k : k + size]] for k in (0, size, 2 * size)])


def _no_matrix(text: str, count: int) -> GroupError:
    if count == len(INERTIA):
        return GroupError(
            f"{shown(text)} holds six numbers, whose order is not known: it may be {_ORDERS}, or another",
            "write the matrix, or a column for each element",
        )
    if count == len(TENSOR):
        return GroupError(f"{shown(text)} holds three numbers", "if it is a diagonal matrix, write diag(…)")
    return GroupError(f"{shown(text)} holds {'one number' if count == 1 else f'{count} numbers'}, not a matrix of 3×3")


def _tensor_parts(rows: Sequence[Sequence[str]]) -> dict[str, str] | GroupError:
    """The elements of a symmetric matrix, of which each pair is given twice."""
    parts: dict[str, str] = {}
    for names, row in zip(TENSOR, rows, strict=True):
        for name, item in zip(names, row, strict=True):
            if not are_equal(parts.setdefault(name, item), item):
                found = f"{name} is {shown(parts[name])} and {shown(item)}"
                return GroupError(f"the inertia tensor is not symmetric: {found}")
    return parts


def are_equal(left: str, right: str) -> bool:
    """Whether two elements of a matrix are the same, as texts or as numbers."""
    try:
        return float(left) == float(right)
    except ValueError:
        return left == right
