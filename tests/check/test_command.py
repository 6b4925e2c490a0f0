"""`dh2urdf check` as people and scripts call it."""

import json
import re
from pathlib import Path

import pytest
from command_line import Cli

TABLE = "# convention: standard\njoint, a, alpha, d\nfirst, 0.4, pi/2, 0.1\nsecond, 0.3, 0, 0\n"


@pytest.fixture
def arm(cli: Cli, tmp_path: Path) -> Path:
    """The URDF of a small table, beside it."""
    (tmp_path / "arm.csv").write_text(TABLE)
    cli("convert", "arm.csv", "-o", "arm.urdf")
    return tmp_path / "arm.urdf"


def swap_limits(path: Path) -> None:
    text = path.read_text("utf-8")
    lower = text.index('lower="')
    path.write_text(text[:lower] + text[lower:].replace('lower="-', 'lower="1', 1).replace('upper="', 'upper="-', 1))


def test_a_file_of_ours_is_taken_by_all(cli: Cli, arm: Path) -> None:
    """Notes only, and exit status 0."""
    answer = cli("check", "--no-ask", arm.name)
    assert answer.stderr == ""
    assert ": note: " in answer.stdout
    assert not {": error: ", ": warning: "} & set(answer.stdout.split("["))
    *_, count, last = answer.stdout.splitlines()
    assert count == "6 notes"
    assert last == "foretold: no error in pybullet, mujoco, pinocchio, drake, ros, gazebo, coppeliasim, isaac"


def test_an_error_is_printed_with_its_place_and_its_fix(cli: Cli, arm: Path) -> None:
    """File, line, column, severity, what is there, the rule; what each consumer does; what to do. Exit status 1."""
    swap_limits(arm)
    lines = cli("check", "--no-ask", arm.name, status=1).stdout.splitlines()
    (index,) = [i for i, line in enumerate(lines) if "[swapped-limits]" in line]
    number = next(i for i, line in enumerate(arm.read_text().splitlines(), start=1) if 'lower="1' in line)
    assert lines[index].startswith(f"arm.urdf:{number}:5: error: joint 'first' has lower ")
    assert lines[index + 1] == (
        "    pybullet (foretold, warning), mujoco (foretold, warning): leaves the joint without limits"
    )
    assert "    drake (foretold): ends the interpreter with SystemExit" in lines
    assert "    fix: exchange them" in lines
    assert lines[-2] == "1 error, 6 notes"
    assert lines[-1].endswith("; errors in drake")


def test_one_simulator_is_asked_for(cli: Cli, arm: Path) -> None:
    """`--for` keeps what it does, and its severity: what Drake refuses does not matter to MuJoCo."""
    swap_limits(arm)
    cli("check", "--no-ask", arm.name, "--for", "drake", status=1)
    answer = cli("check", "--no-ask", arm.name, "--for", "mujoco", "--for", "pinocchio")
    assert ": warning: " in answer.stdout
    assert "pybullet" not in answer.stdout
    assert "drake" not in answer.stdout
    answer = cli("check", "--no-ask", arm.name, "--for", "mujoc", status=2)
    assert "did you mean 'mujoco'?" in answer.stderr
    assert "coppeliasim" in answer.stderr


def test_a_xacro_is_expanded(cli: Cli, arm: Path) -> None:
    """With places in its own files, and where macros are called."""
    cli("convert", "arm.csv", "-o", "arm.urdf.xacro")
    assert arm.is_file()
    lines = cli("check", "--no-ask", "--verbose", "arm.urdf.xacro").stdout.splitlines()
    assert lines[0].startswith("arm_macro.xacro:")
    assert re.fullmatch(r"    by the macro called at arm\.urdf\.xacro:\d+:\d+", lines[1])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nowhere.urdf"], "no such file"),
        (["arm.urdf", "--against", "bare.csv"], "convention"),
        (["arm.urdf", "--against", "arm.csv", "--tip-link", "tool"], "did you mean 'tool0'?"),
    ],
)
def test_what_cannot_be_read_ends_with_2(cli: Cli, arm: Path, words: list[str], said: str) -> None:
    """The file, the table, or the command line."""
    (arm.parent / "arm.txt").write_bytes(arm.read_bytes())
    (arm.parent / "bare.csv").write_text("a,alpha,d\n0,0,0\n")
    assert said in cli("check", *words, status=2).stderr


# --- Fixing -----------------------------------------------------------------------------------------------------------


