"""Mesh files: where a table finds them, how descriptions name them, and how they get beside the descriptions.

A mesh is copied once, however many robots share it, into the folder `FOLDER` of the output. The name of the copy has a
part of the content's hash in it, so that no two files get in each other's way, and no simulator takes one for another.
"""

from __future__ import annotations

import os
import re
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from dh2urdf.documents.text_files import check_file
from dh2urdf.errors import ConfigError, EmitterError, OutputError
from dh2urdf.manipulator import MeshFile
from dh2urdf.output.whole_files import safe_stem
from dh2urdf.robot import Mesh, Visual
from dh2urdf.source import Messages, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from dh2urdf.robot import Collision, Robot

    S = TypeVar("S", Visual, Collision)

say = Messages(__file__)

FOLDER = "meshes"  # the folder of the output that holds copies of meshes
RELATIVE, FILE = "relative", "file"
ACCEPTED = (
    f"{RELATIVE}: copies, named by their path from the description; {FILE}: no copies, but file:// and the path of "
    "each file; package://NAME: copies, in an output folder that is the ROS package NAME"
)
REMEDY = "have it converted: `output: {meshes: {convert: auto}}`"
"""The end of a notice's suggestion, where a conversion leaves nothing to notice."""
_DIGITS = 8  # hexadecimal digits of a content's hash in the name of its copy
_PACKAGE = r"package://[A-Za-z0-9][A-Za-z0-9._-]*(/[A-Za-z0-9][A-Za-z0-9._-]*)*/?"


def prefix_of(word: str, *, in_folders: bool = False) -> str | None:
    """What descriptions, maybe in folders of the output, write before the name of a copy; None without copies."""
    if word == RELATIVE:
        return f"../{FOLDER}/" if in_folders else f"{FOLDER}/"
    if word == FILE:
        return None
    if re.fullmatch(_PACKAGE, word):
        return f"{word.rstrip('/')}/{FOLDER}/"
    raise ConfigError(say("mesh-names-unknown", found=word, accepted=ACCEPTED))


# --- Files ------------------------------------------------------------------------------------------------------------


def find_mesh(text: str, folder: Path, *, links: bool = False) -> MeshFile:
    """The file that a table or a run file in a folder names; a `ConfigError` says where it was looked for.

    Only where `links` are allowed may a link lead out of that folder. A table may be a stranger's, and come with links
    to files of the user who reads it.
    """
    if "://" in text:
        raise ConfigError(say("mesh-address", found=text))
    path = Path(os.path.abspath(folder / text))  # noqa: PTH100 - as it is written: a link may have a better name
    try:
        check_file(path)
    except ConfigError as error:
        why = error.problems[0]
        advice = f"; {why.suggestion}" if why.suggestion else ""
        raise ConfigError(say("no-mesh", found=text, reason=why.message, path=path, advice=advice)) from None
    home = os.path.abspath(folder)  # noqa: PTH100 - as above
    said, target = home if path.is_relative_to(home) else path.parent, Path(os.path.realpath(path))
    # A link may not lead out of the folder, nor out of another one that the path names.
    if not links and not any(target.is_relative_to(os.path.realpath(root)) for root in (home, said)):
        raise ConfigError(say("mesh-link-outside", found=text, folder=said, target=target))
    try:
        status = path.stat()
        return MeshFile(path=str(path), sha256=_digest(str(path), status.st_mtime_ns, status.st_size))
    except OSError as error:
        raise ConfigError(say("mesh-unreadable", found=text, mesh=text, reason=error.strerror)) from None


