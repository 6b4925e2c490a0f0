import math
import random
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from any_tables import transforms
from hypothesis import given, settings, strategies as st

from dh2urdf.columns import RobotColumns, column, in_columns
from dh2urdf.conversion.one_manipulator import Call
from dh2urdf.conversion.robots import make_robot
from dh2urdf.errors import ProofError
from dh2urdf.kinematics import KinematicChain, angle_error, position_error
from dh2urdf.kinematics.expected_poses import ExpectedPoses, proof_vectors
from dh2urdf.kinematics.proof import TOGETHER, Proof, prove, prove_columns
from dh2urdf.manipulator import Convention, DHRow, JointType, Limits, Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.plugin_system.options import make_options
from dh2urdf.robot import Robot
from dh2urdf.rotations import RigidTransform, is_column
from dh2urdf_plugins.formats.urdf.reader import parse_urdf
from dh2urdf_plugins.formats.urdf.scanner import scan_columns
from reference_arms import ReferenceRobot

CATALOG = load()
COUNT = 6
FRAMES = ("aligned", "dh")


def made(table: Manipulator, frames: str = "aligned") -> Robot:
    stage = CATALOG.get("transform", "alpha-swap")
    options = make_options(stage.options, {"frames": frames}, mark=None, where="")
    return make_robot(table, Call(stage=stage, options=options))


def urdf(robot: Robot) -> bytes:
    stage = CATALOG.get("emitter", "urdf")
    (file,) = stage.emit(robot, robot.name, stage.options())
    content: bytes = file.content
    return content


def side_by_side(robots: Sequence[Robot]) -> RobotColumns:
    """The limits of robots of one kind as columns."""

    def limits(index: int) -> Limits:
        every = [robot.joints[index].limits for robot in robots]
        return Limits(lower=column([each.lower for each in every]), upper=column([each.upper for each in every]))

    joints = tuple(replace(joint, limits=limits(index)) for index, joint in enumerate(robots[0].joints))
    return RobotColumns(
        robot=replace(robots[0], joints=joints),
        names=tuple(robot.name for robot in robots),
        comments=tuple(robot.comment for robot in robots),
        sure=np.ones(len(robots), dtype=bool),
    )


def proved(
    tables: Sequence[Manipulator], robots: Sequence[Robot], files: Sequence[bytes] | None = None, count: int = COUNT
) -> list[Proof | ProofError | None]:
    """The proofs of files, those of the robots where no others are given."""
    [(_, columns)] = in_columns(tables)
    written = scan_columns([urdf(robot) for robot in robots] if files is None else files)
    return prove_columns(columns, side_by_side(robots), written, count)


def proved_alone(table: Manipulator, robot: Robot, file: bytes) -> Proof:
    expected = ExpectedPoses.of(table)
    return prove(expected, parse_urdf(file, robot.name), proof_vectors(expected, robot, COUNT))


def test_every_published_robot(reference_robot: ReferenceRobot) -> None:
    """The files of all of them, in both frames, are proved to the last digits."""
    table = reference_robot.manipulator
    for frames in FRAMES:
        robot = made(table, frames)
        (proof,) = proved([table], [robot])
        assert isinstance(proof, Proof)
        alone = proved_alone(table, robot, urdf(robot))
        assert proof.holds
        assert proof.position_error < 1e-5 * proof.tolerance
        assert proof.angle_error < 1e-13
        assert (proof.poses, proof.tolerance, proof.tip) == (alone.poses, alone.tolerance, alone.tip)
        assert proof.q in proof_vectors(ExpectedPoses.of(table), robot, COUNT)


# --- Wrong files ------------------------------------------------------------------------------------------------------


def numbers_on_the_way(content: bytes, names: bytes = b"xyz|rpy") -> list[tuple[int, int]]:
    """Where the numbers of origins and axes are in the joints from base_link to tool0, flange aside."""
    found = []
    for joint in re.finditer(rb"<joint .*?</joint>", content, re.DOTALL):
        if b'<child link="flange"' in joint[0]:
            continue
        for value in re.finditer(rb' (?:%b)="(.*?)"' % names, joint[0]):
            for number in re.finditer(rb"[^ ]+", value[1]):
                start = joint.start() + value.start(1)
                found.append((start + number.start(), start + number.end()))
    return found


