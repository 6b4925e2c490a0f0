from collections.abc import Callable
from itertools import count
from pathlib import Path

import pytest

import dh2urdf
from dh2urdf.manipulator import Manipulator
from dh2urdf.robot import Robot
from dh2urdf_plugins.packages.ros2 import EMITTER, Ros2Options
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.robots import alpha_swap

TABLES = Path(__file__).parents[4] / "configs" / "tables"


@pytest.fixture
def package(tmp_path: Path) -> Callable[..., tuple[Path, Robot, Manipulator]]:
    """Writes the description package of a table; its folder, the robot and the table."""
    numbers = count()

    def written(table: str, frames: str, options: Ros2Options | None = None) -> tuple[Path, Robot, Manipulator]:
        manipulator = dh2urdf.read(TABLES / table)
        robot = alpha_swap(manipulator, AlphaSwapOptions(frames=frames))
        top = tmp_path / str(next(numbers))
        files = EMITTER.emit(robot, manipulator.name, options or Ros2Options())
        for file in files:
            path = top / file.name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(file.content)
        return top / files[0].name.partition("/")[0], robot, manipulator

    return written


@pytest.fixture
def cell() -> str:
    """A run file: an arm on a track, and one of the same kind beside them."""
    return f"""
inputs: [{TABLES}/ur5.csv, {TABLES}/track.csv]
transform: {{stage: alpha-swap, options: {{frames: dh}}}}
cells:
  - name: workshop
    arms:
      - {{name: track, of: track}}
      - {{name: rider, of: ur5, prefix: r_, parent: track/tool0, xyz: [0, 0, 50 mm]}}
      - {{name: fixed, of: ur5, prefix: f_, xyz: [-1.5, 0, 0], rpy: [0, 0, pi]}}
emitters: [{{stage: ros2, options: {{moveit: true, trials: 300}}}}]
"""
