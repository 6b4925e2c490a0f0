import operator
import os
import pickle
import re
import signal
import subprocess
import sys
import traceback
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from dh2urdf.errors import ConfigError, Dh2UrdfError, ExecutorError
from dh2urdf.stages import Lost
from dh2urdf_plugins.executors.local import EXECUTOR, LocalOptions, map_locally

# The work is done by functions of the standard library: a worker has to import what it is to call.
call = operator.methodcaller("__call__")
TWO = LocalOptions(workers=2)


@pytest.fixture(params=[1, 2], ids=["in this process", "in others"])
def options(request: pytest.FixtureRequest) -> LocalOptions:
    return LocalOptions(workers=request.param)


class TestProcesses:
    def test_one_task_needs_no_other_process(self) -> None:
        """One manipulator is made here, whatever number of workers is asked for."""
        assert list(map_locally(call, [os.getpid], LocalOptions(workers=8))) == [os.getpid()]

    def test_what_a_worker_prints_reaches_standard_error(
        self, functions: ModuleType, capfd: pytest.CaptureFixture[str]
    ) -> None:
        """Line by line after each task, in bounds, however much a stage prints; standard output has nothing of it."""
        texts = ["WARNING: a screw is loose\n", "WARNING: a screw is loose\n" * 10_000] * 2
        assert list(map_locally(functions.print_much, texts, TWO)) == [len(text) for text in texts]
        printed = capfd.readouterr()
        assert printed.out == ""
        line = "a worker prints: WARNING: a screw is loose"
        bound = f"a worker prints: [the last 100 lines of {4 * len(texts[1]) + 2:,} bytes]"
        assert sorted(printed.err.splitlines()) == sorted([line] * (2 * 4 + 2 * 100) + [bound] * 2)


class TestErrors:
    @pytest.mark.parametrize("how", ["config", "stage"])
    def test_travel_as_they_are(self, functions: ModuleType, options: LocalOptions, how: str) -> None:
        """An error of a worker is the one that would have come here, with all that it says."""
        with pytest.raises(Dh2UrdfError) as expected:
            functions.fail(how)
        with pytest.raises(type(expected.value)) as found:
            list(map_locally(functions.fail, [how, how], options))
        assert str(found.value) == str(expected.value)
        assert {**vars(found.value)} == {**vars(expected.value)}

    def test_keep_their_traceback(self, functions: ModuleType) -> None:
        """`--debug` shows where in the worker it was."""
        with pytest.raises(ConfigError) as found:
            list(map_locally(functions.fail, ["config"] * 2, TWO))
        assert "in fail\n" in "".join(traceback.format_exception(found.value))

    def test_that_cannot_travel_are_told(self, functions: ModuleType) -> None:
        """An exception or a result that pickle does not take does not cost the worker."""
        with pytest.raises(RuntimeError, match=r"^UnpicklableError: cannot travel$"):
            list(map_locally(functions.fail, ["otherwise"] * 2, TWO))
        with pytest.raises((pickle.PicklingError, AttributeError), match="return_unpicklable"):
            list(map_locally(functions.return_unpicklable, [1, 2], TWO))
        results = map_locally(functions.double, [1, 2, lambda: None, 3], TWO)
        assert [next(results), next(results)] == [2, 4]  # A task has its turn, too.
        with pytest.raises((pickle.PicklingError, AttributeError, TypeError)):
            next(results)

    def test_an_interpreter_that_is_left_is_left_here(self, functions: ModuleType, options: LocalOptions) -> None:
        """`sys.exit` in a stage does what it does without workers."""
        with pytest.raises(SystemExit) as found:
            list(map_locally(functions.fail, ["leave"] * 2, options))
        assert found.value.code == 3

    def test_a_function_that_workers_cannot_import(self, functions: ModuleType) -> None:
        """What is in a script needs no second process, and the message says so."""
        with pytest.raises(
            ExecutorError, match=r"cannot take the work over: ImportError: no module named 'lab'\n.*--workers 1"
        ):
            list(map_locally(functions.Unusable(), [1, 2], TWO))

    def test_workers_that_die_before_they_begin(self, functions: ModuleType) -> None:
        """Where no worker can begin, the tasks are not to blame: the run ends."""
        with pytest.raises(
            ExecutorError, match="worker processes cannot be started: the worker left with exit status 5"
        ):
            list(map_locally(functions.Deadly(), range(100), TWO))


