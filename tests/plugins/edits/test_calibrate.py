"""The edit `calibrate`: the same differences as the readers' option `calibration`, from the same files."""

import shutil
from pathlib import Path
from typing import Any

import pytest

import dh2urdf
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import Manipulator
from dh2urdf_plugins.edits.calibrate import CalibrateOptions, edit_table

TABLE = """# convention: standard
joint, a, alpha, d
one, 0, pi/2, 0.2
two, 0.4, 0, 0
three, 0.3, 0, 0.1
"""
DIFFERENCES = "joint, a, alpha, d, theta\ntwo, 1.5, 0, 0, 0\nthree, 0, 0.02, -0.5, 0.001\n"
CONF = """delta_a = [0.001, 0.002, 0.003]
delta_alpha = [0, 0, 0.01]
delta_d = [0, 0, -0.002]
delta_theta = [0.1, 0, 0]
calibration_status = 2
"""


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.csv").write_text(TABLE)
    Path("differences.csv").write_text(DIFFERENCES)
    Path("calibration.conf").write_text(CONF)


def arm(**more: Any) -> Manipulator:
    return dh2urdf.read("arm.csv", **more)


@pytest.mark.parametrize(
    ("file", "units"), [("calibration.conf", {}), ("differences.csv", {"length_unit": "mm"}), ("differences.csv", {})]
)
def test_the_rows_are_those_of_a_reader_with_the_same_file(file: str, units: dict[str, str]) -> None:
    edited = edit_table(arm(), CalibrateOptions(file=Path(file), **units))
    Path("named.csv").write_text(DIFFERENCES.replace(" a,", " a [mm],").replace(" d,", " d [mm],"))
    read = arm(calibration=Path("named.csv" if units else file))
    for name in ("a", "alpha", "d", "theta", "offset"):
        assert [getattr(row, name) for row in edited.rows] == [getattr(row, name) for row in read.rows]
    assert edited.rows[1].a == 0.4 + {"calibration.conf": 0.002, "differences.csv": 1.5 if not units else 0.0015}[file]
    (notice,) = [each for each in edited.notices if each.field == "calibration"]
    assert notice.message in {each.message.replace("named", "differences") for each in read.notices}


def test_a_run_proves_the_calibrated_arm_against_its_own_rows() -> None:
    """A path in a run file is one from its folder, wherever the run begins; a changed file makes the arm anew."""
    Path("runs").mkdir()
    path = Path("runs", "run.yaml")
    path.write_text(
        "inputs: ../arm.csv\nedits: {stage: calibrate, options: {file: ../calibration.conf}}\noutput: {directory: out}\n"
    )
    report: Any = dh2urdf.run(path)
    assert report["exit_status"] == 0
    written = Path("runs", "out", "arm.urdf")
    joints = written.read_text().partition("<link")[2]
    assert joints == dh2urdf.convert("arm.csv", calibration="calibration.conf").text.partition("<link")[2]
    assert joints != dh2urdf.convert("arm.csv").text.partition("<link")[2]
    before = written.read_bytes()
    shutil.copy("calibration.conf", "kept.conf")
    Path("calibration.conf").write_text(CONF.replace("0.003", "0.004"))
    dh2urdf.run(path, resume=True)
    assert written.read_bytes() != before
    shutil.copy("kept.conf", "calibration.conf")
    dh2urdf.run(path, settings={"edits.0.options.file": "kept.conf"})
    assert written.read_text().partition("<link")[2] == joints


def test_a_file_that_is_missing_is_found_before_anything_is_made() -> None:
    Path("run.yaml").write_text("inputs: arm.csv\nedits: {stage: calibrate, options: {file: calib.conf}}\n")
    with pytest.raises(ConfigError, match=r"calib\.conf': there is no such file") as refused:
        dh2urdf.run("run.yaml")
    assert "run.yaml:2" in str(refused.value)


def test_the_file_of_an_edit_is_not_overwritten() -> None:
    Path("out").mkdir()
    Path("out", "arm.urdf").write_text(CONF)
    Path("run.yaml").write_text(
        "inputs: arm.csv\nedits: {stage: calibrate, options: {file: out/arm.urdf}}\noutput: {directory: out}\n"
    )
    with pytest.raises(dh2urdf.errors.Dh2UrdfError, match=r"arm\.urdf"):
        dh2urdf.run("run.yaml")
    assert Path("out", "arm.urdf").read_text() == CONF
