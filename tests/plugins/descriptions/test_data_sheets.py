"""Known arms as their descriptions place the joints: the rows that their makers or the literature publish come back.

UR5 and Panda, KUKA KR 6 R900 and ABB IRB 2400/10 have the origins of the ROS packages of their makers' arms
(`ur_description`, `franka_description`, `kuka_kr6_support`, `abb_irb2400_support`). Nobody published a description of
the Puma 560 and the Stanford arm with the maker; theirs are drawn with all frames parallel to the base at zero.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import pytest
from lxml import etree

import dh2urdf

if TYPE_CHECKING:
    from pathlib import Path

HALF = math.pi / 2
ROUNDED = 1.57079632679
"""π/2 as the descriptions of ROS write it."""
Z, Y = "0 0 1", "0 1 0"


class Placed(NamedTuple):
    """A joint of a description: origin in the frame of the joint before it, and axis."""

    xyz: str
    axis: str = Z
    rpy: str = "0 0 0"
    type: str = "revolute"


class Known(NamedTuple):
    """An arm: its description, and what is published of it.

    Attributes:
        joints: the joints from base to tip.
        rows: by convention a [m], α [rad], d [m] and θ [rad] of every row.
    """

    joints: tuple[Placed, ...]
    rows: dict[str, tuple[tuple[float, float, float, float], ...]]


UR5 = Known(
    joints=(
        Placed("0 0 0", type="fixed", rpy=f"0 0 {math.pi}"),  # the frame `base` of the controller, and `base_link`
        Placed("0 0 0.089159"),
        Placed("0 0.13585 0", Y, f"0 {ROUNDED} 0"),
        Placed("0 -0.1197 0.425", Y),
        Placed("0 0 0.39225", Y, f"0 {ROUNDED} 0"),
        Placed("0 0.093 0"),
        Placed("0 0 0.09465", Y),
        Placed("0 0.0823 0", rpy=f"-{ROUNDED} 0 0", type="fixed"),
    ),
    rows={
        "standard": (
            (0, HALF, 0.089159, 0),
            (-0.425, 0, 0, 0),
            (-0.39225, 0, 0, 0),
            (0, HALF, 0.10915, 0),
            (0, -HALF, 0.09465, 0),
            (0, 0, 0.0823, 0),
        )
    },
)
PANDA = Known(
    joints=(
        Placed("0 0 0.333"),
        Placed("0 0 0", rpy=f"-{HALF} 0 0"),
        Placed("0 -0.316 0", rpy=f"{HALF} 0 0"),
        Placed("0.0825 0 0", rpy=f"{HALF} 0 0"),
        Placed("-0.0825 0.384 0", rpy=f"-{HALF} 0 0"),
        Placed("0 0 0", rpy=f"{HALF} 0 0"),
        Placed("0.088 0 0", rpy=f"{HALF} 0 0"),
        Placed("0 0 0.107", type="fixed"),
    ),
    rows={
        "modified": (
            (0, 0, 0.333, 0),
            (0, -HALF, 0, 0),
            (0, HALF, 0.316, 0),
            (0.0825, HALF, 0, 0),
            (-0.0825, -HALF, 0.384, 0),
            (0, HALF, 0, 0),
            (0.088, HALF, 0.107, 0),  # the maker's table has the flange as a row of its own
        ),
        "standard": (
            (0, -HALF, 0.333, 0),
            (0, HALF, 0, 0),
            (0.0825, HALF, 0.316, 0),
            (-0.0825, -HALF, 0, 0),
            (0, HALF, 0.384, 0),
            (0.088, HALF, 0, 0),
            (0, 0, 0.107, 0),
        ),
    },
)
PUMA_560 = Known(  # Corke and Armstrong-Hélouvry, A search for consensus among model parameters, 1994
    joints=(
        Placed("0 0 0"),
        Placed("0 0 0", "0 -1 0"),
        Placed("0.4318 0 0", "0 -1 0"),
        Placed("0.0203 -0.15005 0"),
        Placed("0 0 0.4318", "0 -1 0"),
        Placed("0 0 0"),
        Placed("0 0 0", type="fixed"),
    ),
    rows={
        "standard": (
            (0, HALF, 0, 0),
            (0.4318, 0, 0, 0),
            (0.0203, -HALF, 0.15005, 0),
            (0, HALF, 0.4318, 0),
            (0, -HALF, 0, 0),
            (0, 0, 0, 0),
        )
    },
)
STANFORD = Known(  # Scheinman, Stanford AIM-177, figure 2.3, with q₃ along the axis of the third joint
    joints=(
        Placed("0 0 0.412"),
        Placed("0 0 0", Y),
        Placed("0 0.154 0", type="prismatic"),
        Placed("0 0 0"),
        Placed("0 0 0", "1 0 0"),
        Placed("0 0 0"),
        Placed("0 0 0.263", rpy=f"0 0 -{HALF}", type="fixed"),
    ),
    rows={
        "standard": (
            (0, -HALF, 0.412, 0),
            (0, HALF, 0.154, 0),
            (0, 0, 0, -HALF),
            (0, -HALF, 0, 0),
            (0, HALF, 0, 0),
            (0, 0, 0.263, 0),
        )
    },
)
KR_6 = Known(  # a1 = 25, d1 = 400, a2 = 455, a3 = 35, d4 = 420, d6 = 80 mm; A1, A4 and A6 count the other way
    joints=(
        Placed("0 0 0.4", "0 0 -1"),
        Placed("0.025 0 0", Y),
        Placed("0.455 0 0", Y),
        Placed("0 0 0.035", "-1 0 0"),
        Placed("0.42 0 0", Y),
        Placed("0.08 0 0", "-1 0 0"),
        Placed("0 0 0", rpy=f"0 {HALF} 0", type="fixed"),
    ),
    rows={
        "standard": (
            (0.025, HALF, -0.4, 0),
            (0.455, 0, 0, 0),
            (0.035, HALF, 0, -HALF),
            (0, -HALF, -0.42, 0),
            (0, HALF, 0, 0),
            (0, math.pi, -0.08, math.pi),  # tool0 of ROS is turned by half a turn from the flange of the data sheet
        )
    },
)
IRB_2400 = Known(  # d1 = 615, a1 = 100, a2 = 705, a3 = 135, d4 = 755, d6 = 85 mm
    joints=(
        Placed("0 0 0"),
        Placed("0.1 0 0.615", Y),
        Placed("0 0 0.705", Y),
        Placed("0.258 0 0.135", "1 0 0"),
        Placed("0.497 0 0", Y),
        Placed("0.085 0 0", "1 0 0"),
        Placed("0 0 0", rpy=f"0 {ROUNDED} 0", type="fixed"),
    ),
    rows={
        "standard": (
            (0.1, -HALF, 0.615, 0),
            (0.705, 0, 0, -HALF),
            (0.135, -HALF, 0, 0),
            (0, HALF, 0.755, 0),
            (0, -HALF, 0, 0),
            (0, 0, 0.085, math.pi),
        )
    },
)


def description(known: Known) -> str:
    """A URDF of the joints alone."""
    robot = etree.Element("robot", name="arm")
    links = [f"link_{number}" for number in range(len(known.joints))] + ["tool0"]
    for name in links:
        etree.SubElement(robot, "link", name=name)
    for number, placed in enumerate(known.joints):
        joint = etree.SubElement(robot, "joint", name=f"joint_{number}", type=placed.type)
        etree.SubElement(joint, "parent", link=links[number])
        etree.SubElement(joint, "child", link=links[number + 1])
        etree.SubElement(joint, "origin", xyz=placed.xyz, rpy=placed.rpy)
        etree.SubElement(joint, "axis", xyz=placed.axis)
        if placed.type != "fixed":
            etree.SubElement(joint, "limit", lower="-1", upper="1", effort="10", velocity="1")
    return etree.tostring(robot, encoding="unicode")


@pytest.mark.parametrize(
    ("known", "convention"),
    [
        pytest.param(known, convention, id=f"{name}-{convention}")
        for name, known in {
            "UR5": UR5, "Panda": PANDA, "Puma 560": PUMA_560, "Stanford": STANFORD, "KR 6": KR_6, "IRB 2400": IRB_2400
        }.items()
        for convention in known.rows
    ],
)  # fmt: skip
def test_the_published_rows(known: Known, convention: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(description(known), "utf-8")
    found = dh2urdf.extract(path, convention=convention)
    for row, published in zip(found.rows, known.rows[convention], strict=True):
        assert (row.a, row.alpha, row.d, row.theta) == pytest.approx(published, abs=1e-10), found.rows
