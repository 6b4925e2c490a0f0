"""Rows that follow others: joint vectors have no value for them, and what is computed is right all the same."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from dh2urdf import inverse_kinematics
from dh2urdf.cells.cell import ArmCall, Cell, CellCall, compose, expected_poses_of
from dh2urdf.columns import in_columns
from dh2urdf.errors import ProofError, RecordError
from dh2urdf.kinematics import KinematicChain
from dh2urdf.kinematics.chain import as_matrices, link_poses, screws_of_table
from dh2urdf.kinematics.comparison import changes, compare
from dh2urdf.kinematics.expected_poses import ExpectedPoses, proof_vectors
from dh2urdf.kinematics.facts import kinematic_facts
from dh2urdf.kinematics.inverse import dexterity
from dh2urdf.kinematics.proof import Proof, prove, prove_columns
from dh2urdf.manipulator import Convention, DHRow, Follower, JointType, Limits, Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.report.figures import arm_skeleton, robot_skeleton
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.source import Mark
from dh2urdf.testing import oracle
from dh2urdf_plugins.formats.urdf.reader import parse_urdf
from dh2urdf_plugins.formats.urdf.scanner import scan_columns
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.robots import alpha_swap, alpha_swap_columns

CATALOG = load()
RNG = np.random.default_rng(46)
LIMITS = Limits(lower=-1.5, upper=1.0)


def arm(convention: str = "standard", **laws: Follower) -> Manipulator:
    """Six rows: `first` follows a joint behind it, `wrist` a follower, and `slide` a prismatic joint."""
    given = {"first": Follower("lift", 0.5, 0.2), "wrist": Follower("first", -2.0, 0.1)}
    given |= {"slide": Follower("rail", 0.25, 0.05), **laws}
    rows = [
        DHRow(joint="first", link="l1", a=0.1, alpha=1.2, d=0.3, theta=0.1, sign=-1, offset=0.4),
        DHRow(joint="rail", link="l2", type=JointType.PRISMATIC, a=0.2, alpha=-0.7, d=0.1, theta=0.3),
        DHRow(joint="lift", link="l3", a=0.9, alpha=0.2, d=0.0, offset=-0.3, limits=LIMITS),
        DHRow(joint="bolt", link="l4", type=JointType.FIXED, a=0.05, alpha=0.1, d=0.02, theta=0.7),
        DHRow(joint="wrist", link="l5", a=0.4, alpha=-math.pi / 2, d=0.01),
        DHRow(joint="slide", link="l6", type=JointType.PRISMATIC, a=0.1, alpha=0.4, d=0.2, sign=-1),
        DHRow(joint="turn", link="l7", a=0.03, alpha=0.0, d=0.1),
    ]
    rows = [replace(row, follows=given.get(row.joint)) for row in rows]
    return Manipulator(name="arm", convention=Convention(convention), rows=tuple(rows))


def free(table: Manipulator) -> Manipulator:
    """The same arm, each joint of which moves by itself."""
    return replace(table, rows=tuple(replace(row, follows=None) for row in table.rows))


def values(q: Sequence[float]) -> list[float]:
    """The values of all moving joints of `arm()`, by hand, from those of rail, lift and turn."""
    rail, lift, turn = q
    first = 0.5 * lift + 0.2
    return [first, rail, lift, -2.0 * first + 0.1, 0.25 * rail + 0.05, turn]


def vectors(count: int = 8) -> list[list[float]]:
    return [[float(value) for value in q] for q in RNG.uniform(-1.5, 1.5, (count, 3))]


def urdf(robot: Robot) -> bytes:
    stage = CATALOG.get("emitter", "urdf")
    (file,) = stage.emit(robot, robot.name, stage.options())
    content: bytes = file.content
    return content


CONVENTIONS = pytest.mark.parametrize("convention", ["standard", "modified"])


# --- Tables -----------------------------------------------------------------------------------------------------------


@CONVENTIONS
def test_the_poses_are_those_of_an_arm_whose_joints_all_have_values(convention: str) -> None:
    table = arm(convention)
    assert [row.joint for row in table.actuated_rows] == ["rail", "lift", "turn"]
    for q in vectors():
        wanted = oracle.table_pose(free(table), values(q))
        assert np.abs(table.fk(q) - wanted).max() < 1e-14
        assert np.abs(table.fk(q) - oracle.table_pose(table, q)).max() < 1e-14
        named = table.fk({"turn": q[2], "rail": q[0], "lift": q[1]})
        assert (named == table.fk(q)).all()
        frames, alone = table.fk_all(q), free(table).fk_all(values(q))
        assert all(np.abs(frames[link] - alone[link]).max() < 1e-14 for link in alone)
    many = np.array(vectors(50)).reshape(5, 10, 3)
    one_by_one = [[table.fk(q) for q in row] for row in many]
    assert np.abs(table.fk(many) - np.array(one_by_one)).max() < 1e-14


@CONVENTIONS
def test_the_jacobian_is_the_derivative(convention: str) -> None:
    """A leader's column has what its followers do, two of them one behind the other."""
    table, step = arm(convention), 1e-6
    for q in vectors(3):
        found = table.jacobian(q)
        assert found.shape == (6, 3)
        for number in range(3):
            moved = np.eye(3)[number] * step
            before, after = table.fk(np.subtract(q, moved)), table.fk(np.add(q, moved))
            turned = (after[:3, :3] - before[:3, :3]) / (2 * step) @ table.fk(q)[:3, :3].T
            numeric = [*(after - before)[:3, 3] / (2 * step), turned[2, 1], turned[0, 2], turned[1, 0]]
            assert np.abs(found[:, number] - numeric).max() < 1e-8


