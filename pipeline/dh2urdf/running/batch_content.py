"""What there is to make in a batch, and what an earlier run has made of it."""

from __future__ import annotations

import time
from collections import defaultdict
from contextlib import contextmanager
from dataclasses import field
from enum import Enum
from typing import TYPE_CHECKING, Any

import orjson

from dh2urdf.conversion.keys import column_keys, key_of, whole
from dh2urdf.conversion.one_manipulator import Recipe
from dh2urdf.isolation.loads import KeptChildren
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.output.layouts import Layout
from dh2urdf.output.store import Store
from dh2urdf.running.earlier_files import EarlierFiles
from dh2urdf.running.mesh_copies import MeshCopies
from dh2urdf.tasks.batch import Batch, Single, variants_from

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.conversion.outcome import ManifestRow
    from dh2urdf.source import Mark, Problem
    from dh2urdf.variations.laws import DrawnValue
    from dh2urdf.variations.variation import Variants


class Depth(Enum):
    """How far the work on a batch goes."""

    LOOK = "look"
    """Robots are made and checked."""
    REHEARSE = "rehearse"
    """Files are made and proved, but put nowhere: who does not survive that must not take the others along."""
    MAKE = "make"
    """Files are put in their place, and simulators load them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Assignment:
    """What is done with every batch of a run.

    Attributes:
        recipe: what is done with every manipulator.
        key: the key of the recipe.
        store: where everything goes.
        layout: under which names.
        reports: where the files about the run go.
        journal: folder of it for what is done so far.
        home: the process of the run itself, which a manipulator that hangs must not end.
        effect: what is done in earnest.
        has_table: whether the run makes a table of its manifest.
        has_page: whether it makes a page of it.
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
    has_table: bool = False
    has_page: bool = False
    children: KeptChildren = field(default_factory=KeptChildren, compare=False, repr=False)


class BatchContent:
    """What a batch has to make, and what of it an earlier run has made."""

    def __init__(self, worker: Assignment, batch: Batch) -> None:
        self.worker, self.recipe, self.batch = worker, worker.recipe, batch
        self.seconds: defaultdict[str, float] = defaultdict(float)
        self.singles = dict(batch.singles)
        self.drawn: dict[int, dict[str, DrawnValue]] = {}
        self.marks: dict[int, Mark | None] = {}
        self.groups = list(batch.columns)
        self.faults: dict[int, tuple[Problem, ...]] = {}
        self.earlier = EarlierFiles(worker.store, worker.layout)
        self.copies = MeshCopies(
            worker.store, self.earlier, self.recipe.mesh_prefix if self.recipe.copies_meshes else None
        )
        with timed(self.seconds, "draw"):
            for start, variants in batch.variants:
                self._draw(start, variants)
        self.keys = self._keys()

    # --- What there is to make

    def _draw(self, start: int, variants: Variants) -> None:
        """The tables of variants."""
        variation = variants.variation
        drawn = variation.drawn(variants.numbers)
        places = range(start, start + len(variants))
        self.drawn.update(zip(places, drawn, strict=True))
        self.marks.update(dict.fromkeys(places, variation.mark))
        groups, doomed = variants_from(start, variants, drawn)
        self.groups += groups
        self.singles.update(doomed)

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
        return next(columns.marks[places.index(place)] for places, columns in self.groups if place in places)

    def what(self, place: int) -> Single:
        """What is to be made at a place."""
        if place in self.singles:
            return self.singles[place]
        for places, columns in self.groups:
            if place in places:
                return self.batch.with_notices(place, columns.pick(places.index(place)))
        raise LookupError(place)


@contextmanager
def timed(seconds: dict[str, float], step: str) -> Iterator[None]:
    """Add the time that a step takes [s]."""
    started = time.perf_counter()
    try:
        yield
    finally:
        seconds[step] += time.perf_counter() - started
