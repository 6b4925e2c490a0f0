"""Pasted texts: cells of spreadsheets and of texts, and whole tables with their headers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.table_text import TableText
from dh2urdf_plugins.packages.table import TableOptions
from dh2urdf_plugins.packages.table.notation import latex_file, markdown_file
from dh2urdf_studio.editing import edits, opening as pasting
from dh2urdf_studio.editing.opening import tables_of
from dh2urdf_studio.editing.reading import read_whole

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.plugin_system import Catalog

THREE = edits.with_cells(edits.resized(TableText(), 3), {(0, "a"): "1", (1, "a"): "2", (2, "a"): "3"})
COLUMNS = ("joint", "a", "alpha", "d")
TABLES = sorted((Path(__file__).parents[2] / "configs" / "tables").glob("*.[cy]*"))
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


def arm_of(found: Any, catalog: Catalog) -> Manipulator:
    assert isinstance(found, tuple), found
    ((table, *_),) = found
    arm = read_whole(table, catalog).manipulator
    assert arm is not None
    return arm


def test_cells_of_a_spreadsheet() -> None:
    """Lines of cells go in from the cursor on, rows are added for them, and what is too wide is counted."""
    put = pasting.pasted(THREE, 2, "a", "0.1\tpi/2\t0.2\tbeyond\r\n0.3\t0\t\r\n", COLUMNS)
    assert column(put.table, "a") == ["1", "2", "0.1", "0.3"]
    assert column(put.table, "alpha") == ["", "", "pi/2", "0"]
    assert column(put.table, "d") == ["", "", "0.2", ""]
    assert put.left_out == 1
    assert len(pasting.pasted(THREE, 0, "a", "1\n" * (edits.MOST_ROWS + 5), COLUMNS).table.rows) == edits.MOST_ROWS


@pytest.mark.parametrize(
    ("text", "cells"),
    [
        ("1\t2\n3\t4", [["1", "2"], ["3", "4"]]),
        ("1, 2\n3, 4", [["1", "2"], ["3", "4"]]),
        ("0,5;2", [["0.5", "2"]]),
        ("0,5;1.25", [["0,5", "1.25"]]),  # one of them is a slip: the reader says what it thinks of it
        ("0,5\n0,25", [["0.5"], ["0.25"]]),
        ("| 1 | 2 |\n|---|:--:|\n| 3 | 4 |", [["1", "2"], ["3", "4"]]),
        ("-0.4", [["-0.4"]]),
        ('"-425 mm"\t"90°"\r\n"a\nb"\t"5"""', [["-425 mm", "90°"], ["a b", '5"']]),  # as spreadsheets quote
        ("1,234\t2,000", [["1,234", "2,000"]]),  # these commas may separate thousands: the reader asks
        ("\t0.1 & 0 \\\\\n\t0.2 & 1 \\\\", [["0.1", "0"], ["0.2", "1"]]),
        ("1 0 90 0.1\n2 0.3 -90 0\n", [["1", "0", "90", "0.1"], ["2", "0.3", "-90", "0"]]),
        (r"0.1 & $\frac{\pi}{2}$ & $-2\pi$ \\", [["0.1", "pi/2", "-2pi"]]),
        ("-425 mm", [["-425 mm"]]),
        ("0.1 + 0.2\n0.3 + 0.4", [["0.1 + 0.2"], ["0.3 + 0.4"]]),
        ("shoulder 0 pi/2 0.1\nelbow 0.4 0 0", [["shoulder", "0", "pi/2", "0.1"], ["elbow", "0.4", "0", "0"]]),
        ("DH = np.array([[0, 0.1, np.pi/2, 0],\n  [0, -0.2, 0, 0.5]], dtype=np.float64)", CODED),
        ("[(0, 0.1, pi/2, 0),  # waist\n (0, -0.2, 0, 0.5)]", CODED),
        ("DH = [ 0   0.1  pi/2  0 ; ...\n       0  -0.2  0   0.5 ];", CODED),
        ("L(1) = Link([0 0.1 pi/2 0]);\nL(2) = Link([0 -0.2 0 0.5]);", CODED),
        ("double dh[2][4] = {{0, 0.1, M_PI/2, 0}, {0, -0.2, 0, 0.5}};", CODED),
    ],
)
def test_separators(text: str, cells: list[list[str]], catalog: Catalog) -> None:
    """Cells without a header go in as they are, and nobody is asked."""
    assert pasting.cells_of(text) == cells
    assert pasting.whole_tables(text, catalog) == ()


@pytest.mark.parametrize("text", ["dh = np.array([[0, 0.1], [1, 2]]).T", "dh = np.deg2rad([[0, 90], [1, 2]])"])
def test_an_array_that_is_changed_where_it_is_made_is_none(text: str) -> None:
    """Its numbers would be others, or in other places."""
    assert [cell for row in pasting.cells_of(text) for cell in row if cell.isdigit()] == []


def test_the_order_of_columns_without_a_header() -> None:
    """Three or four columns of numbers may be several things, names and types before them."""
    assert ("theta", "d", "a", "alpha") in pasting.orders("0\t0.1\t0.2\t0")
    assert pasting.orders("waist\tR\t0\t0\t0.1")[0] == ("joint", "type", "a", "alpha", "d")
    assert pasting.orders("0\t0.1") == []


