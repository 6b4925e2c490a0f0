r"""What a person pastes: cells for the table on the page, or a whole table with a header of its own.

The text may be CSV with tabs, semicolons or commas, a table of Markdown or LaTeX, YAML or JSON, rows of numbers in
brackets, or numbers with spaces between them. A table with a header is written as CSV and read by the reader of tables,
which knows headers, units and conventions.
"""

from __future__ import annotations

import csv
import io
import re
from dataclasses import replace
from itertools import takewhile
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.manipulator import Convention
from dh2urdf_studio.editing.edits import MOST_ROWS, resized, with_cells
from dh2urdf_studio.editing.opening import Opened, tables_of
from dh2urdf_studio.editing.reading import read_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.table_text import TableText

USUAL_UNITS = ("m", "rad")
ORDERS = {
    3: ("a alpha d", "alpha a d", "d a alpha", "a d alpha"),
    4: ("a alpha d theta", "theta d a alpha", "alpha a d theta", "theta a d alpha", "d theta a alpha"),
}
"""Usual orders of columns: of Spong, of the Robotics Toolbox, of Craig, of Universal Robots, of Wikipedia."""
_NO_TABLE = (
    "this is no table\naccepted: cells of a spreadsheet or CSV, a table of Markdown or LaTeX, YAML, JSON, or rows of "
    "numbers in brackets; a robot description is opened as a file"
)
_CODE = re.compile(r"\s*<[?!A-Za-z]|.*[\w)\]]\s*=(?!=)|.*\w\(.*[,'\"]")
"""A line of a program or of XML."""
_YAML = re.compile(r"(?:---\s*\n)?\s*(?:(?:- +)?(?:\{\s*)?[A-Za-z_]\w*:(?:\s|$)|\[?\s*\{\s*[\"'A-Za-z_])")
_COMMA = re.compile(r"([-+−–]?\d+),(\d+)")
_GROUPS = re.compile(r"[-+−–]?[1-9]\d{0,2}(?:,\d{3})+")
"""A number whose commas may separate thousands: the reader asks which."""
_TIMES_PI = re.compile(r"(?<![\w.])(\d+(?:\.\d*)?|\.\d+)(?=\\?(?:π|pi)\b)", re.IGNORECASE)
_NAME = re.compile(r"(?!pi\b)[^\W\d_][\w -]*", re.IGNORECASE)
_VALUE = re.compile(r"[-+−–]?(?:[\d.,]+(?:e[-+]?\d+)?|pi|π|(?:θ|theta|th|q|d)_?\d+)(?!\w)", re.IGNORECASE)
"""How a number or an expression begins."""
_LETTERS = re.compile(r"[^\W\d_]{2,}")
_BODY = re.compile(r"\\begin\{(tabular[*xy]?|longtable|array|[bpv]?matrix)\}(.*?)\\end\{\1\}", re.DOTALL)
_COLUMNS = re.compile(r"\s*(?:\[[^]]*\])?\{(?:[^{}]|\{[^{}]*\})*\}(?:\{(?:[^{}]|\{[^{}]*\})*\})?")
_COMMAND = re.compile(
    r"\\(?:begin|end|label|caption|vspace|small|centering)\b(?:\[[^]]*\])?(?:\{\w*[:\w]*\})?(?:\[[^]]*\])?"
)
_RULE = re.compile(r"\\(?:(?:top|mid|bottom)rule|hline|c(?:mid)?(?:rule|line)(?:\([^)]*\))?\{[^}]*\})|(?<!\\)%.*")
_BARS = re.compile(r"[\s|+:=-]+")
"""A line below the header of a table of Markdown, or between its rows."""
_BRACKETS = re.compile(r"[\[{(]([^\[\]{}()]*[^\[\]{}()\s][^\[\]{}()]*)[\]})]")
_POSE = re.compile(r"^\W*(base|tool):\s*(?:`|\\texttt\{)?\\?(\{.*?)\\?\}[`}]?$", re.IGNORECASE | re.MULTILINE)
_MIXED = re.compile(r"\s*\[[^\[\],]+, ?[^\[\],]+\]")
_UNITS = {"length": re.compile(r"\[(m|cm|mm)\]"), "angle": re.compile(r"\[(rad|deg|°)\]")}
_CONVENTION = re.compile(r"\b(standard|modified) (?:convention|dh parameters)\b", re.IGNORECASE)
_SIGNS = tuple(
    (re.compile(pattern), plain)
    for pattern, plain in (
        (r"\\(?:text|mbox|boldsymbol|emph|(?:math|text)(?:rm|bf|it|sf|tt))\{([^{}]*)\}", r"\1"),
        (r"\\sqrt\s*\{([^{}]*)\}", r"sqrt(\1)"),
        (r"\\[dt]?frac\{(-?[\w.\\]+)\}\{(\d+)\}", r"\1/\2"),
        (r"\\[dt]?frac\{([^{}]*)\}\{([^{}]*)\}", r"(\1)/(\2)"),
        (r"\s*(?:\^\s*\{?\s*\\circ\s*\}?|\\degree(?![a-z])|\\textdegree(?![a-z]))", "°"),
        (r"\s*\\(?:times|cdot)\s*10\s*\^\s*\{?\s*([+-]?\d+)\s*\}?", r"e\1"),
        (r"\\(?:times|cdot)(?![a-z])", "*"),
        (r"\\[,;:! ]|~|\\q?quad(?![a-z])", " "),
        (r"(\d)\s*\\pi(?![a-z])", r"\1*pi"),
        (r"\\(pi|theta|alpha|min|max)(?![a-z])", r"\1"),
        (r"(\*\*|`)(.+?)\1", r"\2"),
        (r"\b(?:np|numpy|math|sp|std)\.|(?<!\\)[{}$]", ""),
        (r"\bM_PI\b", "pi"),
        (r"\\([\\`*_{}\[\]()#+.!|&%$-])", r"\1"),
    )
)
"""Signs of LaTeX, Markdown and programs, and what a person would type."""


