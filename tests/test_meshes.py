"""Meshes from a table to the simulators: the same bodies in the same places, and every file where its robots find it."""

import json
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from command_line import Cli
from jsonschema import Draft202012Validator
from lxml import etree

from dh2urdf.report.schema import manifest_schema
from dh2urdf_plugins.formats.xacro.reader import expand

SIZE = (0.06, 0.08, 0.2)
ORIGINS = (((0.0, 0.1, -0.05), (0.0, 0.0, 0.0)), ((0.1, 0.0, 0.0), (0.3, -0.5, 0.7)), ((0, 0, 0), (0, math.pi / 2, 0)))
ROWS = (  # a, alpha, d, theta, offset, sign, prismatic
    (0.0, math.pi / 2, 0.2, 0.1, 0.3, 1, False),
    (0.3, 0.4, 0.05, 0.0, 0.0, -1, False),
    (0.1, -math.pi / 2, 0.1, 0.2, 0.05, 1, True),
)
BASE = ((0.1, 0.2, 0.3), (0.1, 0.2, 0.3))
VECTORS = [np.zeros(3), *np.random.default_rng(3).uniform(-0.8, 0.8, (5, 3))]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with boxes as meshes: in metres, and one in millimetres."""
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    box = trimesh.creation.box(SIZE)
    for name in ("link.stl", "link.obj", "link.dae"):
        box.export(meshes / name)
    (meshes / "link.dae").write_text((meshes / "link.dae").read_text().replace("Y_UP", "Z_UP"))
    box.apply_scale(1000.0)
    box.export(meshes / "link_mm.stl")
    return tmp_path


def table(convention: str, *files: str, density: float = 1000.0) -> str:
    """The arm above, each link a mesh where there is a file for it, and the base one."""
    joints = []
    for number, (row, origin) in enumerate(zip(ROWS, ORIGINS, strict=True)):
        a, alpha, d, theta, offset, sign, prismatic = row
        joint = {
            "name": f"joint_{number + 1}",
            **({"type": "prismatic"} if prismatic else {}),
            "a": a,
            "alpha": alpha,
            "d": d,
            "theta": theta,
            "offset": offset,
            "sign": sign,
            "limits": {"lower": -1, "upper": 1},
        }
        if number < len(files):
            scale = 0.001 if "mm" in files[number] else 1
            joint["mesh"] = {"file": f"meshes/{files[number]}", "xyz": origin[0], "rpy": origin[1], "scale": scale}
        joints.append(joint)
    base = {"xyz": BASE[0], "rpy": BASE[1], **({"mesh": f"meshes/{files[0]}"} if files else {})}
    return json.dumps(
        {"name": "arm", "convention": convention, "base": base, "defaults": {"density": density}, "joints": joints}
    )


def matrix(xyz: Any, rpy: Any) -> np.ndarray:
    """A homogeneous matrix of fixed-axis angles, by trimesh's own code."""
    T = trimesh.transformations.euler_matrix(*rpy, axes="sxyz")
    T[:3, 3] = xyz
    return T


def dh_poses(convention: str, q: Any) -> list[np.ndarray]:
    """The DH frames before the first row and after each, as products of plain matrices."""

    def screw(axis: int, angle: float, length: float) -> np.ndarray:
        direction = np.eye(3)[axis]
        T = trimesh.transformations.rotation_matrix(angle, direction)
        T[:3, 3] = length * direction
        return T

    poses = [matrix(*BASE)]
    for (a, alpha, d, theta, offset, sign, prismatic), value in zip(ROWS, q, strict=True):
        moved = offset + sign * value
        z = screw(2, theta + (0 if prismatic else moved), d + (moved if prismatic else 0))
        x = screw(0, alpha, a)
        poses.append(poses[-1] @ (z @ x if convention == "standard" else x @ z))
    return poses


def mesh_names(path: Path) -> list[str]:
    return [element.get("filename") for element in etree.fromstring(path.read_bytes()).iter("mesh")]


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize("frames", ["aligned", "dh"])
def test_meshes_stand_where_the_table_has_them(convention: str, frames: str, folder: Path, cli: Cli) -> None:
    """Pinocchio has each at base · A₁(q₁) · … · Aᵢ(qᵢ) · origin, where it is seen and where it touches."""
    import pinocchio

    (folder / "arm.yaml").write_text(table(convention, "link.stl", "link.obj", "link_mm.stl"))
    cli("convert", "arm.yaml", "-o", "out/arm.urdf", "--frames", frames)
    model, collisions, visuals = pinocchio.buildModelsFromUrdf(str(folder / "out/arm.urdf"), [str(folder / "out")])
    origins = [((0, 0, 0), (0, 0, 0)), *ORIGINS]
    for geometry in (visuals, collisions):
        data, places = model.createData(), geometry.createData()
        assert geometry.ngeoms == 4
        for q in VECTORS:
            pinocchio.updateGeometryPlacements(model, data, geometry, places, np.array(q))
            for shape, dh_frame, origin in zip(places.oMg, dh_poses(convention, q), origins, strict=True):
                assert shape.homogeneous == pytest.approx(dh_frame @ matrix(*origin), abs=1e-12)
        for each in geometry.geometryObjects:
            each.geometry.computeLocalAABB()
            corner = each.geometry.aabb_local.max_
            assert corner == pytest.approx(np.array(SIZE) / 2, rel=1e-6)


