"""The table of a seven-axis URDF, from file to manipulator: read, extracted, measured against the file's chain.

The file is written from a published table, read again in every turn, and nothing of it is kept in between. The median
and the slowest of the turns are printed, for both conventions. Then many such files, no two alike, are read, and
converted by a run that proves what it writes, in turn; the medians of the rounds and their ratio are printed.

    python benchmarks/extract.py
    python benchmarks/extract.py --turns 20 --files 1000 --rounds 3
"""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING

from measuring import in_turn, machine, seconds, table

import dh2urdf
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf_plugins.descriptions.readers import URDF, DescriptionOptions

if TYPE_CHECKING:
    from collections.abc import Callable

# a, alpha [parts of pi/2] and d of the LBR iiwa 14 in the standard convention, from its data sheet
IIWA = ((0, -1, 0.36), (0, 1, 0), (0, 1, 0.42), (0, -1, 0), (0, -1, 0.4), (0, 1, 0), (0, 0, 0.126))


def description(folder: Path) -> Path:
    """A URDF of seven axes with masses, limits and shapes."""
    rows = "".join(f"axis_{n}, {a}, {alpha}*pi/2, {d}\n" for n, (a, alpha, d) in enumerate(IIWA, start=1))
    path = folder / "iiwa.urdf"
    dh2urdf.convert(f"# convention: standard\njoint, a, alpha, d\n{rows}", path, reader="csv")
    return path


def turn(path: Path, convention: Convention) -> float:
    """How long one table takes [s]."""
    started = time.perf_counter()
    (arm,) = URDF.read(path, DescriptionOptions(convention=convention.value))
    took = time.perf_counter() - started
    if not isinstance(arm, Manipulator) or len(arm.rows) != len(IIWA):
        raise TypeError(f"no table of seven rows: {arm}")
    return took


def many(folder: Path, number: int) -> Path:
    """A folder of many files, no two alike."""
    text = description(folder).read_text("utf-8")
    inputs = folder / "inputs"
    inputs.mkdir()
    for index in range(number):
        changed = text.replace('xyz="0 0 0.36"', f'xyz="0 0 {0.36 + index / 1e4:.4f}"')
        named = changed.replace('<robot name="robot"', f'<robot name="arm_{index:04}"')
        (inputs / f"arm_{index:04}.urdf").write_text(named, "utf-8")
    return inputs


def read_all(inputs: Path) -> None:
    """Read all files of a folder, one after the other in this process."""
    for path in sorted(inputs.iterdir()):
        (arm,) = URDF.read(path, DescriptionOptions())
        if not isinstance(arm, Manipulator):
            raise TypeError(f"no table: {arm}")


def run_all(inputs: Path, folder: Path, workers: int) -> None:
    """Convert all files of a folder in a run: read, extracted, transformed, written, read back and proved.

    The page for people, which takes a second or so however long the run is, is left out.
    """
    run_file = folder / "run.yaml"
    run_file.write_text(
        f"inputs: ['{inputs}/*.urdf']\nemitters: [urdf]\nloaders: []\noutput: made\nreport: {{html: false}}\n"
        f"execution: {{options: {{workers: {workers}}}}}\n",
        "utf-8",
    )
    dh2urdf.run(run_file)
    number = len(list(inputs.iterdir()))
    if len(written := list((folder / "made").glob("*.urdf"))) != number:
        raise RuntimeError(f"{len(written)} of {number} files were written")


def processor_time(work: Callable[[Path], None], folder: Path) -> tuple[float, float]:
    """The processor time of some work: of this process, and of those that it started and that have ended [s]."""
    sides = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    before = [resource.getrusage(side) for side in sides]
    work(folder)
    own, others = (
        (after.ru_utime - then.ru_utime) + (after.ru_stime - then.ru_stime)
        for after, then in zip(map(resource.getrusage, sides), before, strict=True)
    )
    return own, others


def main() -> int:
    """Take the turns and print what they took."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=200, help="how many tables of each convention")
    parser.add_argument("--files", type=int, default=1000, help="how many files are read and converted in a run")
    parser.add_argument("--workers", type=int, default=2, help="worker processes of the second run")
    parser.add_argument("--rounds", type=int, default=3, help="how often the files are read, and converted")
    asked = parser.parse_args()
    turns = asked.turns
    with tempfile.TemporaryDirectory() as folder:
        print(f"{machine(Path(folder), ('dh2urdf', 'lxml'))}; {turns} turns each")
        path = description(Path(folder))
        for convention in Convention:
            turn(path, convention)  # imports
            taken = [1000 * turn(path, convention) for _ in range(turns)]
            print(f"{convention}: median {median(taken):.1f} ms, slowest {max(taken):.1f} ms")
        inputs = many(Path(folder), asked.files)
        works: dict[str, Callable[[Path], None]] = {"reading": lambda _: read_all(inputs)} | {
            f"a run, {workers} worker{'s' if workers > 1 else ''}": partial(run_all, inputs, workers=workers)
            for workers in (1, asked.workers)
        }
        sides = {side: partial(processor_time, work) for side, work in works.items()}
        taken_in_turn = in_turn(sides, asked.rounds, Path(folder))
        head = [f"{asked.files} files, median of {asked.rounds}", "s", "processor: this process, s", "workers, s"]
        lines = []
        for side, each in taken_in_turn.items():
            own, workers = (median(one.value[place] for one in each) for place in (0, 1))
            lines.append([side, f"{seconds(each):.1f}", f"{own:.1f}", f"{workers:.1f}"])
        table(head, lines)
    return 0


if __name__ == "__main__":
    sys.exit(main())