class Put(NamedTuple):
    """A table with pasted cells in it, and how many cells found no place."""

    table: TableText
    left_out: int = 0


class PastedText(NamedTuple):
    """The cells of a text, and the lines around them."""

    rows: list[list[str]]
    around: list[str]


def cells_of(text: str) -> list[list[str]]:
    """The cells of a pasted text, line by line; decimal commas become points where they can be nothing else."""
    rows = [[cell.strip() for cell in row] for row in _pasted(text).rows] or [[""]]
    every = [cell for row in rows for cell in row]
    commas = [cell for cell in every if _COMMA.fullmatch(cell)]
    if all(map(_GROUPS.fullmatch, commas)) or any(re.search(r"\d\.\d", cell) for cell in every):
        return rows
    return [[_COMMA.sub(r"\1.\2", cell) if cell in commas else cell for cell in row] for row in rows]


def _pasted(text: str) -> PastedText:
    """The cells of a text, by the first of its separators that it has."""
    text = _TIMES_PI.sub(r"\1*", re.sub(r"\r\n?", "\n", text).rstrip("\n"))
    lines = text.split("\n")
    if re.search(r"(?<!\\)&", text) and ("\\\\" in text or "\\begin{" in text):
        return _latex(text)
    if sum(line.count("|") > 1 for line in lines) > 1 or text.lstrip().startswith("|"):
        barred = [line for line in lines if "|" in line and not _BARS.fullmatch(line)]
        cells = [
            [_plain(cell) for cell in line.strip().removeprefix("|").removesuffix("|").split("|")] for line in barred
        ]
        return PastedText(cells, [line for line in lines if "|" not in line and not _BARS.fullmatch(line)])
    if found := _arrays(text):
        return PastedText(found, [])
    around = [line for line in lines if line.lstrip().startswith("#")]
    lines = [line for line in lines if line not in around]
    for separator in "\t;,":
        if not any(separator in line for line in lines):
            continue
        table: list[list[str]] = list(
            csv.reader(io.StringIO("\n".join(lines)), delimiter=separator, skipinitialspace=True)
        )
        decimal = separator == "," and all(_COMMA.fullmatch(line.strip()) for line in lines)
        if not decimal and (separator != "," or len({len(row) for row in table if row}) == 1):
            around += [row[0] for row in table if len(row) == 1 and len(table) > 1 and max(map(len, table)) > 1]
            wide = [row for row in table if len(row) > 1] or table
            return PastedText([[" ".join(cell.split("\n")) for cell in row] for row in wide], around)
    spaced: list[list[str]] = [
        re.split(r"\s{2,}" if any("  " in line.strip() for line in lines) else r"\s+", line.strip()) for line in lines
    ]
    of_numbers = [row for row in spaced if len(row) > 1 and all(map(_VALUE.match, row[1:]))]
    if of_numbers and len({len(row) for row in of_numbers}) == 1 and (width := len(of_numbers[0])) > 1:
        rows = [row for row in spaced if len(row) == width]
        named = [["", *row] for row in spaced if len(row) == width - 1 and spaced.index(row) == 0]
        others = [" ".join(row) for row in spaced if len(row) != width and ["", *row] not in named and row != [""]]
        if not any(map(str.isdigit, "".join(others))) and "+" not in {cell for row in rows for cell in row}:
            return PastedText(named + rows, around + others)
    return PastedText([[line] for line in lines], around)


