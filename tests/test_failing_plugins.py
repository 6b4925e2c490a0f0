"""Whatever a plugin raises, wherever it does, is reported as its own fault: plugin, distribution and version.

What happens at import, at registration and in hooks is in tests/pipeline/plugin_system.
"""

import json
import signal
import sys
from collections.abc import Callable
from inspect import getsource
from pathlib import Path
from subprocess import CompletedProcess
from typing import Any

import pytest
from command_line import Answer, Cli
from other_fields import with_field

from dh2urdf.cli import exit_status_of

PLUGIN = """
from dataclasses import dataclass, fields, replace
from typing import Any
from dh2urdf import errors
from dh2urdf.hookspecs import hookimpl
from dh2urdf.manipulator import Convention, DHRow, Manipulator
from dh2urdf.plugin_system.records import CAPABILITIES
from dh2urdf.stages import (Compares, Edit, EmittedFile, Executor, HasSchema, Loader, LoadReport, NoOptions, OtherFiles,
                            Reader, Rejected)
from dh2urdf_plugins.formats.urdf import EMITTER
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

class Unpicklable(Exception):
    def __init__(self, one, two):
        super().__init__(f"{one} and {two}")

@dataclass(frozen=True)
class Options:
    def __post_init__(self):
        fail()

def fail(*_arguments):
    raise ZeroDivisionError("at work")

def fail_oddly(*_arguments):
    raise Unpicklable("at work", "odd")

def leave(*_arguments):
    raise SystemExit(7)

class Panic(BaseException):
    pass

def panic(*_arguments):
    raise Panic("as extensions in Rust do")

def refuse(*_arguments):
    of = {"reader": errors.TableError, "transform": errors.TransformError, "edit": errors.EditError,
          "emitter": errors.EmitterError, "loader": errors.LoaderError}
    raise of[KIND]("an arm on Sundays")

def refuse_to_read(*_arguments):
    raise errors.InputError("line 3 is missing")

class Speechless(Exception):
    def __str__(self):
        raise ValueError("no words")

def fail_without_words(*_arguments):
    raise Speechless

def give_nothing(*_arguments):
    return None

def give_numbers(*_arguments):
    return [7]

def give_a_path(*_arguments):
    return [EmittedFile(name="../../arm.bad", content=b"x")]

def give_no_file(*_arguments):
    return []

def reject_in_silence(*_arguments):
    yield Rejected(name="right", problems=())

def give_another_name(table, _):
    return replace(table, name="other")

def promise_a_picture(request, options):
    return replace(load(request, options), picture="arm.png")

def read(path, options):
    for name in ("left", "right"):
        row = DHRow(joint="turn", link="one", a=0.5, alpha=0.0, d=0.1)
        yield Manipulator(name=name, convention=Convention.STANDARD, rows=(row,))

def same(record, options):
    return record

def load(request, options):
    return LoadReport(simulator="paper", version="1", poses=len(request.poses), position_error=0.0)

KIND, FIELD, HOW = "{what}".split(".")

def setting(name, usual):
    return property(globals()[HOW] if (KIND, FIELD) == ("loader", name) else lambda _: usual)

@dataclass(frozen=True)
class Settings:
    poses, picture, time_limit = setting("poses", 2), setting("picture", False), setting("time_limit", 300.0)

WITH_FIELD
GOOD = {
    "reader": Reader(name="bad", summary="s", read=read, options=NoOptions, suffixes=(".bad",),
                     capabilities=(HasSchema(dict),)),
    "transform": with_field(replace(TRANSFORM, name="bad"), "option", None),
    "edit": Edit(name="bad", summary="s", options=NoOptions, edit_table=same, edit_robot=same),
    "emitter": with_field(replace(EMITTER, name="bad", suffixes=(".bad", ".robot")), "other_endings", (".urdf",)),
    "loader": Loader(name="bad", summary="s", open=load, options=Settings, formats=("urdf", "bad")),
    "executor": Executor(name="bad", summary="s", map=lambda work, tasks, _: map(work, tasks), options=NoOptions),
}
def given(kind):
    stage = replace(GOOD[kind], map=None) if FIELD == "pool" and kind == KIND else GOOD[kind]
    yield with_field(stage, FIELD, globals()[HOW]) if kind == KIND and not hasattr(Settings, FIELD) else stage

@hookimpl
def dh2urdf_readers():
    return given("reader")

@hookimpl
def dh2urdf_transforms():
    return given("transform")

@hookimpl
def dh2urdf_edits():
    return given("edit")

@hookimpl
def dh2urdf_emitters():
    return given("emitter")

@hookimpl
def dh2urdf_loaders():
    return given("loader")

@hookimpl
def dh2urdf_executors():
    return given("executor")
"""
RUN = (
    "inputs: arm.bad\ntransform: bad\nedits: bad\nemitters: [bad]\nloaders: bad\nexecution: bad\n"
    "output: {directory: out}\nreport: {html: false}\n"
)
PLUGIN = PLUGIN.replace("WITH_FIELD", getsource(with_field))
PLUGIN_NAME = "plugin 'lab = lab_lab' of lab 1.0 is broken: "


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, install: Callable[..., None]) -> Callable[[str], Path]:
    """Install a plugin with one bad stage, and write a run that uses all of its stages."""

    def with_bad(what: str) -> Path:
        install(tmp_path / "site", "lab", PLUGIN.replace("{what}", what))
        monkeypatch.syspath_prepend(tmp_path / "site")
        monkeypatch.delitem(sys.modules, "lab_lab", raising=False)
        (tmp_path / "arm.bad").touch()
        (tmp_path / "run.yaml").write_text(RUN)
        return tmp_path

    return with_bad


