"""The work of a run: what a worker does with a batch of manipulators.

Manipulators that differ in numbers only are made side by side, a hundred times as fast, where every stage can; the
rest, and whatever there is something to say about, is made one by one. The bytes are the same either way.
"""

from __future__ import annotations

import time
from collections import defaultdict
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from enum import Enum
from hashlib import sha256
from itertools import repeat
from typing import TYPE_CHECKING, Any

import orjson

from dh2urdf.cells.cell import Cell
from dh2urdf.conversion.keys import column_keys, key_of, whole
from dh2urdf.conversion.one_manipulator import (
    Recipe,
    Written,
    emit_robot,
    refuse_undeclared_files,
    with_copies,
    with_notices,
)
from dh2urdf.conversion.outcome import Outcome, kind_of, to_line
from dh2urdf.conversion.robots import edited_robots, edited_tables, make_item, new_notices
from dh2urdf.conversion.simulators import load_with_all, not_loaded, time_limit_of
from dh2urdf.errors import InputError, ManipulatorError, OutputError, StageError, TableError
from dh2urdf.fields import many_unchecked
from dh2urdf.isolation.attribution import collected_lines
from dh2urdf.isolation.kept_children import KeptChildren
from dh2urdf.isolation.process import collected_at_the_end, is_own, this_process, watched
from dh2urdf.kinematics.proof import Proof, prove_columns
from dh2urdf.manipulator import Manipulator
from dh2urdf.output.journal import Journal
from dh2urdf.output.layouts import Layout
from dh2urdf.output.store import Store
from dh2urdf.plugin_system.calls import blaming, own_work
from dh2urdf.plugin_system.column_calls import emit_columns, read_columns, transform_columns
from dh2urdf.rotations import DividedError
from dh2urdf.running.earlier_files import EarlierFiles, MeshCopies
from dh2urdf.source import Mark
from dh2urdf.stages import EmitsInColumns, EmittedFile, Emitter, ReadsBack, Rejected
from dh2urdf.tasks.batch import Batch, Doomed, Single, variants_from
from dh2urdf.tasks.batch_report import BatchReport

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.columns import ManipulatorColumns, RobotColumns
    from dh2urdf.conversion.outcome import ManifestRow
    from dh2urdf.output.layouts import Put
    from dh2urdf.plugin_system.calls import Call
    from dh2urdf.results import FileEntry
    from dh2urdf.source import Problem
    from dh2urdf.variations.laws import DrawnValue


