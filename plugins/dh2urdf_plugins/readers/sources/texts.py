r"""Tables in texts that are no CSV: Markdown, LaTeX, columns of blanks, and numbers in brackets as programs have them.

Each becomes rows of cells. What stands around a table becomes comments above it, where the grammar of tables looks for
the convention and the units.
"""

from __future__ import annotations

import csv
import re
from itertools import groupby
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.errors import TableError
from dh2urdf.quantities import is_unit, plain_text
from dh2urdf.source import Mark, Messages
from dh2urdf.table_text import STATEMENTS, CellRow
from dh2urdf_plugins.readers.comments.top import is_header
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.words.bounds import MAX_TEXT
from dh2urdf_plugins.readers.words.comment_lines import MARKERS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

DELIMITERS = {",": "comma", ";": "semicolon", "\t": "tab"}
MAX_HEADER = 100_000
"""Characters of a header, or of a line that is cut into cells one by one."""
_LOOKED_AT = 1000
"""Lines that show the form of a text."""
_FEWEST = 3
"""Numbers in a row of a table."""
_BARS = str.maketrans("│┃║─━═", "|||---") | dict.fromkeys(map(ord, "┌┬┐├┼┤└┴┘╔╦╗╠╬╣╚╩╝"), "+")
_BAR_RULE = r"[\s|+:=-]+"
"""A line below the header of a table of Markdown, or between its rows."""
_KEY = r"\s*(?:- +|\? +)?[\"']?[^\W\d][\w .()-]{0,40}[\"']?\s*:(?:\s|$)|\s*-(?:\s|$)|\s*[\]}{]"
"""A line of YAML."""
_NAME = (
    r"((?:[ \t]*(?:(?:#|import |from ).*)?\n)*+[ \t]*)([^\W\d]\w*[ \t]*=\s*)(?=(?:\[\s*)?\{\s*([\"'])[^\"'\n]*\3\s*:)"
)
"""What a program has before a dictionary or a list of them: ``DH = ``, below its imports."""
_KEY_OF_LIST = r"\s*[\w -]{1,40}:\s*[\[{]"
_ENVIRONMENT = r"\\begin\{(tabular[*xy]?|longtable|tblr|array|[bpvBV]?matrix)\}"
_COMMAND = r"\\(?:begin|end|label|vspace|small|centering|caption)\b(?:\[[^\]]*\])?(?:\{\w*[:\w]*\})?"
_RULE = r"\\(?:(?:top|mid|bottom)rule|hline|c(?:mid)?(?:rule|line)(?:\([^)]*\))?\{[^}]*\})|(?<!\\)%.*"
_ELEMENT = r"\w\s?[(\[{]\s?\d+\s?[)\]}]\s?=\s?\w*\(?\s?$"
"""What stands before a row that is an element of a list: ``L(2) = Link(``."""
_LONGEST_ELEMENT = 60
_GROUP = r"\[([^\[\]{}]*)\]|\{([^\[\]{}]*)\}"
_CHANGED = (
    r"[\]}]\s*\)?\s*(?:\.\s*(?:T\b|\w+\()|'(?=\s*(?:;|$))|[*/+-])|(?:deg2rad|radians|transpose|rad2deg)\(\s*[\[(]"
)
"""What a program does to the numbers of an array."""
_ARGUMENTS = {"tabular*": 2, "tabularx": 2, "tabulary": 2} | dict.fromkeys(
    ("matrix", *map("{}matrix".format, "bpvBV")), 0
)
"""Arguments in braces behind an environment's beginning."""
_POSE = r"\W*(base|tool)\W*:\W*?(\{.*\})\W*"
_MIXED = r"\s*\[[^\[\],]+,[^\[\],]+\]"
_NUMBER = r"[-+−–]?\s*(?:[0-9.]|\\?pi\b|π|np\.|math\.|M_PI|sqrt|[a-zA-Zθα]{1,5}_?\{?[0-9])"


