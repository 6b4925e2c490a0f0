"""What `dh2urdf check` found, for people: each cause once, the worst first, and who loads the file."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

import click

from dh2urdf.cli.answers import answer, answers as stream
from dh2urdf.source import listed, printable
from dh2urdf.stages import PACKAGE_FILE, SEVERITIES
from dh2urdf_check.reports import OTHER_ARM, counts, errors_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.kinematics.comparison import Agreement
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.source import Mark
    from dh2urdf.stages import Effect, Finding
    from dh2urdf_check.ask.asking import Answer
    from dh2urdf_check.reports import Report

COLOURS = {"error": "red", "warning": "yellow", "note": "cyan"}
SHORT = 20
"""Lines after which warnings and notes are counted and not printed; errors always are."""
LONGEST = 240
"""Characters of what a consumer does that are printed."""
MOST_PLACES = 4
"""Places of one cause that are named besides the first."""
_PARTICULAR = re.compile(r"'[^']*'|\"[^\"]*\"|\[[^\]]*\]|[-+]?\d[\d.e+-]*|\S*/\S*")
"""What differs between two messages about the same: names, numbers and paths."""


class Cause(NamedTuple):
    """Findings that have one cause: a rule, with the same effects in the same programs.

    Attributes:
        first: the first of them.
        others: the others.
    """

    first: Finding
    others: list[Finding]


def causes(findings: Iterable[Finding]) -> list[Cause]:
    """The causes of some findings, the worst first, and else in their order."""
    found: dict[tuple[object, ...], Cause] = {}
    for finding in findings:
        is_own = finding.rule.startswith("seen-")  # What was seen without a rule is alike where its words are.
        effects = tuple((each.consumer, each.severity, is_own and _general(each.text)) for each in finding.effects)
        key = (finding.rule, effects, finding.fix)
        if key in found and found[key].first.seen < finding.seen:
            found[key] = Cause(finding, [found[key].first, *found[key].others])
        elif key in found:
            found[key].others.append(finding)
        else:
            found[key] = Cause(finding, [])
    return sorted(found.values(), key=lambda cause: SEVERITIES.index(cause.first.severity))


def _general(text: str) -> str:
    return _PARTICULAR.sub("#", text)


def print_report(report: Report, *, is_whole: bool) -> None:
    """Print findings, how many there are, what came of the comparison, and who loads the file.

    Args:
        report: what there is to print.
        is_whole: whether each finding is printed by itself, with all that is known of it.
    """
    of_the_file = [finding for finding in report.findings if finding.rule != OTHER_ARM]
    found = [Cause(finding, []) for finding in of_the_file] if is_whole else causes(of_the_file)
    count = left_out = 0
    for cause in found:
        lines = [*_lines(cause, is_whole=is_whole)]
        if not is_whole and cause.first.severity != "error" and count + len(lines) > SHORT:
            left_out += 1 + len(cause.others)
            continue
        count += len(lines)
        _print(lines, cause.first.severity)
    rest = f"; {left_out} of them are not printed: --verbose prints all" if left_out else ""
    answer(f"{numbers_of(of_the_file)}{rest}")
    if not report.is_one:
        files = report.inspections.files
        packages = sum(path.name == PACKAGE_FILE for path in files)
        checked = [_count(len(files) - packages, "description")]
        checked += [_count(packages, "package")] if packages else []
        looked_at = _count(report.inspections.looked_at, "file")
        answer(f"{' and '.join(checked)} checked; {looked_at} looked at")
    if report.comparison:
        answer("\n".join(map(printable, _comparison(*report.comparison))))
    answer(printable(verdict(report.consumers, of_the_file, report.inspections.answers)))


def _print(lines: Sequence[str], severity: str) -> None:
    first, *others = map(printable, lines)
    if stream().isatty():
        first = first.replace(f" {severity}: ", f" {click.style(severity, fg=COLOURS[severity], bold=True)}: ", 1)
    answer("\n".join([first, *others]))


def _lines(cause: Cause, *, is_whole: bool) -> Iterator[str]:
    """A cause: of a note one line, of an error or a warning also what is done with it, and the fix."""
    finding = cause.first
    head = f"{f'{finding.mark}: ' if finding.mark else ''}{finding.severity}: {finding.message} [{finding.rule}]"
    more = _places(finding, cause.others)
    if finding.severity == "note" and not is_whole:
        yield f"{head}{f' and {more}' if more else ''}"
        return
    yield head
    if more:
        yield f"    and {more}"
    for call in finding.calls:
        yield f"    by the macro called at {call}"
    for line in said(finding):
        yield f"    {line if is_whole or len(line) <= LONGEST else f'{line[: LONGEST - 1]}…'}"
    yield f"    fix: {finding.fix}"


def _places(first: Finding, others: Sequence[Finding]) -> str:
    """Where a cause is found besides: how often, and the first places."""
    if not others:
        return ""
    marks = list(dict.fromkeys(each.mark for each in others if each.mark))
    files = {mark.file for mark in marks} | ({first.mark.file} if first.mark else set())
    where = f" in {_count(len(files), 'file')}" if len(files) > 1 else ""
    named = listed(list(dict.fromkeys(_place(mark, first.mark) for mark in marks)), MOST_PLACES)
    return f"{len(others)} more{where}{f': {named}' if named else ''}"


def _place(mark: Mark, first: Mark | None) -> str:
    return f"line {mark.line}" if first and mark.file == first.file and mark.line else str(mark)


def numbers_of(findings: Sequence[Finding]) -> str:
    """How many findings there are of each severity, as a sentence says it."""
    numbers = [_count(count, severity) for severity, count in counts(findings).items() if count]
    return ", ".join(numbers) or "nothing found"


def said(finding: Finding) -> Iterator[str]:
    """What the consumers do, those together that do the same; what was seen says in which program."""
    together: dict[str, list[Effect]] = {}
    for effect in finding.effects:
        together.setdefault(effect.text, []).append(effect)
    for text, effects in together.items():
        names = []
        for effect in effects:
            severity = f", {effect.severity}" if effect.severity != finding.severity else ""
            known = f"seen in {effect.seen}" if effect.seen else "foretold"
            names.append(f"{effect.consumer} ({known}{severity})")
        yield f"{', '.join(names)}: {text}"


def verdict(consumers: Mapping[str, str], findings: Sequence[Finding], asked: Sequence[Answer]) -> str:
    """Who loads the files: as was seen of those that were given them, and as the findings foretell of the others."""
    ends: dict[str, list[Answer]] = {}
    for each in asked:
        if each.end != "unasked":
            ends.setdefault(each.program.consumer, []).append(each)
    loads, fails, fine, faulty = list[str](), list[str](), list[str](), list[str]()
    for consumer in consumers:
        if seen := ends.get(consumer):
            loaded = sum(each.end == "loads" for each in seen)
            share = f" ({loaded} of {len(seen)} files)" if 0 < loaded < len(seen) else ""
            (loads if loaded else fails).append(f"{seen[-1].name}{share}")
        elif any(each.consumer == consumer and each.severity == "error" for one in findings for each in one.effects):
            faulty.append(consumer)
        else:
            fine.append(consumer)
    parts = [
        f"seen: {'; '.join(part for part in (_part('loads in', loads), _part('does not load in', fails)) if part)}",
        f"foretold: {'; '.join(part for part in (_part('no error in', fine), _part('errors in', faulty)) if part)}",
    ]
    return ". ".join(part for part in parts if not part.endswith(": "))


def _part(words: str, names: Sequence[str]) -> str:
    return f"{words} {', '.join(names)}" if names else ""


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _comparison(agreement: Agreement, manipulator: Manipulator, table: Path) -> Iterator[str]:
    from dh2urdf.kinematics.comparison import changes

    count = len(agreement.joints)
    chain = f"{agreement.base_link} to {agreement.tip_link}, {count} joint{'' if count == 1 else 's'}"
    if agreement.holds and agreement.difference is not None:
        yield f"the same arm as {manipulator.name} of {table} ({chain}): within {errors_of(agreement.difference)}"
        return
    yield f"error: not the arm {manipulator.name} of {table} as it stands ({chain}) [{OTHER_ARM}]"
    if agreement.difference is not None:
        q = ", ".join(f"{value:.4g}" for value in agreement.difference.q)
        yield f"    they differ by up to {errors_of(agreement.difference)}, at q = [{q}]"
    if agreement.first_difference:
        yield f"    {agreement.first_difference}"
    if agreement.corrected is None or agreement.remaining is None:
        yield "    no base, tool, signs and offsets make them the same arm"
        return
    outcome = "agree, within" if agreement.remaining.is_none else "differ still, by up to"
    yield f"    with this in the table they {outcome} {errors_of(agreement.remaining)}:"
    for line in changes(manipulator, agreement.corrected):
        yield f"        {line}"
