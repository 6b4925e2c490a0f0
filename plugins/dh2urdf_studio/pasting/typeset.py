r"""Tables as papers, pages and programs show them: LaTeX, Markdown, boxes, and numbers with spaces, as cells."""

from __future__ import annotations

import html
import re
from itertools import takewhile
from typing import NamedTuple

from dh2urdf.quantities.spellings import DEGREE_SIGNS
from dh2urdf_studio.pasting.arrays import code_array

_BODY = r"(?s)\\begin\{(tabular[*xy]?|longtable|array|[bpv]?matrix)\}(.*?)\\end\{\1\}"
_ARGUMENTS = r"\s*(?:\[[^]]*\]|\{(?:[^{}]|\{[^{}]*\})*\})*"
_RULES = (
    r"\\(?:(?:top|mid|bottom)rule|hline|addlinespace|c(?:mid)?(?:rule|line)(?:\([^)]*\))?\{[^}]*\}"
    r"|(?:row|cell|column)color(?:\[[^]]*\])?\{[^}]*\}(?:\[[^]]*\])*|footnotemark(?:\[[^]]*\])?|tnote\{[^}]*\})"
    r"|(?:~|\s)*\\cite[pt]?\*?(?:\[[^]]*\])*\{[^}]*\}"
)
"""Rules, colours, citations and the marks of footnotes."""
_FOOTNOTE = r"\\(?:table)?footnote(?:\[[^]]*\])?\{((?:[^{}]|\{[^{}]*\})*)\}"
_STACK = r"\\(?:makecell|thead|shortstack)(?:\[[^]]*\])?\{((?:[^{}]|\{[^{}]*\})*)\}"
"""A cell of several lines."""
_SPAN = r"\\multicolumn\{\s*(\d{1,2})\s*\}\{[^{}]*\}\{((?:[^{}]|\{[^{}]*\})*)\}"
"""A cell over several columns, which are those of what follows it."""
_COMMENT = r"(?<!\\)%.*"
_NEW_ROW = r"(?:\\\\|\\tabularnewline)(?:\s*\[-?[\d.]+ *[a-z]+\])?"
_COMMAND = (
    r"\\(?:(?:begin|end|label|vspace|hspace|footnotesize|small)\*?(?:\[[^]]*\])?\{[^}]*\}(?:\[[^]]*\])?|[A-Za-z]+)"
)
_CELL = r"(?<!\\)&"
_BAR = r"(?<!\\)\|"
_RULE = r"\|?(?:\s*:?-+:?\s*[|+])+\s*(?::?-+:?)?\s*\|?\s*"
"""The line below the header of a table of Markdown, or of Org."""
_TERM = (
    rf"(?:(?:\d+(?:[.,]\d*)?|[.,]\d+)(?<!,)(?:e[-+]?\d+)?[{DEGREE_SIGNS}]?"
    r"|(?:\d*\*?)?(?:pi|π)(?:/\d+)?|(?:[θqd]|theta|th)_?\d+\*?)"
)
_NUMBER = rf"(?i)[-+−–‒‐‑±]?{_TERM}(?:[-+−–‒]{_TERM})*"
_BOX = str.maketrans(dict.fromkeys("│┃║┌┬┐├┼┤└┴┘╔╦╗╠╬╣╚╩╝╒╤╕╞╪╡╘╧╛╭╮╰╯", "|") | dict.fromkeys("─━═", "-") | {"⍺": "α"})
"""The lines of a table in a terminal, as those of Markdown; the Robotics Toolbox writes the α of APL."""
_LINES = r"[=\-_+ ]*[=\-_]{3}[=\-_+ ]*"
"""A line that rules a table off, as reStructuredText, MATLAB and others have it."""
_SENTENCE = r"[^\t]*[^\t.:][.:]|(?:[^\s:]+ +){3,}[^\s:]+|[^\t:]+: [^\t]+"
"""What no joint is called, in the only cell of a row that is not empty: ``All lengths in mm``, ``Source: [3]``."""
_JOINT = r"(?i)^(joint|link|axis)\s+(\d+)(?=\s)"
"""The name of a row that is two words."""
_GAP = r"\s{2,}"
_UNIT_APART = r"\s+(?=[\[(][^\s\])]*[\])](?:\s|$))"
"""The space before a unit: ``a (mm)`` is one header."""
_SIGN_APART = r"(?:((?:[θq]|theta)_?\d+\*?)\s+|(?<=\s))([-+−–‒])\s+(?=[\d.πp])"
"""A sign with spaces beside it, as copies of PDFs have it: ``– 0.425``, ``θ3 – π/2``."""
_POSE = r"(?im)^\s*(base|tool):\s*(\S.*)$"
_UNIT = r"\[(?:(m|cm|mm)|(rad|deg|°))\]"
_MIXED = r"\s*\[(?:(?:rad|deg|°), ?(?:m|cm|mm)|(?:m|cm|mm), ?(?:rad|deg|°))\]"
"""The unit of a column that has bounds of joints of both kinds."""
_OF_VARIABLES = r"(?i)(?:θ|theta|d)(?![^\W\d_])"
"""A column that may have variables of joints."""
_LOWERED = str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789")
_CONVENTION = r"(?i)\b(standard|modified) (?:convention|dh parameters)\b"
_MARKS = (
    (r"(?i)<br *?/?>", " "),
    (r"(?i)(?<=[\d)])<sup(?: [^<>]*)?>\s*(?:[oº°∘]|&deg;)\s*</sup>", "°"),
    (r"(?i)(?<=[\d)])<sup(?: [^<>]*)?>(?=\s*[-+−\w])", "^"),  # a footnote or a power, and no digit more
    (r"(?i)</?(?:sub|sup|b|i|em|strong|code|var|span|math)(?: [^<>]*)?/?>", ""),
    (r"(?i)(\*\*|__|`)(.+?)\1", r"\2"),
    (r"(?i)(?<![\w*])([*_])([^*_\s][^*_]*)\1(?![\w*])", r"\2"),
)
"""Bold, slanted and lowered text in a cell of Markdown, and formulas of MediaWiki."""
_JIRA_HEAD = r"\|\|(?:[^|]+\|\|)+"
"""A header of Jira and Confluence."""
_JIRA = r"\|\|"
_WIKI_CELL = r"\|\||!!"
_ATTRIBUTES = r"\s*+(?:[\w-]++\s*+=\s*+(?:\"[^\"]*+\"|[\w-]++)\s*+)++\|"
"""What is before a cell of MediaWiki: ``style="text-align:right" |``."""
_ASCIIDOC_CELL = r"\s(?:(\d{1,2})\+)?[<^>]?(?:\.[<^>])?[adehlms]?\|"
"""The beginning of a cell of AsciiDoc, with the columns that it spans, its place and its style: ``2+^h|``."""
_ASCIIDOC_COLUMNS = r"(?m)^\[.*\bcols=\"?([^\"\]]+)"
_ATTRIBUTE_LINE = r"\[.*\]"
_MACRO = r"(?:stem|latexmath|asciimath):\[([^]]*)\]"
_SIUNITX = {
    r"milli\s*\\met(?:re|er)|mm": "mm",
    r"centi\s*\\met(?:re|er)|cm": "cm",
    r"newton\s*\\met(?:re|er)": "Nm",
    r"met(?:re|er)|m": "m",
    r"radian|rad": "rad",
    r"degree": "°",
    r"kilogram|kg": "kg",
    r"newton|N": "N",
    r"per\s*\\s(?:econd)?": "/s",
}
"""Units of the package siunitx."""
_PART = r"(?:\{([^{}]*)\}|(\\pi(?![a-z])|π|[0-9a-zA-Z]))"
"""A part of a fraction: in braces, or without them where it is one sign."""
_FORMULAS = (
    (r"\\multirow\{[^{}]*\}\{[^{}]*\}\{((?:[^{}]|\{[^{}]*\})*)\}", r"\1"),
    (r"\\(?:text|mbox|boldsymbol|bm|emph|(?:math|text)(?:rm|bf|it|sf|tt))\{((?:\\.|[^{}])*)\}", r"\1"),
    (r"^\\\((.*)\\\)$", r"\1"),
    (r"\\sqrt\s*\{([^{}]*)\}", r"sqrt(\1)"),
    (rf"\\(?:[dts]|nice)?frac\s*{_PART}\s*{_PART}", r"\\frac{\1\2}{\3\4}"),
    (r"\\frac\{(-?[\w.\\]+)\}\{(\d+(?:\.\d+)?|\\?[a-zA-Zπ]+)\}", r"\1/\2"),
    (r"\\frac\{([^{}]*)\}\{([^{}]*)\}", r"(\1)/(\2)"),
    *((rf"\\(?:{macro})(?![a-z])", unit) for macro, unit in _SIUNITX.items()),
    (r"\\ang\{([^{};]*)\}", r"\1°"),
    (r"\\(?:num|si|unit)(?:\[[^]]*\])?\{([^{}]*)\}", r"\1"),
    (r"\\(?:SI|qty)(?:\[[^]]*\])?\{([^{}]*)\}\{([^{}]*)\}", r"\1 \2"),
    (r"\s*(?:\^\s*\{?\s*\\circ\s*\}?|\\degree(?![a-z])|\\textdegree(?![a-z]))", "°"),
    (r"\s*\\(?:times|cdot)\s*10\s*\^\s*\{?\s*([+-]?\d+)\s*\}?", r"e\1"),
    (r"\\(?:times|cdot)(?![a-z])", "*"),
    (r"\\(?:left|right)(?![a-z])", ""),
    (r"\\[,;:! ]|~|\\q?quad(?![a-z])", " "),
    (r"\s*\^\s*\{?\s*(?:\*|\\(?:ast|star)(?![a-z]))\s*\}?", "*"),
    (r"(\d)\s*(?:\\pi(?![a-z])|π)", r"\1*pi"),
    (r"\\(pi|theta|alpha|min|max)(?![a-z])", r"\1"),
    (r"(?<!\\)[{}$]", ""),
    (r"\\([\\`*_{}\[\]()#+.!|&%$-])", r"\1"),
)


