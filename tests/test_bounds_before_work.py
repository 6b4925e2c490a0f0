"""Small files that would take gigabytes or minutes: each is refused in one sentence, in a child that is measured."""

import io
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest

MOST = 300
"""What reading may take beyond the memory that a plain table of the same kind takes [MiB]."""
CHILD = """
import resource, sys, time
from dh2urdf.errors import Dh2UrdfError
import dh2urdf
begun = time.process_time()
try:
    dh2urdf.read(sys.argv[1])
    print("read")
except Dh2UrdfError as error:
    print(len(error.problems), error.problems[0].message)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024, time.process_time() - begun)
"""
GEOMETRY: dict[str, Any] = {"a": [0.1, 0.2], "alpha": [0.0, 0.1], "d": [0.1, 0.0]}
ARM = {"convention": ["standard"] * 2, "joint": ["j1", "j2"], **GEOMETRY}


def read(path: Path) -> tuple[str, int, float]:
    """What a child says of a file, its memory [MiB] and its processor time [s]."""
    ended = subprocess.run([sys.executable, "-c", CHILD, str(path)], capture_output=True, text=True, check=True)
    said, measured = ended.stdout.splitlines()
    memory, seconds = measured.split()
    return said, int(memory), float(seconds)


def refused(path: Path, plain: Path) -> str:
    """The one sentence in which a file is refused that takes no more than a plain one does, but for `MOST`."""
    accepted, memory_of_plain, _ = read(plain)
    assert accepted == "read"
    said, memory, _ = read(path)
    assert memory < memory_of_plain + MOST
    count, _, message = said.partition(" ")
    assert count == "1", said
    return message


@pytest.fixture
def parquet(tmp_path: Path) -> Any:
    """Writes columns into a Parquet file."""
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")

    def write(name: str, columns: dict[str, Any], **options: Any) -> Path:
        path = tmp_path / f"{name}.parquet"
        pq.write_table(pa.table(columns), path, compression="zstd", **options)
        assert path.stat().st_size < 2**22
        return path

    write("plain", ARM)
    return write


def test_a_cell_of_parquet_of_hundreds_of_megabytes(parquet: Any, tmp_path: Path) -> None:
    """48 kB that hold one text of 1.5 GB took 7.4 GB before they were refused."""
    path = parquet("cell", {**ARM, "joint": ["x" * 300_000_000, "j2"]})
    assert (
        refused(path, tmp_path / "plain.parquet") == "the column 'joint' has 2 values, 286 MiB when unpacked, in 2 rows"
    )


def test_a_long_cell_that_many_rows_of_parquet_share(parquet: Any, tmp_path: Path) -> None:
    """A dictionary holds it once, and each row that is read would have its own: 30 GB."""
    import pyarrow as pa

    count = 3000
    columns = {key: values * (count // 2) for key, values in ARM.items()}
    note = pa.DictionaryArray.from_arrays(pa.array([0] * count, pa.int32()), ["x" * 10_000_000])
    columns |= {"robot": [f"r{k}" for k in range(count)], "note": note}
    path = parquet("shared", columns)
    assert refused(path, tmp_path / "plain.parquet") == "the column 'note' has a text of 10,000,000 bytes"


def test_rows_of_one_manipulator_are_counted_before_they_are_read(parquet: Any, tmp_path: Path) -> None:
    """3,000,000 rows took 16 s, to say that there are at most 5,000 joints."""
    import numpy as np
    import pyarrow as pa

    count = 3_000_000
    columns: dict[str, Any] = dict.fromkeys(GEOMETRY, np.zeros(count))
    columns["convention"] = pa.array(["standard"] * count).dictionary_encode()
    columns["robot"] = pa.array(["a"] * count).dictionary_encode()
    path, plain = parquet("rows", columns), tmp_path / "plain.parquet"
    assert " joints" in refused(path, plain)
    assert read(path)[2] < read(plain)[2] + 1.0


def test_a_table_has_a_thousand_columns(parquet: Any, tmp_path: Path) -> None:
    """4,000 columns that nothing is called took 9 to 15 s."""
    path, plain = parquet("columns", {**ARM, **{f"c{k}": [1.0, 2.0] for k in range(4000)}}), tmp_path / "plain.parquet"
    assert refused(path, plain).endswith(" columns")
    assert read(path)[2] < read(plain)[2] + 1.0


def workbook(path: Path, sheet: bytes = b"") -> Path:
    """A workbook, whose sheet has other XML where that is given."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in (["# convention: standard"], ["a", "alpha", "d"], [0.1, 0, 0.2]):
        book.active.append(row)
    written = io.BytesIO()
    book.save(written)
    with zipfile.ZipFile(written) as old, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            content = old.read(name)
            is_sheet = name.endswith("sheet1.xml") and sheet
            new.writestr(name, content.replace(b"</sheetData>", sheet + b"</sheetData>") if is_sheet else content)
    return path


def test_a_row_behind_two_thousand_million_that_hold_nothing(tmp_path: Path) -> None:
    """A sheet has 1,048,576 rows and 16,384 columns; a higher number would have been waited for for hours."""
    plain = workbook(tmp_path / "plain.xlsx")
    message = refused(workbook(tmp_path / "far.xlsx", b'<row r="2000000000"/>'), plain)
    assert message.startswith("the workbook cannot be read: ")


def test_a_workbook_is_measured_before_it_is_unpacked(tmp_path: Path) -> None:
    """Its parts say what they have when unpacked."""
    plain = workbook(tmp_path / "plain.xlsx")
    path = workbook(tmp_path / "large.xlsx", b" " * 600_000_000)
    assert refused(path, plain).endswith("MiB in 9 parts when unpacked")
