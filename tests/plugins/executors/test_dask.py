import importlib
import importlib.util
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from itertools import count, islice
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from dh2urdf.errors import ExecutorError, MissingDependencyError
from dh2urdf.plugin_system import load
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import make_plan
from dh2urdf.stages import Lost
from dh2urdf_plugins.executors import dask
from dh2urdf_plugins.executors.dask import EXECUTOR, DaskOptions, map_on_dask

pytest.importorskip("distributed", reason="Dask is not installed")
pytestmark = pytest.mark.skipif(not hasattr(os, "killpg"), reason="the system has no process groups")

HERE = Path(__file__).parent


class Cluster:
    """A real `dask scheduler` and real `dask worker` processes on loopback, each in a process group of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.processes: list[subprocess.Popen[bytes]] = []
        file = folder / "scheduler.json"
        self.scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file))
        end = time.monotonic() + 60
        while not file.exists() or not file.read_text().endswith("}"):
            assert time.monotonic() < end, (folder / "scheduler.log").read_text()
            time.sleep(0.02)
        self.options = DaskOptions(scheduler=json.loads(file.read_text())["address"])

    def worker(self, *path: Path) -> subprocess.Popen[bytes]:
        """Starts a worker that sees some folders before the installed distributions."""
        address = str(self.options.scheduler)
        return self._start("worker", address, "--nworkers", "1", "--nthreads", "2", path=path)

    def _start(self, command: str, *words: str, path: tuple[Path, ...] = ()) -> subprocess.Popen[bytes]:
        folders = [*map(str, path), str(HERE), *filter(None, [os.environ.get("PYTHONPATH")])]
        with (self.folder / f"{command}.log").open("ab") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.dask_{command}", *words, "--no-dashboard"],
                cwd=self.folder,
                env={
                    **os.environ,
                    "PYTHONPATH": os.pathsep.join(folders),
                    "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1",
                },
                stdout=log,
                stderr=log,
                start_new_session=True,
            )
        self.processes.append(process)
        return process

    def workers(self) -> int:
        """How many workers the scheduler knows."""
        import distributed

        with distributed.Client(self.options.scheduler, set_as_default=False) as client:
            return len(client.nthreads())


def contents(folder: Path) -> dict[str, bytes]:
    """The files of a run but for its durations."""
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != "timing.json"]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def kill(process: subprocess.Popen[bytes]) -> None:
    """Ends a process and all that it started, as a machine that fails does."""
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@contextmanager
def started_cluster(folder: Path) -> Iterator[Cluster]:
    cluster = Cluster(folder)
    try:
        yield cluster
    finally:
        for process in cluster.processes:
            if process.poll() is None:
                kill(process)


@pytest.fixture(scope="module")
def two_machines(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    with started_cluster(tmp_path_factory.mktemp("cluster")) as cluster:
        cluster.worker(), cluster.worker()
        yield cluster


@pytest.fixture
def cluster(two_machines: Cluster, soon: Callable[..., bool]) -> Cluster:
    """A scheduler with two workers."""
    while sum(process.poll() is None for process in two_machines.processes) < 3:
        two_machines.worker()
    assert soon(lambda: two_machines.workers() == 2)
    return two_machines


class TestACluster:
    def test_a_worker_does_one_task_at_a_time(self, functions: ModuleType, cluster: Cluster, tmp_path: Path) -> None:
        """The threads of a worker take turns: stages need not bear others beside them."""
        alone = list(map_on_dask(partial(functions.is_alone_in, tmp_path), range(40), cluster.options))
        assert alone == [True] * 40

    @pytest.mark.long
    def test_a_run_of_1500_survives_a_worker(
        self, cluster: Cluster, soon: Callable[..., bool], tmp_path: Path, undrawn: str
    ) -> None:
        """One of two workers is killed in the middle: every manipulator is made once, with the bytes of `local`."""
        root = Path(__file__).parents[3]
        (tmp_path / "run.yaml").write_text(
            f"inputs: {root}/configs/tables/ur5.csv\n"
            "variations: {of: ur5, count: 1500, seed: 1, vary: {joints: all, field: mass, uniform: [1, 5]}}\n"
            "output: {directory: near, layout: folders}\n"
        )
        command = [sys.executable, "-c", f"{undrawn}from dh2urdf.cli import main; main()", "run", "run.yaml", "--quiet"]
        subprocess.run(command, cwd=tmp_path, check=True)
        settings = ("execution.stage=dask", f"execution.options.scheduler={cluster.options.scheduler}")
        far = [*command, "-o", "far", *(word for setting in settings for word in ("--set", setting))]
        with subprocess.Popen(far, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as run:
            assert soon(lambda: len(list((tmp_path / "far").glob("*/*.urdf"))) > 300)
            kill(cluster.processes[-1])
            assert run.poll() is None, "the run was over before a worker was killed"
            _, said = run.communicate(timeout=240)
        assert (run.returncode, said) == (0, "")
        rows = [json.loads(line)["name"] for line in (tmp_path / "far/manifest.jsonl").open("rb")]
        assert len(rows) == len(set(rows)) == 1501
        assert contents(tmp_path / "far") == contents(tmp_path / "near")

    @pytest.mark.long
    @pytest.mark.parametrize("death", ["segmentation fault", "leave"])
    def test_a_task_that_kills_every_worker_is_lost_alone(
        self, functions: ModuleType, cluster: Cluster, death: str
    ) -> None:
        """Its place says so; every other task has its result, also those that was beside it."""
        results = list(map_on_dask(functions.double_or_die, [*range(10), death, *range(10, 20)], cluster.options))
        lost = results.pop(10)
        assert results == [2 * number for number in range(20)]
        assert isinstance(lost, Lost)
        assert lost.reason.startswith("2 Dask workers died at it, the last at tcp://127.0.0.1:")

    @pytest.mark.long
    def test_other_versions_are_refused(self, functions: ModuleType, cluster: Cluster, tmp_path: Path) -> None:
        """A worker that would make other bytes is named with both versions, whether it comes late or early."""
        old = tmp_path / "dh2urdf-0.0.1.dist-info"
        old.mkdir()
        (old / "METADATA").write_text("Metadata-Version: 2.1\nName: dh2urdf\nVersion: 0.0.1\n")
        results = map_on_dask(functions.double, count(), cluster.options)
        assert next(results) == 0
        worker = cluster.worker(tmp_path)
        refused = r"the Dask worker at tcp://127.0.0.1:\d+ has dh2urdf 0\.0\.1, not \d.* as the run has\n.* install dh2urdf \d"
        with pytest.raises(ExecutorError, match=refused):
            list(results)
        with pytest.raises(ExecutorError, match=refused):
            list(map_on_dask(functions.double, range(5), cluster.options))
        kill(worker)

    def test_plugins_are_compared_whose_stages_are_used(
        self,
        functions: ModuleType,
        cluster: Cluster,
        tmp_path: Path,
        install: Callable[..., None],
        monkeypatch: pytest.MonkeyPatch,
    ) -> None:
        """A worker without one of them is refused; what a run leaves out, or does not need, no worker has to have."""
        install(tmp_path, "lab-tools", "raise ImportError('of nobody')")
        monkeypatch.syspath_prepend(tmp_path)
        assert list(map_on_dask(functions.double, range(3), cluster.options)) == [0, 2, 4]
        functions.halve.distributions = ("dh2urdf", "lab-tools")
        refused = r"the Dask worker at tcp://127.0.0.1:\d+ has no lab-tools\n.* install lab-tools 1\.0 where"
        with pytest.raises(ExecutorError, match=refused):
            list(map_on_dask(functions.halve, range(3), cluster.options))

    def test_a_run_that_ends_early_leaves_the_cluster_alone(
        self, functions: ModuleType, cluster: Cluster, tmp_path: Path, soon: Callable[..., bool]
    ) -> None:
        """The scheduler and its workers are somebody else's; what was not begun is not done any more."""
        results = map_on_dask(partial(functions.double_slowly_in, tmp_path), count(), cluster.options)
        assert next(results) == 0
        results.close()  # type: ignore[attr-defined]
        assert cluster.workers() == 2
        begun = -1

        def is_over() -> bool:
            nonlocal begun
            before, begun = begun, len(list(tmp_path.iterdir()))
            time.sleep(0.3)
            return before == begun

        assert soon(is_over)
        assert begun <= 2 * 2 * dask.AHEAD_OF_THREADS


