"""A whole run: inputs, manipulators, robots, files, simulators. The only place that knows the order of the stages."""

from __future__ import annotations

import time
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf import sampling
from dh2urdf.cells import Cell, CellCall, with_tables
from dh2urdf.conversion import Call, Recipe, Written, blaming, make_cell, make_robot, read_items, write_robot
from dh2urdf.errors import (
    ConfigError,
    InputError,
    ManipulatorError,
    OutputError,
    StageError,
    TableError,
)
from dh2urdf.gathering import Gathering
from dh2urdf.isolation import load_in_child
from dh2urdf.kinematics import KinematicChain
from dh2urdf.laws import Value
from dh2urdf.manipulator import Manipulator
from dh2urdf.options import make_options
from dh2urdf.output import Stems
from dh2urdf.proof import joint_vectors
from dh2urdf.source import Mark, Problem, in_file_order, shown
from dh2urdf.stages import Executor, Loader, LoadReport, LoadRequest, Reader, Rejected
from dh2urdf.truth import Truth
from dh2urdf.variation_binding import bind
from dh2urdf.variations import Variant, VariationCall

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.config import RunConfig, StageCall
    from dh2urdf.registry import Catalog
    from dh2urdf.robot import Robot
    from dh2urdf.rotations import RigidTransform

