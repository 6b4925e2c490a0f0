"""Files without a mesh, and texts that only some readers take for a number: each reader does with them what is found."""

from __future__ import annotations

import random
import re
import struct
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import pytest
from consumers import require
from faulty_files import BOX, CYLINDER, ELBOW_LIMIT, LINK_2_BODY, LINK_2_INERTIA, SOUND, write_meshes
from foretelling import effects_of, unforeseen

from dh2urdf_check.document.mesh_sizes import read_mesh
from dh2urdf_check.rules import Outcome

if TYPE_CHECKING:
    from collections.abc import Sequence


CORNERS = [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:" + 64 * b"0" + b"\nsize 12345\n"
FLAT = [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.1, 0.1, 0.0), (0.0, 0.1, 0.0)]


def stl(faces: Sequence[tuple[int, ...]], corners: Sequence[tuple[float, ...]] = CORNERS, scale: float = 1.0) -> bytes:
    triangles = [[scale * number for corner in face for number in corners[corner]] for face in faces]
    packed = [struct.pack("<12fH", 0, 0, 0, *numbers, 0) for numbers in triangles]
    return bytes(80) + struct.pack("<I", len(faces)) + b"".join(packed)


def obj(faces: Sequence[tuple[int, ...]], corners: Sequence[tuple[float, ...]] = CORNERS) -> bytes:
    lines = ["v {} {} {}".format(*corner) for corner in corners]
    return "\n".join([*lines, *("f {} {} {}".format(*(i + 1 for i in face)) for face in faces), ""]).encode()


TRIANGLES = (
    "<triangles count='4'><input semantic='VERTEX' source='#v' offset='0'/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>"
)
VERTICES = "<vertices id='v'><input semantic='POSITION' source='#p'/></vertices>"
MESH = f"""<mesh><source id='p'><float_array id='a' count='12'>0 0 0 0.1 0 0 0 0.1 0 0 0 0.1</float_array>
<technique_common><accessor source='#a' count='4' stride='3'><param name='X' type='float'/><param name='Y' type='float'/>
<param name='Z' type='float'/></accessor></technique_common></source>{VERTICES}{TRIANGLES}</mesh>"""
LIBRARY = f"<library_geometries><geometry id='g'>{MESH}</geometry></library_geometries>"
SCENES = """<library_visual_scenes><visual_scene id='s'><node><instance_geometry url='#g'/></node></visual_scene>
</library_visual_scenes>"""
SCENE = "<scene><instance_visual_scene url='#s'/></scene>"
COLLADA = f"""<?xml version='1.0'?>
<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>
<asset><unit meter='1'/><up_axis>Z_UP</up_axis></asset>{LIBRARY}{SCENES}{SCENE}</COLLADA>
"""
FURTHER = MESH.replace("'p'", "'q'").replace("'#p'", "'#q'").replace("'v'", "'w'").replace("'#v'", "'#w'")


def collada(old: str, new: str) -> bytes:
    assert old in COLLADA
    return COLLADA.replace(old, new).encode()


def further(old: str, new: str) -> bytes:
    """With a second geometry that nothing shows."""
    assert old in FURTHER
    return collada("</library_geom", f"<geometry id='h'>{FURTHER.replace(old, new)}</geometry></library_geom")


SLOPE = [(0.0, 0.0, 0.0625), (0.0625, 0.0, 0.0), (0.0, 0.0625, 0.0), (0.03125, 0.03125, 0.0)]
"""Numbers that are exact, all in one plane that is none of two coordinates."""
CROSS = [(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1), (0, -1, -1), (0, 1, -1), (0, 1, 1), (0, -1, 1)]
WALLS = [(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 6, 7)]


def larger(corners: Sequence[tuple[float, ...]], factor: float) -> list[tuple[float, ...]]:
    return [tuple(factor * number for number in corner) for corner in corners]


def with_vertex(*texts: str) -> bytes:
    """The whole OBJ with other texts for its last vertices."""
    lines = obj(FACES).decode().splitlines()
    lines[len(CORNERS) - len(texts) : len(CORNERS)] = texts
    return "\n".join([*lines, ""]).encode()


