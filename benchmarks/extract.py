"""The table of a seven-axis URDF, from file to manipulator: read, extracted, measured against the file's chain.

The file is written from a published table, read again in every turn, and nothing of it is kept in between. The median
and the slowest of the turns are printed, for both conventions.

    python benchmarks/extract.py
"""

from __future__ import annotations

import argparse
import platform
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import dh2urdf
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf_plugins.descriptions.readers import URDF, DescriptionOptions

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
    seconds = time.perf_counter() - started
    if not isinstance(arm, Manipulator) or len(arm.rows) != len(IIWA):
        raise TypeError(f"no table of seven rows: {arm}")
    return seconds


def main() -> int:
    """Take the turns and print what they took."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=200, help="how many tables of each convention")
    turns = parser.parse_args().turns
    print(f"Python {platform.python_version()}, {platform.machine()}, {turns} turns each")
    with tempfile.TemporaryDirectory() as folder:
        path = description(Path(folder))
        for convention in Convention:
            turn(path, convention)  # imports
            taken = [1000 * turn(path, convention) for _ in range(turns)]
            print(f"{convention}: median {median(taken):.1f} ms, slowest {max(taken):.1f} ms")
    return 0


if __name__ == "__main__":
    sys.exit(main())
