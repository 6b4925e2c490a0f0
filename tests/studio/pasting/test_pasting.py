"""Pasted texts: cells of spreadsheets and of texts, and whole tables with their headers."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from dh2urdf.table_text import TableText
from dh2urdf_studio import pasting
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.reading import read

if TYPE_CHECKING:
    from dh2urdf.plugin_system import Catalog

THREE = edits.with_cells(edits.resized(TableText(), 3), {(0, "a"): "1", (1, "a"): "2", (2, "a"): "3"})
COLUMNS = ("joint", "a", "alpha", "d")


def column(table: TableText, field: str) -> list[str]:
    return [row.get(field, "") for row in table.rows]


def test_cells_of_a_spreadsheet() -> None:
    """Lines of cells go in from the cursor on, rows are added for them, and what is too wide is counted."""
    put = pasting.pasted(THREE, 2, "a", "0.1\tpi/2\t0.2\tbeyond\r\n0.3\t0\t\r\n", COLUMNS)
    assert column(put.table, "a") == ["1", "2", "0.1", "0.3"]
    assert column(put.table, "alpha") == ["", "", "pi/2", "0"]
    assert column(put.table, "d") == ["", "", "0.2", ""]
    assert put.left_out == 1


def test_more_rows_than_a_table_may_have() -> None:
    put = pasting.pasted(THREE, 0, "a", "1\n" * (edits.MOST_ROWS + 5), COLUMNS)
    assert len(put.table.rows) == edits.MOST_ROWS
    assert put.left_out == 5


@pytest.mark.parametrize(
    ("text", "cells"),
    [
        ("1\t2\n3\t4", [["1", "2"], ["3", "4"]]),
        ("1, 2\n3, 4", [["1", "2"], ["3", "4"]]),
        ("1;2", [["1", "2"]]),
        ("0,5;2", [["0.5", "2"]]),
        ("0,5\t1,25", [["0.5", "1.25"]]),
        ("0,5;1.25", [["0,5", "1.25"]]),  # one of them is a slip: the reader says what it thinks of it
        ("0,5\n0,25", [["0.5"], ["0.25"]]),
        ("| 1 | 2 |\n|---|:--:|\n| 3 | 4 |", [["1", "2"], ["3", "4"]]),
        ("atan2(1, 2)\n0", [["atan2(1, 2)"], ["0"]]),
        ("-0.4", [["-0.4"]]),
        ('"-425 mm"\t"90°"\r\n"a\nb"\t"5"""', [["-425 mm", "90°"], ["a b", '5"']]),  # as spreadsheets quote
        ('5"\t3', [['5"', "3"]]),
        ("1,234\t2,000", [["1,234", "2,000"]]),  # these commas may separate thousands: the reader asks
        ("1,234\t0,5", [["1.234", "0.5"]]),
        ("1,234\t−0,5", [["1.234", "−0.5"]]),
        ('"atan2(1, 2)",0', [["atan2(1, 2)", "0"]]),
        ("0.1\t0\r0.2\t1", [["0.1", "0"], ["0.2", "1"]]),
        ("\t0.1 & 0 \\\\\n\t0.2 & 1 \\\\", [["0.1", "0"], ["0.2", "1"]]),
        ("\t0.1 0\n\t0.2 1", [["0.1", "0"], ["0.2", "1"]]),
    ],
)
def test_separators(text: str, cells: list[list[str]]) -> None:
    assert pasting.cells_of(text) == cells


@pytest.mark.parametrize(
    "text",
    [
        "# convention: standard\na,alpha,d\n0.1,pi/2,0.2\n",
        "a\talpha\td\n0.1\tpi/2\t0.2\n",
        "| θ | d | a | α |\n|---|---|---|---|\n| 0 | 0.2 | 0.1 | pi/2 |\n",
    ],
)
def test_a_table_with_a_header(text: str, catalog: Catalog) -> None:
    """It is read as a file would be: columns are known by their names, in any order."""
    found = pasting.whole_tables(text, catalog)
    assert isinstance(found, tuple)
    ((table, *_),) = found
    assert [table.rows[0][field] for field in ("a", "alpha", "d")] == ["0.1", "pi/2", "0.2"]


