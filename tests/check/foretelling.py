"""What the findings about a file foretell, beside what a consumer does with it, and published descriptions to ask of."""

from __future__ import annotations

import importlib.metadata
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from consumers import behaviours

from dh2urdf_check.inspection import inspect_urdf
from dh2urdf_check.rules import Outcome, rules

if TYPE_CHECKING:
    from consumers import Behaviour

    from dh2urdf.stages import Finding

FATAL = {Outcome.REFUSES, Outcome.CRASHES}


def effects_of(path: Path, consumer: str) -> dict[str, Outcome]:
    """By rule, what the findings about a file foretell for a consumer."""
    return {
        finding.rule: rules()[finding.rule].outcomes[consumer]
        for finding in inspect_urdf(path).findings
        for effect in finding.effects
        if effect.consumer == consumer
    }


def unforeseen(consumer: str, paths: list[Path]) -> tuple[list[str], list[Behaviour]]:
    """Where a consumer loads a file although a finding says that it does not, or the other way round."""
    found, wrong = behaviours(consumer, paths), []
    for path, behaviour in zip(paths, found, strict=True):
        fatal = [rule for rule, outcome in effects_of(path, consumer).items() if outcome in FATAL]
        if bool(fatal) != (behaviour.end != "loads"):
            wrong.append(f"{path.name} {behaviour.end}: {fatal} {behaviour.extra.get('raised')}")
    return wrong, found


def descriptions() -> list[Path]:
    """All of them; none where the package is not installed."""
    try:
        files = importlib.metadata.files("example-robot-data") or ()
    except importlib.metadata.PackageNotFoundError:
        return []
    return sorted(Path(str(file.locate())).resolve() for file in files if file.suffix == ".urdf")


@cache
def findings_of(path: Path) -> tuple[Finding, ...]:
    return inspect_urdf(path).findings
