"""The emitter `dot`: the kinematic tree of a robot as text in Graphviz's language DOT."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from dh2urdf.manipulator import JointType
from dh2urdf.stages import EmittedFile, Emitter

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Joint, Link, Robot

DIRECTIONS = {"down": "TB", "right": "LR"}


@dataclass(frozen=True, slots=True, kw_only=True)
class DotOptions:
    """What the graph shows."""

    direction: Literal["down", "right"] = field(
        default="down", metadata={"help": "where the tree grows, from the root"}
    )
    angles: Literal["deg", "rad"] = field(default="deg", metadata={"help": "unit of the limits of joints that turn"})


def emit(robot: Robot, stem: str, options: DotOptions) -> list[EmittedFile]:
    """The graph of a robot, as ``<stem>.dot``: a node for each link, an edge for each joint."""
    return [EmittedFile(name=f"{stem}.dot", content=("\n".join(_lines(robot, options)) + "\n").encode())]


def _lines(robot: Robot, options: DotOptions) -> Iterator[str]:
    nodes = {link.name: f"link_{number}" for number, link in enumerate(robot.links)}
    title = _quoted(f"{robot.name}: {len(robot.moving_joints)} moving joints, {robot.mass:.4g} kg")
    yield f"digraph {_quoted(robot.name)} {{"
    yield f'  graph [rankdir={DIRECTIONS[options.direction]}, label={title}, labelloc=t, fontname="sans-serif"];'
    yield '  node [shape=box, style=rounded, fontname="sans-serif"];'
    yield '  edge [fontname="sans-serif", fontsize=11];'
    for link in robot.links:
        yield f"  {nodes[link.name]} [{_link(link)}];"
    for joint in robot.joints:
        yield f"  {nodes[joint.parent]} -> {nodes[joint.child]} [{_joint(joint, options)}];"
    yield "}"


def _link(link: Link) -> str:
    """A body with its mass; a mere frame is dashed."""
    if link.inertial is None or not link.inertial.mass:
        return f'label={_quoted(link.name)}, style="rounded,dashed"'
    return f"label={_quoted(link.name, f'{link.inertial.mass:.4g} kg')}"


def _joint(joint: Joint, options: DotOptions) -> str:
    """A joint that moves, with its axis and limits; one that does not is dotted."""
    if joint.type is JointType.FIXED:
        return f"label={_quoted(joint.name)}, style=dotted"
    does = "along" if joint.type is JointType.PRISMATIC else "about"
    axis = " ".join(f"{number + 0.0:.4g}" for number in joint.axis)
    return f"label={_quoted(joint.name, f'{joint.type} {does} {axis}', *_limits(joint, options))}"


def _limits(joint: Joint, options: DotOptions) -> tuple[str, ...]:
    lower, upper = joint.limits.lower, joint.limits.upper
    if lower is None or upper is None:
        return ()
    if joint.type is JointType.PRISMATIC:
        return (f"{lower:.4g} … {upper:.4g} m",)
    if options.angles == "deg":
        return (f"{math.degrees(lower):.4g}° … {math.degrees(upper):.4g}°",)
    return (f"{lower:.4g} … {upper:.4g} rad",)


def _quoted(*lines: str) -> str:
    """Lines as one string of DOT, with nothing in them that it would act on.

    A backslash begins an escape in a label, and an ampersand an HTML entity, also between quotes
    (graphviz.org/docs/attr-types/escString and graphviz.org/doc/char.html).
    """
    escaped = (line.replace("\\", "\\\\").replace('"', '\\"').replace("&", "&amp;") for line in lines)
    return '"' + "\\n".join(escaped) + '"'


EMITTER = Emitter(
    name="dot",
    summary="the kinematic tree as a graph for Graphviz",
    emit=emit,
    options=DotOptions,
    suffixes=(".dot", ".gv"),
)
