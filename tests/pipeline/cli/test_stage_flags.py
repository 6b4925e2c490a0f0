"""Options of stages as flags: those of dh2urdf, and those of any plugin whose options say so."""

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

TABLE = "# convention: standard\njoint,a,alpha,d,lower,upper,velocity,effort\nj1,0.4,0,0.1,-1,1,1,10\n"
PLUGIN = """
print("imported")
from dataclasses import dataclass, field, replace
from dh2urdf.hookspecs import hookimpl
from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Emitter, EmittedFile

@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    greeting: str = field(default="hello", metadata={"flag": "TEXT", "help": "what the file begins with"})
    quiet: str = field(default="no", metadata={"flag": "Q", "help": "a flag that the command has"})
    frames: str = field(default="none", metadata={"flag": "F", "help": "a flag that the transform has"})
    silent: bool = field(default=False, metadata={"help": "no flag"})
    elsewhere: str = field(default="", metadata={"flag": "E", "commands": ("info",), "help": "of another command"})

def emit(robot, stem, options):
    text = f"{options.greeting} {robot.name} {options.quiet} {options.frames}"
    return [EmittedFile(name=f"{stem}.note", content=text.encode())]

@hookimpl
def dh2urdf_emitters():
    return [Emitter(name="note", summary="notes", emit=emit, options=Options, suffixes=(".note",))]
"""


@pytest.fixture
def plugin(tmp_path: Path, install: Callable[..., None]) -> Path:
    site = tmp_path / "site"
    site.mkdir()
    install(site, "lab-note", PLUGIN)
    (tmp_path / "arm.csv").write_text(TABLE)
    return site


def test_a_plugin_s_option_is_a_flag(dh2urdf: Callable[..., subprocess.CompletedProcess[str]], plugin: Path) -> None:
    """Its record says so, and the command line takes it; the commands' own flags, and the help, stay as they are."""
    words = ("convert", "arm.csv", "-o", "arm.note", "--greeting", "good day", "--frames", "dh")
    dh2urdf(*words, path=[plugin])
    assert (plugin.parent / "arm.note").read_text() == "good day arm no none"
    shown = dh2urdf("convert", "--help", path=[plugin]).stdout
    assert "--greeting" not in shown  # it imports no plugin
    assert shown.count("--frames ") == 2  # an example, and the flag of the transform
    assert re.search("-q, --quiet +Say only what fails.", shown)
    for word in ("--silent", "--elsewhere"):
        assert "No such option" in dh2urdf(*words, word, "x", path=[plugin], status=2).stderr


def test_a_plugin_is_not_imported_for_the_flags_of_others(
    dh2urdf: Callable[..., subprocess.CompletedProcess[str]], plugin: Path
) -> None:
    """Only a flag that no built-in stage has makes it ask the plugins."""
    done = dh2urdf("convert", "arm.csv", "-o", "arm.urdf", "--frames", "dh", "--profile", "ros", path=[plugin])
    assert "imported" not in done.stdout + done.stderr
    refused = dh2urdf("convert", "arm.csv", "--fraems", "dh", path=[plugin], status=2)
    assert "No such option '--fraems'" in refused.stderr
    assert "--frames" in refused.stderr
