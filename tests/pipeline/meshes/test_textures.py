"""Pictures that meshes of attachments name are copied with them, and nothing but pictures is."""

from __future__ import annotations

import io
import struct
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from lxml import etree
from textured_square import DAE, MTL, OBJ

import dh2urdf
from dh2urdf.meshes.addresses import NamedFiles
from dh2urdf.meshes.files import copy_name, find_mesh, read_mesh
from dh2urdf.meshes.named_files import with_named_files
from dh2urdf.meshes.textures import is_picture

if TYPE_CHECKING:
    from collections.abc import Callable

TABLE = "# convention: standard\nname, a, alpha, d\none, 0.4, pi/2, 0.1\ntwo, 0.3, 0, 0\n"
PART = '<robot name="p"><link name="p"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>'
MATERIALS = f"# a comment\nKa 0.1 0.1 0.1\nillum 2\n{MTL}map_Bump -bm 0.5 {{}}\nsecret: 42\n"
GREEN = (30, 180, 60)


def picture(form: str = "PNG", colour: tuple[int, int, int] = GREEN) -> bytes:
    image = pytest.importorskip("PIL.Image")
    content = io.BytesIO()
    image.new("RGB", (8, 4), colour).save(content, form)
    return content.getvalue()


@pytest.fixture(name="convert")
def _convert(tmp_path: Path) -> Callable[..., list[str]]:
    """Writes an arm with a part in the folder `out`, and returns the notices."""
    (tmp_path / "part" / "meshes" / "maps").mkdir(parents=True)

    def convert(mesh: str = "meshes/body.obj", *, to: str = "out/arm.urdf", **options: Any) -> list[str]:
        (tmp_path / "part" / "part.urdf").write_text(PART.format(mesh), "utf-8")
        edit = {"attach": {"file": str(tmp_path / "part" / "part.urdf"), "name": "part"}}
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            dh2urdf.convert(dh2urdf.read(TABLE), tmp_path / to, edits=[edit], **options)
        return [str(each.message) for each in told]

    return convert


def test_an_obj_finds_its_picture_through_its_materials(tmp_path: Path, convert: Callable[..., list[str]]) -> None:
    """trimesh and PyBullet find it beside the copy; the copy of the materials has their statements alone."""
    meshes = tmp_path / "part" / "meshes"
    (meshes / "body.obj").write_text(OBJ.replace("square", "the body"), "utf-8")
    (meshes / "the body.mtl").write_text(MATERIALS.format(*["maps/skin colour.png"] * 2), "utf-8")
    (meshes / "maps" / "skin colour.png").write_bytes(picture())
    assert convert() == []
    names = sorted(path.name for path in (tmp_path / "out" / "meshes").iterdir())
    (obj,) = [name for name in names if name.endswith(".obj")]
    (mtl,) = [name for name in names if name.endswith(".mtl")]
    (png,) = [name for name in names if name.endswith(".png")]
    assert len(names) == 3
    assert (tmp_path / "out" / "meshes" / png).read_bytes() == picture()
    lines = (tmp_path / "out" / "meshes" / mtl).read_text("utf-8").splitlines()
    painted = ["newmtl painted", "Kd 1 1 1", f"map_Kd {png}", f"map_Bump -bm 0.5 {png}"]
    assert lines == ["Ka 0.1 0.1 0.1", "illum 2", *painted]
    trimesh = pytest.importorskip("trimesh")
    found = trimesh.load(tmp_path / "out" / "meshes" / obj, force="mesh", process=False)
    assert found.visual.material.image.convert("RGB").getpixel((0, 0)) == GREEN
    assert len(found.faces) == 2


def test_pybullet_shows_it(tmp_path: Path, convert: Callable[..., list[str]]) -> None:
    bullet = pytest.importorskip("pybullet")
    meshes = tmp_path / "part" / "meshes"
    (meshes / "body.obj").write_text(OBJ.replace("square", "body"), "utf-8")
    (meshes / "body.mtl").write_text(MTL.format("maps/skin.png"), "utf-8")
    (meshes / "maps" / "skin.png").write_bytes(picture())
    convert()
    client = bullet.connect(bullet.DIRECT)
    try:
        body = bullet.loadURDF(str(tmp_path / "out" / "arm.urdf"), useFixedBase=True)
        flag = bullet.VISUAL_SHAPE_DATA_TEXTURE_UNIQUE_IDS
        shapes = [each for each in bullet.getVisualShapeData(body, flag) if each[4].endswith(b".obj")]
        assert [each[8] >= 0 for each in shapes] == [True]
    finally:
        bullet.disconnect(client)


