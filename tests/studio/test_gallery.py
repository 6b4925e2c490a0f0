from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import dh2urdf_studio
from dh2urdf_studio import gallery

if TYPE_CHECKING:
    from dh2urdf.plugin_system import Catalog

TABLES = Path(__file__).parents[2] / "configs" / "tables"
GALLERY = Path(dh2urdf_studio.__file__).parent / "arms"


def test_the_gallery_is_configs() -> None:
    """The package's tables are those of configs/, all of them and to the byte."""
    assert {path.name: path.read_bytes() for path in GALLERY.iterdir()} == {
        path.name: path.read_bytes() for path in TABLES.iterdir()
    }


@pytest.mark.parametrize("item", gallery.tables(), ids=lambda item: item.name)
def test_every_arm_can_be_opened(item: gallery.GalleryTable, catalog: Catalog) -> None:
    """Each opens under its name, and a line tells what it is."""
    table = gallery.table(item.file, catalog)
    assert table.name == item.name
    assert len(item.told) > 10


def test_nothing_else_can(catalog: Catalog) -> None:
    """A name that is not in the gallery leads nowhere, and not into another folder."""
    with pytest.raises(LookupError):
        gallery.table("../__init__.py", catalog)
