"""Findings about files and folders: which files of a folder are descriptions, and what is found in each of them."""

from __future__ import annotations

import contextlib
import os
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.commands.check import emitter_of, has_macros, inspect
from dh2urdf.documents import read_bytes
from dh2urdf.documents.text_files import check_file, is_folder
from dh2urdf.errors import ConfigError, InputError
from dh2urdf.plugin_system.calls import Call, a_record, depending_on, items_of
from dh2urdf.source import Mark, Messages, Problem
from dh2urdf.stages import PACKAGE_FILE, Checks, Expansion, Finding, Repair

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.robot import Robot
    from dh2urdf_check.ask.asking import Answer
    from dh2urdf_check.ask.findings import Seen

say = Messages(__file__)

_CHOICE = "`--as NAME`"
_BEGINNING = 2**16
"""As much of a file as is read to know whether it is a description [B]."""
_LONGEST_SEARCHED = 2**24
"""Size of a file that is searched for what it includes [B]."""
_INCLUDE = re.compile(rb"<(?:xacro:)?include\s[^>]*?file(?:name)?\s*=\s*[\"']([^\"']+)[\"']")
_WAY = re.compile(r"^.*[)}]/*|^/+|^(?:\.{1,2}/)+")
_NAMED = re.compile(rb"<robot\b[^>]*?\sname\s*=")


class Described(NamedTuple):
    """What is in some folders."""

    files: tuple[tuple[Path, str], ...]  # the descriptions, each with the name of its format, in the order of paths
    unreadable: tuple[Problem, ...]  # what is wrong with files that could not be looked at
    looked_at: int  # how many files there are
    packages: tuple[Path, ...]  # the folders that are ROS packages


class Inspections(NamedTuple):
    """Findings about some files."""

    files: tuple[Path, ...]  # the descriptions that were inspected
    looked_at: int  # how many files were looked at to find them
    consumers: dict[str, str]  # the consumers of their formats
    findings: tuple[Finding, ...]  # in the order of the files; what is in a file that several include, once
    answers: tuple[Answer, ...] = ()  # what the programs made of the files that they were given
    robot: Robot | None = None  # of a single file, as far as it can be read


def inspect_files(
    catalog: Catalog,
    paths: Sequence[Path],
    format_name: str | None,
    expansion: Expansion,
    asked: Sequence[str] | None = None,
) -> Inspections:
    """The findings about files, of which the named ones have a format, and about the descriptions in folders.

    All know the ROS packages in the folders. `asked` are the consumers whose programs are given the files, all where it
    is empty; None where nobody is asked.
    """
    folders = [path for path in paths if is_folder(path)]
    named = [path for path in paths if path not in folders]
    for path in named:
        check_file(path, InputError)
    described = described_files(catalog, folders)
    waiting = dict.fromkeys([*((path, format_name) for path in named), *described.files])
    is_one = len(waiting) == 1 and not folders
    known = replace(expansion, package_paths=(*expansion.package_paths, *described.packages))
    emitters = {path: emitter_of(catalog, path, name, _CHOICE) for path, name in waiting}
    findings = list(map(_unreadable, described.unreadable))
    is_used = is_one or expansion == Expansion()
    at_work: contextlib.AbstractContextManager[Iterable[Seen]] = contextlib.nullcontext(())
    if asked is not None:  # Nothing of programs is imported where nobody is asked.
        from dh2urdf_check.ask.findings import asking

        at_work = asking(catalog, emitters.items(), known, asked)
    inspected = {}
    with at_work as seen:
        for path, emitter in emitters.items():
            checks = emitter.can(Checks)
            expands, finds = has_macros(emitter), checks is not None and checks.finds_packages
            is_used = is_used or expands or (finds and not expansion.arguments)
            given = known if expands or is_one else replace(known, arguments={}) if finds else None
            try:
                inspected[path] = inspect(catalog, path, emitter.name, _CHOICE, given)
            except InputError as error:
                if is_one or isinstance(error, ConfigError):
                    raise
                findings += map(_unreadable, error.problems)
        seen_of = {each.path: each for each in seen}
    for path, inspection in inspected.items():
        of_file = seen_of.get(path)
        findings += of_file.beside(inspection.findings) if of_file else inspection.findings
    if not is_used:
        raise ConfigError(say("files-without-macros"))
    different = {(finding.rule, finding.mark, finding.message): finding for finding in reversed(findings)}
    return Inspections(
        files=tuple(emitters),
        looked_at=len(named) + described.looked_at,
        consumers={name: title for each in inspected.values() for name, title in each.consumers.items()},
        findings=tuple(findings) if is_one else tuple(reversed(different.values())),
        answers=tuple(answer for path in inspected if path in seen_of for answer in seen_of[path].answers),
        robot=next((each.robot for each in inspected.values()), None) if is_one else None,
    )


def _unreadable(problem: Problem) -> Finding:
    fix = "make it a file that can be read, or remove it"
    return Finding(rule="unreadable-file", message=problem.message, fix=fix, mark=problem.mark)


def repaired(catalog: Catalog, file: Path, format_name: str | None) -> Repair:
    """A file with what its emitter can fix."""
    emitter = emitter_of(catalog, file, format_name, _CHOICE)
    checks = emitter.can(Checks)
    if checks is None or checks.fix is None:
        raise ConfigError(say("format-not-fixed", Mark(file=str(file)), emitter=emitter.name))
    with depending_on(Call(stage=emitter, options=None, plugin=catalog.plugin_of(emitter)), "fix"):
        return a_record(checks.fix(file), Repair)


