"""What finds entry points without `importlib.metadata`, against it."""

from __future__ import annotations

import importlib.metadata
import subprocess
import sys
import zipfile
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.plugin_system.entry_points import Point, points, version_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

POINTS = "[dh2urdf]\nlab = lab_{}\n\n[console_scripts]\nlab = lab:main\n"
HEAD = "Metadata-Version: 2.1\nName: {}\nVersion: 1.0\nSummary: a lab\n\nName: of a description\n"

FOLDERS: dict[str, dict[str, str]] = {
    "plain_lab-1.0.dist-info": {"METADATA": HEAD.format("plain-lab"), "entry_points.txt": POINTS.format("plain")},
    "no_points-1.0.dist-info": {"METADATA": HEAD.format("no-points")},
    "others-1.0.dist-info": {"METADATA": HEAD.format("others"), "entry_points.txt": "[console_scripts]\na = b:c\n"},
    "spaces-1.0.dist-info": {
        "METADATA": "name:  spaces \nVERSION:\t2.0\nDescription: x\n  Name: folded\n",
        "entry_points.txt": "# dh2urdf\nlost = lost\n [dh2urdf.v2] \n\n  a=b\nemitter.usd  =  c.d:e.f [extra]\n#x = y\n",
    },
    "lines-1.0.dist-info": {"METADATA": HEAD.format("lines"), "entry_points.txt": POINTS.format("lines")},
    "old.egg-info": {"PKG-INFO": HEAD.format("old"), "entry_points.txt": POINTS.format("old")},
    "no_metadata-3.0.dist-info": {"METADATA": "Name: x\nVersion: 1\n", "entry_points.txt": POINTS.format("no")},
    "Two.Names-1.0.dist-info": {"METADATA": HEAD.format("Two.Names"), "entry_points.txt": POINTS.format("two")},
    "ünïcode-1.0.dist-info": {"METADATA": HEAD.format("ünïcode"), "entry_points.txt": POINTS.format("ünïcode")},
}
LATER = {
    "plain_lab-2.0.dist-info": {"METADATA": HEAD.format("plain-lab"), "entry_points.txt": POINTS.format("hidden")},
    "two__names-2.0.dist-info": {"METADATA": HEAD.format("two-names"), "entry_points.txt": POINTS.format("hidden")},
    "no-points-2.0.dist-info": {"METADATA": HEAD.format("no-points"), "entry_points.txt": POINTS.format("hidden")},
    "later-1.0.dist-info": {"METADATA": HEAD.format("later"), "entry_points.txt": POINTS.format("later")},
}


def fill(place: Path, folders: dict[str, dict[str, str]]) -> Path:
    for folder, files in folders.items():
        (place / folder).mkdir(parents=True)
        for name, text in files.items():
            lines = text.replace("\n", "\r\n") if folder.startswith("lines") else text
            (place / folder / name).write_bytes(lines.encode())
    return place


def archive(place: Path) -> Path:
    """The same in a zip archive."""
    fill(place / "unpacked", FOLDERS)
    with zipfile.ZipFile(place / "lab.zip", "w") as packed:
        for file in sorted((place / "unpacked").rglob("*/*")):
            packed.write(file, file.relative_to(place / "unpacked"))
    return place / "lab.zip"


def egg(place: Path) -> Path:
    return fill(place / "old_lab-1.0-py3.11.egg", {"EGG-INFO": FOLDERS["old.egg-info"]})


class Finder:
    """A finder of somebody else, with a distribution in memory."""

    def find_spec(self, *_: Any) -> None:
        """Find no module."""

    def find_distributions(self, _context: Any) -> Iterator[importlib.metadata.Distribution]:
        class InMemory(importlib.metadata.Distribution):
            def read_text(self, filename: str) -> str | None:
                return FOLDERS["plain_lab-1.0.dist-info"].get(filename)

            def locate_file(self, path: Any) -> Any:
                raise NotImplementedError(path)

        yield InMemory()


def of_the_library() -> set[tuple[str, ...]]:
    every = importlib.metadata.entry_points()
    found = [point for group in every.groups if group.startswith("dh2urdf") for point in every.select(group=group)]
    return {(p.group, p.name, p.value, p.dist.name, p.dist.version) for p in found if p.dist}


def of_the_house() -> set[tuple[str, ...]]:
    found = [point for point in points("dh2urdf") if point.group.startswith("dh2urdf")]
    return {(p.group, p.name, p.value, p.distribution.name, p.distribution.version) for p in found if p.distribution}


@pytest.mark.parametrize("also", [None, "archive", "egg", "upper case", "finder", "missing"])
def test_the_same_as_the_library_finds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, also: str | None) -> None:
    """Group, name, value, distribution and version of each; what is found first hides the same name later."""
    places = [fill(tmp_path / "first", FOLDERS), fill(tmp_path / "later", LATER)]
    if also in ("archive", "egg"):
        places.insert(0, {"archive": archive, "egg": egg}[also](tmp_path))
    elif also == "upper case":
        fill(places[0], {"Upper-1.0.DIST-INFO": FOLDERS["plain_lab-1.0.dist-info"]})
    elif also == "finder":
        monkeypatch.setattr(sys, "meta_path", [*sys.meta_path, Finder()])
    elif also == "missing":
        places.insert(0, tmp_path / "missing")
    monkeypatch.setattr(sys, "path", [*map(str, places), *sys.path])
    found = of_the_house()
    assert found == of_the_library()
    assert ("dh2urdf", "builtin", "dh2urdf_plugins", "dh2urdf", importlib.metadata.version("dh2urdf")) in found
    assert {"later", "spaces ", "ünïcode"} <= {distribution for *_, distribution, _ in found}
    for name in ("numpy", "PyYAML", "plain.lab", "Two_Names", "no-points", "old"):
        assert version_of(name) == importlib.metadata.version(name)


def test_what_is_not_installed_has_no_version() -> None:
    with pytest.raises(importlib.metadata.PackageNotFoundError):
        version_of("not-there")


@pytest.mark.parametrize("value", ["collections.abc", "collections.abc:Mapping.get", "json : dumps [fast]"])
def test_it_imports_what_is_named(value: str) -> None:
    """A module, or a name in one, however it is written."""
    assert Point("g", "n", value, None).load() is importlib.metadata.EntryPoint("n", value, "g").load()


def test_it_needs_no_import_of_the_library() -> None:
    """Names and versions of plugins come from the metadata themselves."""
    code = (
        "import sys; from dh2urdf.plugin_system.discovery import installed; "
        "from dh2urdf.plugin_system.entry_points import version_of; "
        "print(version_of('numpy'), [plugin.distribution for plugin in installed().plugins], "
        "'importlib.metadata' in sys.modules)"
    )
    # -S and -I leave out what .pth files import.
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", f"import sys; sys.path[:] = {sys.path!r}; {code}"],
        check=True,
        capture_output=True,
        text=True,
    )
    assert done.stdout.endswith("False\n")
    assert "dh2urdf " in done.stdout
    assert done.stdout.startswith(f"{importlib.metadata.version('numpy')} ")
