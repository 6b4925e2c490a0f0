"""Files in which makers write their arms as chains of origins, as descriptions.

Each entry of such a file is the origin of a joint about z: T(q) = O_1 Rz(q1) … O_N Rz(qN), and a fixed frame behind it.

- Universal Robots' `*_calibration.yaml`: `ur_calibration` computes it from what the controller knows of one arm, and
  `ur_description` makes joints of it, from the frame `base` of the controller to `tool0`.
- Franka's `kinematics.yaml`: `franka_description` has one for each of its arms, from `link0` to the flange, `link8`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.documents import load_yaml, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.manipulator import TOOL, JointType
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import Z_AXIS
from dh2urdf.source import Problem, did_you_mean
from dh2urdf_plugins.descriptions.description import Description
from dh2urdf_plugins.formats.xml_files import LARGEST

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.documents import Node

NUMBERS = ("x", "y", "z", "roll", "pitch", "yaw")
_LARGEST = 1000.0


class OriginFile(NamedTuple):
    """How a maker writes such a file.

    Attributes:
        base: the link before the first joint.
        entries: the joints, and the links behind them, by the names of their entries, from the base outwards.
        last: the last joint and its link, which are fixed; an entry of its own where `entries` has the joint too.
        example: such a file.
        above: the key whose mapping holds the entries; None where the file is that mapping.
        inside: the key of an entry whose mapping holds the numbers; None where the entry is that mapping.
        others: what the mapping of the entries may hold besides, and nobody needs.
        suffix: what the name of such a file ends with, besides the name of the arm.
    """

    base: str
    entries: dict[str, tuple[str, str]]
    last: tuple[str, str]
    example: str
    above: str | None = None
    inside: str | None = None
    others: tuple[str, ...] = ()
    suffix: str = ""


_UR_JOINTS = {"shoulder": "shoulder_pan", "upper_arm": "shoulder_lift", "forearm": "elbow"}
UR = OriginFile(
    base="base",
    entries={
        name: (f"{_UR_JOINTS.get(name, name)}_joint", f"{name}_link")
        for name in (*_UR_JOINTS, "wrist_1", "wrist_2", "wrist_3")
    },
    last=(f"{TOOL}_joint", TOOL),
    example="kinematics: {shoulder: {x: 0, y: 0, z: 0.089, roll: 0, pitch: 0, yaw: 0}, upper_arm: …, wrist_3: …}",
    above="kinematics",
    others=("hash",),
    suffix="_calibration",
)
"""With the names of `ur_description`."""
FRANKA = OriginFile(
    base="link0",
    entries={f"joint{number}": (f"joint{number}", f"link{number}") for number in range(1, 9)},
    last=("joint8", "link8"),
    example="joint1: {kinematic: {x: 0, y: 0, z: 0.333, roll: 0, pitch: 0, yaw: 0}}, joint2: …, joint8: …",
    inside="kinematic",
)
"""With the names of `franka_description`, without the prefix of the arm."""


def origins_description(path: Path, form: OriginFile) -> Description:
    """The description of a chain of origins, as its maker writes it.

    Raises:
        TableError: the file cannot be read, or lacks an entry or a number.
    """
    root = load_yaml(read_bytes(path, TableError, limit=LARGEST), str(path), TableError)
    problems: list[Problem] = []
    origins = _origins(root, form, problems)
    if problems:
        raise TableError(problems)
    placed = [(form.entries[name], origin) for name, origin in origins.items()]
    placed += [] if form.last in form.entries.values() else [(form.last, Origin())]
    links = [form.base, *(link for (_, link), _ in placed)]
    joints = [
        Joint(
            name=name,
            type=JointType.FIXED if (name, link) == form.last else JointType.REVOLUTE,
            parent=parent,
            child=link,
            origin=origin,
            axis=Z_AXIS,
        )
        for parent, ((name, link), origin) in zip(links, placed, strict=False)
    ]
    found = Description(file=str(path), folder=path.absolute().parent)
    name = path.stem.removesuffix(form.suffix)
    found.robot = Robot(name=name, links=tuple(Link(name=link) for link in links), joints=tuple(joints))
    return found


def _origins(root: Node, form: OriginFile, problems: list[Problem]) -> dict[str, Origin]:
    """The origins by entry; what is wrong goes to the problems, all of it."""
    chain, place = root, form.above or ""
    if form.above:
        chain = _entries(root, (form.above,), "", form, problems).get(form.above, replace(root, value={}))
    nodes, origins = _entries(chain, (*form.entries, *form.others), place, form, problems), {}
    for name in (each for each in form.entries if each in nodes):
        node, place = nodes[name], f"{form.above}.{name}" if form.above else name
        if form.inside:
            inner = _entries(node, (form.inside,), place, form, problems)
            node, place = inner.get(form.inside, replace(node, value={})), f"{place}.{form.inside}"
        numbers = []
        for key, found in _entries(node, NUMBERS, place, form, problems).items():
            value = found.value
            if not isinstance(value, (int, float)) or isinstance(value, bool) or not abs(value) <= _LARGEST:
                accepted = f"a number [m, rad] of {_LARGEST:g} at most"
                message, field = f"{place}.{key} is {found.describe()}", f"{place}.{key}"
                problems.append(
                    Problem(message=message, mark=found.mark, field=field, found=found.text, accepted=accepted)
                )
            else:
                numbers.append((key, float(value)))
        x, y, z, roll, pitch, yaw = ({**dict.fromkeys(NUMBERS, 0.0), **dict(numbers)}[key] for key in NUMBERS)
        origins[name] = Origin(xyz=(x, y, z), rpy=(roll, pitch, yaw))
    return origins


def _entries(
    node: Node, wanted: tuple[str, ...], place: str, form: OriginFile, problems: list[Problem]
) -> dict[str, Node]:
    """The entries of a mapping; those that are missing and those that nobody reads go to the problems."""
    if not isinstance(node.value, dict):
        message = f"{place or 'the file'} is {node.describe()}"
        problems.append(Problem(message=message, mark=node.mark, field=place or None, accepted=form.example))
        return {}
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
    for key in wanted:
        if key not in node.value and key not in form.others:
            message = f"there is no {place}{'.' if place else ''}{key}"
            problems.append(Problem(message=message, mark=node.mark, field=place or key, accepted=form.example))
    return {key: node.value[key] for key in wanted if key in node.value}
