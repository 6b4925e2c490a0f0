"""Calls in child processes that are forks of an interpreter which has imported the host.

A contract makes a dozen calls in child processes for each stage. To start an interpreter and to import the host takes
longer than most of these calls. So an interpreter is kept for each seed of hashes, and makes each call in a fork of
itself. It does nothing but fork, and imports no module of a plugin: no call changes what another call meets.

Only Linux forks safely. Elsewhere each call has an interpreter of its own.
"""

from __future__ import annotations

import atexit
import importlib
import os
import pickle
import signal
import sys
import warnings
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, NoReturn, TypeVar
from uuid import uuid4

from dh2urdf.isolation._child import answer_call
from dh2urdf.isolation.child_process import outcome, pickled_call, run_in_child, started
from dh2urdf.isolation.encodings import PICKLED
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.plugin_system.at_work import VARIABLE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

T = TypeVar("T")

MARK = "DH2URDF_CONTRACT"
"""Environment variable by which a process, and whatever it starts, is known."""
SEED = "PYTHONHASHSEED"
"""Python's environment variable for the seed for the hashes of texts."""
PATIENCE = 300.0
"""How long a stage may take in a test [s]."""
HOST = (
    "lxml.etree",
    "numpy",
    "orjson",
    "pydantic",
    "yaml.nodes",
    "dh2urdf.api",
    "dh2urdf.commands",
    "dh2urdf.kinematics.proof",
    "dh2urdf.plugin_system.catalog",
    "dh2urdf.testing.edits.contract",
    "dh2urdf.testing.emitter_contract",
    "dh2urdf.testing.loader_contract",
    "dh2urdf.testing.reader_contract",
    "dh2urdf.testing.transform_contract",
)
"""What an interpreter that is kept has imported: modules of the host, and packages that the host needs."""
LIGHT_HOST = ("dh2urdf.testing.stage_contract",)
"""The same for a call that looks which packages it imports."""
_WHO = "the stage"


class _Surroundings(NamedTuple):
    """What a new interpreter would have of the process that starts it.

    Attributes:
        variables: its environment.
        path: its `sys.path`.
        folder: its current folder.
    """

    variables: dict[str, str]
    path: list[str]
    folder: Path


class ForkingInterpreter:
    """An interpreter that is kept, and makes each call in a fork of itself.

    Args:
        seed: the seed for the hashes of texts.
        modules: what it imports before the first call.

    Attributes:
        mark: the value of `MARK` in its environment, and in that of all processes that its forks start.
        number: its process number.

    Raises:
        CrashError: it cannot be started.
    """

    def __init__(self, seed: int, modules: tuple[str, ...]) -> None:
        self.mark = uuid4().hex
        with environment({MARK: self.mark, SEED: str(seed)}):
            self._interpreter = started()
        self.number: int = self._answer_to(_prepare, (modules,))

    def is_alive(self) -> bool:
        """Whether it can be called."""
        return self._interpreter.is_alive()

    def call(self, function: Callable[..., T], args: tuple[Any, ...]) -> T:
        """What a function returns in a fork. Where the fork crashes, hangs or leaves, the interpreter ends, too.

        Raises:
            Exception: as `dh2urdf.isolation.child_process.run_in_child`.
        """
        call = pickled_call(function, args, _WHO, PICKLED)
        answer = self._answer_to(_in_fork, (*call, _Surroundings(dict(os.environ), sys.path, Path.cwd())))
        return outcome(answer, self._interpreter.output.text(), 0, function, PATIENCE, _WHO, PICKLED).value

    def _answer_to(self, function: Callable[..., Any], args: tuple[Any, ...]) -> Any:  # noqa: ANN401 - of any function
        """What a function of this module returns there; where it does not return, the interpreter ends."""
        try:
            answer = self._interpreter.call(*pickled_call(function, args, _WHO, PICKLED), PATIENCE)
        except BaseException:
            self.end()
            raise
        status = 0 if answer[:1] == ("value",) else self._interpreter.end()
        output, who = self._interpreter.output.text(), self._interpreter.who or _WHO
        return outcome(answer, output, status, function, PATIENCE, who, PICKLED).value

    def end(self) -> None:
        """End it, with all that it started."""
        self._interpreter.end()


_KEPT: dict[tuple[int, tuple[str, ...]], ForkingInterpreter] = {}
"""The interpreters of this process, by seed and modules."""


def forking_interpreter(seed: int, modules: tuple[str, ...]) -> ForkingInterpreter | None:
    """The interpreter that is kept for a seed; None on a system where nothing can be forked safely."""
    if sys.platform != "linux":
        return None
    if not _KEPT:
        atexit.register(_end_all, os.getpid())
    key = (seed, modules)
    kept = _KEPT.get(key)
    if kept is None or not kept.is_alive():
        kept = _KEPT[key] = ForkingInterpreter(seed, modules)
    return kept


def in_new_interpreter(function: Callable[..., T], args: tuple[Any, ...], seed: int) -> T:
    """What a function returns in an interpreter of its own.

    Raises:
        Exception: as `dh2urdf.isolation.child_process.run_in_child`.
    """
    with environment({SEED: str(seed)}):
        return run_in_child(function, *args, timeout=PATIENCE, who=_WHO, encoding=PICKLED).value


@contextmanager
def environment(variables: dict[str, str]) -> Iterator[None]:
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


def _end_all(owner: int) -> None:
    if os.getpid() == owner:  # A process that was forked off has copies of them, which are not its own to end.
        for kept in _KEPT.values():
            kept.end()
    _KEPT.clear()


# --- In the interpreter that is kept


def _prepare(modules: tuple[str, ...]) -> int:
    """Import modules; the number of this process."""
    for module in modules:
        with suppress(ImportError):  # A package that is not installed is needed by nobody here.
            importlib.import_module(module)
    return os.getpid()


def _in_fork(encoding: bytes, function: bytes, args: bytes, surroundings: _Surroundings) -> Any:  # noqa: ANN401 - an answer
    """What comes of a call in a fork. A fork that ends without an answer ends this process in the same way."""
    with open(os.memfd_create("answer"), "w+b") as answer:  # noqa: PTH123 - memory, not a pipe: nobody waits for its end
        with warnings.catch_warnings():
            # Python 3.12 warns of other threads. There is one here: it waits for the next message, and holds no lock.
            warnings.simplefilter("ignore", DeprecationWarning)
            number = os.fork()
        if number == 0:
            _answer_and_leave(answer, (encoding, function, args), surroundings)
        status = os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])
        answer.seek(0)
        sent = answer.read()
    if status < 0:
        with suppress(OSError):  # SIGKILL has no other handler.
            signal.signal(-status, signal.SIG_DFL)
        os.kill(os.getpid(), -status)
    if status > 0 or not sent:
        os._exit(status)
    return pickle.loads(sent)  # noqa: S301 - our own fork sent it


def _answer_and_leave(file: IO[bytes], call: tuple[bytes, bytes, bytes], surroundings: _Surroundings) -> NoReturn:
    """In the fork: make the call as in a new interpreter, which has the caller's environment, path and folder."""
    own = {name: os.environ[name] for name in (MARK, SEED, VARIABLE) if name in os.environ}
    os.environ.clear()
    os.environ.update({**surroundings.variables, **own})
    sys.path[:] = surroundings.path
    importlib.invalidate_caches()
    os.chdir(surroundings.folder)
    _, answer = answer_call(None, *call)
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):  # closed or replaced by what was called
            stream.flush()
    pickle.dump(answer, file)
    file.flush()
    os._exit(0)
