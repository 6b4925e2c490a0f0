"""What CoppeliaSim's importer does with files, right and faulty: the peer of the tests does the same, case by case.

The real one is not part of CI: it is no free package. What it did is kept in `coppeliasim_4_10_0.json`, and the peer is
compared with that. Where DH2URDF_COPPELIASIM starts a CoppeliaSim (see `coppeliasim_server`), the real one is compared
with it, too; with `--renew` it is written anew.
"""

from __future__ import annotations

import contextlib
import json
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

pytest.importorskip("coppeliasim_zmqremoteapi_client")
pytest.importorskip("zmq")

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
try:
    from coppeliasim_peer import Peer
    from coppeliasim_server import COMMAND, STARTS_WITHIN, Real
finally:
    sys.path.remove(str(HERE))

RECORD = HERE / "coppeliasim_4_10_0.json"
OPTIONS = 8 | 32
ANSWERS_WITHIN = 10.0
WRITTEN_COLOURS = ([0.5, 0.5, 0.25], [0.125, 0.25, 0.5])
DIGITS, ROUNDING = 9, 2e-9

BOX = '<geometry><box size="0.1 0.2 0.3"/></geometry>'
BODY = """<inertial><origin xyz="0.1 0 0.05" rpy="0.1 0.2 0.3"/><mass value="2"/>
<inertia ixx="0.01" ixy="0.001" ixz="0" iyy="0.02" iyz="0" izz="0.03"/></inertial>"""
PART = '<collision><origin xyz="0.1 0 0" rpy="0 0.5 0"/><geometry><box size="0.1 0.2 0.3"/></geometry></collision>'
LIMIT = '<limit lower="-1" upper="1.5" effort="5" velocity="3"/>'


def arm(
    *,
    axis: str = '<axis xyz="0 1 0"/>',
    limit: str = LIMIT,
    kind: str = "revolute",
    name: str = "elbow",
    link: str = "",
    more: str = "",
    robot: str = ' name="arm"',
    base: str = "",
) -> str:
    """An arm of two joints; what follows the first, on an axis that is not z, is wrong where that is."""
    return f"""<?xml version="1.0"?>
<robot{robot}>
  <material name="grey"><color rgba="0.5 0.5 0.25 1"/></material>
  <link name="base_link">{base}</link>
  <joint name="{name}" type="{kind}"><origin xyz="0.3 0.1 0.2" rpy="0.3 -0.2 0.1"/><parent link="base_link"/>
    <child link="forearm"/>{axis}{limit}</joint>
  <link name="forearm">{link or BODY + PART}</link>
  <joint name="wrist" type="revolute"><origin xyz="0.3 0 0" rpy="0 0 0.7"/><parent link="forearm"/><child link="hand"/>
    <axis xyz="1 0 0"/>{LIMIT}</joint>
  <link name="hand">{BODY}{PART}</link>
  <joint name="hand-tool0" type="fixed"><origin xyz="0 0 0.1"/><parent link="hand"/><child link="tool0"/></joint>
  <link name="tool0"/>
  {more}
</robot>
"""


def visual(material: str) -> str:
    return f"{BODY}{PART}<visual>{BOX}{material}</visual>"


def mesh(name: str, tag: str = "collision", *, more: str = "") -> str:
    return f'{BODY}<{tag}><origin xyz="0.1 0 0"/><geometry><mesh filename="{name}"/></geometry></{tag}>{more}'


def joint(name: str, parent: str, child: str) -> str:
    return f'<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>'


