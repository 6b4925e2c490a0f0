"""Inspects a URDF or a xacro of any origin: what every consumer will do with it, and the robot that can be read."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.documents import kind_of_file, read_bytes
from dh2urdf.errors import InputError, ProofError
from dh2urdf.meshes import packages_in, with_its_own
from dh2urdf.source import Mark
from dh2urdf.stages import Expansion, Finding, Inspection
from dh2urdf_check import (
    bodies,
    materials,
    numbers,
    plausibility,
    shapes,
    structure,
    text,
    urdf,
)
from dh2urdf_check.document.description import Description, Hit
from dh2urdf_check.document.parsing import NotXmlError, parse
from dh2urdf_check.document.reading import robot_of
from dh2urdf_check.document.tree import Element
from dh2urdf_check.rules import CONSUMERS, rules, unread_include
from dh2urdf_plugins.formats.xml_files import LARGEST
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign, mark_of

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from dh2urdf.robot import Robot
    from dh2urdf_plugins.xacro_fence.places import Place

_PROLOGUE = b'<?xml version="1.0" encoding="utf-8"?>' + 5 * b"\n"
"""As many lines as the command `xacro` writes before the robot: a line without an element is one of its output."""

_Origin = tuple[Mark, tuple[Mark, ...]]
"""Where something stands, and where the macros are called that it comes from."""


def inspect_urdf(path: Path, expansion: Expansion | None = None) -> Inspection:
    """Findings about a URDF.

    Args:
        path: the file.
        expansion: the packages where the meshes of its ``package://`` addresses are looked for.

    Raises:
        InputError: the file cannot be read, or a folder of packages is none.
    """
    return _inspection(path, read_bytes(path, InputError, limit=LARGEST), expansion)


def inspect_xacro(path: Path, expansion: Expansion | None = None) -> Inspection:
    """Findings about a xacro, as xacro expands it behind a fence.

    Args:
        path: the file.
        expansion: the values of its arguments, and the packages that it may read; defaults where it is None.

    Raises:
        InputError: the file cannot be read, or a folder of packages is none.
    """
    read_bytes(path, InputError, limit=LARGEST)
    try:
        expanded = expand_foreign(path, expansion)
    except ProofError as error:
        (problem,) = error.problems
        mark = problem.mark or Mark(file=str(path))
        return _only(Hit("xacro-fails", 1, problem.message), lambda _: (replace(mark, line=mark.line or 1), ()))
    return _inspection(path, _PROLOGUE + expanded.content, expansion, expanded.places)


def _inspection(
    path: Path, content: bytes, expansion: Expansion | None, places: list[Place | None] | None = None
) -> Inspection:
    """Findings about a text; `places` are those of its elements, where it was expanded."""
    packages = with_its_own(path, packages_in((expansion or Expansion()).package_paths))
    try:
        parsed = parse(content)
    except NotXmlError as error:
        at = Element("", {}, error.line, error.column)
        reason = f"it is {found[0]}" if (found := kind_of_file(content)) else error.reason
        return _only(Hit("not-xml", at, f"no reader takes this: {reason}"), _origins(path))
    origin = _origins(path) if places is None else _origins_in_sources(path, parsed.root, places)
    hits = [Hit(oddity.rule, Element("", {}, oddity.line, oddity.column), oddity.message) for oddity in parsed.oddities]
    robot: Robot | None = None
    if parsed.root.tag != "robot":
        hits.append(Hit("not-a-robot", parsed.root, f"the outermost element is {parsed.root.tag}, not robot"))
    else:
        description = Description(parsed.root, path, content, lambda at: _said(origin(at)[0], path), packages)
        finders = (text, numbers, structure, bodies, shapes, materials, plausibility)
        for finder in finders:
            hits.extend(finder.hits(description))
        hits.extend(urdf.hits(description, rules()))
        robot = robot_of(description)
    findings = [finding for hit in sorted(hits, key=_order) if (finding := _finding(hit, origin)).effects]
    included = [each for each in parsed.root.walk() if each.tag.rpartition(":")[2] == "include"]
    for each in included:
        mark, calls = origin(each)
        findings.append(unread_include(next(iter(each.attributes.values()), None), mark, CONSUMERS, calls))
    return Inspection(consumers=CONSUMERS, findings=tuple(findings), robot=robot)


def _only(hit: Hit, origin: Callable[[Element | int], _Origin]) -> Inspection:
    return Inspection(consumers=CONSUMERS, findings=(_finding(hit, origin),))


def _finding(hit: Hit, origin: Callable[[Element | int], _Origin]) -> Finding:
    rule = rules()[hit.rule]
    mark, calls = origin(hit.at)
    return Finding(
        rule=rule.name,
        message=hit.message,
        fix=rule.fix,
        effects=tuple(effect for effect in rule.effects if hit.of is None or effect.consumer in hit.of),
        mark=mark,
        calls=calls,
    )


def _origins(path: Path) -> Callable[[Element | int], _Origin]:
    """Where things are in a file that is as it is."""

    def origin(at: Element | int) -> _Origin:
        line, column = (at, None) if isinstance(at, int) else (at.line, at.column)
        return Mark(file=str(path), line=line, column=column), ()

    return origin


def _origins_in_sources(path: Path, root: Element, places: list[Place | None]) -> Callable[[Element | int], _Origin]:
    """Where the elements of an expanded text come from; what is no element has a place in the text alone."""
    place = dict(zip(map(id, root.walk()), places, strict=True))

    def origin(at: Element | int) -> _Origin:
        if isinstance(at, Element) and (found := place.get(id(at))):
            return mark_of(found), tuple(map(mark_of, found.calls))
        line = at if isinstance(at, int) else at.line
        return Mark(file=str(path), place=f"line {line} of what it expands to"), ()

    return origin


def _said(mark: Mark, path: Path) -> str:
    return mark.in_file if mark.file == str(path) else f"{mark.in_file} of {mark.file}"


def _order(hit: Hit) -> tuple[int, int]:
    return (hit.at, 0) if isinstance(hit.at, int) else (hit.at.line, hit.at.column)
