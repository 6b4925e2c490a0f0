"""What a run has to make, cut into batches for its workers.

The manipulators of all inputs come one by one, cells and variants after them, and each has a number, from 0, and a stem
of its own for its files. Nothing is held but one batch, and the tables that cells and variations are made of.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from dh2urdf.cells.cell import Cell, WantedTables
from dh2urdf.cells.numbered_cells import NumberedCells, made_cells, with_tables
from dh2urdf.columns import ManipulatorColumns, ManipulatorGroups, in_columns
from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.conversion.simulators import picture_endings
from dh2urdf.errors import ConfigError, ManipulatorError, StageError, TableError
from dh2urdf.fields import replace_unchecked
from dh2urdf.isolation.process import collected_at_the_end
from dh2urdf.manipulator import Manipulator
from dh2urdf.output.layouts import Form
from dh2urdf.output.whole_files import Stems
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf.stages import Rejected
from dh2urdf.tasks.given_meshes import MeshGiver
from dh2urdf.variations.binding import bind
from dh2urdf.variations.variation import Variants, Variation, VariationCall, made_variants

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.run_file.plan import Plan
    from dh2urdf.variations.laws import DrawnValue

say = Messages(__file__)


class Doomed(NamedTuple):
    """A manipulator that cannot be made, since each worker that tried died.

    Attributes:
        name: its name.
        error: what became of the attempt.
        mark: its place in its file.
    """

    name: str
    error: ManipulatorError
    mark: Mark | None


class RunItem(NamedTuple):
    """Something that a run has to make: one manipulator, or several that follow each other.

    Attributes:
        what: a manipulator or cell, or why it cannot be read; manipulators in columns; variants or cells that are not
            made yet.
        source: the file it comes from.
        traceback: where its reader failed.
    """

    what: Manipulator | Cell | Rejected | ManipulatorGroups | Variants[Any]
    source: str
    traceback: str = ""

    @property
    def size(self) -> int:
        """How many manipulators it is."""
        return len(self.what) if isinstance(self.what, ManipulatorGroups | Variants) else 1

    @property
    def names(self) -> Sequence[str]:
        """Their names."""
        return self.what.names if isinstance(self.what, ManipulatorGroups | Variants) else (self.what.name,)

    @property
    def each(self) -> Iterable[Manipulator | Cell | Rejected]:
        """All of them, one by one."""
        return self.what.tables() if isinstance(self.what, ManipulatorGroups | Variants) else (self.what,)

    @property
    def is_slow(self) -> bool:
        """Whether it is made one by one, though it is many."""
        return isinstance(self.what, Variants) and isinstance(self.what.variation, NumberedCells)


Single: TypeAlias = Manipulator | Cell | Rejected | Doomed
TablesAtPlaces: TypeAlias = tuple[tuple[int, ...], ManipulatorColumns]
"""Tables that differ in numbers only, with their places in a batch."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Batch:
    """Consecutive manipulators of a run, as they travel to a worker.

    Attributes:
        first: number of the first one in the run.
        names: their names.
        stems: the stem of the files of each.
        sources: the file each comes from.
        columns: those that differ in numbers only, with their places in the batch.
        variants: variants of variations, and numbered cells, with the place of the first one.
        singles: all others, by their places.
        notices: what is known of them before the work begins, by their places.
        of_readers: the notices of their tables, which those in columns are without, by their places.
        tracebacks: where a reader failed, by place.
        rows: what earlier runs recorded of manipulators of the same name, by place.
    """

    first: int
    names: tuple[str, ...]
    stems: tuple[str, ...]
    sources: tuple[str, ...]
    columns: tuple[TablesAtPlaces, ...] = ()
    variants: tuple[tuple[int, Variants[Any]], ...] = ()
    singles: Mapping[int, Single] = field(default_factory=dict)
    notices: Mapping[int, tuple[Problem, ...]] = field(default_factory=dict)
    of_readers: Mapping[int, tuple[Problem, ...]] = field(default_factory=dict)
    tracebacks: Mapping[int, str] = field(default_factory=dict)
    rows: Mapping[int, tuple[bytes, ...]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.names)

    @property
    def joints(self) -> int:
        """How many joints all those have that can be made at once."""
        tables = [(len(places), some.table) for places, some in self.columns]
        own = [(len(variants), variants.variation) for _, variants in self.variants]
        tables += [(count, variation.nominal) for count, variation in own if isinstance(variation, Variation)]
        return sum(count * len(table.rows) for count, table in tables)

    def begin(self, count: int) -> list[Single]:
        """What is to be made at so many places from the first one on."""
        groups, found = self.first_groups(count)
        for places, some in groups:
            for place, table in zip(places, some.tables(), strict=True):
                found[place] = self.with_notices(place, table)
        return [found[place] for place in range(min(count, len(self)))]

    def first_groups(self, count: int) -> tuple[list[TablesAtPlaces], dict[int, Single]]:
        """The same as groups of tables that differ in numbers only, and the others by their places."""
        groups: list[TablesAtPlaces] = []
        singles = {place: what for place, what in self.singles.items() if place < count}
        for first, variants in self.variants:
            wanted = variants.part(0, max(0, count - first))
            made, doomed = variants_from(first, wanted, wanted.variation.drawn(wanted.numbers))
            groups += made
            singles.update(doomed)
        for places, some in self.columns:
            members = [member for member, place in enumerate(places) if place < count]
            if members:
                groups.append((tuple([places[member] for member in members]), some.take(members)))
        return groups, singles

    def with_notices(self, place: int, table: Manipulator) -> Manipulator:
        """A table of the columns with the notices of its reader."""
        return replace(table, notices=self.of_readers[place]) if place in self.of_readers else table

    def without(self, doomed: Mapping[int, Doomed]) -> Batch:
        """The same batch with reasons why not in some places."""
        return replace(self, singles={**self.singles, **doomed}, rows={})


