"""The contracts of loaders and executors: of the stages that work in processes of their own."""

from __future__ import annotations

import json
import os
import pickle
import signal
import threading
import time
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import count, islice
from operator import mul, truediv
from typing import TYPE_CHECKING, Any, ClassVar

from dh2urdf.conversion.loads import load_in_child
from dh2urdf.errors import CrashError, LoaderError, PluginError
from dh2urdf.isolation.kept_children import KeptChildren
from dh2urdf.kinematics.expected_poses import ExpectedPoses, joint_vectors
from dh2urdf.measuring import load_function
from dh2urdf.plugin_system.catalog import load
from dh2urdf.plugin_system.pools import results_of
from dh2urdf.source import Problem
from dh2urdf.stages import Emitter, Executor, Loader, LoadReport, LoadRequest, Lost, Reusable
from dh2urdf.testing.child import descendants, in_child
from dh2urdf.testing.oracle import table_pose
from dh2urdf.testing.reference import plain_robot, reference_manipulators
from dh2urdf.testing.stage_contract import MISSING, StageContract, clause, difference

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.testing.stage_contract import Found

ASIDE = 0.1
"""How far from where the robot is the contract asserts it to be, to see whether that is found [m]."""
TASKS = 40
AHEAD = 1000
"""Tasks that an executor may take before their results are asked for; a run may have a million."""
LEAVING = 10.0
"""How long workers may take to be gone [s]."""
DOUBLED = partial(mul, 2)
"""A function with data, as the pipeline's own is: a function that pickles is enough."""
_OUTPUTS = ("", "b3Warning\n\0\x1b[1m " * 100, "Error: é 机\n")


