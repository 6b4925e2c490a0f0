"""Robots whose meshes are files that every simulator takes, as a user asks for them.

What a link weighs is computed of the mesh as it is given, and stays: a conversion is of shapes alone.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.errors import ConfigError, CrashError, EmitterError, MissingDependencyError
from dh2urdf.manipulator import MeshFile
from dh2urdf.meshes.addresses import file_address
from dh2urdf.meshes.files import REMEDY, mesh_files, read_mesh, with_shapes
from dh2urdf.meshes.kinds import MeshConversion
from dh2urdf.robot import Material, Mesh
from dh2urdf.source import Messages, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.robot import Collision, Robot, Visual
    from dh2urdf.rotations import Vec3

say = Messages(__file__)

ACCEPTED = (
    f"{MeshConversion.NEVER}: files as they are given; {MeshConversion.AUTO}: OBJ files, which all simulators take; "
    f"{MeshConversion.HULL}: besides, what touches is the convex hull; {MeshConversion.DECOMPOSITION}: besides, what "
    "touches are convex parts"
)
LARGEST = 2**28  # the largest file that is converted [B]
SECONDS = {MeshConversion.AUTO: 60.0, MeshConversion.HULL: 60.0, MeshConversion.DECOMPOSITION: 900.0}
"""How long the conversion of one mesh may take [s]."""


def conversion_of(word: str, prefix: str | None) -> MeshConversion:
    """What a word of a user means; `prefix` is what `dh2urdf.meshes.files.prefix_of` gives."""
    try:
        how = MeshConversion(word)
    except ValueError:
        near = did_you_mean(word, [each.value for each in MeshConversion])
        raise ConfigError(say("mesh-conversion-unknown", found=word, accepted=ACCEPTED, suggestion=near)) from None
    if how is not MeshConversion.NEVER and prefix is None:
        raise ConfigError(say("conversion-without-copies", found=word))
    return how


def unsettled(notices: Iterable[Problem]) -> tuple[Problem, ...]:
    """Those notices that a conversion leaves something of."""
    return tuple(notice for notice in notices if not (notice.suggestion or "").endswith(REMEDY))


def lost_pictures(robot: Robot) -> tuple[Problem, ...]:
    """Notices of the pictures that a conversion leaves out."""
    pictured = [file for file in mesh_files(robot) if file.named and not file.name]
    return tuple([say("mesh-pictures-lost", robot=robot.name, name=Path(file.path).name) for file in pictured])


def converted(robot: Robot, how: MeshConversion) -> Robot:
    """A robot, and the kinds of its arms, whose meshes are converted.

    What cannot be converted is an `EmitterError` that names mesh and link; a library that crashed on it, or did not
    finish in time, is a `CrashError`.
    """
    if not mesh_files(robot):
        return robot
    lost = lost_pictures(robot)
    robot = with_shapes(robot, _visuals, partial(_collisions, how=how))
    arms = tuple([replace(arm, kind=replace(arm.kind, notices=unsettled(arm.kind.notices))) for arm in robot.arms])
    return replace(robot, notices=(*unsettled(robot.notices), *lost), arms=arms)


def _visuals(_link: str, shape: Visual) -> Iterator[Visual]:
    """A visual in OBJ: several, where its file has several colours and the robot gives it none."""
    mesh = shape.geometry
    if not isinstance(mesh, Mesh) or mesh.file is None:
        yield shape
        return
    seen, (whole, *_) = _converted_file(mesh.file, mesh.scale, MeshConversion.AUTO)
    for rgba, file in seen if shape.material is None else ((None, whole),):
        material = shape.material
        if rgba:  # A colour has the same name in every mesh and robot.
            material = Material(name="mesh_" + "".join([f"{round(255 * part):02x}" for part in rgba]), rgba=rgba)
        yield replace(shape, geometry=_geometry(file), material=material)


def _collisions(_link: str, shape: Collision, how: MeshConversion) -> Iterator[Collision]:
    mesh = shape.geometry
    if not isinstance(mesh, Mesh) or mesh.file is None:
        yield shape
        return
    for file in _converted_file(mesh.file, mesh.scale, how)[1]:
        yield replace(shape, geometry=_geometry(file))


def _geometry(file: MeshFile) -> Mesh:
    return Mesh(filename=file_address(file.path), file=file)


@lru_cache(maxsize=256)
def _converted_file(
    file: MeshFile, scale: Vec3, how: MeshConversion
) -> tuple[tuple[tuple[tuple[float, float, float, float] | None, MeshFile], ...], tuple[MeshFile, ...]]:
    """A file as files to be seen, with their colours, and files that touch."""
    from hashlib import sha256

    from dh2urdf.isolation.child_process import run_in_child
    from dh2urdf.isolation.encodings import Data
    from dh2urdf.meshes.forms import Forms, behind_fence
    from dh2urdf.meshes.triangles import FORMATS

    path = Path(file.path)
    name, suffix = shown(path.name), path.suffix.lower()
    if suffix not in FORMATS:
        raise EmitterError(say("mesh-of-other-format", name=path.name, suffixes=tuple(FORMATS)))
    content = read_mesh(file)
    if len(content) > LARGEST:
        raise EmitterError(say("mesh-too-large", name=path.name, size=len(content) / 2**20, most=LARGEST >> 20))
    seconds = SECONDS[how]
    who = f"the conversion of the mesh {name}"
    try:
        made = run_in_child(
            behind_fence, content, suffix, scale, how, seconds, timeout=seconds, who=who, encoding=Data(Forms)
        ).value
    except ImportError as error:
        package = {"collada": "pycollada"}.get(error.name or "", error.name or str(error))
        conversion = f"`output: {{meshes: {{convert: {how}}}}}`"
        raise MissingDependencyError(conversion, package, "dh2urdf[meshes]", error) from error
    except (MemoryError, ValueError) as error:
        reason = str(error) if isinstance(error, ValueError) else "it needs too much memory"
        raise EmitterError(say("mesh-unconvertible", name=path.name, reason=reason)) from error
    except CrashError as error:
        accepted = f"a mesh whose conversion takes less than {seconds:g} s"
        raise type(error)([replace(problem, accepted=accepted) for problem in error.problems]) from error
    word = {MeshConversion.HULL: "_hull", MeshConversion.DECOMPOSITION: "_part"}.get(how, "")

    def named(kind: str, contents: list[bytes]) -> list[MeshFile]:
        numbers = [""] if len(contents) == 1 else [f"_{number}" for number in range(1, len(contents) + 1)]
        places = [path.with_name(f"{path.stem}{kind}{number}.obj") for number in numbers]
        return [
            MeshFile(path=str(place), sha256=sha256(each).hexdigest(), content=each)
            for place, each in zip(places, contents, strict=True)
        ]

    seen = named("", [each for _, each in made.visuals])
    colours = [rgba for rgba, _ in made.visuals]
    return tuple(zip(colours, seen, strict=True)), tuple(named(word, made.collisions))
