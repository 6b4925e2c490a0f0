"""The exact α-swap: a robot whose forward kinematics is the DH product, for every table.

The paper's idea, made right. If all link frames are drawn parallel to the base frame at q = 0, each α turns the joint
axes and the lengths of all that follows; here they are turned by the whole rotation accumulated so far, signs
included. `frames` says where everything is; here it becomes joints and bodies.

The functions that make one robot make a column of them: what differs is only that the numbers are arrays. Where robots
are not all drawn alike, because a length is nothing for some, they are divided, and each half is made by itself.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

from dh2urdf.manipulator import Convention, JointType
from dh2urdf.robot import Collision, Cylinder, Visual, new_origin, new_visual
from dh2urdf.rotations import IDENTITY, DividedError, agreed, greater_of, hypot, is_column, smaller_of, where
from dh2urdf_plugins.transforms.assembly import Base, Part, assemble, parameters
from dh2urdf_plugins.transforms.checks import is_frame, sure_tables
from dh2urdf_plugins.transforms.formulas import Quantity, constants, nameless, origin, plus, signed, times, values
from dh2urdf_plugins.transforms.frames import aligned_frames, composed, modified_frames, settled, standard_frames
from dh2urdf_plugins.transforms.limits import complete_limits
from dh2urdf_plugins.transforms.shapes import (
    AHEAD,
    BARREL,
    BARREL_LENGTH,
    BASE_COLOUR,
    BASE_WIDTH,
    CAP,
    CAP_LENGTH,
    LINK_COLOURS,
    TUBE,
    Segment,
    Style,
    caps,
    collisions,
    default_radius,
    housing,
    pedestal,
    remains,
    visuals,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.columns import ManipulatorColumns, RobotColumns
    from dh2urdf.manipulator import DHRow, Limits, Manipulator, MeshShape
    from dh2urdf.robot import Material, Robot
    from dh2urdf.rotations import Number, RigidTransform
    from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
    from dh2urdf_plugins.transforms.formulas import Symbol
    from dh2urdf_plugins.transforms.frames import Frames, LinkFrame, Pose

    Drawn: TypeAlias = tuple[tuple[Visual, ...], tuple[Collision, ...]]
    """What is seen, and what touches."""

FEWEST = 8
"""Robots that are worth being made at once when others are drawn differently."""


def exact(manipulator: Manipulator, options: AlphaSwapOptions, symbol: Symbol = Quantity.parameter) -> Robot:
    """The robot of a manipulator, with the kinematics of its table; of columns with the symbol `nameless`.

    Raises:
        DividedError: the robots of such a table are not all drawn alike.
    """
    rows, is_modified = manipulator.rows, manipulator.convention is Convention.MODIFIED
    frames_of = aligned_frames if options.frames == "aligned" else modified_frames if is_modified else standard_frames
    frames, holders = _held_by_bodies(rows, frames_of(manipulator, symbol))
    limits = complete_limits(rows)
    base_style, styles = _styles(manipulator, options, frames, limits)
    rails = [_rail(*each) for each in zip(rows, frames.links, limits, styles, strict=True)]
    links = enumerate(zip(rows, frames.links, limits, styles, [*rails[1:], ((), ())], strict=True))
    return assemble(
        manipulator,
        base=_base(manipulator, frames, base_style, rails[0], options),
        parts=[_part(*link, holder=holders[number], is_first=number == 0) for number, link in links],
        flange=origin(*frames.flange),
        tool0=origin(*frames.tool0),
        options=options,
        parameters=() if symbol is nameless else parameters(manipulator, angles=options.frames == "dh"),
        comment=(
            f"{manipulator.name}: made by dh2urdf from a DH table of the {manipulator.convention.value} convention "
            f"(alpha-swap, exact, {options.frames} frames)"
        ),
    )


def _held_by_bodies(rows: Sequence[DHRow], frames: Frames) -> tuple[Frames, list[str | None]]:
    """Every joint, the flange and tool0 on the last link before them that has a body, and that of each joint.

    sdformat drops all that hangs on a link without a mass, also where that link is fixed to one with a mass.
    """
    links, holders = [], []
    holder: str | None = None  # the base
    way: Pose | None = None  # from there to the frame that is in between
    for row, frame in zip(rows, frames.links, strict=True):
        joint = composed(way, frame.joint) if way else frame.joint
        links.append(frame._replace(joint=joint))
        holders.append(holder)
        holder, way = (holder, joint) if is_frame(row) else (row.link, None)
    if way:
        frames = frames._replace(flange=composed(way, frames.flange), tool0=composed(way, frames.tool0))
    return frames._replace(links=links), holders


def _styles(
    manipulator: Manipulator, options: AlphaSwapOptions, frames: Frames, limits: list[Limits]
) -> tuple[Style, list[Style]]:
    """How the base and every link is drawn: what the row says, else the table, else the run, else what fits the arm."""
    table, base = manipulator.geometry, manipulator.base_geometry
    shape = table.shape or options.shape
    radius = table.radius or options.radius
    if radius is None:
        lengths = [frames.front.length.value]
        for row, frame, bounds in zip(manipulator.rows, frames.links, limits, strict=True):
            low, high = _range(row, bounds)
            prismatic = row.type is JointType.PRISMATIC
            lengths += [high - low if prismatic else frame.offset.length.value, frame.normal.length.value]
        radius = default_radius([abs(length) for length in lengths])
    styles = [
        Style(shape, radius if row.radius is None else row.radius, LINK_COLOURS[number % len(LINK_COLOURS)])
        for number, row in enumerate(manipulator.rows)
    ]
    base_radius = base.radius / BASE_WIDTH if base.radius else radius
    return Style(base.shape or shape, base_radius, BASE_COLOUR), styles


def _part(
    row: DHRow,
    frame: LinkFrame,
    limits: Limits,
    style: Style,
    rail: Drawn,
    *,
    holder: str | None,
    is_first: bool,
) -> Part:
    """A joint and its link, which carries the rail of the next joint; a mesh stands for all of it."""
    prismatic = row.type is JointType.PRISMATIC
    # The offset of a prismatic joint is drawn as the rail that the link before carries.
    segments = [frame.normal] if prismatic else [frame.offset, frame.normal]
    if style.shape == "arm":
        tube = Style("cylinder", TUBE * style.radius, style.material)
        seen, style = _arm_visuals(row, frame, style, tube, is_first=is_first), tube
    else:
        seen = visuals(segments, style)
        if style.shape == "capsule":  # the ends of the drawn segments, their common corner once
            offset, normal = not prismatic and style.draws(frame.offset), style.draws(frame.normal)
            points = ((offset, frame.foot), (offset or normal, frame.corner), (normal, frame.end))
            seen += caps([point for is_drawn, point in points if is_drawn], style)
        if prismatic or not seen:
            seen = (housing(frame.corner, frame.offset.rpy, style), *seen)
    touch = collisions(segments, style)
    seen, touch = rail if is_frame(row) else (seen + rail[0], touch + rail[1])
    seen, touch = _or_meshes((seen, touch), row.visual, row.collision, frame.dh_frame, style.material)
    length, delta = frame.normal.length.value, frame.offset.length.value
    low, high = _range(row, limits)
    return Part(
        row=row,
        limits=limits,
        holder=holder,
        origin=origin(*frame.joint),
        axis=frame.axis,
        visuals=seen,
        collisions=touch,
        foot=values(frame.foot),
        reach=hypot(greater_of(abs(delta + low), abs(delta + high)), length),
        arm=abs(length),
        dh_frame=frame.dh_frame,
    )


def _arm_visuals(row: DHRow, frame: LinkFrame, style: Style, tube: Style, *, is_first: bool) -> tuple[Visual, ...]:
    """The bodies of a link of the shape ``arm``: tubes, a ball where two of them meet, and the housing of its joint.

    A fixed row is no joint: it has a housing only where it has no tube. The first one stands on the base, and not
    through it.
    """
    prismatic = row.type is JointType.PRISMATIC
    seen = visuals([frame.normal] if prismatic else [frame.offset, frame.normal], tube)
    has_offset = not prismatic and tube.draws(frame.offset)
    if has_offset and tube.draws(frame.normal):
        seen += caps([frame.corner], tube)
    if row.type is JointType.FIXED and seen:
        return seen
    at, ahead = frame.corner, 0.0
    if has_offset:
        way = where(frame.offset.length.value < 0.0, -1.0, 1.0)
        at, ahead = frame.foot, way * ((0.5 * BARREL_LENGTH + CAP_LENGTH if is_first else AHEAD) * style.radius)
    radius, along = style.radius, constants(signed(row.sign, frame.axis))
    half = 0.5 * (BARREL_LENGTH + CAP_LENGTH) * radius
    barrel = Cylinder(radius=BARREL * radius, length=BARREL_LENGTH * radius)
    cap = Cylinder(radius=CAP * radius, length=CAP_LENGTH * radius)

    def body(shape: Cylinder, offset: Number, material: Material) -> Visual:
        place = plus(at, times(Quantity(offset), along))
        return new_visual(geometry=shape, origin=origin(place, frame.offset.rpy), material=material)

    ends = body(cap, ahead - half, BASE_COLOUR), body(cap, ahead + half, BASE_COLOUR)
    return (body(barrel, ahead, style.material), *ends, *seen)


def _or_meshes(
    drawn: Drawn, visual: MeshShape | None, collision: MeshShape | None, dh_frame: RigidTransform, material: Material
) -> Drawn:
    """What is seen of a link, and what touches: the meshes that the table has for these, else the given shapes."""
    seen, touch = drawn
    if visual or collision:
        from dh2urdf_plugins.transforms.meshes import placed_mesh

        if visual:  # COLLADA files have colours of their own.
            colour = None if visual.file.path.lower().endswith(".dae") else material
            seen = (Visual(**placed_mesh(visual, dh_frame), material=colour),)
        if collision:
            touch = (Collision(**placed_mesh(collision, dh_frame)),)
    return seen, touch


def _rail(row: DHRow, frame: LinkFrame, limits: Limits, style: Style) -> Drawn:
    """The rail of a prismatic joint on the link before, from the lower to the upper limit and to the joint's foot."""
    if row.type is not JointType.PRISMATIC:
        return (), ()
    at, along, rpy = frame.rail
    delta, (low, high) = frame.offset.length, _range(row, limits)
    middle = plus(at, times(delta + Quantity(0.5 * (low + high)), along))
    segments = [Segment(middle, Quantity(high - low), rpy)]
    if agreed(delta.value + low > 0.0):
        segments.append(Segment.between(at, along, delta + Quantity(low), rpy))
    elif agreed(delta.value + high < 0.0):
        segments.append(Segment.between(at, along, delta + Quantity(high), rpy))
    thin = Style(style.shape, 0.5 * style.radius, BASE_COLOUR)
    return visuals(segments, thin), collisions(segments, thin)


