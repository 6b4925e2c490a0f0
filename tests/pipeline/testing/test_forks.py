"""Calls of a contract are made in forks of an interpreter that is kept: each as if it had an interpreter of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import CrashError
from dh2urdf.testing.children import forks
from dh2urdf.testing.children.witness import marked, processes, witnessed

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="interpreters fork on Linux only")

STAGE = """
import os, signal, subprocess, sys, time

calls = 0
with open("imported", "a") as file:
    file.write("x")

def count():
    global calls
    calls += 1
    return calls

def where(name):
    return os.getpid(), os.getppid(), os.getcwd(), sys.path[0], os.environ.get(name), hash("text")

def crash():
    print("last words", flush=True)
    os.kill(os.getpid(), signal.SIGSEGV)

def leave(status):
    os._exit(status)

def leave_a_fork():
    if os.fork() == 0:
        if os.fork() == 0:
            time.sleep(60)
        os._exit(0)
    time.sleep(0.2)
"""


@pytest.fixture
def stage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A module that is there for this test alone."""
    (tmp_path / "forked_stage.py").write_text(STAGE)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.chdir(tmp_path)
    yield import_module("forked_stage")
    del sys.modules["forked_stage"]


def test_no_call_meets_what_another_left(stage: Any, tmp_path: Path) -> None:
    """A module of the stage is imported in each call, as it is here: what it counts begins anew."""
    assert [witnessed(stage.count).value for _ in range(2)] == [1, 1]
    assert (tmp_path / "imported").read_text() == "xxx"


def test_a_call_has_the_place_of_its_caller(stage: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Path and environment are those at the time of the call; the processes differ, and so do hashes by the seed."""
    monkeypatch.setenv("OF_THIS_TEST", "1")
    first, again, other = (witnessed(stage.where, "OF_THIS_TEST", seed=seed).value for seed in (1, 1, 2))
    for number, _, folder, path, variable, _ in (first, again, other):
        assert number != os.getpid()
        assert folder != str(tmp_path)  # an empty one, which is watched
        assert (path, variable) == (str(tmp_path), "1")
    assert first[0] != again[0]
    assert first[1] == again[1] != other[1]  # the interpreter that is kept
    assert first[5] == again[5] != other[5]


@pytest.mark.parametrize(
    ("end", "args", "message"),
    [
        ("crash", (), r"the stage crashed \(segmentation fault\).*last words"),
        ("leave", (3,), r"the stage left the process \(exit status 3\)"),
        ("leave", (0,), r"the stage left the process \(exit status 0\)"),
    ],
)
def test_a_call_that_ends_its_process_is_told(stage: Any, end: str, args: tuple[Any, ...], message: str) -> None:
    """As of an interpreter of its own; the next call has a new one."""
    with pytest.raises(CrashError, match=message):
        witnessed(getattr(stage, end), *args)
    assert witnessed(stage.count).value == 1


def test_a_fork_of_a_call_does_not_stay(stage: Any, is_running: Callable[[int], bool]) -> None:
    """Nobody's child, without a command line of its own, it is found by its mark."""
    seen = witnessed(stage.leave_a_fork)
    assert len(seen.left) == 1
    assert "started a process (os.fork)" in seen.deeds
    kept = forks._KEPT[0, forks.HOST]
    assert is_running(kept.number)
    kept.end()
    assert not is_running(kept.number)


def test_processes_of_others_may_have_any_words() -> None:
    """A word of a command line that is no UTF-8, such as the name of a file, is nobody's fault."""
    program = [os.fsencode(sys.executable), b"-c", b"input()", b"gr\xfcn.csv"]
    with marked() as mark, subprocess.Popen(program, stdin=subprocess.PIPE) as process:
        found = processes(mark)
        process.communicate(b"\n")
    assert found[process.pid].endswith("gr\ufffdn.csv")
