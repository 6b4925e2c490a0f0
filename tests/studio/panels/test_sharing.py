"""Links that hold a table, and pictures, in the browser."""

import base64
import io
import zlib
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from dh2urdf.kinematics import forward_kinematics
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.plugin_system import Catalog
from dh2urdf_studio.drawing.exports import FRAMES, LARGEST
from dh2urdf_studio.editing.edits import kept_table
from dh2urdf_studio.editing.opening import gallery_table

pytestmark = pytest.mark.long


def link_of(tab: Any) -> str:
    tab.choose("Save", "Link with this table")
    box = tab.page.get_by_label("link", exact=True)
    box.wait_for()
    return str(box.input_value())


def test_a_link_holds_the_table(tab: Any, new_tab: Callable[..., Any], catalog: Catalog) -> None:
    """Python reads the fragment too; another tab opens it, and nothing of it is asked of the server."""
    tab.open("panda")
    tab.type_into(2, "a", "0.0825 + 1e-3")
    link = link_of(tab)
    address, _, word = link.partition("#table=")
    assert address == tab.address
    text = zlib.decompress(base64.urlsafe_b64decode(word + "==="), wbits=-15).decode()
    table = kept_table(text)
    expected = gallery_table("panda.yaml", catalog)
    assert table is not None
    assert table.rows[0] == expected.rows[0]
    assert table.rows[2]["a"] == "0.0825 + 1e-3"
    tab.page.get_by_role("button", name="Close").click()
    other = new_tab(link)
    page = other.open()
    other.wait_for_status("7 axes and 1 fixed joint; the arm is the table's")
    other.wait_for_cell(2, "a", "0.0825 + 1e-3")
    assert page.url == tab.address
    assert [url for url in other.asked if word[:20] in url] == []
    page.reload()
    other.wait_for_status("7 axes and 1 fixed joint; the arm is the table's")


def test_pictures(tab: Any) -> None:
    """Twice as fine as the screen; the arm's colours are in both, the ground in one, and labels are written."""
    page = tab.open("ur5")
    size = page.evaluate(
        "(({ clientWidth, clientHeight }) => [clientWidth, clientHeight])(document.querySelector('.arm-view'))"
    )
    pictures = {}
    for entry in ("Picture (PNG)", "Picture with a transparent ground"):
        name, content = tab.save(entry)
        assert name == "ur5.png"
        picture = Image.open(io.BytesIO(content))
        assert list(picture.size) == [2 * length for length in size]
        pictures[entry] = np.asarray(picture.convert("RGBA"))
    plain, clear = pictures.values()
    assert (plain[..., 3] == 255).all()
    assert 0.5 < (clear[..., 3] == 0).mean() < 0.98
    drawn = clear[..., 3] == 255
    same = np.abs(plain[drawn].astype(int) - clear[drawn]).max(axis=1) < 8
    assert same.mean() > 0.99


def test_a_turntable_and_the_scene(tab: Any, arm_of: Callable[..., Any]) -> None:
    """A GIF of a whole turn, all of the arm in every frame, and the camera is back; a GLB of the pose on the screen."""
    page = tab.open("ur5")
    tab.set_sliders([0.3, -1.2, 0.9, 0.4, -0.5, 0.2])
    camera = "document.querySelector('.arm-view').camera.position.toArray()"
    before = page.evaluate(camera)
    name, content = tab.save("Turntable (GIF)")
    assert name == "ur5.gif"
    moving = Image.open(io.BytesIO(content))
    assert moving.n_frames == FRAMES
    assert moving.info["loop"] == 0
    assert LARGEST - 40 < max(moving.size) <= LARGEST
    view = page.locator(".arm-view").bounding_box()
    assert moving.width / moving.height == pytest.approx(view["width"] / view["height"], abs=0.01)
    colour = page.evaluate(
        """() => {
            let found;
            document.querySelector('.arm-view').scene.traverse(part => {
                if (part.isMesh && part.userData.layer === 'axes') found ??= part.material.color.getHex();
            });
            return [found >> 16, (found >> 8) & 255, found & 255];
        }"""
    )
    frames = []
    for number in range(moving.n_frames):
        moving.seek(number)
        frames.append(np.asarray(moving.convert("RGB")).astype(int))
    for one, other in pairwise([*frames, frames[0]]):
        assert 0.002 < (np.abs(one - other).max(axis=2) > 30).mean() < 0.5
    quarter = FRAMES // 4
    assert (np.abs(frames[0] - frames[quarter]).max(axis=2) > 30).mean() > 0.02
    for frame in frames:
        axes = (np.abs(frame - colour).max(axis=2) < 25).nonzero()
        assert min(len(axes[0]), axes[0].min(), axes[1].min()) > 5
        assert axes[0].max() < moving.height - 5
        assert axes[1].max() < moving.width - 5
    assert page.evaluate(camera) == pytest.approx(before)
    name, content = tab.save("Scene as glTF (GLB)")
    assert name == "ur5.glb"
    scene = trimesh.load_scene(io.BytesIO(content), file_type="glb", process=False)
    y_up = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    expected = y_up @ as_matrices(forward_kinematics(arm_of("ur5.csv"), tab.sliders()))
    assert np.abs(scene.graph["tool0"][0] - expected).max() < 1e-6
