"""The contract of loaders."""

from __future__ import annotations

import json
import pickle
from contextlib import suppress
from copy import deepcopy
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import pytest

from dh2urdf.errors import CrashError, LoaderError, PluginError, UnknownStageError
from dh2urdf.isolation.loads import KeptChildren, load_in_child
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.kinematics.proof_vectors import joint_vectors
from dh2urdf.measuring.opened_arm import load_function
from dh2urdf.plugin_system.catalog import load
from dh2urdf.source import Problem
from dh2urdf.stages import Emitter, Loader, LoadReport, LoadRequest
from dh2urdf.testing.comparing import difference
from dh2urdf.testing.oracle import table_pose
from dh2urdf.testing.reference import plain_robot, reference_manipulators
from dh2urdf.testing.stage_contract import StageContract

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Robot

    Children = KeptChildren | None

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

    # --- The clauses

    def test_measures_the_arm(self, tmp_path: Path) -> None:
        """It reports what the simulator has of the arm: its version, its joints, and where tool0 is at every pose."""
        clause, request = self.test_measures_the_arm, self._request(tmp_path)
        report = self._load(clause, request)
        if not isinstance(report, LoadReport):
            self.breach(
                clause,
                found=f"{type(report).__name__} {report!r:.80}",
                accepted="a dh2urdf.stages.LoadReport",
                remedy="return LoadReport(simulator=…, version=…, …)",
            )
        errors = [str(problem) for problem in report.findings if problem.severity == "error"]
        faults = {
            "simulator or version is empty": not (report.simulator and report.version),
            f"{report.poses} of {len(request.poses)} poses were measured": report.poses != len(request.poses),
            f"an error in its findings: {'; '.join(errors)}": bool(errors),
            f"{len(report.joints)} of {len(request.robot.moving_joints)} moving joints": len(report.joints)
            != len(request.robot.moving_joints),
            "no position_error or tolerance": report.position_error is None or report.tolerance is None,
        }
        if report.position_error is not None and report.tolerance is not None:
            beyond = f"position_error {report.position_error:.3g} m is beyond tolerance {report.tolerance:.3g} m"
            faults[beyond] = not report.position_error <= report.tolerance
        self._no_faults(clause, faults)

    def test_finds_another_arm(self, tmp_path: Path) -> None:
        """It measures: an arm that is not where the request has it is reported."""
        clause, request = self.test_finds_another_arm, self._request(tmp_path)
        aside = {
            link: tuple((*frame[:3], frame[3] + ASIDE, *frame[4:]) for frame in frames)
            for link, frames in request.expected.items()
        }
        try:
            report = self._load(clause, replace(request, expected=aside), refusal=True)
        except (LoaderError, CrashError):
            return
        if report.position_error is not None and report.position_error > ASIDE / 2:
            return
        self.breach(
            clause,
            found=f"position_error {report.position_error} m, of an arm expected {ASIDE} m beside where it is",
            accepted="a LoaderError, or a position_error that says how far it is",
            remedy="set the joints to each of request.poses in the simulator, ask it for the pose of every link of "
            "request.expected, and compare",
        )

    def test_report_is_plain_data(self, tmp_path: Path) -> None:
        """The report is the same each time, can be pickled, and can be written as JSON."""
        clause, request = self.test_report_is_plain_data, self._request(tmp_path)
        first, second = (self._load(clause, request) for _ in range(2))
        self.same(clause, replace(first, output=""), replace(second, output=""))
        try:
            json.dumps([first.joints, first.hold], allow_nan=False)
            pickle.dumps(first)
        except (TypeError, ValueError, pickle.PicklingError, AttributeError) as error:
            self.breach(
                clause,
                found=f"{type(error).__name__}: {error}",
                accepted="texts, finite floats, and tuples and mappings of them",
                remedy="convert what the simulator gives: float(x), str(name), tuple(map(float, array))",
            )

    def test_reports_the_same_whatever_was_loaded_before(self, tmp_path: Path) -> None:
        """If it has `prepare`, one process loads many files: each report is that of a process of its own."""
        clause = self.test_reports_the_same_whatever_was_loaded_before
        if self.stage.prepare is None:
            return
        alone = []
        for manipulator in reference_manipulators():
            (folder := tmp_path / manipulator.name).mkdir()
            with suppress(LoaderError, CrashError):  # It need not take every arm.
                request = self._request(folder, manipulator)
                alone.append((request, self._load(clause, request, refusal=True)))
        with KeptChildren() as children:
            for request, report in (*alone, *reversed(alone), *alone[:1] * 3):
                if differs := difference(report, self._load(clause, request, kept=children)):
                    self.breach(
                        clause,
                        found=f"of {request.robot.name!r}, alone and after others: {differs}",
                        accepted="the same report of a file, whatever was loaded before in the same process",
                        remedy="close what `load` opens, and keep nothing; or leave `prepare` out of the record",
                    )

    def test_leaves_nothing_behind(self, tmp_path: Path) -> None:
        """When it returns, no process or window is left, and no file but the picture that it was asked for."""
        clause, request = self.test_leaves_nothing_behind, self._request(tmp_path)
        there = {path.name for path in tmp_path.iterdir()}
        self._require()
        try:
            seen = self.in_child(clause, _load, load_function(self.stage), request, self.given())
        except PluginError as error:
            pytest.skip(str(error))
        new = sorted(
            {path.name for path in tmp_path.iterdir()} - there - ({request.picture.name} if request.picture else set())
        )
        left = [*seen.left, *(f"the file {name}" for name in new)]
        if left:
            self.breach(
                clause,
                found=", ".join(left),
                accepted="nothing",
                remedy="end the simulator, and whatever was started, in a `finally`; a window is a process's, too",
            )

    def test_keeps_its_input(self, tmp_path: Path) -> None:
        """The file and the request are after the call as they were before."""
        clause, request = self.test_keeps_its_input, self._request(tmp_path)
        before, content = deepcopy(request), request.path.read_bytes()
        self._require()
        try:
            seen = self.in_child(clause, _load_and_return, load_function(self.stage), request, self.given())
        except PluginError as error:
            pytest.skip(str(error))
        self.unchanged(clause, before, seen.value)
        self.unchanged(clause, content, request.path.read_bytes())

    def test_raises_documented_errors_only(self, tmp_path: Path) -> None:
        """A file that the simulator does not take is a LoaderError; without the simulator it says what to install."""
        clause, request = self.test_raises_documented_errors_only, self._request(tmp_path)
        try:
            self.stage.require(self.given())
        except PluginError as error:
            pytest.skip(str(error))
        except Exception as error:  # noqa: BLE001 - whatever an author's code raises
            self.breach(
                clause,
                found=f"{type(error).__name__}: {error} from `require`",
                accepted="dh2urdf.errors.MissingDependencyError or MissingProgramError",
                remedy="look with importlib.util.find_spec or shutil.which, and raise one of these",
            )
        for name, content in {"an empty file": b"", "no such format": b"<a><b></a>"}.items():
            request.path.write_bytes(content)
            try:
                self._load(clause, request, refusal=True)
            except (LoaderError, CrashError):
                continue
            self.breach(
                clause,
                found=f"a report, of {name}",
                accepted="a LoaderError: the simulator cannot have an arm of it",
                remedy="check what the simulator returns: many return a number below 0, or nothing, and go on",
            )

    def test_settings_follow_from_the_options(self, tmp_path: Path) -> None:
        """Formats, poses, picture and time limit are what the record promises, and any output can be read."""
        clause, options, stage = self.test_settings_follow_from_the_options, self.given(), self.stage
        poses, picture, limit = stage.poses(options), stage.picture(options), stage.time_limit(options)
        request = self._request(tmp_path)
        outputs = ("", "b3Warning\n\0\x1b[1m " * 100, "Error: é 机\n")
        findings = [finding for output in outputs for finding in stage.read_output(request, output)]
        self._no_faults(
            clause,
            {
                f"formats {stage.formats!r}": not stage.formats or isinstance(stage.formats, str),
                f"poses gives {poses!r}, not a number from 1 on": not (isinstance(poses, int) and poses >= 1),
                f"picture gives {picture!r}, not True or False": not isinstance(picture, bool),
                f"time_limit gives {limit!r}, not seconds or None": not (limit is None or limit > 0),
                f"read_output gives {findings!r:.80}, not Problems": not all(isinstance(f, Problem) for f in findings),
            },
        )

    # --- What the clauses use

    def _no_faults(self, clause: Callable[..., Any], faults: dict[str, bool]) -> None:
        if found := [fault for fault, is_there in faults.items() if is_there]:
            self.breach(
                clause,
                found="; ".join(found),
                accepted="what dh2urdf.stages documents for Loader and LoadReport",
                remedy="compare the record and the report with the docstrings of dh2urdf.stages",
            )

    def _require(self) -> None:
        try:
            self.stage.require(self.given())
        except PluginError as error:
            pytest.skip(str(error))

    def _load(
        self, clause: Callable[..., Any], request: LoadRequest, kept: Children = None, *, refusal: bool = False
    ) -> LoadReport:
        """The report, made in a child process as in a run: a kept one where some are given."""
        self._require()
        try:
            return load_in_child(self.stage, request, self.given(), None, kept)
        except PluginError as error:
            pytest.skip(str(error))
        except (LoaderError, CrashError) as error:
            if refusal and "raised" not in str(error):
                raise
            found = str(error)
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an author's code raises
            found = f"{type(error).__name__}: {error}"
        return self.breach(
            clause,
            found=found,
            accepted="a report of a good file; a LoaderError of any other",
            remedy="let `load` be at the top level of an importable module, and raise LoaderError with a Problem "
            "where the simulator refuses the file",
        )

    def _request(self, folder: Path, manipulator: Manipulator | None = None) -> LoadRequest:
        """A written file of a reference arm, and where its tool0 is by the oracle's matrices."""
        manipulator = manipulator or reference_manipulators()[0]
        robot, expected = plain_robot(manipulator), ExpectedPoses.of(manipulator)
        path = self._written(robot, folder)
        poses = joint_vectors(expected, robot, self.stage.poses(self.given()))
        frames = tuple(tuple(number for row in table_pose(manipulator, q) for number in row) for q in poses)
        picture = folder / f"{path.name.partition('.')[0]}.png" if self.stage.picture(self.given()) else None
        return LoadRequest(path=path, robot=robot, poses=poses, expected={"tool0": frames}, picture=picture)

    def _written(self, robot: Robot, folder: Path) -> Path:
        emitter = self.emitter
        try:
            emitter = emitter or load().get("emitter", self.stage.formats[0])
        except (UnknownStageError, IndexError) as error:
            self.breach(
                self.test_settings_follow_from_the_options,
                found=f"formats {self.stage.formats!r}: {error}",
                accepted="names of emitters, the preferred one first",
                remedy="install the plugin with the emitter, or set `emitter` of the test to it",
            )
        files = emitter.emit(robot, "arm", emitter.options())
        for file in files:
            (folder / file.name).write_bytes(file.content)
        return folder / files[0].name


def _load(load: Callable[[LoadRequest, Any], LoadReport], request: LoadRequest, options: Any) -> None:  # noqa: ANN401 - the stage's own
    load(request, options)


def _load_and_return(
    load: Callable[[LoadRequest, Any], LoadReport],
    request: LoadRequest,
    options: Any,  # noqa: ANN401 - the stage's own
) -> LoadRequest:
    load(request, options)
    return request
