"""Meshes that every simulator takes: the same surfaces and masses, whatever files they come from."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from command_line import Cli
from jsonschema import Draft202012Validator
from lxml import etree

import dh2urdf
from dh2urdf.errors import CrashError, EmitterError
from dh2urdf.meshes import conversion as mesh_conversion
from dh2urdf.meshes.forms import forms_of
from dh2urdf.meshes.kinds import MeshConversion
from dh2urdf.report.schema import manifest_schema

DENSITY = 1000.0
ONE = (1.0, 1.0, 1.0)
Y_UP = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
"""From y up to z up: what is up in the file, along its y, is z."""


def wedge() -> Any:
    """A closed body with no symmetry, away from its origin; its corners are single-precision numbers."""
    mesh = trimesh.creation.icosphere(subdivisions=1)
    mesh.vertices = mesh.vertices * (0.05, 0.1, 0.15) + 0.05 * mesh.vertices[:, [1, 2, 0]] ** 2 + (0.1, -0.05, 0.02)
    mesh.vertices = mesh.vertices.astype(np.float32)
    return mesh


def angle() -> Any:
    """A body that is far from convex: two legs at a right angle, 0.4 m long and 0.1 m thick."""
    outline = np.array([[0, 0], [0.4, 0], [0.4, 0.1], [0.1, 0.1], [0.1, 0.4], [0, 0.4]])
    corners = np.vstack([np.column_stack([outline, np.full(6, z)]) for z in (0.0, 0.1)])
    caps = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    sides = [face for i in range(6) for face in ((i, (i + 1) % 6, 6 + (i + 1) % 6), (i, 6 + (i + 1) % 6, 6 + i))]
    faces = [*(cap[::-1] for cap in caps), *([6 + corner for corner in cap] for cap in caps), *sides]
    return trimesh.Trimesh(corners, faces, process=False)


def collada(mesh: Any, *colours: str, asset: str = "<up_axis>Z_UP</up_axis>", node: str = "") -> str:
    """A COLLADA file as its specification has it, the triangles in turn in each of some colours."""
    numbers = " ".join(map(repr, mesh.vertices.reshape(-1).tolist()))
    used = colours or ("",)
    lists = "".join(
        f'<triangles count="{len(faces)}" material="m{number}"><input semantic="VERTEX" source="#v" offset="0"/>'
        f"<p>{' '.join(map(str, faces.reshape(-1)))}</p></triangles>"
        for number, faces in ((number, mesh.faces[number :: len(used)]) for number in range(len(used)))
    )
    effects = "".join(
        f'<effect id="e{n}"><profile_COMMON><technique sid="t"><lambert><diffuse><color>{colour}</color></diffuse>'
        "</lambert></technique></profile_COMMON></effect>"
        for n, colour in enumerate(colours)
    )
    materials = "".join(f'<material id="a{n}"><instance_effect url="#e{n}"/></material>' for n in range(len(colours)))
    bound = "".join(f'<instance_material symbol="m{n}" target="#a{n}"/>' for n in range(len(colours)))
    bind = f"<bind_material><technique_common>{bound}</technique_common></bind_material>" if colours else ""
    return (
        '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">'
        f"<asset>{asset}</asset><library_effects>{effects}</library_effects>"
        f"<library_materials>{materials}</library_materials>"
        f'<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="f" count="{mesh.vertices.size}">'
        f'{numbers}</float_array><technique_common><accessor source="#f" count="{len(mesh.vertices)}" stride="3">'
        '<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>'
        '</technique_common></source><vertices id="v"><input semantic="POSITION" source="#s"/></vertices>'
        f'{lists}</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="w"><node id="n">{node}'
        f'<instance_geometry url="#g">{bind}</instance_geometry></node></visual_scene></library_visual_scenes>'
        '<scene><instance_visual_scene url="#w"/></scene></COLLADA>'
    )


def obj(content: bytes) -> Any:
    """What is in an OBJ file of plain triangles, taken apart here."""
    lines = [line.split() for line in content.decode().splitlines()]
    assert {words[0] for words in lines} == {"v", "f"}
    corners = [[float(word) for word in words[1:]] for words in lines if words[0] == "v"]
    faces = [[int(word) - 1 for word in words[1:]] for words in lines if words[0] == "f"]
    return trimesh.Trimesh(corners, faces, process=False)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with one body in each format; the COLLADA file in millimetres, with y up, in a node that is moved."""
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    mesh = wedge()
    mesh.export(meshes / "link.stl")
    (meshes / "link_text.STL").write_text(mesh.export(file_type="stl_ascii"))
    mesh.export(meshes / "link.obj", digits=12)
    mesh.vertices = 1000.0 * (mesh.vertices - (0.5, 0.0, 0.0)) @ Y_UP
    asset = '<unit name="mm" meter="0.001"/><up_axis>Y_UP</up_axis>'
    (meshes / "link.dae").write_text(collada(mesh, asset=asset, node="<translate>500 0 0</translate>"))
    angle().export(meshes / "angle.obj", digits=12)
    return tmp_path


