from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from two_fingers import HAND

import dh2urdf
from dh2urdf.errors import InputError
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.plugin_system import Catalog
from dh2urdf.robot import Mesh
from dh2urdf_studio.viewing import View, load_figures

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


def test_joints_of_a_table_that_follow_others_have_no_slider(catalog: Catalog, cli: Callable[..., Any]) -> None:
    """Those of a palletiser; its URDF moves alike."""
    table = CONFIGS / "palletiser" / "irb460.yaml"
    cli("convert", table, "-o", "irb460.urdf")
    view = View(load_figures([table, Path("irb460.urdf")], catalog))
    leaders = [row.joint for row in dh2urdf.read(table).actuated_rows]
    assert [slider.name.partition("/")[2] for slider in view.sliders] == leaders * 2
    view.move({slider.name: 0.1 * (1 + index % len(leaders)) for index, slider in enumerate(view.sliders)})
    one, two = tips(view).values()
    assert np.allclose(one, two, atol=1e-9)


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
    with pytest.raises(InputError) as caught:
        load_figures([run], catalog)
    assert caught.value.problems[0].code == "too-many-robots"
    assert not (tmp_path / "build").exists()


def test_one_robot_and_wrong_files(catalog: Catalog, tmp_path: Path) -> None:
    """A single robot has names of its own; without a tool0, links that hold no other are its ends; all faults are named."""
    names = ("tree.urdf", "wrong.urdf", "wrong.csv", "none.urdf", "x.step")
    tree, *wrong = (tmp_path / name for name in names)
    joint = "<joint name='{0}' type='continuous'><parent link='trunk'/><child link='{0}'/></joint>"
    links = "".join(f"<link name='{name}'/>" for name in ("trunk", "left", "right"))
    tree.write_text(f"<robot name='tree'>{links}{joint.format('left')}{joint.format('right')}</robot>")
    view = View(load_figures([tree], catalog))
    assert (view.figures[0].name, [name for name, _ in view.tips()]) == ("", ["left", "right"])
    wrong[0].write_text("<robot name='x'><link/></robot>")
    wrong[1].write_text("# convention: standard\na,alpha,d\n1,x,0\n")
    wrong[3].write_text("")
    with pytest.raises(InputError) as caught:
        load_figures(wrong, catalog)
    assert [name for name in names[1:] if name not in str(caught.value)] == []


def test_the_arms_of_a_run_file_are_edited(catalog: Catalog, tmp_path: Path) -> None:
    """Joints have their new names, a hand is there, and its follower follows."""
    (tmp_path / "arm.csv").write_text("# convention: standard\na,alpha,d,theta\n0.3,0,0,0\n0.2,0,0,0\n")
    edits = f"[{{stage: rename, options: {{prefix: my_}}}}, {{stage: attach, options: {{file: {HAND}, name: hand}}}}]"
    run = tmp_path / "run.yaml"
    run.write_text(f"inputs: arm.csv\nemitters: [urdf]\nedits: {edits}\noutput: {{directory: build}}\n")
    view = View(load_figures([run], catalog))
    assert [slider.name for slider in view.sliders] == ["my_joint_1", "my_joint_2", "hand_left"]
    view.move({"hand_left": 0.2})
    assert view.q["hand_right"] == pytest.approx(0.001 - 0.05 * 0.2)
    assert {"hand_left_finger", "frame 2"} <= {node.name for node in view.drawing.nodes}
    assert np.allclose(tips(view)["tool0"][:3, 3], (0.5, 0.0, 0.0))
    assert len(view.drawing.poses(view.q)) == len(view.drawing.nodes)
