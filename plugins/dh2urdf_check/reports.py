"""What `dh2urdf check` found, as JSON and as SARIF 2.1.0 (OASIS, 2020), which code hosts and editors show in place."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import quote

from dh2urdf import __version__
from dh2urdf.stages import SEVERITIES, Finding
from dh2urdf_check.explaining import address_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.kinematics.comparison import Agreement, Difference
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.source import Mark
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
    from dh2urdf.kinematics.comparison import changes

    if agreement.holds:
        return None
    message = f"the description is not the arm of the table {manipulator.name!r} as it stands"
    if agreement.difference is not None:
        message += f": {agreement.tip_link} is up to {errors_of(agreement.difference)} away"
    if agreement.first_difference:
        message += f"; {agreement.first_difference}"
    corrected, remaining = agreement.corrected, agreement.remaining
    if corrected is None or remaining is None:
        return Finding(rule=OTHER_ARM, message=message, fix="no base, tool, signs and offsets make them the same arm")
    said = "; ".join(changes(manipulator, corrected)) or "nothing"
    what = "makes them the same arm" if remaining.is_none else f"brings them to within {errors_of(remaining)}"
    return Finding(rule=OTHER_ARM, message=message, fix=f"this in the table {what}: {said}")


def errors_of(difference: Difference) -> str:
    """How far two arms are from each other, as a sentence has it."""
    return f"{difference.position_error:.2g} m and {difference.angle_error:.2g} rad"


class Report(NamedTuple):
    """What a command reports.

    Attributes:
        inspections: the files, and what was found in them.
        findings: what of that is about the consumers that are asked for.
        consumers: whom the findings are about.
        comparison: the arm beside that of a table.
        is_one: whether the command is about one file.
    """

    inspections: Inspections
    findings: Sequence[Finding]
    consumers: Mapping[str, str]
    comparison: tuple[Agreement, Manipulator, Path] | None = None
    is_one: bool = True


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
        document["rules"] = {
            rule: {
                "severity": min((each.severity for each in of_rule), key=SEVERITIES.index),
                "files": dict(Counter(each.mark.file if each.mark else "" for each in of_rule)),
            }
            for rule, of_rule in by_rule(findings).items()
        }
    document["findings"] = [finding_entry(finding) for finding in findings]
    if report.comparison:
        document["comparison"] = _comparison(*report.comparison)
    return json.dumps(document, indent=2, ensure_ascii=False)


def by_rule(findings: Sequence[Finding]) -> dict[str, list[Finding]]:
    """The findings of each rule; the rules with the worst of them first."""
    groups: dict[str, list[Finding]] = {}
    for finding in findings:
        groups.setdefault(finding.rule, []).append(finding)

    def badness(item: tuple[str, list[Finding]]) -> int:
        return min(SEVERITIES.index(finding.severity) for finding in item[1])

    return dict(sorted(groups.items(), key=badness))


def finding_entry(finding: Finding) -> dict[str, Any]:
    """A finding as the JSON has it."""
    return {
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


def _place(mark: Mark | None) -> dict[str, Any]:
    return {name: getattr(mark, name, None) for name in ("file", "line", "column")}


def _comparison(agreement: Agreement, manipulator: Manipulator, table: Path) -> dict[str, Any]:
    from dh2urdf.kinematics.comparison import changes, number_text
    from dh2urdf.manipulator import JointType

    corrected = agreement.corrected
    return {
        "table": str(table),
        "manipulator": manipulator.name,
        "agrees": agreement.holds,
        "base_link": agreement.base_link,
        "tip_link": agreement.tip_link,
        "joints": list(agreement.joints),
        "difference": _difference(agreement.difference),
        "first_difference": agreement.first_difference,
        "correction": None
        if corrected is None
        else {
            "base": _pose(corrected.base),
            "tool": _pose(corrected.tool),
            "rows": [
                {
                    "joint": row.joint,
                    "sign": row.sign,
                    "offset": number_text(row.offset, is_angle=row.type is not JointType.PRISMATIC),
                }
                for row in corrected.moving_rows
            ],
            "changes": list(changes(manipulator, corrected)),
            "remaining": _difference(agreement.remaining),
        },
    }


def _difference(difference: Difference | None) -> dict[str, Any] | None:
    return {**asdict(difference), "q": list(difference.q)} if difference else None


def _pose(pose: Any) -> dict[str, list[float]]:  # noqa: ANN401 - a rigid transform
    return {"xyz": list(pose.translation), "rpy": list(pose.rpy)}


def as_sarif(findings: Sequence[Finding]) -> str:
    """What was found, as a SARIF text."""
    names = list(dict.fromkeys(finding.rule for finding in findings))
    first = {name: next(finding for finding in findings if finding.rule == name) for name in names}
    driver = {
        "name": "dh2urdf",
        "semanticVersion": __version__,
        "rules": [_rule(first[name]) for name in names],
    }
    results = [_result(finding, names.index(finding.rule)) for finding in findings]
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    return json.dumps({"$schema": SARIF_SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2, ensure_ascii=False)


def _rule(finding: Finding) -> dict[str, Any]:
    """The rule of a finding; its page where it has one."""
    address = address_of(finding.rule)
    return {"id": finding.rule, "help": {"text": finding.fix}, **({"helpUri": address} if address else {})}


def _result(finding: Finding, rule_index: int) -> dict[str, Any]:
    mark = finding.mark
    text = f"{finding.message} ({mark.place})" if mark and mark.place else finding.message
    does = (f"{each.consumer}{f' (seen in {each.seen})' if each.seen else ''}: {each.text}" for each in finding.effects)
    said = [text, *does, f"fix: {finding.fix}"]
    result = {
        "ruleId": finding.rule,
        "ruleIndex": rule_index,
        "level": finding.severity,
        "message": {"text": "\n".join(said)},
        "locations": [_location(mark)] if mark else [],
        "properties": {"consumers": [effect.consumer for effect in finding.effects]},
    }
    if finding.calls:
        result["relatedLocations"] = [
            {**_location(call), "message": {"text": "the macro is called here"}} for call in finding.calls
        ]
    return result


def _location(mark: Mark) -> dict[str, Any]:
    place: dict[str, Any] = {"artifactLocation": {"uri": _uri(Path(mark.file))}}
    if mark.line:
        place["region"] = {"startLine": mark.line, **({"startColumn": mark.column} if mark.column else {})}
    return {"physicalLocation": place}


def _uri(file: Path) -> str:
    return file.as_uri() if file.is_absolute() else quote(file.as_posix())
