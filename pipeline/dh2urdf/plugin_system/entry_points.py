"""The entry points that plugins may have, as `importlib.metadata.entry_points` finds them, without an import of it.

It imports some forty modules, the parser of e-mails among them, which take a tenth of the time of a conversion. The
entry points of a distribution are lines of a text file, in a folder with the distribution's metadata. What is no such
folder is left to `importlib.metadata`: zip archives, eggs, and what other finders than Python's own find.
"""

from __future__ import annotations

import os
import sys
from functools import cached_property
from importlib import import_module
from importlib.machinery import PathFinder
from itertools import takewhile
from typing import TYPE_CHECKING, Any

from dh2urdf.late_tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Protocol

    class AnyDistribution(Protocol):
        """What is asked of a distribution; an `importlib.metadata.Distribution` has it, too."""

        @property
        def name(self) -> str:
            """Its name, as its metadata have it."""

        @property
        def version(self) -> str:
            """Its version."""


_INFO = (".dist-info", ".egg-info")


def canonical(name: str) -> str:
    """A distribution's name as pip compares it."""
    return "-".join(filter(None, name.lower().replace(".", "-").replace("_", "-").split("-")))


class Point(NamedTuple):
    """An entry point.

    Attributes:
        group: the heading above it.
        name: what stands before the ``=``.
        value: what stands after it: a module, or a name in one.
        distribution: what has it.
    """

    group: str
    name: str
    value: str
    distribution: AnyDistribution | None

    def load(self) -> Any:  # noqa: ANN401 - anything
        """Import the module; the module, or what is named in it."""
        if self.value.replace(".", "").isidentifier():
            return import_module(self.value)
        from importlib.metadata import EntryPoint

        if EntryPoint.pattern.match(self.value) is None:
            raise ImportError(f"its entry point {self.name!r} names no module: {self.value!r}")
        return EntryPoint(self.name, self.value, self.group).load()


class InfoFolder:
    """A distribution, of which only the folder with its metadata is known as long as nobody asks for more."""

    def __init__(self, path: str) -> None:
        self._path = path

    @property
    def name(self) -> str:
        """Its name, as its metadata have it."""
        return self._name_and_version[0]

    @property
    def version(self) -> str:
        """Its version."""
        return self._name_and_version[1]

    @cached_property
    def _name_and_version(self) -> tuple[str, str]:
        found: dict[str, str] = {}
        for line in takewhile(bool, _text(self._path, "METADATA").splitlines()):
            word, _, value = line.partition(":")
            found.setdefault(word.lower(), value.lstrip(" \t"))
        if "name" in found and "version" in found:
            return found["name"], found["version"]
        from importlib.metadata import Distribution

        distribution = Distribution.at(self._path)
        # What is missing in broken metadata, such as an interrupted installation leaves, is in the name of the folder.
        name, _, version = os.path.basename(self._path).rpartition(".")[0].partition("-")  # noqa: PTH119 - as below
        return distribution.name or name, distribution.version or version or "of an unknown version"


def version_of(distribution: str) -> str:
    """The version of an installed distribution, as `importlib.metadata.version` has it."""
    if folder := (_installed() or {}).get(canonical(distribution)):
        return InfoFolder(folder).version
    from importlib.metadata import version

    return version(distribution)


def points(word: str) -> list[Point]:
    """The entry points of the distributions that have a word in their list of entry points."""
    folders = _installed()
    if folders is not None:
        return [point for folder in folders.values() for point in _points_in(folder, word)]
    from importlib.metadata import entry_points

    others = entry_points()
    return [
        Point(group, point.name, point.value, point.dist)
        for group in others.groups
        for point in others.select(group=group)
    ]


def _installed() -> dict[str, str] | None:
    """The folders with the metadata of distributions, by their names; None where names alone do not show all."""
    if [finder for finder in sys.meta_path if hasattr(finder, "find_distributions")] != [PathFinder]:
        return None
    found: dict[str, str] = {}
    for place in sys.path:
        try:
            children = os.listdir(place or ".")  # noqa: PTH208 - a path for each of some hundred takes as long as all else
        except NotADirectoryError:
            return None  # a zip archive
        except OSError:
            continue
        folders = [child for child in children if child.lower().endswith(_INFO)]
        if place.lower().endswith(".egg") or not all(child.endswith(_INFO) for child in folders):
            return None
        for child in folders:  # What is found first hides what has the same name, as for imports.
            name = canonical(child.rpartition(".")[0].partition("-")[0])
            found.setdefault(name, os.path.join(place, child))  # noqa: PTH118 - as above
    return found


def _points_in(folder: str, word: str) -> Iterator[Point]:
    if not (text := _text(folder, "entry_points.txt", word.encode())):
        return
    distribution, group = InfoFolder(folder), None
    for line in map(str.strip, text.splitlines()):
        if line.startswith("[") and line.endswith("]"):
            group = line.strip("[]")
        elif line and not line.startswith("#") and group is not None:
            name, _, value = line.partition("=")
            yield Point(group, name.strip(), value.strip(), distribution)


def _text(folder: str, file: str, word: bytes = b"") -> str:
    """The text of a file of metadata; empty where it is missing, or has no such word."""
    try:
        with open(os.path.join(folder, file), "rb") as opened:  # noqa: PTH118, PTH123 - as above
            data = opened.read()
    except (FileNotFoundError, NotADirectoryError, IsADirectoryError, PermissionError):
        return ""
    return data.decode(errors="replace") if word in data else ""