def said(answer: Answer) -> str:
    return " ".join(answer.stderr.split())


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ("reader.read.leave", "reader 'bad' of lab 1.0 failed: SystemExit: 7"),
        ("reader.read_columns.fail", "reader 'bad' of lab 1.0 failed: ZeroDivisionError: at work"),
        ("transform.transform.panic", "transform 'bad' of lab 1.0 failed: Panic: as extensions in Rust do"),
        ("emitter.emit.fail_without_words", "emitter 'bad' of lab 1.0 failed: Speechless: its text cannot be made"),
        ("edit.edit_robot.fail", "edit 'bad' of lab 1.0 failed: ZeroDivisionError: at work"),
        (
            "emitter.emit.give_numbers",
            "emitter 'bad' of lab 1.0 failed: TypeError: it gave int, not dh2urdf.stages.Emit",
        ),
        ("emitter.in_folders.fail", "`in_folders` of the emitter 'bad' of lab 1.0 failed: ZeroDivisionError: at work"),
        ("loader.open.fail_oddly", "loader 'bad' of lab 1.0 failed: RuntimeError: Unpicklable: at work and odd"),
        ("loader.time_limit.fail", "loader 'bad' of lab 1.0 failed: ZeroDivisionError: at work"),
        ("loader.read_output.fail", "loader 'bad' of lab 1.0 failed: ZeroDivisionError: at work"),
        (
            "reader.read.reject_in_silence",
            "reader 'bad' of lab 1.0 failed: ValueError: it rejected 'right' and did not",
        ),
        (
            "edit.edit_table.give_another_name",
            "edit 'bad' of lab 1.0 failed: ValueError: it changed the name 'left' to",
        ),
        ("emitter.emit.give_a_path", "'../../arm.bad' is not a plain file name"),
        ("emitter.emit.give_no_file", "emitter 'bad' of lab 1.0 failed: ValueError: it gave no file"),
        ("loader.open.promise_a_picture", "ValueError: it reported a picture 'arm.png' and wrote none"),
        ("executor.map.give_no_file", "it gave no result of the batch that this manipulator is in"),
    ],
)
def test_at_work_on_a_manipulator(cli: Cli, lab: Callable[[str], Path], what: str, message: str) -> None:
    """The manipulator fails with stage, distribution and version, and the plugin whose authors should hear of it."""
    lab(what)
    nothing_was_read = what.startswith("reader")
    told = said(cli("run", "run.yaml", status=2 if nothing_was_read else 1))
    assert message in told
    assert "tell the authors of lab 1.0 (plugin 'lab = lab_lab')" in told
    assert "Traceback" not in told


@pytest.mark.parametrize(
    ("what", "kind", "message"),
    [
        ("transform.transform.refuse", "transform", "transform 'bad' of lab 1.0: an arm on Sundays"),
        ("emitter.read_back.refuse_to_read", "input", "`read_back` of the emitter 'bad' of lab 1.0: line 3 is missing"),
        ("loader.open.refuse", "loader", "bad: an arm on Sundays"),
    ],
)
def test_who_refuses_a_manipulator_is_named(
    cli: Cli, lab: Callable[[str], Path], what: str, kind: str, message: str
) -> None:
    """An error that a plugin's stage raises on purpose names it, once: the run may have five stages of the kind."""
    folder = lab(what)
    told = said(cli("run", "run.yaml", status=1))
    assert f"arm.bad: error: manipulator 'left': {message} " in told
    assert "tell the authors" not in told
    rows = json.loads((folder / "out" / "report.json").read_bytes())["manipulators"]
    assert [(row["kind"], row["errors"][0]["message"]) for row in rows] == [(kind, message)] * 2