def test_a_follower_has_no_value() -> None:
    table = arm()
    for q in ([0.0] * 6, {"rail": 0.0, "lift": 0.0, "turn": 0.0, "wrist": 0.1}):
        with pytest.raises(RecordError):
            table.fk(q)
    whole = table.fk([0.0, 0.3, -0.2, 0.0, 0.0, 0.0, 0.7], full=True)
    assert (whole == table.fk([0.3, -0.2, 0.7])).all()


@CONVENTIONS
def test_inverse_kinematics_keeps_the_laws_and_all_limits(convention: str) -> None:
    """The limits of a follower bound its leader: `wrist` is -lift - 0.3, and so `lift` is at most 0.1."""
    table = arm(convention)
    rows = [replace(row, limits=Limits(lower=-0.4, upper=2.0)) if row.joint == "wrist" else row for row in table.rows]
    bounded = replace(table, rows=tuple(rows))
    for q in RNG.uniform((-0.5, -1.4, -1.5), (0.5, 0.1, 1.5), (5, 3)):
        found = inverse_kinematics(bounded, table.fk(q), start=q + 0.05)
        assert found.reached
        assert np.abs(table.fk(found.q) - table.fk(q)).max() < 1e-8
    beyond = inverse_kinematics(bounded, table.fk([0.0, 0.9, 0.0]))
    assert beyond.q[1] <= 0.1 + 1e-9
    assert dexterity(table, [0.1, 0.2, 0.3]).margins == {"lift": pytest.approx(0.8)}


def test_of_six_axes_one_that_follows_makes_no_opw_arm_and_no_wrist(reference_robots: Any) -> None:
    arm = next(each.manipulator for each in reference_robots if kinematic_facts(each.manipulator).opw)
    led = replace(arm, rows=(*arm.rows[:-1], replace(arm.rows[-1], follows=Follower(arm.rows[3].joint))))
    assert kinematic_facts(led).opw is None
    assert not kinematic_facts(led).spherical_wrist
    assert len(screws_of_table(led)) == 6


