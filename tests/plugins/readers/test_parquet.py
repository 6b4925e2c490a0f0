import csv as python_csv
import io
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from decimal import Decimal
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import assume, given, settings, strategies as st
from pyarrow import parquet as pq

from dh2urdf.errors import Dh2UrdfError, MissingDependencyError, TableError
from dh2urdf.manipulator import Convention, Inertia, Manipulator, Payload
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.plain.rows import PlainRows
from dh2urdf_plugins.readers.table import TableOptions
from reference_arms import ReferenceRobot

Items = list[Manipulator | Rejected]
Column = list[Any]
STANDARD = TableOptions(convention="standard")
RADIANS = {"a": [0.5], "alpha": [0.0], "d": [0.25]}


def table_of(columns: dict[str, Any], **statements: str) -> Any:
    metadata = {f"dh2urdf.{key}": text for key, text in statements.items()}
    return pa.table(columns).replace_schema_metadata(metadata)


@pytest.fixture
def read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Items]:
    """Reads a table that is given as columns; the file is called `arm.parquet`, in the test's folder."""
    monkeypatch.chdir(tmp_path)

    def read_table(columns: dict[str, Any], options: TableOptions = STANDARD, **statements: str) -> Items:
        pq.write_table(table_of(columns, **statements), "arm.parquet")
        return list(stages.PARQUET.read(Path("arm.parquet"), options))

    return read_table


@pytest.fixture
def read_one(read: Callable[..., Items]) -> Callable[..., Manipulator]:
    """Reads a table of one manipulator, which must be accepted."""

    def read_table(columns: dict[str, Any], **statements: str) -> Manipulator:
        (arm,) = read(columns, **statements)
        assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
        return arm

    return read_table


@pytest.fixture
def refusal(read: Callable[..., Items]) -> Callable[..., str]:
    """What is said of a table that is refused, as a whole or one manipulator of it."""

    def read_table(columns: dict[str, Any], **statements: str) -> str:
        try:
            items = read(columns, **statements)
        except TableError as error:
            return str(error)
        return "\n".join(str(problem) for item in items if isinstance(item, Rejected) for problem in item.problems)

    return read_table


# --- The same table as CSV --------------------------------------------------------------------------------------------


def columns_of(text: str, *, numbers: bool) -> tuple[dict[str, Column], dict[str, str]]:
    """The columns of a CSV table, and what its comment lines say; columns of numbers alone as doubles, if asked for."""
    lines = text.splitlines()
    comments = [line[1:].partition(":") for line in lines if line.startswith("#")]
    header, *rows = python_csv.reader(line for line in lines if not line.startswith("#"))
    columns: dict[str, Column] = dict(zip(header, map(list, zip(*rows, strict=True)), strict=True))
    for name, cells in columns.items():
        if numbers and name not in ("joint", "link"):
            with suppress(ValueError):
                columns[name] = [float(cell) if cell else None for cell in cells]
    return columns, {key.strip(): value.strip() for key, _, value in comments}


@pytest.mark.parametrize("units", [("m", "rad"), ("mm", "deg")], ids=" ".join)
@pytest.mark.parametrize("numbers", [True, False], ids=["numbers", "texts"])
def test_a_published_robot_is_the_same_arm_as_from_csv(
    reference_robot: ReferenceRobot,
    as_table: Callable[..., str],
    tmp_path: Path,
    units: tuple[str, str],
    numbers: bool,  # noqa: FBT001 - a parameter
) -> None:
    """To the last bit and with the same notices, whether the columns hold numbers or texts."""
    text = as_table(reference_robot.manipulator, "csv", units=units)
    (tmp_path / "arm.csv").write_text(text, "utf-8")
    columns, statements = columns_of(text, numbers=numbers)
    pq.write_table(table_of(columns, **statements), tmp_path / "arm.parquet")
    (expected,) = stages.CSV.read(tmp_path / "arm.csv", TableOptions())
    (arm,) = stages.PARQUET.read(tmp_path / "arm.parquet", TableOptions())
    assert isinstance(expected, Manipulator)
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    assert arm == expected
    assert [notice.message for notice in arm.notices] == [notice.message for notice in expected.notices]


