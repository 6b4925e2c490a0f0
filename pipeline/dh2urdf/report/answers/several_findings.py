"""What `dh2urdf check` found in several files, by rule, and as JSON."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from dh2urdf._version import __version__
from dh2urdf.report.answers.findings import SCHEMA, counts, finding_entry
from dh2urdf.stages import SEVERITIES

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.commands.check import Inspections
    from dh2urdf.stages import Finding


def by_rule(findings: Sequence[Finding]) -> dict[str, list[Finding]]:
    """The findings of each rule; the rules with the worst of them first."""
    groups: dict[str, list[Finding]] = {}
    for finding in findings:
        groups.setdefault(finding.rule, []).append(finding)

    def badness(item: tuple[str, list[Finding]]) -> int:
        return min(SEVERITIES.index(finding.severity) for finding in item[1])

    return dict(sorted(groups.items(), key=badness))


def in_files(findings: Sequence[Finding]) -> dict[str, int]:
    """How many findings there are in each file."""
    files: dict[str, int] = {}
    for finding in findings:
        name = finding.mark.file if finding.mark else ""
        files[name] = files.get(name, 0) + 1
    return files


def as_json(several: Inspections, findings: Sequence[Finding], consumers: Mapping[str, str]) -> str:
    """What was found, as a JSON text."""
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "version": __version__,
        "files": [str(file) for file in several.files],
        "looked_at": several.looked_at,
        "consumers": dict(consumers),
        "counts": counts(findings),
        "rules": {
            rule: {"severity": min((f.severity for f in found), key=SEVERITIES.index), "files": in_files(found)}
            for rule, found in by_rule(findings).items()
        },
        "findings": [finding_entry(finding) for finding in findings],
    }
    return json.dumps(document, indent=2, ensure_ascii=False)
