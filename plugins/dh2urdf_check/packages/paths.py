"""Rules about the packages and paths that xacros, descriptions and launch files name."""

from __future__ import annotations

import ast
import re
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.documents import is_there
from dh2urdf.meshes import PACKAGE
from dh2urdf.source import Mark, shown
from dh2urdf_check.packages.package import Hit, parsed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from dh2urdf_check.packages.package import Package

_IN_XML = re.compile(
    r"(?:\$\((?:find|find-pkg-share) +|package://)([A-Za-z0-9_-]+)\)?((?:/[A-Za-z0-9_.+-]+)*)(?![\w/${.+-])"
)
_MARKUP = {".xacro", ".urdf", ".srdf", ".launch", ".xml"}
_DECLARED = ("depend", "exec_depend", "run_depend")
_SHARES = ("FindPackageShare", "get_package_share_directory", "get_package_share_path")
_JOINED = ("PathJoinSubstitution", "join")
_BUILDER = "MoveItConfigsBuilder"
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


def hits(package: Package) -> Iterator[Hit]:
    """What there is to report of them."""
    declared = {(element.text or "").strip() for tag in _DECLARED for element in package.root.findall(tag)}
    declared.add(package.name)
    installed = _installed(package)
    reported: set[str] = set()
    for use in _uses(package):
        if use.package not in declared and use.package not in reported:
            reported.add(use.package)
            yield Hit("package-undeclared", use.mark, f"the package {shown(use.package)} is not in package.xml")
        folder = package.known.get(use.package)
        if folder is None or not use.path:
            continue
        if not is_there(folder / use.path):
            if not use.is_mesh:
                yield Hit("package-missing-file", use.mark, f"{shown(use.path)} is not in the package {use.package}")
        elif use.package == package.name and installed is not None and not _is_installed(use.path, installed):
            yield Hit("package-not-installed", use.mark, f"{shown(use.path)} is not installed")


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
    try:
        tree = ast.parse(content)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return
    shares: dict[str, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and (name := _share(node.value, {})):
            shares.update({target.id: name for target in node.targets if isinstance(target, ast.Name)})
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            mark = Mark(file=str(path), line=node.lineno)
            yield from (use._replace(mark=mark) for use in _called(node, shares, mark))


def _called(call: ast.Call, shares: dict[str, str], mark: Mark) -> Iterator[Use]:
    """The packages and paths of one call of a launch file."""
    words = {keyword.arg: _text(keyword.value) for keyword in call.keywords}
    function = _function(call)
    if function in _SHARES and (name := _share(call, shares)):
        yield Use(name, "", mark)
    elif function in _JOINED and (parts := _parts(call)) and (name := _share(parts[0], shares)):
        texts = [_text(part) for part in parts[1:]]
        if texts and all(texts):
            yield Use(name, str(PurePosixPath(*map(str, texts))), mark)
    elif function == _BUILDER:
        first = _text(call.args[0]) if call.args else words.get("robot_name")
        if name := words.get("package_name") or (f"{first}_moveit_config" if first else None):
            yield Use(name, "", mark)
    elif name := words.get("package"):
        yield Use(name, "", mark)


def _function(call: ast.Call) -> str:
    return call.func.id if isinstance(call.func, ast.Name) else getattr(call.func, "attr", "")


def _parts(call: ast.Call) -> list[ast.expr]:
    """The parts of a path, in a list or as arguments."""
    if len(call.args) == 1 and isinstance(call.args[0], (ast.List, ast.Tuple)):
        return call.args[0].elts
    return call.args


def _share(node: ast.expr, shares: dict[str, str]) -> str | None:
    """The package whose share a value is."""
    if isinstance(node, ast.Name):
        return shares.get(node.id)
    if isinstance(node, ast.Call) and _function(node) in _SHARES:
        given = [*node.args, *(keyword.value for keyword in node.keywords)]
        return _text(given[0]) if given else None
    return None


def _text(node: ast.expr) -> str | None:
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value else None


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
