"""The contract of loaders."""

from __future__ import annotations

import json
import pickle
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

from dh2urdf.errors import CrashError, LoaderError, PluginError
from dh2urdf.isolation.loads import KeptChildren, load_in_child
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.kinematics.proof_vectors import joint_vectors
from dh2urdf.measuring.opened_arm import load_function
from dh2urdf.plugin_system.catalog import load
from dh2urdf.source import Problem
from dh2urdf.stages import Emitter, Loader, LoadReport, LoadRequest, Reusable
from dh2urdf.testing.child import in_child
from dh2urdf.testing.comparing import difference
from dh2urdf.testing.oracle import table_pose
from dh2urdf.testing.reference import plain_robot, reference_manipulators
from dh2urdf.testing.stage_contract import StageContract, clause

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.testing.child import Seen
    from dh2urdf.testing.stage_contract import Found

ASIDE = 0.1
"""How far from where the robot is the contract asserts it to be, to see whether that is found [m]."""


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
        """It reports what the simulator has of the arm: its version, its joints, and where tool0 is at every pose."""
        request = self._request(tmp_path)
        report, moving = self._load(request), request.robot.moving_joints
        faults = {
            "simulator or version is empty": not (report.simulator and report.version),
            f"{report.poses} of {len(request.poses)} poses were measured": report.poses != len(request.poses),
            f"{len(report.joints)} of {len(moving)} moving joints": len(report.joints) != len(moving),
            "no position_error or tolerance": report.position_error is None or report.tolerance is None,
            f"position_error {report.position_error} m is beyond tolerance {report.tolerance} m": not (
                (report.position_error or 0.0) <= (report.tolerance or 0.0)
            ),
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
            report = self._load(replace(request, expected=aside))
            if report.position_error is None or report.position_error <= ASIDE / 2:
                error = report.position_error
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
        """When it returns, no process or window is left, and no file but the picture that it was asked for."""
        request = self._request(tmp_path)
        there = {*tmp_path.iterdir(), request.picture}
        left = self._seen(request).left
        yield from (*left, *(f"the file {path.name}" for path in sorted({*tmp_path.iterdir()} - there)))

    @clause
    def test_keeps_its_input(self, tmp_path: Path) -> Found:
        """The file and the request are after the call as they were before."""
        request = self._request(tmp_path)
        content = request.path.read_bytes()
        after = self._seen(request).value
        if differs := difference(request, after) or difference(content, request.path.read_bytes()):
            yield differs

    @clause
    def test_raises_documented_errors_only(self, tmp_path: Path) -> Found:
        """A file that the simulator does not take is a LoaderError; without the simulator it says what to install."""
        yield from self.refuses_with((PluginError,), self.stage.require, self.given())
        request = self._request(tmp_path)
        for name, content in {"an empty file": b"", "no such format": b"<a><b></a>"}.items():
            request.path.write_bytes(content)
            try:
                yield f"the report {self._load(request)!r:.80}, of {name}"
            except (LoaderError, CrashError) as error:
                if "raised" in str(error):
                    yield str(error)

    @clause
    def test_settings_follow_from_the_options(self, tmp_path: Path) -> Found:
        """Formats, poses, picture and time limit are what the record promises, and any output can be read."""
        options, stage, request = self.given(), self.stage, self._request(tmp_path)
        poses, picture, limit = stage.poses(options), stage.picture(options), stage.time_limit(options)
        outputs = ("", "b3Warning\n\0\x1b[1m " * 100, "Error: é 机\n")
        findings = [finding for output in outputs for finding in stage.read_output(request, output)]
        faults = {
            f"formats {stage.formats!r}": not stage.formats or isinstance(stage.formats, str),
            f"poses is {poses!r}, not a number from 1 on": not (isinstance(poses, int) and poses >= 1),
            f"picture is {picture!r}, not True or False": not isinstance(picture, bool),
            f"time_limit is {limit!r}, not seconds or None": not (limit is None or limit > 0),
            f"read_output gives {findings!r:.80}, not Problems": not all(isinstance(f, Problem) for f in findings),
        }
        yield from (fault for fault, is_there in faults.items() if is_there)

    def _load(self, request: LoadRequest, kept: KeptChildren | None = None) -> LoadReport:
        """The report, made in a child process as in a run: a kept one where some are given."""
        self.stage.require(self.given())
        return load_in_child(self.stage, request, self.given(), None, kept)

    def _seen(self, request: LoadRequest) -> Seen:
        self.stage.require(self.given())
        return in_child(_loaded, load_function(self.stage), request, self.given())

    def _request(self, folder: Path, manipulator: Manipulator | None = None) -> LoadRequest:
        """A written file of a reference arm, and where its tool0 is by the oracle's matrices."""
        manipulator = manipulator or reference_manipulators()[0]
        robot, expected, emitter = plain_robot(manipulator), ExpectedPoses.of(manipulator), self.emitter
        emitter = emitter or load().get("emitter", self.stage.formats[0])
        files = emitter.emit(robot, "arm", emitter.options())
        for file in files:
            (folder / file.name).write_bytes(file.content)
        poses = joint_vectors(expected, robot, self.stage.poses(self.given()))
        frames = tuple(tuple(number for row in table_pose(manipulator, q) for number in row) for q in poses)
        picture = folder / "arm.png" if self.stage.picture(self.given()) else None
        path = folder / files[0].name
        return LoadRequest(path=path, robot=robot, poses=poses, expected={"tool0": frames}, picture=picture)


def _loaded(load: Any, request: LoadRequest, options: Any) -> LoadRequest:  # noqa: ANN401 - the stage's own
    load(request, options)
    return request
