"""What a reader reports about the cells that a manipulator comes from; the manipulator is the one that is read without."""

from pathlib import Path
from typing import Any

import pytest

from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Traces
from dh2urdf.table_text import Trace
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.table import TableOptions

TABLES = sorted((Path(__file__).parents[3] / "configs" / "tables").iterdir())
CSV = """\
# convention: standard
# base: {xyz: [0, 0, 0.3]}
robot,joint,a [mm],alpha,d [mm],lower,upper
one,waist,0,90deg,300,-170 deg,3
one,elbow,250,0,,-1.5,1.5
two,waist,10,pi/2,20,,
"""


def read(path: Path) -> list[tuple[Any, Trace]]:
    """Every item of a file, with what its cells say."""
    reader = {".csv": stages.CSV, ".yaml": stages.YAML, ".parquet": stages.PARQUET}[path.suffix]
    traces = reader.can(Traces)
    trace = Trace()
    return [(item, trace.copy()) for item in traces.trace(path, TableOptions(), trace)]


@pytest.mark.parametrize("path", TABLES, ids=lambda path: path.name)
def test_the_manipulator_is_the_same(path: Path) -> None:
    """With a trace and without: to the last bit, marks and notices included; every row has one."""
    reader = stages.CSV if path.suffix == ".csv" else stages.YAML
    (plain,) = reader.read(path, TableOptions())
    ((item, trace),) = read(path)
    assert repr(item) == repr(plain)
    assert isinstance(item, Manipulator)
    assert len(trace.rows) == len(item.rows)
    assert trace.table["convention"].text == item.convention


def test_units_are_those_in_which_a_number_is_read(tmp_path: Path) -> None:
    """Of the header; empty where nothing says one; none where the cell names it, or is no number; nothing if empty."""
    (tmp_path / "arm.csv").write_text(CSV.replace(",-1.5,1.5", ",-1.5,1.5").replace("elbow,250,0,,", "elbow,250,0,0,"))
    (one, first), (two, second) = read(tmp_path / "arm.csv")
    assert (one.name, two.name) == ("one", "two")
    units = {name: said.unit for name, said in first.rows[0].items()}
    assert units == {"joint": None, "a": "mm", "alpha": None, "d": "mm", "lower": None, "upper": ""}
    assert set(second.rows[0]) == {"joint", "a", "alpha", "d"}
    assert str(first.table["base"].mark) == f"{tmp_path / 'arm.csv'}:2:9"


def test_a_rejected_manipulator_has_one_too(tmp_path: Path) -> None:
    """What was typed is known where it is wrong."""
    (tmp_path / "arm.csv").write_text(CSV)
    (one, first), _ = read(tmp_path / "arm.csv")
    assert not isinstance(one, Manipulator)
    assert first.rows[0]["a"].text == "0"


def test_reading_without_one_stays_fast(tmp_path: Path, fast: list[int]) -> None:
    """Without one, all but the model of the form are read fast; with a trace every row is read with care."""
    rows = "".join(f"arm{n},0.4,0,0.1\n" for n in range(2000))
    (tmp_path / "arms.csv").write_text(f"# convention: standard\nrobot,a,alpha,d\n{rows}")
    assert (len(list(stages.CSV.read(tmp_path / "arms.csv", TableOptions()))), sum(fast)) == (2000, 1999)
    assert (len(read(tmp_path / "arms.csv")), sum(fast)) == (2000, 1999)
