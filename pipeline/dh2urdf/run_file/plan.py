"""A run file whose stages and options are all resolved: what there is to do, before anything is read or written."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.cells.cell import CellCall
from dh2urdf.conversion.keys import recipe_key
from dh2urdf.conversion.one_manipulator import Recipe
from dh2urdf.conversion.simulators import missing_of, require
from dh2urdf.errors import ConfigError, InputError, PluginError
from dh2urdf.output.layouts import Layout
from dh2urdf.output.store import Store, open_store
from dh2urdf.plugin_system.calls import Call, call_of
from dh2urdf.run_file.mesh_section import MeshCall
from dh2urdf.run_file.part_section import with_parts
from dh2urdf.source import Messages, Problem, in_file_order
from dh2urdf.stages import Executor, Reader, WritesFolders
from dh2urdf.variations import sampling
from dh2urdf.variations.variation import VariationCall

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.run_file.config import InputCall, RunConfig, StageCall
    from dh2urdf.source import Mark

say = Messages(__file__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A run file whose stages and options are all resolved."""

    inputs: tuple[tuple[Path, Call[Reader[Any]]], ...]
    recipe: Recipe  # what is done with every manipulator
    key: str  # the recipe's, by which a later run knows files that are still right
    store: Store  # where the output goes
    layout: Layout  # under which names
    executor: Call[Executor[Any]]
    cells: tuple[CellCall, ...] = ()  # made when all manipulators have been read
    variations: tuple[VariationCall, ...] = ()  # made at the end
    html: bool = True  # whether to write a page for people, where its packages are installed
    meshes: tuple[MeshCall, ...] = ()
    files: tuple[Path, ...] = ()  # what the run reads besides: its run file
    command: str | None = None  # what makes the same files; None where a program began the run
    input_notices: Mapping[Path, Problem] = field(default_factory=dict)  # of inputs before they are read
    reports: Store | None = None  # where the files about the run go, where that is another place

    @property
    def report_store(self) -> Store:
        """Where the files about the run go: report, manifest, index, journal."""
        return self.reports or self.store


