"""Plugins that are broken in many ways, each with the message that a person reads.

Every case is a run of two arms with one bad stage. Only the manipulators that it touches fail, unless the run depends on
it as a whole; the message names the stage, the distribution and its version. `pytest tests/test_broken_plugins.py -s`
prints all messages, to be read as prose.
"""

from __future__ import annotations

import json
import sys
from inspect import getsource
from typing import TYPE_CHECKING, NamedTuple

import pytest
from other_fields import with_field

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from conftest import Answer

    Cli = Callable[..., Answer]

PLUGIN = """
import os, pickle, signal, sys, time
from dataclasses import dataclass, field, fields, replace
from typing import Any
from dh2urdf import errors
from dh2urdf.errors import *
from dh2urdf.hookspecs import hookimpl
from dh2urdf.manipulator import Convention, DHRow, Manipulator
from dh2urdf.plugin_system.plugin_stages import CAPABILITIES
from dh2urdf.source import Problem
from dh2urdf.stages import Edit, EmittedFile, Executor, Loader, LoadReport, NoOptions, Reader, Rejected
from dh2urdf_plugins.emitters.urdf import EMITTER
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

def row(**changes):
    return DHRow(**{"joint": "turn", "link": "one", "a": 0.5, "alpha": 0.0, "d": 0.1} | changes)

def arm(name, *rows):
    return Manipulator(name=name, convention=Convention.STANDARD, rows=rows or (row(),))

def read(path, options):
    yield arm("left")
    yield arm("right")

def of_right(function):
    # What goes wrong at one manipulator only.
    def work(what, *others):
        robot = getattr(what, "robot", what)
        if robot.name == "right":
            return function(what, *others)
        return GOOD_FUNCTIONS[len(others)](what, *others)
    return work

def load(request, options):
    return LoadReport(simulator="paper", version="1", poses=len(request.poses), position_error=0.0)

def reported(**changes):
    return lambda request, options: replace(load(request, options), **changes)

def raising(error):
    def work(*_arguments):
        raise error
    return work

def giving(value):
    return lambda *_arguments: value

def file(name="arm.bad", content=b"x"):
    return giving([EmittedFile(name=name, content=content)])

class Late(MissingDependencyError):
    def __init__(self):
        super().__init__("late", "late", "late")

@dataclass(frozen=True)
class Unpicklable:
    function: object = field(default=lambda: 1, metadata={"help": "h"})

@dataclass(frozen=True)
class NotUnpicklable:
    def __reduce__(self):
        return int, ("no number",)

GOOD_FUNCTIONS = {1: TRANSFORM.transform, 2: EMITTER.emit}
KIND, FIELD = "{field}".split(".")

def setting(name, usual):
    return property(({value}) if (KIND, FIELD) == ("loader", name) else lambda _: usual)

@dataclass(frozen=True)
class Settings:
    poses, picture, time_limit = setting("poses", 2), setting("picture", False), setting("time_limit", 300.0)

WITH_FIELD
GOOD = {
    "reader": Reader(name="bad", summary="s", read=read, options=NoOptions, suffixes=(".bad",)),
    "transform": with_field(replace(TRANSFORM, name="bad"), "transform_columns", None),
    "edit": Edit(name="bad", summary="s", options=NoOptions, edit_table=lambda table, _: table),
    "emitter": with_field(with_field(replace(EMITTER, name="bad", suffixes=(".bad",)), "other_endings", (".urdf",)),
                          "emit_columns", None),
    "loader": Loader(name="bad", summary="s", open=load, options=Settings, formats=("bad",)),
    "executor": Executor(name="bad", summary="s", map=lambda work, tasks, _: map(work, tasks), options=NoOptions),
}
{before}

def bad_load(request, options):  # by its name: a child process imports it
    function = {value}
    return function(request, options)

def given(kind):
    stage = GOOD[kind]
    if kind == KIND == "loader" and FIELD == "open":
        return [replace(stage, open=bad_load)]
    is_bad = kind == KIND and FIELD != "hook" and not hasattr(Settings, FIELD)
    return [with_field(stage, FIELD, ({value}))] if is_bad else [stage]

@hookimpl
def dh2urdf_readers():
    return ({value}) if "{field}" == "reader.hook" else given("reader")

@hookimpl
def dh2urdf_transforms():
    return ({value}) if "{field}" == "transform.hook" else given("transform")

@hookimpl
def dh2urdf_edits():
    return ({value}) if "{field}" == "edit.hook" else given("edit")

@hookimpl
def dh2urdf_emitters():
    return ({value}) if "{field}" == "emitter.hook" else given("emitter")

@hookimpl
def dh2urdf_loaders():
    return ({value}) if "{field}" == "loader.hook" else given("loader")

@hookimpl
def dh2urdf_executors():
    return ({value}) if "{field}" == "executor.hook" else given("executor")
"""
PLUGIN = PLUGIN.replace("WITH_FIELD", getsource(with_field))
RUN = (
    "inputs: arm.bad\ntransform: bad\nedits: bad\nemitters: [bad]\nloaders: [bad]\nexecution: {stage: bad, time_limit: 8}\n"
    "output: {directory: out}\nreport: {html: false}\n"
)