class Typeset(NamedTuple):
    """A table of a text.

    Attributes:
        rows: its cells, as a person would type them.
        around: the text before and after it.
    """

    rows: list[list[str]]
    around: str = ""

    @property
    def says_more(self) -> bool:
        """Whether words are around the table, commands of LaTeX aside."""
        return any(map(str.isalpha, re.sub(_COMMAND, "", self.around)))

    def as_csv(self) -> str:
        """The table as the reader of CSV files takes it, with tabs, and with what the text around it declares."""
        titles = list(takewhile(lambda row: sum(map(bool, row)) == 1 < len(row), self.rows[:-1]))
        named, *rows = self.rows[len(titles) :]
        heads = [re.sub(_MIXED, "", head) for head in named]
        around = [line.strip() for line in self.around.splitlines() if line.strip()]
        lines = [line if line.startswith("#") else f"# {line}" for line in around if not re.match(_POSE, line)]
        said = {word.lower() for word in re.findall(_CONVENTION, self.around)}
        lines += [f"# convention: {said.pop()}"] if len(said) == 1 else []
        poses = [f"# {name.lower()}: {_pose(pose)}" for name, pose in re.findall(_POSE, self.around)]
        if poses or heads != named:  # which have the units of the other columns
            units = zip(("length", "angle"), zip(*re.findall(_UNIT, " ".join(heads)), strict=True), strict=False)
            said_units = [
                f"{name}: {max(found).replace('°', 'deg')}" for name, found in units if len({*found} - {""}) == 1
            ]
            lines += [f"# units: {{{', '.join(said_units)}}}"] if said_units else []
        # Where axes are counted, a fixed joint has no number; rows are counted without the column.
        if heads[0] in {"i", "no."} and not all(row[0] for row in rows):
            variable = [re.match(_OF_VARIABLES, head) is not None for head in heads]
            heads, *rows = (_uncounted(row, variable) for row in (heads, *rows))
        cells = (re.sub(r"^(#[^\t]*)", r'"\1"', "\t".join(row)) for row in (heads, *rows))  # a name, and no comment
        return "\n".join([*lines, *poses, *("".join(row) for row in titles), *cells, ""])


