"""Edits of the arm in a session: the drawing, the sliders and the files are those of the edited arm."""

import io
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from plain_frames import shift
from two_fingers import HAND, hand_frames

import dh2urdf
import dh2urdf_studio
from dh2urdf.errors import Dh2UrdfError
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.plugin_system import Catalog
from dh2urdf_studio.drawing.scene import Figure
from dh2urdf_studio.editing import edits, save
from dh2urdf_studio.editing.opening import gallery_table
from dh2urdf_studio.editing.session import Session

UR5 = Path(dh2urdf_studio.__file__).parent / "arms" / "ur5.csv"
ATTACH = f"attach: {{file: {HAND}, name: hand, xyz: [0, 0, 11 mm]}}"


@pytest.fixture
def session(catalog: Catalog) -> Session:
    return Session(catalog, gallery_table("ur5.csv", catalog))


def poses(session: Session) -> dict[str, np.ndarray[Any, Any]]:
    """Where the nodes of the scene are, by their names."""
    names = [node.name for node in session.drawing.nodes]
    found = session.drawing.poses(session.joint_values())
    return {name: as_matrices(pose) for name, pose in zip(names, found, strict=True)}


def test_a_hand_is_drawn_and_moves(session: Session) -> None:
    """Its links hang on tool0, its joint has a slider below the arm's, and the follower follows by the file's law."""
    sliders = [slider.name for slider in session.sliders]
    session.edit_arm([ATTACH])
    assert session.problems == ()
    assert [slider.name for slider in session.sliders] == [*sliders, "hand_left"]
    (body,) = (node for node in session.drawing.nodes if node.name == "hand_base_link")
    assert [part.size for part in body.parts if part.layer == "links"] == [(0.1, 0.04, 0.04)]
    session.move(dict.fromkeys(session.q, 0.3) | {"hand_left": 0.0})
    every = poses(session)
    for left in (0.0, 0.25):
        session.move({"hand_left": left})
        found = poses(session)
        for link, wanted in hand_frames(left).items():
            assert np.allclose(found[f"hand_{link}"], every["tool0"] @ shift(z=0.011) @ wanted, atol=1e-12), link
    assert np.allclose(poses(session)["tool0"], every["tool0"])


def test_the_target_is_the_tip(session: Session) -> None:
    """Its own joint moves a tip on a finger, too; Pinocchio has the tip where it was wanted."""
    pinocchio = pytest.importorskip("pinocchio")
    session.edit_arm([ATTACH.replace("name: hand", "name: hand, tip: left_finger")])
    assert session.tool == "hand_left_finger"
    assert session.drawing.as_json()["tool"] == "hand_left_finger"
    session.move({"shoulder_lift_joint": -1.2, "elbow_joint": 1.4, "wrist_1_joint": -0.8, "hand_left": 0.3})
    wanted = session.tool_pose
    assert wanted is not None
    assert np.allclose(as_matrices(wanted), poses(session)["hand_left_finger"], atol=1e-12)
    session.move({"elbow_joint": 1.3, "hand_left": 0.1, "wrist_3_joint": 0.2})
    values, found = session.search(wanted)
    assert found.reached
    assert "hand_left" in values
    session.move(values)
    urdf = save.saved(session.table, "robot", "urdf", "exact", session.catalog, session.changes).content
    model = pinocchio.buildModelFromXML(urdf.decode(), mimic=True)
    data, q = model.createData(), pinocchio.neutral(model)
    for name, value in session.q.items():
        q[model.joints[model.getJointId(name)].idx_q] = value
    pinocchio.framesForwardKinematics(model, data, q)
    tip = data.oMf[model.getFrameId("hand_left_finger")].homogeneous
    assert np.allclose(tip, as_matrices(wanted), atol=1e-8)
    session.edit_arm([ATTACH])
    assert (session.tool, session.tool_pose) == ("tool0", session.pose)


def test_fingers_are_dragged(session: Session) -> None:
    """The finger that follows moves the one that leads: 5 mm of it are 0.1 rad."""
    session.edit_arm([ATTACH])
    session.drag("hand_right_finger", 0.005, begins=True)
    assert session.q["hand_left"] == pytest.approx(-0.1)
    session.show_variant("both")
    session.drag("paper/hand_left_finger", 0.2, begins=True)
    assert session.q["hand_left"] == pytest.approx(0.1)
    assert session.other_error is not None
    session.show_variant("exact")
    arm = session.arm
    assert arm is not None
    session.lay_beside(Figure(robot=arm.robot))  # of as many joints as the table has
    session.drag("hand_left_finger", 0.1, begins=True)
    assert session.q["hand_left"] == pytest.approx(0.2)


def test_edits_have_a_past(session: Session) -> None:
    """Undo takes them away one by one, redo brings them back, and the table is none of their business."""
    rows, plain = session.table.rows, [node.name for node in session.drawing.nodes]
    session.edit_arm([ATTACH])
    session.edit_arm([ATTACH, "payload: {mass: 2}"])
    session.edit(1, "a", "-0.5")
    assert len(session.arm_edits) == 2
    session.undo()
    assert (session.table.rows, len(session.arm_edits)) == (rows, 2)
    session.undo()
    assert session.arm_edits == (ATTACH,)
    session.undo()
    assert (session.arm_edits, [node.name for node in session.drawing.nodes]) == ((), plain)
    session.redo()
    assert "hand_left_finger" in poses(session)
    session.open(gallery_table("scara.csv", session.catalog))
    assert "hand_left_finger" in poses(session), "another table has the same hand"