say = Messages(__file__)


class TextTable(NamedTuple):
    """A table of a text: its rows from the top, and the lines around it as comments."""

    rows: list[CellRow]
    around: list[CellRow]


# --- The form of a text -----------------------------------------------------------------------------------------------


def form_of(lines: Sequence[str]) -> str:  # noqa: PLR0911 - one for each form
    """What a text is: ``csv``, ``markdown``, ``latex``, ``yaml`` (which JSON is too), ``listing`` or ``blanks``."""
    some = [line[:MAX_HEADER].translate(_BARS) for line in lines[:_LOOKED_AT] if line.strip()]
    plain = [line for line in some if not line.lstrip().startswith(MARKERS)]
    text = "\n".join(plain)
    if "\\begin{" in text or ("\\\\" in text and "&" in text):
        return "latex"
    if any(line.count("|") > 1 and "-" in line and re.fullmatch(_BAR_RULE, line) for line in plain):
        return "markdown"
    if re.match(r"---(\s|$)|\{\s*[\"'\w]|\[\s*\{\s*[\"'A-Za-z_]", text.lstrip()[:80]) or re.match(_NAME, text):
        return "yaml"
    if any(delimiter_of(line) for line in plain if not re.match(_KEY_OF_LIST, line)) or any(
        line.count('"') % 2 for line in plain
    ):
        return "csv"
    if plain and _has_delimiters(plain) and any(delimiter_of(line) for line in some if line not in plain):
        return "csv"
    if 2 * sum(map(bool, map(re.compile(_KEY).match, plain))) > len(plain):
        return "yaml"
    if len(plain) > 1 and all(line.count("|") > 1 for line in plain):
        return "markdown"
    if (
        re.search(r"[\[{(]", text)
        and re.search(r"[\[{(]\s*[\[{(]?\s*" + _NUMBER, text)
        and not any(is_header(CellRow(_spaced(line, single=False), Mark(file=""))) for line in plain if "  " in line)
    ):
        return "listing"
    return "csv" if not plain or _has_delimiters(plain) else "blanks"


def without_name(text: str) -> str:
    """A text with blanks in place of the name that a program gives to a dictionary, or to a list of them."""
    if match := re.match(_NAME, text):
        above = re.sub(r"(?m)^[ \t]*[if].*", "", match[1])
        return above + " " * len(match[2]) + text[match.end() :]
    return text


def delimiter_of(line: str, separator: str | None = None) -> str | None:
    """The delimiter that makes a header of a line, of all or of a given one; None where none does."""
    if len(line) > MAX_HEADER:
        return None
    signs = [sign for sign in (separator or DELIMITERS) if sign in line]
    found = [sign for sign in signs if is_header(CellRow(split(line, sign), Mark(file="")))]
    return max(found, key=lambda sign: len(fields_in(line, sign)), default=None)


def split(line: str, delimiter: str) -> list[str]:
    """The cells of one line; a space before a quote is none of the cell."""
    lines = [f"{part}\n" for part in line.split("\n")]  # of a cell in quotes, perhaps
    return [cell.strip() for cell in next(csv.reader(lines, delimiter=delimiter, skipinitialspace=True), [])]


def fields_in(line: str, delimiter: str) -> set[str]:
    """The fields that the cells of a line name, if a delimiter is between them."""
    cells = split(line, delimiter) if delimiter in line else [line]
    return {header.field.name for header in map(read_header, cells) if header.field}


def _has_delimiters(lines: Sequence[str]) -> bool:
    """Whether lines have tabs or semicolons, or as many commas each."""
    return any(sign in line for line in lines for sign in "\t;") or (
        "," in lines[0] and len({line.count(",") for line in lines}) == 1
    )


# --- The tables of a text ---------------------------------------------------------------------------------------------


