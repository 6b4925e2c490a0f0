"""The exact variant is the arm of the table: two oracles that share nothing with it say so."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from any_tables import ANGLES, LENGTHS, manipulators
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from pinocchio_frames import pinocchio_frames
from plain_frames import turn

from dh2urdf.fields import replace_unchecked
from dh2urdf.kinematics import KinematicChain
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.robot import Box, Cylinder, Origin, Robot
from dh2urdf.robot_check import check_robot
from dh2urdf.rotations import RigidTransform
from dh2urdf.testing.oracle import robot_pose, table_pose
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.formulas import Quantity, length_of
from dh2urdf_plugins.transforms.robots import alpha_swap
from reference_arms import ReferenceRobot

FRAMES = pytest.mark.parametrize("frames", ["aligned", "dh"])
SHAPES = ("cylinder", "box", "capsule", "arm")


def tree_pose(robot: Robot, q: Sequence[float], tip: str = "tool0") -> NDArray[np.float64]:
    return robot_pose(robot, q, "base_link", tip)


# Formulas, read as Python reads them.

FUNCTIONS = {name: getattr(math, name) for name in ("sin", "cos", "atan2")} | {"abs": abs, "max": max, "min": min}


def value_of(formula: str, names: Mapping[str, Any]) -> float:
    return float(eval(formula, {"__builtins__": {}}, FUNCTIONS | dict(names)))  # noqa: S307 - the project's own text


def evaluated(robot: Robot, names: Mapping[str, Any]) -> Robot:
    """The robot whose joints are where their formulas put them."""

    def place(origin: Origin) -> Origin:
        xyz, rpy = (
            tuple([value_of(formula, names) for formula in formulas]) if formulas else numbers
            for numbers, formulas in ((origin.xyz, origin.xyz_formula), (origin.rpy, origin.rpy_formula))
        )
        return Origin(xyz=xyz, rpy=rpy)  # type: ignore[arg-type]

    return replace(robot, joints=tuple(replace(joint, origin=place(joint.origin)) for joint in robot.joints))


def numbers_with_formulas(robot: Robot) -> Iterator[tuple[float, str]]:
    origins = [joint.origin for joint in robot.joints]
    for link in robot.links:
        for shape in (*link.visuals, *link.collisions):
            origins.append(shape.origin)
            match shape.geometry:
                case Cylinder(length=length, length_formula=str(formula)):
                    yield length, formula
                case Box(size=size, size_formula=(_, _, _) as formulas):
                    yield from zip(size, formulas, strict=True)
    for origin in origins:
        yield from zip(origin.xyz, origin.xyz_formula or (), strict=False)
        yield from zip(origin.rpy, origin.rpy_formula or (), strict=False)


def parameter_values(robot: Robot) -> dict[str, float]:
    return {parameter.name: parameter.value for parameter in robot.parameters}


def joint_vector(manipulator: Manipulator, seed: int) -> list[float]:
    rng = np.random.default_rng(seed)
    return [float(value) for value in rng.uniform(-3, 3, len(manipulator.actuated_rows))]


@given(manipulators(), st.integers(0, 99), st.sampled_from(SHAPES))
def test_the_robot_has_the_kinematics_of_the_table_in_both_frames(
    manipulator: Manipulator, seed: int, shape: str
) -> None:
    """T(base_link → tool0) is the DH product, whatever the convention, the joints, the angles, base and tool."""
    q = joint_vector(manipulator, seed)
    truth = table_pose(manipulator, q)
    for frames in ("aligned", "dh"):
        robot = alpha_swap(manipulator, AlphaSwapOptions(frames=frames, shape=shape))
        np.testing.assert_allclose(tree_pose(robot, q), truth, rtol=0, atol=1e-12)
        assert not [problem for problem in check_robot(robot) if problem.severity == "error"]


@given(manipulators(most=5), st.sampled_from(SHAPES))
def test_formulas_give_the_numbers_to_the_last_bit(manipulator: Manipulator, shape: str) -> None:
    """Whoever evaluates a formula with the parameters' values gets the number beside it."""
    for frames in ("aligned", "dh"):
        robot = alpha_swap(manipulator, AlphaSwapOptions(frames=frames, shape=shape))
        names = parameter_values(robot)
        for number, formula in numbers_with_formulas(robot):
            assert value_of(formula, names) == number, formula


