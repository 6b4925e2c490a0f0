"""What stages find in robot descriptions of any origin: findings, repairs, and how macros are expanded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, TypeAlias, get_args

from dh2urdf.robot import Robot
from dh2urdf.source import Mark, Problem

Severity: TypeAlias = Literal["error", "warning", "note"]


SEVERITIES: tuple[Severity, ...] = get_args(Severity)
"""From the worst on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """What one consumer does with a file that has a fault.

    Attributes:
        consumer: its name, as `Inspection.consumers` has it.
        severity: how bad that is.
        text: what it does, as a sentence whose subject it is, without a full stop.
        seen: the program that was given the file and did this, such as ``MuJoCo 4.0.0``; empty where a rule foretells
            what the consumer would do.
    """

    consumer: str
    severity: Severity
    text: str
    seen: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """Something in a file that not every consumer takes as it is meant.

    Attributes:
        rule: name of the rule that found it, in kebab-case; it stays the same from version to version.
        message: what is there, as one plain sentence without its place and without a full stop.
        fix: what to do about it.
        effects: what the consumers do that do not just take it; empty where the finding is not about them.
        mark: where it stands; of a file that holds macros, in the file where the element is written.
        calls: where the macros are called that it comes from, the innermost first.
    """

    rule: str
    message: str
    fix: str
    effects: tuple[Effect, ...] = ()
    mark: Mark | None = None
    calls: tuple[Mark, ...] = ()

    @property
    def severity(self) -> Severity:
        """That of the worst effect."""
        return min((effect.severity for effect in self.effects), key=SEVERITIES.index, default="error")

    @property
    def seen(self) -> tuple[str, ...]:
        """The programs that were given the file and did something of this; empty where all of it is foretold."""
        return tuple(dict.fromkeys(effect.seen for effect in self.effects if effect.seen))


@dataclass(frozen=True, slots=True, kw_only=True)
class Inspection:
    """Findings about a file of any origin.

    Attributes:
        consumers: the consumers of the format that were thought of: name, and what it stands for.
        findings: what was found, in the order of the file.
        robot: the links and joints of the file, as far as they can be read; None where there are none.
    """

    consumers: Mapping[str, str]
    findings: tuple[Finding, ...]
    robot: Robot | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Repair:
    """A file in which something was fixed.

    Attributes:
        content: the whole file.
        changes: what was fixed, as notices with the place in the file as it was.
    """

    content: bytes
    changes: tuple[Problem, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Annotation:
    """A file that goes with a robot description of any origin.

    Attributes:
        content: the whole file.
        summary: what is in it, in one line.
        notices: what a careful person would look at.
    """

    content: bytes
    summary: str
    notices: tuple[Problem, ...] = ()


def arguments_of(values: Mapping[str, object] | None) -> dict[str, str]:
    """The values of arguments as YAML has them, as a description with macros takes them: ``true`` for True."""
    return {name: str(each).lower() if isinstance(each, bool) else str(each) for name, each in (values or {}).items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class Expansion:
    """How a description that holds macros is expanded.

    Attributes:
        arguments: the values of its arguments, by name.
        package_paths: folders of ROS packages, or folders that hold some: their files may be read, and ``package://``
            addresses are looked for there.
    """

    arguments: Mapping[str, str] = field(default_factory=dict)
    package_paths: tuple[Path, ...] = ()