def test_the_expanded_xacro_has_the_meshes_of_the_urdf(folder: Path, cli: Cli) -> None:
    """Names, scales and origins; the copies lie beside both."""
    (folder / "arm.yaml").write_text(table("standard", "link.stl", "link.obj", "link_mm.stl"))
    cli("convert", "arm.yaml", "-o", "out/arm.urdf")
    cli("convert", "arm.yaml", "-o", "out/arm.urdf.xacro")
    urdf = etree.parse(folder / "out/arm.urdf")
    expanded = etree.fromstring(expand(folder / "out/arm.urdf.xacro"))
    for tag in ("mesh", "compiler"):
        assert [dict(each.attrib) for each in expanded.iter(tag)] == [dict(each.attrib) for each in urdf.iter(tag)]
    assert len(list(urdf.iter("mesh"))) == 8
    names = set(mesh_names(folder / "out/arm.urdf"))
    assert names == {f"meshes/{path.name}" for path in (folder / "out/meshes").iterdir()}


class TestConvert:
    def test_it_copies_meshes_beside_its_file(self, folder: Path, cli: Cli) -> None:
        """Byte for byte, once each, under names with a part of their hashes."""
        (folder / "arm.yaml").write_text(table("standard", "link.stl", "link.stl", "link.dae"))
        cli("convert", "arm.yaml", "-o", "out/arm.urdf")
        names = mesh_names(folder / "out/arm.urdf")
        assert len(set(names)) == 2
        for name in names:
            original = folder / "meshes" / f"link{Path(name).suffix}"
            assert (folder / "out" / name).read_bytes() == original.read_bytes()

    def test_it_can_name_the_originals(self, folder: Path, cli: Cli) -> None:
        """On standard output it has nothing beside it to name."""
        (folder / "arm.yaml").write_text(table("standard", "link.stl"))
        cli("convert", "arm.yaml", "-o", "out/arm.urdf", "--meshes", "file")
        address = f"file://{folder}/meshes/link.stl"
        assert set(mesh_names(folder / "out/arm.urdf")) == {address}
        assert not (folder / "out/meshes").exists()
        assert address in cli("convert", "arm.yaml").stdout
        told = cli("convert", "arm.yaml", "--meshes", "relative", status=2).stderr
        assert "--meshes relative copies meshes beside a file" in told


RUN = """
inputs: arm.csv
meshes:
  of: arm
  joints:
    joint_1: {mesh: meshes/link.stl}
    joint_2: {visual: {file: meshes/link_mm.stl, scale: 0.001}}
"""
CSV = "# convention: standard\njoint,a,alpha,d\njoint_1,0,pi/2,0.2\njoint_2,0.3,0,0\njoint_3,0.2,0,0\n"


@pytest.fixture
def run(folder: Path, cli: Cli) -> Callable[..., list[dict[str, Any]]]:
    """The rows of the manifest of a run with the meshes above."""
    (folder / "arm.csv").write_text(CSV)

    def call(*words: str | Path, more: str = "", status: int = 0) -> list[dict[str, Any]]:
        (folder / "run.yaml").write_text(RUN + more)
        cli("run", "run.yaml", "-o", folder / "out", "--workers", 1, *words, status=status)
        return [json.loads(line) for line in (folder / "out/manifest.jsonl").read_text().splitlines()]

    return call


VARIANTS = "variations: [{of: arm, count: 30, vary: {joints: all, field: damping, uniform: [0, 2]}}]\n"


class TestRuns:
    def test_all_manipulators_share_one_copy(self, run: Callable[..., list[dict[str, Any]]], folder: Path) -> None:
        """Variants and cells have the meshes of their tables, however they are made; the manifest lists the copies."""
        rows = run(
            more=VARIANTS + "cells:\n  - {name: pair, arms: [{name: a, of: arm}, {name: b, of: arm, xyz: [1, 0, 0]}]}\n"
        )
        assert len(rows) == 32
        copies = {f"meshes/{path.name}" for path in (folder / "out/meshes").iterdir()}
        assert len(copies) == 2
        for row in rows:
            Draft202012Validator(manifest_schema()).validate(row)
            assert {mesh["path"] for mesh in row["meshes"]} == copies
            assert set(mesh_names(folder / "out" / row["files"][0]["path"])) == copies
            assert ("damping" in (folder / "out" / row["files"][0]["path"]).read_text()) == bool(row["drawn"])

    def test_a_simulator_finds_them_before_they_are_in_place(self, run: Callable[..., list[dict[str, Any]]]) -> None:
        """In a package: the loader works in a folder of its own."""
        (row,) = run("--set", "loaders=pybullet", "--set", "output.meshes=package://arm/description")
        report = row["loaders"]["pybullet"]
        assert report["findings"] == []
        assert report["mass_error"] < 1e-6
        assert report["picture"] == "arm.png"


def test_without_trimesh_the_message_says_what_to_install(
    folder: Path, dh2urdf: Callable[..., subprocess.CompletedProcess[str]]
) -> None:
    """In one line, with the exit status of what is not installed; where all masses are given it is not missed."""
    (folder / "trimesh.py").write_text("raise ModuleNotFoundError('not here')\n")
    (folder / "arm.yaml").write_text(table("standard", "link.stl"))
    told = dh2urdf("convert", "arm.yaml", "-o", "out/arm.urdf", path=[folder], status=3).stderr
    assert told.strip().endswith(f"needs trimesh: {sys.executable} -m pip install 'dh2urdf[meshes]'")
    body = "mass: 1, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}"
    (folder / "arm.yaml").write_text(
        f"convention: standard\njoints:\n  - {{a: 0.3, alpha: 0, d: 0.1, {body}, mesh: meshes/link.stl}}\n"
    )
    dh2urdf("convert", "arm.yaml", "-o", "out/arm.urdf", path=[folder])
