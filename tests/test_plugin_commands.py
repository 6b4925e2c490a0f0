"""Commands that plugins add: those of third parties, and a host without `check`, `studio` and `view`."""

import subprocess
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from child_python import python

from dh2urdf.errors import StageConflictError
from dh2urdf.hookspecs import hookimpl
from dh2urdf.isolation.attribution import Plugin
from dh2urdf.plugin_system import Catalog
from dh2urdf.stages import Subcommand

Called = Callable[..., tuple[str, str]]

ROOT = Path(__file__).parents[1]
LAB = """
from dh2urdf.hookspecs import hookimpl
from dh2urdf.stages import Subcommand

@hookimpl
def dh2urdf_commands():
    return [Subcommand(name=name, summary="What a lab does.", function=f"lab_commands:{name}") for name in NAMES]
"""
COMMANDS = """
import click
from dh2urdf.errors import InputError
from dh2urdf.source import Problem

@click.command()
@click.argument("what")
def measure(what):
    "Measure WHAT."
    if what == "fault":
        raise LookupError("no ruler")
    if what == "error":
        raise InputError(Problem(message="no arm"))
    click.echo(f"{what} is measured")
    return 1 if what == "small" else 0

convert = measure
number = 7
"""


@pytest.fixture
def called(
    tmp_path: Path, install: Callable[..., None], dh2urdf: Callable[..., subprocess.CompletedProcess[str]]
) -> Called:
    """What a command prints beside an installed plugin that adds some: on standard output, and on standard error."""
    site = tmp_path / "site"
    install(site, "lab", f'NAMES = ["measure", "convert", "number", "absent"]\n{LAB}')
    (site / "lab_commands.py").write_text(COMMANDS)

    def call(*words: str, status: int = 0) -> tuple[str, str]:
        answer = dh2urdf(*words, path=[site], status=status)
        return answer.stdout, answer.stderr

    return call


class TestOfAThirdParty:
    def test_help_lists_it_behind_the_others(self, called: Called) -> None:
        """With its summary; nothing of the command itself is imported."""
        lines = called("--help")[0].splitlines()
        place = next(i for i, line in enumerate(lines) if line.startswith("  new-plugin"))
        assert lines[place + 1].split(maxsplit=1) == ["measure", "What a lab does."]
        assert sum("What a lab does." in line for line in lines) == 3, "that of the name `convert` is not seen"

    def test_it_is_called(self, called: Called) -> None:
        """What its function returns is the exit status."""
        assert called("measure", "arm") == ("arm is measured\n", "")
        assert called("measure", "small", status=1)[0] == "small is measured\n"
        assert called("measure", "--help")[0].startswith("Usage: dh2urdf measure ")
        assert "-o, --out" in called("convert", "--help")[0], "a command of dh2urdf keeps its name"
        for words in (("--without", "lab", "measure", "arm"), ("measure", "arm", "--without=lab")):
            called(*words, status=2)

    def test_an_error_is_printed_as_any(self, called: Called) -> None:
        """An error of `dh2urdf.errors` has its status and its sentence; another one is the plugin's fault."""
        assert called("measure", "error", status=2)[1] == "error: no arm\n"
        fault = called("measure", "fault", status=3)[1]
        assert "plugin 'lab = lab_lab' of lab 1.0 is broken: the command 'measure': LookupError: no ruler" in fault

    @pytest.mark.parametrize(
        ("name", "reason"),
        [("number", "TypeError: lab_commands:number is int, not a click.Command"), ("absent", "AttributeError: ")],
    )
    def test_a_function_that_is_none(self, called: Called, name: str, reason: str) -> None:
        """The plugin is named, with what is wrong."""
        assert f"of lab 1.0 is broken: the command '{name}': {reason}" in called(name, status=3)[1]

    def test_a_broken_plugin_is_named_where_a_command_is_missing(self, called: Called, tmp_path: Path) -> None:
        """It may have added it; the commands of dh2urdf and the help do not mind."""
        (tmp_path / "site" / "lab_lab.py").write_text("raise RuntimeError")
        assert called("--help")[1] == ""
        assert called("example", "ur5")[0]
        error = called("measure", "arm", status=2)[1]
        assert "the plugin 'lab = lab_lab' of lab 1.0 is broken, and may have added it" in error


def plugin(name: str, *given: Any, entry: str = "") -> Plugin:
    module = SimpleNamespace(dh2urdf_commands=hookimpl(lambda: given))
    return Plugin(name=f"{entry or name} = {name}", distribution=f"{name} 1.0", module=module)


def subcommand(name: str = "measure", function: str = "lab:measure") -> Subcommand:
    return Subcommand(name=name, summary="s", function=function)


class TestRecords:
    def test_two_plugins_with_one_name(self) -> None:
        """Neither is called; an entry point that names the command goes before one that does not."""
        with pytest.raises(StageConflictError, match="command 'measure'"):
            Catalog([plugin("one", subcommand()), plugin("two", subcommand())]).command("measure")
        catalog = Catalog([plugin("one", subcommand()), plugin("two", subcommand(), entry="command.measure")])
        found = catalog.command("measure")
        assert found is not None
        assert found.plugin.distribution == "two 1.0"

    @pytest.mark.parametrize(
        ("given", "reason"),
        [
            ("measure", "the hook dh2urdf_commands gave str 'measure', not a dh2urdf.stages.Subcommand"),
            (subcommand(name="--measure"), "has no name that could be asked for"),
            (subcommand(function="lab"), "accepted: module:name"),
        ],
    )
    def test_what_is_no_command(self, given: Any, reason: str) -> None:
        """The plugin is broken, and the reason is said."""
        catalog = Catalog([plugin("one", given)])
        assert catalog.commands() == {}
        assert reason in catalog.broken[0].reason

    def test_an_entry_point_names_one(self) -> None:
        """A plugin whose entry point names a stage is not asked for commands; one that names a missing command is broken."""
        assert Catalog([plugin("one", subcommand(), entry="emitter.usd")]).commands() == {}
        catalog = Catalog([plugin("one", subcommand(), entry="command.weigh")])
        assert catalog.command("weigh") is None
        assert "names the command 'weigh', and the hook dh2urdf_commands gives 'measure'" in catalog.broken[0].reason


def without_them(*command: str) -> subprocess.CompletedProcess[str]:
    return python(*command, folder=ROOT, DH2URDF_HIDDEN="dh2urdf_check dh2urdf_studio")


@pytest.mark.long
def test_the_tests_of_the_host_pass_without_the_built_in_commands() -> None:
    """Neither package can be imported, and no entry point names them: commands, conversion, emitters and contracts work."""
    tests = ("tests/pipeline/cli/test_main.py", "tests/pipeline/test_api.py", "tests/plugins/emitters/test_urdf.py")
    done = without_them("-m", "pytest", "-p", "no:cacheprovider", *tests)
    assert done.returncode == 0, done.stdout
    assert "without dh2urdf_check, dh2urdf_studio" in done.stdout
