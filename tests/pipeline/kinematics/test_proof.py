import math
from dataclasses import replace

import pytest

from dh2urdf.errors import ProofError
from dh2urdf.kinematics.expected_poses import ExpectedPoses, joint_vectors, proof_vectors
from dh2urdf.kinematics.proof import TOLERANCE, Proof, prove
from dh2urdf.manipulator import Convention, DHRow, JointType, Limits, Manipulator
from dh2urdf.robot import Joint, Link, Origin, Robot

TABLE = Manipulator(
    name="arm",
    convention=Convention.STANDARD,
    rows=(
        DHRow(joint="turn", link="one", a=0.5, alpha=0.0, d=0.0),
        DHRow(joint="bolt", link="two", type=JointType.FIXED, a=0.0, alpha=math.pi / 2, d=0.0),
        DHRow(joint="slide", link="three", type=JointType.PRISMATIC, a=0.0, alpha=0.0, d=0.25),
    ),
)
"""Turns about z, reaches 0.5 m along x, slides along −y."""
TRUTH = ExpectedPoses.of(TABLE)


def written(**changes: Joint) -> Robot:
    """The same arm as links and joints, drawn by hand; a joint of `changes` replaces the one of its name."""
    joints = (
        Joint(
            name="turn",
            type=JointType.REVOLUTE,
            parent="base_link",
            child="one",
            limits=Limits(lower=-1.0, upper=2.0, velocity=1.0, effort=1.0),
        ),
        Joint(name="bolt", type=JointType.FIXED, parent="one", child="two", origin=Origin(xyz=(0.5, 0.0, 0.0))),
        Joint(
            name="slide",
            type=JointType.PRISMATIC,
            parent="two",
            child="three",
            axis=(0.0, -1.0, 0.0),
            limits=Limits(lower=0.1, upper=0.4, velocity=1.0, effort=1.0),
        ),
        Joint(
            name="three-tool0",
            type=JointType.FIXED,
            parent="three",
            child="tool0",
            origin=Origin(xyz=(0.0, -0.25, 0.0), rpy=(math.pi / 2, 0.0, 0.0)),
        ),
    )
    links = tuple(Link(name=name) for name in ("base_link", "one", "two", "three", "tool0"))
    return Robot(name="arm", links=links, joints=tuple(changes.get(joint.name, joint) for joint in joints))


def joint(name: str) -> Joint:
    return next(joint for joint in written().joints if joint.name == name)


POSES = proof_vectors(TRUTH, written(), 32)


class TestJointVectors:
    def test_they_lie_inside_the_limits(self) -> None:
        """Every joint vector is inside the limits, has one entry per moving row, and no two are equal."""
        vectors = joint_vectors(TRUTH, written(), 200)
        assert len(set(vectors)) == 200
        for turn, slide in vectors:
            assert -1.0 <= turn <= 2.0
            assert 0.1 <= slide <= 0.4

    def test_a_joint_without_limits_turns_once_around(self) -> None:
        """A continuous joint is tried between −π and π."""
        free = replace(joint("turn"), type=JointType.CONTINUOUS, limits=Limits(velocity=1.0, effort=1.0))
        turns = [q[0] for q in joint_vectors(TRUTH, written(turn=free), 100)]
        assert all(-math.pi <= turn <= math.pi for turn in turns)
        assert max(turns) - min(turns) > math.pi

    def test_they_are_the_same_everywhere(self) -> None:
        """The vectors of a manipulator do not depend on how many are asked for."""
        assert joint_vectors(TRUTH, written(), 5) == joint_vectors(TRUTH, written(), 50)[:5]

    def test_a_proof_also_tries_zero_and_both_ends(self) -> None:
        """A proof tries zero, also where the limits do not allow it, the lower ends and the upper ends."""
        assert proof_vectors(TRUTH, written(), 2)[:3] == ((0.0, 0.0), (-1.0, 0.1), (2.0, 0.4))
        assert proof_vectors(TRUTH, written(), 2)[3:] == joint_vectors(TRUTH, written(), 2)