AXES = {
    word: arm(axis=f'<axis xyz="{word}"/>', limit=limit)
    for word, limit in [
        *((word, LIMIT) for word in ("0 0 1", "0 0 -1", "1e-30 0 -1", "1e-12 0 -1", "1e-170 0 -1", "0 -1 0", "-1 0 0")),
        *(
            (word, LIMIT)
            for word in ("0.6 0 0.8", "-0.6 0 -0.8", "0 2 0", "0 0.5 0", "0 1 1", "0 0 0", "0 0 -2", "nan 0 1")
        ),
        ("0 0", LIMIT),
    ]
}
LIMITS = {
    "excludes 0 from above": ("0.5", "2"),
    "excludes 0 from below": ("-2", "-0.5"),
    "swapped": ("2", "-2"),
    "equal": ("0.5", "0.5"),
    "no number": ("1,5", "2"),
    "three turns": ("-18", "18"),
}
CASES: dict[str, str] = {
    "plain": arm(),
    **{f"axis {word}": text for word, text in AXES.items()},
    "no axis": arm(axis=""),
    **{
        f"limits {name}": arm(limit=f'<limit lower="{low}" upper="{high}" effort="5" velocity="3"/>')
        for name, (low, high) in LIMITS.items()
    },
    **{
        f"limits {name} about x": arm(
            axis='<axis xyz="1 0 0"/>', limit=f'<limit lower="{low}" upper="{high}" effort="5" velocity="3"/>'
        )
        for name, (low, high) in LIMITS.items()
    },
    "prismatic": arm(kind="prismatic"),
    "prismatic excludes 0": arm(kind="prismatic", limit='<limit lower="0.05" upper="0.2" effort="5" velocity="3"/>'),
    "prismatic without limits": arm(kind="prismatic", limit=""),
    "continuous": arm(kind="continuous"),
    "continuous without limit": arm(kind="continuous", limit=""),
    "no limit": arm(limit=""),
    "no range": arm(limit='<limit effort="5" velocity="3"/>'),
    "no effort and velocity": arm(limit='<limit lower="-1" upper="1"/>'),
    "lower only": arm(limit='<limit lower="-1" effort="1" velocity="1"/>'),
    "floating": arm(kind="floating"),
    "planar": arm(kind="planar"),
    "unknown type": arm(kind="Revolute"),
    "mimic": arm(limit=LIMIT + '<mimic joint="wrist" multiplier="2"/>'),
    "name with a dash": arm(name="el-bow"),
    "name with a dot and a space": arm(name="el.bow 1"),
    "name not of ASCII": arm(name="\u00fcber\u65e5"),
    "empty name": arm(name=""),
    "joint like a shape": arm(name="forearm_visual"),
    "colour in the visual": arm(link=visual('<material name="blue"><color rgba="0.125 0.25 0.5 1"/></material>')),
    "colour by name": arm(link=visual('<material name="grey"/>')),
    "material not defined": arm(link=visual('<material name="gray"/>')),
    "no mass": arm(link=PART),
    "mass 0": arm(link=BODY.replace('"2"', '"0"') + PART),
    "mass below 0": arm(link=BODY.replace('"2"', '"-1"') + PART),
    "blanks around a mass": arm(link=BODY.replace('"2"', '" 2"') + PART),
    "blanks behind limits": arm(limit=LIMIT.replace('"1.5"', '"1.5 "').replace('"5"', '"5\t"')),
    "mass is no number": arm(link=BODY.replace('"2"', '"2 kg"') + PART),
    "no inertia": arm(link='<inertial><mass value="2"/></inertial>' + PART),
    "inertia 0": arm(
        link='<inertial><mass value="2"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>' + PART
    ),
    "inertia not positive": arm(link=BODY.replace('ixx="0.01"', 'ixx="-0.01"') + PART),
    "inertia of no body": arm(link=BODY.replace('izz="0.03"', 'izz="9"') + PART),
    "small inertia": arm(
        link='<inertial><mass value="2"/><inertia ixx="1e-9" ixy="0" ixz="0" iyy="1e-9" iyz="0" izz="1e-9"/></inertial>'
        + PART
    ),
    "no collision": arm(link=BODY),
    "no collision, a visual": arm(link=f"{BODY}<visual>{BOX}</visual>"),
    "two collisions": arm(link=BODY + PART + f'<collision><origin xyz="0 1 0"/>{BOX}</collision>'),
    "collision without geometry": arm(link=f"{BODY}<collision/>{PART}"),
    "collision without size": arm(link=f"{BODY}<collision><geometry><box/></geometry></collision>"),
    "unknown geometry": arm(link=f'{BODY}{PART}<visual><geometry><cone radius="1"/></geometry></visual>'),
    "visual without geometry": arm(link=f"{BODY}{PART}<visual/>"),
    "root with a body": arm(base=BODY + PART),
    "second root": arm(more=f'<link name="stray">{BODY}{PART}</link>'),
    "duplicate link": arm(more=f'<link name="hand">{BODY}{PART}</link>'),
    "duplicate joint": arm(more=joint("wrist", "base_link", "stray") + f'<link name="stray">{BODY}{PART}</link>'),
    "two parents": arm(more=joint("second", "base_link", "tool0")),
    "cycle": arm(more=joint("back", "tool0", "forearm")),
    "joint like a link": arm(name="hand"),
    "no links": '<?xml version="1.0"?>\n<robot name="arm"/>\n',
    "not a robot": '<?xml version="1.0"?>\n<sdf version="1.9"/>\n',
    "not XML": '<?xml version="1.0"?>\n<robot name="arm"><link>\n',
    "mesh": arm(link=mesh("part.obj")),
    "mesh by its address": arm(link=mesh("file://FOLDER/part.obj")),
    "mesh by an absolute path": arm(link=mesh("FOLDER/part.obj")),
    "mesh of STL": arm(link=mesh("part.stl")),
    "mesh of COLLADA": arm(link=mesh("part.dae")),
    "mesh of a package": arm(link=mesh("package://robots/part.obj")),
    "mesh of glTF": arm(link=mesh("part.glb")),
    "mesh of glTF that is seen": arm(link=mesh("part.glb", "visual", more=PART)),
    "missing mesh": arm(link=mesh("nowhere.obj")),
    "missing mesh that is seen": arm(link=mesh("nowhere.obj", "visual", more=PART)),
    "robot without a name": arm(robot=""),
    "link without a name": arm(more="<link/>"),
    "undefined parent": arm(more=joint("further", "nowhere", "tool0")),
    "undefined child": arm(more=joint("further", "tool0", "nowhere")),
    "no parent": arm(more='<joint name="further" type="fixed"><child link="tool0"/></joint>'),
    "no child": arm(more='<joint name="further" type="fixed"><parent link="tool0"/></joint>'),
}
AS_TEXT = ("plain", "mesh", "mesh by its address", "mesh by an absolute path", "missing mesh that is seen", "not XML")
WITH_OPTIONS = {"plain": (32, 32 | 8 | 128), "two collisions": (40 | 128,)}
RUNS: dict[str, tuple[str, str, int]] = {
    **{name: (name, "path", OPTIONS) for name in CASES},
    **{f"{name}, as text": (name, "text", OPTIONS) for name in AS_TEXT},
    **{f"{name}, options {bits}": (name, "path", bits) for name, all_ in WITH_OPTIONS.items() for bits in all_},
}
"""Which file is imported, by its path or as a text, and with which options."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of meshes."""
    trimesh = pytest.importorskip("trimesh")
    folder = tmp_path_factory.mktemp("files")
    box = trimesh.creation.box((0.1, 0.2, 0.3))
    for suffix in ("obj", "stl", "dae", "glb"):
        box.export(folder / f"part.{suffix}")
    return folder


