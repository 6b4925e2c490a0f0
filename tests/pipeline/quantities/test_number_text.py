import json
import re

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dh2urdf.quantities import format_number, format_numbers, format_rows

finite = st.floats(allow_nan=False, allow_infinity=False)
XSD_DOUBLE = re.compile(r"-?[0-9]+(\.[0-9]+)?(e-?[0-9]+)?")


@given(finite)
def test_the_text_reads_back_to_the_same_double(number: float) -> None:
    """Python, JSON and so every reader gets the double that was written."""
    text = format_number(number)
    assert float(text) == number
    assert json.loads(text) == number


@given(finite)
def test_the_text_is_an_xsd_double_with_the_fewest_digits(number: float) -> None:
    """No other form occurs, and `repr`, which is known to give the fewest digits, gives no fewer."""
    text = format_number(number)
    assert XSD_DOUBLE.fullmatch(text)
    assert _digits(text) == _digits(repr(number))


def _digits(text: str) -> str:
    return re.sub(r"e.*|[-.]", "", text).strip("0")


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (-2.0, "-2"),
        (100.0, "100"),
        (0.00001, "0.00001"),
        (-2.5e-9, "-2.5e-9"),
        (1e15, "1000000000000000"),
        (-1e22, "-1e22"),
        (5e-324, "5e-324"),
        (1.7976931348623157e308, "1.7976931348623157e308"),
    ],
)
def test_whole_numbers_zeros_and_exponents_have_one_form(number: float, text: str) -> None:
    """Whole numbers have no point, zero has no sign, exponents have neither plus nor leading zeros."""
    assert format_number(number) == text


@given(st.lists(finite))
def test_a_list_is_formatted_as_its_numbers_are(numbers: list[float]) -> None:
    """There is one formatter: the call for many numbers gives what the call for one gives."""
    assert format_numbers(numbers) == [format_number(number) for number in numbers]


@pytest.mark.parametrize("number", [float("nan"), float("inf"), float("-inf")])
def test_what_is_not_finite_is_refused(number: float) -> None:
    """A robot description has no word for it."""
    with pytest.raises(ValueError, match=f"{number} is not a finite number"):
        format_numbers([0.5, number])
    with pytest.raises(ValueError, match=f"{number} is not a finite number"):
        format_rows([np.array([0.5, number])])


@given(st.lists(st.lists(finite | st.sampled_from([0.0, -0.0, 1.0, 10.0, 1e16]), min_size=3, max_size=3), max_size=6))
def test_columns_are_formatted_as_their_numbers_are(columns: list[list[float]]) -> None:
    """Many columns in one call give the same texts; one text stands for a column of equal numbers."""
    entries, rows = format_rows([np.array(column) for column in columns])
    texts = list(rows)
    for column, entry in zip(columns, entries, strict=True):
        found = [entry] * 3 if isinstance(entry, bytes) else [row[entry] for row in texts]
        assert [text.decode() for text in found] == format_numbers(column)
        assert isinstance(entry, bytes) is (len(set(column)) == 1)


def test_many_rows_are_formatted_as_a_few_are() -> None:
    """Rows beyond those of one call follow those before."""
    numbers = np.arange(200.0) / 3.0
    entries, rows = format_rows([numbers, -numbers])
    assert entries == [0, 1]
    texts = [tuple(text.decode() for text in row) for row in rows]
    assert texts == [(format_number(number), format_number(-number)) for number in numbers]
