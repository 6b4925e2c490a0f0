"""Loads in child processes, which serve many manipulators of a run, so that a simulator is imported once.

Nothing that a load does may change what is reported of the next manipulator. So a child is kept only as long as it is
as it was when the simulator had been imported. It is ended, with all that it started, and the next load gets a new one

- after a load that ended in anything but a report: an exception, a crash, the time limit;
- after a load that left a process or a thread behind, or another current folder, environment, `sys.path` or locale;
- after `LOADS` loads, or once it has used more than `MEMORY`: what a simulator loses bit by bit is given back.

A load that fails in a child which has served others is repeated in a new one, unless it took too long, and what comes
of that counts. What was printed while the simulator was imported is part of the output of each of its loads, as if it
were the only one.
"""

from __future__ import annotations

import locale
import os
import sys
import threading
import time
import warnings
import weakref
from contextlib import contextmanager
from dataclasses import replace
from functools import partial, update_wrapper
from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.errors import CrashError, LoaderError
from dh2urdf.isolation.child_process import ChildFailure, outcome, pickled_call, run_in_child, started
from dh2urdf.isolation.encodings import Data
from dh2urdf.isolation.own_process import is_own
from dh2urdf.measuring.opened_arm import load_function
from dh2urdf.source import Problem
from dh2urdf.stage_calls.answers import a_record, a_whole_record, whole_records
from dh2urdf.stages import LoadReport

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from types import TracebackType
    from typing import Self

    from dh2urdf.isolation.child_process import ChildResult
    from dh2urdf.stages import Loader, LoadRequest

O = TypeVar("O")  # noqa: E741 - the options type of a stage

LOADS = 50
"""Loads that one child serves at most."""
MEMORY = 2**30
"""Memory beyond which a child is not kept [B]."""

_REPORT: Data[LoadReport] = Data(LoadReport)  # Who reads meshes of unknown origin answers with data.
_LOOKING = 5.0  # [s] for a child that has nothing to do to tell in which state it is


def load_in_child(
    loader: Loader[O],
    request: LoadRequest,
    options: O,
    who: str | None = None,
    children: KeptChildren | None = None,
) -> LoadReport:
    """Calls a loader in a child process and completes its report with what the simulator printed.

    Args:
        loader: the loader.
        request: what it is asked to load.
        options: its options.
        who: what messages call it, such as ``the loader 'toy' of lab 1.0``.
        children: the children of loaders that are kept; without them the loader has a child for this one load.

    Raises:
        CrashError: as `dh2urdf.isolation.child_process.run_in_child`.
        LoaderError: whatever the loader refuses; the findings in the output follow it.
        MissingDependencyError: the simulator is not installed.
    """
    # The folder of a file in the making has another name in every run.
    folder = f"{request.path.parent}{os.sep}"

    def plain(problems: Iterable[Problem], simulator: str = "") -> tuple[Problem, ...]:
        """The problems without the folder, each with the name of the simulator in its message."""
        told = (replace(problem, message=problem.message.replace(folder, "")) for problem in problems)
        return tuple(_named(problem, simulator or loader.name, loader.name) for problem in told)

    try:
        limit = a_record(loader.time_limit(options), int, float, NoneType)
        who = who or f"the loader {loader.name!r}"
        if children is None or loader.prepare is None or limit is None:  # A person ends it by closing its window.
            load = _load_of(loader)
            child = run_in_child(load, request, options, timeout=limit, who=who, encoding=_REPORT)
        else:
            child = children.load(loader, request, options, limit, who)
    except (LoaderError, CrashError) as error:
        output = error.__cause__.output if isinstance(error.__cause__, ChildFailure) else ""
        said = whole_records(loader.read_output(request, output), Problem)
        raise type(error)(plain((*error.problems, *said))) from error
    report = replace(child.value, joints=tuple(map(_tuples, child.value.joints)), hold=_tuples(child.value.hold))
    said = whole_records(loader.read_output(request, child.output), Problem)
    findings = plain((*report.findings, *said), report.simulator)
    return replace(report, findings=findings, output=child.output.replace(folder, ""))


def _load_of(loader: Loader[Any]) -> Callable[[LoadRequest, Any], LoadReport]:
    """The function that a child calls."""
    load = load_function(loader)
    return update_wrapper(partial(_whole_report, load), load)


def _whole_report(load: Callable[[LoadRequest, Any], LoadReport], request: LoadRequest, options: Any) -> LoadReport:  # noqa: ANN401 - of any loader
    """In the child: what a loader gives.

    Raises:
        TypeError: it is no `LoadReport`, or something in it has another type than its field says.
    """
    return a_whole_record(load(request, options), LoadReport)


def _tuples(value: Any) -> Any:  # noqa: ANN401 - plain values of a report
    """Plain values as loaders give them, which JSON does not tell apart: vectors and pairs are tuples, in lists."""
    if isinstance(value, dict):
        return {name: _tuples(each) for name, each in value.items()}
    if not isinstance(value, list):
        return value
    is_flat = value and not any(isinstance(each, (list, dict)) for each in value)
    return tuple(value) if is_flat else [_tuples(each) for each in value]


def _named(problem: Problem, *names: str) -> Problem:
    """A problem whose message has one of these names; where it has none, the first is put before it."""
    if any(name.casefold() in problem.message.casefold() for name in names if name):
        return problem
    return replace(problem, message=f"{names[0]}: {problem.message}")