def table(*meshes: dict[str, Any] | str) -> str:
    """An arm with a link for each mesh."""
    joints = [{"a": 0.3, "alpha": 0.1 * n, "d": 0.1, "mesh": mesh} for n, mesh in enumerate(meshes)]
    return json.dumps({"name": "arm", "convention": "standard", "defaults": {"density": DENSITY}, "joints": joints})


def shapes(urdf: str, tag: str) -> Iterator[tuple[str, str, str]]:
    """Link, file and scale of every mesh that is seen, or touches."""
    for link in etree.fromstring(urdf.encode()).iter("link"):
        for mesh in link.iterfind(f"{tag}/geometry/mesh"):
            yield link.get("name"), mesh.get("filename"), mesh.get("scale")


NAMES = ("link.stl", "link_text.STL", "link.obj", "link.dae")
SCALES = (ONE, (1.0, -2.0, 0.5), (0.001, 0.001, 0.001))


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("name", NAMES)
def test_a_surface_stays(name: str, scale: Any, folder: Path) -> None:
    """Of every format at every scale, mirrored too: in metres with z up, and seen from outside."""
    forms = forms_of((folder / "meshes" / name).read_bytes(), Path(name).suffix.lower(), scale, MeshConversion.HULL)
    ((rgba, seen),), (touched,) = forms
    assert rgba is None
    for content, is_hull in ((seen, False), (touched, True)):
        oracle = wedge()
        oracle.apply_transform(np.diag([*scale, 1.0]))
        if is_hull:
            oracle = oracle.convex_hull
        made = obj(content)
        tolerance = 1e-6 if name.endswith((".STL", ".dae")) else 1e-9  # 8 digits are written; single precision is read
        assert len(made.faces) == len(oracle.faces)
        assert made.bounds == pytest.approx(oracle.bounds, rel=tolerance)
        assert made.volume == pytest.approx(oracle.volume, rel=tolerance)  # Seen from inside, it is negative.
        assert made.center_mass == pytest.approx(oracle.center_mass, rel=tolerance)
        assert made.moment_inertia == pytest.approx(
            oracle.moment_inertia, rel=10 * tolerance, abs=tolerance * np.trace(oracle.moment_inertia)
        )


