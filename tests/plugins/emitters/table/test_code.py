"""What the emitter ``table`` writes for others: code, which is run and has the T(q) of the table, and papers."""

import importlib.util
import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.testing.oracle import table_pose as product
from dh2urdf_plugins.packages.table import TableOptions
from dh2urdf_plugins.packages.table.code import left_out_of_code, matlab_file, toolbox_file
from dh2urdf_plugins.packages.table.notation import escaped, latex_file, markdown_file
from reference_arms import ReferenceRobot

SAME = 1e-12
needs_toolbox = pytest.mark.skipif(
    not importlib.util.find_spec("roboticstoolbox"), reason="roboticstoolbox-python is not installed"
)
OCTAVE = shutil.which("octave-cli")
SHIM = Path(__file__).with_name("octave")


def vectors(arm: Manipulator) -> Iterator[list[float]]:
    """Zero and three joint vectors without a pattern."""
    yield [0.0] * len(arm.moving_rows)
    generator = np.random.default_rng(7)
    for _ in range(3):
        yield generator.uniform(-2.0, 2.0, len(arm.moving_rows)).tolist()


# --- Robotics Toolbox for Python


def executed(*arms: Manipulator) -> dict[str, Any]:
    """What the code of some arms defines."""
    scope: dict[str, Any] = {}
    exec(compile(toolbox_file(arms), "arm.py", "exec"), scope)  # noqa: S102 - code of ours
    return scope


@needs_toolbox
def test_several_arms(arm: Manipulator) -> None:
    """Each has a variable of its own name."""
    scope = executed(arm, replace(arm, name="Pi"), replace(arm, name="3"), replace(arm, name="3"))
    names = [name for name, value in scope.items() if type(value).__name__ == "DHRobot"]
    assert names == ["one_of_everything", "pi_2", "robot_3", "robot_3_2"]


@needs_toolbox
def test_names_are_texts(arm: Manipulator) -> None:
    """A name with quotes, backslashes and breaks stays a text."""
    name = 'a"""\\ b\n' + "'"
    rows = (replace(arm.rows[1], link=name), *arm.rows[2:])
    robot = executed(replace(arm, name=name, rows=rows))["robot"]
    assert robot.name == name


def test_a_fixed_row_between_joints_is_refused(arm: Manipulator) -> None:
    """Every link of a DHRobot moves."""
    fixed = DHRow(joint="between", link="b", type=JointType.FIXED, a=0.1, alpha=0.0, d=0.0)
    for rows, code in (((*arm.rows[:2], fixed, *arm.rows[2:]), "fixed-row-between"), ((fixed,), "nothing-moves")):
        with pytest.raises(EmitterError) as caught:
            toolbox_file([replace(arm, rows=rows)])
        assert (caught.value.problems[0].code, caught.value.problems[0].found) == (code, "between")


def test_what_code_has_no_place_for(arm: Manipulator) -> None:
    """It is named; an arm without it gives no notice."""
    rows = (replace(arm.rows[0], mass=1.0), replace(arm.rows[1], limits=replace(arm.rows[1].limits, effort=5.0)))
    given = replace(arm, rows=rows, base_mass=3.0)
    codes = [notice.code for notice in left_out_of_code("roboticstoolbox", [given])]
    assert codes == ["no-place-in-code", "fixed-masses-left-out"]
    (notice,) = left_out_of_code("matlab", [given])
    assert all(word in notice.message for word in ("effort", "damping", "friction", "armature", "base mass"))
    assert not list(left_out_of_code("roboticstoolbox", [arm]))


