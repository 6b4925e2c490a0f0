"""Tables as Markdown and LaTeX."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf_plugins.packages.table import TableOptions
from dh2urdf_plugins.packages.table.notation import escaped, latex_file, markdown_file

if TYPE_CHECKING:
    from pathlib import Path

RADIANS, DEGREES = TableOptions(), TableOptions(length_unit="mm", angle_unit="deg")


def test_markdown(arm: Manipulator) -> None:
    """Symbols are numbered by moving joint, with what is added to the variable; units are in the headers."""
    lines = markdown_file([replace(arm, name="a_b|c")], RADIANS).decode().splitlines()
    assert lines[0] == r"## a\_b&#124;c"
    product = {
        Convention.STANDARD: "A = Rz(θ)·Tz(d)·Tx(a)·Rx(α).",
        Convention.MODIFIED: "A = Rx(α)·Tx(a)·Rz(θ)·Tz(d).",
    }[arm.convention]
    assert lines[2] == f"Denavit-Hartenberg parameters, {arm.convention} convention: {product}"
    assert lines[4:12] == [
        "| no. | joint | type | a [m] | α [rad] | d [m] | θ [rad] | lower [rad, m] | upper [rad, m] |",
        "| --: | --- | --- | --: | --: | --: | --: | --: | --: |",
        "|  | mount | fixed | 0.1 | 0.2 | 0.3 | 0.4 |  |  |",
        "| 1 | turn | revolute | 0.5 | π/2 | −0.25 | −θ₁ + 0.125 − π/4 | −3π/4 | 2 |",
        "| 2 | slide | prismatic | 0.05 | −1.1 | −d₂ + 0.4 + 0.2 | 0.7 | 0 | 0.75 |",
        "| 3 | spin | continuous | 0 | 0.3 | 0.1 | θ₃ |  |  |",
        "| 4 | reach | prismatic | 0.2 | 0 | d₄ | −0.6 |  |  |",
        "|  | last | fixed | 0 | π | 0.05 | π/3 |  |  |",
    ]
    assert lines[13] == "Base: `{xyz: [0.1, -0.2, 0.3], rpy: [0.4, -0.5, 0.6]}`"
    assert lines[15].startswith("Tool: `")
    assert {line.count("|") for line in lines[4:12]} == {10}


def test_units(arm: Manipulator) -> None:
    """Lengths and angles, limits too, are in the units that are asked for."""
    text = markdown_file([arm], DEGREES).decode()
    assert "| a [mm] | α [deg] | d [mm] | θ [deg] | lower [deg, mm] | upper [deg, mm] |" in text
    assert "| 2 | slide | prismatic | 50 |" in text
    assert "| −d₂ + 400 + 200 |" in text
    assert "| −135 |" in text
    assert r"[$^\circ$, mm]" in latex_file([arm], DEGREES).decode()


def test_limits_have_the_units_of_their_joints(arm: Manipulator) -> None:
    """An arm without sliding joints has limits in rad; one without limits has no such columns."""
    turning = replace(arm, rows=(arm.rows[1],))
    assert "| lower [rad] | upper [rad] |" in markdown_file([turning], RADIANS).decode()
    free = replace(arm, rows=(arm.rows[3],))
    assert "lower" not in markdown_file([free], RADIANS).decode()
    assert "min" not in latex_file([free], RADIANS).decode()


def test_latex(arm: Manipulator) -> None:
    """Every row has the cells of the header, in the symbols of the convention; base and tool are below."""
    lines = latex_file([arm], RADIANS).decode().splitlines()
    own = "i" if arm.convention is Convention.STANDARD else "i-1"
    (head,) = [line for line in lines if line.startswith("    $i$")]
    assert rf"$a_{{{own}}}$ [m] & $\alpha_{{{own}}}$ [rad] & $d_i$ [m] & $\theta_i$ [rad]" in head
    rows = [line for line in lines if line.endswith(r"\\")]
    assert {row.count(" & ") for row in rows} == {8}
    assert r"$0.5$ & $\pi/2$ & $-0.25$ & $-\theta_{1} + 0.125 - \pi/4$ & $-3\pi/4$ & $2$ \\" in rows[2]
    assert r"$-d_{2} + 0.4 + 0.2$ & $0.7$" in rows[3]
    assert (
        r"$-1.5 \times 10^{-7}$"
        in latex_file([replace(arm, rows=(replace(arm.rows[1], alpha=-1.5e-7),))], RADIANS).decode()
    )
    assert any(line.startswith(r"  Base: \texttt{\{xyz: [0.1, -0.2, 0.3]") for line in lines)
    assert [line.strip() for line in lines if "rule" in line] == [r"\toprule", r"\midrule", r"\bottomrule"]


def test_special_characters_are_escaped() -> None:
    """No character of a name means anything to LaTeX."""
    assert escaped("a_b & 50% #1 $x$ {y} \\z ~^") == (
        r"a\_b \& 50\% \#1 \$x\$ \{y\} \textbackslash{}z \textasciitilde{}\textasciicircum{}"
    )


def test_groups_are_closed(arm: Manipulator) -> None:
    """Braces, dollars and environments come in pairs, whatever the names are."""
    rows = (replace(arm.rows[0], joint="50% {of $ \\"), *arm.rows[1:])
    text = latex_file([replace(arm, name="#1_{&}", rows=rows)], RADIANS).decode()
    bare = re.sub(r"\\[{}$%&#_\\]", "", "\n".join(line for line in text.splitlines() if not line.startswith("%")))
    assert bare.count("{") == bare.count("}")
    assert bare.count("$") % 2 == 0
    assert re.findall(r"\\begin{(\w+)}", text) == list(reversed(re.findall(r"\\end{(\w+)}", text)))


@pytest.mark.skipif(not shutil.which("pdflatex"), reason="pdflatex is not installed")
@pytest.mark.parametrize("unit", [RADIANS, TableOptions(length_unit="mm", angle_unit="deg")])
def test_latex_compiles(arm: Manipulator, unit: TableOptions, tmp_path: Path) -> None:
    """In a document with booktabs, whatever the names are."""
    rows = tuple(replace(row, joint=f'{row.joint} 50% #{{$\\~^_&<|>"') for row in arm.rows)
    (tmp_path / "arm.tex").write_bytes(latex_file([arm, replace(arm, name='a "b" #1_{&}', rows=rows)], unit))
    (tmp_path / "main.tex").write_text(
        "\\documentclass{article}\n\\usepackage{booktabs}\n\\begin{document}\n\\input{arm}\n\\end{document}\n"
    )
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "main.tex"]
    answer = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert answer.returncode == 0, answer.stdout
    assert "Missing character" not in (tmp_path / "main.log").read_text(errors="replace")
