"""The hold test as all simulators do it: the load that gravity is, what counts as an overlap, and long chains."""

import math
import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.conversion.loads import load_in_child
from dh2urdf.manipulator import Inertia, JointType, Limits
from dh2urdf.robot import Box, Collision, Cylinder, Inertial, Joint, Link, Origin, Robot, Sphere
from dh2urdf.stages import LoadReport, LoadRequest
from dh2urdf_plugins.formats import urdf
from dh2urdf_plugins.loaders.measures import gravity_loads
from dh2urdf_plugins.loaders.simulators import LOADERS

MOVING = ("pybullet", "mujoco", "drake")
BODY = Inertial(mass=1.0, com=(0.05, 0.02, -0.03), inertia=Inertia(ixx=0.01, iyy=0.01, izz=0.01))


def joint(
    name: str, parent: str, xyz: tuple[float, float, float], rpy: tuple[float, float, float], **more: Any
) -> Joint:
    limits = Limits(lower=-1.0, upper=1.0, effort=1000.0, velocity=1.0)
    kind = more.pop("type", JointType.REVOLUTE)
    return Joint(
        name=f"to {name}", type=kind, parent=parent, child=name, origin=Origin(xyz=xyz, rpy=rpy), limits=limits, **more
    )


def loaded(loader: str, robot: Robot, folder: Path) -> LoadReport:
    """What a simulator reports about a robot."""
    path = folder / "arm.urdf"
    path.write_bytes(urdf.EMITTER.emit(robot, "arm", urdf.EMITTER.options())[0].content)
    stage = next(each for each in LOADERS if each.name == loader)
    return load_in_child(stage, LoadRequest(path=path, robot=robot, poses=(), expected={}), stage.options())


def test_the_load_of_gravity_is_that_of_newton_and_euler(tmp_path: Path) -> None:
    """Pinocchio's recursive algorithm, which goes through accelerations, asks the same of every joint of a tree."""
    pinocchio = pytest.importorskip("pinocchio")
    import numpy as np

    draw = random.Random(3)  # noqa: S311 - reproducible on purpose
    links, joints = [Link(name="base_link")], []
    for number in range(12):
        xyz, rpy = (tuple(draw.uniform(-2, 2) for _ in range(3)) for _ in range(2))
        kind = JointType.PRISMATIC if number % 4 == 1 else JointType.REVOLUTE
        length = math.hypot(*(axis := [draw.gauss(0, 1) for _ in range(3)]))
        parent = draw.choice(links).name
        joints.append(joint(f"link {number}", parent, xyz, rpy, type=kind, axis=tuple(a / length for a in axis)))  # type: ignore[arg-type]
        links.append(Link(name=f"link {number}", inertial=replace(BODY, mass=draw.uniform(0.5, 5))))
    robot = Robot(name="tree", links=tuple(links), joints=tuple(joints))
    path = tmp_path / "tree.urdf"
    path.write_bytes(urdf.EMITTER.emit(robot, "tree", urdf.EMITTER.options())[0].content)
    model = pinocchio.buildModelFromUrdf(str(path))
    q = [draw.uniform(-1, 1) for _ in joints]
    places = [model.joints[model.getJointId(each.name)].idx_q for each in joints]
    values = np.zeros(model.nq)
    values[places] = q
    rest = np.zeros(model.nv)
    wanted = pinocchio.rnea(model, model.createData(), values, rest, rest)[places]
    assert gravity_loads(robot, q) == pytest.approx(wanted, rel=1e-9, abs=1e-9)


def pairs_of_shapes(gap: float) -> Robot:
    """Pairs of links beside each other, none joined to the other, whose shapes are so far apart [m]."""
    size, upright = 0.1, Cylinder(radius=0.05, length=0.2)
    box, ball = Box(size=(size, size, size)), Sphere(radius=0.05)
    links, joints = [Link(name="base_link")], []
    for number, shapes in enumerate([(box, box), (upright, upright), (ball, ball), (upright, box), (upright, ball)]):
        for side, shape in enumerate(shapes):
            name = f"{number} {'ab'[side]}"
            place = (side * (size + gap), float(number), 0.0)
            joints.append(joint(name, "base_link", place, (0.0, 0.0, 0.0)))
            links.append(Link(name=name, inertial=BODY, collisions=(Collision(geometry=shape),)))
    return Robot(name="pairs", links=tuple(links), joints=tuple(joints))


@pytest.mark.parametrize("loader", MOVING)
@pytest.mark.parametrize(("gap", "overlaps"), [(0.0, []), (-1e-4, [(f"{n} a", f"{n} b") for n in range(5)])])
def test_touching_is_not_overlapping(
    tmp_path: Path, require_loaders: Callable[..., None], loader: str, gap: float, overlaps: Sequence[tuple[str, str]]
) -> None:
    """Shapes that just touch are no finding in any simulator; those that overlap by a tenth of a millimetre are."""
    require_loaders(loader)
    report = loaded(loader, pairs_of_shapes(gap), tmp_path)
    assert report.hold["contacts"] == list(overlaps)
    assert any("overlap at the start" in finding.message for finding in report.findings) == bool(overlaps)


def chain(joints: int, strength: float) -> Robot:
    """A chain of parallel axes, stretched out level, whose efforts are a share of what gravity asks of each."""
    links = [Link(name="base_link"), *(Link(name=f"link {number}", inertial=BODY) for number in range(joints))]
    made = [
        joint(link.name, before.name, (0.2, 0.0, 0.0), (0.0, 0.0, 0.0), axis=(0.0, 1.0, 0.0))
        for before, link in pairwise(links)
    ]
    robot = Robot(name="chain", links=tuple(links), joints=tuple(made))
    efforts = [abs(load) * strength for load in gravity_loads(robot, [0.0] * joints)]
    limited = [replace(each, limits=replace(each.limits, effort=e)) for each, e in zip(made, efforts, strict=True)]
    return replace(robot, joints=tuple(limited))


@pytest.mark.parametrize(("joints", "strength", "stays"), [(20, 1.02, True), (20, 0.9, False), (60, 1.02, True)])
def test_pybullet_holds_a_long_chain(tmp_path: Path, *, joints: int, strength: float, stays: bool) -> None:
    """Its motors decide, not the number of its joints: 2 % more effort than gravity asks holds it, 10 % less does not."""
    report = loaded("pybullet", chain(joints, strength), tmp_path)
    assert report.hold["stayed"] == stays
    assert report.hold["largest_load"] == pytest.approx(1 / strength)
    assert [finding.field for finding in report.findings] == ([] if stays else ["limits.effort"])