class KeptChildren:
    """The children of a process that loads, by their loaders and options: a context that ends all of them.

    Several threads may use them: a child serves one load at a time. A copy in another process begins without any.
    """

    def __init__(self) -> None:
        self._idle: dict[tuple[bytes, ...], list[_Child]] = {}
        self._changing = threading.Lock()
        weakref.finalize(self, _end_all, self._idle, os.getpid())

    def __reduce__(self) -> tuple[type[KeptChildren], tuple[()]]:
        return KeptChildren, ()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _traceback: TracebackType | None
    ) -> None:
        self.close()

    @contextmanager
    def kept(self, *, is_worker: bool) -> Iterator[None]:
        """A context in which children are kept: for longer, unless this is a worker that goes on after the run."""
        try:
            yield
        finally:
            if is_worker and not is_own():
                self.close()

    def close(self) -> None:
        """End all children; a load that follows starts a new one."""
        with self._changing:
            _end_all(self._idle, os.getpid())

    def load(
        self, loader: Loader[O], request: LoadRequest, options: O, timeout: float, who: str
    ) -> ChildResult[LoadReport]:
        """What a loader returns, and what was printed meanwhile.

        Args:
            loader: a loader with `dh2urdf.stages.Loader.prepare`.
            request: what it is asked to load.
            options: its options.
            timeout: how long it may take [s].
            who: what messages call it.

        Raises:
            Exception: as `dh2urdf.isolation.child_process.run_in_child`.
        """
        assert loader.prepare is not None  # noqa: S101 - the caller has looked
        preparation = pickled_call(loader.prepare, (options,), who)
        load = _load_of(loader)
        call = pickled_call(load, (request, options), who, _REPORT)
        key = (*preparation, call[1])
        child = self._taken(key) or _Child(preparation)
        while True:
            is_new = child.loads == 0
            try:
                answer = child.load(call, timeout)
            except BaseException:
                child.end()
                raise
            output = child.output
            if answer[:1] == ("value",):
                self._put_back(key, child)
                return outcome(answer, output, 0, load, timeout, who, _REPORT)
            status = child.end()
            if is_new or answer == ("late",):
                whose = child.interpreter.who or who
                return outcome(answer, child.output, status, load, timeout, whose, _REPORT)
            child = _Child(preparation)

    def _taken(self, key: tuple[bytes, ...]) -> _Child | None:
        """A child that has nothing to do."""
        with self._changing:
            while idle := self._idle.get(key):
                child = idle.pop()
                if child.interpreter.is_alive():
                    return child
                child.end()
        return None

    def _put_back(self, key: tuple[bytes, ...], child: _Child) -> None:
        """Keep a child, if it is as it was when it had imported its simulator."""
        if child.loads < LOADS and child.is_unchanged():
            with self._changing:
                self._idle.setdefault(key, []).append(child)
        else:
            child.end()


def _end_all(idle: dict[tuple[bytes, ...], list[_Child]], owner: int) -> None:
    if os.getpid() == owner:  # A process that was forked off has copies of them, which are not its own to end.
        for child in [child for children in idle.values() for child in children]:
            child.end()
    idle.clear()


class _Child:
    """A child that imports a simulator before its first load.

    Args:
        preparation: the call that imports it.

    Attributes:
        interpreter: its interpreter.
        loads: how many loads it has begun.
    """

    def __init__(self, preparation: tuple[bytes, bytes, bytes]) -> None:
        self.interpreter = started()
        self.loads = 0
        self._preparation = preparation
        self._printed = ""
        self._state: tuple[Any, ...] = ()

    @property
    def output(self) -> str:
        """What it printed while it imported its simulator, and during its last load."""
        return self._printed + self.interpreter.output.text()

    def load(self, call: tuple[bytes, bytes, bytes], timeout: float) -> tuple[Any, ...]:
        """Its answer to a load."""
        self.loads += 1
        if self.loads == 1:
            begun = time.monotonic()
            answer = self.interpreter.call(*self._preparation, timeout)
            if answer[:1] != ("value",):
                return answer
            printed = self.interpreter.output.text()
            self._state = self.interpreter.call(*_LOOK, _LOOKING)
            self._printed = printed
            timeout = max(0.0, timeout - (time.monotonic() - begun))
        return self.interpreter.call(*call, timeout)

    def is_unchanged(self) -> bool:
        """Whether its last load has left nothing behind."""
        return bool(self._state[:1] == ("value",) and self.interpreter.call(*_LOOK, _LOOKING) == self._state)

    def end(self) -> int:
        """End it, with all that it started; its exit status."""
        return self.interpreter.end()


def _state() -> str:
    """What a load may leave behind in this process, which is a child that is kept; to be compared."""
    try:
        folder = str(Path.cwd())
    except OSError:  # It was removed.
        folder = ""
    with warnings.catch_warnings():  # Entering it makes Python print again what it has warned of before.
        filters = warnings.filters
    process = (locale.setlocale(locale.LC_ALL), threading.active_count(), _has_children(), _peak() > MEMORY, filters)
    return repr((folder, sorted(os.environ.items()), sys.path, process))


def _has_children() -> bool:
    """Whether a process is left that descends from this one; on Linux, also where those in between have ended."""
    if sys.platform == "linux":
        import ctypes

        set_child_subreaper = 36  # PR_SET_CHILD_SUBREAPER of <linux/prctl.h>
        ctypes.CDLL(None).prctl(set_child_subreaper, 1, 0, 0, 0)
    if not hasattr(os, "waitid"):
        return False
    try:
        os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:
        return False
    return True


def _peak() -> int:
    """The most memory that this process had in use at once [B]."""
    try:
        import resource
    except ImportError:  # Windows
        return 0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024 * peak


_LOOK = pickled_call(_state, (), "a child that is kept")
