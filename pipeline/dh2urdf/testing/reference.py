"""Reference arms for the tests of plugins, and the plainest robot of each.

Between them the arms have both conventions, all joint types, offsets, negative signs, a base, a tool and a twist that
is no quarter turn. Their robots have a frame at every joint as the table has it, and a cylinder for every link.
"""

from __future__ import annotations

import math
from copy import deepcopy
from typing import TYPE_CHECKING

from dh2urdf.kinematics.chain import row_transform
from dh2urdf.manipulator import BASE, ROOT, TOOL, Convention, DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.robot import Collision, Cylinder, Inertial, Joint, Link, Origin, Robot, Visual
from dh2urdf.rotations import IDENTITY, RigidTransform

if TYPE_CHECKING:
    from collections.abc import Iterable

HALF = math.pi / 2


def reference_manipulators() -> tuple[Manipulator, ...]:
    """Arms with everything that a table may declare about kinematics."""
    return (_ur5(), _panda(), _scara(), _odd())


def copies_of(manipulators: Iterable[Manipulator] | None) -> tuple[Manipulator, ...]:
    """Copies of some arms, of the ones above where none are given: a stage may change what it is given."""
    return tuple(deepcopy(reference_manipulators() if manipulators is None else manipulators))


def _ur5() -> Manipulator:
    """A UR5 (Universal Robots' published table), in the standard convention."""
    a, d = (0.0, -0.425, -0.39225, 0.0, 0.0, 0.0), (0.089159, 0.0, 0.0, 0.10915, 0.09465, 0.0823)
    alpha = (HALF, 0.0, 0.0, HALF, -HALF, 0.0)
    limits = Limits(lower=-2 * math.pi, upper=2 * math.pi, velocity=3.15, effort=150.0)
    return Manipulator(
        name="ur5",
        convention=Convention.STANDARD,
        rows=tuple(
            DHRow(joint=f"joint_{i + 1}", link=f"link_{i + 1}", a=a[i], alpha=alpha[i], d=d[i], limits=limits)
            for i in range(len(a))
        ),
    )


def _panda() -> Manipulator:
    """A Panda (Franka Emika's published table), in the modified convention, with a tool."""
    a, d = (0.0, 0.0, 0.0, 0.0825, -0.0825, 0.0, 0.088), (0.333, 0.0, 0.316, 0.0, 0.384, 0.0, 0.0)
    alpha = (0.0, -HALF, HALF, HALF, -HALF, HALF, HALF)
    limits = Limits(lower=-2.8, upper=2.8, velocity=2.2, effort=87.0)
    return Manipulator(
        name="panda",
        convention=Convention.MODIFIED,
        rows=tuple(
            DHRow(joint=f"joint_{i + 1}", link=f"link_{i + 1}", a=a[i], alpha=alpha[i], d=d[i], limits=limits)
            for i in range(len(a))
        ),
        tool=RigidTransform.from_xyz_rpy((0.0, 0.0, 0.107)),
    )


def _scara() -> Manipulator:
    """A SCARA: two revolute joints, a prismatic one that points down, a continuous one."""
    turn = Limits(lower=-2.3, upper=2.3, velocity=4.0, effort=60.0)
    travel = Limits(lower=0.0, upper=0.21, velocity=1.0, effort=200.0)
    spin = Limits(velocity=20.0, effort=5.0)
    return Manipulator(
        name="scara",
        convention=Convention.STANDARD,
        rows=(
            DHRow(joint="shoulder", link="upper_arm", a=0.325, alpha=0.0, d=0.387, limits=turn),
            DHRow(joint="elbow", link="forearm", a=0.275, alpha=math.pi, d=0.0, limits=turn),
            DHRow(joint="quill", link="spindle", type=JointType.PRISMATIC, a=0.0, alpha=0.0, d=0.0, limits=travel),
            DHRow(joint="wrist", link="hand", type=JointType.CONTINUOUS, a=0.0, alpha=0.0, d=0.05, limits=spin),
        ),
    )


def _odd() -> Manipulator:
    """No real arm: oblique twists, offsets, negative signs, a fixed row in between, a base and a tool."""
    turn = Limits(lower=-1.0, upper=2.0, velocity=1.5, effort=40.0)
    travel = Limits(lower=-0.1, upper=0.3, velocity=0.5, effort=90.0)
    slide = JointType.PRISMATIC
    return Manipulator(
        name="odd",
        convention=Convention.MODIFIED,
        rows=(
            DHRow(joint="a", link="la", a=0.1, alpha=0.4, d=0.2, theta=0.3, offset=-0.5, sign=-1, limits=turn),
            DHRow(joint="b", link="lb", type=slide, a=-0.2, alpha=-1.1, d=0.05, offset=0.1, sign=-1, limits=travel),
            DHRow(joint="c", link="lc", type=JointType.FIXED, a=0.15, alpha=2.0, d=-0.1, theta=1.2),
            DHRow(joint="d", link="ld", a=0.0, alpha=-HALF, d=0.3, theta=0.7, limits=turn),
        ),
        base=RigidTransform.from_xyz_rpy((0.1, -0.2, 0.3), (0.2, -0.4, 1.0)),
        tool=RigidTransform.from_xyz_rpy((0.0, 0.05, 0.1), (1.0, 0.3, -0.6)),
    )


def plain_robot(manipulator: Manipulator) -> Robot:
    """The robot of a manipulator whose rows say their limits: for the tests of emitters and loaders.

    The motion of a joint is at the left end of a row's product in the standard convention, at its right end in the
    modified one; what is beside it is constant, and goes into the origin of this joint or of the next.
    """
    links, joints = [Link(name=ROOT), _body(BASE)], [_weld(ROOT, BASE)]
    parent, pending = BASE, manipulator.base
    for row in manipulator.rows:
        constant = row_transform(manipulator.convention, row)
        before, after = (IDENTITY, constant) if manipulator.convention is Convention.STANDARD else (constant, IDENTITY)
        joints.append(
            Joint(
                name=row.joint,
                type=row.type,
                parent=parent,
                child=row.link,
                origin=Origin.of(pending @ before),
                axis=(0.0, 0.0, float(row.sign)),
                limits=row.limits,
            )
        )
        links.append(_body(row.link))
        parent, pending = row.link, after
    links.append(Link(name=TOOL, inertial=Inertial(mass=0.0)))  # PyBullet takes a link without one for 1 kg.
    joints.append(_weld(parent, TOOL, pending @ manipulator.tool))
    return Robot(name=manipulator.name, links=tuple(links), joints=tuple(joints), manipulator=manipulator)


def _weld(parent: str, child: str, frame: RigidTransform = IDENTITY) -> Joint:
    name = f"{parent}-{child}"
    return Joint(name=name, type=JointType.FIXED, parent=parent, child=child, origin=Origin.of(frame))


def _body(name: str) -> Link:
    """A cylinder of 1 kg, 40 mm in radius and 100 mm long."""
    shape = Cylinder(radius=0.04, length=0.1)
    across, along = 0.04**2 / 4 + 0.1**2 / 12, 0.04**2 / 2
    return Link(
        name=name,
        inertial=Inertial(mass=1.0, inertia=Inertia(ixx=across, iyy=across, izz=along)),
        visuals=(Visual(geometry=shape),),
        collisions=(Collision(geometry=shape),),
    )
