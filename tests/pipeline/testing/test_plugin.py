import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import dh2urdf_plugins
from dh2urdf.errors import UnknownStageError
from dh2urdf.kinematics.expected_poses import ExpectedPoses, proof_vectors
from dh2urdf.kinematics.proof import prove
from dh2urdf.manipulator import Convention, JointType, Manipulator
from dh2urdf.robot_check import check_robot
from dh2urdf.stages import Emitter, NoOptions
from dh2urdf.testing import catalog_of, do_run, plain_robot, reference_manipulators

ARMS = pytest.mark.parametrize("arm", reference_manipulators(), ids=lambda arm: arm.name)
CSV = "# convention: standard\na, alpha, d\n0.4, pi/2, 0.1\n0.3, 0, 0\n"


class TestReferenceArms:
    def test_they_have_all_that_a_table_may_say_of_kinematics(self) -> None:
        """Both conventions, all joint types, negative signs, offsets, a base and a tool."""
        arms = reference_manipulators()
        rows = [row for arm in arms for row in arm.rows]
        assert {arm.convention for arm in arms} == set(Convention)
        assert {row.type for row in rows} == set(JointType)
        assert {row.sign for row in rows} == {1, -1}
        assert any(row.offset for row in rows)
        assert any(arm.base != arm.tool for arm in arms)

    @ARMS
    def test_the_plain_robot_is_the_arm(self, arm: Manipulator) -> None:
        """It is proved as any other robot, and every reader takes it."""
        robot, expected = plain_robot(arm), ExpectedPoses.of(arm)
        assert prove(expected, robot, proof_vectors(expected, robot, 20)).holds
        assert check_robot(robot) == ()


class TestCatalogs:
    def test_nothing_is_discovered(self) -> None:
        """A catalog of some stages has these, and none that happens to be installed."""
        emitter: Emitter[Any] = Emitter(name="mine", summary="", emit=lambda *_: (), options=NoOptions, suffixes=())
        catalog = catalog_of(emitter)
        assert catalog.get("emitter", "mine") is emitter
        with pytest.raises(UnknownStageError):
            catalog.get("emitter", "urdf")

    def test_a_run_is_a_whole_run(self, tmp_path: Path) -> None:
        """A section `report` is that of the run; without one there is no report.html, the slowest part of a short run."""
        pytest.importorskip("jinja2")
        pytest.importorskip("matplotlib")
        for name, section in (("without", ""), ("with", "report: {html: true}\n")):
            (folder := tmp_path / name).mkdir()
            run = do_run(
                folder, f"inputs: arm.csv\n{section}", {"arm.csv": CSV}, catalog_of(plugins=(dh2urdf_plugins,))
            )
            assert (run.exit_status, run.report["manipulators"][0]["name"]) == (0, "arm")
            assert (run.folder / "arm.urdf").is_file()
            assert (run.folder / "report.html").is_file() == bool(section)


@pytest.mark.long
def test_the_fixtures_are_there_for_every_test(tmp_path: Path) -> None:
    """pytest takes them from the plugin, also in the tests of a project that knows nothing of this one."""
    (tmp_path / "test_it.py").write_text(
        "def test_it(dh2urdf_catalog, dh2urdf_manipulators, dh2urdf_robots, dh2urdf_run):\n"
        "    assert len(dh2urdf_manipulators) == len(dh2urdf_robots)\n"
        f"    assert dh2urdf_run('inputs: arm.csv', {{'arm.csv': {CSV!r}}}).exit_status == 0\n"
        "    assert dh2urdf_catalog().provided('emitter') == ()\n"
    )
    tested = run_pytest(tmp_path)
    assert tested.returncode == 0, tested.stdout


def test_it_costs_other_projects_nothing(tmp_path: Path) -> None:
    """A run of pytest that asks for none of it imports a few small modules of it, and nothing heavy."""
    (tmp_path / "test_it.py").write_text(
        "import sys\n"
        "def test_it():\n"
        "    mine = {name for name in sys.modules if name.split('.')[0] in ('dh2urdf', 'dh2urdf_plugins')}\n"
        "    small = {'dh2urdf', 'dh2urdf._version', 'dh2urdf.testing', 'dh2urdf.testing.plugin'}\n"
        "    assert mine == small\n"
        "    assert not {'numpy', 'pydantic', 'lxml', 'yaml', 'click'} & set(sys.modules)\n"
    )
    tested = run_pytest(tmp_path)
    assert tested.returncode == 0, tested.stdout


def run_pytest(folder: Path) -> subprocess.CompletedProcess[str]:
    """What pytest declares about the tests in a folder, with no plugin of its own but those of this project."""
    loads = ["-p", "dh2urdf.testing.plugin"]
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *loads, "--rootdir", str(folder), str(folder)],
        env={**os.environ, "PYTEST_ADDOPTS": "", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
