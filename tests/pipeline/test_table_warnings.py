"""In Python, what a careful person would look at is a warning: `dh2urdf.TableWarning`, once each, at the caller's line."""

import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import dh2urdf
from dh2urdf.source import Mark

IN_MM = np.array([[0, 0, 0, 340], [-np.pi / 2, 0, 0, 0], [np.pi / 2, 0, 0, 400]])
HOW: dict[str, Any] = {"columns": ["alpha", "a", "theta", "d"], "convention": "modified"}
LONG = "# convention: standard\na, alpha, d, mass\n400, 0, 1.5, 2\n300, 0, 0, 3\n"
"""An arm of 700 m."""
FILE = Path(__file__).name


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "long.csv"
    path.write_text(LONG)
    return path


def told(call: Callable[[], Any]) -> tuple[Any, list[warnings.WarningMessage]]:
    """What a call gives, and all that it warns of."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        given = call()
    assert all(each.category is dh2urdf.TableWarning and Path(each.filename).name == FILE for each in found)
    return given, found


def texts(found: list[warnings.WarningMessage]) -> list[str]:
    return [str(each.message) for each in found]


def test_of_an_array() -> None:
    """An arm of 740 m is none in silence, and the line of the caller is named."""
    arm, found = told(lambda: dh2urdf.Manipulator.from_dh(IN_MM, **HOW))
    assert texts(found) == [str(notice) for notice in arm.notices]
    assert len(found) == 1
    line = Path(__file__).read_text("utf-8").splitlines()[found[0].lineno - 1]
    assert "Manipulator.from_dh(IN_MM" in line


def test_of_a_file(table: Path) -> None:
    """`read` warns of what it noticed; `read_all` gives it with each manipulator."""
    arm, found = told(lambda: dh2urdf.read(table))
    assert texts(found) == [str(notice) for notice in arm.notices] != []
    (again,), silent = told(lambda: list(dh2urdf.read_all(table)))
    assert (again.notices, silent) == (arm.notices, [])


def test_of_a_conversion(table: Path) -> None:
    """Of a file all notices; of a manipulator those of the robot only: the others were reported with it."""
    made, found = told(lambda: dh2urdf.convert(table))
    assert texts(found) == list(dict.fromkeys(map(str, made.notices)))
    assert {str(notice) for notice in made.manipulator.notices} <= set(texts(found))
    arm, first = told(lambda: dh2urdf.read(table))
    again, second = told(lambda: dh2urdf.convert(arm))
    assert texts(second) == list(dict.fromkeys(map(str, again.robot.notices)))
    assert sorted(texts(first) + texts(second)) == sorted(texts(found))


def test_a_script_prints_them_once(tmp_path: Path) -> None:
    """With its own line, and without a filter."""
    script = tmp_path / "script.py"
    script.write_text(
        "import dh2urdf\nimport numpy as np\n"
        f"arm = dh2urdf.Manipulator.from_dh(np.array({IN_MM.tolist()}), **{HOW!r})\n"
        "dh2urdf.convert(arm, 'arm.urdf')\n"
    )
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stderr.count("740 m") == 1
    assert "script.py:3: TableWarning" in done.stderr


READER = """
from dh2urdf.hookspecs import hookimpl
from dh2urdf.manipulator import Manipulator
from dh2urdf.source import Mark
from dh2urdf.stages import NoOptions, Reader

def read(path, options):
    rows = [dict(zip(("a", "alpha", "d"), line.split())) for line in path.read_text().splitlines()]
    yield Manipulator.from_dh(rows, convention="standard", file=path, mark=Mark(file=str(path), line=1))

@hookimpl
def dh2urdf_readers():
    return [Reader(name="words", summary="s", read=read, options=NoOptions, suffixes=(".words",))]
"""
"""A reader of a plugin that calls `from_dh`."""


class TestReaderOfAPlugin:
    @pytest.fixture
    def words(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, install: Callable[..., None]) -> Path:
        install(tmp_path / "site", "lab", READER)
        monkeypatch.syspath_prepend(tmp_path / "site")
        monkeypatch.delitem(sys.modules, "lab_lab", raising=False)
        path = tmp_path / "long.words"
        path.write_text("400 0 1.5\n300 pi/2 0\n")
        return path

    def test_its_reader_is_silent(self, words: Path) -> None:
        """Who calls the reader gets the notices with the manipulator, and warns of them once."""
        arm, found = told(lambda: dh2urdf.read(words))
        assert texts(found) == [str(notice) for notice in arm.notices]
        assert len(found) == 1
        assert str(found[0].message).startswith(f"{words}:line 1, row 1: notice: ")


def test_the_place_of_a_table() -> None:
    """`file` alone, `mark` alone, and what is none."""
    rows = [{"a": 0.4, "alpha": "ninety", "d": 0.1}]

    for how, place in (
        ({"file": Path("lab/arm.json")}, "lab/arm.json:row 1, column alpha: error"),
        ({"mark": Mark(file="arms.jsonl", line=7)}, "arms.jsonl:line 7, row 1, column alpha: error"),
        ({}, r"Manipulator.from_dh\(\):row 1, column alpha: error"),
    ):
        with pytest.raises(dh2urdf.errors.TableError, match=place):
            dh2urdf.Manipulator.from_dh(rows, convention="standard", **how)  # type: ignore[arg-type]
    given = Mark(file="arms.jsonl", line=7)
    arm = dh2urdf.Manipulator.from_dh([{"a": 0.4, "alpha": 0, "d": 0.1}], convention="standard", mark=given)
    assert arm.mark is not None
    assert (arm.mark.file, arm.mark.line) == ("arms.jsonl", 7)