def another_digit(text: bytes, rnd: random.Random) -> bytes:
    """A number with another digit in the place of one of its own."""
    place = rnd.choice([place for place, byte in enumerate(text) if byte in b"0123456789"])
    digit = rnd.choice([d for d in b"0123456789" if d != text[place]])
    return text[:place] + bytes([digit]) + text[place + 1 :]


def another_sign(text: bytes, _rnd: random.Random) -> bytes:
    return text.removeprefix(b"-") if text.startswith(b"-") else b"-" + text


def a_little_more(text: bytes, _rnd: random.Random) -> bytes:
    return repr(float(text) + 1e-6).encode()


@pytest.mark.parametrize("change", [another_digit, another_sign, a_little_more])
def test_one_wrong_number_is_found(
    reference_robot: ReferenceRobot, change: Callable[[bytes, random.Random], bytes]
) -> None:
    """No number of an origin or an axis on the way to tool0 may be another, but for its last digits and whole turns."""
    table = reference_robot.manipulator
    rnd = random.Random(reference_robot.id)  # noqa: S311 - the same on every machine
    for frames in FRAMES:
        robot = made(table, frames)
        content = urdf(robot)
        files, differences = [], []
        for start, end in numbers_on_the_way(content):
            text = change(content[start:end], rnd)
            difference = abs(float(text) - float(content[start:end]))
            if difference != 2 * math.pi:
                differences.append(difference)
                files.append(content[:start] + text + content[end:])
        proofs = proved([table] * len(files), [robot] * len(files), files)
        assert sum(map(bool, differences)) > len(table.rows)
        for difference, proof, file in zip(differences, proofs, files, strict=True):
            if proof is None:  # a leading zero: the slow reader's
                proof = proved_alone(table, robot, file)  # noqa: PLW2901
            assert isinstance(proof, Proof)
            assert not proof.holds or difference < 50 * proof.tolerance, (difference, proof)


lengths = st.just(0.0) | st.floats(-2, 2)
angles = st.sampled_from([k * math.pi / 2 for k in range(-4, 5)]) | st.floats(-2 * math.pi, 2 * math.pi)


@st.composite
def kinds_of_arms(draw: st.DrawFn) -> list[Manipulator]:
    """Several arms that differ in numbers only, some numbers of which are alike."""
    kinds = draw(st.lists(st.sampled_from(JointType), min_size=1, max_size=5))
    signs = [draw(st.sampled_from([1, -1])) if kind is not JointType.FIXED else 1 for kind in kinds]
    limited = [draw(st.booleans()) and kind in (JointType.REVOLUTE, JointType.PRISMATIC) for kind in kinds]
    common = [(draw(lengths), draw(angles), draw(lengths), draw(angles)) for _ in kinds]
    convention, base = draw(st.sampled_from(Convention)), draw(transforms(lengths))
    tool = draw(transforms(lengths))

    def row(n: int) -> DHRow:
        a, alpha, d, theta = (
            number if draw(st.booleans()) else draw(strategy)
            for number, strategy in zip(common[n], (lengths, angles, lengths, angles), strict=True)
        )
        lower, upper = sorted((draw(st.floats(-3, 3)), draw(st.floats(-3, 3)))) if limited[n] else (None, None)
        return DHRow(
            joint=f"joint_{n}",
            link=f"link_{n}",
            type=kinds[n],
            a=a,
            alpha=alpha,
            d=d,
            theta=theta,
            offset=draw(angles) if kinds[n] is not JointType.FIXED else 0.0,
            sign=signs[n],
            limits=Limits(lower=lower, upper=upper),
        )

    return [
        Manipulator(
            name=f"arm_{k}", convention=convention, rows=tuple(row(n) for n in range(len(kinds))), base=base, tool=tool
        )
        for k in range(draw(st.integers(1, 5)))
    ]