def variants_from(
    first: int, variants: Variants[Any], drawn: Sequence[dict[str, DrawnValue]]
) -> tuple[list[TablesAtPlaces], dict[int, Single]]:
    """The tables of variants, or numbered cells, and why there are none, by their places in a batch.

    Args:
        first: the place of the first one.
        variants: the variants.
        drawn: what was drawn for each.
    """
    if isinstance(variants.variation, NumberedCells):
        cells, errors = made_cells(variants, drawn)
        groups: list[tuple[list[int], ManipulatorColumns]] = []
    else:
        cells, (groups, errors) = {}, made_variants(variants, drawn)
    singles: dict[int, Single] = {first + place: cell for place, cell in cells.items()}
    names = variants.names if errors else []
    singles |= {first + place: Doomed(names[place], error, variants.variation.mark) for place, error in errors.items()}
    return [(tuple([first + place for place in places]), columns) for places, columns in groups], singles


def batches(plan: Plan, expected: Expected, own_files: Sequence[str] = ()) -> Iterator[Batch]:
    """All that a run has to make.

    Args:
        plan: the run.
        expected: gets how far the reading has come.
        own_files: names of files of the run beside those of its manipulators.
    """
    emitters = [call.stage for call in plan.recipe.emitters]
    written = [
        *(each.suffixes for each in emitters),
        *((end.lower(),) for each in emitters for end in each.endings[len(each.suffixes) :]),
    ]
    pictures = [(ending,) for ending in picture_endings(plan.recipe)]
    is_beside = plan.layout.form is Form.FILES
    stems = Stems(plan.layout.stem_of, (*written, *pictures), own_files if is_beside else ())
    waiting = _Waiting(items(plan, expected))
    sizes = BatchSizes(plan)
    first = 0
    while True:
        with collected_at_the_end():
            some = waiting.take(sizes.next(expected.total, is_slow=waiting.is_slow), plan.layout.whole)
            batch = _batch(first, some, stems)
        if not some:
            expected.total = first
            return
        yield batch
        first += len(batch)
        sizes.see(len(batch), batch.joints)
        expected.see(first, some[-1].what, some[-1].source)


