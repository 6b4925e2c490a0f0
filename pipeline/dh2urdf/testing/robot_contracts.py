"""The contracts of transforms, edits and emitters: of the stages that make, change and write robots."""

from __future__ import annotations

import json
import tomllib
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar
from xml.parsers.expat import ParserCreate

from dh2urdf import stages
from dh2urdf.columns import RobotColumns, in_columns, member, stacked
from dh2urdf.conversion.robots import with_masses
from dh2urdf.documents.document import load_yaml
from dh2urdf.errors import Dh2UrdfError, EditError, EmitterError, TransformError
from dh2urdf.fields import replace_unchecked
from dh2urdf.kinematics.expected_poses import ExpectedPoses, proof_vectors
from dh2urdf.kinematics.proof import TOLERANCE, prove
from dh2urdf.manipulator import ROOT, TOOL, DHRow, JointType, Limits, Manipulator
from dh2urdf.plugin_system.calls import a_record, emitted_files
from dh2urdf.robot import Box, Robot, Sphere, Visual
from dh2urdf.robot_check import check_robot
from dh2urdf.rotations import DividedError
from dh2urdf.testing.oracle import gap, robot_pose, table_pose
from dh2urdf.testing.reference import plain_robot, reference_manipulators
from dh2urdf.testing.stage_contract import Calls, InputContract, clause, difference

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.stages import Edit, Emitter, Transform
    from dh2urdf.testing.oracle import Matrix
    from dh2urdf.testing.stage_contract import Found

POSES = 16
"""Random joint vectors of a comparison, besides zero and both ends of the limits."""
_AWKWARD = ("a<b&c>\"d'e", "--> ]]>", "${x} $(find y)", "{{ z }} {% w %}", "名前", "two words", "007", "%s\\n", "#;,|")
"""Names that the pipeline lets pass, and that mean something to one format or another."""
_UNREADABLE = (b"", b"\xff\xfe\x00 no text", b"<a><b></a>", b"[1, 2")


_PARSERS: dict[str, Callable[[bytes, str], object]] = {
    **dict.fromkeys(
        (".xml", ".urdf", ".xacro", ".srdf", ".sdf", ".mjcf", ".svg"),
        lambda content, _: ParserCreate().Parse(content, True),
    ),
    ".json": lambda content, _: json.loads(content),
    ".toml": lambda content, _: tomllib.loads(content.decode()),
    **dict.fromkeys((".yaml", ".yml"), lambda content, name: load_yaml(content.decode(), name)),
    **dict.fromkeys(
        (".txt", ".md", ".csv", ".tsv", ".dot", ".gv", ".html", ".py"), lambda content, _: content.decode()
    ),
}


class _ArmContract(InputContract):
    """What holds for a transform or an edit: the reference arms are its input."""

    manipulators: ClassVar[Sequence[Manipulator] | None] = None

    @classmethod
    def arms(cls) -> list[Manipulator]:
        """Copies of the arms: a stage may change what it is given."""
        return list(deepcopy(cls.manipulators) if cls.manipulators is not None else reference_manipulators())


class TransformContract(_ArmContract):
    """What holds for a transform.

    Attributes:
        manipulators: the arms that it is tested with, none of which it refuses; by default the reference arms.
    """

    kind = "transform"
    stage: ClassVar[Transform[Any]]

    def calls(self, folder: Path) -> Iterator[Calls]:  # noqa: ARG002 - no files are needed
        """Making robots of the arms; arms that cannot be made."""
        yield Calls(self.stage.transform, (self.given(),), self.arms(), list(impossible()), (TransformError,))

    @clause
    def test_makes_robots_that_readers_take(self) -> Found:
        """It makes a Robot of every arm, and the robot breaks no rule that readers of descriptions rely on."""
        for manipulator in self.arms():
            yield from _broken_rules(a_record(self.stage.transform(manipulator, self.given()), Robot))

    @clause
    def test_keeps_the_kinematics(self) -> Found:
        """Where the record claims it, T(base_link → tool0) of the robot is the DH product, computed in two ways."""
        for manipulator in self.arms() if self.stage.keeps_kinematics(self.given()) else ():
            robot, expected = self.stage.transform(manipulator, self.given()), ExpectedPoses.of(manipulator)
            poses = proof_vectors(expected, robot, POSES)
            if not (proof := prove(expected, robot, poses)).holds:
                yield f"tool0 of {manipulator.name!r} is off by {proof.position_error:.3g} m at q = {proof.q}"
            yield from _off(manipulator, robot, poses)

    @clause
    def test_many_at_once_are_the_same(self) -> Found:
        """Where it makes many robots at once, their numbers are to the last bit those that it makes one by one."""
        if not (its := self.stage.can(stages.TransformsInColumns)):
            return
        for manipulator in self.arms():
            ((_, columns),) = in_columns(stretched(manipulator))
            for places, robots in its.transform_columns(columns, self.given()) or ():
                for number, place in enumerate(places):
                    alone = self.stage.transform(columns.pick(place), self.given())
                    # What is not sure is made one by one.
                    if robots.sure[number] and (differs := difference(robots.pick(number), alone, whole=False)):
                        yield differs


