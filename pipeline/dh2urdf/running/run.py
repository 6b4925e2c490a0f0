"""A whole run: what is read, made, loaded, reported and cleared away, in which order."""

from __future__ import annotations

import os
import re
import sys
import tempfile
import time
from collections import deque
from contextlib import closing, nullcontext, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.errors import ConfigError, CrashError, ManipulatorError, TableError
from dh2urdf.isolation.attribution import unmarked
from dh2urdf.isolation.child_process import run_in_child
from dh2urdf.isolation.encodings import PICKLED
from dh2urdf.isolation.process import this_process
from dh2urdf.output.journal import JOURNAL, MANIFEST, Earlier, clear_leftovers, earlier_rows, next_journal
from dh2urdf.output.layouts import Form
from dh2urdf.output.store import WORKING, LocalStore, Store
from dh2urdf.output.whole_files import reporting_the_disk
from dh2urdf.plugin_system.calls import Call, a_record, depending_on, fault, items_of, own_work
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.plugin_system.pools import results_of
from dh2urdf.report.manifest import (
    FULL,
    INDEX,
    PAGE,
    REPORT,
    TABLE,
    TIMING,
    ManifestWriter,
    can_write_html,
    command_line,
    reproduction,
    run_report,
    write_reports,
    write_timing,
)
from dh2urdf.report.verdicts import Verdicts
from dh2urdf.run_file.config import load_config, refuse_table
from dh2urdf.run_file.plan import Plan, make_plan
from dh2urdf.running.batch_work import BatchWorker, Depth
from dh2urdf.source import Messages, printable
from dh2urdf.stages import Executor, Lost
from dh2urdf.tasks.batch import Batch, Doomed, Expected, batches
from dh2urdf.tasks.batch_report import BatchReport, Result

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator, Sequence

    from dh2urdf.documents.document import Node
    from dh2urdf.output.store import Store
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.results import RunReport
    from dh2urdf.run_file.plan import Plan
    from dh2urdf.source import Mark

say = Messages(__file__)

KEPT = 100
"""Batches at the start of a run, of which nothing can be read, that keep their rows: all their problems are printed."""
Note: TypeAlias = "Callable[[BatchReport, int | None], None]"
"""Gets each batch, and how many manipulators the run will probably have."""


def load_plan(
    path: Path,
    catalog: Catalog,
    overrides: Sequence[str] = (),
    output: str | None = None,
    root: Node | None = None,
    *,
    mark: Mark = COMMAND_LINE,
) -> Plan:
    """The plan of a run file.

    Args:
        path: the run file.
        catalog: the stages that there are.
        overrides: changes as ``--set`` takes them: ``transform.options.frames=dh``.
        output: where the output goes, if not where the run file says: a folder or an address.
        root: what the run file says, where it is not in the file.
        mark: where the changes are given.

    Raises:
        ConfigError: something in the run file is wrong; all problems are reported at once.
        OutputError: nothing can be written there.
        PluginError: the run needs a plugin that is broken, or a package that is not installed.
    """
    try:
        config = load_config(path, overrides, root, mark)
    except ConfigError:
        if root is None:
            refuse_table(path, catalog)
        raise
    plan = make_plan(config if output is None else config.written_to(output), catalog)
    if root is None:
        plan = replace(plan, files=(path,), command=command_line(path, overrides))
    return plan


def execute(
    plan: Plan, *, resume: bool = False, dry_run: bool = False, keep: bool = False, note: Note | None = None
) -> tuple[Result, RunReport]:
    """Do a run.

    Args:
        plan: what to do.
        resume: keep what earlier runs into the same place have finished, where it is whole and nothing of it changed.
        dry_run: read, transform and check, but write nothing.
        keep: leave the files of the last run into the same place that this one has no part in.
        note: gets every batch as it comes, as soon as something could be read, and how many manipulators the run
            will probably have.

    Returns:
        What became of it, and its report as plain data. The rows of all manipulators, in the order of the inputs, then
        of the cells, then of the variants, are in the manifest.

    Raises:
        ConfigError: the run would write over one of its inputs, or a dry run is to resume.
        TableError: nothing could be read at all.
        OutputError: nothing can be written any more; what is done so far is kept for a run that resumes.
        PluginError: the run needs a plugin that is broken.
    """
    started = time.perf_counter()
    if resume and dry_run:
        raise ConfigError(say("dry-run-resumes", field="resume"))
    refuse_overwriting(plan)
    files = (*plan.files, *(path for path, _ in plan.inputs))
    told = reproduction(plan.command, files, plan.recipe, plan.variations)
    result = Result(keeps_kinematics=plan.recipe.keeps_kinematics)
    if dry_run:
        with reporting_the_disk(tempfile.gettempdir()), tempfile.TemporaryFile(prefix="dh2urdf-") as rows:
            manifest = ManifestWriter(rows, tempfile.gettempdir(), told)
            _make(plan, Depth.LOOK, "", None, manifest, result, note)
            report = run_report(manifest, result)
        result.seconds["total"] = time.perf_counter() - started
        return result, report
    store, reports = plan.store, plan.report_store
    with (
        reporting_the_disk(str(store)),
        store.lock(),
        nullcontext() if reports is store else reports.lock(),
        earlier_rows(reports) if resume else nullcontext() as earlier,
        reports.scratch() as folder,
    ):
        if not resume:  # What earlier runs have done is forgotten.
            reports.remove_tree(JOURNAL)
        journal = next_journal(reports)
        path = folder / "manifest"
        with path.open("w+b") as rows:
            manifest = ManifestWriter(rows, f"{reports}/{MANIFEST}", told, Verdicts.of(plan.recipe))
            try:
                _make(plan, Depth.MAKE, journal, earlier, manifest, result, note)
            except TableError:  # There is nothing to go on with.
                reports.remove_tree(journal if resume else JOURNAL)
                raise
            overview = None
            if plan.html and can_write_html():
                from dh2urdf.report.html import page
                from dh2urdf.report.overview import Overview

                overview = Overview(FULL)
            report = write_reports(reports, manifest, result, folder / TABLE, overview)
            if overview:
                reports.write(PAGE, page(manifest, overview, plan))
            else:
                reports.remove(PAGE)  # An older one would describe another run.
            # While the old manifest is there, as what is removed is known from it alone.
            kept_meshes = plan.recipe.mesh_prefix is None
            result.leftovers = clear_leftovers(store, reports, rows, keep=keep, keep_meshes=kept_meshes)
            result.seconds["total"] = time.perf_counter() - started
            write_timing(reports, result)
        reports.put(MANIFEST, path)
        reports.remove_tree(JOURNAL)
    return result, report


