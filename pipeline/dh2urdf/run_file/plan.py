"""A run file whose stages and options are all resolved: what there is to do, before anything is read or written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.cells.cell import CellCall
from dh2urdf.conversion.keys import recipe_key
from dh2urdf.conversion.one_manipulator import Recipe
from dh2urdf.conversion.simulators import missing_of, require
from dh2urdf.errors import ConfigError
from dh2urdf.output.layouts import Layout
from dh2urdf.output.store import Store, open_store
from dh2urdf.run_file.mesh_section import MeshCall
from dh2urdf.run_file.stages_by_name import AskedStages
from dh2urdf.source import Problem, in_file_order
from dh2urdf.stage_calls.calls import Call
from dh2urdf.stages import Executor, Reader, WritesFolders
from dh2urdf.variations import sampling
from dh2urdf.variations.variation import VariationCall

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.run_file.records import RunConfig
    from dh2urdf.stages import Emitter


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A run file whose stages and options are all resolved.

    Attributes:
        inputs: files with the reader of each.
        input_notices: the findings about inputs before they are read, by path.
        recipe: what is done with every manipulator.
        key: the recipe's, by which a later run knows files that are still right.
        store: where the output goes.
        reports: where the files about the run go, where that is another place.
        layout: under which names.
        executor: does the work.
        cells: robots of several of the manipulators, made when all have been read.
        variations: manipulators drawn from others, made at the end.
        html: whether to write a page for people, where its packages are installed.
        meshes: mesh files that links are drawn and touched as.
        files: what the run reads besides: its run file.
        command: the command that makes the same files; None where a program began the run.
    """

    inputs: tuple[tuple[Path, Call[Reader[Any]]], ...]
    recipe: Recipe
    key: str
    store: Store
    layout: Layout
    executor: Call[Executor[Any]]
    cells: tuple[CellCall, ...] = ()
    variations: tuple[VariationCall, ...] = ()
    html: bool = True
    meshes: tuple[MeshCall, ...] = ()
    files: tuple[Path, ...] = ()
    command: str | None = None
    input_notices: Mapping[Path, Problem] = field(default_factory=dict)
    reports: Store | None = None

    @property
    def report_store(self) -> Store:
        """Where the files about the run go: report, manifest, index, journal."""
        return self.reports or self.store


def make_plan(config: RunConfig, catalog: Catalog) -> Plan:
    """Resolve every stage and every option of a run file, before anything is read or written.

    Raises:
        ConfigError: something in the run file is wrong; all problems are reported at once.
        PluginError: the run needs a plugin that is broken, or a package that is not installed.
    """
    asked = AskedStages(catalog, config.problems, config.folder)
    inputs = asked.readers(config.inputs)
    transform = asked.call("transform", config.transform)
    edits = [asked.call("edit", each) for each in config.edits]  # one may be there twice, with other options
    emitters = asked.calls("emitter", config.emitters)
    loaders = asked.calls("loader", config.loaders)
    executor = asked.call("executor", config.execution)
    asked.check_loaders(config.loaders, loaders, config.emitters, emitters)
    if asked.problems or transform is None or executor is None:
        raise ConfigError(in_file_order(asked.problems))
    recipe = Recipe(
        transform=transform,
        emitters=tuple(call for call in emitters if call),
        edits=tuple(call for call in edits if call),
        loaders=tuple(call for call in loaders if call),
        optional=frozenset(
            call.stage.name for call, each in zip(loaders, config.loaders, strict=True) if call and each.optional
        ),
        poses=config.proof.poses,
        proved=config.proof.proved,
        sample=config.sample,
        time_limit=config.execution.time_limit,
        mesh_prefix=config.output.mesh_prefix,
        mesh_conversion=config.output.mesh_conversion,
    )
    recipe = replace(recipe, missing=missing_of(recipe))
    require(executor)
    for variation in config.variations:
        sampling.require(variation.sampling)
    return Plan(
        inputs=inputs,
        recipe=recipe,
        key=recipe_key(recipe),
        store=open_store(config.output.directory or Path()),
        layout=config.output.layout,
        executor=executor,
        cells=config.cells,
        variations=config.variations,
        html=config.report.html,
        meshes=config.meshes,
        input_notices=asked.notices,
        reports=_reports(config, emitters),
    )


def _reports(config: RunConfig, emitters: Sequence[Call[Emitter[Any]] | None]) -> Store | None:
    """Where the files about a run go: beside the output, where that holds folders of packages and nothing else."""
    asked, output = config.report_directory, config.output.directory
    if asked is not None:
        return None if str(asked) == str(output) else open_store(asked)
    if emitters and all(call is not None and call.stage.can(WritesFolders) for call in emitters):
        place = f"{str(output).rstrip('/')}_report"
        return open_store(place if isinstance(output, str) else Path(place))
    return None
