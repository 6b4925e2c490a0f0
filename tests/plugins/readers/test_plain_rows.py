"""The fast way through a table reads what the careful one reads, or leaves it to that."""

import math
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

from dh2urdf.errors import TableError
from dh2urdf.fields import replace_unchecked
from dh2urdf.manipulator import Convention, DHRow, Manipulator
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.plain import rows as plain_rows
from dh2urdf_plugins.readers.plain.rows import PlainRows, decimals
from dh2urdf_plugins.readers.table import TableOptions


@contextmanager
def without_the_fast_way() -> Generator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(PlainRows, "read", lambda *_arguments: None)
        yield


def outcome(path: Path, content: str, **options: Any) -> Any:
    """Everything that reading a file gives, as texts: records with their marks, notices and errors."""
    path.write_text(content)
    try:
        return [repr(item) for item in stages.CSV.read(path, TableOptions(**options))]
    except TableError as error:
        return str(error)


R, P = "R,100,0,10", "P,100,0,10"
MIXED = {
    "an offset, lengths in mm": ("# units: {length: mm}", "offset", (f"{R},0.5", f"{P},5")),
    "an offset, angles in degrees": ("# units: {angle: deg}", "offset", ("R,1,0,1,90", "P,1,0,1,0.5")),
    "limits, lengths in mm": ("# units: {length: mm}", "lower,upper", (f"{R},-1,{{k}}", f"{P},-1,{{k}}")),
    "speeds, lengths in mm": ("# units: {length: mm}", "velocity", (f"{R},{{k}}", f"{P},{{k}}")),
    "accelerations, lengths in mm": ("# units: {length: mm}", "acceleration,jerk", (f"{R},{{k}},2", f"{P},{{k}},2")),
    "accelerations beside cells with units": (
        "",
        "lower,upper,acceleration",
        ("R,1,0,1,-90°,90°,{k}", "P,1,0,1,0,1,{k}"),
    ),
    "offsets in a column of m": ("", "offset [m]", ("R,1,0,1,0", "P,1,0,1,{k}")),
    "limits in columns of m": ("", "lower [m],upper [m]", ("P,1,0,1,-1,{k}", "P,1,0,1,0,{k}")),
    "an offset in a column of rad, of a joint that slides": ("", "offset [rad]", ("R,1,0,1,0", "P,1,0,1,0.5")),
    "a limit in a column of mm, of a joint that turns": (
        "",
        "lower [mm],upper [mm]",
        ("R,1,0,1,-1,{k}", "P,1,0,1,-1,{k}"),
    ),
    "a speed in a column of m/s, of a joint that turns": ("", "velocity [m/s]", ("R,1,0,1,{k}", "P,1,0,1,{k}")),
}
"""What is above a table or in its header, its last columns, and the rows of an arm that turns and slides."""


@pytest.mark.parametrize(("top", "columns", "rows"), MIXED.values(), ids=MIXED)
def test_a_column_of_angles_and_lengths_has_one_meaning(
    top: str, columns: str, rows: tuple[str, ...], tmp_path: Path
) -> None:
    """An offset, a limit or a speed is in its joint's unit, in the first arm of a file and in the last."""
    path = tmp_path / "arms.csv"
    said, geometry = (top, "a,alpha,d") if top.startswith("#") else ("# name: x", top or "a,alpha,d")
    lines = [said, f"robot,type,{geometry},{columns}"]
    arms = [[f"r{k},{row}".format(k=f"0.{k + 1:03}") for row in rows] for k in range(40)]  # more limits than a few
    content = "\n".join([*lines, *(row for arm in arms for row in arm)])
    fast = outcome(path, content, convention="standard")
    with without_the_fast_way():
        assert fast == outcome(path, content, convention="standard")
    first, *others = stages.CSV.read(path, TableOptions(convention="standard"))
    assert {type(item) for item in others} == {type(first)}


