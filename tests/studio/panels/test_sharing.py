"""Links that hold a table, and pictures, in the browser."""

from __future__ import annotations

import base64
import io
import json
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

from dh2urdf.studio import gallery
from dh2urdf.studio.editing.keeping import kept_table

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.plugin_system.catalog import Catalog


def choose(tab: Any, entry: str) -> None:
    tab.page.get_by_role("button", name="Save").click()
    tab.page.locator(".q-menu").get_by_text(entry, exact=True).click()


def link_of(tab: Any) -> str:
    choose(tab, "Link with this table")
    box = tab.page.get_by_label("link", exact=True)
    box.wait_for()
    return str(box.input_value())


def word_of(text: str) -> str:
    """The text as the fragment of a link, by Python's own zlib."""
    squeezed = zlib.compressobj(wbits=-15)
    return base64.urlsafe_b64encode(squeezed.compress(text.encode()) + squeezed.flush()).decode().rstrip("=")


def test_a_link_holds_the_table(studio_address: str, new_tab: Callable[..., Any], catalog: Catalog) -> None:
    """Python reads the fragment too; another tab opens it, and nothing of it is asked of the server."""
    tab = new_tab(studio_address)
    tab.open()
    tab.open_exhibit("panda")
    tab.type_into(2, "a", "0.0825 + 1e-3")
    link = link_of(tab)
    address, _, word = link.partition("#table=")
    assert address == studio_address
    text = zlib.decompress(base64.urlsafe_b64decode(word + "==="), wbits=-15).decode()
    table = kept_table(text)
    expected = gallery.exhibit("panda.yaml", catalog)
    assert table is not None
    assert table.rows[0] == expected.rows[0]
    assert table.rows[2]["a"] == "0.0825 + 1e-3"
    tab.page.get_by_role("button", name="Close").click()
    other = new_tab(link)
    page = other.open()
    other.wait_for_status("7 axes and 1 fixed joint; the arm is the table's")
    assert other.cells(2, "a") == ["0.0825 + 1e-3"]
    assert page.url == studio_address
    assert [url for url in other.asked if word[:20] in url] == []
    page.reload()
    other.wait_for_status("7 axes and 1 fixed joint; the arm is the table's")


def test_a_link_in_a_tab_that_is_open(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """Its table takes the place of what is there, which undo brings back."""
    tab = new_tab(studio_address)
    page = tab.open()
    tab.open_exhibit("ur5")
    text = json.dumps({"name": "linked", "convention": "standard", "rows": [{"a": "1", "alpha": "0", "d": "0"}]})
    page.evaluate("word => { location.hash = '#table=' + word; }", word_of(text))
    tab.wait_for_status("1 axis; the arm is the table's")
    page.get_by_role("button", name="undo").click()
    tab.wait_for_status("6 axes; the arm is the table's")


@pytest.mark.parametrize(
    "word",
    ["", "%00", "not-a-table", word_of("no"), word_of('{"rows": []}'), word_of("0" * 5_000_000), word_of("[" * 90_000)],
    ids=["empty", "letters", "no deflate", "no JSON", "no rows", "too long", "too deep"],
)
def test_a_link_that_is_broken(studio_address: str, new_tab: Callable[..., Any], word: str) -> None:
    """It is told, and the page works."""
    tab = new_tab(f"{studio_address}#table={word}")
    page = tab.open()
    page.get_by_text("This link holds no table that can be read").wait_for()
    tab.open_exhibit("ur5")


def test_pictures(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """Twice as fine as the screen; the arm's colours are in both, the ground in one, and labels are written."""
    tab = new_tab(studio_address)
    page = tab.open()
    tab.open_exhibit("ur5")
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