def test_an_edited_table_is_drawn_and_the_grid_stays(session: Session, catalog: Catalog) -> None:
    """The arm is that of a table with the edited cell, its joints have their new names, and the cells their texts."""
    rows = session.table.rows
    session.move({"elbow_joint": 0.4})
    session.edit_arm(["values: {elbow_joint: {a: '*1.5'}}", "rename: {prefix: left_}"])
    assert session.problems == ()
    assert session.table.rows == rows
    assert session.q["left_elbow_joint"] == 0.4
    typed = Session(catalog, edits.with_cells(session.table, {(2, "a"): "-0.39225*1.5"}))
    typed.move({"elbow_joint": 0.4})
    assert session.pose is not None
    assert typed.pose is not None
    assert np.allclose(as_matrices(session.pose), as_matrices(typed.pose), atol=1e-12)
    assert np.allclose(poses(session)["tool0"], as_matrices(typed.pose), atol=1e-12)
    session.layers |= {"parameters"}
    labels = {stroke.row: stroke.label for stroke in session.strokes() if stroke.field == "a"}
    assert "0.588375" in labels[2].replace("−", "-")


@pytest.mark.parametrize(
    "wrong",
    [
        "limits: {margin: 400 deg}",
        "attach: {fil: hand.urdf}",
        "attach: {file: gone.urdf, name: more}",
        "no-such-edit",
        "payload: {mass: 2",
    ],
)
def test_a_wrong_edit_is_named(session: Session, wrong: str) -> None:
    """With the message of the command line; the last good arm stays, and the edits that are right are not blamed."""
    session.edit_arm([ATTACH])
    good = session.arm
    session.edit_arm([ATTACH, wrong, "payload: {mass: 1}"])
    assert {found.edit for found in session.problems} == {1}
    assert session.arm is good
    with pytest.raises(Dh2UrdfError) as raised:
        dh2urdf.convert(UR5, edits=[wrong])
    assert session.problems[0].problem.message in str(raised.value)
    assert "table.csv" not in session.problems[0].text, "nobody has seen that file"
    session.undo()
    assert session.problems == ()


def test_notices_of_edits_are_kept(session: Session) -> None:
    """What an edit notices belongs to the arm; an arm without edits has none."""
    assert session.arm is not None
    assert session.arm.remarks == ()
    session.edit_arm(["rename: {pattern: zzz, replacement: y}"])
    assert len(session.arm.remarks) == 1


def test_the_file_of_an_attachment_is_read_again_when_it_is_added_again(session: Session, tmp_path: Path) -> None:
    """While it is attached it is read once, however much is typed."""
    path = tmp_path / "hand.urdf"
    shutil.copy(HAND, path)
    text = f"attach: {{file: {path}, name: hand}}"
    session.edit_arm([text])
    path.write_text(HAND.read_text("utf-8").replace("left_finger", "thumb"), "utf-8")
    session.edit(1, "a", "-0.5")
    assert "hand_left_finger" in poses(session)
    saved = save.saved(session.table, "robot", "urdf", "exact", session.catalog, session.changes)
    assert b"hand_left_finger" in saved.content, "what is saved is what is drawn"
    session.edit_arm([])
    session.edit_arm([text])
    assert "hand_thumb" in poses(session)


# --- Files ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("form", ["urdf", "xacro", "sdf", "mjcf"])
def test_files_are_those_of_convert(catalog: Catalog, cli: Callable[..., Any], tmp_path: Path, form: str) -> None:
    """Byte by byte what `dh2urdf convert --edit` makes of the saved table."""
    given = [ATTACH, "payload: {mass: 2 kg}"]
    session = Session(catalog, gallery_table("ur5.csv", catalog), given)
    table = session.table
    saved = save.table_file(table, "csv", catalog)
    (tmp_path / saved.name).write_bytes(saved.content)
    made = save.saved(table, "robot", form, "exact", catalog, session.changes)
    words = [word for text in given for word in ("--edit", text)]
    assert made.content == cli("convert", saved.name, "--to", form, *words).stdout.encode()
    # In a xacro the names are those of the file of the hand, and the prefix comes with the call.
    assert (b"left_finger" if form == "xacro" else b"hand_left_finger") in made.content


@pytest.mark.long
def test_a_zip_has_the_meshes(catalog: Catalog, cli: Callable[..., Any], tmp_path: Path) -> None:
    """Every mesh that a description names is in the zip, and its run file makes the edited arm; the mesh is drawn."""
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box((0.01, 0.02, 0.03)).export(tmp_path / "finger.stl")
    body = '<visual><geometry><mesh filename="finger.stl"/></geometry></visual>'
    text = HAND.read_text("utf-8").replace('<link name="tool0"/>', f'<link name="tool0">{body}</link>')
    (tmp_path / "hand.urdf").write_text(text, "utf-8")
    given = [f"attach: {{file: {tmp_path / 'hand.urdf'}, name: hand}}", "limits: {margin: 3 deg}"]
    session = Session(catalog, gallery_table("ur5.csv", catalog), given)
    assert [mesh.path for mesh in session.drawing.meshes.values()] == [tmp_path / "finger.stl"]
    content = save.saved(session.table, "all", "", "exact", catalog, session.changes).content
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        archive.extractall(tmp_path)
        names = archive.namelist()
    (mesh,) = [name for name in names if name.startswith("meshes/")]
    urdf = (tmp_path / "ur5.urdf").read_text("utf-8")
    assert mesh in urdf
    assert (tmp_path / mesh).read_bytes() == (tmp_path / "finger.stl").read_bytes()
    cli("run", "ur5_run.yaml")
    (made,) = (path.read_text("utf-8") for path in (tmp_path / "build").rglob("ur5.urdf"))
    assert made.replace("../meshes/", "meshes/") == urdf