class TestNobody:
    @pytest.mark.parametrize(
        ("address", "reason"),
        [
            ("tcp://127.0.0.1:1", "Timed out"),
            ("somewhere", "missing port number"),
            ("http://127.0.0.1:80", "unknown address scheme 'http'"),
        ],
    )
    def test_at_the_address(self, monkeypatch: pytest.MonkeyPatch, address: str, reason: str) -> None:
        """Where no scheduler answers, the message says how to start one."""
        monkeypatch.setattr(dask, "CONNECTING", 0.5)
        with pytest.raises(ExecutorError, match=f"no Dask scheduler answers at '{address}': {reason}") as found:
            list(map_on_dask(abs, [1], DaskOptions(scheduler=address)))
        assert "`dask scheduler` starts one, and `dask worker ADDRESS`" in str(found.value)

    @pytest.mark.long
    def test_to_work_or_to_ask(
        self, functions: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
    ) -> None:
        """A run says that it waits for workers, and ends where none comes, or where the scheduler goes."""
        monkeypatch.setattr(dask, "_UNTOLD", 0.0)
        with started_cluster(tmp_path) as cluster:
            monkeypatch.setattr(dask, "WORKERS_WITHIN", 0.5)
            with pytest.raises(
                ExecutorError, match=r"no Dask worker came within 0.5 s\n.*dask worker tcp://.*--resume"
            ):
                list(map_on_dask(functions.double, [1], cluster.options))
            assert "no Dask worker is there; waiting for one, up to 0.5 s" in caplog.messages
            monkeypatch.setattr(dask, "WORKERS_WITHIN", 60.0)
            results = map_on_dask(functions.double, count(), cluster.options)
            worker = cluster.worker()
            assert next(results) == 0  # One that comes in time is welcome.
            kill(worker)
            monkeypatch.setattr(dask, "WORKERS_WITHIN", 0.5)
            with pytest.raises(ExecutorError, match=r"no Dask worker came within 0.5 s"):
                list(results)
            monkeypatch.setattr(dask, "WORKERS_WITHIN", 60.0)
            cluster.worker()
            results = map_on_dask(functions.double, count(), cluster.options)
            assert next(results) == 0
            kill(cluster.scheduler)
            with pytest.raises(ExecutorError, match=r"the Dask scheduler is gone\n.*--resume"):
                list(results)


