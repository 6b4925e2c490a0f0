"""Tables that the emitter ``table`` writes as YAML, CSV and JSON are read back as they were, byte for byte."""

import hashlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from command_line import Cli

import dh2urdf as api
from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import LinkGeometry, Manipulator, MeshFile, MeshShape, Payload
from dh2urdf.robot import Arm, Link, Origin, Robot
from dh2urdf.stages import GivesNotices, OtherFiles
from dh2urdf_plugins.packages.table import EMITTER, SUFFIXES, TableOptions
from reference_arms import ReferenceRobot

TABLES = Path(__file__).parents[4] / "configs" / "tables"


def robot_of(*arms: Manipulator) -> Robot:
    """A robot of one table; a cell of several."""
    robots = [Robot(name=arm.name, links=(Link(name="base_link"),), joints=(), manipulator=arm) for arm in arms]
    if len(robots) == 1:
        return robots[0]
    placed = [
        Arm(name=f"arm_{number}", kind=kind, prefix=f"arm_{number}_", parent="world", placement=Origin())
        for number, kind in enumerate((*robots, robots[0]))
    ]
    return Robot(name="cell", links=(Link(name="world"),), joints=(), arms=tuple(placed))


def written(*arms: Manipulator, **options: Any) -> bytes:
    """The main file of some arms."""
    return EMITTER.emit(robot_of(*arms), "arm", TableOptions(**options))[0].content


def read(content: bytes, suffix: str, folder: Path) -> list[Any]:
    """What the reader of the suffix makes of a file."""
    path = folder / f"arm{suffix}"
    path.write_bytes(content)
    return list(api.read_all(path))


@pytest.fixture
def full(arm: Manipulator, tmp_path: Path) -> Manipulator:
    """An arm that says all that a table can say."""
    mesh = tmp_path / "link one.stl"
    mesh.write_bytes(TRIANGLE)
    shape = MeshShape(
        file=MeshFile(path=str(mesh), sha256=hashlib.sha256(TRIANGLE).hexdigest()), scale=(0.5, 1.0, 2.0), pose=arm.base
    )
    rows = (arm.rows[0], replace(arm.rows[1], visual=shape, radius=0.05), *arm.rows[2:])
    return replace(
        arm,
        rows=rows,
        geometry=LinkGeometry(shape="box", radius=0.04),
        density=1500.0,
        base_mass=4.0,
        base_geometry=LinkGeometry(shape="cylinder"),
        payload=Payload(mass=2.0, com=(0.0, 0.1, 0.2), inertia=arm.rows[1].inertia),
        visuals=True,
        collisions=False,
    )


ROUNDED = ("rtb_P8", "rtbm_nao_left_leg")
"""Robots whose base or tool is a quarter turn to 1e-16: the readers make such turns exact."""
TRIANGLE = b"solid c\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid c\n"


@pytest.mark.parametrize("name", ["yaml", "json"])
def test_everything_comes_back(full: Manipulator, name: Any, tmp_path: Path) -> None:
    """The manipulator that is read equals the one that was written, in every field, and is written with the same bytes."""
    content = written(full, formats=(name,))
    (again,) = read(content, SUFFIXES[name], tmp_path)
    assert again == full
    assert written(again, formats=(name,)) == content
    gives = EMITTER.can(GivesNotices)
    assert gives.notices(robot_of(full), TableOptions(formats=(name,))) == []


def test_csv_names_what_it_leaves_out(full: Manipulator, tmp_path: Path) -> None:
    """Meshes of rows, and whether links are drawn, are named; everything else comes back, byte for byte."""
    options = TableOptions(formats=("csv",))
    content = EMITTER.emit(robot_of(full), "arm", options)[0].content
    (again,) = read(content, ".csv", tmp_path)
    bare = replace(full.rows[1], visual=None)
    assert again == replace(full, rows=(full.rows[0], bare, *full.rows[2:]), visuals=None, collisions=None)
    assert written(again, formats=("csv",)) == content
    gives = EMITTER.can(GivesNotices)
    assert [notice.code for notice in gives.notices(robot_of(full), options)] == ["no-place-for-field"] * 3


@pytest.mark.parametrize("units", [("m", "rad"), ("mm", "deg"), ("cm", "deg")])
@pytest.mark.parametrize("name", ["yaml", "csv"])
def test_published_tables_come_back(
    reference_robot: ReferenceRobot, name: Any, units: tuple[Any, Any], tmp_path: Path
) -> None:
    """The very manipulator in m and rad, in other units the same to rounding; written again, the same bytes."""
    arm = reference_robot.manipulator
    if arm.name in ROUNDED:
        (exact,) = read(written(arm), ".yaml", tmp_path)
        assert replace(exact, base=arm.base, tool=arm.tool) == arm
        assert abs(exact.fk([0.0] * len(arm.moving_rows)) - arm.fk([0.0] * len(arm.moving_rows))).max() <= 1e-15
        arm = exact
    options: Any = {"formats": (name,), "length_unit": units[0], "angle_unit": units[1]}
    content = written(arm, **options)
    (again,) = read(content, SUFFIXES[name], tmp_path)
    if units == ("m", "rad"):
        assert again == arm
    assert written(again, **options) == content
    q = [0.3] * len(arm.moving_rows)
    assert abs(again.fk(q) - arm.fk(q)).max() <= 1e-12 * max(1.0, abs(arm.fk(q)).max())


