"""What a change of a table does to the arm that is read, and to the messages about it."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, fields, is_dataclass
from typing import TYPE_CHECKING, Any

from dialects import File, write
from tables import READERS

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.source import Problem

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@dataclass
class Outcome:
    """What reading a file gives: its arms, part by part, and the messages about them."""

    parts: dict[str, str] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    refused: bool = False


def outcome(file: File, options: dict[str, Any], folder: Path) -> Outcome:
    """What reading a file gives."""
    path = write(file, folder, "arm")
    try:
        reader = READERS[file.suffix[1:]]
        items = list(reader.read(path, reader.options(**options)))
    except TableError as error:
        return Outcome(problems=list(error.problems), refused=True)
    finally:
        path.unlink()
    found = Outcome()
    for index, item in enumerate(items):
        prefix = f"arm {index}" if len(items) > 1 else ""
        if isinstance(item, Manipulator):
            found.parts |= {f"{prefix}{path}": text for path, text in parts(item)}
            found.problems += item.notices
        else:
            found.refused = True
            found.problems += item.problems
    return found


def parts(record: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Every number and word of a manipulator, by its path."""
    if is_dataclass(record) and not isinstance(record, type):
        for part in fields(record):
            if part.name not in ("mark", "notices"):
                yield from parts(getattr(record, part.name), f"{path}.{part.name}")
    elif isinstance(record, tuple):
        for index, item in enumerate(record):
            yield from parts(item, f"{path}.{index}")
    else:
        yield path, repr(record)


def has_effect(before: Outcome, after: Outcome, *, changes: str | None, words: tuple[str, ...]) -> str | None:
    """None where a change has an effect; else what is missing.

    Args:
        before: what the table said before the change.
        after: what it says now.
        changes: a pattern of the paths that may differ; None where a message is needed.
        words: texts of which a message has to contain one, where it stands for an effect.
    """
    said = {str(problem) for problem in before.problems}
    news = [problem for problem in after.problems if str(problem) not in said]
    named = [problem for problem in news if any(word and word in _all_of(problem) for word in words)]
    if after.refused:
        return None if named else f"refused, and no message speaks of {words}: {[str(problem) for problem in news]}"
    paths = before.parts.keys() | after.parts.keys()
    different = sorted(path for path in paths if before.parts.get(path) != after.parts.get(path))
    if named:
        return None
    if not different:
        return f"nothing changes, and no message speaks of {words}"
    if changes is None:
        return f"{different} change, and no message speaks of {words}"
    wrong = [path for path in different if not re.fullmatch(changes, path)]
    return f"{wrong} change, where only {changes} should" if wrong else None


def _all_of(problem: Problem) -> str:
    return f"{problem} {problem.field} {problem.found}"
