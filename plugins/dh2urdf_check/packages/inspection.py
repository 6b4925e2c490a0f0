"""Inspects a package of ROS 2 of any origin: what colcon, launch files and MoveIt will do with it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.documents import is_file, read_bytes
from dh2urdf.errors import InputError
from dh2urdf.meshes import own_folder, packages_in, with_its_own
from dh2urdf.source import Mark, Problem, shown
from dh2urdf.stages import PACKAGE_FILE, Finding, Inspection
from dh2urdf_check.packages import names, paths
from dh2urdf_check.packages.package import CONSUMERS, LONGEST, Package, broken, of_document, parsed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from dh2urdf.stages import Expansion

_PROJECT = re.compile(r"^[ \t]*project\s*\(\s*([^\s)]+)", re.IGNORECASE | re.MULTILINE)


def packages(roots: Mapping[Path, str]) -> Iterator[Path]:
    """The package.xml of each package among the files of a folder."""
    return (path for path in roots if path.name == PACKAGE_FILE)


def inspect_package(path: Path, expansion: Expansion) -> Inspection:
    """What there is to report of the package that a file is in.

    Args:
        path: its package.xml, or any other file of it.
        expansion: where the packages are that it uses.

    Raises:
        InputError: the file is in no package, or a folder of packages is none.
    """
    folder = own_folder(path)
    if not is_file(folder / PACKAGE_FILE):
        message, accepted = "this file is in no package of ROS", f"a folder with {PACKAGE_FILE}, or a file below it"
        raise InputError(Problem(message=message, mark=Mark(file=str(path)), accepted=accepted))
    place = path if path.name == PACKAGE_FILE else folder / PACKAGE_FILE
    content = read_bytes(place, InputError, limit=LONGEST)
    try:
        root = parsed(content, place)
    except etree.XMLSyntaxError as error:
        mark = Mark(file=str(place), line=max(error.position[0], 1))
        return _inspection([broken("package-not-xml", mark, f"this is not XML: {error.msg}")])
    if root.tag != "package":
        message = f"the outermost element is {root.tag}, not package"
        return _inspection([broken("package-not-xml", Mark(file=str(place), line=1), message)])
    known = with_its_own(path, packages_in(expansion.package_paths))
    package = Package(place.parent, root, {name: each for name, each in known.items() if each != folder})
    package = Package(place.parent, root, {**package.known, package.name: place.parent})
    return _inspection([*of_document(root, place), *_project(package), *paths.hits(package), *names.hits(package)])


def _project(package: Package) -> Iterator[Finding]:
    path = package.folder / "CMakeLists.txt"
    text = (package.content(path) or b"").decode("utf-8", "replace")
    match = _PROJECT.search(text)
    if match and "$" not in match[1] and match[1].strip('"') != package.name:
        mark = Mark(file=str(path), line=text.count("\n", 0, match.start(1)) + 1)
        yield broken(
            "package-project-name", mark, f"the project is {shown(match[1])}, the package {shown(package.name)}"
        )


def _inspection(findings: Iterable[Finding]) -> Inspection:
    return Inspection(consumers=CONSUMERS, findings=tuple(findings))