@settings(max_examples=60)
@given(tables=kinds_of_arms(), frames=st.sampled_from(FRAMES))
def test_any_arms_are_proved(tables: list[Manipulator], frames: str) -> None:
    """Both conventions and all types of joints: what is written is the DH product, to rounding."""
    for proof in proved(tables, [made(table, frames) for table in tables]):
        assert isinstance(proof, Proof)
        assert proof.position_error < 1e-4 * proof.tolerance
        assert proof.angle_error < 1e-13


@settings(max_examples=60)
@given(tables=kinds_of_arms(), frames=st.sampled_from(FRAMES), data=st.data())
def test_the_figures_are_those_of_the_proof_of_one(tables: list[Manipulator], frames: str, data: st.DataObject) -> None:
    """However wrong a file is, the errors are those that the formulas for one arm give at the joint vector named."""
    robots = [made(table, frames) for table in tables]
    files = []
    for content in map(urdf, robots):
        start, end = data.draw(st.sampled_from(numbers_on_the_way(content)))
        files.append(content[:start] + repr(data.draw(st.floats(-3, 3))).encode() + content[end:])
    for table, robot, file, proof in zip(tables, robots, files, proved(tables, robots, files), strict=True):
        assert isinstance(proof, Proof)
        alone = proved_alone(table, robot, file)
        assert proof.position_error == pytest.approx(alone.position_error, rel=1e-9, abs=1e-13)
        assert proof.tolerance == alone.tolerance
        assert proof.poses == alone.poses
        assert proof.q in proof_vectors(ExpectedPoses.of(table), robot, COUNT)
        tip = ExpectedPoses.of(table).tips[0]
        said, found = tip.pose(proof.q), KinematicChain.between(parse_urdf(file, "arm")).forward_kinematics(proof.q)
        assert position_error(said, found) == pytest.approx(proof.position_error, rel=1e-9, abs=1e-13)
        if all(joint.type in (JointType.FIXED, JointType.PRISMATIC) for joint in robot.joints):
            assert proof.angle_error == pytest.approx(alone.angle_error, abs=1e-7)
            assert angle_error(said, found) <= proof.angle_error + 1e-7


# --- What is beside an arm changes nothing ------------------------------------------------------------------------


def many(count: int) -> list[Manipulator]:
    """Arms of one kind whose numbers are the same for all, for some or for none."""
    rnd = random.Random(4)  # noqa: S311 - the same on every machine
    quarters = [0.0, math.pi / 2, -math.pi / 2, math.pi]

    def row(n: int, k: int) -> DHRow:
        lower, upper = (-rnd.uniform(0.5, 3), rnd.uniform(0.5, 3)) if n == 2 or k % 3 == 0 else (-2.5, 2.0)
        return DHRow(
            joint=f"joint_{n}",
            link=f"link_{n}",
            type=(JointType.REVOLUTE, JointType.REVOLUTE, JointType.PRISMATIC, JointType.FIXED, JointType.REVOLUTE)[n],
            a=rnd.choice([0.0, 1.0, rnd.uniform(0.1, 0.5)]),
            alpha=rnd.choice([*quarters, rnd.uniform(-3, 3)]) if n else math.pi / 2,
            d=rnd.choice([0.0, rnd.uniform(0.1, 0.5)]),
            theta=rnd.choice([0.0, math.pi / 2, rnd.uniform(-3, 3)]) if n != 1 else 0.0,
            offset=rnd.choice([0.0, rnd.uniform(-1, 1)]) if n in (0, 2) else 0.0,
            sign=-1 if n == 4 else 1,
            limits=Limits(lower=lower, upper=upper) if n != 3 else Limits(),
        )

    tool = RigidTransform.from_xyz_rpy((0.1, 0.0, 0.2), (0.3, 0.0, -1.0))
    return [
        Manipulator(name=f"arm_{k}", convention=Convention.STANDARD, rows=tuple(row(n, k) for n in range(5)), tool=tool)
        for k in range(count)
    ]


