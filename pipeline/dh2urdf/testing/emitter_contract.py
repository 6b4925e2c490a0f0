"""The contract of emitters."""

from __future__ import annotations

import json
import tomllib
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from dh2urdf.columns import RobotColumns
from dh2urdf.errors import Dh2UrdfError, EmitterError, InputError, PluginError
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.kinematics.proof import TOLERANCE
from dh2urdf.kinematics.proof_vectors import proof_vectors
from dh2urdf.manipulator import ROOT, TOOL
from dh2urdf.robot import Box, Link, Sphere, Visual
from dh2urdf.stages import EmittedFile, Emitter, Expansion
from dh2urdf.testing.oracle import difference, robot_pose
from dh2urdf.testing.reference import plain_robot, reference_manipulators
from dh2urdf.testing.stage_contract import StageContract, each, each_outcome

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.robot import Robot

STEM = "arm-7"
_AWKWARD = ("a<b&c>\"d'e", "--> ]]>", "${x} $(find y)", "{{ z }} {% w %}", "名前", "two words", "007", "%s\\n", "#;,|")
"""Names that the pipeline lets pass, and that mean something to one format or another."""


class EmitterContract(StageContract):
    """What holds for an emitter.

    Attributes:
        robots: the robots that it is tested with; by default the reference arms.
        stem: the stem that it is given.
    """

    kind = "emitter"
    stage: ClassVar[Emitter[Any]]
    robots: ClassVar[Sequence[Robot] | None] = None
    stem: ClassVar[str] = STEM

    # --- The clauses

    def test_files_have_plain_names_and_content(self) -> None:
        """It gives files: the stem and an ending of its record as names, content in bytes, the main file first."""
        for robot in self._robots():
            files = self._emit(robot)
            is_sequence = isinstance(files, (list, tuple))  # a generator could be gone through but once
            if not is_sequence or not files or not all(isinstance(file, EmittedFile) for file in files):
                self.breach(
                    self.test_files_have_plain_names_and_content,
                    found=f"{files!r:.200}",
                    accepted="a sequence of dh2urdf.stages.EmittedFile, at least one",
                    remedy="return [EmittedFile(name=f'{stem}.suffix', content=text.encode())]",
                )
            for file in files:
                is_plain = (Path(file.name).name == file.name) is not (self.stage.in_folders is not None)
                if not is_plain or not file.name.startswith(self.stem):
                    self.breach(
                        self.test_files_have_plain_names_and_content,
                        found=f"a file named {file.name!r} for the stem {self.stem!r}",
                        accepted=f"a name {'in' if self.stage.in_folders else 'without'} a folder that begins with "
                        "the stem",
                        remedy="make names of the stem that `emit` is given: the pipeline has made it safe and unique",
                    )
                if not isinstance(file.content, bytes):
                    self.breach(
                        self.test_files_have_plain_names_and_content,
                        found=f"{file.name} holds {type(file.content).__name__}",
                        accepted="bytes",
                        remedy="encode the text: content=text.encode()",
                    )
            if len({file.name.casefold() for file in files}) < len(files):
                self.breach(
                    self.test_files_have_plain_names_and_content,
                    found=f"the names {[file.name for file in files]}",
                    accepted="names that differ, also where upper and lower case are one",
                    remedy="give each file a name of its own",
                )
            if not self.stage.in_folders and not files[0].name.lower().endswith(self.stage.suffixes):
                self.breach(
                    self.test_files_have_plain_names_and_content,
                    found=f"the main file {files[0].name!r}",
                    accepted=f"a name that ends in {' or '.join(self.stage.suffixes) or 'a suffix of the record'}",
                    remedy="give the main file first, and list its suffix in the record",
                )
            declared = {ending.casefold() for ending in (*self.stage.suffixes, *self.stage.other_endings)}
            for file in () if self.stage.in_folders else files:
                if (ending := file.name[len(self.stem) :]).casefold() not in declared:
                    self.breach(
                        self.test_files_have_plain_names_and_content,
                        found=f"{file.name!r}, which has {ending!r} behind the stem",
                        accepted=f"a file with one of the endings {', '.join(sorted(declared)) or 'of the record'}",
                        remedy="list the ending in suffixes, or in other_endings if it is not that of the main file",
                    )

    def test_files_are_well_formed(self, tmp_path: Path) -> None:
        """Files can be read by programs that know their format, whatever links and joints are called."""
        for robot in (*self._robots(), *self._awkward()):
            try:
                files = self._emit(robot)
            except (EmitterError, PluginError):  # It may refuse what its format cannot hold.
                continue
            _write(tmp_path, files)
            for file in files:
                if fault := _fault(file):
                    self.breach(
                        self.test_files_are_well_formed,
                        found=f"{file.name} of the robot {robot.name!r}: {fault}",
                        accepted="a file that a parser of its format reads",
                        remedy="escape names as the format asks for, by a library that writes it; "
                        "raise EmitterError for a name that it cannot hold",
                    )

    def test_writes_nothing_itself(self) -> None:
        """It writes no file, starts no process and leaves nothing running: the pipeline writes what it gives."""
        clause = self.test_writes_nothing_itself
        seen = self.in_child(clause, each, self.stage.emit, self._robots(), self.stem, self.given())
        if seen.traces:
            self.breach(
                clause,
                found="; ".join(seen.traces),
                accepted="an emitter that only returns its files",
                remedy="return an EmittedFile for each file; the pipeline proves all of them and puts them in place",
            )

    def test_is_deterministic(self) -> None:
        """The same robot gives the same bytes, or the same refusal, in every process."""
        robots = (*self._robots(), *self._awkward())
        self.same_in_every_process(
            self.test_is_deterministic, each_outcome, self.stage.emit, robots, self.stem, self.given()
        )

    def test_keeps_its_input(self) -> None:
        """The robot is after the call as it was before."""
        for robot in self._robots():
            before = deepcopy(robot)
            self._emit(robot)
            self.unchanged(self.test_keeps_its_input, before, robot)

    def test_raises_documented_errors_only(self, tmp_path: Path) -> None:
        """A robot that it cannot write is an EmitterError; a file that it cannot read is an error of dh2urdf."""
        clause = self.test_raises_documented_errors_only
        for robot in self._awkward():
            try:
                self._emit(robot)
            except (EmitterError, PluginError):
                continue
            except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an author's code raises
                self.breach(
                    clause,
                    found=f"{type(error).__name__}: {error} at the robot {robot.name!r}",
                    accepted="dh2urdf.errors.EmitterError, MissingDependencyError or MissingProgramError",
                    remedy="raise EmitterError with a Problem that says what the format cannot hold",
                )
        path = tmp_path / f"broken{(self.stage.suffixes or ('',))[0]}"
        for content in (b"", b"\xff\xfe\x00 no text", b"<a><b></a>", b"[1, 2"):
            path.write_bytes(content)
            for reading, given in (
                (self.stage.read_back, ()),
                (self.stage.read_foreign, self._expansion),
                (self.stage.check, self._checked_with),
            ):
                try:
                    if reading is not None:
                        reading(path, *given)
                except Dh2UrdfError:
                    continue
                except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an author's code raises
                    name = getattr(reading, "__name__", reading)
                    self.breach(
                        clause,
                        found=f"{type(error).__name__}: {error} from {name}, of {content!r}",
                        accepted="dh2urdf.errors.InputError, or what is derived from it",
                        remedy="say with InputError and a Problem what is wrong with the file and where",
                    )

    @property
    def _expansion(self) -> tuple[Expansion, ...]:
        return (Expansion(),) if self.stage.expandable else ()

    @property
    def _checked_with(self) -> tuple[Expansion, ...]:
        return (Expansion(),) if self.stage.expandable or self.stage.finds_packages else ()

    def test_reads_back_the_same_arm(self, tmp_path: Path) -> None:
        """Where it reads its files back, T(q) is that of the robot, by code that the pipeline does not share."""
        clause = self.test_reads_back_the_same_arm
        if self.stage.read_back is None:
            return  # A format that holds no kinematics, such as a data sheet.
        for manipulator in reference_manipulators():
            robot, expected = plain_robot(manipulator), ExpectedPoses.of(manipulator)
            _write(tmp_path, files := self._emit(robot))
            if not files[0].is_robot:
                continue
            try:
                found = self.stage.read_back(tmp_path / files[0].name)
            except Dh2UrdfError as error:
                self.breach(
                    clause,
                    found=f"read_back refuses {files[0].name} of the robot {robot.name!r}: {error}",
                    accepted="a Robot",
                    remedy="let read_back read what emit writes",
                )
            for q in proof_vectors(expected, robot, 8):
                poses = [robot_pose(each, q, ROOT, TOOL) for each in (robot, found)]
                distance, angle = difference(*poses)
                if not (distance <= 3 * TOLERANCE and angle <= 3 * TOLERANCE):
                    self.breach(
                        clause,
                        found=f"tool0 of {robot.name!r} is off by {distance:.3g} m and {angle:.3g} rad at q = {q}",
                        accepted=f"{3 * TOLERANCE:g} m and rad",
                        remedy="write numbers with all their digits (repr), and read every joint's origin and axis",
                    )

    def test_finds_no_fault_in_its_own_files(self, tmp_path: Path) -> None:
        """Where it checks files, some consumer takes those that it writes without an error."""
        if self.stage.check is None:
            return  # `dh2urdf check` does not know the format.
        for robot in self._robots():
            files = self._emit(robot)
            _write(tmp_path, files)
            inspection = self.stage.check(tmp_path / files[0].name, *self._checked_with)
            errors = [finding for finding in inspection.findings if finding.severity == "error"]
            refusing = {effect.consumer for each in errors for effect in each.effects if effect.severity == "error"}
            if not all(each.effects for each in errors) or (errors and not set(inspection.consumers) - refusing):
                self.breach(
                    self.test_finds_no_fault_in_its_own_files,
                    found="; ".join(finding.message for finding in errors),
                    accepted="a consumer for which there are only warnings and notes",
                    remedy="fix emit or check: one of them is wrong",
                )

    def test_many_at_once_are_the_same(self) -> None:
        """Where it writes many robots at once, their files are byte by byte those that it writes one by one."""
        if self.stage.emit_columns is None:
            return  # It makes them one by one.
        columns = _columns(self._robots()[0])
        stems = [f"{self.stem}-{number}" for number in range(len(columns))]
        found = self.stage.emit_columns(columns, stems, self.given())
        for number, files in enumerate(found or ()):
            if files:  # It may leave out what it does not surely write so.
                alone = self.stage.emit(columns.pick(number), stems[number], self.given())
                self.same(self.test_many_at_once_are_the_same, list(files), list(alone))

    # --- What the clauses use

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
            renamed = {link.name: f"{link.name} {text}" for link in robot.links[1:-1]}
            yield replace(
                robot,
                name=text,
                links=tuple(replace(link, name=renamed.get(link.name, link.name)) for link in robot.links),
                joints=tuple(
                    replace(
                        joint,
                        name=f"{joint.name} {text}",
                        parent=renamed.get(joint.parent, joint.parent),
                        child=renamed.get(joint.child, joint.child),
                    )
                    for joint in robot.joints
                ),
            )
        shapes = (Visual(geometry=Box(size=(0.1, 0.2, 0.3))), Visual(geometry=Sphere(radius=0.05)))
        yield replace(robot, name="shapes", links=tuple(_with(link, shapes) for link in robot.links))
        yield replace(robot, name="bare", links=tuple(_with(link, ()) for link in robot.links))


