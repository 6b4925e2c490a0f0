"""ROS packages by name, and the files that a description means by the addresses of its meshes."""

from __future__ import annotations

import io
import os
import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from dh2urdf.documents.text_files import is_file, is_folder
from dh2urdf.errors import InputError
from dh2urdf.source import Messages, Problem, shown
from dh2urdf.stages import PACKAGE_FILE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

say = Messages(__file__)


FILE, PACKAGE = "file://", "package://"
DEEPEST = 4  # how many folders below the one that a user names a package may be
_DRIVE = re.compile(r"^/?(?=[A-Za-z]:[\\/])")  # before a drive of Windows: a slash in an address, nothing in a path
_NAME = re.compile(rb"<name>\s*([^<\s]+)\s*</name>")
_LARGEST_MANIFEST = 2**26  # size of a package.xml that is read [B]


def file_address(path: str) -> str:
    """The address of an absolute path: `file:///usr/arm.stl`, and `file:///C:/arm.stl` with a drive of Windows.

    Nothing is percent-encoded: readers of robot descriptions cut off the scheme and decode nothing.
    """
    return f"{FILE}/{path.replace(chr(92), '/')}" if _DRIVE.match(path) else f"{FILE}{path}"


def path_of_address(address: str) -> str:
    """The path of a `file://` address, without the slash before a drive of Windows; any other text is as it was."""
    return _DRIVE.sub("", address.removeprefix(FILE), count=1) if address.startswith(FILE) else address


def own_folder(path: Path) -> Path:
    """The folder of a file's package; the folder of the file where it is in none."""
    folder = path.resolve().parent
    return next((above for above in (folder, *folder.parents) if is_file(above / PACKAGE_FILE)), folder)


def packages_in(paths: Iterable[Path]) -> dict[str, Path]:
    """The ROS packages in some folders, by the names that they give themselves; the first of a name is meant.

    A folder that holds ``package.xml`` is a package. Others may hold packages, up to `DEEPEST` folders below.
    """
    found: dict[str, Path] = {}
    problems: list[Problem] = []
    for path in paths:
        code, reason, here = "no-package-below", None, dict[str, Path]()
        if not is_folder(path):
            code = "no-folder-of-packages"
        else:
            try:
                here = dict(_packages(path.resolve(), DEEPEST))
            except PermissionError as error:
                code, reason = "packages-unreadable", error.strerror
        if not here:
            problems.append(say(code, found=str(path), file=PACKAGE_FILE, reason=reason))
        found = {**here, **found}
    if problems:
        raise InputError(problems)
    return found


def _packages(folder: Path, depth: int) -> Iterator[tuple[str, Path]]:
    if is_file(manifest := folder / PACKAGE_FILE):
        name = None
        with suppress(PermissionError):
            name = _NAME.search(manifest.read_bytes()[:_LARGEST_MANIFEST])
        yield name[1].decode("utf-8", "replace") if name else folder.name, folder
    elif depth:
        for inner in sorted(folder.iterdir(), reverse=True):  # the first of a name comes last, and stays
            if is_folder(inner) and not inner.is_symlink():
                with suppress(PermissionError):
                    yield from _packages(inner, depth - 1)


def with_its_own(path: Path, packages: Mapping[str, Path]) -> dict[str, Path]:
    """Some packages by name, and the one that a file is in."""
    own = own_folder(path)
    return {**packages, **(dict(_packages(own, 0)) if is_file(own / PACKAGE_FILE) else {})}


def mesh_finder(folder: Path, packages: Mapping[str, Path]) -> Callable[[str], Path | None]:
    """What finds the file of an address: a path from the description's folder, or in a package.

    The packages are those that the user names, the one that the file is in, and a folder of the package's name above.
    """

    def find(address: str) -> Path | None:
        scheme, separator, rest = address.partition("://")
        if not separator:
            return _found(folder / address)
        if scheme == "file":
            return _found(Path(unquote(path_of_address(address))))
        if scheme not in ("package", "model"):
            return None
        name, _, inner = rest.partition("/")
        roots = [packages[name]] if name in packages else []
        roots += [above / name for above in (folder, *folder.parents)]
        roots += [above for above in (folder, *folder.parents) if above.name == name]
        return next((path for root in roots if (path := _found(root / inner))), None)

    return find


def _found(path: Path) -> Path | None:
    return path if is_file(path) else None


SUFFIXES = (".bin", ".bmp", ".gif", ".jpeg", ".jpg", ".mtl", ".png", ".tga", ".tif", ".tiff", ".webp")
"""How the names of files end that a mesh file may name: MTL of an OBJ, buffers of a glTF, and pictures."""


class NamedFiles:
    """What trimesh asks for the files that a mesh file names: a resolver, as `trimesh.load_scene` takes it.

    A file is read if it is not too large [B], and in the folder of the mesh or below it, or anywhere in a ROS package
    that the mesh is in: its own, or one of some `packages`. Unless `links` may lead out of these folders, they are
    followed before that is decided. `unread` has the names of others, each with the reason.
    """

    def __init__(self, mesh: Path, largest: int, packages: Iterable[Path] = (), *, links: bool = False) -> None:
        self._links = links
        self._folder = self._place(mesh).parent
        own = next((above for above in (self._folder, *self._folder.parents) if is_file(above / PACKAGE_FILE)), None)
        roots = [own or self._folder, *map(self._place, packages)]
        self._roots = [root for root in roots if self._folder.is_relative_to(root)]
        self._largest = largest
        self.unread: dict[str, str] = {}

    def _place(self, path: Path) -> Path:
        return Path(os.path.abspath(path)) if self._links else path.resolve()  # noqa: PTH100 - links stay

    def place_of(self, name: str) -> Path | None:
        """Where a file is that may be read; None, with a word in `unread`, where it may not."""
        try:
            return self._path(name)
        except (OSError, ValueError) as error:
            self.unread[name] = (error.strerror if isinstance(error, OSError) else "") or str(error)
            return None

    def get(self, name: str) -> bytes:
        """The bytes of a file."""
        try:
            return self._read(name)
        except (OSError, ValueError) as error:
            reason = (error.strerror if isinstance(error, OSError) else "") or str(error)
            self.unread[name] = reason
            raise OSError(reason) from error

    __getitem__ = get

    def _path(self, name: str) -> Path:
        address = unquote(name).replace("\\", "/").removeprefix(FILE)
        if "://" in address:
            raise ValueError("it is an address, and no file")
        path = self._place(self._folder / address)
        if not any(map(path.is_relative_to, self._roots)):
            raise ValueError("it is outside of the folder of the mesh, and of its package")
        if path.suffix.lower() not in SUFFIXES:
            raise ValueError(f"files with the suffix {shown(path.suffix)} are not read")
        if not is_file(path):
            raise ValueError("there is no such file")
        if path.stat().st_size > self._largest:
            raise ValueError(f"it is larger than {self._largest // 2**20} MB")
        return path

    def _read(self, name: str) -> bytes:
        path = self._path(name)
        content = path.read_bytes()
        if path.suffix.lower() not in (".bin", ".mtl"):
            # trimesh leaves out what Pillow cannot open, without a word.
            try:
                from PIL import Image, UnidentifiedImageError
            except ImportError as error:
                raise ValueError("textures need Pillow, which is not installed") from error
            try:
                Image.open(io.BytesIO(content)).close()
            except (UnidentifiedImageError, Image.DecompressionBombError) as error:
                raise ValueError("it is no picture that can be shown") from error
        return content
