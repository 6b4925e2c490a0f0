"""The tree of `dh2urdf view`: robots, their links, and what these consist of, in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from nicegui.element import Element

from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Mesh, Sphere

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence

    from dh2urdf.robot import Geometry, Inertial, Joint, Link, Origin, Robot
    from dh2urdf.stages.foreign_robot import Follower
    from dh2urdf_studio.drawing.scene import Figure

_POWERS = ("", "²", "³", "⁴")


class RobotTree(Element, component="robot_tree.js"):  # type: ignore[call-arg]  # Element is any type to mypy
    """A tree that folds; a link can be picked, and hidden in the scene."""

    def __init__(self, on_pick: Callable[[str | None], None], on_hide: Callable[[frozenset[str]], None]) -> None:
        super().__init__()
        self._nodes: frozenset[str] = frozenset()
        self.on("pick", lambda event: on_pick(next(iter(self._nodes & {event.args["node"]}), None)))
        self.on("hide", lambda event: on_hide(self._nodes.intersection(map(str, event.args["nodes"]))))

    def show(self, figures: Sequence[Figure], hidden: Collection[str]) -> None:
        """Show the robots, and which links are hidden, by the names of their nodes."""
        robots = [contents(figure) for figure in figures]
        self._nodes = frozenset(link["node"] for robot in robots for link in robot["links"])
        self.run_method("show", robots, sorted(hidden))

    def pick(self, node: str | None) -> None:
        """Let a link stand out, and bring it in sight."""
        self.run_method("choose", node)


def contents(figure: Figure) -> dict[str, Any]:
    """A robot as `robot_tree.js` takes it: its links, each with its joint, its shapes, its mass and its frame."""
    robot = figure.robot
    above = {joint.child: joint for joint in reversed(robot.joints)}
    return {
        "name": figure.title or robot.name or "robot",
        "links": [
            {
                "node": figure.name + link.name,
                "name": link.name,
                "items": [{"kind": kind, "text": text} for kind, text in _items(figure, link, above.get(link.name))],
            }
            for link in _from_root(robot)
        ],
    }


def _from_root(robot: Robot) -> Iterator[Link]:
    """The links, each behind the one that holds it, branch after branch; those that nothing leads to at the end."""
    links = {link.name: link for link in robot.links}
    held = {joint.child for joint in robot.joints}
    waiting = [*reversed(links), *(name for name in reversed(links) if name not in held)]
    while waiting:
        name = waiting.pop()
        if (link := links.pop(name, None)) is not None:
            yield link
            waiting += [joint.child for joint in reversed(robot.joints) if joint.parent == name]


def _items(figure: Figure, link: Link, joint: Joint | None) -> Iterator[tuple[str, str]]:
    if joint is not None:
        yield "joint", _joint(joint, figure)
        yield "frame", f"{_place(joint.origin)} in {joint.parent}"
    else:
        yield "frame", "the root"
    for visual in link.visuals:
        colour = visual.material.name if visual.material else ""
        yield "visual", _geometry(visual.geometry) + (f", {colour}" if colour else "") + _off(visual.origin)
    for collision in link.collisions:
        yield "collision", _geometry(collision.geometry) + _off(collision.origin)
    if link.inertial is not None:
        yield "mass", _mass(link.inertial)


def _joint(joint: Joint, figure: Figure) -> str:
    kind = figure.loose.get(joint.name)
    if kind is not None or joint.type is JointType.FIXED:
        return f"{joint.name}: {f'{kind}, drawn as ' if kind else ''}fixed"
    slides = joint.type is JointType.PRISMATIC
    words = [f"{joint.name}: {joint.type.value} {'along' if slides else 'about'} ({_numbers(joint.axis)})"]
    lower, upper = joint.limits.lower, joint.limits.upper
    if joint.type is not JointType.CONTINUOUS and lower is not None and upper is not None:
        words.append(" to ".join(f"{end:.4g} m" if slides else f"{math.degrees(end):.4g}°" for end in (lower, upper)))
    if (follower := figure.followers.get(joint.name)) is not None:
        words.append(_following(follower))
    return ", ".join(words)


def _following(follower: Follower) -> str:
    if not follower.leader:
        return f"kept at {follower.offset:.4g}"
    text = f"follows {follower.multiplier:.4g} · {follower.leader}"
    for factor, power in zip((follower.offset, *follower.higher), _POWERS, strict=False):
        if factor:
            leader = f" · {follower.leader}{power}" if power else ""
            text += f" {'+' if factor > 0 else '−'} {abs(factor):.4g}{leader}"
    return text


def _geometry(geometry: Geometry) -> str:
    match geometry:
        case Box(size=size):
            return f"box {' × '.join(f'{side:.4g}' for side in size)} m"
        case Cylinder(radius=radius, length=length):
            return f"cylinder, radius {radius:.4g} m, length {length:.4g} m"
        case Sphere(radius=radius):
            return f"sphere, radius {radius:.4g} m"
        case Mesh(filename=filename, scale=scale):
            factors = "" if scale == (1.0, 1.0, 1.0) else f" × ({_numbers(scale)})"
            return f"mesh {filename.replace(chr(92), '/').rpartition('/')[2]}{factors}"


def _mass(inertial: Inertial) -> str:
    i = inertial.inertia
    words = f"{inertial.mass:.4g} kg at ({_numbers(inertial.com)}) m; ixx, iyy, izz ({_numbers((i.ixx, i.iyy, i.izz))})"
    products = (i.ixy, i.ixz, i.iyz)
    return f"{words} kg·m²" + (f"; ixy, ixz, iyz ({_numbers(products)})" if any(products) else "")


def _off(origin: Origin) -> str:
    return f", {_place(origin)}" if any((*origin.xyz, *origin.rpy)) else ""


def _place(origin: Origin) -> str:
    turned = f", rpy ({_numbers(map(math.degrees, origin.rpy))})°" if any(origin.rpy) else ""
    return f"xyz ({_numbers(origin.xyz)}) m{turned}"


def _numbers(numbers: Iterable[float]) -> str:
    return ", ".join(f"{number + 0.0:.4g}" for number in numbers)