def _write(folder: Path, files: Sequence[EmittedFile]) -> None:
    for file in files:
        (folder / file.name).parent.mkdir(parents=True, exist_ok=True)
        (folder / file.name).write_bytes(file.content)


def _with(link: Link, visuals: tuple[Visual, ...]) -> Link:
    return replace(link, visuals=visuals, collisions=()) if link.visuals else link


def _columns(robot: Robot) -> RobotColumns:
    """Three robots that differ in the height of the first joint."""
    import numpy as np

    first, *others = robot.joints
    x, y, z = first.origin.xyz
    height: Any = np.array([z, z + 0.125, z + 1 / 3])
    return RobotColumns(
        robot=replace(robot, joints=(replace(first, origin=replace(first.origin, xyz=(x, y, height))), *others)),
        names=(f"{robot.name}_1", f"{robot.name}_2", f"{robot.name}_3"),
        comments=("", "", ""),
        sure=np.ones(3, dtype=bool),
    )


def _fault(file: EmittedFile) -> str | None:
    """Why nobody can read a file; None where somebody can, or its format is not known here."""
    from xml.parsers.expat import ExpatError, ParserCreate

    suffix = Path(file.name).suffix.lower()
    try:
        if suffix in (".xml", ".urdf", ".xacro", ".srdf", ".sdf", ".mjcf", ".svg"):
            ParserCreate().Parse(file.content, True)
        elif suffix == ".json":
            json.loads(file.content)
        elif suffix == ".toml":
            tomllib.loads(file.content.decode())
        elif suffix in (".yaml", ".yml"):
            from dh2urdf.documents.document import load_yaml

            load_yaml(file.content.decode(), file.name)
        elif suffix in (".txt", ".md", ".csv", ".tsv", ".dot", ".gv", ".html", ".py"):
            file.content.decode()
    except (ExpatError, InputError, ValueError) as error:
        return str(error)
    return None
