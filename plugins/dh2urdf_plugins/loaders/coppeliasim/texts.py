"""What the importer of CoppeliaSim is given, and frames and limits as it has them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.documents import xml_root
from dh2urdf.errors import LoaderError
from dh2urdf.kinematics import axis_rotation
from dh2urdf.manipulator import JointType
from dh2urdf.rotations import IDENTITY, IDENTITY_ROTATION, ZERO, RigidTransform, scale

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from dh2urdf.manipulator import Limits
    from dh2urdf.robot import Robot
    from dh2urdf_plugins.loaders.comparison import Comparison


def text_for(path: Path, comparison: Comparison) -> str:
    """The text of a file as the importer takes it.

    By the declaration it tells a text from a path. Meshes get absolute paths: beside a text it does not look for any.

    Raises:
        LoaderError: the file cannot be read.
    """
    try:
        tree = xml_root(path.read_bytes())
    except OSError as error:
        raise LoaderError(comparison.problem(message=f"the file cannot be read: {error}")) from error
    except etree.XMLSyntaxError as error:
        raise LoaderError(comparison.problem(message=f"the file is not XML: {error}")) from error
    for mesh in tree.iter("mesh"):
        name = mesh.get("filename", "")
        if "://" not in name:
            mesh.set("filename", str((path.parent / name).resolve()))
    return '<?xml version="1.0"?>\n' + etree.tostring(tree, encoding="unicode")


def link_frames(robot: Robot, q: Sequence[float]) -> dict[str, RigidTransform]:
    """The frames of all links in the root at a joint vector [rad or m]."""
    values = dict(zip((joint.name for joint in robot.moving_joints), q, strict=True))
    frames = {robot.root: IDENTITY}
    for joint in robot.joints:  # Parents before children.
        motion = IDENTITY
        if joint.type is JointType.PRISMATIC:
            motion = RigidTransform(IDENTITY_ROTATION, scale(values[joint.name], joint.axis))
        elif joint.type is not JointType.FIXED:
            motion = RigidTransform(axis_rotation(joint.axis, values[joint.name]), ZERO)
        frames[joint.child] = frames[joint.parent] @ joint.origin.transform @ motion
    return frames


def interval(limits: Limits) -> list[float] | None:
    """Limits as CoppeliaSim has them: the lower one, and the range [rad or m]."""
    if limits.lower is None or limits.upper is None:
        return None
    return [limits.lower, limits.upper - limits.lower]


def transform(matrix: Sequence[float]) -> RigidTransform:
    """A rigid transform of the upper three rows of its homogeneous matrix."""
    a, b, c, x, d, e, f, y, g, h, i, z = matrix
    return RigidTransform((a, b, c, d, e, f, g, h, i), (x, y, z))
