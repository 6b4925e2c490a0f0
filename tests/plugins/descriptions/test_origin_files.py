"""Files of origins from makers: the table of the arm, against an own product of the file's frames."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from command_line import Cli
from numpy.typing import NDArray
from plain_frames import rpy, shift, turn

import dh2urdf
from dh2urdf.errors import TableError
from reference_arms import ReferenceRobot

Frames = dict[str, Sequence[float]]

ORIGINS: dict[str, Frames] = yaml.safe_load(Path(__file__).with_name("origins.yaml").read_text("utf-8"))
UR5, FRANKA = ORIGINS["UR5"], ORIGINS["FRANKA"]
JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
Q = [[0.0] * 6, [0.3, -1.2, 0.9, -0.4, 1.1, 2.0], [-2.0, -0.5, 1.7, 0.2, -1.4, 0.6]]


def text_of(frames: Frames) -> str:
    names = ("x", "y", "z", "roll", "pitch", "yaw")
    entries = (
        f"  {name}:\n" + "".join(f"    {key}: {value!r}\n" for key, value in zip(names, values, strict=True))
        for name, values in frames.items()
    )
    return f"kinematics:\n{''.join(entries)}  hash: calib_15200003067234149431\n"


def product(frames: Frames, q: list[float]) -> NDArray[np.float64]:
    """The origins as `ur_description` has them in its URDF, each before a joint about z."""
    pose = np.eye(4)
    for (x, y, z, roll, pitch, yaw), value in zip(frames.values(), q, strict=True):
        pose = pose @ shift(x, y, z) @ rpy(roll, pitch, yaw) @ turn("z", value)
    return pose


@pytest.mark.parametrize("frames", [UR5, ORIGINS["UR5e"]], ids=["UR5", "UR5e"])
@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize("near_parallel", ["dh", "split"])
def test_the_table_is_the_arm(frames: Frames, convention: str, near_parallel: str, tmp_path: Path) -> None:
    """T(q) from the controller's base to tool0, within the tolerance that is asked for; joints keep their names."""
    (path := tmp_path / "ur_calibration.yaml").write_text(text_of(frames))
    options = {"convention": convention, "near_parallel": near_parallel, "tolerance": 1e-12}
    arm = dh2urdf.extract(path, reader="ur-kinematics", **options)
    assert [row.joint for row in arm.moving_rows] == [f"{name}_joint" for name in JOINTS]
    assert (arm.name, len(arm.rows)) == ("ur", 6 if near_parallel == "dh" else 8)
    assert (max(abs(row.d) for row in arm.rows) < 1) == (near_parallel == "split")
    for q in Q:
        assert np.abs(arm.fk(q) - product(frames, q)).max() < 2e-12


def test_in_a_run_and_in_commands(cli: Cli, tmp_path: Path) -> None:
    """The reader goes by its name: the file ends as a table does."""
    (path := tmp_path / "ur_calibration.yaml").write_text(text_of(UR5))
    assert "the axes of" not in cli("extract", path, "--from", "ur-kinematics").stdout
    assert cli("extract", path, "--from", "ur-kinematics", "--tips").stdout == "tool0: 6 moving joints\n"
    cli("convert", path, "--from", "ur-kinematics", "--set", "reader.near_parallel=split", "-o", tmp_path / "ur.urdf")
    pose = dh2urdf.extract(tmp_path / "ur.urdf", base_link="base_link", tip_link="tool0").fk(Q[1])
    assert np.abs(pose - product(UR5, Q[1])).max() < 3e-9
    (tmp_path / "run.yaml").write_text(
        f"inputs: [{{path: {path.name}, stage: ur-kinematics, options: {{near_parallel: split}}}}]\nemitters: [urdf]\n"
        "output: {directory: out}\n"
    )
    cli("run", tmp_path / "run.yaml")
    assert [each.name for each in (tmp_path / "out").glob("*.urdf")] == ["ur.urdf"]


@pytest.mark.parametrize(
    ("pattern", "new", "message"),
    [
        (r"kinematics:\n", "kinematic:\n", "'kinematic' is no entry of a chain of origins"),
        (r"  wrist_3:", "  wrist3:", "'wrist3' is no entry of a chain of origins"),
        (r"  wrist_3:(.|\n)*\Z", "", "there is no kinematics.wrist_3"),
        (r"    yaw: [^\n]*\n  upper", "  upper", "there is no kinematics.shoulder.yaw"),
        (r"x: 0\.0\n", "x: zero\n", "kinematics.shoulder.x is the text 'zero'"),
        (r"x: 0\.0\n", "x: .nan\n", "kinematics.shoulder.x is"),
        (r"(.|\n)*", "[1, 2]\n", "the file is a list of 2"),
    ],
)
def test_what_is_wrong_has_its_place(pattern: str, new: str, message: str, tmp_path: Path) -> None:
    """The entry, what was found, and what a file holds."""
    text: Any = re.sub(pattern, new, text_of(UR5), count=1)
    (path := tmp_path / "ur_calibration.yaml").write_text(text)
    with pytest.raises(TableError, match=re.escape(message)):
        dh2urdf.extract(path, reader="ur-kinematics")


def franka_text(frames: Frames) -> str:
    names = ("x", "y", "z", "roll", "pitch", "yaw")
    entries = (
        f"{name}:\n  kinematic:\n"
        + "".join(f"    {key}: {value!r}\n" for key, value in zip(names, values, strict=True))
        for name, values in frames.items()
    )
    return "\n".join(entries)


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_franka_is_the_arm(convention: str, tmp_path: Path) -> None:
    """T(q) from link0 to the flange: seven joints, and the fixed one behind them."""
    (path := tmp_path / "kinematics.yaml").write_text(franka_text(FRANKA))
    arm = dh2urdf.extract(path, reader="franka-kinematics", convention=convention, tolerance=1e-12)
    assert [row.joint for row in arm.rows] == [f"joint{number}" for number in range(1, 8)]
    for q in np.random.default_rng(8).uniform(-3, 3, (20, 7)):
        assert np.abs(arm.fk(q) - product(FRANKA, [*q, 0.0])).max() < 1e-12


def test_franka_is_the_published_table(reference_robots: list[ReferenceRobot], tmp_path: Path) -> None:
    """The rows of the Panda's table in the Robotics Toolbox, which is Craig's; the last d reaches to the flange."""
    (path := tmp_path / "kinematics.yaml").write_text(franka_text(FRANKA))
    arm = dh2urdf.extract(path, reader="franka-kinematics", convention="modified")
    (panda,) = [robot.manipulator for robot in reference_robots if robot.id == "rtb_Panda"]
    for row, published in zip(arm.rows, panda.rows, strict=True):
        assert (row.a, row.alpha, row.d, row.theta) == (published.a, published.alpha, published.d, published.theta)
    assert arm.tool.translation == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("text", "reader"), [(text_of(UR5), "ur-kinematics"), (franka_text(FRANKA), "franka-kinematics")]
)
def test_the_reader_of_tables_names_the_right_one(text: str, reader: str, cli: Cli, tmp_path: Path) -> None:
    """Its suffix is that of a table: the error is one, and its advice works."""
    (path := tmp_path / "kinematics.yaml").write_text(text)
    answer = cli("convert", path, "-o", tmp_path / "arm.urdf", status=2)
    assert (answer.stderr.count("error:"), f"`--from {reader}` reads it" in answer.stderr) == (1, True)
    cli("convert", path, "--from", reader, "-o", tmp_path / "arm.urdf")
