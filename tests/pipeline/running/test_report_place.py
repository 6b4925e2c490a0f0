"""What tells of a run may go to a place of its own: then the output holds descriptions, and nothing else."""

from pathlib import Path

import pytest
from command_line import Answer, Cli

import dh2urdf
from dh2urdf.errors import ConfigError

TABLE = "# convention: standard\njoint,a,alpha,d\nj1,0,pi/2,0.1\nj2,0.4,0,0\n"
TOLD = {"index.json", "manifest.jsonl", "report.json", "timing.json"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("one", "two"):
        (tmp_path / f"{name}.csv").write_text(TABLE)
    return tmp_path


def run(folder: Path, cli: Cli, config: str, *words: str, status: int = 0) -> Answer:
    (folder / "run.yaml").write_text(config)
    return cli("run", folder / "run.yaml", *words, status=status)


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()} - {"report.html", "manifest.parquet"}


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_folder_of_its_own(folder: Path, cli: Cli, workers: str) -> None:
    """Resumed, nothing is made again; what a later run does not make is removed; the journal leaves nothing."""
    config = "inputs: [one.csv, two.csv]\noutput: {directory: out}\nreport: {directory: told}\n"
    answer = run(folder, cli, config, "--workers", workers)
    assert f"written to {folder / 'out'}, report and manifest to {folder / 'told'}" in answer.stdout
    assert names(folder / "out") == {"one.urdf", "two.urdf"}
    assert names(folder / "told") == TOLD
    made = (folder / "out" / "one.urdf").stat().st_mtime_ns
    assert "2 unchanged" in run(folder, cli, config, "--resume").stdout
    assert (folder / "out" / "one.urdf").stat().st_mtime_ns == made
    assert "1 removed" in run(folder, cli, config.replace(", two.csv", "")).stdout
    assert names(folder / "out") == {"one.urdf"}
    assert names(folder / "told") == TOLD


@pytest.mark.parametrize("words", [(), ("-o", "elsewhere/")])
def test_packages_stand_alone(folder: Path, cli: Cli, words: tuple[str, ...]) -> None:
    """A workspace of colcon holds packages; beside an output of packages and other files there is no other folder."""
    config = "inputs: [one.csv, two.csv]\nemitters: [ros2]\noutput: {directory: src}\nreport: {html: false}\n"
    run(folder, cli, config, *([words[0], str(folder / words[1])] if words else ()))
    output = "elsewhere" if words else "src"
    assert names(folder / output) == {"one_description", "two_description"}
    assert names(folder / f"{output}_report") == TOLD
    run(folder, cli, config.replace("[ros2]", "[ros2, urdf]").replace("src", "both"))
    assert names(folder / "both") == {"one_description", "two_description", "one.urdf", "two.urdf", *TOLD}


def test_an_object_store(folder: Path, cli: Cli) -> None:
    """Reports may be in another kind of place than the descriptions."""
    from fsspec.implementations.memory import MemoryFileSystem

    MemoryFileSystem.store.clear()
    config = "inputs: one.csv\noutput: {directory: out}\nreport: {html: false, directory: 'memory://told'}\n"
    run(folder, cli, config)
    assert names(folder / "out") == {"one.urdf"}
    assert {name.rpartition("/")[2] for name in MemoryFileSystem.store} - {"manifest.parquet"} == TOLD
    assert "1 unchanged" in run(folder, cli, config, "--resume").stdout


def test_an_input_is_not_overwritten(folder: Path) -> None:
    """A file that is read stays, in either place."""
    (folder / "told").mkdir()
    (folder / "told" / "report.json").write_text(
        '{"convention": "standard", "joints": [{"a": 0.1, "alpha": 0, "d": 0.1}]}'
    )
    (folder / "run.yaml").write_text("inputs: told/report.json\noutput: {directory: out}\nreport: {directory: told}\n")
    with pytest.raises(ConfigError) as caught:
        dh2urdf.run(folder / "run.yaml")
    (problem,) = caught.value.problems
    assert (problem.code, problem.field) == ("run-overwrites-input", "report.directory")
