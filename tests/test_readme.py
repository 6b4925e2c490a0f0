"""The README keeps its word: its blocks are run, its numbers are measured, and it stays short.

The two blocks that set a machine up are run word for word by `.ci/run`; all others here. That the errors of the main job
are as small as it says is a fact of tests/test_main_job.py.
"""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import click
import numpy as np
import pytest

from dh2urdf.cli import dh2urdf as program
from dh2urdf.plugin_system import load

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def block(language: str, containing: str = "") -> str:
    """The one fenced block of a language that has a text in it."""
    (found,) = (
        body for tag, body in BLOCK.findall(README.read_text("utf-8")) if tag == language and containing in body
    )
    return str(found)


def test_no_block_goes_untested() -> None:
    """The README has the two blocks of `.ci/run` and the two of this file, and stays short."""
    assert len(README.read_text("utf-8").splitlines()) <= 90
    tags = [tag for tag, _ in BLOCK.findall(README.read_text("utf-8"))]
    assert tags == ["sh", "sh", "csv", "sh"]
    assert README.read_text("utf-8").count("```") == 2 * len(tags)


# --- A table and its conversions --------------------------------------------------------------------------------------


@pytest.fixture
def converted(tmp_path: Path) -> Path:
    """A folder in which the table of the README was saved and its commands were run."""
    (tmp_path / "arm.csv").write_text(block("csv"), "utf-8")
    script = Path(sys.executable).parent
    result = subprocess.run(
        ["/bin/bash", "-euo", "pipefail", "-c", block("sh", "dh2urdf convert")],
        cwd=tmp_path,
        env={**os.environ, "PATH": f"{script}{os.pathsep}{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (result.returncode, result.stdout) == (0, "")
    assert [line.partition(";")[0] for line in result.stderr.splitlines()] == [
        "arm: 4 joints (3 revolute, 1 prismatic)"
    ] * 3
    return tmp_path


def test_the_commands_write_what_they_say(converted: Path) -> None:
    """The URDF, the xacro with its macro, and the URDF with DH frames; nothing else."""
    assert {path.name for path in converted.iterdir()} == {
        *("arm.csv", "arm.urdf", "arm.urdf.xacro", "arm_macro.xacro", "arm_with_dh_frames.urdf")
    }


def test_the_same_arm_three_times(converted: Path, tool0_of: Callable[[Path], Callable[..., np.ndarray]]) -> None:
    """The three files agree on where tool0 is, and the xacro is expanded by the real xacro."""
    import xacro

    expanded = converted / "expanded.urdf"
    expanded.write_text(xacro.process_file(str(converted / "arm.urdf.xacro")).toxml(), "utf-8")
    arms = [tool0_of(converted / name) for name in ("arm.urdf", "arm_with_dh_frames.urdf", "expanded.urdf")]
    for q in ([0, 0, 0, 0], [0.3, -0.7, 0.15, 1.1]):
        first, *others = (arm(q) for arm in arms)
        for other in others:
            np.testing.assert_allclose(other, first, rtol=0, atol=1e-12)


# --- The main job -----------------------------------------------------------------------------------------------------


def test_the_density_is_the_default() -> None:
    """Masses that no table gives come from the density that the README names."""
    default = load().get("transform", "alpha-swap").options().density
    assert f"{default:g} kg/m³" in README.read_text("utf-8")


def test_every_command_is_there() -> None:
    """The README names every command; tests/test_docs.py looks at the flags."""
    commands = program.list_commands(click.Context(program, **program.context_settings))
    assert [name for name in commands if f"dh2urdf {name}" not in README.read_text("utf-8")] == []