@needs_toolbox
def test_the_toolbox_itself(arm: Manipulator, reference_robots: Sequence[ReferenceRobot]) -> None:
    """`fkine` of the toolbox is T(q) of the table, of every published robot too; limits and masses arrive."""
    for each in (arm, *(robot.manipulator for robot in reference_robots)):
        robot = executed(each)["robot"]
        for q in vectors(each):
            expected = product(each, q)
            assert np.abs(robot.fkine(q).A - expected).max() <= SAME * max(1.0, np.abs(expected).max())
    link = executed(arm)["robot"].links[0]
    assert (link.m, link.Jm, link.G, link.B, link.Tc.tolist()) == (2, 0.125, 1, 0.5, [0.25, -0.25])
    assert (link.r.tolist(), link.qlim.tolist()) == ([0.1, -0.2, 0.3], [arm.rows[1].limits.lower, 2.0])
    assert link.I.tolist() == [[0.3, 0.01, -0.02], [0.01, 0.4, 0.03], [-0.02, 0.03, 0.5]]


# --- MATLAB


def octave(folder: Path, *arms: Manipulator) -> list[NDArray[np.float64]]:
    """T(q) of tool0 at the vectors of each arm, computed by Octave with classes that do what MATLAB documents."""
    lines = []
    for number, arm in enumerate(arms):
        (folder / f"arm_{number}.m").write_bytes(matlab_file([arm]))
        lines.append(f"arm_{number};")
        lines += [f"printf('%.17g ', getTransform(robot, {q}, 'tool0')); disp('');" for q in vectors(arm)]
    (folder / "main.m").write_text("\n".join(lines))
    command = [str(OCTAVE), "--norc", "--no-history", "--path", str(SHIM), "main.m"]
    answer = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True, timeout=300)
    assert answer.stderr == ""
    return [np.array(line.split(), dtype=float).reshape(4, 4).T for line in answer.stdout.splitlines()]


@pytest.mark.skipif(OCTAVE is None, reason="octave-cli is not installed")
class TestOctave:
    """The script is run by Octave."""

    def test_pose_of_every_feature(self, arm: Manipulator, tmp_path: Path) -> None:
        """A constant of a joint is a fixed body, a sign the direction of the axis; fixed rows may be anywhere."""
        fixed = DHRow(joint="between", link="b", type=JointType.FIXED, a=0.1, alpha=0.5, d=0.3, theta=-0.2)
        given = replace(arm, rows=(*arm.rows[:3], fixed, *arm.rows[3:]))
        poses = octave(tmp_path, given)
        for q, pose in zip(vectors(given), poses, strict=True):
            assert np.abs(pose - product(given, q)).max() <= SAME

    def test_pose_of_published_robots(self, reference_robots: Sequence[ReferenceRobot], tmp_path: Path) -> None:
        """The script of each published table."""
        arms = [robot.manipulator for robot in reference_robots]
        expected = [product(arm, q) for arm in arms for q in vectors(arm)]
        for pose, known in zip(octave(tmp_path, *arms), expected, strict=True):
            assert np.abs(pose - known).max() <= SAME * max(1.0, np.abs(known).max())


def test_bodies_of_matlab(arm: Manipulator) -> None:
    """The inertia tensor is about the origin of the frame; names with quotes are doubled; limits are in place."""
    text = matlab_file([replace(arm, rows=(replace(arm.rows[1], link="it's"),))]).decode()
    assert "body = rigidBody('it''s');" in text
    assert "joint.PositionLimits = [-3*pi/4, 2];" in text
    assert "body.Mass = 2;\nbody.CenterOfMass = [0.1 -0.2 0.3];" in text
    (line,) = [line for line in text.splitlines() if line.startswith("body.Inertia") and "0 0 0" not in line]
    x, y, z = 0.1, -0.2, 0.3
    about = [[0.3, 0.01, -0.02], [0.01, 0.4, 0.03], [-0.02, 0.03, 0.5]] + 2.0 * (
        (x * x + y * y + z * z) * np.eye(3) - np.outer((x, y, z), (x, y, z))
    )
    expected = [about[0, 0], about[1, 1], about[2, 2], about[1, 2], about[0, 2], about[0, 1]]
    assert np.allclose([float(word) for word in line[16:-2].split()], expected, rtol=0.0, atol=1e-15)


# --- Markdown and LaTeX

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
@pytest.mark.parametrize("unit", [RADIANS, DEGREES])
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
