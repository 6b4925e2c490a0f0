"""Sound descriptions to spoil: those that dh2urdf writes, and those of makers."""

from __future__ import annotations

import importlib.metadata
import shutil
import sys
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, get_args
from xml.etree import ElementTree as ET

import trimesh
from description_tree import Node, read

import dh2urdf
from dh2urdf_plugins.formats.urdf import EMITTER, ProfileName, UrdfOptions
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "check"))
from faulty_files import SOUND, write_meshes as write_part

if TYPE_CHECKING:
    from collections.abc import Sequence

TABLES = Path(__file__).parents[1] / "configs" / "tables"
COPIES = {
    "sub/part.obj": "part.obj",
    "part.OBJ": "part.obj",
    "part b.obj": "part.obj",
    "part.STL": "part.stl",
    "part": "part.stl",
}
"""Other names for two of the meshes."""
VTK = """# vtk DataFile Version 3.0
part
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 4 float
0 0 0 0.1 0 0 0 0.1 0 0 0 0.1
CELLS 1 5
4 0 1 2 3
CELL_TYPES 1
10
"""
LONGEST = 300_000
"""Size of a description that is spoilt [B]."""


def sources(folders: Sequence[Path] = ()) -> list[Node]:
    """All of them, with boxes in place of their meshes: a fault puts meshes in that are there."""
    return _sources(tuple(folders))


@cache
def _sources(folders: tuple[Path, ...]) -> list[Node]:
    texts: list[str | bytes] = [SOUND]
    texts += [*_ours(), *(path.read_bytes() for path in _foreign(folders))]
    robots = []
    for text in texts:
        try:
            robot = read(text)
        except ET.ParseError:
            continue
        if robot.all("link"):
            _without_meshes(robot)
            robots.append(robot)
    return robots


def _ours() -> list[bytes]:
    """Arms as the emitter writes them, in each of its profiles."""
    robots = [
        TRANSFORM.transform(dh2urdf.read(TABLES / name), TRANSFORM.options())
        for name in ("ur5.csv", "scara.csv", "stanford.csv")
    ]
    profiles: tuple[ProfileName, ...] = get_args(ProfileName)
    return [
        EMITTER.emit(robot, "arm", UrdfOptions(profile=profile))[0].content for robot in robots for profile in profiles
    ]


def _foreign(folders: tuple[Path, ...]) -> list[Path]:
    """Descriptions of the PyPI packages example-robot-data and pybullet, and of some folders."""
    paths = [path for folder in folders for path in folder.rglob("*.urdf")]
    for package in ("example-robot-data", "pybullet"):
        try:
            files = importlib.metadata.files(package) or ()
        except importlib.metadata.PackageNotFoundError:
            continue
        paths += [Path(file.locate()) for file in files if file.suffix == ".urdf" and "random_urdfs" not in file.parts]
    return sorted(path for path in paths if path.is_file() and path.stat().st_size < LONGEST)


def _without_meshes(robot: Node) -> None:
    for node in robot.walk():
        if node.tag == "mesh":
            node.tag, node.attributes, node.children = "box", [("size", "0.1 0.1 0.1")], []


def write_meshes(folder: Path) -> None:
    """Meshes of many formats, as the faults name them."""
    write_part(folder)
    (folder / "sub").mkdir()
    for copied, name in COPIES.items():
        shutil.copy(folder / name, folder / copied)
    trimesh.load(folder / "part.obj", force="mesh").export(folder / "part.dae")
    trimesh.load(folder / "part.obj", force="mesh").export(folder / "part.ply")
    (folder / "part.vtk").write_text(VTK)
    (folder / "empty.stl").touch()
    (folder / "empty.obj").touch()