@pytest.mark.parametrize(
    ("what", "words", "message"),
    [
        ("transform.keeps_kinematics.fail", "run run.yaml", "`keeps_kinematics` of the transform 'bad' failed: Zero"),
        ("loader.require.fail", "run run.yaml", "`require` of the loader 'bad' failed: ZeroDivisionError: at work"),
        ("executor.require.fail", "run run.yaml", "`require` of the executor 'bad' failed: ZeroDivisionError: at work"),
        ("executor.pool.fail", "run run.yaml", "the executor 'bad' failed: ZeroDivisionError: at work"),
        ("emitter.check.fail", "check arm.bad", "`check` of the emitter 'bad' failed: ZeroDivisionError: at work"),
        ("reader.schema.fail", "schema table", "`schema` of the reader 'bad' failed: ZeroDivisionError: at work"),
        ("edit.options.Options", "run run.yaml", "the options type Options of the edit 'bad' does not work: Zero"),
    ],
)
def test_what_the_whole_command_needs(
    cli: Cli, lab: Callable[[str], Path], what: str, words: str, message: str
) -> None:
    """Status 3, with the plugin, the distribution, its version, the stage, and what was asked of it."""
    folder = lab(what)
    assert PLUGIN_NAME + message in said(cli(*words.split(), status=3))
    assert not list(folder.glob("out/*.bad"))


@pytest.mark.parametrize(
    ("what", "reason"),
    [
        ("transform.transform_columns.fail", "transform 'bad' of lab 1.0 failed: ZeroDivisionError: at work"),
        ("emitter.emit_columns.give_numbers", "emitter 'bad' of lab 1.0 failed: TypeError: "),
        ("emitter.read_columns.fail", "emitter 'bad' of lab 1.0 failed: ZeroDivisionError: at work"),
    ],
)
def test_where_many_are_made_at_once(cli: Cli, lab: Callable[[str], Path], what: str, reason: str) -> None:
    """Each is made by itself, proved like any, and a notice says why, and whose fault it is."""
    folder = lab(what)
    cli("run", "run.yaml", "--set", "loaders=[]", "--set", "edits=[]")
    rows = json.loads((folder / "out" / "report.json").read_bytes())["manipulators"]
    assert [row["status"] for row in rows] == ["ok", "ok"]
    for row in rows:
        assert row["proof"]["bad"]["position_error"] < 1e-12
        (notice,) = (notice["message"] for notice in row["notices"] if "of lab 1.0" in notice["message"])
        assert notice.startswith(reason)
        assert "; it was made by itself" in notice


