from collections.abc import Callable
from pathlib import Path

import pytest

from dh2urdf.manipulator import Convention, DHRow, Manipulator
from dh2urdf.rotations import HALF_PI, RigidTransform
from dh2urdf.run_file.config import RunConfig, load_config
from dh2urdf.run_file.mesh_section import Shapes
from dh2urdf.stages import Rejected
from dh2urdf.tasks.given_meshes import MeshGiver


@pytest.fixture
def config(tmp_path: Path) -> Callable[..., RunConfig]:
    """A run file with some meshes, which are all there."""
    for name in ("arm.csv", "a.stl", "b.stl", "base.dae"):
        (tmp_path / name).touch()

    def load(meshes: str, *overrides: str) -> RunConfig:
        (tmp_path / "run.yaml").write_text(f"inputs: arm.csv\nmeshes: {meshes}\n")
        return load_config(tmp_path / "run.yaml", overrides)

    return load


def arm(name: str = "ur5") -> Manipulator:
    rows = tuple(DHRow(joint=joint, link=f"{joint}_link", a=0.1, alpha=0.0, d=0.0) for joint in ("pan", "lift"))
    return Manipulator(name=name, convention=Convention.STANDARD, rows=rows)


def test_meshes_go_to_the_joints_that_are_named(config: Callable[..., RunConfig]) -> None:
    """`mesh` is what is seen and what touches; paths lead from the run file; the base has its own."""
    meshes = config(
        "[{of: ur5, base: {visual: base.dae}, joints: {pan: {mesh: a.stl}, "
        "lift: {collision: {file: b.stl, xyz: [100 mm, 0, 0], rpy: [0, 0, 90 deg], scale: [1, 2, 3]}}}}]"
    ).meshes
    given = MeshGiver(meshes).give(arm())
    assert isinstance(given, Manipulator)
    pan, lift = given.rows
    assert pan.visual == pan.collision
    assert pan.visual is not None
    assert Path(pan.visual.file.path).name == "a.stl"
    assert lift.visual is None
    assert lift.collision is not None
    assert lift.collision.pose == RigidTransform.from_xyz_rpy((0.1, 0.0, 0.0), (0.0, 0.0, HALF_PI))
    assert lift.collision.scale == (1.0, 2.0, 3.0)
    assert given.base_visual is not None
    assert given.base_collision is None


def test_several_manipulators_can_share_meshes(config: Callable[..., RunConfig]) -> None:
    """`*` stands for any text, and nothing else for anything but itself; the last one that speaks of a joint holds."""
    meshes = config(
        "[{of: ur5*, joints: {pan: {visual: a.stl}}}, {of: 'ur5_[1]', joints: {pan: {visual: b.stl}}}]"
    ).meshes
    giver = MeshGiver(meshes)
    found = [giver.give(arm(name)) for name in ("ur5", "ur5_1", "ur5_[1]", "kr3")]
    assert [Path(one.rows[0].visual.file.path).stem if one.rows[0].visual else None for one in found] == [  # type: ignore[union-attr]
        "a",
        "a",
        "b",
        None,
    ]
    assert list(giver.left_over()) == []


def test_a_joint_that_is_not_there_fails_its_manipulator(config: Callable[..., RunConfig]) -> None:
    """With the place in the run file, what joints there are, and which was meant."""
    (rejected,) = [MeshGiver(config("{of: ur5, joints: {pam: {visual: a.stl}}}").meshes).give(arm())]
    assert isinstance(rejected, Rejected)
    (problem,) = rejected.problems
    assert str(problem.mark).endswith("run.yaml:2:28")
    assert problem.code == "mesh-joint-unknown"


def test_what_a_table_says_stays_where_the_run_file_is_silent(config: Callable[..., RunConfig]) -> None:
    """And gives way where it is not."""
    (call,) = config("{of: ur5, joints: {pan: {visual: a.stl}}}").meshes
    once = call.given_to(arm())
    assert isinstance(once, Manipulator)
    (other,) = config("{of: ur5, joints: {pan: {collision: b.stl}, lift: {visual: b.stl}}}").meshes
    twice = other.given_to(once)
    assert isinstance(twice, Manipulator)
    assert twice.rows[0].visual == once.rows[0].visual
    assert twice.rows[0].collision == twice.rows[1].visual
    assert Shapes() == Shapes(visual=None)


def test_a_mesh_of_a_setting_leads_from_the_working_directory(
    config: Callable[..., RunConfig], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As every other path of the command line, where the run file is elsewhere."""
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "c.stl").touch()
    monkeypatch.chdir(tmp_path / "here")
    found = config("{of: ur5, base: {mesh: a.stl}}", "meshes.0.base.mesh=c.stl")
    assert found.problems == ()
    shape = found.meshes[0].base.visual
    assert shape is not None
    assert shape.file.path.endswith("here/c.stl")


def test_how_descriptions_name_meshes_is_a_setting_of_the_output(config: Callable[..., RunConfig]) -> None:
    """It can be set on the command line, and knows the layout."""
    assert config("[]").output.mesh_prefix == "meshes/"
    assert config("[]", "output.layout=folders").output.mesh_prefix == "../meshes/"
    assert config("[]", "output.meshes=file").output.mesh_prefix is None
    for word in ("package://arm", "package://arm/"):
        assert config("[]", f"output.meshes={word}").output.mesh_prefix == "package://arm/meshes/"
