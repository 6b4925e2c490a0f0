"""Tables of known arms through every reader: each must be read as the arm that it is, wherever it stands.

    python fuzz/tables.py --tables 50000 --seed 1 --workers 2

Every table is an arm whose meaning is known (`known_arms.py`), written in a random dialect (`known_tables.py`,
`dialects.py`, `row_dialects.py`). It is read from CSV, YAML, JSON, Parquet and workbooks, alone and as one of many, at
the first, a middle and the last place of a file, and by `Manipulator.from_dh`. Its forward kinematics, limits, masses,
shapes and payload must be the known ones to 1e-12, and all readings of one table must be equal to the last bit.
"""

from __future__ import annotations

import argparse
import random
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest.mock import patch

import numpy as np
from dialects import WRITERS, File, as_arguments, as_csv, write
from known_arms import COM, LIMITS, TENSOR
from known_tables import Table, home_positions, make_table

from dh2urdf.errors import Dh2UrdfError, TableError
from dh2urdf.manipulator import DHRow, Manipulator
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.plain import rows as plain_rows
from dh2urdf_plugins.readers.plain.rows import PlainRows

if TYPE_CHECKING:
    from collections.abc import Iterator

    from known_arms import KnownArm, KnownRow
    from known_quantities import Exact

    from dh2urdf.stages import Reader, Rejected

READERS: dict[str, Reader[Any]] = {
    "csv": stages.CSV,
    "tsv": stages.CSV,
    "yaml": stages.YAML,
    "yml": stages.YAML,
    "json": stages.YAML,
}
READERS |= {"parquet": stages.PARQUET, "xlsx": stages.XLSX}
PART = 20
"""How many cases a worker is given at a time."""
EXACTLY = 1e-12
"""Largest error of a number, relative or absolute [SI]."""


Poses = Sequence[tuple[list[float], Any]]
"""Joint vectors, and T(base_link -> tool0) at each."""


class WrongReading(Exception):  # noqa: N818 - it is what is looked for
    """A table was read as another arm, or not at all."""


@dataclass
class Figures:
    """What was done."""

    tables: int = 0
    readings: int = 0
    files: int = 0
    fast: int = 0
    dialects: set[str] = field(default_factory=set)
    by_reader: Counter[str] = field(default_factory=Counter)

    def add(self, other: Figures) -> None:
        """Adds what was done elsewhere."""
        for part in fields(self):
            mine, others = getattr(self, part.name), getattr(other, part.name)
            setattr(self, part.name, mine | others if isinstance(mine, set) else mine + others)


def read(file: File, folder: Path, options: dict[str, Any]) -> list[Manipulator | Rejected]:
    """What a reader makes of a file.

    Raises:
        WrongReading: it refuses the file.
    """
    path = write(file, folder, "arms")
    try:
        reader = READERS[file.suffix[1:]]
        return list(reader.read(path, reader.options(**options)))
    except TableError as error:
        raise WrongReading(f"the file is refused: {error}") from error
    finally:
        path.unlink()


def from_python(rng: random.Random, table: Table) -> Manipulator:
    """What `Manipulator.from_dh` makes of the only arm of a table.

    Raises:
        WrongReading: it refuses the arguments.
    """
    rows, arguments = as_arguments(rng, table)
    try:
        return Manipulator.from_dh(rows, **arguments)
    except Dh2UrdfError as error:
        raise WrongReading(f"from_dh refuses {rows} with {arguments}: {error}") from error


def check(known: KnownArm, found: Manipulator | Rejected, poses: Poses) -> None:
    """Compares a reading with what is known.

    Raises:
        WrongReading: they differ.
    """
    if not isinstance(found, Manipulator):
        raise WrongReading(f"the table is refused: {found.problems[0]}")
    _same("name", found.name, known.name)
    _same("convention", str(found.convention), known.convention)
    _same("number of joints", len(found.rows), len(known.rows))
    for number, (row, wanted) in enumerate(zip(found.rows, known.rows, strict=True), start=1):
        _check_row(row, wanted, number)
    _check_arm(found, known)
    for q, wanted_pose in poses:
        size = max(1.0, float(np.abs(wanted_pose).max()))
        error = float(np.abs(found.fk(q) - wanted_pose).max())
        if not error <= EXACTLY * size * len(known.rows):
            raise WrongReading(f"tool0 is {error:.3g} off at q = {q}")


def _check_arm(found: Manipulator, known: KnownArm) -> None:
    """Compares the base, the links and the payload."""
    _close("base_mass", found.base_mass, _si(known.base_mass))
    _close("density", found.density, _si(known.density))
    for what, shape, wanted in (
        ("geometry", found.geometry, known.shape),
        ("base_geometry", found.base_geometry, known.base_shape),
    ):
        _same(f"shape of {what}", shape.shape, wanted.shape)
        _close(f"radius of {what}", shape.radius, _si(wanted.radius))
    payload, carried = found.payload, known.payload
    if payload is None or carried is None:
        _same("whether there is a payload", payload is not None, carried is not None)
        return
    _close("mass of the payload", payload.mass, carried.mass.si)
    for name, number, exact in zip("xyz", payload.com, carried.com, strict=True):
        _close(f"com of the payload, {name}", number, exact.si)
    for name in TENSOR:
        exact_one = carried.inertia[name].si if carried.inertia else None
        _close(f"{name} of the payload", getattr(payload.inertia, name, None), exact_one)


