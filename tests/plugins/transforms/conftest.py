from collections.abc import Callable, Sequence
from typing import Any

import pytest

from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.robot import Robot
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.robots import alpha_swap

UR5 = (
    # a [m], alpha in quarter turns, d [m]: table III of the paper
    (0.0, 1, 0.089159),
    (-0.425, 0, 0.0),
    (-0.39225, 0, 0.0),
    (0.0, 1, 0.10915),
    (0.0, -1, 0.09465),
    (0.0, 0, 0.0823),
)
HALF_PI = 1.5707963267948966


@pytest.fixture
def table() -> Callable[..., Manipulator]:
    """A table of rows that are given by what differs from zero; names are joint_1, link_1 and so on."""

    def make(*rows: dict[str, Any], convention: str = "standard", **more: Any) -> Manipulator:
        made = []
        for number, row in enumerate(rows, start=1):
            names = {"joint": f"joint_{number}", "link": f"link_{number}"}
            words = {"type": JointType(row["type"])} if "type" in row else {}
            made.append(DHRow(**(names | {"a": 0.0, "alpha": 0.0, "d": 0.0} | row | words)))
        return Manipulator(name="arm", convention=Convention(convention), rows=tuple(made), **more)

    return make


@pytest.fixture
def ur5(table: Callable[..., Manipulator]) -> Manipulator:
    """The UR5 as the paper's table III has it."""
    return table(*({"a": a, "alpha": quarters * HALF_PI, "d": d} for a, quarters, d in UR5))


@pytest.fixture
def robot_of() -> Callable[..., Robot]:
    """The robot of a table with some options."""

    def make(manipulator: Manipulator, **options: Any) -> Robot:
        return alpha_swap(manipulator, AlphaSwapOptions(**options))

    return make


@pytest.fixture
def three_axes(table: Callable[..., Manipulator]) -> Manipulator:
    """An upright arm of two equal links after a column: shapes and masses that a person can compute."""
    rows: Sequence[dict[str, Any]] = ({"d": 0.5, "alpha": HALF_PI}, {"a": 1.0}, {"a": 1.0})
    return table(*rows)
