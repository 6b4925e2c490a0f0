from __future__ import annotations

import sys
import tempfile
import tracemalloc
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from dh2urdf.errors import OutputError
from dh2urdf.output import SeenNames
from dh2urdf.output.seen_names import HASHED, RECENT

any_text = st.text(st.characters(), max_size=3)
"""Lone surrogates and NUL included."""


@given(st.lists(st.lists(any_text, max_size=8), max_size=12), st.integers(0, 5), st.integers(0, 20))
def test_it_knows_what_was_added_before(batches: list[list[str]], recent: int, hashed: int) -> None:
    """Whatever the names are and wherever they are held, the known ones are those of earlier batches."""
    seen, before = SeenNames(recent=recent, hashed=hashed), set[str]()
    for batch in batches:
        assert seen.known(batch) == before.intersection(batch)
        seen.add(batch)
        before.update(batch)


def test_names_are_told_apart_to_the_last_letter() -> None:
    """Case, accents and white space make other names, in memory, by their hashes and in the database."""
    names = ["arm", "Arm", "arm ", "árm", "a\u0301rm", "arm\0"]
    for recent, hashed in ((RECENT, HASHED), (0, HASHED), (0, 0)):
        seen = SeenNames(recent=recent, hashed=hashed)
        for name in names:
            assert seen.known(names) == set(names[: names.index(name)])
            seen.add([name])


@pytest.mark.long
def test_memory_does_not_grow_with_the_names() -> None:
    """Twenty times as many names take no more than the few that are held."""

    def taken(count: int, hashed: int) -> int:
        tracemalloc.start()
        seen = SeenNames(recent=500, hashed=hashed)
        for start in range(0, count, 250):
            names = [f"robot_{number}" for number in range(start, start + 250)]
            assert not seen.known(names)
            seen.add(names)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert seen.known(["robot_0", f"robot_{count - 1}", f"robot_{count}"]) == {"robot_0", f"robot_{count - 1}"}
        return peak

    taken(1_000, 0)  # The first one imports sqlite3 and numpy, whose memory is nobody's name.
    assert taken(40_000, 0) < 1.2 * taken(2_000, 0)
    # A hash takes 8 bytes, and four times as much for a moment where columns are joined.
    assert taken(40_000, HASHED) < taken(2_000, HASHED) + 4 * 8 * 40_000


def test_no_database_is_needed_until_a_name_comes_again() -> None:
    """The hashes of names show that all are new; two names of one hash, and one that comes again, are asked for."""
    seen = SeenNames(recent=10)
    for start in range(0, 1_000, 20):
        names = [f"robot_{number}" for number in range(start, start + 20)]
        assert seen.known(names) == set()
        seen.add(names)
    assert seen._database is None
    assert seen.known(["robot_0", "robot_7", "another"]) == {"robot_0", "robot_7"}
    assert seen._database is not None
    seen.add(["another"])
    assert seen.known(["robot_999", "another", "none"]) == {"robot_999", "another"}


def test_two_names_of_one_hash() -> None:
    """A hash that comes again is no name that comes again."""

    class Name(str):
        __slots__ = ()

        def __hash__(self) -> int:
            return 7

    seen = SeenNames(recent=0)
    seen.add([Name("ur5")])
    assert seen.known([Name("ur10")]) == set()
    assert seen.known([Name("ur5")]) == {"ur5"}


@pytest.mark.parametrize("hashed", [0, HASHED])
def test_nothing_is_left_in_the_temporary_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, hashed: int) -> None:
    """Neither file nor database has a name in the file system, even while they are in use."""
    monkeypatch.setenv("SQLITE_TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    seen = SeenNames(recent=0, hashed=hashed)
    for start in range(0, 200_000, 10_000):  # more than the pages that are kept in memory
        seen.add(f"robot_{number}" for number in range(start, start + 10_000))
        assert list(tmp_path.iterdir()) == []
    assert seen.known(["robot_199999"])
    assert list(tmp_path.iterdir()) == []


def test_a_full_temporary_folder_is_said_to_be_full() -> None:
    """What the database cannot hold is an error of the output, which says where."""
    seen = SeenNames(recent=0, hashed=0)
    seen.add(["robot"])
    assert seen._database is not None
    seen._database.execute("PRAGMA max_page_count = 2")
    with pytest.raises(OutputError, match=r"cannot be kept in the temporary folder: .*full.*\n.*SQLITE_TMPDIR"):
        seen.add(f"robot_{number}" for number in range(10_000))


@pytest.mark.skipif(sys.platform != "linux", reason="/dev/full is a device of Linux")
def test_a_full_temporary_folder_is_said_to_be_full_for_a_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """The file that names are written to before there is a database."""
    monkeypatch.setattr(tempfile, "TemporaryFile", lambda: Path("/dev/full").open("w+b", buffering=0))  # noqa: SIM115 - as it is
    with pytest.raises(OutputError, match=r"cannot be kept in the temporary folder: .*No space left.*\n.*TMPDIR"):
        SeenNames(recent=0).add(["robot"])
