"""Tables as READMEs, papers and programs have them, pasted: what they say is not lost, and makes no other arm."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from dh2urdf_studio import pasting
from dh2urdf_studio.editing.opening import tables_of

if TYPE_CHECKING:
    from dh2urdf.plugin_system import Catalog
    from dh2urdf.table_text import TableText

BEFORE = (
    "| $i$ | $\\alpha_{i-1}$ | $a_{i-1}$ | $d_i$ | $\\theta_i$ |\n|---|---|---|---|---|\n"
    "| 1 | $0$ | $0$ | $0.1$ | $\\theta_1$ |\n| 2 | $0$ | $0.3$ | $0$ | $\\theta_2$ |\n"
)


def table_of(text: str, catalog: Catalog, convention: str = "standard") -> TableText:
    """The one table of a pasted text."""
    found = pasting.whole_tables(text, catalog, convention)
    assert isinstance(found, tuple), found
    ((table, *_),) = found
    return table


@pytest.mark.parametrize("row", ["| 4 | 0 | 0.1 | 0 | 0 |", "| 3 | 0 | 0.1 | 0 | 0 |", "| 3 | 0 | x | 0 | $q_3$ |"])
def test_a_table_whose_headers_say_the_convention_is_never_taken_for_the_other(row: str, catalog: Catalog) -> None:
    """With a fault in it, it was opened in the convention that was chosen on the page, without a word."""
    assert table_of(BEFORE, catalog).convention == "modified"
    found = pasting.whole_tables(f"{BEFORE}{row}\n", catalog, "standard")
    assert isinstance(found, str)
    assert "means the modified (Craig) convention" in found
    assert "error" in found


@pytest.mark.parametrize("convention", ["", "standard", "modified"])
def test_joints_that_slide_keep_their_type_and_their_text(convention: str, catalog: Catalog) -> None:
    """Without a convention in the text the joint of d3 was opened as revolute."""
    text = (
        "i\ttheta\td\ta\talpha\n1\tq1\t0.4\t0.3\t0\n2\tq2 + pi/2\t0\t0.2\tpi\n3\t0\tq3 + 0.1\t0\t0\nEE\t0\t0.1\t0\t0\n"
    )
    table = table_of(text.replace("i\t", "joint\t", 1), catalog, convention)
    assert [row["type"] for row in table.rows] == ["revolute", "revolute", "prismatic", "fixed"]
    assert [row["theta"] for row in table.rows] == ["q1", "q2 + pi/2", "0", "0"]
    assert table.rows[2]["d"] == "q3 + 0.1"
    assert table.convention == convention


def test_ranges_and_units_of_a_data_sheet_are_kept(catalog: Catalog) -> None:
    """The ranges were gone: the table had no column for them, and nothing said so."""
    table = table_of(
        "Joint\tθi (°)\tdi (mm)\tai (mm)\tαi (°)\tRange (°)\n1\tθ1\t290\t0\t-90\t-165 ~ 165\n2\tθ2\t0\t270\t0\t±110\n",
        catalog,
    )
    assert [(row["lower"], row["upper"]) for row in table.rows] == [("-165", "165"), ("-110", "110")]
    assert (table.length_unit, table.angle_unit) == ("mm", "deg")


@pytest.mark.parametrize("cell", ["0", "x"])
@pytest.mark.parametrize("limits", ["[-1, 2]", "{min: -1, max: 2}", "{lower: -1, upper: 2}", '"-1..2"'])
def test_limits_of_yaml_are_kept(limits: str, cell: str, catalog: Catalog) -> None:
    """Also of a table with a fault, which is opened as it was typed."""
    text = f"joints:\n- {{a: 0.3, alpha: 0, d: {cell}, limits: {limits}}}\n"
    found = tables_of("clipboard.yaml", text.encode(), catalog)
    assert isinstance(found, tuple), found
    ((table, *_),) = found
    assert (table.rows[0]["lower"], table.rows[0]["upper"]) == ("-1", "2")


@pytest.mark.parametrize("mark", ["# ", "/// ", "% ", " * ", "//"])
def test_a_table_in_a_comment_of_a_program_is_a_table(mark: str, catalog: Catalog) -> None:
    """Each line of it went into one cell, or it had no header."""
    lines = BEFORE.replace("$", "").splitlines()
    table = table_of("\n".join(f"{mark}{line}" for line in lines), catalog)
    assert table.convention == "modified"
    assert [row["a"] for row in table.rows] == ["0", "0.3"]


def test_bars_between_cells_may_have_lines_of_dashes_between_rows(catalog: Catalog) -> None:
    """As the tables in comments of the ArmPi have them."""
    line = "-" * 40
    text = f"i | α(i-1) | a(i-1) | θ(i) | d(i) |\n{line}\n1 | 0° | 0 | θ1 | 0 |\n{line}\n2 | -90° | 0.1 | θ2 | 0 |\n{line}\n"
    table = table_of(text, catalog)
    assert [row["alpha"] for row in table.rows] == ["0°", "-90°"]
