import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli
from hypothesis import given, strategies as st
from pinocchio_frames import pinocchio_frames

import dh2urdf
from dh2urdf.cells.cell import ArmCall, Cell, CellCall, WantedTables, compose, expected_poses_of
from dh2urdf.cells.numbered_cells import with_tables
from dh2urdf.conversion.one_manipulator import Call
from dh2urdf.conversion.robots import make_item
from dh2urdf.errors import RobotError
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.kinematics.expected_poses import proof_vectors
from dh2urdf.kinematics.proof import prove
from dh2urdf.manipulator import Convention, DHRow, JointType, Limits, Manipulator
from dh2urdf.robot import Joint, Origin, Robot
from dh2urdf.robot_check import check_robot
from dh2urdf.rotations import RigidTransform
from dh2urdf.source import Mark
from dh2urdf.stages import Rejected
from dh2urdf.testing.oracle import robot_pose, table_pose
from dh2urdf_plugins.formats.urdf import EMITTER as URDF
from dh2urdf_plugins.formats.urdf.reader import parse_urdf
from dh2urdf_plugins.formats.xacro import EMITTER as XACRO
from dh2urdf_plugins.formats.xacro.reader import expand
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM, AlphaSwapOptions
from reference_arms import ReferenceRobot

TRACK = Manipulator(
    name="track",
    convention=Convention.STANDARD,
    rows=(
        DHRow(
            joint="slide",
            link="carriage",
            type=JointType.PRISMATIC,
            a=0.0,
            alpha=0.3,
            d=0.1,
            limits=Limits(lower=-1.0, upper=1.0),
        ),
        DHRow(joint="bolt", link="plate", type=JointType.FIXED, a=0.2, alpha=math.pi / 2, d=0.0),
    ),
    base=RigidTransform.from_xyz_rpy((0.0, 0.0, 0.4), (0.0, math.pi / 2, 0.0)),
    tool=RigidTransform.from_xyz_rpy((0.0, 0.05, 0.0), (0.1, 0.2, 0.3)),
)
ARM = Manipulator(
    name="arm",
    convention=Convention.MODIFIED,
    rows=(
        DHRow(joint="pan", link="one", a=0.0, alpha=0.0, d=0.3),
        DHRow(joint="lift", link="two", a=0.1, alpha=-math.pi / 2, d=0.0, offset=0.4, sign=-1),
        DHRow(joint="reach", link="three", a=0.5, alpha=0.7, d=0.2),
    ),
)
TABLES = {"track": TRACK, "arm": ARM}


def cell(*arms: ArmCall, tables: dict[str, Manipulator] | None = None) -> Cell:
    mark = Mark(file="run.yaml", line=3)
    return Cell(call=CellCall(name="cell", arms=arms, mark=mark), manipulators=tables or TABLES)


def call(name: str, of: str, **more: Any) -> ArmCall:
    return ArmCall(name=name, of=of, **{"prefix": f"{name}_", "mark": Mark(file="run.yaml", line=4), **more})


def swap(frames: Any = "aligned") -> Call[Any]:
    return Call(stage=TRANSFORM, options=AlphaSwapOptions(frames=frames))


def robots(tables: dict[str, Manipulator] = TABLES) -> dict[str, Robot]:
    return {name: TRANSFORM.transform(table, AlphaSwapOptions()) for name, table in tables.items()}


ON_TRACK = cell(
    call("track", "track", placement=Origin(xyz=(1.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.5))),
    call("left", "arm", parent="track", link="tool0", placement=Origin(xyz=(0.0, 0.1, 0.0), rpy=(0.0, 0.3, 0.0))),
    call("hand", "arm", parent="left", link="two", placement=Origin(xyz=(0.0, 0.0, 0.2))),
    call("right", "arm", placement=Origin(xyz=(-1.0, 0.0, 0.0))),
)
"""An arm on a track, an arm in the middle of that arm, and one that stands alone."""


