"""Numbers as each reader makes them of a text, and what becomes of a file where a text is none."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from dh2urdf.source import shown
from dh2urdf_check.rules import Hit, table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from lxml import etree

    from dh2urdf_check.finders import Document

_DECIMAL = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_WHOLE = re.compile(rf"\s*({_DECIMAL})", re.ASCII)
_STREAM = re.compile(rf"\s*({_DECIMAL})(?![0-9]*[eE][-+]?(?![0-9]))", re.ASCII)
_HEXADECIMAL = r"0x(?:[0-9a-f]+\.?[0-9a-f]*|\.[0-9a-f]+)(?:p[-+]?[0-9]+)?"
_STRTOD = re.compile(
    rf"{_DECIMAL}|[-+]?(?:nan(?:\([0-9a-z_]*\))?|inf|infinity|{_HEXADECIMAL})", re.ASCII | re.IGNORECASE
)
_URDFDOM = frozenset({"pinocchio", "ros", "gazebo"})
"""The readers that have urdfdom."""
_ALL = frozenset({"pybullet", "mujoco", "drake"}) | _URDFDOM
Numbers = tuple[float, ...]


def numbers_of(text: str | None, count: int) -> Numbers | None:
    """As many finite numbers as a text should hold, as every reader takes them; None where it holds something else."""
    words = (text or "").split()
    if len(words) != count or not all(word.isascii() and "_" not in word for word in words):
        # `float` takes 1_000 and the digits of other alphabets, which no reader does.
        return None
    try:
        found = tuple(map(float, words))
    except ValueError:
        return None
    return found if all(map(math.isfinite, found)) else None


def urdfdom_numbers(text: str, count: int) -> Numbers | None:
    """Numbers as urdfdom takes them: decimal, finite, with blanks between them; None where it refuses them."""
    words = [text] if count == 1 else [word for word in text.split(" ") if word]
    matches = [_WHOLE.fullmatch(word) for word in words]
    numbers = tuple(float(match[1]) for match in matches if match)
    return numbers if len(numbers) == len(words) == count and all(map(math.isfinite, numbers)) else None


def begun_numbers(text: str) -> Numbers:
    """The numbers that a text begins with, as Drake reads them: what follows is ignored."""
    numbers: list[float] = []
    at = 0
    while (match := _STREAM.match(text, at)) and math.isfinite(number := float(match[1])):
        numbers.append(number)
        at = match.end()
    return tuple(numbers)


def drake_numbers(text: str, count: int) -> Numbers | None:
    """Numbers as Drake takes them, the factors of a mesh where `count` is 0: one, or three where there is a blank."""
    numbers = begun_numbers(text)
    return numbers if len(numbers) == (count or (3 if re.search(r"\s", text) else 1)) else None


def mujoco_numbers(text: str, count: int) -> Numbers | None:
    """Numbers as MuJoCo takes them: also hexadecimal, infinite and NaN; None where it refuses them."""
    words = text.split()
    if len(words) != count or not all(_STRTOD.fullmatch(word) for word in words):
        return None
    numbers = tuple(map(_of_strtod, words))
    overflows = any(math.isinf(n) and "i" not in word.lower() for n, word in zip(numbers, words, strict=True))
    return None if overflows else numbers


def _of_strtod(word: str) -> float:
    """The value of a word that `_STRTOD` matches."""
    try:
        return float.fromhex(word) if "x" in word.lower() else float(word.partition("(")[0])
    except OverflowError:
        return math.inf


READ_BY: dict[str, Callable[[str, int], Numbers | None]] = {
    "": numbers_of,
    "mujoco": mujoco_numbers,
    "drake": drake_numbers,
    "urdfdom": urdfdom_numbers,
}
"""How readers read numbers; the first one, as all of them do."""


def hits(document: Document) -> Iterator[Hit]:
    """Findings about every number at the places of ``rules/numbers.yaml``."""
    for place in table("numbers")["places"]:
        for element in document.select(place["at"]):
            for attribute, count in place["numbers"].items():
                text = element.get(attribute)
                if text is None:
                    continue
                if numbers_of(text, count) is None or urdfdom_numbers(text, count) is None:
                    yield from _said(document, element, place, attribute, count)
                if place.get("alone") and text != text.strip() and numbers_of(text, 1):
                    message = f"{attribute} of {element.tag} is {shown(text)}, with blanks around the number"
                    yield Hit("misread-number", element, message, frozenset({"coppeliasim"}))


def _said(
    document: Document, element: etree._Element, place: dict[str, str], attribute: str, count: int
) -> Iterator[Hit]:
    """What each reader that reads an attribute does with it, which is not plain numbers."""
    text = element.get(attribute) or ""

    def holds(path: str | None) -> bool:
        return path is not None and bool(document.select(f"boolean({path})", element))

    readers = _ALL - {reader for reader in _ALL if holds(place.get(f"not read by {reader}"))}
    readers = _URDFDOM if "urdfdom alone" in place else readers
    is_required, is_plain = "required" in place, numbers_of(text, count) is not None
    refused = set(_URDFDOM) if urdfdom_numbers(text, count) is None and "in a joint" in place else set()
    if not is_plain:
        if (mujoco_numbers(text, count) is None and (is_required or text.strip())) or holds(place.get("no body")):
            refused.add("mujoco")
        if drake_numbers(text, 0 if attribute == "scale" else count) is None:
            refused.add("drake")
        if element.tag == "axis" and len([word for word in text.split(" ") if word]) < count:
            refused.add("pybullet")
    refused &= readers
    kind, what = ("number", "one finite number") if count == 1 else ("vector", f"{count} finite numbers")
    what = ": urdfdom takes blanks between numbers alone" if is_plain else f", not {what}"
    message = f"{attribute} of {element.tag} is {shown(text)}{what}"
    of_all = {"coppeliasim"} if not is_plain and readers & {"pybullet", "drake"} else set()
    if refused or (of_all and kind == "number"):
        yield Hit(f"invalid-{kind}", element, message, frozenset(refused | of_all))
        of_all = set()
    misread = readers - refused - (set() if urdfdom_numbers(text, count) is None else _URDFDOM)
    misread &= _URDFDOM if is_plain else _ALL
    if misread:
        yield Hit(f"misread-{kind}", element, message, frozenset(misread | of_all))
