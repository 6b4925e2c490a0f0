"""One file is the oracle of many: what is filled into a template is what `emit` writes of each robot by itself."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from dh2urdf.columns import RobotColumns, stacked
from dh2urdf.robot import Box, Collision, Cylinder, Origin, Robot, Sphere
from dh2urdf.stages import EmitsInColumns
from dh2urdf_plugins.formats.urdf import EMITTER, UrdfOptions

NUMBERS = st.one_of(
    st.sampled_from([0.0, -0.0, 1.0, -1.0, 0.5, 1e16, 1e-7, 1e22, 5e-324, 0.4000000000000001]),
    st.floats(allow_nan=False, allow_infinity=False),
)
TOUCHING = (
    Collision(geometry=Cylinder(radius=0.04, length=0.3)),
    Collision(geometry=Box(size=(0.1, 0.2, 0.3)), origin=Origin(xyz=(0.0, 0.0, 0.1))),
    Collision(geometry=Sphere(radius=0.04)),
)


def emit(robot: Robot, stem: str = "arm") -> tuple[Any, ...]:
    return tuple(EMITTER.emit(robot, stem, UrdfOptions()))


def emit_columns(robots: RobotColumns) -> Any:
    emits = EMITTER.can(EmitsInColumns)
    return emits.emit_columns(robots, [f"stem_{k}" for k in range(len(robots))], UrdfOptions())


@pytest.fixture
def touching(arm: Robot) -> Robot:
    """The arm with collision shapes on two links."""
    links = [replace(link, collisions=TOUCHING) if link.name in ("link_1", "link_3") else link for link in arm.links]
    return replace(arm, links=tuple(links))


@pytest.fixture
def many() -> Callable[..., RobotColumns]:
    """Robots of one structure, side by side."""

    def make(robots: Sequence[Robot], **more: Any) -> RobotColumns:
        together = {
            "robot": stacked(robots),
            "names": tuple(robot.name for robot in robots),
            "comments": tuple(robot.comment for robot in robots),
            "sure": np.ones(len(robots), dtype=bool),
        }
        return RobotColumns(**(together | more))

    return make


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_every_file_is_what_emit_writes(
    touching: Robot, many: Callable[..., RobotColumns], with_numbers: Callable[..., Any], data: st.DataObject
) -> None:
    """Whatever the numbers, whichever shapes are there, byte for byte."""
    count = data.draw(st.integers(1, 5))
    pool = data.draw(st.lists(NUMBERS, min_size=1, max_size=40))
    random = data.draw(st.randoms(use_true_random=False))
    robots = [
        replace(with_numbers(touching, lambda _: random.choice(pool)), name=f"arm {k}", comment=f"number {k}")
        for k in range(count)
    ]
    shapes = data.draw(st.sets(st.sampled_from([(place, number) for place in (2, 4) for number in range(3)])))
    present = {shape: np.array([random.random() < 0.5 for _ in robots]) for shape in sorted(shapes)}
    columns = many(robots, present=present)
    files = emit_columns(columns)
    assert files == [emit(columns.pick(k), f"stem_{k}") for k in range(count)]
    if not present:
        assert files == [emit(robot, f"stem_{k}") for k, robot in enumerate(robots)]


def test_a_robot_that_is_not_sure_has_no_file(arm: Robot, many: Callable[..., RobotColumns]) -> None:
    """Its numbers may be nothing that can be written."""
    bad = replace(arm, joints=(*arm.joints[:-1], replace(arm.joints[-1], origin=Origin(xyz=(float("nan"), 0.0, 0.0)))))
    files = emit_columns(many([arm, bad, arm], sure=np.array([True, False, True])))
    assert files == [emit(arm, "stem_0"), (), emit(arm, "stem_2")]
    assert emit_columns(many([bad], sure=np.array([False]))) == [()]


@pytest.mark.parametrize(
    ("words", "is_plain"),
    [({"name": name}, True) for name in ("机械臂", "it's", "a--b", "x" * 1000)]
    + [({"name": name}, False) for name in ("R&D", "a\tb", "\x00", "\ud800", "\ue000name\ue001", "x" * 9000)]
    + [({"comment": "1 < 2 & 'so on'"}, True)]
    + [({"comment": comment}, False) for comment in ("a -- b", "", "\x1b[1m", "c" * 1001)],
)
def test_names_and_comments_that_have_to_be_changed_are_left_to_emit(
    arm: Robot, many: Callable[..., RobotColumns], *, words: dict[str, str], is_plain: bool
) -> None:
    """They are escaped there, or refused; plain ones, of any script, stand as they are."""
    other = replace(arm, **words)  # type: ignore[arg-type]
    assert emit_columns(many([arm, other])) == [emit(arm, "stem_0"), emit(other, "stem_1") if is_plain else ()]


def test_a_link_may_be_named_like_a_number(arm: Robot, many: Callable[..., RobotColumns]) -> None:
    """Slots are no numbers and no words that a name could be taken for."""
    joints = [
        replace(joint, name={"turn": "1e-290", "spin": "name"}.get(joint.name, joint.name)) for joint in arm.joints
    ]
    robots = [replace(arm, joints=tuple(joints), comment=f"comment {k}") for k in range(2)]
    assert emit_columns(many(robots)) == [emit(robot, f"stem_{k}") for k, robot in enumerate(robots)]


def test_names_that_could_be_slots_are_left_to_emit(arm: Robot, many: Callable[..., RobotColumns]) -> None:
    """All robots share them, so all are made one by one."""
    joints = tuple(replace(joint, name="\ue0000\ue001") if joint.name == "spin" else joint for joint in arm.joints)
    assert emit_columns(many([replace(arm, joints=joints)])) is None


def test_a_link_that_would_be_empty_for_some_is_left_to_emit(arm: Robot, many: Callable[..., RobotColumns]) -> None:
    """Its element would have another form."""
    links = [replace(link, collisions=TOUCHING) if link.name == "base_link" else link for link in arm.links]
    robot = replace(arm, links=tuple(links))
    gone = {(0, number): np.array([True, False]) for number in range(3)}
    assert emit_columns(many([robot, robot], present=gone)) is None
    kept = many([robot, robot], present={(0, 0): np.array([True, False])})
    assert emit_columns(kept) == [emit(kept.pick(k), f"stem_{k}") for k in range(2)]


def test_what_urdf_lacks_is_left_to_emit_to_say(arm: Robot, many: Callable[..., RobotColumns]) -> None:
    """A joint without a limit is no URDF, however many there are of it."""
    joints = tuple(replace(joint, limits=replace(joint.limits, effort=None)) for joint in arm.joints)
    assert emit_columns(many([replace(arm, joints=joints)])) is None
