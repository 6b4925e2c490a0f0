"""What the tests of all loaders share: an arm written by hand, and requests to load it or a published one."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from dh2urdf.conversion.loads import load_in_child
from dh2urdf.plugin_system import load as load_catalog
from dh2urdf.robot import Robot
from dh2urdf.stages import LoadReport, LoadRequest
from dh2urdf_plugins.formats import urdf
from dh2urdf_plugins.formats.urdf.reader import parse_urdf
from dh2urdf_plugins.transforms import alpha_swap

CATALOG = load_catalog()
HEIGHT, UPPER_ARM, FOREARM = 0.3, 0.4, 0.35

# An arm in a vertical plane, written by hand: joints 1 and 2 turn about y, joint 3 draws the forearm out along x,
# joint 4 turns the hand about x without end.
URDF = Path(__file__).with_name("planar.urdf").read_text("utf-8")
ROBOT = parse_urdf(URDF.encode(), "planar.urdf")


def tool_pose(q: tuple[float, ...]) -> tuple[float, ...]:
    """T(base_link → tool0) of the planar arm by plane trigonometry, as a row-major 4x4 matrix."""
    shoulder, elbow, slide, wrist = q
    c, s = math.cos(shoulder + elbow), math.sin(shoulder + elbow)
    cw, sw = math.cos(wrist), math.sin(wrist)
    x = UPPER_ARM * math.cos(shoulder) + (FOREARM + slide) * c
    z = HEIGHT - UPPER_ARM * math.sin(shoulder) - (FOREARM + slide) * s
    return (c, s * sw, s * cw, x, 0.0, cw, -sw, 0.0, -s, c * sw, c * cw, z, 0.0, 0.0, 0.0, 1.0)


POSES = ((0.0, 0.0, 0.05, 0.0), (0.4, -1.3, 0.1, 2.0), (-1.9, 1.1, 0.2, -3.0), (2.4, 1.9, 0.07, 0.5))


class PlanarArm(NamedTuple):
    """The arm by hand: its text, the robot that the text is of, and where plane trigonometry has its tool0.

    Attributes:
        urdf: the text.
        robot: the same arm as a robot.
        poses: joint vectors.
        expected: T(base_link → tool0) at each.
        reach: the length of the chain with its rail drawn out [m].
    """

    urdf: str
    robot: Robot
    poses: tuple[tuple[float, ...], ...]
    expected: tuple[tuple[float, ...], ...]
    reach: float

    @property
    def for_mujoco(self) -> str:
        """The text with what keeps MuJoCo from fusing its fixed links."""
        kept = '"planar"><mujoco><compiler fusestatic="false" discardvisual="false"/></mujoco>'
        return self.urdf.replace('"planar">', kept)

    def with_joint(self, name: str, **changes: Any) -> Robot:
        """The robot with something else about a joint."""
        joints = tuple(replace(each, **changes) if each.name == name else each for each in self.robot.joints)
        return replace(self.robot, joints=joints)

    def with_effort(self, effort: float) -> Robot:
        """The robot with another effort of its shoulder, which has 60 N·m."""
        return self.with_joint("shoulder", limits=replace(self.robot.moving_joints[0].limits, effort=effort))


@pytest.fixture
def run(require_loaders: Callable[..., None]) -> Callable[..., LoadReport]:
    """The report of a loader: as of a run, or from this process."""

    def run(name: str, request: LoadRequest, *, here: bool = False, **options: Any) -> LoadReport:
        require_loaders(name)
        loader = CATALOG.get("loader", name)
        return (loader.open if here else partial(load_in_child, loader))(request, loader.options(**options))

    return run


@pytest.fixture(scope="session")
def planar() -> PlanarArm:
    return PlanarArm(URDF, ROBOT, POSES, tuple(map(tool_pose, POSES)), HEIGHT + UPPER_ARM + FOREARM + 0.2)


@pytest.fixture
def request_for(tmp_path: Path) -> Callable[..., LoadRequest]:
    """The request to load a text, that of the planar arm where none is given."""

    def make(urdf: str = URDF, robot: Robot = ROBOT, **more: Any) -> LoadRequest:
        path = tmp_path / "planar.urdf"
        path.write_text(urdf, "utf-8")
        return LoadRequest(
            path=path, robot=robot, **{"poses": POSES, "expected": {"tool0": tuple(map(tool_pose, POSES))}, **more}
        )

    return make


@pytest.fixture
def published_request(tmp_path: Path) -> Callable[..., LoadRequest]:
    """The request to load a published arm as this project writes it; its poses are its publisher's own."""

    def make(published: Any, profile: str = "portable", **options: Any) -> LoadRequest:
        robot = alpha_swap.TRANSFORM.transform(published.manipulator, alpha_swap.TRANSFORM.options(**options))
        (file,) = urdf.EMITTER.emit(robot, "arm", urdf.EMITTER.options(profile=profile))
        path = tmp_path / file.name
        path.write_bytes(file.content)
        matrices = tuple(tuple(number for row in pose for number in row) for pose in published.poses)
        return LoadRequest(path=path, robot=robot, poses=tuple(map(tuple, published.q)), expected={"tool0": matrices})

    return make
