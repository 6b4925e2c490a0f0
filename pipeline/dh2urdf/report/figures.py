"""The figures of a run's page, drawn by matplotlib as inline SVG.

Their colours are those of the page, light, dark or printed: matplotlib draws with a colour that stands for each, and
the SVG gets the page's CSS variable in its place. The same facts give the same bytes with the same version of
matplotlib. No text of a table is in a figure.
"""

from __future__ import annotations

import logging
import math
import re
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any, Self
from xml.etree import ElementTree as ET

from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.kinematics.proof_vectors import joint_ranges
from dh2urdf.report.skeletons import arm_skeleton
from dh2urdf.rotations import add, rotate

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from dh2urdf.kinematics.expected_poses import ExpectedPoses
    from dh2urdf.report.skeletons import Skeleton
    from dh2urdf.robot import Robot
    from dh2urdf.rotations import Vec3

SAMPLES = 5000
"""Joint vectors at which the workspace is looked at."""
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
_STYLE: dict[str, Any] = {
    "svg.hashsalt": "dh2urdf",
    "svg.fonttype": "none",
    "font.size": 9,
    "font.family": ["DejaVu Sans"],  # comes with matplotlib: places of labels are the same everywhere
    "text.color": _INK,
    "text.parse_math": False,
    "axes.edgecolor": _LINE,
    "axes.labelcolor": _MUTED,
    "axes.facecolor": "none",
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.titlesize": 9,
    "axes.titlecolor": _INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "figure.facecolor": "none",
    "grid.color": _LINE,
    "grid.linewidth": 0.6,
    "xtick.color": _LINE,
    "ytick.color": _LINE,
    "xtick.labelcolor": _MUTED,
    "ytick.labelcolor": _MUTED,
    "axes.formatter.useoffset": False,
    "savefig.transparent": True,
}


# --- The arm --------------------------------------------------------------------------------------------------------


def arm_figure(expected: ExpectedPoses, key: str) -> str:
    """The arms of a robot where all joint values are 0, with joint axes and DH frames, as SVG.

    Args:
        expected: what the tables declare about it.
        key: a word of the figure's own on its page, for the names of its parts.
    """
    return skeleton_figure(
        [arm_skeleton(tip) for tip in expected.tips],
        "the arm at zero joint values, with its joint axes and DH frames",
        key,
    )


def skeleton_figure(arms: Sequence[Skeleton], what: str, key: str) -> str:
    """Arms or robots where all joint values are 0, with joint axes and frames, as SVG.

    Args:
        arms: what is drawn.
        what: the same in words, for who does not see it.
        key: as of `arm_figure`.
    """
    import numpy as np

    points = np.array([p for arm in arms for p in (*(f.translation for f in arm.frames), *_corners(arm))])
    low, high = points.min(axis=0), points.max(axis=0)
    size = max(float((high - low).max()), 1e-3)
    middle, extent = (low + high) / 2.0, np.maximum(high - low, 0.45 * size) + 0.16 * size
    with _Canvas(5.2, 3.9) as drawing:
        axes: Any = drawing.figure.add_axes((-0.09, -0.06, 1.12, 1.16), projection="3d", proj_type="ortho")
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
        return drawing.svg(what, key)


def _height(extent: NDArray[np.float64]) -> float:
    """How high a box appears, as a share of its diagonal, which is what matplotlib fits into the drawing."""
    x, y, z = extent / math.hypot(*extent)
    up, around = math.radians(_ELEVATION), math.radians(_AZIMUTH)
    return float(z * math.cos(up) + (x * math.cos(around) + y * math.sin(around)) * math.sin(up))


def _corners(arm: Skeleton) -> list[Vec3]:
    return [point for path in arm.paths for point in path]


