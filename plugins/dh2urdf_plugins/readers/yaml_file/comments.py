"""Comments of a YAML file: nothing is read from them, but they may show that the table is read wrongly."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.source import Mark, Problem
from dh2urdf_plugins.readers.words.comment_lines import Comment

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from dh2urdf_plugins.readers.statements.statements import Statements

_MAX_COMMENTS = 1000


def judge_comments(
    text: str, file: str, statements: Statements, *, typed: bool, add: Callable[[Problem], None]
) -> None:
    """Adds what lines of comments say that the table does not: another unit, another convention, a joint that slides.

    Args:
        text: the file's text.
        file: the file.
        statements: what the table and the options say.
        typed: whether the table has types.
        add: what takes the problems.
    """
    for comment in _comments(text, file):
        from dh2urdf_plugins.readers.header.columns import Columns
        from dh2urdf_plugins.readers.statements.comment_phrases import prose_problems
        from dh2urdf_plugins.readers.statements.judged_comments import types_elsewhere

        for problem in (
            *prose_problems(comment, statements, Columns(mark=Mark(file=file), headers=[])),
            *types_elsewhere(comment, typed=typed),
        ):
            add(problem)


def _comments(text: str, file: str) -> Iterator[Comment]:
    """The lines that are comments as a whole; one behind a value is about this value."""
    found = 0
    for number, line in enumerate(text.splitlines() if "#" in text else (), start=1):
        if line.lstrip().startswith("#") and found < _MAX_COMMENTS:
            found += 1
            yield Comment.of(line.strip(), Mark(file=file, line=number))