class _Waiting:
    """What waits for its batch."""

    def __init__(self, waiting: Iterator[RunItem]) -> None:
        self._waiting = waiting
        self._rest: RunItem | None = None

    @property
    def is_slow(self) -> bool:
        """Whether the next ones are made one by one."""
        self._rest = self._rest or next(self._waiting, None)
        return self._rest is not None and self._rest.is_slow

    def take(self, size: int, whole: int) -> list[RunItem]:
        """The next manipulators, so many of them or all that are left.

        Where a batch is no `whole` shard, it ends before what is made in another way.
        """
        taken: list[RunItem] = []
        while size and (item := self._rest or next(self._waiting, None)):
            self._rest = item
            if taken and whole == 1 and item.is_slow is not taken[0].is_slow:
                break
            self._rest = None
            if isinstance(item.what, ManipulatorGroups | Variants) and item.size > size:
                self._rest = item._replace(what=item.what.part(size, item.size))
                item = item._replace(what=item.what.part(0, size))
            taken.append(item)
            size -= item.size
        return taken


def _batch(first: int, some: Sequence[RunItem], stems: Stems) -> Batch:
    names = [name for item in some for name in item.names]
    sources = [source for item in some for source in (item.source,) * item.size]
    own_stems = [""] * len(names)
    notices: dict[int, tuple[Problem, ...]] = {}
    singles: dict[int, Single] = {}
    plain: list[tuple[Sequence[int], Manipulator | ManipulatorColumns]] = []
    of_readers: dict[int, tuple[Problem, ...]] = {}
    variants: list[tuple[int, Variants[Any]]] = []
    tracebacks: dict[int, str] = {}
    place = 0
    for item in some:
        match what := item.what:
            case Variants():
                variants.append((place, what))
                if what.numbers.start == 1 and (noticed := tuple(what.variation.notices())):
                    notices[place] = noticed  # once, with the first
            case Manipulator():
                plain.append(((place,), what))
            case ManipulatorGroups(groups=groups):
                plain += [([place + member for member in members], columns) for members, columns in groups]
            case _:
                singles[place] = what
                if isinstance(what, Cell) and what.call.notices:
                    notices[place] = what.call.notices
        if item.traceback:
            tracebacks[place] = item.traceback
        place += item.size
    # Of an input that cannot be read there will be no files, and its name may be another manipulator's.
    for place in [place for place in range(len(names)) if not isinstance(singles.get(place), Rejected)]:
        own_stems[place], clash = stems.claim(names[place])
        if clash:
            told = clash.about(mark=Mark(file=sources[place]) if sources[place] else None)
            notices[place] = (*notices.get(place, ()), told)
    return Batch(
        first=first,
        names=tuple(names),
        stems=tuple(own_stems),
        sources=tuple(sources),
        columns=_groups(plain, of_readers),
        variants=tuple(variants),
        singles=singles,
        notices=notices,
        of_readers=of_readers,
        tracebacks=tracebacks,
    )


def _groups(
    plain: Sequence[tuple[Sequence[int], Manipulator | ManipulatorColumns]],
    of_readers: dict[int, tuple[Problem, ...]],
) -> tuple[TablesAtPlaces, ...]:
    """Manipulators that differ in numbers only, with their places.

    Args:
        plain: manipulators and columns, with their places.
        of_readers: takes their notices, by place: tables that differ in numbers only have notices of their own.
    """
    tables: list[Manipulator | ManipulatorColumns] = []
    for places, what in plain:
        table = what.table if isinstance(what, ManipulatorColumns) else what
        if table.notices:
            of_readers.update(dict.fromkeys(places, table.notices))
            bare = replace_unchecked(table, notices=())
            tables.append(replace(what, table=bare) if isinstance(what, ManipulatorColumns) else bare)
        else:
            tables.append(what)
    all_places = [place for places, _ in plain for place in places]
    return tuple([(tuple([all_places[k] for k in members]), some) for members, some in in_columns(tables)])