class TestAClusterOfItsOwn:
    @pytest.mark.long
    def test_works_and_goes(
        self,
        functions: ModuleType,
        soon: Callable[..., bool],
        is_running: Callable[[int], bool],
        capfd: pytest.CaptureFixture[str],
    ) -> None:
        """Without an address the work is done by processes of this machine, quietly, and none of them stays."""
        results = map_on_dask(functions.pid, count(), DaskOptions(workers=2))
        workers = set(islice(results, 30))
        assert 1 <= len(workers) <= 2
        assert os.getpid() not in workers
        results.close()  # type: ignore[attr-defined]
        assert soon(lambda: not any(map(is_running, workers)))
        assert capfd.readouterr() == ("", "")

    @pytest.mark.long
    @pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL], ids=lambda end: end.name)
    @pytest.mark.usefixtures("functions")
    def test_ends_with_the_run(
        self, tmp_path: Path, end: signal.Signals, soon: Callable[..., bool], is_running: Callable[[int], bool]
    ) -> None:
        """Ctrl-C in a terminal is reported once, by the run; however it ends, its workers leave in the middle of a task."""
        script = (
            "import signal, sys\n"
            "from pathlib import Path\n"
            "from worker_functions import hang_half_written\n"
            "from dh2urdf_plugins.executors.dask import DaskOptions, map_on_dask\n"
            "signal.signal(signal.SIGTERM, signal.default_int_handler)\n"
            "tasks = [Path(sys.argv[1]) / str(number) for number in range(6)]\n"
            "try:\n"
            "    list(map_on_dask(hang_half_written, tasks, DaskOptions(workers=1)))\n"
            "except KeyboardInterrupt:\n"
            "    print('interrupted')\n"
        )
        with subprocess.Popen(
            [sys.executable, "-c", script, tmp_path],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        ) as process:
            assert soon(lambda: list(tmp_path.glob("*.pids")))
            (file,) = tmp_path.glob("*.pids")
            worker = int(file.read_text().split()[0])
            os.killpg(process.pid, end)
            printed, said = process.communicate(timeout=60)
        assert said == ""
        assert printed == ("" if end == signal.SIGKILL else "interrupted\n")
        assert soon(lambda: not is_running(worker))


