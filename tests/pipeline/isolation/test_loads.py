import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import ModuleType

import pytest
from other_fields import with_field

from dh2urdf.conversion.loads import load_in_child
from dh2urdf.errors import CrashError, LoaderError, TimeLimitError
from dh2urdf.isolation.child_process import KEPT_OUTPUT
from dh2urdf.isolation.kept_children import KeptChildren
from dh2urdf.robot import Robot
from dh2urdf.stages import LoadReport, LoadRequest, NoOptions


@pytest.fixture
def request_for(tmp_path: Path) -> Callable[[str], LoadRequest]:
    """The request to load a file of some name."""

    def make(name: str) -> LoadRequest:
        return LoadRequest(path=tmp_path / name, robot=Robot(name="arm", links=(), joints=()), poses=(), expected={})

    return make


@pytest.fixture
def children() -> Iterator[KeptChildren]:
    with KeptChildren() as children:
        yield children


@pytest.fixture
def kept(
    functions: ModuleType, children: KeptChildren, request_for: Callable[[str], LoadRequest]
) -> Callable[..., LoadReport]:
    """The report of a kept child of a toy: its version is the child's number, its simulator the files that were loaded."""

    def load(name: str, prepare: Callable[..., None] = functions.prepare, time_limit: float = 20.0) -> LoadReport:
        loader = with_field(functions.KEPT, "prepare", prepare)
        return load_in_child(loader, request_for(f"{name}.urdf"), functions.Hasty(time_limit), None, children)

    return load


class TestOneLoad:
    def test_report_is_completed_with_the_output(
        self, functions: ModuleType, request_for: Callable[[str], LoadRequest]
    ) -> None:
        """A loader's report gets what was printed, and the findings in it after the loader's own."""
        report = load_in_child(functions.LOADER, request_for("good.urdf"), NoOptions())
        assert report.output == "WARNING: a screw is loose\n"
        assert [finding.message for finding in report.findings] == ["toy: measured", "toy: WARNING: a screw is loose"]

    @pytest.mark.parametrize(("name", "error"), [("refused", LoaderError), ("crash", CrashError)])
    def test_a_failure_is_completed_with_the_output(
        self, functions: ModuleType, request_for: Callable[[str], LoadRequest], name: str, error: type[LoaderError]
    ) -> None:
        """What a simulator printed before it refused the file or crashed follows the loader's own problems."""
        with pytest.raises(error) as caught:
            load_in_child(functions.LOADER, request_for(f"{name}.urdf"), NoOptions())
        first, finding = caught.value.problems
        assert "toy" in first.message
        assert finding.message == "toy: WARNING: a screw is loose"


