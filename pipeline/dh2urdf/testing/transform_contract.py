"""The contract of transforms."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

from dh2urdf.columns import in_columns
from dh2urdf.errors import PluginError, ProofError, TransformError
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.kinematics.proof import TOLERANCE, prove
from dh2urdf.kinematics.proof_vectors import proof_vectors
from dh2urdf.manipulator import DHRow, JointType, Limits, Manipulator
from dh2urdf.robot import Robot
from dh2urdf.robot_check import check_robot
from dh2urdf.testing.oracle import difference, robot_pose, table_pose
from dh2urdf.testing.reference import copies_of, reference_manipulators
from dh2urdf.testing.stage_contract import StageContract, each, each_outcome

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.stages import Transform

POSES = 16
"""Random joint vectors of a comparison, besides zero and both ends of the limits."""


class TransformContract(StageContract):
    """What holds for a transform.

    Attributes:
        manipulators: the arms that it is tested with, none of which it refuses; by default the reference arms.
    """

    kind = "transform"
    stage: ClassVar[Transform[Any]]
    manipulators: ClassVar[Sequence[Manipulator] | None] = None

    # --- The clauses

    def test_makes_robots_that_readers_take(self) -> None:
        """It makes a Robot of every arm, and the robot breaks no rule that readers of descriptions rely on."""
        clause = self.test_makes_robots_that_readers_take
        for manipulator in copies_of(self.manipulators):
            robot = self._transform(manipulator)
            if not isinstance(robot, Robot):
                self.breach(
                    clause,
                    found=f"{type(robot).__name__} of the arm {manipulator.name!r}",
                    accepted="a dh2urdf.robot.Robot",
                    remedy="return Robot(name=manipulator.name, links=…, joints=…)",
                )
            if errors := [str(problem) for problem in check_robot(robot) if problem.severity == "error"]:
                self.breach(
                    clause,
                    found=f"of the arm {manipulator.name!r}: {'; '.join(errors)}",
                    accepted="a robot of which dh2urdf.robot_check.check_robot says no error",
                    remedy="fill in what the table leaves open: masses and inertias, and the limits of every joint",
                )

    def test_keeps_the_kinematics(self) -> None:
        """Where the record claims it, T(base_link → tool0) of the robot is the DH product, computed in two ways."""
        if not self.stage.keeps_kinematics(self.given()):
            return  # The proof reports the difference, and fails nothing.
        clause = self.test_keeps_the_kinematics
        remedy = "fix the transform; or, where another arm is meant, let keeps_kinematics say False with these options"
        for manipulator in copies_of(self.manipulators):
            robot, expected = self._transform(manipulator), ExpectedPoses.of(manipulator)
            poses = proof_vectors(expected, robot, POSES)
            try:
                proof = prove(expected, robot, poses)
            except ProofError as error:
                self.breach(
                    clause,
                    found=str(error),
                    accepted="a chain from base_link to tool0 with the moving joints of the table, in order",
                    remedy=remedy,
                )
            for q in poses:
                found = robot_pose(robot, q, expected.root, expected.tips[0].link)
                distance, angle = difference(table_pose(manipulator, q), found)
                if not (proof.holds and distance <= proof.tolerance and angle <= TOLERANCE):
                    worst, turned = max(distance, proof.position_error), max(angle, proof.angle_error)
                    self.breach(
                        clause,
                        found=f"tool0 of {manipulator.name!r} is off by up to {worst:.3g} m and {turned:.3g} rad, "
                        f"at q = {proof.q if not proof.holds else q}",
                        accepted=f"{proof.tolerance:.3g} m and {TOLERANCE:.3g} rad",
                        remedy=remedy,
                    )

    def test_is_deterministic(self) -> None:
        """The same arm gives the same robot, or the same refusal, in every process."""
        arms = (*copies_of(self.manipulators), *impossible())
        self.same_in_every_process(self.test_is_deterministic, each_outcome, self.stage.transform, arms, self.given())

    def test_does_nothing_else(self) -> None:
        """It writes no file, starts no process and leaves nothing running."""
        clause = self.test_does_nothing_else
        seen = self.in_child(clause, each, self.stage.transform, copies_of(self.manipulators), self.given())
        if seen.traces:
            self.breach(
                clause,
                found="; ".join(seen.traces),
                accepted="a transform that only returns its robot",
                remedy="compute without files; say what a person should know in the robot's `notices`",
            )

    def test_keeps_its_input(self) -> None:
        """The manipulator is after the call as it was before."""
        for manipulator in copies_of(self.manipulators):
            before = deepcopy(manipulator)
            self._transform(manipulator)
            self.unchanged(self.test_keeps_its_input, before, manipulator)

    def test_raises_documented_errors_only(self) -> None:
        """An arm that cannot be made is a TransformError."""
        for manipulator in impossible():
            try:
                self._transform(manipulator)
            except (TransformError, PluginError):
                continue
            except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an author's code raises
                self.breach(
                    self.test_raises_documented_errors_only,
                    found=f"{type(error).__name__}: {error} at {manipulator.name}",
                    accepted="dh2urdf.errors.TransformError, MissingDependencyError or MissingProgramError",
                    remedy="check the numbers and names first, and raise TransformError with a Problem for each fault",
                )

    def test_many_at_once_are_the_same(self) -> None:
        """Where it makes many robots at once, their numbers are to the last bit those that it makes one by one."""
        if self.stage.transform_columns is None:
            return  # It makes them one by one.
        clause = self.test_many_at_once_are_the_same
        for manipulator in copies_of(self.manipulators):
            arms = [stretched(manipulator, factor) for factor in (1.0, 1.1, 4 / 3)]
            ((_, columns),) = in_columns(arms)
            for places, robots in self.stage.transform_columns(columns, self.given()) or ():
                for number, place in enumerate(places):
                    if robots.sure[number]:  # The others are made one by one.
                        alone = self._transform(columns.pick(place))
                        self.same(clause, robots.pick(number), alone, whole=False)

    # --- What the clauses use

    def _transform(self, manipulator: Manipulator) -> Robot:
        return self.stage.transform(manipulator, self.given())


def stretched(manipulator: Manipulator, factor: float) -> Manipulator:
    """An arm of another size."""
    rows = tuple(replace(row, a=row.a * factor, d=row.d * factor) for row in manipulator.rows)
    return replace(manipulator, name=f"{manipulator.name}_{factor:.3g}", rows=rows)


def impossible() -> Iterator[Manipulator]:
    """Arms that readers may give and nobody can make, and some that are only strange; the name says which."""
    arm = reference_manipulators()[0]
    first, second, *others = arm.rows

    def with_first(name: str, **changes: Any) -> Manipulator:  # noqa: ANN401 - fields of a row
        return replace(arm, name=name, rows=(replace(first, **changes), second, *others))

    yield with_first("an arm as long as numbers go", a=1e308, d=1e308)
    yield with_first("a link named like a joint", link=second.joint)
    yield with_first("a link named base_link", link="base_link")
    yield with_first("limits of which one is missing", limits=Limits(lower=1.0))
    yield with_first("a body of negative mass", mass=-1.0)
    yield replace(
        arm,
        name="an arm that does not move",
        rows=(DHRow(joint="weld", link="stump", type=JointType.FIXED, a=0.0, alpha=0.0, d=0.0),),
    )