class EditContract(_ArmContract):
    """What holds for an edit of tables, of robots, or of both.

    Attributes:
        manipulators: the arms that it is tested with, none of which it refuses; by default the reference arms. An edit
            of robots is tested with the plainest robot of each.
    """

    kind = "edit"
    stage: ClassVar[Edit[Any]]

    @classmethod
    def arms(cls) -> list[Manipulator]:
        """Copies of the arms, with masses where the edit needs these."""
        arms = super().arms()
        return [with_masses(arm, plain_robot(arm)) for arm in arms] if cls.stage.can(stages.NeedsMasses) else arms

    def calls(self, folder: Path) -> Iterator[Calls]:  # noqa: ARG002 - no files are needed
        """Editing tables, and arms that cannot be made; editing robots."""
        for function, items in self._work(self.arms()):
            odd = list(impossible()) if function is self.stage.edit_table else []
            yield Calls(function, (self.given(),), items, odd, (EditError,))

    @clause
    def test_returns_what_it_was_given(self) -> Found:
        """It makes a Manipulator of every Manipulator, and a Robot of every Robot, with the same name."""
        for function, items in self._work(self.arms()):
            for item in items:
                found = a_record(function(item, self.given()), type(item))
                if found.name != item.name:
                    yield f"the name {found.name!r} for the {type(item).__name__} {item.name!r}"

    @clause
    def test_robots_stay_what_readers_take(self) -> Found:
        """A robot that breaks no rule breaks none after the edit."""
        for _, robot in map(self._edited, self.arms()):
            yield from _broken_rules(robot)

    @clause
    def test_keeps_the_kinematics(self) -> Found:
        """Where the record claims it, T(base_link → tool0) after the edit of the robot is the table's DH product."""
        if self.stage.edit_robot is None or not self.stage.keeps_kinematics(self.given()):
            return  # The edited table is the truth; or the proof reports the difference, and fails nothing.
        for table, robot in map(self._edited, self.arms()):
            yield from _off(table, robot, proof_vectors(ExpectedPoses.of(table), plain_robot(table), POSES))

    @clause
    def test_many_at_once_are_the_same(self) -> Found:
        """Where it accepts columns, it makes of many arms at once, to the last bit, what it makes of each alone."""
        for manipulator in self.arms() if self.stage.can(stages.EditsInColumns) else ():
            for function, arms in self._work(stretched(manipulator)):
                try:
                    many = function(stacked(arms), self.given())
                except DividedError:
                    continue  # The run makes groups of them that go the same way.
                for number, arm in enumerate(arms):
                    alone = function(arm, self.given())
                    one = replace_unchecked(member(many, number), name=alone.name)
                    if differs := difference(one, alone, whole=False):
                        yield differs

    def _work(self, arms: Sequence[Manipulator]) -> Iterator[tuple[Callable[[Any, Any], Any], list[Any]]]:
        """The functions of the edit, each with what it is tested with."""
        if self.stage.edit_table is not None:
            yield self.stage.edit_table, [*arms]
        if self.stage.edit_robot is not None:
            yield self.stage.edit_robot, [plain_robot(self._edited(each)[0]) for each in arms]

    def _edited(self, table: Manipulator) -> tuple[Manipulator, Robot]:
        if self.stage.edit_table is not None:
            table = self.stage.edit_table(table, self.given())
        robot = plain_robot(table)
        return table, self.stage.edit_robot(robot, self.given()) if self.stage.edit_robot else robot


