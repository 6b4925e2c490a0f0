"""Triangles and textures of mesh files as the page takes them, held against trimesh; each file is read once."""

import importlib
import io
import json
import os
import struct
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image
from textured_square import DAE, MTL, OBJ

from dh2urdf.errors import OutputError
from dh2urdf.isolation import Child
from dh2urdf.plugin_system import Catalog
from dh2urdf_studio.drawing import mesh_files
from dh2urdf_studio.drawing.exports import glb
from dh2urdf_studio.drawing.mesh_files import DrawnMesh, MeshStore, triangles
from dh2urdf_studio.viewing import View, load_figures


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


@pytest.mark.parametrize(("as_in_ros", "sizes"), [(True, (1, 1, 0)), (False, (1, 0, 1))])
def test_the_unit_the_axis_up_and_the_colour_of_collada(
    tmp_path: Path, sizes: tuple[int, ...], *, as_in_ros: bool
) -> None:
    path = tmp_path / "plate.dae"
    coloured = DAE.replace('<texture texture="m" texcoord="UV"/>', "<color>0.2 0.4 0.6 1</color>")
    path.write_text(coloured.replace("<up_axis>Z_UP</up_axis>", '<unit meter="0.001"/><up_axis>Y_UP</up_axis>'))
    ((rgba, positions, _),) = parts(DrawnMesh(path=path, as_in_ros=as_in_ros))
    assert 1000 * np.ptp(positions, axis=0) == pytest.approx(sizes, abs=1e-6)
    assert rgba == pytest.approx([0.2, 0.4, 0.6, 1.0], abs=0.003)


@pytest.mark.parametrize("content", [b"solid x\nendsolid x\n", b"PK\x03\x04", b"<COLLADA", None])
@pytest.mark.parametrize("suffix", ["stl", "dae"])
def test_what_is_no_mesh(tmp_path: Path, suffix: str, content: bytes | None) -> None:
    path = tmp_path / f"arm.{suffix}"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(OutputError, match=path.name):
        triangles(DrawnMesh(path=path))


# --- Textures ---------------------------------------------------------------------------------------------------------

COLOURS = {(0, 0): (255, 0, 0), (1, 0): (0, 255, 0), (0, 1): (0, 0, 255), (1, 1): (255, 255, 0)}
"""Colours at the corners of a square, by x and y."""


def picture() -> Image.Image:
    image = Image.new("RGB", (4, 4))
    for (x, y), colour in COLOURS.items():
        image.paste(colour, (2 * x, 2 * (1 - y), 2 * x + 2, 2 * (1 - y) + 2))  # rows go down
    return image


def square(folder: Path, name: str, texture: str = "square.png") -> Path:
    """A square in x and y with the colours at its corners; of a glTF, whose y is up, in x and z."""
    path = folder / name
    if not (folder / "square.png").exists():
        for suffix in ("png", "tga"):
            picture().save(folder / f"square.{suffix}")
    if path.suffix == ".obj":
        path.write_text(OBJ)
        path.with_suffix(".mtl").write_text(MTL.format(texture))
    elif path.suffix == ".dae":
        path.write_text(DAE.format(texture))
    else:
        trimesh.load(square(folder, "square.obj"), process=False).export(path)
    return path


def colours_at(uv: Any, image: Image.Image) -> Any:
    size = np.array(image.size)
    column, row = (np.asarray(uv) * (1, -1) + (0, 1)).__mul__(size).astype(int).T
    return np.asarray(image.convert("RGB"))[row, column]


@pytest.mark.parametrize(
    ("name", "texture"), [("square.obj", "square.png"), ("square.dae", "./square.tga"), ("square.glb", "")]
)
def test_every_corner_has_its_place_in_the_picture(tmp_path: Path, name: str, texture: str) -> None:
    """OBJ with MTL, COLLADA and glTF; a TGA, which browsers do not show, becomes a PNG; a mirror keeps places."""
    mesh = DrawnMesh(path=square(tmp_path, name, texture), scale=(-1.0, 1.0, 1.0), as_in_ros=True)
    content, pictures = triangles(mesh)
    (length,) = struct.unpack_from("<I", content)
    header = json.loads(content[4 : 4 + length])
    ((key, shown),) = pictures.items()
    (part,) = header["parts"]
    assert (part["texture"], header["unread"]) == (key, [])
    assert shown.media_type == "image/png"
    count, corners = part["vertices"], part["corners"]
    at = 4 + length
    positions = np.frombuffer(content, "<f4", 3 * count, at).reshape(-1, 3)
    uv = np.frombuffer(content, "<f4", 2 * count, at + 16 * count).reshape(-1, 2)
    assert len(content) == at + 24 * count + 4 * corners
    up = 2 if name.endswith("glb") else 1
    expected = [COLOURS[round(-x), round(y)] for x, y in positions[:, [0, up]]]
    assert (colours_at(uv, Image.open(io.BytesIO(shown.content))) == expected).all()
    store = MeshStore({"key": mesh})
    assert store.picture(key) is None, "nobody has got the mesh"
    store.triangles("key").result()
    assert store.picture(key) == shown
    store.close()


