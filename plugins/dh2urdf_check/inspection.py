"""Inspects a URDF or a xacro of any origin: what every consumer will do with it, and the robot that can be read."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.documents import kind_of_file, read_bytes
from dh2urdf.errors import InputError, ProofError
from dh2urdf.meshes import packages_in, with_its_own
from dh2urdf.source import Mark
from dh2urdf.stages import Expansion, Inspection
from dh2urdf_check import misread
from dh2urdf_check.document import NotXmlError, parse
from dh2urdf_check.rules import CONSUMERS, Hit, rules, unread_include
from dh2urdf_check.urdf import Urdf
from dh2urdf_plugins.formats.xml_files import LARGEST

if TYPE_CHECKING:
    from pathlib import Path

    from lxml import etree

    from dh2urdf.stages import Finding
    from dh2urdf_check.document import Parsed
    from dh2urdf_check.rules import At
    from dh2urdf_plugins.xacro_fence.places import Place

_PROLOGUE = b'<?xml version="1.0" encoding="utf-8"?>' + 5 * b"\n"
"""As many lines as the command `xacro` writes before the robot: a line without an element is one of its output."""


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
    from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

    read_bytes(path, InputError, limit=LARGEST)
    try:
        expanded = expand_foreign(path, expansion)
    except ProofError as error:
        (problem,) = error.problems
        mark = problem.mark or Mark(file=str(path))
        return _only("xacro-fails", problem.message, replace(mark, line=mark.line or 1))
    return _inspection(path, _PROLOGUE + expanded.content, expansion, expanded.places)


def _inspection(
    path: Path, content: bytes, expansion: Expansion | None, places: list[Place | None] | None = None
) -> Inspection:
    """Findings about a text; `places` are those of its elements, where it was expanded."""
    packages = with_its_own(path, packages_in((expansion or Expansion()).package_paths))
    try:
        parsed = parse(content)
    except NotXmlError as error:
        reason = f"it is {found[0]}" if (found := kind_of_file(content)) else error.reason
        line, column = error.at
        return _only("not-xml", f"no reader takes this: {reason}", Mark(file=str(path), line=line, column=column))
    origins = _Origins(path, parsed, places)
    document = Urdf(parsed, path, content, origins.said, packages)
    hits = [*document.hits(rules().values()), *misread.hits(document)]
    if parsed.complaint is not None:
        reason, at = parsed.complaint
        hits.append(Hit("not-strict-xml", at, reason, frozenset(CONSUMERS)))
    findings = [origins.finding(hit) for hit in sorted(hits, key=lambda hit: origins.place(hit.at))]
    for each in parsed.places:
        if str(each.tag).rpartition(".")[2] == "include":
            mark, calls = origins.of(each)
            address = next(map(str, each.attrib.values()), None)
            findings.append(unread_include(address, mark, CONSUMERS, calls))
    robot = document.links.robot(origins.in_text)
    return Inspection(consumers=CONSUMERS, findings=tuple(findings), robot=robot)


def _only(rule: str, message: str, mark: Mark) -> Inspection:
    return Inspection(consumers=CONSUMERS, findings=(rules()[rule].finding(message, CONSUMERS, mark),))


class _Origins:
    """Where the elements of a text come from: the text itself, or the files that it was expanded from."""

    def __init__(self, path: Path, parsed: Parsed, places: list[Place | None] | None) -> None:
        self._path, self._parsed = path, parsed
        self._sources = None if places is None else dict(zip(parsed.places, places, strict=True))

    def place(self, at: At) -> tuple[int, int]:
        """The line and column in the text."""
        return at if isinstance(at, tuple) else self._parsed.places[at]

    def in_text(self, at: At) -> Mark:
        """A place in the text."""
        line, column = self.place(at)
        return Mark(file=str(self._path), line=line, column=column)

    def of(self, at: At) -> tuple[Mark, tuple[Mark, ...]]:
        """Where something is, and where the macros are called that it comes from."""
        if self._sources is None:
            return self.in_text(at), ()
        if not isinstance(at, tuple) and (found := self._sources[at]):
            from dh2urdf_plugins.xacro_fence.expansion import mark_of

            return mark_of(found), tuple(map(mark_of, found.calls))
        return Mark(file=str(self._path), place=f"line {self.place(at)[0]} of what it expands to"), ()

    def said(self, at: etree._Element) -> str:
        """Where an element is, as messages say it."""
        mark = self.of(at)[0]
        return mark.in_file if mark.file == str(self._path) else f"{mark.in_file} of {mark.file}"

    def finding(self, hit: Hit) -> Finding:
        """A hit as a finding."""
        mark, calls = self.of(hit.at)
        return rules()[hit.rule].finding(hit.message, hit.of, mark, calls)
