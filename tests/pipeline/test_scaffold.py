from __future__ import annotations

import tomllib
from typing import TYPE_CHECKING

import pytest
from trove_classifiers import classifiers

from dh2urdf import __version__
from dh2urdf.plugin_system import KINDS
from dh2urdf.scaffold import LONGEST, stage_name

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from conftest import Answer

    from dh2urdf.stages import Kind


@pytest.mark.parametrize("kind", KINDS)
def test_a_whole_distribution_is_written(cli: Callable[..., Answer], tmp_path: Path, kind: Kind) -> None:
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


def test_it_goes_where_it_is_told(cli: Callable[..., Answer], tmp_path: Path) -> None:
    """`--dir` names the folder that the distribution's own is made in."""
    (tmp_path / "inner").mkdir()
    cli("new-plugin", "lab", "--kind", "reader", "--dir", "inner")
    assert (tmp_path / "inner" / "lab" / "pyproject.toml").is_file()


def test_what_comes_next_can_be_typed(cli: Callable[..., Answer], tmp_path: Path) -> None:
    """A folder with a space in its name is quoted, as a shell takes it."""
    (tmp_path / "our plugins").mkdir()
    said = cli("new-plugin", "lab", "--kind", "reader", "--dir", "our plugins").stdout
    assert "    cd 'our plugins/lab'\n" in said


def test_the_stage_goes_without_the_prefix() -> None:
    """Distributions of plugins are called dh2urdf-something; nobody wants to type that in a run file."""
    assert stage_name("dh2urdf-lab-7") == "lab-7"
    assert stage_name("lab-7") == "lab-7"


@pytest.mark.parametrize("name", ["My_Lab", "7lab", "lab--7", "", "łab", "../lab", "a" * (LONGEST + 1)])
def test_a_name_that_is_none_is_refused(cli: Callable[..., Answer], tmp_path: Path, name: str) -> None:
    """With what is accepted."""
    refused = cli("new-plugin", "--kind", "emitter", "--", name, status=2).stderr
    assert "a plugin cannot be named " in refused
    assert "accepted: lower-case letters, digits and single dashes, from a letter on, at most 40 characters" in refused
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["class", "json", "numpy"])
def test_a_name_that_a_package_cannot_have_is_refused(cli: Callable[..., Answer], tmp_path: Path, name: str) -> None:
    """Python's own words and modules, and what is installed: a package of the name would hide it or be hidden."""
    refused = cli("new-plugin", name, "--kind", "emitter", status=2).stderr
    assert f"'{name}' is a keyword of Python, or a module or package that is installed here" in refused
    assert f"`dh2urdf-{name}` names the distribution so" in refused
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["urdf", "dh2urdf-urdf"])
def test_a_name_that_a_stage_has_is_told(cli: Callable[..., Answer], name: str) -> None:
    """Who provides it, and which names are taken; a stage of another kind may have it."""
    refused = cli("new-plugin", name, "--kind", "emitter", status=2).stderr
    assert f"the emitter 'urdf' is provided by dh2urdf {__version__}" in refused
    assert "accepted: a name besides mjcf, ros2, sdf, srdf, table, urdf, xacro" in refused
    cli("new-plugin", name, "--kind", "loader")


def test_nothing_is_overwritten(cli: Callable[..., Answer], tmp_path: Path) -> None:
    """Whatever is in the place, a file or a folder or a link to nothing, stays as it is."""
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to("nowhere")
    for name in ("file", "folder", "link"):
        refused = cli("new-plugin", name, "--kind", "loader", status=2).stderr
        assert f"'{name}' is there already" in refused
        assert "nothing is overwritten" in refused
    assert (tmp_path / "file").read_text() == "mine"
    assert list((tmp_path / "folder").iterdir()) == []


def test_a_folder_that_is_not_there_is_not_made(cli: Callable[..., Answer], tmp_path: Path) -> None:
    """It may be misspelt."""
    refused = cli("new-plugin", "lab", "--kind", "loader", "--dir", "labz", status=2).stderr
    assert "there is no folder 'labz'" in refused
    assert list(tmp_path.iterdir()) == []


def test_a_kind_that_is_none_is_refused(cli: Callable[..., Answer]) -> None:
    """The five kinds are said."""
    refused = cli("new-plugin", "lab", "--kind", "writer", status=2).stderr
    assert all(kind in refused for kind in KINDS)
