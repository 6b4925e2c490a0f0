"""What the findings about a file foretell, beside what a consumer does with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from consumers import behaviours, require
from model_consumers import outcomes

from dh2urdf_check.inspection import inspect_urdf
from dh2urdf_check.models.mjcf import inspect_mjcf
from dh2urdf_check.models.models import model_rules
from dh2urdf_check.models.sdf import inspect_sdf
from dh2urdf_check.rules import Outcome, rules

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from consumers import Behaviour

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


def wrong_models(folder: Path, consumer: str, texts: Mapping[str, str], kind: str) -> list[str]:
    """Where a consumer loads a model of a kind, sdf or mjcf, although a finding says that it does not, or the other way
    round.
    """
    require(consumer)
    inspect, ending = {"sdf": (inspect_sdf, "sdf"), "mjcf": (inspect_mjcf, "xml")}[kind]
    paths = [folder / f"odd-{number}.{ending}" for number in range(len(texts))]
    for path, text in zip(paths, texts.values(), strict=True):
        path.write_text(text)
    wrong = []
    for name, path, found in zip(texts, paths, outcomes(consumer, paths), strict=True):
        fatal = [
            finding.rule
            for finding in inspect(path).findings
            if any(effect.consumer == consumer for effect in finding.effects)
            and model_rules(kind)[finding.rule].outcomes[consumer] in FATAL
        ]
        if bool(fatal) != (found["end"] != "loads"):
            wrong.append(f"{name}: it {found['end']}, {fatal} {found['printed'][:200]} {found.get('raised')}")
    return wrong
