"""What `dh2urdf check` found, as JSON, as SARIF 2.1.0 (OASIS, 2020), which code hosts and editors show, and as text."""

from __future__ import annotations

import json
import re
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import quote

import click

from dh2urdf import __version__
from dh2urdf.cli.answers import answer, answers as stream
from dh2urdf.source import Cause, printable
from dh2urdf.stages import PACKAGE_FILE, SEVERITIES, Finding
from dh2urdf_check.rules import address_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from dh2urdf.kinematics.comparison import Agreement, Difference
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.source import Mark
    from dh2urdf_check.ask.asking import Answer
    from dh2urdf_check.files import Inspections

SCHEMA = "dh2urdf-check/1"
"""Name and version of the form of the JSON."""
SARIF_SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
OTHER_ARM = "other-kinematics"


def counts(findings: Sequence[Finding]) -> dict[str, int]:
    """How many findings there are of each severity, the worst first."""
    return {severity: sum(finding.severity == severity for finding in findings) for severity in SEVERITIES}


def comparison_finding(agreement: Agreement, manipulator: Manipulator) -> Finding | None:
    """The finding that a description is not the arm of a table; None where it is."""
    if agreement.holds:
        return None
    differences, remedy, changed = _apart(agreement, manipulator)
    head = f"not the arm of the table {manipulator.name!r} as it stands ({_chain(agreement)})"
    fix = f"{remedy}: {'; '.join(changed)}" if changed else remedy
    return Finding(rule=OTHER_ARM, message="; ".join([head, *differences]), fix=fix)


def _apart(agreement: Agreement, manipulator: Manipulator) -> tuple[list[str], str, Sequence[str]]:
    """How a description and a table differ, whether they can agree, and what to change in the table for that."""
    from dh2urdf.kinematics.comparison import changes

    differences = []
    if agreement.difference is not None:
        q = ", ".join(f"{value:.4g}" for value in agreement.difference.q)
        differences.append(f"they differ by up to {_errors(agreement.difference)}, at q = [{q}]")
    if agreement.first_difference:
        differences.append(agreement.first_difference)
    corrected, remaining = agreement.corrected, agreement.remaining
    if corrected is None or remaining is None:
        return differences, "no base, tool, signs and offsets make them the same arm", ()
    outcome = "agree, within" if remaining.is_none else "differ still, by up to"
    remedy = f"with this in the table they {outcome} {_errors(remaining)}"
    return differences, remedy, [*changes(manipulator, corrected)] or ["nothing"]


def _errors(difference: Difference) -> str:
    return f"{difference.position_error:.2g} m and {difference.angle_error:.2g} rad"


def _chain(agreement: Agreement) -> str:
    return f"{agreement.base_link} to {agreement.tip_link}, {_count(len(agreement.joints), 'joint')}"


class Report(NamedTuple):
    """What a command reports."""

    inspections: Inspections
    findings: Sequence[Finding]  # what was found about the consumers that are asked for
    consumers: Mapping[str, str]  # whom the findings are about
    comparison: tuple[Agreement, Manipulator, Path] | None = None  # the arm beside that of a table
    is_one: bool = True  # whether the command is about one file


def as_json(report: Report) -> str:
    """What was found, as a JSON text."""
    found, findings, answers = report.inspections, report.findings, report.inspections.answers
    document: dict[str, Any] = {"schema": SCHEMA, "version": __version__}
    if report.is_one:
        document["file"] = str(found.files[0])
        asked: dict[str, Any] = {each.program.consumer: {"program": each.name, "end": each.end} for each in answers}
    else:
        document |= {"files": [str(file) for file in found.files], "looked_at": found.looked_at}
        names = dict.fromkeys(each.name for each in answers)
        asked = {name: dict(Counter(each.end for each in answers if each.name == name)) for name in names}
    document |= {"consumers": dict(report.consumers), "asked": asked, "counts": counts(findings)}
    if not report.is_one:
        rules = {
            rule: {
                "severity": min((each.severity for each in of_rule), key=SEVERITIES.index),
                "files": dict(Counter(each.mark.file if each.mark else "" for each in of_rule)),
            }
            for rule, of_rule in by_rule(findings).items()
        }
        document["rules"] = dict(sorted(rules.items(), key=lambda item: SEVERITIES.index(item[1]["severity"])))
    document["findings"] = [
        {
            "rule": finding.rule,
            "severity": finding.severity,
            **_place(finding.mark),
            "calls": [_place(call) for call in finding.calls],
            "message": finding.message,
            "fix": finding.fix,
            "consumers": {
                effect.consumer: {"severity": effect.severity, "does": effect.text, "seen": effect.seen or None}
                for effect in finding.effects
            },
        }
        for finding in findings
    ]
    if report.comparison:
        document["comparison"] = _comparison_entry(*report.comparison)
    return json.dumps(document, indent=2, ensure_ascii=False)