def _range(row: DHRow, limits: Limits) -> tuple[float, float]:
    """How far the joint value changes δ, downwards and upwards [m]; only a prismatic joint's does."""
    if row.type is not JointType.PRISMATIC or limits.lower is None or limits.upper is None:
        return 0.0, 0.0
    ends = (row.sign * limits.lower, row.sign * limits.upper)
    return (smaller_of(*ends), greater_of(*ends))


def _base(manipulator: Manipulator, frames: Frames, style: Style, rail: Drawn, options: AlphaSwapOptions) -> Base:
    """The pedestal, with the segment a before the first joint and the rail of the first joint where there are such.

    A mesh stands for all of it, in the DH frame before the first row.
    """
    stand = pedestal(*frames.pedestal, style)
    seen = (stand, *visuals([frames.front], style), *rail[0])
    touch: tuple[Collision, ...] = ()
    if options.base_collision:
        foot = Collision(geometry=stand.geometry, origin=stand.origin)
        touch = (foot, *collisions([frames.front], style), *rail[1])
    dh_frame = settled(manipulator.base) if options.frames == "aligned" else IDENTITY
    seen, touch = _or_meshes((seen, touch), manipulator.base_visual, manipulator.base_collision, dh_frame, BASE_COLOUR)
    place = new_origin(xyz=dh_frame.translation, rpy=dh_frame.rpy)
    return Base(origin=origin(*frames.base), visuals=seen, collisions=touch, dh_frame=place)


