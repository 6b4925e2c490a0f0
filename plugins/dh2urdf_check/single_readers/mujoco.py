"""What MuJoCo alone reads: its extension of URDF, and the words and numbers of MJCF.

The words and counts are those that MuJoCo 4.0.0 takes, in mujoco_values.txt; a test asks it of each.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.source import did_you_mean, listed, shown
from dh2urdf_check.document.description import Hit
from dh2urdf_check.numbers import mujoco_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.document.description import Description, JointNode

_READ = ("compiler", "option", "flag", "size")
_ANY = "any"
_INTEGER = re.compile(r"[-+]?[0-9]+", re.ASCII)
_AXES = 3


@cache
def _kinds() -> dict[str, str]:
    """What an attribute may be, by its name alone, by its element and name, or by its element and ``*``."""
    lines = Path(__file__).with_name("mujoco_values.txt").read_text("utf-8").splitlines()
    return {name: kind for kind, _, names in (line.partition(": ") for line in lines) for name in names.split()}


def kind_of(tag: str, name: str) -> str:
    """What an attribute of an element may be: `any`, words with ``|`` between them, or a count such as 3, 1-3 and 1-.

    Before the count of whole numbers is `whole`.
    """
    kinds = _kinds()
    return kinds.get(f"{tag}.{name}") or kinds.get(f"{tag}.*") or kinds.get(name, _ANY)


def fault_of(tag: str, name: str, text: str) -> str:
    """What MuJoCo refuses of an attribute; empty where it takes it, or where that is not known."""
    about, kind = f"{name} of {tag} is {shown(text)}", kind_of(tag, name)
    if "|" in kind:
        words = kind.split("|")
        near = did_you_mean(text, words) or f"it may be {listed(words)}"
        return "" if text in words or (words[0] == "1" and text.strip() in {"", *words}) else f"{about}: {near}"
    if (tag, name) == ("compiler", "eulerseq") and len(text) != _AXES:
        return f"{about}, not three letters"
    if kind == _ANY or not (words := text.split()):
        return ""
    whole, count = kind.startswith("whole "), kind.removeprefix("whole ")
    least, _, most = count.partition("-")
    is_read = all(map(_INTEGER.fullmatch, words)) if whole else mujoco_numbers(text, len(words)) is not None
    if is_read and int(least) <= len(words) <= (float(most or "inf") if "-" in count else int(least)):
        return ""
    what = "whole numbers" if whole else "numbers"
    if count == "1":
        return f"{about}, not a {what.removesuffix('s')}"
    return f"{about}, not {f'{least} to {most}' if most else count.replace('-', ' or more')} {what}"


def hits(description: Description) -> Iterator[Hit]:
    """Findings about the extension, of which MuJoCo reads no more than the compiler, options and sizes."""
    extension = description.root.first("mujoco")
    for element in extension.walk() if extension else ():
        if element.tag not in _READ:
            continue
        for name, text in element.attributes.items():
            if fault := fault_of(element.tag, name, text):
                yield Hit("mujoco-extension", element, fault)
    compiler = extension.first("compiler") if extension else None
    if compiler is None:
        return
    if compiler.get("coordinate") == "global":
        yield Hit("mujoco-extension", compiler, "coordinate of compiler is 'global', which MuJoCo knows no more")
    if compiler.get("autolimits") == "false" and (joint := next(filter(_is_limited, description.joints), None)):
        message = f"autolimits of compiler is 'false', and joint {shown(joint.name)} has limits"
        yield Hit("mujoco-extension", compiler, message)


def _is_limited(joint: JointNode) -> bool:
    """Whether MuJoCo reads limits of a joint: of its range, or of its effort."""
    limit = joint.element.first("limit")
    if limit is None or joint.kind in {"fixed", "floating"}:
        return False
    lower, upper, effort = (_number(limit.get(name)) for name in ("lower", "upper", "effort"))
    return bool(effort) or (joint.kind != "continuous" and lower is not None and upper is not None and lower < upper)


def _number(text: str | None) -> float | None:
    numbers = mujoco_numbers(text or "", 1)
    return numbers[0] if numbers else None