def _draw_arm(axes: Any, arm: Skeleton, size: float) -> None:  # noqa: ANN401 - matplotlib has no type for 3D axes
    labelled = len(arm.axes) <= _MOST_LABELS
    for path in arm.paths:
        axes.plot(*zip(*path, strict=True), color=_MUTED, linewidth=5.0, alpha=0.35, solid_capstyle="round")
        axes.plot(*zip(*path, strict=True), color=_INK, linewidth=1.2, solid_capstyle="round")
    beside = 0.13 * size
    taken: list[Vec3] = []
    for number, at, direction, slides in arm.axes:
        ends = [tuple(p + s * beside * u for p, u in zip(at, direction, strict=True)) for s in (-1.0, 1.0)]
        axes.plot(*zip(*ends, strict=True), color=_FILL, linewidth=1.1, linestyle="dotted" if slides else "dashed")
        if labelled:
            # Several joints may have one point: each next label stands farther out.
            label = tuple(p + 0.17 * size * u for p, u in zip(at, direction, strict=True))
            while any(math.dist(label, other) < 0.07 * size for other in taken):
                label = tuple(p + 0.07 * size * u for p, u in zip(label, direction, strict=True))
            taken.append(label)  # type: ignore[arg-type]  # three numbers
            axes.text(*label, str(number), color=_FILL, fontsize=9.5, ha="center", va="center")
    length = 0.075 * size
    for frame in arm.frames if labelled else (arm.frames[0], *arm.frames[-len(arm.tips) :]):
        for index, colour in enumerate(_AXES):
            unit: list[float] = [0.0, 0.0, 0.0]
            unit[index] = length
            end = add(frame.translation, rotate(frame.rotation, (unit[0], unit[1], unit[2])))
            axes.plot(*zip(frame.translation, end, strict=True), color=colour, linewidth=1.5)
    origins = [frame.translation for frame in arm.frames]
    for at, marker, large in ((origins[0], "s", 6.0), *((tip, "o", 6.5) for tip in arm.tips)):
        axes.plot(*([number] for number in at), color=_INK, marker=marker, markersize=large)
    axes.plot(*zip(*origins, strict=True), color=_INK, linestyle="none", marker="o", markersize=2.6)


# --- The workspace --------------------------------------------------------------------------------------------------


class Workspace:
    """Where the tips of a robot get to, by forward kinematics of its tables at many joint vectors at once.

    Attributes:
        points: positions of every tip in the root frame at random joint vectors inside the limits, (samples, 3) [m].
    """

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
        """The points from the top and from the side, as SVG, with a key as of `arm_figure`."""
        import numpy as np

        together = np.concatenate([*self.points.values(), np.zeros((1, 3))])
        low, high = together.min(axis=0), together.max(axis=0)
        pad = 0.06 * max(float((high - low).max()), 1e-3)
        with _Canvas(8.0, 3.7) as drawing:
            views = drawing.figure.subplots(1, 2)
            for axes, vertical, title in zip(views, (1, 2), ("from the top", "from the side"), strict=True):
                for colour, points in zip(_cycled(len(self.points)), self.points.values(), strict=True):
                    # Thousands of points are a picture in the figure, not thousands of elements of the page.
                    at = points[:, 0], points[:, vertical]
                    axes.scatter(*at, s=2.2, color=colour, alpha=0.5, linewidths=0, rasterized=True)
                axes.plot(0.0, 0.0, marker="+", color=_INK, markersize=9)
                axes.set_aspect("equal")
                axes.set_xlim(low[0] - pad, high[0] + pad)
                axes.set_ylim(low[vertical] - pad, high[vertical] + pad)
                axes.set_xlabel("x [m]")
                axes.set_ylabel(f"{'xyz'[vertical]} [m]")
                axes.set_title(title)
                axes.xaxis.set_major_locator(_ticks(5))
                axes.yaxis.set_major_locator(_ticks(5))
            drawing.figure.tight_layout()
            return drawing.svg("where tool0 gets to, seen from the top and from the side", key)


def _cycled(count: int) -> list[str]:
    return [ARMS[number % len(ARMS)] for number in range(count)]


# --- Distributions --------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Bars:
    """A distribution, ready to be drawn.

    Attributes:
        title: what is distributed, in the project's own words.
        edges: edges of the bars, one more than there are bars; or their words, one for each.
        counts: how many values each holds.
        unit: below the axis.
        logarithmic: whether the edges are powers of ten.
    """

    title: str
    edges: tuple[float, ...] | tuple[str, ...]
    counts: tuple[int, ...]
    unit: str = ""
    logarithmic: bool = False


