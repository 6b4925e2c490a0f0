"""Sound descriptions of each format, and each with the fault of every rule that `dh2urdf check` has for it."""

from __future__ import annotations

import struct
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf_check.inspection import model_rules
from dh2urdf_check.rules import rules

if TYPE_CHECKING:
    from collections.abc import Sequence


SUFFIXES = {"urdf": ".urdf", "sdf": ".sdf", "mjcf": ".xml"}
SOUND_OF = {name: Path(__file__).with_name(f"sound{suffix}").read_text("utf-8") for name, suffix in SUFFIXES.items()}
SOUND, SDF, MJCF = SOUND_OF.values()

ELBOW, ELBOW_AXIS = '<joint name="elbow" type="revolute">', '<axis xyz="0 1 0"/>'
ELBOW_LIMIT = '<limit lower="-2" upper="2" effort="20" velocity="3"/>'
LINK_2_INERTIA = '<inertia ixx="0.005" ixy="0" ixz="0" iyy="0.006" iyz="0" izz="0.007"/>'
LINK_2_BODY = f"""    <inertial>
      <origin xyz="0.1 0 0" rpy="0 0 0"/>
      <mass value="1"/>
      {LINK_2_INERTIA}
    </inertial>
"""
BOX, CYLINDER = '<box size="0.1 0.05 0.05"/>', '<cylinder radius="0.02" length="0.05"/>'
END = "</robot>\n"


class Proof(NamedTuple):
    """How a sound file is made one that breaks a rule.

    Attributes:
        old: the text of the sound file that is replaced.
        new: what takes its place.
        at: a text of the line where the fault is found.
        nth: which occurrence of that text is meant.
        besides: other rules that are broken with it.
        of: the consumers that it matters to, where that is not all of the rule.
    """

    old: str
    new: str
    at: str
    nth: int = 1
    besides: Sequence[str] = ()
    of: Sequence[str] = ()


def many_joints(count: int = 140) -> str:
    """Links in a row, each turning on the one before."""
    names = ["link_2", *(f"further_{number}" for number in range(count))]
    joint = (
        '  <joint name="j_{1}" type="revolute">\n    <parent link="{0}"/>\n    <child link="{1}"/>\n'
        '    <axis xyz="0 0 1"/>\n    <limit lower="-1" upper="1" effort="1" velocity="1"/>\n  </joint>\n'
    )
    links = [f'  <link name="{name}">\n{LINK_2_BODY}  </link>\n' for name in names[1:]]
    return "".join([*links, *(joint.format(*pair) for pair in pairwise(names))])


LONG_NAME = "n" * 1200
PROOFS: dict[str, Proof] = {
    **{rule.name: Proof(**rule.proof) for rule in rules().values() if rule.proof},
    # What no YAML can have, or nobody would read in it.
    "wrong-encoding": Proof('<robot name="arm">', '<robot name="arm" author="Jos\udce9">', "<robot"),
    "long-line": Proof('<mass value="1"/>', '<mass value="' + "0" * 8500 + '1"/>', '<mass value="000'),
    "name-too-long": Proof('<joint name="elbow"', f'<joint name="{LONG_NAME}"', LONG_NAME),
    "too-many-joints": Proof(END, many_joints() + END, '<joint name="j_further_119"'),
}
"""By rule of URDF, the substitution that breaks it."""
UNPROVED = {"root-without-inertial", "named-colour", "xacro-fails", "free-root", "empty-root", "usd-name"}
"""Rules that the sound file has, or that no URDF can break."""
MODEL_PROOFS = {
    rule.name: Proof(**rule.proof) for name in ("sdf", "mjcf") for rule in model_rules(name).values() if rule.proof
}


def faulty(sound: str, proof: Proof) -> str:
    """The text of a sound file with the fault of a proof; `ALL` of it may be another text."""
    if proof.old == "ALL":
        return proof.new
    if proof.old not in sound:
        raise ValueError(f"{proof.old!r} is not there")
    return sound.replace(proof.old, proof.new, 1)


