"""Functions that the tests of this folder run in child processes, in a module that the child can import."""

# ruff: noqa: T201 - what is printed in a child is what these functions are about

from __future__ import annotations

import contextlib
import ctypes
import os
import pickle
import signal
import struct
import subprocess
import sys
import threading
import time
import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NoReturn

from dh2urdf.conversion.loads import load_in_child
from dh2urdf.errors import LoaderError, ProofError
from dh2urdf.isolation import enter
from dh2urdf.isolation.child_process import LARGEST_ANSWER
from dh2urdf.isolation.encodings import MOST_VALUES
from dh2urdf.isolation.kept_children import KeptChildren
from dh2urdf.source import Problem
from dh2urdf.stages import Loader, LoadReport, LoadRequest, NoOptions, ReadsOutput, Reusable


def print_everywhere() -> str:
    libc = ctypes.CDLL(None)
    print("from Python")
    libc.puts(b"from C")
    libc.printf(b"without a newline")
    libc.fflush(None)
    os.write(1, b"\nfrom descriptor 1\n")
    os.write(2, b"from descriptor 2\n")
    print("from standard error", file=sys.stderr)
    return "printed"


def print_in_c_and_crash() -> None:
    ctypes.CDLL(None).printf(b"the last thing that was said")
    os.kill(os.getpid(), signal.SIGSEGV)