def _uncounted(row: list[str], variable: list[bool]) -> list[str]:
    """A row without the number of its axis, and its variable without it: a reader counts fixed joints, too."""
    number = row[0].translate(_LOWERED)
    own = rf"(?<![^\W\d_])(?:θ|theta|[dq])_?{re.escape(number)}(?!\w)"
    return [
        re.sub(own, "q", cell.translate(_LOWERED)) if number.isdigit() and is_own else cell
        for cell, is_own in zip(row[1:], variable[1:], strict=True)
    ]


def typeset(text: str) -> Typeset | None:
    """The table of a text; None where it is neither LaTeX nor Markdown, nor numbers with spaces between them."""
    every = text.translate(_BOX).splitlines()
    comments = [line for line in every if line.lstrip().startswith("#")]  # or headings of Markdown
    lines = [line for line in every if not line.lstrip().startswith("#")]
    if any(line.strip().startswith("{|") for line in lines):
        found = _wiki(lines)
    elif sum(line.strip() == "|===" for line in lines) == 2:  # noqa: PLR2004 - above and below the table
        found = _asciidoc([line.strip() for line in lines])
    elif array := code_array(text):
        return Typeset(array.rows, array.around)
    elif any(re.search(_CELL, line) for line in lines) and ("\\\\" in text or "\\begin{" in text):
        found = _latex("\n".join(lines))
    elif any(line.strip().startswith("|") for line in lines) or _ruled(lines):
        found = _markdown(lines)
    elif any("\t" in line.strip() for line in lines):
        found = _tabbed(lines)
    else:
        found = _spaced([line.strip() for line in lines if line.strip() and not re.fullmatch(_LINES, line)])
    return found._replace(around="\n".join([*comments, found.around])) if found.rows else None


