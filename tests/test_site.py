"""The documentation site: it is built without a warning, it is whole, and it asks nothing of other hosts.

Its pictures are drawn by docs/generators/pictures.py; `pytest --renew` writes them.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from child_python import python
from lxml import html
from plain_frames import shift, turn

import gallery
import pictures
import site_hook
from dh2urdf import hookspecs
from dh2urdf.plugin_system import KINDS, describe_options, load
from hook_pages import specified

if TYPE_CHECKING:
    from drawing import Camera

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"


def build(folder: Path, root: Path = ROOT) -> tuple[int, list[str]]:
    """Build the site as `.ci/run` does: the exit status, and the warnings."""
    for module in ("material", "mkdocstrings_handlers"):
        pytest.importorskip(module, reason="the extra docs is not installed")
    words = ("-m", "mkdocs", "build", "--strict", "--site-dir", folder)
    built = python(*words, folder=root, NO_MKDOCS_2_WARNING="1")  # a notice about the next version of mkdocs
    warnings = [line for line in built.stderr.splitlines() if not line.startswith("INFO")]
    return built.returncode, warnings


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site; a warning fails the build."""
    folder = tmp_path_factory.mktemp("site")
    assert build(folder) == (0, [])
    return folder


def text_of(site: Path, page: str) -> str:
    """What a reader sees of a page, its words apart by one space."""
    (article,) = html.parse(site / page / "index.html").iter("article")
    return " ".join(article.text_content().split())


def pages(site: Path) -> list[Path]:
    return sorted(site.rglob("*.html"))


# --- Nothing is missing -----------------------------------------------------------------------------------------------


@pytest.mark.long
def test_every_page_is_in_the_site(site: Path) -> None:
    """Each Markdown file of docs/ is a page; nothing of what makes the site is published with it."""
    wanted = {path.relative_to(DOCS).with_suffix("") for path in DOCS.rglob("*.md")}
    found = {path.parent.relative_to(site) for path in pages(site) if path.name == "index.html"}
    assert found == {path if path.name != "index" else path.parent for path in wanted}
    assert not list(site.rglob("*.py"))


def test_every_place_is_filled(site: Path) -> None:
    """No page shows the mark of something generated, and each generator has a page that asks for it."""
    assert not [path for path in pages(site) if "<!-- generated" in path.read_text("utf-8")]
    asked = {
        place["name"] for path in DOCS.rglob("*.md") for place in site_hook.PLACE.finditer(path.read_text("utf-8"))
    }
    assert asked == set(site_hook.GENERATORS)


def test_every_stage_is_there_with_its_options(site: Path) -> None:
    """Name, summary and options of each built-in stage, the help texts whole: what is in braces too."""
    text = text_of(site, "reference/stages").replace("`", "")
    catalog = load()
    for kind in KINDS:
        for item in catalog.provided(kind):
            if item.plugin.distribution.startswith("dh2urdf "):
                assert item.stage.summary[1:] in text
                for name, takes, default, words in describe_options(item.stage.options):
                    assert " ".join(f"{name} {takes} {default} {words}".replace("`", "").split()) in text


def test_every_hook_is_there_with_its_signature(site: Path) -> None:
    """Each hook of the module has a section with its signature, word for word, and with the fields of its record."""
    text = text_of(site, "reference/hooks")
    source = " ".join(Path(hookspecs.__file__).read_text("utf-8").split())
    assert f"version {hookspecs.INTERFACE_VERSION} of the interface" in text
    signatures = re.findall(r"@hookspec (def \w+\(.*?\) -> [^:]+):", source)
    assert len(signatures) == len(specified()) == len(KINDS) + 1  # and one for commands
    for signature, (_, record) in zip(signatures, specified(), strict=True):
        section = text.partition(signature)[2]
        assert section
        for field in record.__dataclass_fields__:
            assert field in section


# --- Nothing is asked of others ---------------------------------------------------------------------------------------

LOADED = {"script": "src", "img": "src", "iframe": "src", "source": "src", "video": "src", "link": "href"}