class LoaderContract(StageContract):
    """What holds for a loader. Where its simulator is not installed, the tests that need it are skipped.

    Attributes:
        emitter: what writes the files that it loads; by default the installed emitter of its preferred format.
    """

    kind = "loader"
    stage: ClassVar[Loader[Any]]
    emitter: ClassVar[Emitter[Any] | None] = None

    @clause
    def test_measures_the_arm(self, tmp_path: Path) -> Found:
        """Settings are sound; it reports the simulator's version, its joints, and where tool0 is at every pose."""
        options, stage, request = self.given(), self.stage, self._request(tmp_path)
        poses, picture, limit = stage.poses(options), stage.picture(options), stage.time_limit(options)
        told = [finding for output in _OUTPUTS for finding in stage.read_output(request, output)]
        settings = {
            f"formats {stage.formats!r}": not stage.formats or isinstance(stage.formats, str),
            f"poses is {poses!r}, not a number from 1 on": not (isinstance(poses, int) and poses >= 1),
            f"picture is {picture!r}, not True or False": not isinstance(picture, bool),
            f"time_limit is {limit!r}, not seconds or None": not (limit is None or limit > 0),
            f"read_output gives {told!r:.80}, not Problems": not all(isinstance(each, Problem) for each in told),
        }
        yield from (fault for fault, is_there in settings.items() if is_there)
        report, moving = self._load(request), request.robot.moving_joints
        error, tolerance = report.position_error, report.tolerance
        faults = {
            "simulator or version is empty": not (report.simulator and report.version),
            f"{report.poses} of {len(request.poses)} poses were measured": report.poses != len(request.poses),
            f"{len(report.joints)} of {len(moving)} moving joints": len(report.joints) != len(moving),
            "no position_error or tolerance": error is None or tolerance is None,
            f"position_error {error} m is beyond tolerance {tolerance} m": not ((error or 0.0) <= (tolerance or 0.0)),
        }
        errors = [f"an error: {problem}" for problem in report.findings if problem.severity == "error"]
        if found := [*errors, *(fault for fault, is_there in faults.items() if is_there)]:
            yield "; ".join(found)

    @clause
    def test_finds_another_arm(self, tmp_path: Path) -> Found:
        """It measures: an arm that is not where the request has it is reported."""
        request = self._request(tmp_path)
        aside = {
            link: tuple((*frame[:3], frame[3] + ASIDE, *frame[4:]) for frame in frames)
            for link, frames in request.expected.items()
        }
        with suppress(LoaderError, CrashError):
            error = self._load(replace(request, expected=aside)).position_error
            if error is None or error <= ASIDE / 2:
                yield f"position_error {error} m, of an arm expected {ASIDE} m beside where it is"

    @clause
    def test_report_is_plain_data(self, tmp_path: Path) -> Found:
        """The report is the same each time, can be pickled, and can be written as JSON."""
        request = self._request(tmp_path)
        first, second = (replace(self._load(request), output="") for _ in range(2))
        if differs := difference(first, second):
            yield differs
        json.dumps([first.joints, first.hold], allow_nan=False)
        pickle.dumps(first)

    @clause
    def test_reports_the_same_whatever_was_loaded_before(self, tmp_path: Path) -> Found:
        """If it has `prepare`, each report is the same after this import as in a process of its own."""
        alone = []
        for manipulator in reference_manipulators() if self.stage.can(Reusable) else ():
            (folder := tmp_path / manipulator.name).mkdir()
            with suppress(LoaderError, CrashError):  # It need not take every arm.
                alone.append((request := self._request(folder, manipulator), self._load(request)))
        with KeptChildren() as children:
            for request, report in (*alone, *alone[:1]):
                if differs := difference(report, self._load(request, children)):
                    yield f"of {request.robot.name!r}, alone and after `prepare`: {differs}"

    @clause
    def test_leaves_nothing_behind(self, tmp_path: Path) -> Found:
        """It leaves no process or window, no file but the picture that it was asked for, and its input as it was."""
        self.stage.require(self.given())
        request = self._request(tmp_path)
        content, there = request.path.read_bytes(), {*tmp_path.iterdir(), request.picture}
        after, _, left = in_child(_loaded, load_function(self.stage), request, self.given())
        yield from (*left, *(f"the file {path.name}" for path in sorted({*tmp_path.iterdir()} - there)))
        if differs := difference((content, request), (request.path.read_bytes(), after)):
            yield differs

    @clause
    def test_raises_documented_errors_only(self, tmp_path: Path) -> Found:
        """A file that the simulator does not take is a LoaderError; without the simulator it says what to install."""
        with suppress(PluginError):
            self.stage.require(self.given())
        request = self._request(tmp_path)
        for name, content in {"an empty file": b"", "no such format": b"<a><b></a>"}.items():
            request.path.write_bytes(content)
            try:
                yield f"the report {self._load(request)!r:.80}, of {name}"
            except (LoaderError, CrashError) as error:
                if "raised" in str(error):
                    yield str(error)

    def _load(self, request: LoadRequest, kept: KeptChildren | None = None) -> LoadReport:
        """The report, made in a child process as in a run: a kept one where some are given."""
        self.stage.require(self.given())
        return load_in_child(self.stage, request, self.given(), None, kept)

    def _request(self, folder: Path, manipulator: Manipulator | None = None) -> LoadRequest:
        """A written file of a reference arm, and where its tool0 is by the oracle's matrices."""
        manipulator = manipulator or reference_manipulators()[0]
        robot, expected, emitter = plain_robot(manipulator), ExpectedPoses.of(manipulator), self.emitter
        emitter = emitter or load().get("emitter", self.stage.formats[0])
        files = emitter.emit(robot, "arm", emitter.options())
        for file in files:
            (folder / file.name).write_bytes(file.content)
        poses = joint_vectors(expected, robot, self.stage.poses(self.given()))
        frames = tuple(tuple(table_pose(manipulator, q).ravel().tolist()) for q in poses)
        picture = folder / "arm.png" if self.stage.picture(self.given()) else None
        path = folder / files[0].name
        return LoadRequest(path=path, robot=robot, poses=poses, expected={"tool0": frames}, picture=picture)


def _loaded(load: Any, request: LoadRequest, options: Any) -> LoadRequest:  # noqa: ANN401 - the stage's own
    load(request, options)
    return request


