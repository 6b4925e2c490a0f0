"""The section `parts` of a run file: robot descriptions that cells have beside manipulators, as they are."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

from dh2urdf.cells.attachments import AttachmentCall, attachment_of
from dh2urdf.documents import check_file
from dh2urdf.errors import ConfigError, InputError, ManipulatorError
from dh2urdf.plugin_system.calls import a_record, blaming, default_call
from dh2urdf.run_file.sections import KeepSection, PartSection
from dh2urdf.source import Mark, Messages, did_you_mean
from dh2urdf.stages import Expansion, ForeignRobot, ReadsForeign, arguments_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.cells.cell import CellCall
    from dh2urdf.documents.document import Node
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.robot import Attachment
    from dh2urdf.run_file.reading import Reading
    from dh2urdf.source import Problem

say = Messages(__file__)


@dataclass(frozen=True, slots=True, kw_only=True)
class PartCall:
    """A part as a run file asks for it."""

    path: Path
    call: AttachmentCall  # what is asked of the file; each cell has the place where it is held
    expansion: Expansion  # how it is expanded where it holds macros
    mark: Mark | None = field(default=None, compare=False)


def read_parts(entries: Iterable[tuple[Node, str]], to: Reading) -> tuple[PartCall, ...]:
    """The parts, each in its node at its place."""
    return to.distinct(to.entries(entries, PartSection, _part), lambda part: part.call.name, "parts")


def _part(given: PartSection, node: Node, place: str, to: Reading) -> PartCall | None:
    file, packages = node.entry("file") or node, node.entry("packages")
    keep = KeepSection(elements="none") if isinstance(given.keep, str) else given.keep
    with to.noting(file, f"{place}.file"):
        path = to.folder_of(file) / given.file
        check_file(path)
        folders = {}
        for name, folder in (given.packages or {}).items():
            entry = (packages.entry(name) if packages else None) or node
            folders[name] = to.folder_of(entry) / folder
        call = AttachmentCall(
            name=given.name,
            root=given.root,
            tip=given.tip,
            srdf=None if given.srdf is None else to.folder_of(file) / given.srdf,
            elements=keep.elements == "all",
            repairs=keep.inertia == "repair",
            missing_meshes=keep.missing_meshes,
            packages=folders,
            mesh_links=given.mesh_links,
        )
        expansion = Expansion(arguments=arguments_of(given.args), package_paths=tuple(folders.values()))
        return PartCall(path=path, call=call, expansion=expansion, mark=node.mark)
    return None


def with_parts(
    cells: Sequence[CellCall], parts: Sequence[PartCall], catalog: Catalog, *, all_known: bool
) -> tuple[CellCall, ...]:
    """Cells whose arms that name a part have what its file holds, which is read once.

    Args:
        cells: the cells.
        parts: the parts.
        catalog: has what reads them.
        all_known: whether these are all cells: one that is wrong may name a part.

    Raises:
        ConfigError: a part cannot be read, or no cell has it.
    """
    found: dict[str, tuple[Attachment, tuple[Problem, ...]]] = {}
    problems: list[Problem] = []
    named = {arm.of for cell in cells for arm in cell.arms}
    for part in parts:
        name = part.call.name
        if name not in named and all_known:
            near = did_you_mean(name, named)
            problems.append(say("part-unused", part.mark, field="parts", found=name, suggestion=near))
            continue
        try:
            found[name] = attachment_of(_read(part, catalog), part.path, part.call)
        except (InputError, ManipulatorError) as error:
            problems += [problem.about(mark=problem.mark or part.mark) for problem in error.problems]
    if problems:
        raise ConfigError(problems)
    made = []
    for cell in cells:
        arms = [replace(arm, part=found[arm.of][0]) if arm.of in found else arm for arm in cell.arms]
        of_parts = dict.fromkeys(arm.of for arm in cell.arms if arm.of in found)
        notices = [notice for of in of_parts for notice in found[of][1]]
        made.append(replace(cell, arms=tuple(arms), notices=(*cell.notices, *notices)))
    return tuple(made)


def _read(part: PartCall, catalog: Catalog) -> ForeignRobot:
    """What the file of a part holds."""
    emitter = catalog.emitter_for(part.path)
    reads = emitter.can(ReadsForeign)
    if reads is None or not reads.can_attach:
        others = [
            name
            for name, each in catalog.by_name("emitter").items()
            if (its := each.stage.can(ReadsForeign)) and its.can_attach
        ]
        name, found = emitter.name, part.path.name
        raise ConfigError(
            say("part-of-other-format", part.mark, field="file", found=found, format=name, formats=others)
        )
    with blaming(default_call(catalog, emitter), "read_foreign"):
        return cast("ForeignRobot", a_record(reads.read_foreign(part.path, part.expansion), ForeignRobot))
