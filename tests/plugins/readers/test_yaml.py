import json
import math
from collections.abc import Callable

from dh2urdf.manipulator import Convention, Inertia, JointType, LinkGeometry, Manipulator
from dh2urdf.stages import Rejected

FULL = """
name: ur5
convention: standard
units: {length: mm, angle: deg, inertia: kg·m², effort: [Nm, N], damping: [N·m·s/rad, N·s/m]}
base: {xyz: [0, 0, 10], rpy: [0, 0, 180], mass: 4, geometry: {shape: box, radius: 75}}
tool: {xyz: [0, 0, 100]}
defaults: {geometry: {shape: cylinder, radius: 40}, density: 2700, damping: 0.5}
joints:
  - {name: pan, link: shoulder, type: revolute, a: 0, alpha: 90, d: 89.159, theta: q1 + 45,
     limits: {lower: -360, upper: 360, velocity: 180, effort: 150}, mass: 3.7, com: [0, -20, 0],
     inertia: {ixx: 0.01, iyy: 0.01, izz: 0.01, ixy: 0.001}, radius: 60, friction: 1}
  - {name: rail, type: P, a: -425, alpha: 0, d: 10, sign: -1, damping: 0, mass: 1,
     limits: {lower: 0, upper: 500}, inertia: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}
"""


def test_everything_that_a_table_can_say_is_read(read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """Each key comes to its place, in SI units."""
    (arm,) = read(FULL, ".yaml")
    assert isinstance(arm, Manipulator)
    assert (arm.name, arm.convention, arm.density, arm.base_mass) == ("ur5", Convention.STANDARD, 2700.0, 4.0)
    assert arm.geometry == LinkGeometry(shape="cylinder", radius=0.04)
    assert arm.base_geometry == LinkGeometry(shape="box", radius=0.075)
    assert arm.base.translation == (0.0, 0.0, 0.01)
    assert arm.base.rotation == (-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0)
    pan, rail = arm.rows
    assert (pan.joint, pan.link, pan.d, pan.alpha) == ("pan", "shoulder", 0.089159, math.pi / 2)
    assert (pan.theta, pan.offset, pan.limits.upper, pan.limits.velocity) == (0.0, math.pi / 4, 2 * math.pi, math.pi)
    assert (pan.mass, pan.com, pan.radius, pan.damping, pan.friction) == (3.7, (0.0, -0.02, 0.0), 0.06, 0.5, 1.0)
    assert pan.inertia == Inertia(ixx=0.01, iyy=0.01, izz=0.01, ixy=0.001)
    assert (rail.type, rail.a, rail.d, rail.sign, rail.link) == (JointType.PRISMATIC, -0.425, 0.01, -1, "link_2")
    assert (rail.limits.upper, rail.damping) == (0.5, 0.0)
    assert rail.inertia == Inertia(ixx=1, iyy=1, izz=1)
    assert arm.notices == ()


def test_a_file_may_hold_several_manipulators(read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """Each has its own name and convention; a bad one fails alone; JSON is YAML."""
    joints = [{"a": 0, "alpha": 0, "d": 1}]
    robots = [
        {"name": "A", "convention": "DH", "joints": joints},
        {"convention": "MDH", "joints": joints},
        {"name": "C", "joints": joints},
        "D",
    ]
    first, second, third, fourth = read(json.dumps({"robots": robots}), ".json")
    assert isinstance(first, Manipulator)
    assert isinstance(second, Manipulator)
    assert (first.name, first.convention) == ("A", Convention.STANDARD)
    assert (second.name, second.convention) == ("arm_2", Convention.MODIFIED)
    assert isinstance(third, Rejected)
    assert isinstance(fourth, Rejected)


def test_defaults_hold_where_a_joint_says_nothing(read_one: Callable[..., Manipulator]) -> None:
    """Fields of joints too; what a joint says itself is stronger, a sign under its other name included."""
    arm = read_one(
        "defaults: {type: P, flip: true}\njoints:\n- {a: 0, alpha: 0, d: 1}\n- {a: 0, alpha: 0, d: 1, sign: 1, type: R}",
        ".yaml",
    )
    assert [(row.type.value, row.sign) for row in arm.rows] == [("prismatic", -1), ("revolute", 1)]


def test_craigs_keys_mean_his_convention(read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """They contradict the other one."""
    table = 'joints: [{"a_{i-1}": 0.5, "alpha_{i-1}": 0, d: 1}]'
    (arm,) = read(table, ".yaml")
    assert isinstance(arm, Manipulator)
    assert arm.convention is Convention.MODIFIED
    assert isinstance(read(table, ".yaml", convention="standard")[0], Rejected)
