"""The bounds of what is read: nobody meets them with a real arm, and nothing beyond them costs time or memory.

Each is tried from both sides: just inside, the table is read; just outside, the message says what the bound is. That
the answer comes quickly is what the suite's own time limit is for; the sizes here would take hours, or all memory, if
the bounds did not hold.
"""

import csv as python_csv
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dh2urdf.documents.text_files import MAX_BYTES
from dh2urdf.errors import SCREENFUL, TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.rows.rows import MAX_PROBLEMS
from dh2urdf_plugins.readers.sources.delimited import MAX_LINE
from dh2urdf_plugins.readers.sources.texts import MAX_HEADER
from dh2urdf_plugins.readers.table import TableOptions
from dh2urdf_plugins.readers.words.bounds import MAX_COLUMNS, MAX_JOINTS

CSV, YAML = stages.CSV, stages.YAML
STANDARD = TableOptions(convention="standard")
CELL = python_csv.field_size_limit()
REFERENCE = Path(__file__).parent / "reference" / "inputs"


@pytest.fixture
def read(tmp_path: Path) -> Callable[..., Manipulator]:
    """The manipulator of a table of one; what is refused is raised."""

    def read_table(text: str, suffix: str = ".csv") -> Manipulator:
        path = tmp_path / f"arm{suffix}"
        path.write_text(text, "utf-8")
        (item,) = (CSV if suffix == ".csv" else YAML).read(path, STANDARD)
        if isinstance(item, Rejected):
            raise TableError(item.problems)
        return item

    return read_table


# --- Cells and lines --------------------------------------------------------------------------------------------------


def test_a_cell_of_any_length_that_is_left_out(read: Callable[..., Manipulator]) -> None:
    """A cell may have 131,072 characters, as in Python's own reader; one more is refused, also without quotes."""
    for quote in ('"', ""):
        assert read(f"a,alpha,d,comment\n1,0,0,{quote}{'x' * CELL}{quote}\n").rows[0].a == 1
        with pytest.raises(
            TableError, match=f"arm.csv:2: error: a cell is too long\n *accepted: at most {CELL} characters"
        ):
            read(f"a,alpha,d,comment\n1,0,0,{quote}{'x' * (CELL + 1)}{quote}\n")


def test_a_line_has_a_million_characters(read: Callable[..., Manipulator]) -> None:
    """A file without line ends is not held as one line."""
    cells = ["x" * 100_000] * 10
    header = ",".join(f"c{k}" for k in range(10))
    assert read(f"a,alpha,d,{header}\n1,0,0,{','.join(cells)}\n").rows[0].a == 1
    with pytest.raises(TableError, match=f"arm.csv:2: error: a line has more than {MAX_LINE} characters"):
        read(f"a,alpha,d,{header}\n1,0,0,{','.join([*cells, *cells])}\n")


def test_a_header_has_a_thousand_columns(read: Callable[..., Manipulator]) -> None:
    """Hundreds of columns that nothing is called are left out, with one notice; more are refused, and a long header."""
    columns = MAX_COLUMNS - len(("a", "alpha", "d"))
    (notice,) = read(f"a,alpha,d{',comment' * columns}\n1,0,0{',x' * columns}\n").notices
    assert notice.code == "columns-left-out"
    with pytest.raises(TableError, match=r"the header has 1,001 columns\n *accepted: at most 1,000 columns"):
        read(f"a,alpha,d{',comment' * (columns + 1)}\n1,0,0{',' * (columns + 1)}\n")
    with pytest.raises(TableError, match=f"at most {MAX_HEADER} characters"):
        read(f"a,alpha,d{',' * MAX_HEADER}\n1,0,0\n")


