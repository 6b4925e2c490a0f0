"""Files that are opened, and what is pasted: cells of spreadsheets and of texts, and whole tables with their headers."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.errors import InputError
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system import Catalog
from dh2urdf.table_text import TableText
from dh2urdf_plugins.packages.table import TableOptions
from dh2urdf_plugins.packages.table.notation import latex_file, markdown_file
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.opening import cells_of, open_tables, orders, pasted, tables_of, whole_tables
from dh2urdf_studio.editing.reading import read_whole

REFERENCE = Path(__file__).parents[2] / "reference" / "inputs"
TABLES = Path(__file__).parents[3] / "configs" / "tables"


def accepted() -> list[str]:
    records = json.loads((REFERENCE / "expected.json").read_text("utf-8"))
    items = records.items() if isinstance(records, dict) else ((record["file"], record) for record in records)
    return [name for name, record in items if isinstance(record, dict) and record.get("outcome") == "accept"]


@pytest.mark.parametrize("name", accepted())
def test_any_table_that_a_reader_takes_can_be_opened(name: str, catalog: Catalog) -> None:
    """What the tables of real people say is said by their texts too, and the arm is the same."""
    path = REFERENCE / name
    reader = catalog.reader_for(path)
    try:
        arms = [item for item in reader.read(path, reader.options()) if isinstance(item, Manipulator)]
    except InputError:
        arms = []
    if not arms:  # it does not say its convention
        ((table, *_),) = open_tables(path, catalog)
        assert not table.convention
        (arm,) = reader.read(path, reader.options(convention="modified"))
        assert read_whole(replace(table, convention="modified"), catalog).manipulator == arm
        return
    for arm, opened in zip(arms, open_tables(path, catalog), strict=True):
        assert read_whole(opened.table, catalog).manipulator == arm
        assert opened.lost == ()


def test_the_texts_of_a_file_are_kept(catalog: Catalog) -> None:
    """`pi/2` and `-130°` are what the file says, and what is shown."""
    ((table, *_),) = open_tables(TABLES / "scara.csv", catalog)
    assert table.rows[1]["alpha"] == "pi"
    assert table.rows[0]["lower"] == "-130°"


def test_what_a_table_cannot_hold_is_told(catalog: Catalog, tmp_path: Path) -> None:
    """A mesh has no cell: the arm is opened without it, and that is said."""
    (tmp_path / "link.stl").write_text("solid x\nendsolid x\n")
    path = tmp_path / "arm.yaml"
    path.write_text(
        "convention: standard\nvisuals: none\njoints:\n"
        "  - {a: 1, alpha: 0, d: 0}\n  - {name: bare, a: 1, alpha: 0, d: 0, collision: link.stl}\n"
    )
    ((table, lost, _),) = open_tables(path, catalog)
    assert [row["a"] for row in table.rows] == ["1", "1"]
    assert lost == ("visuals", "collision of bare")


def test_of_a_large_file_only_the_first_are_read(catalog: Catalog) -> None:
    rows = "".join(f"r{number},0.1,0,0\n" for number in range(200))
    content = f"# convention: standard\nrobot,a,alpha,d\n{rows}r200,wrong,0,0\n".encode()
    opened = tables_of("many.csv", content, catalog, most=7)
    assert [each.table.name for each in opened] == [f"r{number}" for number in range(7)]  # type: ignore[union-attr]


def test_a_description_with_several_chains(catalog: Catalog) -> None:
    """None of its leaves has a usual name, so each chain is a table that can be chosen."""
    links = "".join(f"<link name='{name}'/>" for name in ("trunk", "left", "right"))
    joint = (
        "<joint name='{0}_joint' type='continuous'><parent link='trunk'/><child link='{0}'/><axis xyz='0 0 1'/></joint>"
    )
    text = f"<robot name='tree'>{links}{joint.format('left')}{joint.format('right')}</robot>"
    opened = tables_of("tree.urdf", text.encode(), catalog)
    assert not isinstance(opened, str)
    assert [each.table.name for each in opened] == ["tree_left", "tree_right"]
    assert [each.table.rows[0]["joint"] for each in opened] == ["left_joint", "right_joint"]


def test_a_table_of_two_units_and_no_convention_is_opened(tmp_path: Path, catalog: Catalog) -> None:
    """No table can hold its texts, so it has their numbers; a person says the convention on the page."""
    (tmp_path / "two.csv").write_text("a [mm],alpha [deg],d [m]\n425,90,0.1\n0,-90,0.2\n")
    (opened,) = open_tables(tmp_path / "two.csv", catalog)
    assert opened.table.convention == ""
    arm = read_whole(replace(opened.table, convention="modified"), catalog).manipulator
    assert arm is not None
    assert [(row.a, row.d) for row in arm.rows] == [(0.425, 0.1), (0.0, 0.2)]


@pytest.mark.parametrize("convention", ["# convention: modified\n", ""])
def test_a_manipulator_that_cannot_be_read_is_named(convention: str, catalog: Catalog, tmp_path: Path) -> None:
    """The page opened the other ones without a word, and the command line had never heard of it."""
    path = tmp_path / "arms.csv"
    path.write_text(f"{convention}robot,a [mm],alpha,d [m]\ngood,1,0,0\nbad one,wrong,0,0\nworse,0,0,wrong\n")
    (opened,) = open_tables(path, catalog)
    assert opened.table.name == "good"
    for text in ("bad one, worse", f"{path}:{4 if convention else 3}:9: ", "'wrong'"):
        assert text in opened.notices[-1]
    if convention:
        with pytest.raises(InputError, match="'wrong'"):
            open_tables(path, catalog, wanted="worse")
    assert open_tables(path, catalog, wanted="good") == open_tables(path, catalog, wanted="none") == (opened,)


@pytest.mark.parametrize(
    ("name", "content", "told", "untold"),
    [
        (
            "arm.csv",
            "a [mm],alpha [deg],d\n0.1,x,2\n",
            ["'x'", "'2'"],
            "convention",
        ),  # which a person chooses on the page
        ("arm.csv", "a [mm],alpha [deg],d [m]\n425,90,x\n", ["'x'"], "convention"),
        ("arm.csv", "# convention: craigg\na [mm],alpha [deg],d\n0.1,x,2\n", ["'craigg'"], "dh2urdf-"),
        (
            "run.yaml",
            "inputs: arm.csv\nemitters: [urdf]\noutput: {directory: build}\n",
            ["run.yaml", "dh2urdf view"],
            "dh2urdf-",
        ),
        (
            "a.urdf.xacro",
            '<robot xmlns:xacro="http://ros.org/wiki/xacro" name="a"><xacro:include filename="b.xacro"/></robot>',
            ["'./b.xacro'"],
            "dh2urdf-",
        ),
    ],
)
def test_what_cannot_be_opened(name: str, content: str, told: list[str], untold: str, catalog: Catalog) -> None:
    """Only what is wrong is named, without the folder in which it was read."""
    found = tables_of(name, content.encode(), catalog)
    assert isinstance(found, str)
    assert [each for each in told if each not in found] == []
    assert untold not in found


def test_a_column_that_means_nothing_is_noticed(catalog: Catalog) -> None:
    """It is not in the table on the page: its notice would be lost."""
    content = "# convention: standard\na,alpha,d,colour of the cable\n1,90°,0,red\n".encode()
    (opened,) = tables_of("arm.csv", content, catalog)  # type: ignore[misc]
    (notice,) = opened.notices
    assert notice.startswith("arm.csv:2")
    assert "colour of the cable" in notice


# --- Pasting ----------------------------------------------------------------------------------------------------------

THREE = edits.with_cells(edits.resized(TableText(), 3), {(0, "a"): "1", (1, "a"): "2", (2, "a"): "3"})
COLUMNS = ("joint", "a", "alpha", "d")
CONFIGS = sorted(TABLES.glob("*.[cy]*"))
IN_A_PLACE = """# convention: standard
# base: {xyz: [0, 0, 0.3], rpy: [0, 0, pi]}
# tool: {xyz: [0, 0.1, 0]}
joint,type,a,alpha,d,theta,lower,upper
waist_1,R,0.1,pi/2,0.2,-q + pi/4,-3*pi/4,1
slide,P,0.3,-1.1,0.4 - q,0.7,0,0.75
wrist,R,0,pi,0.05,pi/3 + q,-1,1
"""
CODED = [["0", "0.1", "pi/2", "0"], ["0", "-0.2", "0", "0.5"]]


def column(table: TableText, field: str) -> list[str]:
    return [row.get(field, "") for row in table.rows]


def tables_in(found: Any) -> TableText:
    assert isinstance(found, tuple), found
    ((table, *_),) = found
    return table


def test_cells_of_a_spreadsheet() -> None:
    """Lines of cells go in from the cursor on, rows are added for them, and what is too wide is counted."""
    put = pasted(THREE, 2, "a", "0.1\tpi/2\t0.2\tbeyond\r\n0.3\t0\t\r\n", COLUMNS)
    assert column(put.table, "a") == ["1", "2", "0.1", "0.3"]
    assert column(put.table, "alpha") == ["", "", "pi/2", "0"]
    assert column(put.table, "d") == ["", "", "0.2", ""]
    assert put.left_out == 1
    assert len(pasted(THREE, 0, "a", "1\n" * (edits.MOST_ROWS + 5), COLUMNS).table.rows) == edits.MOST_ROWS


@pytest.mark.parametrize(
    ("text", "cells"),
    [
        ("1\t2\n3\t4", [["1", "2"], ["3", "4"]]),
        ("", [[""]]),
        ("a", [["a"]]),
        ("0,5;2", [["0.5", "2"]]),
        ("0,5;1.25", [["0,5", "1.25"]]),  # one of them is a slip: the reader says what it thinks of it
        ("| 1 | 2 |\n|---|:--:|\n| 3 | 4 |", [["1", "2"], ["3", "4"]]),
        ('"-425 mm"\t"90°"\r\n"a\nb"\t"5"""', [["-425 mm", "90°"], ["a b", '5"']]),  # as spreadsheets quote
        ("1,234\t2,000", [["1,234", "2,000"]]),  # these commas may separate thousands: the reader asks
        ("\t0.1 & 0 \\\\\n\t0.2 & 1 \\\\", [["0.1", "0"], ["0.2", "1"]]),
        (r"0.1 & $\frac{\pi}{2}$ & $-2\pi$ \\", [["0.1", "pi/2", "-2pi"]]),
        ("shoulder 0 pi/2 0.1\nelbow 0.4 0 0", [["shoulder", "0", "pi/2", "0.1"], ["elbow", "0.4", "0", "0"]]),
        ("DH = np.array([[0, 0.1, np.pi/2, 0],\n  [0, -0.2, 0, 0.5]], dtype=np.float64)", CODED),
        ("DH = [ 0   0.1  pi/2  0 ; ...\n       0  -0.2  0   0.5 ];", CODED),
        ("double dh[2][4] = {{0, 0.1, M_PI/2, 0}, {0, -0.2, 0, 0.5}};", CODED),
    ],
)
def test_separators(text: str, cells: list[list[str]], catalog: Catalog) -> None:
    """Cells without a header go in as they are, and nobody is asked."""
    assert cells_of(text) == cells
    assert whole_tables(text, catalog) == ()


