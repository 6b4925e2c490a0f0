"""The contract of emitters."""

from __future__ import annotations

import json
import tomllib
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from dh2urdf.columns import RobotColumns
from dh2urdf.documents.document import load_yaml
from dh2urdf.errors import Dh2UrdfError, EmitterError
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.kinematics.proof import TOLERANCE
from dh2urdf.kinematics.proof_vectors import proof_vectors
from dh2urdf.manipulator import ROOT, TOOL
from dh2urdf.robot import Box, Sphere, Visual
from dh2urdf.stages import (
    Checks,
    EmitsInColumns,
    EmittedFile,
    Emitter,
    Expansion,
    ReadsBack,
    ReadsForeign,
    WritesFolders,
)
from dh2urdf.testing.child import in_child
from dh2urdf.testing.comparing import difference
from dh2urdf.testing.oracle import gap, robot_pose
from dh2urdf.testing.reference import plain_robot, reference_manipulators
from dh2urdf.testing.stage_contract import StageContract, changed_by, clause, results

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.robot import Robot
    from dh2urdf.testing.stage_contract import Found

_AWKWARD = ("a<b&c>\"d'e", "--> ]]>", "${x} $(find y)", "{{ z }} {% w %}", "名前", "two words", "007", "%s\\n", "#;,|")
"""Names that the pipeline lets pass, and that mean something to one format or another."""
_UNREADABLE = (b"", b"\xff\xfe\x00 no text", b"<a><b></a>", b"[1, 2")
_XML = (".xml", ".urdf", ".xacro", ".srdf", ".sdf", ".mjcf", ".svg")
_TEXTS = (".txt", ".md", ".csv", ".tsv", ".dot", ".gv", ".html", ".py")