@pytest.mark.parametrize(
    "text",
    [
        "# convention: standard\na,alpha,d\n0.1,pi/2,0.2\n0.3,0,0\n",
        "a\talpha\td\n0.1\tpi/2\t0.2\n0.3\t0\t0\n",
        'joint,a,alpha,d\n"shoulder, left",0.1,pi/2,0.2\nelbow,0.3,0,0\n',
        "| θ | d | a | α |\n|---|---|---|---|\n| q1 | 0.2 | 0.1 | pi/2 |\n| q2 | 0 | 0.3 | 0 |\n",
        "     a  alpha    d\n0  0.1    pi/2  0.2\n1  0.3    0.0  0.0\n",
        "---\njoints:\n- {a: 0.1, alpha: pi/2, d: 0.2}\n- {a: 0.3, alpha: 0, d: 0}\n",
        "- {a: 0.1, alpha: pi/2, d: 0.2}\n- {a: 0.3, alpha: 0, d: 0}",
        json.dumps([{"a": 0.1, "alpha": "pi/2", "d": 0.2}, {"a": 0.3, "alpha": 0, "d": 0}]),
        json.dumps({"joints": [{"a": 0.1, "alpha": "pi/2", "d": 0.2}, {"a": 0.3, "alpha": 0, "d": 0}]}, indent=2),
        (
            "\\begin{table}[h]\n\\begin{tabular}{|c|c|c|c|} \\hline\n$i$ & $\\alpha_i$ & $a_i$ & $d_i$ \\\\ \\hline\n"
            "1 & $90^{\\circ}$ & \\textbf{0.1} & $2 \\times 10^{-1}$ \\\\\n2 & 0 & 0.3 & 0 \\\\\n\\end{tabular}\n\\end{table}"
        ),
    ],
)
def test_a_table_with_a_header(text: str, catalog: Catalog) -> None:
    """It is read as a file would be: columns are known by their names, in any order, and units by theirs."""
    arm = arm_of(pasting.whole_tables(text, catalog, "standard"), catalog)
    assert [(row.a, row.alpha, row.d) for row in arm.rows] == [
        (0.1, pytest.approx(1.5707963267948966), 0.2),
        (0.3, 0, 0),
    ]


@pytest.mark.parametrize("text", ["0.1\t0\n0.2\t0", "shoulder\trevolute\nelbow\trevolute", "a", "", "\n"])
def test_cells_have_no_header(text: str, catalog: Catalog) -> None:
    assert pasting.whole_tables(text, catalog) == ()


@pytest.mark.parametrize(
    "text",
    [
        "DH table, lengths in mm\n100 0 0.2\n300 0 0\n",
        "Modified convention, in mm:\n\n| 100 | 0 | 0 |\n| 300 | 0 | 0 |\n",
        r"\caption{In mm}\begin{tabular}{ccc} 100 & 0 & 0 \\ 300 & 0 & 0 \\ \end{tabular}",
        "- {a: 0.1, alpha: 0, d: 0, unknown: 1 m}\n- {a: 0.3, alpha: 0, d: 0}\n",
        '<robot name="arm">\n  <link name="base_link"/>\n</robot>',
    ],
)
def test_what_would_be_lost_is_said_first(text: str, catalog: Catalog) -> None:
    """Words around numbers are not dropped in silence, and a description is no table."""
    assert isinstance(pasting.whole_tables(text, catalog, "standard"), str)


def test_what_cannot_be_read_is_said(catalog: Catalog) -> None:
    """In the reader's words, by its line, without a folder that nobody knows."""
    found = pasting.whole_tables("# convention: standard\na,alpha,d\n0.1,x,2\n", catalog)
    assert isinstance(found, str)
    assert found.startswith("clipboard.txt:")
    assert "'x' cannot be read" in found


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("a\talpha\td\n100\t90\t2\n", ("mm", "deg")),
        ("- {a: 100, alpha: 90, d: 2}\n", ("mm", "deg")),
        ('{"joints": [{"a": 100, "alpha": 90, "d": 2}]}', ("mm", "deg")),
        ("a [m]\talpha\td [m]\n100\t90\t2\n", ("m", "deg")),
        ("# units: {length: m, angle: rad}\na\talpha\td\n100\t90\t2\n", ("m", "rad")),
    ],
)
def test_a_table_without_units_has_those_of_the_page(text: str, units: tuple[str, str], catalog: Catalog) -> None:
    found = pasting.whole_tables(text, catalog, "standard", ("mm", "deg"))
    assert isinstance(found, tuple), found
    ((table, *_),) = found
    assert (table.length_unit, table.angle_unit) == units


@pytest.mark.parametrize("form", [latex_file, markdown_file])
@pytest.mark.parametrize("table", [*TABLES, IN_A_PLACE], ids=lambda table: getattr(table, "name", "in a place"))
def test_what_is_written_for_papers_is_read(table: Path | str, form: Callable[..., bytes], catalog: Catalog) -> None:
    """The arm is the same, with its names, types, bounds, base and tool, and with the convention of the caption."""
    name, text = (table.name, table.read_text()) if isinstance(table, Path) else ("arm.csv", table)
    arm = arm_of(tables_of(name, text.encode(), catalog), catalog)
    typed = form([arm], TableOptions(length_unit="mm", angle_unit="deg")).decode()
    again = arm_of(pasting.whole_tables(typed, catalog), catalog)
    assert again.convention == arm.convention
    for new, old in zip(again.rows, arm.rows, strict=True):
        assert (new.joint, new.type, new.sign) == (old.joint, old.type, old.sign)
        numbers = [(row.a, row.alpha, row.d, row.theta, row.offset) for row in (new, old)]
        assert numbers[0] == pytest.approx(numbers[1], abs=1e-12)
        if old.limits is not None:
            bounds = [(row.limits.lower, row.limits.upper) for row in (new, old)]
            assert bounds[0] == pytest.approx(bounds[1], abs=1e-12)
    for place, old_place in ((again.base, arm.base), (again.tool, arm.tool)):
        assert place.translation == pytest.approx(old_place.translation, abs=1e-12)
        assert place.rpy == pytest.approx(old_place.rpy, abs=1e-12)