def test_the_order_of_columns_without_a_header() -> None:
    """Three or four columns of numbers may be several things, names and types before them."""
    assert ("theta", "d", "a", "alpha") in orders("0\t0.1\t0.2\t0")
    assert orders("waist\tR\t0\t0\t0.1")[0] == ("joint", "type", "a", "alpha", "d")
    assert orders("0\t0.1") == []


@pytest.mark.parametrize(
    "text",
    [
        "# convention: standard\na,alpha,d\n0.1,pi/2,0.2\n0.3,0,0\n",
        "a\talpha\td\n0.1\tpi/2\t0.2\n0.3\t0\t0\n",
        "| θ | d | a | α |\n|---|---|---|---|\n| q1 | 0.2 | 0.1 | pi/2 |\n| q2 | 0 | 0.3 | 0 |\n",
        "---\njoints:\n- {a: 0.1, alpha: pi/2, d: 0.2}\n- {a: 0.3, alpha: 0, d: 0}\n",
        json.dumps([{"a": 0.1, "alpha": "pi/2", "d": 0.2}, {"a": 0.3, "alpha": 0, "d": 0}]),
        (
            "\\begin{table}[h]\n\\begin{tabular}{|c|c|c|c|} \\hline\n$i$ & $\\alpha_i$ & $a_i$ & $d_i$ \\\\ \\hline\n"
            "1 & $90^{\\circ}$ & \\textbf{0.1} & $2 \\times 10^{-1}$ \\\\\n2 & 0 & 0.3 & 0 \\\\\n\\end{tabular}\n\\end{table}"
        ),
    ],
)
def test_a_table_with_a_header(text: str, catalog: Catalog, arm_of: Callable[..., Manipulator]) -> None:
    """It is read as a file would be: columns are known by their names, in any order, and units by theirs."""
    arm = arm_of(tables_in(whole_tables(text, catalog, "standard")))
    assert [(row.a, row.alpha, row.d) for row in arm.rows] == [
        (0.1, pytest.approx(1.5707963267948966), 0.2),
        (0.3, 0, 0),
    ]


