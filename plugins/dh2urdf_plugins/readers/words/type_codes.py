"""Legends that turn round what the numbers of a column mean here: ``0 = prismatic, 1 = revolute``, ``0 = reversed``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.words.fields import joint_type

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.manipulator import JointType

_PAIR = (
    r"(?<![\w.,+-])(?=([01]|[^\W\d_]+)\s*(?:[=:→]|[-=]>|\s[-–—]\s|\bfor\b|\bis\b|\bmeans\b)\s*"
    r"([01]|[^\W\d_]+)(?![\w.]))"
)
"""A code and its meaning, in either order: ``1 = revolute``, ``R: 1``, ``0 for prismatic``."""
_CODES = ("0", "1")
_TURNED = frozenset(("reversed", "reverse", "inverted", "flipped", "opposite", "negative", "invertiert", "invertido"))
_KEPT = frozenset(("normal", "regular", "unchanged", "same", "positive", "forward"))
_COUNTED = r"\b(?:joints?|axis|axes|links?|rows?|gelenke?|achsen?|articulation|eje|giunto)\s*$"
"""What a number behind it counts: ``joint 1: revolute`` is no legend."""


def _meanings(text: str) -> Iterator[tuple[str, str]]:
    """The meanings that a legend gives to the numbers 0 and 1, as words in lower case."""
    plain = text.casefold()
    for match in re.finditer(_PAIR, plain) if any(code in plain for code in _CODES) else ():
        one, other = match.groups()
        code, word = (one, other) if one in _CODES else (other, one)
        if code in _CODES and not word.isdigit() and not re.search(_COUNTED, plain[: match.start()]):
            yield code, word


def exchanged_codes(text: str) -> dict[str, JointType]:
    """The other meanings that a legend gives to the numbers 0 and 1 of a column of types; empty where it agrees."""
    said = {code: kind for code, word in _meanings(text) if (kind := joint_type(word))}
    return {code: kind for code, kind in said.items() if joint_type(code) is not kind}


def exchanged_direction(name: str, text: str, mark: Mark) -> Problem | None:
    """The fault of a header of flip or sign whose legend turns its numbers round; None for any other.

    Args:
        name: the field: a flip of 1 turns the direction, and so does a sign of -1.
        text: the header.
        mark: its place.
    """
    turning = "0" if name == "flip" else "1"
    for code, word in _meanings(text):
        if (code == turning and word in _TURNED) or (name == "flip" and code == "1" and word in _KEPT):
            return Problem(
                message=f"{shown(text)} calls {code} {word}, and in a column {name} "
                f"{'1' if name == 'flip' else '-1'} turns the direction",
                mark=mark,
                field=name,
                found=text,
                accepted="a column flip with true or false, or a column sign with 1 or -1",
            )
    return None


def exchanged(text: str, codes: dict[str, JointType], mark: Mark) -> Problem:
    """The fault of a legend that gives the numbers of types another meaning than they have here."""
    theirs = " and ".join(f"{code} {kind}" for code, kind in codes.items())
    return Problem(
        message=f"{shown(text)} calls {theirs}, and in a column of types 0 is revolute and 1 is prismatic",
        mark=mark,
        field="type",
        found=text,
        accepted="0 for revolute and 1 for prismatic, or the words revolute and prismatic, or R and P",
        suggestion="write R and P in the cells, and take out the legend",
    )
