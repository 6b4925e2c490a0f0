"""Parts of run files: robots from descriptions, as they are, in cells beside manipulators."""

from pathlib import Path

import numpy as np
import pytest
import two_fingers
from plain_frames import shift, turn
from two_fingers import TWO_JOINTS as TABLE, hand_frames

import dh2urdf
from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.robot import Robot
from dh2urdf.testing.oracle import table_pose
from dh2urdf_plugins.formats import read_mjcf, read_sdf, read_urdf

HAND = two_fingers.HAND.read_text("utf-8")
BODY = '<inertial><mass value="{}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
LIFT = f"""<robot name="lift"><link name="base_link">{BODY.format(20)}</link><link name="carriage">{BODY.format(5)}</link>
<link name="plate"/><joint name="up" type="prismatic"><parent link="base_link"/><child link="carriage"/>
<origin xyz="0.1 0 0.2" rpy="0.1 0 0"/><axis xyz="0 0 1"/><limit lower="0" upper="0.5" effort="1000" velocity="1"/></joint>
<joint name="on_top" type="fixed"><parent link="carriage"/><child link="plate"/><origin xyz="0 0.3 0.1"/></joint></robot>"""
RUN = """
inputs: arm.csv
parts:
- {name: lift, file: lift.urdf}
- {name: gripper, file: hand.urdf}
cells:
- name: cell
  arms:
  - {name: hand, of: gripper, parent: arm/tool0, xyz: [0, 0, 11 mm], rpy: [0, 0, 30 deg]}
  - {name: arm, of: arm, parent: base/plate, xyz: [0.2, 0, 0]}
  - {name: base, of: lift, xyz: [0, 1, 0]}
  - {name: eye, of: gripper, parent: hand/tool0}
emitters: [urdf, mjcf, sdf]
output: out
"""
READERS = {".urdf": read_urdf, ".sdf": read_sdf, ".xml": read_mjcf}


@pytest.fixture(name="made", scope="module")
def _made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a cell on a lift, with a hand and another one on that."""
    folder = tmp_path_factory.mktemp("parts")
    write(folder, RUN)
    dh2urdf.run(folder / "run.yaml")
    return folder / "out"


def write(folder: Path, run: str) -> None:
    for name, text in (("arm.csv", TABLE), ("lift.urdf", LIFT), ("hand.urdf", HAND), ("run.yaml", run)):
        (folder / name).write_text(text, "utf-8")


@pytest.mark.parametrize("suffix", READERS)
def test_every_link_is_where_the_files_have_it(suffix: str, made: Path) -> None:
    """The lift moves the arm, and the arm the hands; the fingers of each hand follow their own leader."""
    robot: Robot = READERS[suffix](made / f"cell{suffix}")
    table = dh2urdf.read(made.parent / "arm.csv")
    for lift, one, two, left in ((0.0, 0.0, 0.0, 0.0), (0.4, 0.7, -1.1, 0.5), (0.1, -2.0, 0.4, -0.3)):
        q = {"base_up": lift, "arm_one": one, "arm_two": two, "hand_left": left, "eye_left": -left}
        found = {name: as_matrices(pose) for name, pose in link_poses(robot, q).items()}
        carriage = shift(0.1, 1, 0.2) @ turn("x", 0.1) @ shift(z=lift)
        tool = carriage @ shift(0.2, 0.3, 0.1) @ table_pose(table, (one, two))
        hand = tool @ shift(z=0.011) @ turn("z", np.radians(30.0))
        for link, wanted in {
            "base_carriage": carriage,
            "arm_tool0": tool,
            **{f"hand_{name}": hand @ frame for name, frame in hand_frames(left).items()},
            **{f"eye_{name}": hand @ shift(z=0.1) @ frame for name, frame in hand_frames(-left).items()},
        }.items():
            assert np.allclose(found[link], wanted, atol=1e-12), link


def test_mujoco_has_all_the_masses(made: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(made / "cell.xml"))
    arm = read_urdf(made / "arm.urdf").mass
    assert model.body_mass.sum() == pytest.approx(arm + 25.0 + 2 * 0.9, rel=1e-12)


def test_the_efforts_of_the_arm_carry_both_hands(made: Path) -> None:
    alone, laden = read_urdf(made / "arm.urdf"), read_urdf(made / "cell.urdf")
    efforts = {joint.name: joint.limits.effort for joint in laden.joints}
    for joint in alone.actuated_joints:
        assert efforts[f"arm_{joint.name}"] > (joint.limits.effort or 0.0) + 2 * 9.81 * 1.8 * 0.3


def test_variants_have_it_and_a_changed_part_makes_them_anew(tmp_path: Path) -> None:
    """Each variant of an arm has a cell of its own with the hand; what did not change is kept."""
    run = (
        RUN[: RUN.index("cells:")]
        + """
variations: [{name: longer, of: arm, count: 3, vary: [{field: a, joints: 1, uniform: [0.2, 0.5]}]}]
cells:
- name: cell
  arms:
  - {name: arm, of: longer}
  - {name: hand, of: gripper, parent: arm/tool0}
  - {name: lift, of: lift, xyz: [2, 0, 0]}
emitters: urdf
output: out
"""
    )
    write(tmp_path, run)
    dh2urdf.run(tmp_path / "run.yaml")
    robots = [read_urdf(tmp_path / "out" / f"cell_{number}.urdf") for number in (1, 2, 3)]
    lengths = {float(link_poses(robot, {})["arm_tool0"].translation[0]) for robot in robots}
    assert len(lengths) == 3
    assert all("hand_left_finger" in {link.name for link in robot.links} for robot in robots)

    def written_again() -> set[str]:
        files = [*(tmp_path / "out").glob("*.urdf")]
        before = {path.name: path.stat().st_mtime_ns for path in files}
        dh2urdf.run(tmp_path / "run.yaml", resume=True)
        return {path.name for path in files if path.stat().st_mtime_ns != before[path.name]}

    assert written_again() == set()
    (tmp_path / "run.yaml").write_text(run.replace("hand.urdf}", "hand.urdf, srdf: hand.srdf}"))
    srdf = '<robot name="hand"><passive_joint name="left"/></robot>'
    (tmp_path / "hand.srdf").write_text(srdf)
    assert written_again() == {f"cell_{number}.urdf" for number in (1, 2, 3)}
    assert written_again() == set()
    (tmp_path / "hand.srdf").write_text(srdf.replace("left", "right"))
    assert written_again() == {f"cell_{number}.urdf" for number in (1, 2, 3)}
    (tmp_path / "hand.urdf").write_text(HAND.replace('mass value="0.6"', 'mass value="0.7"'), "utf-8")
    assert written_again() == {f"cell_{number}.urdf" for number in (1, 2, 3)}
    assert read_urdf(tmp_path / "out" / "cell_2.urdf").mass == pytest.approx(robots[1].mass + 0.1, rel=1e-12)
