import io
import zipfile
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.errors import EmitterError, InputError
from dh2urdf.plugin_system import Catalog
from dh2urdf.table_text import TableText
from dh2urdf_studio.editing import edits, save
from dh2urdf_studio.editing.opening import gallery, gallery_table, tables_of
from dh2urdf_studio.editing.reading import read_whole


@pytest.mark.parametrize(
    ("file", "variant", "form", "robot"),
    [
        *(("ur5_paper.csv", *case) for case in product(("exact", "paper"), ("csv", "yaml"), ("urdf", "xacro"))),
        *((file, "exact", "csv", "urdf") for file in gallery()),
    ],
)
def test_files_are_those_of_convert(
    catalog: Catalog, cli: Callable[..., Any], tmp_path: Path, *, file: str, variant: str, form: str, robot: str
) -> None:
    """Byte by byte what `dh2urdf convert` makes of the saved table, of every arm of the gallery, saved in either format."""
    table = gallery_table(file, catalog)
    saved = save.table_file(table, form, catalog)
    (tmp_path / saved.name).write_bytes(saved.content)
    made = save.saved(table, "robot", robot, variant, catalog)
    assert made.proof is not None
    assert made.proof.holds is (variant == "exact")
    answer = cli("convert", saved.name, "--to", robot, "--variant", variant)
    assert made.content == answer.stdout.encode()


@pytest.mark.parametrize("form", ["csv", "yaml"])
def test_decimal_commas_are_saved(catalog: Catalog, cli: Callable[..., Any], tmp_path: Path, form: str) -> None:
    """A saved YAML table had them as they were typed, and could not be read."""
    one = {"joint": "1,2", "a": "0,5", "alpha": "-1,25", "d": "−,3", "velocity": "2,5 rad/s", "effort": "1,5E2"}
    two = {"joint": "3,4", "type": "P", "a": "12,5 cm", "alpha": "30,5°", "d": "0", "lower": "0", "upper": "+0,4"}
    table = TableText(name="arm", convention="standard", rows=(one, two))
    saved = save.table_file(table, form, catalog)
    (tmp_path / saved.name).write_bytes(saved.content)
    assert save.saved(table, "robot", "urdf", "exact", catalog).content == cli("convert", saved.name).stdout.encode()


@pytest.mark.long
def test_a_zip_of_all_runs(catalog: Catalog, cli: Callable[..., Any], tmp_path: Path) -> None:
    """The run file of the zip makes the robot descriptions of the zip, byte by byte; a zip is always the same bytes."""
    table = replace(gallery_table("ur5.csv", catalog), name="my arm: 1")
    content = save.saved(table, "all", "", "exact", catalog).content
    assert content == save.saved(table, "all", "", "exact", catalog).content
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        archive.extractall(tmp_path)
        names = archive.namelist()
    (run,) = [name for name in names if name.endswith("_run.yaml")]
    cli("run", run)
    made = {path.name: path.read_bytes() for path in (tmp_path / "build").glob("*/my_arm*")}
    tables = (".csv", ".yaml", ".json", ".md", ".tex", ".m", ".py")
    assert {name.removeprefix("my_arm__1") for name in names} >= set(tables)
    robots = [name for name in names if not name.endswith(tables)]
    assert {"my_arm__1.urdf", "my_arm__1.urdf.xacro", "my_arm__1.sdf", "my_arm__1.xml"} <= set(robots)
    assert made == {name: (tmp_path / name).read_bytes() for name in robots}


@pytest.mark.parametrize("suffix", [".json", ".md", ".tex", ".m", ".py"])
def test_tables_for_people_and_programs(catalog: Catalog, cli: Callable[..., Any], tmp_path: Path, suffix: str) -> None:
    """Byte by byte what `dh2urdf convert` writes; YAML and CSV are saved as they were typed, and not once more."""
    assert save.other_suffixes(catalog) == (".md", ".tex", ".json", ".m", ".py")
    table = gallery_table("panda.yaml", catalog)
    saved = save.table_file(table, "yaml", catalog)
    (tmp_path / saved.name).write_bytes(saved.content)
    cli("convert", saved.name, "-o", f"again{suffix}")
    assert save.other_file(table, suffix, "exact", catalog).content == (tmp_path / f"again{suffix}").read_bytes()


def test_what_cannot_be_made(catalog: Catalog) -> None:
    """A wrong cell, an empty row, a format that is only read, and a fixed row between two joints of a DHRobot."""
    ur5 = gallery_table("ur5.csv", catalog)
    assert save.table_formats(catalog) == ("csv", "yaml")
    with pytest.raises(InputError):
        save.table_file(ur5, "parquet", catalog)
    with pytest.raises(InputError, match="'wrong'"):
        save.saved(edits.with_cells(ur5, {(1, "alpha"): "wrong"}), "robot", "urdf", "exact", catalog)
    with pytest.raises(InputError):
        save.all_files(edits.resized(ur5, 7), "exact", catalog)
    fixed = edits.with_cells(ur5, {(2, "type"): "fixed"})
    with pytest.raises(EmitterError):
        save.other_file(fixed, ".py", "exact", catalog)
    names = [file.name for file in save.all_files(fixed, "exact", catalog)]
    assert ("ur5.m" in names, "ur5.py" in names) == (True, False), "the zip has all that can be made"


@pytest.mark.parametrize("name", ["base", "payload"])
@pytest.mark.parametrize(
    "text",
    ["xyz: [0, 0, 300 mm]", "mass: 2", "{xyz: [0, 0", "[0, 0", "a: b: c", "'x", "*x", "- a", "{mass: 2.5}, more: 1"],
)
def test_a_text_below_the_cells_breaks_no_file(name: str, text: str, catalog: Catalog) -> None:
    """`base: xyz: [0, 0, 1]` is a mapping on the page and no YAML: the whole file could not be opened again."""
    row = {"joint": "j", "type": "revolute", "a": "1", "alpha": "0", "d": "0"}
    table = TableText(name="arm", convention="standard", rows=(row,))
    table = replace(table, **{name: text})
    read = read_whole(table, catalog)
    opened = tables_of("arm.yaml", save.table_file(table, "yaml", catalog).content, catalog)
    if read.manipulator is not None:
        assert isinstance(opened, tuple), opened
        assert read_whole(opened[0].table, catalog).manipulator == read.manipulator
    else:
        assert f"'{name}" in str(opened)
        assert "valid YAML" not in str(opened)
