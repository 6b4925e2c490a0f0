"""Scenes as binary glTF, read again by trimesh; and frames as an animation."""

import base64
import io
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from dh2urdf.errors import OutputError
from dh2urdf.kinematics import dh_frames, link_poses
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.plugin_system import Catalog
from dh2urdf.rotations import RigidTransform
from dh2urdf_studio.drawing.exports import LARGEST, gif, glb
from dh2urdf_studio.drawing.scene import LAYERS, Drawing
from dh2urdf_studio.editing.opening import gallery_table
from dh2urdf_studio.editing.session import BOTH, Session
from dh2urdf_studio.viewing import View, load_figures

Z_UP = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def read(content: bytes) -> trimesh.Scene:
    return trimesh.load_scene(io.BytesIO(content), file_type="glb", process=False)


def json_of(content: bytes) -> dict[str, Any]:
    magic, version, length, size, kind = struct.unpack_from("<4sIII4s", content)
    assert (magic, version, length, kind) == (b"glTF", 2, len(content), b"JSON")
    return dict(json.loads(content[20 : 20 + size]))


def place(scene: trimesh.Scene, node: str) -> Any:
    """Where a node is, z up."""
    return Z_UP @ scene.graph[node][0]


def bounds(drawing: Drawing, q: Any, layers: set[str]) -> Any:
    """The box about all plain shapes, as trimesh makes them."""
    found = []
    for node, pose in zip(drawing.nodes, drawing.poses(q), strict=True):
        for part in node.parts:
            if part.layer not in layers:
                continue
            if part.shape == "box":
                body = trimesh.creation.box(part.size)
            elif part.shape == "cylinder":
                body = trimesh.creation.cylinder(part.size[0], part.size[1], sections=32)
            else:
                body = trimesh.creation.icosphere(4)
                body.apply_scale(part.size if len(part.size) > 1 else part.size[0])
            found.append(body.apply_transform(as_matrices(pose @ part.pose)).bounds)
    return np.array([np.min(found, axis=0)[0], np.max(found, axis=0)[1]])


@pytest.mark.parametrize("file", ["ur5.csv", "panda.yaml", "stanford.csv"])
def test_nodes_are_where_kinematics_has_them(catalog: Catalog, file: str) -> None:
    """Links and DH frames at a pose, to 1e-9; links are nested as joints hold them; the shapes have their extent."""
    session = Session(catalog, gallery_table(file, catalog))
    assert session.arm is not None
    arm = session.arm
    session.move({slider.name: 0.3 * number - 0.4 for number, slider in enumerate(session.sliders)})
    content = glb(session.drawing, session.joint_values(), set(LAYERS), "an arm")
    scene = read(content)
    for name, pose in link_poses(arm.robot, session.q).items():
        assert np.abs(place(scene, name) - as_matrices(pose)).max() < 1e-9
    vector = [session.q[row.joint] for row in arm.manipulator.moving_rows]
    for number, frame in enumerate(dh_frames(arm.manipulator, vector)):
        assert np.abs(place(scene, f"frame {number}") - as_matrices(frame)).max() < 1e-9
    holders = scene.graph.transforms.parents
    assert {joint.child: holders[joint.child] for joint in arm.robot.joints} == {
        joint.child: joint.parent for joint in arm.robot.joints
    }
    layers = {"links", "axes", "masses", "inertias"}
    shapes = read(glb(session.drawing, session.q, layers, "an arm"))
    found = shapes.copy().apply_transform(Z_UP).bounds
    size = session.drawing.reach
    assert np.abs(found - bounds(session.drawing, session.q, layers)).max() < 0.01 * size
    told = json_of(content)
    assert told["nodes"][0]["name"] == "an arm"
    assert len(told["meshes"]) < len(told["nodes"]) / 3, "boxes, cylinders and arrows are shared"


def test_colours_and_surfaces(catalog: Catalog) -> None:
    """Colours of sRGB become linear; what can be looked through is blended; all surfaces are closed, normals outwards."""
    session = Session(catalog, gallery_table("ur5.csv", catalog))
    session.show_variant(BOTH)
    content = glb(session.drawing, session.joint_values(), {"links", "inertias", "frames"}, "arm")
    materials = json_of(content)["materials"]
    colours = [material["pbrMetallicRoughness"]["baseColorFactor"] for material in materials]
    expected = [0.45**2.2, 0.24**2.2, 0.72**2.2, 1.0]  # the paper's variant
    assert min(np.abs(np.subtract(colour, expected)).max() for colour in colours) < 0.01
    assert {colour[3] < 1.0 for colour in colours} == {True, False}
    assert [material.get("alphaMode") == "BLEND" for material in materials] == [colour[3] < 1.0 for colour in colours]
    for mesh in read(content).geometry.values():
        welded = trimesh.Trimesh(mesh.vertices.round(6), mesh.faces, process=True, merge_norm=True)
        assert welded.is_watertight
        assert welded.volume > 0.0
        of_corners = mesh.vertex_normals[mesh.faces].mean(axis=1)
        assert (np.einsum("ij,ij->i", of_corners, mesh.face_normals)[mesh.area_faces > 1e-9] > 0.5).all()