@pytest.mark.parametrize(
    "text",
    [
        "DH table, lengths in mm\n100 0 0.2\n300 0 0\n",
        "Modified convention, in mm:\n\n| 100 | 0 | 0 |\n| 300 | 0 | 0 |\n",
        r"\caption{In mm}\begin{tabular}{ccc} 100 & 0 & 0 \\ 300 & 0 & 0 \\ \end{tabular}",
        '<robot name="arm">\n  <link name="base_link"/>\n</robot>',
        "# convention: standard\na,alpha,d\n0.1,x,2\n",
    ],
)
def test_what_would_be_lost_is_said_first(text: str, catalog: Catalog) -> None:
    """Words around numbers are not dropped in silence, and a description is no table."""
    found = whole_tables(text, catalog, "standard")
    assert isinstance(found, str)
    assert "dh2urdf-" not in found, "no folder that nobody knows"


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("a\talpha\td\n100\t90\t2\n", ("mm", "deg")),
        ("a [m]\talpha\td [m]\n100\t90\t2\n", ("m", "deg")),
        ("# units: {length: m, angle: rad}\na\talpha\td\n100\t90\t2\n", ("m", "rad")),
    ],
)
def test_a_table_without_units_has_those_of_the_page(text: str, units: tuple[str, str], catalog: Catalog) -> None:
    table = tables_in(whole_tables(text, catalog, "standard", ("mm", "deg")))
    assert (table.length_unit, table.angle_unit) == units


