"""Reads a written table into a robot whose joints are its rows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.errors import InputError, ProofError
from dh2urdf.kinematics import row_transform
from dh2urdf.manipulator import ROOT, TOOL, Convention, JointType, Manipulator
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import IDENTITY, Z_AXIS
from dh2urdf.source import Mark, Messages

if TYPE_CHECKING:
    from pathlib import Path

say = Messages(__file__)

_READERS = {".yaml": "yaml", ".yml": "yaml", ".json": "yaml", ".csv": "csv"}


def read_table(path: Path) -> Robot:
    """The robot of the one table of a file."""
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        mark = Mark(file=str(path))
        raise InputError(say("table-only-written", mark, found=path.suffix, suffixes=tuple(_READERS)))
    from dh2urdf import read_all

    (arm,) = read_all(path, reader=reader)
    if not isinstance(arm, Manipulator):
        raise ProofError(arm.problems)
    return robot_of(arm)


def robot_of(arm: Manipulator) -> Robot:
    """A robot of the rows of a table, without bodies.

    A row at q is its transform at 0 and the joint's motion about z: the motion comes first in the standard convention,
    and last in the modified one.
    """
    links, joints = [Link(name=ROOT)], list[Joint]()
    so_far = arm.base
    for row in arm.rows:
        step = row_transform(arm.convention, row)
        origin, so_far = (so_far, step) if arm.convention is Convention.STANDARD else (so_far @ step, IDENTITY)
        joints.append(
            Joint(
                name=row.joint,
                type=row.type,
                parent=links[-1].name,
                child=row.link,
                origin=Origin.of(origin),
                axis=Z_AXIS if row.sign > 0 else (0.0, 0.0, -1.0),
                limits=row.limits,
                follows=row.follows,
            )
        )
        links.append(Link(name=row.link))
    last = Origin.of(so_far @ arm.tool)
    joints.append(Joint(name=f"{TOOL}_joint", type=JointType.FIXED, parent=links[-1].name, child=TOOL, origin=last))
    return Robot(name=arm.name, links=(*links, Link(name=TOOL)), joints=tuple(joints))
