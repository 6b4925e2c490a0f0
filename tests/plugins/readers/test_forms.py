"""Tables in every form, through every way in: the same arm comes out, or one question with the answer in it."""

import gc
import io
import math
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

import dh2urdf
from dh2urdf.errors import Dh2UrdfError, TableError
from dh2urdf_plugins.packages.table import TableOptions as Notation
from dh2urdf_plugins.packages.table.notation import latex_file, markdown_file
from dh2urdf_plugins.readers.sources.texts import all_tables, form_of

TABLES = sorted((Path(__file__).parents[3] / "configs" / "tables").glob("*.[cy]*"))
ROWS = [(0.1, math.pi / 2, 0.2), (0.3, 0.0, 0.0)]

FORMS = {
    "commas": "a,alpha,d\n0.1,pi/2,0.2\n0.3,0,0\n",
    "semicolons": "a;alpha;d\n0,1;pi/2;0,2\n0,3;0;0\n",
    "tabs": "a\talpha\td\n0.1\tpi/2\t0.2\n0.3\t0\t0\n",
    "blanks": "  a   alpha  d\n0.1  pi/2  0.2\n0.3  0  0\n",
    "a data frame": "     a  alpha    d\n0  0.1    pi/2  0.2\n1  0.3    0.0  0.0\n",
    "single blanks": "joint a alpha d\nj1 0.1 pi/2 0.2\nj2 0.3 0 0\n",
    "Markdown": "Some arm:\n\n| a | alpha | d |\n|---|:-:|---|\n| 0.1 | **pi/2** | `0.2` |\n| 0.3 | 0 | 0 |\n",
    "bars of a terminal": "┌───┬───┬───┐\n│ a │ α │ d │\n├───┼───┼───┤\n│ 0.1 │ π/2 │ 0.2 │\n│ 0.3 │ 0 │ 0 │\n└───┴───┴───┘\n",
    "LaTeX": "\\begin{tabular}{|c|c|c|}\\hline\n$a_i$ & $\\alpha_i$ & $d_i$ \\\\ \\hline\n"
    "0.1 & $\\frac{\\pi}{2}$ & 0.2 \\\\\n$0.3$ & 0 & 0 \\\\\n\\end{tabular}\n",
    "rows of LaTeX": "a & alpha & d \\\\\n0.1 & pi/2 & 0.2 \\\\\n0.3 & 0 & 0 \\\\\n",
    "joints in YAML": "joints:\n- {a: 0.1, alpha: pi/2, d: 0.2}\n- {a: 0.3, alpha: 0, d: 0}\n",
    "a list": "- {a: 0.1, alpha: pi/2, d: 0.2}\n- {a: 0.3, alpha: 0, d: 0}\n",
    "JSON": '[{"a": 0.1, "alpha": "pi/2", "d": 0.2}, {"a": 0.3, "alpha": 0, "d": 0}]',
    "a dictionary of Python": "import numpy as np\n# links\nDH = {'a': [0.1, 0.3], 'alpha': [np.pi/2, 0],\n  'd': [0.2, 0]}\n",
    "dictionaries of Python": 'dh = [\n {"a": 0.1, "alpha": "pi/2", "d": 0.2},  # waist\n {"a": 0.3, "alpha": 0, "d": 0},\n]\n',
    "dh_parameters": "dh_parameters:\n- {a: 0.1, alpha: pi/2, d: 0.2}\n- {a: 0.3, alpha: 0, d: 0}\n",
    "columns in YAML": "a: [0.1, 0.3]\nalpha: [pi/2, 0]\nd: [0.2, 0]\n",
    "joints by name": "shoulder: {a: 0.1, alpha: pi/2, d: 0.2}\nelbow: {a: 0.3, alpha: 0, d: 0}\n",
    "a mapping in each joint": "joints:\n- name: x\n  dh: {a: 0.1, alpha: pi/2, d: 0.2}\n"
    "- name: y\n  dh: {a: 0.3, alpha: 0, d: 0}\n",
}
BARE = {
    "numpy": "import numpy as np\nDH = np.array([[0.1, np.pi/2, 0.2],\n  [0.3, 0, 0]], dtype=float)\n",
    "MATLAB": "DH = [ 0.1 pi/2 0.2 ; ...\n  0.3 0 0 ];\n",
    "C": "double dh[2][3] = {{0.1, M_PI/2, 0.2},\n {0.3, 0, 0}};\n",
    "tuples": "[(0.1, pi/2, 0.2),  # waist\n (0.3, 0, 0)]\n",
    "links": "L(1) = Link([0.1 pi/2 0.2]);\nL(2) = Link([0.3 0 0]);\n",
    "commas": "0.1,pi/2,0.2\n0.3,0,0\n",
    "tabs": "0.1\tpi/2\t0.2\n0.3\t0\t0\n",
    "blanks": "0.1 pi/2 0.2\n0.3 0 0\n",
    "lists in YAML": "- [0.1, pi/2, 0.2]\n- [0.3, 0, 0]\n",
}
"""Numbers without names."""


