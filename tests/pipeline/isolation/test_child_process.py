import math
import os
import signal
import struct
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from dh2urdf.errors import CrashError, ProofError, TimeLimitError
from dh2urdf.isolation import PICKLED, ChildFailure, Data, run_in_child
from dh2urdf.isolation.child_process import KEPT_OUTPUT, LARGEST_ANSWER
from dh2urdf.isolation.encodings import MOST_VALUES, Pickled
from dh2urdf.source import Mark, Problem

LONG = 60.0


def test_everything_printed_is_caught(functions: ModuleType, capfd: pytest.CaptureFixture[str]) -> None:
    """Both streams are caught, from Python, C and bare descriptors, in the order of printing; nothing leaks out."""
    result = run_in_child(functions.print_everywhere, timeout=LONG)
    assert result.value == "printed"
    assert result.output.splitlines() == [
        "from Python",
        "from C",
        "without a newline",
        "from descriptor 1",
        "from descriptor 2",
        "from standard error",
    ]
    assert capfd.readouterr() == ("", "")


def test_huge_output_keeps_beginning_and_end(functions: ModuleType) -> None:
    """Of four megabytes of output 64 kB are kept, and a line says how much is missing."""
    output = run_in_child(functions.print_much, 4_000_000, timeout=LONG).output
    assert output.startswith("the beginning\n")
    assert output.endswith("the end\n")
    gap = next(line for line in output.splitlines() if "left out" in line)
    total = len("the beginning\n") + 4_000_000 + len("the end\n")
    assert gap == f"[{total - KEPT_OUTPUT} bytes left out]"
    assert len(output) < KEPT_OUTPUT + 100


@pytest.mark.parametrize(
    ("function", "given", "code", "said"),
    [
        ("kill_myself", (signal.SIGSEGV,), "child-crashed", "segmentation fault"),
        ("kill_myself", (signal.SIGKILL,), "child-crashed", "killed"),
        ("print_in_c_and_crash", (), "child-crashed", "the last thing that was said"),
        ("leave", ("SystemExit",), "child-left", "3"),
        ("leave", ("os._exit",), "child-left", "3"),
        ("forge_answer", ("truncated",), "child-left", "0"),
        ("forge_answer", ("no json",), "child-answer-unusable", "Invalid JSON"),
        ("forge_answer", ("wrong form",), "child-answer-unusable", "Input should be a valid "),
        ("forge_answer", ("nested",), "child-answer-unusable", "recursion limit exceeded"),
        ("forge_answer", ("many values",), "child-answer-unusable", f"{MOST_VALUES}"),
        ("forge_answer", ("too long",), "child-answer-unusable", f"{LARGEST_ANSWER}"),
        ("forge_answer", ("no word",), "child-answer-unusable", "kind"),
        ("forge_answer", ("no such exception",), "child-answer-unusable", "'os.system'"),
        ("forge_answer", ("unfit exception",), "child-answer-unusable", "'MissingDependencyError'"),
    ],
)
def test_a_child_without_an_answer_is_an_error(
    functions: ModuleType, function: str, given: tuple[Any, ...], code: str, said: str
) -> None:
    """With the signal, the exit status, the last words or what is wrong with the answer, in one sentence."""
    with pytest.raises(CrashError) as caught:
        run_in_child(getattr(functions, function), *given, timeout=LONG, encoding=Data(tuple[bytes, str]))
    (problem,) = caught.value.problems
    assert problem.code == code
    assert said in problem.message


def test_exceptions_keep_their_type(functions: ModuleType) -> None:
    """An exception comes back in its own type, with the child's traceback and output in its cause."""
    with pytest.raises(ValueError, match="not this value") as caught:
        run_in_child(functions.raise_value_error, timeout=LONG)
    cause = caught.value.__cause__
    assert isinstance(cause, ChildFailure)
    assert cause.output == "looking for it\n"
    assert "in raise_value_error" in cause.traceback
    assert "in raise_value_error" in str(cause)


