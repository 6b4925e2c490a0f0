"""`dh2urdf init` and `dh2urdf example`: what they write is a table that is right, and nothing is overwritten."""

import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from command_line import Cli

import dh2urdf

ROOT = Path(__file__).parents[3]
TABLES = sorted((ROOT / "configs" / "tables").iterdir())
CONVENTIONS = ("standard", "modified")


@pytest.mark.parametrize("axes", [1, 6, 100])
@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("file", ["arm.csv", "new/folder/arm.yml"])
def test_every_template_can_be_converted_at_once(cli: Cli, file: str, convention: str, axes: int) -> None:
    """Without a notice, and with as many joints as were asked for."""
    answer = cli("init", file, "--convention", convention, "--axes", axes)
    assert answer.stdout.splitlines()[0] == file
    said = cli("convert", file, "-o", "arm.urdf").stderr
    assert said.startswith(f"arm: {axes} revolute joint")
    assert said.count("\n") == 1
    assert dh2urdf.read(file).convention == convention


@pytest.mark.parametrize("axes", [1, 7])
def test_both_conventions_are_the_same_arm(cli: Cli, axes: int) -> None:
    """As CSV and as YAML: the DH products agree at random joint vectors."""
    for convention in CONVENTIONS:
        for suffix in ("csv", "yaml"):
            cli("init", f"{convention}.{suffix}", "--convention", convention, "--axes", axes)
    q = np.random.default_rng(axes).uniform(-3, 3, (50, axes))
    poses = [dh2urdf.read(f"{name}.{suffix}").fk(q) for name in CONVENTIONS for suffix in ("csv", "yaml")]
    assert np.abs(poses[0][:, :3, 3]).max() > 0.05
    for other in poses[1:]:
        assert np.allclose(poses[0], other, rtol=0, atol=1e-12)


def test_names(cli: Cli) -> None:
    """Of the joints and of the manipulator; their number is that of the axes."""
    cli("init", "arm.yaml", "--joints", "waist, shoulder,elbow", "--name", "My arm")
    arm = dh2urdf.read("arm.yaml")
    assert (arm.name, [row.joint for row in arm.rows]) == ("My arm", ["waist", "shoulder", "elbow"])


@pytest.mark.parametrize("run", ["run.yaml", "runs/run.yaml"])
def test_a_run_file_can_be_run_at_once(cli: Cli, tmp_path: Path, run: str) -> None:
    """It names the table by its path from there."""
    answer = cli("init", "my tables/arm.csv", "--run", run)
    assert "dh2urdf convert 'my tables/arm.csv' -o arm.urdf" in answer.stdout
    assert cli("run", run, "--quiet") == ("", "")
    folder = (tmp_path / run).parent / "build"
    assert {"arm.urdf", "arm.urdf.xacro", "arm_macro.xacro"} <= {path.name for path in folder.iterdir()}


def test_what_it_advises_works(cli: Cli) -> None:
    """The lines below `next:` are commands that can be typed."""
    printed = cli("init", "--run", "run.yaml").stdout
    commands = [line.split() for line in printed.partition("next:")[2].splitlines() if line.strip()]
    assert len(commands) == 3
    for program, *words in commands:
        assert program == "dh2urdf"
        cli(*words)


@pytest.mark.parametrize("words", [["arm.csv"], ["new.csv", "--run", "arm.csv"], ["arm.csv", "--run", "new.yaml"]])
@pytest.mark.parametrize("kind", ["file", "folder", "dead link"])
def test_nothing_is_overwritten(cli: Cli, tmp_path: Path, words: list[str], kind: str) -> None:
    """Whatever has the name of a file is kept, and no other file is written either."""
    path, other = tmp_path / "arm.csv", tmp_path / "other"
    match kind:
        case "file":
            path.write_text("mine")
        case "folder":
            path.mkdir()
        case "dead link":
            path.symlink_to(other)
    before = sorted(tmp_path.iterdir())
    cli("init", *words, status=2)
    assert sorted(tmp_path.iterdir()) == before
    assert not path.is_file() or path.read_text() == "mine"


class TestExamples:
    def test_the_list_has_every_table_of_the_project(self, cli: Cli) -> None:
        """Without a name, too; it is printed, and not written."""
        text = cli("example", "--list").stdout
        cli("example", "--list", "-o", "list.txt", status=2)
        assert [line.split()[0] for line in text.splitlines()] == [path.stem for path in TABLES]
        assert cli("example").stdout == text

    @pytest.mark.parametrize("path", TABLES, ids=lambda path: path.name)
    def test_each_is_the_table_of_configs(self, cli: Cli, path: Path, tmp_path: Path) -> None:
        """Byte for byte: on standard output, into a file, into a folder."""
        wanted = path.read_bytes()
        assert cli("example", path.stem).stdout.encode() == wanted
        cli("example", path.stem, "-o", f"mine{path.suffix}")
        cli("example", path.stem, "-o", "folder/")
        assert (
            (tmp_path / f"mine{path.suffix}").read_bytes() == (tmp_path / "folder" / path.name).read_bytes() == wanted
        )

    def test_nothing_is_overwritten(self, cli: Cli, tmp_path: Path) -> None:
        """Nor written under the suffix of another format."""
        (tmp_path / "ur5.csv").write_text("mine")
        for name in ("ur5.csv", "ur5.yaml"):
            cli("example", "ur5", "-o", name, status=2)
        assert list(tmp_path.iterdir()) == [tmp_path / "ur5.csv"]
        assert (tmp_path / "ur5.csv").read_text() == "mine"

    def test_a_wheel_has_them(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """Unpacked somewhere else, the program prints the same tables."""
        build = pytest.importorskip("hatchling.build", reason="hatchling is not installed")
        monkeypatch.chdir(ROOT)
        wheel = tmp_path / build.build_wheel(str(tmp_path))
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(tmp_path / "site")
        code = f"import sys; sys.path.insert(0, {str(tmp_path / 'site')!r}); from dh2urdf.cli import main; main(sys.argv[1:])"
        for path in TABLES:
            printed = subprocess.run(
                [sys.executable, "-c", code, "example", path.stem], capture_output=True, check=True, cwd=tmp_path
            ).stdout
            assert printed == path.read_bytes()