def text_of(value: float | str | None) -> str:
    return "" if value is None else value if isinstance(value, str) else repr(value).removesuffix(".0")


plain = st.floats(-1.5, 1.5) | st.sampled_from([0.0, -0.0, 1.5707963267948966, 1.0, 1e-7, 90.0])
odd = plain | st.none() | st.sampled_from([float("nan"), float("inf"), 400.0, 1.57, 1e300])
expressions = st.sampled_from(["pi/2", "-90deg", "0.1 + 0.02", "", "x", "1,5", "50 mm", "nan", "1_0", "q1", "-0"])
HEADERS = {
    "a": ("a", "a [mm]"),
    "alpha": ("alpha", "alpha [deg]"),
    "d": ("d", "d [cm]"),
    "theta": ("theta", "theta [deg]"),
    "offset": ("offset", "offset [deg]"),
    "mass": ("mass",),
    "velocity": ("velocity", "velocity [deg/s]"),
}


@st.composite
def tables(draw: st.DrawFn) -> dict[str, Column]:
    """Some manipulators, in columns of numbers, of numbers with gaps, and of texts."""
    sizes = draw(st.lists(st.integers(1, 4), min_size=1, max_size=4))
    count = sum(sizes)
    names = ["a", "alpha", "d", *draw(st.lists(st.sampled_from(["theta", "offset", "mass", "velocity"]), unique=True))]
    columns: dict[str, Column] = {"robot": [f"r{robot}" for robot, size in enumerate(sizes) for _ in range(size)]}
    if draw(st.booleans()):
        columns["type"] = draw(st.lists(st.sampled_from(["R", "P", "fixed"]), min_size=count, max_size=count))
    for name in names:
        cells = draw(st.sampled_from([plain, plain, plain, odd, expressions, st.integers(-3, 3)]))
        columns[draw(st.sampled_from(HEADERS[name]))] = draw(st.lists(cells, min_size=count, max_size=count))
    return columns


def everything(items: Iterable[Manipulator | Rejected]) -> list[Any]:
    """The manipulators and what is said of them, without its places."""
    found: list[Any] = []
    for item in items:
        problems = item.notices if isinstance(item, Manipulator) else item.problems
        what = item if isinstance(item, Manipulator) else item.name
        found.append((what, sorted(repr(replace(problem, mark=None)) for problem in problems)))
    return found


def lines_of(items: Iterable[Manipulator | Rejected]) -> list[int | None]:
    marks = [row.mark for item in items if isinstance(item, Manipulator) for row in item.rows]
    return [mark.line for mark in marks if mark]


@pytest.mark.long
@given(tables())
@settings(max_examples=300, deadline=None)
def test_numbers_are_read_as_their_texts_are(columns: dict[str, Column]) -> None:
    """Every manipulator, notice and error is that of the CSV file with the same numbers, on the fast way and without it."""
    texts = [text_of(value) for column in columns.values() for value in column]
    # Beside `1,5` the text 1.125 may be a thousand and is refused; the number 1.125 is none, and is read.
    assume("1,5" not in texts or not any(re.fullmatch(r"-?[0-9]{1,3}\.[0-9]{3}", text) for text in texts))
    with TemporaryDirectory() as folder:
        path = Path(folder) / "arm.csv"
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = python_csv.writer(file)
            writer.writerows([list(columns), *(map(text_of, row) for row in zip(*columns.values(), strict=True))])
        expected = list(stages.CSV.read(path, STANDARD))
        pq.write_table(pa.table(columns), path.with_suffix(".parquet"))
        fast = list(stages.PARQUET.read(path.with_suffix(".parquet"), STANDARD))
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(PlainRows, "read", lambda *_arguments: None)
            careful = list(stages.PARQUET.read(path.with_suffix(".parquet"), STANDARD))
    assert lines_of(fast) == lines_of(careful)
    assert everything(fast) == everything(careful) == everything(expected)


