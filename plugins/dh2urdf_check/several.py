"""Findings about several files, and files with what is mechanical fixed: what `dh2urdf check` does besides one file."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.commands.check import emitter_of, has_macros, inspect
from dh2urdf.documents.text_files import check_file, is_folder
from dh2urdf.errors import ConfigError, InputError
from dh2urdf.source import Mark, Problem
from dh2urdf.stage_calls.calls import Call, a_record, depending_on
from dh2urdf.stages import Checks, Expansion, Finding, Repair
from dh2urdf_check.ask.findings import asking, seen_findings
from dh2urdf_check.described_files import described_files

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Inspection
    from dh2urdf_check.ask.asking import Answer

_UNREADABLE = Finding(rule="unreadable-file", message="", fix="make it a file that can be read, or remove it")


class Inspections(NamedTuple):
    """Findings about several files.

    Attributes:
        files: the descriptions that were inspected.
        looked_at: how many files were looked at to find them.
        consumers: the consumers of their formats.
        findings: what was found, in the order of the files; of a file that several include, once.
        answers: what the programs made of the files that were asked.
    """

    files: tuple[Path, ...]
    looked_at: int
    consumers: dict[str, str]
    findings: tuple[Finding, ...]
    answers: tuple[Answer, ...] = ()


def inspect_several(
    catalog: Catalog,
    paths: Iterable[Path],
    format_name: str | None,
    choice: str,
    expansion: Expansion,
    *,
    asked: Sequence[str] | None = None,
) -> Inspections:
    """The findings about files and about the descriptions in folders, which know the ROS packages in there.

    Args:
        catalog: the emitters that there are.
        paths: files and folders.
        format_name: the format of the files that are named; by their suffix where it is None.
        choice: how a format is named, for messages.
        expansion: how those are expanded that hold macros, and where packages are.
        asked: the consumers whose programs are given the files, all where it is empty; None where nobody is asked.

    Raises:
        InputError: a file that is named cannot be read, or there is nothing to inspect in a folder.
        ConfigError: the format of a file that is named cannot be checked, or no file takes the arguments.
        BrokenPluginError: an emitter is at fault.
    """
    waiting: list[tuple[Path, str | None]] = []
    unreadable: list[Problem] = []
    packages: list[Path] = []
    looked_at = 0
    for path in paths:
        if is_folder(path):
            found = described_files(catalog, [path])
            waiting.extend(found.files)
            unreadable.extend(found.unreadable)
            looked_at += found.looked_at
            packages.extend(found.packages)
        else:
            check_file(path, InputError)
            waiting.append((path, format_name))
            looked_at += 1
    consumers: dict[str, str] = {}
    findings = [replace(_UNREADABLE, message=problem.message, mark=problem.mark) for problem in unreadable]
    waiting = list(dict.fromkeys(waiting))
    is_used = expansion == Expansion()
    known = replace(expansion, package_paths=(*expansion.package_paths, *packages))
    with_emitters = [(path, emitter_of(catalog, path, name, choice)) for path, name in waiting]
    answers: list[Answer] = []
    with asking(catalog, with_emitters, known, asked) as seen:
        by_path: dict[Path, Inspection] = {}
        for path, emitter in with_emitters:
            checks = emitter.can(Checks)
            expands, finds = has_macros(emitter), checks is not None and checks.finds_packages
            is_used = is_used or expands or (finds and not expansion.arguments)
            given = known if expands else replace(known, arguments={}) if finds else None
            try:
                by_path[path] = inspect(catalog, path, emitter.name, choice, given)
            except InputError as error:
                if isinstance(error, ConfigError):
                    raise
                findings += [replace(_UNREADABLE, message=each.message, mark=each.mark) for each in error.problems]
        seen_of = {each.given.path: each for each in seen}
    for path, inspection in by_path.items():
        consumers.update(inspection.consumers)
        if each := seen_of.get(path):
            answers.extend(each.answers)
            findings.extend(seen_findings(each, inspection.findings))
        else:
            findings.extend(inspection.findings)
    if not is_used:
        message = "none of these files has macros: they take no arguments, and only a URDF takes package paths"
        raise ConfigError(Problem(message=message, accepted="NAME:=VALUE and package paths with a xacro"))
    different = {(finding.rule, finding.mark, finding.message): finding for finding in reversed(findings)}
    paths = tuple(path for path, _ in waiting)
    return Inspections(paths, looked_at, consumers, tuple(reversed(different.values())), tuple(answers))


def repaired(catalog: Catalog, file: Path, format_name: str | None, choice: str) -> Repair:
    """A file with what its emitter can fix.

    Raises:
        InputError: the file cannot be read.
        ConfigError: files of the format are not fixed.
        BrokenPluginError: the emitter is at fault.
    """
    emitter = emitter_of(catalog, file, format_name, choice)
    checks = emitter.can(Checks)
    if checks is None or checks.fix is None:
        message = f"files of the format {emitter.name!r} are not fixed"
        suggestion = "fix them at the places that the findings name"
        raise ConfigError(Problem(message=message, mark=Mark(file=str(file)), accepted="a URDF", suggestion=suggestion))
    with depending_on(Call(stage=emitter, options=None, plugin=catalog.plugin_of(emitter)), "fix"):
        return a_record(checks.fix(file), Repair)
