"""Comment lines of a CSV table: what columns cannot say stands in them, and prose stands in them too."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.documents import Node, load_yaml
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.cells import SPACES, Cell
from dh2urdf_plugins.readers.fields import one_slip

if TYPE_CHECKING:
    from collections.abc import Iterable

STATEMENTS = ("name", "convention", "units", "base", "tool", "defaults")
"""What comment lines before the header may say, as YAML."""
_EXAMPLES = {
    "name": "# name: ur5",
    "convention": "# convention: standard, or modified",
    "units": "# units: {length: mm, angle: deg}",
    "base": "# base: {xyz: [0, 0, 0.3], rpy: [0, 0, pi]}",
    "tool": "# tool: {xyz: [0, 0, 0.1]}",
    "defaults": "# defaults: {geometry: {shape: cylinder, radius: 0.04}, density: 2700}",
}
MAX_STATEMENT = 10_000
"""Length of a comment line that says something [1]."""


_STATEMENT = re.compile(r"\s*#\s*(?:dh[\s_-]+)?([^\W\d]+)\s*[:=]\s*", re.IGNORECASE)
_SAYS_CONVENTION = re.compile(r"\bdh\b|denavit|convention|parameters", re.IGNORECASE)
_PROSE = {
    Convention.MODIFIED: (
        re.compile(r"\b(mdh|craig|proximal)\b", re.IGNORECASE),
        re.compile(r"\bmodified\b", re.IGNORECASE),
    ),
    Convention.STANDARD: (
        re.compile(r"\b(sdh|distal|spong)\b", re.IGNORECASE),
        re.compile(r"\b(standard|classic|classical)\b", re.IGNORECASE),
    ),
}
"""Words for the convention in a comment: those that mean nothing else, and those that may."""
SPREADSHEET_ERROR = re.compile(r"\s*#(REF!|N/A|NAME\?|VALUE!|DIV/0!|NUM!|NULL!|SPILL!|CALC!)")


def convention_in_prose(line: str) -> Convention | None:
    """The convention that a comment speaks of; None where it speaks of none, or of both."""
    spoken = [
        convention
        for convention, (sure, likely) in _PROSE.items()
        if sure.search(line) or (likely.search(line) and _SAYS_CONVENTION.search(line))
    ]
    return spoken[0] if len(spoken) == 1 else None


def prose_notices(comments: Iterable[tuple[Convention, Cell]], convention: Convention) -> list[Problem]:
    """Notices of comments that speak of another convention than the table is read in."""
    return [
        Problem(
            message=f"this comment speaks of the {spoken} convention, and the table is read as {convention}",
            severity="notice",
            mark=comment.mark,
            field="convention",
            found=comment.text,
            suggestion=f"if it means this table, write `# convention: {spoken}`",
        )
        for spoken, comment in comments
        if spoken is not convention
    ]


def is_comment(line: str) -> bool:
    """Whether a line is a comment; what spreadsheets write for an error begins with # too, and is none."""
    return line.lstrip(SPACES + "\ufeff").startswith("#") and not SPREADSHEET_ERROR.match(line)


def statement(line: str, number: int, file: str) -> tuple[str, Node] | None:
    """What a comment line says, as a key and the YAML value behind it; None where it is only a comment.

    Raises:
        TableError: it is a misspelt key, or the value is not YAML.
    """
    match = _STATEMENT.match(line)
    if not match:
        return None
    key = match[1].casefold()
    if key not in STATEMENTS:
        near = next((word for word in STATEMENTS if one_slip(key, word)), None)
        if near:
            raise TableError(
                Problem(
                    message=f"the comment line says {shown(match[1])}, which nothing is called",
                    mark=Mark(file=file, line=number, column=match.start(1) + 1),
                    found=match[1],
                    accepted=", ".join(STATEMENTS),
                    suggestion=f"did you mean {near!r}?",
                )
            )
        return None
    if len(line) > MAX_STATEMENT:
        message = f"the comment line has {len(line)} characters"
        accepted = f"at most {MAX_STATEMENT} where it says {key}"
        raise TableError(Problem(message=message, mark=Mark(file=file, line=number), accepted=accepted))
    if not line[match.end() :].strip():
        raise TableError(
            Problem(
                message=f"the comment line says nothing behind {shown(match[1])}",
                mark=Mark(file=file, line=number, column=match.start(1) + 1),
                field=key,
                found=line.strip(),
                accepted=_EXAMPLES[key],
            )
        )
    # The value is moved to its own line and column, so that its marks are those of the file.
    return key, load_yaml("\n" * (number - 1) + " " * match.end() + line[match.end() :], file, TableError)
