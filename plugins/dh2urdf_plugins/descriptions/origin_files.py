"""Files in which makers write their arms as chains of origins, as descriptions.

Each entry of such a file is the origin of a joint about z: T(q) = O_1 Rz(q1) … O_N Rz(qN), and a fixed frame behind it.

- Universal Robots' `*_calibration.yaml`: `ur_calibration` computes it from what the controller knows of one arm, and
  `ur_description` makes joints of it, from the frame `base` of the controller to `tool0`.
- Franka's `kinematics.yaml`: `franka_description` has one for each of its arms, from `link0` to the flange, `link8`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.documents import load_yaml, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.manipulator import TOOL, JointType
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import Z_AXIS
from dh2urdf.source import Problem, did_you_mean
from dh2urdf_plugins.descriptions.description import Description
from dh2urdf_plugins.read_back.xml_files import LARGEST

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from dh2urdf.documents import Node

NUMBERS = ("x", "y", "z", "roll", "pitch", "yaw")
_LARGEST = 1000.0


class Entry(NamedTuple):
    """The joint that an entry is the origin of, and the link behind it."""

    joint: str
    link: str
    type: JointType = JointType.REVOLUTE


@dataclass(frozen=True, slots=True, kw_only=True)
class OriginFile:
    """How a maker writes such a file.

    Attributes:
        base: the link before the first joint.
        entries: the joints by the names of their entries, from the base outwards.
        ending: a fixed joint behind them that has no entry; None for none.
        above: the key whose mapping holds the entries; None where the file is that mapping.
        inside: the key of an entry whose mapping holds the numbers; None where the entry is that mapping.
        others: what the mapping of the entries may hold besides, and nobody needs.
        suffix: what the name of such a file ends with, besides the name of the arm.
        example: such a file.
    """

    base: str
    entries: dict[str, Entry]
    ending: Entry | None = None
    above: str | None = None
    inside: str | None = None
    others: tuple[str, ...] = ()
    suffix: str = ""
    example: str


UR = OriginFile(
    base="base",
    entries={
        "shoulder": Entry("shoulder_pan_joint", "shoulder_link"),
        "upper_arm": Entry("shoulder_lift_joint", "upper_arm_link"),
        "forearm": Entry("elbow_joint", "forearm_link"),
        "wrist_1": Entry("wrist_1_joint", "wrist_1_link"),
        "wrist_2": Entry("wrist_2_joint", "wrist_2_link"),
        "wrist_3": Entry("wrist_3_joint", "wrist_3_link"),
    },
    ending=Entry(f"{TOOL}_joint", TOOL, JointType.FIXED),
    above="kinematics",
    others=("hash",),
    suffix="_calibration",
    example="kinematics: {shoulder: {x: 0, y: 0, z: 0.089, roll: 0, pitch: 0, yaw: 0}, upper_arm: …, wrist_3: …}",
)
"""With the names of `ur_description`."""
FRANKA = OriginFile(
    base="link0",
    entries={
        **{f"joint{number}": Entry(f"joint{number}", f"link{number}") for number in range(1, 8)},
        "joint8": Entry("joint8", "link8", JointType.FIXED),
    },
    inside="kinematic",
    example="joint1: {kinematic: {x: 0, y: 0, z: 0.333, roll: 0, pitch: 0, yaw: 0}}, joint2: …, joint8: …",
)
"""With the names of `franka_description`, without the prefix of the arm."""


def origins_description(path: Path, form: OriginFile) -> Description:
    """The description of a chain of origins.

    Args:
        path: the file.
        form: how its maker writes it.

    Raises:
        TableError: the file cannot be read, or lacks an entry or a number.
    """
    root = load_yaml(read_bytes(path, TableError, limit=LARGEST), str(path), TableError)
    problems: list[Problem] = []
    place = form.above or ""
    chain = _inner(root, form.above, "", form, problems)
    nodes = {} if chain is None else _entries(chain, (*form.entries, *form.others), place, form, problems)
    origins = {
        name: _origin(nodes[name], f"{place}.{name}" if place else name, form, problems)
        for name in form.entries
        if name in nodes
    }
    if problems:
        raise TableError(problems)
    placed = [(entry, origins[name]) for name, entry in form.entries.items()]
    placed += [(form.ending, Origin())] if form.ending else []
    links = [form.base, *(entry.link for entry, _ in placed)]
    joints = [
        Joint(name=entry.joint, type=entry.type, parent=parent, child=entry.link, origin=origin, axis=Z_AXIS)
        for parent, (entry, origin) in zip(links, placed, strict=False)
    ]
    robot = Robot(
        name=path.stem.removesuffix(form.suffix), links=tuple(Link(name=name) for name in links), joints=tuple(joints)
    )
    return Description(robot=robot, file=str(path), folder=path.absolute().parent)


def _inner(node: Node, key: str | None, place: str, form: OriginFile, problems: list[Problem]) -> Node | None:
    """What the one key of a mapping holds; the node itself where it has no such key to have."""
    return node if key is None else _entries(node, (key,), place, form, problems).get(key)


def _entries(
    node: Node, wanted: Iterable[str], place: str, form: OriginFile, problems: list[Problem]
) -> dict[str, Node]:
    """The entries of a mapping, all that are wanted and no others."""
    if not isinstance(node.value, dict):
        problems.append(
            Problem(
                message=f"{place or 'the file'} is {node.describe()}",
                mark=node.mark,
                field=place or None,
                accepted=form.example,
            )
        )
        return {}
    wanted = tuple(wanted)
    problems += [
        Problem(
            message=f"{key!r} is no entry of a chain of origins",
            mark=node.key_mark(key),
            field=place or None,
            found=key,
            accepted=", ".join(wanted),
            suggestion=did_you_mean(key, wanted),
        )
        for key in node.value
        if key not in wanted
    ]
    before = f"{place}." if place else ""
    problems += [
        Problem(message=f"there is no {before}{key}", mark=node.mark, field=place or key, accepted=form.example)
        for key in wanted
        if key not in node.value and key not in form.others
    ]
    return node.value


def _origin(node: Node, place: str, form: OriginFile, problems: list[Problem]) -> Origin:
    inner = _inner(node, form.inside, place, form, problems)
    place = f"{place}.{form.inside}" if form.inside else place
    entries = {} if inner is None else _entries(inner, NUMBERS, place, form, problems)
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