class EmitterContract(StageContract):
    """What holds for an emitter.

    Attributes:
        robots: the robots that it is tested with; by default the reference arms.
        stem: the stem that it is given.
    """

    kind = "emitter"
    stage: ClassVar[Emitter[Any]]
    robots: ClassVar[Sequence[Robot] | None] = None
    stem: ClassVar[str] = "arm-7"

    @clause
    def test_files_have_plain_names_and_content(self) -> Found:
        """It gives files: the stem and an ending of its record as names, content in bytes, the main file first."""
        in_folders = self.stage.can(WritesFolders) is not None
        endings = {ending.casefold() for ending in self.stage.endings}
        for files in map(self._emit, self._robots()):
            # A generator could be gone through but once.
            if not isinstance(files, (list, tuple)) or not all(isinstance(file, EmittedFile) for file in files):
                yield f"{files!r:.200}"
            for file in files:
                if (Path(file.name).name == file.name) is in_folders or not file.name.startswith(self.stem):
                    yield f"a file named {file.name!r} for the stem {self.stem!r}"
                if not isinstance(file.content, bytes):
                    yield f"{file.name} holds {type(file.content).__name__}"
                if not in_folders and (ending := file.name[len(self.stem) :]).casefold() not in endings:
                    yield f"{file.name!r}, which has {ending!r} behind the stem; the record has {sorted(endings)}"
            if not files or len({file.name.casefold() for file in files}) < len(files):
                yield f"the names {[file.name for file in files]}"
            if not in_folders and not files[0].name.lower().endswith(self.stage.suffixes):
                yield f"the main file {files[0].name!r}"

    @clause
    def test_files_are_well_formed(self) -> Found:
        """Files can be read by programs that know their format, whatever links and joints are called."""
        for robot in (*self._robots(), *self._awkward()):
            try:
                files = self._emit(robot)
            except EmitterError:  # It may refuse what its format cannot hold.
                continue
            for file in files:
                try:
                    _parse(Path(file.name).suffix.lower(), file)
                except Exception as error:  # noqa: BLE001 - of any parser
                    yield f"{file.name} of the robot {robot.name!r}: {error}"

    @clause
    def test_writes_nothing_itself(self) -> Found:
        """It writes no file, starts no process and leaves nothing running: the pipeline writes what it gives."""
        seen = in_child(results, self.stage.emit, self._robots(), self.stem, self.given())
        yield from (*seen.deeds, *(f"left {each}" for each in seen.left))

    @clause
    def test_is_deterministic(self) -> Found:
        """The same robot gives the same bytes, or the same refusal, in every process."""
        robots = (*self._robots(), *self._awkward())
        yield from self.same_in_every_process(self.stage.emit, robots, self.stem, self.given())

    @clause
    def test_keeps_its_input(self) -> Found:
        """The robot is after the call as it was before."""
        yield from changed_by(self.stage.emit, self._robots(), self.stem, self.given())

    @clause
    def test_raises_documented_errors_only(self, tmp_path: Path) -> Found:
        """A robot that it cannot write is an EmitterError; a file that it cannot read is an error of dh2urdf."""
        for robot in self._awkward():
            yield from self.refuses_with((EmitterError,), self._emit, robot)
        path = tmp_path / f"broken{(*self.stage.suffixes, '')[0]}"
        back, foreign, checks = self.stage.can(ReadsBack), self.stage.can(ReadsForeign), self.stage.can(Checks)
        readings: list[Callable[..., Any]] = [back.read_back] if back else []
        readings += [lambda path: foreign.read_foreign(path, Expansion())] if foreign else []
        readings += [lambda path: checks.check(path, Expansion())] if checks else []
        for content in _UNREADABLE:
            path.write_bytes(content)
            for reading in readings:
                for found in self.refuses_with((Dh2UrdfError,), reading, path):
                    yield f"{found}, of a file with {content!r}"

    @clause
    def test_reads_back_the_same_arm(self, tmp_path: Path) -> Found:
        """Where it reads its files back, T(q) is that of the robot, by code that the pipeline does not share."""
        if not (reads := self.stage.can(ReadsBack)):
            return  # A format that holds no kinematics, such as a data sheet.
        for manipulator in reference_manipulators():
            robot, expected = plain_robot(manipulator), ExpectedPoses.of(manipulator)
            path = _write(tmp_path, files := self._emit(robot))
            found = reads.read_back(path) if files[0].is_robot else robot
            for q in proof_vectors(expected, robot, 8):
                distance, angle = gap(*[robot_pose(each, q, ROOT, TOOL) for each in (robot, found)])
                if not (distance <= 3 * TOLERANCE and angle <= 3 * TOLERANCE):
                    yield f"tool0 of {robot.name!r} is off by {distance:.3g} m and {angle:.3g} rad at q = {q}"

    @clause
    def test_finds_no_fault_in_its_own_files(self, tmp_path: Path) -> Found:
        """Where it checks files, some consumer takes those that it writes without an error."""
        checks = self.stage.can(Checks)
        for robot in self._robots() if checks else ():
            inspection = checks.check(_write(tmp_path, self._emit(robot)), Expansion())  # type: ignore[union-attr]
            errors = [finding for finding in inspection.findings if finding.severity == "error"]
            refusing = {effect.consumer for each in errors for effect in each.effects if effect.severity == "error"}
            if not all(each.effects for each in errors) or (errors and not set(inspection.consumers) - refusing):
                yield "; ".join(finding.message for finding in errors)

    @clause
    def test_many_at_once_are_the_same(self) -> Found:
        """Where it writes many robots at once, their files are byte by byte those that it writes one by one."""
        if not (emits := self.stage.can(EmitsInColumns)):
            return  # It makes them one by one.
        columns = _columns(self._robots()[0])
        stems = [f"{self.stem}-{number}" for number in range(len(columns))]
        for number, files in enumerate(emits.emit_columns(columns, stems, self.given()) or ()):
            alone = self.stage.emit(columns.pick(number), stems[number], self.given())
            if files and (differs := difference(list(files), list(alone))):  # It may leave out what is not sure.
                yield differs

    @classmethod
    def _robots(cls) -> tuple[Robot, ...]:
        # Copies: an emitter that changes its input would be given what it has changed before.
        return tuple(deepcopy(cls.robots) if cls.robots is not None else map(plain_robot, reference_manipulators()))

    def _emit(self, robot: Robot) -> Sequence[EmittedFile]:
        return self.stage.emit(robot, self.stem, self.given())

    def _awkward(self) -> Iterator[Robot]:
        """Robots that the pipeline lets pass and that an emitter may stumble over."""
        robot = self._robots()[0]
        for text in _AWKWARD:
            names = {link.name: f"{link.name} {text}" for link in robot.links[1:-1]}
            links = [replace(link, name=names.get(link.name, link.name)) for link in robot.links]
            joints = [
                replace(each, name=f"{each.name} {text}", parent=names.get(each.parent, each.parent),
                        child=names.get(each.child, each.child))
                for each in robot.joints
            ]  # fmt: skip
            yield replace(robot, name=text, links=tuple(links), joints=tuple(joints))
        shapes = (Visual(geometry=Box(size=(0.1, 0.2, 0.3))), Visual(geometry=Sphere(radius=0.05)))
        for name, visuals in {"shapes": shapes, "bare": ()}.items():
            links = [replace(each, visuals=visuals, collisions=()) if each.visuals else each for each in robot.links]
            yield replace(robot, name=name, links=tuple(links))


def _write(folder: Path, files: Sequence[EmittedFile]) -> Path:
    """Write files; the path of the main one."""
    for file in files:
        (folder / file.name).parent.mkdir(parents=True, exist_ok=True)
        (folder / file.name).write_bytes(file.content)
    return folder / files[0].name


def _columns(robot: Robot) -> RobotColumns:
    """Three robots that differ in the height of the first joint."""
    import numpy as np

    first, *others = robot.joints
    x, y, z = first.origin.xyz
    height: Any = np.array([z, z + 0.125, z + 1 / 3])
    joints = (replace(first, origin=replace(first.origin, xyz=(x, y, height))), *others)
    names = tuple(f"{robot.name}_{number}" for number in (1, 2, 3))
    return RobotColumns(
        robot=replace(robot, joints=joints), names=names, comments=("",) * 3, sure=np.ones(3, dtype=bool)
    )


def _parse(suffix: str, file: EmittedFile) -> None:
    """Parse a file; one whose format is not known here passes."""
    from xml.parsers.expat import ParserCreate

    if suffix in _XML:
        ParserCreate().Parse(file.content, True)
    elif suffix == ".json":
        json.loads(file.content)
    elif suffix == ".toml":
        tomllib.loads(file.content.decode())
    elif suffix in (".yaml", ".yml"):
        load_yaml(file.content.decode(), file.name)
    elif suffix in _TEXTS:
        file.content.decode()
