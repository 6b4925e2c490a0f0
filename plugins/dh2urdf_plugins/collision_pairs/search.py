"""The search for collision pairs, in the order and with the thresholds of MoveIt's setup assistant.

The rules are those of ``computeDefaultCollisions`` in moveit_setup_srdf_plugins (moveit/moveit2). A pair gets the first
reason that fits:

- ``Adjacent``: one joint joins the links, or several with links without a collision shape between them;
- ``Default``: they touch where the robot starts;
- ``Always``: they touch in more than 95 % of 200 random states; looked for again until none is found;
- ``Never``: they touch in none of the random states.

MoveIt draws other states each time. Here a seed draws them: the same robot has the same pairs. A pair that has come
nearer than `PairOptions.min_distance` is not `Never` here, since other states might have found a contact.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from itertools import chain, combinations
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, get_args

from dh2urdf.errors import EmitterError, InputError
from dh2urdf.meshes import read_mesh
from dh2urdf_plugins.collision_pairs.scene import FLOATING, Mechanism, Scene, pair_of, shaped_neighbours

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from dh2urdf.robot import Mesh, Robot
    from dh2urdf_plugins.collision_pairs.options import PairOptions
    from dh2urdf_plugins.collision_pairs.scene import Pair

Reason: TypeAlias = Literal["Adjacent", "Default", "Always", "Never"]
REASONS: tuple[Reason, ...] = get_args(Reason)
ROUND = 200  # random states of one round of the search for pairs that always touch
ALWAYS = 190  # a pair that touches in more of them always touches: 95 %


class DisabledPair(NamedTuple):
    """Two links whose collisions need no check."""

    link1: str  # the first of them in the order of their names
    link2: str  # the other
    reason: Reason  # why


@dataclass(frozen=True, slots=True, kw_only=True)
class CollisionPairs:
    """What was found: the pairs that need no check, in the order of their names, as MoveIt sorts them."""

    disabled: tuple[DisabledPair, ...]
    links: tuple[str, ...]  # those that have a collision shape

    @property
    def summary(self) -> str:
        """The counts in one line."""
        counts = Counter(pair.reason for pair in self.disabled)
        reasons = ", ".join(f"{reason} {counts[reason]}" for reason in REASONS)
        checked = len(self.links) * (len(self.links) - 1) // 2 - len(self.disabled)
        return f"{len(self.links)} links with collision shapes; {reasons}; {checked} pairs to check"


def robot_pairs(robot: Robot, options: PairOptions) -> CollisionPairs:
    """The collision pairs of a robot that was made of tables."""
    try:
        loose = {joint.name: FLOATING for joint in robot.joints if joint.child in robot.floating}
        return collision_pairs(Mechanism(robot=robot, loose=loose), _content, options)
    except InputError as error:
        raise EmitterError(error.problems) from error


def _content(mesh: Mesh) -> tuple[bytes, str]:
    return (read_mesh(mesh.file), Path(mesh.file.path).suffix.lower()) if mesh.file else (b"", "")


def collision_pairs(
    mechanism: Mechanism, mesh: Callable[[Mesh], tuple[bytes, str]], options: PairOptions
) -> CollisionPairs:
    """The collision pairs of a mechanism; `mesh` returns the content and the suffix of a mesh."""
    scene = Scene(mechanism, mesh)
    random = Random(options.seed)  # noqa: S311 - states, no secrets
    reasons: dict[Pair, Reason] = {}

    def disable(pairs: Iterable[Pair], reason: Reason) -> None:
        pairs = set(pairs)
        reasons.update(dict.fromkeys(pairs, reason))
        scene.ignore(pairs)

    disable(shaped_neighbours(mechanism), "Adjacent")
    start = mechanism.state()
    disable(scene.touching(start), "Default")
    seen: set[Pair] = set()
    while True:
        counts: Counter[Pair] = Counter()
        for _ in range(ROUND):
            counts.update(scene.touching(mechanism.state(random)))
        seen |= set(counts)
        always = {pair for pair, count in counts.items() if count > ALWAYS}
        if not always:
            break
        disable(always, "Always")
    waiting = {pair_of(one, other) for one, other in combinations(scene.links, 2)} - set(reasons) - seen
    scene.ignore(seen)
    for state in chain((start,), (mechanism.state(random) for _ in range(options.trials))):
        near = scene.touching(state, options.min_distance)
        waiting -= near
        scene.ignore(near)
        if not waiting:
            break
    disable(waiting, "Never")
    disabled = tuple(DisabledPair(*pair, reasons[pair]) for pair in sorted(reasons))
    return CollisionPairs(disabled=disabled, links=scene.links)
