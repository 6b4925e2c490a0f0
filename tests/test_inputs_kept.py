"""No command writes over what it reads, whatever name the output has; nothing is written then."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import Cli

import dh2urdf
from dh2urdf.errors import OutputError

TABLE = "# convention: standard\njoint,a,alpha,d\nshoulder,0,pi/2,0.1\nelbow,0.4,0,0\n"
JSON = '{"convention": "standard", "joints": [{"a": 0.4, "alpha": 0, "d": 0.1}]}'
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.csv").write_text(TABLE)
    return tmp_path


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() if path.is_file() else b"" for path in folder.rglob("*")}


# --- convert ----------------------------------------------------------------------------------------------------------


def same(_: Path) -> str:
    return "arm.csv"


def symbolic(folder: Path) -> str:
    (folder / "link.urdf").symlink_to("arm.csv")
    return "link.urdf"


def hard(folder: Path) -> str:
    os.link(folder / "arm.csv", folder / "hard.urdf")
    return "hard.urdf"


@pytest.mark.parametrize("name_of", [same, symbolic, hard])
def test_a_conversion_refuses_to_overwrite_its_table(cli: Cli, folder: Path, name_of: Callable[[Path], str]) -> None:
    """By its name, a path to it, a link of any kind, or another case; status 2, and every file is as it was."""
    name = name_of(folder)
    before = contents(folder)
    answer = cli("convert", "arm.csv", "-o", name, "--to", "urdf", status=2)
    assert "the output would overwrite the input 'arm.csv'" in answer.stderr
    assert contents(folder) == before


def test_a_mesh_is_an_input(cli: Cli, folder: Path) -> None:
    """A mesh file that the table names is not overwritten by the description."""
    (folder / "link.obj").write_text(TETRAHEDRON)
    (folder / "arm.yaml").write_text(
        "convention: standard\njoints: [{a: 0.4, alpha: 0, d: 0.1, mass: 1, visual: link.obj}]\n"
    )
    before = contents(folder)
    answer = cli("convert", "arm.yaml", "-o", "link.obj", "--to", "urdf", status=2)
    assert "would overwrite the input" in answer.stderr
    assert contents(folder) == before


def test_a_program_is_refused_too(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`dh2urdf.convert`, with the table's file, and with a manipulator that was read from it."""
    monkeypatch.chdir(folder)
    for table in ("arm.csv", dh2urdf.read("arm.csv")):
        with pytest.raises(OutputError, match="would overwrite the input"):
            dh2urdf.convert(table, "arm.csv", formats="urdf")
        with pytest.raises(OutputError, match="would overwrite the input"):
            dh2urdf.convert(table, folder / "ARM.csv", formats="urdf")
    assert (folder / "arm.csv").read_text() == TABLE


# --- run --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "words"), [("report.json", ()), ("Report.JSON", ("--resume",))])
def test_a_run_refuses_to_overwrite_a_table(cli: Cli, folder: Path, name: str, words: tuple[str, ...]) -> None:
    """A table in the output folder that is called like a file of the run is named before anything is written."""
    (folder / name).write_text(JSON)
    (folder / "run.yaml").write_text(f"inputs: {name}\noutput: {{directory: .}}\n")
    before = contents(folder)
    answer = cli("run", "run.yaml", *words, status=2)
    assert f"the run would overwrite its input '{name}'" in answer.stderr
    assert contents(folder) == before


def test_a_run_refuses_links_into_its_folder(cli: Cli, folder: Path) -> None:
    """A table elsewhere that is a link to a file in the output folder, or the other way round, or has a second name."""
    (folder / "run.yaml").write_text("inputs: {path: table.json}\noutput: {directory: out}\n")
    (folder / "out").mkdir()
    index, table = folder / "out" / "index.json", folder / "table.json"
    index.write_text(JSON)
    table.symlink_to(index)
    cli("run", "run.yaml", status=2)
    table.unlink()
    os.link(index, table)
    cli("run", "run.yaml", status=2)
    index.unlink()
    index.symlink_to(table)
    cli("run", "run.yaml", status=2)
    assert table.read_text() == JSON


def test_a_run_refuses_to_overwrite_a_table_called_like_a_description(cli: Cli, folder: Path) -> None:
    """What ends like the files of an emitter may be one of them; the macro of a xacro too."""
    for name, emitter in (("arm.urdf", "urdf"), ("arm_macro.xacro", "xacro")):
        (folder / "arm.csv").write_text(TABLE)
        shutil.move(folder / "arm.csv", folder / name)
        (folder / "run.yaml").write_text(
            f"inputs: {{path: {name}, stage: csv}}\nemitters: {emitter}\noutput: {{directory: .}}\n"
        )
        assert "the run would overwrite its input" in cli("run", "run.yaml", status=2).stderr
        assert (folder / name).read_text() == TABLE


