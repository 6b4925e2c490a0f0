"""Collision pairs in the text of an SRDF: those of an earlier file are brought up to date, all else stays as it is."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from lxml import etree

from dh2urdf.documents import xml_root
from dh2urdf.errors import InputError
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf_plugins.collision_pairs.scene import pair_of
from dh2urdf_plugins.collision_pairs.search import REASONS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.robot import Robot
    from dh2urdf_plugins.collision_pairs.search import DisabledPair

say = Messages(__file__)

TAG = "disable_collisions"
_INDENT = "  "
_ELEMENT = re.compile(rb"<!--.*?-->|(<disable_collisions\b[^>]*?(?:/>|>\s*</disable_collisions\s*>))", re.DOTALL)
"""A comment, in which no pair is one, or the element of a pair."""
_LINE_END = re.compile(rb"[ \t]*\r?\n")


def pair_element(pair: DisabledPair) -> str:
    """The element of a pair."""
    link1, link2 = map(quoteattr, (pair.link1, pair.link2))
    return f'<{TAG} link1={link1} link2={link2} reason="{pair.reason}"/>'


def new_file(robot: Robot, pairs: Sequence[DisabledPair]) -> bytes:
    """An SRDF that has collision pairs alone."""
    elements = [f"{_INDENT}{pair_element(pair)}" for pair in pairs]
    lines = ['<?xml version="1.0"?>', f"<robot name={quoteattr(robot.name)}>", *elements, "</robot>"]
    return "".join(f"{line}\n" for line in lines).encode()


def updated(content: bytes, file: str, robot: Robot, pairs: Sequence[DisabledPair]) -> tuple[bytes, list[Problem]]:
    """An SRDF with other collision pairs of a robot, and notices; `file` is what messages call it.

    Pairs of the same reason stay where they are, and so do pairs that have a reason of their own, such as ``User``:
    those are somebody's decision. Other pairs go, and new ones come behind the last.
    """
    root = _root(content, file)
    places = [match.span(1) for match in _ELEMENT.finditer(content) if match[1]]
    elements = list(root.iter(TAG))
    if len(places) != len(elements):
        raise _refusal(file, "pairs-with-content", tag=TAG)
    found = [
        (place, element, pair_of(element.get("link1", "").strip(), element.get("link2", "").strip()))
        for place, element in zip(places, elements, strict=True)
        if element.getparent() is root
    ]
    encoding = root.getroottree().docinfo.encoding or "utf-8"
    wanted = {(pair.link1, pair.link2): pair for pair in pairs}
    links = {link.name for link in robot.links}
    met = {pair for _, element, pair in found if element.get("reason") not in REASONS}
    notices = []
    if (own := root.get("name", "").strip()) != robot.name:
        notices.append(say("srdf-of-other-robot", Mark(file=file), own=own, robot_name=robot.name))
    edits: list[tuple[int, int, str]] = []
    for (start, end), element, pair in found:
        if (reason := element.get("reason")) not in REASONS:
            if unknown := [shown(name) for name in pair if name not in links]:
                mark = Mark(file=file, line=element.sourceline)  # type: ignore[arg-type]  # wrong in the stubs
                names = {"pair": " and ".join(map(shown, pair)), "unknown": " and no link ".join(unknown)}
                notices.append(say("pair-of-no-links", mark, **names))
        elif pair not in wanted or pair in met:
            # It goes with its lines, where nothing else is in them.
            line, after = content.rfind(b"\n", 0, start) + 1, _LINE_END.match(content, end)
            is_alone = after and not content[line:start].strip()
            edits.append((line, after.end(), "") if after and is_alone else (start, end, ""))
        else:
            met.add(pair)
            if wanted[pair].reason != reason:
                edits.append((start, end, pair_element(wanted[pair])))
    if added := [pair_element(pair) for key, pair in wanted.items() if key not in met]:
        edits.append(_insertion(content, [place for place, _, _ in found], added))
    for start, end, text in sorted(edits, reverse=True):
        content = content[:start] + text.encode(encoding, "xmlcharrefreplace") + content[end:]
    return content, notices


def _root(content: bytes, file: str) -> etree._Element:
    """The outermost element of an SRDF."""
    if b"\0" in content[:4]:
        raise _refusal(file, "srdf-in-utf-16")
    try:
        root = xml_root(content)
    except etree.XMLSyntaxError as error:
        raise _refusal(file, "srdf-no-xml", reason=error.msg) from error
    if root.tag != "robot":
        raise _refusal(file, "root-element-other", found=str(root.tag), accepted="robot")
    if b"<xacro:" in content:
        raise _refusal(file, "srdf-with-macros")
    if b"</robot" not in content:
        raise _refusal(file, "srdf-empty")
    return root


def _refusal(file: str, code: str, **about: str) -> InputError:
    return InputError(say(code, Mark(file=file), **about))


def _insertion(content: bytes, places: Sequence[tuple[int, int]], added: Sequence[str]) -> tuple[int, int, str]:
    """Where new pairs come: behind the last one, or at the end of the robot."""
    ending = "\r\n" if b"\r\n" in content else "\n"
    if places:
        start, end = places[-1]
        margin = content[content.rfind(b"\n", 0, start) + 1 : start]
        indent = "" if margin.strip() else margin.decode("ascii")
        return end, end, "".join(f"{ending}{indent}{each}" for each in added)
    end = content.rindex(b"</robot")
    line = content.rfind(b"\n", 0, end) + 1
    text = "".join(f"{_INDENT}{each}{ending}" for each in added)
    return (end, end, ending + text) if content[line:end].strip() else (line, line, text)
