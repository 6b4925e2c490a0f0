"""Regular expressions that are compiled when they are first used."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from dh2urdf.patterns import late_pattern
from dh2urdf.quantities.spellings import advice, misreading

_STARTED = """
import pathlib, re, sys
compiled = []
compile_ = re.compile
re.compile = lambda *given: compiled.append(given) or compile_(*given)
from dh2urdf.quantities.spellings import misreading
before = len(compiled)
misreading("12-14")
print(before, len(compiled) > before)
"""


def test_is_compiled_at_its_first_use_only() -> None:
    """Importing a module with forty patterns compiles none of them."""
    done = subprocess.run([sys.executable, "-c", _STARTED], check=True, capture_output=True, text=True)
    assert done.stdout.split() == ["0", "True"]


@pytest.mark.parametrize("text", ["a12", "12", ""])
def test_finds_what_a_pattern_finds(text: str) -> None:
    """Each method, at its first use and later, is that of the pattern."""
    late, early = late_pattern("([A-Z])([0-9]+)", re.IGNORECASE), re.compile("([A-Z])([0-9]+)", re.IGNORECASE)
    for _ in range(2):
        assert [bool(late.match(text)), late.findall(text), late.sub("x", text)] == [
            bool(early.match(text)),
            early.findall(text),
            early.sub("x", text),
        ]
    assert late.pattern == early.pattern


def test_a_text_that_is_no_pattern_is_an_error_where_it_is_used() -> None:
    with pytest.raises(re.error):
        late_pattern("(").match("")


@pytest.mark.parametrize("text", ["Jan 5", "5 jan", "märz 2", "1/2/2024", " 12:30", "2024-01-05", "3-4"])
def test_dates_are_recognised_by_their_first_character_first(text: str) -> None:
    assert misreading(text) == ("it is a date", misreading("3-4")[1])  # type: ignore[index]


def test_advice_goes_through_all_patterns() -> None:
    """A text that none of them knows compiles them all: each is a pattern."""
    assert advice("?") is None
