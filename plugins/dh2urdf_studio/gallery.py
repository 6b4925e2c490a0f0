"""The arms that the studio comes with: those of the project's configs/, as data of the package."""

from __future__ import annotations

from importlib.resources import as_file, files
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf_studio.editing.opening import open_tables

if TYPE_CHECKING:
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.table_text import TableText

_FOLDER = files("dh2urdf_studio") / "arms"


class GalleryTable(NamedTuple):
    """A table of the gallery.

    Attributes:
        name: its name.
        file: its file.
        told: what its first comment line says.
    """

    name: str
    file: str
    told: str


def tables() -> tuple[GalleryTable, ...]:
    """What there is in the gallery, by name."""
    found = []
    for entry in sorted(_FOLDER.iterdir(), key=lambda entry: entry.name):
        first = entry.read_text("utf-8").partition("\n")[0]
        found.append(GalleryTable(entry.name.partition(".")[0], entry.name, first.lstrip("# ")))
    return tuple(found)


def table(file: str, catalog: Catalog) -> TableText:
    """A table of the gallery.

    Raises:
        LookupError: there is no such file in it.
    """
    if file not in {item.file for item in tables()}:
        raise LookupError(f"the gallery has no {file!r}")
    with as_file(_FOLDER / file) as path:
        return open_tables(path, catalog)[0].table