@pytest.mark.parametrize("encoding", [Data(), PICKLED], ids=["data", "pickle"])
def test_unpicklable_exception_is_wrapped(functions: ModuleType, encoding: Data[Any] | Pickled[Any]) -> None:
    """An exception that cannot be sent becomes a RuntimeError with its name, its text and its traceback."""
    with pytest.raises(RuntimeError, match=r"^UnpicklableError: cannot travel") as caught:
        run_in_child(functions.raise_unpicklable, timeout=LONG, encoding=encoding)
    assert isinstance(caught.value.__cause__, ChildFailure)
    assert "in raise_unpicklable" in caught.value.__cause__.traceback


@pytest.mark.parametrize("when", ["before its answer", "in its place"])
def test_pickle_from_behind_the_fence_runs_nothing(functions: ModuleType, tmp_path: Path, when: str) -> None:
    """A child that is taken over writes a pickle to every pipe it has: its parent runs nothing, and says so."""
    ran = tmp_path / "ran"
    with pytest.raises(CrashError) as caught:
        run_in_child(functions.send_pickle, str(ran), when, timeout=LONG)
    assert not ran.exists()
    assert caught.value.problems[0].code == "child-answer-unusable"


@pytest.mark.parametrize("number", [0.1 + 0.2, -0.0, 5e-324, 1.7976931348623157e308, math.inf, -math.inf, math.nan])
def test_numbers_arrive_bit_for_bit(functions: ModuleType, number: float) -> None:
    """A float is the same double in parent and child."""
    value = run_in_child(functions.as_it_is, number, timeout=LONG, encoding=Data(float)).value
    assert struct.pack("d", value) == struct.pack("d", number)


def test_records_and_marks_arrive(functions: ModuleType) -> None:
    """Records, tuples and bytes arrive as they are; so do the places and notices of an error, and notes on it."""
    problem = Problem(message="odd", severity="notice", mark=Mark(file="a.urdf", line=3), found="x")
    given = {"a": ((problem, b"\x00\xff"),), "b": ()}
    encoding = Data(dict[str, tuple[tuple[Problem, bytes], ...]])
    assert run_in_child(functions.as_it_is, given, timeout=LONG, encoding=encoding).value == given
    with pytest.raises(ProofError) as caught:
        run_in_child(functions.refuse, problem, timeout=LONG)
    assert (caught.value.problems, caught.value.notices) == ((problem, problem), (problem,))
    assert caught.value.__notes__ == ["a note"]


@pytest.mark.long
def test_time_limit_ends_the_whole_group(
    functions: ModuleType, tmp_path: Path, soon: Callable[..., bool], is_running: Callable[[int], bool]
) -> None:
    """A child that hangs is killed at the limit, together with what it started itself."""
    pids = tmp_path / "pids"
    with pytest.raises(TimeLimitError, match="did not finish within 3 s"):
        run_in_child(functions.hang, str(pids), timeout=3)
    assert soon(lambda: not any(is_running(int(pid)) for pid in pids.read_text().split()))


def test_interrupt_ends_the_child(
    functions: ModuleType, tmp_path: Path, soon: Callable[..., bool], is_running: Callable[[int], bool]
) -> None:
    """Ctrl-C while a child runs is raised in the parent, and leaves no process behind."""
    pids = tmp_path / "pids"

    def interrupt() -> None:
        soon(pids.exists)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        run_in_child(functions.hang, str(pids), timeout=LONG)
    assert soon(lambda: not any(is_running(int(pid)) for pid in pids.read_text().split()))


def test_script_needs_no_main_guard(tmp_path: Path) -> None:
    """A script without `if __name__ == "__main__"` may use it: the child does not run the script again."""
    script = tmp_path / "script.py"
    script.write_text(
        "from math import hypot\n"
        "from dh2urdf.isolation.child_process import run_in_child\n"
        "print('once', run_in_child(hypot, 3.0, 4.0, timeout=60).value)\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run([sys.executable, str(script)], env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "once 5.0\n", "")
