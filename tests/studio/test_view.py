"""`dh2urdf view` in a real browser."""

import io
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from dh2urdf.plugin_system import Catalog
from dh2urdf_studio.viewing import View, load_figures

pytestmark = pytest.mark.long
CONFIGS = Path(__file__).parents[2] / "configs"


def test_a_cell_and_an_arm_in_one_scene(open_view: Callable[..., Any], catalog: Catalog) -> None:
    """A dual-arm cell and a table beside it: sliders for all joints, and every tool0 where its kinematics has it."""
    paths = [CONFIGS / "pair.yaml", CONFIGS / "tables" / "panda.yaml"]
    with open_view(*paths, sliders=19) as tab:
        page = tab.page
        tab.press("random pose")
        view = View(load_figures(paths, catalog))
        shown = [slider.value(x) for slider, x in zip(view.sliders, tab.sliders(), strict=True)]
        view.move({slider.name: x for slider, x in zip(view.sliders, shown, strict=True)})
        names = [node.name for node in view.drawing.nodes]
        poses = view.drawing.poses(view.q)
        for name in ("pair/left_tool0", "pair/right_tool0", "panda/tool0"):
            tab.wait_for_pose(name, poses[names.index(name)])
        name, content = tab.save("Scene as glTF (GLB)")
        assert name == "pair-panda.glb"
        scene = trimesh.load_scene(io.BytesIO(content), file_type="glb", process=False)
        for link in ("pair/right_tool0", "panda/tool0"):
            x, up, y = scene.graph[link][0][:3, 3]  # y is up in glTF
            assert np.abs(np.subtract((x, -y, up), poses[names.index(link)].translation)).max() < 1e-6
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            page.locator(f"html[data-look={scheme}]").wait_for()
            assert tab.serious() == []
        tab.switch_layers("common normals")
        drawn = Counter(stroke.field for stroke in view.drawing.normals(view.q))
        page.wait_for_function(
            "count => document.querySelector('.arm-view').scene.children[1].children.length === count",
            arg=drawn.total(),
        )
        assert drawn["line"] == 12 + 9, "of a cell its moving joints, of a table its z axes"
        tab.switch_layers("common normals")
        tab.switch_layers("collision")
        script = """() => {
            let count = 0;
            document.querySelector('.arm-view').scene.traverse(part => count += part.userData.layer === 'collision' && part.visible);
            return count;
        }"""
        page.wait_for_function(f"({script})() > 10")
        page.get_by_role("button", name="at one place").click()
        page.wait_for_function(
            "document.querySelector('.arm-view').scene.getObjectByName('panda/base_link').matrixWorld.elements[13] === 0"
        )


MESHES = """<?xml version="1.0"?>
<robot name="meshes">
  <link name="base_link"><visual><geometry><mesh filename="package://arm_description/meshes/box.stl"/></geometry>
    <material name="blue"><color rgba="0 0 1 1"/></material></visual></link>
  <link name="upper"><visual><geometry><mesh filename="meshes/ball.obj" scale="2 2 2"/></geometry></visual>
    <collision><geometry><mesh filename="meshes/ball.obj"/></geometry></collision></link>
  <link name="fore"/>
  <link name="tool0"><visual><geometry><mesh filename="meshes/gone.stl"/></geometry></visual>
    <visual><geometry><mesh filename="meshes/broken.stl"/></geometry></visual>
    <visual><geometry><mesh filename="meshes/painted.dae"/></geometry><material name="blue"/></visual>
    <visual><geometry><mesh filename="meshes/square.obj"/></geometry></visual>
    <visual><geometry><mesh filename="meshes/thief.obj"/></geometry></visual></link>
  <joint name="hip" type="continuous"><parent link="base_link"/><child link="upper"/><origin xyz="0 0 0.5"/></joint>
  <joint name="knee" type="continuous"><parent link="upper"/><child link="fore"/><origin xyz="0 0 0.5"/></joint>
  <joint name="end" type="fixed"><parent link="fore"/><child link="tool0"/><origin xyz="0.4 0 0.3"/></joint>
</robot>
"""


COLOURS = """() => {
    const found = [];
    document.querySelector('.arm-view').scene.traverse(part => {
        if (part.isMesh && part.geometry.attributes.normal?.itemSize === 4) found.push(`#${part.material.color.getHexString()}`);
    });
    return found;
}"""


