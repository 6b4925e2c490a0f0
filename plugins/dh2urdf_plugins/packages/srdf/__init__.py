"""The stage ``srdf``: the semantic description of a robot or a cell, and the collision pairs of any description."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.errors import ConfigError, InputError
from dh2urdf.source import Mark, Messages
from dh2urdf.stages import Annotates, EmittedFile, Emitter
from dh2urdf_plugins.collision_pairs.options import PairOptions
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.robot import Mesh, Robot
    from dh2urdf.stages import Annotation, Expansion

say = Messages(__file__)

# What searches for pairs is imported where it is used: a run without an SRDF pays for none of it.

GROUP = "manipulator"
_MACROS = ".xacro"


@dataclass(frozen=True, slots=True, kw_only=True)
class SrdfOptions(PairOptions):
    """How collision pairs are looked for, and what the group of joints is called."""

    group: str = option("name of the group from base_link to tool0; in a cell behind the prefix of each arm", GROUP)


def emit(robot: Robot, stem: str, options: SrdfOptions) -> tuple[EmittedFile]:
    """The SRDF of a robot, as ``<stem>.srdf``; it raises what `srdf` raises."""
    from dh2urdf.cells.floating import without_world

    return (EmittedFile(name=f"{stem}.srdf", content=srdf(without_world(robot), options, options.group)),)


def srdf(robot: Robot, options: PairOptions, group: str) -> bytes:
    """The SRDF of a robot."""
    from dh2urdf_plugins.collision_pairs.search import robot_pairs
    from dh2urdf_plugins.formats.urdf.writer import serialise
    from dh2urdf_plugins.packages.srdf.semantics import semantics

    return serialise(semantics(robot, robot_pairs(robot, options), group), robot.comment)


def annotate(path: Path, expansion: Expansion, earlier: Path | None, options: SrdfOptions) -> Annotation:
    """The collision pairs of a URDF or a xacro of any origin, in an SRDF of their own or in an earlier one."""
    from dh2urdf.documents import read_bytes
    from dh2urdf.meshes import mesh_finder, packages_in, with_its_own
    from dh2urdf.stages import Annotation
    from dh2urdf_plugins.collision_pairs.scene import Mechanism
    from dh2urdf_plugins.collision_pairs.search import collision_pairs
    from dh2urdf_plugins.descriptions.description import describe
    from dh2urdf_plugins.formats.xml_files import LARGEST
    from dh2urdf_plugins.packages.srdf.pairs_text import new_file, updated

    has_macros = path.name.lower().endswith(_MACROS)
    if expansion.arguments and not has_macros:
        raise ConfigError(say("arguments-without-macros", Mark(file=str(path))))
    content = None if earlier is None else read_bytes(earlier, InputError, limit=LARGEST)
    packages = with_its_own(path, packages_in(expansion.package_paths))
    description = describe("xacro" if has_macros else "urdf", path, expansion)
    find = mesh_finder(description.folder, packages)

    def mesh(shape: Mesh) -> tuple[bytes, str]:
        if (file := find(shape.filename)) is None:
            raise InputError(say("collision-mesh-missing", Mark(file=str(path)), mesh=shape.filename))
        return read_bytes(file, InputError, limit=LARGEST), file.suffix.lower()

    mechanism = Mechanism(robot=description.robot, loose=description.loose, file=description.file)
    pairs = collision_pairs(mechanism, mesh, options)
    if content is None:
        return Annotation(content=new_file(description.robot, pairs.disabled), summary=pairs.summary)
    content, notices = updated(content, str(earlier), description.robot, pairs.disabled)
    return Annotation(content=content, summary=pairs.summary, notices=tuple(notices))


EMITTER = Emitter(
    name="srdf",
    summary="an SRDF for MoveIt: groups, named states, and the collision pairs that need no check",
    suffixes=(".srdf",),
    options=SrdfOptions,
    emit=emit,
    capabilities=(Annotates(annotate),),
)
