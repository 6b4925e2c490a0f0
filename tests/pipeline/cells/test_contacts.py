"""Arms of a cell that overlap where they start: the notice against PyBullet's shapes, and what is no overlap."""

import json
import random
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest
from command_line import Cli

import dh2urdf
from dh2urdf.cells.cell import ArmCall, Cell, CellCall
from dh2urdf.conversion.one_manipulator import Call
from dh2urdf.conversion.robots import make_item
from dh2urdf.robot import Origin, Robot
from dh2urdf_plugins.formats.urdf import EMITTER, UrdfOptions
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM, AlphaSwapOptions

TABLES = Path(__file__).parents[3] / "configs/tables"
SWAP: Call[Any] = Call(stage=TRANSFORM, options=AlphaSwapOptions())
UR5, TRACK, PANDA = (dh2urdf.read(TABLES / name) for name in ("ur5.csv", "track.csv", "panda.yaml"))


def cell(*arms: ArmCall) -> Robot:
    tables = {table.name: table for table in (UR5, TRACK, PANDA)}
    kinds = {arm.of: tables[arm.of] for arm in arms}
    return make_item(Cell(call=CellCall(name="cell", arms=arms), manipulators=kinds), SWAP)[0]


def arm(name: str, of: str = "ur5", **more: Any) -> ArmCall:
    return ArmCall(name=name, of=of, prefix=f"{name}_", **more)


def overlaps(robot: Robot) -> list[str]:
    return [notice.message for notice in robot.notices if notice.code == "arms-overlap"]


def gap_in_pybullet(robot: Robot, path: Path) -> tuple[float, float]:
    """How far shapes of different arms are apart at the home pose, and the greatest radius of a shape [m]."""
    pybullet = pytest.importorskip("pybullet")
    (file,) = EMITTER.emit(robot, "cell", UrdfOptions())
    path.write_bytes(file.content)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        body = pybullet.loadURDF(str(path), useFixedBase=True, flags=0)
        links = {}
        for joint in range(pybullet.getNumJoints(body)):
            about = pybullet.getJointInfo(body, joint)
            lower, upper = about[8], about[9]
            if about[2] != pybullet.JOINT_FIXED and lower < upper and not lower <= 0 <= upper:
                pybullet.resetJointState(body, joint, (lower + upper) / 2)
            links[about[12].decode()] = joint
        of_arm = {each.name: [links[each.prefix + link.name] for link in each.kind.links] for each in robot.arms}
        gap = 1.0
        for one, other in combinations(of_arm.values(), 2):
            for first in one:
                for second in other:
                    points = pybullet.getClosestPoints(body, body, 1.0, first, second)
                    gap = min([gap, *(point[8] for point in points)])
    finally:
        pybullet.disconnect(client)
    radii = [shape.geometry.radius for link in robot.links for shape in link.collisions]  # type: ignore[union-attr]
    return gap, max(radii)


def test_the_notice_is_of_what_pybullet_finds(tmp_path: Path) -> None:
    """Where PyBullet's cylinders are in each other, there is a notice; a capsule is at most a radius longer at each end."""
    draw = random.Random(3)  # noqa: S311 - no secret
    found = {True: 0, False: 0}
    for number in range(60):
        xyz = (draw.uniform(-0.6, 0.6), draw.uniform(-0.2, 0.2), draw.uniform(-0.2, 0.2))
        placement = Origin(xyz=xyz, rpy=(draw.uniform(-1, 1), 0.0, draw.uniform(-3, 3)))
        robot = cell(arm("left"), arm("right", "panda" if number % 2 else "ur5", placement=placement))
        gap, radius = gap_in_pybullet(robot, tmp_path / f"{number}.urdf")
        told = overlaps(robot)
        found[bool(told)] += 1
        if gap < -0.02 * radius:
            assert told, (number, gap)
        if told:
            reported = float(told[0].partition("reaches ")[2].partition(" m")[0])
            assert gap <= 2 * radius - reported + 0.001, (number, gap, reported)
    assert min(found.values()) >= 8


def test_the_deepest_pair_is_named() -> None:
    """Both arms, both links, and how deep; of several pairs the deepest, and how many there are."""
    near = Origin(xyz=(0.0, 0.02, 0.0))
    robot = cell(arm("a"), arm("b", placement=Origin(xyz=(0.0, 0.1, 0.0))), arm("c", placement=near))
    (told,) = overlaps(robot)
    assert "'a' and 'c'" in told
    assert "of 3 pairs of arms" in told
    depth = float(told.partition("reaches ")[2].partition(" m")[0])
    assert 0.02 < depth < 0.4


def test_what_is_bolted_to_an_arm_does_not_overlap_it() -> None:
    """The base of a rider is on the carriage, as it should be; an arm that another arm reaches into is another matter."""
    track = arm("track", "track")
    assert overlaps(cell(track, arm("rider", parent="track", link="tool0"))) == []
    beside = Origin(xyz=(0.0, 0.05, 0.24))
    (told,) = overlaps(cell(track, arm("rider", parent="track", link="tool0"), arm("other", placement=beside)))
    assert "'other'" in told
    upside_down = Origin(rpy=(0.0, 3.14159, 0.0))
    assert overlaps(cell(arm("left"), arm("right", parent="left", link="tool0", placement=upside_down)))


def test_far_arms_and_single_arms_have_no_notice() -> None:
    """Nothing is there to overlap."""
    assert overlaps(cell(arm("only"))) == []
    assert overlaps(cell(arm("left"), arm("right", placement=Origin(xyz=(5.0, 0.0, 0.0))))) == []


def test_arms_at_one_place_are_reported_once(cli: Cli, tmp_path: Path) -> None:
    """Where two arms have one place, of variants too, there is one notice of it, and none of their overlap."""
    (tmp_path / "run.yaml").write_text(
        f"inputs: {TABLES}/ur5.csv\n"
        "cells:\n"
        "  - {name: same, arms: [{name: a, of: ur5}, {name: b, of: ur5}]}\n"
        "  - {name: near, arms: [{name: a, of: ur5}, {name: b, of: ur5, xyz: [0, 0.01, 0]}]}\n"
        "  - {name: turned, arms: [{name: a, of: ur5}, {name: b, of: ur5}], vary: {arm: b, field: x, grid: [0, 3]}}\n"
    )
    cli("run", tmp_path / "run.yaml", "-o", tmp_path / "out")
    rows = json.loads((tmp_path / "out/report.json").read_bytes())["manipulators"]
    codes = {row["name"]: tuple(notice["code"] for notice in row["notices"]) for row in rows}
    alike = dict.fromkeys(("same", "turned_1"), ("arms-at-one-place",))
    assert codes == {"ur5": (), "near": ("arms-overlap",), "turned_2": (), **alike}
