"""Random chains become tables: how far the worst table is from its chain, and how fast tables are made.

    python fuzz/extraction.py --chains 100000 --seed 7

Each chain is made in both conventions with a tolerance of 1e-12, and held against numpy's products of the joints'
origins and of the rows at random joint values. A table that is off by more than 1e-12 of the arm's size is printed with
its seed, and the exit status is 1.
"""

from __future__ import annotations

import argparse
import random
import sys
import time

from random_chains import largest_difference, random_chain

from dh2urdf.manipulator import Convention, JointType
from dh2urdf_plugins.extraction.solving import Choices, solve

LARGEST = 1e-12
"""Difference of the poses over the arm's size, 1 m at least."""


def main() -> int:
    """Make the chains and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--chains", type=int, default=1000, help="how many chains are made")
    parser.add_argument("--seed", default="0", help="the first word of each chain's seed")
    asked = parser.parse_args()
    worst, far, split, seconds = 0.0, 0, 0, 0.0
    for number in range(asked.chains):
        seed = f"{asked.seed}.{number}"
        draw = random.Random(seed)
        joints = random_chain(draw)
        for convention in Convention:
            started = time.perf_counter()
            solution = solve(joints, Choices(convention=convention, tolerance=1e-12))
            seconds += time.perf_counter() - started
            error = largest_difference(joints, solution.table, draw) / max(1.0, solution.length)
            worst = max(worst, error)
            split += any(row.type is JointType.FIXED for row in solution.table.rows)
            if not error <= LARGEST:
                far += 1
                print(f"chain {seed}, {convention}: {error:.3g} of the arm's size")
    tables = 2 * asked.chains
    print(
        f"{asked.chains} chains, {tables} tables: worst {worst:.2g} of the arm's size, {far} beyond {LARGEST:g}; "
        f"{100 * split / tables:.1f} % with a fixed row; {1000 * seconds / tables:.1f} ms each"
    )
    return 1 if far else 0


if __name__ == "__main__":
    sys.exit(main())