@pytest.mark.parametrize("text", ["0.1\t0\n0.2\t0", "shoulder\trevolute\nelbow\trevolute", "a", "", "\n"])
def test_cells_have_no_header(text: str, catalog: Catalog) -> None:
    assert pasting.whole_tables(text, catalog) == ()


@pytest.mark.parametrize("cells", ["1.200\t0\t0,5", "0\t−1.200\n0,5\t12,25", "1.200;0,5"])
def test_cells_that_can_be_read_in_two_ways(cells: str, catalog: Catalog) -> None:
    """Beside a decimal comma a point may separate thousands: 1200 mm were 1.2, without a word."""
    assert "can be read in two ways" in str(pasting.whole_tables(cells, catalog))
    assert pasting.whole_tables(cells.replace("1.200", "1.20"), catalog) == ()


@pytest.mark.parametrize("start", [0, 1])
def test_a_column_that_counts_the_rows(start: int, catalog: Catalog) -> None:
    """Without a header, 1, 2 and 3 would be lengths of metres, and all other cells one column to the right."""
    rows = [f"{number}\t0.1\t0\t0.2" for number in range(start, start + 3)]
    assert "counts the rows" in str(pasting.whole_tables("\n".join(rows), catalog))
    for cells in (rows[1:], ["4\t0\t0\t0", *rows], [row.rsplit("\t", 1)[0] for row in rows]):
        assert pasting.whole_tables("\n".join(cells), catalog) == ()


@pytest.mark.parametrize("indent", [None, 2])
def test_json_is_yaml(catalog: Catalog, indent: int | None) -> None:
    """Its lines went into cells."""
    rows = [{"a": 0.1, "alpha": 0, "d": 0.2}, {"a": 0.3, "alpha": 0, "d": 0}]
    found = pasting.whole_tables(json.dumps({"convention": "modified", "joints": rows}, indent=indent), catalog)
    assert isinstance(found, tuple)
    ((table, *_),) = found
    assert (table.convention, [row["a"] for row in table.rows]) == ("modified", ["0.1", "0.3"])


@pytest.mark.parametrize(
    "text",
    [
        'joint,a,alpha,d\n"shoulder, left",0.1,0,0\nelbow,0.3,0,0\n',
        "joint,a,alpha,d\nshoulder,0.1,0,0\n# the first, of two\nelbow,0.3,0,0\n",
        "\ta\talpha\td\nshoulder\t0.1\t0\t0\nelbow\t0.3\t0\t0\n",  # as spreadsheets and pandas name rows
        "          a  alpha  d\nshoulder  0.1  0  0\nelbow  0.3  0  0\n",
        "     a  alpha    d\n0  0.1    0.0  0.0\n1  0.3    0.0  0.0\n",
        "|   | a | alpha | d |\n|---|---|---|---|\n| 0 | 0.1 | 0 | 0 |\n| 1 | 0.3 | 0 | 0 |\n",
        "| # | a | alpha | d |\n|---|---|---|---|\n| 1 | 0.1 | 0 | 0 |\n| 2 | 0.3 | 0 | 0 |\n",
        "#  a    alpha  d\n1  0.1  0      0\n2  0.3  0      0\n",
        "\\# & a & alpha & d \\\\\n1 & 0.1 & 0 & 0 \\\\\n2 & 0.3 & 0 & 0 \\\\\n",
        "# & a & alpha & d \\\\\n1 & 0.1 & 0 & 0 \\\\\n2 & 0.3 & 0 & 0 \\\\\n",
        "Table 1: DH parameters\n#;a;alpha;d\n1;0.1;0;0\n2;0.3;0;0\n",
        "---\njoints:\n- {a: 0.1, alpha: 0, d: 0}\n- {a: 0.3, alpha: 0, d: 0}\n",
    ],
)
def test_a_header_is_not_lost(text: str, catalog: Catalog) -> None:
    """Each line went into one cell, or the header was dropped, and the numbers of the rows became lengths."""
    found = pasting.whole_tables(text, catalog, "standard")
    assert isinstance(found, tuple), found
    ((table, *_),) = found
    assert [column(table, field) for field in ("a", "d")] == [["0.1", "0.3"], [table.rows[0]["d"]] * 2]