def test_plain_tables_go_the_fast_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Numbers in foreign units, gaps in the limits and words of few kinds are no reason to go slowly."""
    count = 6 * 500
    columns = {
        "robot": [k // 6 for k in range(count)],
        "i": [k % 6 + 1 for k in range(count)],
        "type": pa.array(["revolute"] * count).dictionary_encode(),
        "a [mm]": [100 + k / 7 for k in range(count)],
        "alpha [deg]": [90] * count,
        "d": [25.0] * count,
        "theta [rad]": ["pi/2", "0"] * (count // 2),
        "lower [rad]": [-1.5 if k % 6 else None for k in range(count)],
        "upper [rad]": [1.5 if k % 6 else None for k in range(count)],
    }
    pq.write_table(pa.table(columns), tmp_path / "arms.parquet")
    fast = PlainRows.read
    refused: list[int] = []

    def counted(self: PlainRows, groups: Any) -> Any:
        result = fast(self, groups)
        refused.extend([] if result else [len(groups)])
        return result

    monkeypatch.setattr(PlainRows, "read", counted)
    arms = list(stages.PARQUET.read(tmp_path / "arms.parquet", TableOptions(convention="standard", length_unit="mm")))
    assert ([arm.name for arm in arms], refused) == ([str(robot) for robot in range(500)], [])


# --- Columns ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("cells", "kind", "number"),
    [
        ([2**63], pa.uint64(), 2.0**63),
        ([0.1], pa.float32(), 0.10000000149011612),
        ([Decimal("0.10")], pa.decimal128(10, 2), 0.1),
        (["1/10"], pa.dictionary(pa.int8(), pa.string()), 0.1),
    ],
    ids=str,
)
def test_numbers_of_all_kinds(read_one: Callable[..., Manipulator], cells: Column, kind: Any, number: float) -> None:
    """Whole numbers, short floats to their last bit, decimals, and texts of all codings."""
    arm = read_one({**RADIANS, "effort": pa.array(cells, kind)})
    assert arm.rows[0].limits.effort == number


def test_words_may_be_numbers(read: Callable[..., Items]) -> None:
    """A whole number is a name, also in a column of floats that gaps have made one; truth values are words."""
    columns = {
        "robot": [7.0, 7.0, 8.5],
        "joint": [1, 2, 3],
        "sigma": [0, 1, 0],
        "flip": [True, False, None],
        **{name: cells * 3 for name, cells in RADIANS.items()},
    }
    first, second = read(columns)
    assert isinstance(first, Manipulator)
    assert (first.name, second.name) == ("7", "8.5")
    assert [(row.joint, row.type.value, row.sign) for row in first.rows] == [
        ("joint_1", "revolute", -1),
        ("joint_2", "prismatic", 1),
    ]


# --- What is said of all rows -----------------------------------------------------------------------------------------


def test_metadata_say_what_columns_cannot(tmp_path: Path) -> None:
    """Each comment line of a CSV table has a key, and other people's keys are left alone."""
    statements = {
        "name": "gantry",
        "convention": "Craig",
        "units": "{length: mm, angle: deg}",
        "base": "{xyz: [0, 0, 300], rpy: [0, 0, 90]}",
        "tool": "{xyz: [0, 0, 10]}",
        "payload": "{mass: 2, com: [0, 0, 50], inertia: {ixx: 1 kg·m², iyy: 1 kg·m², izz: 1 kg·m²}}",
        "defaults": "{geometry: {shape: box, radius: 40}, density: 1000}",
    }
    table = table_of({"a": [100], "alpha": [90], "d": [50.5]}, **statements)
    pq.write_table(table.replace_schema_metadata({**table.schema.metadata, "pandas": "{}"}), tmp_path / "arm.parquet")
    (arm,) = stages.PARQUET.read(tmp_path / "arm.parquet", TableOptions())
    assert isinstance(arm, Manipulator)
    assert (arm.name, arm.convention, arm.rows[0].a, arm.rows[0].d) == ("gantry", Convention.MODIFIED, 0.1, 0.0505)
    assert (arm.base.translation, arm.base.rotation[:3]) == ((0.0, 0.0, 0.3), (0.0, -1.0, 0.0))
    assert arm.tool.translation == (0.0, 0.0, 0.01)
    assert arm.payload == Payload(mass=2.0, com=(0.0, 0.0, 0.05), inertia=Inertia(ixx=1.0, iyy=1.0, izz=1.0))
    assert (arm.geometry.shape, arm.geometry.radius, arm.density) == ("box", 0.04, 1000.0)