class TestKeptChild:
    def test_serves_many_loads(self, kept: Callable[..., LoadReport], is_running: Callable[[int], bool]) -> None:
        """One process makes all loads, in forks of itself: none meets what another one has left in it."""
        reports = [kept(f"good_{number}") for number in range(10)]
        (pid,) = {int(report.version) for report in reports}
        assert pid != os.getpid()
        assert is_running(pid)
        assert [report.simulator for report in reports] == [f"good_{number}.urdf" for number in range(10)]

    def test_serves_one_loader_with_its_options(
        self, functions: ModuleType, children: KeptChildren, request_for: Callable[[str], LoadRequest]
    ) -> None:
        """Loaders of other functions have other children, and one that declares nothing has a new one each time."""
        request = request_for("good")
        others = [with_field(functions.KEPT, "prepare", function) for function in (functions.prepare_otherwise, None)]
        pids = [
            load_in_child(loader, request, NoOptions(), None, children).version
            for loader in (functions.KEPT, *others) * 3
        ]
        assert [len(set(pids[number::3])) for number in range(3)] == [1, 1, 3]

    def test_serves_one_thread_at_a_time(self, kept: Callable[..., LoadReport]) -> None:
        """Threads that load at once do not wait for each other's child, nor mix their answers."""
        names = [f"good_{number}" for number in range(30)]
        with ThreadPoolExecutor(3) as threads:
            reports = list(threads.map(kept, names))
        assert [report.output for report in reports] == [f"toy is starting\nloading {name}.urdf\n" for name in names]
        assert len({report.version for report in reports}) <= 3

    def test_output_is_that_of_its_load(self, kept: Callable[..., LoadReport]) -> None:
        """From C too, without an end of a line, and in bounds; what the import printed belongs to each load."""
        start = "toy is starting\nloading {}.urdf\n"
        for _ in range(2):
            assert kept("good").output == start.format("good")
            assert kept("in_c").output == start.format("in_c") + "from C, without an end"
            much = kept("much").output
            assert much.startswith(start.format("much") + "the beginning\n")
            assert much.endswith("the end\n")
            assert len(much) < KEPT_OUTPUT + 200

    @pytest.mark.parametrize("name", ["thread", "folder", "environment", "path", "refused"])
    def test_meets_nothing_that_a_load_leaves(self, kept: Callable[..., LoadReport], name: str) -> None:
        """A thread, another folder, variable or path, or an exception: they end with the fork, and the child serves on."""
        first = kept("good")
        if name == "refused":
            with pytest.raises(LoaderError, match="toy: I do not like it"):
                kept(name)
        else:
            assert kept(name).version == first.version
        assert kept("good") == first

    @pytest.mark.parametrize("name", ["late", "orphan"])
    def test_is_replaced_where_a_load_leaves_a_process(
        self, kept: Callable[..., LoadReport], soon: Callable[..., bool], is_running: Callable[[int], bool], name: str
    ) -> None:
        """The load counts, its processes are ended, and the next one gets another child."""
        first = kept("good").version
        report = kept(name)
        assert report.version == first
        if name == "orphan":
            assert soon(lambda: not is_running(int(report.output.splitlines()[-1])))
        assert kept("good").version != first
        assert not is_running(int(first))

    @pytest.mark.parametrize(
        ("name", "code"), [("crash", "child-crashed"), ("exit", "child-left"), ("leave", "child-left")]
    )
    @pytest.mark.parametrize("before", [0, 4])
    def test_that_ends_costs_one_load(self, kept: Callable[..., LoadReport], name: str, code: str, before: int) -> None:
        """The first load or a later one: those before and after have their reports."""
        pids = [kept("good").version for _ in range(before)]
        with pytest.raises(CrashError) as caught:
            kept(name)
        assert f"'toy is starting loading {name}.urdf'" in caught.value.problems[0].message
        assert caught.value.problems[0].code in (code, None)
        assert kept("good").version not in pids

    @pytest.mark.long
    def test_that_hangs_is_ended_with_what_it_started(
        self,
        kept: Callable[..., LoadReport],
        tmp_path: Path,
        soon: Callable[..., bool],
        is_running: Callable[[int], bool],
    ) -> None:
        """The third load is over its time limit; its processes are gone, and the fourth has a new child."""
        pids = [kept("good", time_limit=3.0).version for _ in range(2)]
        with pytest.raises(TimeLimitError, match="the loader 'toy' did not finish within 3 s"):
            kept("hang", time_limit=3.0)
        left = [int(pid) for pid in (tmp_path / "hang.pids").read_text().split()]
        assert len(left) == 2
        assert soon(lambda: not any(map(is_running, left)))
        assert kept("good", time_limit=3.0).version not in pids


class TestLifetime:
    def test_ends_with_its_context(
        self, functions: ModuleType, is_running: Callable[[int], bool], request_for: Callable[[str], LoadRequest]
    ) -> None:
        """Also where the context ends with an error."""
        request = request_for("good")
        pids = []

        def use(children: KeptChildren) -> None:
            with children:
                pids.append(int(load_in_child(functions.KEPT, request, NoOptions(), None, children).version))
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            use(KeptChildren())
        assert pids
        assert not any(map(is_running, pids))

    def test_ends_where_nobody_has_it_any_more(
        self, functions: ModuleType, is_running: Callable[[int], bool], request_for: Callable[[str], LoadRequest]
    ) -> None:
        """A worker has no context around a run: its children go with what it works with."""
        request = request_for("good")
        children = pickle.loads(pickle.dumps(KeptChildren()))  # noqa: S301 - made here
        pid = int(load_in_child(functions.KEPT, request, NoOptions(), None, children).version)
        assert is_running(pid)
        del children
        assert not is_running(pid)

    def test_an_interrupt_ends_the_child(
        self,
        kept: Callable[..., LoadReport],
        tmp_path: Path,
        soon: Callable[..., bool],
        is_running: Callable[[int], bool],
    ) -> None:
        """Ctrl-C during the second load is raised here, and leaves no process behind."""
        first, pids = int(kept("good").version), tmp_path / "hang.pids"

        def interrupt() -> None:
            soon(pids.exists)
            os.kill(os.getpid(), signal.SIGINT)

        threading.Thread(target=interrupt).start()
        with pytest.raises(KeyboardInterrupt):
            kept("hang")
        assert soon(lambda: not any(is_running(int(pid)) for pid in (*pids.read_text().split(), first)))

    @pytest.mark.parametrize("name", ["good", "hang"])
    def test_leaves_with_a_parent_that_is_killed(
        self, tmp_path: Path, soon: Callable[..., bool], is_running: Callable[[int], bool], name: str
    ) -> None:
        """In the middle of a load and between two."""
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])}
        place, pids = tmp_path / f"{name}.urdf", tmp_path / "hang.pids"
        script = f"import isolated_functions as f; f.load_and_wait({str(place)!r})"
        with subprocess.Popen([sys.executable, "-c", script], env=environment) as parent:
            assert soon(pids.exists)
            left = [int(pid) for pid in pids.read_text().split()]
            assert all(map(is_running, left))
            parent.kill()
        assert soon(lambda: not any(map(is_running, left)))
