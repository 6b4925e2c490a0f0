import json
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf.conversion.outcome import kind_of, to_line
from dh2urdf.errors import StageError, TableError, TimeLimitError


@pytest.mark.parametrize(
    ("error", "kind"),
    [
        (TableError("x"), "table"),
        (TimeLimitError("x"), "time limit"),
        (StageError("emitter 'x'", "KeyError: 1"), "stage"),
    ],
    ids=["table", "time limit", "stage"],
)
def test_the_kind_of_a_failure_is_its_class_in_words(error: Exception, kind: str) -> None:
    """Failures are counted by words, and a new class needs no new word."""
    assert kind_of(error) == kind


TEXTS = st.text(st.characters(codec=None), max_size=5)


@given(st.recursive(st.none() | st.booleans() | st.integers(-9, 9) | TEXTS, lambda inner: st.lists(inner, max_size=3)))
def test_anything_plain_can_be_written(data: Any) -> None:
    """Whatever texts it holds, lone surrogates too: what is UTF-8 comes back as it was."""
    found = json.loads(to_line({"data": data}))["data"]
    try:
        json.dumps(data, ensure_ascii=False).encode()
    except UnicodeEncodeError:
        return
    assert found == data