@pytest.mark.parametrize("frames", FRAMES)
@pytest.mark.parametrize("convention", Convention)
def test_an_arm_has_the_same_figures_in_every_batch(convention: Convention, frames: str) -> None:
    """Alone, among few, among so many that not all joint vectors are walked together, in any order: the proof is the same to the last bit."""
    count = 32
    total = TOGETHER // (3 + count) + 14
    tables = [replace(table, convention=convention) for table in many(total)]
    robots = [made(table, frames) for table in tables]
    files = [urdf(robot) for robot in robots]
    files[5] = files[5].replace(b'xyz="0 0 ', b'xyz="0 0.125 ', 1)
    whole = proved(tables, robots, files, count)
    assert {type(proof) for proof in whole} == {Proof}

    def of(members: Sequence[int]) -> list[Any]:
        return proved(*([every[member] for member in members] for every in (tables, robots, files)), count)  # type: ignore[arg-type]

    for size in (1, 7, 100):
        for first in range(0, 21, size):
            members = range(first, first + size)
            assert of(members) == [whole[member] for member in members]
    shuffled = random.Random(1).sample(range(total), total)  # noqa: S311 - the same on every machine
    assert of(shuffled) == [whole[member] for member in shuffled]
    alike = [5] * 3
    assert of(alike) == [whole[5]] * 3


# --- What cannot be proved --------------------------------------------------------------------------------------------

PLAIN = many(4)


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        (b'name="joint_1"', b'name="other"', "other-joints-move"),
        (b'"joint_2" type="prismatic"', b'"joint_2" type="fixed"', "other-joints-move"),
        (b'<child link="tool0"/>', b'<child link="tip"/>', "no-way"),
    ],
)
def test_a_chain_that_does_not_match_fails_alone(old: bytes, new: bytes, code: str) -> None:
    """What does not have the table's moving joints is an error with the name of its arm; the others are proved."""
    robots = [made(table) for table in PLAIN]
    files = [urdf(robot) for robot in robots]
    for member in (1, 2):
        assert old in files[member]
        files[member] = files[member].replace(old, new)
    proofs = proved(PLAIN, robots, files)
    for member, proof in enumerate(proofs):
        assert isinstance(proof, ProofError if member in (1, 2) else Proof)
        if isinstance(proof, ProofError):
            assert (proof.problems[0].code, proof.problems[0].robot) == (code, f"arm_{member}")


def test_what_is_not_a_number_is_an_infinite_error() -> None:
    """A length or an axis that overflows or is no number is never a proof, and costs the others nothing."""
    [(_, columns)] = in_columns(PLAIN)
    robots = [made(table) for table in PLAIN]
    ((places, read),) = scan_columns([urdf(robot) for robot in robots])
    whole = prove_columns(columns, side_by_side(robots), [(places, read)], COUNT)
    for wrong in (math.nan, math.inf, 1e308):
        for field in ("origin", "axis"):
            joint = read.joints[1]
            numbers = joint.origin.xyz if field == "origin" else joint.axis
            first = np.array(np.broadcast_to(numbers[0], len(PLAIN)) if is_column(numbers[0]) else [numbers[0]] * 4)
            first[2] = wrong
            changed = (first, *numbers[1:])
            broken = (
                replace(joint, axis=changed)
                if field == "axis"
                else replace(joint, origin=replace(joint.origin, xyz=changed))
            )
            robot = replace(read, joints=(read.joints[0], broken, *read.joints[2:]))
            proofs = prove_columns(columns, side_by_side(robots), [(places, robot)], COUNT)
            bad = proofs[2]
            assert isinstance(bad, Proof)
            assert not bad.holds
            assert bad.position_error == math.inf
            assert (bad.angle_error == math.inf) is (field == "axis")
            assert [proofs[k] for k in (0, 1, 3)] == [whole[k] for k in (0, 1, 3)]