class TestParts:
    """A link may touch with several convex parts."""

    @pytest.fixture(scope="class")
    @staticmethod
    def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dh2urdf.Conversion]:
        folder = tmp_path_factory.mktemp("parts")
        angle().export(folder / "angle.obj", digits=12)
        (folder / "arm.yaml").write_text(table("angle.obj"))
        formats = ["urdf", "xacro", "sdf", "mjcf"]
        return folder, dh2urdf.convert(
            folder / "arm.yaml", folder / "out", formats=formats, convert_meshes="decomposition"
        )

    @pytest.mark.long
    def test_they_are_convex_and_together_the_mesh(self, made: tuple[Path, dh2urdf.Conversion]) -> None:
        """Nearly: no point of the legs is outside all, and the corner between the legs is outside each."""
        folder, conversion = made
        found = list(shapes(conversion.text, "collision"))
        assert len(found) >= 2
        assert len({filename for _, filename, _ in found}) == len(found)
        parts = [obj((folder / "out" / filename).read_bytes()) for _, filename, _ in found]
        for part in parts:
            assert part.is_watertight
            assert part.volume == pytest.approx(part.convex_hull.volume, rel=1e-9)
        legs = np.random.default_rng(5).uniform((0, 0, 0), (0.4, 0.1, 0.1), (500, 3))
        inside = np.vstack([legs, legs[:, [1, 0, 2]]])
        depths = [
            ((inside[:, None] - part.triangles_center) * part.face_normals).sum(axis=2).max(axis=1) for part in parts
        ]
        assert np.min(depths, axis=0).max() < 0.01
        notch = np.array([[0.3, 0.3, 0.05]])
        assert all(((notch - part.triangles_center) * part.face_normals).sum(axis=1).max() > 0.05 for part in parts)
        assert len(list(shapes(conversion.text, "visual"))) == 1

    def test_every_format_has_them(
        self, made: tuple[Path, dh2urdf.Conversion], require_loaders: Callable[..., None]
    ) -> None:
        """And MuJoCo and Drake collide with as many."""
        require_loaders("mujoco", "drake")
        import mujoco
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
        from pydrake.systems.framework import DiagramBuilder

        folder, conversion = made
        count = len(list(shapes(conversion.text, "collision")))
        sdf = etree.parse(folder / "out/arm.sdf")
        assert len(sdf.findall(".//collision/geometry/mesh")) == count
        model = mujoco.MjModel.from_xml_path(str(folder / "out/arm.xml"))
        touching = [geom for geom in range(model.ngeom) if model.geom_contype[geom] and model.geom_dataid[geom] >= 0]
        assert len(touching) == count
        plant, _ = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.0)
        Parser(plant).AddModels(str(folder / "out/arm.urdf"))
        assert plant.num_collision_geometries() == count + sum(
            1 for _ in etree.fromstring(conversion.text.encode()).iterfind("link/collision/geometry/cylinder")
        )


def test_a_body_in_several_colours_is_closed(folder: Path) -> None:
    """Each colour alone is a surface with holes; what it weighs is what all of them enclose."""
    (folder / "angle.dae").write_text(collada(angle(), "0.25 0.5 0.75 1", "1 0 0 1", "0 1 0 1"))
    (folder / "arm.yaml").write_text(table("angle.dae"))
    made = dh2urdf.convert(folder / "arm.yaml")
    assert not any("not closed" in str(notice) for notice in made.notices)
    mass = next(link.inertial.mass for link in made.robot.links if link.visuals and link.name == "link_1")
    assert mass == pytest.approx(DENSITY * 0.007, rel=1e-6)  # 0.4 × 0.1 × 0.1 and 0.1 × 0.3 × 0.1


def test_the_colours_of_a_collada_file_stay(folder: Path) -> None:
    """As a visual for each, with the colour in the description; what touches is one mesh."""
    (folder / "meshes/link.dae").write_text(collada(wedge(), "0.25 0.5 0.75 1", "1 0 0 1"))
    (folder / "arm.yaml").write_text(table("meshes/link.dae"))
    urdf = dh2urdf.convert(folder / "arm.yaml", folder / "out/arm.urdf", convert_meshes="auto").text
    root = etree.fromstring(urdf.encode())
    colours = {each.get("name"): each.find("color").get("rgba") for each in root.iterfind("material")}
    seen = [visual for visual in root.iter("visual") if visual.find("geometry/mesh") is not None]
    assert [colours[visual.find("material").get("name")] for visual in seen] == [
        "0.25098 0.501961 0.74902 1",
        "1 0 0 1",
    ]
    parts = [obj((folder / "out" / filename).read_bytes()) for _, filename, _ in shapes(urdf, "visual")]
    (whole,) = [obj((folder / "out" / filename).read_bytes()) for _, filename, _ in shapes(urdf, "collision")]
    centres = [
        sorted(each.tolist())
        for each in (np.vstack([part.triangles_center for part in parts]), wedge().triangles_center)
    ]
    assert np.array(centres[0]) == pytest.approx(np.array(centres[1]), rel=1e-9)
    assert whole.volume == pytest.approx(wedge().volume, rel=1e-9)