def _latex(text: str) -> PastedText:
    bodies = [found[2] for found in _BODY.finditer(text)]
    inner = "\n".join(_COLUMNS.sub("", body, count=1) for body in bodies) if bodies else text
    rows = re.split(r"\\\\(?:\s*\[[^]]*\])?|\\tabularnewline", _RULE.sub("", inner))
    cells = [[_plain(cell) for cell in re.split(r"(?<!\\)&", row)] for row in rows if row.strip()]
    around = _COMMAND.sub("", _BODY.sub("", text)).splitlines() if bodies else []
    return PastedText(cells, [line.strip() for line in around if line.strip("{} \t")])


def _arrays(text: str) -> list[list[str]]:
    """Rows of numbers in brackets, as programs have them; none where the numbers are changed behind the brackets."""
    code = re.sub(r"(?:#|//|%).*", "", text).strip()
    code = re.sub(r"^[\w\s.:<>*\[\]]*=\s*(?:[\w.]*(?:array|mat|[Mm]atrix|tensor|list)\()?|\.\.\.", "", code).rstrip(
        "; "
    )
    code = re.sub(r"(?:,\s*\w+\s*=\s*[\w.]+)?\)$", "", code) if code.count(")") > code.count("(") else code
    if code[:1] not in set("[{(") or code[-1:] not in set("]}),") or ":" in code:
        return []
    groups = _BRACKETS.findall(code)
    if len(groups) == 1 and not re.fullmatch(r"[\[{(]{2}.*", code, re.DOTALL):
        groups = [part for part in re.split(r"[;\n]", groups[0]) if part.strip(" ,")]
    rows = [re.split(r"\s*,\s*" if "," in group else r"\s+", group.strip().strip(",").strip()) for group in groups]
    cells = [[_plain(cell.strip("'\" ")) for cell in row] for row in rows]
    rest = re.sub(r"[\[\]{}(),\s]", "", _BRACKETS.sub("", code)) if len(groups) > 1 and ";" not in code else ""
    return [] if rest or len({len(row) for row in cells}) != 1 or len(cells[0]) == 1 else cells


def _plain(cell: str) -> str:
    """A cell without the signs of LaTeX and Markdown; what is not known stays, and the reader names it."""
    for pattern, plain in _SIGNS:
        cell = pattern.sub(plain, cell)
    return " ".join(cell.split())


def first_field(text: str) -> str:
    """The field of the first cell of a text that is pasted into an empty table: names of joints may come first."""
    return "joint" if _NAME.fullmatch(cells_of(text)[0][0]) else "a"


def orders(text: str) -> list[tuple[str, ...]]:
    """What the columns of cells may be that have no names: of DH parameters alone, or behind names and types."""
    rows = cells_of(text)
    if len({len(row) for row in rows}) > 1:
        return []
    columns = [*zip(*rows, strict=True)]
    names = [*takewhile(lambda cells: all(_NAME.fullmatch(each) and not _VALUE.match(each) for each in cells), columns)]
    usual = ORDERS.get(len(columns) - len(names), ()) if len(names) <= len(("joint", "type")) else ()
    return [(*("joint", "type")[: len(names)], *order.split()) for order in usual]