def test_the_scene_as_gltf_has_textures(tmp_path: Path, catalog: Catalog) -> None:
    square(tmp_path, "square.obj")
    robot = tmp_path / "square.urdf"
    shape = '<geometry><mesh filename="square.obj"/></geometry>'
    robot.write_text(f"<robot name='s'><link name='l'><visual>{shape}</visual></link></robot>")
    view = View(load_figures([robot], catalog))
    scene = trimesh.load_scene(io.BytesIO(glb(view.drawing, view.q, {"links"}, "s")), file_type="glb", process=False)
    (mesh,) = scene.geometry.values()
    assert len(mesh.vertices) == 4, "corners that are alike are there once"
    expected = [COLOURS[round(x), round(y)] for x, y in mesh.vertices[:, :2]]
    assert (colours_at(mesh.visual.uv, mesh.visual.material.baseColorTexture) == expected).all()


@pytest.mark.parametrize(
    ("texture", "message"),
    [
        ("../secret.png", "outside of the folder"),
        ("%2e%2e/secret.png", "outside of the folder"),
        ("..\\secret.png", "outside of the folder"),
        ("{folder}/secret.png", "outside of the folder"),
        ("file://{folder}/secret.png", "outside of the folder"),
        ("link.png", "outside of the folder"),
        ("http://127.0.0.1/secret.png", "no file"),
        ("notes.txt", "suffix"),
        ("gone.png", "no such file"),
        ("folder.png", "no such file"),
        ("large.png", "larger than 1 MB"),
        ("many.png", "million pixels"),
        ("text.png", "no picture"),
    ],
)
@pytest.mark.parametrize("name", ["square.obj", "square.dae"])
def test_only_pictures_of_the_mesh_are_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, texture: str, message: str
) -> None:
    """What a mesh names outside of its folder or package is refused; the mesh is drawn without, and a message is given."""
    inner = tmp_path / "meshes"
    (inner / "folder.png").mkdir(parents=True)
    picture().save(tmp_path / "secret.png")
    (inner / "link.png").symlink_to(tmp_path / "secret.png")
    (inner / "notes.txt").write_text("secret")
    (inner / "text.png").write_text("secret")
    (inner / "large.png").write_bytes(bytes(2**20 + 1))
    picture().resize((1025, 1024)).save(inner / "many.png")
    monkeypatch.setattr(mesh_files, "LARGEST_PICTURE", 2**20)
    path = square(inner, name, texture.replace("{folder}", str(tmp_path)))
    monkeypatch.setattr(mesh_files, "LARGEST", 2**20)
    content, pictures = triangles(DrawnMesh(path=path))
    (length,) = struct.unpack_from("<I", content)
    header = json.loads(content[4 : 4 + length])
    assert (pictures, header["parts"][0]["texture"]) == ({}, None)
    assert b"secret" not in content[4 + length :]
    assert any(message in told for told in header["unread"]), header["unread"]
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    assert bool(triangles(DrawnMesh(path=path)).pictures) is (message == "outside of the folder"), "in its package"


# --- The store --------------------------------------------------------------------------------------------------------


def test_a_file_is_read_once_until_it_changes(tmp_path: Path) -> None:
    path = tmp_path / "box.stl"
    trimesh.creation.box((1.0, 1.0, 1.0)).export(path)
    mesh = DrawnMesh(path=path)
    store = MeshStore({"key": mesh})
    store.begin(["key"])
    reading = store.triangles("key")
    before = reading.result()
    assert store.triangles("key") is reading
    assert before == triangles(mesh)
    trimesh.creation.icosphere(subdivisions=1).export(path)
    os.utime(path, ns=(1, 1))
    assert store.triangles("key").result() != before
    path.unlink()
    with pytest.raises(OutputError):
        store.triangles("key").result()
    assert "key" in store
    assert "other" not in store
    store.close()


def test_a_reader_that_crashes_costs_one_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A new one reads the next file, and none is left."""
    meshes = {name: DrawnMesh(path=tmp_path / f"{name}.stl") for name in ("bad", "good")}
    for mesh in meshes.values():
        trimesh.creation.box((1.0, 1.0, 1.0)).export(mesh.path)
    readers: list[Child] = []
    monkeypatch.setattr(Child, "started", lambda: (readers.append(Child()), readers[-1])[1])
    store = MeshStore(meshes)
    with monkeypatch.context() as patch:
        (tmp_path / "aborting.py").write_text("import os\ndef read(_mesh): os.abort()\n")
        monkeypatch.syspath_prepend(tmp_path)
        patch.setattr(mesh_files, "triangles", importlib.import_module("aborting").read)
        with pytest.raises(OutputError, match=r"bad\.stl"):
            store.triangles("bad").result()
    assert store.triangles("good").result() == triangles(meshes["good"])
    store.close()
    assert [reader.is_alive() for reader in readers] == [False, False]


def test_what_is_being_read_at_the_end_is_ended_by_one_thread(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two that end one reader at once would close what the other one reads: `view` ended with a false message then."""
    os.mkfifo(tmp_path / "pipe.stl")  # nobody writes to it, so its reader waits
    ends: set[threading.Thread] = set()
    is_there = threading.Event()

    def watched() -> Child:
        child = Child()
        end = child.end
        monkeypatch.setattr(child, "end", lambda: (ends.add(threading.current_thread()), end())[1])
        is_there.set()
        return child

    monkeypatch.setattr(Child, "started", watched)
    store = MeshStore({"pipe": DrawnMesh(path=tmp_path / "pipe.stl")})
    reading = store.triangles("pipe")
    assert is_there.wait(60)
    while not store._children._busy:
        time.sleep(0.01)
    store.close()
    with pytest.raises(OutputError, match=r"pipe\.stl"):
        reading.result(60)
    assert len(ends) == 1
