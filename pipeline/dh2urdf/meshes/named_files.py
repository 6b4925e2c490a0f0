"""The files that a mesh file names: its materials, its textures and its buffers, and nothing else of the machine."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING
from urllib.parse import unquote

from dh2urdf.documents.text_files import is_file
from dh2urdf.meshes.addresses import FILE, own_folder
from dh2urdf.source import shown

if TYPE_CHECKING:
    from pathlib import Path

SUFFIXES = (".bin", ".bmp", ".gif", ".jpeg", ".jpg", ".mtl", ".png", ".tga", ".tif", ".tiff", ".webp")
"""How the names of files end that a mesh file may name: MTL of an OBJ, buffers of a glTF, and pictures."""


class NamedFiles:
    """What trimesh asks for the files that a mesh file names: a resolver, as `trimesh.load_scene` takes it.

    A file is read if it is in the folder of the mesh or below it, or anywhere in the ROS package of the mesh. Links are
    followed before that is decided.

    Attributes:
        unread: the names that were not read, each with the reason.

    Args:
        mesh: the mesh file.
        largest: size of a file that is read [B].
    """

    def __init__(self, mesh: Path, largest: int) -> None:
        self._folder = mesh.resolve().parent
        self._root = own_folder(mesh)
        self._largest = largest
        self.unread: dict[str, str] = {}

    def get(self, name: str) -> bytes:
        """The bytes of a file.

        Raises:
            OSError: it is not one of the mesh's own files, or cannot be read.
        """
        try:
            return self._read(name)
        except (OSError, ValueError) as error:
            reason = (error.strerror if isinstance(error, OSError) else "") or str(error)
            self.unread[name] = reason
            raise OSError(reason) from error

    __getitem__ = get

    def _read(self, name: str) -> bytes:
        address = unquote(name).replace("\\", "/").removeprefix(FILE)
        if "://" in address:
            raise ValueError("it is an address, and no file")
        path = (self._folder / address).resolve()
        if not path.is_relative_to(self._root):
            raise ValueError("it is outside of the folder of the mesh, and of its package")
        if path.suffix.lower() not in SUFFIXES:
            raise ValueError(f"files with the suffix {shown(path.suffix)} are not read")
        if not is_file(path):
            raise ValueError("there is no such file")
        if path.stat().st_size > self._largest:
            raise ValueError(f"it is larger than {self._largest // 2**20} MB")
        content = path.read_bytes()
        if path.suffix.lower() not in (".bin", ".mtl"):
            _check_picture(content)
        return content


def _check_picture(content: bytes) -> None:
    """Looks at the beginning of a picture, as trimesh leaves out what Pillow cannot open, without a word.

    Raises:
        ValueError: it is no picture, or Pillow is not installed.
    """
    try:
        from PIL import Image, UnidentifiedImageError
    except ImportError as error:
        raise ValueError("textures need Pillow, which is not installed") from error
    try:
        Image.open(io.BytesIO(content)).close()
    except (UnidentifiedImageError, Image.DecompressionBombError) as error:
        raise ValueError("it is no picture that can be shown") from error
