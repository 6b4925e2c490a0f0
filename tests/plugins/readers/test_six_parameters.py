"""Rows of six parameters, of Hayati and of Khalil and Kleinfinger, against an own product of their matrices."""

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli
from numpy.typing import NDArray
from plain_frames import dh, shift, turn

import dh2urdf
from dh2urdf import Manipulator
from dh2urdf.errors import TableError

Array = NDArray[np.float64]
Row = dict[str, Any]

CONVENTIONS = ("standard", "modified")


def frames(rows: list[Row], convention: str, q: Array, base: Array) -> list[Array]:
    """The frame behind each row, its β included."""
    values, pose, found = iter(q), base, []
    for row in rows:
        value = 0.0 if row["type"] == "fixed" else row["sign"] * next(values) + row["offset"]
        slides = row["type"] == "prismatic"
        z = turn("z", row["theta"] + (0.0 if slides else value)) @ shift(z=row["d"] + (value if slides else 0.0))
        x = turn("x", row["alpha"]) @ shift(row["a"])
        before = turn("z", row["gamma"]) @ shift(z=row["b"])
        pose = pose @ (z @ x if convention == "standard" else before @ x @ z) @ turn("y", row["beta"])
        found.append(pose)
    return found


def random_rows(seed: int, convention: str) -> list[Row]:
    """Two to seven rows: the parameters that are not DH's own are 0 in some of them."""
    draw = np.random.default_rng(seed)
    rows: list[Row] = []
    for number in range(draw.integers(2, 8)):
        kind = draw.choice(["revolute", "revolute", "prismatic", "fixed"]) if number else "revolute"
        moves = kind != "fixed"
        khalil = draw.random() < 0.5 and convention == "modified"
        rows.append(
            {
                "joint": f"j{number}",
                "type": str(kind),
                "a": draw.uniform(-0.5, 0.5),
                "alpha": float(draw.choice([0.0, np.pi / 2, draw.uniform(-3, 3)])),
                "d": draw.uniform(-0.5, 0.5),
                "theta": float(draw.choice([0.0, draw.uniform(-3, 3)])),
                "offset": draw.uniform(-0.3, 0.3) * moves,
                "sign": int(draw.choice([-1, 1])) if moves else 1,
                "beta": float(draw.choice([0.0, 1e-3, draw.uniform(-3, 3)])),
                "gamma": draw.uniform(-3, 3) * khalil,
                "b": draw.uniform(-0.5, 0.5) * khalil,
                "mass": 2.0,
                "com_x": draw.uniform(-0.1, 0.1),
                "com_y": draw.uniform(-0.1, 0.1),
                "com_z": draw.uniform(-0.1, 0.1),
            }
        )
    return rows


def as_csv(rows: list[Row], convention: str) -> str:
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, list(rows[0]))
    writer.writeheader()
    writer.writerows(rows)
    return f"# convention: {convention}\n# base: {{xyz: [0.1, 0, 0.2], rpy: [0, 0, 0.3]}}\n{buffer.getvalue()}"


def as_yaml(rows: list[Row], convention: str) -> str:
    joints = [
        {"name": row["joint"], "com": [row[f"com_{axis}"] for axis in "xyz"]}
        | {key: value for key, value in row.items() if key != "joint" and not key.startswith("com_")}
        for row in rows
    ]
    return json.dumps({"convention": convention, "base": {"xyz": [0.1, 0, 0.2], "rpy": [0, 0, 0.3]}, "joints": joints})


BASE = shift(0.1, 0.0, 0.2) @ turn("z", 0.3)


def check(arm: Manipulator, rows: list[Row], convention: str, seed: int) -> None:
    """T(q), and where each link has its centre of mass; what was added has no mass."""
    by_joint = {row.joint: row for row in arm.rows}
    assert all(row.mass == 0 for name, row in by_joint.items() if name not in {each["joint"] for each in rows})
    for q in np.random.default_rng(seed).uniform(-2, 2, (4, len(arm.moving_rows))):
        expected = frames(rows, convention, q, BASE)
        assert np.abs(arm.fk(q) - expected[-1]).max() < 1e-14
        poses = arm.fk_all(q)
        for given, pose in zip(rows, expected, strict=True):
            row = by_joint[given["joint"]]
            centre = pose @ [given["com_x"], given["com_y"], given["com_z"], 1.0]
            assert row.com is not None
            assert np.abs(poses[row.link] @ [*row.com, 1.0] - centre).max() < 1e-14


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("seed", range(15))
def test_the_table_is_the_arm(seed: int, convention: str) -> None:
    """From CSV and from YAML, and once more from what is written of the table."""
    rows = random_rows(seed, convention)
    arm = dh2urdf.read(as_csv(rows, convention), reader="csv")
    check(arm, rows, convention, seed)
    assert dh2urdf.read(as_yaml(rows, convention) + "\n", reader="yaml").rows == arm.rows
    again = dh2urdf.read(arm.to_yaml(), reader="yaml")
    assert (again.rows, again.base, again.tool) == (arm.rows, arm.base, arm.tool)


