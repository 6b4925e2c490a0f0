"""The files that a pattern of a run file stands for, as in a shell: `tables/*.csv`, `**/arm.yaml`.

The folders on the way may be a whole disk, on which others are at work: the search has a bound, passes over a folder
that vanishes, and notes one that it may not enter.
"""

from __future__ import annotations

import fnmatch
import glob
import os
import re
import sys
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.documents.text_files import LONG_PATH
from dh2urdf.errors import ConfigError
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.output.whole_files import NOT_THERE
from dh2urdf.source import Problem, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

MAX_FILES = 1_000_000
"""Files that one pattern may match."""
MOST_ENTRIES = 3_000_000
"""Files and folders that one pattern may pass: three times the files that it may match; some ten seconds."""
_DEEP = "**"
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
    search = _Search(folder, pattern)
    narrower = "a pattern of fewer folders"
    try:
        paths = sorted(islice(search.files(), MAX_FILES + 1))
    except OSError as error:  # /proc and the like
        told = f"{shown(str(error.filename), LONG_PATH)} cannot be searched: {error.strerror}"
        raise ConfigError(Problem(message=f"{shown(pattern)}: {told}", accepted=narrower)) from None
    except _TooManyError:
        message = f"{shown(pattern)} leads past more than {MOST_ENTRIES:,} files and folders"
        raise ConfigError(Problem(message=message, accepted=narrower)) from None
    if len(paths) > MAX_FILES:
        message = f"more than {MAX_FILES} files match {shown(pattern)}"
        raise ConfigError(Problem(message=message, accepted=f"at most {MAX_FILES} files for one pattern"))
    closed = [
        f"{shown(os.path.normpath(path), LONG_PATH)} cannot be searched: {why}" for path, why in search.closed.items()
    ]
    told = "".join([*closed[:1], *([f"; {len(closed) - 1} more folders neither"] if len(closed) > 1 else [])])
    if not paths:
        message = f"no file matches {shown(pattern)} in the folder {shown(str(folder.absolute()), LONG_PATH)}"
        raise ConfigError(Problem(message=message, suggestion=told or None))
    message = f"files that match {shown(pattern)} may be missing: {told}"
    return Matches(paths, Problem(message=message, severity="notice", field="inputs") if closed else None)


class _TooManyError(Exception):
    """A pattern passes more files and folders than it may."""


class _Search:
    """The search for the files that match a pattern.

    Attributes:
        passed: how many files and folders were looked at.
        closed: folders that could not be entered, with the reason of each.
    """

    def __init__(self, folder: Path, pattern: str) -> None:
        """Takes the folder from which the pattern leads, which is no pattern itself."""
        path = Path(pattern)
        self._start = Path(path.anchor) if path.anchor else folder
        parts = path.parts[1:] if path.anchor else path.parts
        self._parts = [
            part for place, part in enumerate(parts) if part != _DEEP or parts[place - 1 : place] != (_DEEP,)
        ]
        flags = re.IGNORECASE if sys.platform == "win32" else 0
        self._tests = [re.compile(fnmatch.translate(part), flags) for part in self._parts]
        self.passed = 0
        self.closed: dict[str, str] = {}

    def files(self) -> Iterator[Path]:
        """The files, in no particular order; links to folders are followed where a name stands for them, not by `**`.

        Raises:
            _TooManyError: `MOST_ENTRIES` were passed.
            OSError: a folder cannot be searched for another reason than that it is gone or closed.
        """
        seen: set[tuple[str, int]] = set()  # With two `**` there are several ways to a file.
        waiting = [(str(self._start), 0)]
        while waiting:
            path, place = waiting.pop()
            if self._parts.count(_DEEP) > 1:
                if (path, place) in seen:
                    continue
                seen.add((path, place))
            if place == len(self._parts):
                if os.path.lexists(path) and not os.path.isdir(path):  # noqa: PTH112 - texts are quicker
                    yield Path(path)
            elif self._parts[place] == _DEEP:
                waiting.append((path, place + 1))
                waiting += [(entry.path, place) for entry in self._entries(path) if _is_inside(entry)]
            elif not glob.has_magic(self._parts[place]):
                waiting.append((os.path.join(path, self._parts[place]), place + 1))  # noqa: PTH118
            else:
                yield from self._matching(path, place, waiting)

    def _matching(self, path: str, place: int, waiting: list[tuple[str, int]]) -> Iterator[Path]:
        """The files in a folder that match the last part of the pattern, or the folders that match another one."""
        is_last, test = place == len(self._parts) - 1, self._tests[place]
        shows_hidden = self._parts[place].startswith(_HIDDEN)
        for entry in self._entries(path):
            if test.match(entry.name) and (shows_hidden or not entry.name.startswith(_HIDDEN)):
                if not is_last:
                    waiting.append((entry.path, place + 1))
                elif not _is_folder(entry):
                    yield Path(entry.path)

    def _entries(self, path: str) -> Iterator[os.DirEntry[str]]:
        try:
            with os.scandir(path) as entries:
                for entry in entries:
                    self.passed += 1
                    if self.passed > MOST_ENTRIES:
                        raise _TooManyError
                    yield entry
        except NOT_THERE:
            return  # It has vanished, or is a file.
        except PermissionError as error:
            self.closed[path] = error.strerror or str(error)


def _is_folder(entry: os.DirEntry[str]) -> bool:
    """Whether an entry is a folder, or a link to one; what a link that leads in a circle is, its reader reports."""
    try:
        return entry.is_dir()
    except OSError:
        return False


def _is_inside(entry: os.DirEntry[str]) -> bool:
    """Whether `**` goes into an entry."""
    return not entry.name.startswith(".") and entry.is_dir(follow_symlinks=False)
