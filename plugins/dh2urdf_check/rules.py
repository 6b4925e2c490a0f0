"""The rules of `dh2urdf check`: each a fault, and what every consumer does with a file that has it.

They are in the folder ``rules`` beside this module, a file a group; the pages in docs/rules are made of them.
"""

from __future__ import annotations

from difflib import get_close_matches
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import yaml

from dh2urdf.errors import ConfigError
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Messages, did_you_mean
from dh2urdf.stages import Effect, Finding

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from lxml import etree

    from dh2urdf.source import Mark
    from dh2urdf.stages import Severity

say = Messages(__file__)

_TABLES = Path(__file__).with_name("rules")
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
    """A place where a rule is broken."""

    rule: str
    at: At
    message: str
    of: frozenset[str]  # the consumers that it matters to


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


class Case(NamedTuple):
    """One way in which a rule is broken."""

    at: str  # the XPath of the elements that are looked at
    verb: str  # what is wrong with them, one of `dh2urdf_check.finders.VERBS`
    argument: Any  # what the verb needs
    says: str  # the message, with XPaths in braces
    of: frozenset[str]  # the consumers that it matters to; all of the rule where there is none


class Rule(NamedTuple):
    """A fault, what to do about it, and what each consumer does with a file that has it."""

    name: str
    fault: str
    fix: str
    outcomes: dict[str, Outcome]  # by consumer; one that is not named takes the file as it stands
    effects: tuple[Effect, ...]  # the same as findings say it
    where: dict[str, str]  # by consumer, the XPath of the elements that it minds; empty where it minds all
    cases: tuple[Case, ...]  # how it is found; none of a rule that a function finds
    proof: Mapping[str, Any]  # a substitution in a sound file that breaks the rule; empty where the tests have it

    def finding(
        self, message: str, mark: Mark, calls: tuple[Mark, ...] = (), of: Collection[str] | None = None
    ) -> Finding:
        """A finding of this rule, which matters to all consumers or to some."""
        effects = tuple(effect for effect in self.effects if of is None or effect.consumer in of)
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
    text = (_TABLES / f"{name}.yaml").read_text("utf-8")
    found: dict[str, Any] = yaml.load(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506 - both are safe
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
    where = {consumer: "".join(words[2:]) for consumer, words in consumers.items()}
    found = tuple(_case(**each) for each in (*cases, *([case] if case else [])))
    return Rule(name, fault, fix, outcomes, effects, where, found, proof or {})


def _case(*, says: str, at: str = "", of: Sequence[str] = (), **words: Any) -> Case:  # noqa: ANN401 - what YAML has
    """A case as a table says it; a `table` of an argument is another file of the folder."""
    verb = words.get("is", "there")
    argument: Any = None
    if isinstance(verb, dict):
        ((verb, argument),) = verb.items()
    if isinstance(argument, dict) and "table" in argument:
        argument = {**argument, "table": table(argument["table"])}
    return Case(at, verb, argument, says, frozenset(of))


# --- `--explain RULE`, and the rules of a SARIF log -------------------------------------------------------------------


@cache
def tables() -> dict[str, tuple[Path, dict[str, Any]]]:
    """Every rule by its name: the table that has it, and its entry there."""
    return {
        name: (path, entry)
        for path in sorted(_TABLES.glob("*.yaml"))
        for name, entry in table(path.stem).items()
        if isinstance(entry, dict) and "fault" in entry
    }


def explanation(name: str) -> str:
    """What a rule means, what each consumer does with a file that breaks it, and what to do."""
    if name not in tables():
        near = did_you_mean(name, get_close_matches(name, tables(), n=1))
        raise ConfigError(say("rule-unknown", COMMAND_LINE, field="--explain", found=name, suggestion=near))
    _, entry = tables()[name]
    together: dict[str, list[str]] = {}
    for consumer, (outcome, does, *_) in entry.get("consumers", {}).items():
        together.setdefault(f"{does} ({outcome})", []).append(consumer)
    lines = [f"{name}: {entry['fault']}"]
    lines += [f"    {', '.join(consumers)}: {does}" for does, consumers in together.items()]
    lines += [f"    seen in a program ({entry['severity']})"] if "severity" in entry else []
    return "\n".join([*lines, f"    fix: {entry['fix']}", f"    {address_of(name)}"])


def address_of(name: str) -> str | None:
    """The address of the page that explains a rule; without a published source, that of its table on this machine."""
    if name not in tables():
        return None
    import importlib.metadata

    path, _ = tables()[name]
    urls = importlib.metadata.metadata("dh2urdf").get_all("Project-URL") or ()
    known = dict(each.partition(", ")[::2] for each in urls)
    if source := known.get("Source"):
        return f"{source.rstrip('/')}/docs/rules/{path.stem}.md#{name}"
    return f"{path.as_uri()}#{name}"
