"""What `convert` says when it is done, to people and to programs; standard input, several tables, errors as JSON."""

import io
import json
import os
import subprocess
import sys
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from command_line import Cli
from jsonschema import Draft202012Validator
from lxml import etree

from dh2urdf.report.schema import conversions_schema, error_schema

COMMAND = [sys.executable, "-c", "from dh2urdf.cli import main; main()"]
TABLES = Path(__file__).parents[3] / "configs" / "tables"
BARE = "# convention: standard\njoint,a,alpha,d\nshoulder,0,pi/2,0.1\nelbow,0.4,0,0\n"
FULL = (
    "# convention: standard\n# base: {mass: 5}\njoint,type,a,alpha,d,lower,upper,velocity,effort,mass,com_x,com_y,com_z,ixx,iyy,izz\n"
    "one,R,0,pi/2,0.1,-1,1,2,30,4,0,0,0.05,0.1,0.1,0.1\ntwo,P,0.4,0,0,0,1,2,30,4,0,0,0.05,0.1,0.1,0.1\n"
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "bare.csv").write_text(BARE)
    (tmp_path / "full.csv").write_text(FULL)
    (tmp_path / "bad.csv").write_text(BARE.replace("pi/2", "ninety"))
    return tmp_path


def valid(schema: dict[str, Any], text: str) -> dict[str, Any]:
    """What a text of JSON holds, which is valid."""
    data: dict[str, Any] = json.loads(text)
    assert [error.message for error in Draft202012Validator(schema).iter_errors(data)] == []
    return data


@pytest.fixture
def type_in(monkeypatch: pytest.MonkeyPatch) -> Callable[[bytes], None]:
    """Put something into standard input."""
    return lambda content: monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(content)))


@pytest.mark.usefixtures("folder")
class TestJson:
    def test_a_conversion(self, cli: Cli, folder: Path) -> None:
        """Valid by its schema, and true: the file's hash, the proof, what was filled in."""
        report = valid(conversions_schema(), cli("convert", "bare.csv", "-o", "out/bare.urdf.xacro", "--json").stdout)
        (row,) = report["conversions"]
        assert (row["status"], row["name"], row["source"]) == ("ok", "bare", "bare.csv")
        assert [file["path"] for file in row["files"]] == ["out/bare.urdf.xacro", "out/bare_macro.xacro"]
        for file in row["files"]:
            assert sha256((folder / file["path"]).read_bytes()).hexdigest() == file["sha256"]
        assert row["proof"]["xacro"]["position_error"] < 1e-12
        assert row["filled_in"]["masses"] == ["link_1", "link_2", "the base"]
        assert row["filled_in"]["limits"] == ["shoulder", "elbow"]

    def test_without_a_file_the_description_is_in_it(self, cli: Cli) -> None:
        """Standard output is JSON, whole, and holds what would have been there without --json."""
        (row,) = valid(conversions_schema(), cli("convert", "full.csv", "--json").stdout)["conversions"]
        assert row["files"][0]["content"] == cli("convert", "full.csv").stdout
        assert row["filled_in"] == {}

    @pytest.mark.parametrize(
        ("words", "kind", "code", "found"),
        [
            (["convert", "bad.csv", "--json"], "table", "quantity-refused", "ninety"),
            (["run", "--json"], "usage", "missing-parameter", None),
            (["run", "--bogus", "--json"], "usage", "no-such-option", None),
            (["check", "nope.urdf", "--format=json"], "input", "no-such-file", None),
        ],
        ids=lambda value: " ".join(value) if isinstance(value, list) else "",
    )
    def test_an_error_is_json_too(self, cli: Cli, words: list[str], kind: str, code: str, found: str | None) -> None:
        """On standard output, valid by its schema, with every problem that standard error says, and its code."""
        answer = cli(*words, status=2)
        report = valid(error_schema(), answer.stdout)
        assert (report["kind"], report["exit_status"]) == (kind, 2)
        assert found in (None, *(error["found"] for error in report["errors"]))
        assert code in [error["code"] for error in report["errors"]]
        for error in report["errors"]:
            assert error["message"].partition("; ")[0] in answer.stderr


