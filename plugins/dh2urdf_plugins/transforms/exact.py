"""The exact α-swap: a robot whose forward kinematics is the DH product, for every table.

The paper's idea, made right. If all link frames are drawn parallel to the base frame at q = 0, each α turns the joint
axes and the lengths of all that follows; here they are turned by the whole rotation accumulated so far, signs
included. `frames` says where everything is; here it becomes joints and bodies.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from dh2urdf import unchecked_records as own
from dh2urdf.elementwise import agreed, greater_of, hypot, smaller_of
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.robot import Collision
from dh2urdf.rotations import IDENTITY
from dh2urdf_plugins.transforms.assembly import Base, Part, assemble, complete_limits, parameters
from dh2urdf_plugins.transforms.checks import is_frame
from dh2urdf_plugins.transforms.formulas import Quantity, nameless, origin, plus, times, values
from dh2urdf_plugins.transforms.frames import aligned_frames, composed, modified_frames, settled, standard_frames
from dh2urdf_plugins.transforms.shapes import (
    BASE_COLOUR,
    BASE_WIDTH,
    LINK_COLOURS,
    Segment,
    Style,
    caps,
    collisions,
    default_radius,
    housing,
    pedestal,
    visuals,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.manipulator import DHRow, Limits, Manipulator, MeshShape
    from dh2urdf.robot import Material, Robot, Visual
    from dh2urdf.rotations import RigidTransform
    from dh2urdf_plugins.transforms.alpha_swap_options import AlphaSwapOptions
    from dh2urdf_plugins.transforms.formulas import Quantities, Symbol
    from dh2urdf_plugins.transforms.frames import Frames, LinkFrame, Pose

    Drawn: TypeAlias = tuple[tuple[Visual, ...], tuple[Collision, ...]]
    Meshes: TypeAlias = tuple[MeshShape | None, MeshShape | None]


class Rail(NamedTuple):
    """What a prismatic joint runs on, in the frame of the link before it."""

    visuals: tuple[Visual, ...] = ()
    collisions: tuple[Collision, ...] = ()


def exact(manipulator: Manipulator, options: AlphaSwapOptions, symbol: Symbol = Quantity.parameter) -> Robot:
    """The robot of a manipulator, with the kinematics of its table.

    Of a table whose numbers are columns it is the robot whose numbers are columns; `symbol` is `nameless` then.

    Raises:
        DividedError: the robots of such a table are not all drawn alike.
    """
    frames, holders = _held_by_bodies(manipulator.rows, _frames(manipulator, options, symbol))
    limits = complete_limits(manipulator.rows)
    base_style, styles = _styles(manipulator, options, frames, limits)
    rails = [
        _rail(row, frame, bounds, style)
        for row, frame, bounds, style in zip(manipulator.rows, frames.links, limits, styles, strict=True)
    ]
    carried = [*rails[1:], Rail()]
    links = zip(manipulator.rows, frames.links, limits, styles, carried, strict=True)
    parts = [
        _part(*link, holder=holder, is_first=not n) for n, (holder, link) in enumerate(zip(holders, links, strict=True))
    ]
    return assemble(
        manipulator,
        base=_base(manipulator, frames, base_style, rails[0], options),
        parts=parts,
        flange=origin(*frames.flange),
        tool0=origin(*frames.tool0),
        options=options,
        parameters=() if symbol is nameless else parameters(manipulator, angles=options.frames == "dh"),
        comment=(
            f"{manipulator.name}: made by dh2urdf from a DH table of the {manipulator.convention.value} convention "
            f"(alpha-swap, exact, {options.frames} frames)"
        ),
    )


def _frames(manipulator: Manipulator, options: AlphaSwapOptions, symbol: Symbol) -> Frames:
    if options.frames == "aligned":
        return aligned_frames(manipulator, symbol)
    return (modified_frames if manipulator.convention is Convention.MODIFIED else standard_frames)(manipulator, symbol)


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
    if way is None:
        return frames._replace(links=links), holders
    flange, tool0 = composed(way, frames.flange), composed(way, frames.tool0)
    return frames._replace(links=links, flange=flange, tool0=tool0), holders


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
    base_style = Style(
        shape=base.shape or shape,
        radius=base.radius / BASE_WIDTH if base.radius else radius,
        material=BASE_COLOUR,
    )
    styles = [
        Style(
            shape=shape,
            radius=radius if row.radius is None else row.radius,
            material=LINK_COLOURS[number % len(LINK_COLOURS)],
        )
        for number, row in enumerate(manipulator.rows)
    ]
    return base_style, styles


def _part(
    row: DHRow, frame: LinkFrame, limits: Limits, style: Style, rail: Rail, *, holder: str | None, is_first: bool
) -> Part:
    """A joint and its link, which carries the rail of the next joint; a mesh stands for all of it."""
    prismatic = row.type is JointType.PRISMATIC
    # The offset of a prismatic joint is drawn as the rail that the link before carries.
    segments = [frame.normal] if prismatic else [frame.offset, frame.normal]
    if style.shape == "arm":
        from dh2urdf_plugins.transforms.housings import arm_visuals, tube_style

        seen, style = arm_visuals(row, frame, style, is_first=is_first), tube_style(style)
    else:
        seen = visuals(segments, style)
        if style.shape == "capsule":
            seen += caps(_ends(frame, style, offset=not prismatic), style)
        if prismatic or not seen:
            seen = (housing(frame.corner, frame.offset.rpy, style), *seen)
    normal, delta = frame.normal.length.value, frame.offset.length.value
    low, high = _range(row, limits)
    seen, touch = seen + rail.visuals, collisions(segments, style) + rail.collisions
    if is_frame(row):
        seen, touch = rail.visuals, rail.collisions
    seen, touch = _or_meshes((seen, touch), (row.visual, row.collision), frame.dh_frame, style.material)
    return Part(
        row=row,
        limits=limits,
        holder=holder,
        origin=origin(*frame.joint),
        axis=frame.axis,
        visuals=seen,
        collisions=touch,
        foot=values(frame.foot),
        reach=hypot(greater_of(abs(delta + low), abs(delta + high)), normal),
        arm=abs(normal),
        dh_frame=frame.dh_frame,
    )


def _or_meshes(drawn: Drawn, meshes: Meshes, dh_frame: RigidTransform, material: Material) -> Drawn:
    """What is seen of a link, and what touches: the meshes that the table has for these, else the given shapes."""
    (seen, touch), (visual, collision) = drawn, meshes
    if visual or collision:
        from dh2urdf_plugins.transforms.meshes import mesh_collision, mesh_visual

        seen = (mesh_visual(visual, dh_frame, material),) if visual else seen
        touch = (mesh_collision(collision, dh_frame),) if collision else touch
    return seen, touch


def _ends(frame: LinkFrame, style: Style, *, offset: bool) -> list[Quantities]:
    """The ends of the drawn segments, their common corner once."""
    offset, normal = offset and style.draws(frame.offset), style.draws(frame.normal)
    drawn = ((offset, frame.foot), (offset or normal, frame.corner), (normal, frame.end))
    return [point for is_drawn, point in drawn if is_drawn]


def _rail(row: DHRow, frame: LinkFrame, limits: Limits, style: Style) -> Rail:
    """The rail of a prismatic joint, from its lower to its upper limit and down to the joint's foot."""
    if row.type is not JointType.PRISMATIC:
        return Rail()
    at, along, rpy = frame.rail
    delta, (low, high) = frame.offset.length, _range(row, limits)
    middle = plus(at, times(delta + Quantity(0.5 * (low + high)), along))
    segments = [Segment(middle, Quantity(high - low), rpy)]
    if agreed(delta.value + low > 0.0):
        segments.append(Segment.between(at, along, delta + Quantity(low), rpy))
    elif agreed(delta.value + high < 0.0):
        segments.append(Segment.between(at, along, delta + Quantity(high), rpy))
    thin = Style(shape=style.shape, radius=0.5 * style.radius, material=BASE_COLOUR)
    return Rail(visuals(segments, thin), collisions(segments, thin))


