import tomllib
from pathlib import Path

import pytest
from command_line import Cli
from trove_classifiers import classifiers

from dh2urdf import __version__
from dh2urdf.plugin_system import KINDS
from dh2urdf.scaffold import LONGEST
from dh2urdf.stages import Kind


@pytest.mark.parametrize("kind", KINDS)
def test_a_whole_distribution_is_written(cli: Cli, tmp_path: Path, kind: Kind) -> None:
    """What it is made of, and nothing else; its entry point leads to the package with the hook."""
    said = cli("new-plugin", "dh2urdf-lab-7", "--kind", kind).stdout
    folder = tmp_path / "dh2urdf-lab-7"
    files = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert files == {
        ".github/workflows/ci.yml",
        ".gitignore",
        "README.md",
        "pyproject.toml",
        "src/dh2urdf_lab_7/__init__.py",
        "src/dh2urdf_lab_7/py.typed",
        f"src/dh2urdf_lab_7/{kind}.py",
        f"tests/test_{kind}.py",
    }
    assert all(file in said for file in files)
    project = tomllib.loads((folder / "pyproject.toml").read_text("utf-8"))["project"]
    assert project["entry-points"]["dh2urdf"] == {f"{kind}.lab-7": "dh2urdf_lab_7"}
    assert project["dependencies"] == [f"dh2urdf>={__version__.rpartition('.')[0]}"]
    assert {"dh2urdf-plugin", kind} <= set(project["keywords"])
    assert set(project["classifiers"]) <= classifiers
    for path in folder.rglob("*"):
        if path.is_file():
            text = path.read_text("utf-8")
            assert "$" not in text.replace("${{ matrix.python }}", ""), path
            assert text == "" or text.endswith("\n")
    assert list(tmp_path.iterdir()) == [folder]


def test_it_goes_where_it_is_told(cli: Cli, tmp_path: Path) -> None:
    """`--dir` names the folder that the distribution's own is made in."""
    (tmp_path / "inner").mkdir()
    cli("new-plugin", "lab", "--kind", "reader", "--dir", "inner")
    assert (tmp_path / "inner" / "lab" / "pyproject.toml").is_file()


NAMES = ("My_Lab", "7lab", "lab--7", "", "łab", "../lab", "a" * (LONGEST + 1), "class", "json", "numpy")


@pytest.mark.parametrize("words", [*((name,) for name in (*NAMES, "urdf", "dh2urdf-urdf")), ("lab", "--dir", "labz")])
def test_a_name_that_cannot_be_given_writes_nothing(cli: Cli, tmp_path: Path, words: tuple[str, ...]) -> None:
    """None, one of Python's or of what is installed, one that a stage has; nor goes it into a folder that is not there."""
    name, *others = words
    cli("new-plugin", "--kind", "emitter", *others, "--", name, status=2)
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_overwritten(cli: Cli, tmp_path: Path) -> None:
    """Whatever is in the place, a file or a folder or a link to nothing, stays as it is."""
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to("nowhere")
    for name in ("file", "folder", "link"):
        cli("new-plugin", name, "--kind", "loader", status=2)
    assert (tmp_path / "file").read_text() == "mine"
    assert list((tmp_path / "folder").iterdir()) == []