@pytest.mark.parametrize("form", [latex_file, markdown_file])
@pytest.mark.parametrize("table", [*CONFIGS, IN_A_PLACE], ids=lambda table: getattr(table, "name", "in a place"))
def test_what_is_written_for_papers_is_read(
    table: Path | str, form: Callable[..., bytes], catalog: Catalog, arm_of: Callable[..., Manipulator]
) -> None:
    """The arm is the same, with its names, types, bounds, base and tool, and with the convention of the caption."""
    name, text = (table.name, table.read_text()) if isinstance(table, Path) else ("arm.csv", table)
    arm = arm_of(tables_in(tables_of(name, text.encode(), catalog)))
    typed = form([arm], TableOptions(length_unit="mm", angle_unit="deg")).decode()
    again = arm_of(tables_in(whole_tables(typed, catalog)))
    assert again.convention == arm.convention

    def facts(arm: Manipulator) -> tuple[list[Any], list[float]]:
        numbers = [
            number or 0.0
            for row in arm.rows
            for number in (row.a, row.alpha, row.d, row.theta, row.offset, row.limits.lower, row.limits.upper)
        ]
        ends = (*arm.base.translation, *arm.base.rpy, *arm.tool.translation, *arm.tool.rpy)
        return [(row.joint, row.type, row.sign) for row in arm.rows], [*numbers, *ends]

    (names, numbers), (old_names, old_numbers) = facts(again), facts(arm)
    assert names == old_names
    assert numbers == pytest.approx(old_numbers, abs=1e-12)