plain_numbers = st.sampled_from(
    ["0", "0.5", "-0.25", "1.5707963267948966", "-0", "1e-3", "+2.", ".5", "3", "0.0", "12.5", "1.25", "50"]
)
odd_cells = st.sampled_from(
    ["", " ", "1.57", "pi/2", "90 deg", "nan", "inf", "-inf", "1_0", "٣", "1e400", "400", "7", "x", "#REF!", "j1", "world", "1,5", "0x10", "flange", "é", "\x1f", "fixed", "continuous", "P", '"a"', "-5", "1\xa0", "0", "DH", "craig", "q1", "flange ", "J1", "link_1-tool0", "base_link", "2e4", "-1e-400", '"1\n2"', '"revolute\n"']
)  # fmt: skip
COLUMNS = ["robot", "joint", "link", "i", "type", "a", "alpha", "d", "theta", "offset", "lower", "upper", "velocity"]
WORDS = ["revolute", "revolute", "R", "prismatic", "continuous", "fixed"]
EXPRESSIONS = ["pi/2", "-pi/2", "0", "90deg", "0.1 + 0.02", "-0.25", "1e-3", "50 mm"]
LIMITS = {
    "lower": ["-1", "-2", "", "-0.5"],
    "upper": ["1", "2", "", "pi"],
    "velocity": ["1", "", "2"],
    "effort": ["5", ""],
}
UNITS = {
    "a": ["mm", "m"],
    "d": ["cm", "mm"],
    "alpha": ["deg", "rad"],
    "theta": ["deg"],
    "offset": ["deg", "rad", "m", "mm"],
    "lower": ["deg", "rad", "m", "mm"],
    "upper": ["deg", "rad", "m", "mm"],
    "velocity": ["deg/s", "m/s", "rad/s"],
}
STATED = [[], [], ["# units: {length: mm}"], ["# units: {angle: deg}"], ["# units: mm, deg"], ["# units: cm"]]


@st.composite
def large_tables(draw: st.DrawFn) -> str:
    """Several manipulators, plain for the most part, with an odd cell now and then."""
    more = st.lists(st.sampled_from([*COLUMNS, "effort", "convention"]), max_size=9, unique=True)
    columns = ["a", "alpha", "d", *draw(more)]
    columns = list(dict.fromkeys(columns))
    if draw(st.booleans()) and "lower" in columns:
        columns = list(dict.fromkeys([*columns, "lower", "upper", "velocity", "effort"]))
    headers = [
        f"{name} [{draw(st.sampled_from(UNITS[name]))}]" if name in UNITS and draw(st.integers(0, 3)) == 0 else name
        for name in columns
    ]
    delimiter = draw(st.sampled_from([",", ",", ";"]))
    lines = [*draw(st.sampled_from(STATED)), delimiter.join([*headers, ""])]
    mixed, own_names = draw(st.booleans()), draw(st.booleans())
    expressions = draw(st.sets(st.sampled_from(["a", "alpha", "d", "theta", "offset"]), max_size=2))
    for robot in range(draw(st.integers(1, 4))):
        end = f"_{robot}" if own_names else ""
        for number in range(1, draw(st.integers(1, 4)) + 1):
            words = {"robot": f"arm{robot}", "joint": f"j{number}{end}", "link": f"l{number}", "i": str(number)}
            words |= {"type": "revolute", "velocity": "1", "effort": "2", "upper": "3", "convention": "DH"}
            words |= {name: draw(st.sampled_from(EXPRESSIONS)) for name in sorted(expressions)}
            if mixed:
                words["type"] = draw(st.sampled_from(WORDS))
                words |= {name: draw(st.sampled_from(texts)) for name, texts in LIMITS.items()}
            line = [words[name] if name in words else draw(plain_numbers) for name in columns]
            if draw(st.integers(0, 5)) == 0:
                line[draw(st.integers(0, len(line) - 1))] = draw(odd_cells)
            lines.append(delimiter.join([*line, ""]))
    return "\n".join(lines)


@pytest.mark.long
@given(large_tables())
@settings(max_examples=800)
def test_the_fast_way_reads_what_the_careful_one_reads(tmp_path_factory: pytest.TempPathFactory, content: str) -> None:
    """Every manipulator, every notice and every error is the same with and without it, be there one of a form or many."""
    path = tmp_path_factory.getbasetemp() / "arms.csv"
    header = next(line for line in content.split("\n") if not line.startswith("#"))
    options = {} if "convention" in header else {"convention": "standard"}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plain_rows, "FEWEST", 0)
        fast = outcome(path, content, **options)
    with without_the_fast_way():
        assert fast == outcome(path, content, **options)


def test_the_fast_way_is_taken_by_plain_tables(tmp_path: Path, fast: list[int]) -> None:
    """A table of a benchmark's kind, units and limits included, goes the fast way; the last arm is a batch by itself."""
    header = (
        "robot,i,joint,type,a [mm],alpha [deg],d [mm],theta [deg],lower [deg],upper [deg],velocity [rad/s],effort [Nm]"
    )
    lines = [
        f"r{robot},{joint},joint_{joint},revolute,{joint}.5,90,{robot % 100 + 10}.25,-45,-180,180,3.14,50"
        for robot in range(2000)
        for joint in range(1, 7)
    ]
    path = tmp_path / "arms.csv"
    path.write_text("\n".join([header, *lines]))
    arms = list(stages.CSV.read(path, TableOptions(convention="standard")))
    assert (len(arms), sum(fast)) == (2000, 1999)


