import json
from pathlib import Path
from typing import Any

import pytest
from command_line import Cli

TABLE = "# convention: standard\njoint,a,alpha,d\nshoulder,0,pi/2,0.1\nelbow,0.4,0,0\n"
ARMS = "# convention: standard\nrobot,a,alpha,d\nleft,0.4,0,0.1\nbad,0.4,ninety,0.1\nright,0.4,1.5708,0.1\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The working directory, with tables and run files in it."""
    (tmp_path / "arm.csv").write_text(TABLE)
    (tmp_path / "arms.csv").write_text(ARMS)
    (tmp_path / "arm.yaml").write_text("inputs: arm.csv\noutput: {directory: out}\n")
    (tmp_path / "arms.yaml").write_text("inputs: arms.csv\noutput: {directory: out}\n")
    return tmp_path


def written(folder: Path) -> set[str]:
    return {path.name for path in (folder / "out").iterdir()} if (folder / "out").exists() else set()


def report(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / "out" / "report.json").read_bytes()))


class TestOutput:
    def test_files_reports_and_a_summary(self, cli: Cli, folder: Path, reports: frozenset[str]) -> None:
        """The files and both reports in the folder of the run file; the summary on standard output."""
        answer = cli("run", "arm.yaml")
        assert written(folder) == {"arm.urdf", *reports}
        assert answer.stderr == ""
        assert answer.stdout.startswith("largest distance of tool0 from the DH product, in metres:\n")
        assert answer.stdout.endswith("1 made\nwritten to out\n")

    def test_notices_are_said_beside_errors(self, cli: Cli, folder: Path) -> None:
        """Of one manipulator, by `convert` in the order of the file, by a run each cause once; in both reports all."""
        table = "# convention: standard\nrobot,a,alpha,d,supplier\nbad,0.4,1.5708,0.1,ACME\nbad,0.4,ninety,0.1,ACME\n"
        (folder / "arm.csv").write_text(table + "good,0.4,0,0,ACME\n")
        first, second, error = ["arm.csv:2:17", "notice"], ["arm.csv:3:9", "notice"], ["arm.csv:4:9", "error"]
        for words, status, told in (
            (("convert", "arm.csv", "--robot", "bad"), 2, [first, second, error]),
            (("run", "arm.yaml", "--verbose"), 1, [first, second, error]),
            (("run", "arm.yaml"), 1, [error, first, second]),
        ):
            lines = cli(*words, status=status).stderr.splitlines()
            assert [line.split(": ")[:2] for line in lines if line.startswith("arm.csv:")] == told
        entry, _ = (json.loads(line) for line in (folder / "out" / "manifest.jsonl").read_text().splitlines())
        assert [notice["line"] for notice in entry["notices"]] == [2, 3]
        assert [error["line"] for error in entry["errors"]] == [4]

    def test_another_folder(self, cli: Cli, folder: Path, reports: frozenset[str]) -> None:
        """-o is relative to the working directory, not to the run file."""
        (folder / "configs").mkdir()
        (folder / "configs" / "arm.yaml").write_text("inputs: ../arm.csv\n")
        assert cli("run", "configs/arm.yaml", "-o", "elsewhere").stdout.endswith("written to elsewhere\n")
        assert {path.name for path in (folder / "elsewhere").iterdir()} == {"arm.urdf", *reports}
        assert not (folder / "configs" / "build").exists()

    def test_dry_run(self, cli: Cli, folder: Path) -> None:
        """--dry-run reads and checks everything, says what it would say, and writes nothing."""
        answer = cli("run", "arms.yaml", "--dry-run", status=1)
        assert written(folder) == set()
        assert "2 planned, 1 failed (table: 1)" in answer.stdout
        assert "(dry run: nothing was written)" in answer.stdout
        assert "made" not in answer.stdout
        assert "arms.csv:4" in answer.stderr
        assert (
            json.loads(cli("run", "arm.yaml", "--dry-run", "--json").stdout)["manipulators"][0]["status"] == "planned"
        )
        assert written(folder) == set()


class TestFailures:
    def test_one_of_several_is_status_1(self, cli: Cli, folder: Path, reports: frozenset[str]) -> None:
        """The others are written; the summary and the report say which failed, standard error says why."""
        answer = cli("run", "arms.yaml", status=1)
        assert written(folder) == {"left.urdf", "right.urdf", *reports}
        assert "2 made, 1 failed (table: 1)\n" in answer.stdout
        entries = {entry["name"]: entry for entry in report(folder)["manipulators"]}
        assert [entry["status"] for entry in entries.values()] == ["ok", "failed", "ok"]
        (error,) = entries["bad"]["errors"]
        assert (Path(error["file"]).name, error["line"], error["field"], error["found"]) == (
            *("arms.csv", 4, "alpha", "ninety"),
        )
        assert answer.stderr.count(": error: ") == 1
        assert "arms.csv:4:9: error: " in answer.stderr

    def test_nothing_readable_is_status_2(self, cli: Cli, folder: Path) -> None:
        """Where no manipulator can be read, nothing is written, and each problem is said once."""
        (folder / "arms.csv").write_text(ARMS.replace("0.4,0,", "0.4,zero,").replace("1.5708", "half a turn"))
        answer = cli("run", "arms.yaml", status=2)
        assert written(folder) == set()
        assert answer.stdout == ""
        assert answer.stderr.count(": error: ") == 3


class TestWords:
    def test_set(self, cli: Cli, folder: Path, reports: frozenset[str]) -> None:
        """--set changes a value of the run file, through lists and sections that are not there."""
        words = ["transform.options.frames=dh", "emitters=[xacro]", "inputs.0.options.tool={xyz: [0, 0, 1]}"]
        cli("run", "arm.yaml", *(word for setting in words for word in ("--set", setting)))
        assert written(folder) == {"arm.urdf.xacro", "arm_macro.xacro", *reports}
        assert "dh frames" in (folder / "out" / "arm_macro.xacro").read_text("utf-8")