@lru_cache(maxsize=4096)
def _digest(path: str, _changed: int, _size: int) -> str:
    """The hash of a file, which many manipulators may share; it is taken again after a change."""
    import hashlib

    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def read_mesh(file: MeshFile) -> bytes:
    """What is in a mesh file."""
    if file.content is not None:
        return file.content
    from hashlib import sha256

    try:
        content = Path(file.path).read_bytes()
    except OSError as error:
        raise OutputError(say("mesh-unreadable", mesh=file.path, reason=error.strerror)) from error
    if file.named or file.path.lower().endswith(".mtl"):
        from dh2urdf.meshes.textures import with_names

        names = {each.name: copy_name(each) for each in file.named}
        content = with_names(content, Path(file.path).suffix.lower(), names)
    if sha256(content).hexdigest() != file.sha256:
        raise OutputError(say("mesh-changed", mesh=file.path))
    return content


def copy_name(file: MeshFile) -> str:
    """The name of the copy of a mesh."""
    path = Path(file.path)
    return f"{safe_stem(path.stem)}-{file.sha256[:_DIGITS]}{path.suffix.lower()}"


def copy_path(file: MeshFile) -> str:
    """The place of the copy in the output."""
    return f"{FOLDER}/{copy_name(file)}"


# --- Robots -----------------------------------------------------------------------------------------------------------


def located(robot: Robot, prefix: str | None) -> Robot:
    """A robot, and the kinds of its arms, whose meshes are named as descriptions name them; see `prefix_of`."""
    if prefix is None or not mesh_files(robot):
        return robot

    def named(_link: str, shape: S) -> list[S]:
        return [with_addresses(shape, lambda file: f"{prefix}{copy_name(file)}")]

    return with_shapes(robot, named, named)


def with_addresses(shape: S, address_of: Callable[[MeshFile], str]) -> S:
    """A shape whose mesh, and the picture on whose material, have other addresses, where their files are at hand."""
    mesh = shape.geometry
    if isinstance(mesh, Mesh) and mesh.file is not None:
        shape = replace(shape, geometry=replace(mesh, filename=address_of(mesh.file)))
    if isinstance(shape, Visual) and (material := shape.material) and material.picture:
        return replace(shape, material=replace(material, texture=address_of(material.picture)))
    return shape


def with_shapes(
    robot: Robot,
    seen: Callable[[str, Visual], Iterable[Visual]],
    touching: Callable[[str, Collision], Iterable[Collision]],
) -> Robot:
    """A robot, and the kinds of its arms, with other visuals and collisions, given the name of the link and the shape.

    An `EmitterError` names the link.
    """
    kinds = {id(arm.kind): with_shapes(arm.kind, seen, touching) for arm in robot.arms}
    links = []
    for link in robot.links:
        try:
            visuals = tuple([made for shape in link.visuals for made in seen(link.name, shape)])
            collisions = tuple([made for shape in link.collisions for made in touching(link.name, shape)])
        except EmitterError as error:
            of = f"link {shown(link.name)}: "
            raise EmitterError(replace(each, message=of + each.message) for each in error.problems) from error
        links.append(replace(link, visuals=visuals, collisions=collisions))
    arms = tuple([replace(arm, kind=kinds[id(arm.kind)]) for arm in robot.arms])
    return replace(robot, links=tuple(links), arms=arms)


def mesh_files(robot: Robot) -> tuple[MeshFile, ...]:
    """The mesh files of a robot that are at hand and the files that they name, each once, in the order of its links."""
    files = [mesh.file for mesh in _meshes(robot)]
    files += [each.material.picture for link in robot.links for each in link.visuals if each.material]
    return tuple(dict.fromkeys(each for file in files if file for each in with_its_files(file)))


def with_its_files(file: MeshFile) -> Iterator[MeshFile]:
    """A mesh file, and the files that it names and those that they name, which are copied into the same folder."""
    yield file
    for named in file.named:
        yield from with_its_files(named)


def has_meshes(robot: Robot) -> bool:
    """Whether any link of a robot is a mesh."""
    return next(_meshes(robot), None) is not None


def _meshes(robot: Robot) -> Iterator[Mesh]:
    for link in robot.links:
        shapes: Iterable[Visual | Collision] = (*link.visuals, *link.collisions)
        for shape in shapes:
            if isinstance(shape.geometry, Mesh):
                yield shape.geometry
