"""Files that a browser sent: a robot description, alone or with the mesh files that it names, or all of it as a ZIP."""

from __future__ import annotations

import os
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from dh2urdf.documents import BROKEN_ARCHIVE
from dh2urdf.errors import Dh2UrdfError, InputError
from dh2urdf.meshes import addresses
from dh2urdf.source import Messages
from dh2urdf.stages import PACKAGE_FILE, Emitter, ReadsForeign
from dh2urdf_studio.drawing.mesh_files import LARGEST, SUFFIXES
from dh2urdf_studio.drawing.scene import meshes_of
from dh2urdf_studio.viewing import description

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf_studio.drawing.scene import Figure

say = Messages(__file__)

MOST_FILES = 1000
"""Files that are kept of those that were sent."""


def description_suffixes(catalog: Catalog) -> tuple[str, ...]:
    """File name endings of robot descriptions that can be compared."""
    stages = (item.stage for item in catalog.provided("emitter"))
    readable = (stage for stage in stages if isinstance(stage, Emitter) and stage.can(ReadsForeign) is not None)
    return tuple(suffix for stage in readable for suffix in stage.suffixes)


def wanted_suffixes(catalog: Catalog) -> tuple[str, ...]:
    """File name endings of everything that is kept."""
    return (*description_suffixes(catalog), *SUFFIXES, *addresses.SUFFIXES, ".yaml", ".yml")


def too_much() -> InputError:
    """The error of more files, or larger ones, than are kept."""
    return InputError(say("too-many-files", files=MOST_FILES, size=LARGEST // 2**20))


class GivenFiles:
    """A folder for files that were sent, which is there until `close`."""

    def __init__(self, files: Iterable[tuple[str, bytes]], catalog: Catalog) -> None:
        self._catalog = catalog
        self._wanted = wanted_suffixes(catalog)
        self._folder = tempfile.TemporaryDirectory(prefix="dh2urdf-")
        # One folder deeper: an MJCF may include files beside its folder, and nothing is there.
        self._root = Path(self._folder.name).resolve() / "files"
        self._paths: list[Path] = []
        self._left = LARGEST
        for name, content in files:
            self.add(name, content)

    @property
    def descriptions(self) -> Sequence[str]:
        """The descriptions among them, those in fewer folders first."""
        suffixes = description_suffixes(self._catalog)
        paths = [path.relative_to(self._root) for path in self._paths]
        found = [path for path in paths if path.name.lower().endswith(suffixes) and path.name != PACKAGE_FILE]
        return [path.as_posix() for path in sorted(found, key=lambda path: (len(path.parts), path))]

    def figure(self, name: str) -> Figure | str:
        """The robot of one of the descriptions, with the mesh files that are here; or what is wrong with it."""
        path = self.path(name)
        try:
            figure = description(path, self._catalog)
        except Dh2UrdfError as error:
            return str(error).replace(f"{path.parent}{os.sep}", "").replace(f"{self._root}{os.sep}", "")
        addresses = dict.fromkeys(mesh.filename for mesh in meshes_of(figure.robot))
        files = {address: file for address in addresses if (file := self._file(address, figure.files.get(address)))}
        return replace(figure, title=path.name, files=files)

    def path(self, name: str) -> Path:
        """Where one of the descriptions is."""
        return self._root / name

    def close(self) -> None:
        """Remove the files."""
        self._folder.cleanup()

    def _file(self, address: str, found: Path | None) -> Path | None:
        """The file that an address means: the one that was found, or that whose path ends most like the address."""
        if found is not None and (path := found.resolve()).is_relative_to(self._root):
            return path
        wanted = tuple(part for part in address.replace("\\", "/").split("/") if part)
        for length in range(len(wanted), 0, -1):
            for path in self._paths:
                if path.parts[-length:] == wanted[-length:]:
                    return path
        return None

    def add(self, name: str, content: bytes) -> None:
        """Keep a file by its name, with slashes where it is in folders. A ZIP is unpacked.

        Raises:
            InputError: the files are more than `MOST_FILES`, or larger than `LARGEST`, or a ZIP cannot be read.
        """
        if not name.lower().endswith(".zip"):
            self._write(name, content)
            return
        with tempfile.TemporaryFile() as packed:
            packed.write(content)
            try:
                with zipfile.ZipFile(packed) as archive:
                    for entry in archive.infolist():
                        if not entry.is_dir() and self._place(entry.filename) is not None:
                            with archive.open(entry) as file:
                                self._write(entry.filename, file.read(self._left + 1))
            except BROKEN_ARCHIVE as error:
                raise InputError(say("archive-broken", name=name, reason=error)) from error

    def _place(self, name: str) -> Path | None:
        """Where a file is written; None for one that nothing here reads, or whose name leads elsewhere."""
        parts = PurePosixPath(name.replace("\\", "/")).parts
        if not parts or not name.lower().endswith(self._wanted):
            return None
        if any(part in ("..", "/") or ":" in part or "\0" in part for part in parts):
            return None
        return self._root.joinpath(*parts)

    def _write(self, name: str, content: bytes) -> None:
        if (path := self._place(name)) is None:
            return
        self._left -= len(content)
        if self._left < 0 or len(self._paths) == MOST_FILES:
            raise too_much()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        except OSError as error:
            raise InputError(say("file-not-kept", name=name, reason=error.strerror)) from error
        self._paths.append(path)
