import math
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from plain_frames import tensor

from dh2urdf.columns import in_columns
from dh2urdf.errors import MissingDependencyError, TransformError
from dh2urdf.manipulator import Inertia, JointType, Manipulator, MeshFile, MeshShape
from dh2urdf.meshes import find_mesh
from dh2urdf.robot import Mesh, Robot
from dh2urdf.rotations import RigidTransform
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.meshes import mesh_body
from dh2urdf_plugins.transforms.robots import alpha_swap, alpha_swap_columns

ONE = (1.0, 1.0, 1.0)
BOX = (0.1, 0.2, 0.3)
Z_UP = "<up_axis>Y_UP</up_axis>", "<up_axis>Z_UP</up_axis>"


@pytest.fixture
def saved(tmp_path: Path) -> Callable[..., MeshFile]:
    """A mesh as a file."""

    def save(mesh: Any, name: str = "link.stl", *change: str) -> MeshFile:
        path = tmp_path / name
        mesh.export(path)
        if change:
            path.write_text(path.read_text().replace(*change))
        return find_mesh(name, tmp_path)

    return save


def wedge(at: tuple[float, float, float] = (0.3, -0.2, 0.1)) -> Any:
    """A closed body without any symmetry, away from its origin."""
    mesh = trimesh.creation.icosphere(subdivisions=2)
    mesh.vertices = mesh.vertices * (0.1, 0.2, 0.3) + 0.1 * mesh.vertices[:, [1, 2, 0]] ** 2 + at
    return mesh


