"""Call a stage in a fresh interpreter, and watch the files that it writes and the processes that it starts.

The interpreter's audit hook misses what C libraries write. So the child works in an empty folder, which is also the
folder of temporary files: a file that lies there afterwards was left behind.
"""

from __future__ import annotations

import os
import pickle
import re
import signal
import sys
import tempfile
import threading
import traceback
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.isolation.child_process import Child
from dh2urdf.isolation.encodings import PICKLED

if TYPE_CHECKING:
    from collections.abc import Callable

PATIENCE = 600.0
"""Longest time of a call [s]."""
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_CHANGES = re.compile(r"os\.(chdir|mkdir|rename|remove|rmdir|link|symlink|truncate|chmod)")
_STARTS = re.compile(r"subprocess\.Popen|os\.(system|fork|forkpty|exec|posix_spawn|spawn)")
_HELPERS = re.compile(r"from multiprocessing\.(resource_tracker|forkserver) import main")
"""Processes that `multiprocessing` keeps for itself: one for each interpreter, which ends with it."""
_SUBREAPER = 36  # PR_SET_CHILD_SUBREAPER: processes that lose their parent become children of this one


class Seen(NamedTuple):
    """What a call returned; what it wrote and started; the processes, threads and files that it left."""

    value: Any
    deeds: tuple[str, ...]
    left: tuple[str, ...]


def in_child(function: Callable[..., Any], *args: Any, seed: int = 1) -> Seen:  # noqa: ANN401 - any arguments
    """Call a function in a child process.

    Args:
        function: a function at the top level of a module.
        args: its arguments; they and the value must be picklable.
        seed: the seed for the hashes of texts. Another seed shows whether the result depends on the order of a set.

    Raises:
        Exception: what the function raised; a CrashError where the child ended without an answer.
    """
    with tempfile.TemporaryDirectory(prefix="dh2urdf-", ignore_cleanup_errors=True) as work:
        environment = {"PYTHONHASHSEED": str(seed), **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), work)}
        with Child("-B", environment=environment) as child:
            return child.call(_watched, (work, function, args), PATIENCE, "the stage", PICKLED).value


def _watched(work: str, function: Callable[..., Any], args: tuple[Any, ...]) -> Seen:
    """In the child: make the call."""
    import ctypes

    ctypes.CDLL(None).prctl(_SUBREAPER, 1)
    os.chdir(work)
    deeds: list[str] = []
    watching, threads = True, set(threading.enumerate())

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        if watching and (deed := _deed(event, arguments)):
            deeds.append(deed)

    sys.addaudithook(watch)
    what = "returns"
    try:
        found = function(*args)
    except BaseException as error:
        error.add_note("".join(traceback.format_exception(error)))
        what, found = f"raises, {type(error).__name__}: {error},", error
        raise
    finally:
        watching = False
        try:
            pickle.loads(pickle.dumps(found))  # noqa: S301 - made in the same line
        except Exception as error:  # noqa: BLE001 - whatever an author's record or exception raises
            raise RuntimeError(f"what it {what} cannot be pickled: {type(error).__name__}: {error}") from None
    left = [*descendants().values(), *(f"the thread {each.name}" for each in set(threading.enumerate()) - threads)]
    left += [f"the file {path.name}" for path in sorted(Path(work).iterdir())]
    for number in descendants():
        with suppress(ProcessLookupError):
            os.kill(number, signal.SIGKILL)
    return Seen(found, tuple(dict.fromkeys(deeds)), tuple(left))


def _deed(event: str, arguments: tuple[Any, ...]) -> str | None:
    """What an audit event changes on the machine, in words; None where it changes nothing."""
    if event == "open":
        path, mode, flags = arguments
        writes = set(mode) & set("wax+") if isinstance(mode, str) else isinstance(flags, int) and flags & _WRITES
        return None if not writes or path == os.devnull or isinstance(path, int) else f"wrote {os.fsdecode(path)}"
    if _CHANGES.fullmatch(event):
        return f"{event} of {arguments[0]}"
    return f"started a process ({event}): {arguments[:1]}" if _STARTS.fullmatch(event) else None


def descendants() -> dict[int, str]:
    """The processes below this one: numbers and command lines."""
    running: dict[int, tuple[int, str]] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # It is gone by now.
            state, parent, *_ = (folder / "stat").read_text("utf-8", "replace").rpartition(")")[2].split()
            command = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()
            if state != "Z" and not _HELPERS.search(command):
                running[int(folder.name)] = int(parent), command
    own = {os.getpid()}
    while more := {number for number, (parent, _) in running.items() if parent in own} - own:
        own |= more
    return {number: running[number][1] for number in own - {os.getpid()}}