@pytest.mark.parametrize(
    ("joint", "law", "code"),
    [
        ("first", Follower("lifd"), "leader-unknown"),
        ("first", Follower(""), "leader-unknown"),
        ("first", Follower("first"), "leaders-in-circle"),
        ("first", Follower("wrist"), "leaders-in-circle"),
        ("first", Follower("bolt"), "leader-fixed"),
        ("first", Follower("rail"), "leader-moves-otherwise"),
        ("first", Follower("lift", math.nan), "law-not-linear"),
        ("first", Follower("lift", 1.0, 0.0, (0.1,)), "law-not-linear"),
        ("bolt", Follower("lift"), "fixed-joint-follows"),
    ],
)
def test_what_no_joint_can_follow(joint: str, law: Follower, code: str) -> None:
    with pytest.raises(RecordError) as caught:
        arm(**{joint: law})
    assert code in {problem.code for problem in caught.value.problems}


# --- Descriptions -----------------------------------------------------------------------------------------------------


@CONVENTIONS
@pytest.mark.parametrize("frames", ["aligned", "dh"])
def test_a_file_is_proved_and_one_of_another_law_is_not(convention: str, frames: Any) -> None:
    table = arm(convention)
    robot, expected = alpha_swap(table, AlphaSwapOptions(frames=frames)), ExpectedPoses.of(table)
    content, poses = urdf(robot), proof_vectors(expected, robot, 8)
    assert {len(q) for q in poses} == {3}
    written = parse_urdf(content, "arm")
    assert written.followers == table.followers
    chain = KinematicChain.between(written)
    assert chain.actuated == ("rail", "lift", "turn")
    for q in vectors(3):
        assert np.abs(written.fk(q) - oracle.table_pose(free(table), values(q))).max() < 1e-12
    for at_once in (False, True):
        assert prove(expected, written, poses, at_once=at_once).holds
    for old, new in ((b'multiplier="-2"', b'multiplier="-2.0001"'), (b'offset="0.1"', b'offset="0.1001"')):
        assert content.count(old) == 1
        wrong = parse_urdf(content.replace(old, new), "arm")
        assert not prove(expected, wrong, poses).holds
    loose = content.replace(b'<mimic joint="first" multiplier="-2" offset="0.1"/>', b"")
    with pytest.raises(ProofError):
        prove(expected, parse_urdf(loose, "arm"), poses)


@CONVENTIONS
def test_many_arms_are_proved_as_each_alone(convention: str) -> None:
    """Variants of one arm side by side: their robots and proofs are those of one by one, to the last bit."""
    base = arm(convention)
    tables = []
    for number in range(60):
        rows = [
            replace(row, a=row.a + float(RNG.uniform(0, 0.1)), d=row.d + float(RNG.uniform(0, 0.1)))
            for row in base.rows
        ]
        limits = Limits(lower=-float(RNG.uniform(1, 2)), upper=float(RNG.uniform(1, 2)))
        rows = [replace(row, limits=limits) if row.joint == "lift" else row for row in rows]
        tables.append(replace(base, name=f"arm_{number}", rows=tuple(rows)))
    [(_, columns)] = in_columns(tables)
    options = AlphaSwapOptions()
    [(places, robots)] = alpha_swap_columns(columns, options)
    assert list(places) == list(range(60))
    alone = [alpha_swap(table, options) for table in tables]
    files = [urdf(robot) for robot in alone]
    assert [urdf(robots.pick(number)) for number in range(60)] == files
    proofs = prove_columns(columns, robots, scan_columns(files), 5)
    for table, robot, file, proof in zip(tables, alone, files, proofs, strict=True):
        expected = ExpectedPoses.of(table)
        single = prove(expected, parse_urdf(file, "arm"), proof_vectors(expected, robot, 5))
        assert isinstance(proof, Proof)
        assert proof.holds
        assert single.holds
        assert (proof.poses, proof.tolerance) == (single.poses, single.tolerance)
        assert proof.q in proof_vectors(expected, robot, 5)
    wrong = [file.replace(b'multiplier="0.25"', b'multiplier="0.26"') for file in files]
    assert not any(proof.holds for proof in prove_columns(columns, robots, scan_columns(wrong), 5) if proof)


