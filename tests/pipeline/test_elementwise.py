import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dh2urdf.rotations import (
    atan2,
    greater_of,
    hypot,
    is_column,
    mapped,
    smaller_of,
    where,
)

FINITE = st.floats(allow_nan=False, allow_infinity=False)
PAIRS = st.lists(st.tuples(FINITE, FINITE), min_size=1, max_size=6)


@pytest.mark.parametrize(
    ("function", "of_floats"),
    [
        (hypot, math.hypot),
        (atan2, math.atan2),
        (greater_of, max),
        (smaller_of, min),
        (lambda x, y: where(x < y, x, -y), lambda x, y: x if x < y else -y),
    ],
    ids=["hypot", "atan2", "greater_of", "smaller_of", "where"],
)
@given(PAIRS)
def test_columns_give_what_their_entries_give(
    function: Callable[..., Any], of_floats: Callable[..., float], pairs: list[tuple[float, float]]
) -> None:
    """To the last bit, for two columns, and for a column and a float."""
    x, y = (np.array(column) for column in zip(*pairs, strict=True))
    assert function(x, y).tolist() == [of_floats(a, b) for a, b in pairs]
    assert function(x, pairs[0][1]).tolist() == [of_floats(a, pairs[0][1]) for a, _ in pairs]
    assert function(pairs[0][0], y).tolist() == [of_floats(pairs[0][0], b) for _, b in pairs]


@given(FINITE, FINITE)
def test_floats_stay_floats(x: float, y: float) -> None:
    """One robot is made of Python's own numbers."""
    for value in (hypot(x, y), atan2(x, y), greater_of(x, y), smaller_of(x, y), where(x < y, x, y), mapped(abs, x)):
        assert type(value) is float


def test_a_scalar_of_numpy_is_no_column() -> None:
    """Whoever computes a table with numpy may hand its numbers over."""
    assert not is_column(np.float64(1.0))
    assert not is_column(1)
    assert is_column(np.array([1.0]))
    assert hypot(np.float64(3.0), 4.0) == 5.0
