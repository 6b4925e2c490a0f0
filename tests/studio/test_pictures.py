"""The pictures of docs/studio: taken in the browser with `pytest --renew`, and shown on the pages."""

import struct
from pathlib import Path

import pytest

from studio_pictures import ALL, STUDIO, VIEWS, do, set_sliders, take

ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "docs" / "studio"
LARGEST = 150_000
"""Size of a picture [B]: they are cloned with the project."""


@pytest.mark.parametrize("name", STUDIO)
def test_pictures_of_the_studio(name: str, renew: bool, request: pytest.FixtureRequest) -> None:  # noqa: FBT001 - a fixture
    """With `--renew` the studio is brought into the state of each picture, and the picture is taken."""
    if not renew:
        return
    table, sliders, acts, (width, height) = STUDIO[name]
    new_tab = request.getfixturevalue("new_tab")
    tab = new_tab(request.getfixturevalue("studio_address"), width=width, height=height)
    tab.page.emulate_media(color_scheme="dark" if name == "dark" else "light")
    tab.open()
    if table:
        tab.open_from_gallery(table)
    if sliders:
        set_sliders(tab, sliders)
    for what, how in acts:
        do(tab, what, how)
    if name == "lesson":
        tab.wait_for_lesson(3.0)
    take(tab, name, PICTURES)


@pytest.mark.parametrize("name", VIEWS)
def test_pictures_of_robots(name: str, renew: bool, request: pytest.FixtureRequest, tmp_path: Path) -> None:  # noqa: FBT001 - a fixture
    """With `--renew` a dual-arm cell, a maker's description and a UR5 with housings are shown, and pictures taken."""
    if not renew:
        return
    table = tmp_path / "ur5.csv"
    words = (ROOT / "configs" / "tables" / "ur5.csv").read_text("utf-8")
    table.write_text(f"# defaults: {{geometry: {{shape: arm}}}}\n{words}", "utf-8")
    path = {"dual_arm": ROOT / "configs" / "pair.yaml", "housings": table}.get(name)
    if path is None:
        path = request.getfixturevalue("example_robots") / "panda_description" / "urdf" / "panda.urdf"
    count, sliders = VIEWS[name]
    with request.getfixturevalue("open_view")(path, sliders=count) as tab:
        if name == "meshes":
            tab.wait_for_triangles(100_000)
        for layer in ("joint axes", "frames") if name == "housings" else ():
            tab.page.locator(".studio-bar").get_by_role("checkbox", name=layer, exact=True).set_checked(checked=False)
        set_sliders(tab, sliders)
        take(tab, name, PICTURES)


@pytest.mark.parametrize("name", ALL)
def test_every_picture_is_shown(name: str) -> None:
    """Each is there, small, in the size of its screen, and on the page about the studio or about shapes."""
    content = (PICTURES / f"{name}.png").read_bytes()
    assert len(content) < LARGEST
    assert struct.unpack(">II", content[16:24]) == ALL[name]
    page = "tables/other-files.md" if name == "housings" else "studio.md"
    assert f"studio/{name}.png)" in (ROOT / "docs" / page).read_text("utf-8")