# --- Many tables at once ----------------------------------------------------------------------------------------------


def exact_columns(columns: ManipulatorColumns, options: AlphaSwapOptions) -> list[tuple[list[int], RobotColumns]]:
    """The robots of many manipulators, in groups that are drawn alike, each with the places of its members.

    Those about which there is a doubt, and those that few others are drawn like, are left out.
    """
    import numpy as np

    groups = []
    waiting = [np.flatnonzero(sure_tables(columns))]
    # What a number too large or too small makes of others is no fault: such a robot is not sure.
    with np.errstate(all="ignore"):
        while waiting:
            members = waiting.pop()
            places = members.tolist()
            if not places:
                continue
            some = columns if len(places) == len(columns) else columns.take(places)
            try:
                groups.append((places, _robots(some, options)))
            except DividedError as divided:
                halves = (members[~divided.condition], members[divided.condition])
                waiting += [half for half in halves if len(half) >= FEWEST]
    return groups


def _robots(columns: ManipulatorColumns, options: AlphaSwapOptions) -> RobotColumns:
    """The robots of tables that are all drawn alike."""
    from dh2urdf.columns import RobotColumns
    from dh2urdf.robot_check import sure_columns

    robot = exact(columns.table, options, nameless)
    # A table of many has no name, so the comment of its robot begins where a name would end.
    comments = tuple([name + robot.comment for name in columns.names])
    return RobotColumns(
        robot=replace(robot, name=columns.names[0], comment=comments[0]),
        names=columns.names,
        comments=comments,
        sure=sure_columns(robot, columns.names),
        present={
            (place, number): mask
            for place, link in enumerate(robot.links)
            for number, collision in enumerate(link.collisions)
            if is_column(mask := remains(collision.geometry)) and not mask.all()
        },
    )