URDF = """<?xml version="1.0"?>
<robot name="meshes">
  <link name="base"><visual><origin xyz="0 0 1" rpy="0 0.3 0"/><geometry><mesh filename="ball.obj" scale="2 1 1"/></geometry>
    <material name="blue"><color rgba="0 0 1 0.5"/></material></visual></link>
  <link name="upper"><visual><geometry><mesh filename="ball.obj" scale="2 1 1"/></geometry></visual></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/><origin xyz="0 0 2"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""


def test_meshes_are_included(tmp_path: Path, catalog: Catalog) -> None:
    """Their triangles in metres where the visual has them, once for both links; a broken file is named."""
    ball = trimesh.creation.icosphere(3, 0.1)
    ball.export(tmp_path / "ball.obj")
    path = tmp_path / "meshes.urdf"
    path.write_text(URDF)
    view = View(load_figures([path], catalog))
    view.move({"turn": 0.7})
    content = glb(view.drawing, view.q, {"links"}, "meshes")
    told, scene = json_of(content), read(content)
    expected = as_matrices(RigidTransform.from_xyz_rpy((0.0, 0.0, 1.0), (0.0, 0.3, 0.0)))
    corners = np.asarray(ball.vertices) * (2, 1, 1) @ expected[:3, :3].T + expected[:3, 3]
    bodies = {node: scene.graph[node] for node in scene.graph.nodes_geometry}
    assert len(bodies) == 2
    found = [trimesh.transform_points(scene.geometry[name].vertices, Z_UP @ matrix) for matrix, name in bodies.values()]
    nearest = [np.linalg.norm(corners[:, None] - each[None], axis=2).min(axis=1).max() for each in found]
    assert min(nearest) < 1e-6
    assert np.abs(place(scene, "upper") - as_matrices(link_poses(view.figures[0].robot, view.q)["upper"])).max() < 1e-9
    assert len(told["bufferViews"]) == 3, "positions, normals and corners, once"
    assert sum(len(mesh.faces) for mesh in scene.geometry.values()) == 2 * len(ball.faces)
    assert all(len(mesh.vertices) < 1.1 * len(ball.vertices) for mesh in scene.geometry.values())
    (tmp_path / "ball.obj").write_text("v 1 2")
    with pytest.raises(OutputError, match=r"ball\.obj"):
        glb(view.drawing, view.q, {"links"}, "meshes")


def test_an_empty_scene() -> None:
    with pytest.raises(OutputError) as caught:
        glb(Drawing(), {}, set(LAYERS), "none")
    assert caught.value.problems[0].code == "nothing-shown"


def frame(size: tuple[int, int], colour: tuple[int, int, int], kind: str = "PNG") -> str:
    written = io.BytesIO()
    Image.new("RGB", size, colour).save(written, kind)
    return "data:image/png;base64," + base64.b64encode(written.getvalue()).decode()


def test_frames_keep_their_order_and_colours() -> None:
    colours = [(250 - 40 * number, 30 * number, 40) for number in range(6)]
    made = Image.open(io.BytesIO(gif([frame((20, 10), colour) for colour in colours])))
    for number, colour in enumerate(colours):
        made.seek(number)
        assert made.size == (20, 10)
        found = made.convert("RGB").getpixel((5, 5))
        assert isinstance(found, tuple)
        assert max(abs(one - other) for one, other in zip(found, colour, strict=True)) < 3


@pytest.mark.parametrize(
    "second",
    [
        "",
        "data:image/png;base64,!",
        "data:image/png;base64,aaaa",
        frame((9, 9), (0, 0, 0), "JPEG"),
        frame((9, 8), (0, 0, 0)),
        frame((LARGEST + 1, 2), (1, 2, 3)),
    ],
    ids=["empty", "no base64", "no picture", "a JPEG", "another size", "too large"],
)
def test_what_is_no_frame_is_refused(second: str) -> None:
    with pytest.raises(OutputError) as caught:
        gif([frame((9, 9), (1, 2, 3)), second])
    assert caught.value.problems[0].code == "frame-no-picture"