def print_much(size: int) -> None:
    line = b"x" * 79 + b"\n"
    os.write(1, b"the beginning\n")
    for _ in range(size // len(line)):
        os.write(1, line)
    os.write(2, b"the end\n")


def kill_myself(number: int) -> None:
    os.kill(os.getpid(), number)


def leave(how: str) -> None:
    if how == "SystemExit":
        raise SystemExit(3)
    if how == "os._exit":
        os._exit(3)


def hang(pids: str) -> None:
    """Hangs, with a child of its own that hangs too; both process ids are in the file."""
    other = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    path = Path(pids)
    path.with_suffix(".new").write_text(f"{os.getpid()} {other.pid}")
    path.with_suffix(".new").rename(path)
    time.sleep(600)


def raise_value_error() -> NoReturn:
    print("looking for it")
    raise ValueError("not this value")


class UnpicklableError(Exception):
    def __init__(self, first: str, second: str) -> None:
        super().__init__(first + second)


def raise_unpicklable() -> NoReturn:
    raise UnpicklableError("cannot ", "travel")


class _Command:
    """Unpickling it runs a command."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __reduce__(self) -> tuple[Any, ...]:
        return os.system, (self.text,)


def write_everywhere(data: bytes) -> None:
    """Writes to every pipe that this process has, but those of its output."""
    for number in range(3, 64):
        with contextlib.suppress(OSError):
            os.write(number, data)


def send_pickle(ran: str, when: str) -> str:
    """What a child does that a file has taken over, behind the whole fence."""
    data = pickle.dumps(_Command(f"touch {ran}"))
    enter([Path(__file__).parent], 10)
    write_everywhere(data)
    if when == "in its place":
        os._exit(0)
    return "all is well"


def forge_answer(kind: str) -> None:
    """Sends an answer of its own and leaves."""
    letter, body = {
        "no json": (b"v", b"\x80\x04"),
        "wrong form": (b"v", b'[["eA==", 5]]'),
        "nested": (b"v", 10**6 * b"["),
        "many values": (b"v", b"[" + MOST_VALUES * b"[]," + b"1]"),
        "too long": (b"v", b""),
        "no word": (b"e", b"[1]"),
        "no such exception": (b"r", b'[["os.system", ["true"], null, []]]'),
        "unfit exception": (b"r", b'[["MissingDependencyError", [], null, []]]'),
        "truncated": (b"v", b"[1"),
    }[kind]
    size = {"too long": LARGEST_ANSWER + 1, "truncated": 1000}.get(kind, len(body))
    sent = struct.pack(">cII", letter, 0, size) + body
    for number in range(3, 64):  # The one that blocks is read by the parent.
        with contextlib.suppress(OSError), open(number, "wb", closefd=False) as pipe:
            pipe.write(sent)
    os._exit(0)


def as_it_is(value: Any) -> Any:
    return value


def refuse(problem: Problem) -> NoReturn:
    error = ProofError([problem, problem], [problem])
    error.add_note("a note")
    raise error


def load(request: LoadRequest, _options: NoOptions) -> LoadReport:
    print("WARNING: a screw is loose")
    match request.path.name:
        case "refused.urdf":
            raise LoaderError("I do not like it")
        case "crash.urdf":
            sys.stdout.flush()
            os.kill(os.getpid(), signal.SIGSEGV)
        case "hang.urdf":
            time.sleep(600)
    return LoadReport(simulator="toy", version="1", findings=(Problem(message="measured", severity="notice"),))


def read_output(_request: LoadRequest, output: str) -> list[Problem]:
    return [Problem(message=line, severity="notice") for line in output.splitlines() if "WARNING" in line]


@dataclass(frozen=True)
class Hasty:
    time_limit: float = 2.0


LOADER = Loader(
    name="toy", summary="loads nothing", open=load, options=NoOptions, capabilities=(ReadsOutput(read_output),)
)


SERVED: list[str] = []
"""The names of the files that this process has loaded: the global state of a simulator."""


PREPARED: list[int] = []
"""The process that has imported the simulator, once it has."""


ORPHAN = """
import subprocess, sys
print(subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"]).pid)
"""
"""A program that prints the number of another one, which it leaves behind."""


def prepare(_options: NoOptions) -> None:
    PREPARED.append(os.getpid())
    print("toy is starting")


def prepare_otherwise(_options: NoOptions) -> None:
    PREPARED.append(os.getpid())
    print("another toy is starting")


def kept_load(request: LoadRequest, _options: NoOptions) -> LoadReport:  # noqa: C901, PLR0912 - one case for each file
    """Does what the name of the file asks for."""
    SERVED.append(request.path.name)
    print(f"loading {request.path.name}")
    match request.path.stem:
        case "in_c":
            ctypes.CDLL(None).printf(b"from C, without an end")
        case "late":
            subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
        case "orphan":
            subprocess.run([sys.executable, "-c", ORPHAN], check=True)
        case "thread":
            threading.Thread(target=time.sleep, args=(600,), daemon=True).start()
        case "folder":
            os.chdir("/")
        case "environment":
            os.environ["TOY"] = "broken"
        case "path":
            sys.path.insert(0, "/nowhere")
        case "warning":
            warnings.warn("a screw is loose", stacklevel=1)
        case "much":
            print_much(4_000_000)
        case "crash":
            os.kill(os.getpid(), signal.SIGSEGV)
        case "hang":
            hang(str(request.path.with_suffix(".pids")))
        case "exit":
            sys.exit(3)
        case "leave":
            os._exit(4)
        case "refused":
            raise LoaderError("I do not like it")
    return LoadReport(simulator=" ".join(SERVED), version=str((PREPARED or [os.getpid()])[0]))


KEPT = replace(LOADER, open=kept_load, options=Hasty, capabilities=(ReadsOutput(read_output), Reusable(prepare)))


def load_and_wait(path: str) -> None:
    """Loads a file in a kept child; its number, and that of what it started, are in ``hang.pids`` meanwhile."""
    from dh2urdf.robot import Robot

    robot = Robot(name="arm", links=(), joints=())
    request = LoadRequest(path=Path(path), robot=robot, poses=(), expected={})
    with KeptChildren() as children:
        report = load_in_child(KEPT, request, NoOptions(), None, children)
        new = Path(path).with_name("hang.new")
        new.write_text(report.version)
        new.rename(new.with_suffix(".pids"))
        time.sleep(600)
