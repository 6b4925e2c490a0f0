"""Files without a mesh, and texts that only some readers take for a number: each reader does with them what is found."""

from __future__ import annotations

import re
import struct
from itertools import pairwise
from pathlib import Path

import pytest
from consumers import require
from faulty_files import BOX, CYLINDER, ELBOW_LIMIT, LINK_2_BODY, LINK_2_INERTIA, SOUND, collada, write_meshes
from foretelling import effects_of, unforeseen

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


BASE = SOUND.replace(CYLINDER, '<mesh filename="part.obj" scale="1 1 1"/>').replace(
    LINK_2_BODY, f'{LINK_2_BODY}<collision><geometry><cylinder radius="0.02" length="0.05"/></geometry></collision>'
)
BASE = BASE.replace(ELBOW_LIMIT, f'{ELBOW_LIMIT}<dynamics damping="1" friction="0"/>')
SCALES = ("2", "2 ", "2x", "2x 1 1", "0x10", "0x10 1 1", "1 1 0x10", "1e-9 1 1", "1e-8 1 1", "2,2,2", "2 2 2x", "0 1 1")


def with_odd_numbers() -> list[str]:
    """The sound description, each time with another number of it in a form that not all readers take."""
    texts = [BASE.replace('scale="1 1 1"', f'scale="{scale}"') for scale in SCALES]
    for match in re.finditer(r' (value|i[xyz]{2}|xyz|rpy|size|lower|upper|velocity|damping)="([-0-9. ]+)"', BASE):
        words = match[2].split()
        for odd in ("nan", "-inf", "0x10", "-0x10", "0x.8", "0x0", "NaN(1)", "1e5x", "-3x"):
            text = " ".join([*words[:-1], odd])
            texts.append(BASE[: match.start(2)] + text + BASE[match.end(2) :])
    mass, impossible = '<mass value="1"/>', LINK_2_INERTIA.replace("0.005", "-1")
    no_body = [
        BASE.replace(LINK_2_INERTIA, impossible),
        BASE.replace(LINK_2_INERTIA, LINK_2_INERTIA.replace("0.007", "7")),
    ]
    texts += [text.replace(mass, '<mass value="inf"/>') for text in no_body]
    return [*texts, BASE.replace(mass, '<mass value="0x1p9999"/>')]


@pytest.mark.long
@pytest.mark.parametrize("consumer", ["mujoco", "drake"])
def test_what_a_reader_makes_of_an_odd_number_is_foreseen(tmp_path: Path, consumer: str) -> None:
    """MuJoCo reads nan, inf and 0x10, Drake what the text begins with: and refuses what cannot be a body or an axis."""
    require(consumer)
    write_meshes(tmp_path)
    paths = []
    for number, text in enumerate(with_odd_numbers()[::12]):
        paths.append(tmp_path / f"{number}.urdf")
        paths[-1].write_text(text)
    assert unforeseen(consumer, paths)[0] == []