def _range(row: DHRow, limits: Limits) -> tuple[float, float]:
    """How far the joint value changes δ, downwards and upwards [m]; only a prismatic joint's does."""
    if row.type is not JointType.PRISMATIC or limits.lower is None or limits.upper is None:
        return 0.0, 0.0
    ends = (row.sign * limits.lower, row.sign * limits.upper)
    return (smaller_of(*ends), greater_of(*ends))


def _base(manipulator: Manipulator, frames: Frames, style: Style, rail: Rail, options: AlphaSwapOptions) -> Base:
    """The pedestal, with the segment a before the first joint and the rail of the first joint where there are such.

    A mesh stands for all of it, in the DH frame before the first row.
    """
    stand = pedestal(*frames.pedestal, style)
    seen: tuple[Visual, ...] = (stand, *visuals([frames.front], style), *rail.visuals)
    touch: tuple[Collision, ...] = (
        Collision(geometry=stand.geometry, origin=stand.origin),
        *collisions([frames.front], style),
        *rail.collisions,
    )
    touch = touch if options.base_collision else ()
    dh_frame = settled(manipulator.base) if options.frames == "aligned" else IDENTITY
    meshes = manipulator.base_visual, manipulator.base_collision
    seen, touch = _or_meshes((seen, touch), meshes, dh_frame, BASE_COLOUR)
    place = own.origin(xyz=dh_frame.translation, rpy=dh_frame.rpy)
    return Base(origin=origin(*frames.base), visuals=seen, collisions=touch, dh_frame=place)
