"""Files that have the ending of another kind: each reader says what the file really is."""

import gzip
import io
import zipfile
from pathlib import Path

import pytest

import dh2urdf
from dh2urdf.errors import Dh2UrdfError


def _workbook() -> bytes:
    book = pytest.importorskip("openpyxl").Workbook()
    book.active.append(["a", "alpha", "d"])
    content = io.BytesIO()
    book.save(content)
    return content.getvalue()


def _parquet() -> bytes:
    arrow, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    content = io.BytesIO()
    parquet.write_table(arrow.table({"a": [0.0]}), content)
    return content.getvalue()


def _archive() -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr("arm.csv", "a,alpha,d\n")
    return content.getvalue()


KINDS = {
    "an Excel workbook": _workbook,
    "another zip archive": _archive,
    "a Parquet file": _parquet,
    "a PDF document": lambda: b"%PDF-1.4\n%\xac\xdc \xab\xba\n1 0 obj\n<< /Type /Catalog >>\nendobj\n",
    "a picture": lambda: b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR\x00\x00\x00\x01\x00\x00\x00\x01\x08\x06\x00\x00\x00",
    "a gzip archive": lambda: gzip.compress(b"a,alpha,d\n0,0,1\n"),
    "a pointer of Git LFS": lambda: b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12\n",
    "a page of the web": lambda: b"\n<!DOCTYPE html>\n<html><head><title>arm.csv at main</title></head></html>\n",
}


OWN = {(".xlsx", "an Excel workbook"), (".xlsx", "another zip archive"), (".parquet", "a Parquet file")}
ENDINGS = (".csv", ".yaml", ".xlsx", ".parquet", ".urdf", ".sdf", ".xml", ".urdf.xacro")


@pytest.mark.parametrize("ending", ENDINGS)
def test_what_a_file_is_is_said(tmp_path: Path, ending: str) -> None:
    """A byte that is no UTF-8, or a tag that is missing, is no help to a person who has renamed a file."""
    path = tmp_path / f"arm{ending}"
    for kind in KINDS.keys() - {kind for own, kind in OWN if own == ending}:
        path.write_bytes(KINDS[kind]())
        with pytest.raises(Dh2UrdfError) as caught:
            dh2urdf.read(path)
        assert kind in str(caught.value)


def test_a_run_file_is_no_other_file(tmp_path: Path) -> None:
    (tmp_path / "run.yaml").write_bytes(KINDS["a PDF document"]())
    with pytest.raises(Dh2UrdfError, match="a PDF document"):
        dh2urdf.run(tmp_path / "run.yaml")


def test_check_says_it_too(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_bytes(KINDS["a PDF document"]())
    (finding,) = dh2urdf.check(tmp_path / "arm.urdf").findings
    assert (finding.rule, "a PDF document" in finding.message) == ("not-xml", True)