class TestProve:
    def test_the_same_arm_is_proved(self) -> None:
        """An arm drawn by hand from its table is proved to the last digits."""
        proof = prove(TRUTH, written(), POSES)
        assert proof.holds
        assert proof.position_error < 1e-15
        assert proof.angle_error < 1e-15
        assert proof.poses == len(POSES) == 35
        assert proof.q in POSES

    @pytest.mark.parametrize(
        "wrong",
        [
            replace(joint("bolt"), origin=Origin(xyz=(0.5 + 1e-8, 0.0, 0.0))),
            replace(joint("turn"), axis=(0.0, 0.0, -1.0)),
            replace(joint("slide"), axis=(0.0, 1.0, 0.0)),
            replace(joint("slide"), type=JointType.REVOLUTE),
            replace(joint("three-tool0"), origin=Origin(xyz=(0.0, -0.25, 0.0), rpy=(math.pi / 2, 0.0, 1e-8))),
        ],
        ids=["a length", "the sense of a turn", "the sense of a slide", "a joint type", "the tool's rotation"],
    )
    def test_another_arm_is_not(self, wrong: Joint) -> None:
        """One wrong length, axis, joint type or angle, by as little as 1e-8, is found."""
        assert not prove(TRUTH, written(**{wrong.name: wrong}), POSES).holds

    @pytest.mark.parametrize(
        "wrong",
        [
            joint("bolt"),
            replace(joint("bolt"), origin=Origin(xyz=(0.7, 0.0, 0.0), rpy=(0.1, 0.2, 0.3))),
            replace(joint("bolt"), origin=Origin(xyz=(math.nan, 0.0, 0.0))),
            replace(joint("turn"), axis=(0.6, 0.0, 0.8)),
            replace(joint("slide"), axis=(0.0, 1.0, 0.0)),
        ],
        ids=["nothing", "an origin", "no number", "an oblique axis", "the sense of a slide"],
    )
    def test_all_joint_vectors_at_once_give_the_same(self, wrong: Joint) -> None:
        """Whether they are walked one by one or together, the errors agree to rounding, and the joint vector does."""
        robot = written(**{wrong.name: wrong})
        alone, together = prove(TRUTH, robot, POSES), prove(TRUTH, robot, POSES, at_once=True)
        assert together.position_error == pytest.approx(alone.position_error, rel=1e-13, abs=1e-15)
        assert together.angle_error == pytest.approx(alone.angle_error, rel=1e-13, abs=1e-15)
        assert (together.holds, together.poses, together.tolerance) == (alone.holds, alone.poses, alone.tolerance)
        assert wrong == joint(wrong.name) or together.q == alone.q

    def test_the_worst_joint_vector_is_named(self) -> None:
        """The proof names the joint vector at which the position error is largest."""
        reversed_slide = replace(joint("slide"), axis=(0.0, 1.0, 0.0))
        proof = prove(TRUTH, written(slide=reversed_slide), POSES)
        assert proof.q == (2.0, 0.4)
        assert proof.position_error == pytest.approx(0.8)

    def test_where_positions_agree_the_worst_angle_is_named(self) -> None:
        """Where only the rotation is wrong, the joint vector of the largest angle error is named."""
        table = Manipulator(
            name="wrist",
            convention=Convention.STANDARD,
            rows=(DHRow(joint="turn", link="one", a=0.0, alpha=0.0, d=0.0),),
        )
        joints = (
            replace(joint("turn"), axis=(0.0, 0.0, -1.0)),
            Joint(name="end", type=JointType.FIXED, parent="one", child="tool0"),
        )
        proof = prove(ExpectedPoses.of(table), Robot(name="wrist", links=(), joints=joints), [(0.0,), (0.5,), (-0.2,)])
        assert proof.q == (0.5,)
        assert proof.position_error == 0.0
        assert proof.angle_error == pytest.approx(1.0)

    def test_what_may_differ_grows_with_the_arm(self) -> None:
        """The tolerance is that of one metre times the reach, prismatic travel included, and never less."""
        assert prove(TRUTH, written(), POSES).tolerance == pytest.approx(TOLERANCE * (0.75 + 0.4), rel=1e-12)
        assert prove(TRUTH, written(), [(0.0, 0.0)]).tolerance == TOLERANCE
        crane = replace(TABLE, rows=(replace(TABLE.rows[0], a=1000.0), *TABLE.rows[1:]))
        long = replace(joint("bolt"), origin=Origin(xyz=(1000.0, 0.0, 0.0)))
        assert prove(ExpectedPoses.of(crane), written(bolt=long), POSES).tolerance == pytest.approx(TOLERANCE * 1000.65)

    @pytest.mark.parametrize(
        ("position", "angle", "holds"),
        [
            (1e-9, 1e-9, True),
            (1.1e-9, 0.0, False),
            (0.0, 1.1e-9, False),
            (math.nan, 0.0, False),
            (0.0, math.nan, False),
        ],
    )
    def test_it_holds_within_its_tolerance(self, position: float, angle: float, *, holds: bool) -> None:
        """Position and angle both have to be within 1e-9; what is not a number is not proved."""
        proof = Proof(position_error=position, angle_error=angle, q=(), tolerance=1e-9, poses=1)
        assert proof.holds is holds


class TestChainsThatDoNotMatch:
    @pytest.mark.parametrize(
        ("changed", "code"),
        [
            (replace(joint("three-tool0"), child="tip"), "no-way"),
            (replace(joint("turn"), name="twist"), "other-joints-move"),
        ],
    )
    def test_without_tool0_or_with_other_joints(self, changed: Joint, code: str) -> None:
        """A proof that fails, with the name of the arm."""
        old = "turn" if changed.name == "twist" else changed.name
        with pytest.raises(ProofError) as caught:
            prove(TRUTH, written(**{old: changed}), POSES)
        assert [(problem.code, problem.robot) for problem in caught.value.problems] == [(code, "arm")]

    def test_an_arm_that_cannot_move(self) -> None:
        """A table of fixed rows is proved at its one pose."""
        table = replace(TABLE, rows=TABLE.rows[1:2])
        joints = (
            Joint(name="bolt", type=JointType.FIXED, parent="base_link", child="two"),
            Joint(
                name="end",
                type=JointType.FIXED,
                parent="two",
                child="tool0",
                origin=Origin(rpy=(math.pi / 2, 0.0, 0.0)),
            ),
        )
        robot = Robot(name="arm", links=(), joints=joints)
        poses = proof_vectors(ExpectedPoses.of(table), robot, 2)
        assert set(poses) == {()}
        for at_once in (False, True):
            assert prove(ExpectedPoses.of(table), robot, poses, at_once=at_once).holds
