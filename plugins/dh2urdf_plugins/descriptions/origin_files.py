"""Files in which makers write their arms as chains of origins, as descriptions.

Each entry of such a file is the origin of a joint about z: T(q) = O_1 Rz(q1) … O_N Rz(qN), and a fixed frame behind it.

- Universal Robots' `*_calibration.yaml`: `ur_calibration` computes it from what the controller knows of one arm, and
  `ur_description` makes joints of it, from the frame `base` of the controller to `tool0`.
- Franka's `kinematics.yaml`: `franka_description` has one for each of its arms, from `link0` to the flange, `link8`.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.documents import load_yaml, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Joint, Origin
from dh2urdf.rotations import Z_AXIS
from dh2urdf.source import Messages, did_you_mean
from dh2urdf_plugins.descriptions.description import chain_description
from dh2urdf_plugins.formats.xml_files import LARGEST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.documents import Node
    from dh2urdf_plugins.descriptions.description import Description

say = Messages(__file__)

NUMBERS = ("x", "y", "z", "roll", "pitch", "yaw")
_LARGEST = 1000.0


class OriginFile(NamedTuple):
    """How a maker writes such a file."""

    base: str  # the link before the first joint
    entries: dict[str, list[str]]  # from the base outwards, the joints and the links behind them, by their entries
    last: list[str]  # the last joint and its link, which are fixed; `entries` has it where the file does
    above: Sequence[str] = ()  # the keys from the file to the mapping of the entries
    inside: Sequence[str] = ()  # the keys from an entry to the mapping of its numbers
    others: Sequence[str] = ()  # what the mapping of the entries may hold besides, and nobody needs
    suffix: str = ""  # what the name of such a file ends with, besides the name of the arm


MAKERS = {
    name: OriginFile(**form)
    for name, form in tomllib.loads((Path(__file__).parent / "origin_files.toml").read_text("utf-8")).items()
}
"""How makers write such files, by the names of the readers."""


def origins_description(path: Path, maker: str) -> Description:
    """The description of a chain of origins, as a maker writes it."""
    form = MAKERS[maker]
    node, place = load_yaml(read_bytes(path, TableError, limit=LARGEST), str(path), TableError), ""
    for key in form.above:
        node, place = _entries(node, (key,), place)[key], key
    placed = []
    for name, entry in _entries(node, tuple(form.entries), place, form.others).items():
        inner, where = entry, _below(place, name)
        for key in form.inside:
            inner, where = _entries(inner, (key,), where)[key], _below(where, key)
        numbers = []
        for key, found in _entries(inner, NUMBERS, where).items():
            value = found.value
            if not isinstance(value, (int, float)) or isinstance(value, bool) or not abs(value) <= _LARGEST:
                about: dict[str, Any] = {"found": found.text, "kind": found.describe(), "most": _LARGEST}
                raise TableError(say("origin-no-number", found.mark, field=_below(where, key), **about))
            numbers.append(float(value))
        x, y, z, roll, pitch, yaw = numbers
        placed.append((form.entries[name], Origin(xyz=(x, y, z), rpy=(roll, pitch, yaw))))
    placed += [] if form.last in form.entries.values() else [(form.last, Origin())]
    links = [form.base, *(link for (_, link), _ in placed)]
    joints = [
        Joint(
            name=name,
            type=JointType.FIXED if [name, link] == form.last else JointType.REVOLUTE,
            parent=parent,
            child=link,
            origin=origin,
            axis=Z_AXIS,
        )
        for parent, ((name, link), origin) in zip(links, placed, strict=False)
    ]
    return chain_description(path, path.stem.removesuffix(form.suffix), joints)


def _below(place: str, key: str) -> str:
    return f"{place}.{key}" if place else key


def _entries(node: Node, wanted: Sequence[str], place: str, others: Sequence[str] = ()) -> dict[str, Node]:
    """The entries of a mapping, in the order in which they are wanted."""
    field = place or None
    if not isinstance(node.value, dict):
        what, kind = place or "the file", node.describe()
        raise TableError(say("origin-no-mapping", node.mark, field=field, what=what, kind=kind, wanted=wanted))
    for key in node.value:
        if key not in (*wanted, *others):
            mark, near = node.key_mark(key), did_you_mean(key, wanted)
            raise TableError(say("origin-key-unknown", mark, field=field, found=key, wanted=wanted, suggestion=near))
    if missing := [key for key in wanted if key not in node.value]:
        raise TableError(say("origin-key-missing", node.mark, field=_below(place, missing[0]), wanted=wanted))
    return {key: node.value[key] for key in wanted}
