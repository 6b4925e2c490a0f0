from __future__ import annotations

import io
import json
import re
import tracemalloc
from collections import Counter
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet

from dh2urdf.manifest import LONGEST_REASON, MAX_NAMES, MAX_REASONS, ROW_GROUP, Index, can_write_parquet, pattern
from dh2urdf.manifest import write_parquet as write
from dh2urdf.outcome import to_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path


def row(name: str = "arm", **facts: Any) -> dict[str, Any]:
    """A row of the manifest of which nothing is to be said."""
    plain: dict[str, Any] = {
        "status": "ok",
        "kind": None,
        "source": "arms.csv",
        "key": "00ff",
        "drawn": {},
        "keeps_kinematics": True,
    }
    empty: dict[str, Any] = {"files": [], "proof": {}, "loaders": {}, "notices": [], "errors": []}
    return {"name": name, **plain, **empty, **facts}


def failed(name: str, kind: str, message: str) -> dict[str, Any]:
    return row(name, status="failed", kind=kind, errors=[{"message": message, "file": "arms.csv", "line": 3}])


def json_lines(rows: Iterable[dict[str, Any]]) -> io.BytesIO:
    return io.BytesIO(b"".join(json.dumps(each).encode() + b"\n" for each in rows))


def written(rows: Iterable[dict[str, Any]]) -> bytes:
    target = io.BytesIO()
    write(json_lines(rows), target)
    return target.getvalue()


def table(rows: Iterable[dict[str, Any]]) -> Any:
    return parquet.read_table(io.BytesIO(written(rows)))


def file(path: str, stage: str = "urdf", **place: Any) -> dict[str, Any]:
    return {"path": path, "stage": stage, "bytes": 7000, "sha256": "ab" * 32, **place}


def proof(position: float | None, angle: float) -> dict[str, Any]:
    return {"position_error": position, "angle_error": angle, "q": [0.5, -0.5], "tolerance": 1e-12, "poses": 35}