@pytest.mark.parametrize(
    ("declared", "said", "status"),
    [
        ("('.notes',), capabilities=(OtherFiles(other_endings=('.csv',)),)", "the run would overwrite its input", 2),
        ("('.notes',)", "'arm.csv' has '.csv' behind the stem, which is none of the suffixes and other_endings", 1),
    ],
)
def test_the_second_file_of_an_emitter_is_written_over_no_table(  # noqa: PLR0917 - fixtures
    dh2urdf: Callable[..., object], install: Callable[..., None], folder: Path, declared: str, said: str, status: int
) -> None:
    """Before the run begins, where the record of a third party's emitter declares it, and else when it comes."""
    files = NOTES.replace("('.notes',)", declared)
    install(folder / "lab", "lab-notes", files)
    (folder / "run.yaml").write_text("inputs: arm.csv\nemitters: [urdf, notes]\noutput: {directory: .}\n")
    answer = dh2urdf("run", "run.yaml", path=[folder / "lab"], status=status)
    assert said in answer.stderr  # type: ignore[attr-defined]
    assert (folder / "arm.csv").read_text() == TABLE


NOTES = """
from dh2urdf.hookspecs import hookimpl
from dh2urdf.stages import EmittedFile, Emitter, NoOptions, OtherFiles, WritesFolders

def emit(robot, stem, options):
    return [EmittedFile(name=f"{stem}.notes", content=b"x"), EmittedFile(name=f"{stem}.csv", content=b"x")]

@hookimpl
def dh2urdf_emitters():
    return [Emitter(name="notes", summary="notes", emit=emit, options=NoOptions, suffixes=('.notes',))]
"""


def test_a_file_in_a_folder_of_an_emitter_is_written_over_no_table(
    dh2urdf: Callable[..., object], install: Callable[..., None], folder: Path
) -> None:
    """Which files are in the folders of a third party's emitter, nobody knows before: the store refuses them."""
    source = NOTES.replace('f"{stem}.', 'f"{stem}/{stem}.')
    install(
        folder / "lab",
        "lab-notes",
        source.replace("('.notes',)", "(), capabilities=(WritesFolders(lambda stem, options: [stem]),)"),
    )
    (folder / "arm").mkdir()
    (folder / "arm" / "arm.csv").write_text(TABLE)
    (folder / "run.yaml").write_text("inputs: arm/arm.csv\nemitters: [urdf, notes]\noutput: {directory: .}\n")
    answer = dh2urdf("run", "run.yaml", path=[folder / "lab"], status=2)
    assert "the output would overwrite the input 'arm/arm.csv'" in answer.stderr  # type: ignore[attr-defined]
    assert (folder / "arm" / "arm.csv").read_text() == TABLE


def test_two_arms_of_an_emitter_of_two_files_share_none(
    dh2urdf: Callable[..., object], install: Callable[..., None], tmp_path: Path
) -> None:
    """The second file of the arm `arm` and the main file of `arm_parts` were one, and the last one remained."""
    source = NOTES.replace("{stem}.csv", "{stem}_parts.notes").replace('b"x"', "robot.name.encode()")
    order = ("arm", "arm_parts", "arm_parts_parts")
    rows = "".join(f"{name},0.3,0,0.1\n" for name in order)
    (tmp_path / "arms.csv").write_text(f"# convention: standard\nrobot,a,alpha,d\n{rows}")
    (tmp_path / "run.yaml").write_text("inputs: arms.csv\nemitters: [urdf, notes]\noutput: {directory: out}\n")
    install(
        tmp_path / "lab",
        "lab-notes",
        source.replace("('.notes',)", "('.notes',), capabilities=(OtherFiles(other_endings=('_parts.notes',)),)"),
    )
    dh2urdf("run", "run.yaml", path=[tmp_path / "lab"])
    written = sorted((path.name, path.read_text()) for path in (tmp_path / "out").glob("*.notes"))
    assert sorted(content for _, content in written) == sorted(order * 2)


@pytest.mark.skipif(not os.path.exists("/dev/stdin"), reason="the system has no name for standard input")  # noqa: PTH110 - at import
def test_standard_input_is_an_input(folder: Path) -> None:
    """A table that the shell redirects into `convert -` is not written over."""
    main = "from dh2urdf.cli import main; main()"
    command = [sys.executable, "-c", main, "convert", "-", "-o", "arm.csv", "--to", "urdf"]
    with (folder / "arm.csv").open("rb") as table:
        answer = subprocess.run(command, cwd=folder, stdin=table, capture_output=True, encoding="utf-8", check=False)
    assert answer.returncode == 2
    assert "the output would overwrite the input" in answer.stderr
    assert (folder / "arm.csv").read_text() == TABLE
