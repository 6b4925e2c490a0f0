"""The contracts of transforms and of edits."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

from dh2urdf.columns import in_columns, member, stacked
from dh2urdf.elementwise import DividedError
from dh2urdf.errors import EditError, TransformError
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.kinematics.proof import TOLERANCE, prove
from dh2urdf.kinematics.proof_vectors import proof_vectors
from dh2urdf.manipulator import ROOT, TOOL, DHRow, JointType, Limits, Manipulator
from dh2urdf.robot import Robot
from dh2urdf.robot_check import check_robot
from dh2urdf.stages import EditsInColumns, TransformsInColumns
from dh2urdf.testing.child import in_child
from dh2urdf.testing.comparing import difference
from dh2urdf.testing.oracle import gap, robot_pose, table_pose
from dh2urdf.testing.reference import copies_of, plain_robot, reference_manipulators
from dh2urdf.testing.stage_contract import StageContract, changed_by, clause, results
from dh2urdf.unchecked_records import changed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.stages import Edit, Transform
    from dh2urdf.testing.stage_contract import Found

POSES = 16
"""Random joint vectors of a comparison, besides zero and both ends of the limits."""
_FACTORS = (1.0, 1.1, 4 / 3)


class TransformContract(StageContract):
    """What holds for a transform.

    Attributes:
        manipulators: the arms that it is tested with, none of which it refuses; by default the reference arms.
    """

    kind = "transform"
    stage: ClassVar[Transform[Any]]
    manipulators: ClassVar[Sequence[Manipulator] | None] = None

    @clause
    def test_makes_robots_that_readers_take(self) -> Found:
        """It makes a Robot of every arm, and the robot breaks no rule that readers of descriptions rely on."""
        for manipulator in copies_of(self.manipulators):
            robot = self.stage.transform(manipulator, self.given())
            if not isinstance(robot, Robot):
                yield f"{type(robot).__name__} of the arm {manipulator.name!r}"
            yield from _broken_rules(robot)

    @clause
    def test_keeps_the_kinematics(self) -> Found:
        """Where the record claims it, T(base_link → tool0) of the robot is the DH product, computed in two ways."""
        for manipulator in copies_of(self.manipulators) if self.stage.keeps_kinematics(self.given()) else ():
            robot, expected = self.stage.transform(manipulator, self.given()), ExpectedPoses.of(manipulator)
            poses = proof_vectors(expected, robot, POSES)
            if not (proof := prove(expected, robot, poses)).holds:
                yield f"tool0 of {manipulator.name!r} is off by {proof.position_error:.3g} m at q = {proof.q}"
            yield from _off(manipulator, robot, poses)

    @clause
    def test_is_deterministic(self) -> Found:
        """The same arm gives the same robot, or the same refusal, in every process."""
        arms = (*copies_of(self.manipulators), *impossible())
        yield from self.same_in_every_process(self.stage.transform, arms, self.given())

    @clause
    def test_does_nothing_else(self) -> Found:
        """It writes no file, starts no process and leaves nothing running."""
        seen = in_child(results, self.stage.transform, copies_of(self.manipulators), self.given())
        yield from (*seen.deeds, *(f"left {each}" for each in seen.left))

    @clause
    def test_keeps_its_input(self) -> Found:
        """The manipulator is after the call as it was before."""
        yield from changed_by(self.stage.transform, copies_of(self.manipulators), self.given())

    @clause
    def test_raises_documented_errors_only(self) -> Found:
        """An arm that cannot be made is a TransformError."""
        for arm in impossible():
            for found in self.refuses_with((TransformError,), self.stage.transform, arm, self.given()):
                yield f"{found} at {arm.name}"

    @clause
    def test_many_at_once_are_the_same(self) -> Found:
        """Where it makes many robots at once, their numbers are to the last bit those that it makes one by one."""
        its = self.stage.can(TransformsInColumns)
        for manipulator in copies_of(self.manipulators) if its else ():
            ((_, columns),) = in_columns([stretched(manipulator, factor) for factor in _FACTORS])
            for places, robots in its.transform_columns(columns, self.given()) or () if its else ():
                for number, place in enumerate(places):
                    alone = self.stage.transform(columns.pick(place), self.given())
                    # What is not sure is made one by one.
                    if robots.sure[number] and (differs := difference(robots.pick(number), alone, whole=False)):
                        yield differs


class EditContract(StageContract):
    """What holds for an edit of tables, of robots, or of both.

    Attributes:
        manipulators: the arms that it is tested with, none of which it refuses; by default the reference arms. An edit
            of robots is tested with the plainest robot of each.
    """

    kind = "edit"
    stage: ClassVar[Edit[Any]]
    manipulators: ClassVar[Sequence[Manipulator] | None] = None

    @clause
    def test_returns_what_it_was_given(self) -> Found:
        """It makes a Manipulator of every Manipulator, and a Robot of every Robot, with the same name."""
        for function, items in self._work(copies_of(self.manipulators)):
            for item in items:
                found, kind = function(item, self.given()), type(item)
                if not isinstance(found, kind) or found.name != item.name:
                    name = getattr(found, "name", None)
                    yield f"{type(found).__name__} with the name {name!r} for the {kind.__name__} {item.name!r}"

    @clause
    def test_robots_stay_what_readers_take(self) -> Found:
        """A robot that breaks no rule breaks none after the edit."""
        for _, robot in map(self._edited, copies_of(self.manipulators)):
            yield from _broken_rules(robot)

    @clause
    def test_keeps_the_kinematics(self) -> Found:
        """Where the record claims it, T(base_link → tool0) after the edit of the robot is the table's DH product."""
        if self.stage.edit_robot is None or not self.stage.keeps_kinematics(self.given()):
            return  # The edited table is the truth; or the proof reports the difference, and fails nothing.
        for table, robot in map(self._edited, copies_of(self.manipulators)):
            yield from _off(table, robot, proof_vectors(ExpectedPoses.of(table), plain_robot(table), POSES))

    @clause
    def test_is_deterministic(self) -> Found:
        """The same input gives the same result, or the same refusal, in every process."""
        for function, items in self._work(copies_of(self.manipulators), impossible()):
            yield from self.same_in_every_process(function, items, self.given())

    @clause
    def test_does_nothing_else(self) -> Found:
        """It writes no file, starts no process and leaves nothing running."""
        for function, items in self._work(copies_of(self.manipulators)):
            seen = in_child(results, function, items, self.given())
            yield from (*seen.deeds, *(f"left {each}" for each in seen.left))

    @clause
    def test_keeps_its_input(self) -> Found:
        """The manipulator, or the robot, is after the call as it was before."""
        for function, items in self._work(copies_of(self.manipulators)):
            yield from changed_by(function, items, self.given())

    @clause
    def test_raises_documented_errors_only(self) -> Found:
        """What cannot be edited is an EditError."""
        for arm in impossible() if self.stage.edit_table else ():
            for found in self.refuses_with((EditError,), self.stage.edit_table, arm, self.given()):  # type: ignore[arg-type]
                yield f"{found} at {arm.name}"

    @clause
    def test_many_at_once_are_the_same(self) -> Found:
        """Where it accepts columns, it makes of many arms at once, to the last bit, what it makes of each alone."""
        for manipulator in copies_of(self.manipulators) if self.stage.can(EditsInColumns) else ():
            for function, arms in self._work([stretched(manipulator, factor) for factor in _FACTORS]):
                try:
                    many = function(stacked(arms), self.given())
                except DividedError:
                    continue  # The run makes groups of them that go the same way.
                for number, arm in enumerate(arms):
                    alone = function(arm, self.given())
                    if differs := difference(changed(member(many, number), name=alone.name), alone, whole=False):
                        yield differs

    def _work(
        self, arms: Sequence[Manipulator], others: Iterator[Manipulator] | tuple[()] = ()
    ) -> Iterator[tuple[Callable[[Any, Any], Any], list[Any]]]:
        """The functions of the edit, each with what it is tested with; other tables go to that of tables."""
        if self.stage.edit_table is not None:
            yield self.stage.edit_table, [*arms, *others]
        if self.stage.edit_robot is not None:
            yield self.stage.edit_robot, [plain_robot(self._edited(each)[0]) for each in arms]

    def _edited(self, table: Manipulator) -> tuple[Manipulator, Robot]:
        if self.stage.edit_table is not None:
            table = self.stage.edit_table(table, self.given())
        robot = plain_robot(table)
        return table, self.stage.edit_robot(robot, self.given()) if self.stage.edit_robot else robot


def _broken_rules(robot: Robot) -> Found:
    for problem in check_robot(robot):
        if problem.severity == "error":
            yield f"of the arm {robot.name!r}: {problem}"


def _off(table: Manipulator, robot: Robot, poses: Any) -> Found:  # noqa: ANN401 - joint vectors
    """Where tool0 of a robot is not where its table has it, by matrices that the proof does not share."""
    for q in poses:
        distance, angle = gap(table_pose(table, q), robot_pose(robot, q, ROOT, TOOL))
        allowed = TOLERANCE * max(1.0, ExpectedPoses.of(table).tips[0].reach([q]))
        if not (distance <= allowed and angle <= TOLERANCE):
            yield f"tool0 of {robot.name!r} is off by {distance:.3g} m and {angle:.3g} rad at q = {q}"


def stretched(manipulator: Manipulator, factor: float) -> Manipulator:
    """An arm of another size."""
    rows = tuple(replace(row, a=row.a * factor, d=row.d * factor) for row in manipulator.rows)
    return replace(manipulator, name=f"{manipulator.name}_{factor:.3g}", rows=rows)


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