@pytest.mark.parametrize(
    ("units", "columns", "cells"),
    [
        ("length: mm, angle: rad", "type,a,d,alpha", "300,100,1.2"),
        ("length: mm, angle: rad", "type,a,d,alpha,offset,lower,upper,velocity", "300,100,1.2,0.5,-1,1,2"),
        ("length: m, angle: deg", "type,a,d,alpha,lower,upper,effort", "0.3,0.1,70,-1,1,5"),
    ],
)
def test_the_fast_way_is_taken_where_joints_slide(
    units: str, columns: str, cells: str, tmp_path: Path, fast: list[int]
) -> None:
    """In any unit: it took thirty times as long where a column has angles in one row and lengths in another."""
    rows = [f"r{k},{kind},{cells}" for k in range(40) for kind in ("R", "P")]
    content = "\n".join([f"# units: {{{units}}}", f"robot,{columns}", *rows])
    read = outcome(tmp_path / "arms.csv", content, convention="standard")
    assert any(fast)
    with without_the_fast_way():
        assert read == outcome(tmp_path / "arms.csv", content, convention="standard")


@pytest.mark.parametrize(
    ("cells", "is_fast"),
    [
        ("0.3,90 deg,0,-170°,170°,180 deg/s", True),
        ("300 mm,pi/2,2 cm,-1,1,1", True),
        ("300 mm,pi/2,0.02,-1,1,1", False),
        ("0.3,0,0,-170°,1,180 deg/s", False),
        ("0.3,0,0,-170°,170°,3", False),
    ],
)
def test_units_in_cells_are_read_fast_where_no_bare_number_is_beside_them(
    cells: str, tmp_path: Path, fast: list[int], *, is_fast: bool
) -> None:
    """A number without a unit, in a column beside one whose cells name units, is looked at with care."""
    rows = "".join(f"r{k},{cells}\n" for k in range(40))
    content = f"robot,a,alpha,d,lower,upper,velocity\n{rows}"
    read = outcome(tmp_path / "arms.csv", content, convention="standard")
    assert any(fast) is is_fast
    with without_the_fast_way():
        assert read == outcome(tmp_path / "arms.csv", content, convention="standard")