ALL_PROVED = 100
"""Manipulators of a run that are proved in every format [1]; formats whose proof is slow are sampled beyond."""
SAMPLE = 50
"""Beyond that, every how many-th manipulator is proved in the slow formats too [1]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A run file whose stages and options are all resolved.

    Attributes:
        inputs: files with the reader and the reader's options of each.
        recipe: what is done with every manipulator.
        directory: where the output goes.
        executor: does the work.
        executor_options: its options.
        cells: robots of several of the manipulators, made when all have been read.
        variations: manipulators drawn from others, made at the end.
    """

    inputs: tuple[tuple[Path, Reader[Any], Any], ...]
    recipe: Recipe
    directory: Path
    executor: Executor[Any]
    executor_options: Any
    cells: tuple[CellCall, ...] = ()
    variations: tuple[VariationCall, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """One manipulator, one cell of several or one variant of one, for a worker.

    Attributes:
        index: its number in the run, from 0.
        item: the manipulator, cell or variant, or why it cannot be read; a variant is drawn by the worker.
        source: the file it comes from.
        stem: the stem of its files.
        notices: what is known before the work begins.
        traceback: where its reader failed.
    """

    index: int
    item: Manipulator | Cell | Variant | Rejected
    source: str
    stem: str = ""
    notices: tuple[Problem, ...] = ()
    traceback: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What became of one manipulator, cell or variant.

    Attributes:
        name: its name.
        status: ok, failed, or skipped where the run only looked.
        source: the file it comes from.
        drawn: what was drawn for it, by field and joint: ``a_2`` [SI].
        was_read: whether there was a manipulator at all.
        keeps_kinematics: whether its transform keeps T(q).
        written: what each emitter wrote.
        loads: what each simulator said, by the loader's name.
        notices: what a careful person would want to know.
        errors: why it failed.
        traceback: where a stage failed, for ``--debug``.
        seconds: how long each step took [s].
    """

    name: str
    status: Literal["ok", "failed", "skipped"]
    source: str
    drawn: dict[str, Value] = field(default_factory=dict)
    was_read: bool = True
    keeps_kinematics: bool = True
    written: tuple[Written, ...] = ()
    loads: dict[str, LoadReport] = field(default_factory=dict)
    notices: tuple[Problem, ...] = ()
    errors: tuple[Problem, ...] = ()
    traceback: str = ""
    seconds: dict[str, float] = field(default_factory=dict)


def make_plan(config: RunConfig, catalog: Catalog) -> Plan:
    """Resolve every stage and every option of a run file, before anything is read or written.

    Raises:
        ConfigError: something in the run file is wrong; all of it is said at once.
        PluginError: the run needs a plugin that is broken, or a package that is not installed.
    """
    problems: list[Problem] = list(config.problems)

    def resolve(kind: Any, call: StageCall) -> Call[Any] | None:  # noqa: ANN401 - a kind of stage
        try:
            stage = catalog.get(kind, call.stage)
            where = f"{kind} {stage.name!r}"
            return Call(stage=stage, options=make_options(stage.options, call.options, mark=call.mark, where=where))
        except InputError as error:
            problems.extend(problem.about(mark=call.mark) for problem in error.problems)
            return None

    inputs: list[tuple[Path, Reader[Any], Any]] = []
    for given in config.inputs:
        for path in given.paths:
            try:
                name = given.stage or catalog.reader_for(path).name
            except InputError as error:
                problems.extend(problem.about(mark=given.mark) for problem in error.problems)
                continue
            call = resolve("reader", given.read_by(name))
            if call is None:
                break
            inputs.append((path, call.stage, call.options))
    transform = resolve("transform", config.transform)
    emitters = [resolve("emitter", call) for call in config.emitters]
    loaders = [resolve("loader", call) for call in config.loaders]
    executor = resolve("executor", config.execution)
    problems += _without_file(config, loaders)
    if problems or transform is None or executor is None:
        raise ConfigError(in_file_order(problems))
    recipe = Recipe(
        transform=transform,
        emitters=tuple(call for call in emitters if call),
        loaders=tuple(call for call in loaders if call),
        poses=config.poses,
    )
    for loader in recipe.loaders:
        loader.stage.require(loader.options)
    for variation in config.variations:
        sampling.require(variation.sampling)
    return Plan(
        inputs=tuple(inputs),
        recipe=recipe,
        directory=config.directory,
        executor=executor.stage,
        executor_options=executor.options,
        cells=config.cells,
        variations=config.variations,
    )


def _without_file(config: RunConfig, loaders: Sequence[Call[Loader[Any]] | None]) -> Iterator[Problem]:
    """The loaders that take no file which the run writes."""
    formats = [call.stage for call in config.emitters]
    for asked, loader in zip(config.loaders, loaders, strict=True):
        if loader is not None and not set(loader.stage.formats) & set(formats):
            yield Problem(
                message=f"the loader {loader.stage.name!r} has no file to load",
                mark=asked.mark,
                field="loaders",
                found=", ".join(formats),
                accepted=f"one of the emitters {', '.join(loader.stage.formats)} in the section `emitters`",
            )


def execute(plan: Plan, *, dry_run: bool = False, note: Callable[[Outcome], None] | None = None) -> list[Outcome]:
    """Do a run.

    Args:
        plan: what to do.
        dry_run: read, transform and check, but write nothing.
        note: is told of every outcome as it comes, as soon as something could be read.

    Returns:
        One outcome per manipulator, in the order of the inputs, then one per cell, then one per variant.

    Raises:
        TableError: nothing could be read at all.
        PluginError: the run needs a plugin that is broken.
    """
    work = partial(make, plan.recipe, plan.directory, dry_run=dry_run)
    outcomes: list[Outcome] = []
    readable, told = False, 0
    for outcome in plan.executor.map(work, tasks(plan), plan.executor_options):
        outcomes.append(outcome)
        readable = readable or outcome.was_read
        if note and readable:  # Where nothing can be read, the error at the end says why, and nobody says it twice.
            for each in outcomes[told:]:
                note(each)
            told = len(outcomes)
    if not readable:
        raise TableError([problem for outcome in outcomes for problem in outcome.errors])
    return outcomes


def tasks(plan: Plan) -> Iterator[Task]:
    """The manipulators of all inputs, one by one, each with a stem of its own; a bad input ends itself, not the run.

    Cells and variants come last: of the manipulators, only those that they need are kept so long.
    """
    needed = [arm.of for cell in plan.cells for arm in cell.arms] + [call.of for call in plan.variations]
    stems, gathering = Stems(), Gathering(needed)
    index = 0
    for path, reader, options in plan.inputs:
        first = index
        try:
            for item in read_items(reader, path, options):
                gathering.see(item)
                yield _task(index, item, str(path), stems)
                index += 1
            if index == first:
                raise TableError("there is no manipulator in it")
        except (TableError, StageError) as error:
            rejected = Rejected(name=path.stem, problems=error.problems, mark=Mark(file=str(path)))
            gathering.see(rejected)
            traceback = error.traceback if isinstance(error, StageError) else ""
            yield Task(index=index, item=rejected, source=str(path), traceback=traceback)
            index += 1
    for cell in with_tables(plan.cells, gathering):
        yield _task(index, cell, cell.mark.file if cell.mark else "", stems)
        index += 1
    for call in plan.variations:
        for variant in _variants(call, gathering):
            yield _task(index, variant, call.mark.file if call.mark else "", stems)
            index += 1


def _variants(call: VariationCall, gathering: Gathering) -> Iterator[Variant | Rejected]:
    """The variants of a variation, one by one; why not, where there can be none."""
    table = gathering.table(call.of, f"the variation {shown(call.name)}", call.of_mark or call.mark)
    try:
        if not isinstance(table, Manipulator):
            raise ConfigError(table)
        variation = bind(call, table)
    except ConfigError as error:
        yield Rejected(name=call.name, problems=error.problems, mark=call.mark)
        return
    yield from variation.variants()


def _task(index: int, item: Manipulator | Cell | Variant | Rejected, source: str, stems: Stems) -> Task:
    if isinstance(item, Rejected):
        return Task(index=index, item=item, source=source)
    # Variants come last, and no two have the same name: that nothing of them is remembered lets a run be of any length.
    stem, clash = stems.claim(item.name, remember=not isinstance(item, Variant))
    return Task(index=index, item=item, source=source, stem=stem, notices=(clash,) if clash else ())


def make(recipe: Recipe, directory: Path, task: Task, *, dry_run: bool = False) -> Outcome:
    """Everything that is done with one manipulator, in whatever process.

    A manipulator that fails gives an outcome that says why; what is wrong with the run itself (a broken plugin, a full
    disk) is raised.
    """
    item = task.item
    if isinstance(item, Rejected):
        return Outcome(
            name=item.name,
            status="failed",
            source=task.source,
            was_read=False,
            errors=tuple(problem.about(mark=item.mark) for problem in item.problems),
            traceback=task.traceback,
        )
    seconds: dict[str, float] = {}
    outcome = Outcome(
        name=item.name,
        status="skipped" if dry_run else "ok",
        source=task.source,
        drawn=item.drawn() if isinstance(item, Variant) else {},
        keeps_kinematics=recipe.keeps_kinematics,
        notices=(*(item.notices if isinstance(item, Manipulator) else ()), *task.notices),
        seconds=seconds,
    )
    try:
        with _timed(seconds, "transform"):
            robot, truth = _robot(item.manipulator(outcome.drawn) if isinstance(item, Variant) else item, recipe)
        outcome = replace(outcome, notices=(*outcome.notices, *robot.notices))
        if dry_run:
            return outcome
        with _timed(seconds, "write"):
            sampled = task.index < ALL_PROVED or task.index % SAMPLE == 0
            written = write_robot(truth, robot, recipe, directory=directory, stem=task.stem, prove_costly=sampled)
        outcome = replace(outcome, written=written)
        for number, call in enumerate(recipe.loaders):
            with _timed(seconds, f"load {call.stage.name}"):
                picture = f"{task.stem}.png" if number == 0 else f"{task.stem}.{call.stage.name}.png"
                report = _load(truth, robot, call, written, recipe=recipe, directory=directory, picture=picture)
            outcome = replace(outcome, loads={**outcome.loads, call.stage.name: report})
    except OutputError:
        raise
    except (ManipulatorError, InputError) as error:
        return replace(
            outcome,
            status="failed",
            errors=tuple(problem.about(robot=item.name, mark=item.mark) for problem in error.problems),
            traceback=getattr(error, "traceback", ""),
        )
    return outcome


def _robot(item: Manipulator | Cell, recipe: Recipe) -> tuple[Robot, Truth]:
    if isinstance(item, Cell):
        return make_cell(item, recipe.transform)
    return make_robot(item, recipe.transform), Truth.of(item)


def _load(
    truth: Truth,
    robot: Robot,
    call: Call[Loader[Any]],
    written: tuple[Written, ...],
    *,
    recipe: Recipe,
    directory: Path,
    picture: str,
) -> LoadReport:
    """What a simulator says of the file that was written.

    Where the transform does not keep the kinematics, the simulator is held against the robot, not against the tables.
    """
    loader = call.stage
    names = {emitted.stage: emitted.files[0].name for emitted in written}
    path = next(directory / names[wanted] for wanted in loader.formats if wanted in names)
    poses = joint_vectors(truth, robot, loader.poses(call.options))
    expected: dict[str, tuple[tuple[float, ...], ...]] = {}
    for tip in truth.tips:
        chain = KinematicChain.between(robot, truth.root, tip.link)
        expected[tip.link] = tuple(
            _elements(tip.pose(q) if recipe.keeps_kinematics else chain.forward_kinematics(tip.values(q)))
            for q in poses
        )
    request = LoadRequest(
        path=path,
        robot=robot,
        poses=poses,
        expected=expected,
        mark=truth.mark,
        picture=directory / picture if loader.picture(call.options) else None,
    )
    with blaming("loader", loader.name):
        return load_in_child(loader, request, call.options)


def _elements(frame: RigidTransform) -> tuple[float, ...]:
    """A rigid transform as the 16 elements of its homogeneous matrix, row by row."""
    r, t = frame
    return (*r[0:3], t[0], *r[3:6], t[1], *r[6:9], t[2], 0.0, 0.0, 0.0, 1.0)


@contextmanager
def _timed(seconds: dict[str, float], step: str) -> Iterator[None]:
    started = time.perf_counter()
    try:
        yield
    finally:
        seconds[step] = time.perf_counter() - started
