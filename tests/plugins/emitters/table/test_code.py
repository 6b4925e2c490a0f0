"""Code for MATLAB and Python that the emitter ``table`` writes is run, and its T(q) is that of the table."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import DHRow, JointType, Manipulator
from dh2urdf.testing.oracle import table_pose as product
from dh2urdf_plugins.packages.table.code import left_out_of_code, matlab_file, toolbox_file

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from conftest import ReferenceRobot
    from numpy.typing import NDArray


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