def make_plan(config: RunConfig, catalog: Catalog) -> Plan:
    """Resolve every stage and every option of a run file; all that is wrong is reported at once, in a ConfigError."""
    asked = _Stages(catalog, config.problems, config.folder)
    inputs = asked.readers(config.inputs)
    transform = asked.call("transform", config.transform)
    edits = [asked.call("edit", each) for each in config.edits]  # one may be there twice, with other options
    emitters = asked.calls("emitter", config.emitters)
    loaders = asked.calls("loader", config.loaders)
    executor = asked.call("executor", config.execution)
    formats = [
        call.stage.name if call else each.stage or "" for each, call in zip(config.emitters, emitters, strict=True)
    ]
    for each, loader in zip(config.loaders, loaders, strict=True):
        if loader is not None and not set(loader.stage.formats) & set(formats):
            about = {"found": ", ".join(formats), "loader": loader.stage.name, "needs": loader.stage.formats}
            asked.problems.append(say("loader-without-file", each.mark, field="loaders", **about))
    cells = config.cells
    try:
        cells = with_parts(config.cells, config.parts, catalog, all_known=not config.problems)
    except ConfigError as error:
        asked.problems += error.problems
    if asked.problems or transform is None or executor is None:
        raise ConfigError(in_file_order(asked.problems))
    recipe = Recipe(
        transform=transform,
        emitters=tuple(call for call in emitters if call),
        edits=tuple(call for call in edits if call),
        loaders=tuple(call for call in loaders if call),
        only={
            call.stage.name: each.only
            for call, each in zip(emitters, config.emitters, strict=True)
            if call and each.only
        },
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
    for kind in {call.sampling for call in config.variations} | {call.sampling for call in config.cells}:
        sampling.require(kind)
    output = config.output.directory or Path()
    reports = config.report_directory or output
    if config.report_directory is None and all(call.stage.can(WritesFolders) for call in recipe.emitters):
        # Folders of packages, and nothing else, are where the output goes.
        beside = f"{str(output).rstrip('/')}_report"
        reports = beside if isinstance(output, str) else Path(beside)
    return Plan(
        inputs=inputs,
        recipe=recipe,
        key=recipe_key(recipe),
        store=open_store(output),
        layout=config.output.layout,
        executor=executor,
        cells=cells,
        variations=config.variations,
        html=config.report.html,
        meshes=config.meshes,
        input_notices=asked.notices,
        reports=None if str(reports) == str(output) else open_store(reports),
    )


class _Stages:
    """Finds the stages of a run file; gathers what is wrong, and the findings about inputs by their paths."""

    def __init__(self, catalog: Catalog, problems: Iterable[Problem], folder: Path) -> None:
        self.problems = list(problems)
        self.notices: dict[Path, Problem] = {}
        self._catalog, self._folder = catalog, folder

    @contextmanager
    def _at(self, mark: Mark | None) -> Iterator[None]:
        """Problems with what a place asks for are reported with the place."""
        try:
            yield
        except InputError as error:
            self.problems += [problem.about(mark=mark) for problem in error.problems]
        except PluginError as error:
            error.mark = error.mark or mark
            raise

    def call(self, kind: Any, asked: StageCall | InputCall, name: str | None = None) -> Call[Any] | None:  # noqa: ANN401
        """The stage of a kind, of a name where one is given, with its options; None where something is wrong."""
        name = name or asked.stage
        with self._at(asked.mark):
            stage: Any = self._catalog.get(kind, name) if name else self._catalog.usual(kind)
            return call_of(self._catalog, stage, asked.options, asked.mark, self._folder)
        return None

    def calls(self, kind: Any, asked: Sequence[StageCall]) -> list[Call[Any] | None]:  # noqa: ANN401 - a kind of stage
        """Stages of a kind, each name once: files and reports are named by these names."""
        calls = [self.call(kind, each) for each in asked]
        first: dict[str, StageCall] = {}
        for given, call in zip(asked, calls, strict=True):
            if call is not None and (other := first.setdefault(call.stage.name, given)) is not given:
                about: dict[str, Any] = {"found": call.stage.name, "kind": call.kind, "first": other.mark}
                self.problems.append(say("stage-twice", given.mark, field=f"{call.kind}s", **about))
        return calls

    def readers(self, inputs: Iterable[InputCall]) -> tuple[tuple[Path, Call[Reader[Any]]], ...]:
        """Every input file once with its reader: the one that is named, or that of its suffix."""
        found: list[tuple[Path, Call[Reader[Any]]]] = []
        first: dict[tuple[int, int], tuple[Path, Call[Reader[Any]], Mark | None]] = {}
        for given in inputs:
            self.notices.update((path, notice) for path, notice in zip(given.paths, given.notices, strict=False))
            calls: dict[str, Call[Reader[Any]] | None] = {}
            before = len(self.problems)
            for path in given.paths:
                if len(self.problems) > before:
                    break  # What is wrong with a file is often wrong with all files of this input.
                with self._at(given.mark):
                    name = given.stage or self._catalog.reader_for(path).name
                    if name not in calls:
                        calls[name] = self.call("reader", given, name)
                    if (call := calls[name]) is None:
                        break
                    status = path.stat()
                    other, earlier, at = first.setdefault((status.st_dev, status.st_ino), (path, call, given.mark))
                    advice = f"the first time is at {at}" if at != given.mark else None
                    about: dict[str, Any] = {"field": "inputs", "path": other, "suggestion": advice}
                    if other is path:
                        found.append((path, call))
                    elif (call.stage, call.options) == (earlier.stage, earlier.options):  # Once is enough.
                        self.notices.setdefault(other, say("input-twice", given.mark, **about))
                    else:
                        self.problems.append(say("input-read-twice", given.mark, found=str(path), **about))
        return tuple(found)