@pytest.mark.parametrize("field", ["a", "alpha", "d", "theta", "offset", "lower"])
def test_a_number_too_small_for_a_double_is_refused_in_bulk(
    field: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """On the fast path, among numbers with usual exponents."""
    fields = ("a", "alpha", "d", "theta", "offset", "lower", "upper")
    row = dict.fromkeys(fields, "0") | {"a": "0.3", "lower": "-1", "upper": "1"}
    rows = [row | {"d": "1e-05"} for _ in range(400)]
    rows[300] |= {field: "1e-400"}
    lines = "".join(f"r{k},{','.join(row.values())}\n" for k, row in enumerate(rows))
    arms = read(f"# convention: standard\nrobot,{','.join(fields)}\n{lines}")
    assert [arm.name for arm in arms if not isinstance(arm, Manipulator)] == ["r300"]


# --- The sample that is read twice ------------------------------------------------------------------------------------


def arms_of(count: int, rows: int = 6) -> str:
    lines = [f"r{arm},j{row},R,0.00{row},pi/2,0.02,0.{arm:04}" for arm in range(count) for row in range(1, rows + 1)]
    return "\n".join(["robot,joint,type,a,alpha,d,offset", *lines])


def plant(
    monkeypatch: pytest.MonkeyPatch, change: Callable[[tuple[DHRow, ...]], tuple[DHRow, ...]], *, after: int = 0
) -> None:
    """Makes the fast way read every manipulator wrongly, after so many rows."""
    fast = PlainRows.read
    read = 0

    def wrong(self: PlainRows, groups: Any) -> Any:
        nonlocal read
        read += sum(len(rows.cells) for rows in groups)
        result = fast(self, groups)
        return result and [
            (members, replace_unchecked(arm, rows=change(arm.rows) if read > after else arm.rows))
            for members, arm in result
        ]

    monkeypatch.setattr(PlainRows, "read", wrong)


@pytest.mark.parametrize("rows", [1, 200])
def test_a_wrong_fast_reading_is_an_error_that_names_both(
    rows: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last bit of one offset is enough; the message names the row, both readings and what to do."""
    path = tmp_path / "arms.csv"
    path.write_text(arms_of(3, rows))
    least = math.nextafter(0.0, 1.0)
    plant(monkeypatch, lambda rows: (replace_unchecked(rows[0], offset=rows[0].offset + least), *rows[1:]))
    with pytest.raises(TableError) as caught:
        list(stages.CSV.read(path, TableOptions(convention="standard")))
    (problem,) = caught.value.problems
    assert (problem.code, str(problem.mark), problem.joint) == ("two-readings", f"{path}:2", "j1")
    assert problem.message.count("=5e-324,") == 1


def test_a_row_that_only_the_fast_way_accepts_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the careful reading refuses, or has a notice about, is another reading too."""
    path = tmp_path / "arms.csv"
    row = DHRow(joint="j1", link="link_1", a=0.001, alpha=1.5708, d=0.02)
    arm = Manipulator(name="arm", convention=Convention.STANDARD, rows=(row,))
    monkeypatch.setattr(
        PlainRows,
        "read",
        lambda _self, groups: [
            ([k], replace_unchecked(arm, rows=(row,) * len(own.cells))) for k, own in enumerate(groups)
        ],
    )
    for replaced in ("1.5708", "400"):
        path.write_text(arms_of(3).replace("r0,j1,R,0.001,pi/2", f"r0,j1,R,0.001,{replaced}"))
        with pytest.raises(TableError) as caught:
            list(stages.CSV.read(path, TableOptions(convention="standard")))
        assert [problem.code for problem in caught.value.problems] == ["two-readings"]


def test_a_wrong_reading_deep_in_a_file_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The sample goes on to the end of a file: an error that sets in after 60,000 rows is found."""
    path = tmp_path / "arms.csv"
    path.write_text(arms_of(20_000))
    plant(monkeypatch, lambda rows: (replace_unchecked(rows[0], sign=-1), *rows[1:]), after=60_000)
    with pytest.raises(TableError) as caught:
        list(stages.CSV.read(path, TableOptions(convention="standard")))
    (problem,) = caught.value.problems
    assert problem.code == "two-readings"
    assert "=-1," in problem.message


@pytest.mark.parametrize(
    ("column", "numbers"),
    [
        (["0.25", "-1.5e-3", "3"], [0.25, -1.5e-3, 3.0]),
        (["-0", "-0.0", "12345678901234567890123"], [0.0, 0.0, 12345678901234567890123.0]),
        (["+1", "01", ".5", "2.", " 7 "], [1.0, 1.0, 0.5, 2.0, 7.0]),
        (["1,2"], None),
        (["[1", "2]", "3,4"], None),
        (['"1', '2"', "3,4"], None),
        (["1", ""], None),
        (["1_0", "2"], None),
        (["1\n", "2"], None),
        (["0", "1e-400"], None),
    ],
)
def test_decimal_numbers_are_those_of_float(column: list[str], numbers: list[float] | None) -> None:
    """Texts that are read together mean what each means by itself, and no text reaches into the next one."""
    found = decimals(column)
    assert repr(found) == repr(numbers)


@pytest.mark.parametrize(
    ("header", "cells"),
    [
        ("mass", "1.5"),
        ("mass,com_x,com_y,com_z", "1.5,0,-0.1,{k}"),
        ("mass,ixx,iyy,izz,ixy,ixz,iyz", "1.5,0.1,0.1,0.2,0,0,{k}"),
        ("damping,friction,armature", "0.1,0,{k}"),
        ("mass", "-{k}"),
        ("damping", "-1"),
    ],
)
def test_a_column_of_other_numbers_is_read_alike(header: str, cells: str, tmp_path: Path) -> None:
    """Masses and what joints resist with go the fast way too, with joints that turn, slide and stand still."""
    path = tmp_path / "arms.csv"
    for kinds in ("RR", "RP", "RF"):
        rows = [f"r{k},{kind},0.3,0,0.1,{cells}".format(k=f"0.{k + 1:03}") for k in range(40) for kind in kinds]
        content = "\n".join([f"robot,type,a,alpha,d,{header}", *rows])
        fast = outcome(path, content, convention="standard")
        with without_the_fast_way():
            assert fast == outcome(path, content, convention="standard")


def test_arms_of_other_sizes_are_of_other_forms(tmp_path: Path) -> None:
    """Where no column has words, the number of joints alone tells arms apart."""
    sizes = (3, 1, 3, 1, 2, 3, 1, 1)
    rows = "".join(f"r{arm},0.{joint + 1},0,0.{arm + 1}\n" for arm, n in enumerate(sizes) for joint in range(n))
    (tmp_path / "arms.csv").write_text(f"robot,a,alpha,d\n{rows}")
    arms = list(stages.CSV.read(tmp_path / "arms.csv", TableOptions(convention="standard")))
    assert [(arm.name, len(arm.rows)) for arm in arms] == [(f"r{arm}", n) for arm, n in enumerate(sizes)]
    assert [row.d for arm in arms for row in arm.rows] == [
        (arm + 1) / 10 for arm, n in enumerate(sizes) for _ in range(n)
    ]