class ExecutorContract(StageContract):
    """What holds for an executor."""

    kind = "executor"
    stage: ClassVar[Executor[Any]]

    @clause
    def test_results_come_in_order(self) -> Found:
        """Results come in the order of the tasks; what a task or their iterator raises, after the results before it."""

        def broken() -> Iterator[int]:
            yield from range(5)
            raise LookupError("the table ends here")

        doubles = [2 * task for task in range(TASKS)]
        for function, tasks, wanted, error in (
            (doubled_at_leisure, range(TASKS), doubles, None),
            (doubled_at_leisure, range(1), doubles[:1], None),
            (doubled_at_leisure, range(0), [], None),
            (partial(truediv, 1), [1, 2, 0, 4], [1.0, 0.5], ZeroDivisionError),
            (DOUBLED, broken(), doubles[:5], LookupError),
            (DOUBLED, range(TASKS), doubles, None),
        ):
            found, raised = [], None
            try:
                for result in self._map(function, tasks):
                    found.append(result)  # noqa: PERF402 - what came before the error is the fact
            except MISSING:
                raise
            except Exception as caught:  # noqa: BLE001 - whatever an author's code raises
                raised = caught
            if found != wanted or type(raised) is not (error or type(None)):
                yield f"{found}, and then {raised!r}, in place of {wanted}, and then {error and error.__name__}"

    @clause
    def test_takes_tasks_as_they_are_needed(self) -> Found:
        """Tasks without end give results: only a few are taken ahead."""
        taken = 0

        def endless() -> Iterator[int]:
            nonlocal taken
            for taken in count(1):
                if taken > 10 * AHEAD:
                    return
                yield taken

        results = self._map(DOUBLED, endless())
        first = list(islice(results, TASKS))
        results.close()
        if first != [2 * task for task in range(1, TASKS + 1)] or taken > AHEAD + TASKS:
            yield f"{taken} tasks were taken before {len(first)} results were asked for"

    @clause
    def test_a_worker_that_ends_costs_one_task(self) -> Found:
        """A task that ends its worker's process gives Lost in its place, and all others have their results."""
        if os.getpid() in list(self._map(process_of, range(8))):
            return  # It works in this process, which no task may end.
        tasks = [*range(1, 9), -1, *range(9, 17)]
        found = list(self._map(doubled_or_killed, tasks))
        if [isinstance(each, Lost) or each for each in found] != [task < 0 or 2 * task for task in tasks]:
            yield f"{found}"

    @clause
    def test_leaves_nothing_behind(self) -> Found:
        """When all results are there, or are not wanted any more, its processes and threads are gone."""
        threads, processes = set(threading.enumerate()), set(descendants())
        for wanted in (TASKS, 3):
            results = self._map(DOUBLED, range(TASKS))
            list(islice(results, wanted))
            results.close()
            patience = time.monotonic() + LEAVING
            while left := _left(threads, processes):
                if time.monotonic() > patience:
                    yield f"after {wanted} of {TASKS} results there were still {', '.join(left)}"
                time.sleep(0.05)

    def _map(self, function: Callable[[Any], Any], tasks: Iterable[Any]) -> Generator[Any, None, None]:
        """The results; whatever goes wrong is raised where the first of them is asked for."""
        self.stage.require(self.given())
        yield from results_of(self.stage, function, tasks, self.given())


def _left(threads: set[threading.Thread], processes: set[int]) -> list[str]:
    """What was started since and would keep the program from ending: processes, and threads that are no daemons."""
    running = [thread for thread in threading.enumerate() if thread not in threads and not thread.daemon]
    others = [command for number, command in descendants().items() if number not in processes]
    return [*others, *(f"the thread {thread.name}" for thread in running)]


# --- What workers do: every one of them can import this module


def doubled_at_leisure(number: int) -> int:
    """Twice a number; every fourth takes longer than those after it."""
    time.sleep(0.0 if number % 4 else 0.03)
    return 2 * number


def process_of(_task: object) -> int:
    """The process that does the task."""
    return os.getpid()


def doubled_or_killed(number: int) -> int:
    """Twice a number; a negative one ends the process that works at it."""
    if number < 0:
        os.kill(os.getpid(), signal.SIGKILL)
    return 2 * number