# --- Refusals ---------------------------------------------------------------------------------------------------------

TWO = {"joint": ["j1", "j2"], "a": [0.5, 0.25], "alpha": [0.0, 0.0], "d": [0.0, 0.5]}


def of(field: str) -> str:
    return f"arm.parquet:row 2, column {field}: error: joint 'j2', field '{field}': "


NOTHING = "    accepted: a number, 0 included: nothing is filled in for geometry"


@pytest.mark.parametrize(
    ("columns", "said"),
    [({"a": [0.5, None]}, of("a") + f"a is empty\n{NOTHING}"), ({"a": [0.5, float("nan")]}, of("a") + "'nan' "), ({"d": ["0", "1,5,0"]}, of("d") + "'1,5,0' cannot be read"), ({"mu": [0.0, 0.5]}, "'mu' is whether a joint is driven, in Khalil and Kleinfinger's convention, which no column holds, and it is '0.5'"), ({"a [mm]": [0, 0]}, "two columns are a: 'a' and 'a [mm]' (a duplicate)"), ({"a": pa.array([1, 2], pa.timestamp("ms"))}, "field 'a': the column 'a' holds timestamp[ms]\n    accepted: numbers or text"), ({"a": [[0.5], [0.25]]}, "field 'a': the column 'a' holds list<element: double>")],
)  # fmt: skip
def test_a_message_names_the_row(refusal: Callable[..., str], columns: dict[str, Any], said: str) -> None:
    """File, row, joint, field, what was found, what is accepted: with the row where a CSV file has a line."""
    assert said in refusal({**TWO, **columns})


# --- Many manipulators ------------------------------------------------------------------------------------------------


def robots(names: list[str | None], **columns: Column) -> dict[str, Column]:
    count = len(names)
    return {"robot": names, "a": [0.1] * count, "alpha": [0.0] * count, "d": [0.0] * count, **columns}


@pytest.mark.parametrize("gap", [1, 20_000])
def test_a_manipulator_whose_rows_return_is_refused(read: Callable[..., Items], gap: int) -> None:
    """Two halves of an arm are never two arms; far behind, at least the second half is refused."""
    arms = read(robots(["A", *(f"B{number}" for number in range(gap)), "A"]))
    assert isinstance(arms[-1], Rejected)
    assert "rows of 'A' are in several places" in str(arms[-1].problems[0])
    assert isinstance(arms[0], Rejected) is (gap == 1)
    assert len(arms) == gap + 2