def is_value(cell: str) -> bool:
    """Whether a cell is a number or an expression of numbers and variables: ``0.1``, ``pi/2``, ``q2-90°``."""
    return re.fullmatch(_NUMBER, "".join(cell.split())) is not None


def _latex(text: str) -> Typeset:
    notes = "".join(f"\n{found[1]}" for found in re.finditer(_FOOTNOTE, text))
    text = re.sub(_STACK, lambda found: found[1].replace("\\\\", " "), re.sub(_FOOTNOTE, "", text)).replace("~", " ")
    bodies = [found[2] for found in re.finditer(_BODY, text)]
    rows = (
        row
        for body in bodies or [text]
        for row in re.split(_NEW_ROW, re.sub(_RULES, "", re.sub(_COMMENT, "", _inside(body))))
    )
    cells = [[_plain(cell) for cell in re.split(_CELL, re.sub(_SPAN, _spread, row))] for row in rows if row.strip()]
    return Typeset(cells, (re.sub(_BODY, "", text) if bodies else "") + notes)


def _spread(span: re.Match[str]) -> str:
    return span[2] + "&" * (int(span[1]) - 1)


def _inside(body: str) -> str:
    """What follows the arguments of a table: its place, its width, its columns."""
    arguments = re.match(_ARGUMENTS, body)
    return body[arguments.end() :] if arguments else body


def _markdown(lines: list[str]) -> Typeset:
    """The table of Markdown; bars at both ends of its lines may be left out."""
    ruled = _ruled(lines)
    table = [line.strip() for line in lines if line.strip().startswith("|") or (ruled and re.search(_BAR, line))]
    lines_of_cells = (re.sub(_JIRA, "|", line) if re.fullmatch(_JIRA_HEAD, line) else line for line in table)
    cells = (
        re.split(_BAR, line.removeprefix("|").removesuffix("|"))
        for line in lines_of_cells
        if not re.fullmatch(_RULE, line)
    )
    around = "\n".join(line for line in lines if line.strip() not in table)
    rows = [[_plain(_unmarked(cell)) for cell in row] for row in cells]
    width = len(rows[0]) if rows else 0
    return Typeset([row + [""] * (width - len(row)) for row in rows], around)


def _wiki(lines: list[str]) -> Typeset:
    """The table of MediaWiki: rows begin with ``|-``, cells of a head with ``!``, others with ``|``."""
    rows: list[list[str]] = [[]]
    around, is_inside = [], False
    for line in map(str.strip, lines):
        if line.startswith(("{|", "|}")):
            is_inside = line.startswith("{|")
        elif not is_inside or line.startswith("|+"):
            around.append(line.removeprefix("|+"))
        elif line.startswith("|-"):
            rows.append([])
        elif line.startswith(("|", "!")):
            cells = (re.sub(_ATTRIBUTES, "", cell) for cell in re.split(_WIKI_CELL, line[1:]))
            rows[-1] += [_plain(_unmarked(cell)) for cell in cells]
    return Typeset([row for row in rows if row], "\n".join(around))


def _asciidoc(lines: list[str]) -> Typeset:
    """The table of AsciiDoc: a bar begins a cell, and a row may take several lines."""
    first = lines.index("|===")
    last = lines.index("|===", first + 1)
    around = [line for line in (*lines[:first], *lines[last + 1 :]) if not re.fullmatch(_ATTRIBUTE_LINE, line)]
    inside = [re.sub(_ASCIIDOC_CELL, _repeated, f" {line}") for line in lines[first + 1 : last] if line]
    cells = [[_plain(_unmarked(re.sub(_MACRO, r"\1", cell))) for cell in re.split(_BAR, line)] for line in inside]
    flat: list[str] = []
    for before, *own in cells:  # what is before the first bar goes on with the cell of the line above
        flat[-1:] = [f"{flat[-1]} {before}".strip()] if flat else []
        flat += own
    columns = re.search(_ASCIIDOC_COLUMNS, "\n".join(lines[:first]))
    parts = [part.strip() for part in columns[1].split(",")] if columns else []
    counts = [int(found[1]) if (found := re.match(r"(\d+)\*", part)) else 1 for part in parts]
    width = sum(counts) or len(cells[0]) - 1 if cells else 0
    rows = [flat[start : start + width] for start in range(0, len(flat), max(width, 1))]
    return Typeset(rows, "\n".join(line.removeprefix(".") for line in around))


