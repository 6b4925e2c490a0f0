from __future__ import annotations

import tracemalloc
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, strategies as st

from dh2urdf.errors import OutputError
from dh2urdf.output import SeenNames
from dh2urdf.output.seen_names import RECENT

if TYPE_CHECKING:
    from pathlib import Path

any_text = st.text(st.characters(), max_size=3)
"""Lone surrogates and NUL included."""


@given(st.lists(st.lists(any_text, max_size=8), max_size=12), st.integers(0, 5))
def test_it_knows_what_was_added_before(batches: list[list[str]], recent: int) -> None:
    """Whatever the names are and wherever they are held, the known ones are those of earlier batches."""
    seen, before = SeenNames(recent=recent), set[str]()
    for batch in batches:
        assert seen.known(batch) == before.intersection(batch)
        seen.add(batch)
        before.update(batch)


def test_names_are_told_apart_to_the_last_letter() -> None:
    """Case, accents and white space make other names, in memory and in the database."""
    names = ["arm", "Arm", "arm ", "árm", "a\u0301rm", "arm\0"]
    for recent in (RECENT, 0):
        seen = SeenNames(recent=recent)
        for name in names:
            assert seen.known(names) == set(names[: names.index(name)])
            seen.add([name])


@pytest.mark.long
def test_memory_does_not_grow_with_the_names() -> None:
    """Twenty times as many names take no more than the few that are held."""

    def taken(count: int) -> int:
        tracemalloc.start()
        seen = SeenNames(recent=500)
        for start in range(0, count, 250):
            names = [f"robot_{number}" for number in range(start, start + 250)]
            assert not seen.known(names)
            seen.add(names)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert seen.known(["robot_0", f"robot_{count - 1}", f"robot_{count}"]) == {"robot_0", f"robot_{count - 1}"}
        return peak

    taken(1_000)  # The first one imports sqlite3, whose memory is nobody's name.
    assert taken(40_000) < 1.2 * taken(2_000)


def test_nothing_is_left_in_the_temporary_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The database has no name in the file system, even while it is in use."""
    monkeypatch.setenv("SQLITE_TMPDIR", str(tmp_path))
    seen = SeenNames(recent=0)
    for start in range(0, 200_000, 10_000):  # more than the pages that are kept in memory
        seen.add(f"robot_{number}" for number in range(start, start + 10_000))
    assert seen.known(["robot_199999"])
    assert list(tmp_path.iterdir()) == []


def test_a_full_temporary_folder_is_said_to_be_full() -> None:
    """What the database cannot hold is an error of the output, which says where."""
    seen = SeenNames(recent=0)
    seen.add(["robot"])
    assert seen._database is not None
    seen._database.execute("PRAGMA max_page_count = 2")
    with pytest.raises(OutputError, match=r"cannot be kept in the temporary folder: .*full.*\n.*SQLITE_TMPDIR"):
        seen.add(f"robot_{number}" for number in range(10_000))
