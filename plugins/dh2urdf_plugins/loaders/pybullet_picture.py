"""A picture of the arm, by PyBullet's software renderer: no display, no graphics card."""

from __future__ import annotations

import math
from io import BytesIO
from itertools import product
from typing import TYPE_CHECKING, Any

from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Geometry, Sphere
from dh2urdf.rotations import RigidTransform, Vec3, add, rotate, scale
from dh2urdf_plugins.loaders.measures import clipped

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from dh2urdf.robot import Robot

WIDTH, HEIGHT = 800, 600
"""Size of the picture [pixels]."""
_SUPERSAMPLING = 2  # rendered larger, then averaged: the renderer's edges are stairs
_FIELD_OF_VIEW = math.radians(30.0)  # vertical; a long lens keeps parallel links parallel
_AZIMUTH, _ELEVATION = math.radians(-55.0), math.radians(18.0)  # where the camera stands, seen from the arm
_BORDER = 1.12  # how much farther than a tight fit
_BEND = 0.6  # [rad]
_GROUND = (0.93, 0.94, 0.95, 1.0)


def picture_pose(robot: Robot) -> tuple[float, ...]:
    """A joint vector that shows the arm: bent a little, so that links do not hide one another, rails half way out."""
    q = []
    for number, joint in enumerate(robot.moving_joints):
        lower, upper = joint.limits.lower, joint.limits.upper
        if joint.type is JointType.PRISMATIC and lower is not None and upper is not None:
            q.append((lower + upper) / 2)
        else:
            q.append(clipped(joint, _BEND if number % 2 else -_BEND))
    return tuple(q)


def write_picture(bullet: Any, robot: Robot, frames: Mapping[str, RigidTransform], path: Path) -> None:  # noqa: ANN401
    """Render the arm as it stands, and write a PNG.

    Args:
        bullet: the connected module.
        robot: the robot that was loaded.
        frames: the frames of its links in the world.
        path: the file to write.
    """
    from PIL import Image

    points = _corners(robot, frames)
    _lay_ground(bullet, points)
    eye, target, distance = _camera(points)
    width, height = WIDTH * _SUPERSAMPLING, HEIGHT * _SUPERSAMPLING
    pixels = bullet.getCameraImage(
        width,
        height,
        viewMatrix=bullet.computeViewMatrix(eye, target, (0.0, 0.0, 1.0)),
        projectionMatrix=bullet.computeProjectionMatrixFOV(
            math.degrees(_FIELD_OF_VIEW), WIDTH / HEIGHT, distance / 100, distance * 100
        ),
        shadow=1,
        lightDirection=(0.6, -0.5, 1.0),
        lightDistance=2 * distance,
        lightAmbientCoeff=0.6,
        lightDiffuseCoeff=0.5,
        lightSpecularCoeff=0.05,
        renderer=bullet.ER_TINY_RENDERER,
    )[2]
    image = Image.frombytes("RGBA", (width, height), bytes(pixels)).convert("RGB")
    data = BytesIO()
    image.resize((WIDTH, HEIGHT), Image.Resampling.BOX).save(data, "PNG", optimize=True)
    path.write_bytes(data.getvalue())


def _corners(robot: Robot, frames: Mapping[str, RigidTransform]) -> list[Vec3]:
    """Points in the world that enclose all that is seen, and the links' origins [m]."""
    points = []
    for link in robot.links:
        frame = frames[link.name]
        points.append(frame.translation)
        for visual in link.visuals:
            shape = frame @ visual.origin.transform
            half = _half_size(visual.geometry)
            for signs in product((-1.0, 1.0), repeat=3):
                corner = (signs[0] * half[0], signs[1] * half[1], signs[2] * half[2])
                points.append(add(shape.translation, rotate(shape.rotation, corner)))
    return points


def _half_size(geometry: Geometry) -> Vec3:
    """Half the edges of the box that encloses a shape [m]; a mesh, whose size its file says, counts as a point."""
    match geometry:
        case Box(size=size):
            return scale(0.5, size)
        case Cylinder(radius=radius, length=length):
            return (radius, radius, length / 2)
        case Sphere(radius=radius):
            return (radius, radius, radius)
        case _:
            return (0.0, 0.0, 0.0)


def _camera(points: Sequence[Vec3]) -> tuple[Vec3, Vec3, float]:
    """Where the camera stands and looks so that it just sees all points, and the distance between the two [m]."""
    ca, sa, ce, se = math.cos(_AZIMUTH), math.sin(_AZIMUTH), math.cos(_ELEVATION), math.sin(_ELEVATION)
    right, up, back = (-sa, ca, 0.0), (-se * ca, -se * sa, ce), (ce * ca, ce * sa, se)
    axes = (*right, *up, *back)
    seen = [rotate(axes, point) for point in points]
    middle = tuple((min(values) + max(values)) / 2 for values in zip(*seen, strict=True))
    tangent = math.tan(_FIELD_OF_VIEW / 2)
    # A point at (x, y, z) is in the picture where |y| <= tangent · (distance − z), and |x| the same times the aspect.
    distance = max(
        z - middle[2] + max(abs(x - middle[0]) * HEIGHT / WIDTH, abs(y - middle[1])) / tangent for x, y, z in seen
    )
    distance = max(distance * _BORDER, 1e-3)
    target = add(add(scale(middle[0], right), scale(middle[1], up)), scale(middle[2], back))
    return add(target, scale(distance, back)), target, distance


def _lay_ground(bullet: Any, points: Sequence[Vec3]) -> None:  # noqa: ANN401 - a module without type information
    """A light floor under the arm, for its shadow to fall on."""
    low = tuple(min(values) for values in zip(*points, strict=True))
    high = tuple(max(values) for values in zip(*points, strict=True))
    size = 20 * math.dist(low, high)
    shape = bullet.createVisualShape(
        bullet.GEOM_BOX, halfExtents=(size / 2, size / 2, size / 200), rgbaColor=_GROUND, specularColor=(0, 0, 0)
    )
    bullet.createMultiBody(
        baseVisualShapeIndex=shape, basePosition=((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2] - size / 200)
    )