class EmitterContract(InputContract):
    """What holds for an emitter.

    Attributes:
        robots: the robots that it is tested with; by default the reference arms.
        stem: the stem that it is given.
    """

    kind = "emitter"
    stage: ClassVar[Emitter[Any]]
    robots: ClassVar[Sequence[Robot] | None] = None
    stem: ClassVar[str] = "arm-7"

    def calls(self, folder: Path) -> Iterator[Calls]:
        """Writing the robots, and robots with awkward names; reading files that nobody can read."""
        yield Calls(self.stage.emit, (self.stem, self.given()), self._robots(), self._awkward(), (EmitterError,))
        broken = [folder / f"broken_{number}{(*self.stage.suffixes, '')[0]}" for number in range(len(_UNREADABLE))]
        for path, content in zip(broken, _UNREADABLE, strict=True):
            path.write_bytes(content)
        if back := self.stage.can(stages.ReadsBack):
            yield Calls(back.read_back, (), [], broken, (Dh2UrdfError,))
        if foreign := self.stage.can(stages.ReadsForeign):
            yield Calls(foreign.read_foreign, (stages.Expansion(),), [], broken, (Dh2UrdfError,))
        if checks := self.stage.can(stages.Checks):
            yield Calls(checks.check, (stages.Expansion(),), [], broken, (Dh2UrdfError,))

    @clause
    def test_files_have_plain_names_and_content(self) -> Found:
        """It gives files: the stem and an ending of its record as names, content in bytes, the main file first."""
        in_folders = self.stage.can(stages.WritesFolders) is not None
        endings = {ending.casefold() for ending in self.stage.endings}
        for given in map(self._emit, self._robots()):
            if not isinstance(given, (list, tuple)):  # A generator could be gone through but once.
                yield f"{given!r:.200}"
            files = emitted_files(given, self.stem, in_folders=in_folders)
            for file in files if not in_folders else ():
                if (ending := file.name[len(self.stem) :]).casefold() not in endings:
                    yield f"{file.name!r}, which has {ending!r} behind the stem; the record has {sorted(endings)}"
            if not files or not (in_folders or files[0].name.lower().endswith(self.stage.suffixes)):
                yield f"the names {[file.name for file in files]}, of which the first is the main file's"

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
                    if parse := _PARSERS.get(Path(file.name).suffix.lower()):
                        parse(file.content, file.name)
                except Exception as error:  # noqa: BLE001 - of any parser
                    yield f"{file.name} of the robot {robot.name!r}: {error}"

    @clause
    def test_reads_back_the_same_arm(self, tmp_path: Path) -> Found:
        """Where it reads its files back, T(q) is that of the robot, by code that the pipeline does not share."""
        if not (reads := self.stage.can(stages.ReadsBack)):
            return  # A format that holds no kinematics, such as a data sheet.
        for manipulator in reference_manipulators():
            robot, expected = plain_robot(manipulator), ExpectedPoses.of(manipulator)
            path = _write(tmp_path, files := self._emit(robot))
            found = reads.read_back(path) if files[0].is_robot else robot
            for q in proof_vectors(expected, robot, 8):
                both = robot_pose(robot, q, ROOT, TOOL), robot_pose(found, q, ROOT, TOOL)
                yield from _apart(robot, q, both, (3 * TOLERANCE, 3 * TOLERANCE))

    @clause
    def test_finds_no_fault_in_its_own_files(self, tmp_path: Path) -> Found:
        """Where it checks files, some consumer takes those that it writes without an error."""
        if not (checks := self.stage.can(stages.Checks)):
            return
        for robot in self._robots():
            inspection = checks.check(_write(tmp_path, self._emit(robot)), stages.Expansion())
            errors = [finding for finding in inspection.findings if finding.severity == "error"]
            refusing = {effect.consumer for each in errors for effect in each.effects if effect.severity == "error"}
            if not all(each.effects for each in errors) or (errors and not set(inspection.consumers) - refusing):
                yield "; ".join(finding.message for finding in errors)

    @clause
    def test_many_at_once_are_the_same(self) -> Found:
        """Where it writes many robots at once, their files are byte by byte those that it writes one by one."""
        import numpy as np

        if not (emits := self.stage.can(stages.EmitsInColumns)):
            return  # It makes them one by one.
        robot = self._robots()[0]  # three of it, which differ in the height of the first joint
        x, y, z = robot.joints[0].origin.xyz
        height: Any = np.array([z, z + 0.125, z + 1 / 3])
        first = replace(robot.joints[0], origin=replace(robot.joints[0].origin, xyz=(x, y, height)))
        many, names = replace(robot, joints=(first, *robot.joints[1:])), tuple(f"{robot.name}_{n}" for n in (1, 2, 3))
        columns = RobotColumns(robot=many, names=names, comments=("",) * 3, sure=np.ones(3, dtype=bool))
        stems = [f"{self.stem}-{number}" for number in range(3)]
        for number, files in enumerate(emits.emit_columns(columns, stems, self.given()) or ()):
            alone = self.stage.emit(columns.pick(number), stems[number], self.given())
            if files and (differs := difference(list(files), list(alone))):  # It may leave out what is not sure.
                yield differs

    @classmethod
    def _robots(cls) -> list[Robot]:
        # Copies: an emitter that changes its input would be given what it has changed before.
        return list(deepcopy(cls.robots) if cls.robots is not None else map(plain_robot, reference_manipulators()))

    def _emit(self, robot: Robot) -> Sequence[stages.EmittedFile]:
        return self.stage.emit(robot, self.stem, self.given())

    def _awkward(self) -> list[Robot]:
        """Robots that the pipeline lets pass and that an emitter may stumble over."""
        robot, found = self._robots()[0], []
        for text in _AWKWARD:
            names = {link.name: f"{link.name} {text}" for link in robot.links[1:-1]}
            links = [replace(link, name=names.get(link.name, link.name)) for link in robot.links]
            ends = [(names.get(each.parent, each.parent), names.get(each.child, each.child)) for each in robot.joints]
            joints = [
                replace(joint, name=f"{joint.name} {text}", parent=parent, child=child)
                for joint, (parent, child) in zip(robot.joints, ends, strict=True)
            ]
            found.append(replace(robot, name=text, links=tuple(links), joints=tuple(joints)))
        shapes = (Visual(geometry=Box(size=(0.1, 0.2, 0.3))), Visual(geometry=Sphere(radius=0.05)))
        for name, visuals in {"shapes": shapes, "bare": ()}.items():
            links = [replace(each, visuals=visuals, collisions=()) if each.visuals else each for each in robot.links]
            found.append(replace(robot, name=name, links=tuple(links)))
        return found