class Broken(NamedTuple):
    """A broken plugin.

    Attributes:
        field: kind and field of the bad stage; ``hook`` for its hook.
        value: what is there, as code.
        message: what a person reads.
        failed: names of the manipulators that fail; None where the run does not begin.
        workers: how many processes work, of the executor `local`; 0 takes the plugin's executor.
        before: code that is run at import.
    """

    field: str
    value: str
    message: str
    failed: tuple[str, ...] | None = ("right",)
    workers: int = 0
    before: str = ""

    @property
    def status(self) -> int:
        """The exit status of the run."""
        if self.failed is None:
            return 2 if self.field == READ else 3  # Nothing could be read, or the run needs a plugin that is broken.
        return 1 if self.failed else 0

    @property
    def id(self) -> str:
        """A name for the case."""
        return " ".join(
            filter(None, (f"{self.field}={self.value}", self.before, "in a worker" if self.workers else ""))
        )


BOTH, ALL = ("left", "right"), None
EMIT, LOAD, SWAP, READ, MAP = "emitter.emit", "loader.open", "transform.transform", "reader.read", "executor.map"
E, L, T, R, D = (f"{kind} 'bad' of lab 1.0 failed: " for kind in ("emitter", "loader", "transform", "reader", "edit"))
X = "executor 'bad' of lab 1.0 failed: "
BROKEN = "plugin 'lab = lab_lab' of lab 1.0 is broken: "
NO_RESULT = f"{X}ValueError: it gave no result of the batch that this manipulator is in"

