"""Packages in a workspace: the command that makes them, and Debian's ament, colcon and catkin_pkg, the real ones."""

import json
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xacro
import yaml
from lxml import etree
from two_fingers import HAND

from dh2urdf.errors import ConfigError
from dh2urdf_plugins.packages.ros2 import Ros2Options
from dh2urdf_plugins.packages.ros2.package_files import package_xml

Cli = Callable[..., Any]

TABLES = Path(__file__).parents[4] / "configs" / "tables"
SYSTEM_PYTHON = "/usr/bin/python3"
"""The interpreter that Debian's ament and colcon are installed for."""


def has_ament() -> bool:
    return shutil.which("colcon") is not None and Path("/usr/share/ament_cmake_pytest").is_dir()


needs_ament = pytest.mark.skipif(not has_ament(), reason="colcon and ament_cmake_pytest are not installed")


def system(*command: str | Path, cwd: Path, **environment: str) -> str:
    """What a program of the system prints, which sees no environment of these tests."""
    known = {"PATH": "/usr/bin:/bin", "HOME": str(cwd), "LANG": "C.UTF-8", **environment}
    done = subprocess.run(command, cwd=cwd, env=known, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture
def modules(tmp_path: Path) -> Path:
    """A folder with the package xacro for the system's interpreter, and nothing else of this environment."""
    folder = tmp_path / "modules"
    folder.mkdir()
    (folder / "xacro").symlink_to(Path(xacro.__file__).parent)
    return folder


@pytest.mark.long
@needs_ament
def test_colcon_builds_and_tests_the_packages(cli: Cli, tmp_path: Path, modules: Path, cell: str) -> None:
    """A UR5, a Panda in the modified convention, a SCARA, an arm with a hand and a cell: built, installed, found, and their tests pass."""
    source = tmp_path / "src"
    for table, frames in (("panda.yaml", "dh"), ("scara.csv", "aligned")):
        cli("convert", TABLES / table, "--to", "ros2", "--frames", frames, "--set", "moveit=true", "-o", source)
    hand = ["--frames", "dh", "--set", "moveit=true", "--edit", f"attach: {{file: {HAND}, name: hand, keep: none}}"]
    cli("convert", TABLES / "stanford.csv", "--to", "ros2", *hand, "-o", source)
    run_file = tmp_path / "cell.yaml"
    run_file.write_text(cell)
    cli("run", run_file, "-o", source / "made")
    cli("run", TABLES.parent / "ros2_cell.yaml", "-o", tmp_path / "example")
    for package in (tmp_path / "example").glob("two_arms_*"):  # The run writes the packages of a single UR5, too.
        package.rename(source / package.name)
    shutil.rmtree(tmp_path / "example")
    names = [
        f"{name}_{kind}"
        for name in ("panda", "scara", "stanford", "ur5", "track", "workshop", "two_arms")
        for kind in ("description", "moveit_config")
    ]
    system("colcon", "build", cwd=tmp_path, PYTHONPATH=str(modules))
    system("colcon", "test", "--return-code-on-test-failure", cwd=tmp_path, PYTHONPATH=str(modules))
    results = system("colcon", "test-result", "--all", cwd=tmp_path)
    assert "0 errors, 0 failures, 0 skipped" in results.splitlines()[-1]
    for name in names:
        is_description = name.endswith("_description")
        robot = name.removesuffix("_description").removesuffix("_moveit_config")
        test, place = ("test_description", "urdf") if is_description else ("test_moveit_config", "config")
        assert f"build/{name}/test_results/{name}/{test}.xunit.xml" in results
        prefix = tmp_path / "install" / name
        assert (prefix / "share" / name / ".setup_assistant").is_file() is not is_description
        index = prefix / "share" / "ament_index" / "resource_index" / "packages" / name
        assert index.is_file()
        top = prefix / "share" / name / place / f"{robot}.urdf.xacro"
        found = f"{prefix}:{tmp_path / 'install' / f'{robot}_description'}"
        code = f"import xacro; print(xacro.process_file({str(top)!r}).documentElement.getAttribute('name'))"
        printed = system(SYSTEM_PYTHON, "-c", code, cwd=tmp_path, PYTHONPATH=str(modules), AMENT_PREFIX_PATH=found)
        assert printed.strip() == robot


@needs_ament
def test_the_tests_of_packages_with_hands_pass(cli: Cli, tmp_path: Path, modules: Path, cell: str) -> None:
    """A cell whose arms hold a hand each: those of its tools and of its fingers, whose followers follow."""
    attach = f"{{stage: attach, options: {{file: {HAND}, name: hand, keep: none}}}}"
    (tmp_path / "run.yaml").write_text(f"{cell}\nedits: [{attach}]\n")
    cli("run", tmp_path / "run.yaml", "-o", tmp_path / "share")
    for kind in ("description", "moveit_config"):
        index = tmp_path / "share" / "ament_index" / "resource_index" / "packages" / f"workshop_{kind}"
        index.parent.mkdir(parents=True, exist_ok=True)
        index.touch()
        found = {"PYTHONPATH": str(modules), "AMENT_PREFIX_PATH": str(tmp_path)}
        command = [SYSTEM_PYTHON, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test"]
        assert " passed" in system(*command, cwd=tmp_path / "share" / f"workshop_{kind}", **found)


@needs_ament
def test_catkin_pkg_accepts_package_xml_without_a_warning(cli: Cli, tmp_path: Path) -> None:
    """It is the parser that colcon, bloom and rosdep read the file with."""
    options = ["maintainer=Ada", "email=ada@lab.org", "license=MIT"]
    given = [word for option in options for word in ("--set", option)]
    cli("convert", TABLES / "ur5.csv", "--to", "ros2", "-o", tmp_path, "--set", "moveit=true", *given)
    code = (
        "import sys; from catkin_pkg.package import parse_package; warnings = []; "
        "package = parse_package(sys.argv[1], warnings=warnings); "
        "package.validate(warnings=warnings); print(warnings, package.name, package.get_build_type())"
    )
    for name in ("ur5_description", "ur5_moveit_config"):
        printed = system(SYSTEM_PYTHON, "-c", code, str(tmp_path / name), cwd=tmp_path)
        assert printed.strip() == f"[] {name} ament_cmake"


EMAILS = ["a.b+c_d%e@x-y.lab.org", "ada", "ada@lab", "Ada <ada@lab.org>", "a@b.co, c@d.co", "ä@b.co", "a..b@c.de"]
TEXTS = ["Ada Lovelace", "Ünal & <Söhne>", " ", "\t\n"]


@needs_ament
@pytest.mark.parametrize(
    ("option", "text"), [("email", text) for text in EMAILS] + [("license", text) for text in TEXTS]
)
def test_what_catkin_pkg_refuses_is_refused(option: str, text: str, tmp_path: Path) -> None:
    """The message names the option; what catkin_pkg accepts is accepted."""
    given = {"email": "a@b.co", "maintainer": "Ada", "license": "MIT", option: text}
    package = etree.fromstring(package_xml("arm", "An arm", Ros2Options(), (), ()))
    package.find("license").text = given["license"]
    package.find("maintainer").set("email", given["email"])
    (tmp_path / "package.xml").write_bytes(etree.tostring(package))
    code = (
        "import sys; from catkin_pkg.package import InvalidPackage, parse_package\n"
        "try: parse_package(sys.argv[1], warnings=[])\nexcept InvalidPackage: print('refused')"
    )
    if system(SYSTEM_PYTHON, "-c", code, str(tmp_path), cwd=tmp_path).strip() == "refused":
        with pytest.raises(ConfigError) as caught:
            Ros2Options(**given)
        assert caught.value.problems[0].field == option
    else:
        Ros2Options(**given)


def test_a_package_goes_into_a_folder(cli: Cli, tmp_path: Path) -> None:
    """-o names the folder of packages, which need not be there; the package holds nothing of the run."""
    cli("convert", TABLES / "ur5.csv", "--to", "ros2", "-o", tmp_path / "src")
    assert [path.name for path in (tmp_path / "src").iterdir()] == ["ur5_description"]
    cli("convert", TABLES / "ur5.csv", TABLES / "scara.csv", "--to", "ros2", "-o", tmp_path / "src")
    assert {path.name for path in (tmp_path / "src").iterdir()} == {"ur5_description", "scara_description"}
    told = cli("convert", TABLES / "ur5.csv", "--to", "ros2", "-o", tmp_path / "src", "--json")
    (row,) = json.loads(told.stdout)["conversions"]
    assert all(Path(file["path"]).is_file() for file in row["files"])


@pytest.mark.parametrize("package", ["a1", "a1_b"])
@pytest.mark.parametrize("names", [("a1", "a1_b"), ("a1_b", "a1")])
def test_names_that_begin_alike_share_no_package(
    cli: Cli, tmp_path: Path, names: tuple[str, str], package: str
) -> None:
    """The second robot fails also where its own package has the name of the option, and the first one stays whole."""
    for name in names:
        (tmp_path / f"{name}.csv").write_text("# convention: standard\njoint, a, alpha, d\nj1, 0.3, 0, 0.1\n")
    run_file = tmp_path / "run.yaml"
    stage = {"stage": "ros2", "options": {"package": package}}
    run_file.write_text(yaml.safe_dump({"inputs": [f"{name}.csv" for name in names], "emitters": [stage]}))
    result = cli("run", run_file, "-o", tmp_path / "out", status=1)
    assert "name the folder of one robot, and the run has several" in result.stdout + result.stderr
    description = f"The description of {names[0]}</description>".encode()
    assert description in (tmp_path / "out" / f"{package}_description" / "package.xml").read_bytes()


def test_a_second_run_removes_the_files_that_it_has_no_part_in(cli: Cli, tmp_path: Path) -> None:
    """Without its hardware a package has fewer files, and none of the first run is left in it."""
    run_file = tmp_path / "run.yaml"
    run_file.write_text(yaml.safe_dump({"inputs": [str(TABLES / "ur5.csv")], "emitters": ["ros2"]}))
    cli("run", run_file, "-o", tmp_path / "out")
    control = tmp_path / "out" / "ur5_description" / "config" / "ros2_controllers.yaml"
    assert control.is_file()
    stage = {"stage": "ros2", "options": {"hardware": "none"}}
    run_file.write_text(yaml.safe_dump({"inputs": [str(TABLES / "ur5.csv")], "emitters": [stage]}))
    cli("run", run_file, "-o", tmp_path / "out")
    assert not control.exists()
    assert (tmp_path / "out" / "ur5_description" / "package.xml").is_file()


def test_meshes_are_files_of_the_package(cli: Cli, tmp_path: Path) -> None:
    """They are named by package:// addresses, and no copies lie beside the package."""
    triangle = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    (tmp_path / "part.obj").write_text(triangle)
    (tmp_path / "arm.yaml").write_text(
        "convention: standard\njoints: [{name: hip, a: 0.4, alpha: 0, d: 0.1, visual: part.obj, collision: part.obj, "
        "mass: 1, com: [0, 0, 0], inertia: {ixx: 0.1, iyy: 0.1, izz: 0.1}}]\n"
    )
    cli("convert", tmp_path / "arm.yaml", "--to", "ros2", "-o", tmp_path / "src")
    folder = tmp_path / "src" / "arm_description"
    assert [path.name for path in (tmp_path / "src").iterdir()] == ["arm_description"]
    text = (folder / "urdf" / "arm_macro.xacro").read_text()
    for kind in ("visual", "collision"):
        (mesh,) = (folder / "meshes" / kind).iterdir()
        assert mesh.read_text() == triangle
        assert f'filename="package://arm_description/meshes/{kind}/{mesh.name}"' in text
    assert "install(DIRECTORY config launch meshes rviz urdf" in (folder / "CMakeLists.txt").read_text()


def test_arms_of_a_cell_may_be_called_as_macros_of_another(cli: Cli, tmp_path: Path) -> None:
    """`ur_at` and `ur_ros2_control` are the names of further macros of `ur`, which xacro calls where it finds them last."""
    names = ("ur", "ur_at", "ur_ros2_control", "ur_at_2")
    for name, table in zip(names, ("ur5.csv", "scara.csv", "stanford.csv", "ur5.csv"), strict=True):
        shutil.copy(TABLES / table, tmp_path / f"{name}.csv")
    for order in (names, names[::-1]):
        arms = [{"name": f"{name}_1", "of": name, "xyz": [3 * place, 0, 0]} for place, name in enumerate(order)]
        run = {
            "inputs": [f"{name}.csv" for name in names],
            "transform": {"stage": "alpha-swap", "options": {"frames": "dh"}},
            "cells": [{"name": "lab", "arms": arms}],
            "emitters": "ros2",
        }
        (tmp_path / "run.yaml").write_text(yaml.safe_dump(run))
        cli("run", "run.yaml", "--quiet", "-o", "src")  # It proves where each tool0 is.
        macros = "".join(path.read_text() for path in (tmp_path / "src" / "lab_description" / "urdf").iterdir())
        defined = re.findall(r'<xacro:macro name="([^"]*)"', macros)
        assert len(defined) == len(set(defined)) == 3 * len(names)
