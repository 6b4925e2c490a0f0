"""Line drawings of things in space as SVG: an orthographic camera, and the few shapes that the pictures need."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.rotations import RigidTransform, Vec3, add, rotate, scale

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

Point = tuple[float, float]

X_COLOUR, Y_COLOUR, Z_COLOUR = "#c62f2f", "#2e8b57", "#1d5fbf"
"""Of the axes x, y and z, as every viewer of robots has them."""
INK, FAINT, BODY, BODY_TOP = "#22272e", "#8a94a0", "#dde3ea", "#eef2f6"
FIXED_WIDTH = "ui-monospace, SFMono-Regular, Menlo, Consolas, 'DejaVu Sans Mono', monospace"
FINEST = 1e-6
"""What is shorter in a picture is a point [px]."""
ROUND = 48
"""Corners of a drawn circle."""


class Camera(NamedTuple):
    """An orthographic camera.

    Attributes:
        azimuth: from where it looks, about z from x [rad].
        elevation: from how high it looks [rad].
        scale: length of a metre in the picture [px].
        centre: the point of space that is drawn at the origin of the picture [m].
    """

    azimuth: float
    elevation: float
    scale: float
    centre: Vec3 = (0.0, 0.0, 0.0)

    def project(self, point: Vec3) -> Point:
        """Where a point is drawn: to the right and downwards [px]."""
        x, y, z = (value - middle for value, middle in zip(point, self.centre, strict=True))
        c, s = math.cos(self.azimuth), math.sin(self.azimuth)
        up = z * math.cos(self.elevation) - (c * x + s * y) * math.sin(self.elevation)
        return self.scale * (c * y - s * x), -self.scale * up

    def depth(self, point: Vec3) -> float:
        """How near a point is: larger is nearer."""
        x, y, z = point
        along = math.cos(self.azimuth) * x + math.sin(self.azimuth) * y
        return along * math.cos(self.elevation) + z * math.sin(self.elevation)


class Drawing:
    """A picture under way: shapes are drawn over those before them."""

    def __init__(self, camera: Camera, *, shift: Point = (0.0, 0.0)) -> None:
        self.camera = camera
        self.shift = shift
        self.elements: list[str] = []

    def at(self, point: Vec3) -> Point:
        """Where a point of space is drawn."""
        x, y = self.camera.project(point)
        return x + self.shift[0], y + self.shift[1]

    def line(self, *points: Vec3, colour: str = INK, width: float = 2, dashes: str = "", opacity: float = 1) -> None:
        """A line through points of space."""
        extra = f' stroke-dasharray="{dashes}"' if dashes else ""
        extra += f' opacity="{opacity:g}"' if opacity != 1 else ""
        self.elements.append(
            f'<polyline points="{_points(map(self.at, points))}" fill="none" stroke="{colour}" '
            f'stroke-width="{width:g}" stroke-linecap="round" stroke-linejoin="round"{extra}/>'
        )

    def area(self, points: Iterable[Point], *, fill: str, edge: str = FAINT) -> None:
        """A filled polygon, of points of the picture."""
        self.elements.append(
            f'<polygon points="{_points(points)}" fill="{fill}" stroke="{edge}" stroke-width="1" '
            'stroke-linejoin="round"/>'
        )

    def arrow(self, start: Vec3, end: Vec3, *, colour: str, width: float = 2.5, head: float = 9) -> None:
        """An arrow from a point to another; one that points at the camera is a dot."""
        (x0, y0), (x1, y1) = self.at(start), self.at(end)
        length = math.hypot(x1 - x0, y1 - y0)
        if length < head / 2:
            self.dot(end, colour=colour, radius=width)
            return
        self.line(
            start, add(start, scale(max(0.0, 1 - head / length), _between(start, end))), colour=colour, width=width
        )
        self.head((x1, y1), ((x1 - x0) / length, (y1 - y0) / length), colour, head)

    def arc(self, frame: RigidTransform, angle: float, radius: float, *, colour: str) -> None:
        """An arrow about the z axis of a frame, from its x axis by an angle [rad]."""
        turns = [angle * step / ROUND for step in range(ROUND + 1)]
        points = [_seen(frame, (radius * math.cos(turn), radius * math.sin(turn), 0.0)) for turn in turns]
        self.line(*points[:-5], colour=colour, width=2)
        (x0, y0), (x1, y1) = self.at(points[-6]), self.at(points[-1])
        length = math.hypot(x1 - x0, y1 - y0) or 1.0
        self.head((x1, y1), ((x1 - x0) / length, (y1 - y0) / length), colour, 8)

    def path(self, points: Iterable[Point], *, colour: str = INK, width: float = 2) -> None:
        """A line through points of the picture."""
        self.elements.append(
            f'<polyline points="{_points(points)}" fill="none" stroke="{colour}" stroke-width="{width:g}"/>'
        )

    def head(self, tip: Point, towards: Point, colour: str, size: float) -> None:
        """The head of an arrow at a point of the picture, in a direction of length 1."""
        (x, y), (dx, dy) = tip, towards
        base = (x - size * dx, y - size * dy)
        half = 0.42 * size
        corners = (tip, (base[0] - half * dy, base[1] + half * dx), (base[0] + half * dy, base[1] - half * dx))
        self.elements.append(f'<polygon points="{_points(corners)}" fill="{colour}"/>')

    def dot(self, point: Vec3, *, colour: str = INK, radius: float = 4) -> None:
        """A dot."""
        x, y = self.at(point)
        self.elements.append(f'<circle cx="{_number(x)}" cy="{_number(y)}" r="{radius:g}" fill="{colour}"/>')

    def cylinder(
        self,
        frame: RigidTransform,
        radius: float,
        length: float,
        *,
        fills: tuple[str, str] = (BODY, BODY_TOP),
        edge: str = FAINT,
        corners: int = ROUND,
    ) -> None:
        """A cylinder about the z axis of a frame, centred at its origin; its side and its near end are filled."""
        turns = [math.tau * step / corners for step in range(corners)]
        ends = [
            [
                self.at(_seen(frame, (radius * math.cos(turn), radius * math.sin(turn), side * length / 2)))
                for turn in turns
            ]
            for side in (-1, 1)
        ]
        self.area(_hull(ends[0] + ends[1]), fill=fills[0], edge=edge)
        tips = [_seen(frame, (0.0, 0.0, side * length / 2)) for side in (-1, 1)]
        near = max((0, 1), key=lambda side: self.camera.depth(tips[side]))
        self.area(ends[near], fill=fills[1], edge=edge)

    def solid(self, frame: RigidTransform, radius: float, length: float, colour: tuple[float, float, float]) -> None:
        """A cylinder of a colour, darker towards its sides: red, green and blue in 0..1."""
        number = len(self.elements)
        tips = [_seen(frame, (0.0, 0.0, side * length / 2)) for side in (-1, 1)]
        (x0, y0), (x1, y1) = map(self.at, tips)
        along = math.hypot(x1 - x0, y1 - y0) or 1.0
        across = (-(y1 - y0) / along, (x1 - x0) / along) if along > FINEST else (1.0, 0.0)
        half, (x, y) = radius * self.camera.scale, self.at(frame.translation)
        ends = (x - half * across[0], y - half * across[1], x + half * across[0], y + half * across[1])
        left, top, right, bottom = map(_number, ends)
        stops = "".join(
            f'<stop offset="{at:g}" stop-color="{_shade(colour, light)}"/>'
            for at, light in ((0, 0.62), (0.4, 1.12), (1, 0.55))
        )
        self.elements.append(
            f'<linearGradient id="c{number}" gradientUnits="userSpaceOnUse" x1="{left}" y1="{top}" '
            f'x2="{right}" y2="{bottom}">'
            f"{stops}</linearGradient>"
        )
        self.cylinder(
            frame,
            radius,
            length,
            fills=(f"url(#c{number})", _shade(colour, 1.05)),
            edge=_shade(colour, 0.5),
            corners=20,
        )

    def triad(self, frame: RigidTransform, size: float, *, width: float = 2.5, head: float = 9) -> None:
        """The axes of a frame, those behind first."""
        axes = zip("xyz", (X_COLOUR, Y_COLOUR, Z_COLOUR), strict=True)
        tips = [(axis_tip(frame, axis, size), colour) for axis, colour in axes]
        for tip, colour in sorted(tips, key=lambda each: self.camera.depth(each[0])):
            self.arrow(frame.translation, tip, colour=colour, width=width, head=head)

    def label(
        self,
        point: Vec3,
        text: str,
        index: str = "",
        *,
        by: Point = (0.0, 0.0),
        colour: str = INK,
        anchor: str = "middle",
    ) -> None:
        """A symbol with an index at a point, moved by some pixels."""
        x, y = self.at(point)
        lower = f'<tspan dy="5" font-size="13">{escape(index)}</tspan>' if index else ""
        style = f'font-style="italic" fill="{colour}"'
        self._text((x + by[0], y + by[1]), f"{escape(text)}{lower}", style=style, size=19, anchor=anchor)

    def words(self, place: Point, text: str, *, size: float = 14, colour: str = FAINT, anchor: str = "middle") -> None:
        """Plain words at a place of the picture."""
        self._text(place, escape(text), style=f'fill="{colour}"', size=size, anchor=anchor)

    def code(self, place: Point, lines: Iterable[str], *, size: float = 12, leading: float = 17) -> None:
        """Lines of a file in a fixed-width font, the first at a place of the picture."""
        x, y = place
        for number, line in enumerate(lines):
            self.elements.append(
                f'<text x="{_number(x)}" y="{_number(y + number * leading)}" font-size="{size:g}" xml:space="preserve" '
                f'font-family="{FIXED_WIDTH}" fill="{INK}">{escape(line, quote=False)}</text>'
            )

    def _text(self, place: Point, content: str, *, style: str, size: float, anchor: str) -> None:
        x, y = place
        # The halo keeps text legible where it crosses a line.
        self.elements.append(
            f'<text x="{_number(x)}" y="{_number(y)}" font-size="{size:g}" text-anchor="{anchor}" {style} '
            f'stroke="#fff" stroke-width="4" stroke-linejoin="round" paint-order="stroke">{content}</text>'
        )


def svg(drawings: Sequence[Drawing], box: tuple[float, float, float, float], title: str) -> str:
    """The file of some drawings on one sheet.

    Args:
        drawings: what is drawn.
        box: left, top, width and height of the sheet [px].
        title: what is to be seen, for those who cannot see it.
    """
    left, top, width, height = box
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{left:g} {top:g} {width:g} {height:g}" width="{width:g}" '
        f'height="{height:g}" role="img" font-family="\'Source Sans 3\', \'Segoe UI\', Helvetica, Arial, sans-serif">'
    )
    lines = [
        head,
        f"<title>{escape(title)}</title>",
        f'<rect x="{left:g}" y="{top:g}" width="{width:g}" height="{height:g}" rx="10" fill="#fff"/>',
        *(element for drawing in drawings for element in drawing.elements),
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def axis_tip(frame: RigidTransform, axis: str, size: float) -> Vec3:
    """The tip of an axis of a frame, ``x``, ``y`` or ``z``, of some length."""
    return _seen(frame, tuple(size * (axis == name) for name in "xyz"))  # type: ignore[arg-type]


def _seen(frame: RigidTransform, point: Vec3) -> Vec3:
    """A point of a frame, in space."""
    return add(frame.translation, rotate(frame.rotation, point))


def _between(start: Vec3, end: Vec3) -> Vec3:
    return end[0] - start[0], end[1] - start[1], end[2] - start[2]


def _hull(points: list[Point]) -> list[Point]:
    """The convex hull of points (Andrew's monotone chain)."""
    chains = []
    for ordered in (sorted(points), sorted(points, reverse=True)):
        chain: list[Point] = []
        for point in ordered:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], point) <= 0:
                chain.pop()
            chain.append(point)
        chains += chain[:-1]
    return chains


def _shade(colour: tuple[float, float, float], light: float) -> str:
    """A colour, darker or lighter, as #rrggbb."""
    return "#" + "".join(f"{min(255, round(255 * part * light)):02x}" for part in colour)


def _turn(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _points(points: Iterable[Point]) -> str:
    return " ".join(f"{_number(x)},{_number(y)}" for x, y in points)


def _number(value: float) -> str:
    """A tenth of a pixel is enough, and the same on every machine."""
    return f"{round(value, 1) + 0.0:g}"
