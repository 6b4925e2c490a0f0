"""Names of manipulators, joints and links: any text that XML can hold and that a person can see."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import replace
from itertools import chain, count, pairwise
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.manipulator import BASE, ENDS, ROOT, WORLD
from dh2urdf.source import Mark, Problem, shown

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

MAX_NAME = 200
"""Length of a name; readers of robot descriptions cut names of a thousand characters, or crash."""
RESERVED = (WORLD, ROOT, BASE, *ENDS)
"""Links that every robot description of ours has; `world` is the simulators' own."""
_NUMBERED = r"(?s)(.*?)([0-9]{1,9})"
_REMARK = r"(?<=[0-9])\s*[(\[][^()\[\]]*[)\]]$"
_STEP = r"(\w+)\s*(-*>|[→➔⟶]|[-–]|\bto\b)\s*(\w+)"
_BETWEEN = (">", "-", " to ")
_DASHES = "-–"
_FOOTNOTES = "*†‡§¹²³⁴⁵⁶⁷⁸⁹"
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
    if name.isascii() and name.isprintable():
        return None
    for character in name:
        kind = _CLASSES.get(unicodedata.category(character))
        if character in "\ufffe\uffff":
            kind = "no character"
        if kind and character not in _JOINERS:
            return f"the name {shown(name)} holds U+{ord(character):04X}, which is {kind}", accepted
    return None


class RowNames(NamedTuple):
    """The names of a row's joint and link, and where they stand."""

    joint: str
    link: str
    joint_mark: Mark | None = None
    link_mark: Mark | None = None


def name_problems(rows: Sequence[RowNames]) -> list[Problem]:
    """What is wrong with the names of a manipulator's joints and links, taken together.

    Links and joints share one set of names, with those that every description has.
    """
    last = rows[-1].link
    taken: dict[str, str] = dict.fromkeys(RESERVED, "it is the name of a link that every robot description has")
    for name in ("base_link-base_link_inertia", f"{last}-tool0", f"{last}-flange"):
        taken[name] = "it is the name of a joint that the description adds"
    names = {name for row in rows for name in (row.joint, row.link)}
    alike: dict[str, str] = {}
    problems = []
    for kind in ("joint", "link"):
        words = [getattr(row, kind) for row in rows]
        if fault := order_fault(words):
            problems.append(
                Problem(
                    message=f"the numbers of the {kind}s, {shown(', '.join(words))}, {fault}",
                    severity="notice",
                    mark=getattr(rows[0], f"{kind}_mark"),
                    field=kind,
                    suggestion="rows are in the order from the base to the tool",
                )
            )
        marked = [place for place, word in enumerate(words) if word[-1] in _FOOTNOTES]
        if marked and (len(marked) < len(words) or words[0][-1] == "*"):
            first = words[marked[0]]
            problems.append(
                Problem(
                    message=f"the name {shown(first)} ends with the mark of a footnote, and keeps it",
                    severity="notice",
                    mark=getattr(rows[marked[0]], f"{kind}_mark"),
                    joint=rows[marked[0]].joint,
                    field=kind,
                    found=first,
                    suggestion="take out the mark, and write what the footnote says in a column, such as type",
                )
            )
    for joint, link, joint_mark, link_mark in rows:
        for kind, name, mark in (("joint", joint, joint_mark), ("link", link, link_mark)):
            if name in taken:
                free = _free(name, kind, names | taken.keys())
                problems.append(_taken(kind, name, taken[name], joint, mark, free=free))
                continue
            taken[name] = f"a {kind} of {replace(mark, column=None)} has it already" if mark else "it is taken already"
            folded = unicodedata.normalize("NFKC", name).casefold()
            if (twin := alike.setdefault(folded, name)) is not name:
                problems.append(
                    Problem(
                        message=f"the {kind} {shown(name)} and {shown(twin)} differ only in case or in how a letter "
                        "is coded; they are kept apart",
                        severity="notice",
                        mark=mark,
                        joint=joint,
                        field=kind,
                        found=name,
                    )
                )
    return problems


def order_fault(names: Sequence[str]) -> str | None:
    """How names show that a row is missing or elsewhere: names alike but for a number, or steps such as ``1->2``.

    Args:
        names: the names of the joints, or of the links, along the arm.

    Returns:
        What is wrong with their numbers, as the end of a sentence; None where nothing is.
    """
    may_be_step = any(sign in names[0] for sign in _BETWEEN) or not names[0].isascii()
    steps = [step for name in names if (step := re.fullmatch(_STEP, name))] if may_be_step else []
    if len(steps) == len(names):
        pairs = list(pairwise(steps))
        wrong = [pair for pair in pairs if pair[0][3] != pair[1][1]]
        if wrong and (len(wrong) < len(pairs) or steps[0][2] not in _DASHES):  # `wrist-1`, `wrist-2` are no steps
            return f"do not follow each other: {wrong[0][1][0]} is behind {wrong[0][0][0]}"
    if names[0][-1:] in ")]":
        names = [re.sub(_REMARK, "", name) for name in names]  # `Joint 1 (shoulder)`
    parts = [re.fullmatch(_NUMBERED, name) for name in names] if all(name[-1:].isdecimal() for name in names) else []
    if not parts or not all(parts) or len({part[1] for part in parts if part}) > 1:
        return None
    numbers = [int(part[2]) for part in parts if part]
    if any(left >= right for left, right in pairwise(numbers)):
        return "do not rise from row to row"
    leaps = [f"leap from {left} to {right}" for left, right in pairwise(numbers) if right > left + 1]
    return leaps[0] if leaps and numbers[0] <= 1 else None


def _free(name: str, kind: str, taken: Collection[str]) -> str:
    """A name like this one that nothing has yet."""
    numbered = (f"{name}_{number}" for number in count(2))
    kinds = () if name.casefold().endswith(kind) else (f"{name}_{kind}",)
    return next(free for free in chain(kinds, numbered) if free not in taken)


def _taken(kind: str, name: str, reason: str, joint: str, mark: Mark | None, *, free: str) -> Problem:
    return Problem(
        message=f"the {kind} cannot be named {shown(name)}: {reason}",
        mark=mark,
        joint=joint,
        field=kind,
        found=name,
        accepted=f"a name of its own: links and joints share one set of names, and {', '.join(RESERVED)} are in it",
        suggestion=f"name it otherwise, such as {free}",
    )
