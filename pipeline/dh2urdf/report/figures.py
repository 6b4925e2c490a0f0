"""The figures of a run's page, drawn by matplotlib as inline SVG.

Their colours are those of the page, light, dark or printed: matplotlib draws with a colour that stands for each, and
the SVG gets the page's CSS variable in its place. The same facts give the same bytes with the same version of
matplotlib. No text of a table is in a figure.
"""

from __future__ import annotations

import logging
import math
import re
from collections.abc import Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib.resources import as_file, files
from io import BytesIO
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.etree import ElementTree as ET

from dh2urdf.kinematics.chain import as_matrices, dh_frames, link_poses
from dh2urdf.kinematics.expected_poses import joint_ranges
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.rotations import IDENTITY, RigidTransform, Vec3, add, rotate

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from dh2urdf.kinematics.expected_poses import ExpectedPoses, Tip
    from dh2urdf.robot import Robot

SAMPLES = 5000  # joint vectors at which the workspace is looked at
FARTHEST_DRAWN = 1e9
"""How far from its root an arm may reach and be drawn [m]: beyond it is a mistake, and matplotlib's arithmetic ends."""
_MOST_VALUES = 500_000  # joint values of such a sample: arms of more than a hundred axes get fewer vectors
_MOST_LABELS = 40  # numbered joints of a drawing
_ELEVATION, _AZIMUTH = 22.0, 58.0  # of who looks at an arm, above its ground and to the right of its x axis [deg]
_INK, _MUTED, _LINE, _FILL = "#010203", "#010204", "#010205", "#010206"
_VARIABLES = {_INK: "--ink", _MUTED: "--muted", _LINE: "--line", _FILL: "--accent"}
_AXES = ("#d1495b", "#2f9e54", "#3b7dd8")  # x, y, z: seen well on white and on black
ARMS = ("#1c8cb0", "#d9822b", "#8a63d2", "#2f9e54", "#d1495b", "#8c7853")
"""The colours of a cell's arms, one after the other."""
_FONT = re.compile(r"font: [^;]*?(\d+(?:\.\d+)?px)[^;]*")
_REFERENCE = re.compile(r"""(url\(#|href="#)([\w.-]+)""")
_HALO = "; paint-order: stroke; stroke: var(--card); stroke-width: 3px; stroke-linejoin: round"  # text is seen on lines


@contextmanager
def _drawing(width: float, height: float) -> Iterator[Figure]:
    """A figure of some size [inch] in the style of the page; the settings of other drawings stay as they are."""
    from matplotlib import rc_context, rc_params_from_file, rcdefaults, rcParams
    from matplotlib.figure import Figure

    logger = logging.getLogger("matplotlib")  # It prints about its font cache and its folders at its first use.
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        with as_file(files("dh2urdf.report") / "templates" / "page.mplstyle") as path, rc_context():
            rcdefaults()
            rcParams.update(rc_params_from_file(path, use_default_template=False))
            yield Figure(figsize=(width, height))
    finally:
        logger.setLevel(level)


