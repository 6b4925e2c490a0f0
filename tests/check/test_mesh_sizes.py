"""Sides of mesh files against those that trimesh reads, and files that are no meshes."""

from __future__ import annotations

import importlib.metadata
import re
import struct
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from faulty_files import BOX, SOUND, write_meshes

from dh2urdf_check.document import mesh_sizes
from dh2urdf_check.document.mesh_sizes import read_mesh
from dh2urdf_check.inspection import inspect_urdf

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.rotations import Vec3


def sides_of(path: Path) -> Vec3 | None:
    file = read_mesh(path)
    return file.sides if file else None


COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit meter="{unit}"/><up_axis>Z_UP</up_axis></asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="p"><float_array id="a" count="12">0 0 0 100 0 0 0 200 0 0 0 300</float_array>
      <technique_common><accessor source="#a" count="4" stride="3"/></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="s"><node>{steps}<instance_geometry url="#g"/></node></visual_scene>
  </library_visual_scenes>
</COLLADA>
"""


@pytest.mark.parametrize(
    ("unit", "steps", "sides"),
    [
        ("0.001", "", (0.1, 0.2, 0.3)),
        ("1", "<matrix>0 1 0 9 2 0 0 9 0 0 1 9 0 0 0 1</matrix>", (200, 200, 300)),
    ],
)
def test_a_collada_file_is_read_with_its_unit_and_transforms(
    tmp_path: Path, unit: str, steps: str, sides: tuple[float, ...]
) -> None:
    path = tmp_path / "part.dae"
    path.write_text(COLLADA.format(unit=unit, steps=steps))
    assert sides_of(path) == pytest.approx(sides)


@pytest.mark.parametrize("name", ["part.obj", "part.stl", "text.stl"])
def test_stl_and_obj_files_have_their_sides(tmp_path: Path, name: str) -> None:
    """Those of a tetrahedron with edges of 0.1, in text and in binary."""
    write_meshes(tmp_path)
    assert sides_of(tmp_path / name) == pytest.approx((0.1, 0.1, 0.1))


NO_MESHES = {
    "empty.stl": b"",
    "cut.stl": bytes(80) + struct.pack("<I", 1000) + bytes(50),
    "nan.obj": b"v nan 0 0\nv 1 1 1\n",
    "not.dae": b"hello",
    "nowhere.dae": COLLADA.format(unit="1", steps="").replace('source="#p"', 'source="#q"').encode(),
    "other.glb": b"glTF",
}


@pytest.mark.parametrize("name", NO_MESHES)
def test_what_cannot_be_read_has_no_sides(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(NO_MESHES[name])
    assert sides_of(path) is None


def test_a_large_file_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_meshes(tmp_path)
    monkeypatch.setattr(mesh_sizes, "LARGEST", 10)
    assert sides_of(tmp_path / "part.obj") is None


def test_real_meshes_have_the_sides_that_trimesh_reads() -> None:
    """Three of each format in example-robot-data and pybullet, of up to 200 kB."""
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("collada")
    paths: dict[str, list[Path]] = {".stl": [], ".obj": [], ".dae": []}
    for package in ("example-robot-data", "pybullet"):
        try:
            files = importlib.metadata.files(package) or ()
        except importlib.metadata.PackageNotFoundError:
            pytest.skip(f"{package} is not installed")
        for path in (Path(str(file.locate())) for file in files if file.suffix.lower() in paths):
            if path.is_file() and 1000 < path.stat().st_size < 200_000:
                paths[path.suffix.lower()].append(path)
    chosen = [path for found in paths.values() for path in sorted(found)[:: max(1, len(found) // 3)][:3]]
    assert len(chosen) == 9
    for path in chosen:
        sides, extents = sides_of(path), trimesh.load_scene(path, process=False).extents
        assert sides is not None
        named = re.search(rb'<unit[^>]* meter="([^"]+)"', path.read_bytes())  # trimesh does not follow it.
        unit = float(named[1]) if named and path.suffix.lower() == ".dae" else 1.0
        assert sides == pytest.approx([side * unit for side in extents], rel=1e-5)


def rule_of(folder: Path, mesh: str, change: Callable[[str], str] = lambda text: text) -> list[str]:
    path = folder / "arm.urdf"
    path.write_text(change(SOUND.replace(BOX, mesh)))
    return [finding.message for finding in inspect_urdf(path).findings if finding.rule == "length-in-millimetres"]


def test_a_mesh_in_millimetres_is_found_unless_it_is_scaled(tmp_path: Path) -> None:
    """Once for all meshes of a file; and not of a single link, which may be the ground."""
    write_meshes(tmp_path)
    text = (tmp_path / "part.obj").read_text().replace("0.1", "120")
    (tmp_path / "part.obj").write_text(text)
    whole, scaled = '<mesh filename="part.obj"/>', '<mesh filename="part.obj" scale="0.001 -0.001 0.001"/>'
    assert rule_of(tmp_path, whole) == ["the mesh 'part.obj' measures 120 m"]
    assert rule_of(tmp_path, scaled) == []
    twice = rule_of(tmp_path, whole, lambda text: text.replace('<cylinder radius="0.02" length="0.05"/>', whole))
    assert twice == ["2 meshes are too large; the first, 'part.obj' measures 120 m"]
    ground = f'<robot name="a"><link name="b"><visual><geometry>{whole}</geometry></visual></link></robot>'
    assert rule_of(tmp_path, whole, lambda _: ground) == []