def test_a_leader_on_another_branch() -> None:
    """Both fingers move by the left one, the right tip by a follower of the right finger and by powers of that."""
    laws = {"right": Follower("left", 0.5, 0.1, (0.25,)), "tip": Follower("right", -2.0, 0.3)}
    joints = [
        Joint(name=name, type=JointType.REVOLUTE, parent=parent, child=f"l_{name}", axis=axis, follows=laws.get(name))
        for name, parent, axis in (
            ("turn", "base", (0.0, 0.0, 1.0)),
            ("right", "l_turn", (0.0, 1.0, 0.0)),
            ("tip", "l_right", (0.0, 0.6, 0.8)),
            ("left", "l_turn", (1.0, 0.0, 0.0)),
        )
    ]
    placed = [replace(joint, origin=Origin(xyz=(0.3, 0.1, 0.2))) for joint in joints]
    links = [Link(name=name) for name in ("base", *(joint.child for joint in placed), "end")]
    held = Joint(name="e", type=JointType.FIXED, parent="l_tip", child="end", origin=Origin(xyz=(0.1, 0.2, 0.3)))
    robot = Robot(name="hand", links=tuple(links), joints=(*placed, held))
    moved = replace(robot, joints=tuple(replace(joint, follows=None) for joint in robot.joints))
    assert KinematicChain.between(robot, "base", "end").actuated == ("turn", "left")
    for turn, left in RNG.uniform(-1, 1, (5, 2)):
        right = 0.1 + 0.5 * left + 0.25 * left**2
        wanted = oracle.robot_pose(moved, [turn, right, 0.3 - 2.0 * right], "base", "end")
        assert np.abs(robot.fk([turn, left], "end") - wanted).max() < 1e-14
        assert np.abs(as_matrices(link_poses(robot, {"turn": turn, "left": left})["end"]) - wanted).max() < 1e-14
        rate = 0.5 + 0.5 * left
        alone = moved.jacobian([turn, right, 0.3 - 2.0 * right], "end")
        led = np.c_[alone[:, 0], rate * (alone[:, 1] - 2.0 * alone[:, 2])]
        assert np.abs(robot.jacobian([turn, left], "end") - led).max() < 1e-14
        found = inverse_kinematics(robot, wanted, start=[turn + 0.05, left + 0.05], link="end")
        assert found.reached


# --- Limits and efforts -----------------------------------------------------------------------------------------------


def test_limits_follow_from_the_law() -> None:
    """Those of `first` are half of those of `lift` and 0.2, those of `wrist` come from there; velocities, too."""
    joints = {joint.name: joint for joint in alpha_swap(arm(), AlphaSwapOptions()).joints}
    assert (joints["first"].limits.lower, joints["first"].limits.upper) == pytest.approx((-0.55, 0.7))
    assert (joints["wrist"].limits.lower, joints["wrist"].limits.upper) == pytest.approx((-1.3, 1.2))
    assert joints["first"].limits.velocity == pytest.approx(0.5 * math.pi)
    assert joints["slide"].limits.velocity == pytest.approx(0.25)


@pytest.mark.parametrize(("upper", "count"), [(1.2, 0), (1.19, 1)])
def test_limits_that_the_law_leaves_get_a_notice(upper: float, count: int) -> None:
    rows = [replace(row, limits=Limits(lower=-1.3, upper=upper)) if row.joint == "wrist" else row for row in arm().rows]
    robot = alpha_swap(replace(arm(), rows=tuple(rows)), AlphaSwapOptions())
    assert [notice.code for notice in robot.notices].count("law-leaves-limits") == count


def test_a_leader_bears_what_its_followers_do() -> None:
    """By the virtual work: the load of `lift` is its own, half that of `first` and that of `wrist`."""
    limits = {joint.name: joint.limits for joint in alpha_swap(arm(), AlphaSwapOptions()).joints}
    bounded = [replace(row, limits=replace(limits[row.joint], effort=None)) for row in free(arm()).rows]
    alone, efforts = (
        {joint.name: joint.limits.effort or 0.0 for joint in alpha_swap(each, AlphaSwapOptions()).joints}
        for each in (replace(arm(), rows=tuple(bounded)), arm())
    )
    wanted = alone["lift"] + 0.5 * alone["first"] + 1.0 * alone["wrist"]
    assert efforts["lift"] == pytest.approx(wanted, rel=0.05)  # each is rounded up to two digits
    assert {name: efforts[name] for name in ("wrist", "first", "turn", "slide")} == {
        name: alone[name] for name in ("wrist", "first", "turn", "slide")
    }


