from __future__ import annotations

import tracemalloc

import pytest
from hypothesis import given, strategies as st

from dh2urdf.output import NameSet
from dh2urdf.output.name_set import RECENT

any_text = st.text(st.characters(), max_size=3)
"""Lone surrogates and NUL included."""


@given(st.lists(st.lists(any_text, max_size=8), max_size=12), st.integers(0, 20))
def test_it_knows_what_was_added_before(batches: list[list[str]], recent: int) -> None:
    """Whatever the names are and wherever their hashes are held, the known ones are those of earlier batches."""
    seen, before = NameSet(recent), set[str]()
    for batch in batches:
        assert seen.known(batch) == before.intersection(batch)
        seen.add(batch)
        before.update(batch)


@pytest.mark.parametrize("recent", [0, RECENT])
def test_names_are_told_apart_to_the_last_letter(recent: int) -> None:
    """Case, accents and white space make other names."""
    names = ["arm", "Arm", "arm ", "árm", "a\u0301rm", "arm\0"]
    seen = NameSet(recent)
    for name in names:
        assert seen.known(names) == set(names[: names.index(name)])
        seen.add([name])


@pytest.mark.long
def test_a_name_takes_eight_bytes() -> None:
    """And four times as much for a moment where columns are joined."""

    def taken(count: int) -> int:
        tracemalloc.start()
        seen = NameSet(500)
        for start in range(0, count, 250):
            names = [f"robot_{number}" for number in range(start, start + 250)]
            assert not seen.known(names)
            seen.add(names)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert seen.known(["robot_0", f"robot_{count - 1}", f"robot_{count}"]) == {"robot_0", f"robot_{count - 1}"}
        return peak

    taken(1_000)  # The first one imports numpy, whose memory is nobody's name.
    assert taken(40_000) < taken(2_000) + 4 * 8 * 40_000
