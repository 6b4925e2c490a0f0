"""Pictures and materials that mesh files name: their copies lie beside that of the mesh, which names the copies.

Files of unknown origin name what they like. What is copied is in the folder of the mesh or in a package that the mesh
is in, and it is a picture by its content, or the statements of a material: nothing else gets into the output.
"""

from __future__ import annotations

from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.manipulator import MeshFile
from dh2urdf.meshes.files import copy_name, read_mesh
from dh2urdf.meshes.textures import NAMING, is_picture, names_in, with_names

if TYPE_CHECKING:
    from dh2urdf.meshes.addresses import NamedFiles


def with_named_files(file: MeshFile, files: NamedFiles) -> MeshFile:
    """A mesh file with the files that it names and that can be copied; `files` knows where they may be, and why not."""
    return _with_named(file, read_mesh(file), files) if Path(file.path).suffix.lower() in NAMING else file


def picture_of(name: str, files: NamedFiles) -> MeshFile | None:
    """The picture of a name; None, with a word in `unread` of the files, where it may not be copied."""
    if path := files.place_of(name):
        content = path.read_bytes()
        if is_picture(content, path.suffix.lower()):
            return MeshFile(path=str(path), sha256=sha256(content).hexdigest(), name=name)
        files.unread[name] = "it is no picture"
    return None


def _materials_of(name: str, files: NamedFiles) -> MeshFile | None:
    if (path := files.place_of(name)) is None:
        return None
    return _with_named(MeshFile(path=str(path), sha256="", name=name), path.read_bytes(), files)


def _with_named(file: MeshFile, content: bytes, files: NamedFiles) -> MeshFile:
    suffix = Path(file.path).suffix.lower()
    names = names_in(content, suffix)
    if suffix == ".gltf":
        files.unread |= dict.fromkeys(names, "what a glTF names stays where it is")
        return file
    found = [_materials_of(name, files) if suffix == ".obj" else picture_of(name, files) for name in names]
    named = tuple([each for each in found if each])
    if not named and suffix != ".mtl":
        return file
    copied = with_names(content, suffix, {each.name: copy_name(each) for each in named})
    return replace(file, named=named, sha256=sha256(copied).hexdigest())
