"""Reference arms for the tests of plugins (`arms.toml`), and the plainest robot of each.

The robots have a frame at every joint as the table has it, and a cylinder for every link.
"""

from __future__ import annotations

import tomllib
from importlib.resources import files

from dh2urdf.kinematics.chain import row_transform
from dh2urdf.manipulator import BASE, ROOT, TOOL, Convention, DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.robot import Collision, Cylinder, Inertial, Joint, Link, Origin, Robot, Visual
from dh2urdf.rotations import IDENTITY, RigidTransform

_FIELDS = ("joint", "link", "type", "a", "alpha", "d", "theta", "offset", "sign", "limits")


def reference_manipulators() -> tuple[Manipulator, ...]:
    """Arms with everything that a table may declare about kinematics; each call makes new ones."""
    arms = tomllib.loads(files("dh2urdf.testing").joinpath("arms.toml").read_text("utf-8"))
    found = []
    for name, arm in arms.items():
        rows = [dict(zip(_FIELDS, row, strict=True)) for row in arm["rows"]]
        given = [{**row, "type": JointType(row["type"]), "limits": Limits(**row["limits"])} for row in rows]
        base, tool = (RigidTransform.from_xyz_rpy(*arm[key]) if key in arm else IDENTITY for key in ("base", "tool"))
        table, convention = tuple(DHRow(**row) for row in given), Convention(arm["convention"])
        found.append(Manipulator(name=name, convention=convention, rows=table, base=base, tool=tool))
    return tuple(found)


def plain_robot(manipulator: Manipulator) -> Robot:
    """The robot of a manipulator whose rows have all limits: for the tests of emitters and loaders.

    The motion of a joint is at the left end of a row's product in the standard convention, at its right end in the
    modified one. The constant rest goes into the origin of this joint or of the next one.
    """
    links, joints = [Link(name=ROOT), _body(BASE)], [_weld(ROOT, BASE)]
    parent, pending = BASE, manipulator.base
    for row in manipulator.rows:
        constant = row_transform(manipulator.convention, row)
        before, after = (IDENTITY, constant) if manipulator.convention is Convention.STANDARD else (constant, IDENTITY)
        joint = Joint(
            name=row.joint,
            type=row.type,
            parent=parent,
            child=row.link,
            origin=Origin.of(pending @ before),
            axis=(0.0, 0.0, float(row.sign)),
            limits=row.limits,
            follows=row.follows,
        )
        joints.append(joint)
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
    inertial = Inertial(mass=1.0, inertia=Inertia(ixx=across, iyy=across, izz=along))
    return Link(
        name=name, inertial=inertial, visuals=(Visual(geometry=shape),), collisions=(Collision(geometry=shape),)
    )
