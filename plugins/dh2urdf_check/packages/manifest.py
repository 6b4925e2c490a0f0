"""Rules about package.xml and CMakeLists.txt, as catkin_pkg and ament_cmake have them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.source import Mark, shown
from dh2urdf_check.packages.package import Hit
from dh2urdf_plugins.ros_conventions import PACKAGE_NAME, VERSION

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.packages.package import Package

_NAME = re.compile(r"[a-zA-Z0-9][a-zA-Z0-9_-]*")
_PROJECT = re.compile(r"^[ \t]*project\s*\(\s*([^\s)]+)", re.IGNORECASE | re.MULTILINE)
_REQUIRED = ("name", "version", "description", "maintainer", "license")


def hits(package: Package) -> Iterator[Hit]:
    """What there is to report of these files."""
    yield from _missing(package)
    yield from _words(package)
    yield from _project(package)


def _at(package: Package, tag: str) -> Mark:
    element = package.root.find(tag)
    line = (package.root if element is None else element).sourceline
    return Mark(file=str(package.manifest), line=line)  # type: ignore[arg-type]  # the stubs of lxml


def _missing(package: Package) -> Iterator[Hit]:
    for tag in _REQUIRED:
        if not any("".join(map(str, element.itertext())).strip() for element in package.root.findall(tag)):
            yield Hit("package-incomplete", _at(package, tag), f"the package has no {tag}")
    if any(not maintainer.get("email") for maintainer in package.root.findall("maintainer")):
        yield Hit("package-incomplete", _at(package, "maintainer"), "the maintainer has no address (email)")


def _words(package: Package) -> Iterator[Hit]:
    version = (package.root.findtext("version") or "").strip()
    if version and not VERSION.fullmatch(version):
        yield Hit("package-version", _at(package, "version"), f"the version is {shown(version)}")
    name = package.name
    if name and not PACKAGE_NAME.fullmatch(name):
        rule = "package-name-style" if _NAME.fullmatch(name) else "package-name"
        yield Hit(rule, _at(package, "name"), f"the package is called {shown(name)}")
    for tag in ("license", "maintainer"):
        text = (package.root.findtext(tag) or "").strip()
        address = next((element.get("email") or "" for element in package.root.findall(tag)), "")
        if text.startswith("TODO") or address.endswith("@todo.todo"):
            yield Hit("package-placeholder", _at(package, tag), f"the {tag} is {shown(text)}")


def _project(package: Package) -> Iterator[Hit]:
    path = package.folder / "CMakeLists.txt"
    text = (package.content(path) or b"").decode("utf-8", "replace")
    match = _PROJECT.search(text)
    if match and "$" not in match[1] and match[1].strip('"') != package.name:
        mark = Mark(file=str(path), line=text.count("\n", 0, match.start(1)) + 1)
        yield Hit("package-project-name", mark, f"the project is {shown(match[1])}, the package {shown(package.name)}")
