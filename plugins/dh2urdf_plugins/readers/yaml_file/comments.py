"""Comments of a YAML file: nothing is read from them, but they may show that the table is read wrongly."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.words.comment_lines import Comment

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from dh2urdf_plugins.readers.statements.statements import Statements

_MAX_COMMENTS = 1000
_JOINT = r"-\s.*\b(?:a|alpha|d)\s*:\s*[-+]?(?:[0-9.]|pi)"
"""A joint, in the list of which it is no more."""
_STATEMENT = r"(base|tool|payload|defaults)\s*[:=]\s*[\[{]"
_BEFORE_QUOTES = ("", ":", ",", "[", "{", "-", "?")
"""What a text in quotes comes after."""


class CommentLines:
    """The lines of a file with comments, by the manipulators that they are about.

    Args:
        text: the file's text.
    """

    def __init__(self, text: str) -> None:
        self._lines = text.splitlines() if "#" in text else []
        self._first: int | None = None  # where the first of several manipulators begins

    def all(self) -> Iterator[tuple[int, str]]:
        """Every line with its number: of a file that is one manipulator."""
        return enumerate(self._lines, start=1)

    def of(self, first: int, end: int | None) -> Iterator[tuple[int, str]]:
        """The lines of one of several manipulators, and those above all of them.

        Args:
            first: the line where it begins; comments right above it belong to it.
            end: the line where the next one begins; None for the last one.
        """
        if not self._lines:
            return
        begin, stop = self._with_comments_above(first), self._with_comments_above(end or len(self._lines) + 1)
        self._first = begin if self._first is None else self._first
        for number in (*range(1, self._first), *range(begin, len(self._lines) + 1 if end is None else stop)):
            yield number, self._lines[number - 1]

    def _with_comments_above(self, line: int) -> int:
        while line > 1 and self._lines[line - 2].lstrip().startswith("#"):
            line -= 1
        return line


def judge_comments(
    lines: Iterable[tuple[int, str]], file: str, statements: Statements, *, typed: bool, add: Callable[[Problem], None]
) -> None:
    """Adds what comments say that the table does not: another unit, another convention, a joint that slides.

    Args:
        lines: the lines that the comments are in, with their numbers.
        file: the file.
        statements: what the table and the options say.
        typed: whether the table has types.
        add: what takes the problems.
    """
    found, among_rows = 0, False
    for number, line in lines:
        among_rows = among_rows or line.lstrip(" -{").startswith("joints")
        if "#" not in line or found >= _MAX_COMMENTS or (position := _start(line)) is None:
            continue
        from dh2urdf_plugins.readers.comments.judged import behind_problems, types_elsewhere, unread
        from dh2urdf_plugins.readers.comments.prose import in_other_words, units_beside

        found += 1
        before = line[:position].strip()
        comment = Comment.of(
            line[position:].strip(), Mark(file=file, line=number, column=position + 1 if before else None)
        )
        problems = in_other_words(comment, statements, units_beside(before), lead="", behind=bool(before))
        problems += types_elsewhere(comment, typed=typed)
        if before:
            problems = problems or behind_problems(
                comment, before, 1, statements, typed=typed or not among_rows, lead="", place="key"
            )
        else:
            problems = problems or _left_out(comment, statements) or _lost_joint(comment)
            problems = problems or unread(comment, statements, among_rows=among_rows, lead="", place="key")
        for problem in problems:
            add(problem)


def _left_out(comment: Comment, statements: Statements) -> list[Problem]:
    """A notice of a base, a tool or a payload that is declared as in a CSV table, and that no key declares."""
    match = re.match(_STATEMENT, comment.text)
    if match is None or match[1] in statements.placed:
        return []
    message = f"{shown(comment.line)} is a comment, and nothing is read from it"
    meant = f"if it is part of the arm, write the key `{match[1]}:` without #"
    notice = Problem(message=message, severity="notice", mark=comment.whole, found=comment.line, suggestion=meant)
    return [notice]


def _lost_joint(comment: Comment) -> list[Problem]:
    """A notice of a comment that is a joint: ``# - {a: 0.4, …``."""
    if not re.match(_JOINT, comment.text):
        return []
    message = f"{shown(comment.line)} is a comment, and no joint"
    return [Problem(message=message, severity="notice", mark=comment.whole, found=comment.line)]


def _start(line: str) -> int | None:
    """Where the comment of a line begins; None where # is in a text or in a word."""
    quote = ""
    for position, letter in enumerate(line):
        if quote:
            if letter == quote and not (quote == '"' and line[position - 1] == "\\"):
                quote = ""
        elif letter in "'\"" and line[:position].rstrip()[-1:] in _BEFORE_QUOTES:
            quote = letter
        elif letter == "#" and not line[:position][-1:].strip():
            return position
    return None
