from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.rotations import HALF_PI, RigidTransform
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.table import TableOptions


@pytest.fixture
def read_one(tmp_path: Path) -> Callable[..., Manipulator | Rejected]:
    """The manipulator of a table; there are meshes beside it."""
    (tmp_path / "meshes").mkdir()
    for name in ("a.stl", "b.dae"):
        (tmp_path / "meshes" / name).touch()

    def read(text: str, suffix: str = ".yaml") -> Manipulator | Rejected:
        path = tmp_path / f"arm{suffix}"
        path.write_text(text)
        (arm,) = (stages.YAML if suffix == ".yaml" else stages.CSV).read(path, TableOptions())
        return arm

    return read


def joint(words: str) -> str:
    return f"convention: standard\nunits: mm, deg\njoints:\n  - {{name: j, a: 300, alpha: 90, d: 0, {words}}}\n"


def test_a_mesh_is_a_path_or_a_mapping(read_one: Callable[..., Manipulator]) -> None:
    """Its place has the units of the table; its path leads from the folder of the table, and its mark is kept."""
    arm = read_one(
        joint(
            "mesh: meshes/a.stl, visual: meshes/b.dae, collision: {file: meshes/a.stl, xyz: [1, 0, 0], rpy: [0, 0, 90], scale: 1/1000}"
        )
    )
    (row,) = arm.rows
    assert row.visual is not None
    assert row.collision is not None
    assert [Path(shape.file.path).name for shape in (row.visual, row.collision)] == ["b.dae", "a.stl"]
    assert (row.visual.scale, row.collision.scale) == ((1.0,) * 3, (0.001,) * 3)
    assert row.visual.pose == RigidTransform.from_xyz_rpy((0.0, 0.0, 0.0))
    assert row.collision.pose == RigidTransform.from_xyz_rpy((0.001, 0.0, 0.0), (0.0, 0.0, HALF_PI))
    assert str(row.visual.mark).endswith("arm.yaml:4:68")


@pytest.mark.parametrize("reader", [stages.YAML, stages.CSV], ids=["yaml", "csv"])
def test_a_mesh_that_is_a_link_to_elsewhere_is_refused(tmp_path: Path, reader: Any) -> None:
    """Of a joint, and of the base in any table; the option `mesh_links` allows it."""
    (tmp_path / "secret").write_text("solid")
    (tmp_path / "table").mkdir()
    (tmp_path / "table/link.stl").symlink_to(tmp_path / "secret")
    path = tmp_path / "table" / f"arm.{reader.name}"
    if reader is stages.YAML:
        path.write_text(joint("mesh: link.stl"))
    else:
        path.write_text("# convention: standard\n# base: {mesh: link.stl}\njoint,a,alpha,d\nj,1,0,0\n")
    try:
        problems = [problem for item in reader.read(path, TableOptions()) for problem in item.problems]
    except TableError as error:
        problems = list(error.problems)
    assert ["is a link out of the folder" in problem.message for problem in problems] == [True]
    (arm,) = reader.read(path, TableOptions(mesh_links=True))
    assert arm.base_visual or arm.rows[0].visual


def test_the_base_has_meshes_in_comment_lines_too(read_one: Callable[..., Manipulator]) -> None:
    """Where a CSV table says its base."""
    arm = read_one(
        "# convention: standard\n# base: {xyz: [0, 0, 1], mesh: meshes/a.stl}\na,alpha,d\n0.3,0,0\n", suffix=".csv"
    )
    assert arm.base_visual is not None
    assert arm.base_visual == arm.base_collision
    assert Path(arm.base_visual.file.path).name == "a.stl"


def test_a_table_says_what_is_drawn(read_one: Callable[..., Manipulator]) -> None:
    """All or none; nothing leaves it to the run."""
    arm = read_one("visuals: none\ncollisions: all\n" + joint("armature: 0.02 kg·m²"))
    assert (arm.visuals, arm.collisions, arm.rows[0].armature) == (False, True, 0.02)
    plain = read_one(joint("d: 0").replace("d: 0, d: 0", "d: 0"))
    assert (plain.visuals, plain.collisions, plain.rows[0].armature) == (None, None, None)


@pytest.mark.parametrize(
    ("words", "place", "field"),
    [
        ("visual: meshes/c.stl", "4:48", "visual"),
        ("visual: {file: meshes/c.stl}", "4:55", "visual.file"),
        ("visual: package://arm/a.stl", "4:48", "visual"),
        ("visual: {xyz: [0, 0, 0]}", "4:48", "visual"),
        ("visual: 3", "4:48", "visual"),
        ("visual: {file: meshes/a.stl, scael: 2}", "4:69", "scael"),
        ("visual: {file: meshes/a.stl, scale: 2 mm}", "4:76", "visual.scale"),
    ],
)
def test_what_is_wrong_with_a_mesh_has_its_place(
    words: str, place: str, field: str, read_one: Callable[..., Rejected]
) -> None:
    """Line and column, joint and field."""
    rejected = read_one(joint(words))
    assert isinstance(rejected, Rejected)
    (problem,) = rejected.problems
    assert str(problem.mark).endswith(f"arm.yaml:{place}")
    assert (problem.joint, problem.field) == ("j", field)


@pytest.mark.parametrize("words", ["defaults: {visual: meshes/a.stl}", "visuals: false"])
def test_one_file_is_not_the_shape_of_all_links_and_false_is_not_none(
    words: str, read_one: Callable[..., Rejected]
) -> None:
    assert isinstance(read_one(f"{words}\n{joint('theta: 0')}"), Rejected)