@given(manipulators(most=4), st.data(), st.integers(0, 99))
def test_an_edited_parameter_edits_the_arm(manipulator: Manipulator, data: st.DataObject, seed: int) -> None:
    """With other lengths, in `dh` frames other angles too, the formulas of the old table give the new one's arm."""
    q = joint_vector(manipulator, seed)
    other = tuple(
        replace(row, a=data.draw(LENGTHS), d=data.draw(LENGTHS), alpha=data.draw(ANGLES), theta=data.draw(ANGLES))
        for row in manipulator.rows
    )
    only_lengths = tuple(replace(row, a=new.a, d=new.d) for row, new in zip(manipulator.rows, other, strict=True))
    for frames, edited_rows in (("aligned", only_lengths), ("dh", other)):
        robot = alpha_swap(manipulator, AlphaSwapOptions(frames=frames))
        edited = replace(manipulator, rows=edited_rows)
        names = parameter_values(alpha_swap(edited, AlphaSwapOptions(frames=frames)))
        pose = tree_pose(evaluated(robot, names), q)
        np.testing.assert_allclose(pose, table_pose(edited, q), rtol=0, atol=1e-12)


@FRAMES
@pytest.mark.parametrize("shape", SHAPES)
def test_published_arms_keep_every_rule(reference_robot: ReferenceRobot, frames: str, shape: str) -> None:
    """The check of finished robots has nothing to report about any published table."""
    options = AlphaSwapOptions(frames=frames, shape=shape, base_collision=True)
    assert check_robot(alpha_swap(reference_robot.manipulator, options)) == ()


def all_numbers(value: Any) -> Iterator[float]:
    """Every number of nested records."""
    if isinstance(value, float):
        yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from all_numbers(part)
    elif hasattr(value, "__dataclass_fields__"):
        for name in value.__dataclass_fields__:
            yield from all_numbers(getattr(value, name))


quarters = st.integers(-4, 4).map(lambda k: k * math.pi / 2)


@given(
    st.lists(st.tuples(st.sampled_from([0.0, 0.3, -0.2]), quarters, st.sampled_from([0.0, 0.1, -0.5]), quarters)),
    st.sampled_from(Convention),
    st.tuples(quarters, quarters, quarters),
    st.sampled_from(SHAPES),
)
def test_quarter_turns_leave_no_noise(
    parameters: list[tuple[float, float, float, float]],
    convention: Convention,
    rpy: tuple[float, float, float],
    shape: str,
) -> None:
    """Where all angles are quarter turns, no number of the robot is -0.0, or 6.1e-17 where 0 is meant."""
    table = Manipulator(
        name="arm",
        convention=convention,
        base=RigidTransform.from_xyz_rpy((0.0, 0.0, 0.3), rpy),
        tool=RigidTransform.from_xyz_rpy((0.0, 0.0, 0.1), rpy),
        rows=tuple(
            DHRow(joint=f"j{i}", link=f"l{i}", type=JointType.REVOLUTE, a=a, alpha=alpha, d=d, offset=offset, sign=sign)
            for (i, (a, alpha, d, offset)), sign in zip(
                enumerate([*parameters, (0.1, 0.0, 0.0, 0.0)]), [1, -1] * len(parameters) + [1], strict=False
            )
        ),
    )
    for frames in ("aligned", "dh"):
        robot = alpha_swap(table, AlphaSwapOptions(frames=frames, shape=shape))
        for number in all_numbers((robot.joints, robot.links)):
            assert math.copysign(1, number) > 0 or number < 0, "-0.0"
            assert number == 0 or abs(number) > 1e-12


@pytest.mark.parametrize("convention", Convention)
def test_aligned_axes_are_those_of_the_swap(convention: Convention, table: Callable[..., Manipulator]) -> None:
    """For θ = 0 joint i's axis is (0, -sin A, cos A), A being the sum of α before it; rpy is 0 at every joint."""
    alphas = [0.0, math.pi / 2, math.pi, -math.pi / 2, 0.0, -math.pi / 2, math.pi / 2, math.pi]
    robot = alpha_swap(
        table(*({"alpha": alpha, "d": 0.1} for alpha in alphas), convention=convention), AlphaSwapOptions()
    )
    before = alphas if convention is Convention.MODIFIED else [0.0, *alphas]
    sums = np.cumsum(before)
    for joint, total in zip(robot.moving_joints, sums, strict=False):
        np.testing.assert_allclose(joint.axis, (0, -math.sin(total), math.cos(total)), atol=1e-15)
        assert joint.origin.rpy == (0.0, 0.0, 0.0)


