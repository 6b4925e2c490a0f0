"""Pasted tables of papers, pages and YAML files are the arms that they show."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from dh2urdf_plugins.emitters.table.notation import latex_file, markdown_file
from dh2urdf_plugins.emitters.table.options import TableOptions
from dh2urdf_studio.editing.opening import tables_of
from dh2urdf_studio.editing.reading import read_whole
from dh2urdf_studio.pasting import cells_of, whole_tables
from dh2urdf_studio.pasting.typeset import typeset

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.plugin_system import Catalog

TABLES = sorted((Path(__file__).parents[3] / "configs" / "tables").glob("*.[cy]*"))
CODED = [["0", "0.1", "pi/2", "0"], ["0", "-0.2", "0", "0.5"]]
IN_A_PLACE = """# convention: standard
# base: {xyz: [0, 0, 0.3], rpy: [0, 0, pi]}
# tool: {xyz: [0, 0.1, 0]}
joint,type,a,alpha,d,theta,lower,upper
waist_1,R,0.1,pi/2,0.2,-q + pi/4,-3*pi/4,1
slide,P,0.3,-1.1,0.4 - q,0.7,0,0.75
last,fixed,0,pi,0.05,pi/3,,
"""


FIXED_BEFORE = """# convention: standard
joint,type,a,alpha,d,theta,lower,upper
"#1",P,0.3,-1.1,0.4 + q,0.7,0,0.75
d2,fixed,0,pi,0.05,pi/3,,
"#3",P,0.1,pi/2,0.2 + q,0,0,1
q3,R,0.1,pi/2,0.2,-q + pi/4,-3*pi/4,1
"""


def arm_of(found: Any, catalog: Catalog) -> Manipulator:
    assert isinstance(found, tuple), found
    ((table, *_),) = found
    arm = read_whole(table, catalog).manipulator
    assert arm is not None
    return arm


@pytest.mark.parametrize("form", [latex_file, markdown_file])
@pytest.mark.parametrize("units", [("m", "rad"), ("mm", "deg")])
@pytest.mark.parametrize(
    "table",
    [*TABLES, IN_A_PLACE, FIXED_BEFORE],
    ids=lambda table: getattr(table, "name", "fixed" * ("#1" in str(table))),
)
def test_what_is_written_for_papers_is_read(
    table: Path | str, units: tuple[str, str], form: Callable[..., bytes], catalog: Catalog
) -> None:
    """The arm is the same, with its names, types, bounds, base and tool, and with the convention of the caption."""
    name, text = (table.name, table.read_text()) if isinstance(table, Path) else ("arm.csv", table)
    arm = arm_of(tables_of(name, text.encode(), catalog), catalog)
    length, angle = units
    typed = form([arm], TableOptions(length_unit=length, angle_unit=angle)).decode()
    again = arm_of(whole_tables(typed, catalog), catalog)
    assert again.convention == arm.convention
    assert [row.joint for row in again.rows] == [row.joint for row in arm.rows]
    for new, old in zip(again.rows, arm.rows, strict=True):
        assert (new.type, new.sign) == (old.type, old.sign)
        numbers = [(row.a, row.alpha, row.d, row.theta, row.offset) for row in (new, old)]
        assert numbers[0] == pytest.approx(numbers[1], abs=1e-12)
        if old.limits is not None:
            assert new.limits is not None
            bounds = [(row.lower, row.upper) for row in (new.limits, old.limits)]
            assert bounds[0] == pytest.approx(bounds[1], abs=1e-12)
    for place, old_place in ((again.base, arm.base), (again.tool, arm.tool)):
        assert place.translation == pytest.approx(old_place.translation, abs=1e-12)
        assert place.rpy == pytest.approx(old_place.rpy, abs=1e-12)


PAPER = r"""
\begin{table}[h]
\caption{D-H parameters of the arm}  % and no word of the convention
\begin{tabular}{|c|c|c|c|c|} \hline
$i$ & $\alpha_i$ (deg) & $a_i$ (mm) & $d_i$ (mm) & $\theta_i$ \\ [0.5ex] \hline\hline
1 & $-90^{\circ}$ & $0$ & \textbf{105.5} & $\theta_1$ \\ \cline{1-2}
2 & $90$ & $4.25 \times 10^{2}$ & 0 & $\theta_2 - \frac{\pi}{2}$ \\
\end{tabular}
\end{table}
"""


def test_a_table_of_a_paper(catalog: Catalog) -> None:
    """Rules, formulas and bold type; what the text does not say is not guessed."""
    found = typeset(PAPER)
    assert found is not None
    assert found.rows == [
        ["i", "alpha_i (deg)", "a_i (mm)", "d_i (mm)", "theta_i"],
        ["1", "-90°", "0", "105.5", "theta_1"],
        ["2", "90", "4.25e2", "0", "theta_2 - pi/2"],
    ]
    opened = whole_tables(PAPER, catalog)
    assert isinstance(opened, tuple)
    assert opened[0].table.convention == ""
    arm = arm_of(whole_tables(PAPER, catalog, "standard"), catalog)
    assert [row.a for row in arm.rows] == [0.0, 0.425]
    assert arm.rows[1].theta + arm.rows[1].offset == pytest.approx(-1.5707963267948966, abs=1e-15)


@pytest.mark.parametrize(
    ("text", "cells"),
    [
        ("1 0 90 0.1\n2 0.3 -90 0\n", [["1", "0", "90", "0.1"], ["2", "0.3", "-90", "0"]]),
        ("0,1   -π/2  .5 θ1", [["0.1", "-π/2", ".5", "θ1"]]),
        ("0 –90\N{WHITE BULLET} 1", [["0", "–90\N{WHITE BULLET}", "1"]]),
        (r"0.1 & $\dfrac{\pi}{2}$ & $-2\pi$ \\", [["0.1", "pi/2", "-2*pi"]]),
        (r"0.1 & $\nicefrac{\pi}{2}$ & $-\sfrac{\pi}{4}$ \\", [["0.1", "pi/2", "-pi/4"]]),
        (r"0.1 & $\boldsymbol{\pi}$ & \multirow{2}{*}{$q_{1}$} \\", [["0.1", "pi", "q_1"]]),
        (r"0{,}425 & {-}0{,}1 \\", [["0.425", "-0.1"]]),  # as German papers have a decimal comma
        (r"\multicolumn{2}{c}{0.3} & 0.1 & 0 \\", [["0.3", "", "0.1", "0"]]),
        ("| 0.1<sup>1</sup> | 90<sup>o</sup> | a<br>b |", [["0.1^1", "90°", "a b"]]),
        (r"1 & \unknown{2} \\", [["1", r"\unknown2"]]),  # the reader names what it does not know
        ("-425 mm", [["-425 mm"]]),
        ("0.1 + 0.2\n0.3 + 0.4", [["0.1 + 0.2"], ["0.3 + 0.4"]]),
        ("0.1 0.2\n0.3", [["0.1 0.2"], ["0.3"]]),
        ("0 1.57 0.1\n0.4 x 0", [["0 1.57 0.1"], ["0.4 x 0"]]),  # a slip is no text below a table
        ("shoulder 0 pi/2 0.1\nelbow 0.4 0 0", [["shoulder", "0", "pi/2", "0.1"], ["elbow", "0.4", "0", "0"]]),
        ("[[0, 1.5708, 0.09],\n [-0.425, 0, 0]]", [["0", "1.5708", "0.09"], ["-0.425", "0", "0"]]),
        ("dh = np.array([\n  [0, np.pi/2, 1],  # one\n  [2, 0, 0],\n])\n", [["0", "pi/2", "1"], ["2", "0", "0"]]),
        ("[(0, 0.1, pi/2, 0), (0, -0.2, 0, 0.5)]", CODED),
        ("dh_params = (\n    (0, 0.1, math.pi/2, 0),  # joint 1\n    (0, -0.2, 0, 0.5),\n)", CODED),
        ("(0, 0.1, pi/2, 0),\n(0, -0.2, 0, 0.5)", CODED),
        ("[0, 0.1, pi/2, 0],\n[0, -0.2, 0, 0.5],", CODED),
        ("DH = np.array([[0, 0.1, np.pi/2, 0],\n               [0, -0.2, 0, 0.5]], dtype=np.float64)", CODED),
        ("T = sp.Matrix([[0, 0.1, sp.pi/2, 0], [0, -0.2, 0, 0.5]])", CODED),
        ("DH = [ 0   0.1  pi/2  0 ; ...\n       0  -0.2  0   0.5 ];", CODED),
        ("double dh[2][4] = {{0, 0.1, M_PI/2, 0}, {0, -0.2f, 0, 0.5f}};", CODED),
        ("static constexpr double DH[2][4] = {\n  {0, 0.1, M_PI_2, 0}, // shoulder\n  {0, -0.2, 0, 0.5},\n};", CODED),
        ("{0, 0.1, Pi/2, 0},\n{0, -0.2, 0, 0.5}", CODED),
        ("Eigen::MatrixXd dh(2, 4);\ndh << 0, 0.1, M_PI/2, 0,\n      0, -0.2, 0, 0.5;", CODED),
        (
            "dh = [('waist', 0.1, deg2rad(90), 1), ('elbow', 2, 0, 0)]",
            [["waist", "0.1", "90°", "1"], ["elbow", "2", "0", "0"]],
        ),
        ("DH = [0 pi/2 0.089; -0.425 0 0];  ", [["0", "pi/2", "0.089"], ["-0.425", "0", "0"]]),
        ("[0.5]", [["[0.5]"]]),
    ],
)
def test_cells_without_a_header(text: str, cells: list[list[str]], catalog: Catalog) -> None:
    """Spaces are between cells only where nothing but numbers is there, and as many in every line."""
    assert cells_of(text) == cells
    assert whole_tables(text, catalog) == ()


@pytest.mark.parametrize(
    "text",
    [
        "dh = np.array([[0, 0.1], [1, 2]]).T",
        "dh = [0 0.1; 1 2]';",
        "dh = np.deg2rad([[0, 90], [1, 2]])",
        "dh = [0 90; 1 2]*pi/180;",
        "dh = 0.001 * np.array([[0, 90], [1, 2]])",
        "dh = [[0, 0.1], [1]]",
    ],
)
def test_an_array_that_is_changed_where_it_is_made_is_none(text: str) -> None:
    """Its numbers would be others, or in other places."""
    assert typeset(text) is None
    assert all("[" in cell or "]" in cell or len(row) == 1 for row in cells_of(text) for cell in row[:1])


@pytest.mark.parametrize(
    ("text", "row"),
    [
        (
            "# theta, d, a, alpha\ndh = [\n  [0.1, 0.2, 0.3, pi/2],  # joint 1\n  [0.4, 0.5, 0.6, 0],\n]",
            {"theta": "0.1", "d": "0.2", "a": "0.3", "alpha": "pi/2"},
        ),
        (
            "%  theta_i   d_i[mm]   a_i[mm]  alpha_i\nDH = [0.1 200 300 pi/2\n      0.4 0 0 0];",
            {"theta": "0.1", "d": "200", "a": "300", "alpha": "pi/2"},
        ),
        (
            "double dh[2][4] = { // a, alpha, d, theta\n  {0.3, M_PI_2, 0.2, 0.1},\n  {0.6, 0, 0, 0}};",
            {"theta": "0.1", "d": "0.2", "a": "0.3", "alpha": "pi/2"},
        ),
    ],
)
def test_a_comment_names_the_columns_of_an_array(text: str, row: dict[str, str], catalog: Catalog) -> None:
    """Their order is that of the comment, and not that of the screen."""
    found = whole_tables(text, catalog, "standard")
    assert isinstance(found, tuple), found
    ((table, *_),) = found
    assert row.items() <= dict(table.rows[0]).items()


SIX = {
    "paper": "Link θ d a α\n1 θ1 0.0892 0 π/2\n2 θ2 0 – 0.425 0\n3 θ3 – π/2 0.109 − 0.392 0\n",
    "org": "| i | theta | d | a | alpha |\n|---+-------+---+---+-------|\n| 1 | q1 | 0.0892 | 0 | pi/2 |\n"
    "| 2 | q2 | 0 | -0.425 | 0 |\n| 3 | q3-pi/2 | 0.109 | -0.392 | 0 |\n",
    "joints in a list": "- {a: 0, alpha: pi/2, d: 0.0892, theta: q1}\n- {a: -0.425, alpha: 0, d: 0, theta: q2}\n"
    "- {a: -0.392, alpha: 0, d: 0.109, theta: q3 - pi/2}",
    "dictionaries": "[{'a': 0, 'alpha': 'pi/2', 'd': 0.0892},\n {'a': -0.425, 'alpha': 0, 'd': 0},\n"
    " {'a': -0.392, 'alpha': 0, 'd': 0.109, 'offset': '-pi/2'}]",
    "columns": "a = [0, -0.425, -0.392]\nalpha = [pi/2, 0, 0]\nd = [0.0892, 0, 0.109]\ntheta = [0, 0, -pi/2]",
    "columns of MATLAB": "p.a = [0 -0.425 -0.392]; % m\np.alpha = [pi/2 0 0];\np.d = [0.0892 0 0.109];\np.theta = [0 0 -pi/2];",
    "a header inside": "DH = [\n    # a,     alpha,  d,      theta\n    (0,      pi/2,   0.0892, 0),\n"
    "    (-0.425, 0,      0,      0),  # upper arm\n    (-0.392, 0,      0.109,  -pi/2),\n]",
    "a header with units": "// alpha[deg] a[mm] theta[deg] d[mm]\n"
    "float dh[3][4] = {{90, 0, 0, 89.2},{0,-425,0,0},{0,-392,-90,109}};",
    "a line of braces": r"a & $\alpha$ & d & $\theta$ \\ 0\footnote{all lengths in m} & $\frac\pi2$ & 0.0892~m & $\theta_1$ \\"
    "\n"
    r"\rowcolor{gray!20} -0.425\tnote{a} & 0 & 0 & $\theta_2$ \\ -0.392~\cite{ur} & 0 & 0.109 & $\theta_3-\frac12\pi$ \\",
    "KaTeX": "| a | α | d | θ |\n|--|--|--|--|\n| 0 | $\\frac\\pi2$ | 0.0892 | $\\theta_1$ |\n| -0.425 | \\(0\\) | 0 | \\(\\theta_2\\) |\n"
    "| -0.392 | $0$ | 0.109 | $\\theta_3-\\dfrac{\\pi}2$ |\n",
    "AsciiDoc": '.DH parameters\n[%header,cols="5*^"]\n|===\n|i |a |alpha |d |theta\n\n|1 |0 |stem:[pi/2] |0.0892 |q1\n'
    "|2\n|-0.425\n|0\n|0\n|q2\n>|3 h|-0.392 |0 |0.109 |q3 -\npi/2\n|===\n",
    "AsciiDoc without columns": "|===\n|a|alpha|d|theta\n\n|0|pi/2|0.0892|q1|-0.425|0|0|q2\n|-0.392|0|0.109|q3-pi/2\n|===\n",
    "Jira": "||a||alpha||d||theta||\n|0|pi/2|0.0892|q1|\n|-0.425|0|0|q2|\n|-0.392|0|0.109|q3-pi/2|\n",
    "a table of MATLAB": "      a       alpha      d       theta \n    ______    _____    ______    ______\n\n"
    "         0     pi/2    0.0892     q1\n    -0.425        0         0     q2\n    -0.392        0     0.109  q3-pi/2\n",
    "joints in columns": "Joint\t1\t2\t3\na\t0\t-0.425\t-0.392\nalpha\tpi/2\t0\t0\nd\t0.0892\t0\t0.109\ntheta\tq1\tq2\tq3-pi/2\n",
    "joints in columns, with names": "| | J1 | J2 | J3 |\n|--|--|--|--|\n| $a_i$ [mm] | 0 | -425 | -392 |\n| $\\alpha_i$ [°] | 90 | 0 | 0 |\n"
    "| $d_i$ [mm] | 89.2 | 0 | 109 |\n| θ [°] | θ1 | θ2 | θ3-90 |\n",
    "joints in columns of numbers": "# units: {length: mm}\nd,89.2,0,109\na,0,-425,-392\nalpha,pi/2,0,0\ntheta,0,0,-pi/2\n",
    "joints in columns of LaTeX": r"\begin{tabular}{c|ccc} $i$ & 1 & 2 & 3 \\ \hline $a_i$ & 0 & -0.425 & -0.392 \\"
    r"$\alpha_i$ & $\nicefrac{\pi}{2}$ & 0 & 0 \\ $d_i$ & 0.0892 & 0 & 0.109 \\ $\theta_i$ & 0 & 0 & $\frac{-\pi}{2}$ \end{tabular}",
    "other signs": "a\talpha\td\ttheta\n0\tπ/2\t0.0892\t0\n‒0.425\t0\t0\t0\n﹣0.392\t0\t0.109\t－π/2\n",
}


def product(*rows: tuple[float, float, float, float]) -> Any:
    """The standard product of rows of a, alpha, d, theta."""
    pose = np.eye(4)
    for a, alpha, d, theta in rows:
        (ct, st), (ca, sa) = ((np.cos(angle), np.sin(angle)) for angle in (theta, alpha))
        pose = pose @ np.array(
            [[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0, sa, ca, d], [0, 0, 0, 1]]
        )
    return pose


@pytest.mark.parametrize("text", SIX.values(), ids=SIX)
def test_forms_of_papers_and_programs_are_the_arm_that_they_show(text: str, catalog: Catalog) -> None:
    """They were refused, or cells of other columns."""
    arm = arm_of(whole_tables(text, catalog, "standard"), catalog)
    q = (0.3, -0.7, 1.1)
    meant = product((0.0, np.pi / 2, 0.0892, q[0]), (-0.425, 0.0, 0.0, q[1]), (-0.392, 0.0, 0.109, q[2] - np.pi / 2))
    assert np.abs(arm.fk(np.array([q]))[0] - meant).max() < 1e-12


@pytest.mark.parametrize(
    ("cell", "number"),
    [
        (r"$\frac{1}{2\pi}$", 1 / (2 * np.pi)),  # it was pi/2
        (r"$2\frac{\pi}{3}$", 2 * np.pi / 3),
        (r"$\frac{2\pi}3$", 2 * np.pi / 3),
        (r"$-\frac{\sqrt{3}}{2}$", -(3**0.5) / 2),
        ("2π", 2 * np.pi),
        ("-3π/2", -3 * np.pi / 2),
        ("0.5pi", np.pi / 2),
    ],
)
@pytest.mark.parametrize(
    "form", ["| a | α | d |\n|--|--|--|\n| 0 | %s | 1 |\n| 1 | 0 | 0 |\n", "a\tα\td\n0\t%s\t1\n1\t0\t0\n"]
)
def test_products_and_fractions(cell: str, number: float, form: str, catalog: Catalog) -> None:
    if "|" not in form:
        cell = cells_of(f"0 & {cell} \\\\")[0][1]
    arm = arm_of(whole_tables(form % cell, catalog, "standard"), catalog)
    assert arm.rows[0].alpha == pytest.approx(number, abs=1e-15)


def test_a_footnote_is_read_as_a_comment_is(catalog: Catalog) -> None:
    """Its unit counts."""
    table = r"a & $\alpha$ & d \\ 100\footnote{All lengths in {mm}} & 0 & 5 \\ 200 & 0 & 0 \\"
    assert [row.a for row in arm_of(whole_tables(table, catalog, "standard"), catalog).rows] == [0.1, 0.2]


MILLIMETRES = ("mm", "deg")


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("a\talpha\td\n100\t90\t2\n", MILLIMETRES),
        ("| a | alpha | d |\n|--|--|--|\n| 100 | 90 | 2 |\n", MILLIMETRES),
        ("- {a: 100, alpha: 90, d: 2}\n", MILLIMETRES),
        ("---\njoints:\n- {a: 100, alpha: 90, d: 2}\n", MILLIMETRES),
        ('{"joints": [{"a": 100, "alpha": 90, "d": 2}]}', MILLIMETRES),
        ("a [m]\talpha\td [m]\n100\t90\t2\n", ("m", "deg")),
        ("a\talpha [rad]\td\n100\t1\t2\n", ("mm", "rad")),
        ("# units: {length: m, angle: rad}\na\talpha\td\n100\t90\t2\n", ("m", "rad")),
        ("joints:\n- {a: 100, alpha: 1, d: 2}\nunits: {length: cm}\n", ("cm", "rad")),
    ],
)
def test_a_table_without_units_has_those_of_the_page(text: str, units: tuple[str, str], catalog: Catalog) -> None:
    """It was in metres and radians, though a person had chosen millimetres and degrees."""
    found = whole_tables(text, catalog, "standard", MILLIMETRES)
    assert isinstance(found, tuple), found
    ((table, *_),) = found
    assert (table.length_unit, table.angle_unit) == units


@pytest.mark.parametrize("sign", ["#", "%", "//"])
def test_comments_beside_columns_are_comments_of_the_table(sign: str, catalog: Catalog) -> None:
    """They were lost: a modified table was a standard one, and millimetres were metres."""
    text = f"{sign} modified DH\na = [0, 300] {sign} mm\nalpha = [0, 90]; {sign} [deg]\nd = [100, 0] {sign} in mm"
    arm = arm_of(whole_tables(text, catalog, "standard"), catalog)
    assert str(arm.convention) == "modified"
    assert [(row.a, row.alpha, row.d) for row in arm.rows] == [(0, 0, 0.1), (0.3, np.pi / 2, 0)]
    text = text.replace(
        "300]", "\n300]"
    )  # the unit is behind no whole column: nothing but the reader knows what it means
    assert "mm" in str(whole_tables(text, catalog, "standard"))


@pytest.mark.parametrize("sentence", ["All lengths in mm", "Lengths in mm.", "Unit of lengths: mm"])
def test_a_sentence_below_a_table_is_no_joint(sentence: str, catalog: Catalog) -> None:
    """A spreadsheet copies its row with the empty cells behind it; it was a joint of that name. A joint stays."""
    table = "Joint\ta\talpha\td\n1\t300\t0\t1\n2\t0\t0\t5\n%s\t\t\t\n"
    assert "mm" in str(found := whole_tables(table % sentence, catalog, "standard"))
    assert isinstance(found, str) or [row.a for row in arm_of(found, catalog).rows] == [0.3, 0]
    ((joints, *_),) = whole_tables(table % "upper arm", catalog, "standard")
    assert [row["joint"] for row in joints.rows] == ["1", "2", "upper arm"]


def test_a_comment_beside_an_array_is_a_comment_of_the_table(catalog: Catalog) -> None:
    """It may say the convention, a unit or a type."""
    text = "# modified DH, mm\n# a, alpha, d\ndh = [(300, pi/2, 0), (0, 0, 100)]"
    arm = arm_of(whole_tables(text, catalog, "standard"), catalog)
    assert str(arm.convention) == "modified"
    assert [row.a for row in arm.rows] == [0.3, 0]
    found = whole_tables("# a, alpha, d\ndh = [(300, pi/2, 0), # prismatic\n (0, 0, 100)]", catalog, "standard")
    assert "speaks of a prismatic joint" in str(found)


@pytest.mark.parametrize(
    ("text", "told", "row"),
    [
        (
            "Table 1: DH parameters of the UR5\nJoint a [m] α [rad] d [m] θ [rad]\n1 0 π/2 0.089 θ1\n2 -0.425 0 0 θ2\n",
            ("standard", "m", "rad"),
            {"a": "-0.425", "alpha": "0", "d": "0", "theta": "θ2"},
        ),
        (
            "Modified DH parameters\ni a alpha d theta\n1 0 0 333 q1\n2 0 -90° 0 q2\nLengths in mm\n",
            ("modified", "mm", "rad"),
            {"joint": "joint_2", "a": "0", "alpha": "-90°", "d": "0", "theta": "q2"},
        ),
        (
            "Kinematics theta [rad] a [m] d [m] alpha [rad]\nJoint 1 0 0 0.1625 π/2\nJoint 2 0 -0.425 0 0\n",
            ("standard", "m", "rad"),
            {"joint": "joint_2", "theta": "0", "a": "-0.425", "d": "0", "alpha": "0"},
        ),
    ],
    ids=["caption", "units below", "names of two words"],
)
def test_a_table_of_a_pdf(text: str, told: tuple[str, ...], row: dict[str, str], catalog: Catalog) -> None:
    """Lines of text around numbers with spaces between them are a caption, and what they say counts."""
    ((table, *_),) = whole_tables(text, catalog, "standard")
    assert (table.convention, table.length_unit, table.angle_unit) == told
    assert row.items() <= table.rows[1].items()


GITHUB = """&alpha;   | a      | d    | &theta;
:--------:|:------:|:----:|:-------:
0         | 0      | 0.75 | q&#8321;
-&pi;/2   | 0.35   | 0    | q&#8322;-&pi;/2
"""
BOLD = """| **i** | **&alpha;<sub>i-1</sub> (°)** | *a<sub>i-1</sub>* (mm) | `d` (mm) | __θ__ (°) |
|:--:|--|--|--|--|
| **1** | 0 | 0 | `750` | θ<sub>1</sub><sup>*</sup> |
| 2 | −90° | 350 | 0 | θ<sub>2</sub> − 90° |
"""
FORMULAS = r"""| $i$ | $\alpha_{i-1}$ | $a_{i-1}$ | $d_{i}$ | $\theta_{i}$ |
|:---:|---|---|---|---|
| 1 | $0$ | $0$ | $0.75$ | $\theta_{1}^{*}$ |
| 2 | $-\frac{\pi}{2}$ | $0.35$ | $0$ | $\theta_{2}^\ast-\frac{\pi}{2}$ |
"""
UNRULED = "i | alpha | a | d | theta |\n1 | 0 | 0 | 0.75 | q1 |\n2 | -pi/2 | 0.35 | 0 | q2-pi/2 |\n"
TITLED = f"| KR 210 | | | |\n|--|--|--|--|\n| alpha | a | d | theta |\n{GITHUB.split(chr(10), 2)[2]}"
BOX = """DHRobot: KR210, 2 joints (RR), modified DH parameters
┌───────┬────────┬──────────────┬───────┐
│ aⱼ₋₁  │  ⍺ⱼ₋₁  │      θⱼ      │  dⱼ   │
├───────┼────────┼──────────────┼───────┤
│   0.0 │   0.0° │           q1 │  0.75 │
│  0.35 │ -90.0° │     q2 - 90° │   0.0 │
└───────┴────────┴──────────────┴───────┘
"""
RULES = "=====  ====  ====  =======\nalpha  a     d     theta\n=====  ====  ====  =======\n"
RULES += "0      0     0.75  q1\n-pi/2  0.35  0     q2-pi/2\n=====  ====  ====  =======\n"
ALIGNED = "alpha (°)   a (mm)   d (mm)   theta (°)\n0      0     750  q1\n-90  350  0     θ2−90\n"
SIUNITX = r"""\begin{tabular}{SSSc}
{$\alpha_{i-1}$ [\si{\degree}]} & {$a_{i-1}$ / \si{\milli\metre}} & {$d_i$ (\unit{\mm})} & {$\theta_i$} \\
\ang{0} & \num{0} & \SI{0.75}{\metre} & $\theta_1$ \\
-90 & \qty{350}{\mm} & 0 & $\theta_2 - \ang{90}$ \\
\end{tabular}"""
UNITS_BELOW = "α\ta\td\tθ\n[°]\t[mm]\t[mm]\t[°]\n0\t0\t750\tq1\n-90\t350\t0\tq2-90\n"


@pytest.mark.parametrize(
    "text",
    [GITHUB, BOLD, FORMULAS, UNRULED, TITLED, BOX, RULES, ALIGNED, SIUNITX, UNITS_BELOW],
    ids=["GitHub", "bold", "formulas", "no rule", "title", "box", "reStructuredText", "aligned", "siunitx", "units"],
)
def test_tables_as_pages_and_programs_show_them(text: str, catalog: Catalog) -> None:
    """Two rows of a KR 210: as cells of one column each, the lines would not be an arm."""
    arm = arm_of(whole_tables(text, catalog, "modified"), catalog)
    rows = [(row.a, row.alpha, row.d, row.theta + row.offset) for row in arm.rows]
    quarter = 1.5707963267948966
    assert rows == [
        pytest.approx((0.0, 0.0, 0.75, 0.0), abs=1e-15),
        pytest.approx((0.35, -quarter, 0.0, -quarter), abs=1e-15),
    ]


@pytest.mark.parametrize("model", ["Puma560", "Panda"])
def test_what_the_robotics_toolbox_prints(model: str, catalog: Catalog) -> None:
    """Its convention, rows and limits, as it has them itself; it prints angles to a tenth of a degree."""
    toolbox = pytest.importorskip("roboticstoolbox")
    robot = getattr(toolbox.models.DH, model)()
    arm = arm_of(whole_tables(str(robot).split("\n\n")[0], catalog), catalog)
    assert arm.convention == ("modified" if robot.mdh else "standard")
    for row, link in zip(arm.rows, robot.links, strict=True):
        assert (row.a, row.d) == pytest.approx((link.a, link.d), abs=5e-5)
        assert row.alpha == pytest.approx(link.alpha, abs=1e-3)
        assert (row.limits.lower, row.limits.upper) == pytest.approx(tuple(link.qlim), abs=1e-2)


@pytest.mark.parametrize(
    ("before", "behind", "said"),
    [
        ("DH parameters of the arm (lengths in mm, angles in degrees):", "", "mentions mm"),
        ("", "Note: joint 2 is prismatic.", "speaks of a prismatic joint"),
        (r"\begin{table}\caption{DH parameters in mm}", r"\end{table}", "mentions mm"),
    ],
)
def test_what_the_text_around_a_table_says_is_not_lost(before: str, behind: str, said: str, catalog: Catalog) -> None:
    """Lengths were read in metres, and joints that slide as joints that turn."""
    table = "| i | a | alpha | d |\n|---|---|---|---|\n| 1 | 0 | 0 | 100 |\n| 2 | 0 | 0 | 100 |"
    found = whole_tables(f"{before}\n\n{table}\n\n{behind}\n", catalog, "standard")
    assert isinstance(found, str)
    assert said in found


@pytest.mark.parametrize("first", ["pi/2\tpi/2", "q1\tpi", "θ1-90°\t2*pi"])
def test_cells_whose_first_line_has_expressions_have_no_header(first: str, catalog: Catalog) -> None:
    """They were taken for a header that nobody knows, and refused."""
    text = f"{first}\n0.1\t0.2\n"
    assert whole_tables(text, catalog, "standard") == ()
    assert cells_of(text) == [first.split("\t"), ["0.1", "0.2"]]


COMMENTS = "# convention: modified\n# units: {length: mm, angle: deg}\n# tool: {xyz: [0, 0, 50]}\n"


@pytest.mark.parametrize(
    "table",
    [
        "| a | alpha | d |\n|---|---|---|\n| 100 | 90 | 200 |\n| 300 | 0 | 0 |\n",
        "a alpha d\n100 90 200\n300 0 0\n",
        "a & alpha & d \\\\\n100 & $90^\\circ$ & 200 \\\\\n300 & 0 & 0 \\\\\n",
        "a,alpha,d\n100,90,200\n300,0,0\n",
    ],
    ids=["Markdown", "spaces", "LaTeX", "CSV"],
)
def test_comments_above_a_table_are_kept(table: str, catalog: Catalog) -> None:
    """Without them lengths would be metres."""
    arm = arm_of(whole_tables(COMMENTS + table, catalog), catalog)
    assert arm.convention == "modified"
    assert [(row.a, row.d) for row in arm.rows] == [(0.1, 0.2), (0.3, 0.0)]
    assert arm.rows[0].alpha == pytest.approx(1.5707963267948966, abs=1e-15)
    assert arm.tool.translation == (0.0, 0.0, 0.05)


def test_comments_above_cells_are_not_lost(catalog: Catalog) -> None:
    """Cells have no place for them, so the text is a table, whose header is missing."""
    found = whole_tables("# units: {length: mm}\n100 90 200\n300 0 0\n", catalog)
    assert isinstance(found, str)
    assert "no header" in found


def test_a_header_of_words(catalog: Catalog) -> None:
    arm = arm_of(whole_tables("i a alpha d\n1 0.1 pi/2 0.2\n2 0.3 0 0\n", catalog, "modified"), catalog)
    assert [(row.a, row.d) for row in arm.rows] == [(0.1, 0.2), (0.3, 0.0)]


@pytest.mark.parametrize("table", [table for table in TABLES if table.suffix == ".yaml"], ids=lambda table: table.name)
def test_a_yaml_table(table: Path, catalog: Catalog) -> None:
    assert arm_of(whole_tables(table.read_text(), catalog), catalog).rows == (
        arm_of(tables_of(table.name, table.read_bytes(), catalog), catalog).rows
    )
    assert "clipboard.yaml" in str(whole_tables("convention: standard\njoints: [{a: x}]\n", catalog))


@pytest.mark.parametrize(
    "table",
    [
        (
            '{| class="wikitable"\n|+ Modified DH\n|-\n! i !! a [m] !! alpha !! d [m] !! theta\n|-\n'
            "| 1 || 0.1 || {\\pi/2} || 0 || θ1\n|-\n| 2 || -0.2 || 0 || 0.5 || θ2\n|}\n"
        ),
        (
            'The table:\n{|\n! scope="col" | i\n! a\n! <math>\\alpha</math>\n! d\n! θ\n|- style="text-align:right"\n'
            '| 1\n| style="color:red" | 0.1\n| <math>\\pi/2</math>\n| 0\n| θ<sub>1</sub>\n|-\n'
            "| 2\n| −0.2\n| 0\n| 0.5\n| θ<sub>2</sub>\n|}\n"
        ),
    ],
)
def test_a_table_of_mediawiki(table: str, catalog: Catalog) -> None:
    """The source of a table of Wikipedia, in both forms of its rows; its lines went into one cell each."""
    found = whole_tables(table, catalog, "modified")
    assert not isinstance(found, str), found
    arm = read_whole(found[0].table, catalog).manipulator
    assert arm is not None
    assert [(row.a, row.alpha, row.d) for row in arm.rows] == [(0.1, np.pi / 2, 0.0), (-0.2, 0.0, 0.5)]
    assert arm.convention == "modified"