class TestOptions:
    @pytest.mark.parametrize(
        ("options", "reason"),
        [
            ({"workers": 0}, "a number from 1 on, or auto"),
            ({"workers": 2, "scheduler": "tcp://host:8786"}, "workers are those of the scheduler"),
        ],
    )
    def test_what_makes_no_sense_is_refused(self, options: dict[str, Any], reason: str) -> None:
        """No worker, and a number of workers for somebody else's cluster."""
        with pytest.raises(ValueError, match=reason):
            DaskOptions(**options)

    def test_what_is_not_installed_is_said_before_the_run(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """The message has the line that installs it."""
        EXECUTOR.require(DaskOptions())
        monkeypatch.setattr(importlib.util, "find_spec", lambda _name: None)
        with pytest.raises(MissingDependencyError, match=r"executor 'dask' needs .*pip install 'dh2urdf\[dask\]'"):
            EXECUTOR.require(DaskOptions())


class TestThePage:
    """docs/machines.md keeps its word."""

    ROOT = HERE.parents[2]

    def blocks(self, language: str) -> list[str]:
        text = (self.ROOT / "docs" / "machines.md").read_text("utf-8")
        return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)

    def test_its_commands_have_these_options(self) -> None:
        """Dask knows every word of the commands that start a cluster."""
        (block,) = self.blocks("sh")
        _, scheduler, worker = map(shlex.split, block.splitlines())
        for words in (scheduler, worker):
            program, command, *options = words
            assert program == "dask"
            parameters = importlib.import_module(f"distributed.cli.dask_{command}").main.params
            known = {name for parameter in parameters for name in (*parameter.opts, *parameter.secondary_opts)}
            assert {word for word in options if word.startswith("--")} <= known

    def test_its_script_calls_the_run(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """The SLURM script, with a stand-in for the queue, does a run with the cluster's address and the given words."""
        (block,) = self.blocks("python")
        called: list[list[str]] = []

        class Stub:
            scheduler_address = "tcp://10.0.0.1:8786"

            def __init__(self, *_cluster: Any, **_options: Any) -> None: ...

            def __enter__(self) -> Any:
                return self

            def __exit__(self, *_error: object) -> None: ...

            def scale(self, *, jobs: int) -> None:
                assert jobs > 0

            def wait_for_workers(self, number: int) -> None:
                assert number == 1

        script = compile(block, "on_slurm.py", "exec")
        with monkeypatch.context() as patch:
            patch.setitem(sys.modules, "dask_jobqueue", SimpleNamespace(SLURMCluster=Stub))
            patch.setitem(sys.modules, "distributed", SimpleNamespace(Client=Stub))
            patch.setattr(subprocess, "call", called.append)
            patch.setattr(sys, "argv", ["on_slurm.py", "study.yaml", "--resume"])
            with pytest.raises(SystemExit):
                exec(script, {"__name__": "__main__"})  # noqa: S102 - the page's own script
        (words,) = called
        assert words[:4] == ["dh2urdf", "run", "study.yaml", "--resume"]
        shutil.copytree(self.ROOT / "configs", tmp_path / "configs")
        plan = make_plan(load_config(tmp_path / "configs" / "ur5.yaml", words[5::2]), load())
        assert plan.executor.options == DaskOptions(scheduler=Stub.scheduler_address)
