"""From where a picture shows an arm well: the same pose, the same lens and the same place for every simulator."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Geometry, Mesh, Sphere
from dh2urdf.rotations import RigidTransform, Rotation, Vec3, add, rotate, scale, transpose
from dh2urdf_plugins.loaders.measures import clipped

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.robot import Joint, Robot

JointVector: TypeAlias = tuple[float, ...]
Frames: TypeAlias = dict[str, RigidTransform]

WIDTH, HEIGHT = 800, 600
"""Size of the picture [pixels]."""
FIELD_OF_VIEW = math.radians(30.0)
"""Vertical [rad]; a long lens keeps parallel links parallel."""
AZIMUTH, ELEVATION = math.radians(-55.0), math.radians(20.0)
"""Where the camera stands, seen from the arm [rad]."""
SUPERSAMPLING = 2
"""How much larger a picture is rendered, and then averaged: the renderers' edges are stairs."""
FLOOR = (0.86, 0.88, 0.91, 1.0)
"""Colour of the floor that an arm stands on."""
_BORDER = 1.1  # how much farther than a tight fit
_BENDS = (0.5, 1.0)  # of the joints [rad]
_BENT_JOINTS = 4  # whose bends are tried both ways


class View(NamedTuple):
    """How the arm stands, and the camera that just sees all of it.

    Attributes:
        q: the joint vector [rad or m].
        eye: where the camera stands [m].
        target: what it looks at [m].
        distance: between the two [m].
        low: the corner with the smallest coordinates of the box around the arm [m].
        high: the corner with the largest [m].
    """

    q: JointVector
    eye: Vec3
    target: Vec3
    distance: float
    low: Vec3
    high: Vec3

    @property
    def floor(self) -> tuple[Vec3, float]:
        """The middle of a floor under the arm, and half the length of its edges [m]."""
        middle = ((self.low[0] + self.high[0]) / 2, (self.low[1] + self.high[1]) / 2, self.low[2])
        return middle, 0.75 * math.dist(self.low, self.high)


def best_view(robot: Robot, frames_at: Callable[[JointVector], Frames]) -> View:
    """A pose that shows the arm well, and the camera for it.

    Args:
        robot: the robot that was loaded.
        frames_at: puts the arm at a joint vector, and says the frames of its links in the world.
    """

    def quality(pose: JointVector) -> float:
        frames = frames_at(pose)
        return _quality(_corners(robot, frames), frames[robot.root].translation[2])

    q = max(_poses(robot), key=quality)
    points = _corners(robot, frames_at(q))
    low, high = (
        (choose(p[0] for p in points), choose(p[1] for p in points), choose(p[2] for p in points))
        for choose in (min, max)
    )
    return View(q, *_camera(points), low, high)


def _poses(robot: Robot) -> list[JointVector]:
    """Joint vectors that may show the arm well: every joint bent, by less or more, the first ones to either side.

    Rails are drawn half way out. All are inside the limits.
    """
    joints = robot.moving_joints
    return [
        tuple(_bent(joint, bend * sides[number % len(sides)]) for number, joint in enumerate(joints))
        for bend in _BENDS
        for sides in product((1, -1), repeat=min(len(joints), _BENT_JOINTS))
    ]


def _bent(joint: Joint, bend: float) -> float:
    lower, upper = joint.limits.lower, joint.limits.upper
    if joint.type is JointType.PRISMATIC and lower is not None and upper is not None:
        return (lower + upper) / 2
    return clipped(joint, bend)


def _quality(points: Sequence[Vec3], base: float) -> float:
    """How well a pose shows the arm: by the area that it fills, less where it hangs below the base.

    Args:
        points: the points that enclose the arm [m].
        base: the height of the root [m].
    """
    seen = [rotate(_CAMERA, point) for point in points]
    width, height, _ = (max(values) - min(values) for values in zip(*seen, strict=True))
    below = base - min(point[2] for point in points)
    sinking = 4.0 * below / max(height, 1e-9)
    return float(width * height / (1.0 + sinking * sinking))


def _corners(robot: Robot, frames: Frames) -> list[Vec3]:
    """Points in the world that enclose all that is seen; the links' origins where there is nothing to see [m]."""
    points = []
    for link in robot.links:
        frame = frames[link.name]
        for visual in link.visuals or link.collisions:  # simulators draw what touches where nothing is seen
            if isinstance(visual.geometry, Mesh):  # It probably reaches from the link's origin to somewhere.
                points.append(frame.translation)
            shape = frame @ visual.origin.transform
            half = _half_size(visual.geometry)
            for side in product((-1.0, 1.0), repeat=3):
                corner = (side[0] * half[0], side[1] * half[1], side[2] * half[2])
                points.append(add(shape.translation, rotate(shape.rotation, corner)))
    return points or [frame.translation for frame in frames.values()]


def _half_size(geometry: Geometry) -> Vec3:
    """Half the edges of the box that encloses a shape [m]; a mesh, whose size only its file says, counts as a point."""
    match geometry:
        case Box(size=size):
            return scale(0.5, size)
        case Cylinder(radius=radius, length=length):
            return (radius, radius, length / 2)
        case Sphere(radius=radius):
            return (radius, radius, radius)
        case _:
            return (0.0, 0.0, 0.0)


def _camera_axes() -> Rotation:
    """The camera's axes in the world, as rows: to the right, up, and back towards the camera."""
    ca, sa, ce, se = math.cos(AZIMUTH), math.sin(AZIMUTH), math.cos(ELEVATION), math.sin(ELEVATION)
    return (-sa, ca, 0.0, -se * ca, -se * sa, ce, ce * ca, ce * sa, se)


_CAMERA = _camera_axes()


def _camera(points: Sequence[Vec3]) -> tuple[Vec3, Vec3, float]:
    """Where the camera stands and looks so that it just sees all points, and the distance between the two [m]."""
    seen = [rotate(_CAMERA, point) for point in points]
    x0, y0, z0 = ((min(values) + max(values)) / 2 for values in zip(*seen, strict=True))
    tangent = math.tan(FIELD_OF_VIEW / 2)
    # A point at (x, y, z) is seen where |y| <= tangent · (distance − z), and |x| <= the same times the aspect.
    distance = max(z - z0 + max(abs(x - x0) * HEIGHT / WIDTH, abs(y - y0)) / tangent for x, y, z in seen)
    distance = max(distance * _BORDER, 1e-3)
    to_world = transpose(_CAMERA)
    return rotate(to_world, (x0, y0, z0 + distance)), rotate(to_world, (x0, y0, z0)), distance
