from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from dh2urdf.conversion.one_manipulator import Sample
from dh2urdf.errors import ConfigError
from dh2urdf.output.layouts import DEFAULT_SIZE, Form, Layout
from dh2urdf.run_file.config import RunConfig, load_config


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with tables, and the working directory above it."""
    (tmp_path / "work" / "tables").mkdir(parents=True)
    for name in ("b.csv", "a.csv", "ur5.csv", "odd[1].csv"):
        (tmp_path / "work" / "tables" / name).write_text("a,alpha,d\n")
    (tmp_path / "here.csv").write_text("a,alpha,d\n")
    monkeypatch.chdir(tmp_path)
    return Path("work")


def config(folder: Path, text: str, *settings: str) -> RunConfig:
    path = folder / "run.yaml"
    path.write_text(text)
    return load_config(path, settings)


TABLE = "inputs: tables/a.csv\n"


def test_defaults(folder: Path) -> None:
    """A run file needs its inputs only: stages are the usual ones; the output goes into `build/<stem>` beside it."""
    found = config(folder, TABLE)
    assert found.problems == ()
    assert [given.paths for given in found.inputs] == [(folder / "tables" / "a.csv",)]
    assert found.transform.stage is None
    assert [call.stage for call in found.emitters] == [None]
    assert found.loaders == ()
    assert found.execution.stage is None
    assert found.output.directory == folder / "build" / "run"
    assert found.proof.poses == 32
    assert found.output.layout == Layout(form=Form.FILES, size=DEFAULT_SIZE)
    assert found.proof.proved == Sample(first=0, every=1)
    assert found.sample == Sample(first=1000, every=50)
    assert found.execution.time_limit == 300.0


def test_every_section_is_read(folder: Path) -> None:
    """The long form of the run file, with marks at the stages."""
    found = config(
        folder,
        "inputs:\n"
        "  - {path: tables/ur5.csv, stage: csv, options: {convention: standard}}\n"
        "transform: {stage: alpha-swap, options: {variant: exact}}\n"
        "emitters:\n"
        "  - {stage: urdf, options: {profile: portable}}\n"
        "  - {stage: xacro}\n"
        "loaders:\n"
        "  - {stage: pybullet, options: {poses: 25}}\n"
        "output: {directory: ../out}\n"
        "execution: {stage: local, options: {workers: auto}}\n"
        "proof: {poses: 8}\n",
    )
    assert found.problems == ()
    (read,) = found.inputs
    assert (read.stage, str(read.mark)) == ("csv", "work/run.yaml:2:35")
    assert read.options is not None
    assert read.options.plain() == {"convention": "standard"}
    assert [(call.stage, str(call.mark)) for call in (found.transform, *found.emitters, *found.loaders)] == [
        ("alpha-swap", "work/run.yaml:3:20"),
        ("urdf", "work/run.yaml:5:13"),
        ("xacro", "work/run.yaml:6:13"),
        ("pybullet", "work/run.yaml:8:13"),
    ]
    assert found.execution.options is not None
    assert found.execution.options.plain() == {"workers": "auto"}
    assert found.output.directory == Path("out")
    assert found.proof.poses == 8


def test_every_setting_is_read(folder: Path) -> None:
    """From the file, and from the command line in its place."""
    text = (
        "output: {directory: out, layout: shards, size: 500}\n"
        "proof: {poses: 8, first: 10, every: 3}\n"
        "sample: {first: 0, every: 1000}\n"
        "execution: {stage: local, time_limit: 0.5}"
    )
    found = config(folder, f"{TABLE}{text}\n")
    assert found.problems == ()
    assert found.output.layout == Layout(form=Form.SHARDS, size=500)
    assert (found.proof.proved, found.sample) == (Sample(first=10, every=3), Sample(first=0, every=1000))
    assert (found.execution.time_limit, found.proof.poses) == (0.5, 8)
    changed = config(
        folder,
        f"{TABLE}{text}\n",
        "output.layout=folders",
        "sample.every=7",
        "execution.time_limit=60",
        "proof.first=0",
    )
    assert changed.problems == ()
    assert changed.output.layout == Layout(form=Form.FOLDERS, size=500)
    assert (changed.sample.every, changed.execution.time_limit, changed.proof.proved.first) == (7, 60.0, 0)


# --- Paths ------------------------------------------------------------------------------------------------------------


def test_patterns_give_files_in_the_order_of_their_names(folder: Path) -> None:
    """A pattern stands for files, sorted; folders that match are left out."""
    (folder / "tables" / "c.csv").mkdir()
    (read,) = config(folder, "inputs: tables/?.csv\n").inputs
    assert read.paths == (folder / "tables" / "a.csv", folder / "tables" / "b.csv")
    (read,) = config(folder, "inputs: '**/ur*.csv'\n").inputs
    assert read.paths == (folder / "tables" / "ur5.csv",)


@pytest.mark.parametrize(
    ("pattern", "file"), [("**/ur*.csv", "ur5.csv"), ("tables/*a.csv", "a.csv"), ("tables/odd[1].csv", "odd[1].csv")]
)
def test_what_a_pattern_does_not_find(folder: Path, pattern: str, file: str) -> None:
    """It follows no links, finds no hidden files, and is a name where a file has that name."""
    (folder / "tables" / "back").symlink_to(folder.absolute())
    (folder / "tables" / ".a.csv").write_text("a,alpha,d\n")
    (read,) = config(folder, f"inputs: '{pattern}'\n").inputs
    assert read.paths == (folder / "tables" / file,)


def test_paths_are_relative_to_the_file_that_says_them(folder: Path) -> None:
    """The run file's paths start at its folder, those of the command line at the working directory."""
    found = config(folder, TABLE + "output: {directory: out}\n")
    assert found.output.directory == folder / "out"
    found = config(folder, TABLE, "output.directory=out", "inputs=here.csv")
    assert found.output.directory == Path("out")
    assert found.inputs[0].paths == (Path("here.csv"),)


