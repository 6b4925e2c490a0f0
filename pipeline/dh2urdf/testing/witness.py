"""Calls a stage in a child process that watches what it does: the files it writes, the processes it starts.

A child of its own, because what watches cannot be taken off again, and because another seed for the hashes of texts
shows whether the order of a set has got into the result.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar
from uuid import uuid4

from dh2urdf.isolation import run_in_child

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

T = TypeVar("T")

PATIENCE = 300.0
"""How long a stage may take in a test [s]."""
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_CHANGES = frozenset(
    {"os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.link", "os.symlink", "os.truncate", "os.chmod"}
)
_STARTS = frozenset({"subprocess.Popen", "os.system", "os.fork", "os.forkpty", "os.exec", "os.posix_spawn", "os.spawn"})
_MARK = "DH2URDF_CONTRACT"
"""Environment variable by which a process, and whatever it starts, is known."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Testimony(Generic[T]):
    """What was seen of a call.

    Attributes:
        value: what it returned.
        deeds: the files that it wrote or changed and the processes that it started, in words, in order.
        left: the command lines of processes, and the names of threads, that it left behind.
    """

    value: T
    deeds: tuple[str, ...]
    left: tuple[str, ...]


def witnessed(function: Callable[..., T], *args: Any, seed: int = 0) -> Testimony[T]:  # noqa: ANN401 - any arguments
    """Calls a function in a child process and says what it did there.

    Args:
        function: a function of a module that can be imported by name.
        args: its arguments; they and the value must be picklable.
        seed: the seed for the hashes of texts.

    Raises:
        CrashError: the child crashed, hung or left, or cannot import the function.
        Exception: whatever the function raised.
    """
    mark = uuid4().hex
    with _environment({"PYTHONHASHSEED": str(seed), _MARK: mark}):
        try:
            testimony: Testimony[T] = run_in_child(_watched, function, args, timeout=PATIENCE, who="the stage").value
        finally:
            _end(mark)
    return testimony


def processes(mark: str) -> dict[int, str]:
    """The processes that have a mark in their environment, this one excepted: number and command line."""
    found: dict[int, str] = {}
    if Path("/proc/self/environ").exists():
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                if f"{_MARK}={mark}".encode() in (folder / "environ").read_bytes().split(b"\0"):
                    found[int(folder.name)] = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode().strip()
            except OSError:  # It is gone by now, or somebody else's.
                continue
    elif os.name == "posix":  # `e` shows the environment after the command.
        listed = subprocess.run(["ps", "axeww", "-o", "pid=,command="], capture_output=True, text=True, check=True)  # noqa: S607
        for line in listed.stdout.splitlines():
            number, _, command = line.strip().partition(" ")
            if f"{_MARK}={mark}" in command:
                found[int(number)] = command.partition(f" {_MARK}=")[0]
    found.pop(os.getpid(), None)
    return found


@contextmanager
def marked() -> Iterator[str]:
    """Gives everything that is started meanwhile a mark; ends what of it is left."""
    mark = uuid4().hex
    with _environment({_MARK: mark}):
        try:
            yield mark
        finally:
            _end(mark)


def _end(mark: str) -> None:
    """Ends what a stage has left behind: the machine of the tests is as it was."""
    for number in processes(mark):
        with suppress(ProcessLookupError, PermissionError):
            os.kill(number, signal.SIGKILL if hasattr(signal, "SIGKILL") else signal.SIGTERM)


@contextmanager
def _environment(variables: dict[str, str]) -> Iterator[None]:
    """Environment variables for what is started meanwhile."""
    before = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _watched(function: Callable[..., T], args: tuple[Any, ...]) -> Testimony[T]:
    """Makes a call in this process, which is made for it."""
    deeds: list[str] = []
    watching = True

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        if watching and (deed := _deed(event, arguments)):
            deeds.append(deed)

    sys.dont_write_bytecode = True  # That is Python's own writing.
    threads = set(threading.enumerate())
    sys.addaudithook(watch)
    try:
        value = function(*args)
    finally:
        watching = False
    running = [thread for thread in threading.enumerate() if thread not in threads and not thread.daemon]
    left = [*processes(os.environ[_MARK]).values(), *(f"the thread {thread.name}" for thread in running)]
    return Testimony(value=value, deeds=tuple(dict.fromkeys(deeds)), left=tuple(left))


def _deed(event: str, arguments: tuple[Any, ...]) -> str | None:
    """What an event of the interpreter's audit does to the world, in words; None where it does nothing."""
    if event == "open":
        path, mode, flags = arguments
        writes = set(mode) & set("wax+") if isinstance(mode, str) else isinstance(flags, int) and flags & _WRITES
        if not writes or path == os.devnull or isinstance(path, int):
            return None
        return f"wrote {os.fsdecode(path)}"
    if event in _CHANGES:
        return f"{event} of {arguments[0]}"
    if event in _STARTS:
        return f"started a process ({event}): {arguments[0]}"
    return None
