"""Calls a stage in a fresh interpreter, which watches the files that it writes and the processes that it starts.

What a C library writes is not seen where it happens, so the child works in an empty folder, which is also that of
temporary files: what lies there afterwards was left behind.
"""

from __future__ import annotations

import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.documents import is_file
from dh2urdf.late_tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

PATIENCE = 600.0
"""How long a call may take [s]."""
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_CHANGES = re.compile(r"os\.(chdir|mkdir|rename|remove|rmdir|link|symlink|truncate|chmod)")
_STARTS = re.compile(r"subprocess\.Popen|os\.(system|fork|forkpty|exec|posix_spawn|spawn)")
_HELPERS = re.compile(r"from multiprocessing\.(resource_tracker|forkserver) import main")
"""Processes of `multiprocessing` itself: there is one for each interpreter, which ends with it."""
_SUBREAPER = 36  # PR_SET_CHILD_SUBREAPER: processes that lose their parent become children of this one


class Seen(NamedTuple):
    """What a call returned, what it wrote and started, and the processes, threads and files that it left."""

    value: Any
    deeds: tuple[str, ...]
    left: tuple[str, ...]


def in_child(function: Callable[..., Any], *args: Any, seed: int = 1) -> Seen:  # noqa: ANN401 - any arguments
    """Call a function in a child process.

    Args:
        function: a function of a module that can be imported by name.
        args: its arguments; they and the value must be picklable.
        seed: the seed for the hashes of texts: another one shows whether the order of a set is in the result.

    Raises:
        Exception: what the function raised; a RuntimeError where the child ended without an answer.
    """
    with tempfile.TemporaryDirectory(prefix="dh2urdf-", ignore_cleanup_errors=True) as folder:
        work, call, answer = (Path(folder, name) for name in ("work", "call", "answer"))
        work.mkdir()
        call.write_bytes(pickle.dumps((function, args)))
        begin = f"import sys; sys.path[:] = {sys.path!r}; from dh2urdf.testing.child import _main; _main()"
        done = subprocess.run(  # noqa: S603 - our own interpreter
            [sys.executable, "-B", "-c", begin, call, answer],
            cwd=work,
            env={**os.environ, "PYTHONHASHSEED": str(seed), **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(work))},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=PATIENCE,
            check=False,
        )
        if not is_file(answer):
            last = done.stdout.decode(errors="replace")[-1000:]
            raise RuntimeError(f"the process ended with exit status {done.returncode} and gave no result: {last}")
        raised, *found = pickle.loads(answer.read_bytes())  # noqa: S301 - our own child wrote it
    if raised is not None:
        raise raised
    return Seen(*found)


def _main() -> None:
    import ctypes
    import threading

    ctypes.CDLL(None).prctl(_SUBREAPER, 1)
    deeds: list[str] = []
    raised, value, watching = None, None, True

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        if watching and (deed := _deed(event, arguments)):
            deeds.append(deed)

    threads = set(threading.enumerate())
    work, answer = Path.cwd(), Path(sys.argv[2])
    try:
        function, args = pickle.loads(Path(sys.argv[1]).read_bytes())  # noqa: S301 - our own parent wrote it
        sys.addaudithook(watch)
        value = function(*args)
    except BaseException as error:  # noqa: BLE001 - whatever an author's code raises
        raised = _sendable(error)
    watching = False
    left = [*descendants().values(), *(f"the thread {each.name}" for each in set(threading.enumerate()) - threads)]
    left += [f"the file {path.name}" for path in sorted(work.iterdir())]
    for number in descendants():
        with suppress(ProcessLookupError):
            os.kill(number, signal.SIGKILL)
    try:
        sent = pickle.dumps((raised, value, tuple(dict.fromkeys(deeds)), tuple(left)))
    except Exception as error:  # noqa: BLE001 - whatever an author's record raises
        message = f"what it returns cannot be pickled: {type(error).__name__}: {error}"
        sent = pickle.dumps((RuntimeError(message), None, (), ()))
    answer.write_bytes(sent)
    os._exit(0)  # Threads that are left do not matter.


def _sendable(error: BaseException) -> BaseException:
    """An exception with its traceback as a note; one that cannot be pickled as a RuntimeError."""
    import traceback

    error.add_note("".join(traceback.format_exception(error)))
    try:
        pickle.loads(pickle.dumps(error))  # noqa: S301 - made in the same line
    except Exception:  # noqa: BLE001 - it is the exception's own code
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def _deed(event: str, arguments: tuple[Any, ...]) -> str | None:
    """What an event of the interpreter's audit does to the world, in words; None where it does nothing."""
    if event == "open":
        path, mode, flags = arguments
        writes = set(mode) & set("wax+") if isinstance(mode, str) else isinstance(flags, int) and flags & _WRITES
        return None if not writes or path == os.devnull or isinstance(path, int) else f"wrote {os.fsdecode(path)}"
    if _CHANGES.fullmatch(event):
        return f"{event} of {arguments[0]}"
    return (
        f"started a process ({event}){f': {arguments[0]}' if arguments else ''}" if _STARTS.fullmatch(event) else None
    )


def descendants() -> dict[int, str]:
    """The processes that this one has started, and those that they have: numbers and command lines."""
    running: dict[int, tuple[int, str]] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # It is gone by now.
            # The name before them, in brackets, may hold anything.
            state, parent, *_ = (folder / "stat").read_text("utf-8", "replace").rpartition(")")[2].split()
            command = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()
            if state != "Z" and not _HELPERS.search(command):
                running[int(folder.name)] = int(parent), command
    own = {os.getpid()}
    while more := {number for number, (parent, _) in running.items() if parent in own} - own:
        own |= more
    return {number: running[number][1] for number in own - {os.getpid()}}


def registered(place: str, kind: Any, name: str, options: bytes) -> set[str]:  # noqa: ANN401 - a kind
    """In a fresh process: the packages that registering a plugin, and asking whether its stage can work, import."""
    from importlib.metadata import EntryPoint

    from dh2urdf.errors import PluginError
    from dh2urdf.hookspecs import PROJECT
    from dh2urdf.plugin_system.catalog import Catalog, Plugin

    before = set(sys.modules)
    plugin = Plugin(name=f"contract = {place}", module=EntryPoint("", place, PROJECT).load(), distribution="a test")
    stage = Catalog([plugin]).get(kind, name)
    with suppress(PluginError):  # It is not installed: then it was not imported either.
        stage.require(pickle.loads(options))  # noqa: S301 - our own parent made them
    return {
        each.partition(".")[0] for each in set(sys.modules) - before if getattr(sys.modules[each], "__spec__", None)
    }
