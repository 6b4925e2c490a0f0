"""What each documented column costs: a CSV file with it against the same file without, read in turn in one run.

The plain table has names, types, the four parameters and limits. A line of the answer is the time of a table with one
more column, or with one column written another way, as a multiple of the plain table's.

    python benchmarks/read_columns.py
"""

from __future__ import annotations

import argparse
import csv
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

ADDED: dict[str, dict[str, str]] = {
    "mass": {"mass": "2.5"},
    "mass [g]": {"mass [g]": "2500"},
    "centre of mass": {"mass": "2.5", "com_x": "0.01", "com_y": "0", "com_z": "-0.02"},
    "inertia": {
        "mass": "2.5",
        "com_x": "0.01",
        "com_y": "0",
        "com_z": "-0.02",
        "ixx": "0.01",
        "iyy": "0.01",
        "izz": "0.01",
        "ixy": "0",
        "ixz": "0",
        "iyz": "0",
    },
    "damping, friction": {"damping": "0.1", "friction": "0.2"},
    "armature": {"armature": "0.05"},
    "sign": {"sign": "1"},
    "offset": {"offset": "0.1"},
    "link": {"link": "part"},
    "a column of text": {"remark": "red"},
}
"""Columns that are added, with the text of each of their cells."""
CHANGED: dict[str, dict[str, tuple[str, Callable[[str], str]]]] = {
    "lengths in mm": {key: (f"{key} [mm]", lambda text: f"{1000 * float(text):.2f}") for key in ("a", "d")},
    "type R": {"type": ("type", lambda _: "R")},
    "a joint variable": {"theta": ("theta", lambda _: "q")},
    "multiples of pi": {"theta": ("theta", lambda text: f"pi/{2 + int(float(text) > 0)}")},
}
"""Columns that are written another way: by their names, the header and the way."""


def with_columns(plain: list[list[str]], name: str) -> list[list[str]]:
    header, *rows = plain
    if name in ADDED:
        texts = [f"{text}_{{}}" if key == "link" else text for key, text in ADDED[name].items()]
        more = [[text.format(number % 6) for text in texts] for number in range(len(rows))]
        return [[*header, *ADDED[name]], *([*row, *cells] for row, cells in zip(rows, more, strict=True))]
    changed = CHANGED[name]
    ways = [changed.get(key, (key, str)) for key in header]
    return [[key for key, _ in ways], *([way(text) for (_, way), text in zip(ways, row, strict=True)] for row in rows)]


def seconds(path: Path, robots: int) -> float:
    started = time.perf_counter()
    items = list(CSV.read(path, TableOptions(convention="standard", angle_unit="rad")))
    taken = time.perf_counter() - started
    if len(items) != robots or not all(isinstance(item, Manipulator) for item in items):
        raise ValueError(f"{path.stem}: {items[0]}")
    return taken


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, default=3000)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        paths = {"plain": Path(folder) / "plain.csv"}
        write_table(paths["plain"], given.robots)
        with paths["plain"].open(newline="", encoding="utf-8") as file:
            plain = list(csv.reader(file))
        for name in (*ADDED, *CHANGED):
            paths[name] = Path(folder) / f"{len(paths)}.csv"
            with paths[name].open("w", newline="", encoding="utf-8") as file:
                csv.writer(file).writerows(with_columns(plain, name))
        times: dict[str, list[float]] = {name: [] for name in paths}
        for _ in range(given.rounds):
            for name, path in paths.items():
                times[name].append(seconds(path, given.robots))
    unit = median(times["plain"])
    for name, found in times.items():
        print(f"{name:18} {1e6 * median(found) / given.robots:7.0f} µs an arm   {median(found) / unit:5.2f} x plain")


if __name__ == "__main__":
    main()