CASES = [
    # --- Emitters
    Broken(EMIT, "of_right(file(content='text'))",
           f"{E}TypeError: the name and the content of a file are 'arm.bad' and 'text'"),
    Broken(EMIT, "of_right(file(name='sub/arm.bad'))",
           f"{E}ValueError: 'sub/arm.bad' is not a plain file name; accepted: a name without a folder"),
    Broken(EMIT, "of_right(file(name='../../arm.bad'))", f"{E}ValueError: '../../arm.bad' is not a plain file name"),
    Broken(EMIT, "of_right(file(name='..'))", f"{E}ValueError: '..' is not a plain file name"),
    Broken(EMIT, "of_right(file(name=''))", f"{E}ValueError: '' is not a plain file name"),
    Broken(EMIT, "of_right(file(name=7))", f"{E}TypeError: the name and the content of a file are 7 and"),
    Broken(EMIT, "of_right(giving(None))", f"{E}TypeError: it gave None, not several of dh2urdf.stages.EmittedFile"),
    Broken(EMIT, "of_right(giving(b'<robot/>'))", f"{E}TypeError: it gave bytes, not several of dh2urdf.stages.EmittedFile"),
    Broken(EMIT, "of_right(giving([]))", f"{E}ValueError: it gave no file"),
    Broken(EMIT, "of_right(raising(EmitterError(())))", f"{E}EmitterError, without a message"),
    Broken(EMIT, "of_right(lambda *_: EmitterError(['no']))", f"{E}TypeError: EmitterError was made of 'no', not"),
    Broken(EMIT, "of_right(raising(OutputError('the disk is mine')))", f"{E}OutputError: the disk is mine"),
    Broken(EMIT, "of_right(raising(BrokenPluginError('p', 'd', 'r')))", f"{E}BrokenPluginError: plugin 'p' of d is broken"),
    Broken(EMIT, "of_right(lambda *_: MissingDependencyError('usd-core'))", f"{E}TypeError: MissingDependencyError.__init__() "
           "missing 2 required positional arguments: 'package' and 'extra'"),
    Broken(EMIT, "of_right(lambda *_: MissingDependencyError('emitter', None, 'lab[usd]'))",
           f"{E}TypeError: MissingDependencyError was made of None, not of a text"),
    Broken(EMIT, "of_right(lambda *_: os._exit(3))",
           "emitter 'bad' of lab 1.0 left the process (exit status 3) and gave no result", workers=2),
    Broken(EMIT, "of_right(lambda *_: os.kill(os.getpid(), signal.SIGSEGV))",
           "emitter 'bad' of lab 1.0 crashed (segmentation fault)", workers=2),
    Broken(EMIT, "of_right(lambda *_: time.sleep(60))", "emitter 'bad' of lab 1.0 did not finish within 8 s", workers=2),
    Broken("emitter.notices", "lambda robot, _: ['beware'] if robot.name == 'right' else []",
           f"{E}TypeError: it gave str, not dh2urdf.source.Problem"),
    Broken("emitter.read_back", "lambda path: '<robot/>'", f"{E}TypeError: it gave str, not dh2urdf.robot.Robot", BOTH),
    # --- Transforms
    Broken(SWAP, "of_right(giving(None))", f"{T}TypeError: it gave None, not dh2urdf.robot.Robot"),
    Broken(SWAP, "of_right(lambda table, _: row(a='1'))", f"{T}RecordTypeError: DHRow(): error: "),
    Broken(SWAP, "of_right(lambda *_: os._exit(0))", "transform 'bad' of lab 1.0 left the process (exit status 0)", workers=2),
    Broken("transform.keeps_kinematics", "giving(None)", f"{BROKEN}`keeps_kinematics` of the transform 'bad' failed: "
           "TypeError: it gave None, not bool", ALL),
    # --- Edits
    Broken("edit.edit_table", "giving(None)", f"{D}TypeError: it gave None, not dh2urdf.manipulator.Manipulator", BOTH),
    Broken("edit.edit_table", "lambda table, _: replace(table, name='other')", f"{D}ValueError: it changed the name 'left' to", BOTH),
    Broken("edit.edit_table", "lambda table, _: replace(table, rows=())", f"{D}RecordValueError: Manipulator()", BOTH),
    Broken("edit.edit_table", "raising(EditError(()))", f"{D}EditError, without a message", BOTH),
    Broken("edit.edit_robot", "giving(None)", f"{D}TypeError: it gave None, not dh2urdf.robot.Robot", BOTH),
    Broken("edit.edit_robot", "lambda robot, _: replace(robot, links=(*robot.links, robot.links[1]))", "after the edit 'bad' of lab 1.0: ",
           BOTH),
    Broken("edit.edit_robot", "lambda robot, _: os._exit(4)",
           "edit 'bad' of lab 1.0 left the process (exit status 4) and gave no result", BOTH, workers=2),
    Broken("edit.edit_table", "None", f"{BROKEN}ValueError: the edit 'bad' has to give edit_table, edit_robot, or both", ALL),
    # --- Readers
    Broken(READ, "lambda *_: iter([arm('left', row(a='1'))])", f"{R}RecordTypeError: DHRow(): error: ", ALL),
    Broken(READ, "lambda *_: iter([arm('left', row(a=float('nan')))])",
           "nan is not a finite number: the reader 'bad' of lab 1.0 made such a record of it", ALL),
    Broken(READ, "lambda *_: (each for each in (arm('left'), Rejected(name='right', problems=())))",
           f"{R}ValueError: it rejected 'right' and did not say why", ("arm",)),
    Broken(READ, "lambda *_: iter([arm('left'), None])", f"{R}TypeError: it gave None, not dh2urdf.manipulator.Manip", ("arm",)),
    Broken(LOAD, "reported(poses='2')", "sent an answer that cannot be used", BOTH),
    Broken(READ, "giving(None)", f"{R}TypeError: it gave None, not several of dh2urdf.manipulator.Manipulator", ALL),
    Broken(READ, "raising(TableError(()))", f"{R}TableError, without a message", ALL),
    Broken(READ, "raising(ExecutorError('nobody works'))", f"{R}ExecutorError: nobody works", ALL),
    # --- Loaders
    Broken(LOAD, "giving(None)", f"{L}TypeError: open returned NoneType, neither a SimulatedArm nor a LoadReport", BOTH),
    Broken(LOAD, "reported(picture='arm.png')", f"{L}ValueError: it reported a picture 'arm.png' and wrote none", BOTH),
    Broken(LOAD, "reported(picture='../arm.png')", f"{L}ValueError: '../arm.png' is not a plain file name", BOTH),
    Broken(LOAD, "lambda *_: os._exit(9)", "loader 'bad' of lab 1.0 left the process (exit status 9) and gave no result", BOTH),
    Broken("loader.time_limit", "giving('soon')", f"{L}TypeError: it gave str, not int or float", BOTH),
    Broken("loader.poses", "giving(2.5)", f"{L}TypeError: it gave float, not int", BOTH),
    Broken("loader.read_output", "giving(None)", f"{L}TypeError: it gave None, not several of dh2urdf.source.Problem", BOTH),
    Broken("loader.require", "giving(MissingDependencyError('a', 'b', 'c'))", f"{BROKEN}`require` of the loader 'bad' failed: "
           "TypeError: it gave MissingDependencyError, not None", ALL),
    Broken("loader.require", "lambda _: MissingProgramError('loader')", f"{BROKEN}`require` of the loader 'bad' failed: "
           "TypeError: MissingProgramError.__init__() missing 2 required positional arguments", ALL),
    # --- Executors
    Broken(MAP, "lambda work, tasks, _: []", NO_RESULT, BOTH),
    Broken(MAP, "lambda work, tasks, _: list(tasks) and []", NO_RESULT, BOTH),
    Broken(MAP, "lambda work, tasks, _: (None for task in tasks)",
           f"{X}TypeError: it gave None, not dh2urdf.tasks.batch_report.BatchReport or dh2urdf.stages.Lost", BOTH),
    Broken(MAP, "lambda work, tasks, _: (each for task in tasks for each in [work(task)] * 2)", "", ()),
    Broken(MAP, "lambda work, tasks, _: raising(KeyError('gone'))()", f"{BROKEN}the executor 'bad' failed: KeyError: 'gone'", ALL),
    Broken("executor.require", "giving(False)", f"{BROKEN}`require` of the executor 'bad' failed: TypeError: it gave bool", ALL),
    # --- Options
    Broken("emitter.options", "Unpicklable", f"{BROKEN}`options` of the emitter 'bad' failed: ", ALL, workers=2),
    Broken("emitter.options", "NotUnpicklable", f"{BROKEN}`options` of the emitter 'bad' failed: ValueError: invalid literal",
           ALL, workers=2),
    # --- Hooks and records
    Broken("emitter.hook", "None", f"{BROKEN}TypeError: the hook dh2urdf_emitters gave None, not a list of dh2urdf.stages.Emitter; no "
           "other plugin provides the emitter 'bad'", ALL),
    Broken("emitter.hook", "GOOD['emitter']", f"{BROKEN}TypeError: the hook dh2urdf_emitters gave Emitter, not a list of", ALL),
    Broken("emitter.suffixes", "('bad',)", f"{BROKEN}ValueError: the emitter 'bad' has the suffix 'bad'; accepted: lower case, "
           "with the dot before it", ALL),
    Broken("reader.suffixes", "('.BAD',)", f"{BROKEN}ValueError: the reader 'bad' has the suffix '.BAD'", ALL),
    # --- Imports
    Broken("emitter.name", "'bad'", f"{BROKEN}OSError: no licence", ALL, before="raise OSError('no licence')"),
    Broken("emitter.name", "'bad'", f"{BROKEN}SystemExit: usage: lab", ALL, before="sys.exit('usage: lab')"),
]  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("case", CASES, ids=[case.id for case in CASES])
def test_the_right_one_is_blamed(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, install: Callable[..., None], case: Broken
) -> None:
    """The message names who failed, and the manipulators that do not depend on it are made."""
    source = PLUGIN.replace("{field}", case.field).replace("{value}", case.value).replace("{before}", case.before)
    install(tmp_path / "site", "lab", source)
    monkeypatch.syspath_prepend(tmp_path / "site")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "site"), prepend=":")
    monkeypatch.delitem(sys.modules, "lab_lab", raising=False)
    (tmp_path / "arm.bad").touch()
    (tmp_path / "run.yaml").write_text(RUN.replace("stage: bad, ", "") if case.workers else RUN)
    words = ("--workers", str(case.workers), "--set", "loaders=[]") if case.workers else ()
    answer = cli("run", "run.yaml", "--quiet", *words, status=case.status)
    print(f"\n# {case.id}\n{answer.stderr}")  # noqa: T201 - to be read as prose
    told = " ".join(answer.stderr.split())
    assert " ".join(case.message.split()) in told
    assert "internal error" not in told
    assert not (tmp_path / "arm.bad.png").exists()
    if case.failed is not None:
        rows = json.loads((tmp_path / "out" / "report.json").read_bytes())["manipulators"]
        assert tuple(row["name"] for row in rows if row["status"] == "failed") == case.failed
        assert len(rows) == 2


def test_there_are_many() -> None:
    """Forty kinds at least, and no case twice."""
    assert len({case.id for case in CASES}) == len(CASES) >= 40
