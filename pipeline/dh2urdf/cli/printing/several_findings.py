"""What `dh2urdf check` found in several files, for people: by rule, and of each rule where."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.cli.answers import answer
from dh2urdf.cli.printing.findings import numbers_of, said
from dh2urdf.report.answers.several_findings import by_rule, in_files
from dh2urdf.source import printable
from dh2urdf.stages import PACKAGE_FILE, SEVERITIES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.commands.check import Inspections
    from dh2urdf.stages import Finding

MOST_OF_A_FILE = 3
"""Findings of one rule in one file that are printed; the others are counted."""


def print_grouped(several: Inspections, findings: Sequence[Finding], consumers: Mapping[str, str]) -> None:
    """Print findings by rule, how many there are, and how many files were looked at."""
    for rule, found in by_rule(findings).items():
        answer("\n".join(map(printable, _lines(rule, found))))
    packages = sum(path.name == PACKAGE_FILE for path in several.files)
    checked = [_count(len(several.files) - packages, "description")]
    if packages:
        checked.append(_count(packages, "package"))
    answer(f"{numbers_of(findings)} for {', '.join(consumers)}")
    answer(f"{' and '.join(checked)} checked; {_count(several.looked_at, 'file')} looked at")


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _lines(rule: str, findings: Sequence[Finding]) -> Iterator[str]:
    files = in_files(findings)
    severity = min((finding.severity for finding in findings), key=SEVERITIES.index)
    yield f"{severity}: [{rule}] in {len(files)} file{'' if len(files) == 1 else 's'}"
    for file, count in files.items():
        here = [finding for finding in findings if (finding.mark.file if finding.mark else "") == file]
        for finding in here[:MOST_OF_A_FILE]:
            yield f"    {finding.mark or file}: {finding.message}"
        if count > MOST_OF_A_FILE:
            yield f"    {file}: and {count - MOST_OF_A_FILE} more"
    for line in dict.fromkeys(line for finding in findings for line in said(finding)):
        yield f"        {line}"
    yield f"        fix: {findings[0].fix}"