def geometry(arm: Any) -> list[tuple[float, float, float]]:
    return [(row.a, row.alpha, row.d) for row in arm.rows]


@pytest.mark.parametrize("text", FORMS.values(), ids=FORMS)
def test_a_text_of_any_form_is_read_by_every_way(text: str, tmp_path: Path) -> None:
    """As a text, a stream, bytes, a file of unknown form, and by `from_dh`."""
    path = tmp_path / "arm.txt"
    path.write_text(text, "utf-8")
    for given in (text, text.encode(), io.StringIO(text), path):
        assert geometry(dh2urdf.read(given, convention="standard")) == ROWS
    assert geometry(dh2urdf.Manipulator.from_dh(text, convention="standard")) == ROWS


def test_comments_above_a_dictionary_declare() -> None:
    """A program has no other way; in YAML a key in a comment is commented out."""
    table = "# convention: modified\nDH = {'a': [0.1, 0.3], 'alpha': [0, 0], 'd': [0.2, 0]}\n"
    assert dh2urdf.read(table).convention == "modified"
    with pytest.raises(TableError):
        dh2urdf.read(table.replace("DH = ", ""))


@pytest.mark.parametrize("text", BARE.values(), ids=BARE)
def test_the_order_of_bare_numbers_is_asked_for(text: str) -> None:
    """It is never guessed, and declared by `columns`."""
    with pytest.raises(TableError, match="--columns theta,d,a,alpha"):
        dh2urdf.read(text, convention="standard")
    assert geometry(dh2urdf.read(text, convention="standard", columns="a,alpha,d")) == ROWS
    assert geometry(dh2urdf.Manipulator.from_dh(text, columns=["a", "alpha", "d"], convention="standard")) == ROWS


def test_elements_of_a_list_are_rows_of_one_table() -> None:
    """Link by link, as MATLAB's toolbox is given them; two lists with names of their own are two tables."""
    links = "L(1) = Link([0 0.1 0 pi/2]);\nL(2) = Link([0 0 0.5 0]);\nL(3) = Link([0, 0.2, 0, 0]);\n"
    arm = dh2urdf.read(links, convention="standard", columns="theta,d,a,alpha")
    assert [(row.d, row.a) for row in arm.rows] == [(0.1, 0), (0, 0.5), (0.2, 0)]
    with pytest.raises(TableError) as caught:
        dh2urdf.read("one = [0 0.1 0 0; 0 1 0 0]\ntwo = [0 0.1 0 0; 0 1 0 0]\n", columns="theta,d,a,alpha")
    assert [problem.code for problem in caught.value.problems] == ["several-tables"]


@pytest.mark.parametrize("columns", ["a,alpha", "a,alpha,d,theta"])
def test_columns_that_do_not_fit_are_refused(columns: str) -> None:
    with pytest.raises(TableError, match="3 columns"):
        dh2urdf.read(BARE["numpy"], convention="standard", columns=columns)


def test_columns_of_a_table_with_names_are_refused() -> None:
    for name in ("commas", "Markdown"):
        with pytest.raises(TableError, match="names its columns itself"):
            dh2urdf.read(FORMS[name], convention="standard", columns="d,a,alpha")


@pytest.mark.parametrize(
    "text", ["dh = np.array([[0, 0.1, 1], [1, 2, 3]]).T\n", "dh = np.deg2rad([[0, 90, 1], [1, 2, 3]])\n"]
)
def test_an_array_that_a_program_changes_is_refused(text: str) -> None:
    """Its numbers would be others, or in other places."""
    with pytest.raises(TableError, match="no program is run"):
        dh2urdf.read(text, convention="standard", columns="a,alpha,d")