class TestDeaths:
    @pytest.mark.parametrize(
        ("death", "reason"),
        [
            ("SIGKILL", r"^the worker was killed \(SIGKILL\), from outside or for want of memory$"),
            ("SIGABRT", r"^the worker crashed \(SIGABRT, aborted\); it printed last: 'Fatal Python error: Aborted .* in double_or_die"),
            ("segmentation fault", r"^the worker crashed \(SIGSEGV, segmentation fault\); .*Fatal Python error: Seg.* in string_at"),
            ("leave", r"^the worker left with exit status 3; it printed last: 'I am leaving'$"),
            ("hang", r"^the worker left with exit status 1; it printed last: 'Timeout \(0:00:00.500000\)! .* in double_or_die"),
            ("fork and die", r"^the worker was killed \(SIGKILL\)"),
            ("answer wrongly", r"^the worker was killed \(SIGKILL\)"),
        ],
    )  # fmt: skip
    def test_a_task_that_kills_every_worker_is_lost_alone(self, functions: ModuleType, death: str, reason: str) -> None:
        """Its place says how the worker ended; every other task has its result, in order."""
        tasks = [*range(10), death, *range(10, 20)]
        results = list(map_locally(functions.double_or_die, tasks, TWO))
        lost = results.pop(10)
        assert results == [2 * number for number in range(20)]
        assert isinstance(lost, Lost)
        assert re.search(reason, lost.reason), lost.reason

    def test_a_worker_that_dies_once_costs_nothing(self, functions: ModuleType, tmp_path: Path) -> None:
        """Its task is given to another one: nobody hears of it."""
        tasks = [(tmp_path / f"{number % 5}", number) for number in range(20)]
        assert list(map_locally(functions.die_once, tasks, TWO)) == list(range(20))

    @pytest.mark.long
    def test_workers_that_are_killed_from_outside(self, functions: ModuleType, tmp_path: Path) -> None:
        """Whenever it happens, at work or idle, every task has its one result; only what was under way is done twice."""
        killed = 0
        for number, result in enumerate(map_locally(partial(functions.double_slowly_in, tmp_path), range(40), TWO)):
            assert result == 2 * number
            if number in {5, 20}:
                # The file of the last task may be there before its line is.
                begun = {int(path.name): path.read_text().split() for path in tmp_path.iterdir()}
                os.kill(int(begun[max(task for task in begun if begun[task])][-1]), signal.SIGKILL)
                killed += 1
        done = [len((tmp_path / f"{number}").read_text().splitlines()) for number in range(40)]
        assert killed == 2
        assert 40 <= sum(done) <= 40 + killed

    def test_a_task_is_not_blamed_for_the_words_of_another(self, functions: ModuleType) -> None:
        """The reason repeats what was printed since the task began."""
        results = map_locally(functions.double_or_die, [1, 2, "SIGKILL", 3], TWO)
        assert not any("printed" in str(result) for result in results)


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="the system has no process groups")
class TestInterrupts:
    HANGING = (
        "import sys\n"
        "from pathlib import Path\n"
        "from worker_functions import *\n"
        "from dh2urdf_plugins.executors.local import LocalOptions, map_locally\n"
        "tasks = [Path(sys.argv[1]) / str(number) for number in range(6)]\n"
        "try:\n"
        "    list(map_locally({}, tasks, LocalOptions(workers=2)))\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted')\n"
    )

    @pytest.mark.parametrize("results", [1, 30], ids=["while workers start", "while workers wait"])
    def test_an_interrupt_is_told_once(self, results: int) -> None:
        """Ctrl-C reaches every process of the terminal; the workers end without a word, the run tells it once."""
        script = (
            "import time\n"
            "from dh2urdf_plugins.executors.local import LocalOptions, map_locally\n"
            "def tasks():\n"
            "    while True:\n"
            "        yield 0.001\n"
            "        time.sleep(0.01)\n"
            "try:\n"
            "    for _ in map_locally(time.sleep, tasks(), LocalOptions(workers=3)):\n"
            "        print('done', flush=True)\n"
            "except KeyboardInterrupt:\n"
            "    print('interrupted')\n"
        )
        with started(script) as process:
            assert process.stdout
            for _ in range(results):
                assert process.stdout.readline() == "done\n"
            os.killpg(process.pid, signal.SIGINT)
            printed, errors = process.communicate(timeout=60)
        assert printed.splitlines()[-1] == "interrupted"
        assert errors == ""

    @pytest.mark.usefixtures("functions")
    def test_an_interrupted_task_takes_away_what_it_was_writing(
        self, tmp_path: Path, soon: Callable[..., bool], is_running: Callable[[int], bool]
    ) -> None:
        """Ctrl-C ends a task in its middle, with all that it started, and leaves nothing half-written."""
        with started(self.HANGING.format("hang_half_written"), tmp_path) as process:
            assert soon(lambda: len(list(tmp_path.glob("*.pids"))) == 2)
            os.killpg(process.pid, signal.SIGINT)
            assert process.communicate(timeout=60) == ("interrupted\n", "")
        assert [path.suffix for path in tmp_path.iterdir()] == [".pids"] * 2
        assert soon(lambda: not any(map(is_running, pids(tmp_path.glob("*.pids")))))

    @pytest.mark.usefixtures("functions")
    def test_a_task_that_does_not_listen_is_ended(
        self, tmp_path: Path, soon: Callable[..., bool], is_running: Callable[[int], bool]
    ) -> None:
        """A worker that cannot be asked to end is killed: no run waits for it."""
        with started(self.HANGING.format("ignore_termination"), tmp_path) as process:
            assert soon(lambda: len(pids(tmp_path.iterdir())) == 2)
            os.killpg(process.pid, signal.SIGINT)
            assert process.communicate(timeout=60) == ("interrupted\n", "")
        assert not any(map(is_running, pids(tmp_path.iterdir())))

    @pytest.mark.usefixtures("functions")
    def test_workers_leave_with_a_run_that_is_killed(
        self, tmp_path: Path, soon: Callable[..., bool], is_running: Callable[[int], bool]
    ) -> None:
        """SIGKILL gives a run no chance to end its workers: they see that it is gone, in the middle of a task too."""
        with started(self.HANGING.format("hang_half_written"), tmp_path) as process:
            assert soon(lambda: len(list(tmp_path.glob("*.pids"))) == 2)
            left = pids(tmp_path.glob("*.pids"))
            assert all(map(is_running, left))
            process.kill()
            process.wait()
            assert soon(lambda: not any(map(is_running, left)))
            assert process.communicate(timeout=60) == ("", "")


def started(script: str, *words: Any) -> subprocess.Popen[str]:
    """A script in a process group of its own."""
    return subprocess.Popen(
        [sys.executable, "-c", script, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def pids(paths: Iterable[Path]) -> list[int]:
    """The process ids that files hold."""
    return [int(word) for path in paths for word in path.read_text().split()]


class TestOptions:
    def test_there_is_at_least_one_worker(self) -> None:
        with pytest.raises(ValueError, match="a number from 1 on, or auto"):
            LocalOptions(workers=0)

    def test_auto_is_the_default_and_works(self) -> None:
        """Without a number there is a worker per processor."""
        assert EXECUTOR.options() == LocalOptions(workers="auto")
        assert list(EXECUTOR.map(operator.neg, range(10), LocalOptions())) == [-number for number in range(10)]

    def test_auto_leaves_the_process_itself_alone(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """A machine with one processor has one worker process, which may crash; the number 1 asks for none."""
        monkeypatch.setattr("dh2urdf_plugins.executors.local.processors", lambda: 1)
        own, others = (set(map_locally(call, [os.getpid] * 4, LocalOptions(workers=n))) for n in (1, "auto"))
        assert own == {os.getpid()}
        assert len(others) == 1
        assert own != others