def tables_of(text: str, file: str, form: str) -> list[TextTable]:
    """The tables of a text that has parameters in them: those with a header, or else those with numbers in each row."""
    found = all_tables(text, file, form)
    counts = [
        [sum(re.match(_NUMBER, str(cell)) is not None for cell in row.cells) for row in each.rows] for each in found
    ]
    numbers = [table for table, count in zip(found, counts, strict=True) if min(count) >= _FEWEST]
    return [table for table in found if any(map(is_header, table.rows))] or numbers


def all_tables(text: str, file: str, form: str) -> list[TextTable]:
    """The tables of a text of some form but ``yaml``; of ``csv``, the one without a header."""
    forms = {"latex": _latex, "markdown": _markdown, "listing": _listing, "csv": _cells}
    return [table for table in forms.get(form, _blanks)(text, file) if table.rows]


def grammar_rows(table: TextTable, columns: Sequence[str] | None, file: str) -> Iterator[CellRow]:
    """The rows of a table as the grammar takes them: what is around it, a header, and its rows."""
    head = next((row for row in table.rows if is_header(row)), None)
    rows = table.rows[table.rows.index(head) :] if head else table.rows
    above = [*table.around, *(table.rows[: table.rows.index(head)] if head else [])]
    yield from (row for row in above if not _is_pose(row))
    if head is None:
        yield named_columns(rows, columns, file)
        yield from rows
        return
    if columns:
        raise TableError(say("two-headers", head.mark, field="columns"))
    texts = [re.sub(_MIXED, "", str(cell)) for cell in head.cells]  # bounds in both units have those of the others
    headers, poses = list(map(read_header, texts)), list(filter(_is_pose, table.around))
    if poses or texts != list(head.cells):  # which have the units of the header
        units = dict.fromkeys(header.unit for header in headers if header.unit and is_unit(header.unit))
        yield from [CellRow([f"# units: [{', '.join(units)}]"], head.mark)] if units else ()
    for row in poses:
        match = re.fullmatch(_POSE, str(row.cells[0]), re.IGNORECASE)
        yield CellRow([f"# {match[1].lower()}: {match[2]}" if match else None], row.mark)
    # A first column that numbers the joints that move, and no others, is left out.
    field = headers[0].field
    first = field is not None and field.name == "index" and not all(row.cells and row.cells[0] for row in rows[1:])
    yield CellRow(texts[first:], head.mark, (head.marks or [])[first:])
    for row in rows[1:]:
        yield row if not first else CellRow(row.cells[first:], row.mark, (row.marks or [])[first:])


def named_columns(rows: Sequence[CellRow], columns: Sequence[str] | None, file: str) -> CellRow:
    """The header of rows without one."""
    width = max((len(row.cells) for row in rows), default=0)
    mark = rows[0].mark if rows else Mark(file=file)
    if columns and (not rows or width == len(columns)):
        return CellRow(list(columns), mark, [mark] * len(columns))
    named = f", and --columns names {len(columns)}" if columns else ", and their order is never guessed"
    raise TableError(say("no-names-of-columns", mark, field="columns", width=width, named=named))


def _is_pose(row: CellRow) -> bool:
    return re.fullmatch(_POSE, str(row.cells[0]), re.IGNORECASE) is not None


def _comment(line: str, mark: Mark) -> list[CellRow]:
    """A line around a table as a comment; none where it holds nothing."""
    text = " ".join(line.strip().lstrip("#%/ ").split())
    if len(text) > MAX_TEXT:
        return []
    if pose := re.fullmatch(_POSE, text.replace("`", "").replace("\\", ""), re.IGNORECASE):
        return [CellRow([f"{pose[1]}: {pose[2]}"], mark)]
    is_statement = text.partition(":")[0].strip().casefold() in STATEMENTS  # which is YAML
    text = text if is_statement else plain_text(text)
    return [CellRow([f"# {text}"], mark)] if any(map(str.isalnum, text)) else []


def _row(cells: Sequence[str], mark: Mark) -> CellRow:
    return CellRow([plain_text(cell.strip()) for cell in cells], mark)


