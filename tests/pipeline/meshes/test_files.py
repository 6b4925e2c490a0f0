from hashlib import sha256
from pathlib import Path

import pytest

from dh2urdf.errors import ConfigError, OutputError
from dh2urdf.manipulator import JointType, MeshFile
from dh2urdf.meshes import copy_name, find_mesh, has_meshes, read_mesh
from dh2urdf.meshes.files import copy_path, located, mesh_files, prefix_of
from dh2urdf.robot import Arm, Box, Collision, Inertial, Joint, Link, Mesh, Origin, Robot, Visual


@pytest.fixture
def file(tmp_path: Path) -> MeshFile:
    (tmp_path / "Upper Arm.STL").write_bytes(b"solid")
    return find_mesh("Upper Arm.STL", tmp_path)


def robot_of(file: MeshFile | None, name: str = "arm") -> Robot:
    """A robot of one link that is a mesh and a box."""
    mesh = Mesh(filename="file:///somewhere", scale=(2.0, 1.0, 1.0), file=file)
    shapes = (Visual(geometry=mesh), Visual(geometry=Box(size=(1.0, 1.0, 1.0))))
    links = (Link(name="base_link"), Link(name="one", visuals=shapes, collisions=(Collision(geometry=mesh),)))
    joints = (Joint(name="j", type=JointType.FIXED, parent="base_link", child="one"),)
    return Robot(name=name, links=links, joints=joints)


class TestFiles:
    def test_a_changed_file_is_another_one(self, tmp_path: Path) -> None:
        """Though many manipulators share what is read of a file."""
        path = tmp_path / "link.stl"
        hashes = []
        for content in (b"solid", b"solid two"):
            path.write_bytes(content)
            hashes.append(find_mesh("link.stl", tmp_path).sha256)
        assert hashes == [sha256(b"solid").hexdigest(), sha256(b"solid two").hexdigest()]

    @pytest.mark.parametrize("text", ["link.stl", "shared/far.stl", "./shared/../link.stl", "../other/back.stl"])
    def test_a_link_out_of_the_folder_is_refused_unless_it_is_allowed(self, tmp_path: Path, text: str) -> None:
        """A table may come from a stranger, with links to files of its reader; the target is named."""
        table, other = tmp_path / "table", tmp_path / "other"
        for folder in (table, other, tmp_path / "far"):
            folder.mkdir()
        (tmp_path / "far/far.stl").write_bytes(b"solid")
        for link in (table / "link.stl", other / "back.stl"):
            link.symlink_to(tmp_path / "far/far.stl")
        (table / "shared").symlink_to(tmp_path / "far")
        with pytest.raises(ConfigError, match=r"is a link out of the folder '.*', to '.*far\.stl'") as caught:
            find_mesh(text, table)
        assert "mesh_links: true" in str(caught.value.problems[0])
        assert find_mesh(text, table, links=True).sha256 == sha256(b"solid").hexdigest()

    @pytest.mark.parametrize("text", ["in.stl", "linked/link.stl", "../other/mesh.stl", "../other/near.stl"])
    def test_other_links_are_followed(self, tmp_path: Path, text: str) -> None:
        """Within the folder, or within another one that the table names by its path; the folder itself may be a link."""
        table, other = tmp_path / "real", tmp_path / "other"
        for folder in (table / "meshes", other):
            folder.mkdir(parents=True)
        for file in (table / "meshes/link.stl", other / "mesh.stl"):
            file.write_bytes(b"solid")
        (table / "in.stl").symlink_to("meshes/link.stl")
        (table / "linked").symlink_to("meshes")
        (other / "near.stl").symlink_to("mesh.stl")
        (tmp_path / "table").symlink_to("real")
        assert find_mesh(text, tmp_path / "table").sha256 == sha256(b"solid").hexdigest()

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("lnik.stl", "did you mean"),
            ("no/such.stl", "there is no folder"),
            ("folder", "this is a folder"),
            ("package://arm/link.stl", "is an address, not a path"),
            ("li\0nk.stl", "null"),
        ],
    )
    def test_what_is_no_file_is_refused(self, text: str, message: str, tmp_path: Path) -> None:
        """With the place where it was looked for, where there is one."""
        (tmp_path / "link.stl").touch()
        (tmp_path / "folder").mkdir()
        with pytest.raises(ConfigError, match=message) as caught:
            find_mesh(text, tmp_path)
        (problem,) = caught.value.problems
        assert problem.found == text
        if "://" not in text:
            assert "it was looked for at" in str(problem)

    def test_a_file_that_changes_meanwhile_is_not_copied(self, file: MeshFile) -> None:
        """What is read is what the table's reader has seen, or nothing."""
        assert read_mesh(file) == b"solid"
        Path(file.path).write_bytes(b"other")
        with pytest.raises(OutputError, match="has changed since its table was read"):
            read_mesh(file)
        Path(file.path).unlink()
        with pytest.raises(OutputError, match="cannot be read"):
            read_mesh(file)

    def test_the_name_of_a_copy_is_safe_and_its_content_s(self, file: MeshFile) -> None:
        """Two files of one name do not get in each other's way."""
        assert copy_name(file) == f"Upper_Arm-{file.sha256[:8]}.stl"
        assert copy_path(file) == f"meshes/{copy_name(file)}"
        assert copy_name(MeshFile(path=file.path, sha256="0" * 64)) != copy_name(file)


class TestNames:
    @pytest.mark.parametrize("word", ["", "absolute", "package://", "package://../x", "package://a b", "https://x"])
    def test_other_words_are_refused(self, word: str) -> None:
        """With all that are accepted; a package's name leads nowhere else."""
        with pytest.raises(ConfigError, match=r"relative: .*file: .*package://NAME"):
            prefix_of(word)

    def test_a_robot_names_its_copies(self, file: MeshFile) -> None:
        """What is seen and what touches, and nothing else changes."""
        robot = robot_of(file)
        changed = located(robot, "meshes/")
        visual, box = changed.links[1].visuals
        assert visual.geometry == Mesh(filename=f"meshes/{copy_name(file)}", scale=(2.0, 1.0, 1.0))
        assert changed.links[1].collisions[0].geometry == visual.geometry
        assert box == robot.links[1].visuals[1]
        assert mesh_files(changed) == (file,)
        assert located(robot, None) is robot

    def test_meshes_that_are_not_at_hand_keep_their_names(self) -> None:
        """Those of a description that was read."""
        robot = robot_of(None)
        assert located(robot, "meshes/") is robot
        assert has_meshes(robot)
        assert mesh_files(robot) == ()

    def test_arms_of_one_kind_stay_so(self, file: MeshFile) -> None:
        """In a cell: an emitter knows a kind by its identity."""
        kind = robot_of(file)
        arms = tuple(
            Arm(name=name, kind=kind, prefix=name, parent="world", placement=Origin()) for name in ("left", "right")
        )
        links = (Link(name="world", inertial=Inertial(mass=0.0)), *kind.links)
        changed = located(Robot(name="cell", links=links, joints=kind.joints, arms=arms), "../meshes/")
        left, right = (arm.kind for arm in changed.arms)
        assert left is right
        assert left.links[1].visuals[0].geometry == Mesh(filename=f"../meshes/{copy_name(file)}", scale=(2.0, 1.0, 1.0))
