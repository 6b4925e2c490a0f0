from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from dh2urdf.errors import InputError
from dh2urdf.manipulator import Manipulator
from dh2urdf_studio import words
from dh2urdf_studio.editing.opening import open_tables, tables_of
from dh2urdf_studio.editing.reading import read_whole

if TYPE_CHECKING:
    from dh2urdf.plugin_system import Catalog

REFERENCE = Path(__file__).parents[2] / "reference" / "inputs"
TABLES = Path(__file__).parents[3] / "configs" / "tables"


def accepted() -> list[str]:
    records = json.loads((REFERENCE / "expected.json").read_text("utf-8"))
    items = records.items() if isinstance(records, dict) else ((record["file"], record) for record in records)
    return [name for name, record in items if isinstance(record, dict) and record.get("outcome") == "accept"]


@pytest.mark.parametrize("name", accepted())
def test_any_table_that_a_reader_takes_can_be_opened(name: str, catalog: Catalog) -> None:
    """What the tables of real people say is said by their texts too, and the arm is the same."""
    path = REFERENCE / name
    reader = catalog.reader_for(path)
    try:
        arms = [item for item in reader.read(path, reader.options()) if isinstance(item, Manipulator)]
    except InputError:
        arms = []
    if not arms:  # it does not say its convention
        ((table, *_),) = open_tables(path, catalog)
        assert not table.convention
        (arm,) = reader.read(path, reader.options(convention="modified"))
        assert read_whole(replace(table, convention="modified"), catalog).manipulator == arm
        return
    for arm, opened in zip(arms, open_tables(path, catalog), strict=True):
        assert read_whole(opened.table, catalog).manipulator == arm
        assert opened.lost == ()


@pytest.mark.parametrize("convention", ["# convention: modified\n", ""])
def test_a_manipulator_that_cannot_be_read_is_named(convention: str, catalog: Catalog, tmp_path: Path) -> None:
    """The page opened the other ones without a word, and the command line had never heard of it."""
    path = tmp_path / "arms.csv"
    path.write_text(f"{convention}robot,a [mm],alpha,d [m]\ngood,1,0,0\nbad one,wrong,0,0\nworse,0,0,wrong\n")
    (opened,) = open_tables(path, catalog)
    assert opened.table.name == "good"
    assert f"also has bad one, worse, which cannot be read: {path}:{4 if convention else 3}:9: " in opened.notices[-1]
    assert "'wrong' cannot be read" in opened.notices[-1]
    if convention:
        with pytest.raises(InputError, match="'wrong' cannot be read"):
            open_tables(path, catalog, wanted="worse")
    assert open_tables(path, catalog, wanted="good") == open_tables(path, catalog, wanted="none") == (opened,)


def test_the_texts_of_a_file_are_kept(catalog: Catalog) -> None:
    """`pi/2` and `-130°` are what the file says, and what is shown."""
    ((table, *_),) = open_tables(TABLES / "scara.csv", catalog)
    assert table.rows[1]["alpha"] == "pi"
    assert table.rows[0]["lower"] == "-130°"


def test_all_numbers_of_a_joint_are_kept(catalog: Catalog, tmp_path: Path) -> None:
    """Masses, friction and armature are columns of the table too."""
    path = tmp_path / "arm.yaml"
    path.write_text(
        "convention: standard\njoints:\n"
        "  - {a: 1, alpha: 0, d: 0, mass: 2, com: [0, 0, 0.1], damping: 0.1, friction: 0.2, armature: 0.3}\n"
    )
    ((table, lost, _),) = open_tables(path, catalog)
    assert lost == ()
    assert {"mass": "2", "com_z": "0.1", "damping": "0.1", "friction": "0.2", "armature": "0.3"}.items() <= table.rows[
        0
    ].items()


def test_what_a_table_cannot_hold_is_told(catalog: Catalog, tmp_path: Path) -> None:
    """A mesh has no cell: the arm is opened without it, and that is said."""
    (tmp_path / "link.stl").write_text("solid x\nendsolid x\n")
    path = tmp_path / "arm.yaml"
    path.write_text(
        "convention: standard\nvisuals: none\njoints:\n"
        "  - {a: 1, alpha: 0, d: 0}\n  - {name: bare, a: 1, alpha: 0, d: 0, collision: link.stl}\n"
    )
    ((table, lost, _),) = open_tables(path, catalog)
    assert [row["a"] for row in table.rows] == ["1", "1"]
    assert lost == ("visuals", "collision of bare")