def by_rule(findings: Sequence[Finding]) -> dict[str, list[Finding]]:
    """The findings of each rule."""
    groups: dict[str, list[Finding]] = {}
    for finding in findings:
        groups.setdefault(finding.rule, []).append(finding)
    return groups


def _place(mark: Mark | None) -> dict[str, Any]:
    return {name: getattr(mark, name, None) for name in ("file", "line", "column")}


def _comparison_entry(agreement: Agreement, manipulator: Manipulator, table: Path) -> dict[str, Any]:
    from dh2urdf.kinematics.comparison import changes, number_text
    from dh2urdf.manipulator import JointType

    corrected, correction = agreement.corrected, None
    if corrected is not None:
        correction = {
            **{
                name: {"xyz": list(pose.translation), "rpy": list(pose.rpy)}
                for name, pose in (("base", corrected.base), ("tool", corrected.tool))
            },
            "rows": [
                {
                    "joint": row.joint,
                    "sign": row.sign,
                    "offset": number_text(row.offset, is_angle=row.type is not JointType.PRISMATIC),
                }
                for row in corrected.moving_rows
            ],
            "changes": list(changes(manipulator, corrected)),
            "remaining": asdict(agreement.remaining) if agreement.remaining else None,
        }
    return {
        "table": str(table),
        "manipulator": manipulator.name,
        "agrees": agreement.holds,
        "base_link": agreement.base_link,
        "tip_link": agreement.tip_link,
        "joints": list(agreement.joints),
        "difference": asdict(agreement.difference) if agreement.difference else None,
        "first_difference": agreement.first_difference,
        "correction": correction,
    }