def test_a_manipulator_may_be_longer_than_a_batch(read_one: Callable[..., Manipulator]) -> None:
    """5,000 joints are read, with the row of each."""
    arm = read_one({"a": [0.001] * 5000, "alpha": [0.0] * 5000, "d": [0.0] * 5000})
    assert [row.mark.line for row in arm.rows if row.mark] == list(range(1, 5001))


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of 50,000 manipulators that all differ, in a single row group."""
    path = tmp_path_factory.mktemp("large") / "arms.parquet"
    count = 300_000
    columns = {name: pa.array([(k * step % 1009) / 1009 + k * 1e-9 for k in range(count)]) for name, step in STEPS}
    pq.write_table(pa.table({"robot": [k // 6 for k in range(count)], **columns}), path, **ONE_GROUP_OF_SMALL_PAGES)
    return path


ONE_GROUP_OF_SMALL_PAGES = {"row_group_size": 300_000, "data_page_size": 2**16, "use_dictionary": False}
STEPS = (("a", 613), ("alpha", 127), ("d", 991))


@pytest.mark.long
def test_rows_are_read_as_they_are_asked_for(large: Path) -> None:
    """Of a row group of several megabytes, a fraction is in memory at any time."""
    before, most, count = pa.total_allocated_bytes(), 0, 0
    for arm in stages.PARQUET.read(large, STANDARD):
        count += isinstance(arm, Manipulator)
        if count % 100 == 0:
            most = max(most, pa.total_allocated_bytes() - before)
    assert count == 50_000
    assert 0 < most < large.stat().st_size / 4


@pytest.mark.long
def test_what_stands_before_a_fault_is_read(large: Path, tmp_path: Path) -> None:
    """Manipulators come before the file has been read to its end; the fault is an error that names the row."""
    content = bytearray(large.read_bytes())
    start = pq.ParquetFile(large).metadata.row_group(0).column(1).data_page_offset
    content[start + 2**20 : start + 2**20 + 2**18] = bytes(2**18)
    (tmp_path / "arms.parquet").write_bytes(content)
    arms = stages.PARQUET.read(tmp_path / "arms.parquet", STANDARD)
    assert [arm.name for arm in islice(arms, 1000)] == [str(robot) for robot in range(1000)]
    with pytest.raises(TableError, match=r"arms.parquet:row \d{4,}: error: the file is broken from here on: ."):
        list(arms)


# --- The file ---------------------------------------------------------------------------------------------------------


def whole_file() -> bytes:
    content = io.BytesIO()
    pq.write_table(pa.table(RADIANS), content)
    return content.getvalue()


@pytest.mark.parametrize("content", [b"", b"a,alpha,d\n0,0,1\n", whole_file()[:-10]])
def test_what_is_no_parquet_file_is_refused(tmp_path: Path, content: bytes) -> None:
    """Nothing, another format, half a file: one line that says so."""
    (tmp_path / "arm.parquet").write_bytes(content)
    with pytest.raises(TableError, match=r"arm.parquet: error: this is no Parquet file that can be read: .*\n.*whole"):
        list(stages.PARQUET.read(tmp_path / "arm.parquet", STANDARD))


def test_pyarrow_is_asked_for_where_it_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message is the command that installs it."""
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(MissingDependencyError) as caught:
        list(stages.PARQUET.read(tmp_path / "arm.parquet", STANDARD))
    assert str(caught.value) == f"reader 'parquet' needs pyarrow: {sys.executable} -m pip install 'dh2urdf[parquet]'"