def items(plan: Plan, expected: Expected) -> Iterator[RunItem]:
    """The manipulators of all inputs, in columns where they can be; a bad input ends itself, not the run.

    Cells and variants come last: of the manipulators, only those that they need are kept so long.

    Args:
        plan: the run.
        expected: gets how far the reading has come.
    """
    needed = [arm.of for cell in plan.cells for arm in cell.arms] + [call.of for call in plan.variations]
    variations = {call.name: call.of for call in plan.variations}
    gathering = WantedTables(needed, (cell.name for cell in plan.cells), variations)
    meshes = MeshGiver(plan.meshes)
    count = 0
    for path, call in plan.inputs:
        source, before = str(path), count
        try:
            for item in read_items(call, path, columns=not plan.meshes):
                read = meshes.give(item) if not isinstance(item, ManipulatorGroups) else item
                for part in _first_noticed(read, plan.input_notices.get(path) if count == before else None):
                    gathering.see(part)
                    made = RunItem(part, source)
                    count += made.size
                    yield made
            if count == before:
                raise TableError(say("table-empty", names=()))
        except (TableError, StageError) as error:
            rejected = Rejected(name=path.stem, problems=error.problems, mark=Mark(file=source), notices=error.notices)
            gathering.see(rejected)
            count += 1
            yield RunItem(rejected, source, error.traceback if isinstance(error, StageError) else "")
        expected.finish_input()
    for left in meshes.left_over():
        count += 1
        yield RunItem(left, _file(left.mark))
    of_variations = [_variants(call, gathering) for call in plan.variations]
    calls = zip(plan.variations, of_variations, strict=True)
    named = {call.name: variants for call, variants in calls if call.name != call.of}
    of_cells = with_tables(plan.cells, gathering, named)
    later = [RunItem(what, _file(call.mark)) for call, what in zip(plan.cells, of_cells, strict=True)]
    later += [RunItem(what, _file(call.mark)) for call, what in zip(plan.variations, of_variations, strict=True)]
    expected.finish_inputs(count + sum(item.size for item in later))
    yield from later


def _first_noticed(
    what: Manipulator | ManipulatorGroups | Rejected, notice: Problem | None
) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
    """What was read, with a notice of the whole input before those of its first manipulator."""
    if notice is None:
        yield what
    elif isinstance(what, ManipulatorGroups):
        (table,) = what.part(0, 1).tables()
        yield replace(table, notices=(notice, *table.notices))
        if len(what) > 1:
            yield what.part(1, len(what))
    else:
        yield replace(what, notices=(notice, *what.notices))


def _file(mark: Mark | None) -> str:
    return mark.file if mark else ""


def _variants(call: VariationCall, gathering: WantedTables) -> Variants[Variation] | Rejected:
    """The variants of a variation; why not, where there can be none."""
    table = gathering.table(call.of, f"the variation {shown(call.name)}", call.of_mark or call.mark)
    try:
        if not isinstance(table, Manipulator):
            raise ConfigError(table)
        return bind(call, table).variants()
    except ConfigError as error:
        return Rejected(name=call.name, problems=error.problems, mark=call.mark)


SMALL = 16
"""Manipulators of a batch at most, where each takes long."""
LARGE = 500
"""Manipulators of a batch at most, as long as it is not known how many are left."""
JOINTS = 24_000
"""Joints of a larger batch at most: its worker holds the descriptions of them all, some 2 kB for each joint."""
PARTS = 64
"""Into so many parts what is left is cut where the number of workers is not known."""