@pytest.mark.parametrize("table", sorted(TABLES.iterdir()), ids=lambda path: path.name)
@pytest.mark.parametrize("suffix", [".yaml", ".csv", ".json"])
def test_convert_writes_tables(cli: Cli, tmp_path: Path, table: Path, suffix: str) -> None:
    """The suffix chooses the format, the table is proved, and a table of the table is the same file."""
    first, second = tmp_path / f"first{suffix}", tmp_path / "again" / f"second{suffix}"
    answer = cli("convert", table, "-o", first)
    assert "proved at" in answer.stderr
    cli("convert", first, "-o", second)
    assert second.read_bytes() == first.read_bytes()
    assert api.read(first) == api.read(table)


def test_a_description_becomes_a_table(cli: Cli, tmp_path: Path) -> None:
    """`convert arm.urdf -o arm.csv` writes the table that `extract` writes, without its comments."""
    cli("convert", TABLES / "ur5.csv", "-o", tmp_path / "ur5.urdf")
    cli("convert", tmp_path / "ur5.urdf", "-o", tmp_path / "converted.yaml")
    cli("extract", tmp_path / "ur5.urdf", "-o", tmp_path / "extracted.yaml", "--convention", "standard")
    extracted = (tmp_path / "extracted.yaml").read_text().splitlines()
    assert (tmp_path / "converted.yaml").read_text().splitlines() == [line for line in extracted if line[0] != "#"]


def test_split_rows_are_in_the_table(cli: Cli, tmp_path: Path) -> None:
    """What the option near_parallel makes of a calibrated table is what is written."""
    numbers = [(0, 1.5719, 0.15), (-0.6, 0.001, 574.2), (-0.57, -0.0009, -507.1), (0, 1.5702, -66.9)]
    numbers += [(0, -1.5711, 0.1), (0, 0, 0.09)]
    lines = ["# convention: standard", "a,alpha,d", *(",".join(map(str, row)) for row in numbers)]
    (tmp_path / "calibrated.csv").write_text("\n".join(lines))
    given = api.read(tmp_path / "calibrated.csv")
    cli("convert", tmp_path / "calibrated.csv", "-o", tmp_path / "split.csv", "--set", "near_parallel=split")
    split = api.read(tmp_path / "split.csv")
    assert [row.type.value for row in split.rows].count("fixed") == 2
    assert len(split.moving_rows) == len(given.moving_rows) == 6
    assert max(abs(row.d) for row in split.rows) < 1
    q = [0.1, -0.7, 0.4, 1.0, -0.2, 0.5]
    assert abs(split.fk(q) - given.fk(q)).max() <= 1e-11


def test_what_can_be_read_back_is_proved(cli: Cli, tmp_path: Path) -> None:
    """A table for a paper is the main file, and the table beside it is the one that is proved."""
    words = ["convert", TABLES / "ur5.csv", "-o", tmp_path / "ur5.tex"]
    assert "not proved" in cli(*words).stderr
    assert "proved at" in cli(*words, "--set", "formats=[latex, csv]").stderr


class TestCells:
    """A cell has a table for each kind of arm."""

    def test_each_kind_once(self, arm: Manipulator, tmp_path: Path) -> None:
        """Three arms of two kinds: two tables, which come back; where the arms are is not said, and that is."""
        other = replace(arm, name="other", tool=arm.base)
        for name in ("yaml", "json"):
            content = written(arm, other, formats=(name,))
            assert read(content, SUFFIXES[name], tmp_path) == [arm, other]
        gives = EMITTER.can(GivesNotices)
        (notice,) = gives.notices(robot_of(arm, other), TableOptions())
        assert notice.code == "tables-of-a-cell"

    def test_csv_has_one_base(self, arm: Manipulator, tmp_path: Path) -> None:
        """Arms of one base are rows of one file; of two, an error that names what differs."""
        twin = replace(arm, name="twin")
        content = written(arm, twin, formats=("csv",))
        assert read(content, ".csv", tmp_path) == [arm, twin]
        with pytest.raises(EmitterError):
            written(arm, replace(twin, tool=arm.base), formats=("csv",))


def test_several_formats(arm: Manipulator) -> None:
    """A file each, the first being the main one; a suffix that a person chose comes first."""
    options = TableOptions(formats=("latex", "csv"))
    assert [file.name for file in EMITTER.emit(robot_of(arm), "a", options)] == ["a.tex", "a.csv"]
    others = EMITTER.can(OtherFiles)
    assert others.for_suffix(options, ".csv").formats == ("csv", "latex")
    assert others.for_suffix(TableOptions(), ".yml").formats == ("yaml",)
    others = EMITTER.can(OtherFiles)
    assert others.one_file(options).formats == ("latex",)


def test_links_that_no_table_has_are_noticed(tmp_path: Path, cli: Cli) -> None:
    """What an edit has mounted is in the URDF, and a notice of the table names it."""
    (tmp_path / "arm.csv").write_text("# convention: standard\na, alpha, d\n0.4, pi/2, 0.1\n0.3, 0, 0\n")
    (tmp_path / "run.yaml").write_text(
        "inputs: arm.csv\nemitters: [urdf, table]\nedits: {stage: mount, options: {name: camera, optical: true}}\n"
    )
    told = cli("run", tmp_path / "run.yaml", "-o", tmp_path / "out").stderr
    assert "camera_optical_frame" in told
    assert '"camera"' in (tmp_path / "out" / "arm.urdf").read_text()
