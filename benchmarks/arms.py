"""Tables of arms that are all different, for benchmarks."""

from __future__ import annotations

import csv
import random
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from pathlib import Path

HALF_PI = 1.5707963267948966
TWISTS = (HALF_PI, 0.0, 0.0, HALF_PI, -HALF_PI, 0.0)


class Lengths(NamedTuple):
    """Between which limits the lengths of a table lie [m]."""

    a: tuple[float, float]
    d: tuple[float, float]


# Every one is long enough for a cylinder to be seen and one to collide with. Of shorter ones some have these, and so
# nearly every robot of many axes would be of a form of its own.
LONG = Lengths(a=(0.2, 0.8), d=(0.15, 0.4))
SHORT = Lengths(a=(0.1, 0.12), d=(0.045, 0.055))
"""With these an arm of 600 axes is not longer than 100 m, which would be noticed in each."""


def write_table(path: Path, robots: int, *, axes: int = 6, lengths: Lengths | None = None) -> None:
    """Robots like a UR5, no two of them alike.

    Args:
        path: the CSV file that is written.
        robots: how many.
        axes: of each.
        lengths: with them robots differ in numbers only. Without, a tenth of the twists is no multiple of a quarter
            turn, and some links are too short for a shape, so that the files of many have other elements.
    """
    draw = random.Random(3)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["robot", "joint", "type", "a", "alpha", "d", "theta", "lower", "upper", "velocity", "effort"])
        for robot in range(robots):
            for axis in range(axes):
                twist = TWISTS[axis % 6]
                if lengths:
                    a, d = draw.choice((-1, 1)) * draw.uniform(*lengths.a), draw.uniform(*lengths.d)
                else:
                    twist = twist if draw.random() < 0.9 else round(draw.uniform(-1.2, 1.2), 4)
                    a, d = draw.uniform(-0.4, 0.4), draw.uniform(0, 0.4)  # so that no arm is long enough for a notice
                a, d, theta = round(a, 5), round(d, 5), round(draw.uniform(-1.4, 1.4), 4)
                name = f"joint_{axis + 1}"
                writer.writerow([f"arm_{robot}", name, "revolute", a, twist, d, theta, -3.14, 3.14, 3.15, 150])
