"""Robot descriptions as tables: chains and tips, what goes with them, what is left out, and every refusal."""

import dataclasses
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from plain_frames import homogeneous, rpy, shift, turn

import dh2urdf
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.stages import Rejected
from reference_arms import ReferenceRobot

JOINT = """
  <joint name="{name}" type="{type}">
    <parent link="{parent}"/> <child link="{child}"/>
    <origin xyz="{xyz}" rpy="{rpy}"/> <axis xyz="{axis}"/>
    {more}
  </joint>"""
INERTIAL = '<inertial><mass value="{0}"/><inertia ixx="{1}" iyy="{1}" izz="{1}" ixy="0" ixz="0" iyz="0"/></inertial>'
LIMITS = '<limit lower="-2" upper="2.5" effort="80" velocity="1.5"/>'


def joint(
    name: str,
    parent: str,
    child: str,
    *,
    xyz: str = "0 0 0",
    rpy: str = "0 0 0",
    axis: str = "0 0 1",
    type: str = "revolute",  # noqa: A002 - as URDF calls it
    more: str = LIMITS,
) -> str:
    """A joint as URDF."""
    return JOINT.format(name=name, parent=parent, child=child, xyz=xyz, rpy=rpy, axis=axis, type=type, more=more)


def urdf(*elements: str, links: str = "", name: str = "arm") -> str:
    """A URDF of some elements; links that only joints name are added."""
    text = "".join(elements)
    named = dict.fromkeys(re.findall(r'(?:parent|child) link="([^"]+)"', text))
    said = set(re.findall(r'<link name="([^"]+)"', links))
    added = "".join(f'\n  <link name="{each}"/>' for each in named if each not in said)
    return f'<?xml version="1.0"?>\n<robot name="{name}">{links}{added}{text}\n</robot>\n'


PLAIN = (
    joint("hip", "foot", "upper", xyz="0 0 0.1"),
    joint("knee", "upper", "fore", xyz="0.4 0 0", rpy=f"{math.pi / 2} 0 0"),
)
END = joint("end", "fore", "tool0", xyz="0.3 0 0", type="fixed", more="")


def read(tmp_path: Path, text: str, suffix: str = ".urdf", **options: Any) -> Manipulator:
    """The manipulator of a text."""
    path = tmp_path / f"robot{suffix}"
    path.write_text(text, "utf-8")
    return dh2urdf.read(path, **options)


def refusal(tmp_path: Path, text: str, **options: Any) -> str:
    """The code of why a text is no table."""
    with pytest.raises(TableError) as caught:
        read(tmp_path, text, **options)
    return caught.value.problems[0].code


def notices(arm: Manipulator) -> list[str]:
    """The codes of all notices of a manipulator."""
    return [notice.code for notice in arm.notices]