def _write(folder: Path, files: Sequence[stages.EmittedFile]) -> Path:
    """Write files; the path of the main one."""
    for file in files:
        (folder / file.name).parent.mkdir(parents=True, exist_ok=True)
        (folder / file.name).write_bytes(file.content)
    return folder / files[0].name


def _broken_rules(robot: Robot) -> Found:
    errors = (problem for problem in check_robot(robot) if problem.severity == "error")
    yield from (f"of the arm {robot.name!r}: {problem}" for problem in errors)


def _off(table: Manipulator, robot: Robot, poses: Sequence[Sequence[float]]) -> Found:
    """Where tool0 of a robot is not where its table has it, by matrices that the proof does not share."""
    for q in poses:
        allowed = TOLERANCE * max(1.0, ExpectedPoses.of(table).tips[0].reach([q]))
        both = table_pose(table, q), robot_pose(robot, q, ROOT, TOOL)
        yield from _apart(robot, q, both, (allowed, TOLERANCE))


def _apart(robot: Robot, q: Sequence[float], both: tuple[Matrix, Matrix], allowed: tuple[float, float]) -> Found:
    distance, angle = gap(*both)
    if not (distance <= allowed[0] and angle <= allowed[1]):
        yield f"tool0 of {robot.name!r} is off by {distance:.3g} m and {angle:.3g} rad at q = {q}"


def stretched(manipulator: Manipulator) -> list[Manipulator]:
    """The same arm in three sizes."""
    found = []
    for factor in (1.0, 1.1, 4 / 3):
        rows = tuple(replace(row, a=row.a * factor, d=row.d * factor) for row in manipulator.rows)
        found.append(replace(manipulator, name=f"{manipulator.name}_{factor:.3g}", rows=rows))
    return found


def impossible() -> Iterator[Manipulator]:
    """Arms that readers may give and nobody can make, and some that are only strange; the name says which."""
    arm = reference_manipulators()[0]
    first, second, *others = arm.rows
    broken: dict[str, dict[str, Any]] = {
        "an arm as long as numbers go": {"a": 1e308, "d": 1e308},
        "a link named like a joint": {"link": second.joint},
        "a link named base_link": {"link": ROOT},
        "limits of which one is missing": {"limits": Limits(lower=1.0)},
        "a body of negative mass": {"mass": -1.0},
    }
    for name, changes in broken.items():
        yield replace(arm, name=name, rows=(replace(first, **changes), second, *others))
    weld = DHRow(joint="weld", link="stump", type=JointType.FIXED, a=0.0, alpha=0.0, d=0.0)
    yield replace(arm, name="an arm that does not move", rows=(weld,))