def test_meshes_are_drawn(open_view: Callable[..., Any], tmp_path: Path) -> None:
    """The files that a description names, from its package or beside it, and nothing else; what is missing is named."""
    package = tmp_path / "arm_description"
    (package / "meshes").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>arm_description</name></package>")
    trimesh.creation.box((0.2, 0.2, 0.1)).export(package / "meshes" / "box.stl")
    trimesh.creation.icosphere(subdivisions=2, radius=0.05).export(package / "meshes" / "ball.obj")
    painted = trimesh.creation.box((0.3, 0.3, 0.3))
    painted.visual = trimesh.visual.TextureVisuals(
        material=trimesh.visual.material.PBRMaterial(baseColorFactor=[0, 255, 0, 255])
    )
    painted.export(package / "meshes" / "painted.dae")
    Image.new("RGB", (8, 4), "red").save(package / "meshes" / "square.png")
    for name, texture in (("square", "square.png"), ("thief", "../../secret.png")):
        text = f"mtllib {name}.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\nf 1/1 2/2 3/3\n"
        (package / "meshes" / f"{name}.obj").write_text(text)
        (package / "meshes" / f"{name}.mtl").write_text(f"newmtl m\nKd 1 1 1\nmap_Kd {texture}\n")
    Image.new("RGB", (8, 4)).save(tmp_path / "secret.png")
    (package / "meshes" / "broken.stl").write_text("solid x\nendsolid x\n")
    (package / "arm.urdf").write_text(MESHES)
    with open_view(
        package / "arm.urdf", sliders=2, faults=False
    ) as tab:  # the browser complains of a file that is no mesh
        page = tab.page
        page.get_by_text("1 mesh file was not found: meshes/gone.stl").wait_for()
        page.locator(".q-notification", has_text="'broken.stl' cannot be read").wait_for()
        page.locator(".q-notification", has_text="'thief.obj' names '../../secret.png': it is outside of").wait_for()
        assert page.locator(".q-notification").count() == 1, "one notification has them all"
        tab.wait_for_triangles(300)
        asked = [url for url in tab.asked if "/meshes/" in url]
        tab.switch_layers("collision")
        page.wait_for_function(
            """() => {
                let touching = 0;
                document.querySelector('.arm-view').scene.traverse(part => touching += !!part.isMesh && part.userData.layer === 'collision');
                return touching;
            }"""
        )
        later = [url for url in tab.asked if "/meshes/" in url]
        assert (len(asked), len(later)) == (6, 7), (
            "what only the collision shapes need is asked for when they are shown"
        )
        packed = page.evaluate("async url => (await fetch(url)).headers.get('content-encoding')", asked[0])
        assert packed is None, "on one machine packing takes longer than sending"
        drawn = page.evaluate(
            """() => {
                const found = [];
                const {scene} = document.querySelector('.arm-view');
                scene.updateMatrixWorld();
                scene.traverse(part => {
                    if (!part.isMesh || !part.geometry.attributes.normal || part.geometry.attributes.normal.itemSize !== 4) return;
                    const {min, max} = part.geometry.boundingBox;
                    const [a, b] = [min, max].map(corner => corner.clone().applyMatrix4(part.matrixWorld));
                    const {map} = part.material;
                    found.push([part.userData.layer, part.visible, map ? map.image.width : '#' + part.material.color.getHexString(),
                                b.sub(a).toArray().map(x => Number(x.toFixed(3)))]);
                });
                return found;
            }"""
        )
        sizes = {(layer, shown, colour): size for layer, shown, colour, size in drawn}
        assert sizes == {
            ("links", True, "#0000ff"): [0.2, 0.2, 0.1],
            ("links", True, "#b8bdc4"): [0.2, 0.2, 0.2],
            ("links", True, 8): [1, 1, 0],  # with its texture
            ("links", True, "#ffffff"): [1, 1, 0],  # without the texture that it may not name
            ("links", True, "#00ff00"): [0.3, 0.3, 0.3],  # the file's own colour comes before that of the description
            ("collision", True, "#d93373"): [0.1, 0.1, 0.1],
        }
        answers = page.evaluate(
            "Promise.all(['meshes/nothing', 'meshes/..%2Farm.urdf', 'meshes/', 'textures/square.png', 'textures/..%2F..%2Fsecret.png',"
            " 'textures/'].map(path => fetch(path).then(a => a.status)))"
        )
        assert answers == [404] * 6
        page.get_by_role("button", name="opacity, and the colour of links without one").click()
        field = page.get_by_label("links without a colour")
        assert field.input_value() == "#b8bdc4"
        field.fill("#ff8800")
        page.wait_for_function(f"({COLOURS})().includes('#ff8800')")
        painted_ones = {"#0000ff", "#ff8800", "#ffffff", "#00ff00", "#d93373"}
        assert set(page.evaluate(COLOURS)) == painted_ones, "those that have a colour keep it"
        assert tab.foreign() == []
