"""The contract of edits."""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, Any, ClassVar

from dh2urdf.columns import member, stacked
from dh2urdf.elementwise import DividedError
from dh2urdf.errors import EditError, PluginError
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.kinematics.proof import TOLERANCE
from dh2urdf.kinematics.proof_vectors import proof_vectors
from dh2urdf.manipulator import ROOT, TOOL
from dh2urdf.robot_check import check_robot
from dh2urdf.testing.oracle import difference, robot_pose, table_pose
from dh2urdf.testing.reference import copies_of, plain_robot
from dh2urdf.testing.stage_contract import StageContract, each, each_outcome
from dh2urdf.testing.transform_contract import POSES, impossible, stretched
from dh2urdf.validation.coercion import replace_unchecked

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Robot
    from dh2urdf.stages import Edit

_ERRORS = "dh2urdf.errors.EditError, MissingDependencyError or MissingProgramError"


class EditContract(StageContract):
    """What holds for an edit of tables, of robots, or of both.

    Attributes:
        manipulators: the arms that it is tested with, none of which it refuses; by default the reference arms. An edit
            of robots is tested with the plainest robot of each.
    """

    kind = "edit"
    stage: ClassVar[Edit[Any]]
    manipulators: ClassVar[Sequence[Manipulator] | None] = None

    # --- The clauses

    def test_returns_what_it_was_given(self) -> None:
        """It makes a Manipulator of every Manipulator, and a Robot of every Robot, with the same name."""
        for function, items in self._work():
            for item in items:
                found, kind = function(item, self.given()), type(item)
                if not isinstance(found, kind) or found.name != item.name:
                    name = getattr(found, "name", None)
                    self.breach(
                        self.test_returns_what_it_was_given,
                        found=f"{type(found).__name__} with the name {name!r} for the {kind.__name__} {item.name!r}",
                        accepted=f"a {kind.__name__} with the name {item.name!r}",
                        remedy="return dataclasses.replace(given, …) without a new name: files are named before edits",
                    )

    def test_robots_stay_what_readers_take(self) -> None:
        """A robot that breaks no rule breaks none after the edit."""
        for robot in map(self._edited_robot, copies_of(self.manipulators)):
            if errors := [str(problem) for problem in check_robot(robot) if problem.severity == "error"]:
                self.breach(
                    self.test_robots_stay_what_readers_take,
                    found=f"of the arm {robot.name!r}: {'; '.join(errors)}",
                    accepted="a robot of which dh2urdf.robot_check.check_robot says no error",
                    remedy="give new links a fixed joint that holds them, names of their own, and a sound inertia",
                )

    def test_keeps_the_kinematics(self) -> None:
        """Where the record claims it, T(base_link → tool0) after the edit of the robot is the table's DH product."""
        # Of an edit that also changes the table, it is the table after that change.
        if self.stage.edit_robot is None or not self.stage.keeps_kinematics(self.given()):
            return  # The edited table is the truth; or the proof reports the difference, and fails nothing.
        for manipulator in copies_of(self.manipulators):
            table, robot = self._edited_table(manipulator), self._edited_robot(manipulator)
            expected = ExpectedPoses.of(table)
            for q in proof_vectors(expected, plain_robot(table), POSES):
                distance, angle = self._distance(table, robot, q)
                tolerance = TOLERANCE * max(1.0, expected.tips[0].reach([q]))
                if not (distance <= tolerance and angle <= TOLERANCE):
                    self.breach(
                        self.test_keeps_the_kinematics,
                        found=f"tool0 of {robot.name!r} is off by {distance:.3g} m and {angle:.3g} rad at q = {q}",
                        accepted=f"{tolerance:.3g} m and {TOLERANCE:.3g} rad",
                        remedy="change the table in `edit_table` where another arm is meant; or let keeps_kinematics "
                        "return False with these options",
                    )

    def test_is_deterministic(self) -> None:
        """The same input gives the same result, or the same refusal, in every process."""
        for function, items in self._work(*impossible()):
            self.same_in_every_process(self.test_is_deterministic, each_outcome, function, items, self.given())

    def test_does_nothing_else(self) -> None:
        """It writes no file, starts no process and leaves nothing running."""
        for function, items in self._work():
            seen = self.in_child(self.test_does_nothing_else, each, function, items, self.given())
            if seen.traces:
                self.breach(
                    self.test_does_nothing_else,
                    found="; ".join(seen.traces),
                    accepted="an edit that only returns what it has changed",
                    remedy="compute without files; say what a person should know in `notices` of what you return",
                )

    def test_keeps_its_input(self) -> None:
        """The manipulator, or the robot, is after the call as it was before."""
        for function, items in self._work():
            for item in items:
                before = deepcopy(item)
                function(item, self.given())
                self.unchanged(self.test_keeps_its_input, before, item)

    def test_raises_documented_errors_only(self) -> None:
        """What cannot be edited is an EditError."""
        if self.stage.edit_table is None:
            return  # What transforms refuse never comes to an edit of robots.
        for manipulator in impossible():
            try:
                self.stage.edit_table(manipulator, self.given())
            except (EditError, PluginError):
                continue
            except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an author's code raises
                self.breach(
                    self.test_raises_documented_errors_only,
                    found=f"{type(error).__name__}: {error} at {manipulator.name}",
                    accepted=_ERRORS,
                    remedy="check the numbers and names first, and raise EditError with a Problem for each fault",
                )

    def test_many_at_once_are_the_same(self) -> None:
        """Where it accepts columns, it makes of many arms at once, to the last bit, what it makes of each alone."""
        if not self.stage.accepts_columns:
            return  # A run edits its arms one by one.
        clause = self.test_many_at_once_are_the_same
        for manipulator in copies_of(self.manipulators):
            for function, arms in self._work_of([stretched(manipulator, factor) for factor in (1.0, 1.1, 4 / 3)]):
                try:
                    many = function(stacked(arms), self.given())
                except DividedError:
                    continue  # The run makes groups of them that go the same way.
                for number, arm in enumerate(arms):
                    alone = function(arm, self.given())
                    one = replace_unchecked(member(many, number), name=alone.name)
                    self.same(clause, one, alone, whole=False)

    # --- What the clauses use

    def _work(self, *others: Manipulator) -> Iterator[tuple[Callable[[Any, Any], Any], list[Any]]]:
        """The functions of the edit, each with what it is tested with; other tables go to that of tables."""
        yield from self._work_of(copies_of(self.manipulators), others)

    def _work_of(
        self, manipulators: Sequence[Manipulator], others: Sequence[Manipulator] = ()
    ) -> Iterator[tuple[Callable[[Any, Any], Any], list[Any]]]:
        if self.stage.edit_table is not None:
            yield self.stage.edit_table, [*manipulators, *others]
        if self.stage.edit_robot is not None:
            yield self.stage.edit_robot, [plain_robot(self._edited_table(each)) for each in manipulators]

    def _edited_table(self, manipulator: Manipulator) -> Manipulator:
        return self.stage.edit_table(manipulator, self.given()) if self.stage.edit_table else manipulator

    def _edited_robot(self, manipulator: Manipulator) -> Robot:
        robot = plain_robot(self._edited_table(manipulator))
        return self.stage.edit_robot(robot, self.given()) if self.stage.edit_robot else robot

    def _distance(self, table: Manipulator, robot: Robot, q: Sequence[float]) -> tuple[float, float]:
        """How far tool0 of a robot is from where its table has it [m, rad]."""
        try:
            found = robot_pose(robot, q, ROOT, TOOL)
        except (ValueError, StopIteration):
            return self.breach(
                self.test_keeps_the_kinematics,
                found=f"no chain from base_link to tool0 with {len(q)} moving joints in {robot.name!r}",
                accepted="the chain that the robot had before the edit",
                remedy="keep the links base_link and tool0, and the moving joints between them",
            )
        return difference(table_pose(table, q), found)