def with_normals(*normals: str) -> bytes:
    """The whole OBJ with normals, of which all its corners use the first."""
    lines = [
        re.sub(r"(\d+)", r"\1//1", line) if line.startswith("f") else line for line in obj(FACES).decode().split("\n")
    ]
    return "\n".join([*normals, *lines]).encode()


VERTICES_OF_WORDS = {
    f"vertex-{number}.obj": with_vertex(*texts)
    for number, texts in enumerate(
        [
            *(["v a b c"] * count for count in (1, 2, 3, 4)),
            *(
                [f"v {text}"]
                for text in ("x 0 0.1", "0 0", "0", "", "0,0 0,0 0,1", "0,0,0.1", "0m 0m 0.1m", "0 0 1e 0")
            ),
            *(
                [f"v {text}"]
                for text in ("0 0 0x1p-3", "0 0 .1", ". . .1", "0 0 -.1", "0 0 1d-1", "0 0 0.1f", "0 0 0.1 # z")
            ),
            *([f"v {text}"] for text in ("0 0 inf", "0 0 1e999", "0 0 nan", "0 0 -nan(ind)", "nan 0 0.1", "0 0 1e ")),
            ["v 0 0 0.1 1 0 0"],
            *(
                [f"v 0 0 0.1 {more}"]
                for more in (
                    "0",
                    "1",
                    "-1",
                    "x",
                    "0x1",
                    "1e-400",
                    "1e-40",
                    "0 # c",
                    "0#",
                    "# 0",
                    ".0",
                    "-.0",
                    "inf",
                    "1 x",
                )
            ),
            *([f"v 0 0 0.1 {more}"] for more in ("0 0", "1 0", "0 0 0", "1 0 0 0", "x 1 1", "x 0")),
            *([f"v 0 0 {z}"] for z in ("1e38", "3.5e38", "1e300", "1.7e308", "1e309", "-1e39", "0.1_0", "0_1")),
            ["v 0 0 0.1 red"],
            ["v 0 0 \\\n 0.1"],
            ["  v 0 0 0.1"],
            ["v\t0\t0\t0.1"],
            ["v  0   0  0.1  "],
            ["v 0 0 0.1", "v 0 0 0.1"],
        ]
    )
}
MARK = b"\xef\xbb\xbf"
ADDED = {
    f"added-{number}.obj": obj(FACES) + f"{line}\n".encode()
    for number, line in enumerate(
        [
            *(
                f"f 1 2 3{comment}"
                for comment in (" # comment", " #comment", "# comment", " # 4", " #", " # 9", "/1 # 9")
            ),
            *("f 1 2 # 3", "f # 1 2 3", "f 1 2 x # c", "f 1 2 3.5 # c", "f 1#2 2 3", "f 0_1 2 3", "f 1_0 2 3"),
            *("f 0 1", "f x 1", "f 0", "f 9 1", "f -9 1", "f 1 2"),
            *("l 1 2", "l 0 1", "l 1 9", "l -9 1", "l 1 x", "l 1 2 # c", "l", "l\t0 2", "l 1/9 2/9", "l 1.5 2"),
            *("p 1", "p 0", "p 9", "p x", "p 1 # c"),
            *("v 1 1 1 0", "v 0 0 1e39", "v 0 0 1e308", "v 0 0 1e15", "vn 0 0 1 # c", "vt 0 0 # c"),
        ]
    )
}
"""The whole OBJ with a line more."""
MESHES = {
    **VERTICES_OF_WORDS,
    **ADDED,
    "mark.obj": MARK + obj(FACES),
    "mark-and-comment.obj": MARK + b"# exported\n" + obj(FACES),
    "mark-and-blank.obj": MARK + b" " + obj(FACES),
    "marks.obj": MARK + MARK + obj(FACES),
    "line-first.obj": b"l 0 1\n" + obj(FACES),
    "commented-faces.obj": obj(FACES).replace(b"f 1 3 2\n", b"f 1 3 2 # a\n"),
    "far-corners.obj": with_vertex("v 1e30 0 0", "v 0 1e30 0", "v 0 0 1e30"),
    "far-plane.obj": with_vertex("v 0 1e20 0", "v 0 0 -1e20"),
    "far-line.obj": with_vertex("v 0 0 1e15", "v 0 0 -1e15"),
    "far-cube.obj": obj(FACES, [(1e15 * (10 + a), 1e16 * (1 + b), 1e16 * (1 + c)) for a, b, c in CORNERS]),
    "decimetre.obj": obj(FACES).replace(b"v 0.1", b"v 0_1"),
    "further-word.obj": obj(FACES) + b"v a b c\n",
    "slope.stl": stl([(0, 1, 2), (1, 3, 2)], SLOPE),
    "slope.obj": obj([(0, 1, 2), (1, 3, 2)], SLOPE),
    "large-slope.stl": stl([(0, 1, 2), (1, 3, 2)], SLOPE, 256),
    "large-slope.obj": obj([(0, 1, 2), (1, 3, 2)], larger(SLOPE, 256)),
    "vertices-of-a-slope.obj": obj([], SLOPE),
    "slope-and-a-vertex.obj": obj([(0, 1, 2), (1, 3, 2)], [*SLOPE, (1, 1, 1)]),
    "cross.obj": obj(WALLS, larger(CROSS, 0.0625)),
    "cross.stl": stl(WALLS, CROSS, 0.0625),
    "tilted.stl": stl(
        [(0, 1, 2), (0, 2, 3)],
        [(0.0, 0.0, 0.0), (0.0921, 0.0, -0.0389), (0.1072, 0.0955, -0.0092), (0.0151, 0.0955, 0.0297)],
    ),
    "thin.obj": obj(FACES, [*CORNERS[:3], (0.0, 0.0, 1e-11)]),
    "thinner.obj": obj(FACES, [*CORNERS[:3], (0.0, 0.0, 1e-13)]),
    "twice.obj": obj([(2 * a, 2 * b, 2 * c) for a, b, c in FACES], [each for each in CORNERS for _ in range(2)]),
    "triangle-twice.obj": obj([(0, 2, 4), (1, 3, 5)], [each for each in CORNERS[:3] for _ in range(2)]),
    "line.obj": obj([(0, 1, 2), (1, 2, 3)], [(i / 10, i / 10, i / 10) for i in range(4)]),
    "one-of-four.obj": obj(FACES[:1]),
    "inside-out.obj": obj([face[::-1] for face in FACES]),
    "small.obj": obj(FACES, larger(CORNERS, 1e-4)),
    "far.stl": stl(FACES, scale=1e20),
    "far.obj": obj(FACES, larger(CORNERS, 1e20)),
    "infinite-corner.stl": stl(FACES, [(float("inf"), 0.0, 0.0), *CORNERS[1:]]),
    "edges.obj": obj([]) + b"l 1 2\nl 2 3\n",
    "unused-normal.obj": obj(FACES) + b"vn 0 0 1\n",
    "normals-of-all.obj": with_normals("vn 0 0 1"),
    "normals-of-some.obj": with_normals("vn 0 0 1") + b"f 1 2 3\n",
    "normal-beyond.obj": with_normals("vn 0 0 1") + b"f 1//2 2//1 3//1\n",
    "normal-of-words.obj": with_normals("vn a b c"),
    "normal-of-two.obj": with_normals("vn 0 1"),
    "normal-of-points.obj": with_normals("vn .5 .5 -.5"),
    "texture-of-one.obj": obj(FACES) + b"vt 0\n",
    "texture-of-points.obj": obj(FACES) + b"vt .5 .5\n",
    "texture-of-two.obj": obj(FACES) + b"vt 0.5 -.5\n",
    "face-of-decimals.obj": obj(FACES) + b"f 1.0 2.0 3.0\n",
    "faces-after-blanks.obj": obj(FACES).replace(b"f", b"  f"),
    "vertices-after-blanks.obj": obj(FACES).replace(b"v", b"  v"),
    "whole.stl": stl(FACES),
    "empty.stl": b"",
    "none.stl": stl([]),
    "pointer.stl": POINTER,
    "words.stl": b"This is a text.\n",
    "page.stl": b"<!DOCTYPE html>\n<html><body>Not found</body></html>\n" * 4,
    "short.stl": bytes(50),
    "cut.stl": stl(FACES)[:-60],
    "longer.stl": stl(FACES) + b"\n",
    "solid.stl": b"solid part\nendsolid part\n",
    "one.stl": stl(FACES[:1]),
    "open.stl": stl(FACES[:2]),
    "flat.stl": stl([(0, 1, 2), (0, 2, 3)], FLAT),
    "speck.stl": stl(FACES, scale=1e-5),
    "infinite.stl": stl(FACES, [(float("nan"), 0.0, 0.0), *CORNERS[1:]]),
    "points.stl": stl([(i, i, i) for i in range(4)]),
    "lines.stl": stl([(0, 1, 1), (1, 2, 2), (2, 3, 3), (3, 0, 0)]),
    "with-a-point.stl": stl([*FACES, (0, 0, 0)]),
    "whole.obj": obj(FACES),
    "empty.obj": b"",
    "pointer.obj": POINTER,
    "words.obj": b"This is a text.\n",
    "comment.obj": b"# exported\no part\n",
    "vertices.obj": obj([]),
    "faces.obj": b"f 1 2 3\n",
    "one.obj": obj([(0, 1, 2)], CORNERS[:3]),
    "flat.obj": obj([(0, 1, 2), (0, 2, 3)], FLAT),
    "returns.obj": obj(FACES).replace(b"\n", b"\r"),
    "beyond.obj": obj([*FACES, (0, 1, 4)]),
    "normals.obj": obj(FACES) + b"f 1//7 2//7 3//7\nf 1/9 2/9 3/9\nf -1 -2 -3\n",
    "infinite.obj": obj(FACES).replace(b"v 0.1", b"v nan"),
    "nowhere.obj": obj(FACES, [(float("nan"),) * 3] * 4),
    "zero.obj": obj(FACES) + b"f 0 1 2\n",
    "zeros.obj": obj([(-1, -1, -1)]),
    "word.obj": obj(FACES) + b"f a b c\n",
    "backwards.obj": obj([]) + b"f -4 -2 -3\nf -4 -3 -1\nf -4 -1 -2\nf -3 -2 -1\n",
    "too-far-back.obj": obj(FACES) + b"f -5 -1 -2\n",
    "back-too-early.obj": b"v 0 0 0\nv 0.1 0 0\nf -3 -2 -1\nv 0 0.1 0\nv 0 0 0.1\n" + obj(FACES)[-32:],
    "forward.obj": b"v 0 0 0\nv 0.1 0 0\nf 1 2 3\nv 0 0.1 0\nv 0 0 0.1\n" + obj(FACES)[-32:],
    "points.obj": obj([(i, i, i) for i in range(4)]),
    "lines.obj": obj([(0, 1, 1), (1, 2, 2), (2, 3, 3), (3, 0, 0)]),
    "quads-of-lines.obj": obj([]) + b"f 1 1 2 2\nf 2 2 3 3\nf 3 3 4 4\n",
    "whole.dae": COLLADA.encode(),
    "empty.dae": b"",
    "pointer.dae": POINTER,
    "words.dae": b"This is a text.\n",
    "cut.dae": COLLADA[:500].encode(),
    "page.dae": b"<html><body/></html>",
    "bare.dae": b"<COLLADA/>",
    "declaration.dae": b"<?xml version='1.0' encoding='utf-8'?>\n",
    "comment.dae": b"<?xml version='1.0'?>\n<!-- exported -->\n<!-- twice -->",
    "type.dae": b"\xef\xbb\xbf<?xml version='1.0'?><!DOCTYPE COLLADA>",
    "blank.dae": b" \n",
    "declaration-and-words.dae": b"<?xml version='1.0'?>This is a text.",
    "half-a-declaration.dae": b"<?xml version='1.0'",
    "half-a-comment.dae": b"<!-- exported",
    "no-library.dae": collada(LIBRARY, ""),
    "no-geometry.dae": collada(LIBRARY, "<library_geometries/>"),
    "no-mesh.dae": collada(MESH, ""),
    "no-numbers.dae": collada("0 0 0 0.1 0 0 0 0.1 0 0 0 0.1</", "</"),
    "no-triangles.dae": collada(TRIANGLES, ""),
    "no-corners.dae": collada("0 2 1 0 1 3 0 3 2 1 2 3", ""),
    "no-scenes.dae": collada(SCENES + SCENE, ""),
    "no-scene.dae": collada(SCENE, ""),
    "no-instance.dae": collada("<instance_geometry url='#g'/>", ""),
    "further.dae": further("0 2 1", "0 2 1"),
    "further-without-corners.dae": further("<p>0 2 1 0 1 3 0 3 2 1 2 3</p>", ""),
    "further-without-vertices.dae": further("vertices", "verts"),
    "further-without-numbers.dae": further("0 0 0 0.1 0 0 0 0.1 0 0 0 0.1</", "</"),
    "further-without-anything.dae": further(FURTHER, "<mesh/>"),
    "further-without-faces.dae": further(TRIANGLES.replace("'#v'", "'#w'"), ""),
    "polygons.dae": collada("triangles", "polygons"),
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
            loses[path.name] |= effects_of(path, consumer).get("missing-vertex") == Outcome.LOSES
        assert {name: "geometry" in each.extra for name, each in loaded.items()} == loses


def test_real_meshes_are_not_said_to_be_none() -> None:
    """Of the meshes that come with the simulators."""
    pybullet_data = pytest.importorskip("pybullet_data")
    paths = [path for path in Path(pybullet_data.getDataPath()).rglob("*") if path.suffix in {".stl", ".obj", ".dae"}]
    read = {path: read_mesh(path) for path in paths[:300]}
    assert len(read) > 100
    assert [
        path.name
        for path, file in read.items()
        if file is None or file.problem or file.is_hollow or file.stray is not None or not file.has_area
    ] == []


def test_corners_are_read_as_one_by_one() -> None:
    """Of an OBJ of several blocks, whose faces are written in all ways, in any order with the vertices."""
    chance = random.Random(5)  # noqa: S311 - no secret
    found = []
    for _ in range(60):
        lines, count = [], 0
        for _ in range(chance.choice([3, 30, 30_000])):
            if chance.random() < 0.5 or not count:
                lines.append("v 0 0 0")
                count += 1
                continue
            form = chance.choice(["{}", "{}/{}", "{}//{}", "{}/{}/{}"])
            corners = [chance.choice([1, -1]) * chance.randint(1, count) for _ in range(chance.choice([3, 4]))]
            lines.append("f " + " ".join(form.format(corner, 0, 99_999_999) for corner in corners))
        if chance.random() < 0.7:
            odd = chance.choice([0, count + 1, -count - 1, 10 * count, -(10**6)])
            lines.insert(chance.randint(0, len(lines)), f"f 1/7 {odd}//3 2 1")
        found.append((stray_one_by_one(lines), read_stray("\n".join(lines).encode())))
    assert len({one is None for one, _ in found}) == 2
    assert [pair for pair in found if (pair[0] is None) != (pair[1] is None)] == []


def read_stray(content: bytes) -> int | None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "part.obj"
        path.write_bytes(content)
        file = read_mesh(path)
    assert file is not None
    return file.stray


def stray_one_by_one(lines: list[str]) -> int | None:
    whole, count = sum(line.startswith("v ") for line in lines), 0
    for line in lines:
        count += line.startswith("v ")
        for corner in line.split()[1:] if line.startswith("f ") else ():
            number = int(corner.partition("/")[0])
            if number == 0 or number > whole or -number > count:
                return number
    return None


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
    for number, text in enumerate(with_odd_numbers()):
        paths.append(tmp_path / f"{number}.urdf")
        paths[-1].write_text(text)
    assert len(paths) > 200
    assert unforeseen(consumer, paths)[0] == []