# --- Runs -------------------------------------------------------------------------------------------------------------

LOADERS = ("pybullet", "mujoco", "pinocchio", "drake", "gazebo")
ROOT = Path(__file__).parents[1]


@pytest.mark.long
def test_every_simulator_takes_three_arms_with_meshes_in_every_format(
    folder: Path, cli: Cli, require_loaders: Callable[..., None]
) -> None:
    """Each is the arm of its table there; Pinocchio, which looks at collision meshes, has them all."""
    require_loaders(*LOADERS)
    import pinocchio

    arms = ("ur5", "panda", "scara")
    tables = {arm: next((ROOT / "configs/tables").glob(f"{arm}.*")) for arm in arms}
    calls, counts = [], {}
    for arm in arms:
        joints = [row.joint for row in dh2urdf.read(tables[arm]).rows]
        files = [("link.dae", "link.stl", "link.obj")[number % 3] for number in range(len(joints))]
        meshes = {joint: {"mesh": f"meshes/{file}"} for joint, file in zip(joints, files, strict=True)}
        calls.append({"of": arm, "joints": meshes})
        counts[arm] = len(joints)
    run = {
        "inputs": [str(tables[arm]) for arm in arms],
        "meshes": calls,
        "loaders": list(LOADERS),
        "output": {"directory": "out", "meshes": {"convert": "auto"}},
        "report": {"html": False},
    }
    (folder / "run.yaml").write_text(json.dumps(run))
    cli("run", "run.yaml")
    rows = [json.loads(line) for line in (folder / "out/manifest.jsonl").read_text().splitlines()]
    assert [row["status"] for row in rows] == ["ok"] * 3
    for row in rows:
        Draft202012Validator(manifest_schema()).validate(row)
        assert {Path(mesh["path"]).suffix for mesh in row["meshes"]} == {".obj"}
        assert set(row["loaders"]) == set(LOADERS)
        for name, report in row["loaders"].items():
            assert report["position_error"] < 1e-6, name
            assert report["mass_error"] < 1e-6, name
        path = str(folder / "out" / row["files"][0]["path"])
        model = pinocchio.buildModelFromUrdf(path)
        geometry = pinocchio.buildGeomFromUrdf(
            model, path, pinocchio.GeometryType.COLLISION, package_dirs=[str(folder / "out")]
        )
        found = [each for each in geometry.geometryObjects if each.meshPath.endswith(".obj")]
        assert len(found) == counts[row["name"]]
    assert len(list((folder / "out/meshes").iterdir())) == len({mesh["path"] for row in rows for mesh in row["meshes"]})


RUN = """
inputs: arm.csv
meshes: {of: arm, joints: {joint_1: {mesh: meshes/link.stl}, joint_2: {mesh: {file: meshes/link.dae, scale: 0.5}}}}
variations: [{of: arm, count: 10, vary: {joints: all, field: damping, uniform: [0, 2]}}]
report: {html: false}
"""
CSV = "# convention: standard\njoint,a,alpha,d\njoint_1,0,pi/2,0.2\njoint_2,0.3,0,0\n"


