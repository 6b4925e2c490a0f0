"""A tree of links and joints that moves: what drives its joints, where they start, and random states.

States are those of MoveIt's robot model: a joint starts at 0, or in the middle of its limits where 0 is outside; random
values are uniform within the limits, or a turn where there are none; a joint that mimics another follows it, wherever
that leads; a floating joint turns about its origin and a planar joint about z, since nothing limits where they are.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import InputError
from dh2urdf.foreign_robot import Follower, with_followers
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Robot
from dh2urdf.rotations import norm
from dh2urdf.source import Mark, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Iterator
    from random import Random

    from dh2urdf.robot import Joint

FLOATING, PLANAR = "floating", "planar"


State = Mapping[str, float | tuple[float, float, float, float]]
"""The values of moving joints by name [rad or m]; of a floating joint its orientation, as a quaternion (x, y, z, w)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mechanism:
    """A robot with what its joints follow.

    Attributes:
        robot: the links and joints; floating and planar joints are fixed in it.
        followers: joints that mimic another, by name.
        loose: floating and planar joints, by name.
        file: what messages call the description.
    """

    robot: Robot
    followers: Mapping[str, Follower] = field(default_factory=dict)
    loose: Mapping[str, str] = field(default_factory=dict)
    file: str | None = None

    def moves(self, joint: Joint) -> bool:
        """Whether a joint moves, by itself or behind another."""
        return joint.type is not JointType.FIXED or joint.name in self.loose

    def from_root(self) -> tuple[Joint, ...]:
        """The joints, each behind the one that holds its parent.

        Raises:
            InputError: the links are not a tree with one root, a joint follows none, or an axis has no length.
        """
        problems = list(self._problems())
        if not problems:
            links = {link.name for link in self.robot.links}
            roots = links - {joint.child for joint in self.robot.joints}
            if len(roots) == 1:
                joints: list[Joint] = []
                reached = set(roots)
                waiting = list(self.robot.joints)
                while ready := [joint for joint in waiting if joint.parent in reached]:
                    joints += ready
                    reached |= {joint.child for joint in ready}
                    waiting = [joint for joint in waiting if joint.child not in reached]
                if not waiting:
                    return tuple(joints)
            found = ", ".join(map(shown, sorted(roots)[:5])) or "none"
            accepted = "a tree of links that begins at one"
            problems = [self._problem("the links are no tree with one root", found=found, accepted=accepted)]
        raise InputError(problems)

    def _problems(self) -> Iterator[Problem]:
        links = [link.name for link in self.robot.links]
        held: set[str] = set()
        moving = [joint.name for joint in self.robot.joints if self.moves(joint)]
        if not links:
            yield self._problem("there are no links")
        for joint in self.robot.joints:
            for name in (joint.parent, joint.child):
                if name not in links:
                    message, near = f"no link is called {shown(name)}", did_you_mean(name, links)
                    yield self._problem(message, joint, suggestion=near)
            if joint.child in held:
                yield self._problem(f"a second joint holds the link {shown(joint.child)}", joint)
            held.add(joint.child)
            if joint.type is not JointType.FIXED and not norm(joint.axis):
                yield self._problem("the axis of the joint has no length", joint, accepted="a direction")
            follower = self.followers.get(joint.name)
            if follower is None or not self.moves(joint):
                continue
            if not follower.is_finite:
                message = "the multiplier or the offset of the mimic element is not a finite number"
                yield self._problem(message, joint, accepted="finite numbers")
            if follower.leader not in moving or self._circles(joint.name):
                message = f"the joint mimics {shown(follower.leader)}, which no joint can follow"
                accepted = "another joint that moves"
                yield self._problem(message, joint, accepted=accepted, suggestion=did_you_mean(follower.leader, moving))

    def _circles(self, name: str) -> bool:
        seen: set[str] = set()
        while name in self.followers and name not in seen:
            seen.add(name)
            name = self.followers[name].leader
        return name in seen

    def _problem(self, message: str, joint: Joint | None = None, **words: Any) -> Problem:  # noqa: ANN401 - those of a Problem
        mark = joint.mark if joint and joint.mark else Mark(file=self.file) if self.file else None
        robot = None if self.file else self.robot.name
        return Problem(message=message, robot=robot, joint=joint.name if joint else None, mark=mark, **words)

    # States

    def default_state(self) -> State:
        """Where the joints start."""
        return with_followers({joint.name: self._start(joint) for joint in self._driven()}, self._moved())

    def random_state(self, random: Random) -> State:
        """A state within the limits."""
        return with_followers({joint.name: self._anywhere(joint, random) for joint in self._driven()}, self._moved())

    def _driven(self) -> list[Joint]:
        return [joint for joint in self.robot.joints if self.moves(joint) and joint.name not in self.followers]

    def _moved(self) -> dict[str, Follower]:
        moving = (joint.name for joint in self.robot.joints if self.moves(joint))
        return {name: self.followers[name] for name in moving if name in self.followers}

    def _start(self, joint: Joint) -> float | tuple[float, float, float, float]:
        if self.loose.get(joint.name) == FLOATING:
            return (0.0, 0.0, 0.0, 1.0)
        lower, upper = self._range(joint)
        return 0.0 if lower <= 0.0 <= upper else 0.5 * lower + 0.5 * upper

    def _anywhere(self, joint: Joint, random: Random) -> float | tuple[float, float, float, float]:
        if self.loose.get(joint.name) == FLOATING:
            return _orientation(random)
        lower, upper = self._range(joint)
        return lower + random.random() * (upper - lower)

    def _range(self, joint: Joint) -> tuple[float, float]:
        """The limits of a joint: a turn where it has none; a joint that slides without limits stays where it starts."""
        lower, upper = joint.limits.lower, joint.limits.upper
        if joint.type is JointType.CONTINUOUS or self.loose.get(joint.name) == PLANAR:
            return -math.pi, math.pi
        if joint.limits.velocity is None and lower is None and upper is None:
            return (0.0, 0.0) if joint.type is JointType.PRISMATIC else (-math.pi, math.pi)
        return lower or 0.0, upper or 0.0


def _orientation(random: Random) -> tuple[float, float, float, float]:
    """A rotation from the uniform distribution over all: K. Shoemake, "Uniform random rotations", Graphics Gems III."""
    radius, first, second = random.random(), math.tau * random.random(), math.tau * random.random()
    small, large = math.sqrt(1.0 - radius), math.sqrt(radius)
    return small * math.sin(first), small * math.cos(first), large * math.sin(second), large * math.cos(second)