def test_the_ur5_reads_like_one_that_a_person_wrote(ur5: Manipulator) -> None:
    """Aligned frames: origins are the table's lengths, axes are bare signs."""
    robot = alpha_swap(ur5, AlphaSwapOptions())
    assert [joint.origin.xyz for joint in robot.moving_joints] == [
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.089159),
        (-0.425, 0.0, 0.0),
        (-0.39225, 0.0, 0.0),
        (0.0, -0.10915, 0.0),
        (0.0, 0.0, -0.09465),
    ]
    y, z = (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)
    assert [joint.axis for joint in robot.moving_joints] == [z, y, y, y, (0.0, 0.0, -1.0), y]
    assert robot.moving_joints[2].origin.xyz_formula == ("a_2", "-d_2", "0")
    assert robot.moving_joints[4].origin.xyz_formula == ("a_4", "-d_4", "0")


@pytest.mark.parametrize("convention", Convention)
def test_dh_link_frames_are_the_frames_of_the_table(convention: Convention) -> None:
    """Modified: link i's frame is DH frame i; standard: DH frame i-1 turned by q_i."""
    table = Manipulator(
        name="arm",
        convention=convention,
        base=RigidTransform.from_xyz_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6)),
        rows=tuple(
            DHRow(joint=f"j{i}", link=f"l{i}", a=0.1 * i, alpha=0.3 + i, d=0.2, theta=0.7 * i) for i in range(4)
        ),
    )
    robot = alpha_swap(table, AlphaSwapOptions(frames="dh"))
    q = [0.3, -0.7, 1.1, 0.2]
    for i in range(4):
        upto = i + 1 if convention is Convention.MODIFIED else i
        frame = table_pose(replace_unchecked(table, rows=table.rows[:upto]), q[:upto])
        if convention is Convention.STANDARD:
            frame = frame @ turn("z", q[i])
        np.testing.assert_allclose(tree_pose(robot, q, f"l{i}"), frame, atol=1e-14)


@FRAMES
@pytest.mark.parametrize("convention", Convention)
def test_the_frame_base_is_the_dh_frame_before_the_first_row(frames: str, convention: Convention) -> None:
    """On request alone, where the base transform puts it, with a base that turns about all axes."""
    base = RigidTransform.from_xyz_rpy((0.1, -0.2, 0.3), (0.4, -0.5, math.pi))
    rows = (DHRow(joint="j", link="link_1", a=0.3, alpha=0.2, d=0.1, theta=0.5),)
    manipulator = Manipulator(name="arm", convention=convention, rows=rows, base=base)
    assert "base" not in [link.name for link in alpha_swap(manipulator, AlphaSwapOptions(frames=frames)).links]
    robot = alpha_swap(manipulator, AlphaSwapOptions(frames=frames, base_frame=True))
    np.testing.assert_allclose(
        tree_pose(robot, [0.7], "base"), table_pose(replace_unchecked(manipulator, rows=()), []), atol=1e-15
    )
    (link,) = [link for link in robot.links if link.name == "base"]
    assert (link.visuals, link.collisions, link.inertial and link.inertial.mass) == ((), (), 0.0)
    assert [problem for problem in check_robot(robot) if problem.severity == "error"] == []


@FRAMES
@pytest.mark.parametrize("convention", Convention)
def test_the_flange_looks_out_along_x(frames: str, convention: Convention) -> None:
    """The flange is the last DH frame turned by rpy (0, -π/2, -π/2), as in ROS-Industrial; the tool is not in it."""
    table = Manipulator(
        name="arm",
        convention=convention,
        tool=RigidTransform.from_xyz_rpy((0.0, 0.0, 0.2), (0.1, 0.2, 0.3)),
        rows=tuple(DHRow(joint=f"j{i}", link=f"l{i}", a=0.1, alpha=0.3, d=0.2, theta=0.7) for i in range(3)),
    )
    robot = alpha_swap(table, AlphaSwapOptions(frames=frames))
    q = [0.3, -0.7, 1.1]
    last = table_pose(replace(table, tool=RigidTransform.from_xyz_rpy((0.0, 0.0, 0.0))), q)
    expected = last @ turn("z", -math.pi / 2) @ turn("y", -math.pi / 2)
    np.testing.assert_allclose(tree_pose(robot, q, "flange"), expected, atol=1e-14)
    np.testing.assert_allclose(expected[:3, 0], last[:3, 2], atol=1e-15)


