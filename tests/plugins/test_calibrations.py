"""Calibrations: differences that are added to the rows of a table."""

import csv
import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import dh2urdf
from dh2urdf.errors import Dh2UrdfError, OutputError

UR3 = """# convention: standard
joint,a,alpha,d,theta
shoulder_pan,0,pi/2,0.1519,0
shoulder_lift,-0.24365,0,0,0
elbow,-0.21325,0,0,0
wrist_1,0,pi/2,0.11235,0
wrist_2,0,-pi/2,0.08535,0
wrist_3,0,0,0.0819,0
"""
# A real UR3's, as MyRobotLab/pyrobotlab#145 has it.
CONF = """[mounting]
delta_theta = [ 9.14361764983717684e-08, 0.178461025123001604, 6.68283349819805572, -0.578116982609792496, \
6.11299818305960363e-06, -5.03926212855332345e-07]
delta_a = [ -0.000243788991999517813, 0.00381165418642351317, 0.034503078453104935, 0.000107694612896758047, \
-0.000198736633205663144, 0]
delta_d = [ 9.225352853908797e-05, 12.0620003757611567, 17.6719025641737275, -29.7339960369544869, \
-2.8164617795367608e-05, 0.000217420471082099831]
delta_alpha = [ 0.00115615746589403656, 0.0035851898103369975, 0.00392132336586574568, 0.000406668888106365145, \
-0.00201170396009153762, 0]
joint_checksum = [ 0xb3241580, 0xb10112f1, 0x290cac88, 0xa8d3f155, 0xa8b7e9eb, 0xa8dbbfa3]
calibration_status = 2 # 0 == notInitialized / 1 == notLinearised / 2 == Linearised
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the table and the calibration of a UR3, in which the test is."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ur3.csv").write_text(UR3)
    (tmp_path / "calibration.conf").write_text(CONF)
    return tmp_path


def product(q: NDArray[np.float64], conf: str | None = None) -> NDArray[np.float64]:
    """T(q) of the table, with the differences of a calibration.conf: by numpy, from the texts themselves."""
    rows = [
        [eval(row[name], {"pi": math.pi}) for name in ("theta", "d", "a", "alpha")]  # noqa: S307 - our own texts
        for row in csv.DictReader(io.StringIO(UR3.partition("\n")[2]))
    ]
    numbers = np.array(rows, dtype=float)
    if conf is not None:
        lists = dict(line.partition("#")[0].split(" = ") for line in conf.splitlines()[1:])
        for column, name in enumerate(("theta", "d", "a", "alpha")):
            numbers[:, column] += [float(word) for word in lists[f"delta_{name}"].strip("[] ").split(",")]
    pose = np.eye(4)
    for (theta, d, a, alpha), angle in zip(numbers, q, strict=True):
        c, s, ca, sa = math.cos(theta + angle), math.sin(theta + angle), math.cos(alpha), math.sin(alpha)
        pose = pose @ [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
    return pose


def vectors(count: int = 24) -> NDArray[np.float64]:
    return np.random.default_rng(16).uniform(-math.pi, math.pi, (count, 6))


@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_the_calibrated_ur3_is_the_product_of_both_files(folder: Path, suffix: str) -> None:
    """Of the nominal table and the differences; and it is a UR3: its tip is millimetres from the nominal one."""
    table = folder / "ur3.csv"
    if suffix == ".yaml":
        joints = [line.split(",") for line in UR3.splitlines()[2:]]
        rows = "".join(f"  - {{name: {n}, a: {a}, alpha: {al}, d: {d}, theta: {t}}}\n" for n, a, al, d, t in joints)
        table = folder / "ur3.yaml"
        table.write_text(f"convention: standard\njoints:\n{rows}")
    arm = dh2urdf.read(table, calibration=folder / "calibration.conf")
    for q in vectors():
        assert np.abs(np.array(arm.fk(q)) - product(q, CONF)).max() < 1e-12
        assert np.linalg.norm(product(q, CONF)[:3, 3] - product(q)[:3, 3]) < 0.003
    assert [each.suggestion for each in arm.notices if each.field == "calibration"] == [None]


def test_it_is_converted_with_links_of_its_own_size(folder: Path) -> None:
    """Beside the axes' normals, which are 12 m and 18 m away."""
    made = dh2urdf.convert("ur3.csv", "ur3.urdf", calibration="calibration.conf", near_parallel="split")
    assert made.proofs["urdf"] is not None
    assert made.proofs["urdf"].position_error < 1e-11
    assert sum(link.inertial.mass for link in made.robot.links if link.inertial) < 30
    assert (folder / "ur3.urdf").is_file()


