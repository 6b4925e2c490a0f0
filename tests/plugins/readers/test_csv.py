import gc
import io
import warnings
from collections.abc import Callable
from itertools import islice
from pathlib import Path

import pytest

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.stages import CSV
from dh2urdf_plugins.readers.table import TableOptions

STANDARD = TableOptions(convention="standard")
HEADER = "joint,type,a,alpha,d,theta\n"
ROWS = "j1,revolute,0,pi/2,0.1,0\nj2,prismatic,0.4,0,q2,0\n"


@pytest.mark.long
def test_each_manipulator_of_a_file_is_yielded_as_it_is_read(tmp_path: Path) -> None:
    """The first of many comes before the file has been read to its end: here it ends in a broken quote."""
    path = tmp_path / "arms.csv"
    rows = "".join(f"r{robot},{joint}.5,0,{robot}\n" for robot in range(6000) for joint in range(6))
    path.write_text(f'robot,a,alpha,d\n{rows}r6000,"1,0,0\n')
    arms = CSV.read(path, STANDARD)
    assert [arm.name for arm in islice(arms, 100)] == [f"r{robot}" for robot in range(100)]
    with pytest.raises(TableError, match=r"arms.csv:36002:7: error: a cell opens with a quote that is not closed"):
        list(arms)


def test_a_manipulator_may_be_longer_than_a_block(read_one: Callable[..., Manipulator]) -> None:
    """5,000 joints are read, across many blocks of the file, with the line of each."""
    arm = read_one("a,alpha,d\n" + "0.001,pi/2,0\n" * 5_000)
    assert len(arm.rows) == 5_000
    assert [row.mark.line for row in arm.rows if row.mark] == list(range(2, 5_002))
    assert arm.rows[-1].joint == "joint_5000"


def test_a_bad_manipulator_fails_alone(read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """The others of the file are read, before and behind it."""
    arms = read("robot,a,alpha,d\nA,0,0,1\nB,0,x,1\nB,y,0,1\nC,0,0,2\n", convention="standard")
    assert [type(arm) for arm in arms] == [Manipulator, Rejected, Manipulator]
    assert isinstance(arms[1], Rejected)
    assert [str(problem.mark) for problem in arms[1].problems] == ["arm.csv:3:5", "arm.csv:4:3"]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_an_encoding_is_recognised(read_one: Callable[..., Manipulator], encoding: str, end: str) -> None:
    """UTF-8, and UTF-16 with its byte order mark, any line ends, letters beyond ASCII."""
    arm = read_one((HEADER + ROWS).replace("j1", "Grün").replace("\n", end).encode(encoding))
    assert [row.joint for row in arm.rows] == ["Grün", "j2"]


def test_the_columns_of_a_message_are_those_of_the_line(read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """Quotes, spaces and letters of other scripts before the cell are counted as a person counts them."""
    (arm,) = read('joint,type,a,alpha,d\n"é, ""x""", R ,  abc,0,1\n', convention="standard")
    assert isinstance(arm, Rejected)
    assert str(arm.problems[0].mark) == "arm.csv:2:18"


def test_all_problems_of_a_table_come_at_once_in_the_order_of_the_file(
    read: Callable[..., list[Manipulator | Rejected]],
) -> None:
    """A person fixes the table once, not once for each cell."""
    (arm,) = read("joint,type,a,alpha,d,lower\nj1,X,b,90,,1\nj1,R,0,0,1,2\n\n,R,0,0,1,\n", convention="standard")
    assert isinstance(arm, Rejected)
    marks = [(problem.mark.line or 0, problem.mark.column or 0) for problem in arm.problems if problem.mark]
    assert marks == sorted(marks)
    assert {problem.field for problem in arm.problems} >= {"type", "a", "alpha", "d", "upper", "joint"}


def test_reading_a_hopeless_table_stops(read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """A thousand problems are enough to know that the table is not one."""
    (arm,) = read("a,alpha,d\n" + "x,y,z\n" * 5000, convention="standard")
    assert isinstance(arm, Rejected)
    assert 1000 <= len(arm.problems) <= 1010
    assert "stopped after" in arm.problems[-1].message


@pytest.mark.parametrize(
    "content",
    ["a,alpha,d\n" + "0" * 2**21, "x" * 2**21, 'a,alpha,d\n"' + "0,0\n" * 100_000, "x\n" * 1001 + "a,alpha,d\n0,0,1\n"],
)
def test_a_line_or_cell_without_end_is_refused(read: Callable[..., list[Manipulator | Rejected]], content: str) -> None:
    """A file is read in blocks; what does not fit one is no table, nor is what has no header for a thousand lines."""
    with pytest.raises(TableError):
        read(content, convention="standard")


def test_a_reader_that_is_left_closes_its_file(tmp_path: Path) -> None:
    """A run that is interrupted leaves no file open."""
    path = tmp_path / "arms.csv"
    path.write_text("robot,a,alpha,d\n" + "".join(f"r{robot},0,0,1\n" for robot in range(5000)))
    arms = CSV.read(path, STANDARD)
    next(arms)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        del arms
        gc.collect()
    path.unlink()
    assert not [file for file in gc.get_objects() if isinstance(file, io.BufferedReader) and file.name == str(path)]