def test_no_page_loads_anything_from_another_host(site: Path) -> None:
    """Scripts, styles, fonts and pictures lie beside the pages, and the policy of each page lets nothing else in."""
    for path in pages(site):
        page = html.parse(path).getroot()
        for tag, attribute in LOADED.items():
            for element in page.iter(tag):
                target = element.get(attribute, "")
                assert not re.match(r"(?:\w+:)?//", target), f"{path}: {target}"
        (policy,) = page.xpath("//meta[@http-equiv='Content-Security-Policy']/@content")
        assert "default-src 'self'" in policy
        assert "http" not in policy
    for path in site.rglob("*.css"):
        assert not re.search(r"(?:url\(|@import)\s*[\"']?(?:https?:)?//", path.read_text("utf-8")), path


# --- The pictures -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", pictures.PICTURES)
def test_the_pictures_are_what_is_drawn(name: str, *, renew: bool) -> None:
    """The files in docs/pictures are those that the code draws."""
    if name == "servo-steps.svg":
        pytest.importorskip("mujoco")
    path = DOCS / "pictures" / name
    if renew:
        path.write_text(pictures.PICTURES[name](), "utf-8")
    assert path.read_text("utf-8") == pictures.PICTURES[name](), "run `pytest --renew tests/test_site.py`"


def test_every_picture_is_shown() -> None:
    """In some page, and nothing else lies beside them."""
    text = "".join(path.read_text("utf-8") for path in (ROOT / "README.md", *DOCS.rglob("*.md")))
    assert {path.name for path in (DOCS / "pictures").iterdir()} == set(pictures.PICTURES)
    assert all(f"pictures/{name})" in text for name in pictures.PICTURES)


def test_the_gallery_shows_every_arm(*, renew: bool) -> None:
    """The tables of the page are what the generator makes of the example tables and of the published arms."""
    path = DOCS / "gallery.md"
    start = "|" + " |" * gallery.COLUMNS
    intro, _, _ = path.read_text("utf-8").partition(start)
    if renew:
        path.write_text(intro + gallery.page(), "utf-8")
    assert path.read_text("utf-8") == intro + gallery.page(), "run `pytest --renew tests/test_site.py`"


def seen(camera: Camera, point: np.ndarray) -> tuple[float, float]:
    """Where a camera about z, then tilted, sees a point [px]: right is x, down is y."""
    view = turn("x", camera.elevation - math.pi / 2) @ turn("z", -camera.azimuth - math.pi / 2)
    x, y, *_ = camera.scale * (view @ [*point, 1.0])
    return x, -y


LENGTHS = re.compile(
    r'<polyline points="([-\d.]+),([-\d.]+) ([-\d.]+),([-\d.]+)" fill="none" stroke="(#\w+)" stroke-width="4"'
)


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_lengths_are_drawn_along_their_axes(convention: str) -> None:
    """By the textbook's matrices: d on the joint's own axis, a on the common normal; both from where they begin to where they end."""
    a, alpha, d, theta = pictures.A, pictures.ALPHA, pictures.D, pictures.THETA
    if convention == "standard":  # Rz(θ) Tz(d) Tx(a) Rx(α)
        corners = [np.eye(4), turn("z", theta) @ shift(z=d), turn("z", theta) @ shift(z=d) @ shift(x=a)]
        colours, camera = ("#1d5fbf", "#c62f2f"), pictures.STANDARD_CAMERA
    else:  # Rx(α) Tx(a) Rz(θ) Tz(d)
        corners = [np.eye(4), turn("x", alpha) @ shift(x=a), turn("x", alpha) @ shift(x=a) @ shift(z=d)]
        colours, camera = ("#c62f2f", "#1d5fbf"), pictures.MODIFIED_CAMERA
    drawn = LENGTHS.findall((DOCS / "pictures" / f"dh-{convention}.svg").read_text("utf-8"))
    assert [colour for *_, colour in drawn] == list(colours)
    for (*ends, _), start, end in zip(drawn, corners[:2], corners[1:], strict=True):
        expected = [*seen(camera, start[:3, 3]), *seen(camera, end[:3, 3])]
        np.testing.assert_allclose([float(value) for value in ends], expected, atol=0.06)