@pytest.mark.parametrize(
    "text",
    [
        "DH table, lengths in mm\n100 0 0.2\n300 0 0\n",
        "100 0 0.2\n300 0 0\nAll lengths in mm.\n",
        "Lengths in mm:\n100\t0\t0.2\n300\t0\t0\n",
        "Modified convention, in mm:\n\n| 100 | 0 | 0 |\n| 300 | 0 | 0 |\n",
        r"\caption{In mm}\begin{tabular}{ccc} 100 & 0 & 0 \\ 300 & 0 & 0 \\ \end{tabular}",
        "- {a: 0.1, alpha: 0, d: 0, unknown: 1}\n- {a: 0.3, alpha: 0, d: 0}\n",
        '[{"a": 0.1, "alpha": 0, "d": 0, "unknown": 1}]',
        "joint,a,alpha,d,lower,upper\nshoulder,0.1,0,0,-1,1\nelbow,0.2,0,0\n",
        "a,alpha,d\n100,0,0\n# units: {length: mm}\n200,0,0\n",
    ],
)
def test_what_would_be_lost_is_said_first(text: str, catalog: Catalog) -> None:
    """The words around numbers were dropped in silence, and lines went into one cell each."""
    assert isinstance(pasting.whole_tables(text, catalog, "standard"), str)


def test_commands_of_latex_say_nothing(catalog: Catalog) -> None:
    text = r"\begin{table}[h]\centering\begin{tabular}{cc} 0.1 & 0 \\ 0.3 & 1 \\ \end{tabular}\label{tab:dh}\end{table}"
    assert pasting.whole_tables(text, catalog, "standard") == ()
    assert pasting.cells_of(text) == [["0.1", "0"], ["0.3", "1"]]


def test_a_text_that_is_cut_is_no_number(catalog: Catalog) -> None:
    """The first thousand characters of a sum were read as all of it."""
    text = "+1" * edits.LONGEST_TEXT
    table = edits.with_cells(replace(THREE, convention="standard"), {(0, field): text for field in ("a", "alpha", "d")})
    assert {problem.field for problem in read(table, catalog).errors if problem.row == 0} == {"a", "alpha", "d"}


@pytest.mark.parametrize(
    "text",
    [
        "L(1) = Link([0 0.1 0.2 pi/2]);\nL(2) = Link([0 0 0.4 0]);",
        "L(1) = Link('d', 0.1, 'a', 0.2, 'alpha', pi/2);\nrobot = SerialLink(L, 'name', 'x');",
        "robot = DHRobot([\n    RevoluteDH(d=0.1, a=0.2, alpha=pi/2),\n    PrismaticMDH(a=0.4),\n])",
        "Link(d=0.1, a=0, alpha=pi/2),\nLink(d=0, a=0.4, alpha=0),",
        "Link([0 0.1 0 pi/2])\nLink([0 0 0.4 0])",
        "d=0.1, a=0, alpha=pi/2\nd=0, a=0.4, alpha=0",
        "'d', 0.1, 'a', 0, 'alpha', pi/2\n'd', 0, 'a', 0.4, 'alpha', 0",
        "L(1).d = 0.1; L(1).a = 0;\nL(2).d = 0; L(2).a = 0.4;",
        "L1 = [0 0.1 0 pi/2];\nL2 = [0 0 0.4 0];",
        "E1 = ET.tz(0.333) * ET.Rz()\nE2 = ET.Rx(-pi/2) * ET.Rz()",
        "dh_matrix(0, 0.1, 0, pi/2)\ndh_matrix(0, 0, 0.4, 0)",
        "setFixedTransform(jnt1,dhparams(1,:),'dh');\nsetFixedTransform(jnt2,dhparams(2,:),'dh');",
        "chain.addSegment(Segment(Joint(Joint::RotZ), Frame::DH(0.1, pi/2, 0, 0)));",
    ],
)
def test_code_is_no_table(catalog: Catalog, text: str) -> None:
    """Each line of it went into one cell."""
    found = pasting.whole_tables(text, catalog)
    assert isinstance(found, str)
    assert "paste the matrix of its numbers" in found
    assert "dh2urdf.from_roboticstoolbox(robot)" in found