class Depth(Enum):
    """How far the work on a batch goes."""

    LOOK = "look"
    """Robots are made and checked."""
    REHEARSE = "rehearse"
    """Files are made and proved, but put nowhere: who does not survive that must not take the others along."""
    MAKE = "make"
    """Files are put in their place, and simulators load them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchWorker:
    """Makes the batches of a run, in whatever process.

    What is wrong with a manipulator fails it alone; what is wrong with the run, such as a full disk, is raised.

    Attributes:
        recipe: what is done with every manipulator.
        key: the key of the recipe.
        store: where everything goes.
        layout: under which names.
        reports: where the files about the run go.
        journal: folder of it for what is done so far.
        home: the process of the run itself, which a manipulator that hangs must not end.
        effect: what is done in earnest.
        places: those of a batch that are rehearsed; None for all.
        children: the children of loaders that are kept, of the process that this is in.
    """

    recipe: Recipe
    key: str
    store: Store
    reports: Store
    layout: Layout
    journal: str
    home: str
    effect: Depth = Depth.MAKE
    places: range | None = None
    children: KeptChildren = field(default_factory=KeptChildren, compare=False, repr=False)

    @property
    def distributions(self) -> tuple[str, ...]:
        """The distributions whose stages are used: see `dh2urdf.stages.Executor`."""
        return tuple(sorted({call.plugin.distribution_name for call in self.recipe.calls if call.plugin}))

    def __call__(self, batch: Batch) -> BatchReport:
        """Make a batch, and put it in its place."""
        is_worker = self.home != this_process()
        # A worker that is no process of ours goes on after the run, and keeps no children.
        kept = self.children if is_worker and not is_own() else nullcontext()
        with kept, own_work(), collected_at_the_end(), collected_lines(is_worker=is_worker) as lines:
            report = Work(self, batch).done()
        return replace(report, printed=tuple(lines))


class Work:
    """A batch on its way: what it has to make, what of it an earlier run has made, and the making."""

    def __init__(self, worker: BatchWorker, batch: Batch) -> None:
        self.worker, self.batch = worker, batch
        self.recipe, self.of_cells = worker.recipe.of("arms"), worker.recipe.of("cells")
        self.seconds: defaultdict[str, float] = defaultdict(float)
        self.singles = dict(batch.singles)
        self.drawn: dict[int, dict[str, DrawnValue]] = {}
        self.marks: dict[int, Mark | None] = {}
        self.groups = list(batch.columns)
        self.faults: dict[int, tuple[Problem, ...]] = {}
        self.earlier = EarlierFiles(worker.store, worker.layout)
        self.copies = MeshCopies(
            worker.store, self.earlier, worker.recipe.mesh_prefix if worker.recipe.copies_meshes else None
        )
        with timed(self.seconds, "draw"):
            for start, variants in batch.variants:
                drawn, places = variants.variation.drawn(variants.numbers), range(start, start + len(variants))
                self.drawn.update(zip(places, drawn, strict=True))
                self.marks.update(dict.fromkeys(places, variants.variation.mark))
                groups, doomed = variants_from(start, variants, drawn)
                self.groups += groups
                self.singles.update(doomed)
        self.members = {
            place: (columns, member) for places, columns in self.groups for member, place in enumerate(places)
        }
        self.keys = self._keys()

    # --- What there is to make

    def _keys(self) -> dict[int, str]:
        """What the files of each depend on: its table, the recipe, and where they go."""
        keys: dict[int, str] = {}
        for places, columns in self.groups:
            contexts = [self._context(place) for place in places]
            keys.update(zip(places, column_keys(columns, self.worker.key, contexts), strict=True))
        for place, what in self.singles.items():
            keys[place] = key_of((whole(what), self._context(place)), self.worker.key)
        return keys

    def _context(self, place: int) -> tuple[Any, ...]:
        index, recipe = self.batch.first + place, self.recipe
        where = self.worker.layout.folder(index)
        return (
            where,
            self.batch.stems[place],
            self.batch.sources[place],
            index in recipe.proved,
            index in recipe.sample,
            self.batch.notices.get(place),
            self.batch.of_readers.get(place),
        )

    def key(self, place: int, *, noticed: bool, mark: Mark | None) -> str:
        """The key of a row; where it names a file's lines, they count too."""
        return key_of(str(mark), self.keys[place]) if noticed else self.keys[place]

    # --- What an earlier run has made

    def kept(self) -> dict[int, tuple[ManifestRow, bytes]]:
        """The rows of manipulators that are finished, unchanged and whole, with their lines."""
        kept: dict[int, tuple[ManifestRow, bytes]] = {}
        for place, lines in self.batch.rows.items():
            for row, line in zip(map(orjson.loads, lines), lines, strict=True):
                if self._is_kept(place, row):
                    kept[place] = row, line
                    break
        return kept

    def _is_kept(self, place: int, row: ManifestRow) -> bool:
        try:
            key = self.key(place, noticed=bool(row["notices"]), mark=self.mark(place))
            missing = {name for name, load in row["loaders"].items() if load["verdict"] == "missing"}
            is_same = row["status"] == "ok" and row["key"] == key and missing <= self.recipe.missing.keys()
            return bool(is_same and self.earlier.has(self.batch.first + place, row))
        except (KeyError, TypeError):
            return False  # It is the manifest of something else.

    def mark(self, place: int) -> Mark | None:
        """The place of a manipulator in its file."""
        if place in self.marks:
            return self.marks[place]
        if place in self.singles:
            return self.singles[place].mark
        columns, member = self.members[place]
        return columns.marks[member]

    def what(self, place: int) -> Single:
        """What is to be made at a place."""
        if place in self.singles:
            return self.singles[place]
        columns, member = self.members[place]
        return self.batch.with_notices(place, columns.pick(member))

    # --- Making

    def done(self) -> BatchReport:
        """Make everything, and tell what became of it."""
        kept = self.kept()
        report = BatchReport(first=self.batch.first, seconds=self.seconds)
        parts = [self.worker.places] if self.worker.places else self.worker.layout.parts(len(self.batch))
        ready = self._side_by_side({place for places in parts for place in places if place not in kept})
        lines = [line for places in parts for line in self._part(places, kept, ready, report)]
        return replace(report, rows=b"".join(lines))

    def _part(
        self, places: range, kept: dict[int, tuple[ManifestRow, bytes]], ready: dict[int, Outcome], report: BatchReport
    ) -> list[bytes]:
        """Put the files of a shard in their place, or of all where there are none; the lines of the manifest."""
        makes, is_whole = self.worker.effect is Depth.MAKE, self.worker.layout.is_whole
        first = self.batch.first + places.start
        journal = Journal(self.worker.reports, f"{self.worker.journal}/{first:09d}.jsonl")
        old = [kept[place][0] for place in places if place in kept]
        changes = len(old) < len(places) or (is_whole and not self.earlier.are_all(first, old))
        made: list[bytes] = []
        with self.worker.layout.place(self.worker.store, first) if changes and makes else nullcontext() as target:
            for place in places:
                alone = place not in kept and place not in ready
                if place in kept:
                    report.statuses["kept"] += 1
                    row, line = kept[place]
                    if target is not None and is_whole:
                        line = to_line(self.earlier.moved(self.batch.first + place, row, target))
                else:
                    outcome = self._one(place) if alone else ready.pop(place)
                    if self.recipe.loaders and makes:
                        sampled = self.batch.first + place in self.recipe.sample
                        outcome = replace(outcome, not_loaded=not_loaded(self.recipe, outcome, is_sampled=sampled))
                    line = to_line(outcome.row(*self._put(place, outcome, target)))
                    report.note(outcome)
                made.append(line)
                if makes and not is_whole:
                    journal.add(line, now=alone)
        if makes:
            for line in made if is_whole else ():
                journal.add(line)
            journal.close()
        return made

    def _put(self, place: int, outcome: Outcome, put: Put | None) -> tuple[str, list[FileEntry]]:
        """Put the files of a manipulator in their place; its key and where they are."""
        facts: list[FileEntry] = []
        index = self.batch.first + place
        started = time.perf_counter()
        if put is not None:
            self.copies.put(outcome.meshes)
            for written in outcome.written:
                for file in written.files:
                    where = put(index, file.name, file.content)
                    digest = sha256(file.content).hexdigest()
                    facts.append({**where, "stage": written.stage, "bytes": len(file.content), "sha256": digest})
            for name, picture in outcome.pictures.items():
                put(index, name, picture)
        self.seconds["write"] += time.perf_counter() - started
        told = bool(outcome.notices or outcome.errors)
        return self.key(place, noticed=told, mark=self.mark(place) if told else None), facts

    # --- Many at once

    def _side_by_side(self, missing: set[int]) -> dict[int, Outcome]:
        """The outcomes of those that can be made so."""
        recipe = self.recipe
        if self.worker.effect is Depth.LOOK or not recipe.makes_many_at_once:
            return {}
        ready: dict[int, Outcome] = {}
        # Of the others there is more to do than to write files and to prove them.
        plain = missing - self.batch.notices.keys() - self.singles.keys()
        if recipe.loaders:
            plain = {place for place in plain if self.batch.first + place not in recipe.sample}
        for places, columns in self.groups:
            wanted = [member for member, place in enumerate(places) if place in plain]
            if wanted:
                some = columns if len(wanted) == len(places) else columns.take(wanted)
                with watched(self.worker.home, self.recipe.time_limit):
                    ready.update(self._group([places[member] for member in wanted], some))
        return ready

    def _group(self, places: list[int], columns: ManipulatorColumns) -> dict[int, Outcome]:
        """The outcomes of manipulators that differ in numbers only; what fails here is made one by one, to say why.

        A stage that fails at many and not at one is at fault all the same, and a notice of each reports it.
        """
        outcomes: dict[int, Outcome] = {}
        try:
            with timed(self.seconds, "transform"):
                edited = edited_tables(columns, self.recipe.transform, self.recipe.edits)
                groups = transform_columns(self.recipe.transform, edited)
            for members, made in groups:
                own = [places[member] for member in members]
                try:
                    with timed(self.seconds, "transform"):
                        robots = edited_robots(made, self.recipe.edits, new_notices(edited.table, columns.table))
                except DividedError as divided:
                    outcomes.update(self._halves(own, columns.take(members), divided))
                    continue
                robots = replace(robots, robot=with_copies(robots.robot, self.recipe))
                some = edited if len(members) == len(edited) else edited.take(members)
                outcomes.update(self._alike(own, some, robots))
        except DividedError as divided:
            return self._halves(places, columns, divided)
        except StageError as error:
            (problem,) = error.problems
            notice = replace(problem, severity="notice", message=f"{problem.message}; it was made by itself")
            self.faults.update(dict.fromkeys(places, (notice,)))
            return {}
        except ManipulatorError:
            return {}
        return outcomes

    def _halves(self, places: list[int], columns: ManipulatorColumns, divided: DividedError) -> dict[int, Outcome]:
        """The outcomes of manipulators of which an edit makes different things, each kind by itself."""
        outcomes: dict[int, Outcome] = {}
        for wanted in (True, False):
            members = [member for member, goes in enumerate(divided.condition) if bool(goes) is wanted]
            if 0 < len(members) < len(places):
                outcomes.update(self._group([places[member] for member in members], columns.take(members)))
        return outcomes

    def _alike(self, places: list[int], columns: ManipulatorColumns, robots: RobotColumns) -> dict[int, Outcome]:
        """The outcomes of robots that differ in numbers only."""
        stems = [self.batch.stems[place] for place in places]
        made: list[list[Written]] = [[] for _ in places]
        for call in self.recipe.emitters:
            with timed(self.seconds, "emit"):
                files = emit_columns(call, robots, stems)
            if files is None:
                return {}
            refuse_undeclared_files(call, stems, files)
            for member, proof in self._proofs(places, columns, robots, files, call).items():
                made[member].append(Written(stage=call.stage.name, files=files[member], proof=proof))
        meshes = self.copies.of(robots.robot)
        notices = with_notices(robots.pick(0), self.recipe.emitters).notices
        whole = [member for member, own in enumerate(made) if len(own) == len(self.recipe.emitters)]
        done = [places[member] for member in whole]
        names = [columns.names[member] for member in whole]
        of_readers, drawn = self.batch.of_readers, self.drawn
        keeps, tools = self.recipe.keeps_kinematics, robots.robot.tips
        alike = Outcome(name="", status="ok", source="", keeps_kinematics=keeps, meshes=meshes, tools=tools)
        told = [many_unchecked(notice, len(whole), robot=names) for notice in notices]
        own_notices = zip(*told, strict=True) if told else repeat(())
        outcomes = many_unchecked(
            alike,
            len(whole),
            name=names,
            source=[self.batch.sources[place] for place in done],
            drawn=[drawn.get(place, {}) for place in done],
            notices=[(*of_readers.get(place, ()), *own) for place, own in zip(done, own_notices, strict=False)],
            written=[tuple(made[member]) for member in whole],
        )
        return dict(zip(done, outcomes, strict=True))

    def _proofs(
        self,
        places: Sequence[int],
        columns: ManipulatorColumns,
        robots: RobotColumns,
        files: Sequence[Sequence[EmittedFile]],
        call: Call[Emitter[Any]],
    ) -> dict[int, Proof | None]:
        """How far the main file of each is from its table, for those that pass; None for those that nobody asks."""
        recipe, emitter = self.recipe, call.stage
        sure = [member for member, own in enumerate(files) if own]
        asked = {member for member in sure if self.batch.first + places[member] in recipe.proved}
        if emitter.can(ReadsBack) is None or not asked:
            return dict.fromkeys(sure)
        emits = emitter.can(EmitsInColumns)
        if emits is None or emits.read_columns is None:
            return dict.fromkeys([member for member in sure if member not in asked])
        with timed(self.seconds, "prove"), blaming(call):
            described = read_columns(call, [own[0].content if own else b"" for own in files])
            proofs = prove_columns(columns, robots, described, recipe.poses)
        passed: dict[int, Proof | None] = {}
        for member in sure:
            proof = proofs[member]
            if member not in asked:
                passed[member] = None
            elif isinstance(proof, Proof) and (proof.holds or not recipe.keeps_kinematics):
                passed[member] = proof
        return passed

    # --- One by one

    def _one(self, place: int) -> Outcome:
        """What becomes of one manipulator, in whatever way it fails."""
        what, batch = self.what(place), self.batch
        recipe = self.of_cells if isinstance(what, Cell) else self.recipe
        index = batch.first + place
        seconds: dict[str, float] = defaultdict(float)
        # What its table was read with is reported with the nominal manipulator, not with each of its variants.
        own = what.notices if isinstance(what, Manipulator | Rejected) and place not in self.drawn else ()
        outcome = Outcome(
            name=what.name,
            status="planned" if self.worker.effect is Depth.LOOK else "ok",
            source=batch.sources[place],
            drawn=self.drawn.get(place, {}),
            keeps_kinematics=recipe.keeps_kinematics,
            notices=(*own, *batch.notices.get(place, ()), *self.faults.get(place, ())),
            seconds=seconds,
        )
        try:
            if isinstance(what, Rejected):
                raise TableError(what.problems)
            if isinstance(what, Doomed):
                raise what.error
            is_loaded = self.worker.effect is Depth.MAKE and index in recipe.sample
            loaders = recipe.loaders if is_loaded else ()
            with watched(self.worker.home, time_limit_of(recipe, loaders)):
                with timed(seconds, "transform"):
                    robot, expected = make_item(what, recipe.transform, recipe.edits)
                    robot = with_notices(with_copies(robot, recipe), recipe.emitters)
                outcome = replace(outcome, notices=(*outcome.notices, *robot.notices), tools=robot.tips)
                if self.worker.effect is Depth.LOOK:
                    return outcome
                with self.copies.workplace(robot, loads=bool(loaders)) as folder:
                    with timed(seconds, "emit"):
                        written = emit_robot(
                            expected,
                            robot,
                            recipe,
                            folder=folder,
                            stem=batch.stems[place],
                            place=f"{self.worker.store}/{self.worker.layout.path(index, '')}".rstrip("/"),
                            proved=index in recipe.proved,
                            sampled=index in recipe.sample,
                            alone=index == 0,
                            at_once=True,
                        )
                    for call, made in zip(recipe.emitters, written, strict=True):
                        refuse_undeclared_files(call, [batch.stems[place]], [made.files])
                    outcome = replace(outcome, written=written, meshes=self.copies.of(robot))
                    if loaders:
                        stem, kept = batch.stems[place], self.worker.children
                        loads, pictures, failures = load_with_all(
                            expected, robot, recipe, written, folder, stem, seconds, kept
                        )
                        outcome = replace(outcome, loads=loads, pictures=pictures)
                        if failures:
                            outcome = self._failed(outcome, place, failures)
        except OutputError:
            raise
        except (ManipulatorError, InputError) as error:
            outcome = self._failed(outcome, place, (error,))
        finally:
            for step, time_taken in seconds.items():
                self.seconds[step] += time_taken
        return outcome

    def _failed(self, outcome: Outcome, place: int, errors: Sequence[ManipulatorError | InputError]) -> Outcome:
        """The outcome of a manipulator that failed, of the kind of the first error."""
        what = self.what(place)
        was_read = not isinstance(what, Rejected)
        # Who rejected it has said whom each problem is about: it may be a file, or a section of the run file.
        name = what.name if was_read else None
        mark = self.mark(place) or (Mark(file=outcome.source) if outcome.source else None)
        problems = [problem.about(robot=name, mark=mark) for error in errors for problem in error.problems]
        if place in self.drawn:  # Its table has no such notice, and many variants have the same joints.
            problems = [replace(problem, message=f"{what.name}: {problem.message}") for problem in problems]
        tracebacks = [text for error in errors if (text := getattr(error, "traceback", ""))]
        return replace(
            outcome,
            status="failed",
            kind=kind_of(errors[0]),
            was_read=was_read,
            errors=tuple(problems),
            traceback=tracebacks[0] if tracebacks else self.batch.tracebacks.get(place, ""),
        )


@contextmanager
def timed(seconds: dict[str, float], step: str) -> Iterator[None]:
    """Add the time that a step takes [s]."""
    started = time.perf_counter()
    try:
        yield
    finally:
        seconds[step] += time.perf_counter() - started
