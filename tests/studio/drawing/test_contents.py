"""The links of a robot and what they consist of, in words."""

from __future__ import annotations

import math

from dh2urdf.manipulator import Inertia, JointType, Limits
from dh2urdf.robot import Box, Collision, Inertial, Joint, Link, Material, Mesh, Origin, Robot, Visual
from dh2urdf.stages.foreign_robot import Follower
from dh2urdf_studio.drawing.scene import Figure
from dh2urdf_studio.view_page import contents


def test_links_from_the_root_with_all_that_they_hold() -> None:
    links = (
        Link(name="tip"),
        Link(
            name="finger",
            inertial=Inertial(mass=0.5, com=(0.0, 0.0, 0.1), inertia=Inertia(ixx=1e-3, iyy=2e-3, izz=1e-3)),
        ),
        Link(
            name="hand",
            visuals=(
                Visual(
                    geometry=Mesh(filename="package://lab/meshes/hand.dae", scale=(0.001, 0.001, 0.001)),
                    origin=Origin(xyz=(0.0, 0.0, 0.2), rpy=(math.pi / 2, 0.0, 0.0)),
                    material=Material(name="white", rgba=(1.0, 1.0, 1.0, 1.0)),
                ),
            ),
            collisions=(Collision(geometry=Box(size=(0.1, 0.2, 0.3))),),
        ),
        Link(name="loose"),
    )
    joints = (
        Joint(name="f", type=JointType.PRISMATIC, parent="hand", child="finger", limits=Limits(lower=0.0, upper=0.04)),
        Joint(
            name="t", type=JointType.REVOLUTE, parent="finger", child="tip", limits=Limits(lower=-math.pi, upper=1.0)
        ),
        Joint(name="l", type=JointType.FIXED, parent="hand", child="loose"),
    )
    figure = Figure(
        robot=Robot(name="gripper", links=links, joints=joints),
        name="gripper/",
        title="gripper",
        followers={"t": Follower("f", -2.0, 0.1, (0.0, -0.5))},
        loose={"l": "floating"},
    )
    found = contents(figure)
    assert found["name"] == "gripper"
    assert {link["node"]: [f"{item['kind']} {item['text']}" for item in link["items"]] for link in found["links"]} == {
        "gripper/hand": [
            "frame the root",
            "visual mesh hand.dae × (0.001, 0.001, 0.001), white, xyz (0, 0, 0.2) m, rpy (90, 0, 0)°",
            "collision box 0.1 × 0.2 × 0.3 m",
        ],
        "gripper/finger": [
            "joint f: prismatic along (0, 0, 1), 0 m to 0.04 m",
            "frame xyz (0, 0, 0) m in hand",
            "mass 0.5 kg at (0, 0, 0.1) m; ixx, iyy, izz (0.001, 0.002, 0.001) kg·m²",
        ],
        "gripper/tip": [
            "joint t: revolute about (0, 0, 1), -180° to 57.3°, follows -2 · f + 0.1 − 0.5 · f³",
            "frame xyz (0, 0, 0) m in finger",
        ],
        "gripper/loose": ["joint l: floating, drawn as fixed", "frame xyz (0, 0, 0) m in hand"],
    }
    assert [link["name"] for link in found["links"]] == ["hand", "finger", "tip", "loose"]
