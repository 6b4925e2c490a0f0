"""From where a picture shows an arm well: the same pose, the same lens and the same place for every simulator."""

from __future__ import annotations

import math
from io import BytesIO
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from dh2urdf.manipulator import JointType
from dh2urdf.output import write_whole
from dh2urdf.robot import Link, Mesh
from dh2urdf.rotations import ZERO, RigidTransform, Vec3
from dh2urdf_plugins.loaders import measures

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from dh2urdf.robot import Robot

JointVector: TypeAlias = tuple[float, ...]
Frames: TypeAlias = dict[str, RigidTransform]

WIDTH, HEIGHT = 800, 600  # size of the picture [pixels]
FIELD_OF_VIEW = math.radians(30.0)  # vertical [rad]; a long lens keeps parallel links parallel
AZIMUTH, ELEVATION = math.radians(-55.0), math.radians(20.0)  # where the camera stands, seen from the arm [rad]
RENDERED = (2 * WIDTH, 2 * HEIGHT)
"""Size of a picture that is rendered, and then averaged: the renderers' edges are stairs [pixels]."""
FLOOR = (0.86, 0.88, 0.91, 1.0)  # colour of the floor that an arm stands on
_BORDER = 1.1  # how much farther than a tight fit
_BENDS = (0.5, 1.0)  # of the joints [rad]
_BENT_JOINTS = 4  # whose bends are tried both ways


class View(NamedTuple):
    """How the arm stands, and the camera that just sees all of it."""

    q: JointVector  # the joint vector [rad or m]
    eye: Vec3  # where the camera stands [m]
    target: Vec3  # what it looks at [m]
    distance: float  # between the two [m]
    low: Vec3  # the corner with the smallest coordinates of the box around the arm [m]
    high: Vec3  # the corner with the largest [m]

    @property
    def floor(self) -> tuple[Vec3, float]:
        """The middle of a floor under the arm, and half the length of its edges [m]."""
        middle = ((self.low[0] + self.high[0]) / 2, (self.low[1] + self.high[1]) / 2, self.low[2])
        return middle, 0.75 * math.dist(self.low, self.high)


def best_view(robot: Robot, frames_at: Callable[[JointVector], Frames]) -> View:
    """A pose that fills the largest area, with the arm hanging little below its base, and the camera for it.

    `frames_at` puts the arm at a joint vector, and returns the frames of its links in the world.
    """
    import numpy as np

    ca, sa, ce, se = math.cos(AZIMUTH), math.sin(AZIMUTH), math.cos(ELEVATION), math.sin(ELEVATION)
    # The camera's axes in the world, as rows: to the right, up, and back towards the camera.
    camera = np.array([(-sa, ca, 0.0), (-se * ca, -se * sa, ce), (ce * ca, ce * sa, se)])
    corners = {link.name: _corners(link) for link in robot.links}

    def points_at(q: JointVector) -> tuple[Any, float]:
        """Points in the world that enclose all that is seen, and the height of the root [m]."""
        frames = frames_at(q)
        seen = [
            np.add(points @ np.reshape(frames[name].rotation, (3, 3)).T, frames[name].translation)
            for name, points in corners.items()
            if len(points)
        ]
        points = np.concatenate(seen) if seen else np.array([frame.translation for frame in frames.values()])
        return points, frames[robot.root].translation[2]

    def quality(q: JointVector) -> float:
        points, base = points_at(q)
        width, height, _ = np.ptp(points @ camera.T, axis=0)
        sinking = 4.0 * (base - points[:, 2].min()) / max(height, 1e-9)
        return float(width * height / (1.0 + sinking * sinking))

    q = max(_poses(robot), key=quality)
    points, _ = points_at(q)
    seen = points @ camera.T
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
    tangent = math.tan(FIELD_OF_VIEW / 2)
    x, y, z = (seen - middle).T
    # A point at (x, y, z) is seen where |y| <= tangent · (distance − z), and |x| <= the same times the aspect.
    distance = float((z + np.maximum(np.abs(x) * HEIGHT / WIDTH, np.abs(y)) / tangent).max())
    distance = max(distance * _BORDER, 1e-3)
    eye, target = camera.T @ (middle + np.array((0.0, 0.0, distance))), camera.T @ middle
    low, high = points.min(axis=0), points.max(axis=0)
    return View(q, measures.vector(eye), measures.vector(target), distance, measures.vector(low), measures.vector(high))


def _poses(robot: Robot) -> list[JointVector]:
    """Joint vectors that may show the arm well: every joint bent, by less or more, the first ones to either side.

    Rails are drawn half way out. All are inside the limits.
    """
    poses = []
    for bend, sides in product(_BENDS, product((1, -1), repeat=min(len(robot.moving_joints), _BENT_JOINTS))):
        q = []
        for number, joint in enumerate(robot.moving_joints):
            lower, upper = joint.limits.lower, joint.limits.upper
            if joint.type is JointType.PRISMATIC and lower is not None and upper is not None:
                q.append((lower + upper) / 2)
            else:
                q.append(measures.clipped(joint, bend * sides[number % len(sides)]))
        poses.append(tuple(q))
    return poses


def _corners(link: Link) -> Any:  # noqa: ANN401 - an array of shape (n, 3)
    """Points that enclose what is seen of a link, in its frame [m]."""
    import numpy as np

    points = [np.empty((0, 3))]
    for shape in link.visuals or link.collisions:  # simulators draw what touches where nothing is seen
        if isinstance(shape.geometry, Mesh):  # It probably reaches from the link's origin to somewhere.
            points.append(np.zeros((1, 3)))
        rotation, translation = shape.origin.transform
        ends = np.array([*product((-0.5, 0.5), repeat=3)]) * (measures.edges(shape.geometry) or ZERO)
        points.append(ends @ np.reshape(rotation, (3, 3)).T + translation)
    return np.concatenate(points)


def write_png(image: Any, path: Path) -> None:  # noqa: ANN401 - an image of Pillow
    """Write a picture of the size `RENDERED`, averaged."""
    from PIL import Image

    data = BytesIO()
    image.resize((WIDTH, HEIGHT), Image.Resampling.BOX).save(data, "PNG", optimize=True)
    write_whole(path, data.getvalue())
