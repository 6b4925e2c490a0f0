"""Mesh files: those without a mesh, their sides, and the headers of COLLADA files."""

import re
import struct
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest
from consumers import behaviours, require
from faulty_files import BOX, CYLINDER, SOUND, collada, write_meshes
from foretelling import effects_of, unforeseen

from dh2urdf.rotations import Vec3
from dh2urdf_check import meshes
from dh2urdf_check.inspection import inspect_urdf
from dh2urdf_check.meshes import read_meshes
from dh2urdf_check.rules import Outcome


def stl(*corners: tuple[float, float, float]) -> bytes:
    """An STL of the triangles between each corner, the next and the first."""
    triangles = [(corners[0], second, third) for second, third in pairwise(corners[1:])]
    packed = [struct.pack("<12fH", 0, 0, 0, *one, *two, *three, 0) for one, two, three in triangles]
    return bytes(80) + struct.pack("<I", len(triangles)) + b"".join(packed)


POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:" + 64 * b"0" + b"\nsize 12345\n"
WHOLE = stl((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1), (0.1, 0.0, 0.0))
TETRAHEDRON = b"v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
MESHES = {
    "whole.stl": WHOLE,
    "empty.stl": b"",
    "pointer.stl": POINTER,
    "cut.stl": WHOLE[:-60],
    "flat.stl": stl((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.1, 0.1, 0.0), (0.0, 0.1, 0.0)),
    "whole.obj": TETRAHEDRON,
    "empty.obj": b"",
    "pointer.obj": POINTER,
    "flat.obj": b"v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nf 1 2 3\nf 1 3 4\n",
    "whole.dae": collada().encode(),
    "empty.dae": b"",
    "cut.dae": collada()[:500].encode(),
}
"""Mesh files, of which the whole ones are right."""


@pytest.mark.long
@pytest.mark.parametrize("consumer", ["pybullet", "mujoco", "pinocchio", "drake", "ros", "gazebo"])
@pytest.mark.parametrize("instead_of", [BOX, CYLINDER], ids=["visual", "collision"])
def test_a_file_without_a_mesh_is_found(tmp_path: Path, consumer: str, instead_of: str) -> None:
    """A reader loads the description, or does not, as the findings say; PyBullet and Pinocchio say that they lose it."""
    require(consumer)
    paths = []
    # Two look into no mesh, which one file of each format shows as well.
    names = {Path(name).suffix: name for name in MESHES}.values() if consumer in {"ros", "gazebo"} else MESHES
    for name in names:
        (tmp_path / name).write_bytes(MESHES[name])
        paths.append(tmp_path / f"{name}.urdf")
        paths[-1].write_text(SOUND.replace(instead_of, f'<mesh filename="{tmp_path / name}"/>'))
    wrong, found = unforeseen(consumer, paths)
    assert wrong == []
    loses = {path.name: effects_of(path, consumer).get("unreadable-mesh") == Outcome.LOSES for path in paths}
    loaded = {path.name: behaviour for path, behaviour in zip(paths, found, strict=True) if behaviour.end == "loads"}
    if consumer == "pybullet":  # It is silent of an OBJ for collisions.
        named = [name for name in loaded if instead_of == BOX or ".obj" not in name]
        assert {name: "cannot extract" in loaded[name].printed for name in named} == {
            name: loses[name] for name in named
        }
    if consumer == "pinocchio" and instead_of == BOX:
        for path in paths:
            loses[path.name] |= effects_of(path, consumer).get("unreadable-mesh") == Outcome.LOSES
        assert {name: "geometry" in each.extra for name, each in loaded.items()} == loses


def test_real_meshes_are_not_said_to_be_none() -> None:
    """Of the meshes that come with the simulators."""
    pybullet_data = pytest.importorskip("pybullet_data")
    paths = [path for path in Path(pybullet_data.getDataPath()).rglob("*") if path.suffix in {".stl", ".obj", ".dae"}]
    read = read_meshes(paths[:300])
    assert len(read) > 100
    assert [path.name for path, file in read.items() if file.problem or file.header] == []


# --- Sizes and headers -------------------------------------------------------------------------------------------------


def sides_of(path: Path) -> Vec3 | None:
    file = read_meshes([path]).get(path)
    if file is None or file.sides is None:
        return None
    x, y, z = file.sides
    return file.unit * x, file.unit * y, file.unit * z


CORNERS = "0 0 0 100 0 0 0 200 0 0 0 300"
ASSET = '<asset><unit meter="{}"/><up_axis>Z_UP</up_axis></asset>'


@pytest.mark.parametrize(
    ("unit", "steps", "sides"),
    [("0.5", "", (50, 100, 150)), ("1", "<matrix>0 1 0 9 2 0 0 9 0 0 1 9 0 0 0 1</matrix>", (200, 200, 300))],
)
def test_a_collada_file_is_read_with_its_unit_and_transforms(
    tmp_path: Path, unit: str, steps: str, sides: tuple[float, ...]
) -> None:
    path = tmp_path / "part.dae"
    path.write_text(collada(ASSET.format(unit), CORNERS, steps))
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
    "nowhere.dae": collada().replace('source="#p"', 'source="#q"').encode(),
    "other.glb": b"glTF",
}


@pytest.mark.parametrize("name", NO_MESHES)
def test_what_cannot_be_read_has_no_sides(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(NO_MESHES[name])
    assert sides_of(path) is None


def test_a_large_file_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_meshes(tmp_path)
    monkeypatch.setattr(meshes, "LARGEST", 10)
    assert sides_of(tmp_path / "part.obj") is None


HEADERS = {
    '<unit meter="0.001"/><up_axis>Z_UP</up_axis>': True,
    "<up_axis>Y_UP</up_axis>": True,
    '<unit name="m"/><up_axis>Z_UP</up_axis>': False,
    "<unit/><up_axis>Z_UP</up_axis>": False,
    '<unit meter="1"/><up_axis/>': False,
    "no asset": False,
}
"""What is in the `<asset>` of a COLLADA file, and whether PyBullet survives it."""


def test_the_headers_that_end_pybullet_are_found(tmp_path: Path) -> None:
    """And no other: PyBullet is asked of each."""
    write_meshes(tmp_path)
    whole = re.sub("<asset>.*</asset>", "%s", (tmp_path / "unit.dae").read_text())
    paths = []
    for number, header in enumerate(HEADERS):
        asset = "" if header == "no asset" else f"<asset>{header}</asset>"
        (tmp_path / f"{number}.dae").write_text(whole % asset)
        paths.append(tmp_path / f"{number}.urdf")
        paths[-1].write_text(SOUND.replace(BOX, f'<mesh filename="{number}.dae"/>'))
    found = [{finding.rule for finding in inspect_urdf(path).findings} for path in paths]
    assert ["hollow-mesh" not in rules for rules in found] == [*HEADERS.values()]
    assert ["collada-unit" in rules for rules in found] == [True] + 5 * [False]
    require("pybullet")
    assert [each.end == "loads" for each in behaviours("pybullet", paths)] == [*HEADERS.values()]


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
    assert ["120 m" in message for message in rule_of(tmp_path, whole)] == [True]
    assert rule_of(tmp_path, scaled) == []
    twice = rule_of(tmp_path, whole, lambda text: text.replace('<cylinder radius="0.02" length="0.05"/>', whole))
    assert len(twice) == 1
    ground = f'<robot name="a"><link name="b"><visual><geometry>{whole}</geometry></visual></link></robot>'
    assert rule_of(tmp_path, whole, lambda _: ground) == []
