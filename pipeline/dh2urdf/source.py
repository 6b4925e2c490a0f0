"""A place in a file, and what is wrong there: marks and problems.

Everything that comes from a file carries a `Mark`, so that whatever is found later, in whatever stage, can
point to the line and column where a person has to fix it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import islice
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.results import ProblemEntry

SHOWN_TEXT = 60
"""Characters of a found text that a message repeats; a longer one is cut in the middle."""
LONGEST_SLIP = 100
"""Characters of a word that is compared with others: a longer one is no slip of the pen."""
MOST_CHOICES = 200
"""Words that a word is compared with: of more, none is named, so that a file of n slips costs no n² comparisons."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """A place in a file or on the command line.

    Attributes:
        file: the path as the user gave it, or a word such as ``command line``.
        line: line or row, counted from 1; None where there is none.
        column: counted from 1, in characters of a line or in cells of a row; None where the whole line is meant.
        place: how people who use the format name the place, such as ``Sheet2!C4`` or ``row 3, column a``; None where
            line and column name it. Line and column, where they are given too, put problems in the file's order.
    """

    file: str
    line: int | None = None
    column: int | None = None
    place: str | None = None

    def __str__(self) -> str:
        parts = (self.file, self.line, self.column) if self.place is None else (self.file, self.place)
        return ":".join(str(part) for part in parts if part is not None)

    def __reduce__(self) -> tuple[object, ...]:
        """Pickled in a third of the time of a dataclass: a batch of a run has a thousand of them."""
        return _mark, (self.file, self.line, self.column, self.place)

    @property
    def in_file(self) -> str:
        """The place without the file, as a sentence names it: ``line 3``, ``Sheet2!C4``; empty for a whole file."""
        return self.place or (f"line {self.line}" if self.line is not None else "")


def _mark(file: str, line: int | None, column: int | None, place: str | None) -> Mark:
    return Mark(file=file, line=line, column=column, place=place)


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """One thing that a person should know about the input, and what can be done about it.

    Attributes:
        message: what is wrong, as one plain sentence without its place and without a full stop.
        severity: an ``error`` refuses the manipulator, a ``notice`` does not.
        mark: the place.
        robot: name of the manipulator concerned.
        joint: name of the joint concerned.
        field: name of the field concerned, as the project calls it (``alpha``, ``limits.lower``).
        found: the text that was found, as it is in the file.
        accepted: what is accepted in its place, in words, every accepted word written out.
        suggestion: what was probably meant, or what to do.
    """

    message: str
    severity: Literal["error", "notice"] = "error"
    mark: Mark | None = None
    robot: str | None = None
    joint: str | None = None
    field: str | None = None
    found: str | None = None
    accepted: str | None = None
    suggestion: str | None = None

    def __str__(self) -> str:
        about = [f"{word} {shown(name)}" for word, name in (("joint", self.joint), ("field", self.field)) if name]
        place = [str(self.mark)] if self.mark else []
        if self.robot and not self.joint:
            about.insert(0, f"manipulator {shown(self.robot)}")
        head = ": ".join([*place, self.severity, *([", ".join(about)] if about else []), self.message])
        tail = [f"accepted: {self.accepted}"] if self.accepted else []
        if self.suggestion:
            tail.append(self.suggestion)
        return "\n    ".join(map(printable, [head, *tail]))

    def as_json(self) -> ProblemEntry:
        """The problem as the entry of a report: file, line, column, place, joint, field, found, accepted, message."""
        return {
            "file": self.mark.file if self.mark else None,
            "line": self.mark.line if self.mark else None,
            "column": self.mark.column if self.mark else None,
            "place": self.mark.place if self.mark else None,
            "joint": self.joint,
            "field": self.field,
            "found": self.found,
            "accepted": self.accepted,
            "message": self.message if not self.suggestion else f"{self.message}; {self.suggestion}",
        }

    def about(self, *, robot: str | None = None, mark: Mark | None = None) -> Problem:
        """The same problem with robot and mark filled in where it has none."""
        return replace(self, robot=self.robot or robot, mark=self.mark or mark)


def in_file_order(problems: Iterable[Problem]) -> list[Problem]:
    """Problems by line and column; those without a place, and those of one place, keep their order."""

    def place(problem: Problem) -> tuple[int, int]:
        return (problem.mark.line or 0, problem.mark.column or 0) if problem.mark else (0, 0)

    return sorted(problems, key=place)


def shown(text: str, limit: int = SHOWN_TEXT) -> str:
    """A text as a message repeats it: quoted, control characters escaped, cut where it is long."""
    plain = printable(text[: 4 * limit])
    if len(plain) > limit or len(text) > 4 * limit:
        plain = f"{plain[:limit]}…"
    return f"'{plain}'"


def printable(text: str) -> str:
    """A text with its control characters escaped.

    A table, a file name and the message of a parser may come from a stranger, and land on a terminal:
    escape sequences must not.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def markdown_text(text: str) -> str:
    """Return a text as one line of Markdown, which every renderer shows as the same text.

    A backslash escapes what all renderers let it escape. The other characters become entities.
    """
    plain = printable(" ".join(text.split()))
    signs = r"[\\`*_{}\[\]#]|^[-+](?=[-\s]|$)|^\d+[.)](?=\s|$)"
    plain = re.sub(signs, lambda found: f"{found[0][:-1]}\\{found[0][-1]}", plain)
    return re.sub("[<>&|~]", lambda found: f"&#{ord(found[0])};", plain)


def free_name(name: str, taken: set[str]) -> str:
    """A name that is not taken, with a ``_`` behind it for as long as it is; the set has it then."""
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def listed(texts: Sequence[str], most: int = 5) -> str:
    """Texts in one line, and how many more there are: ``a, b, c and 4 more``.

    Args:
        texts: all of them.
        most: how many are repeated.
    """
    more = len(texts) - most
    return ", ".join(texts[:most]) + (f" and {more} more" if more > 0 else "")


def did_you_mean(word: str, choices: Iterable[str]) -> str | None:
    """The sentence that names the choice nearest to a word, or None where nothing is near or the choices are many."""
    from difflib import get_close_matches

    few = list(islice(choices, MOST_CHOICES + 1))
    if len(word) > LONGEST_SLIP or len(few) > MOST_CHOICES:
        return None
    near = get_close_matches(word.casefold(), few, n=1, cutoff=0.6)
    return f"did you mean {near[0]!r}?" if near else None