def test_a_reader_that_is_left_closes_its_file(large: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that is interrupted leaves no file open."""
    opened: list[Any] = []
    real = Path.open

    def noting(self: Path, *arguments: Any, **options: Any) -> Any:
        opened.append(real(self, *arguments, **options))
        return opened[-1]

    monkeypatch.setattr(Path, "open", noting)
    arms: Iterator[Manipulator | Rejected] = stages.PARQUET.read(large, STANDARD)
    next(arms)
    arms.close()  # type: ignore[attr-defined]
    assert opened
    assert all(file.closed for file in opened)


# --- Kinds of columns -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("numbers", "said"), [([0.5, 0.25], None), ([0.5, None], "d is empty"), ([0.5, float("nan")], "'nan'")]
)
def test_a_dictionary_of_numbers_holds_numbers(read: Callable[..., Items], numbers: Column, said: str | None) -> None:
    """As pandas writes a categorical column: what is missing or no number is not lost."""
    (arm,) = read({"a": [0.0] * 2, "alpha": [0.0] * 2, "d": pa.array(numbers, pa.float64()).dictionary_encode()})
    if said is None:
        assert isinstance(arm, Manipulator)
        assert [row.d for row in arm.rows] == numbers
    else:
        assert isinstance(arm, Rejected)
        assert said in str(arm.problems[0])


def with_metadata(**units: dict[str, str]) -> Any:
    fields = [pa.field(name, pa.float64(), metadata=units.get(name.split()[0])) for name in ("a", "alpha", "d [mm]")]
    return pa.table([pa.array([100.0]), pa.array([90.0]), pa.array([50.0])], schema=pa.schema(fields))


@pytest.mark.parametrize("key", ["unit", "units", "Unit"])
def test_the_metadata_of_a_column_have_its_unit(tmp_path: Path, key: str) -> None:
    """Under the keys that other programs write."""
    table = with_metadata(a={key: "mm", "long_name": "link length"}, alpha={key: "deg"}, d={key: "mm"})
    pq.write_table(table, tmp_path / "arm.parquet")
    (arm,) = stages.PARQUET.read(tmp_path / "arm.parquet", STANDARD)
    assert isinstance(arm, Manipulator)
    (row,) = arm.rows
    assert (row.a, row.alpha, row.d) == (0.1, 1.5707963267948966, 0.05)
    assert arm.notices == ()


@pytest.mark.parametrize(
    ("units", "said"),
    [
        ({"d": {"unit": "cm"}}, "column 'd [mm]' say 'cm' and 'mm'"),
        ({"a": {"unit": "cm", "units": "mm"}}, "column 'a' say 'cm' and 'mm'"),
        ({"a": {"unit": "lightyears"}}, "column a: error: "),
    ],
)  # fmt: skip
def test_units_that_contradict_or_mean_nothing_are_refused(
    tmp_path: Path, units: dict[str, dict[str, str]], said: str
) -> None:
    """The message names the column."""
    pq.write_table(with_metadata(**units), tmp_path / "arm.parquet")
    with pytest.raises(TableError) as caught:
        list(stages.PARQUET.read(tmp_path / "arm.parquet", STANDARD))
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("kind", "value"), [(pa.timestamp("us"), 1), (pa.struct([("x", pa.float64())]), {"x": 0.5}), (pa.binary(), b"0.5")]
)
def test_columns_of_other_kinds_are_refused_where_they_are_read(
    refusal: Callable[..., str], read_one: Callable[..., Manipulator], kind: Any, value: Any
) -> None:
    """With the column and its field; one that no field is called is no matter."""
    cells = pa.array([value], kind)
    assert f"arm.parquet:column theta: error: field 'theta': the column 'theta' holds {kind}" in refusal(
        {**RADIANS, "theta": cells}
    )
    assert read_one({**RADIANS, "remark": cells}).rows[0].d == 0.25


@pytest.mark.parametrize("number", [2**53 + 1, -(2**63)])
def test_whole_numbers_beyond_doubles_are_exact_as_names(read_one: Callable[..., Manipulator], number: int) -> None:
    """As numbers they are lengths that are refused."""
    assert read_one({**RADIANS, "link": [number]}).rows[0].link == str(number)


@pytest.mark.parametrize("dtype", ["int64", "Int64", "float64", "Float64", "float32", "category", "object", "string"])
def test_tables_of_pandas(tmp_path: Path, dtype: str) -> None:
    """Whatever pandas makes of a column; an index without a name is no column."""
    import pandas as pd

    frame = pd.DataFrame({"joint": ["hip", "knee"], "a": [1, 2], "alpha": [0.0, 0.0], "d": [0, 0], "mass": [1, 2]})
    frame["a"] = frame["a"].astype(dtype)  # type: ignore[call-overload]  # any kind
    frame.to_parquet(tmp_path / "arm.parquet")
    (arm,) = stages.PARQUET.read(tmp_path / "arm.parquet", STANDARD)
    assert isinstance(arm, Manipulator)
    assert [(row.joint, row.a) for row in arm.rows] == [("hip", 1.0), ("knee", 2.0)]
    assert arm.notices == ()


def arm_of(given: Any) -> Manipulator:
    """The one arm of a file or a data frame."""
    if not isinstance(given, Path):
        return Manipulator.from_dh(given, convention="standard")
    (arm,) = stages.PARQUET.read(given, STANDARD)
    assert isinstance(arm, Manipulator)
    return arm


def test_an_index_of_pandas_without_a_name_is_that_of_the_joints(tmp_path: Path) -> None:
    """As `Manipulator.from_dh` reads it; beside a column of joints it is left out."""
    import pandas as pd

    frame = pd.DataFrame({"a": [0.1, 1.0], "alpha": [0.0, 0.0], "d": [0.0, 0.0]}, index=["hip", "knee"])
    path = tmp_path / "arm.parquet"
    frame.to_parquet(path)
    for source in (path, frame):
        assert [row.joint for row in arm_of(source).rows] == ["hip", "knee"]
        assert arm_of(source).notices == ()
    frame.assign(joint=["one", "two"]).to_parquet(path)
    assert [row.joint for row in arm_of(path).rows] == ["one", "two"]
    assert arm_of(path).notices == ()


@pytest.mark.parametrize(
    ("key", "outcome"),
    [
        ("units", "refused"),
        ("length_unit", "refused"),
        ("DH2URDF.units", "refused"),
        ("convention", "refused"),
        ("dh2urdf.units", "read"),
        ("owner", "left alone"),
    ],
)
def test_metadata_whose_key_is_nearly_one(tmp_path: Path, key: str, outcome: str) -> None:
    """In the file, and as attributes that pandas writes into it."""
    import pandas as pd

    frame = pd.DataFrame({"a": [300.0], "alpha": [0.0], "d": [0.0]})
    value = "standard" if key == "convention" else "mm"
    frame.to_parquet(tmp_path / "plain.parquet")
    table = pq.read_table(tmp_path / "plain.parquet")
    metadata = {**(table.schema.metadata or {}), key: value}
    pq.write_table(table.replace_schema_metadata(metadata), tmp_path / "plain.parquet")
    frame.attrs = {key: value}
    frame.to_parquet(tmp_path / "attributes.parquet")
    for source in (tmp_path / "plain.parquet", tmp_path / "attributes.parquet"):
        if outcome == "refused":
            with pytest.raises(Dh2UrdfError, match=key):
                arm_of(source)
        else:
            assert arm_of(source).rows[0].a == (0.3 if outcome == "read" else 300.0)


def test_lists_are_read_where_a_cell_holds_several_fields(tmp_path: Path) -> None:
    """Ranges, centres of mass and tensors, of a Parquet file and from Python alike; refused elsewhere."""
    tensor = [[0.1, 0.0, 0.01], [0.0, 0.1, 0.0], [0.01, 0.0, 0.1]]
    row = {"a": 0.3, "alpha": 0.0, "d": 0.0, "mass": 1.0, "limits": [-1, 2], "com": [0.0, 0.1, 0.2], "inertia": tensor}
    pq.write_table(pa.table({key: [cell] for key, cell in row.items()}), tmp_path / "arm.parquet")
    given = {**row, "com": np.array([0.0, 0.1, 0.2]), "limits": (-1, np.float64(2)), "inertia": np.array(tensor)}
    for arm in (arm_of(tmp_path / "arm.parquet"), arm_of([given])):
        (made,) = arm.rows
        assert (made.limits.lower, made.limits.upper, made.com) == (-1.0, 2.0, (0.0, 0.1, 0.2))
        assert made.inertia is not None
        assert made.inertia.ixz == 0.01
    with pytest.raises(Dh2UrdfError, match="field 'a'"):
        arm_of([{**given, "a": [0.3]}])