def line_of(sound: str, proof: Proof) -> int:
    """The line of the finding: of a model, the one at the change or before it, or else after it."""
    text, start = faulty(sound, proof), 0 if proof.old == "ALL" else sound.index(proof.old)
    place = text.rfind(proof.at, 0, start + max(len(proof.new), len(proof.at)))
    if sound == SOUND:
        place = -1
        for _ in range(proof.nth):
            place = text.index(proof.at, place + 1)
    return text.count("\n", 0, place if place >= 0 else text.index(proof.at)) + 1


COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">{asset}
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="12">{corners}</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="4">
<input semantic="VERTEX" source="#v" offset="0"/><p>{faces}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node>{steps}<instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def collada(
    asset: str = '<asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>',
    corners: str = "0 0 0 0.1 0 0 0 0.1 0 0 0 0.1",
    steps: str = "",
) -> str:
    """A tetrahedron in COLLADA."""
    return COLLADA.format(asset=asset, corners=corners, faces="0 2 1 0 1 3 0 3 2 1 2 3", steps=steps)


def write_meshes(folder: Path) -> None:
    """A part in the formats that the faults name, and a folder that is empty of it."""
    corners = [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    obj = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (folder / "part.obj").write_text("\n".join(obj) + "\n")
    triangles = [struct.pack("<12fH", 0, 0, 0, *corners[a], *corners[b], *corners[c], 0) for a, b, c in faces]
    (folder / "part.stl").write_bytes(bytes(80) + struct.pack("<I", len(faces)) + b"".join(triangles))
    text = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {:g} {:g} {:g}\n".format(*corners[i]) for i in face)
        + "endloop\nendfacet\n"
        for face in faces
    )
    (folder / "text.stl").write_text(f"solid part\n{text}endsolid part\n")
    (folder / "part.glb").write_bytes(b"glTF")
    (folder / "many.stl").write_bytes(bytes(80) + struct.pack("<I", 200_004) + b"".join(triangles) * 50_001)
    (folder / "pointer.stl").write_text(f"version https://git-lfs.github.com/spec/v1\noid sha256:{64 * '0'}\nsize 9\n")
    dae = collada('<asset><unit meter="0.01"/><up_axis>Z_UP</up_axis></asset>')
    (folder / "unit.dae").write_text(dae)
    (folder / "hollow.dae").write_text(dae.replace(' meter="0.01"', ""))
    (folder / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n")


def write_all(folder: Path) -> dict[str, Path]:
    """The sound file, as ``sound``, and every faulty one, by its rule, with the meshes beside them."""
    folder = folder / "robots"
    folder.mkdir()
    write_meshes(folder)
    texts = {"sound": SOUND, **{rule: faulty(SOUND, proof) for rule, proof in PROOFS.items()}}
    paths = {name: folder / f"{name}.urdf" for name in texts}
    for name, path in paths.items():
        path.write_bytes(texts[name].replace("FOLDER", str(folder)).encode("utf-8", "surrogateescape"))
    return paths


def write_models(folder: Path) -> dict[str, Path]:
    """The sound models, as ``sdf`` and ``mjcf``, and every faulty one by its rule, with meshes beside them."""
    write_meshes(folder)
    (folder / "pointer.obj").write_bytes((folder / "pointer.stl").read_bytes())
    (folder / "part.stl").write_bytes(bytes(80) + struct.pack("<I", 4) + 4 * bytes(50))
    paths = {}
    for name in ("sdf", "mjcf"):
        faults = {rule: faulty(SOUND_OF[name], proof) for rule, proof in MODEL_PROOFS.items() if rule.startswith(name)}
        for rule, content in {name: SOUND_OF[name], **faults}.items():
            paths[rule] = folder / f"{rule}{SUFFIXES[name]}"
            paths[rule].write_text(content)
    return paths
