"""The table of a seven-axis URDF, from file to manipulator: read, extracted, measured against the file's chain.

The file is written from a published table, read again in every turn, and nothing of it is kept in between. The median
and the slowest of the turns are printed, for both conventions. Then many such files, no two alike, are read, and
converted by a run that proves what it writes; the ratio of the two is printed.

    python benchmarks/extract.py
    python benchmarks/extract.py --turns 20 --files 1000
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


def many(folder: Path, number: int, workers: int) -> tuple[float, float]:
    """How long it takes to read many files [s], and to convert them in a run [s]."""
    text = description(folder).read_text("utf-8")
    inputs = folder / "inputs"
    inputs.mkdir()
    for index in range(number):
        changed = text.replace('xyz="0 0 0.36"', f'xyz="0 0 {0.36 + index / 1e4:.4f}"')
        (inputs / f"arm_{index:04}.urdf").write_text(changed.replace('name="iiwa"', f'name="arm_{index:04}"'), "utf-8")
    run_file = folder / "run.yaml"
    run_file.write_text(
        "inputs: ['inputs/*.urdf']\nemitters: [urdf]\nloaders: []\noutput: made\n"
        f"execution: {{options: {{workers: {workers}}}}}\n",
        "utf-8",
    )
    started = time.perf_counter()
    for path in sorted(inputs.iterdir()):
        (arm,) = URDF.read(path, DescriptionOptions())
        if not isinstance(arm, Manipulator):
            raise TypeError(f"no table: {arm}")
    reading = time.perf_counter() - started
    started = time.perf_counter()
    dh2urdf.run(run_file)
    running = time.perf_counter() - started
    if len(written := list((folder / "made").glob("*.urdf"))) != number:
        raise RuntimeError(f"{len(written)} of {number} files were written")
    return reading, running


def main() -> int:
    """Take the turns and print what they took."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=200, help="how many tables of each convention")
    parser.add_argument("--files", type=int, default=1000, help="how many files are read and converted in a run")
    parser.add_argument("--workers", type=int, default=2, help="worker processes of the run")
    asked = parser.parse_args()
    turns = asked.turns
    print(f"Python {platform.python_version()}, {platform.machine()}, {turns} turns each")
    with tempfile.TemporaryDirectory() as folder:
        path = description(Path(folder))
        for convention in Convention:
            turn(path, convention)  # imports
            taken = [1000 * turn(path, convention) for _ in range(turns)]
            print(f"{convention}: median {median(taken):.1f} ms, slowest {max(taken):.1f} ms")
        reading, running = many(Path(folder), asked.files, asked.workers)
        each = 1000 / max(asked.files, 1)
        print(
            f"{asked.files} files: read in {reading:.1f} s ({reading * each:.1f} ms each), "
            f"the whole run {running:.1f} s ({running / reading:.2f} times)"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