class TestCompose:
    def test_there_is_one_root_and_every_name_has_its_prefix(self) -> None:
        """The links are the world and those of every arm, each with the prefix; joints and materials likewise."""
        alone = robots()
        robot = compose(ON_TRACK, alone)
        assert robot.name == "cell"
        assert [link.name for link in robot.links] == [
            "world",
            *(f"{arm.name}_{link.name}" for arm in ON_TRACK.call.arms for link in alone[arm.of].links),
        ]
        joints = [joint.name for joint in robot.joints]
        assert joints[:3] == ["track_base_joint", "track_base_link-base_link_inertia", "track_slide"]
        assert len(joints) == len(set(joints)) == len(robot.links) - 1
        materials = {visual.material.name for link in robot.links for visual in link.visuals if visual.material}
        assert materials
        assert all(name.startswith(("track_", "left_", "hand_", "right_")) for name in materials)
        assert check_robot(robot) == ()

    def test_an_arm_is_what_it_is_alone(self) -> None:
        """Without the prefix, and but for its root's explicit weightlessness, no number of an arm changes."""
        alone = robots()["arm"]
        placed = compose(cell(call("left", "arm", prefix="")), robots())
        assert placed.joints[1:] == alone.joints
        assert placed.links[2:] == alone.links[1:]
        assert alone.links[0].inertial is None
        assert placed.links[1].inertial is not None
        assert placed.links[1].inertial.mass == 0.0

    def test_the_arms_keep_their_formulas_and_the_cell_has_none(self) -> None:
        """Two arms both have an a_1: their parameters stand with their kind, once."""
        robot = compose(ON_TRACK, robots())
        assert robot.parameters == ()
        assert all(joint.origin.xyz_formula is None for joint in robot.joints)
        left, hand, right = robot.arms[1:]
        assert left.kind is hand.kind is right.kind
        assert left.kind.parameters
        assert (hand.prefix, hand.parent) == ("hand_", "left_two")

    def test_names_that_meet_are_named(self) -> None:
        """Different prefixes can still give one name; both arms, and the place of the second, are said."""
        rows = (replace(ARM.rows[0], link="b_one"), *ARM.rows[1:])
        tables = {"arm": ARM, "other": replace(ARM, name="other", rows=rows)}
        both = cell(call("x", "other", prefix="a_"), call("y", "arm", prefix="a_b_"), tables=tables)
        with pytest.raises(RobotError) as caught:
            compose(both, robots(tables))
        (problem,) = caught.value.problems
        assert (problem.code, problem.field, problem.mark) == ("arms-share-a-name", "prefix", call("y", "arm").mark)


# --- The expected poses, against products of textbook matrices ---------------------------------------------


def at(origin: Origin) -> np.ndarray:
    held = Joint(name="held", type=JointType.FIXED, parent="a", child="b", origin=origin)
    return robot_pose(Robot(name="placement", links=(), joints=(held,)), [], "a", "b")


joint_values = st.lists(st.floats(-3, 3), min_size=10, max_size=10)


class TestExpectedPoses:
    @given(q=joint_values)
    def test_an_arm_on_another_arms_tool_is_a_product_of_dh_products(self, q: list[float]) -> None:
        """T(world → tool0) is placement · T_track(q) · placement · T_arm(q), and of an arm on the world its own."""
        stated = expected_poses_of(ON_TRACK, robots())
        track, left, _hand, right = (at(arm.placement) for arm in ON_TRACK.call.arms)
        tips = {tip.link: np.asarray(as_matrices(tip.pose(q))) for tip in stated.tips}
        on_track = track @ table_pose(TRACK, q[:1])
        expected = {
            "track_tool0": on_track,
            "left_tool0": on_track @ left @ table_pose(ARM, q[1:4]),
            "right_tool0": right @ table_pose(ARM, q[7:10]),
        }
        for link, pose in expected.items():
            np.testing.assert_allclose(tips[link], pose, rtol=0, atol=1e-13)

    @given(q=joint_values)
    def test_an_arm_on_a_link_in_the_middle(self, q: list[float]) -> None:
        """With DH frames and the modified convention, link i is DH frame i: an arm on it has the product up to there."""
        alone = {name: TRANSFORM.transform(table, AlphaSwapOptions(frames="dh")) for name, table in TABLES.items()}
        tip = expected_poses_of(ON_TRACK, alone).tips[2]
        track, left, hand, _ = (at(arm.placement) for arm in ON_TRACK.call.arms)
        expected = (
            track
            @ table_pose(TRACK, q[:1])
            @ left
            @ table_pose(replace(ARM, rows=ARM.rows[:2]), q[1:4])
            @ hand
            @ table_pose(ARM, q[4:7])
        )
        assert tip.link == "hand_tool0"
        np.testing.assert_allclose(np.asarray(as_matrices(tip.pose(q))), expected, rtol=0, atol=1e-13)


