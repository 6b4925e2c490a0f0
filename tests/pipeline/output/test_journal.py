import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf.output.journal import JOURNAL, MANIFEST, Journal, earlier_rows, next_journal
from dh2urdf.output.store import LocalStore, Store, open_store


def line(name: str, **facts: Any) -> bytes:
    return json.dumps({"name": name, **facts}).encode() + b"\n"


def write(store: Store, folder: str, file: str, *rows: bytes) -> None:
    journal = Journal(store, f"{folder}/{file}")
    for row in rows:
        journal.add(row)
    journal.close()


def found(store: Store, names: Sequence[str]) -> dict[int, list[Any]]:
    """What is known of some names, as the numbers of their rows."""
    with earlier_rows(store) as earlier:
        return {place: [json.loads(row)["number"] for row in rows] for place, rows in earlier.of(names).items()}


class TestEarlier:
    def test_rows_are_found_by_name(self, store: Store) -> None:
        """In whatever file of the journal they stand, byte for byte, by the place of the name that was asked for."""
        write(store, f"{JOURNAL}/0001", "000000000.jsonl", line("a", number=1), line("b", number=2))
        write(store, f"{JOURNAL}/0001", "000000002.jsonl", line("ä 機", number=3))
        with earlier_rows(store) as earlier:
            assert len(earlier) == 3
            assert earlier.of(["x", "b", "a", "ä 機", "b"]) == {
                1: (line("b", number=2),),
                2: (line("a", number=1),),
                3: (line("ä 機", number=3),),
                4: (line("b", number=2),),
            }

    def test_the_newest_comes_first(self, store: Store) -> None:
        """Of several attempts the last, of one attempt the last row; the manifest of a finished run is the oldest."""
        store.write(MANIFEST, line("a", number=0))
        write(store, f"{JOURNAL}/0002", "000000000.jsonl", line("a", number=3))
        write(store, f"{JOURNAL}/0010", "000000000.jsonl", line("a", number=4))
        write(store, f"{JOURNAL}/0001", "000000000.jsonl", line("a", number=1), line("a", number=2))
        assert found(store, ["a"]) == {0: [4, 3, 2, 1, 0]}

    @pytest.mark.parametrize(
        "torn", [b'{"name": "c", "num', b'{"name"', b"{}", b"[]", b"3", b'{"name": 3}', b"\xff\xfe"]
    )
    def test_a_torn_line_is_left_out(self, store: Store, torn: bytes) -> None:
        """What a process wrote when it was killed is no row; those before it are."""
        write(store, f"{JOURNAL}/0001", "000000000.jsonl", line("a", number=1), torn)
        write(store, f"{JOURNAL}/0001", "000000001.jsonl", line("b", number=2))
        assert found(store, ["a", "b", "c"]) == {0: [1], 1: [2]}
        assert found(store, ["b", "3"]) == {0: [2]}

    @given(
        st.lists(st.tuples(st.sampled_from("abcdef"), st.integers(0, 9)), max_size=30),
        st.lists(st.sampled_from("abcxyz")),
    )
    def test_as_in_a_plain_dictionary(
        self, tmp_path_factory: pytest.TempPathFactory, rows: list[tuple[str, int]], names: list[str]
    ) -> None:
        """Whatever rows there are and whatever is asked for."""
        store = open_store(tmp_path_factory.mktemp("journal"))
        write(store, f"{JOURNAL}/0001", "000000000.jsonl", *(line(name, number=number) for name, number in rows))
        known = {name: [number for other, number in rows[::-1] if other == name] for name in "abcdef"}
        assert found(store, names) == {place: known[name] for place, name in enumerate(names) if known.get(name)}


class TestJournal:
    def test_a_row_that_was_dear_is_there_at_once(self, tmp_path: Path) -> None:
        """In a folder, where a line can be added to a file; the cheap ones before it come along, in their order."""
        journal = Journal(LocalStore(tmp_path), f"{JOURNAL}/0001/000000000.jsonl")
        file = tmp_path / JOURNAL / "0001" / "000000000.jsonl"
        journal.add(line("a"))
        assert not file.exists()
        journal.add(line("b"), now=True)
        assert file.read_bytes() == line("a") + line("b")
        journal.add(line("c"))
        journal.close()
        assert file.read_bytes() == line("a") + line("b") + line("c")

    def test_an_object_has_all_rows_of_its_batch(self, store: Store) -> None:
        """Where files cannot be written bit by bit they are written once, at the end."""
        journal = Journal(store, f"{JOURNAL}/0001/000000007.jsonl")
        for name in "abc":
            journal.add(line(name), now=True)
        journal.close()
        assert store.read(f"{JOURNAL}/0001/000000007.jsonl") == line("a") + line("b") + line("c")


def test_every_run_has_a_journal_of_its_own(store: Store) -> None:
    """Numbered on from the highest that is there, so that names in the order of the alphabet are in that of time."""
    assert next_journal(store) == f"{JOURNAL}/0001"
    write(store, next_journal(store), "000000000.jsonl", line("a"))
    write(store, next_journal(store), "000000000.jsonl", line("a"))
    assert next_journal(store) == f"{JOURNAL}/0003"
    write(store, f"{JOURNAL}/0042", "000000000.jsonl", line("a"))
    assert next_journal(store) == f"{JOURNAL}/0043"
