"""The extracted table against engines that share nothing with this project, on the description as it is written."""

import random
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from pinocchio_frames import pinocchio_frames
from random_chains import random_chain

import dh2urdf
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.robot import Joint

CHAINS = 12


def description(joints: list[Joint]) -> str:
    """The URDF of a chain, written here."""
    text = ['<robot name="arm"><link name="base"/>']
    parent = "base"
    for joint in joints:
        xyz, rpy, axis = (" ".join(map(repr, each)) for each in (joint.origin.xyz, joint.origin.rpy, joint.axis))
        kind = "fixed" if joint.type is JointType.FIXED else joint.type.value
        limit = '<limit lower="-3" upper="3" effort="1" velocity="1"/>' if kind != "fixed" else ""
        text.append(
            f'<link name="{joint.child}"><inertial><mass value="1"/>'
            '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="{joint.name}" type="{kind}"><parent link="{parent}"/><child link="{joint.child}"/>'
            f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>{limit}</joint>'
        )
        parent = joint.child
    return "".join([*text, "</robot>"])


@pytest.mark.parametrize("convention", list(Convention))
def test_pinocchio(tmp_path: Path, convention: Convention) -> None:
    """Its pose of the tip is that of the table; it reads rpy with 1e-15 and a continuous joint as cosine and sine."""
    for number in range(CHAINS):
        draw = random.Random(f"pinocchio {number}")  # noqa: S311 - reproducible on purpose
        path, joints = tmp_path / f"{number}.urdf", random_chain(draw)
        path.write_text(description(joints))
        arm = dh2urdf.extract(path, convention=str(convention), tolerance=1e-12)
        frame = pinocchio_frames(path)
        for _ in range(4):
            q = {joint.name: draw.uniform(-2, 2) for joint in joints if joint.type is not JointType.FIXED}
            wanted = frame(q, joints[-1].child)
            size = max(1.0, np.abs(wanted).max())
            assert np.abs(wanted - arm.fk([*q.values()])).max() < 2e-12 * size, f"chain {number}"


@pytest.mark.skipif(not find_spec("mujoco"), reason="mujoco is not installed")
def test_mujoco() -> None:
    """MuJoCo's pose of the tip, of an MJCF whose joints are apart from their bodies' origins."""
    import mujoco

    path = Path(__file__).parent / "files" / "joints_apart.xml"
    arm = dh2urdf.extract(path)
    assert [row.joint for row in arm.rows] == ["j1", "j2", "j3"]
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    draw = random.Random("mujoco")  # noqa: S311 - reproducible on purpose
    for _ in range(10):
        data.qpos[:] = [draw.uniform(-1, 1) for _ in range(3)]
        mujoco.mj_kinematics(model, data)
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = data.site("tool0").xmat.reshape(3, 3), data.site("tool0").xpos
        assert np.abs(pose - arm.fk(data.qpos)).max() < 1e-9
