"""The rules of `dh2urdf check`: each a fault, and what every consumer does with a file that has it.

They are in the folder ``rules`` beside this module, a file a group; the pages in docs/rules are made of them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import yaml

from dh2urdf.source import shown
from dh2urdf.stages import Effect, Finding

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence  # noqa: TC004 - no annotation is evaluated

    from lxml import etree

    from dh2urdf.source import Mark
    from dh2urdf.stages import Severity

CONSUMERS = {
    "pybullet": "PyBullet",
    "mujoco": "MuJoCo",
    "pinocchio": "Pinocchio",
    "drake": "Drake",
    "ros": "ROS: urdfdom (robot_state_publisher, RViz, MoveIt) and KDL",
    "gazebo": "Gazebo: sdformat",
    "coppeliasim": "CoppeliaSim",
    "isaac": "Isaac Sim: importer of URDF, as it is documented",
}
"""The readers of robot descriptions that the rules speak of, by the names that ``--for`` takes."""


At: TypeAlias = "etree._Element | tuple[int, int]"  # noqa: SLF001 - the type that lxml has for elements
"""Where something is: an element, or the line and column of a text."""


class Hit(NamedTuple):
    """A place where a rule is broken.

    Attributes:
        rule: its name.
        at: the place.
        message: what is there.
        of: the consumers that it matters to.
    """

    rule: str
    at: At
    message: str
    of: frozenset[str]


class Outcome(StrEnum):
    """What becomes of a file in a consumer's hands; the README of the tables explains each word."""

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


@dataclass(frozen=True, slots=True)
class Case:
    """One way in which a rule is broken.

    Attributes:
        at: the XPath of the elements that are looked at.
        verb: the verb that says what is wrong with them, one of `dh2urdf_check.finders.VERBS`.
        argument: what the verb needs.
        says: the message, with XPaths in braces.
        of: the consumers that it matters to; all of the rule where there is none.
    """

    at: str
    verb: str
    argument: Any
    says: str
    of: frozenset[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """One rule.

    Attributes:
        name: its name, which stays.
        fault: what is at fault where it is broken.
        fix: what to do about it.
        outcomes: what becomes of the file, by consumer; one that is not named takes it as it stands.
        effects: the same as findings say it.
        where: by consumer, the XPath of the elements that it minds; empty where it minds all.
        cases: how it is found; none of a rule that a function finds.
        proof: a substitution in a sound file that breaks the rule, for its test; empty where the tests have it.
    """

    name: str
    fault: str
    fix: str
    outcomes: dict[str, Outcome]
    effects: tuple[Effect, ...]
    where: dict[str, str]
    cases: tuple[Case, ...] = ()
    proof: Mapping[str, Any] = field(default_factory=dict)

    def finding(self, message: str, of: Collection[str], mark: Mark, calls: tuple[Mark, ...] = ()) -> Finding:
        """A finding of this rule, which matters to some consumers."""
        effects = tuple(effect for effect in self.effects if effect.consumer in of)
        return Finding(rule=self.name, message=message, fix=self.fix, effects=effects, mark=mark, calls=calls)


GROUPS = ("text", "names", "tree", "joints", "masses", "shapes", "plausibility")
"""The tables of rules of URDF, in their order."""


@cache
def rules() -> dict[str, Rule]:
    """All rules of URDF by name, in the order of their tables."""
    return {name: rule for group in GROUPS for name, rule in rules_of(group).items()}


def rules_of(group: str, known: Mapping[str, str] = CONSUMERS) -> dict[str, Rule]:
    """The rules of one table by name, in its order; `known` are the consumers that it may name."""
    return {name: _rule(name, known, **entry) for name, entry in table(group).items() if "fault" in entry}


@cache
def table(name: str) -> dict[str, Any]:
    """A file of the folder ``rules``."""
    path = Path(__file__).with_name("rules") / f"{name}.yaml"
    found: dict[str, Any] = yaml.load(path.read_text("utf-8"), getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506 - both are safe
    return found


def _rule(
    name: str,
    known: Mapping[str, str],
    *,
    fault: str,
    fix: str,
    consumers: Mapping[str, Sequence[str]],
    proof: Mapping[str, Any] | None = None,
    cases: Sequence[Mapping[str, Any]] = (),
    **case: Any,  # noqa: ANN401 - what YAML has
) -> Rule:
    """A rule as an entry of a table says it; `known` are the consumers of the table, in their order."""
    outcomes = {consumer: Outcome(word) for consumer, (word, *_) in consumers.items()}
    effects = tuple(
        Effect(consumer=consumer, severity=outcomes[consumer].severity, text=consumers[consumer][1])
        for consumer in known
        if consumer in consumers
    )
    return Rule(
        name=name,
        fault=fault,
        fix=fix,
        outcomes=outcomes,
        effects=effects,
        where={consumer: "".join(words[2:]) for consumer, words in consumers.items()},
        cases=tuple(_case(**each) for each in (*cases, *([case] if case else []))),
        proof=proof or {},
    )


def _case(*, says: str, at: str = "", of: Sequence[str] = (), **words: Any) -> Case:  # noqa: ANN401 - what YAML has
    """A case as a table says it; a `table` of an argument is another file of the folder."""
    verb = words.get("is", "there")
    argument: Any = None
    if isinstance(verb, dict):
        ((verb, argument),) = verb.items()
    if isinstance(argument, dict) and "table" in argument:
        argument = {**argument, "table": table(argument["table"])}
    return Case(at, verb, argument, says, frozenset(of))


def unread_include(
    address: str | None, mark: Mark, consumers: Mapping[str, str], calls: tuple[Mark, ...] = ()
) -> Finding:
    """What `check` does not look into: a file that the one that is inspected includes.

    Args:
        address: what the file says for it.
        mark: where.
        consumers: those of the format, which may look into it.
        calls: where macros are called that it comes from.
    """
    does = "may load it, and this file was checked without it"
    return Finding(
        rule="unread-include",
        message=f"{shown(address or '')} is included, and was not looked into",
        fix="check that file too; or check the description that a consumer makes of both",
        effects=tuple(Effect(consumer=consumer, severity="note", text=does) for consumer in consumers),
        mark=mark,
        calls=calls,
    )