@pytest.mark.parametrize("form", ["PNG", "JPEG", "BMP", "TGA"])
def test_a_collada_file_finds_its_picture(form: str, tmp_path: Path, convert: Callable[..., list[str]]) -> None:
    """Of any of these forms, with a name that XML escapes; the image of the surface keeps its name."""
    name = f"maps/skin &amp; bone.{form.lower()}"
    meshes = tmp_path / "part" / "meshes"
    (meshes / "body.dae").write_bytes(DAE.format(name).encode())
    (meshes / name.replace("&amp;", "&")).write_bytes(picture(form))
    assert convert("meshes/body.dae") == []
    trimesh = pytest.importorskip("trimesh")
    (dae,) = (tmp_path / "out" / "meshes").glob("*.dae")
    found = trimesh.load(dae, force="mesh")
    image = found.visual.material.baseColorTexture.convert("RGB")
    assert image.size == (8, 4)
    assert np.abs(np.array(image.getpixel((0, 0))) - GREEN).max() <= 3
    assert len([*(tmp_path / "out" / "meshes").iterdir()]) == 2


@pytest.mark.parametrize("emitter", ["urdf", "ros2"])
def test_runs_and_packages_have_it_beside_the_mesh(
    emitter: str, tmp_path: Path, convert: Callable[..., list[str]]
) -> None:
    """With the names of the manifest; what was made stays what it is when the run resumes."""
    meshes = tmp_path / "part" / "meshes"
    (meshes / "body.obj").write_text(OBJ.replace("square", "body"), "utf-8")
    (meshes / "body.mtl").write_text(MTL.format("maps/skin.png"), "utf-8")
    (meshes / "maps" / "skin.png").write_bytes(picture())
    convert()
    (tmp_path / "arm.csv").write_text(TABLE, "utf-8")
    edit = {"stage": "attach", "options": {"file": str(tmp_path / "part" / "part.urdf"), "name": "part"}}
    run = {"inputs": str(tmp_path / "arm.csv"), "edits": [edit], "emitters": [emitter], "output": str(tmp_path / "run")}
    (row,) = dh2urdf.run(run)["manipulators"]
    found = {path.suffix: path for path in (tmp_path / "run").rglob("*") if path.suffix in {".obj", ".mtl", ".png"}}
    assert len({path.parent for path in found.values()}) == 1
    assert found[".mtl"].name in found[".obj"].read_text("utf-8")
    assert found[".png"].name in found[".mtl"].read_text("utf-8")
    if emitter == "urdf":
        assert {Path(each["path"]).name for each in row["meshes"]} == {path.name for path in found.values()}
        dh2urdf.run(run, resume=True)
        (meshes / "maps" / "skin.png").write_bytes(picture(colour=(1, 2, 3)))
        (again,) = dh2urdf.run(run, resume=True)["manipulators"]
        assert again["key"] != row["key"]