def _svg(figure: Figure, what: str, key: str) -> str:
    """A figure as SVG for HTML: no name spaces, no size of its own, no names of its parts but those that are used."""
    drawn = BytesIO()
    figure.savefig(drawn, format="svg", metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    root = ET.fromstring(drawn.getvalue())  # noqa: S314 - matplotlib wrote it
    used = {name for _, name in _REFERENCE.findall(drawn.getvalue().decode())}
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
        attributes = {name.rpartition("}")[2]: value for name, value in element.attrib.items()}
        if attributes.get("id") in used:
            attributes["id"] = f"{key}-{attributes['id']}"
        else:
            attributes.pop("id", None)
        if attributes.get("href", "").startswith("#"):
            attributes["href"] = f"#{key}-{attributes['href'][1:]}"
        style = _FONT.sub(r"font-size: \1", attributes.get("style", ""))
        for colour, variable in _VARIABLES.items():
            style = style.replace(colour, f"var({variable})")
        if style := style + (_HALO if element.tag == "text" else ""):
            attributes["style"] = style
        element.attrib.clear()
        element.attrib.update({n: _REFERENCE.sub(rf"\g<1>{key}-\g<2>", value) for n, value in attributes.items()})
    for metadata in root.findall("metadata"):
        root.remove(metadata)
    for size in ("width", "height", "version"):
        root.attrib.pop(size, None)
    root.attrib.update({"role": "img", "aria-label": what})
    return ET.tostring(root, encoding="unicode")


def _ticks(count: int, *, whole: bool = False) -> Any:  # noqa: ANN401 - matplotlib's
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(nbins=count, integer=whole, steps=[1, 2, 2.5, 5, 10])


# --- Lines, joint axes and frames at zero joint values ----------------------------------------------------------------


class JointAxis(NamedTuple):
    """The axis of a moving joint."""

    number: int  # among the moving joints, from 1
    at: Vec3  # a point on it [m]
    direction: Vec3  # the unit vector about which the joint turns, or along which it slides
    slides: bool


class Skeleton(NamedTuple):
    """An arm or a robot where all joint values are 0, in the root frame [m]."""

    paths: tuple[tuple[Vec3, ...], ...]  # from the root outwards; a branch of a tree begins where it leaves another one
    axes: tuple[JointAxis, ...]
    frames: tuple[RigidTransform, ...]  # the base, the frames of the links, and the tips
    tips: tuple[Vec3, ...]  # where the paths end


def arm_skeleton(tip: Tip) -> Skeleton:
    """The last arm on the way to a tip, as its table has it: along every d and a."""
    zero = [0.0] * (1 + max(tip.columns.values(), default=0))
    table, _, placement = tip.way[-1]
    root = replace(tip, way=tip.way[:-1]).pose(zero) @ placement
    frames = [root, *(root @ frame for frame in dh_frames(table, [0.0] * len(table.actuated_rows)))]
    path, axes = [frame.translation for frame in frames[:2]], list[JointAxis]()
    is_standard = table.convention is Convention.STANDARD
    for row, (pose, after) in zip(table.rows, pairwise(frames[1:]), strict=True):
        # Rows move along x of the frame after them, in the modified convention of the one before.
        start, rotation, a = (after, after.rotation, -row.a) if is_standard else (pose, pose.rotation, row.a)
        corner = add(start.translation, rotate(rotation, (a, 0.0, 0.0)))
        path += [corner, after.translation]
        if row.type is not JointType.FIXED:
            # The joint turns about z of the frame before it, in the modified convention about z of its own.
            at, rotation = (pose.translation, pose.rotation) if is_standard else (corner, after.rotation)
            direction = rotate(rotation, (0.0, 0.0, float(row.sign)))
            axes.append(JointAxis(len(axes) + 1, at, direction, row.type is JointType.PRISMATIC))
    pose = frames[-1] @ table.tool
    tool0 = pose.translation
    return Skeleton(((*path, tool0),), tuple(axes), (*frames, pose), (tool0,))


def robot_skeleton(robot: Robot) -> Skeleton:
    """A robot as its joints have it: straight from link to link; a ValueError where no parents come first."""
    poses, met = link_poses(robot, {}), {robot.root}
    ending = {robot.root: [IDENTITY.translation]}
    paths = list(ending.values())
    axes: list[JointAxis] = []
    frames = [IDENTITY]
    for joint in robot.joints:
        if joint.parent not in met:
            raise ValueError(f"the joint {joint.name!r} has no parent {joint.parent!r} before it")
        met.add(joint.child)
        pose = poses[joint.child]
        path = ending.pop(joint.parent, None)
        if path is None:  # another child of it has gone on with its line
            path = [poses[joint.parent].translation]
            paths.append(path)
        path.append(pose.translation)
        ending[joint.child] = path
        if joint.type is not JointType.FIXED:
            direction = rotate(pose.rotation, joint.axis)
            axes.append(JointAxis(len(axes) + 1, pose.translation, direction, joint.type is JointType.PRISMATIC))
            frames.append(pose)
    # Of frames that end in one point, such as a flange and tool0, the last one is drawn.
    ends = {poses[link].translation: poses[link] for link in ending}
    lines = tuple(tuple(path) for path in paths if len(set(path)) > 1)
    return Skeleton(lines, tuple(axes), (*frames, *ends.values()), tuple(ends))


# --- The arm --------------------------------------------------------------------------------------------------------


def skeleton_figure(arms: Sequence[Skeleton], what: str, key: str) -> str:
    """Arms or robots with joint axes and frames, as SVG: `what` is that in words, and `key` the figure's own word."""
    import numpy as np

    corners = [point for arm in arms for path in arm.paths for point in path]
    points = np.array([*(frame.translation for arm in arms for frame in arm.frames), *corners])
    low, high = points.min(axis=0), points.max(axis=0)
    size = max(float((high - low).max()), 1e-3)
    middle, extent = (low + high) / 2.0, np.maximum(high - low, 0.45 * size) + 0.16 * size
    with _drawing(5.2, 3.9) as figure:
        axes: Any = figure.add_axes((-0.09, -0.06, 1.12, 1.16), projection="3d", proj_type="ortho")
        axes.set_box_aspect(extent / extent.max(), zoom=min(1.04, 0.96 * _height(np.ones(3)) / _height(extent)))
        for name, centre, width in zip("xyz", middle, extent, strict=True):
            getattr(axes, f"set_{name}lim")(centre - width / 2.0, centre + width / 2.0)
            axis = getattr(axes, f"{name}axis")
            axis.set_major_locator(_ticks(4))
            axis.set_tick_params(labelsize=7.5, pad=-1)
            axis.set_pane_color((0.0, 0.0, 0.0, 0.0))
            axis.line.set_color(_LINE)
            getattr(axes, f"set_{name}label")(f"{name} [m]", labelpad=-3, fontsize=8)
        axes.view_init(elev=_ELEVATION, azim=-_AZIMUTH)
        for arm in arms:
            _draw_arm(axes, arm, size)
        return _svg(figure, what, key)


def _height(extent: NDArray[np.float64]) -> float:
    """How high a box appears, as a share of its diagonal, which is what matplotlib fits into the drawing."""
    x, y, z = extent / math.hypot(*extent)
    up, around = math.radians(_ELEVATION), math.radians(_AZIMUTH)
    return float(z * math.cos(up) + (x * math.cos(around) + y * math.sin(around)) * math.sin(up))


def _draw_arm(axes: Any, arm: Skeleton, size: float) -> None:  # noqa: ANN401 - matplotlib has no type for 3D axes
    def line(points: Sequence[Vec3], **style: Any) -> None:  # noqa: ANN401 - matplotlib's
        axes.plot(*zip(*points, strict=True), **style)

    def ahead(at: Vec3, direction: Vec3, distance: float) -> Vec3:
        return (at[0] + distance * direction[0], at[1] + distance * direction[1], at[2] + distance * direction[2])

    labelled = len(arm.axes) <= _MOST_LABELS
    for path in arm.paths:
        line(path, color=_MUTED, linewidth=5.0, alpha=0.35, solid_capstyle="round")
        line(path, color=_INK, linewidth=1.2, solid_capstyle="round")
    taken: list[Vec3] = []
    for number, at, direction, slides in arm.axes:
        ends = [ahead(at, direction, side * 0.13 * size) for side in (-1.0, 1.0)]
        line(ends, color=_FILL, linewidth=1.1, linestyle="dotted" if slides else "dashed")
        if labelled:
            # Several joints may have one point: each next label stands farther out.
            label = ahead(at, direction, 0.17 * size)
            while any(math.dist(label, other) < 0.07 * size for other in taken):
                label = ahead(label, direction, 0.07 * size)
            taken.append(label)
            axes.text(*label, str(number), color=_FILL, fontsize=9.5, ha="center", va="center")
    for frame in arm.frames if labelled else (arm.frames[0], *arm.frames[-len(arm.tips) :]):
        for unit, colour in zip(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), _AXES, strict=True):
            end = add(frame.translation, rotate(frame.rotation, ahead((0.0, 0.0, 0.0), unit, 0.075 * size)))
            line([frame.translation, end], color=colour, linewidth=1.5)
    origins = [frame.translation for frame in arm.frames]
    for at, marker, large in ((origins[0], "s", 6.0), *((tip, "o", 6.5) for tip in arm.tips)):
        line([at], color=_INK, marker=marker, markersize=large)
    line(origins, color=_INK, linestyle="none", marker="o", markersize=2.6)


