"""A robot description of any origin: the robot, and what a `Robot` does not hold."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple, TypeVar

from dh2urdf.robot import Robot
from dh2urdf.source import Problem

V = TypeVar("V")


class Follower(NamedTuple):
    """How a joint follows another one: its value is offset + multiplier x + higher[0] x² + … of the leader's value x.

    Attributes:
        leader: name of the joint that it follows; empty where the file names none.
        multiplier: not a number where the file has none that can be read.
        offset: [rad or m].
        higher: factors of the square of the leader's value, its cube and so on; MJCF has them.
    """

    leader: str
    multiplier: float = 1.0
    offset: float = 0.0
    higher: tuple[float, ...] = ()

    @property
    def is_finite(self) -> bool:
        """Whether all numbers are finite."""
        return all(map(math.isfinite, (self.multiplier, self.offset, *self.higher)))

    @property
    def is_held(self) -> bool:
        """Whether the joint keeps one value, and follows none."""
        return not self.leader and self.multiplier == 0.0 and self.is_finite

    def value(self, leading: float) -> float:
        """The value of the joint where the leader has the one given [rad or m]."""
        powers = 0.0
        for factor in reversed(self.higher):
            powers = (powers + factor) * leading
        return (self.multiplier + powers) * leading + self.offset

    def rate(self, leading: float) -> float:
        """How fast the joint moves for each rad or m of the leader, at a value of that."""
        powers = ((power + 2) * factor * leading ** (power + 1) for power, factor in enumerate(self.higher))
        return self.multiplier + sum(powers)


@dataclass(frozen=True, slots=True, kw_only=True)
class ForeignRobot:
    """What a description of unknown origin holds.

    Attributes:
        robot: the links and joints; joints that no table has, such as floating ones, are fixed in it.
        followers: the joints that follow another one, by name.
        loose: the types of the joints that no table has, by the name of the joint.
        folder: where the paths of its meshes begin; None for the folder of the file.
        notices: what could not be read, and is left out.
    """

    robot: Robot
    followers: Mapping[str, Follower] = field(default_factory=dict)
    loose: Mapping[str, str] = field(default_factory=dict)
    folder: Path | None = None
    notices: tuple[Problem, ...] = ()


def following(followers: Mapping[str, Follower], joints: Iterable[str]) -> dict[str, Follower]:
    """The followers that can follow: what they lead back to is one of some moving joints, which follows none.

    A joint that keeps one value follows without a leader.

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
        if follower is None or follower.is_held:
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
        while way[-1] and way[-1] not in every:
            way.append(followers[way[-1]].leader)
        leader = way.pop()
        value: V | float = every[leader] if leader else 0.0
        for each in reversed(way):
            if isinstance(value, float):
                value = followers[each].value(value)
            every[each] = value
    return every