def test_a_fixed_file_is_written_and_checked(cli: Cli, arm: Path) -> None:
    """What was done is printed with its place; the input stays, and the rest of the text too."""
    right = arm.read_bytes()
    swap_limits(arm)
    wrong = arm.read_bytes()
    answer = cli("check", "--no-ask", arm.name, "--fix", "-o", "fixed.urdf")
    (line, last) = answer.stderr.splitlines()
    assert re.fullmatch(r"arm\.urdf:\d+:\d+: fixed: lower 1\S+ and upper -\S+ are exchanged", line)
    assert last == "1 fix; written to fixed.urdf"
    assert "swapped-limits" not in answer.stdout
    assert "fixed.urdf:" in answer.stdout
    assert arm.read_bytes() == wrong
    assert len(arm.with_name("fixed.urdf").read_bytes().splitlines()) == len(right.splitlines())
    cli("check", "--no-ask", arm.name, "--fix", "--out", arm.name)  # It was named.
    assert arm.read_bytes() == arm.with_name("fixed.urdf").read_bytes()


@pytest.mark.parametrize(
    "words",
    [
        ["arm.urdf", "-o", "new.urdf"],
        ["arm.urdf", "arm.xacro", "--fix", "-o", "new.urdf"],
        [".", "--fix", "-o", "new.urdf"],
        ["arm.xacro", "--fix", "-o", "new.urdf"],
    ],
)
def test_what_is_not_fixed_is_refused(cli: Cli, arm: Path, words: list[str]) -> None:
    """And nothing is written."""
    arm.with_name("arm.xacro").write_bytes(arm.read_bytes())
    cli("check", *words, status=2)
    assert not arm.with_name("new.urdf").exists()


# --- Against a table --------------------------------------------------------------------------------------------------


def test_the_same_arm_is_said_to_be_the_same(cli: Cli, arm: Path) -> None:
    """With the ends of the chain and the errors."""
    last = cli("check", "--no-ask", arm.name, "--against", "arm.csv").stdout.splitlines()[-2]
    assert last.startswith("the same arm as arm of arm.csv (base_link to tool0, 2 joints): within ")


def test_another_arm_is_an_error_with_its_correction(cli: Cli, arm: Path) -> None:
    """Base, tool, signs and offsets in a form that goes into a table: with them, it is the same arm."""
    other = TABLE.replace("# conv", "# tool: {xyz: [0, 0, 0.1], rpy: [0, 0, 0]}\n# conv").replace("d\nf", "d, sign\nf")
    other = other.replace("pi/2, 0.1", "pi/2, 0.1, -1").replace("0, 0\n", "0, 0, 1\n")
    (arm.parent / "other.csv").write_text(other)
    out = cli("check", "--no-ask", arm.name, "--against", "other.csv", status=1).stdout
    assert "error: not the arm other of other.csv as it stands (base_link to tool0, 2 joints) [other-kinematics]" in out
    assert "    with this in the table they agree, within " in out
    assert out.splitlines()[-3:-1] == ["        tool: {xyz: [0, 0, 0], rpy: [0, 0, 0]}", "        joint first: sign: 1"]
    told = json.loads(cli("check", "--no-ask", arm.name, "--against", "other.csv", "--format", "json", status=1).stdout)
    assert told["comparison"]["agrees"] is False
    assert told["comparison"]["correction"]["changes"] == [
        "tool: {xyz: [0, 0, 0], rpy: [0, 0, 0]}",
        "joint first: sign: 1",
    ]


def test_a_file_that_is_no_robot_is_no_arm(cli: Cli, arm: Path) -> None:
    """It has nothing that could be compared."""
    arm.write_text("<sdf/>")
    out = cli("check", "--no-ask", arm.name, "--against", "arm.csv", status=1).stdout
    assert "arm.urdf has no tree of links that could be compared" in out


# --- For scripts ------------------------------------------------------------------------------------------------------


def test_the_same_as_json(cli: Cli, arm: Path) -> None:
    """Everything that the text says, with the exit status of the text."""
    swap_limits(arm)
    told = json.loads(cli("check", "--no-ask", arm.name, "--format", "json", status=1).stdout)
    assert set(told) == {"schema", "version", "file", "consumers", "asked", "counts", "findings"}
    assert told["schema"] == "dh2urdf-check/1"
    assert told["counts"] == {"error": 1, "warning": 0, "note": 6}
    (finding,) = [finding for finding in told["findings"] if finding["severity"] == "error"]
    assert set(finding) == {"rule", "severity", "file", "line", "column", "calls", "message", "fix", "consumers"}
    assert finding["consumers"]["drake"] == {
        "severity": "error",
        "does": "ends the interpreter with SystemExit",
        "seen": None,
    }


def test_names_of_strangers_do_not_reach_the_terminal(cli: Cli, arm: Path) -> None:
    """Control characters and markup are shown as text, on a terminal too."""
    text = arm.read_text().replace('"second"', '"[red]a&#155;2J"')
    arm.write_text(text)
    assert "[red]a\\x9b2J" in cli("check", "--no-ask", arm.name).stdout
