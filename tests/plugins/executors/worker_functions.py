"""What workers of the executors' tests do, in a module that they can import."""

# ruff: noqa: T201 - what a worker prints is what some of these are about

from __future__ import annotations

import contextlib
import ctypes
import faulthandler
import os
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING, Any, NoReturn

from dh2urdf.errors import ConfigError, StageError
from dh2urdf.source import Mark, Problem

if TYPE_CHECKING:
    from pathlib import Path


def double(number: int) -> int:
    return 2 * number


class _Halving:
    """A function that says, as a run's does, whose stages it uses."""

    distributions: tuple[str, ...] = ()

    def __call__(self, number: int) -> float:
        return number / 2


halve = _Halving()


def pid(_task: Any) -> int:
    return os.getpid()


def double_or_die(task: int | str) -> int:
    """Numbers are doubled; words are ways to die."""
    match task:
        case int():
            return 2 * task
        case "segmentation fault":
            ctypes.string_at(0)
        case "leave":
            os.write(2, b"I am leaving\n")
            os._exit(3)
        case "hang":
            faulthandler.dump_traceback_later(0.5, exit=True)
            time.sleep(600)
        case "fork and die":
            if os.fork() == 0:
                time.sleep(600)
            os.kill(os.getpid(), signal.SIGKILL)
        case "answer wrongly":
            for number in range(3, 64):  # whatever number the pipe has
                with contextlib.suppress(OSError):
                    os.write(number, b"no pickle")
            time.sleep(600)
        case _:
            os.kill(os.getpid(), signal.Signals[task])
    raise RuntimeError("I should be dead")


def double_slowly_in(folder: Path, number: int) -> int:
    """Each time that it is done leaves a line in the folder."""
    with (folder / f"{number}").open("a") as file:
        file.write(f"{os.getpid()}\n")
    time.sleep(0.1)
    return 2 * number


def is_alone_in(folder: Path, _task: Any) -> bool:
    """Whether no other task is done in this process at the same time."""
    path = folder / f"{os.getpid()}"
    try:
        path.touch(exist_ok=False)
    except FileExistsError:
        return False
    time.sleep(0.02)
    path.unlink()
    return True


def die_once(task: tuple[Path, int]) -> int:
    """The first worker dies, and the file says so."""
    path, number = task
    if not path.exists():
        path.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def print_much(text: str) -> int:
    """Prints on standard output and standard error, from Python and from C."""
    print(text)
    print(text, file=sys.stderr)
    os.write(1, text.encode())
    os.write(2, text.encode())
    return len(text)


def hang_half_written(path: Path) -> None:
    """Hangs with a child process and a file that only cleaning up takes away; process ids are beside it."""
    path.write_text("half")
    try:
        other = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
        pids = path.with_suffix(".new")
        pids.write_text(f"{os.getpid()} {other.pid}")
        pids.rename(path.with_suffix(".pids"))
        time.sleep(600)
    finally:
        path.unlink()


def ignore_termination(path: Path) -> None:
    """Hangs, and cannot be asked to end."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    path.write_text(f"{os.getpid()}")
    while True:
        time.sleep(1)


class UnpicklableError(Exception):
    def __init__(self, first: str, second: str) -> None:
        super().__init__(first + second)


def fail(how: str) -> NoReturn:
    match how:
        case "config":
            raise ConfigError([Problem(message="wrong", mark=Mark(file="run.yaml", line=3, column=7))])
        case "stage":
            raise StageError("emitter 'x'", "ValueError: y", "its traceback")
        case "leave":
            raise SystemExit(3)
        case _:
            raise UnpicklableError("cannot ", "travel")


def return_unpicklable(_task: Any) -> Any:
    return lambda: None


class Unusable:
    """A function that cannot be taken over: its module may be there, but does not let it be read again."""

    def __call__(self, task: Any) -> Any:
        return task

    def __reduce__(self) -> Any:
        return (_refuse, ())


class Deadly:
    """A function that ends the process that reads it."""

    def __call__(self, task: Any) -> Any:
        return task

    def __reduce__(self) -> Any:
        return (os._exit, (5,))


def _refuse() -> NoReturn:
    raise ImportError("no module named 'lab'")
