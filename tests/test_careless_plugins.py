"""Plugins that work and leave something behind: another folder, a thread, a second process, a changed file.

Each test is a run of three arms by the real command. What a stage does besides its work changes nothing of the other
arms, and the command ends.
"""

import json
import time
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

Command = Callable[..., CompletedProcess[str]]
Made = Callable[..., tuple[CompletedProcess[str], dict[str, str]]]

PLUGIN = """
import os, shutil, signal, subprocess, sys, threading, time
from dh2urdf.hookspecs import hookimpl
from dh2urdf.manipulator import Convention, DHRow, Manipulator
from dh2urdf.stages import EmittedFile, Emitter, Executor, Loader, LoadReport, NoOptions, Reader

def read(path, options):
    for name in ("left", "right", "third"):
        row = DHRow(joint="turn", link="one", a=0.5, alpha=0.0, d=0.1)
        yield Manipulator(name=name, convention=Convention.STANDARD, rows=(row,))

def emit(robot, stem, options):
    if "{stage}" == "emit" and robot.name == "right":
        {code}
    return [EmittedFile(name=f"{stem}.bad", content=robot.name.encode())]

def load(request, options):
    if "{stage}" == "load" and request.robot.name == "right":
        {code}
    return LoadReport(simulator="paper", version="1", poses=len(request.poses), position_error=0.0)

def look(request, options):
    if request.path.read_text() != request.robot.name:
        raise ValueError("this is another file")
    return LoadReport(simulator="glasses", version="1", poses=len(request.poses), position_error=0.0)

def work(function, tasks, options):
    for task in tasks:
        yield function(task)
    if "{stage}" == "map":
        while True:
            yield {code}

def loader(name, load):
    return Loader(name=name, summary="s", open=load, options=NoOptions, formats=("bad",))

@hookimpl
def dh2urdf_readers():
    return [Reader(name="bad", summary="s", read=read, options=NoOptions, suffixes=(".bad",))]

@hookimpl
def dh2urdf_emitters():
    return [Emitter(name="bad", summary="s", emit=emit, options=NoOptions, suffixes=(".bad",))]

@hookimpl
def dh2urdf_loaders():
    return [loader("first", load), loader("second", look)]

@hookimpl
def dh2urdf_executors():
    return [Executor(name="bad", summary="s", map=work, options=NoOptions)]
"""
RUN = "inputs: arm.bad\nemitters: bad\noutput: {directory: out}\nreport: {html: false}\n"
BOTH = "loaders: [first, second]\n"


@pytest.fixture
def made(tmp_path: Path, dh2urdf: Command, install: Callable[..., None]) -> Made:
    """The answer of a run with a stage that does something, and the status of each arm."""

    def run(
        stage: str, code: str, *words: str, more: str = "", status: int = 0
    ) -> tuple[CompletedProcess[str], dict[str, str]]:
        install(tmp_path / "site", "lab", PLUGIN.replace("{stage}", stage).replace("{code}", code))
        (tmp_path / "arm.bad").touch()
        (tmp_path / "run.yaml").write_text(RUN + more)
        answer = dh2urdf("run", "run.yaml", "--quiet", *words, path=[tmp_path / "site"], status=status)
        assert "internal error" not in answer.stderr
        rows = [json.loads(line) for line in (tmp_path / "out" / "manifest.jsonl").read_text().splitlines()]
        rows = [row for row in rows if "status" in row]
        assert [row["name"] for row in rows] == ["left", "right", "third"]  # each once
        for row in rows:
            for file in row.get("files", ()):
                assert (tmp_path / "out" / file["path"]).read_text() == row["name"]
        return answer, {row["name"]: row["status"] for row in rows}

    return run


ALL_WELL = {"left": "ok", "right": "ok", "third": "ok"}
WORKERS = pytest.mark.parametrize("workers", ["1", "2"])


@WORKERS
@pytest.mark.parametrize("code", ["os.chdir('/')", "os.fork()"], ids=["folder", "fork"])
def test_a_stage_that_leaves_the_folder_or_forks(made: Made, code: str, workers: str) -> None:
    """The next arms are read and made as ever: the input was reported as changed, and a twin made them again."""
    answer, states = made("emit", code, "--workers", workers)
    assert states == ALL_WELL
    assert not answer.stderr


@WORKERS
@pytest.mark.parametrize(
    ("code", "said"),
    [
        (r"sys.stdout.buffer.write(b'caf\xc3'); sys.stdout.buffer.write(b'\xa9\xff\n')", r"prints: café\xff"),
        ("subprocess.run(['echo', 'hello'], stdout=sys.stdout, check=True)", "hello"),
    ],
    ids=["bytes", "program"],
)
def test_what_is_printed_by_all_ways_arrives(made: Made, code: str, said: str, workers: str) -> None:
    """Standard output has what libraries use of it: bytes, another encoding, and programs that print to it."""
    answer, states = made("emit", code, "--workers", workers)
    assert states == ALL_WELL
    assert said in answer.stderr


def test_dots_without_an_end_take_no_time(made: Made) -> None:
    """A hundred thousand dots in one line; each was joined with all before it, which took minutes."""
    begun = time.monotonic()
    answer, states = made("emit", "[print('.', end='') for _ in range(100_000)]", "--workers", "1")
    assert states == ALL_WELL
    assert answer.stderr.count(".") >= 100_000
    assert time.monotonic() - begun < 60


@WORKERS
def test_a_loader_that_changes_its_file_is_the_one_that_fails(made: Made, workers: str) -> None:
    """The next loader finds the file as it was written; it was the one that failed."""
    code = "request.path.write_text('changed')"
    answer, states = made("load", code, "--workers", workers, more=BOTH, status=1)
    assert states == {"left": "ok", "right": "failed", "third": "ok"}
    assert "loader 'first' of lab 1.0 failed: ValueError: it changed or removed the file 'right.bad'" in answer.stderr
    assert "second" not in answer.stderr


@pytest.mark.parametrize("code", ["None", "function(task)"])
def test_an_executor_that_never_ends_is_left(made: Made, code: str) -> None:
    """All results are there, and what comes after them is not asked for; the run never ended."""
    _, states = made("map", code, more="execution: bad\n")
    assert states == ALL_WELL


def test_a_worker_that_is_told_to_end_names_who_did_it(made: Made) -> None:
    """SIGTERM, which programs send to their own process group to end their children, is named with the stage."""
    code = "os.kill(os.getpid(), signal.SIGTERM); time.sleep(1)"
    answer, states = made("emit", code, "--workers", "2", status=1)
    assert states == {"left": "ok", "right": "failed", "third": "ok"}
    assert "emitter 'bad' of lab 1.0 crashed (terminated)" in answer.stderr