def as_sarif(findings: Sequence[Finding]) -> str:
    """What was found, as a SARIF text."""
    groups, rules = by_rule(findings), list[dict[str, Any]]()
    for name, (first, *_) in groups.items():
        address = address_of(name)  # its page, where it has one
        rules.append({"id": name, "help": {"text": first.fix}, **({"helpUri": address} if address else {})})
    driver = {"name": "dh2urdf", "semanticVersion": __version__, "rules": rules}
    results = [_result(finding, list(groups).index(finding.rule)) for finding in findings]
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    return json.dumps({"$schema": SARIF_SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2, ensure_ascii=False)


def _result(finding: Finding, rule_index: int) -> dict[str, Any]:
    mark = finding.mark
    text = f"{finding.message} ({mark.place})" if mark and mark.place else finding.message
    does = (f"{each.consumer}{f' (seen in {each.seen})' if each.seen else ''}: {each.text}" for each in finding.effects)
    result = {
        "ruleId": finding.rule,
        "ruleIndex": rule_index,
        "level": finding.severity,
        "message": {"text": "\n".join([text, *does, f"fix: {finding.fix}"])},
        "locations": [_location(mark)] if mark else [],
        "properties": {"consumers": [effect.consumer for effect in finding.effects]},
    }
    if finding.calls:
        here = {"message": {"text": "the macro is called here"}}
        result["relatedLocations"] = [{**_location(call), **here} for call in finding.calls]
    return result


def _location(mark: Mark) -> dict[str, Any]:
    file = Path(mark.file)
    address = file.as_uri() if file.is_absolute() else quote(file.as_posix())
    place: dict[str, Any] = {"artifactLocation": {"uri": address}}
    if mark.line:
        place["region"] = {"startLine": mark.line, **({"startColumn": mark.column} if mark.column else {})}
    return {"physicalLocation": place}


# --- For people: each cause once, the worst first, and who loads the file ---------------------------------------------


COLOURS = {"error": "red", "warning": "yellow", "note": "cyan"}
SHORT = 20
"""Lines after which warnings and notes are counted and not printed; errors always are."""
LONGEST = 240
"""Characters of what a consumer does that are printed."""
_PARTICULAR = re.compile(r"'[^']*'|\"[^\"]*\"|\[[^\]]*\]|[-+]?\d[\d.e+-]*|\S*/\S*")
"""What differs between two messages about the same: names, numbers and paths."""


def causes(findings: Iterable[Finding]) -> list[Cause[Finding]]:
    """The causes of some findings, the worst first, and else in their order."""
    found: dict[tuple[object, ...], Cause[Finding]] = {}
    for finding in findings:
        is_own = finding.rule.startswith("seen-")  # What was seen without a rule is alike where its words are.
        effects = tuple(
            (each.consumer, each.severity, is_own and _PARTICULAR.sub("#", each.text)) for each in finding.effects
        )
        key = (finding.rule, effects, finding.fix)
        if key in found and found[key].first.seen < finding.seen:
            found[key] = Cause(finding, [found[key].first, *found[key].others])
        elif key in found:
            found[key].others.append(finding)
        else:
            found[key] = Cause(finding)
    return sorted(found.values(), key=lambda cause: SEVERITIES.index(cause.first.severity))


def print_report(report: Report, *, is_whole: bool) -> None:
    """Print findings, how many there are, what came of the comparison, and who loads the file.

    With `is_whole`, each finding is printed by itself, with all that is known of it.
    """
    of_the_file = [finding for finding in report.findings if finding.rule != OTHER_ARM]
    found = [Cause(finding) for finding in of_the_file] if is_whole else causes(of_the_file)
    count = left_out = 0
    for cause in found:
        severity, lines = cause.first.severity, [*map(printable, _lines(cause, is_whole=is_whole))]
        if not is_whole and severity != "error" and count + len(lines) > SHORT:
            left_out += cause.count
            continue
        count += len(lines)
        if stream().isatty():
            style = click.style(severity, fg=COLOURS[severity], bold=True)
            lines[0] = lines[0].replace(f" {severity}: ", f" {style}: ", 1)
        answer("\n".join(lines))
    rest = f"; {left_out} of them are not printed: --verbose prints all" if left_out else ""
    numbers = [_count(number, severity) for severity, number in counts(of_the_file).items() if number]
    answer(f"{', '.join(numbers) or 'nothing found'}{rest}")
    if not report.is_one:
        files = report.inspections.files
        packages = sum(path.name == PACKAGE_FILE for path in files)
        checked = [_count(len(files) - packages, "description")]
        checked += [_count(packages, "package")] if packages else []
        looked_at = _count(report.inspections.looked_at, "file")
        answer(f"{' and '.join(checked)} checked; {looked_at} looked at")
    if report.comparison:
        answer("\n".join(map(printable, _comparison_lines(*report.comparison))))
    answer(printable(_verdict(report.consumers, of_the_file, report.inspections.answers)))


def _lines(cause: Cause[Finding], *, is_whole: bool) -> Iterator[str]:
    """A cause: of a note one line, of an error or a warning also what is done with it, and the fix."""
    finding = cause.first
    head = f"{f'{finding.mark}: ' if finding.mark else ''}{finding.severity}: {finding.message} [{finding.rule}]"
    more = cause.elsewhere
    if finding.severity == "note" and not is_whole:
        yield f"{head}{f' and {more}' if more else ''}"
        return
    yield head
    if more:
        yield f"    and {more}"
    for call in finding.calls:
        yield f"    by the macro called at {call}"
    for line in _said(finding):
        yield f"    {line if is_whole or len(line) <= LONGEST else f'{line[: LONGEST - 1]}…'}"
    yield f"    fix: {finding.fix}"


def _said(finding: Finding) -> Iterator[str]:
    """What the consumers do, those together that do the same; what was seen says in which program."""
    together: dict[str, list[str]] = {}
    for effect in finding.effects:
        severity = f", {effect.severity}" if effect.severity != finding.severity else ""
        known = f"seen in {effect.seen}" if effect.seen else "foretold"
        together.setdefault(effect.text, []).append(f"{effect.consumer} ({known}{severity})")
    yield from (f"{', '.join(names)}: {text}" for text, names in together.items())


def _verdict(consumers: Mapping[str, str], findings: Sequence[Finding], asked: Sequence[Answer]) -> str:
    """Who loads the files: as was seen of those that were given them, and as the findings foretell of the others."""
    groups: dict[str, list[str]] = {"loads in": [], "does not load in": [], "no error in": [], "errors in": []}
    loads, fails, fine, faulty = groups.values()
    for consumer in consumers:
        if seen := [each for each in asked if each.program.consumer == consumer and each.end != "unasked"]:
            loaded = sum(each.end == "loads" for each in seen)
            share = f" ({loaded} of {len(seen)} files)" if 0 < loaded < len(seen) else ""
            (loads if loaded else fails).append(f"{seen[-1].name}{share}")
        elif any(each.consumer == consumer and each.severity == "error" for one in findings for each in one.effects):
            faulty.append(consumer)
        else:
            fine.append(consumer)
    words = [f"{word} {', '.join(names)}" if names else "" for word, names in groups.items()]
    parts = {"seen": words[:2], "foretold": words[2:]}
    return ". ".join(f"{known}: {'; '.join(filter(None, part))}" for known, part in parts.items() if any(part))


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _comparison_lines(agreement: Agreement, manipulator: Manipulator, table: Path) -> Iterator[str]:
    chain = _chain(agreement)
    if agreement.holds and agreement.difference is not None:
        yield f"the same arm as {manipulator.name} of {table} ({chain}): within {_errors(agreement.difference)}"
        return
    differences, remedy, changed = _apart(agreement, manipulator)
    yield f"error: not the arm {manipulator.name} of {table} as it stands ({chain}) [{OTHER_ARM}]"
    yield from (f"    {line}" for line in (*differences, f"{remedy}:" if changed else remedy))
    yield from (f"        {line}" for line in changed)