def test_debug_shows_where(
    lab: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """The line of the plugin that raised it, also where that was in a child process."""
    monkeypatch.chdir(lab("loader.open.fail"))
    assert exit_status_of(["--debug", "run", "run.yaml"]) == 1
    told = capfd.readouterr().err
    assert "Traceback (most recent call last):" in told
    assert 'raise ZeroDivisionError("at work")' in told


def test_debug_shows_where_of_listed_plugins(
    tmp_path: Path, install: Callable[..., None], monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """`dh2urdf --debug plugins` shows the tracebacks, and --json has them always, as its schema says."""
    install(tmp_path, "at-import", "raise OSError('the licence server does not answer')")
    monkeypatch.syspath_prepend(tmp_path)
    assert exit_status_of(["plugins"]) == 0
    assert "Traceback" not in capfd.readouterr().out
    assert exit_status_of(["--debug", "plugins"]) == 0
    assert "raise OSError('the licence server does not answer')" in capfd.readouterr().out
    assert exit_status_of(["plugins", "--json"]) == 0
    (entry,) = json.loads(capfd.readouterr().out)["broken"]
    assert "raise OSError('the licence server does not answer')" in entry.pop("traceback")
    assert entry == {
        "plugin": "lab = at_import_lab",
        "distribution": "at-import 1.0",
        "reason": "OSError: the licence server does not answer",
    }


def test_a_fault_of_the_host_is_no_executor_s(
    cli: Cli, lab: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What dh2urdf itself raises inside an executor, which calls it, is reported as an internal error."""
    lab("reader.schema.fail")

    def fail(*_arguments: Any) -> None:
        raise LookupError("the ground is gone")

    monkeypatch.setattr("dh2urdf.running.batch_work.Work.done", fail)
    assert "dh2urdf: internal error: LookupError: the ground is gone" in said(cli("run", "run.yaml", status=1))


def test_options_that_cannot_be_described(
    tmp_path: Path, install: Callable[..., None], monkeypatch: pytest.MonkeyPatch, cli: Cli
) -> None:
    """A default that cannot be made does not end the list: the stage is there, the plugin is named as broken."""
    source = (
        "from dataclasses import dataclass, field, replace\nfrom dh2urdf.hookspecs import hookimpl\n"
        "from dh2urdf_plugins.formats.urdf import EMITTER\n"
        "def odd():\n    raise RuntimeError('not shown')\n"
        "@dataclass(frozen=True)\nclass Options:\n    odd: int = field(default_factory=odd)\n"
        "@hookimpl\ndef dh2urdf_emitters():\n    return [replace(EMITTER, name='odd', options=Options)]\n"
    )
    install(tmp_path, "shy", source)
    monkeypatch.syspath_prepend(tmp_path)
    listed = json.loads(cli("plugins", "--json").stdout)
    assert "odd" in {stage["name"] for stage in listed["stages"]}
    (entry,) = listed["broken"]
    assert entry["distribution"] == "shy 1.0"
    assert entry["reason"] == "`options` of the emitter 'odd' failed: RuntimeError: not shown"


def test_what_a_plugin_prints_is_no_answer(
    tmp_path: Path, install: Callable[..., None], dh2urdf: Callable[..., CompletedProcess[str]]
) -> None:
    """Standard output has what was asked for alone; what a plugin prints, from programs too, is on standard error."""
    source = (
        "import os\nfrom dataclasses import replace\nfrom dh2urdf.hookspecs import hookimpl\n"
        "from dh2urdf_plugins.formats.urdf import EMITTER\nprint('welcome')\n"
        "@hookimpl\ndef dh2urdf_emitters():\n    os.system('echo licensed')\n    yield replace(EMITTER, name='noisy')\n"
    )
    install(tmp_path / "site", "noisy", source)
    answer = dh2urdf("plugins", "--json", path=[tmp_path / "site"])
    assert json.loads(answer.stdout)
    assert {"welcome", "licensed"} <= set(answer.stderr.split())


def test_what_an_emitter_prints_is_not_in_its_file(
    tmp_path: Path, install: Callable[..., None], dh2urdf: Callable[..., CompletedProcess[str]]
) -> None:
    """A description on standard output is the one that a file would hold."""
    source = (
        "from dataclasses import replace\nfrom dh2urdf.hookspecs import hookimpl\n"
        "from dh2urdf_plugins.formats.urdf import EMITTER\n"
        "def emit(robot, stem, options):\n    print('at work')\n    return EMITTER.emit(robot, stem, options)\n"
        "@hookimpl\ndef dh2urdf_emitters():\n    yield replace(EMITTER, name='noisy', emit=emit, suffixes=('.noisy', '.urdf'))\n"
    )
    install(tmp_path / "site", "noisy", source)
    (tmp_path / "arm.csv").write_text("# convention: standard\na, alpha, d\n0.4, 0, 0.1\n")
    answer = dh2urdf("convert", "arm.csv", "--to", "noisy", path=[tmp_path / "site"])
    quiet = dh2urdf("convert", "arm.csv", "--to", "urdf", path=[tmp_path / "site"])
    assert answer.stdout == quiet.stdout
    assert answer.stderr == "emitter 'noisy' of noisy 1.0 prints: at work\n" + quiet.stderr


def test_what_crashes_the_command_itself_is_named(
    tmp_path: Path, install: Callable[..., None], dh2urdf: Callable[..., CompletedProcess[str]]
) -> None:
    """`convert` calls stages in its own process: one that crashes it is known all the same."""
    source = (
        "import ctypes, os\nfrom dataclasses import replace\nfrom dh2urdf.hookspecs import hookimpl\n"
        "from dh2urdf_plugins.formats.urdf import EMITTER\n\ndef emit(robot, stem, options):\n"
        "    ctypes.string_at(0)\n"
        "@hookimpl\ndef dh2urdf_emitters():\n    yield replace(EMITTER, name='bad', emit=emit, suffixes=('.bad',))\n"
    )
    install(tmp_path / "site", "rude", source)
    (tmp_path / "arm.csv").write_text("# convention: standard\na, alpha, d\n0.4, 0, 0.1\n")
    answer = dh2urdf("convert", "arm.csv", "-o", "arm.bad", path=[tmp_path / "site"], status=-signal.SIGSEGV)
    assert 'rude_lab.py", line 7 in emit' in answer.stderr
    assert not (tmp_path / "arm.bad").exists()
