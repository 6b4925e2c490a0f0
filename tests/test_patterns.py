"""What spellings of numbers are, and no numbers."""

from __future__ import annotations

import pytest

from dh2urdf.quantities.spellings import advice, misreading


@pytest.mark.parametrize("text", ["Jan 5", "5 jan", "märz 2", "1/2/2024", " 12:30", "2024-01-05", "3-4"])
def test_dates_are_recognised_by_their_first_character_first(text: str) -> None:
    assert misreading(text) == ("it is a date", misreading("3-4")[1])  # type: ignore[index]


def test_advice_goes_through_all_patterns() -> None:
    """A text that none of them knows compiles them all: each is a pattern."""
    assert advice("?") is None
