"""Arrays of programs: lists of tuples, NumPy and SymPy, matrices of MATLAB, braces of C, and Eigen, as cells.

The rows are taken as they stand. A comment that has as many words as a row has cells names the columns.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

_HEAD = r"\s*(?:[\w.:<>*&,\[\]() \t]*;\s*)?[\w.:<>*& \t\[\]]*(?:=(?!=)|<<)\s*"
"""What is before the value: ``dh =``, ``static const double DH[6][4] =``, ``dh <<``."""
_CALL = (
    r"(?i)\s*(?:\w+(?:\.|::))*(?:as)?(?:array|mat|matrix|tensor|list|tuple|sym|double|single|DM|SX|MX)\s*"
    r"\(\s*(?=[\[({])"
)
"""What makes an array, and leaves its numbers as they are: ``np.array(``."""
_TAIL = r"(?:\s|,\s*[A-Za-z_]\w*\s*=\s*[\w.'\"]+|[,;)])*"
"""What is behind it: ``, dtype=float)``."""
_REMARK = r"(?:#|//|%|/\*).*"
_UNIT = r"(?:in )?[\[(]?(m|cm|mm|rad|deg)(?:rees|ians)?[\])]?"
"""A comment that is the unit of the column beside it."""
_OF_A_ROW = (
    r"(?i)(?!.*(?:pris|trans|slid|lin|fix|deg|inch|mod|craig|\b[cm]?m\b))[^\W\d_]{3,}(?:[\s_.-]+\w+){0,2}|[jli]?\s*\d*"
    r"|\d+\s*(?:-+>|→)\s*\d+"
)
"""What a comment says that is only the number of a row, or its name."""
_SYMBOL = r"(?i)(?:a|r|d|alpha|α|theta|θ|th)i?(?![^\W\d_])"
_WORDS = r"[\s,;|&]+"
_COLUMN = r"(?<![\w.])(?:\w++\.)?(\w++)\s*+=\s*(?:(?:\w+\.)?(?:array|list)\()?\[([^\[\]{}=;]*)\]\)?"
_SPELLINGS: tuple[tuple[str, Any], ...] = (
    (r"\bM_PI_([24])\b", r"pi/\1"),
    (r"\bM_PI\b|\bPi\b|\bPI\b", "pi"),
    (r"\b(?:(?:np|numpy|math|sp|sympy|std|torch|jnp|cas|ca)\.|std::)", ""),
    (r"\b(?:deg2rad|radians)\(\s*([-+]?[\d.]+)\s*\)", r"\1°"),
    (r"(?<![\w.])(\d+\.\d*|\.\d+|\d+(?=f))f\b", r"\1"),
    (r"\*\*|\.\*|\./", lambda found: {"**": "^", ".*": "*", "./": "/"}[found[0]]),
)
"""What programs have in numbers, as a person would type it."""
_PAIRS = {"[": "]", "(": ")", "{": "}"}


class CodeArray(NamedTuple):
    """An array of a program.

    Attributes:
        rows: its cells, below the names of the columns where a comment has them.
        around: the comments that are neither those names nor the number of a row.
    """

    rows: list[list[str]]
    around: str = ""


def code_array(text: str) -> CodeArray | None:
    """The array that a text is, with its comments; None where it is none, or its rows differ in length."""
    if not any(sign in text for sign in (*_PAIRS, "<<")) or "\\" in text:
        return None
    lines = [line.replace("...", "") for line in text.splitlines()]
    comments = [found[0].lstrip("#/%* ").rstrip("*/ ") for line in lines if (found := re.search(_REMARK, line))]
    if columns := _columns("\n".join(re.sub(_REMARK, "", line) for line in lines)):
        units = dict(filter(None, map(_unit, lines)))
        heads = [f"{name} [{units[name]}]" if name in units else name for name in columns[0]]
        return CodeArray([heads, *columns[1:]], "\n".join(each for each in comments if not re.fullmatch(_UNIT, each)))
    code = "\n".join(re.sub(_REMARK, "", line) for line in lines).strip()
    head = re.match(_HEAD, code)
    is_stream = head is not None and head[0].rstrip().endswith("<<")
    code = code[head.end() :] if head else code
    while call := re.match(_CALL, code):
        code = code[call.end() :]
    rows = _streamed(code) if is_stream else _rows(code)
    if not rows or len({len(row) for row in rows}) > 1 or len(rows[0]) < 2:  # noqa: PLR2004 - a table
        return None
    cells = [[_plain(cell) for cell in row] for row in rows]
    if not all(cells[0]) or any(sign in cell for row in cells for cell in row for sign in "[]{}=:;'\""):
        return None
    names = next((words for each in comments if len(words := _names(each, cells)) == len(cells[0])), None)
    around = [each for each in comments if _names(each, cells) != names and not re.fullmatch(_OF_A_ROW, each)]
    return CodeArray([names, *cells] if names else cells, "\n".join(around))


def _columns(code: str) -> list[list[str]]:
    """The cells of arrays of one column each, named after it: ``a = [0 1]``, ``alpha = [pi/2 0]``, ``d = [1 0]``."""
    found = re.findall(_COLUMN, code)
    if re.sub(_COLUMN, "", code).strip(" \t\n;,") or not all(re.match(_SYMBOL, name) for name, _ in found):
        return []
    columns = [[name, *map(_plain, _cells(" ".join(cells.split())))] for name, cells in found]
    return [list(row) for row in zip(*columns, strict=True)] if len({len(column) for column in columns}) == 1 else []


def _unit(line: str) -> tuple[str, str] | None:
    """The name of the column of a line, and the unit of which the comment is that is behind it."""
    code, _, remark = line.partition(found[0]) if (found := re.search(_REMARK, line)) else (line, "", "")
    names, unit = re.findall(_COLUMN, code), found and re.fullmatch(_UNIT, found[0].lstrip("#/%* ").rstrip("*/ "))
    return (names[0][0], unit[1]) if unit and len(names) == 1 and not remark else None


def _names(comment: str, cells: list[list[str]]) -> list[str]:
    """The words of a comment where they name the columns: as many as a row has cells, and symbols among them."""
    inner = comment.strip("[](){} ") if comment[:1] in _PAIRS else comment
    words = [word for word in re.split(_WORDS, inner) if word]
    return (
        words if len(words) == len(cells[0]) and sum(re.match(_SYMBOL, word) is not None for word in words) > 1 else []
    )


def _rows(code: str) -> list[list[str]]:
    """The rows of an array without its name and its comments; none where it is none."""
    parts = _parts(code, ",;\n")
    if code[:1] in _PAIRS and (close := _closing(code)) and re.fullmatch(_TAIL, code[close + 1 :]):
        inner = code[1:close]
        if not (items := [item for item in _parts(inner, ",;\n") if item]):
            return []
        if not all(map(_is_group, items)):  # one row, or rows of MATLAB
            lines = [line for line in _parts(inner, ";\n") if line] if code[0] == "[" else []
            return [_cells(line.rstrip(",")) for line in lines]
        return [_cells(item[1:-1]) for item in items]
    items = [item for item in parts if item]
    return [_cells(item[1:-1]) for item in items] if all(map(_is_group, items)) else []  # rows alone


def _streamed(code: str) -> list[list[str]]:
    """The rows that are handed to a matrix of Eigen, line by line."""
    return [_cells(line.strip().rstrip(",;")) for line in code.split("\n") if line.strip()]


def _cells(row: str) -> list[str]:
    """The cells of a row: with commas, or with spaces between them."""
    found = _parts(row, ",") if "," in row else row.split()
    return [cell.strip() for cell in (found[:-1] if found and not found[-1].strip() else found)]


def _parts(text: str, separators: str) -> list[str]:
    """The parts of a text between separators that are in no bracket."""
    parts, depth, start = [], 0, 0
    for place, character in enumerate(text):
        depth += (character in _PAIRS) - (character in _PAIRS.values())
        if character in separators and depth == 0:
            parts.append(text[start:place].strip())
            start = place + 1
    return [*parts, text[start:].strip()]


def _closing(text: str) -> int | None:
    """Where the bracket is closed that a text begins with."""
    depth = 0
    for place, character in enumerate(text):
        depth += (character in _PAIRS) - (character in _PAIRS.values())
        if depth == 0:
            return place if character == _PAIRS[text[0]] else None
    return None


def _is_group(item: str) -> bool:
    """Whether a text is in brackets as a whole."""
    return item[:1] in _PAIRS and _closing(item) == len(item) - 1


def _plain(cell: str) -> str:
    """A cell of a program as a person would type it."""
    if len(cell) > 1 and cell[0] == cell[-1] and cell[0] in "'\"":
        cell = cell[1:-1]
    for pattern, plain in _SPELLINGS if any(map(str.isalpha, cell)) or "*" in cell or "." in cell else ():
        cell = re.sub(pattern, plain, cell)
    return cell
