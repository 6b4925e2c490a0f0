"""A CSV file of 100,000 six-axis robots (600,000 rows), read by dh2urdf, by Python's csv module alone, and by pandas.

Every robot of the file is different. Each way reads the same file from beginning to end, in turn, so that what else
the machine does falls on all; medians are printed with their ratio to `csv.reader`. dh2urdf gives checked manipulators
in SI units; `csv.reader` gives lists of texts; pandas one frame of numbers.

    python benchmarks/read_csv.py
"""

from __future__ import annotations

import argparse
import csv
import platform
import sys
import tempfile
import time
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING

from arms import write_table

from dh2urdf.manipulator import Manipulator
from dh2urdf_plugins.readers.options import TableOptions
from dh2urdf_plugins.readers.stages import CSV

if TYPE_CHECKING:
    from collections.abc import Callable

AXES = 6


def with_dh2urdf(path: Path) -> int:
    """Joints of all manipulators, each of which must have been accepted."""
    joints = 0
    for item in CSV.read(path, TableOptions(convention="standard")):
        if not isinstance(item, Manipulator):
            raise TypeError(f"refused: {item.problems[0]}")
        joints += len(item.rows)
    return joints


def with_csv(path: Path) -> int:
    """Rows below the header."""
    with path.open(newline="", encoding="utf-8") as file:
        return sum(1 for _ in csv.reader(file)) - 1


def with_pandas(path: Path) -> int:
    """Rows of the frame."""
    import pandas as pd

    return len(pd.read_csv(path))


def seconds(read: Callable[[Path], int], path: Path, rows: int) -> float:
    started = time.perf_counter()
    found = read(path)
    taken = time.perf_counter() - started
    if found != rows:
        raise ValueError(f"{found} rows were read of {rows}")
    return taken


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, default=100_000)
    parser.add_argument("--rounds", type=int, default=7)
    given = parser.parse_args()
    ways: dict[str, Callable[[Path], int]] = {"csv.reader": with_csv, "dh2urdf": with_dh2urdf}
    try:
        import pandas as pd
    except ImportError:
        print("pandas is not installed: it is left out")
    else:
        ways[f"pandas {pd.__version__}"] = with_pandas
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "robots.csv"
        write_table(path, given.robots)
        rows = given.robots * AXES
        times: dict[str, list[float]] = {name: [] for name in ways}
        for _ in range(given.rounds):
            for name, read in ways.items():
                times[name].append(seconds(read, path, rows))
        size = path.stat().st_size
    unit = median(times["csv.reader"])
    print(f"{given.robots:,} robots, {rows:,} rows, {size / 1e6:.1f} MB; median of {given.rounds} rounds, in turn")
    print(f"Python {sys.version.split()[0]}, {platform.machine()}")
    for name, found in times.items():
        taken = median(found)
        print(f"{name:16} {taken:7.3f} s   {1e6 * taken / rows:6.2f} µs per row   {taken / unit:5.2f} x csv.reader")


if __name__ == "__main__":
    main()
