import ast
import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import Cli
from terminal import on_a_terminal

import dh2urdf.cli.listings
from dh2urdf import __version__, cli
from dh2urdf.cli import COMMANDS, exit_status_of, main
from dh2urdf.hookspecs import INTERFACE_VERSION
from dh2urdf.isolation.fence import walls

COMMAND = [sys.executable, "-c", "from dh2urdf.cli import main; main()"]
CONFIGS = Path(__file__).parents[3] / "configs"


class TestHelp:
    def test_it_names_every_command_and_status(self, cli: Cli) -> None:
        """What the program is for, an example, and each command with what it does."""
        text = cli("-h").stdout
        assert "provably the same arm" in text
        assert "dh2urdf convert ur5.csv -o ur5.urdf" in text
        for name, summary in COMMANDS.items():
            assert f"  {name}" in text
            assert summary in text

    def test_each_command_has_examples_and_explains_its_options(self, cli: Cli) -> None:
        """The help begins with what the command does; no flag stands without a sentence."""
        for command in COMMANDS:
            text = cli(command, "--help").stdout
            assert text.startswith(f"Usage: dh2urdf {command} ")
            assert f"\n  dh2urdf {command}" in text
            flags = [line for line in text.split("Options:")[1].splitlines() if line.startswith("  -")]
            assert flags
            assert [line for line in flags if "  " not in line.strip()] == []

    def test_without_a_command_it_is_shown_and_nothing_was_done(self, cli: Cli) -> None:
        """The help goes to standard error: nobody asked for it."""
        answer = cli(status=2)
        assert answer.stdout == ""
        assert "Usage: dh2urdf [OPTIONS] COMMAND" in answer.stderr


class TestWords:
    def test_version(self, cli: Cli) -> None:
        """Version of the program, of Python, and of the interface for plugins."""
        assert cli("--version").stdout == (
            f"dh2urdf {__version__} (Python {platform.python_version()}, plugin interface {INTERFACE_VERSION})\n"
            f"fence around files of unknown origin: {walls()}\n"
        )


class TestDebug:
    def test_with_it_the_traceback_comes_first(self, capfd: pytest.CaptureFixture[str]) -> None:
        """The last line is still the sentence."""
        with pytest.raises(SystemExit) as left:
            main(["--debug", "convert", "nope.csv"])
        assert left.value.code == 2
        lines = capfd.readouterr().err.splitlines()
        assert lines[0] == "Traceback (most recent call last):"
        assert lines[-1].startswith("nope.csv: error: ")

    def test_a_fault_of_the_program_says_so(
        self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
    ) -> None:
        """An error that nobody foresaw is status 1, one sentence, and a way to see more; with --debug it is raised."""

        def broken() -> None:
            raise LookupError("the ground is gone")

        monkeypatch.setattr(dh2urdf.cli.listings, "catalog", broken)
        assert exit_status_of(["plugins"], debug=False) == cli.INTERNAL_ERROR == 1
        assert "LookupError: the ground is gone\n" in capfd.readouterr().err
        with pytest.raises(LookupError):
            exit_status_of(["--debug", "plugins"])

    def test_an_interrupt_names_who_was_at_work(
        self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
    ) -> None:
        """Status 130, and what was noted on the way out."""

        def interrupted() -> None:
            error = KeyboardInterrupt()
            error.add_note("emitter 'slow' of lab 1.0 was at work")
            raise error

        monkeypatch.setattr(dh2urdf.cli.listings, "catalog", interrupted)
        assert exit_status_of(["plugins"]) == 130
        assert "emitter 'slow' of lab 1.0 was at work" in capfd.readouterr().err