# --- The descriptions in a folder -------------------------------------------------------------------------------------


def described_files(catalog: Catalog, folders: Iterable[Path]) -> Described:
    """The robot descriptions in some folders and in those below them, as emitters know those of their formats."""
    files, unreadable, looked_at = dict[tuple[Path, str], None](), list[Problem](), 0
    packages: list[Path] = []
    for folder in folders:
        roots: dict[Path, str] = {}
        paths = sorted(files_in(folder, unreadable))
        for path in paths:
            try:
                check_file(path, InputError)
                roots[path] = _outermost(path)
            except InputError as error:
                unreadable.extend(error.problems)
        found: dict[Path, str] = {}
        for provided in catalog.provided("emitter"):
            emitter, checks = provided.stage, provided.stage.can(Checks)
            if checks is None or checks.descriptions is None:
                continue
            with depending_on(Call(stage=emitter, options=None, plugin=catalog.plugin_of(emitter)), "descriptions"):
                found |= dict.fromkeys(items_of(checks.descriptions(roots), "paths"), emitter.name)
        if not found and not unreadable:
            raise InputError(say("folder-without-description", Mark(file=str(folder)), count=len(paths)))
        looked_at += len(paths)
        packages.extend(path.parent for path in paths if path.name == PACKAGE_FILE)
        files |= dict.fromkeys(sorted(found.items()))
    return Described(tuple(files), tuple(unreadable), looked_at, tuple(packages))


def files_in(
    folder: Path, unreadable: list[Problem], is_entered: Callable[[Path], bool] = lambda _: True
) -> Iterator[Path]:
    """The files in a folder, and in those below it that are entered; hidden folders are not."""

    def refused(error: OSError) -> None:
        unreadable.append(say("folder-unreadable", Mark(file=str(error.filename)), reason=error.strerror))

    for inner, folders, names in os.walk(folder, onerror=refused):
        folders[:] = sorted(name for name in folders if not name.startswith(".") and is_entered(Path(inner, name)))
        yield from (Path(inner, name) for name in sorted(names))


def _outermost(path: Path) -> str:
    """The name of a file's outermost element; empty where the file does not begin as XML does."""
    try:
        with path.open("rb") as file:
            beginning = file.read(_BEGINNING)
    except OSError as error:
        raise InputError(say("file-unreadable", Mark(file=str(path)), reason=error.strerror)) from None
    parser = etree.XMLPullParser(events=("start",), resolve_entities=False, no_network=True, load_dtd=False)
    with contextlib.suppress(etree.XMLSyntaxError):
        parser.feed(beginning.lstrip())
    return next((str(element.tag).rpartition("}")[2] for _, element in parser.read_events()), "")  # type: ignore[union-attr]  # the stubs of lxml


# --- Which of them are whole, and not parts that others include -------------------------------------------------------


def urdfs(roots: Mapping[Path, str]) -> Iterator[Path]:
    """Files whose outermost element is ``robot``, or that are called ``.urdf`` and begin with no element.

    The outermost element of SRDF, which says what MoveIt does with a robot, is ``robot`` too.
    """
    for path, tag in roots.items():
        suffix = path.suffix.lower()
        is_urdf = tag == "robot" or (not tag and suffix == ".urdf")
        if is_urdf and suffix != ".xacro" and ".srdf" not in path.suffixes:
            yield path


def xacros(roots: Mapping[Path, str]) -> Iterator[Path]:
    """Files called ``.xacro`` whose robot has a name, and that no other includes."""
    whole = _whole(roots, lambda path, tag: path.suffix.lower() == ".xacro" and tag in {"robot", ""})
    yield from (path for path, text in whole if ".srdf" not in path.suffixes and _NAMED.search(text))


def sdfs(roots: Mapping[Path, str]) -> Iterator[Path]:
    """Files whose outermost element is ``sdf``, or that are called ``.sdf`` and begin with no element."""
    yield from (path for path, tag in roots.items() if tag == "sdf" or (not tag and path.suffix.lower() == ".sdf"))


def mjcfs(roots: Mapping[Path, str]) -> Iterator[Path]:
    """Files whose outermost element is ``mujoco``, and that no other includes."""
    yield from (path for path, _ in _whole(roots, lambda _, tag: tag == "mujoco"))


def _whole(roots: Mapping[Path, str], is_one: Callable[[Path, str], bool]) -> Iterator[tuple[Path, bytes]]:
    """Files of a format that no other of them includes, with their text."""
    texts: dict[Path, bytes] = {}
    for path in (path for path, tag in roots.items() if is_one(path, tag)):
        try:
            texts[path] = read_bytes(path, InputError, limit=_LONGEST_SEARCHED)
        except InputError:  # The inspection of the file reports it.
            texts[path] = b"<robot name=''/>"
    # What follows a package, an argument, or the way to another folder.
    named = (name.decode("utf-8", "replace") for text in texts.values() for name in _INCLUDE.findall(text))
    ends = {_WAY.sub("", name.replace("\\", "/")) for name in named}
    for path, text in texts.items():
        parts = path.absolute().parts
        if not any("/".join(parts[-count:]) in ends for count in range(1, len(parts) + 1)):
            yield path, text