def test_differences_are_a_table_of_some_joints(folder: Path) -> None:
    (folder / "d.csv").write_text(
        "joint,a [mm],alpha [deg],d [mm],theta [rad]\nelbow,0.2,0.1,0,0\nwrist_1,0,0,-0.3,1e-3\n"
    )
    given, arm = (dh2urdf.read("ur3.csv", **more) for more in ({}, {"calibration": "d.csv"}))
    changed = {row.joint: row for row, other in zip(arm.rows, given.rows, strict=True) if row != other}
    assert changed.keys() == {"elbow", "wrist_1"}
    assert changed["elbow"].a == -0.21325 + 0.0002
    assert changed["elbow"].alpha == pytest.approx(math.radians(0.1), abs=1e-15)
    assert changed["wrist_1"].d == 0.11235 - 0.0003
    assert changed["wrist_1"].theta == 1e-3


def test_differences_without_names_go_by_order(folder: Path) -> None:
    joints = "".join(f"  - {{a: 0, alpha: 0, d: {n} mm}}\n" for n in range(6))
    (folder / "d.yaml").write_text(f"joints:\n{joints}")
    given, arm = (dh2urdf.read("ur3.csv", **more) for more in ({}, {"calibration": "d.yaml"}))
    found = [row.d - other.d for row, other in zip(arm.rows, given.rows, strict=True)]
    assert found == pytest.approx([0, 0.001, 0.002, 0.003, 0.004, 0.005], abs=1e-15)


def test_lists_pass_over_fixed_rows(folder: Path) -> None:
    """A calibration.conf has a number for each moving joint."""
    lines = UR3.replace("theta\n", "theta,type\n").replace(",0\n", ",0,revolute\n").splitlines()
    lines.insert(4, "bracket,0,0,0,0,fixed")
    (folder / "more.csv").write_text("\n".join(lines))
    arm = dh2urdf.read("more.csv", calibration="calibration.conf")
    bracket = arm.rows[2]
    assert (bracket.joint, bracket.a, bracket.alpha, bracket.d, bracket.theta) == ("bracket", 0, 0, 0, 0)
    assert np.abs(np.array(arm.fk(vectors(1)[0])) - product(vectors(1)[0], CONF)).max() < 1e-12


def test_a_run_file_names_the_calibration_of_an_input(folder: Path) -> None:
    """From the run file's folder, wherever the run begins."""
    (folder / "runs").mkdir()
    path = folder / "runs" / "run.yaml"
    path.write_text("inputs: [{path: ../ur3.csv, calibration: ../calibration.conf}]\noutput: {directory: out}\n")
    report: Any = dh2urdf.run(path)
    assert report["exit_status"] == 0
    written = (folder / "runs" / "out" / "ur3.urdf").read_text()
    assert written == dh2urdf.convert("ur3.csv", calibration="calibration.conf").text
    for wrong, word in (
        ("{path: ../ur3.csv, calibration: 3x.conf}", "3x.conf"),
        ("{path: ../ur3.csv, calibration: a.conf, options: {calibration: b.conf}}", "given twice"),
    ):
        path.write_text(f"inputs: [{wrong}]\noutput: {{directory: out2}}\n")
        with pytest.raises(Dh2UrdfError, match=word):
            dh2urdf.run(path)


def test_the_calibration_is_not_overwritten(folder: Path) -> None:
    with pytest.raises(OutputError, match=r"calibration\.conf"):
        dh2urdf.convert("ur3.csv", "calibration.conf", formats="urdf", calibration="calibration.conf")
    assert (folder / "calibration.conf").read_text() == CONF


def test_every_row_has_a_difference_of_its_own(folder: Path) -> None:
    """Also in a table of several manipulators, which are read one by one then."""
    header, *rows = UR3.splitlines()[1:]
    lines = [f"robot,{header}", *(f"{name},{row}" for name in "xyz" for row in rows)]
    (folder / "three.csv").write_text("# convention: standard\n" + "\n".join(lines))
    alone: Any = dh2urdf.read("ur3.csv", calibration="calibration.conf")
    for arm in dh2urdf.read_all("three.csv", calibration="calibration.conf"):
        assert isinstance(arm, dh2urdf.Manipulator)
        assert [row.d for row in arm.rows] == [row.d for row in alone.rows]