@pytest.mark.parametrize(
    "text",
    [
        "atan2(1, 2)\t0.1\nsqrt(2)*0.1\tcos(pi/3)",
        '"a (m)","alpha (rad)","d (m)"\n"0.1","pi/2","0"',
        "a(i-1) (m, link), alpha(i-1), d\n0.1, pi/2, 0",
        "np.array([[0.1, np.deg2rad(90), 0], [0.4, 0, 0]])",
        '"j1",0.1,0\n"j2",0.4,0',
    ],
)
def test_what_is_no_code(catalog: Catalog, text: str) -> None:
    """Functions that a cell may have, units in brackets, and arrays."""
    assert "code of a program" not in str(pasting.whole_tables(text, catalog))


@pytest.mark.parametrize(
    "text",
    [
        '<?xml version="1.0"?>\n<robot name="arm">\n  <link name="base_link"/>\n</robot>\n',
        '\n<robot name="arm">\n  <link name="base_link"/>\n</robot>',
        "<!-- made by hand -->\n<mujoco>\n</mujoco>",
        "<table><tr><th>a</th><th>alpha</th></tr><tr><td>0.1</td><td>0</td></tr></table>",
    ],
)
def test_markup_is_no_table(catalog: Catalog, text: str) -> None:
    """Each line of it went into one cell."""
    found = pasting.whole_tables(text, catalog)
    assert isinstance(found, str)
    assert "open a robot description as a file" in found


def test_a_header_that_looks_like_code(catalog: Catalog) -> None:
    """A link with its index, and types with their letters."""
    text = "Link (i)\tType\ta [m]\talpha\td [m]\n1\tRevolute (R)\t0.1\tpi/2\t0.2\n2\tRevolute (R)\t0.3\t0\t0\n"
    found = pasting.whole_tables(text, catalog, "standard")
    assert not isinstance(found, str), found
    assert [len(opened.table.rows) for opened in found] == [2]


def test_what_cannot_be_read_is_said(catalog: Catalog) -> None:
    """In the reader's words, by its line, without a folder that nobody knows."""
    found = pasting.whole_tables("# convention: standard\na,alpha,d\n0.1,x,2\n", catalog)
    assert isinstance(found, str)
    assert found.startswith("clipboard.csv:3:")
    assert "'x' cannot be read" in found


@pytest.mark.parametrize(
    "form", ["{0}", "[{0}]", "[1{0}f]", r"\begin{{tabular}}{{cc}}{0}\end{{tabular}}", "a\talpha\td\n1\t0\t0\n{0}"]
)
@pytest.mark.parametrize("atom", [" ", "\t", "\n", "1", "a", "(", "deg2rad(", "a = [", "|", "&", "\\frac{"])
def test_no_clipboard_is_costly(catalog: Catalog, form: str, atom: str) -> None:
    """Twenty thousand characters of one kind: blanks took a minute, digits half of one."""
    text = form.format(atom * (20_000 // len(atom)))
    assert isinstance(pasting.whole_tables(text, catalog), (str, tuple))
    assert pasting.cells_of(text)
