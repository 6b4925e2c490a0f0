"""The rules of `dh2urdf check`: each a fault, and what every consumer does with a file that has it.

They are in ``rules.yaml`` and ``plausibility.yaml`` beside this module, which docs/check.md is made of.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import yaml

from dh2urdf.stages import Effect

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.stages import Severity

CONSUMERS = {
    "pybullet": "PyBullet",
    "mujoco": "MuJoCo",
    "pinocchio": "Pinocchio",
    "drake": "Drake",
    "ros": "ROS: urdfdom (robot_state_publisher, RViz, MoveIt) and KDL",
    "gazebo": "Gazebo: sdformat",
    "coppeliasim": "CoppeliaSim",
}
"""The readers of robot descriptions that the rules speak of, by the names that ``--for`` takes."""


class Outcome(StrEnum):
    """What becomes of a file in a consumer's hands; rules.yaml says what each word means."""

    REFUSES = "refuses"
    CRASHES = "crashes"
    LOSES = "loses"
    ALTERS = "alters"
    WARNS = "warns"
    NOTE = "note"
    DOUBTFUL = "doubtful"

    @property
    def severity(self) -> Severity:
        """How bad it is."""
        if self is Outcome.NOTE:
            return "note"
        return "warning" if self in {Outcome.ALTERS, Outcome.WARNS, Outcome.DOUBTFUL} else "error"


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """One rule.

    Attributes:
        name: its name, which stays.
        fault: what is at fault where it is broken.
        fix: what to do about it.
        outcomes: what becomes of the file, by consumer; one that is not named takes it as it stands.
        effects: the same as findings say it.
    """

    name: str
    fault: str
    fix: str
    outcomes: dict[str, Outcome]
    effects: tuple[Effect, ...]


@cache
def plausibility_rules() -> dict[str, Rule]:
    """The rules about what is hardly meant, in the order of their table."""
    return _table("plausibility.yaml")


@cache
def rules() -> dict[str, Rule]:
    """All rules by name, in the order of the tables."""
    return {**_table("rules.yaml"), **plausibility_rules()}


def _table(name: str) -> dict[str, Rule]:
    text = Path(__file__).with_name(name).read_text("utf-8")
    table = yaml.load(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506 - both are safe
    return {rule: rule_of(rule, CONSUMERS, **entry) for rule, entry in table.items()}


def rule_of(
    name: str, known: Mapping[str, str], *, fault: str, fix: str, consumers: Mapping[str, tuple[str, str]]
) -> Rule:
    """A rule as an entry of a table says it; `known` are the consumers of the table, in their order."""
    outcomes = {consumer: Outcome(word) for consumer, (word, _) in consumers.items()}
    effects = tuple(
        Effect(consumer=consumer, severity=outcomes[consumer].severity, text=consumers[consumer][1])
        for consumer in known
        if consumer in consumers
    )
    return Rule(name=name, fault=fault, fix=fix, outcomes=outcomes, effects=effects)