class TestStandardInput:
    @pytest.mark.parametrize("table", sorted(TABLES.iterdir()), ids=lambda path: path.name)
    def test_every_table_of_the_project_is_known(self, cli: Cli, type_in: Callable[[bytes], None], table: Path) -> None:
        """Its format is seen, and what comes out is what comes of the file."""
        type_in(table.read_bytes())
        (row,) = json.loads(cli("convert", "-", "--json").stdout)["conversions"]
        wanted = cli("convert", table).stdout
        if table.suffix == ".csv":  # whose name is that of the file
            wanted = wanted.replace(f"<!-- {table.stem}:", "<!-- robot:")
            wanted = wanted.replace(f'<robot name="{table.stem}"', '<robot name="robot"')
        assert row["files"][0]["content"] == wanted

    def test_the_command_in_a_pipeline(self, tmp_path: Path) -> None:
        """A real pipe on both ends; nothing is left behind."""
        done = subprocess.run(
            [*COMMAND, "convert", "-", "--from", "csv"],
            input=BARE.encode(),
            env={**os.environ, "TMPDIR": str(tmp_path)},
            capture_output=True,
            check=True,
        )
        assert etree.fromstring(done.stdout).get("name") == "robot"
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.usefixtures("folder")
    def test_check_takes_a_description_from_there(self, cli: Cli, type_in: Callable[[bytes], None]) -> None:
        """`check - --as urdf`; its lines are those of standard input."""
        text = cli("convert", "bare.csv").stdout
        type_in(text.replace('<child link="link_2"/>', '<child link="nobody"/>').encode())
        answer = cli("check", "-", "--as", "urdf", status=1)
        assert "standard input:" in answer.stdout
        assert "dh2urdf-" not in answer.stdout
        type_in(text.encode())
        assert "`--as NAME`" in cli("check", "-", status=2).stderr


@pytest.mark.usefixtures("folder")
class TestSeveralTables:
    def test_each_becomes_a_file_of_its_name(self, cli: Cli, folder: Path) -> None:
        """The same as one by one, into a folder that is made."""
        answer = cli("convert", "bare.csv", "full.csv", "-o", "out", "--to", "xacro")
        assert answer.stdout == ""
        assert [line.partition(":")[0] for line in answer.stderr.splitlines() if "proved" in line] == ["bare", "full"]
        names = {path.name for path in (folder / "out").iterdir()}
        assert names == {f"{arm}{end}" for arm in ("bare", "full") for end in (".urdf.xacro", "_macro.xacro")}
        cli("convert", "full.csv", "-o", "alone.urdf.xacro")
        assert "full" in (folder / "alone_macro.xacro").read_text()

    def test_one_that_fails_does_not_stop_the_others(self, cli: Cli, folder: Path) -> None:
        """Status 1; what is wrong with it is said, and how many were made; a missing table counts as one."""
        answer = cli("convert", "bare.csv", "bad.csv", "nope.csv", "full.csv", "note.txt", "-o", "out", status=1)
        assert {path.name for path in (folder / "out").iterdir()} == {"bare.urdf", "full.urdf"}
        assert answer.stderr.count("error: ") == 3
        report = valid(
            conversions_schema(),
            cli("convert", "bare.csv", "bad.csv", "nope.csv", "-o", "out", "--json", "-q", status=1).stdout,
        )
        assert [row["status"] for row in report["conversions"]] == ["ok", "failed", "failed"]
        assert report["conversions"][1]["errors"][0]["line"] == 3
        assert report["exit_status"] == 1

    def test_none_overwrites_another_table(self, cli: Cli, folder: Path) -> None:
        """The output of one may not be the input of the next."""
        (folder / "full.urdf").write_text(FULL)
        cli("convert", "full.csv", "full.urdf", "--from", "csv", "-o", ".", status=2)
        cli("convert", "bare.csv", "./bare.csv", "-o", "out", status=2)
        assert not (folder / "out").exists()
        (folder / "bare.urdf").write_text(FULL)
        (folder / "other.csv").symlink_to("bare.urdf")
        cli("convert", "bare.csv", "other.csv", "-o", ".", status=2)
        assert (folder / "bare.urdf").read_text() == FULL


class TestPipes:
    @pytest.mark.parametrize(
        ("words", "status"),
        [
            (["convert", "bare.csv"], 0),
            (["convert", "bad.csv"], 2),
            (["run", "run.yaml", "--json"], 0),
            (["check", "bad.urdf"], 1),
        ],
        ids=lambda value: " ".join(value) if isinstance(value, list) else "",
    )
    @pytest.mark.parametrize("both", [False, True], ids=["stdout", "stdout and stderr"])
    def test_a_reader_who_leaves_early_changes_no_status(
        self, cli: Cli, folder: Path, words: list[str], status: int, *, both: bool
    ) -> None:
        """`… | head -0`, and `… 2>&1 | head -0`: no traceback, and the status of what was done."""
        text = cli("convert", "bare.csv").stdout
        (folder / "bad.urdf").write_text(text.replace('<child link="link_2"/>', '<child link="nobody"/>'))
        (folder / "run.yaml").write_text("inputs: bare.csv\nreport: {html: false}\n")
        reading, writing = os.pipe()
        os.close(reading)
        done = subprocess.run(
            [*COMMAND, *words],
            stdout=writing,
            stderr=writing if both else subprocess.PIPE,
            text=True,
            cwd=folder,
            check=False,
        )
        os.close(writing)
        assert done.returncode == status
        assert both or "Traceback" not in done.stderr
        assert both or "internal error" not in done.stderr
