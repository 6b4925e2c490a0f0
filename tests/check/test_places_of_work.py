"""`dh2urdf check` where people work: the hook of pre-commit, the action of GitHub, and rules that explain themselves."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from command_line import Cli

from dh2urdf_check.rules import address_of, tables

ROOT = Path(__file__).parents[2]
GOOD = (
    '<?xml version="1.0"?>\n<robot name="r">\n<link name="a"><inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>\n</robot>\n'
)
BAD = GOOD.replace("</robot>", '<link name="a"/>\n</robot>')


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    """One in which the command `dh2urdf` is that of this interpreter."""
    folder = tmp_path / "bin"
    folder.mkdir()
    command = folder / "dh2urdf"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m dh2urdf "$@"\n')
    command.chmod(0o755)
    return {**os.environ, "PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}


def test_the_hook_checks_the_files_that_it_takes(tmp_path: Path, environment: dict[str, str]) -> None:
    """As pre-commit calls it: the entry, the arguments, the files. Parts of xacros are not taken."""
    (hook,) = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text("utf-8"))
    taken = re.compile(hook["files"])
    assert [name for name in ("a.urdf", "a.sdf", "a.urdf.xacro", "part.xacro", "a.srdf") if taken.search(name)] == [
        "a.urdf",
        "a.sdf",
        "a.urdf.xacro",
    ]
    for text, status in ((GOOD, 0), (BAD, 1)):
        (tmp_path / "a.urdf").write_text(text)
        words = [*hook["entry"].split(), "--no-ask", "a.urdf"]
        done = subprocess.run(words, cwd=tmp_path, env=environment, check=False, capture_output=True, text=True)
        assert done.returncode == status, done.stderr


@pytest.mark.parametrize(("text", "status"), [(GOOD, 0), (BAD, 1)])
def test_the_action_writes_its_findings(tmp_path: Path, environment: dict[str, str], text: str, status: int) -> None:
    """Its steps as GitHub runs them, but for those of others: errors end the last step, after the findings are there."""
    action = yaml.safe_load((ROOT / "action.yml").read_text("utf-8"))
    steps = {step["name"]: step for step in action["runs"]["steps"] if "name" in step}
    (tmp_path / "a.urdf").write_text(text)
    output = tmp_path / "output"
    given = {"PATHS": "a.urdf", "ARGUMENTS": "--no-ask", "FOLDER": str(tmp_path), "GITHUB_OUTPUT": str(output)}

    def run(step: str, more: dict[str, str]) -> int:
        words = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", steps[step]["run"]]
        assert set(steps[step]["env"]) <= {*given, *more}
        return subprocess.run(words, cwd=tmp_path, env=environment | given | more, check=False).returncode

    assert run("check", {}) == 0
    told = dict(line.split("=", 1) for line in output.read_text().splitlines())
    assert run("errors", {"STATUS": told["status"]}) == status
    log = json.loads(Path(told["sarif"]).read_text("utf-8"))
    assert {each["level"] == "error" for each in log["runs"][0]["results"]} >= ({True} if status else set())


def test_a_rule_explains_itself(cli: Cli) -> None:
    """What it is, what each consumer does, and the fix; of what was seen, how bad it is."""
    out = cli("check", "--explain", "duplicate-link").stdout
    assert out.startswith("duplicate-link: two links with one name\n")
    assert "mujoco, pinocchio, drake, ros, gazebo: refuses the file (refuses)" in out
    assert "    fix: rename one of them\n" in out
    assert "seen in a program (error)" in cli("check", "--explain", "seen-crash").stdout
    assert "did you mean 'swapped-limits'?" in cli("check", "--explain", "swaped-limits", status=2).stderr


def test_every_rule_has_an_address() -> None:
    """With the table that has it; what is no rule has none."""
    for name in tables():
        address = address_of(name)
        assert address is not None
        assert address.startswith(("file:///", "https://"))
        assert address.endswith(f"#{name}")
    assert address_of("other-kinematics") is None