def test_of_several_tables_the_one_with_parameters_is_read() -> None:
    """Of several with parameters one is chosen by its number."""
    limits = "\n| joint | min | max |\n|---|---|---|\n| 1 | -1 | 1 |\n"
    assert geometry(dh2urdf.read(FORMS["Markdown"] + limits, convention="standard")) == ROWS
    two = FORMS["Markdown"] + "\nAnother:\n\n" + FORMS["Markdown"].replace("0.3", "0.5")
    with pytest.raises(TableError, match="`--table-number N`, from 1 to 2"):
        dh2urdf.read(two, convention="standard")
    assert geometry(dh2urdf.read(two, convention="standard", table_number=2))[1] == (0.5, 0.0, 0.0)


@pytest.mark.parametrize("table", TABLES, ids=lambda path: path.name)
def test_what_is_written_is_read_back(table: Path, tmp_path: Path) -> None:
    """Markdown and LaTeX for papers: convention, names, types, bounds, base and tool are the same."""
    arm = dh2urdf.read(table)
    for suffix, form in ((".md", markdown_file), (".tex", latex_file)):
        for units in (("m", "rad"), ("mm", "deg")):
            path = tmp_path / f"arm{suffix}"
            path.write_bytes(form([arm], Notation(length_unit=units[0], angle_unit=units[1])))
            again = dh2urdf.read(path)
            assert again.convention == arm.convention
            for new, old in zip(again.rows, arm.rows, strict=True):
                assert (new.joint, new.type, new.sign) == (old.joint, old.type, old.sign)
                for name in ("a", "alpha", "d", "theta", "offset"):
                    assert getattr(new, name) == pytest.approx(getattr(old, name), abs=1e-12)
                for name in ("lower", "upper"):
                    bounds = getattr(new.limits, name), getattr(old.limits, name)
                    assert bounds[0] == (None if bounds[1] is None else pytest.approx(bounds[1], abs=1e-12))
            for one, other in ((again.base, arm.base), (again.tool, arm.tool)):
                assert one.translation == pytest.approx(other.translation, abs=1e-12)
                assert one.rpy == pytest.approx(other.rpy, abs=1e-12)


# --- Sizes ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        ",".join(f"c{k}" for k in range(100_000)) + "\n" + ",".join("0" for _ in range(100_000)) + "\n",
        "a,alpha,d," + ",".join(f"c{k}" for k in range(5_000)) + "\n0,0,1\n",
        "x" * 20_000_000,
        "| " + "a | " * 100_000 + "\n|---|---|---|\n",
        "[" * 100_000 + "\n",
        "\\begin{tabular}{" * 20_000 + "\n a & b \\\\",
    ],
    ids=["columns", "more columns than are read", "a line without end", "bars", "brackets", "environments"],
)
def test_what_is_too_large_ends_in_seconds(text: str, tmp_path: Path) -> None:
    """With an error of the table."""
    path = tmp_path / "arm.txt"
    path.write_text(text)
    start = time.process_time()
    with pytest.raises(Dh2UrdfError):
        dh2urdf.read(path, convention="standard")
    assert time.process_time() - start < 5.0


@pytest.mark.parametrize(
    "unit",
    ["a ", "[1 2 3] ", "[1, 2, 3],\n", "| a ", "|---|\n", "& ", "\\\\ ", "{", "# a\n", "base: {", "a: [", " ", "(", "\\frac{", "1 2 3\n", '"', "- a: 1\n", "^\\circ", "%", "Tool: {}}"],
)  # fmt: skip
def test_the_form_of_a_text_is_known_in_linear_time(unit: str) -> None:
    """Ten times the text takes no more than some twenty times as long."""

    def seconds(count: int) -> float:
        text = unit * count
        best = math.inf
        gc.disable()  # which looks through what other tests have left, too
        try:
            for _ in range(2):
                start = time.process_time()
                form_of(text.split("\n"))
                for form in ("markdown", "latex", "listing", "blanks"):
                    with suppress(TableError):
                        all_tables(text, "", form)
                best = min(best, time.process_time() - start)
        finally:
            gc.enable()
        return best

    assert seconds(20_000) < 25 * seconds(2_000) + 0.2