class TestWhatGoesWithTheKinematics:
    def test_limits_and_dynamics(self, tmp_path: Path) -> None:
        more = f'{LIMITS}<dynamics damping="0.5" friction="0.25"/>'
        arm = read(
            tmp_path, urdf(joint("hip", "foot", "upper", more=more), joint("end", "upper", "tool0", type="fixed"))
        )
        (row,) = arm.rows
        limits = dh2urdf.Limits(lower=-2, upper=2.5, effort=80, velocity=1.5)
        assert (row.joint, row.link, row.limits) == ("hip", "upper", limits)
        assert (row.damping, row.friction) == (0.5, 0.25)

    def test_a_continuous_joint_stays_one(self, tmp_path: Path) -> None:
        arm = read(
            tmp_path, urdf(joint("hip", "foot", "upper", type="continuous", more='<limit effort="1" velocity="2"/>'))
        )
        assert arm.rows[0].type == "continuous"
        assert arm.rows[0].limits == dh2urdf.Limits(effort=1, velocity=2)

    def test_values_that_stand_for_unknown_ones_are_left_out(self, tmp_path: Path) -> None:
        more = '<limit lower="-1" upper="1" effort="0" velocity="0"/>'
        arm = read(tmp_path, urdf(joint("hip", "foot", "upper", more=more)))
        assert arm.rows[0].limits == dh2urdf.Limits(lower=-1, upper=1)
        assert notices(arm).count("limit-left-out") == 2

    def test_masses_are_lumped_and_turned(self, tmp_path: Path) -> None:
        """Against numpy: two bodies of one link, seen from the DH frame behind it."""
        inertia = '<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="0.002" iyz="-0.003"/>'
        body = '<inertial><origin xyz="{}" rpy="{}"/><mass value="{}"/>' + inertia + "</inertial>"
        links = (
            '<link name="upper">' + body.format("0.1 0.02 0", "0 0 0", "2") + "</link>"
            '<link name="bracket">' + body.format("0 0 0.05", "0.3 0 0", "1") + "</link>"
        )
        bracket = joint("weld", "upper", "bracket", xyz="0.2 0 0.1", rpy="0 0 0.5", type="fixed", more="")
        arm = read(tmp_path, urdf(*PLAIN, END, bracket, links=links))
        row = arm.rows[0]
        frame = np.array(arm.fk_all([0, 0])["upper"])  # DH frame 1
        tensor = np.array([[0.02, 0.001, 0.002], [0.001, 0.03, -0.003], [0.002, -0.003, 0.04]])
        turned = rpy(0.3, 0, 0.5)[:3, :3]
        pieces = [
            (2.0, np.array([0.1, 0.02, 0.1]), tensor),
            (1.0, np.array([0.2, 0, 0.25]), turned @ tensor @ turned.T),
        ]
        mass = sum(piece[0] for piece in pieces)
        com = sum(piece[0] * piece[1] for piece in pieces) / mass
        whole = np.zeros((3, 3))
        for piece_mass, place, piece in pieces:
            away = place - com
            whole += piece + piece_mass * (away @ away * np.eye(3) - np.outer(away, away))
        R, t = frame[:3, :3], frame[:3, 3]
        wanted = R.T @ whole @ R
        assert row.mass == mass
        assert np.abs(np.array(row.com) - R.T @ (com - t)).max() < 1e-9
        found = row.inertia
        assert found is not None
        rows = [[found.ixx, found.ixy, found.ixz], [found.ixy, found.iyy, found.iyz], [found.ixz, found.iyz, found.izz]]
        assert np.abs(np.array(rows) - wanted).max() < 1e-9
        assert arm.base_mass is None

    @pytest.mark.parametrize("inertial", ["", INERTIAL.format(0, 0)])
    def test_a_link_without_a_mass_beside_others(self, tmp_path: Path, inertial: str) -> None:
        """As the wrists of makers' files, and the frames between the joints of one body in an MJCF."""
        upper = f'<link name="upper">{inertial}</link>'
        arm = read(tmp_path, urdf(*PLAIN, END, links=f'{upper}<link name="fore">{INERTIAL.format(3, 1)}</link>'))
        assert [row.mass for row in arm.rows] == [None, 3]
        assert "masses-missing" in notices(arm)
        assert "masses-missing" not in notices(read(tmp_path, urdf(*PLAIN, END, links=upper)))
        body = '<body><joint name="{}"/>{}<joint name="{}" axis="0 1 0"/><geom size="0.1"/></body>'
        arm = read(tmp_path, f"<mujoco><worldbody>{body.format('a', '', 'b')}</worldbody></mujoco>", ".xml")
        assert notices(arm).count("masses-missing") == 1

    def test_an_inertia_of_no_body_is_left_out(self, tmp_path: Path) -> None:
        links = (
            '<link name="upper"><inertial><mass value="2"/>'
            '<inertia ixx="1" iyy="1" izz="5" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        )
        arm = read(tmp_path, urdf(*PLAIN, END, links=links))
        assert arm.rows[0].inertia is None
        assert "left-out-of-table" in notices(arm)

    def test_a_mesh_is_where_it_was(self, tmp_path: Path) -> None:
        mesh = tmp_path / "meshes" / "upper.stl"
        mesh.parent.mkdir()
        mesh.write_bytes(b"solid a\nendsolid a\n")
        shape = '<origin xyz="0.1 0 0.2" rpy="0 0 0.4"/><geometry><mesh filename="{}" scale="2 2 2"/></geometry>'
        links = (
            f'<link name="upper"><visual>{shape.format("meshes/upper.stl")}</visual>'
            f"<collision>{shape.format('package://other/upper.stl')}</collision></link>"
        )
        arm = read(tmp_path, urdf(*PLAIN, END, links=links))
        visual = arm.rows[0].visual
        assert visual is not None
        assert Path(visual.file.path) == mesh
        assert visual.scale == (2, 2, 2)
        frame = np.array(arm.fk_all([0, 0])["upper"])
        wanted = shift(0.1, 0, 0.3) @ turn("z", 0.4)
        assert np.abs(frame @ homogeneous(visual.pose) - wanted).max() < 1e-12
        assert arm.rows[0].collision is None
        assert "left-out-of-table" in notices(arm)

    def test_names_of_every_description_are_replaced(self, tmp_path: Path) -> None:
        arm = read(tmp_path, urdf(joint("flange", "foot", "base_link"), joint("b", "base_link", "b")), tip_link="b")
        names = [name for row in arm.rows for name in (row.joint, row.link)]
        assert names == ["flange_joint", "base_link_link", "b", "b_link"]
        assert "names-replaced" in notices(arm)
        dh2urdf.convert(arm)


class TestTheChain:
    BRANCHES = (*PLAIN, END, joint("pan", "upper", "camera"), joint("weld", "foot", "sign", type="fixed", more=""))

    LEAVES = urdf(*BRANCHES).replace("tool0", "hand")
    SIDE = joint("pan", "upper", "camera")
    FOLLOWER = joint("finger_2", "upper", "tip", more=f'{LIMITS}<mimic joint="pan"/>')

    @pytest.mark.parametrize("name", ["tool0", "left_tool0", "panda_hand_tcp", "link_tcp"])
    def test_a_usual_tip_is_taken(self, tmp_path: Path, name: str) -> None:
        """Behind a prefix, as of an arm in a cell; a link in the middle of whose name it is is none."""
        arm = read(tmp_path, urdf(*self.BRANCHES).replace("tool0", name).replace("camera", "tool0_camera"))
        assert [row.joint for row in arm.rows] == ["hip", "knee"]
        assert {"chain-extracted", "joints-left-out"} <= {*notices(arm)}

    def test_a_tip_is_chosen(self, tmp_path: Path) -> None:
        assert [row.joint for row in read(tmp_path, self.LEAVES, tip_link="camera").rows] == ["hip", "pan"]

    @pytest.mark.parametrize(
        ("text", "options", "code"),
        [
            (LEAVES, {}, "several-leaves"),
            (urdf(*BRANCHES).replace("tool0", "left_tcp").replace("camera", "right_tcp"), {}, "several-leaves"),
            (urdf(*PLAIN, END), {"tip_link": "tool"}, "link-unknown"),
            (urdf(*PLAIN, END), {"base_link": "tool0", "tip_link": "foot"}, "no-way"),
            (urdf(*PLAIN, END), {"base_link": "fore"}, "chain-without-motion"),
            (urdf(PLAIN[0], SIDE, FOLLOWER), {"tip_link": "tip"}, "joint-not-own"),
            (urdf(*PLAIN, END, joint("rod", "foot", "fore", type="fixed", more="")), {}, "chain-in-loop"),
            (urdf(joint("hip", "a", "b", axis="0 0 0")), {}, "axis-of-length-0"),
            (urdf(joint("hip", "a", "b", more=LIMITS.replace('"2.5"', '"-3"'))), {}, "lower-above-upper"),
        ],
    )
    def test_what_is_no_chain(self, tmp_path: Path, text: str, options: dict[str, str], code: str) -> None:
        assert refusal(tmp_path, text, **options) == code

    def test_every_leaf_in_one_go(self, tmp_path: Path) -> None:
        path = tmp_path / "robot.urdf"
        path.write_text(urdf(*self.BRANCHES))
        found = {item.name: item for item in dh2urdf.read_all(path, tip_link="*")}
        assert list(found) == ["arm_tool0", "arm_camera"]  # No joint moves the link `sign`.
        assert not any(isinstance(item, Rejected) for item in found.values())

    def test_the_chain_may_begin_inside(self, tmp_path: Path) -> None:
        arm = read(tmp_path, urdf(*PLAIN, END), base_link="upper")
        assert [row.joint for row in arm.rows] == ["knee"]

    @pytest.mark.parametrize(
        ("axis", "code"), [("<axis/>", "axis-without-xyz"), ('<axis xyz="0 0 2"/>', "axes-of-other-length")]
    )
    def test_an_odd_axis_is_noticed(self, tmp_path: Path, axis: str, code: str) -> None:
        """Without numbers, Drake takes it for x, urdfdom for 0, and others refuse it; a long one is a direction."""
        text = urdf(joint("hip", "a", "b")).replace('<axis xyz="0 0 1"/>', axis)
        assert code in notices(read(tmp_path, text))


class TestRoundedPi:
    TEXT = urdf(
        joint("hip", "foot", "upper"),
        joint("knee", "upper", "fore", xyz="0.4 0.1 0", rpy="1.5708 0 0"),
        joint("wrist", "fore", "hand", xyz="0.3 0 0.1", rpy="-1.5708 0 0"),
    )

    @pytest.mark.parametrize(
        ("option", "alphas", "code"),
        [("keep", [1.5708, -1.5708, 0], "pi-rounded"), ("repair", [math.pi / 2, -math.pi / 2, 0], "pi-repaired")],
    )
    def test_it_is_kept_or_repaired(self, tmp_path: Path, option: str, alphas: list[float], code: str) -> None:
        arm = read(tmp_path, self.TEXT, rounded_pi=option)
        assert [row.alpha for row in arm.rows] == alphas
        assert code in notices(arm)


class TestFormats:
    def test_all_of_our_own_read_back_as_the_table(self, tmp_path: Path, reference_robot: ReferenceRobot) -> None:
        """Of each published table: every format gives the same table, which gives the same description again."""
        arm = reference_robot.manipulator
        found = {}
        for suffix in (".urdf", ".sdf", ".xml", ".urdf.xacro"):
            path = tmp_path / f"robot{suffix}"
            dh2urdf.convert(arm, path)
            table = dh2urdf.read(path, convention=str(arm.convention), base_link="base_link", tip_link="tool0")
            found[suffix] = kinematics(table)
            assert np.abs(table.fk(reference_robot.q) - np.array(reference_robot.poses)).max() < 2e-8
        assert found[".urdf"] == found[".urdf.xacro"]
        for suffix in (".sdf", ".xml"):
            for one, other in zip(found[suffix], found[".urdf"], strict=True):
                assert one == pytest.approx(other, abs=1e-9)

    @pytest.mark.parametrize("frames", ["aligned", "dh"])
    def test_a_table_of_a_table_is_the_table(
        self, tmp_path: Path, reference_robot: ReferenceRobot, frames: str
    ) -> None:
        """To the last byte, once the first table is one that was extracted."""
        convention = str(reference_robot.manipulator.convention)
        path = tmp_path / "robot.urdf"
        dh2urdf.convert(reference_robot.manipulator, path, frames=frames)
        first = dh2urdf.read(path, convention=convention, tip_link="tool0")
        again = tmp_path / "again.urdf"
        dh2urdf.convert(first, again)
        assert dh2urdf.read(again, convention=convention, tip_link="tool0").to_yaml() == first.to_yaml()

    def test_arguments_of_a_xacro(self, tmp_path: Path) -> None:
        text = urdf(joint("hip", "foot", "upper", xyz="0 0 $(arg height)"), END.replace("fore", "upper"))
        text = text.replace("<robot ", '<robot xmlns:xacro="http://ros.org/wiki/xacro" ').replace(
            "<link", '<xacro:arg name="height" default="0.1"/><link', 1
        )
        for arguments, height in ({}, 0.1), ({"arguments": {"height": "0.7"}}, 0.7):
            assert read(tmp_path, text, ".urdf.xacro", **arguments).rows[0].d == height

    def test_a_file_of_its_own_name_stays_a_description(self) -> None:
        """The studio and `view` open a description as one, though a reader has its suffix."""
        catalog = load()
        assert not any(catalog.is_table(Path(f"arm{suffix}")) for suffix in (".urdf", ".sdf", ".xml", ".xacro"))
        assert catalog.is_table(Path("arm.csv"))


def kinematics(table: Manipulator) -> list[tuple[float, ...]]:
    """The numbers of the rows, and of base and tool."""
    rows = [(row.a, row.alpha, row.d, row.theta) for row in table.rows]
    return [*rows, *((*pose.rotation, *pose.translation) for pose in (table.base, table.tool))]


def test_a_frame_of_a_split_has_no_body(tmp_path: Path) -> None:
    """A fixed row of mass 0: no shape, no mass, in every format; and a table says it."""
    far = urdf(
        joint("a", "foot", "b"),
        joint("b", "b", "c", xyz="0.4 0.2 0", rpy="3e-4 0 0"),
        joint("c", "c", "d", xyz="0 0.3 0.1", type="fixed", more=""),
    )
    arm = read(tmp_path, far, near_parallel="split")
    fixed = arm.rows[1]
    assert (fixed.type, fixed.mass) == ("fixed", 0)
    assert "nearly-parallel-split" in notices(arm)
    conversion = dh2urdf.convert(arm, tmp_path / "split", formats=["urdf", "sdf", "mjcf", "xacro"])
    link = next(link for link in conversion.robot.links if link.name == fixed.link)
    assert not link.visuals
    assert link.inertial is not None
    assert link.inertial.mass == 0
    assert all(proof is not None and proof.position_error < 1e-12 for proof in conversion.proofs.values())
    for text, reader in ((arm.to_yaml(), "yaml"), (arm.to_csv(), "csv")):
        again = dh2urdf.read(text, reader=reader)
        assert dataclasses.replace(again, notices=()) == dataclasses.replace(arm, notices=())