# --- The two ----------------------------------------------------------------------------------------------------------


def outcome(port: int, name: str, folder: Path) -> dict[str, Any]:
    """What a CoppeliaSim does with a file, and what is in its scene then that was not before."""
    import zmq
    from coppeliasim_zmqremoteapi_client import RemoteAPIClient

    case, way, options = RUNS[name]
    text = CASES[case].replace("FOLDER", str(folder))
    (path := folder / "arm.urdf").write_text(text, "utf-8")
    client = RemoteAPIClient("127.0.0.1", port)
    client.socket.setsockopt(zmq.LINGER, 0)
    client.socket.setsockopt(zmq.RCVTIMEO, round(1000 * STARTS_WITHIN))
    sim, importer = client.require("sim"), client.require("simURDF")
    client.socket.setsockopt(zmq.RCVTIMEO, round(1000 * ANSWERS_WITHIN))
    before = set(sim.getObjectsInTree(sim.handle_scene))
    found: dict[str, Any] = {"end": "imports"}
    try:
        robot, models = importer.importFile(str(path) if way == "path" else text, options)
        found |= {"robot": robot, "models": [sim.getObjectAlias(handle) for handle in models]}
    except zmq.ZMQError:
        return {"end": "crashes"}
    except Exception as error:  # noqa: BLE001 - the client raises nothing else
        found |= {
            "end": "raises",
            "error": str(error)
            .partition("sim.genericFunctionHandler: ")[2]
            .split("(in function")[0]
            .strip(" \t\n_=TBNL"),
        }
    new = [handle for handle in sim.getObjectsInTree(sim.handle_scene) if handle not in before]
    if found["end"] == "imports":
        found["objects"] = in_order(described(sim, handle, new) for handle in new)
    else:
        found["left behind"] = bool(new)
    if new:
        sim.removeObjects(new)
    return found


def described(sim: Any, handle: int, new: list[int]) -> dict[str, Any]:
    """An object of the scene, in numbers that are rounded."""
    parent = sim.getObjectParent(handle)
    matrix = sim.getObjectMatrix(handle, -1)
    found: dict[str, Any] = {
        "name": sim.getObjectAlias(handle),
        "kind": sim.getObjectType(handle),
        "on": sim.getObjectAlias(parent) if parent in new else None,
    }
    if found["kind"] == sim.sceneobject_joint:
        cyclic, interval = sim.getJointInterval(handle)
        found |= {
            "type": sim.getJointType(handle),
            "interval": None if cyclic else rounded(interval),
            "position": rounded([sim.getJointPosition(handle)]),
            "force": rounded([sim.getJointTargetForce(handle)]),
            "velocity": rounded([sim.getObjectFloatParam(handle, sim.jointfloatparam_maxvel)]),
            "origin": rounded(matrix[3::4]),
            "axis": rounded(matrix[2::4]),
        }
    elif found["kind"] == sim.sceneobject_shape:
        static = bool(sim.getObjectInt32Param(handle, sim.shapeintparam_static))
        respondable = bool(sim.getObjectInt32Param(handle, sim.shapeintparam_respondable))
        inertia, body = sim.getShapeInertia(handle)
        colour = rounded(sim.getShapeColor(handle, None, sim.colorcomponent_ambient_diffuse)[1], 4)
        found |= {
            "frame": rounded(matrix),
            "static": static,
            "mask": sim.getObjectInt32Param(handle, sim.shapeintparam_respondable_mask) if respondable else None,
            "colour": colour if colour in WRITTEN_COLOURS else None,
            "mass": None if static else rounded([sim.getShapeMass(handle)]),
            "inertia": rounded(inertia) if respondable and not static else None,
            "centre": rounded(body[3::4]) if respondable and not static else None,
        }
    return found


