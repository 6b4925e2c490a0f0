"""A robot description of any origin: the robot, and what a `Robot` does not hold."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import field
from pathlib import Path
from typing import NamedTuple, TypeVar

from dh2urdf.late_dataclasses import dataclass
from dh2urdf.robot import Robot

V = TypeVar("V")


class Follower(NamedTuple):
    """How a joint follows another one: its value is multiplier · value of the leader + offset.

    Attributes:
        leader: name of the joint that it follows; empty where the file names none.
        multiplier: not a number where the file has none that can be read, or where the joint does not follow linearly.
        offset: [rad or m].
    """

    leader: str
    multiplier: float = 1.0
    offset: float = 0.0

    @property
    def is_finite(self) -> bool:
        """Whether both numbers are finite."""
        return math.isfinite(self.multiplier) and math.isfinite(self.offset)


@dataclass(frozen=True, slots=True, kw_only=True)
class ForeignRobot:
    """What a description of unknown origin holds.

    Attributes:
        robot: the links and joints; joints that no table has, such as floating ones, are fixed in it.
        followers: the joints that follow another one, by name.
        loose: the types of the joints that no table has, by the name of the joint.
        folder: where the paths of its meshes begin; None for the folder of the file.
    """

    robot: Robot
    followers: Mapping[str, Follower] = field(default_factory=dict)
    loose: Mapping[str, str] = field(default_factory=dict)
    folder: Path | None = None


def following(followers: Mapping[str, Follower], joints: Iterable[str]) -> dict[str, Follower]:
    """The followers that can follow: what they lead back to is one of some moving joints, which follows none.

    Args:
        followers: the joints that follow another one, by name.
        joints: the names of the moving joints.
    """
    moving = set(joints)
    found: dict[str, Follower] = {}
    for name in moving & followers.keys():
        way = [name]
        while (follower := followers.get(way[-1])) and follower.is_finite and follower.leader in moving - set(way):
            way.append(follower.leader)
        if way[-1] not in followers:
            found[name] = followers[name]
    return found


def with_followers(values: Mapping[str, V], followers: Mapping[str, Follower]) -> dict[str, V | float]:
    """The values of joints, and of the joints that follow them.

    Args:
        values: by the name of the joint [rad or m]; what is no float, such as an orientation, is passed on as it is.
        followers: joints that can follow, by name: those of `following`. What is in `values` of them does not count.
    """
    every: dict[str, V | float] = {name: value for name, value in values.items() if name not in followers}
    for name in followers:
        way = [name]
        while way[-1] not in every:
            way.append(followers[way[-1]].leader)
        value = every[way.pop()]
        for each in reversed(way):
            if isinstance(value, float):
                value = followers[each].multiplier * value + followers[each].offset
            every[each] = value
    return every