# --- Forms ------------------------------------------------------------------------------------------------------------


def _lines(text: str, file: str, *markers: str) -> list[tuple[Mark, str]]:
    """The lines of a text, or those of them that begin with a marker."""
    lines = enumerate(text.split("\n"), start=1)
    return [(Mark(file=file, line=at), line) for at, line in lines if line.lstrip().startswith(markers or "")]


def _cells(text: str, file: str) -> Iterator[TextTable]:
    """Cells with delimiters between them, and without a header."""
    marked = [(mark, line) for mark, line in _lines(text, file) if line.strip()]
    cells = [(mark, line) for mark, line in marked if not line.lstrip().startswith("#")]
    sign = next((sign for sign in ("\t", ";", ",") if cells and sign in cells[0][1]), ",")
    around = [CellRow([line], mark) for mark, line in marked if line.lstrip().startswith("#")]
    yield TextTable([CellRow(split(line, sign), mark) for mark, line in cells], around)


def _markdown(text: str, file: str) -> Iterator[TextTable]:
    """Tables between bars; what is around them holds for each."""
    marked = [(mark, line.translate(_BARS).strip()) for mark, line in _lines(text, file)]
    around = [row for mark, line in marked if "|" not in line and line.strip("-=+ ") for row in _comment(line, mark)]
    for barred, block in groupby(marked, key=lambda each: "|" in each[1]):
        cut = [
            (mark, re.split(r"(?<!\\)\|", line.removeprefix("|").removesuffix("|")))
            for mark, line in (block if barred else ())
            if not re.fullmatch(_BAR_RULE, line)
        ]
        rows = [_row([cell.replace("\\|", "|") for cell in cells], mark) for mark, cells in cut]
        yield TextTable(rows, around)


def _latex(text: str, file: str) -> Iterator[TextTable]:
    """Environments of LaTeX, or rows alone; what is around them holds for each."""
    bodies: list[tuple[int, str]] = []
    outside: list[str] = []
    end, line, unclosed = 0, 1, set[str]()
    for found in re.finditer(_ENVIRONMENT, text):
        name = found[1]
        close = -1 if name in unclosed or found.start() < end else text.find(f"\\end{{{name}}}", found.end())
        if close < 0:
            unclosed |= {name} if found.start() >= end else set()
            continue
        line += text.count("\n", end, found.end())
        outside.append(text[end : found.start()])
        bodies.append((line, _without_columns(text[found.end() : close], _ARGUMENTS.get(name, 1))))
        line, end = line + text.count("\n", found.end(), close), close + len(f"\\end{{{name}}}")
    if bodies:
        plain = re.sub(_COMMAND, "", "\n".join([*outside, text[end:]]))
        plain = re.sub(r"\\(?:texttt|emph|text\w*)\{((?:[^{}\\]|\\.)*)\}", r"\1", plain)
        plain = re.sub(r"\\([&%$#_{}])", r"\1", re.sub(r"(?m)(?<=\S)(?<!\\)%.*$", "", plain)).replace("--", "-")
        around = [row for each in plain.split("\n") for row in _comment(each, Mark(file=file))]
    else:
        around = [row for mark, line in _lines(text, file, "#") for row in _comment(line, mark)]
        text = re.sub(r"(?m)^[^\S\n]*#.*", "", text)
    for start, body in bodies or [(1, text)]:
        rows, line = [], start
        for part in re.split(r"\\\\(?: *\[[^\]\n]*\])?|\\tabularnewline", re.sub(_RULE, "", body)):
            begin = line + part[: len(part) - len(part.lstrip())].count("\n")
            line += part.count("\n")
            if part.strip():
                rows.append(_row(re.split(r"(?<!\\)&", part), Mark(file=file, line=begin)))
        yield TextTable(rows, around)


