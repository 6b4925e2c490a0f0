"""What the YAML parser declares about a text that is not YAML, and what a person can do about it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.source import Mark, Problem, shown

if TYPE_CHECKING:
    import yaml

_ADVICE = (
    ("mapping values are not allowed", "indent the keys of a mapping alike, and quote a text that holds ': '"),
    ("could not find expected ':'", "each line of a mapping is `name: value`, with a space after the colon"),
    ("did not find expected key", "indent the keys of a mapping alike, and the dashes of a list"),
    ("did not find expected '-' indicator", "indent the dashes of a list alike"),
    ("did not find expected ','", "close the bracket that opens here, or put a comma between the values"),
    ("did not find expected node content", "a value is missing, or a bracket or comma is too many"),
    ("unexpected end of stream", "close the quote that opens here"),
    ("expected alphabetic or numeric", "quote a text that starts with * or &"),
    ("unknown escape character", "use single quotes, in which a backslash means itself"),
    ("invalid Unicode character escape", "write the character itself"),
    ("incompatible YAML document", "remove the line %YAML"),
)
_TAB = "indent with spaces: YAML takes no tabs there"
_RESERVED = "quote a text that starts with this character"


def syntax_problem(reason: yaml.YAMLError, text: str, file: str) -> Problem:
    """The problem that a parser's error describes.

    Args:
        reason: what PyYAML raised.
        text: the whole text.
        file: what the mark names as the file.
    """
    said = str(getattr(reason, "problem", None) or reason).partition("\n")[0]
    place = getattr(reason, "problem_mark", None)
    opened = getattr(reason, "context_mark", None)
    if place is None:
        return Problem(message=f"this is not valid YAML: {said}", mark=Mark(file=file))
    lines = re.split(r"\r\n|\n|\r", text)
    if opened is not None and not "".join([_rest(lines, place.line, place.column), *lines[place.line + 1 :]]).strip():
        place = opened  # The text ended too early: what was left open is the place to fix.
    rest = _rest(lines, place.line, place.column)
    suggestion = next((advice for words, advice in _ADVICE if words in said), None)
    if "cannot start any token" in said:
        said = f"a value cannot start with {shown(rest[:1])}"
        suggestion = _TAB if rest[:1] == "\t" else _RESERVED
    return Problem(
        message=f"this is not valid YAML: {said}" + (f", at {shown(rest.strip())}" if rest.strip() else ""),
        mark=Mark(file=file, line=place.line + 1, column=place.column + 1),
        found=rest.strip() or None,
        suggestion=suggestion,
    )


def _rest(lines: list[str], line: int, column: int) -> str:
    return lines[line][column:] if line < len(lines) else ""
