"""The files that a pattern of a run file stands for, as in a shell: `tables/*.csv`, `**/arm.yaml`.

The folders on the way may be a whole disk, on which others are at work: the search has a bound, passes over a folder
that vanishes, and notes one that it may not enter.
"""

from __future__ import annotations

import fnmatch
import glob
import os
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.errors import ConfigError
from dh2urdf.output.whole_files import NOT_THERE
from dh2urdf.source import LONG_PATH, Messages, Problem, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

say = Messages(__file__)

MAX_FILES = 1_000_000
"""Files that one pattern may match."""
MOST_ENTRIES = 3_000_000
"""Files and folders that one pattern may pass: three times the files that it may match; some ten seconds."""
_DEEP = "**"
_NARROWER = f"a pattern of fewer folders, with at most {MAX_FILES} files"
_HIDDEN = (".", "~$")
"""How names begin that no pattern matches unless it begins so: the second is Excel's, of a workbook that is open."""


class Matches(NamedTuple):
    """What a pattern stands for.

    Attributes:
        paths: the files, in the order of their names.
        notice: which folders could not be entered, so that files of theirs may be missing.
    """

    paths: list[Path]
    notice: Problem | None


def matching(folder: Path, pattern: str) -> Matches:
    """The files that match a pattern.

    Args:
        folder: the folder from which the pattern leads, which is no pattern itself.
        pattern: the pattern.

    Raises:
        ConfigError: no file matches, or more than `MAX_FILES`, or the pattern leads past more than `MOST_ENTRIES`.
    """
    search, path = _Search(), Path(pattern)
    parts = path.parts[1:] if path.anchor else path.parts
    parts = tuple([part for part, before in zip(parts, ("", *parts), strict=False) if (part, before) != (_DEEP, _DEEP)])
    try:
        paths = sorted(set(islice(search.files(path.anchor or str(folder), parts), MAX_FILES + 1)))
    except OSError as error:  # /proc and the like
        code, where = "pattern-unsearchable", error.filename
        raise ConfigError(say(code, found=pattern, path=where, reason=error.strerror, most=MAX_FILES)) from None
    if search.passed > MOST_ENTRIES or len(paths) > MAX_FILES:
        code = "pattern-of-too-many" if len(paths) > MAX_FILES else "pattern-too-wide"
        raise ConfigError(say(code, found=pattern, most=MAX_FILES, passed=MOST_ENTRIES))
    told = "".join(
        f"{shown(os.path.normpath(place), LONG_PATH)} cannot be searched: {why}"
        for place, why in [*search.closed.items()][:1]
    )
    if len(search.closed) > 1:
        told += f"; {len(search.closed) - 1} more folders neither"
    if not paths:
        raise ConfigError(say("no-file-matches", found=pattern, folder=folder.absolute(), suggestion=told or None))
    notice = say("files-may-be-missing", field="inputs", found=pattern, reason=told) if told else None
    return Matches(paths, notice)


class _Search:
    """The search for the files that match a pattern.

    Attributes:
        passed: how many files and folders were looked at; it ends after `MOST_ENTRIES`.
        closed: folders that could not be entered, with the reason of each.
    """

    def __init__(self) -> None:
        self.passed = 0
        self.closed: dict[str, str] = {}

    def files(self, path: str, parts: tuple[str, ...]) -> Iterator[Path]:
        """Yield the files below a path that match the rest of a pattern, some of them twice where it has two `**`.

        Links to folders are followed where a name stands for them, not by `**`.

        Raises:
            OSError: a folder cannot be searched for another reason than that it is gone or closed.
        """
        if not parts:
            if os.path.lexists(path) and not os.path.isdir(path):  # noqa: PTH112 - texts are quicker
                yield Path(path)
            return
        part, *rest = parts
        if part == _DEEP:
            yield from self.files(path, (*rest,))
            for entry in self._entries(path):
                if not entry.name.startswith(".") and entry.is_dir(follow_symlinks=False):
                    yield from self.files(entry.path, parts)
        elif not glob.has_magic(part):
            yield from self.files(os.path.join(path, part), (*rest,))  # noqa: PTH118
        else:
            for entry in self._entries(path):
                is_hidden = entry.name.startswith(_HIDDEN) and not part.startswith(_HIDDEN)
                if not is_hidden and fnmatch.fnmatch(entry.name, part):
                    yield from self.files(entry.path, (*rest,))

    def _entries(self, path: str) -> Iterator[os.DirEntry[str]]:
        try:
            with os.scandir(path) as entries:
                for entry in entries:
                    self.passed += 1
                    if self.passed > MOST_ENTRIES:
                        return
                    yield entry
        except NOT_THERE:
            return  # It has vanished, or is a file.
        except PermissionError as error:
            self.closed[path] = error.strerror or str(error)