class TestProof:
    @pytest.mark.parametrize("frames", ["aligned", "dh"])
    @pytest.mark.parametrize("link", ["base_link", "base_link_inertia", "one", "two", "three", "flange", "tool0"])
    def test_it_holds_whatever_link_holds_the_arm(self, frames: str, link: str) -> None:
        """The written file puts every tool0 where the tables have it."""
        made, stated = make_item(cell(call("a", "arm"), call("b", "track", parent="a", link=link)), swap(frames))
        (file,) = URDF.emit(made, "cell", URDF.options())
        proof = prove(stated, parse_urdf(file.content, "cell"), proof_vectors(stated, made, 8))
        assert proof.holds
        assert proof.position_error < 1e-14
        assert set(proof.tips) == {"a_tool0", "b_tool0"}

    def test_a_wrong_placement_is_found_in_the_arm_that_it_moves(self) -> None:
        """The tip of the largest error is named, and the error of every other one said."""
        made, stated = make_item(ON_TRACK, swap())
        moved = tuple(
            replace(joint, origin=Origin(xyz=(-1.0, 0.0, 1e-6))) if joint.name == "right_base_joint" else joint
            for joint in made.joints
        )
        proof = prove(stated, replace(made, joints=moved), proof_vectors(stated, made, 4))
        assert not proof.holds
        assert proof.tip == "right_tool0"
        assert proof.tips["right_tool0"] == pytest.approx(1e-6)
        assert max(error for tip, error in proof.tips.items() if tip != "right_tool0") < 1e-14

    def test_pinocchio_has_every_tool_where_the_tables_have_it(self, tmp_path: Path) -> None:
        """A reader that shares no code with the project, on the file as it is written."""
        made, stated = make_item(ON_TRACK, swap())
        (file,) = URDF.emit(made, "cell", URDF.options())
        (tmp_path / file.name).write_bytes(file.content)
        frame = pinocchio_frames(tmp_path / file.name)
        for q in proof_vectors(stated, made, 5):
            for tip in stated.tips:
                found = frame(dict(zip(stated.joints, q, strict=True)), tip.link)
                np.testing.assert_allclose(found, as_matrices(tip.pose(q)), rtol=0, atol=1e-12)

    def test_published_arms_stand_in_one_cell(self, reference_robots: list[ReferenceRobot]) -> None:
        """All of them at once, each on its place, at the poses that their publishers computed."""
        tables = {robot.id: robot.manipulator for robot in reference_robots if len(robot.manipulator.rows) <= 12}
        arms = [
            call(f"a{number}", name, placement=Origin(xyz=(number, 0.0, 0.0), rpy=(0.1 * number, 0.0, 0.2)))
            for number, name in enumerate(tables)
        ]
        stated = expected_poses_of(cell(*arms, tables=tables), robots(tables))
        published = {robot.id: robot for robot in reference_robots}
        assert len(arms) > 15
        for arm, tip in zip(arms, stated.tips, strict=True):
            robot = published[arm.of]
            for values, pose in zip(robot.q, robot.poses, strict=True):
                q = np.zeros(len(stated.joints))
                q[list(tip.columns.values())] = values
                expected = at(arm.placement) @ np.asarray(pose)
                np.testing.assert_allclose(as_matrices(tip.pose(tuple(q))), expected, rtol=0, atol=1e-9)


# --- The files ---------------------------------------------------------------------------------------------------------


class TestXacro:
    def test_there_is_one_macro_for_each_kind_and_one_call_for_each_arm(self) -> None:
        """The parameters of each kind are there once, too."""
        top, library = XACRO.emit(compose(ON_TRACK, robots()), "cell", XACRO.options())
        assert (top.name, library.name) == ("cell.urdf.xacro", "cell_macro.xacro")
        calls = re.findall(rb'<xacro:(\w+) prefix="(\w+)" parent="(\w+)"', top.content)
        assert calls == [
            (b"track", b"track_", b"world"),
            (b"arm", b"left_", b"track_tool0"),
            (b"arm", b"hand_", b"left_two"),
            (b"arm", b"right_", b"world"),
        ]
        macros = re.findall(rb'<xacro:macro name="(\w+)"', library.content)
        assert macros == [b"track", b"track_at", b"arm", b"arm_at"]
        assert library.content.count(b'<xacro:property name="a_1"') == 2

    def test_a_frame_that_is_no_root_weighs_nothing_explicitly(self, tmp_path: Path) -> None:
        """PyBullet takes a link without inertial for 1 kg, unless it is the root, which must have none for KDL."""
        (tmp_path / "arm_macro.xacro").write_bytes(XACRO.emit(robots()["arm"], "arm", XACRO.options())[1].content)
        scene = tmp_path / "scene.xacro"
        for parent, mass in (("", None), ("world", 0.0)):
            scene.write_text(
                '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="s"><xacro:include filename="arm_macro.xacro"/>'
                f'<link name="world"/><xacro:arm prefix="" parent="{parent}"><origin/></xacro:arm></robot>'
            )
            base = parse_urdf(expand(scene), "scene").links[1]
            assert base.name == "base_link"
            assert (base.inertial and base.inertial.mass) == mass