class BatchSizes:
    """The sizes of the batches of a run, one after the other.

    What a batch costs besides its manipulators, some 10 ms, is the less for each the more there are. But a short run is
    to keep every worker busy, and at its end none is to wait long for another: so batches grow from one, and where they
    have become large, each is a part of what is left, shared by the workers (guided self-scheduling: Polychronopoulos
    and Kuck, IEEE Transactions on Computers C-36(12), 1987).
    """

    def __init__(self, plan: Plan) -> None:
        self._recipe = plan.recipe.of("arms")
        self._whole = plan.layout.whole
        workers = getattr(plan.executor.options, "workers", None)
        if not isinstance(workers, int):
            self._parts = PARTS
        else:
            self._parts = 1 if workers == 1 else 2 * workers
        self._size = self._axes = 1
        self._taken = 0

    def next(self, total: int | None, *, is_slow: bool = False) -> int:
        """The size of the next batch; where there are shards, that of one or more of them.

        Args:
            total: how many manipulators the run will probably have; None where there is no saying.
            is_slow: whether the next ones are made one by one.
        """
        is_quick = self._is_quick and not is_slow
        largest = LARGE if is_quick else SMALL
        if total is not None and is_quick:
            largest = max(LARGE, min((total - self._taken) // self._parts, JOINTS // self._axes))
        return self._whole * max(1, min(self._size, largest) // self._whole)

    def see(self, count: int, joints: int) -> None:
        """Take notice of a batch, behind which the next one may be larger.

        Args:
            count: manipulators in it.
            joints: the joints of those that can be made at once.
        """
        if self._taken:  # An executor looks at the first two before it takes processes for them.
            self._size = 2 * count if self._is_quick else count + 1
        self._axes = max(1, joints // count)
        self._taken += count

    @property
    def _is_quick(self) -> bool:
        """Whether manipulators are made many at once, and simulators load few of them."""
        recipe = self._recipe
        loads = recipe.loaders and (self._taken < recipe.sample.first or recipe.sample.every < SMALL)
        return recipe.makes_many_at_once and not loads


class Expected:
    """How many manipulators a run will have, as far as is known while its inputs are being read.

    Attributes:
        total: how many; None as long as there is no saying.
    """

    def __init__(self, plan: Plan) -> None:
        self.total: int | None = None
        self._inputs = max(1, len(plan.inputs))
        self._read = 0
        named = {call.name for call in plan.variations if call.name != call.of}
        of_variants = any(arm.of in named for cell in plan.cells for arm in cell.arms)
        counts = [call.count for call in plan.variations]
        counts += [cell.count if cell.vary else 1 for cell in plan.cells]
        self._besides = None if None in counts or of_variants else sum(filter(None, counts))

    def see(self, count: int, what: object, source: str) -> None:
        """Take notice of how far the reading has come."""
        if self._besides is None or not isinstance(what, Manipulator | ManipulatorGroups | Rejected):
            return
        mark = what.marks[-1] if isinstance(what, ManipulatorGroups) else what.mark
        lines = _lines_of(source)
        part = mark.line / lines if mark and mark.line and mark.line <= lines else 0.0
        if (fraction := (self._read + part) / self._inputs) > 0.0:
            self.total = round(count / fraction) + self._besides

    def finish_input(self) -> None:
        """One more input is read."""
        self._read += 1

    def finish_inputs(self, total: int) -> None:
        """All inputs are read, and with cells and variants there are so many manipulators."""
        self.total = total


@lru_cache(maxsize=1)
def _lines_of(source: str) -> int:
    """Lines of a file; 0 where it is none of text."""
    try:
        with Path(source).open("rb") as file:
            blocks = iter(partial(file.read, 1 << 20), b"")
            first = next(blocks, b"")
            return 0 if b"\0" in first else first.count(b"\n") + sum(block.count(b"\n") for block in blocks)
    except OSError:
        return 0  # Its reader says why.