def _without_columns(body: str, arguments: int) -> str:
    """The body of a table without the arguments at its beginning, which say how its columns look."""
    at = depth = 0
    for at, letter in enumerate(body):
        if depth == 0 and (letter not in "{[ " or (letter == "{" and not arguments)):
            return body[at:]
        arguments -= depth == 0 and letter == "{"
        depth += (letter in "{[") - (letter in "}]")
    return body[at:]


def _listing(text: str, file: str) -> Iterator[TextTable]:
    """Numbers in brackets, as programs have them: a pair of brackets is a row, or has rows between ``;``."""
    comments = _lines(text, file, *MARKERS)
    around = [row for mark, line in comments for row in _comment(line, mark)]
    code = re.sub(r"(?:#|//|%).*", "", text)
    if found := re.search(_CHANGED, code):
        mark = Mark(file=file, line=code.count("\n", 0, found.start()) + 1)
        raise TableError(say("changed-by-a-program", mark, found=found[0].strip()))
    tables: list[list[CellRow]] = []
    end, line = 0, 1
    for group in re.finditer(_GROUP, code):
        between, inner = code[end : group.start()], group[1] or group[2] or ""
        line, end = line + between.count("\n"), group.end()
        if inner.lstrip().startswith("("):  # a list of tuples
            parts = re.findall(r"\(([^()]*)\)", inner)
        else:
            parts = re.split(r"[;\n]", inner.replace("...", "")) if ";" in inner or "," not in inner else [inner]
        items = [part.strip().strip(",").split("," if "," in part else None) for part in parts if part.strip(" \t,")]
        cut = [[cell.strip("'\" ") for cell in each] for each in items]
        rows = [_row(cells, Mark(file=file, line=line)) for cells in cut if len(cells) > 1]
        line += inner.count("\n")
        if rows:
            goes_on = tables and len(tables[-1][0].cells) == len(rows[0].cells)
            is_element = re.search(_ELEMENT, code[max(0, group.start() - _LONGEST_ELEMENT) : group.start()])
            if not goes_on or ("=" in between and len(tables[-1]) > 1 and not is_element):
                tables.append([])
            tables[-1] += rows
    for rows in tables:
        header = next((head for _, line in comments if (head := _names(line, len(rows[0].cells), file))), None)
        yield TextTable([header, *rows] if header else rows, around)


def _names(comment: str, width: int, file: str) -> CellRow | None:
    """A comment that names the columns of a table of numbers: ``# theta, d, a, alpha``."""
    text = comment.strip().lstrip("#%/ ").strip("[]() ")
    for cells in (re.split(r"\s*[,;|&]\s*", text), text.split()):
        row = _row(cells, Mark(file=file))
        if len(cells) == width and is_header(row) and all(read_header(str(cell)).field for cell in row.cells):
            return row
    return None


def _blanks(text: str, file: str) -> Iterator[TextTable]:
    """Columns of blanks: two or more between cells, or one where no cell has one in it."""
    marked = [(mark, line.strip()) for mark, line in _lines(text, file) if line.strip()]
    table: list[CellRow] = []
    for single in (False, True):
        rows = [_row(_spaced(line, single=single), mark) for mark, line in marked if not line.startswith(MARKERS)]
        widths = [len(row.cells) for row in rows]
        width = max(set(widths), key=lambda width: (widths.count(width), width), default=0)
        found = [row for row in rows if len(row.cells) == width or (len(row.cells) == width - 1 and is_header(row))]
        if width > 1 and (any(map(is_header, found)) or not table):
            table = [row if len(row.cells) == width else CellRow(["", *row.cells], row.mark) for row in found]
    kept = {row.mark.line for row in table}
    yield TextTable(table, [row for mark, line in marked if mark.line not in kept for row in _comment(line, mark)])


def _spaced(line: str, *, single: bool) -> list[str]:
    """The cells of a line with blanks between them."""
    return line.split() if single else [cell for cell in re.split(r" {2,}|\t", line.strip()) if cell]
