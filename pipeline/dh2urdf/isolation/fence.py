"""A fence around a child process that works on a stranger's file: from then on it can compute, and read what it must.

`enter` is called in a child of `dh2urdf.isolation.child_process`, after everything that the work needs is imported.
Three layers hold independently of each other:

- limits of the system on computing time, memory and written files (POSIX);
- Landlock, where the kernel has it (Linux 5.13 and later): only the named folders can be read, and nothing written;
- an audit hook of Python (PEP 578): no file is opened but for reading and below the named folders, no process is
  started, no socket is opened, nothing is imported from C by `ctypes`. A hook cannot be taken off again.
"""

from __future__ import annotations

import os
import signal
import sys
import warnings
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.isolation.process import is_own

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

TRUST = "DH2URDF_TRUST"
"""Environment variable, also for workers on other machines: meshes are read where the kernel offers no wall."""
MEMORY = 2**31
"""Address space of a fenced process [B]."""

_WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_EVENTS = (
    "socket. subprocess. os.exec os.fork os.posix_spawn os.spawn os.startfile os.system os.kill os.putenv os.unsetenv "
    "os.remove os.rename os.rmdir os.mkdir os.link os.symlink os.truncate os.chmod os.chown os.utime os.setxattr "
    "os.removexattr os.chdir os.fchdir shutil. tempfile. ctypes. pty. signal.pthread_kill urllib. webbrowser. winreg. "
    "msvcrt. _winapi. mmap. ensurepip. cpython.run_ code.__new__ function.__new__"
)
"""Audit events that a fenced process has no business with, or what their names begin with."""
_REFUSED = tuple(_EVENTS.split())


class FenceError(PermissionError):
    """A fenced process tried something that its fence refuses."""


@cache
def missing_wall() -> str:
    """Return why the kernel cannot build a fence here, as a sentence; an empty text where it can.

    The answer is kept, because a process behind a fence can no longer ask.
    """
    from landlock import LandlockError, landlock_abi_version

    try:
        landlock_abi_version()
    except (LandlockError, OSError) as error:  # A kernel without Landlock, or a container that forbids it.
        return f"this kernel offers no Landlock: {error}"
    return ""


def walls() -> str:
    """Which walls stand around a child that works on a stranger's file."""
    missing = missing_wall()
    kernel = f"no wall of the kernel ({missing}; meshes need --trust)" if missing else "Landlock"
    return f"{kernel}, limits of memory and time, Python's audit hook"


def tell_of_missing_wall() -> None:
    """Tell the user, once, that a fence stands without the kernel: on standard error, or a caller as a warning."""
    if missing := missing_wall():
        _tell(f"{missing}; the fence around files of unknown origin is Python's audit hook and limits of the system")


@cache
def _tell(text: str) -> None:
    if is_own():
        sys.stderr.write(f"notice: {text}\n")
    else:
        warnings.warn(text, RuntimeWarning, stacklevel=3)


def refuse_without_wall() -> None:
    """Refuse to read a mesh where the kernel offers no wall, unless the user trusts it.

    Raises:
        ValueError: it does not, and nobody has said so.
    """
    if (missing := missing_wall()) and not os.environ.get(TRUST):
        raise ValueError(f"{missing}; `--trust` (or {TRUST}=1) reads it all the same")


def enter(readable: Iterable[Path], seconds: float, *, starts_program: bool = False) -> None:
    """Gives up, for the rest of this process, all that working on a stranger's file does not need.

    Args:
        readable: folders and files that may still be read.
        seconds: computing time that is left [s]; the process is killed when it is over.
        starts_program: whether a program of the system works on the file. Then the programs and libraries of the system
            can be read and started too; the audit hook, which ends at this process, is left out.
    """
    import ctypes
    import resource

    folders = sorted({os.path.realpath(path) for path in readable})
    set_parent_death_signal = 1  # PR_SET_PDEATHSIG of <linux/prctl.h>: an endless computation lets no thread see to it
    ctypes.CDLL(None).prctl(set_parent_death_signal, signal.SIGKILL, 0, 0, 0)
    used = resource.getrusage(resource.RUSAGE_SELF)
    whole = int(used.ru_utime + used.ru_stime + seconds) + 1
    for what, bound in (
        (resource.RLIMIT_CPU, whole),
        (resource.RLIMIT_AS, MEMORY),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
    ):
        _, hard = resource.getrlimit(what)
        most = bound if hard == resource.RLIM_INFINITY else min(bound, hard)
        resource.setrlimit(what, (most, most))
    _lock(folders, _system_folders() if starts_program else [])
    if not starts_program:
        _watch(folders)


def _system_folders() -> list[str]:
    """Where programs, and what they load, are on this system."""
    prefixes = {os.path.realpath(Path(folder).parent) for folder in os.get_exec_path()}
    places = {*prefixes, sys.prefix, "/usr", "/lib", "/lib64", "/etc", "/proc", "/opt", "/dev"}
    home = {os.path.realpath(Path.home()), "/"}
    return sorted({place for place in map(os.path.realpath, places) if Path(place).is_dir()} - home)


def _lock(folders: list[str], system: Sequence[str] = ()) -> None:
    """Has the kernel refuse all files but those of some folders, where it can; what is in `system` can be started."""
    if missing_wall():  # The parent has told the user.
        return
    from landlock import FSAccess, Ruleset

    rules = Ruleset()
    for folder in folders:
        rules.allow(folder, rules=FSAccess.READ_FILE | (FSAccess.READ_DIR if Path(folder).is_dir() else 0))
    for folder in system:
        rules.allow(folder, rules=FSAccess.READ_FILE | FSAccess.READ_DIR | FSAccess.EXECUTE)
    rules.apply()


def _watch(folders: list[str]) -> None:
    """Has Python itself refuse what the process must not do."""
    inside = tuple(os.path.join(folder, "") for folder in folders)  # noqa: PTH118 - compared as texts

    def audit(event: str, args: tuple[Any, ...]) -> None:
        if event == "open":
            path, _, flags = args
            if isinstance(path, int):
                return  # a file that is open already
            if flags & _WRITING:
                raise FenceError(1, "nothing can be written here", os.fsdecode(path))
            real = os.path.realpath(os.fsdecode(path))
            if real not in folders and not real.startswith(inside):
                raise FenceError(1, "the file is outside the folders that may be read", os.fsdecode(path))
        elif event == "import" and args[1]:
            raise FenceError(1, f"nothing more can be imported: {args[0]}")
        elif event.startswith(_REFUSED):
            raise FenceError(1, f"{event} is refused")

    sys.addaudithook(audit)