def bars_figure(several: Sequence[Bars], what: str, key: str, columns: int = 3) -> str:
    """Distributions beside each other, as SVG, with a key as of `arm_figure`."""
    rows = -(-len(several) // columns)
    wide = min(columns, len(several))
    with _Canvas(3.1 * wide, 1.9 * rows + 0.1) as drawing:
        grid = drawing.figure.subplots(rows, wide, squeeze=False)
        for axes, bars in zip(grid.flat, several, strict=False):
            _draw_bars(axes, bars)
        for axes in grid.flat[len(several) :]:
            axes.set_axis_off()
        drawing.figure.tight_layout()
        return drawing.svg(what, key)


def _draw_bars(axes: Axes, bars: Bars) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    if len(bars.edges) == len(bars.counts):
        axes.bar([str(edge) for edge in bars.edges], bars.counts, color=_FILL, width=0.6)
    else:
        edges = [float(edge) for edge in bars.edges]
        axes.stairs(bars.counts, edges, fill=True, color=_FILL)
        if bars.logarithmic:
            axes.set_xscale("log")
            axes.xaxis.set_major_locator(LogLocator(numticks=5))
            axes.xaxis.set_minor_locator(NullLocator())
            axes.xaxis.set_major_formatter(FuncFormatter(lambda power, _: f"{power:.0e}"))
        else:
            axes.xaxis.set_major_locator(_ticks(5))
    axes.grid(visible=False, axis="x")
    axes.set_title(bars.title)
    axes.set_xlabel(bars.unit, fontsize=8)
    axes.tick_params(labelsize=7.5)
    axes.yaxis.set_major_locator(_ticks(4, whole=True))


def _ticks(count: int, *, whole: bool = False) -> Any:  # noqa: ANN401 - matplotlib's
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(nbins=count, integer=whole, steps=[1, 2, 2.5, 5, 10])


@contextmanager
def without_warnings() -> Iterator[None]:
    """Hides what matplotlib prints about its font cache and its folders at its first use."""
    logger = logging.getLogger("matplotlib")
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        logger.setLevel(level)


# --- SVG ------------------------------------------------------------------------------------------------------------


class _Canvas:
    """A figure of some size [inch] in the style of the page."""

    def __init__(self, width: float, height: float) -> None:
        from matplotlib import rc_context, rcdefaults, rcParams
        from matplotlib.figure import Figure

        self._style = rc_context()
        self._style.__enter__()
        rcdefaults()  # What a person has set for other drawings is restored afterwards.
        rcParams.update(_STYLE)  # type: ignore[arg-type]  # of names that every version has
        self.figure: Figure = Figure(figsize=(width, height), dpi=110)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._style.__exit__(None, None, None)

    def svg(self, what: str, key: str) -> str:
        """The figure as an element for the page, which says in words what it shows."""
        drawn = BytesIO()
        nothing = dict.fromkeys(("Date", "Creator", "Format", "Type"))
        self.figure.savefig(drawn, format="svg", dpi=110, metadata=nothing)
        return _inline(drawn.getvalue(), what, key)


_FONT = re.compile(r"font: [^;]*?(\d+(?:\.\d+)?px)[^;]*")
_REFERENCE = re.compile(r"""(url\(#|href="#)([\w.-]+)""")


def _inline(svg: bytes, what: str, key: str) -> str:
    """SVG as it is in HTML: no name spaces, no size of its own, no names of its parts but those that are used."""
    root = ET.fromstring(svg)  # noqa: S314 - matplotlib wrote it
    used = {name for _, name in _REFERENCE.findall(svg.decode())}
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
        for name in list(element.attrib):
            value = element.attrib.pop(name)
            plain = name.rpartition("}")[2]
            if plain == "id" and value in used:
                element.set("id", f"{key}-{value}")
            elif plain == "href" and value.startswith("#"):
                element.set("href", f"#{key}-{value[1:]}")
            elif plain != "id":
                element.set(plain, _REFERENCE.sub(rf"\g<1>{key}-\g<2>", value))
        if style := _page_style(element):
            element.set("style", style)
    for metadata in root.findall("metadata"):
        root.remove(metadata)
    for size in ("width", "height", "version"):
        root.attrib.pop(size, None)
    root.set("role", "img")
    root.set("aria-label", what)
    return ET.tostring(root, encoding="unicode")


def _page_style(element: ET.Element) -> str:
    """The style of an element with the font and the colours of the page."""
    style = _FONT.sub(r"font-size: \1", element.get("style", ""))
    for colour, variable in _VARIABLES.items():
        style = style.replace(colour, f"var({variable})")
    if element.tag == "text":  # seen on lines too
        style += "; paint-order: stroke; stroke: var(--card); stroke-width: 3px; stroke-linejoin: round"
    return style