def whole_tables(
    text: str, catalog: Catalog, convention: str = "", units: tuple[str, str] = USUAL_UNITS
) -> tuple[Opened, ...] | str:
    """The tables of a pasted text with a header; convention and units hold where it names none.

    Returns:
        The tables; none where the text has no header, and so is cells. A message where it has one and cannot be read.
    """
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if _YAML.match("\n".join(lines)):
        if "joints" not in text:
            text = "joints:\n" + "\n".join(f"  {line}" for line in text.splitlines())
        return _read(text, catalog, convention, units, is_yaml=True)
    found = _pasted(text)
    if not _arrays(text) and 2 * sum(map(bool, map(_CODE.match, lines))) > len(lines):
        return _NO_TABLE
    headed = is_headed(found.rows)
    if not headed and not any(map(_LETTERS.search, found.around)):
        return ()
    comments = [
        line if line.lstrip().startswith("#") else f"# {line}" for line in found.around if not _POSE.match(line)
    ]
    around = "\n".join(found.around)
    said = {word.lower() for word in _CONVENTION.findall(around)}
    comments += [f"# convention: {said.pop()}"] if len(said) == 1 and "# convention:" not in around else []
    comments += [f"# {name.lower()}: {pose}}}" for name, pose in _POSE.findall(around)]
    head, *rows = found.rows
    whole = [_MIXED.sub("", name) for name in head]  # the bounds of both kinds of joints have the units of the others
    if whole != head or _POSE.search(around):
        units_said = [
            f"{kind}: {unit[1]}" for kind, pattern in _UNITS.items() if (unit := pattern.search(" ".join(whole)))
        ]
        comments.append(f"# units: {{{', '.join(units_said)}}}".replace("°", "deg"))
    if whole[0] in ("i", "no.") and not all(row[0] for row in rows):  # fixed joints are not counted there
        whole, rows = whole[1:], [row[1:] for row in rows]
    written = io.StringIO()
    csv.writer(written, delimiter="\t", lineterminator="\n").writerows([whole, *rows])
    return _read("\n".join([*comments, written.getvalue()]), catalog, convention, units, is_yaml=False)


def is_headed(rows: Sequence[Sequence[str]]) -> bool:
    """Whether a row of two words or more is above a row with numbers."""
    head = next((row for row in rows if sum(map(bool, row)) > 1), [])
    words = [cell for cell in head if cell]
    below = [cell for row in rows[rows.index(head) + 1 :] for cell in row] if head else []
    return len(words) > 1 and not any(map(_VALUE.match, words)) and any(map(_VALUE.match, below))


def _read(
    text: str, catalog: Catalog, convention: str, units: tuple[str, str], *, is_yaml: bool
) -> tuple[Opened, ...] | str:
    """The tables of a text, in the units of the page where it can be read in them."""
    unread: tuple[Opened, ...] | str = ()
    for declared in _declared(text, units, is_yaml=is_yaml):
        found = tables_of("clipboard.yaml" if is_yaml else "clipboard.csv", declared.encode(), catalog)
        if not isinstance(found, str):
            found = tuple(opened._replace(table=_of(convention, opened.table)) for opened in found)
            if not any(read_whole(_of(Convention.STANDARD, opened.table), catalog).errors for opened in found):
                return found
        unread = found
    return unread


def _of(convention: str, table: TableText) -> TableText:
    """A table in a convention, unless it names one."""
    return replace(table, convention=table.convention or str(convention))


def _declared(text: str, units: tuple[str, str], *, is_yaml: bool) -> Iterator[str]:
    """A text with units declared in it: a reader refuses that where the text names its own. The text itself is last."""
    pairs = [
        f"{kind}: {unit}" for kind, unit in zip(("length", "angle"), units, strict=True) if unit not in USUAL_UNITS
    ]
    for some in (pairs, *([pair] for pair in pairs[:: len(pairs) or 1]), *([pair] for pair in pairs[1:])):
        said = f"units: {{{', '.join(some)}}}"
        if some and not is_yaml:
            yield f"# {said}\n{text}"
        elif some and text.lstrip().startswith("{"):
            yield text.replace("{", f"{{{said}, ", 1)
        elif some:
            begin = found.end() if (found := re.match(r"\s*---.*\n", text)) else 0
            yield f"{text[:begin]}{said}\n{text[begin:]}"
    yield text


def pasted(table: TableText, row: int, field: str, text: str, columns: Sequence[str]) -> Put:
    """The table with the cells of a text put in, from one cell to the right and downwards; rows are added for them."""
    lines = cells_of(text)
    first = columns.index(field)
    table = resized(table, max(len(table.rows), min(row + len(lines), MOST_ROWS)))
    every = {(row + down, first + right): cell for down, line in enumerate(lines) for right, cell in enumerate(line)}
    fitting = {
        (down, columns[right]): cell
        for (down, right), cell in every.items()
        if down < len(table.rows) and right < len(columns)
    }
    return Put(with_cells(table, fitting), sum(map(bool, every.values())) - sum(map(bool, fitting.values())))
