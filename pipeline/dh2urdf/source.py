"""A place in a file, and what is wrong there: marks and problems.

Everything that comes from a file carries a `Mark`, so that whatever is found later, in whatever stage, can
point to the line and column where a person has to fix it.
"""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache
from itertools import islice
from pathlib import Path
from string import Formatter
from typing import TYPE_CHECKING, Any, Generic, Literal, Protocol, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from dh2urdf.results import ProblemEntry

SHOWN_TEXT = 60
"""Characters of a found text that a message repeats; a longer one is cut in the middle."""
LONG_PATH = 200
"""The same of a path."""
LONGEST_SLIP = 100
"""Characters of a word that is compared with others: a longer one is no slip of the pen."""
MESSAGES = "messages.toml"
"""Name of the file beside a package's modules that has the sentences of its problems."""
TEMPLATES = ("message", "accepted", "suggestion")
"""What an entry of that file has as templates. Besides, `severity` may be ``notice``."""
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
        code: the name of the kind of message, such as ``unit-twice``; None where it has none.
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
    code: str | None = None

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
        """The problem as the entry of a report."""
        return {
            "code": self.code,
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

    @classmethod
    def from_json(cls, entry: ProblemEntry, severity: Literal["error", "notice"], robot: str | None = None) -> Problem:
        """The problem that an entry of a report is, with what is suggested as a part of its message."""
        place: Any = {name: entry[name] for name in ("file", "line", "column", "place")}
        mark = Mark(**place) if entry["file"] else None
        about: Any = {name: entry[name] for name in ("code", "joint", "field", "found", "accepted", "message")}
        return cls(severity=severity, mark=mark, robot=robot, **about)

    @property
    def cause(self) -> tuple[str | None, ...]:
        """What it has in common with problems of other manipulators: all but names and numbers; words found count."""
        return (self.severity, self.code, self.field, alike(self.message), re.sub(_NUMBER, "#", self.found or ""))

    def about(self, *, robot: str | None = None, mark: Mark | None = None) -> Problem:
        """The same problem with robot and mark filled in where it has none."""
        return replace(self, robot=self.robot or robot, mark=self.mark or mark)


class Messages:
    """The sentences of one package, as data: the program names a code, and a `messages.toml` has the words.

    A package keeps the sentences of its problems in one file beside its modules, and makes a problem by its code::

        [unit-twice]
        message = "{found:quoted} contradicts the unit {earlier} that {where} declares"
        accepted = "one unit of {key} for the whole table"

        say = Messages(__file__)
        say("unit-twice", mark, field="units", found="mm", earlier="inch", where=other, key="length")

    ``{name}`` takes the value of a keyword, several values with commas between them; ``{name:quoted}`` takes its text
    in quotes, escaped and cut as messages repeat texts, and ``{name:path}`` cuts it only where a path is very long.
    What is accepted or suggested is left out where it comes out empty.

    Args:
        module: the ``__file__`` of a module; the nearest `messages.toml`, beside it or above, has the sentences.
    """

    def __init__(self, module: str) -> None:
        self._module = module

    @cached_property
    def entries(self) -> Mapping[str, Mapping[str, str]]:
        """Code -> templates. The file is read when the first problem is made: most tables have none."""
        for folder in Path(self._module).parents:
            with suppress(FileNotFoundError):
                return _entries(folder / MESSAGES)
        raise FileNotFoundError(f"no {MESSAGES} is beside {self._module}, or above")

    def __call__(
        self,
        code: str,
        mark: Mark | None = None,
        *,
        robot: str | None = None,
        joint: str | None = None,
        field: str | None = None,
        found: str | None = None,
        suggestion: str | None = None,
        **values: object,
    ) -> Problem:
        """Make the problem that a code names.

        Args:
            code: the entry in `messages.toml`.
            mark: the place.
            robot: name of the manipulator concerned.
            joint: name of the joint concerned.
            field: name of the field concerned.
            found: the text that was found.
            suggestion: what was probably meant; it takes the place of the entry's own suggestion.
            values: what the templates name besides.

        Raises:
            KeyError: there is no such entry, or a template names a value that is not given.
        """
        entry = self.entries[code]
        about: dict[str, Any] = {"robot": robot, "joint": joint, "field": field, "found": found}
        words: dict[str, Any] = {
            word: _SENTENCES.vformat(entry[word], (), about | values) or None for word in TEMPLATES if word in entry
        }
        if suggestion:
            words["suggestion"] = suggestion
        if "severity" in entry:
            about["severity"] = entry["severity"]
        return Problem(code=code, mark=mark, **about, **words)


@cache
def _entries(path: Path) -> Mapping[str, Mapping[str, str]]:
    import tomllib

    return tomllib.loads(path.read_text("utf-8"))


class _Sentences(Formatter):
    """Values in sentences: texts as they are or in quotes, several joined by commas."""

    def format_field(self, value: object, format_spec: str) -> str:
        if format_spec in _LENGTHS:
            return shown(str(value), _LENGTHS[format_spec])
        if isinstance(value, (list, tuple)):
            return ", ".join(map(str, value))
        return str(super().format_field(value, format_spec))


_SENTENCES = _Sentences()
_LENGTHS = {"quoted": SHOWN_TEXT, "path": LONG_PATH}


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


# --- What several messages have in common -----------------------------------------------------------------------------

MOST_PLACES = 4
"""Places of one cause that are named besides the first."""
LONGEST_PATTERN = 300  # characters of a pattern; of a longer message the beginning counts
_QUOTED = r"(?<!\w)('[^']*'|\"[^\"]*\")(?!\w)"
_NUMBER = r"(?i)[-+−]?\d+(?:[.,]\d+)*(?:e[-+]?\d+)?|\b(?:nan|inf)\b"
_NUMBERS = r"#(?:, #)+"
_SEVERAL = r"(?:'…'|#)(?:(?:, | and | )(?:'…'|#))*"


def pattern(message: str) -> str:
    """Return a message without what differs between manipulators: quoted text is '…', a number or several are #."""
    without = re.sub(_NUMBER, "#", re.sub(_QUOTED, "'…'", message[: 4 * LONGEST_PATTERN]))
    return re.sub(_NUMBERS, "#", without)[:LONGEST_PATTERN]


@lru_cache(maxsize=1024)
def alike(message: str) -> str:
    """What a message has in common with those that name other joints, links and numbers."""
    return re.sub(_SEVERAL, "…", pattern(message))


class Told(Protocol):
    """A message with a place."""

    @property
    def mark(self) -> Mark | None:
        """The place."""


_Told = TypeVar("_Told", bound=Told)


class Cause(Generic[_Told]):
    """Messages that have one cause.

    Attributes:
        first: the one that is printed.
        others: the others.
        dropped: how many more others there are, of which nothing is kept.
    """

    def __init__(self, first: _Told, others: Iterable[_Told] = (), dropped: int = 0) -> None:
        self.first, self.others, self.dropped = first, [*others], dropped

    @property
    def count(self) -> int:
        """How many messages have the cause."""
        return 1 + len(self.others) + self.dropped

    def add(self, others: Sequence[_Told], dropped: int = 0) -> None:
        """Take more of them; the places of the first few are kept."""
        kept = others[: max(0, MOST_PLACES - len(self.others))]
        self.others += kept
        self.dropped += dropped + len(others) - len(kept)

    @property
    def elsewhere(self) -> str:
        """Where the cause is found besides: ``3 more in 2 files: line 7, b.csv:4 and 1 more``; empty where nowhere."""
        if self.count == 1:
            return ""
        here = self.first.mark.file if self.first.mark else ""
        marks = dict.fromkeys(each.mark for each in self.others if each.mark)
        files = {mark.file for mark in marks} | {here} - {""}
        where = f" in {len(files)} files" if len(files) > 1 and not self.dropped else ""
        places = dict.fromkeys(f"line {mark.line}" if mark.file == here and mark.line else str(mark) for mark in marks)
        named = listed(list(places), MOST_PLACES, self.dropped) if places else ""
        return f"{self.count - 1:,} more{where}{f': {named}' if named else ''}"


def free_name(name: str, taken: set[str]) -> str:
    """A name that is not taken, with a ``_`` behind it for as long as it is; the set has it then."""
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def listed(texts: Sequence[str], most: int = 5, others: int = 0) -> str:
    """Texts in one line, and how many more there are: ``a, b, c and 4 more``.

    Args:
        texts: all that are known.
        most: how many are repeated.
        others: how many more there are.
    """
    more = max(0, len(texts) - most) + others
    return ", ".join(texts[:most]) + (f" and {more:,} more" if more else "")


def did_you_mean(word: str, choices: Iterable[str]) -> str | None:
    """The sentence that names the choice nearest to a word, or None where nothing is near or the choices are many."""
    from difflib import get_close_matches

    few = list(islice(choices, MOST_CHOICES + 1))
    if len(word) > LONGEST_SLIP or len(few) > MOST_CHOICES:
        return None
    near = get_close_matches(word.casefold(), few, n=1, cutoff=0.6)
    return f"did you mean {near[0]!r}?" if near else None
