"""A picture of the arm, by PyBullet's software renderer: it needs no display and no graphics card."""

from __future__ import annotations

import math
from io import BytesIO
from itertools import product
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.manipulator import JointType
from dh2urdf.output import write_whole
from dh2urdf.robot import Box, Cylinder, Geometry, Sphere
from dh2urdf.rotations import RigidTransform, Rotation, Vec3, add, rotate, scale, transpose
from dh2urdf_plugins.loaders.measures import clipped

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from dh2urdf.robot import Joint, Robot

JointVector: TypeAlias = tuple[float, ...]
Frames: TypeAlias = dict[str, RigidTransform]

WIDTH, HEIGHT = 800, 600
"""Size of the picture [pixels]."""
_SUPERSAMPLING = 2  # rendered larger, then averaged: the renderer's edges are stairs
_FIELD_OF_VIEW = math.radians(30.0)  # vertical; a long lens keeps parallel links parallel
_AZIMUTH, _ELEVATION = math.radians(-55.0), math.radians(20.0)  # where the camera stands, seen from the arm
_BORDER = 1.1  # how much farther than a tight fit
_BENDS = (0.5, 1.0)  # of the joints [rad]
_BENT_JOINTS = 4  # whose bends are tried both ways
_SHADOWS_UP_TO = 5.0  # [m] from the camera: beyond, the renderer's fixed bias lets every surface shade itself
_FLOOR = (0.86, 0.88, 0.91, 1.0)


def write_picture(bullet: Any, robot: Robot, frames_at: Callable[[JointVector], Frames], path: Path) -> None:  # noqa: ANN401 - a module without type information
    """Render the arm in a pose that shows it well, and write a PNG.

    Args:
        bullet: the connected module.
        robot: the robot that was loaded.
        frames_at: puts the arm at a joint vector, and says the frames of its links in the world.
        path: the file to write.
    """
    from PIL import Image

    pose = max(_poses(robot), key=lambda q: _quality(_corners(robot, frames_at(q))))
    points = _corners(robot, frames_at(pose))
    eye, target, distance = _camera(points)
    _lay_floor(bullet, points)
    width, height = WIDTH * _SUPERSAMPLING, HEIGHT * _SUPERSAMPLING
    pixels = bullet.getCameraImage(
        width,
        height,
        viewMatrix=bullet.computeViewMatrix(eye, target, (0.0, 0.0, 1.0)),
        projectionMatrix=bullet.computeProjectionMatrixFOV(
            math.degrees(_FIELD_OF_VIEW), WIDTH / HEIGHT, distance / 100, distance * 100
        ),
        shadow=int(distance < _SHADOWS_UP_TO),
        lightDirection=(0.6, -0.5, 1.2),
        lightDistance=4 * distance,  # The shadows have the camera's lens: from afar they cover all that is seen.
        lightAmbientCoeff=0.6,
        lightDiffuseCoeff=0.5,
        lightSpecularCoeff=0.05,
        renderer=bullet.ER_TINY_RENDERER,
    )[2]
    image = Image.frombytes("RGBA", (width, height), bytes(pixels)).convert("RGB")
    data = BytesIO()
    image.resize((WIDTH, HEIGHT), Image.Resampling.BOX).save(data, "PNG", optimize=True)
    write_whole(path, data.getvalue())


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


def _quality(points: Sequence[Vec3]) -> float:
    """How well a pose shows the arm: by the area that it fills, less where it hangs below the base.

    Args:
        points: the points that enclose the arm, the root's origin first [m].
    """
    seen = [rotate(_CAMERA, point) for point in points]
    width, height, _ = (max(values) - min(values) for values in zip(*seen, strict=True))
    below = points[0][2] - min(point[2] for point in points)
    sinking = 4.0 * below / max(height, 1e-9)
    return float(width * height / (1.0 + sinking * sinking))


def _corners(robot: Robot, frames: Frames) -> list[Vec3]:
    """Points in the world that enclose all that is seen, and the links' origins [m]."""
    points = []
    for link in robot.links:
        frame = frames[link.name]
        points.append(frame.translation)
        for visual in link.visuals or link.collisions:  # PyBullet draws what touches where nothing is seen
            shape = frame @ visual.origin.transform
            half = _half_size(visual.geometry)
            for side in product((-1.0, 1.0), repeat=3):
                corner = (side[0] * half[0], side[1] * half[1], side[2] * half[2])
                points.append(add(shape.translation, rotate(shape.rotation, corner)))
    return points


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
    ca, sa, ce, se = math.cos(_AZIMUTH), math.sin(_AZIMUTH), math.cos(_ELEVATION), math.sin(_ELEVATION)
    return (-sa, ca, 0.0, -se * ca, -se * sa, ce, ce * ca, ce * sa, se)


_CAMERA = _camera_axes()


def _camera(points: Sequence[Vec3]) -> tuple[Vec3, Vec3, float]:
    """Where the camera stands and looks so that it just sees all points, and the distance between the two [m]."""
    seen = [rotate(_CAMERA, point) for point in points]
    x0, y0, z0 = ((min(values) + max(values)) / 2 for values in zip(*seen, strict=True))
    tangent = math.tan(_FIELD_OF_VIEW / 2)
    # A point at (x, y, z) is seen where |y| <= tangent · (distance − z), and |x| <= the same times the aspect.
    distance = max(z - z0 + max(abs(x - x0) * HEIGHT / WIDTH, abs(y - y0)) / tangent for x, y, z in seen)
    distance = max(distance * _BORDER, 1e-3)
    to_world = transpose(_CAMERA)
    return rotate(to_world, (x0, y0, z0 + distance)), rotate(to_world, (x0, y0, z0)), distance


def _lay_floor(bullet: Any, points: Sequence[Vec3]) -> None:  # noqa: ANN401 - a module without type information
    """A light floor under the arm, for its shadow to fall on."""
    low, high = ([choose(values) for values in zip(*points, strict=True)] for choose in (min, max))
    half = 0.75 * math.dist(low, high)
    thickness = half / 100
    shape = bullet.createVisualShape(
        bullet.GEOM_BOX, halfExtents=(half, half, thickness), rgbaColor=_FLOOR, specularColor=(0, 0, 0)
    )
    bullet.createMultiBody(
        baseVisualShapeIndex=shape,
        basePosition=((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2] - thickness),
    )
