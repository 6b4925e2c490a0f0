"""A description beside the table, in a real browser."""

import shutil
from pathlib import Path
from typing import Any

import pytest
import trimesh

import dh2urdf
import dh2urdf_studio

UR5 = Path(dh2urdf_studio.__file__).parent / "arms" / "ur5.csv"
COUNT = "document.querySelector('.arm-view').scene.children[0].children.filter(node => node.name.startsWith('description/')).length"


def with_meshes(folder: Path, text: str) -> Path:
    """A package with a URDF whose tool0 names a mesh that is there, and one that is not."""
    (folder / "meshes").mkdir(parents=True)
    (folder / "urdf").mkdir()
    trimesh.creation.icosphere(subdivisions=3, radius=0.07).export(folder / "meshes" / "ball.stl")
    meshes = "".join(
        f'<visual><geometry><mesh filename="package://arm_description/meshes/{name}"/></geometry></visual>'
        for name in ("ball.stl", "gone.stl")
    )
    assert text.count('<link name="tool0">') == 1
    (folder / "urdf" / "arm.urdf").write_text(text.replace('<link name="tool0">', f'<link name="tool0">{meshes}'))
    return folder


@pytest.mark.long
def test_a_description_lies_upon_the_arm(tab: Any, tmp_path: Path) -> None:
    """The arm's own URDF with an elbow that stands 3 mm off: the table of differences, and the two arms in one place."""
    text = dh2urdf.convert(UR5).text
    assert text.count('xyz="0 0 0.089159"') == 1
    path = tmp_path / "measured.urdf"
    path.write_text(text.replace('xyz="0 0 0.089159"', 'xyz="0 0 0.092159"'))
    page = tab.open("ur5")
    page.get_by_role("button", name="compare with a robot description").click()
    with page.expect_file_chooser() as choosing:
        page.get_by_role("button", name="Open a description").click()
    choosing.value.set_files(path)
    table = page.locator(".studio-differences")
    table.wait_for()
    rows = [row.split("\t") for row in table.inner_text().splitlines()]
    assert rows[0][-4:] == ["mm now", "° now", "mm at most", "° at most"]
    assert [row[0] for row in rows[1:3]] == ["axis of shoulder_pan_joint", "axis of shoulder_lift_joint"]
    assert [row[1:] for row in rows[1:3]] == [["0", "0", "0", "0"], ["3", "0", "3", "0"]]
    assert rows[-1] == ["tool0 and tool0", "3", "0", "3", "0"]
    told = page.locator(".studio-compared").inner_text()
    assert "measured.urdf: base_link to tool0, 6 moving joints" in told
    assert "With these entries the table is the same arm:\nbase: {xyz: [0, 0, 0.003], rpy: [0, 0, 0]}" in told

    # Its numbers are taken into the table: one cell, and one step of undo.
    page.get_by_role("button", name="Take its numbers over").click()
    page.get_by_text("The description is the arm of the table.").wait_for()
    tab.wait_for_cells(0, a="0", alpha="pi/2", d="0.092159")
    page.locator(".q-notification", has_text="1 cell has the description's numbers").wait_for()
    assert page.get_by_role("button", name="Take its numbers over").count() == 0
    page.get_by_role("button", name="undo").click()
    tab.wait_for_cell(0, "d", "0.089159")
    page.get_by_text("With these entries the table is the same arm").wait_for()

    # They move together, and the panel takes the description along when it closes.
    before = tab.pose("tool0")[0][3]
    tab.press("random pose")
    script = """before => {
        const {scene} = document.querySelector('.arm-view');
        scene.updateMatrixWorld();
        const [one, other] = ['tool0', 'description/tool0'].map(name => scene.getObjectByName(name).matrixWorld.elements);
        return one[12] !== before && one.every((x, i) => Math.abs(other[i] - x - (i === 14 ? 0.003 : 0)) < 1e-6);
    }"""
    page.wait_for_function(script, arg=before)

    # With the folder of its meshes it is drawn as it is; a mesh that is not there is named.
    folder = with_meshes(tmp_path / "arm_description", text)
    with page.expect_file_chooser() as choosing:
        page.get_by_role("button", name="Open a folder").click()
    choosing.value.set_files(folder)
    page.get_by_text(
        "1 mesh file was not found, and the links are drawn as sticks: package://arm_description/meshes/gone.stl"
    ).wait_for()
    drawn = """() => {
        const node = document.querySelector('.arm-view').scene.getObjectByName('description/tool0');
        let count = 0;
        node?.traverse(part => count += part.isMesh && part.geometry.attributes.normal?.itemSize === 4 ? (part.geometry.index ?? part.geometry.attributes.position).count / 3 : 0);
        return count;
    }"""
    page.wait_for_function(f"({drawn})() === 1280")

    drop_all(tab, folder, drawn)
    page.get_by_label("tip link of the description").click()
    page.get_by_role("option", name="link_3", exact=True).click()
    page.get_by_text("the description has 3 moving joints on this chain, the table 6").wait_for()
    page.get_by_role("button", name="compare with a robot description").click()
    page.wait_for_function(f"{COUNT} === 0")


def drop_all(tab: Any, folder: Path, drawn: str) -> None:
    """Drops a description with its meshes on the panel, in every way; what is dropped beside the panel is a table."""
    page = tab.page
    packed = Path(shutil.make_archive(str(folder.with_name("packed")), "zip", folder.parent, folder.name))
    for dropped in ([folder / "urdf" / "arm.urdf", folder / "meshes" / "ball.stl"], [folder], [packed]):
        page.get_by_role("button", name="Take it away").click()
        page.wait_for_function(f"{COUNT} === 0")
        tab.drop(".studio-panel:visible", *dropped)
        page.wait_for_function(f"({drawn})() === 1280")
    notes = folder.with_name("notes.pdf")
    notes.write_text("no table")
    tab.drop(".studio-panel:visible", notes)
    page.locator(".studio-compared", has_text="No description was found.").wait_for()
    other = UR5.with_name("scara.csv")
    for dropped, answer in (([notes], "This is not a file that can be opened"), ([UR5, other], "Open one file")):
        tab.drop(".arm-view", *dropped)
        page.locator(".q-notification", has_text=answer).get_by_role("button", name="Close").click()
        tab.expect(page.locator(".q-notification", has_text=answer)).to_have_count(0)
    tab.drop(".arm-view", other)
    tab.wait_for_table("scara")
    page.get_by_role("button", name="undo").click()
    tab.wait_for_table("ur5")
