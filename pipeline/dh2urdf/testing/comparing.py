"""Where two records differ."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

_SHOWN = 200
"""Characters of a value that a difference repeats."""


def difference(first: Any, second: Any, *, whole: bool = True) -> str | None:  # noqa: ANN401 - any values
    """Where two values differ first, and by what; None where they are the same.

    `whole` is whether fields count that `==` leaves out, such as marks, notices and formulas.
    """
    both = leaves(first, whole=whole), leaves(second, whole=whole)
    for one, other in zip_longest(*both, fillvalue=("it", "nothing")):
        if one != other:
            (place, left), (_, right) = one, other
            start = next((i for i, (a, b) in enumerate(zip(left, right, strict=False)) if a != b), 0)
            cut = slice(max(0, start - _SHOWN // 2), max(_SHOWN, start + _SHOWN // 2))
            return f"{place or 'it'} is once {left[cut]} and once {right[cut]}"
    return None


def leaves(value: Any, place: str = "", *, whole: bool = True) -> Iterator[tuple[str, str]]:  # noqa: ANN401 - any value
    """Every number and text in a value, as `repr` has it, with its place: ``rows[2].limits.lower``."""
    parts: list[tuple[str, Any]] = []
    if is_dataclass(value) and not isinstance(value, type):
        names = [field.name for field in fields(value) if whole or field.compare]
        parts = [(f"{place}.{name}".lstrip("."), getattr(value, name)) for name in names]
    elif isinstance(value, (list, tuple)):
        parts = [(f"{place}[{index}]", item) for index, item in enumerate(value)]
    elif isinstance(value, dict):
        parts = [(f"{place}[{key!r}]", item) for key, item in value.items()]
    else:
        yield place, repr(value)
        return
    yield place, f"a {type(value).__name__} of {len(parts)}"
    for inner, item in parts:
        yield from leaves(item, inner, whole=whole)