class TestParquet:
    def test_pyarrow_is_looked_for(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Whether a Parquet file can be written is known without an import."""
        assert can_write_parquet()
        monkeypatch.setattr("dh2urdf.manifest.find_spec", lambda _name: None)
        assert not can_write_parquet()

    def test_what_every_manifest_has(self) -> None:
        """A row that says nothing fills every column that does not depend on the run."""
        (read,) = table([row()]).to_pylist()
        facts = {name: fact for name, fact in row().items() if name not in ("drawn", "proof", "loaders")}
        assert read == {**facts, "position_error": None, "angle_error": None, "proved": [], "error": None}

    def test_errors_are_the_largest_of_all_files(self) -> None:
        """Of a stage that was not proved, and of a distance that is infinite, nothing counts."""
        proofs = {"urdf": proof(1e-16, 3e-9), "xacro": None, "sdf": proof(5e-16, 1e-9), "mjcf": proof(None, 0.0)}
        read = table([row(proof=proofs), row(proof={"urdf": None})]).to_pylist()
        assert [each["position_error"] for each in read] == [5e-16, None]
        assert [each["angle_error"] for each in read] == [3e-9, None]
        assert [each["proved"] for each in read] == [["urdf", "sdf", "mjcf"], []]

    def test_files_keep_their_place(self) -> None:
        """A file of its own has a path; one in a tar shard has the shard and the offset of its bytes too."""
        files = [file("a.urdf"), file("b.urdf.xacro", "xacro", shard="shard-000001.tar", offset=2**33 + 512)]
        (read,) = table([row(files=files)])["files"].to_pylist()
        assert read == [{"shard": None, "offset": None, **each} for each in files]

    def test_drawn_values_are_columns(self) -> None:
        """Numbers are doubles to the last bit, whole or not; types are text; what was not drawn is null."""
        rows = [row(drawn={"a_2": 1}), row(drawn={"a_2": 0.1 + 0.2, "type_3": "prismatic"}), row(drawn={"axes": 6})]
        read = table(rows)
        drawn = {name: read[name].to_pylist() for name in read.column_names if name.startswith("drawn.")}
        assert drawn == {
            "drawn.a_2": [1.0, 0.1 + 0.2, None],
            "drawn.type_3": [None, "prismatic", None],
            "drawn.axes": [None, None, 6.0],
        }
        assert read.schema.field("drawn.axes").type == pa.float64()

    def test_what_is_a_number_here_and_text_there_is_text(self) -> None:
        """A column has one type, and nothing of it is lost."""
        assert table([row(drawn={"x": 0.5}), row(drawn={"x": "c"})])["drawn.x"].to_pylist() == ["0.5", "c"]

    def test_reports_of_simulators_are_columns(self) -> None:
        """Numbers, truth values, text and the messages of findings; other lists and what nobody filled are left out."""
        report = {
            "simulator": "PyBullet",
            "position_error": 3e-8,
            "mass": None,
            "joints": [{"name": "joint_1"}],
            "q": [1.0],
            "hold": {"stayed": True, "seconds": 1, "contacts": []},
            "findings": [{"message": "it wobbles", "line": None}],
        }
        read = table([row(loaders={"pybullet": report}), row()])
        found = {name: read[name].to_pylist() for name in read.column_names if name.startswith("loaders.")}
        assert found == {
            "loaders.pybullet.simulator": ["PyBullet", None],
            "loaders.pybullet.position_error": [3e-8, None],
            "loaders.pybullet.hold.stayed": [True, None],
            "loaders.pybullet.hold.seconds": [1.0, None],
            "loaders.pybullet.findings": [["it wobbles"], None],
        }

    def test_messages(self) -> None:
        """The first error for a glance, and all of them, and the notices, in their order."""
        errors, notices = [{"message": "one"}, {"message": "two"}], [{"message": "three"}]
        (read,) = table([row(status="failed", kind="robot", errors=errors, notices=notices)]).to_pylist()
        assert (read["kind"], read["error"], read["errors"], read["notices"]) == (
            "robot",
            "one",
            ["one", "two"],
            ["three"],
        )

    def test_all_rows_in_their_order_in_groups(self, tmp_path: Path) -> None:
        """More rows than one group holds are all there; a column that the last one alone fills is there too."""
        count = 2 * ROW_GROUP + 5
        last = row(f"arm_{count - 1}", drawn={"late": 1.5})
        path = tmp_path / "manifest.parquet"
        write(json_lines([*(row(f"arm_{number}") for number in range(count - 1)), last]), path)
        with parquet.ParquetFile(path) as read:
            assert [read.metadata.row_group(k).num_rows for k in range(read.num_row_groups)] == [
                ROW_GROUP,
                ROW_GROUP,
                5,
            ]
            columns = read.read(["name", "drawn.late"]).to_pydict()
        assert columns["name"] == [f"arm_{number}" for number in range(count)]
        assert columns["drawn.late"] == [None] * (count - 1) + [1.5]

    def test_rows_of_any_length(self) -> None:
        """A row longer than what is read at once is read whole, and so are those around it."""
        long = "x" * 3_000_000
        read = table([row("a"), row("b", notices=[{"message": long}]), row("c")])
        assert read["name"].to_pylist() == ["a", "b", "c"]
        assert read["notices"].to_pylist() == [[], [long], []]

    def test_a_run_without_manipulators(self) -> None:
        """No rows give a file without rows, with the columns that every manifest has."""
        read = table([])
        assert read.num_rows == 0
        assert {"name", "files", "error"} <= set(read.column_names)

    def test_the_same_rows_give_the_same_bytes(self) -> None:
        """Nothing of the moment or of the process is in the file."""
        rows = [
            row(
                f"arm_{number}",
                drawn={"a_1": number / 7},
                files=[file(f"arm_{number}.urdf")],
                proof={"urdf": proof(0, 0)},
            )
            for number in range(3000)
        ]
        assert written(rows) == written(rows)

    def test_rows_are_not_kept(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Ten times as many rows take no more memory than one group of them."""
        monkeypatch.setattr("dh2urdf.manifest.ROW_GROUP", 500)

        class Lines:
            """JSON lines that nobody holds."""

            def __init__(self, count: int) -> None:
                self.count = count

            def seek(self, position: int) -> None:
                assert position == 0

            def __iter__(self) -> Iterator[bytes]:
                for number in range(self.count):
                    yield json.dumps(row(f"arm_{number}", files=[file("a")], drawn={"a_1": number})).encode()

        def peak(count: int) -> int:
            arrow = pa.total_allocated_bytes()
            tracemalloc.start()
            target = io.BytesIO()
            write(cast("BinaryIO", Lines(count)), target)
            size = len(target.getvalue())
            taken = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            assert pa.total_allocated_bytes() == arrow
            return taken - 2 * size  # the file itself stands in memory here

        write(cast("BinaryIO", Lines(1)), io.BytesIO())  # what is imported for the first time is not counted
        assert peak(10_000) < 1.3 * peak(1_000)


MESSAGES = (
    "'{q}' is more than a full turn in rad, and no unit is declared for it",
    "what the emitter 'urdf' wrote is not the arm of the table: tool0 is off by {x} m at q = [{x}, {x}]",
    "the worker crashed (segmentation fault)",
    "it didn't answer within {n} s",
)
KINDS = ("table", "proof", "crash", "time limit")


class TestIndex:
    def test_a_run_in_which_nothing_failed(self) -> None:
        """Everything is counted, and there are no failures."""
        index = Index()
        for number in range(3):
            index.add(row(str(number)))
        assert index.as_json() == {"manipulators": 3, "ok": 3, "failed": 0, "failures": {}}

    @given(
        st.lists(st.tuples(st.sampled_from(range(5)), st.integers(0, 10**9), st.floats(allow_nan=False)), max_size=60)
    )
    def test_counts_are_those_of_the_rows(self, outcomes: list[tuple[int, int, float]]) -> None:
        """By kind and by reason, as a plain count finds them; examples and names are those of the first rows."""
        index, rows = Index(), []
        for number, (which, n, x) in enumerate(outcomes):
            if which == len(KINDS):
                rows.append(row(f"arm_{number}"))
            else:
                rows.append(failed(f"arm_{number}", KINDS[which], MESSAGES[which].format(q=f"{x} deg", n=n, x=x)))
            index.add(rows[-1])
        found = json.loads(json.dumps(index.as_json()))
        bad = [each for each in rows if each["status"] == "failed"]
        assert (found["manipulators"], found["ok"], found["failed"]) == (len(rows), len(rows) - len(bad), len(bad))
        assert {kind: failures["count"] for kind, failures in found["failures"].items()} == Counter(
            each["kind"] for each in bad
        )
        counts = [failures["count"] for failures in found["failures"].values()]
        assert counts == sorted(counts, reverse=True)
        for kind, failures in found["failures"].items():
            of_kind = [each for each in bad if each["kind"] == kind]
            assert failures["names"] == [each["name"] for each in of_kind]
            (reason,) = failures["reasons"]
            assert reason["count"] == len(of_kind)
            assert reason["example"] == of_kind[0]["errors"][0]["message"]

    def test_reasons_are_told_apart(self) -> None:
        """Two things that went wrong are two reasons, the commoner one first."""
        index = Index()
        for number, message in enumerate(["d is empty", "a is empty", "a is empty"]):
            index.add(failed(str(number), "table", message))
        reasons = index.as_json()["failures"]["table"]["reasons"]
        assert [(reason["pattern"], reason["count"]) for reason in reasons] == [("a is empty", 2), ("d is empty", 1)]

    def test_the_index_stays_small(self) -> None:
        """Of many names the first ones are listed, of many reasons the first ones are told apart; all are counted."""
        index = Index()
        words = [f"{chr(97 + k // 26)}{chr(97 + k % 26)}" for k in range(MAX_REASONS + 50)]
        for number in range(10 * len(words)):
            index.add(failed(f"arm_{number}", "emitter", f"{words[number % len(words)]} {'x' * 10_000}"))
        failures = index.as_json()["failures"]["emitter"]
        assert failures["count"] == 10 * len(words)
        assert failures["names"] == [f"arm_{number}" for number in range(MAX_NAMES)]
        assert [reason["pattern"][:2] for reason in failures["reasons"]] == words[:MAX_REASONS]
        assert {reason["count"] for reason in failures["reasons"]} == {10}
        assert {len(reason["pattern"]) for reason in failures["reasons"]} == {LONGEST_REASON}
        assert failures["other_reasons"] == 10 * 50

    @pytest.mark.parametrize(
        ("message", "what"),
        [
            ("off by 1.5e-07 m and −3 rad, q = [0.1, -0.2, inf]", "off by # m and # rad, q = [#]"),
            ("joint_12: 5,000 joints, nan kg", "joint_#: # joints, # kg"),
            ("the name 'a b 7' is that of \"it's\"", "the name '…' is that of '…'"),
            ("it doesn't move, and it can't", "it doesn't move, and it can't"),
            ("information about infinity", "information about infinity"),
        ],
    )
    def test_a_pattern_keeps_what_was_said(self, message: str, what: str) -> None:
        """Numbers and quoted texts are taken out, and nothing else: no word that only looks like one of them."""
        assert pattern(message) == what
        assert not re.search(r"\d", pattern(message))


@given(st.lists(st.tuples(st.text() | st.just('x","status":"ok","kind":null,"'), st.booleans()), max_size=8))
def test_lines_are_counted_as_rows_are(some: list[tuple[str, bool]]) -> None:
    """The index of lines as a run writes them is the index of their rows, whatever manipulators are called."""
    rows = [row(name) if good else failed(name, "proof", f"{name} is another arm") for name, good in some]
    by_row, by_line = Index(), Index()
    for each in rows:
        by_row.add(each)
        by_line.add_line(to_line(each))
    assert by_line.as_json() == by_row.as_json()
