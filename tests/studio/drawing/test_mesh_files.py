"""Triangles of mesh files as the page takes them, held against trimesh."""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import trimesh

from dh2urdf.errors import OutputError
from dh2urdf_studio.drawing.mesh_files import DrawnMesh, surfaces, triangles

if TYPE_CHECKING:
    from pathlib import Path

COLOURED = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.001"/><up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert>
<diffuse><color>0.2 0.4 0.6 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1000 0 0 0 2000 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="s"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="s" target="#m"/></technique_common></bind_material></instance_geometry></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


def parts(mesh: DrawnMesh) -> list[tuple[Any, Any, Any]]:
    """Colour, positions (N, 3) and normals (N, 3) of the corners of all triangles, for each part."""
    content = triangles(mesh).content
    (length,) = struct.unpack_from("<I", content)
    assert (4 + length) % 4 == 0
    at, found = 4 + length, []
    for part in json.loads(content[4:at])["parts"]:
        count, corners = part["vertices"], part["corners"]
        positions = np.frombuffer(content, "<f4", 3 * count, at).reshape(-1, 3)
        normals = np.frombuffer(content, np.int8, 4 * count, at + 12 * count).reshape(-1, 4)[:, :3] / 127
        numbers = np.frombuffer(content, "<u4", corners, at + 16 * count)
        assert set(numbers.tolist()) == set(range(count)), "no corner is sent that no triangle has"
        found.append((part["rgba"], positions[numbers], normals[numbers]))
        at += 16 * count + 4 * corners
    assert at == len(content)
    return found


def written(folder: Path, name: str, mesh: Any) -> Path:
    path = folder / name
    mesh.export(path)
    return path


@pytest.mark.parametrize("name", ["box.stl", "box.obj", "box.glb"])
def test_a_box_has_edges(tmp_path: Path, name: str) -> None:
    """Every corner has the normal of its face; glTF has y up."""
    box = trimesh.creation.box((0.1, 0.2, 0.3))
    ((_, positions, normals),) = parts(DrawnMesh(path=written(tmp_path, name, box), scale=(2.0, 1.0, 1.0)))
    sizes = (0.2, 0.3, 0.2) if name.endswith("glb") else (0.2, 0.2, 0.3)
    assert np.ptp(positions, axis=0) == pytest.approx(sizes, abs=1e-6)
    assert len(positions) == 36
    flat = np.cross(positions[1::3] - positions[::3], positions[2::3] - positions[::3])
    flat /= np.linalg.norm(flat, axis=1)[:, None]
    assert np.abs(normals - np.repeat(flat, 3, axis=0)).max() < 0.01


def test_a_ball_is_smooth(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.5)
    ((_, positions, normals),) = parts(DrawnMesh(path=written(tmp_path, "ball.stl", ball)))
    assert np.abs(normals - positions / 0.5).max() < 0.03


@pytest.mark.parametrize(("name", "count"), [("box.stl", 24), ("ball.stl", 642)])
def test_corners_that_are_alike_are_one(tmp_path: Path, name: str, count: int) -> None:
    """A box has three normals at each of its corners, a ball one."""
    shape = trimesh.creation.box((1, 1, 1)) if name == "box.stl" else trimesh.creation.icosphere(subdivisions=3)
    ((_, surface),) = surfaces(DrawnMesh(path=written(tmp_path, name, shape)))
    assert (len(surface.positions), surface.faces.shape) == (count, shape.faces.shape)


@pytest.mark.parametrize(("as_in_ros", "sizes"), [(True, (1, 2, 0)), (False, (1, 0, 2))])
def test_the_unit_the_axis_up_and_the_colour_of_collada(
    tmp_path: Path, sizes: tuple[int, ...], *, as_in_ros: bool
) -> None:
    path = tmp_path / "plate.dae"
    path.write_text(COLOURED)
    ((rgba, positions, _),) = parts(DrawnMesh(path=path, as_in_ros=as_in_ros))
    assert np.ptp(positions, axis=0) == pytest.approx(sizes, abs=1e-6)
    assert rgba == pytest.approx([0.2, 0.4, 0.6, 1.0], abs=0.003)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("empty.stl", b"solid x\nendsolid x\n", "cannot be read"),
        ("zip.stl", b"PK\x03\x04", "ZIP archive"),
        ("arm.dae", b"<COLLADA", "cannot be read"),
    ],
)
def test_what_is_no_mesh(tmp_path: Path, name: str, content: bytes, message: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(OutputError, match=message):
        triangles(DrawnMesh(path=tmp_path / name))


def test_a_file_that_has_gone(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"gone\.stl' cannot be read: No such file"):
        triangles(DrawnMesh(path=tmp_path / "gone.stl"))