def rounded(numbers: Any, digits: int = DIGITS) -> list[float]:
    return [round(float(number), digits) + 0.0 for number in numbers]


@pytest.fixture(scope="module")
def peer() -> Iterator[Callable[[str, Path], dict[str, Any]]]:
    """What the peer does with a case; it is started again after each crash, too."""
    with contextlib.ExitStack() as stack:
        running = [stack.enter_context(Peer())]

        def ask(name: str, folder: Path) -> dict[str, Any]:
            found = outcome(running[-1].port, name, folder)
            if found["end"] == "crashes":
                running.append(stack.enter_context(Peer()))
            return found

        yield ask


@pytest.fixture(scope="module")
def record() -> dict[str, Any]:
    """What the real one did."""
    return read_record()


def read_record() -> dict[str, Any]:
    """The record; objects that are those of the plain file are kept by their names."""
    kept = json.loads(RECORD.read_text("utf-8"))
    plain = {each["name"]: each for each in kept["plain"]["objects"]}
    for found in kept.values():
        if "objects" in found:
            found["objects"] = in_order(plain[each] if isinstance(each, str) else each for each in found["objects"])
    return dict(kept)


def write_record(found: dict[str, Any]) -> None:
    plain = {each["name"]: each for each in found["plain"]["objects"]}
    lines = []
    for name, each in found.items():
        objects = {"objects": [o["name"] if plain.get(o["name"]) == o else o for o in each.get("objects", ())]}
        short = each if name == "plain" or "objects" not in each else each | objects
        lines.append(f"{json.dumps(name)}: {json.dumps(short, separators=(',', ':'))}")
    RECORD.write_text("{\n" + ",\n".join(lines) + "\n}\n", "utf-8")


def in_order(objects: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """By name; two of one name come in either order, and are told apart by where they are."""
    return sorted(
        objects,
        key=lambda each: (each["name"], each["kind"], each["on"] or "", [round(x, 6) for x in each.get("frame") or ()]),
    )


def differences(found: Any, kept: Any, place: str = "") -> list[str]:
    """Where two outcomes differ by more than the rounding of their numbers."""
    if isinstance(found, dict) and isinstance(kept, dict) and found.keys() == kept.keys():
        return [
            line
            for key in kept
            for line in differences(found[key], kept[key], f"{place}.{found.get('name', '')}.{key}")
        ]
    if isinstance(found, list) and isinstance(kept, list) and len(found) == len(kept):
        pairs = zip(found, kept, strict=True)
        return [
            line for number, (one, other) in enumerate(pairs) for line in differences(one, other, f"{place}[{number}]")
        ]
    if isinstance(found, float | int) and isinstance(kept, float | int):
        same = found == kept or math.isclose(found, kept, rel_tol=ROUNDING, abs_tol=ROUNDING)
        return [] if same else [f"{place}: {found}, kept is {kept}"]
    return [] if found == kept else [f"{place}: {found}, kept is {kept}"]


def test_the_real_one_does_what_is_kept(folder: Path, *, renew: bool) -> None:
    """Where a command starts CoppeliaSim, it does with every file what is kept of it."""
    if not COMMAND:
        assert RECORD.is_file()
        return
    found = {}
    with Real() as real:
        for name in RUNS:
            found[name] = outcome(real.port, name, folder)
            if found[name]["end"] == "crashes":
                real.end()
                real.start()
    if renew:
        write_record(found)
    assert differences(found, read_record()) == []


@pytest.mark.parametrize("name", RUNS)
def test_the_peer_does_the_same(
    peer: Callable[[str, Path], dict[str, Any]],
    folder: Path,
    record: dict[str, Any],
    name: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The peer imports, refuses and crashes where CoppeliaSim did, and has the same objects in its scene."""
    if record[name]["end"] == "crashes":  # Then there is no answer to wait for, however busy the machine is.
        monkeypatch.setattr(f"{__name__}.ANSWERS_WITHIN", 0.5)
    assert differences(peer(name, folder), record[name]) == []