def test_links_and_joints_have_the_names_of_the_interface(ur5: Manipulator) -> None:
    """An empty base_link, base_link_inertia fixed to it, the links of the table, flange and tool0 on the last one."""
    robot = alpha_swap(ur5, AlphaSwapOptions())
    links = ["base_link", "base_link_inertia", *(f"link_{i}" for i in range(1, 7)), "flange", "tool0"]
    assert [link.name for link in robot.links] == links
    assert robot.links[0].inertial is None
    assert not robot.links[0].visuals
    assert [(joint.name, joint.parent, joint.child) for joint in robot.joints if joint.type is JointType.FIXED] == [
        ("base_link-base_link_inertia", "base_link", "base_link_inertia"),
        ("link_6-flange", "link_6", "flange"),
        ("link_6-tool0", "link_6", "tool0"),
    ]
    assert [joint.child for joint in robot.joints] == links[1:]


# --- A description of the real arm, by other people and through another library


UR5_JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")


@pytest.fixture
def description() -> Path:
    """The UR5 of the PyPI package example-robot-data."""
    try:
        files = metadata.files("example-robot-data") or ()
    except metadata.PackageNotFoundError:
        pytest.skip("example-robot-data is not installed")
    return next(path.locate() for path in files if path.name == "ur5_robot.urdf").resolve()  # type: ignore[attr-defined,no-any-return]


@pytest.mark.parametrize("frames", ["aligned", "dh"])
def test_with_a_half_turn_at_its_base_the_table_is_the_real_ur5(
    ur5: Manipulator, description: Path, frames: str
) -> None:
    """T(base_link → tool0) of the real description is Rz(π) times the DH product of the paper's table, for every q."""
    frame, joints = pinocchio_frames(description), [f"{name}_joint" for name in UR5_JOINTS]
    half_turn = RigidTransform.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, math.pi))
    chain = KinematicChain.between(alpha_swap(replace(ur5, base=half_turn), AlphaSwapOptions(frames=frames)))
    rng = np.random.default_rng(5)
    for q in (np.zeros(6), *rng.uniform(-2 * math.pi, 2 * math.pi, (50, 6))):
        values = dict(zip(joints, q, strict=True))
        real = np.linalg.inv(frame(values, "base_link")) @ frame(values, "tool0")
        np.testing.assert_allclose(as_matrices(chain.forward_kinematics(list(q))), real, rtol=0, atol=1e-9)


# --- How formulas are written

A, B = Quantity.parameter("a", 0.7), Quantity.parameter("b", -1.3)


def n(value: float) -> Quantity:
    return Quantity(value)


@pytest.mark.parametrize(
    ("quantity", "formula"),
    [
        (n(-0.5) * A, "-0.5*a"),
        (n(-1e-07) * A, "-0.0000001*a"),
        (A + n(-0.25), "a - 0.25"),
        (A - (B + n(1.0)), "a - (b + 1)"),
        ((A + B) * n(0.5), "0.5*(a + b)"),
        ((A * B) * B, "a*b*b"),
        (length_of(B, 0.08, least=0.001), "max(abs(b) - 0.08, 0.001)"),
    ],
)
def test_formulas_are_short_and_give_the_value(quantity: Quantity, formula: str) -> None:
    """What changes nothing is not written, signs are in front, and the value is the formula's."""
    assert quantity.formula == formula
    assert value_of(formula, {"a": 0.7, "b": -1.3}) == quantity.value


@given(
    st.floats(0.0, 1e30)
    | st.floats(0.0, 1e-3)
    | st.sampled_from([1e-6, 2.0**-24, 5e-324, 1e16, 1e23, 1.7976931348623157e308])
)
def test_numbers_have_no_exponents(value: float) -> None:
    """A number in a formula is its shortest decimal text, written out as `decimal` writes it."""
    assert Quantity(value).formula == format(Decimal(repr(value)), "f").removesuffix(".0")