def _make(  # noqa: PLR0917 - what a run has in its hands
    plan: Plan,
    effect: Depth,
    journal: str,
    earlier: Earlier | None,
    manifest: ManifestWriter,
    result: Result,
    note: Note | None,
) -> None:
    """Make all manipulators, and write the rows of the manifest."""
    worker = BatchWorker(
        recipe=plan.recipe,
        key=plan.key,
        store=plan.store,
        reports=plan.report_store,
        layout=plan.layout,
        journal=journal,
        home=this_process(),
        effect=effect,
    )
    under_way: deque[Batch] = deque()
    expected = Expected(plan)

    def handed_over() -> Iterator[Batch]:
        with own_work():
            for batch in batches(plan, expected, OWN_FILES):
                known = replace(batch, rows=earlier.of(batch.names)) if earlier else batch
                under_way.append(known)
                manifest.see(batch)
                yield known

    unread: list[BatchReport] = []  # Where nothing can be read, the error at the end names the reason, once.
    readable = False
    # An error or an interrupt here ends the workers and the children of loaders, not some time later.
    with worker.children, closing(_answers(plan, worker, handed_over(), under_way)) as answers:
        for batch, answer in answers:
            report = _rescued(worker, batch, answer) if isinstance(answer, Lost) else answer
            for line in report.printed:
                print(printable(line), file=sys.stderr)  # noqa: T201 - where plugins expect their words to go
            manifest.add(report)
            result.add(report)
            readable = readable or report.was_read
            unread.append(report if readable or len(unread) < KEPT else replace(report, rows=b""))
            if readable:
                for each in unread:
                    if note:
                        note(each, expected.total)
                unread.clear()
    if not readable:
        found = [problem for report in unread for problem in report.problems]
        errors, notices = ([problem for problem in found if problem.severity == kind] for kind in ("error", "notice"))
        raise TableError(errors, notices)


def _answers(
    plan: Plan, worker: BatchWorker, some: Iterator[Batch], under_way: deque[Batch]
) -> Generator[tuple[Batch, BatchReport | Lost], None, None]:
    """Every batch with what the executor has of it.

    Results are in the order of the batches. A result that is none, or of another batch, fails the manipulators of the
    batch; so does a result that is missing.

    Args:
        plan: the run.
        worker: makes a batch.
        some: the batches; taking one adds it to those under way.
        under_way: the batches without a result.

    Raises:
        BrokenPluginError: the executor failed, and not because of a batch.
    """
    call = plan.executor
    with depending_on(call):
        results = items_of(results_of(call.stage, worker, some, call.options), "an iterator of results")
    end = object()
    try:
        while True:
            with depending_on(call):  # What is done with a result is not the executor's work.
                result = next(results, end)
            if result is end or not under_way:  # Results of nothing may never end.
                break
            batch = under_way.popleft()
            first = result.first if isinstance(result, BatchReport) else batch.first
            while first in {each.first for each in under_way}:  # Results are missing before this one.
                yield batch, _undone(worker, batch, call)
                batch = under_way.popleft()
            if first == batch.first and isinstance(result, BatchReport | Lost):
                yield batch, result
            else:
                yield batch, _undone(worker, batch, call, result)
    finally:  # An interrupt holds this frame and all in it; the workers must be gone before the folder is unlocked.
        if close := getattr(results, "close", None):
            with depending_on(call):
                close()
    for _ in some:
        pass  # An executor that ended too early has not taken them: each is under way now.
    while under_way:
        yield under_way[0], _undone(worker, under_way.popleft(), call)


