"""The robot descriptions among the files of a folder, by what the files hold."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from xml.parsers import expat

from dh2urdf.documents.text_files import check_file
from dh2urdf.errors import InputError
from dh2urdf.source import Mark, Problem
from dh2urdf.stage_calls.calls import Call, depending_on, items_of
from dh2urdf.stages import PACKAGE_FILE, Checks

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.plugin_system.catalog import Catalog

BEGINNING = 2**16
"""As much of a file as is read to know whether it is a description [B]."""


class Described(NamedTuple):
    """What is in some folders.

    Attributes:
        files: the descriptions, each with the name of its format, in the order of their paths.
        unreadable: what is wrong with files that could not be looked at.
        looked_at: how many files there are.
        packages: the folders that are ROS packages.
    """

    files: tuple[tuple[Path, str], ...]
    unreadable: tuple[Problem, ...]
    looked_at: int
    packages: tuple[Path, ...]


def described_files(catalog: Catalog, folders: Iterable[Path]) -> Described:
    """The robot descriptions in some folders and in those below them; hidden folders are not entered.

    Args:
        catalog: the emitters, which know the descriptions of their formats.
        folders: the folders.

    Raises:
        InputError: a folder cannot be read, or there is no description in it.
        BrokenPluginError: an emitter is at fault.
    """
    files, unreadable, looked_at = list[tuple[Path, str]](), list[Problem](), 0
    packages: list[Path] = []
    for folder in folders:
        roots: dict[Path, str] = {}
        paths = sorted(_files(folder, unreadable))
        for path in paths:
            try:
                check_file(path, InputError)
                roots[path] = outermost(path)
            except InputError as error:
                unreadable.extend(error.problems)
        found = {path: name for name, path in _claimed(catalog, roots)}
        if not found and not unreadable:
            raise InputError(
                Problem(
                    message=f"no robot description is in this folder ({len(paths)} files looked at)",
                    mark=Mark(file=str(folder)),
                    accepted="files whose outermost element is that of a format that `dh2urdf check` knows",
                )
            )
        looked_at += len(paths)
        packages.extend(path.parent for path in paths if path.name == PACKAGE_FILE)
        files.extend(sorted(found.items()))
    return Described(tuple(dict.fromkeys(files)), tuple(unreadable), looked_at, tuple(packages))


def _claimed(catalog: Catalog, roots: dict[Path, str]) -> Iterator[tuple[str, Path]]:
    for provided in catalog.provided("emitter"):
        emitter, checks = provided.stage, provided.stage.can(Checks)
        if checks is None or checks.descriptions is None:
            continue
        with depending_on(Call(stage=emitter, options=None, plugin=catalog.plugin_of(emitter)), "descriptions"):
            for path in items_of(checks.descriptions(roots), "paths"):
                yield emitter.name, path


def _files(folder: Path, unreadable: list[Problem]) -> Iterator[Path]:
    def refused(error: OSError) -> None:
        message = f"this folder cannot be read: {error.strerror}"
        unreadable.append(Problem(message=message, mark=Mark(file=str(error.filename))))

    for inner, folders, names in os.walk(folder, onerror=refused):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        yield from (Path(inner, name) for name in names)


class _FoundError(Exception):
    pass


def outermost(path: Path) -> str:
    """The name of a file's outermost element; empty where the file does not begin as XML does.

    Raises:
        InputError: the file cannot be read.
    """
    try:
        with path.open("rb") as file:
            beginning = file.read(BEGINNING)
    except OSError as error:
        raise InputError(Problem(message=f"it cannot be read: {error.strerror}", mark=Mark(file=str(path)))) from None
    name = ""

    def started(tag: str, _attributes: dict[str, str]) -> None:
        nonlocal name
        name = tag
        raise _FoundError

    parser = expat.ParserCreate()
    parser.StartElementHandler = started
    with contextlib.suppress(_FoundError, expat.ExpatError, ValueError, LookupError):
        parser.Parse(beginning.lstrip(), False)
    return name
