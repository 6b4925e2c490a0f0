"""A fixed row between nearly parallel axes, whose common normal is too far away for a double.

The common normal of axes that are 0.001 rad from parallel lies hundreds of metres away, and so do the DH frames. The
link is split at the line from a point P of the first axis to its projection on the second one. Both axes are
perpendicular to that line, up to their small angle: the rows have numbers of the arm's own size, and T(q) stays.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.errors import TableError
from dh2urdf.kinematics import angle_error, dh_frames, forward_kinematics, position_error, row_transform
from dh2urdf.kinematics.mass import rotated
from dh2urdf.manipulator import Convention, DHRow, JointType
from dh2urdf.rotations import IDENTITY, ZERO, RigidTransform, add, multiply, rotate, rotation_x, transpose
from dh2urdf.source import Messages, Problem, free_name, shown
from dh2urdf_plugins.extraction.chain import Axis, Chain, Precision, decompose, seen_from
from dh2urdf_plugins.extraction.ends import STEEPEST, place_sliding_axes
from dh2urdf_plugins.extraction.rows import rows_of

if TYPE_CHECKING:
    from dh2urdf.manipulator import Manipulator, MeshShape
    from dh2urdf.rotations import Vec3

say = Messages(__file__)

MOST = 1000.0
"""How many lengths of the arm a d may be before the link is split."""
DIGITS = 4e-16
"""What a d loses of itself in a double."""
NEARLY = 0.1
"""Below which angle axes are nearly parallel [rad]."""
TOLERANCE = 1e-12
"""How far a table with split links may be from the given one [m, rad]."""
LARGEST = 1e-9
"""How far a table in another convention may be from the given one [m, rad]."""


class NearlyParallel(NamedTuple):
    """Two neighbours, by the names of their joints, whose axes are nearly parallel."""

    first: str
    second: str
    angle: float  # between their axes, or between one and the other's opposite [rad]
    far: float  # how far away the common normal is, along the axis where it is further [m]
    split: bool  # whether a fixed row is between them

    def notice(self) -> Problem:
        """What was done about them."""
        axes = f"joints {shown(self.first)} and {shown(self.second)} are {self.angle:.2g} rad from parallel"
        code = "nearly-parallel-split" if self.split else "nearly-parallel"
        return say(code, field="near_parallel", axes=axes, far=self.far)


def split_links(
    chain: Chain, precision: Precision, arm_length: float, tolerance: float, near_parallel: str
) -> tuple[Chain, tuple[NearlyParallel, ...]]:
    """The chain with a fixed axis wherever a link has to be split, and all neighbours that are nearly parallel.

    The sliding axes are in their places; the tip may be as far from the file's as the tolerance, lengths are in m, and
    nearly parallel axes are split (``split``) or not (``dh``), or where the table would lose digits (``auto``).
    """
    axes, links = [chain.axes[0]], [chain.links[0]]
    found: list[NearlyParallel] = []
    point = (0.0, 0.0, seen_from(chain.links[0], ZERO)[2])
    for before, after, link in zip(chain.axes, chain.axes[1:], chain.links[1:], strict=False):
        screws = decompose(link, precision)
        sine, far = math.hypot(link.rotation[2], link.rotation[5]), max(abs(screws.b), abs(screws.e))
        reached = (0.0, 0.0, seen_from(link, point)[2])
        middle = None
        if not screws.parallel and sine < NEARLY and far > STEEPEST * arm_length:
            is_too_far = far > MOST * arm_length or far * DIGITS > tolerance
            if near_parallel == "split" or (near_parallel == "auto" and is_too_far):
                middle = _middle(link, point)
            found.append(NearlyParallel(before.joint, after.joint, math.asin(sine), far, middle is not None))
        if middle:
            axes.append(Axis(before.joint, JointType.FIXED))
        axes.append(after)
        links += middle or [link]
        point = reached if middle or screws.parallel else (0.0, 0.0, 0.0 - screws.e)
    return Chain(tuple(axes), (*links, chain.links[-1])), tuple(found)


def _middle(link: RigidTransform, point: Vec3) -> list[RigidTransform] | None:
    """The link in two parts, which meet at the line from a point of its first axis to the second axis."""
    r, t = link
    px, py, _ = seen_from(link, point)
    if (length := math.hypot(px, py)) == 0.0:
        return None
    mx, my, mz = rotate(r, (-px / length, -py / length, 0.0))
    # The frame of the middle: z along the line, x as near to the first axis as it can be.
    across = math.hypot(mx, my)
    nx, ny, nz = -mz * mx / across, -mz * my / across, across
    yx, yy, yz = my * nz - mz * ny, mz * nx - mx * nz, mx * ny - my * nx
    turn = (nx, yx, mx, ny, yy, my, nz, yz, mz)
    back = transpose(turn)
    dx, dy, dz = (there - here for there, here in zip(t, point, strict=True))
    return [RigidTransform(turn, point), RigidTransform(multiply(back, r), rotate(back, (dx, dy, dz)))]


def with_split_links(manipulator: Manipulator) -> tuple[Manipulator, list[Problem]]:
    """The table with a fixed row between nearly parallel axes, and a notice of each.

    A table without such axes stays as it is. In any other, signs and offsets are in the turns of the rows, and base and
    tool may share with their neighbours otherwise: the joint values mean the same.
    """
    chain, length, precision = _measured(manipulator)
    split, pairs = split_links(chain, precision, length, TOLERANCE, "split")
    if not any(pair.split for pair in pairs):
        return manipulator, []
    table = _rewritten(manipulator, split, manipulator.convention, precision, length)
    return table, [pair.notice() for pair in pairs if pair.split]


def in_convention(manipulator: Manipulator, convention: Convention) -> Manipulator:
    """The same arm with other rows: those that a person would write in a convention.

    Joint values, directions, limits and bodies mean the same; signs and offsets are in the turns of the rows.
    """
    given, length, precision = _measured(manipulator)
    chain, _ = split_links(place_sliding_axes(given, precision, length), precision, length, TOLERANCE, "auto")
    table = _rewritten(manipulator, chain, convention, precision, length)
    for value in (0.0, 0.7, -1.3):
        q = [value * (1.0 + 0.1 * number) for number in range(len(manipulator.actuated_rows))]
        one, other = forward_kinematics(manipulator, q), forward_kinematics(table, q)
        far = max(position_error(one, other), angle_error(one, other))
        if not far <= LARGEST:
            about = {"convention": str(convention), "far": f"{far:.2g}"}
            raise TableError(say("rewritten-table-differs", manipulator.mark, robot=manipulator.name, **about))
    return table


def _rewritten(
    manipulator: Manipulator, chain: Chain, convention: Convention, precision: Precision, length: float
) -> Manipulator:
    """A table with the rows of a chain, which is its own, with fixed axes where a link is split."""
    numbers = rows_of(chain, convention, precision, length, origins="fewest")
    taken = {name for row in manipulator.rows for name in (row.joint, row.link)}
    given, rows = iter(manipulator.rows), list[DHRow]()
    row: DHRow | None = None
    for axis, found in zip(chain.axes, numbers.rows, strict=True):
        if row is not None and axis.joint == row.joint:
            joint, link = (free_name(f"{name}_split", taken) for name in (row.joint, row.link))
            rows.append(DHRow(joint=joint, link=link, type=JointType.FIXED, mass=0.0, mark=row.mark, **found._asdict()))
        else:
            row = next(given)
            rows.append(replace(row, **found._asdict(), offset=0.0, sign=1))
    table = replace(manipulator, convention=convention, rows=tuple(rows), base=numbers.base, tool=numbers.tool)
    # What the links carry is where the given table has it, in the frames of this one.
    before, after = (dh_frames(each, (0.0,) * len(each.actuated_rows))[1:] for each in (manipulator, table))
    old = dict(zip([row.joint for row in manipulator.rows], before, strict=True))
    rows = [
        with_moved_body(row, frame.inverse @ old[row.joint]) if row.joint in old else row
        for row, frame in zip(table.rows, after, strict=True)
    ]
    back = table.base.inverse @ manipulator.base
    visual, collision = (_moved_mesh(mesh, back) for mesh in (table.base_visual, table.base_collision))
    return replace(table, rows=tuple(rows), base_visual=visual, base_collision=collision)


def _measured(manipulator: Manipulator) -> tuple[Chain, float, Precision]:
    """The axes of the rows, fixed ones included, each turned so that its joint counts about z; length and precision."""
    is_standard = manipulator.convention is Convention.STANDARD
    links, so_far = list[RigidTransform](), manipulator.base
    for row in manipulator.rows:
        step = row_transform(manipulator.convention, row)
        turned = RigidTransform(rotation_x(-1.0, 0.0), ZERO) if row.sign < 0 else IDENTITY
        before = so_far if is_standard else so_far @ step
        links.append(before @ turned)
        so_far = turned @ step if is_standard else turned  # a half turn is its own inverse
    axes = tuple([Axis(row.joint, row.type) for row in manipulator.rows])
    chain = Chain(axes, (*links, so_far @ manipulator.tool))
    length = chain.length
    # A turn that is off moves an axis whose frame is far away by as much more.
    return chain, length, Precision.of(TOLERANCE, max(length, *(abs(row.d) for row in manipulator.rows)))


def with_moved_body(row: DHRow, by: RigidTransform) -> DHRow:
    """A row with what its link carries in another frame, from which `by` leads to the frame that it is given in."""
    return replace(
        row,
        com=None if row.com is None else add(by.translation, rotate(by.rotation, row.com)),
        inertia=None if row.inertia is None else rotated(row.inertia, by.rotation),
        visual=_moved_mesh(row.visual, by),
        collision=_moved_mesh(row.collision, by),
    )


def _moved_mesh(shape: MeshShape | None, by: RigidTransform) -> MeshShape | None:
    return shape and replace(shape, pose=by @ shape.pose)