def _undone(worker: BatchWorker, batch: Batch, call: Call[Executor[Any]], result: object = None) -> BatchReport:
    """What becomes of a batch of which the executor has another result, or none: its manipulators fail."""
    try:
        if result is not None:
            a_record(result, BatchReport, Lost)
        raise ValueError("it gave no result of the batch that this manipulator is in")
    except (TypeError, ValueError) as error:
        doomed = {place: Doomed(name, fault(call, error), None) for place, name in enumerate(batch.names)}
    return worker(batch.without(doomed))


# --- Batches that their workers do not survive -----------------------------------------------------------------------


def _rescued(worker: BatchWorker, batch: Batch, lost: Lost) -> BatchReport:
    """Make all of a batch that no worker survives, but the manipulators that are the reason."""
    doomed = dict(_culprits(worker, batch, range(len(batch))))
    try:
        made = run_in_child(BatchWorker.__call__, worker, batch.without(doomed), timeout=None, encoding=PICKLED)
        return replace(made.value, printed=(*made.value.printed, *unmarked(made.output)))
    except ManipulatorError:
        error = CrashError(say("batch-unmakeable", count=len(batch), reason=lost.reason))
        return worker(batch.without({place: Doomed(name, error, None) for place, name in enumerate(batch.names)}))


def _culprits(worker: BatchWorker, batch: Batch, places: range) -> Iterator[tuple[int, Doomed]]:
    """Yield the manipulators of a batch that end the process which tries to make them, found by halving."""
    alone = len(places) == 1
    limit = worker.recipe.time_limit if alone else None
    # A single one is ended from outside, in time; of several the first that takes too long ends the process itself.
    patience = replace(worker.recipe, time_limit=2 * worker.recipe.time_limit) if alone else worker.recipe
    rehearsal = replace(worker, effect=Depth.REHEARSE, recipe=patience, places=places)
    try:
        run_in_child(BatchWorker.__call__, rehearsal, batch, timeout=limit, who="a stage", encoding=PICKLED)
    except ManipulatorError as error:
        if alone:
            yield places.start, Doomed(batch.names[places.start], error, None)
            return
        middle = len(places) // 2
        yield from _culprits(worker, batch, places[:middle])
        yield from _culprits(worker, batch, places[middle:])


# --- Inputs, which a run does not write over ------------------------------------------------------------------------

OWN_FILES = (MANIFEST, TABLE, INDEX, REPORT, TIMING, PAGE)
"""The files of a run beside those of its manipulators."""
_SHARD = re.compile(r"[0-9]{6}\.tar")


def refuse_overwriting(plan: Plan) -> None:
    """Refuses a run that would write over one of its inputs, and protects the others from it.

    Which files a run writes is known before it begins by their names: its own, and those with the endings that its
    emitters declare. The rest, such as the files of a ROS package, the store refuses when it comes.

    Raises:
        ConfigError: a file that the run writes is one that it reads; it names all of them.
    """
    emitters = [call.stage for call in plan.recipe.emitters]
    suffixes = tuple(ending for each in emitters for ending in each.endings)
    pictures = (".png",) if plan.recipe.loaders else ()
    _refuse_overwriting(plan, plan.store, (*suffixes, *pictures), "output.directory")
    if plan.reports is not None:
        _refuse_overwriting(plan, plan.reports, (), "report.directory")


def _refuse_overwriting(plan: Plan, store: Store, suffixes: tuple[str, ...], field: str) -> None:
    if not isinstance(store, LocalStore):
        return
    problems, names = [], set()
    for path in dict.fromkeys(_inputs(plan)):
        own = set(_names_in(store, path))
        names |= own
        if any(
            name.endswith(suffixes)
            or name.startswith(f"{WORKING}/")
            or name in OWN_FILES
            or (plan.layout.form is Form.SHARDS and _SHARD.fullmatch(name))
            for name in own
        ):
            problems.append(say("run-overwrites-input", field=field, found=str(path), path=path, store=str(store)))
    if problems:
        raise ConfigError(problems)
    store.protect(names)


def _inputs(plan: Plan) -> Iterator[Path]:
    """Every file that a run reads, as far as it is known before its tables are read."""
    yield from plan.files
    for path, reader in plan.inputs:
        yield path
        yield from reader.files
    for stage in plan.recipe.calls:
        yield from stage.files
    for call in plan.meshes:
        for shapes in (call.base, *(shapes for _, shapes in call.joints)):
            for shape in (shapes.visual, shapes.collision):
                if shape is not None:
                    yield Path(shape.file.path)


def _names_in(store: LocalStore, path: Path) -> Iterator[str]:
    """Yield the names of a file in the folder of a store, in lower case: by its own path, and by links."""
    root = os.path.realpath(store.directory)
    by_folder = os.path.join(os.path.realpath(path.parent), path.name)  # noqa: PTH118
    for place in dict.fromkeys((by_folder, os.path.realpath(path))):
        name = os.path.relpath(place, root)
        if name != ".." and not name.startswith("../"):
            yield name.casefold()
    for own in OWN_FILES:
        with suppress(OSError, ValueError):
            if os.path.samefile(path, os.path.join(root, own)):  # noqa: PTH118, PTH121
                yield own
