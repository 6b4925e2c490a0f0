import io
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pyarrow as pa
from pyarrow import parquet

from dh2urdf.conversion.outcome import to_line
from dh2urdf.report.manifest_table import ROW_GROUP, ManifestTable


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


def written(rows: list[dict[str, Any]]) -> bytes:
    """The file of some rows."""
    table = ManifestTable()
    for each in rows:
        table.add(each)  # type: ignore[arg-type]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "manifest.parquet"
        table.write(path, io.BytesIO(b"".join(map(to_line, rows))))
        return path.read_bytes()


def table(rows: list[dict[str, Any]]) -> Any:
    return parquet.read_table(io.BytesIO(written(rows)))


def file(path: str, stage: str = "urdf", **place: Any) -> dict[str, Any]:
    return {"path": path, "stage": stage, "bytes": 7000, "sha256": "ab" * 32, **place}


def proof(position: float | None, angle: float) -> dict[str, Any]:
    return {"position_error": position, "angle_error": angle, "q": [0.5, -0.5], "tolerance": 1e-12, "poses": 35}


class TestManifestTable:
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
        path.write_bytes(written([*(row(f"arm_{number}") for number in range(count - 1)), last]))
        with parquet.ParquetFile(path) as read:
            assert [read.metadata.row_group(k).num_rows for k in range(read.num_row_groups)] == [
                ROW_GROUP,
                ROW_GROUP,
                5,
            ]
            columns = read.read(["name", "drawn.late"]).to_pydict()
        assert columns["name"] == [f"arm_{number}" for number in range(count)]
        assert columns["drawn.late"] == [None] * (count - 1) + [1.5]