# --- Settings ---------------------------------------------------------------------------------------------------------


def test_settings_change_the_run_file(folder: Path) -> None:
    """A setting is put where its key leads, through lists, names alone, defaults and sections that are not there."""
    found = config(
        folder,
        TABLE + "emitters: [urdf, {stage: xacro}]\nloaders: pybullet\n",
        "emitters.1.options.single_file=true",
        "emitters.0.options.profile=pybullet",
        "loaders.0.options.size=[1, 2]",
        "transform.options.variant=paper",
        "execution.options.workers=2",
        "proof.poses=5",
        "inputs.0.options.base={xyz: [0, 0, 1]}",
    )
    assert found.problems == ()
    stages = (*found.emitters, *found.loaders, found.transform, found.execution)
    options = [call.options for call in stages] + [given.options for given in found.inputs]
    assert [node.plain() for node in options if node] == [
        {"profile": "pybullet"},
        {"single_file": True},
        {"size": [1, 2]},
        {"variant": "paper"},
        {"workers": 2},
        {"base": {"xyz": [0, 0, 1]}},
    ]
    assert found.proof.poses == 5


def test_a_whole_section_can_be_set(folder: Path) -> None:
    """A list or a name in place of a section is taken as the file would take it; later settings see it."""
    found = config(
        folder, TABLE + "loaders: [pybullet]\n", "emitters=[xacro, urdf]", "loaders=[]", "emitters.1.stage=dot"
    )
    assert [call.stage for call in (*found.emitters, *found.loaders)] == ["xacro", "dot"]


@pytest.mark.parametrize("word", ["*.csv", "@x", "50%", "C:\\\\arms\\\\out", '"[x"'])
def test_a_setting_that_is_a_text_needs_no_quotes(folder: Path, word: str) -> None:
    """A pattern is no YAML, and what is meant all the same; a text that begins like a list is in quotes."""
    found = config(folder, TABLE, f"output.directory={word}")
    assert not found.problems
    assert Path(found.output.directory or "").name == Path(word.strip('"')).name


@given(setting=st.text() | st.from_regex(r"\A(inputs|emitters|output|proof)(\.[a-z0]+){0,3}=[\[\]{}a-z: ]*\Z"))
def test_any_setting_is_taken_or_refused(tmp_path_factory: pytest.TempPathFactory, setting: str) -> None:
    """Whatever is behind --set gives a run file or problems."""
    path = tmp_path_factory.getbasetemp() / "any.yaml"
    path.write_text("inputs: any.yaml\nemitters: [urdf]\n")
    assert isinstance(load_config(path, [setting]), RunConfig)


# --- What is wrong ----------------------------------------------------------------------------------------------------


def test_everything_that_is_wrong_is_said_at_once(folder: Path) -> None:
    """Unknown keys, missing files, wrong values and empty lists come together, each with its place."""
    text = (
        "inputs:\n  - {path: tables/nope.csv}\n  - {pth: x}\n"
        "transfrom: alpha-swap\n"
        "emitters:\n  - {stage: urdf, profile: portable}\n  - {stage: [x]}\n  - 3\n  - [x]\n"
        "output: [build]\n"
        "proof: {poses: 0}\n"
    )
    lines = {problem.mark.line for problem in config(folder, text).problems if problem.mark}
    assert lines == {2, 3, 4, 6, 7, 9, 10, 11}


@pytest.mark.parametrize("text", ["", "a,b\n1,2\n", "[1]"])
def test_what_is_no_mapping_is_no_run_file(folder: Path, text: str) -> None:
    """A table, a list or an empty file in place of a run file cannot be used at all."""
    with pytest.raises(ConfigError):
        config(folder, text)


def test_a_run_file_that_is_not_there(folder: Path) -> None:
    """A slip in the run file's own name is answered with its neighbours."""
    config(folder, TABLE)
    with pytest.raises(ConfigError) as caught:
        load_config(folder / "run.yml")
    assert "run.yaml" in str(caught.value.problems[0].suggestion)
