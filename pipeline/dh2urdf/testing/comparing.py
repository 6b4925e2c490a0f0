"""Says where two records differ: what `==` only denies."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

_SHOWN = 200
"""Characters of a value that a difference repeats."""


def difference(first: Any, second: Any, *, whole: bool = True) -> str | None:  # noqa: ANN401 - any values
    """Where two values differ first, and by what; None where they are the same.

    Args:
        first: one value.
        second: the other.
        whole: whether fields count that `==` leaves out, such as marks, notices and formulas.
    """
    leaves = list(_leaves(first, "", whole)), list(_leaves(second, "", whole))
    for (place, left), (other_place, right) in zip(*leaves, strict=False):
        if (place, left) != (other_place, right):
            if place != other_place:
                return f"{place or 'one'} is {left}, and {other_place or 'the other'} is {right}"
            return f"{place or 'it'} is once {_around(left, right)} and once {_around(right, left)}"
    counts = tuple(map(len, leaves))
    return f"once {counts[0]} and once {counts[1]} values" if counts[0] != counts[1] else None


def _leaves(value: Any, place: str, whole: bool) -> Iterator[tuple[str, str]]:  # noqa: ANN401, FBT001 - any value
    """Every number and text in a value, spelled out, with its place: ``rows[2].limits.lower``."""
    if is_dataclass(value) and not isinstance(value, type):
        yield place, type(value).__name__
        for field in fields(value):
            if whole or field.compare:
                yield from _leaves(getattr(value, field.name), f"{place}.{field.name}".lstrip("."), whole)
    elif isinstance(value, (list, tuple)):
        yield place, f"{type(value).__name__} of {len(value)}"
        for index, item in enumerate(value):
            yield from _leaves(item, f"{place}[{index}]", whole)
    elif isinstance(value, dict):
        yield place, f"a mapping of {', '.join(map(repr, value))}"
        for key, item in value.items():
            yield from _leaves(item, f"{place}[{key!r}]", whole)
    elif isinstance(value, Enum):
        yield place, str(value)
    else:
        yield place, repr(value)


def _around(text: str, other: str) -> str:
    """A text, cut to the part in which it differs from another."""
    start = next((i for i, (left, right) in enumerate(zip(text, other, strict=False)) if left != right), 0)
    if len(text) <= _SHOWN:
        return text
    begin = max(0, start - _SHOWN // 2)
    return f"{'…' if begin else ''}{text[begin : begin + _SHOWN]}…"
