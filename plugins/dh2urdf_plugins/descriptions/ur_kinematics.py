"""What Universal Robots' ROS packages write of one arm, `*_calibration.yaml`, as a description: a chain of origins.

`ur_calibration` computes the file from what the controller knows. `ur_description` takes each entry for the origin of a
joint about z: T(q) = O_shoulder Rz(q1) … O_wrist_3 Rz(q6), from the frame `base` of the controller to `tool0`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.documents import load_yaml, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import Z_AXIS
from dh2urdf.source import Problem, did_you_mean
from dh2urdf_plugins.descriptions.description import LARGEST, Description

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.documents import Node

BASE, TIP = "base", "tool0"
JOINTS = {
    "shoulder": "shoulder_pan_joint",
    "upper_arm": "shoulder_lift_joint",
    "forearm": "elbow_joint",
    "wrist_1": "wrist_1_joint",
    "wrist_2": "wrist_2_joint",
    "wrist_3": "wrist_3_joint",
}
"""The joints of `ur_description` by the entries of the file, from the base outwards."""
NUMBERS = ("x", "y", "z", "roll", "pitch", "yaw")
_LARGEST = 1000.0
_ACCEPTED = "kinematics: {shoulder: {x: 0, y: 0, z: 0.089, roll: 0, pitch: 0, yaw: 0}, upper_arm: …, wrist_3: …}"


def ur_kinematics_description(path: Path) -> Description:
    """The description of a calibration.

    Raises:
        TableError: the file cannot be read, or lacks an entry or a number.
    """
    root = load_yaml(read_bytes(path, TableError, limit=LARGEST), str(path), TableError)
    problems: list[Problem] = []
    entries = _entries(_entries(root, ("kinematics",), "", problems).get("kinematics"), JOINTS, "kinematics", problems)
    origins = {name: _origin(node, f"kinematics.{name}", problems) for name, node in entries.items() if name != "hash"}
    if problems:
        raise TableError(problems)
    names = [BASE, *(f"{name}_link" for name in JOINTS)]
    joints = [
        Joint(
            name=joint, type=JointType.REVOLUTE, parent=parent, child=f"{name}_link", origin=origins[name], axis=Z_AXIS
        )
        for parent, (name, joint) in zip(names, JOINTS.items(), strict=False)
    ]
    joints.append(Joint(name=f"{TIP}_joint", type=JointType.FIXED, parent=names[-1], child=TIP))
    links = tuple(Link(name=name) for name in (*names, TIP))
    name = path.stem.removesuffix("_calibration")
    return Description(
        robot=Robot(name=name, links=links, joints=tuple(joints)), file=str(path), folder=path.absolute().parent
    )


def _entries(
    node: Node | None, wanted: dict[str, str] | tuple[str, ...], place: str, problems: list[Problem]
) -> dict[str, Node]:
    """The entries of a mapping, all that are wanted and no others but the hash of the arm."""
    if node is None:
        return {}
    if not isinstance(node.value, dict):
        problems.append(
            Problem(
                message=f"{place or 'the file'} is {node.describe()}",
                mark=node.mark,
                field=place or None,
                accepted=_ACCEPTED,
            )
        )
        return {}
    problems += [
        Problem(
            message=f"{key!r} is no entry of a calibration",
            mark=node.key_mark(key),
            field=place or None,
            found=key,
            accepted=", ".join(wanted),
            suggestion=did_you_mean(key, wanted),
        )
        for key in node.value
        if key not in wanted and key != "hash"
    ]
    before = f"{place}." if place else ""
    problems += [
        Problem(message=f"there is no {before}{key}", mark=node.mark, field=place or key, accepted=_ACCEPTED)
        for key in wanted
        if key not in node.value
    ]
    return node.value


def _origin(node: Node, place: str, problems: list[Problem]) -> Origin:
    entries = _entries(node, NUMBERS, place, problems)
    numbers = [_number(entries[name], f"{place}.{name}", problems) if name in entries else 0.0 for name in NUMBERS]
    x, y, z, roll, pitch, yaw = numbers
    return Origin(xyz=(x, y, z), rpy=(roll, pitch, yaw))


def _number(node: Node, place: str, problems: list[Problem]) -> float:
    value = node.value
    if isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= _LARGEST:
        return float(value)
    problems.append(
        Problem(
            message=f"{place} is {node.describe()}",
            mark=node.mark,
            field=place,
            found=node.text,
            accepted=f"a number [m, rad] of {_LARGEST:g} at most",
        )
    )
    return 0.0