def test_where_they_go() -> None:
    """A fixed row behind β, the tool for the last β, the base for the first γ, and one row for β and the next γ."""
    header = "# convention: modified\njoint,a,alpha,d,gamma,b,beta\n"
    arm = dh2urdf.read(f"{header}j1,0,0,1,0.1,0.2,0.3\nj2,1,0,0,0.4,0.5,0\nj3,1,0,0,0.6,0.7,0.8\n", reader="csv")
    assert [row.joint for row in arm.rows] == ["j1", "j1_beta", "j2", "j3_gamma", "j3"]
    assert (arm.base.translation, arm.rows[1].d, arm.rows[3].d) == ((0.0, 0.0, 0.2), 0.5, 0.7)
    assert np.abs(np.reshape(arm.tool.rotation, (3, 3)) - turn("y", 0.8)[:3, :3]).max() < 1e-15
    assert [notice.code for notice in arm.notices if notice.field == "beta"] == ["six-parameters"]


def test_hayati_is_what_keeps_nearly_parallel_axes_near() -> None:
    """A calibrated elbow: β in place of a d of hundreds of metres; `split` has nothing left to do."""
    text = "# convention: standard\na,alpha,d,beta\n0,pi/2,0.09,0\n-0.425,0.0012,0,0.0007\n-0.392,0.0004,0,0\n0,pi/2,0.1,0\n"
    arm = dh2urdf.read(text, reader="csv")
    given = [(0, np.pi / 2, 0.09, 0), (-0.425, 0.0012, 0, 0.0007), (-0.392, 0.0004, 0, 0), (0, np.pi / 2, 0.1, 0)]
    for q in np.random.default_rng(5).uniform(-3, 3, (5, 4)):
        pose = np.eye(4)
        for (a, alpha, d, beta), value in zip(given, q, strict=True):
            pose = pose @ dh("standard", value, d, a, alpha) @ turn("y", beta)
        assert np.abs(arm.fk(q) - pose).max() < 1e-15
    conversion = dh2urdf.convert(arm, near_parallel="split")
    assert [joint.name for joint in conversion.robot.joints if "split" in joint.name] == []


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_many_arms_of_one_file(convention: str, cli: Cli, tmp_path: Path) -> None:
    """Arms with and without them, in batches of a run: each file is that of its table alone."""
    tables = {f"arm{seed}": random_rows(seed, convention) for seed in range(12)}
    plain = {"beta": 0.0, "gamma": 0.0, "b": 0.0}
    rows = [
        {"robot": name} | row | (plain if number % 3 == 0 else {})
        for number, (name, table) in enumerate(tables.items())
        for row in table
    ]
    (tmp_path / "arms.csv").write_text(as_csv(rows, convention))
    (tmp_path / "run.yaml").write_text("inputs: arms.csv\nemitters: [urdf]\noutput: {directory: out}\n")
    cli("run", tmp_path / "run.yaml")
    for arm in dh2urdf.read_all(tmp_path / "arms.csv"):
        assert isinstance(arm, dh2urdf.Manipulator)
        own = [row for row in rows if row["robot"] == arm.name]
        check(arm, own, convention, 1)
        alone = dh2urdf.convert(arm).text
        written = (tmp_path / "out" / f"{arm.name}.urdf").read_text()
        assert written.splitlines()[2:] == alone.splitlines()[2:]


def test_a_table_of_differences_has_none(tmp_path: Path) -> None:
    """Differences are added to rows of four parameters: a β of them is refused, a column of zeros is not."""
    (table := tmp_path / "arm.csv").write_text("# convention: standard\na,alpha,d,beta\n0.5,0,0,0.01\n0.5,0,0,0\n")
    (differences := tmp_path / "differences.csv").write_text("a,alpha,d,beta\n0,0,0,0.001\n0,0,0,0\n")
    with pytest.raises(TableError):
        dh2urdf.read(table, calibration=differences)
    differences.write_text("a,alpha,d,beta\n0.001,0,0,0\n0,0,0,0\n")
    assert [row.a for row in dh2urdf.read(table, calibration=differences).rows] == [0.501, 0.0, 0.5]
