"""Numbers as each reader makes them of a text."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


_DECIMAL = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_WHOLE = re.compile(rf"\s*({_DECIMAL})", re.ASCII)
_STREAM = re.compile(rf"\s*({_DECIMAL})(?![0-9]*[eE][-+]?(?![0-9]))", re.ASCII)
_HEXADECIMAL = r"0x(?:[0-9a-f]+\.?[0-9a-f]*|\.[0-9a-f]+)(?:p[-+]?[0-9]+)?"
_STRTOD = re.compile(
    rf"{_DECIMAL}|[-+]?(?:nan(?:\([0-9a-z_]*\))?|inf|infinity|{_HEXADECIMAL})", re.ASCII | re.IGNORECASE
)
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
    numbers: list[float] = []
    for word in words:
        try:
            numbers.append(float.fromhex(word) if "x" in word.lower() else float(word.partition("(")[0]))
        except OverflowError:
            numbers.append(math.inf)
    overflows = any(math.isinf(n) and "i" not in word.lower() for n, word in zip(numbers, words, strict=True))
    return None if overflows else tuple(numbers)


READ_BY: dict[str, Callable[[str, int], Numbers | None]] = {
    "": numbers_of,
    "mujoco": mujoco_numbers,
    "drake": drake_numbers,
    "urdfdom": urdfdom_numbers,
}
"""How readers read numbers; the first one, as all of them do."""
