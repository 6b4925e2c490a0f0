"""A picture of the arm, rendered by MuJoCo without a display: by EGL or by OSMesa, whichever is installed."""

from __future__ import annotations

import ctypes.util
import math
import os
import sys
from typing import TYPE_CHECKING, Any

from dh2urdf_plugins.loaders.viewpoint import (
    AZIMUTH,
    ELEVATION,
    FIELD_OF_VIEW,
    FLOOR,
    HEIGHT,
    SUPERSAMPLING,
    WIDTH,
    View,
    best_view,
    write_png,
)

if TYPE_CHECKING:
    from pathlib import Path


_SHADOW_MAP = 4096  # [pixels]; with more, the processor that renders is busy with the shadow map most of the time
_LIBRARIES = {"egl": "EGL", "osmesa": "OSMesa"}  # MuJoCo's name of a way to render, and the library that it needs
_SKY = ((0.97, 0.98, 1.0), (0.90, 0.92, 0.95))  # above and below
_THICKER = 0.003  # by what share a link is drawn thicker than the one before: more than its facets are flat
_VISUALS, _FLOORS = 1, 2  # groups of shapes; MuJoCo puts what a URDF says to collide into group 0


class NoGraphicsError(Exception):
    """Nothing can be rendered on this machine."""


def graphics() -> str | None:
    """What to render by, as MuJoCo's variable MUJOCO_GL has it; None where MuJoCo knows, or the variable is set."""
    if sys.platform != "linux" or os.environ.get("MUJOCO_GL"):
        return None
    return next((name for name, library in _LIBRARIES.items() if ctypes.util.find_library(library)), "disable")


def write_picture(mujoco: Any, file: Path, arm: Any, path: Path) -> None:  # noqa: ANN401 - a module, and the arm of the loader
    """Render the arm in a pose that shows it well, and write a PNG.

    Args:
        mujoco: the module.
        file: the robot description.
        arm: the arm that was loaded from it.
        path: the file to write.

    Raises:
        NoGraphicsError: there is no library that renders without a display.
    """
    from PIL import Image

    links = [link.name for link in arm.robot.links]
    view = best_view(arm.robot, lambda q: arm.frames(q, links))
    model = _lit_model(mujoco, file, view)
    data = mujoco.MjData(model)
    data.qpos[arm.addresses(model)] = view.q
    mujoco.mj_forward(model, data)
    write_png(Image.fromarray(_render(mujoco, model, data, view)), path)


def _lit_model(mujoco: Any, file: Path, view: View) -> Any:  # noqa: ANN401 - a module without type information
    """The model on a light floor, under a light sky, with a lamp that throws shadows."""
    spec = mujoco.MjSpec.from_file(str(file.resolve()))
    spec.stat.center, spec.stat.extent = view.target, view.distance / 4
    spec.visual.global_.fovy = math.degrees(FIELD_OF_VIEW)
    spec.visual.global_.offwidth, spec.visual.global_.offheight = WIDTH * SUPERSAMPLING, HEIGHT * SUPERSAMPLING
    spec.visual.quality.shadowsize, spec.visual.quality.offsamples = _SHADOW_MAP, 0
    spec.visual.quality.numslices = 96
    spec.visual.headlight.ambient = (0.45, 0.45, 0.45)
    spec.visual.headlight.diffuse = (0.25, 0.25, 0.25)
    spec.visual.headlight.specular = (0.0, 0.0, 0.0)
    sky = spec.add_texture(name="dh2urdf sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, width=256, height=1536)
    sky.builtin = mujoco.mjtBuiltin.mjBUILTIN_GRADIENT
    sky.rgb1, sky.rgb2 = _SKY
    middle, half = view.floor
    floor = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, pos=(middle[0], middle[1], middle[2] - half / 100))
    floor.size, floor.rgba, floor.group = (half, half, half / 100), FLOOR, _FLOORS
    away = (0.6, -0.5, 1.2)
    lamp = spec.worldbody.add_light(pos=[at + 2 * view.distance * to for at, to in zip(view.target, away, strict=True)])
    lamp.dir = [-to for to in away]
    lamp.diffuse, lamp.specular, lamp.castshadow = (0.55, 0.55, 0.55), (0.1, 0.1, 0.1), True
    lamp.cutoff, lamp.exponent = 30.0, 0.0
    model = spec.compile()
    # Where links of one thickness overlap, their surfaces would fight for the same pixels.
    model.geom_size *= 1.0 + _THICKER * (model.geom_bodyid[:, None] % 4)
    return model


def _render(mujoco: Any, model: Any, data: Any, view: View) -> Any:  # noqa: ANN401 - MuJoCo's, and an array of pixels
    camera, shown = mujoco.MjvCamera(), mujoco.MjvOption()
    camera.lookat[:], camera.distance = view.target, view.distance
    camera.azimuth, camera.elevation = math.degrees(AZIMUTH) + 180.0, -math.degrees(ELEVATION)
    shown.geomgroup[:] = 0
    shown.geomgroup[_FLOORS] = 1
    shown.geomgroup[_VISUALS if _VISUALS in model.geom_group else 0] = 1
    if not hasattr(mujoco, "GLContext"):
        raise NoGraphicsError("there is no library that renders without a display")
    try:
        renderer = mujoco.Renderer(model, HEIGHT * SUPERSAMPLING, WIDTH * SUPERSAMPLING)
    except Exception as error:  # A library that is there and does not work raises errors of its own.
        raise NoGraphicsError(" ".join(str(error).split()) or type(error).__name__) from error
    try:
        renderer.update_scene(data, camera, shown)
        return renderer.render()
    finally:
        renderer.close()