# --- A description beside a table ------------------------------------------------------------------------------------


def test_a_table_is_compared_with_its_own_description() -> None:
    table = arm()
    robot = alpha_swap(table, AlphaSwapOptions())
    assert compare(robot, table).holds
    other = arm(wrist=Follower("first", -2.0, 0.2))
    assert not compare(robot, other).holds
    assert "wrist" in (compare(robot, other).first_difference or "")
    assert not compare(robot, free(table)).holds


def test_the_corrected_table_has_the_laws_of_the_description() -> None:
    """Of a table whose wrist counts the other way, the law has to have the other sign."""
    table = arm()
    robot = alpha_swap(table, AlphaSwapOptions())
    turned = [
        replace(row, sign=-row.sign, follows=Follower("first", 2.0, -0.1)) if row.joint == "wrist" else row
        for row in table.rows
    ]
    found = compare(robot, replace(table, rows=tuple(turned)))
    assert not found.holds
    assert found.corrected is not None
    for q in vectors(4):
        assert np.abs(found.corrected.fk(q) - table.fk(q)).max() < 1e-6
    assert any(
        "follows: -lift - 0.3" in change for change in changes(replace(table, rows=tuple(turned)), found.corrected)
    )


# --- Pictures and cells -----------------------------------------------------------------------------------------------


@CONVENTIONS
def test_a_drawing_has_the_pose_at_zero(convention: str) -> None:
    """That of the table and that of its robot, where followers are at the offsets of their laws."""
    table = arm(convention)
    wanted = table.fk([0.0] * 3)[:3, 3]
    tips = (
        arm_skeleton(ExpectedPoses.of(table).tips[0]).tips[0],
        robot_skeleton(alpha_swap(table, AlphaSwapOptions())).tips[-1],
    )
    for tip in tips:
        assert np.abs(np.array(tip) - wanted).max() < 1e-12


@CONVENTIONS
def test_an_arm_stands_on_a_link_whose_leader_is_behind_it(convention: str) -> None:
    """The second arm of a cell is on the link of `first`, which follows `lift`: a joint that is no part of its way."""
    table = arm(convention)
    robot = alpha_swap(table, AlphaSwapOptions())
    arms = (
        ArmCall(name="low", of="arm", prefix="low_", mark=Mark(file="run.yaml", line=2)),
        ArmCall(
            name="top",
            of="arm",
            prefix="top_",
            parent="low",
            link="l1",
            placement=Origin(xyz=(0.1, 0.2, 0.3)),
            mark=Mark(file="run.yaml", line=3),
        ),
    )
    cell = Cell(call=CellCall(name="cell", arms=arms, mark=Mark(file="run.yaml", line=1)), manipulators={"arm": table})
    stated, made = expected_poses_of(cell, {"arm": robot}), compose(cell, {"arm": robot})
    assert stated.joints == tuple(f"{prefix}_{name}" for prefix in ("low", "top") for name in ("rail", "lift", "turn"))
    top = stated.tips[1]
    assert top.columns == {"low_lift": 1, "top_rail": 3, "top_lift": 4, "top_turn": 5}
    written = parse_urdf(urdf(made), "cell")
    assert prove(stated, written, proof_vectors(stated, made, 6)).holds
    q = RNG.uniform(-1, 1, 6)
    ends = made.fk_all(dict(zip(stated.joints, q, strict=True)))
    held = made.fk_all(dict(zip(stated.joints, [0.0, q[1], 0.0, *q[3:]], strict=True)))
    assert np.abs(ends["top_tool0"] - held["top_tool0"]).max() < 1e-12
    assert np.abs(ends["top_tool0"] - as_matrices(top.pose(q))).max() < 1e-12
