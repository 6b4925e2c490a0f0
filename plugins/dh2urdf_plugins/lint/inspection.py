"""Inspects a URDF or a xacro of any origin: what every consumer will do with it, and the robot that can be read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.errors import InputError, ProofError
from dh2urdf.source import Mark
from dh2urdf.stages import Finding, Inspection
from dh2urdf.textfiles import read_bytes
from dh2urdf_plugins.lint import bodies, joints, shapes, structure, text
from dh2urdf_plugins.lint.description import Description, Hit
from dh2urdf_plugins.lint.reading import robot_of
from dh2urdf_plugins.lint.rules import CONSUMERS, rules
from dh2urdf_plugins.lint.tree import Element, NotXmlError, parse
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.robot import Robot
    from dh2urdf.stages import Expansion

LONGEST = 2**26
"""Size of a description that is inspected [B]."""
_PROLOGUE = b'<?xml version="1.0" encoding="utf-8"?>' + 5 * b"\n"
"""As many lines as the command `xacro` writes before the robot: lines of findings are those of its output."""


def inspect_urdf(path: Path) -> Inspection:
    """What there is to say of a URDF.

    Raises:
        InputError: the file cannot be read.
    """
    return _inspection(path, read_bytes(path, InputError, limit=LONGEST), str(path))


def inspect_xacro(path: Path, expansion: Expansion | None = None) -> Inspection:
    """What there is to say of a xacro, as xacro expands it behind a fence.

    Args:
        path: the file.
        expansion: the values of its arguments, and the packages that it may read; defaults where it is None.

    Raises:
        InputError: the file cannot be read.
    """
    read_bytes(path, InputError, limit=LONGEST)
    try:
        content = expand_foreign(path, expansion)
    except ProofError as error:
        return _only(Hit("xacro-fails", 1, error.problems[0].message), str(path))
    return _inspection(path, _PROLOGUE + content, f"{path} (expanded)")


def _inspection(path: Path, content: bytes, file: str) -> Inspection:
    try:
        parsed = parse(content)
    except NotXmlError as error:
        at = Element("", {}, error.line, error.column)
        return _only(Hit("not-xml", at, f"this is not XML: {error.reason}"), file)
    hits: list[Hit] = []
    if parsed.declarations is not None:
        what = "declares entities; nothing below could be checked" if parsed.entities else "has declarations of its own"
        hits.append(Hit("document-type", parsed.declarations, f"the document type {what}"))
    robot: Robot | None = None
    if parsed.root.tag != "robot":
        hits.append(Hit("not-a-robot", parsed.root, f"the outermost element is {parsed.root.tag}, not robot"))
    elif not parsed.entities:
        description = Description(parsed.root, path, content)
        for finder in (text, structure, joints, bodies, shapes):
            hits.extend(finder.hits(description))
        robot = robot_of(description)
    findings = [finding for hit in hits if (finding := _finding(hit, file)).effects]
    return Inspection(consumers=CONSUMERS, findings=tuple(sorted(findings, key=_place)), robot=robot)


def _only(hit: Hit, file: str) -> Inspection:
    return Inspection(consumers=CONSUMERS, findings=(_finding(hit, file),))


def _finding(hit: Hit, file: str) -> Finding:
    rule = rules()[hit.rule]
    line, column = (hit.at, None) if isinstance(hit.at, int) else (hit.at.line, hit.at.column)
    return Finding(
        rule=rule.name,
        message=hit.message,
        mend=rule.mend,
        effects=tuple(effect for effect in rule.effects if hit.of is None or effect.consumer in hit.of),
        mark=Mark(file=file, line=line, column=column),
    )


def _place(finding: Finding) -> tuple[int, int]:
    mark = finding.mark
    return (mark.line or 0, mark.column or 0) if mark else (0, 0)