# --- The workspace --------------------------------------------------------------------------------------------------


class Workspace:
    """Where the tips of a robot get to at random joint vectors inside the limits: `points`, (samples, 3) [m]."""

    def __init__(self, expected: ExpectedPoses, robot: Robot) -> None:
        import numpy as np

        ranges = np.array(joint_ranges(expected, robot)).reshape(-1, 2)
        samples = max(500, min(SAMPLES, _MOST_VALUES // max(1, len(ranges))))
        shares = np.random.default_rng(20240229).random((samples, len(ranges)))
        columns = list((ranges[:, 0] + shares * (ranges[:, 1] - ranges[:, 0])).T)
        self.points: dict[str, NDArray[np.float64]] = {}
        for tip in expected.tips:
            poses = np.broadcast_to(as_matrices(tip.pose(columns)), (samples, 4, 4))
            self.points[tip.link] = poses[:, :3, 3]

    def extent(self, tip: str) -> dict[str, float]:
        """How far a tip got from the z axis of the root, from its origin, and how low and high [m]."""
        import numpy as np

        points = self.points[tip]
        return {
            "radius": float(np.hypot(points[:, 0], points[:, 1]).max()),
            "distance": float(np.linalg.norm(points, axis=1).max()),
            "low": float(points[:, 2].min()),
            "high": float(points[:, 2].max()),
        }

    def figure(self, key: str) -> str:
        """The points from the top and from the side, as SVG, with a key as of `skeleton_figure`."""
        import numpy as np

        together = np.concatenate([*self.points.values(), np.zeros((1, 3))])
        low, high = together.min(axis=0), together.max(axis=0)
        pad = 0.06 * max(float((high - low).max()), 1e-3)
        with _drawing(8.0, 3.7) as figure:
            views = figure.subplots(1, 2)
            for axes, vertical, title in zip(views, (1, 2), ("from the top", "from the side"), strict=True):
                for number, points in enumerate(self.points.values()):
                    # Thousands of points are a picture in the figure, not thousands of elements of the page.
                    at, colour = (points[:, 0], points[:, vertical]), ARMS[number % len(ARMS)]
                    axes.scatter(*at, s=2.2, color=colour, alpha=0.5, linewidths=0, rasterized=True)
                axes.plot(0.0, 0.0, marker="+", color=_INK, markersize=9)
                axes.set(aspect="equal", title=title, xlabel="x [m]", ylabel=f"{'xyz'[vertical]} [m]")
                axes.set_xlim(low[0] - pad, high[0] + pad)
                axes.set_ylim(low[vertical] - pad, high[vertical] + pad)
                axes.xaxis.set_major_locator(_ticks(5))
                axes.yaxis.set_major_locator(_ticks(5))
            figure.tight_layout()
            return _svg(figure, "where tool0 gets to, seen from the top and from the side", key)


# --- Distributions --------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Bars:
    """A distribution, ready to be drawn."""

    title: str
    edges: Sequence[Any]  # edges of the bars, one more than there are bars; or their words, one for each
    counts: Sequence[int]
    unit: str = ""
    logarithmic: bool = False  # whether the edges are powers of ten


def bars_figure(several: Sequence[Bars], what: str, key: str) -> str:
    """Distributions side by side, at most three, and below each other, as SVG, with a key as of `skeleton_figure`."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    rows, wide = -(-len(several) // 3), min(3, len(several))
    with _drawing(3.1 * wide, 1.9 * rows + 0.1) as figure:
        grid = figure.subplots(rows, wide, squeeze=False)
        for axes in grid.flat[len(several) :]:
            axes.set_axis_off()
        for axes, bars in zip(grid.flat, several, strict=False):
            if len(bars.edges) == len(bars.counts):
                axes.bar([str(edge) for edge in bars.edges], bars.counts, color=_FILL, width=0.6)
            else:
                axes.stairs(bars.counts, bars.edges, fill=True, color=_FILL)
                axes.xaxis.set_major_locator(_ticks(5))
            if bars.logarithmic:
                axes.set_xscale("log")
                axes.xaxis.set_major_locator(LogLocator(numticks=5))
                axes.xaxis.set_minor_locator(NullLocator())
                axes.xaxis.set_major_formatter(FuncFormatter(lambda power, _: f"{power:.0e}"))
            axes.grid(visible=False, axis="x")
            axes.set_title(bars.title)
            axes.set_xlabel(bars.unit, fontsize=8)
            axes.tick_params(labelsize=7.5)
            axes.yaxis.set_major_locator(_ticks(4, whole=True))
        figure.tight_layout()
        return _svg(figure, what, key)