@pytest.mark.long
def test_copies_of_converted_meshes_are_copies(folder: Path, cli: Cli) -> None:
    """Shared, the same bytes in every run, made again where they are lost, and removed where nobody needs them."""
    (folder / "arm.csv").write_text(CSV)
    (folder / "run.yaml").write_text(RUN)
    words = ("--workers", 1, "--set", "output.layout=shards", "--set", "output.meshes.convert=auto")

    def contents(out: str) -> dict[str, bytes]:
        top = folder / out
        return {
            str(path.relative_to(top)): path.read_bytes()
            for path in sorted(top.rglob("*"))
            if path.is_file() and path.name != "timing.json"
        }

    cli("run", "run.yaml", "-o", "out", *words)
    first = contents("out")
    copies = sorted(name for name in first if name.startswith("meshes/"))
    assert [Path(name).suffix for name in copies] == [".obj", ".obj"]
    mesh_conversion._converted_file.cache_clear()
    cli("run", "run.yaml", "-o", "again", *words)
    assert contents("again") == first
    (folder / "out" / copies[0]).unlink()
    cli("run", "run.yaml", "-o", "out", "--resume", *words)
    assert contents("out") == first
    cli("run", "run.yaml", "-o", "out", *words[:-1], "output.meshes.convert=hull")
    assert sum(name.startswith("meshes/") for name in contents("out")) == 4
    cli("run", "run.yaml", "-o", "out", *words[:-1], "output.meshes=relative")
    assert sorted(path.suffix for path in (folder / "out/meshes").iterdir()) == [".dae", ".stl"]


# --- What is refused --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("suffix", "content", "message"),
    [
        (".stl", wedge().export(file_type="stl")[:-60], "it has no triangles"),
        (".obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 2 3 4\n", "at no finite place"),
        (".dae", b"PK\x03\x04" + bytes(100), "it is a ZIP archive"),
        (".dae", '<!DOCTYPE a [<!ENTITY b "c">]><COLLADA/>'.encode("utf-16"), "it has a document type"),
    ],
)
def test_a_hostile_mesh_is_refused(suffix: str, content: bytes, message: str) -> None:
    """Whatever is wrong with it."""
    with pytest.raises(Exception, match=message):
        forms_of(content, suffix, ONE, MeshConversion.AUTO)


class TestRefusals:
    @pytest.fixture(autouse=True)
    def _in(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.chdir(folder)
        mesh_conversion._converted_file.cache_clear()

    def convert(self, mesh: str) -> None:
        body = {"mass": 1, "com": [0, 0, 0], "inertia": {"ixx": 1, "iyy": 1, "izz": 1}}
        joints = [{"a": 0.3, "alpha": 0, "d": 0.1, "mesh": mesh, **body}]
        Path("arm.yaml").write_text(json.dumps({"convention": "standard", "joints": joints}))
        dh2urdf.convert("arm.yaml", "out/arm.urdf", convert_meshes="auto")

    def test_it_is_said_of_which_link(self) -> None:
        """And nothing is written."""
        Path("bad.obj").write_text("v 0 0 0\n")
        with pytest.raises(
            EmitterError, match=r"link 'link_1': the mesh 'bad\.obj' cannot be converted: it has no tri"
        ):
            self.convert("bad.obj")
        assert not list(Path("out").rglob("*.*"))

    @pytest.mark.long
    def test_a_scene_of_scenes_of_scenes_ends_in_time(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Thirty nodes, each of which is the next one twice: a thousand million meshes."""
        nodes = "".join(
            f'<node id="k{n}"><instance_node url="#k{n + 1}"/><instance_node url="#k{n + 1}"/></node>'
            for n in range(30)
        )
        end = '<node id="k30"><instance_geometry url="#g"/></node>'
        text = collada(wedge(), node='<instance_node url="#k0"/>')
        text = text.replace(
            "<library_visual_scenes>", f"<library_nodes>{end}{nodes}</library_nodes><library_visual_scenes>"
        )
        Path("bomb.dae").write_text(text)
        monkeypatch.setitem(mesh_conversion.SECONDS, MeshConversion.AUTO, 5.0)
        with pytest.raises((CrashError, EmitterError), match=r"mesh 'bomb\.dae'"):
            self.convert("bomb.dae")