def _si(number: Exact | None) -> float | None:
    return None if number is None else number.si


def _check_row(row: DHRow, wanted: KnownRow, number: int) -> None:
    _same("joint", row.joint, wanted.joint or f"joint_{number}")
    _same("link", row.link, wanted.link or f"link_{number}")
    _same("type", str(row.type), wanted.type)
    for name in (*LIMITS, "mass", "radius", "damping", "friction", "armature", *COM, *TENSOR):
        _close(f"{name} of row {number}", _value(row, name), wanted.si(name))


def _value(row: DHRow, name: str) -> float | None:
    """A field of a row by its name in a table."""
    value: float | None
    if name in COM:
        value = row.com and row.com[COM.index(name)]
    elif name in TENSOR:
        value = getattr(row.inertia, name) if row.inertia else None
    else:
        value = getattr(row.limits if name in LIMITS else row, name)
    return value


def _same(what: str, found: object, wanted: object) -> None:
    if found != wanted:
        raise WrongReading(f"{what} is {found!r}, and it should be {wanted!r}")


def _close(what: str, found: float | None, wanted: float | None) -> None:
    if (found is None) != (wanted is None) or (
        found is not None and wanted is not None and not abs(found - wanted) <= EXACTLY * max(1.0, abs(wanted))
    ):
        raise WrongReading(f"{what} is {found!r}, and it should be {wanted!r}")


def signature(arm: Manipulator) -> str:
    """Everything that a reading declares about an arm, to the last bit; not where it was read, and not its name."""
    rows = [[getattr(row, part.name) for part in fields(row) if part.name != "mark"] for row in arm.rows]
    others = [getattr(arm, part.name) for part in fields(arm) if part.name not in ("name", "rows", "mark", "notices")]
    return repr((rows, others))


class _Case:
    """One table, and its readings so far."""

    def __init__(self, table: Table, rng: random.Random, folder: Path, figures: Figures) -> None:
        self.table = table
        self.poses = [[(q, arm.known.fk(q)) for q in home_positions(rng, arm.known)] for arm in table.arms]
        self.folder = folder
        self.figures = figures
        self.has_units = any(column.unit for column in table.columns)
        self.readings: dict[tuple[str, bool], dict[str, str]] = {}

    def only(self, index: int) -> Table:
        """A table of one of the arms."""
        return replace(self.table, arms=[self.table.arms[index]])

    def take_file(self, name: str, file: File, indices: list[int]) -> None:
        """Reads a file that holds some of the arms."""
        self.figures.files += 1
        self.figures.dialects.add(file.dialect)
        try:
            self.take(name, read(file, self.folder, self.table.options), indices)
        except WrongReading as error:
            raise WrongReading(f"{error}\n{_shown(file)}") from error

    def take(self, name: str, items: Sequence[Manipulator | Rejected], indices: list[int]) -> None:
        """Compares readings with what is known of some of the arms."""
        _same("number of arms", len(items), len(indices))
        for index, item in zip(indices, items, strict=True):
            self.figures.readings += 1
            self.figures.by_reader[name] += 1
            try:
                check(self.table.arms[index].known, item, self.poses[index])
            except WrongReading as error:
                raise WrongReading(f"{name}, arm {index} of {len(items)}: {error}") from error
            if isinstance(item, Manipulator):
                # Keys of YAML have no units: then its cells are other texts, and may differ in the last bit.
                other = self.has_units and name in ("yaml", "json")
                rows = repr(self.table.arms[index].rows)
                key = rows + str(self.table.arms[index].said), other
                self.readings.setdefault(key, {}).setdefault(signature(item), name)

    def compare(self) -> None:
        """Compares all readings of the same rows with each other."""
        for said in self.readings.values():
            (one, name), *others = said.items()
            for other, other_name in others:
                start = next((k for k, (x, y) in enumerate(zip(one, other, strict=False)) if x != y), 0)
                parts = one[max(0, start - 60) : start + 60], other[max(0, start - 60) : start + 60]
                raise WrongReading(f"an arm has two readings: {name} gives …{parts[0]}…, {other_name} …{parts[1]}…")


def run_table(rng: random.Random, count: int, folder: Path, figures: Figures, *, plain: bool) -> None:
    """Writes and reads one table of some arms in every way.

    Raises:
        WrongReading: one of the readings is wrong.
    """
    table = make_table(rng, count, plain=plain)
    again = replace(table.arms[0], known=replace(table.arms[0].known, name="the first one again"))
    table.arms += [again] if count > 1 else []  # equal rows at the last place
    figures.tables += count
    case = _Case(table, rng, folder, figures)
    for name, writer in WRITERS.items():
        extra = {"plain": plain} if writer is as_csv else {}
        if count > 1:
            case.take_file(name, writer(rng, table, bulk=True, **extra), list(range(len(table.arms))))
        for index in sorted({0, rng.randrange(count), count - 1}):
            case.take_file(name, writer(rng, case.only(index), bulk=False, **extra), [index])
    for index in sorted({0, count - 1}) if "defaults" not in table.said else ():  # which `from_dh` does not take
        case.take("python", [from_python(rng, case.only(index))], [index])
    case.compare()