# --- The run ----------------------------------------------------------------------------------------------------------


class TestGathering:
    CALL = CellCall(name="pair", arms=(call("a", "arm"), call("b", "arm")), mark=Mark(file="run.yaml", line=3))

    def gathered(self, *items: Manipulator | Rejected) -> Cell | Rejected:
        gathering = WantedTables(["arm"])
        for item in items:
            gathering.see(item)
        (found,) = with_tables([self.CALL], gathering)
        return found

    def test_no_manipulator_or_several_fail_the_cell(self) -> None:
        """With what there is, and what was probably meant; it is not guessed which of several is."""
        first, second = (replace(ARM, mark=Mark(file="a.csv", line=line)) for line in (2, 9))
        for items, code, names in (
            ((replace(ARM, name="arms"), TRACK), "made-of-nothing", "'arms'"),
            ((first, second), "made-of-several", "a.csv:9"),
        ):
            found = self.gathered(*items)
            assert isinstance(found, Rejected)
            assert [each.code for each in found.problems] == [code] * 2
            assert all(names in str(each.suggestion) for each in found.problems)

    @pytest.mark.parametrize(
        ("of", "code"),
        [("v_1", "made-of-no-input"), ("d", "made-of-no-input"), ("v_x", "made-of-nothing")],
    )
    def test_what_the_run_makes_itself_is_named_so(self, tmp_path: Path, of: str, code: str) -> None:
        """The name is there, in the folder of the run even; a cell is made of inputs and variations all the same."""
        (tmp_path / "b.csv").write_text("# convention: standard\na,alpha,d\n0.3,0,0\n")
        (tmp_path / "run.yaml").write_text(
            "inputs: b.csv\n"
            "variations: {name: v, of: b, count: 2, vary: [{joints: 1, field: a, uniform: [0.2, 0.4]}]}\n"
            f"cells: [{{name: c, arms: [{{name: l, of: {of}}}]}}, {{name: d, arms: [{{name: l, of: b}}]}}]\n"
        )
        report = dh2urdf.run(tmp_path / "run.yaml", tmp_path / "out")
        (failed,) = [arm for arm in report["manipulators"] if arm["status"] == "failed"]
        assert failed["name"] == "c"
        assert failed["errors"][0]["code"] == code


def report(folder: Path) -> dict[str, Any]:
    entries = json.loads((folder / "report.json").read_bytes())["manipulators"]
    return {entry["name"]: entry for entry in entries}


RUN = """
inputs: [arms.csv]
cells:
  - {name: good, arms: [{name: a, of: one}, {name: b, of: two, parent: a/tool0}]}
  - {name: lost, arms: [{name: a, of: tow}]}
  - {name: bad, arms: [{name: a, of: three}]}
  - {name: heavy, arms: [{name: a, of: four}]}
  - {name: loose, arms: [{name: a, of: one}, {name: b, of: two, parent: a/link_9}]}
"""
ARMS = """# convention: standard
robot,a,alpha,d,mass
one,0.3,0,0.1,1
two,0.4,pi/2,0,1
three,0.4,x,0,1
four,0.4,0,0,1e400
"""


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_cell_that_cannot_be_made_fails_alone(cli: Cli, tmp_path: Path, workers: str) -> None:
    """Every cell is a row of the report, with its reason; all else is made, in any number of processes."""
    (tmp_path / "run.yaml").write_text(RUN)
    (tmp_path / "arms.csv").write_text(ARMS)
    cli("run", "run.yaml", "-o", "out", "--workers", workers, status=1)
    rows = report(tmp_path / "out")
    assert list(rows) == ["one", "two", "three", "four", "good", "lost", "bad", "heavy", "loose"]
    assert {name for name, row in rows.items() if row["status"] == "ok"} == {"one", "two", "good"}
    codes = {name: row["errors"][0]["code"] for name, row in rows.items() if row["errors"]}
    lost, bad, loose = ("made-of-nothing", "not-made", "stands-on-no-link")
    assert [codes[name] for name in ("lost", "bad", "heavy", "loose")] == [lost, bad, bad, loose]
    assert (rows["lost"]["errors"][0]["line"], rows["lost"]["errors"][0]["column"]) == (5, 39)
    assert [error["file"] for error in rows["bad"]["errors"]] == ["run.yaml", "arms.csv"]
    assert (tmp_path / "out" / "good.urdf").is_file()
    assert not (tmp_path / "out" / "loose.urdf").exists()
