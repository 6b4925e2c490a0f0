"""What `dh2urdf check` found, for people: a table on a terminal, plain lines elsewhere; of several files, by rule."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.cli.answers import answer, answers
from dh2urdf.kinematics.comparison import changes
from dh2urdf.source import printable
from dh2urdf.stages import PACKAGE_FILE, SEVERITIES
from dh2urdf_check.reports import OTHER_ARM, by_rule, counts, in_files

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.kinematics.comparison import Agreement, Difference
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Finding
    from dh2urdf_check.several import Inspections

COLOURS = {"error": "red", "warning": "yellow", "note": "cyan"}


def print_findings(
    findings: Sequence[Finding],
    consumers: Mapping[str, str],
    comparison: tuple[Agreement, Manipulator, Path] | None,
) -> None:
    """Print findings, how many there are, and what came of the comparison."""
    of_the_file = [finding for finding in findings if finding.rule != OTHER_ARM]
    if of_the_file and answers().isatty():
        _print_table(of_the_file)
    else:
        for finding in of_the_file:
            answer("\n".join(map(printable, _lines(finding))))
    answer(f"{numbers_of(of_the_file)} for {', '.join(consumers)}")
    if comparison:
        answer("\n".join(map(printable, _comparison(*comparison))))


def numbers_of(findings: Sequence[Finding]) -> str:
    """How many findings there are of each severity, as a sentence says it."""
    numbers = [f"{count} {severity}{'s' if count > 1 else ''}" for severity, count in counts(findings).items() if count]
    return ", ".join(numbers) or "nothing found"


def said(finding: Finding) -> Iterator[str]:
    """What the consumers do, those together that do the same."""
    together: dict[str, list[str]] = {}
    for effect in finding.effects:
        severity = f" ({effect.severity})" if effect.severity != finding.severity else ""
        together.setdefault(effect.text, []).append(f"{effect.consumer}{severity}")
    for text, names in together.items():
        yield f"{', '.join(names)}: {text}"


def _lines(finding: Finding) -> Iterator[str]:
    place = f"{finding.mark}: " if finding.mark else ""
    yield f"{place}{finding.severity}: {finding.message} [{finding.rule}]"
    for call in finding.calls:
        yield f"    by the macro called at {call}"
    for line in said(finding):
        yield f"    {line}"
    yield f"    fix: {finding.fix}"


def _print_table(findings: Sequence[Finding]) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    files = list(dict.fromkeys(finding.mark.file for finding in findings if finding.mark))
    table = Table(title=escape(printable(", ".join(files))), show_lines=True)
    table.add_column("line", justify="right")
    table.add_column("rule", overflow="fold")
    table.add_column("what is there, and how to fix it", ratio=3, overflow="fold")
    table.add_column("what is done with it", ratio=4, overflow="fold")
    for finding in findings:
        mark = finding.mark
        place = str(mark if len(files) > 1 and mark else replace(mark, file="") if mark else "").removeprefix(":")
        colour = COLOURS[finding.severity]
        table.add_row(
            escape(printable("\n".join([place, *(f"by {call}" for call in finding.calls)]))),
            f"[{colour}]{finding.severity}[/]\n{escape(finding.rule)}",
            escape(printable(finding.message)) + f"\n[dim]{escape(printable(finding.fix))}[/]",
            escape("\n".join(map(printable, said(finding)))),
        )
    Console(file=answers(), highlight=False).print(table)


def _comparison(agreement: Agreement, manipulator: Manipulator, table: Path) -> Iterator[str]:
    count = len(agreement.joints)
    chain = f"{agreement.base_link} to {agreement.tip_link}, {count} joint{'' if count == 1 else 's'}"
    if agreement.holds and agreement.difference is not None:
        yield f"the same arm as {manipulator.name} of {table} ({chain}): within {_errors(agreement.difference)}"
        return
    yield f"error: not the arm {manipulator.name} of {table} as it stands ({chain}) [{OTHER_ARM}]"
    if agreement.difference is not None:
        q = ", ".join(f"{value:.4g}" for value in agreement.difference.q)
        yield f"    they differ by up to {_errors(agreement.difference)}, at q = [{q}]"
    if agreement.first_difference:
        yield f"    {agreement.first_difference}"
    if agreement.corrected is None or agreement.remaining is None:
        yield "    no base, tool, signs and offsets make them the same arm"
        return
    outcome = "agree, within" if agreement.remaining.is_none else "differ still, by up to"
    yield f"    with this in the table they {outcome} {_errors(agreement.remaining)}:"
    for line in changes(manipulator, agreement.corrected):
        yield f"        {line}"


def _errors(difference: Difference) -> str:
    return f"{difference.position_error:.2g} m and {difference.angle_error:.2g} rad"


MOST_OF_A_FILE = 3
"""Findings of one rule in one file that are printed; the others are counted."""


def print_grouped(several: Inspections, findings: Sequence[Finding], consumers: Mapping[str, str]) -> None:
    """Print findings by rule, how many there are, and how many files were looked at."""
    for rule, found in by_rule(findings).items():
        answer("\n".join(map(printable, _grouped_lines(rule, found))))
    packages = sum(path.name == PACKAGE_FILE for path in several.files)
    checked = [_count(len(several.files) - packages, "description")]
    if packages:
        checked.append(_count(packages, "package"))
    answer(f"{numbers_of(findings)} for {', '.join(consumers)}")
    answer(f"{' and '.join(checked)} checked; {_count(several.looked_at, 'file')} looked at")


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _grouped_lines(rule: str, findings: Sequence[Finding]) -> Iterator[str]:
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