def _repeated(cell: re.Match[str]) -> str:
    """The bar of a cell, once for each column that it spans."""
    return " |" * int(cell[1] or 1)


def _ruled(lines: list[str]) -> bool:
    """Whether bars are between cells: there is a line of Markdown below the header, or every line has as many bars."""
    bars = {len(re.findall(_BAR, line)) for line in lines if line.strip() and not re.fullmatch(_LINES, line.strip())}
    return any("|" in line and re.fullmatch(_RULE, line.strip()) for line in lines) or (
        len(bars) == 1 and max(bars) > 1
    )


def _unmarked(cell: str) -> str:
    """A cell of Markdown without bold type, tags and codes of HTML."""
    cell = html.unescape(cell).strip()
    for pattern, plain in _MARKS if any(sign in cell for sign in "<*_`") else ():
        cell = re.sub(pattern, plain, cell)
    return cell


def _tabbed(lines: list[str]) -> Typeset:
    """The table of lines with tabs between the cells and sentences above or below.

    Without such sentences it has no rows: the reader of CSV files reads the text as it is.
    """
    tabbed = [
        number for number, line in enumerate(lines) if "\t" in line and not re.fullmatch(_SENTENCE, line.rstrip())
    ]
    first, last = tabbed[0], tabbed[-1] + 1
    around = [line for line in (*lines[:first], *lines[last:]) if line.strip()]
    are_sentences = around and all(len(line.split()) > 1 for line in around)
    if not are_sentences or any('"' in line for line in lines):  # a cell in quotes may have several lines
        return Typeset([])
    rows = [[cell.strip() for cell in line.split("\t")] for line in lines[first:last] if line.strip()]
    return Typeset(rows, "\n".join(around))


def _spaced(lines: list[str]) -> Typeset:
    """The table of lines with spaces between the cells; without rows where it is none, or its cells could be others.

    It is one where all lines have as many cells, and only a header has other cells than numbers, the names of joints
    aside. Lines of text before and after it, as a caption, have fewer than two numbers.
    """
    lines = [re.sub(_JOINT, r"\1_\2", line) for line in lines]
    together = [re.sub(_SIGN_APART, r"\1\2", line) for line in lines]
    for rows in (
        [re.sub(_UNIT_APART, "", line).split() for line in lines],
        [re.split(_GAP, line) for line in lines],
        [line.split() for line in together] if together != lines else [],
    ):
        of_numbers = [number for number, row in enumerate(rows) if _are_numbers(row)]
        if not of_numbers:
            continue
        first, last = of_numbers[0], of_numbers[-1] + 1
        head = rows[first - 1]
        if first and not any(re.fullmatch(_NUMBER, cell) for cell in head):
            if len(head) == len(rows[first]) - 1:  # as pandas prints it, without a word above the names of the rows
                rows[first - 1] = head = ["", *head]
            first -= len(head) == len(rows[first])
        table, around = rows[first:last], [*rows[:first], *rows[last:]]
        is_table = last - of_numbers[0] == len(of_numbers) and len({len(row) for row in table}) == 1
        counts = [(len(row), sum(re.fullmatch(_NUMBER, cell) is not None for cell in row)) for row in around]
        is_text = all(words != len(table[0]) and numbers < min(words, 2) for words, numbers in counts)
        is_split = rows[0] == lines[0].split() or not _are_numbers(table[0])  # `0.1 + 0.2` may be a cell
        if is_table and is_text and is_split:
            return Typeset(table, "\n".join([*lines[:first], *lines[last:]]))
    return Typeset([])


def _are_numbers(row: list[str]) -> bool:
    """Whether a line has numbers alone, two or more, or the name of a joint and three or more."""
    named = len(row) > 3 and row[0].isidentifier() and re.fullmatch(_NUMBER, row[0]) is None  # noqa: PLR2004
    return len(row) > 1 and all(re.fullmatch(_NUMBER, cell) for cell in row[named:])


def _plain(cell: str) -> str:
    """A cell without the signs of LaTeX and of Markdown; what is not known stays, and the reader names it."""
    for pattern, plain in _FORMULAS if any(sign in cell for sign in "\\$π{") else ():
        cell = re.sub(pattern, plain, cell)
    return " ".join(cell.split())


def _pose(text: str) -> str:
    return text.strip("` ") if text.startswith("`") else _plain(text)
