"""Rules about the packages and paths that xacros, descriptions and launch files name."""

from __future__ import annotations

import re
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.documents import is_there
from dh2urdf.meshes import PACKAGE
from dh2urdf.source import Mark, shown
from dh2urdf_check.packages.package import broken, parsed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from dh2urdf.stages import Finding
    from dh2urdf_check.packages.package import Package

_IN_XML = re.compile(
    r"(?:\$\((?:find|find-pkg-share) +|package://)([A-Za-z0-9_-]+)\)?((?:/[A-Za-z0-9_.+-]+)*)(?![\w/${.+-])"
)
_MARKUP = {".xacro", ".urdf", ".srdf", ".launch", ".xml"}
_DECLARED = ("depend", "exec_depend", "run_depend")
_TEXT = r"[\"']([^\"'\n]+)[\"']"
_SHARE = rf"(?:FindPackageShare|get_package_share_(?:directory|path))\(\s*(?:package(?:_name)?\s*=\s*)?{_TEXT}\s*\)"
"""How Python names the folder of a package."""
_INSTALL = re.compile(
    r"install\s*\(\s*(?:DIRECTORY|FILES|PROGRAMS)\s+([^)]*?)\s+DESTINATION\b|INSTALL_TO_SHARE\s+([^)]*)\)",
    re.IGNORECASE,
)


class Use(NamedTuple):
    """A place that names a package.

    Attributes:
        package: its name.
        path: the file in it; empty where none is named.
        mark: the place.
        is_mesh: whether the rules of descriptions look for the file.
    """

    package: str
    path: str
    mark: Mark
    is_mesh: bool = False


def hits(package: Package) -> Iterator[Finding]:
    """What there is to report of them."""
    declared = {(element.text or "").strip() for tag in _DECLARED for element in package.root.findall(tag)}
    declared.add(package.name)
    installed = _installed(package)
    reported: set[str] = set()
    for use in _uses(package):
        if use.package not in declared and use.package not in reported:
            reported.add(use.package)
            yield broken("package-undeclared", use.mark, f"the package {shown(use.package)} is not in package.xml")
        folder = package.known.get(use.package)
        if folder is None or not use.path:
            continue
        if not is_there(folder / use.path):
            if not use.is_mesh:
                yield broken("package-missing-file", use.mark, f"{shown(use.path)} is not in the package {use.package}")
        elif use.package == package.name and installed is not None and not _is_installed(use.path, installed):
            yield broken("package-not-installed", use.mark, f"{shown(use.path)} is not installed")


def _uses(package: Package) -> Iterator[Use]:
    for path in package.files:
        if path == package.manifest or "test" in path.relative_to(package.folder).parts:
            continue
        if path.suffix in _MARKUP:
            yield from _in_markup(path, package.content(path) or b"")
        elif path.suffix == ".py" and ("launch" in path.name or "launch" in path.relative_to(package.folder).parts):
            yield from _in_launch(path, package.content(path) or b"")


def _in_markup(path: Path, content: bytes) -> Iterator[Use]:
    try:
        root = parsed(content, path)
    except etree.XMLSyntaxError:  # The rules of descriptions report it.
        return
    for element in root.iter(etree.Element):
        mark = Mark(file=str(path), line=element.sourceline)  # type: ignore[arg-type]  # the stubs of lxml
        for text in (*map(str, element.attrib.values()), element.text or ""):
            for match in _IN_XML.finditer(text):
                yield Use(match[1], match[2].strip("/"), mark, is_mesh=match[0].startswith(PACKAGE))


def _in_launch(path: Path, content: bytes) -> Iterator[Use]:
    """The packages and paths of a launch file, as far as they are texts in it."""
    text = re.sub(r"(?m)^[ \t]*#.*$", "", content.decode("utf-8", "replace"))

    def use(match: re.Match[str], package: str, inside: str = "") -> Use:
        return Use(package, inside, Mark(file=str(path), line=text.count("\n", 0, match.start()) + 1))

    shares = {match[1]: match[2] for match in re.finditer(rf"(\w+)\s*=\s*{_SHARE}", text)}
    for match in re.finditer(_SHARE, text):
        yield use(match, match[1])
    for match in re.finditer(rf"(?:PathJoinSubstitution|join)\(\s*\[?\s*(?:{_SHARE}|(\w+))((?:\s*,\s*{_TEXT})+)", text):
        if (package := match[1] or shares.get(match[2])) and text[match.end() :].lstrip(" \n\t,")[:1] in {"]", ")"}:
            yield use(match, package, str(PurePosixPath(*re.findall(_TEXT, match[3]))))
    for match in re.finditer(rf"\bpackage\s*=\s*{_TEXT}", text):
        yield use(match, match[1])
    for match in re.finditer(rf"MoveItConfigsBuilder\(\s*(?:robot_name\s*=\s*)?{_TEXT}([^()]*)", text):
        named = re.search(rf"package_name\s*=\s*{_TEXT}", match[2])
        yield use(match, named[1] if named else f"{match[1]}_moveit_config")


def _installed(package: Package) -> list[PurePosixPath] | None:
    """What CMakeLists.txt installs; None where there is none, or where variables name it."""
    content = package.content(package.folder / "CMakeLists.txt")
    if content is None:
        return None
    text = re.sub(r"#[^\n]*", "", content.decode("utf-8", "replace"))
    words = [word.strip('"') for match in _INSTALL.finditer(text) for word in (match[1] or match[2] or "").split()]
    return None if any("$" in word for word in words) else [PurePosixPath(word) for word in words]


def _is_installed(path: str, installed: Iterable[PurePosixPath]) -> bool:
    return any(PurePosixPath(path).is_relative_to(each) for each in installed)
