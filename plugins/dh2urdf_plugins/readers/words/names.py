"""Names of manipulators, joints and links: any text that XML can hold and that a person can see."""

from __future__ import annotations

import unicodedata
from dataclasses import replace
from itertools import chain, count
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.manipulator import BASE, ENDS, ROOT, WORLD
from dh2urdf.source import Mark, Messages, Problem, shown

if TYPE_CHECKING:
    from collections.abc import Sequence

say = Messages(__file__)

MAX_NAME = 200
"""Length of a name; readers of robot descriptions cut names of a thousand characters, or crash."""
RESERVED = (WORLD, ROOT, BASE, *ENDS)
"""Links that every robot description of ours has; `world` is the simulators' own."""
_JOINERS = "\u200c\u200d"  # invisible, but part of how Persian, Hindi and composed emoji are written
_CLASSES = {"Cc": "a control character", "Cf": "an invisible character", "Cs": "half a character (a lone surrogate)"}
_CLASSES |= {"Zl": "a line separator", "Zp": "a paragraph separator"}


def name_fault(name: str) -> tuple[str, str] | None:
    """Why a text is no name and what is accepted, or None."""
    accepted = f"1 to {MAX_NAME} visible characters"
    if not name or name.isspace():
        return "the name is empty", accepted
    if len(name) > MAX_NAME:
        return f"the name {shown(name)} has {len(name)} characters", accepted
    for character in () if name.isascii() and name.isprintable() else name:
        kind = "no character" if character in "\ufffe\uffff" else _CLASSES.get(unicodedata.category(character))
        if kind and character not in _JOINERS:
            return f"the name {shown(name)} holds U+{ord(character):04X}, which is {kind}", accepted
    return None


class RowNames(NamedTuple):
    """The names of a row's joint and link, and where they stand."""

    joint: str
    link: str
    joint_mark: Mark | None
    link_mark: Mark | None


def added_joints(last: str) -> tuple[str, ...]:
    """The joints that a description adds to those of the rows, by the name of the last link."""
    return ("base_link-base_link_inertia", f"{last}-tool0", f"{last}-flange")


def name_problems(rows: Sequence[RowNames]) -> list[Problem]:
    """What is wrong with the names of a manipulator's joints and links, taken together.

    Links and joints share one set of names, with those that every description has.
    """
    taken = dict.fromkeys(RESERVED, "it is the name of a link that every robot description has")
    taken |= dict.fromkeys(added_joints(rows[-1].link), "it is the name of a joint that the description adds")
    names, problems = {name for row in rows for name in (row.joint, row.link)}, []
    for row in rows:
        for kind, name, mark in (("joint", row.joint, row.joint_mark), ("link", row.link, row.link_mark)):
            if name in taken:
                kinds = () if name.casefold().endswith(kind) else (f"{name}_{kind}",)
                others = chain(kinds, (f"{name}_{number}" for number in count(2)))
                free = next(other for other in others if other not in names and other not in taken)
                about: dict[str, Any] = {"reason": taken[name], "reserved": RESERVED, "free": free}
                problems.append(say("name-taken", mark, joint=row.joint, field=kind, found=name, **about))
            else:
                place = f"a {kind} of {replace(mark, column=None)} has it already" if mark else "it is taken already"
                taken[name] = place
    return problems
