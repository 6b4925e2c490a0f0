"""A picture of the arm, by PyBullet's software renderer: it needs no display and no graphics card."""

from __future__ import annotations

import math
from io import BytesIO
from typing import TYPE_CHECKING, Any

from dh2urdf.output import write_whole
from dh2urdf_plugins.loaders.viewpoint import (
    FIELD_OF_VIEW,
    FLOOR,
    HEIGHT,
    SUPERSAMPLING,
    WIDTH,
    Frames,
    JointVector,
    best_view,
)

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from dh2urdf.robot import Robot

_SHADOWS_UP_TO = 5.0  # [m] from the camera: beyond, the renderer's fixed bias lets every surface shade itself


def write_picture(bullet: Any, robot: Robot, frames_at: Callable[[JointVector], Frames], path: Path) -> None:  # noqa: ANN401 - a module without type information
    """Render the arm in a pose that shows it well, and write a PNG.

    Args:
        bullet: the connected module.
        robot: the robot that was loaded.
        frames_at: puts the arm at a joint vector, and says the frames of its links in the world.
        path: the file to write.
    """
    from PIL import Image

    view = best_view(robot, frames_at)
    frames_at(view.q)
    # A light floor under the arm, for its shadow to fall on.
    (x, y, z), half = view.floor
    thickness = half / 100
    shape = bullet.createVisualShape(
        bullet.GEOM_BOX, halfExtents=(half, half, thickness), rgbaColor=FLOOR, specularColor=(0, 0, 0)
    )
    bullet.createMultiBody(
        baseVisualShapeIndex=shape,
        basePosition=(x, y, z - thickness),
    )
    width, height = WIDTH * SUPERSAMPLING, HEIGHT * SUPERSAMPLING
    pixels = bullet.getCameraImage(
        width,
        height,
        viewMatrix=bullet.computeViewMatrix(view.eye, view.target, (0.0, 0.0, 1.0)),
        projectionMatrix=bullet.computeProjectionMatrixFOV(
            math.degrees(FIELD_OF_VIEW), WIDTH / HEIGHT, view.distance / 100, view.distance * 100
        ),
        shadow=int(view.distance < _SHADOWS_UP_TO),
        lightDirection=(0.6, -0.5, 1.2),
        lightDistance=4 * view.distance,  # The shadows have the camera's lens: from afar they cover all that is seen.
        lightAmbientCoeff=0.6,
        lightDiffuseCoeff=0.5,
        lightSpecularCoeff=0.05,
        renderer=bullet.ER_TINY_RENDERER,
    )[2]
    image = Image.frombytes("RGBA", (width, height), bytes(pixels)).convert("RGB")
    data = BytesIO()
    image.resize((WIDTH, HEIGHT), Image.Resampling.BOX).save(data, "PNG", optimize=True)
    write_whole(path, data.getvalue())