def test_what_the_reader_noticed_is_told(catalog: Catalog) -> None:
    """A column that means nothing is not in the table on the page: its notice would be lost."""
    content = "# convention: standard\na,alpha,d,colour of the cable\n1,90°,0,red\n".encode()
    (opened,) = tables_of("arm.csv", content, catalog)  # type: ignore[misc]
    (notice,) = opened.notices
    assert notice.startswith("arm.csv:2")
    assert "colour of the cable" in notice
    assert words.remarks(opened) == [notice]


def test_of_a_large_file_only_the_first_are_read(catalog: Catalog) -> None:
    rows = "".join(f"r{number},0.1,0,0\n" for number in range(200))
    content = f"# convention: standard\nrobot,a,alpha,d\n{rows}r200,wrong,0,0\n".encode()
    opened = tables_of("many.csv", content, catalog, most=7)
    assert [each.table.name for each in opened] == [f"r{number}" for number in range(7)]  # type: ignore[union-attr]


def test_a_convention_is_not_missed_beside_another_error(catalog: Catalog) -> None:
    """A person chooses it on the page: only what else is wrong with the file is said."""
    told = tables_of("arm.csv", b"a [mm],alpha [deg],d\n0.1,x,2\n", catalog)
    assert isinstance(told, str)
    assert "convention" not in told
    assert "'x' cannot be read" in told
    assert "'2' has no unit" in told
    told = tables_of("arm.csv", b"# convention: craigg\na [mm],alpha [deg],d\n0.1,x,2\n", catalog)
    assert "'craigg' is no convention" in told


def test_a_run_file_is_no_table(catalog: Catalog) -> None:
    """It is told what it is, and where its robots are shown."""
    with pytest.raises(InputError, match=r"ur5\.yaml: error: this is a run file, not a table\n.*`dh2urdf view`"):
        open_tables(TABLES.parent / "ur5.yaml", catalog)


def test_a_description_with_several_chains(catalog: Catalog) -> None:
    """None of its leaves has a usual name, so each chain is a table that can be chosen."""
    links = "".join(f"<link name='{name}'/>" for name in ("trunk", "left", "right"))
    joint = (
        "<joint name='{0}_joint' type='continuous'><parent link='trunk'/><child link='{0}'/><axis xyz='0 0 1'/></joint>"
    )
    text = f"<robot name='tree'>{links}{joint.format('left')}{joint.format('right')}</robot>"
    opened = tables_of("tree.urdf", text.encode(), catalog)
    assert not isinstance(opened, str)
    assert [each.table.name for each in opened] == ["tree_left", "tree_right"]
    assert [each.table.rows[0]["joint"] for each in opened] == ["left_joint", "right_joint"]


def test_a_table_of_two_units_and_no_convention_is_opened(tmp_path: Path, catalog: Catalog) -> None:
    """No table can hold its texts, so it has their numbers; a person says the convention on the page."""
    (tmp_path / "two.csv").write_text("a [mm],alpha [deg],d [m]\n425,90,0.1\n0,-90,0.2\n")
    (opened,) = open_tables(tmp_path / "two.csv", catalog)
    assert opened.table.convention == ""
    arm = read_whole(replace(opened.table, convention="modified"), catalog).manipulator
    assert arm is not None
    assert [(row.a, row.d) for row in arm.rows] == [(0.425, 0.1), (0.0, 0.2)]
    (tmp_path / "two.csv").write_text("a [mm],alpha [deg],d [m]\n425,90,x\n")
    with pytest.raises(InputError, match="'x' cannot be read"):
        open_tables(tmp_path / "two.csv", catalog)


def test_a_xacro_without_its_macro(catalog: Catalog) -> None:
    """A browser sends one file alone: the message names the other one, and what to open in its place."""
    top = b'<robot xmlns:xacro="http://ros.org/wiki/xacro" name="a"><xacro:include filename="a_macro.xacro"/></robot>'
    found = tables_of("a.urdf.xacro", top, catalog)
    assert isinstance(found, str)
    assert "it names the file './a_macro.xacro', which is not there" in found
    assert "the URDF that xacro makes of it" in found