class TestPipes:
    def test_a_closed_one_is_told(self, tmp_path: Path) -> None:
        """Nothing was printed, and `convert` said that it was."""
        answer = closed(tmp_path, ["convert", "arm.csv"])
        assert (answer.returncode, answer.stderr.splitlines()[-2][:6]) == (2, "error:")

    def test_who_prints_nothing_needs_none(self, tmp_path: Path) -> None:
        """No file has the number of standard output either: a library in C would print into it."""
        assert closed(tmp_path, ["convert", "arm.csv", "-o", "new.urdf"]).returncode == 0
        assert closed(tmp_path, ["run", "run.yaml", "-q"]).returncode == 0
        command = ["sh", "-c", 'exec "$@" >&-', "sh", sys.executable, "-c", FIRST_FILE]
        found = subprocess.run(command, capture_output=True, check=False)
        assert found.returncode > cli.LAST_STREAM


FIRST_FILE = """
import os
import sys
from dh2urdf import cli
cli.exit_status_of = lambda words: os.open(os.devnull, os.O_RDONLY)
cli.main()
"""


def closed(folder: Path, words: list[str]) -> subprocess.CompletedProcess[str]:
    """What a command does with standard output closed."""
    table = CONFIGS / "tables" / "ur5.csv"
    (folder / "arm.csv").write_bytes(table.read_bytes())
    (folder / "run.yaml").write_text("inputs: arm.csv\nreport: {html: false}\n")
    subprocess.run([*COMMAND, "convert", "arm.csv", "-o", "arm.urdf", "-q"], cwd=folder, check=True)
    command = ["sh", "-c", 'exec "$@" >&-', "sh", *COMMAND, *words]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


class TestColours:
    WORDS = ("run", str(CONFIGS / "ur5_paper.yaml"), "-o", "out", "--set", "report.html=false")

    def test_a_terminal_shows_them(self, tmp_path: Path) -> None:
        """The status is green there."""
        status, _, printed = on_a_terminal(tmp_path, *self.WORDS)
        assert status == 0
        assert "\x1b[32mok" in printed


def test_python_runs_the_package_as_the_command() -> None:
    """`python -m dh2urdf` is the command, under its own name."""
    shown = subprocess.run(
        [sys.executable, "-m", "dh2urdf", "--help"], capture_output=True, text=True, check=True
    ).stdout
    assert shown.startswith("Usage: dh2urdf [OPTIONS] COMMAND")


class TestEmptyWords:
    """What an unset variable of the shell leaves of a path would be the current folder."""

    @pytest.mark.parametrize(
        "words", [["run", "run.yaml", "-o", ""], ["convert", "arm.csv", "--output="], ["convert", "", "-o", "arm.urdf"]]
    )
    def test_they_are_refused(
        self, cli: Cli, words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """A run with `-o "$OUT"` wrote into the current folder, and its next run removed from there."""
        monkeypatch.chdir(tmp_path)
        (tmp_path / "arm.csv").write_text("# convention: standard\na,alpha,d\n0.3,0,0\n")
        (tmp_path / "run.yaml").write_text("inputs: arm.csv\n")
        cli(*words, status=2)
        assert sorted(path.name for path in tmp_path.iterdir()) == ["arm.csv", "run.yaml"]


def test_shells_complete_paths() -> None:
    """A shell asks which words may follow: where a path is wanted, it is to look for files."""
    answer = subprocess.run(
        [Path(sys.executable).parent / "dh2urdf"],
        env={
            **os.environ,
            "_DH2URDF_COMPLETE": "bash_complete",
            "COMP_WORDS": "dh2urdf convert arm",
            "COMP_CWORD": "2",
        },
        capture_output=True,
        text=True,
        check=True,
    )
    assert answer.stdout.strip() == "file,arm"


def test_every_command_gives_its_answer_as_one() -> None:
    """While a command is at work `click.echo` is for remarks: where it writes by itself would be standard error."""
    folder = Path(cli.__file__).parent
    modules = [path for path in folder.glob("*.py") if path.name not in ("__init__.py", "answers.py")]
    assert len(modules) > 6
    for path in modules:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "click.echo":
                assert "err" in [word.arg for word in node.keywords], f"{path.name}:{node.lineno}"