@pytest.mark.parametrize("kind", ["absolute", "above", "address", "link", "none", "huge", "text", "mtl"])
def test_what_is_elsewhere_or_no_picture_is_not_copied(
    kind: str, tmp_path: Path, convert: Callable[..., list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A notice names it; the mesh is copied as it is."""
    meshes, outside = tmp_path / "part" / "meshes", tmp_path / "outside.png"
    outside.write_bytes(picture())
    names = {"absolute": str(outside), "above": "../../outside.png", "address": "https://a.example/skin.png"}
    name = names.get(kind, "skin.png")
    if kind == "link":
        (meshes / name).symlink_to(outside)
    elif kind == "text":
        (meshes / name).write_text("root:x:0:0:root", "utf-8")
    elif kind == "huge":
        (meshes / name).write_bytes(picture())
        monkeypatch.setattr("dh2urdf.cells.attachments.LARGEST_PICTURE", 10)
    (meshes / "body.dae").write_bytes(DAE.format(name).encode())
    mesh = "meshes/body.dae"
    if kind == "mtl":
        mesh = "meshes/body.obj"
        (tmp_path / "secret.mtl").write_text("newmtl secret\n", "utf-8")
        (meshes / "body.obj").write_text(OBJ.replace("square.mtl", "../../secret.mtl"), "utf-8")
    (told,) = convert(mesh)
    reasons = {"address": "an address", "none": "no such file", "huge": "larger than", "text": "no picture"}
    assert f"which is not copied: it is {reasons.get(kind, 'outside')}" in told.replace("there is no", "it is no")
    (copy,) = (tmp_path / "out" / "meshes").iterdir()
    assert copy.read_bytes() == (tmp_path / "part" / mesh).read_bytes()


TEXTURED = """<robot name="p"><material name="skin"><texture filename="package://hands/skin.png"/></material>
<material name="worn"><color rgba="1 0.5 0 1"/><texture filename="{}"/></material><link name="p">
<visual><geometry><box size="1 1 1"/></geometry><material name="skin"/></visual>
<visual><geometry><mesh filename="meshes/body.obj"/></geometry><material name="worn"/></visual></link></robot>"""


@pytest.mark.parametrize("suffix", ["urdf", "urdf.xacro", "sdf", "xml"])
def test_a_texture_of_a_material_is_copied(suffix: str, tmp_path: Path) -> None:
    """For URDF and xacro, where yourdfpy finds it; one that is elsewhere is left out of all, with its colour in place."""
    part = tmp_path / "hands"
    (part / "meshes").mkdir(parents=True)
    (part / "package.xml").write_text("<package><name>hands</name></package>", "utf-8")
    (part / "meshes" / "body.obj").write_text(OBJ.replace("mtllib square.mtl\n", ""), "utf-8")
    for path in (part / "skin.png", tmp_path / "outside.png"):
        path.write_bytes(picture())
    (part / "part.urdf").write_text(TEXTURED.format("../outside.png"), "utf-8")
    edit = {"attach": {"file": str(part / "part.urdf"), "name": "part"}}
    path = tmp_path / "out" / f"arm.{suffix}"
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        dh2urdf.convert(dh2urdf.read(TABLE), path, edits=[edit])
    told = " ".join(str(each.message) for each in caught)
    assert "the texture '../outside.png' of a material is left out: it is outside" in told
    assert ("elements texture (1)" in told) is (suffix in {"sdf", "xml"})
    if suffix not in {"urdf", "urdf.xacro"}:
        return
    content = path.read_bytes()
    if suffix != "urdf":
        content = pytest.importorskip("xacro").process_file(str(path)).toxml().encode()
    root = etree.fromstring(content)
    found = {each.get("name"): each for each in root.iterfind("material") if each.get("name").startswith("part_")}
    assert found["part_worn"].find("texture") is None
    assert found["part_worn"].find("color").get("rgba") == "1 0.5 0 1"
    address = found["part_skin"].find("texture").get("filename")
    assert (path.parent / address).read_bytes() == picture()
    (path.parent / "read.urdf").write_bytes(content)
    read = pytest.importorskip("yourdfpy").URDF.load(path.parent / "read.urdf", load_meshes=False).robot
    shown = {each.name: each.texture and each.texture.filename for each in read.materials if each.name in found}
    assert shown == {"part_skin": address, "part_worn": None}


def test_without_copies_all_is_named_where_it_is(tmp_path: Path, convert: Callable[..., list[str]]) -> None:
    (tmp_path / "part" / "meshes" / "body.obj").write_text(OBJ.replace("mtllib square.mtl\n", ""), "utf-8")
    convert(to="arm.urdf", meshes="file")
    (mesh,) = etree.parse(str(tmp_path / "arm.urdf")).iterfind("link/visual/geometry/mesh")
    assert mesh.get("filename") == f"file://{tmp_path / 'part' / 'meshes' / 'body.obj'}"


def test_a_conversion_says_that_pictures_are_lost(tmp_path: Path, convert: Callable[..., list[str]]) -> None:
    (tmp_path / "part" / "meshes" / "body.dae").write_text(DAE.format("skin.png"), "utf-8")
    (tmp_path / "part" / "meshes" / "skin.png").write_bytes(picture())
    (told,) = convert("meshes/body.dae", convert_meshes="auto")
    assert "the conversion of the mesh 'body.dae' leaves its pictures out" in told
    assert [path.suffix for path in (tmp_path / "out" / "meshes").iterdir()] == [".obj"]


def test_a_package_of_the_mesh_is_no_elsewhere(tmp_path: Path) -> None:
    """A folder beside that of the mesh, in the package of both; of a package that is given, too."""
    meshes, textures = tmp_path / "hands" / "meshes", tmp_path / "hands" / "textures"
    meshes.mkdir(parents=True)
    textures.mkdir()
    (textures / "skin.png").write_bytes(picture())
    (meshes / "body.dae").write_bytes(DAE.format("../textures/skin.png").encode())
    (tmp_path / "hands" / "package.xml").touch()
    mesh = find_mesh("body.dae", meshes)
    for packages in ((), (tmp_path / "hands",), (tmp_path / "other",)):
        files = NamedFiles(meshes / "body.dae", 2**20, packages)
        whole = with_named_files(mesh, files)
        assert bool(whole.named) is (tmp_path / "other" not in packages)
        if whole.named:
            (skin,) = whole.named
            assert copy_name(skin).encode() in read_mesh(whole)
        (tmp_path / "hands" / "package.xml").unlink(missing_ok=True)


@pytest.mark.parametrize("form", ["PNG", "JPEG", "BMP", "TGA"])
def test_pictures_are_known_by_their_content(form: str) -> None:
    content = picture(form)
    assert is_picture(content, f".{form.lower()}")
    assert not is_picture(b"root:x:0:0:root:/root:/bin/bash\n" * 9, f".{form.lower()}")
    assert not is_picture(b"", f".{form.lower()}")
    header = struct.pack("<BBBHHBHHHHBB", 0, 0, 2, 0, 0, 0, 0, 0, 8, 4, 24, 0)
    assert is_picture(header + bytes(8 * 4 * 3), ".tga")
    assert not is_picture(header, ".tga")


@pytest.mark.parametrize(
    "content",
    [
        b"<image " * 200_000,
        b"<image><init_from>" + b" " * 1_000_000 + b"</image>",
        b"mtllib " + b" " * 1_000_000 + b"x",
    ],
)
def test_hostile_texts_take_no_time(content: bytes, tmp_path: Path) -> None:
    """Whatever a mesh says, it is read from front to back."""
    for suffix in (".dae", ".obj"):
        path = tmp_path / f"mesh{suffix}"
        path.write_bytes(content)
        mesh = with_named_files(find_mesh(path.name, tmp_path), NamedFiles(path, 2**20))
        assert not mesh.named