def _shown(file: File) -> str:
    if file.suffix in (".parquet", ".xlsx"):
        return f"({file.dialect})"
    text = file.content.decode("utf-16" if "utf-16" in file.dialect else "utf-8", "replace")
    return f"({file.dialect}, {text[:6000]!r})"


@contextmanager
def counted_fast(figures: Figures) -> Iterator[None]:
    """Counts the arms that are read by the fast way, which takes all that are plain, be there one of a form or many."""
    read_fast = PlainRows.read

    def counted(self: PlainRows, arms: Any) -> Any:
        groups = read_fast(self, arms)
        figures.fast += sum(len(members) for members, _ in groups or ())
        return groups

    with patch.object(PlainRows, "read", counted), patch.object(plain_rows, "FEWEST", 0):
        yield


def cases(seed: int, tables: int) -> list[int]:
    """The numbers of the cases that have so many tables together."""
    numbers, total = [], 0
    while total < tables:
        numbers.append(len(numbers) + 1)
        total += _case(seed, numbers[-1])[1]
    return numbers


def run_cases(seed: int, numbers: Sequence[int], *, keep_going: bool) -> tuple[Figures, list[str]]:
    """Some cases of a seed: what was done, and what was read wrong."""
    figures, wrong = Figures(), []
    with tempfile.TemporaryDirectory() as folder, counted_fast(figures):
        for number in numbers:
            try:
                run_case(seed, number, Path(folder), figures)
            except WrongReading as error:
                wrong.append(f"case {number} of seed {seed}: {error}")
                if not keep_going:
                    break
    return figures, wrong


def run_all(
    seed: int, numbers: Sequence[int], workers: int, *, keep_going: bool
) -> Iterator[tuple[Figures, list[str]]]:
    """All cases of a seed in parts, in their order; each case has its own chance, so that the workers do not matter."""
    parts = [numbers[start : start + PART] for start in range(0, len(numbers), PART)]
    run = partial(run_cases, seed, keep_going=keep_going)
    if workers == 1:
        yield from map(run, parts)
        return
    ignore = (signal.SIGINT, signal.SIG_IGN)  # an interrupt is for this process
    with ProcessPoolExecutor(workers, get_context("spawn"), signal.signal, ignore) as pool:
        try:
            yield from pool.map(run, parts)
        finally:
            pool.shutdown(cancel_futures=True)


def main() -> int:
    """Read so many tables, and print what was done; 1 where a reading is wrong, or not all are done."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tables", type=int, default=50_000, help="how many tables")
    parser.add_argument("--seed", type=int, default=1, help="of everything that is random")
    parser.add_argument("--keep-going", action="store_true", help="go on after a wrong reading, and count them")
    parser.add_argument("--workers", type=int, default=1, help="how many processes; the result does not depend on it")
    parser.add_argument("--progress", action="store_true", help="say how far it is, now and then")
    given = parser.parse_args()
    figures, wrong, done, started = Figures(), 0, False, time.perf_counter()
    parts = run_all(given.seed, cases(given.seed, given.tables), given.workers, keep_going=given.keep_going)
    try:
        for part, messages in parts:
            figures.add(part)
            wrong += len(messages)
            for message in messages:
                print(f"{message}\n", file=sys.stderr, flush=True)
            if given.progress:
                said = f"{figures.tables:,} tables, {figures.readings:,} readings, wrong {wrong:,}"
                print(said, file=sys.stderr, flush=True)
            if messages and not given.keep_going:
                break
        else:
            done = True
    except KeyboardInterrupt:
        print("interrupted: what was done until then", file=sys.stderr, flush=True)
    print(f"tables     {figures.tables:9,}\nfiles      {figures.files:9,}\nreadings   {figures.readings:9,}")
    print(f"read fast  {figures.fast:9,}")
    print(f"dialects   {len(figures.dialects):9,}")
    for name, count in figures.by_reader.items():
        print(f"  {name:8} {count:9,}")
    print(f"wrong      {wrong:9,}\nseconds    {time.perf_counter() - started:9.0f}")
    return int(wrong > 0 or not done)


def run_case(seed: int, number: int, folder: Path, figures: Figures) -> None:
    """One case of a seed: a table of one arm, of some, or now and then of many plain ones."""
    rng, count, plain = _case(seed, number)
    run_table(rng, count, folder, figures, plain=plain)


def _case(seed: int, number: int) -> tuple[random.Random, int, bool]:
    """The chance of a case, how many arms it has, and whether they are plain."""
    rng = random.Random(f"{seed} {number}")
    plain = rng.random() < 0.3
    return rng, rng.choice([1, 2, 5, 12]) if not plain else rng.choice([1, 2, 2, 3, 60]), plain


if __name__ == "__main__":
    sys.exit(main())
