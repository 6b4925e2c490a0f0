"""Functions that take one number and a column of numbers alike.

A column is a numpy array with an entry for each of many robots (see `dh2urdf.columns`). Sums, products and comparisons
are elementwise as they stand, and IEEE 754 rounds them alike in Python and in numpy. The functions here do what they do
not: choosing, and what comes from the C library, where numpy has loops of its own that may differ in the last bit. So
one code makes one robot and many, and the same bytes. numpy is imported where there is a column, and nowhere else.
"""

from __future__ import annotations

import math
import operator
from functools import reduce
from itertools import repeat
from struct import pack
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

Number: TypeAlias = Any
"""A float, or an array of shape (N,)."""
Condition: TypeAlias = Any
"""A bool, or an array of N booleans."""


class DividedError(Exception):
    """The members of a column would go different ways.

    Attributes:
        condition: array of N booleans: which of them go the one way.
    """

    def __init__(self, condition: Condition) -> None:
        self.condition = condition
        super().__init__(condition)


def is_column(number: Number) -> bool:
    """Whether a number is one of many; numpy's own scalars are not."""
    return bool(getattr(number, "ndim", 0))


def mapped(function: Callable[..., float], *numbers: Number) -> Number:
    """The value of a function of floats; of columns, its value for every entry."""
    for number in numbers:
        if is_column(number):
            break
    else:
        return function(*numbers)
    return array_of(tuple(map(function, *[each.tolist() if is_column(each) else repeat(each) for each in numbers])))


def array_of(numbers: Sequence[float]) -> Any:  # noqa: ANN401 - an array
    """Numbers as an array of float64, not to be written to: in a third of the time that numpy takes for a list."""
    import numpy as np

    return np.frombuffer(pack(f"{len(numbers)}d", *numbers))


def total(numbers: Iterable[Number]) -> float:
    """The sum from the left, each step rounded: since Python 3.12, `sum` rounds floats otherwise, and columns so."""
    found: float = reduce(operator.add, numbers, 0.0)
    return found


def hypot(*coordinates: Number) -> Number:
    """The length of a vector, without overflow."""
    return mapped(math.hypot, *coordinates)


def atan2(y: Number, x: Number) -> Number:
    """The angle of a point [rad]."""
    return mapped(math.atan2, y, x)


def where(condition: Condition, yes: Number, no: Number) -> Number:
    """One number or another."""
    if is_column(condition):
        import numpy as np

        return np.where(condition, yes, no)
    return yes if condition else no


def greater_of(left: Number, right: Number) -> Number:
    """The greater of two numbers."""
    if is_column(left) or is_column(right):
        import numpy as np

        return np.maximum(left, right)
    return max(left, right)


def smaller_of(left: Number, right: Number) -> Number:
    """The smaller of two numbers."""
    if is_column(left) or is_column(right):
        import numpy as np

        return np.minimum(left, right)
    return min(left, right)


def for_some(condition: Condition) -> bool:
    """Whether a condition holds for one member at least."""
    return bool(condition.any()) if is_column(condition) else condition


def agreed(condition: Condition) -> bool:
    """A condition on which all members agree: what has another structure cannot be made side by side.

    Raises:
        DividedError: they do not.
    """
    if not is_column(condition):
        return bool(condition)
    if condition.all():
        return True
    if condition.any():
        raise DividedError(condition)
    return False