class TestBodies:
    @pytest.mark.parametrize("name", ["link.stl", "link.obj", "link.dae"])
    @pytest.mark.parametrize("scale", [ONE, (0.001, 0.001, 0.001), (1.0, 2.0, 0.5), (1.0, -1.0, 1.0)])
    def test_a_closed_mesh_weighs_what_it_encloses(
        self, name: str, scale: tuple[float, float, float], saved: Callable[..., MeshFile]
    ) -> None:
        """As trimesh's own integrals have it, in every format, at every scale, mirrored too."""
        file = saved(wedge(), name, *(Z_UP if name.endswith(".dae") else ()))
        body = mesh_body(file, scale)
        oracle = wedge()
        oracle.apply_transform(np.diag([*scale, 1.0]))
        assert body.is_closed
        assert body.solid.mass == pytest.approx(oracle.volume, rel=1e-5)  # single precision in the files
        assert body.solid.com == pytest.approx(oracle.center_mass, rel=1e-5)
        assert tensor(body.solid.inertia) == pytest.approx(oracle.moment_inertia, rel=1e-4, abs=1e-6 * oracle.volume)

    def test_a_box_is_a_box(self, saved: Callable[..., MeshFile]) -> None:
        """By the formula of solid boxes, with no noise where its symmetry has zeros."""
        mesh = trimesh.creation.box(BOX)
        mesh.apply_translation((0.5, 0.0, 0.0))
        body = mesh_body(saved(mesh), ONE).solid
        x, y, z = BOX
        assert body.mass == pytest.approx(x * y * z, rel=1e-6)
        assert body.com[0] == pytest.approx(0.5, rel=1e-6)
        assert body.com[1:] == (0.0, 0.0)
        assert (body.inertia.ixy, body.inertia.ixz, body.inertia.iyz) == (0.0, 0.0, 0.0)
        assert body.inertia.ixx == pytest.approx(body.mass / 12 * (y * y + z * z), rel=1e-5)

    def test_triangles_may_be_seen_from_inside(self, saved: Callable[..., MeshFile]) -> None:
        """Whoever exports them the wrong way round gets the same body."""
        inverted = wedge()
        inverted.invert()
        one, other = mesh_body(saved(wedge()), ONE), mesh_body(saved(inverted, "inside_out.stl"), ONE)
        assert other.is_closed
        assert other.solid.mass == pytest.approx(one.solid.mass, rel=1e-12)
        assert tensor(other.solid.inertia) == pytest.approx(tensor(one.solid.inertia), rel=1e-12)

    def test_an_open_mesh_weighs_what_its_hull_encloses(self, saved: Callable[..., MeshFile]) -> None:
        """A box without a lid is a box."""
        mesh = trimesh.creation.box(BOX)
        mesh.update_faces([True] * 10 + [False] * 2)
        body = mesh_body(saved(mesh), ONE)
        assert not body.is_closed
        assert body.solid.mass == pytest.approx(math.prod(BOX), rel=1e-5)

    def test_a_mesh_stands_where_its_scene_has_it(self, saved: Callable[..., MeshFile]) -> None:
        """A COLLADA file is a scene of nodes."""
        moved = ("<instance_geometry", "<translate>1 0 0</translate><instance_geometry")
        body = mesh_body(saved(trimesh.creation.box(BOX), "link.dae", *moved), ONE)
        assert body.solid.com == pytest.approx((1.0, 0.0, 0.0), abs=1e-6)
        assert body.size == pytest.approx(0.3, rel=1e-5)

    @pytest.mark.parametrize(
        ("said", "unit", "turn"),
        [
            ("<up_axis>Y_UP</up_axis>", 1.0, [[1, 0, 0], [0, 0, -1], [0, 1, 0]]),
            ("", 1.0, [[1, 0, 0], [0, 0, -1], [0, 1, 0]]),
            ('<unit name="mm" meter="0.001"/><up_axis>X_UP</up_axis>', 0.001, [[0, -1, 0], [0, 0, -1], [1, 0, 0]]),
            ('<unit meter="25.4e-3"/><up_axis> Z_UP\n</up_axis>', 0.0254, np.eye(3)),
        ],
    )
    def test_a_collada_file_has_its_unit_and_its_axes(
        self, said: str, unit: float, turn: Any, saved: Callable[..., MeshFile]
    ) -> None:
        """Those that its asset names: metres and y up where it names none."""
        body = mesh_body(saved(wedge(), "link.dae", Z_UP[0], said), ONE).solid
        oracle = wedge()
        oracle.apply_transform(np.block([[unit * np.array(turn), np.zeros((3, 1))], [np.zeros(3), np.ones(1)]]))
        assert body.mass == pytest.approx(oracle.volume, rel=1e-5)
        assert body.com == pytest.approx(oracle.center_mass, rel=1e-5)
        assert tensor(body.inertia) == pytest.approx(
            oracle.moment_inertia, rel=1e-4, abs=1e-5 * oracle.volume * unit**2
        )

    def test_a_flat_mesh_is_no_body(self, saved: Callable[..., MeshFile]) -> None:
        """One sheet, or none at all."""
        sheet = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]])
        with pytest.raises(TransformError, match="is flat"):
            mesh_body(saved(sheet), ONE)

    @pytest.mark.parametrize(
        ("name", "content", "message"),
        [
            (
                "link.dae",
                '<!DOCTYPE x [<!ENTITY s SYSTEM "file:///etc/passwd">]><COLLADA version="1.4.1"><asset>&s;</asset></COLLADA>',
                "'link.dae' cannot be read as DAE: it has a document type",
            ),
            ("link.dae", "PK\x03\x04 of a megabyte of zeros", "as DAE: it is a ZIP archive"),
            ("link.dae", '<COLLADA><asset><unit meter="-1"/></asset></COLLADA>', "link.dae"),
            ("link.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "as OBJ: it has no triangle whose corners"),
            ("link.obj", "v 0 0 0\nv 1 0 0\nf 1 2 999999999999\n", "cannot be read as OBJ: index 999999999998"),
            ("link.stl", "\0" * 80 + "\x7f" * 4 + "\0" * 100, "link"),
        ],
    )
    def test_a_hostile_mesh_is_refused(self, name: str, content: str, message: str, tmp_path: Path) -> None:
        """No file beside it is read, and none makes an internal error."""
        (tmp_path / name).write_bytes(content.encode("latin-1"))
        with pytest.raises(TransformError, match=message):
            mesh_body(find_mesh(name, tmp_path), ONE)


class TestLinks:
    def test_a_link_weighs_its_mesh_times_the_density(
        self, three_axes: Manipulator, robot_of: Callable[..., Robot], saved: Callable[..., MeshFile]
    ) -> None:
        """A given mass scales the mesh's inertia, a given centre of mass carries it along."""
        shape = MeshShape(file=saved(wedge()))
        rows = list(three_axes.rows)
        rows[1] = replace(rows[1], visual=shape)
        rows[2] = replace(rows[2], visual=shape, mass=5.0, com=(0.1, 0.2, 0.3))
        robot = robot_of(replace(three_axes, rows=tuple(rows)), density=1000.0, frames="dh")
        light, heavy = (link.inertial for link in robot.links[3:5])
        assert light is not None
        assert heavy is not None
        assert light.mass == pytest.approx(1000 * wedge().volume, rel=1e-5)
        # The DH frame of row 2 stands 1 m along x of the link's, not turned.
        assert light.com == pytest.approx(wedge().center_mass + np.array([1, 0, 0]), rel=1e-5)
        assert (heavy.mass, heavy.com) == (5.0, pytest.approx((1.1, 0.2, 0.3)))
        assert tensor(heavy.inertia) == pytest.approx(tensor(light.inertia) * 5.0 / light.mass, rel=1e-9)

    def test_a_mesh_takes_the_place_of_all_shapes_of_its_link(
        self, three_axes: Manipulator, robot_of: Callable[..., Robot], saved: Callable[..., MeshFile]
    ) -> None:
        """What is seen or touches alone, too; COLLADA files keep their own colours."""
        stl, dae = MeshShape(file=saved(wedge())), MeshShape(file=saved(wedge(), "link.dae", *Z_UP))
        one, two, three = three_axes.rows
        rows = (replace(one, visual=stl), replace(two, collision=stl), replace(three, visual=dae, collision=dae))
        plain, robot = robot_of(three_axes), robot_of(replace(three_axes, rows=rows))
        first, second, third = robot.links[2:5]
        assert [visual.geometry for visual in first.visuals] == [Mesh(filename=f"file://{stl.file.path}")]
        assert first.visuals[0].material is not None
        assert first.collisions == plain.links[2].collisions
        assert second.visuals == plain.links[3].visuals
        assert len(second.collisions) == len(third.visuals) == len(third.collisions) == 1
        assert third.visuals[0].material is None

    def test_the_base_can_be_a_mesh(
        self, three_axes: Manipulator, robot_of: Callable[..., Robot], saved: Callable[..., MeshFile]
    ) -> None:
        """In the DH frame before the first row, whichever frames the links get; what is asked for touches."""
        shape = MeshShape(file=saved(wedge()), pose=RigidTransform.from_xyz_rpy((0.0, 0.1, 0.0)))
        base = RigidTransform.from_xyz_rpy((0.0, 0.0, 2.0), (0.0, 0.0, math.pi / 2))
        table = replace(three_axes, base=base, base_visual=shape, base_collision=shape)
        for frames in ("aligned", "dh"):
            robot = robot_of(table, frames=frames)
            (visual,), (collision,) = robot.links[1].visuals, robot.links[1].collisions
            assert visual.origin == collision.origin
            world = robot.joints[0].origin.transform @ visual.origin.transform
            assert world.translation == pytest.approx((-0.1, 0.0, 2.0))
            assert world.rpy == pytest.approx((0.0, 0.0, math.pi / 2))

    def test_nobody_reads_a_mesh_whose_mass_is_given(
        self,
        three_axes: Manipulator,
        robot_of: Callable[..., Robot],
        saved: Callable[..., MeshFile],
        monkeypatch: pytest.MonkeyPatch,
    ) -> None:
        """Mass, centre and inertia in the table are enough, without any package; with less, it is named."""
        monkeypatch.setitem(sys.modules, "trimesh", None)
        body = {"mass": 1.0, "com": (0.0, 0.0, 0.0), "inertia": Inertia(ixx=1.0, iyy=1.0, izz=1.0)}
        rows = [replace(row, visual=MeshShape(file=saved(wedge())), **body) for row in three_axes.rows]
        robot = robot_of(replace(three_axes, rows=tuple(rows)))
        assert robot.links[3].inertial.mass == 1.0  # type: ignore[union-attr]
        mesh_body.cache_clear()
        rows[1] = replace(rows[1], inertia=None)
        with pytest.raises(MissingDependencyError, match=r"trimesh: .* -m pip install 'dh2urdf\[meshes\]'"):
            robot_of(replace(three_axes, rows=tuple(rows)))

    def test_joints_resist_as_the_run_says_where_the_table_is_silent(
        self, table: Callable[..., Manipulator], robot_of: Callable[..., Robot]
    ) -> None:
        """0 is an answer too; a fixed joint resists nothing."""
        arm = table({"a": 1.0}, {"a": 1.0, "damping": 0.0, "armature": 0.3}, {"type": JointType.FIXED, "a": 0.1})
        joints = robot_of(arm, damping=0.5, friction=0.25, armature=0.1).joints
        assert [(joint.damping, joint.friction, joint.armature) for joint in joints[:4]] == [
            (None, None, None),
            (0.5, 0.25, 0.1),
            (0.0, 0.25, 0.3),
            (None, None, None),
        ]


class TestProblems:
    @pytest.mark.parametrize(
        ("change", "scale", "code"),
        [
            (Z_UP, 1000.0, "mesh-size-odd"),
            (Z_UP, 1e-3, "mesh-size-odd"),
            (("Y_UP", "Y_UP"), 1.0, "mesh-of-own-up"),
            (("<up_axis>Y_UP</up_axis>", ""), 1.0, "mesh-of-own-up"),
            ((Z_UP[0], '<unit meter="0.001" name="mm"/><up_axis>Z_UP</up_axis>'), 1000.0, "mesh-of-own-unit"),
        ],
    )
    def test_what_is_probably_meant_otherwise_is_noticed(
        self, change: tuple[str, str], scale: float, code: str, three_axes: Manipulator, saved: Callable[..., MeshFile]
    ) -> None:
        """A mesh far too large or too small for an arm, and axes and units that readers of COLLADA take in two ways."""
        shape = MeshShape(file=saved(wedge(), "link.dae", *change), scale=(scale,) * 3)
        (notice,) = made_with(three_axes, shape).notices
        assert notice.code == code

    @pytest.mark.parametrize(("name", "scale"), [("link.ply", ONE), ("link.stl", (1.0, 0.0, 1.0))])
    def test_what_no_simulator_takes_is_refused(
        self, name: str, scale: tuple[float, float, float], three_axes: Manipulator, saved: Callable[..., MeshFile]
    ) -> None:
        """With the joint."""
        with pytest.raises(TransformError) as caught:
            made_with(three_axes, MeshShape(file=saved(wedge(), name), scale=scale))
        assert caught.value.problems[0].joint == "joint_1"


def made_with(table: Manipulator, shape: MeshShape) -> Robot:
    """The robot whose first link is drawn by a mesh."""
    rows = (replace(table.rows[0], visual=shape), *table.rows[1:])
    return alpha_swap(replace(table, rows=rows), AlphaSwapOptions())


class TestColumns:
    def made(self, table: Manipulator, shape: MeshShape) -> tuple[list[Manipulator], Any]:
        """Ten tables that differ in numbers, and what is made of them side by side."""
        tables = []
        for number in range(1, 11):
            rows = [replace(row, a=row.a + 0.01 * number, alpha=row.alpha + 0.1 * number) for row in table.rows]
            rows[1] = replace(rows[1], visual=shape, collision=shape, friction=0.1 * number)
            tables.append(replace(table, name=f"arm_{number}", rows=tuple(rows)))
        ((_, columns),) = in_columns(tables)
        return tables, alpha_swap_columns(columns, AlphaSwapOptions())

    def test_meshes_side_by_side_stand_as_one_by_one(
        self, three_axes: Manipulator, saved: Callable[..., MeshFile]
    ) -> None:
        """To the last bit, masses too."""
        pose = RigidTransform.from_xyz_rpy((0.1, 0.2, 0.3), (0.3, 0.2, 0.1))
        tables, groups = self.made(three_axes, MeshShape(file=saved(wedge()), pose=pose))
        made = {place: robots.pick(index) for places, robots in groups for index, place in enumerate(places)}
        assert len(made) == 10
        for place, robot in made.items():
            assert robot == alpha_swap(tables[place], AlphaSwapOptions())
