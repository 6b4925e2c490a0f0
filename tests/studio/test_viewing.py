from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import trimesh

from dh2urdf.errors import InputError
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.robot import Mesh
from dh2urdf_studio.viewing import View, load_figures

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.plugin_system import Catalog

CONFIGS = Path(__file__).parents[2] / "configs"


def tips(view: View) -> dict[str, np.ndarray]:
    return {name: as_matrices(pose) for name, pose in view.tips()}


def test_every_form_of_an_arm_is_the_same(catalog: Catalog, cli: Callable[..., Any], tmp_path: Path) -> None:
    """A table, its URDF and its xacro are three robots of one scene, with the same tool0 for the same joint values."""
    table = CONFIGS / "tables" / "ur5.csv"
    cli("convert", table, "-o", "ur5.urdf")
    cli("convert", table, "-o", "ur5.urdf.xacro")
    view = View(load_figures([table, tmp_path / "ur5.urdf", tmp_path / "ur5.urdf.xacro"], catalog))
    assert [figure.name for figure in view.figures] == ["ur5/", "ur5 2/", "ur5 3/"]
    assert len(view.sliders) == 18
    view.move({slider.name: 0.1 * (index % 6) for index, slider in enumerate(view.sliders)})
    one, two, three = tips(view).values()
    assert np.allclose(one, two, atol=1e-9)
    assert np.allclose(one, three, atol=1e-9)


def test_a_cell_is_one_robot(catalog: Catalog) -> None:
    """A run file with a cell shows the cell, whose arms have sliders each; one without shows its arms."""
    view = View(load_figures([CONFIGS / "pair.yaml"], catalog))
    assert len(view.figures) == 1
    assert len(view.sliders) == 12
    assert set(tips(view)) == {"left_tool0", "right_tool0"}
    folder = load_figures([CONFIGS / "folder.yaml"], catalog)
    assert {figure.title for figure in folder} >= {"ur5", "panda", "scara"}


def test_a_run_file_is_planned_as_a_run_plans_it(catalog: Catalog, tmp_path: Path) -> None:
    """Its meshes are on the links, and its variants are shown beside the table that they are drawn from."""
    trimesh.creation.box((0.1, 0.1, 0.1)).export(tmp_path / "part.stl")
    (tmp_path / "arm.csv").write_text("# convention: standard\na,alpha,d,theta\n0.3,0,0,0\n0.2,0,0,0\n")
    run = tmp_path / "run.yaml"
    text = (
        "inputs: arm.csv\nemitters: [urdf]\nloaders: [pybullet]\noutput: {directory: build}\n"
        "meshes: [{of: arm, joints: {joint_1: {mesh: part.stl}}}]\n"
        "variations: [{name: more, of: arm, count: 3, seed: 1, vary: [{joints: all, field: a, uniform: [0.1, 0.5]}]}]\n"
    )
    run.write_text(text)
    figures = load_figures([run], catalog)
    assert [figure.title for figure in figures] == ["arm", "more_1", "more_2", "more_3"]
    shapes = [visual.geometry for link in figures[0].robot.links for visual in link.visuals]
    assert any(isinstance(shape, Mesh) for shape in shapes)
    lengths = {row.a for figure in figures[1:] if figure.manipulator for row in figure.manipulator.rows}
    assert len(lengths) == 6
    run.write_text(text.replace("count: 3", "count: 1000000"))
    with pytest.raises(InputError, match="these are more than 50 robots"):
        load_figures([run], catalog)
    assert not (tmp_path / "build").exists()


def test_a_single_robot_has_its_own_names(catalog: Catalog) -> None:
    """Nothing stands before the names of joints and links where there is only one robot."""
    (figure,) = load_figures([CONFIGS / "tables" / "ur5.csv"], catalog)
    assert (figure.name, figure.title) == ("", "")


def test_side_by_side_or_at_one_place(catalog: Catalog) -> None:
    """Robots stand far enough from each other, or all at the same place to be compared."""
    table = CONFIGS / "tables" / "ur5.csv"
    view = View(load_figures([table, table], catalog))
    names = [node.name for node in view.drawing.nodes]
    for apart in (True, False):
        view.place(apart=apart)
        poses = view.drawing.poses(view.q)
        one, other = (poses[names.index(f"{name}/base_link")].translation for name in ("ur5", "ur5 2"))
        assert (abs(other[1] - one[1]) > 1.0) is apart


def test_everything_that_is_wrong_is_said(catalog: Catalog, tmp_path: Path) -> None:
    """All files are looked at; each that cannot be shown is named."""
    (tmp_path / "wrong.urdf").write_text("<robot name='x'><link/></robot>")
    (tmp_path / "wrong.csv").write_text("# convention: standard\na,alpha,d\n1,x,0\n")
    paths = [tmp_path / "wrong.urdf", tmp_path / "wrong.csv", tmp_path / "none.urdf", tmp_path / "x.step"]
    (tmp_path / "x.step").write_text("")
    with pytest.raises(InputError) as caught:
        load_figures(paths, catalog)
    text = str(caught.value)
    assert all(path.name in text for path in paths)


def test_ends_of_a_foreign_robot(catalog: Catalog, tmp_path: Path) -> None:
    """Where nothing is called tool0, the links that hold no other are the ends."""
    path = tmp_path / "tree.urdf"
    path.write_text(
        "<robot name='tree'><link name='trunk'/><link name='left'/><link name='right'/>"
        "<joint name='l' type='continuous'><parent link='trunk'/><child link='left'/></joint>"
        "<joint name='r' type='fixed'><parent link='trunk'/><child link='right'/></joint></robot>"
    )
    assert [name for name, _ in View(load_figures([path], catalog)).tips()] == ["left", "right"]
