"""What a run has to make, cut into batches for its workers.

The manipulators of all inputs come one by one, cells and variants after them, and each has a number, from 0, and a stem
of its own for its files. Nothing is held but one batch, and the tables that cells and variations are made of.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from dh2urdf.cells.cell import Cell, with_tables
from dh2urdf.cells.wanted_tables import Gathering
from dh2urdf.columns import ManipulatorColumns, in_columns
from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.errors import ConfigError, ManipulatorError, StageError, TableError
from dh2urdf.isolation.garbage import collected_at_the_end
from dh2urdf.manipulator import Manipulator
from dh2urdf.output.whole_files import Stems
from dh2urdf.run_file.mesh_section import MeshGiver
from dh2urdf.source import Mark, Problem, shown
from dh2urdf.stages import Rejected
from dh2urdf.variations.binding import bind
from dh2urdf.variations.variation import Variant, Variation, VariationCall

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.run_file.plan import Plan

SMALL = 16
"""Manipulators of a batch at most, where each takes long."""
LARGE = 500
"""Manipulators of a batch at most: beyond, columns do not pay more, and a worker that dies loses more."""


class Doomed(NamedTuple):
    """A manipulator that cannot be made, since whoever tried did not survive it.

    Attributes:
        name: its name.
        error: what became of the attempt.
        mark: its place in its file.
    """

    name: str
    error: ManipulatorError
    mark: Mark | None


Single: TypeAlias = Manipulator | Cell | Rejected | Doomed


class RunItem(NamedTuple):
    """Something that a run has to make.

    Attributes:
        what: the manipulator, cell or variant, or why it cannot be read.
        source: the file it comes from.
        traceback: where its reader failed.
    """

    what: Manipulator | Cell | Variant | Rejected
    source: str
    traceback: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Batch:
    """Manipulators that stand behind each other in a run, as they travel to a worker.

    Attributes:
        first: number of the first one in the run.
        names: their names.
        stems: the stem of the files of each.
        sources: the file each comes from.
        columns: those that differ in numbers only, with their places in the batch.
        variants: variations whose variants they are, with the place of the first one and the variants' numbers.
        singles: all others, by their places.
        notices: what is known of them before the work begins, by their places.
        of_readers: the notices of their tables, which those in columns are without, by their places.
        tracebacks: where a reader failed, by place.
        rows: what earlier runs tell of manipulators of the same name, by place.
    """

    first: int
    names: tuple[str, ...]
    stems: tuple[str, ...]
    sources: tuple[str, ...]
    columns: tuple[tuple[tuple[int, ...], ManipulatorColumns], ...] = ()
    variants: tuple[tuple[int, Variation, range], ...] = ()
    singles: Mapping[int, Single] = field(default_factory=dict)
    notices: Mapping[int, tuple[Problem, ...]] = field(default_factory=dict)
    of_readers: Mapping[int, tuple[Problem, ...]] = field(default_factory=dict)
    tracebacks: Mapping[int, str] = field(default_factory=dict)
    rows: Mapping[int, tuple[bytes, ...]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.names)

    def single(self, place: int) -> Single:
        """What is to be made at a place."""
        if place in self.singles:
            return self.singles[place]
        for first, variation, numbers in self.variants:
            if first <= place < first + len(numbers):
                variant = Variant(variation=variation, number=numbers[place - first])
                try:
                    return variant.manipulator(variant.drawn())
                except ManipulatorError as error:
                    return Doomed(variant.name, error, variant.mark)
        table = next(some.pick(places.index(place)) for places, some in self.columns if place in places)
        return self.with_notices(place, table)

    def with_notices(self, place: int, table: Manipulator) -> Manipulator:
        """A table of the columns with the notices of its reader."""
        return replace(table, notices=self.of_readers[place]) if place in self.of_readers else table

    def part(self, start: int, stop: int) -> Batch:
        """Those from one place to before another one."""
        wanted = range(start, stop)
        columns = []
        for places, some in self.columns:
            members = [member for member, place in enumerate(places) if place in wanted]
            if members:
                columns.append((tuple([places[member] - start for member in members]), some.take(members)))
        variants = []
        for first, variation, numbers in self.variants:
            inside = numbers[max(0, start - first) : max(0, stop - first)]
            if inside:
                variants.append((max(0, first - start), variation, inside))
        return Batch(
            first=self.first + start,
            names=self.names[start:stop],
            stems=self.stems[start:stop],
            sources=self.sources[start:stop],
            columns=tuple(columns),
            variants=tuple(variants),
            singles={place - start: what for place, what in self.singles.items() if place in wanted},
            notices={place - start: notices for place, notices in self.notices.items() if place in wanted},
            of_readers={place - start: notices for place, notices in self.of_readers.items() if place in wanted},
            tracebacks={place - start: text for place, text in self.tracebacks.items() if place in wanted},
            rows={place - start: rows for place, rows in self.rows.items() if place in wanted},
        )

    def without(self, doomed: Mapping[int, Doomed]) -> Batch:
        """The same batch with reasons why not in some places."""
        return replace(self, singles={**self.singles, **doomed}, rows={})


class Expected:
    """How many manipulators a run will have, as far as can be told while its inputs are being read.

    Attributes:
        total: how many; None as long as there is no saying.
    """

    def __init__(self, plan: Plan) -> None:
        self.total: int | None = None
        self._inputs = max(1, len(plan.inputs))
        self._read = 0
        self._lines: dict[str, int] = {}
        counts = [call.count for call in plan.variations]
        self._besides = None if None in counts else len(plan.cells) + sum(filter(None, counts))

    def see(self, count: int, item: RunItem) -> None:
        """Takes notice of how far the reading has come."""
        if self._besides is None or not isinstance(item.what, Manipulator | Rejected):
            return
        mark = item.what.mark
        lines = self._lines_of(item.source)
        part = mark.line / lines if mark and mark.line and mark.line <= lines else 0.0
        if (fraction := (self._read + part) / self._inputs) > 0.0:
            self.total = round(count / fraction) + self._besides

    def finish_input(self) -> None:
        """One more input is read."""
        self._read += 1

    def finish_inputs(self, count: int) -> None:
        """All inputs are read, with so many manipulators."""
        if self._besides is not None:
            self.total = count + self._besides

    def finish(self, count: int) -> None:
        """Everything has been read."""
        self.total = count

    def _lines_of(self, source: str) -> int:
        """Lines of a file; 0 where it is none of text."""
        if source not in self._lines:
            self._lines = {source: _count_lines(Path(source))}
        return self._lines[source]


def _count_lines(path: Path) -> int:
    try:
        with path.open("rb") as file:
            blocks = iter(partial(file.read, 1 << 20), b"")
            first = next(blocks, b"")
            return 0 if b"\0" in first else first.count(b"\n") + sum(block.count(b"\n") for block in blocks)
    except OSError:
        return 0  # Its reader says why.


def batches(plan: Plan, expected: Expected) -> Iterator[Batch]:
    """All that a run has to make.

    Args:
        plan: the run.
        expected: is told how far the reading has come.
    """
    stems = Stems(plan.layout.stem_of)
    waiting = items(plan, expected)
    first = 0
    for size in plan.layout.batch_sizes(_sizes(plan)):
        with collected_at_the_end():
            some = list(islice(waiting, size))
            batch = _batch(first, some, stems)
        if not some:
            expected.finish(first)
            return
        yield batch
        first += len(some)
        expected.see(first, some[-1])


def _sizes(plan: Plan) -> Iterator[int]:
    """How many manipulators a worker takes at once: few at first, so that a short run keeps every worker busy."""
    recipe, size, made = plan.recipe, 1, 0
    quick = recipe.makes_many_at_once
    loads = bool(recipe.loaders)
    yield size
    while True:
        yield size
        made += size
        if quick and not (loads and (made < recipe.sample.first or recipe.sample.every < SMALL)):
            size = min(2 * size, LARGE)
        else:
            size = min(size + 1, SMALL)


def _batch(first: int, some: Sequence[RunItem], stems: Stems) -> Batch:
    # Of an input that cannot be read there will be no files, and its name may be another manipulator's.
    claimed = iter(stems.claim_all([item.what.name for item in some if not isinstance(item.what, Rejected)]))
    own_stems: list[str] = []
    notices: dict[int, tuple[Problem, ...]] = {}
    singles: dict[int, Single] = {}
    plain: dict[int, Manipulator] = {}
    of_readers: dict[int, tuple[Problem, ...]] = {}
    variants: list[tuple[int, Variation, range]] = []
    for place, (what, _, _) in enumerate(some):
        stem, clash = ("", None) if isinstance(what, Rejected) else next(claimed)
        own_stems.append(stem)
        if clash:
            notices[place] = (clash,)
        match what:
            case Variant(variation=variation, number=number):
                # The variants of a variation come one after the other, by their numbers.
                if variants and variants[-1][1] is variation:
                    start, _, numbers = variants[-1]
                    variants[-1] = (start, variation, range(numbers.start, number + 1))
                else:
                    variants.append((place, variation, range(number, number + 1)))
            case Manipulator(notices=()):
                plain[place] = what
            case Manipulator():  # Tables that differ in numbers only have notices of their own all the same.
                plain[place], of_readers[place] = replace(what, notices=()), what.notices
            case _:
                singles[place] = what
    places = list(plain)
    return Batch(
        first=first,
        names=tuple([item.what.name for item in some]),
        stems=tuple(own_stems),
        sources=tuple([source for _, source, _ in some]),
        columns=tuple(
            [
                (tuple([places[member] for member in members]), columns)
                for members, columns in in_columns(list(plain.values()))
            ]
        ),
        variants=tuple(variants),
        singles=singles,
        notices=notices,
        of_readers=of_readers,
        tracebacks={place: traceback for place, (_, _, traceback) in enumerate(some) if traceback},
    )


def items(plan: Plan, expected: Expected) -> Iterator[RunItem]:
    """The manipulators of all inputs, one by one; a bad input ends itself, not the run.

    Cells and variants come last: of the manipulators, only those that they need are kept so long.
    """
    needed = [arm.of for cell in plan.cells for arm in cell.arms] + [call.of for call in plan.variations]
    gathering = Gathering(needed)
    meshes = MeshGiver(plan.meshes)
    count = 0
    for path, call in plan.inputs:
        source, before = str(path), count
        try:
            for item in map(meshes.give, read_items(call, path)):
                said = plan.input_notices.get(path) if count == before else None
                what = replace(item, notices=(said, *item.notices)) if said else item
                gathering.see(what)
                count += 1
                yield RunItem(what, source)
            if count == before:
                raise TableError("there is no manipulator in it")
        except (TableError, StageError) as error:
            rejected = Rejected(name=path.stem, problems=error.problems, mark=Mark(file=source), notices=error.notices)
            gathering.see(rejected)
            count += 1
            yield RunItem(rejected, source, error.traceback if isinstance(error, StageError) else "")
        expected.finish_input()
    for left in meshes.left_over():
        count += 1
        yield RunItem(left, _file(left.mark))
    expected.finish_inputs(count)
    for cell in with_tables(plan.cells, gathering):
        yield RunItem(cell, _file(cell.mark))
    for variation in plan.variations:
        source = _file(variation.mark)
        for variant in _variants(variation, gathering):
            yield RunItem(variant, source)


def _file(mark: Mark | None) -> str:
    return mark.file if mark else ""


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
