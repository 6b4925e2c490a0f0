"""Every rule about packages of ROS 2 against a package that breaks it, and what colcon's own parser makes of it."""

import json
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import yaml

from dh2urdf.stages import Expansion, Finding
from dh2urdf_check.packages import inspect_package, package_rules
from dh2urdf_check.rules import Outcome

Cli = Callable[..., Any]

pytest.importorskip("pinocchio")

TABLES = Path(__file__).parents[2] / "configs" / "tables"
SYSTEM_PYTHON = "/usr/bin/python3"
DESCRIPTION, MOVEIT = "ur5_description", "ur5_moveit_config"


class Fault(NamedTuple):
    """How a sound package is broken: a text of one of its files becomes another; it is found in the line of that text."""

    rule: str
    package: str
    file: str
    old: str
    new: str
    besides: Sequence[str] = ()


XML, SRDF, LIMITS = "package.xml", "config/ur5.srdf", "config/joint_limits.yaml"
FAULTS = [Fault(rule.name, **rule.proof) for rule in package_rules().values() if rule.proof]


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sound description package and a sound MoveIt package of a UR5."""
    import dh2urdf
    from dh2urdf_plugins.packages.ros2 import EMITTER, Ros2Options
    from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
    from dh2urdf_plugins.transforms.robots import alpha_swap

    robot = alpha_swap(dh2urdf.read(TABLES / "ur5.csv"), AlphaSwapOptions(frames="dh"))
    person = {"maintainer": "Ada", "email": "ada@lab.org", "license": "BSD-3-Clause"}
    folder = tmp_path_factory.mktemp("src")
    for file in EMITTER.emit(robot, "ur5", Ros2Options(moveit=True, trials=50, acceleration=10.0, **person)):
        path = folder / file.name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(file.content)
    return folder


@pytest.fixture
def source(workspace: Path, tmp_path: Path) -> Path:
    """A copy of them that a test may break."""
    return Path(shutil.copytree(workspace, tmp_path / "src"))


def findings(source: Path, package: str) -> tuple[Finding, ...]:
    return inspect_package(source / package / XML, Expansion(package_paths=(source,))).findings


def broken(source: Path, fault: Fault) -> tuple[Path, int]:
    """Breaks a package: the file, and the line."""
    path = source / fault.package / fault.file
    text = path.read_text(encoding="utf-8")
    assert fault.old in text
    place = text.index(fault.old)
    path.write_text(text[:place] + fault.new + text[place + len(fault.old) :], encoding="utf-8")
    return path, text.count("\n", 0, place) + 1


@pytest.mark.parametrize("package", [DESCRIPTION, MOVEIT])
def test_a_sound_package_has_no_finding(workspace: Path, package: str) -> None:
    """Of those that the emitter writes."""
    assert findings(workspace, package) == ()


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: f"{fault.rule}-{fault.new}")
def test_a_fault_is_found(source: Path, fault: Fault) -> None:
    """In its file and line; and nothing else is."""
    path, line = broken(source, fault)
    found = findings(source, fault.package)
    assert {finding.rule for finding in found} - set(fault.besides) == {fault.rule}
    mine = [finding for finding in found if finding.rule == fault.rule]
    assert {finding.mark.file for finding in mine if finding.mark} == {str(path)}
    if fault.rule not in {"package-not-xml", "package-not-yaml"}:  # These are found where the text cannot go on.
        assert line in {finding.mark.line for finding in mine if finding.mark}
    assert mine[0].fix == package_rules()[fault.rule].fix


def test_a_joint_without_acceleration_is_found(source: Path) -> None:
    """Whether its limits are incomplete, or it has none."""
    path = source / MOVEIT / LIMITS
    content = yaml.safe_load(path.read_text())
    del content["joint_limits"]["elbow_joint"]
    content["joint_limits"]["wrist_1_joint"]["has_acceleration_limits"] = False
    path.write_text(yaml.safe_dump(content))
    found = findings(source, MOVEIT)
    assert [finding.rule for finding in found] == ["package-missing-limits"] * 2
    assert ["elbow_joint" in found[0].message, "wrist_1_joint" in found[1].message] == [True, True]


def test_a_folder_that_is_not_installed_is_found(source: Path) -> None:
    """The file is in the package, and no launch file finds it once the package is installed."""
    path = source / DESCRIPTION / "CMakeLists.txt"
    path.write_text(path.read_text().replace("install(DIRECTORY config launch rviz", "install(DIRECTORY config launch"))
    (finding,) = findings(source, DESCRIPTION)
    assert (finding.rule, "rviz/view_robot.rviz" in finding.message) == ("package-not-installed", True)
    path.write_text(path.read_text().replace("DIRECTORY config", "DIRECTORY ${FOLDERS} config"))
    assert findings(source, DESCRIPTION) == ()


@pytest.mark.parametrize("fault", [fault for fault in FAULTS if fault.file == XML], ids=lambda fault: fault.new)
def test_colcon_refuses_what_the_table_has(source: Path, fault: Fault) -> None:
    """catkin_pkg is the parser of colcon, rosdep and bloom."""
    if subprocess.run([SYSTEM_PYTHON, "-c", "import catkin_pkg"], capture_output=True, check=False).returncode:
        pytest.skip("catkin_pkg is not installed")
    broken(source, fault)
    code = "import sys; from catkin_pkg.package import parse_package; parse_package(sys.argv[1], warnings=[])"
    command = [SYSTEM_PYTHON, "-c", code, str(source / fault.package)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    refuses = package_rules()[fault.rule].outcomes["colcon"] is Outcome.REFUSES
    assert bool(done.returncode) is refuses, done.stderr


def test_colcon_does_not_build_another_project(source: Path) -> None:
    """ament_cmake compares the names."""
    if shutil.which("colcon") is None or not Path("/usr/share/ament_cmake_core").is_dir():
        pytest.skip("colcon and ament_cmake are not installed")
    broken(source, next(fault for fault in FAULTS if fault.rule == "package-project-name"))
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(source), "LANG": "C.UTF-8"}
    command = ["colcon", "build", "--base-paths", source / DESCRIPTION]
    done = subprocess.run(command, cwd=source.parent, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode
    assert "does not match current PROJECT_NAME" in " ".join(done.stderr.split())


def test_elements_that_no_srdf_has_are_not_judged(source: Path) -> None:
    """srdfdom passes over them."""
    broken(source, Fault("", MOVEIT, SRDF, "<disable_collisions", "<disable_collision"))
    assert findings(source, MOVEIT) == ()


def test_without_the_description_joints_are_not_compared(source: Path) -> None:
    """The check of the xacro reports that its package is not known."""
    broken(source, next(fault for fault in FAULTS if fault.rule == "package-controller-joint"))
    shutil.rmtree(source / DESCRIPTION)
    assert findings(source, MOVEIT) == ()


@pytest.mark.long
def test_the_command_checks_folders_of_packages(cli: Cli, source: Path) -> None:
    """Packages and descriptions together; those of one package know the others of the folder."""
    broken(source, next(fault for fault in FAULTS if fault.rule == "package-srdf-robot"))
    answer = json.loads(cli("check", source, "--format", "json").stdout)
    rules = {finding["rule"] for finding in answer["findings"]}
    assert "package-srdf-robot" in rules
    packages = [Path(file).parent.name for file in answer["files"] if file.endswith("package.xml")]
    assert packages == [DESCRIPTION, MOVEIT]
    assert "xacro-fails" not in rules
    shown = cli("check", source, "--for", "moveit").stdout
    assert "package-srdf-robot" in shown
    assert "fixed-link" not in shown
    alone = cli("check", source / MOVEIT, status=1).stdout
    assert "xacro-fails" in alone
    with_other = cli("check", source / MOVEIT, "--package-path", source).stdout
    assert "package-srdf-robot" in with_other


@pytest.mark.long
def test_a_cell_has_no_finding(cli: Cli, tmp_path: Path) -> None:
    """The files of its macros have names without the prefix of an arm."""
    run_file = Path(__file__).parents[2] / "configs" / "ros2_cell.yaml"
    cli("run", run_file, "-o", tmp_path / "src")
    for name in ("two_arms_description", "two_arms_moveit_config"):
        assert findings(tmp_path / "src", name) == ()