@pytest.mark.parametrize("suffix", [".yaml", ".json"])
def test_a_file_that_is_read_at_once_has_a_gibibyte(tmp_path: Path, suffix: str) -> None:
    """A larger one is refused by its size, unread."""
    path = tmp_path / f"arm{suffix}"
    with path.open("wb") as file:
        file.truncate(MAX_BYTES + 1)  # a sparse file: nothing is written
    with pytest.raises(TableError, match="the file has 1024 MiB, too much to be read at once"):
        list(YAML.read(path, STANDARD))


# --- Joints, problems, sizes ------------------------------------------------------------------------------------------

ROW = {".csv": "0.01,pi/2,0.01\n", ".yaml": "- {a: 0.01, alpha: pi/2, d: 0.01}\n"}
TOP = {".csv": "a,alpha,d\n", ".yaml": "joints:\n"}


@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_a_manipulator_has_five_thousand_joints(read: Callable[..., Manipulator], suffix: str) -> None:
    """One more is refused, and 200,000 are refused as quickly: they are counted, not held."""
    assert len(read(TOP[suffix] + ROW[suffix] * MAX_JOINTS, suffix).rows) == MAX_JOINTS
    for count in (MAX_JOINTS + 1, 200_000):
        with pytest.raises(TableError, match="accepted: at most 5,000 ") as caught:
            read(TOP[suffix] + ROW[suffix] * count, suffix)
        assert len(caught.value.problems) == 1


def test_a_manipulator_with_too_many_joints_fails_alone(tmp_path: Path) -> None:
    """The others of a CSV file are read, before and behind it."""
    rows = ["one,1,0,0", *["long,1,0,0"] * (MAX_JOINTS + 1), "two,2,0,0"]
    path = tmp_path / "arms.csv"
    path.write_text("robot,a,alpha,d\n" + "\n".join(rows))
    items = list(CSV.read(path, STANDARD))
    assert [(item.name, type(item)) for item in items] == [
        ("one", Manipulator),
        ("long", Rejected),
        ("two", Manipulator),
    ]


@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_a_thousand_problems_are_collected_and_a_screenful_is_printed(
    read: Callable[..., Manipulator], suffix: str
) -> None:
    """Reading a hopeless table stops, and the message fits a screen."""
    bad = {".csv": "x,y,z\n", ".yaml": "- {a: x, alpha: y, d: z}\n"}[suffix]
    with pytest.raises(TableError) as caught:
        read(TOP[suffix] + bad * MAX_JOINTS, suffix)
    assert MAX_PROBLEMS <= len(caught.value.problems) <= MAX_PROBLEMS + 10
    heads = [line for line in str(caught.value).splitlines() if ": error: " in line]
    assert len(heads) == SCREENFUL
    assert str(caught.value).endswith(f"and {len(caught.value.problems) - SCREENFUL} more problems")


# --- A thousand axes, all the way -------------------------------------------------------------------------------------


@pytest.mark.long
def test_a_thousand_axes_go_all_the_way(cli: Any, tmp_path: Path, tool0_of: Any) -> None:
    """A snake of a thousand joints becomes URDF and xacro, both proved, and the URDF's tool0 is the table's."""
    expected = next(
        case for case in json.loads((REFERENCE / "expected.json").read_text("utf-8")) if case["file"] == "axes_1000.csv"
    )
    shutil.copy(REFERENCE / "axes_1000.csv", tmp_path / "snake.csv")
    (tmp_path / "run.yaml").write_text(
        f"inputs: [{{path: snake.csv, options: {{convention: {expected['convention']}}}}}]\n"
        "emitters: [urdf, xacro]\noutput: {directory: out}\nproof: {poses: 1}\n"
    )
    (arm,) = json.loads(cli("run", "run.yaml", "--json").stdout)["manipulators"]
    assert (arm["status"], len(expected["rows"])) == ("ok", 1000)
    assert all(arm["proof"][form]["position_error"] < 1e-9 for form in ("urdf", "xacro"))
    found = tool0_of(tmp_path / "out" / "snake.urdf")(expected["q"])
    assert np.abs(found - np.array(expected["T_ee"])).max() < 1e-9
