"""Calls a stage in a child process that watches what it does: the files it writes, the processes it starts.

What Python writes is seen where it happens. What a C library writes is not, so the child works in an empty folder,
which is also that of temporary files, and what lies there afterwards was left behind.

A child of its own, because what watches cannot be taken off again, and because another seed for the hashes of texts
shows whether the order of a set has got into the result. `dh2urdf.testing.children.forks` has the children.
"""

from __future__ import annotations

import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar
from uuid import uuid4

from dh2urdf.errors import CrashError
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.testing.children.forks import HOST, MARK, environment, forking_interpreter, in_new_interpreter

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

T = TypeVar("T")

_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_CHANGES = frozenset(
    {"os.chdir", "os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.link", "os.symlink", "os.truncate", "os.chmod"}
)
_STARTS = frozenset({"subprocess.Popen", "os.system", "os.fork", "os.forkpty", "os.exec", "os.posix_spawn", "os.spawn"})
_GLANCES = 100
"""How often a process without a command line is looked at again."""
_HELPERS = re.compile(r"from multiprocessing\.(resource_tracker|forkserver) import main")
"""Processes of `multiprocessing` itself: there is one for each interpreter, which ends with it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Testimony(Generic[T]):
    """What was seen of a call.

    Attributes:
        value: what it returned.
        deeds: the files that it wrote or changed and the processes that it started, in words, in order.
        left: the command lines of processes, and the names of threads and files, that it left behind.
    """

    value: T
    deeds: tuple[str, ...]
    left: tuple[str, ...]

    @property
    def traces(self) -> tuple[str, ...]:
        """What it did to the world, and what it left there."""
        return (*self.deeds, *(f"left {what}" for what in self.left))


def witnessed(function: Callable[..., T], *args: Any, seed: int = 0, modules: tuple[str, ...] = HOST) -> Testimony[T]:  # noqa: ANN401 - any arguments
    """Calls a function in a child process and says what it did there.

    Args:
        function: a function of a module that can be imported by name.
        args: its arguments; they and the value must be picklable.
        seed: the seed for the hashes of texts.
        modules: what the child may have imported before.

    Raises:
        CrashError: the child crashed, hung or left, cannot import the function, or cannot send what it returned.
        Exception: whatever the function raised.
    """
    kept = forking_interpreter(seed, modules)
    with (
        tempfile.TemporaryDirectory(prefix="dh2urdf-", ignore_cleanup_errors=True) as folder,
        environment({"TMPDIR": folder, "TEMP": folder, "TMP": folder}),
    ):
        if kept is None:
            with marked() as mark:
                return in_new_interpreter(_watched, (function, args, mark, folder), seed)
        try:
            return kept.call(_watched, (function, args, kept.mark, folder))
        finally:
            _end(set(processes(kept.mark)) - {kept.number})


class _Process(NamedTuple):
    """A process that is running.

    Attributes:
        parent: the number of the process that started it, or has inherited it.
        command: its command line.
        marked: whether it has the mark in its environment.
    """

    parent: int
    command: str
    marked: bool


def processes(mark: str) -> dict[int, str]:
    """The processes that have a mark in their environment, this one excepted: number and command line."""
    return _without_helpers({number: process for number, process in _running(mark).items() if process.marked})


def _descendants(mark: str) -> dict[int, str]:
    """The processes that this one has started, and those that they have, with a mark or without: `env` is anything."""
    found: dict[int, str] = {}
    for _ in range(_GLANCES):
        running, own = _running(mark), {os.getpid()}
        while more := {number for number, process in running.items() if process.parent in own} - own:
            own |= more
        found = _without_helpers({number: it for number, it in running.items() if number in own or it.marked})
        if all(found.values()):
            break
        time.sleep(0.01)  # One that is just being started has no command line, nor an environment, yet.
    return found


def _without_helpers(running: dict[int, _Process]) -> dict[int, str]:
    """The command lines of processes.

    Without this one, the one that it was forked from, and what `multiprocessing` has started for itself in it.
    """
    return {
        number: process.command
        for number, process in running.items()
        if number not in (os.getpid(), os.getppid())
        and not (process.parent == os.getpid() and _HELPERS.search(process.command))
    }


def _running(mark: str) -> dict[int, _Process]:
    """The processes of this machine, by their numbers."""
    found: dict[int, _Process] = {}
    if Path("/proc/self/environ").exists():
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                has_mark = f"{MARK}={mark}".encode() in (folder / "environ").read_bytes().split(b"\0")
                # The name before them, in brackets, may hold anything.
                state, parent, *_ = (folder / "stat").read_text("utf-8", "replace").rpartition(")")[2].split()
                command = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()
            except OSError:  # It is gone by now, or somebody else's.
                continue
            if state != "Z":  # It has ended, and nobody has asked how.
                found[int(folder.name)] = _Process(int(parent), command, has_mark)
    elif os.name == "posix":  # `e` shows the environment after the command.
        listing = ["ps", "axeww", "-o", "pid=,ppid=,command="]
        listed = subprocess.run(listing, capture_output=True, text=True, encoding="utf-8", errors="replace", check=True)  # noqa: S603 - nobody's input
        for line in listed.stdout.splitlines():
            number, parent, command = line.split(None, 2)
            if "ps axeww" not in command:
                shown = command.partition(f" {MARK}=")[0]
                found[int(number)] = _Process(int(parent), shown, f"{MARK}={mark}" in command)
    return found


@contextmanager
def marked() -> Iterator[str]:
    """Gives everything that is started meanwhile a mark; ends what of it is left."""
    mark = uuid4().hex
    with environment({MARK: mark}):
        try:
            yield mark
        finally:
            _end(processes(mark))


def _end(numbers: Iterable[int]) -> None:
    """Ends what a stage has left behind: the machine of the tests is as it was."""
    for number in numbers:
        with suppress(ProcessLookupError, PermissionError):
            os.kill(number, signal.SIGKILL if hasattr(signal, "SIGKILL") else signal.SIGTERM)


def _watched(function: Callable[..., T], args: tuple[Any, ...], mark: str, folder: str) -> Testimony[T]:
    """Makes a call in this process, which is made for it, and in a folder where nothing is yet."""
    deeds: list[str] = []
    watching = True

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        if watching and (deed := _deed(event, arguments)):
            deeds.append(deed)

    sys.dont_write_bytecode = True  # That is Python's own writing.
    threads = set(threading.enumerate())
    os.chdir(folder)
    sys.addaudithook(watch)
    try:
        value = function(*args)
    finally:
        watching = False
        started = _descendants(mark)
        _end(started)
    try:
        pickle.dumps(value)
    except Exception as error:
        raise CrashError(f"what it returns cannot be pickled: {type(error).__name__}: {error}") from error
    left = [
        *started.values(),
        *(f"the thread {thread.name}" for thread in threading.enumerate() if thread not in threads),
        *(f"the file {path.name}" for path in sorted(Path(folder).iterdir())),
    ]
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
        return f"started a process ({event}){f': {arguments[0]}' if arguments else ''}"
    return None
