"""The proof alone: both ways from base_link to tool0, walked at 35 joint vectors, and compared.

No file is read or written: what the transform makes of a table is held against the table. Each figure is the least of
several rounds. With `--against`, another checkout is measured too, in processes that take turns with ours.

    python benchmarks/proof.py
    python benchmarks/proof.py --against ../dh2urdf-before
"""

from __future__ import annotations

import argparse
import inspect
import json
import os
import random
import subprocess
import sys
import time
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from arms import HALF_PI, TWISTS
from measuring import machine, table

from dh2urdf.columns import in_columns
from dh2urdf.kinematics import KinematicChain, forward_kinematics
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.kinematics.proof import prove
from dh2urdf.manipulator import Convention, DHRow, Manipulator
from dh2urdf.plugin_system.catalog import load
from dh2urdf.plugin_system.options import make_options
from dh2urdf.stages import TransformsInColumns

if TYPE_CHECKING:
    from collections.abc import Callable

RANDOM = 32
"""Random joint vectors of a proof, besides zero and both ends of the limits."""
MANY = 1024
LENGTHS = ((0.0, 0.089), (-0.425, 0.0), (-0.392, 0.0), (0.0, 0.109), (0.0, 0.095), (0.0, 0.082))
"""a and d of a UR5 [m]."""

TRANSFORM = load().get("transform", "alpha-swap")
OPTIONS = make_options(TRANSFORM.options, {}, mark=None, where="")


def of_older(name: str, *modules: str) -> Callable[..., Any]:
    """A function that other checkouts may have in another module."""
    for module in modules:
        with suppress(ImportError):
            if found := getattr(import_module(f"dh2urdf.kinematics.{module}"), name, None):
                return cast("Callable[..., Any]", found)
    raise ImportError(f"no {name} in {', '.join(modules)}")


prove_columns = of_older("prove_columns", "proof", "proof_columns")
proof_vectors = of_older("proof_vectors", "expected_poses", "proof_vectors", "proof")
TOGETHER = {"at_once": True} if "at_once" in inspect.signature(prove).parameters else {}


def arm(
    name: str, draw: random.Random, *, axes: int = 6, lengths: bool = False, all_numbers: bool = False
) -> Manipulator:
    """An arm like a UR5.

    Args:
        name: its name.
        draw: gives its numbers.
        axes: how many joints.
        lengths: whether the lengths that are not 0 are its own.
        all_numbers: whether every number is.
    """

    def row(number: int) -> DHRow:
        a, d = LENGTHS[number % 6]
        alpha, theta = TWISTS[number % 6], 0.0
        if lengths:
            a, d = a * draw.uniform(0.8, 1.2), d * draw.uniform(0.8, 1.2)
        if all_numbers:
            a, d, alpha, theta = (
                draw.uniform(0.1, 0.5),
                draw.uniform(0.1, 0.5),
                draw.uniform(-2, 2),
                draw.uniform(-2, 2),
            )
        return DHRow(joint=f"joint_{number}", link=f"link_{number}", a=a, alpha=alpha, d=d, theta=theta)

    return Manipulator(name=name, convention=Convention.STANDARD, rows=tuple(map(row, range(axes))))


def least(function: Callable[[], object], rounds: int) -> float:
    """The least time of some rounds, after one that is not counted [s]."""
    taken = []
    for _ in range(rounds + 1):
        started = time.perf_counter()
        function()
        taken.append(time.perf_counter() - started)
    return min(taken[1:])


def of_columns(members: int, rounds: int, **kind: bool) -> float:
    """Seconds for each of some arms that are proved side by side."""
    draw = random.Random(1)
    [(_, tables)] = in_columns([arm(f"arm_{number}", draw, **kind) for number in range(members)])
    total = 0.0
    for places, robots in TRANSFORM.can(TransformsInColumns).transform_columns(tables, OPTIONS):
        some = tables.take(places)
        written = [(range(len(places)), robots.robot)]
        for proof in prove_columns(some, robots, written, RANDOM):
            if not proof.holds:
                raise ValueError(f"not proved: {proof}")
        total += least(lambda a=some, b=robots, c=written: prove_columns(a, b, c, RANDOM), rounds)
    return total / members


def of_one(rounds: int, *, axes: int = 6, all_numbers: bool = False, **how: bool) -> float:
    """Seconds for the proof of an arm that is made by itself."""
    one = arm("arm", random.Random(2), axes=axes, all_numbers=all_numbers)
    robot, expected = TRANSFORM.transform(one, OPTIONS), ExpectedPoses.of(one)
    poses = proof_vectors(expected, robot, RANDOM)
    if not prove(expected, robot, poses, **how).holds:
        raise ValueError("not proved")
    return least(lambda: prove(expected, robot, poses, **how), rounds)


def of_a_pose(rounds: int) -> tuple[float, float]:
    """Seconds of one T(q) of a table, and of a chain of joints that is compiled."""
    one, q = arm("arm", random.Random(3)), [0.1, 0.2, 0.3, HALF_PI, 0.5, 0.6]
    chain = KinematicChain.between(TRANSFORM.transform(one, OPTIONS))

    def of_tables() -> None:
        for _ in range(100):
            forward_kinematics(one, q)

    def of_chains() -> None:
        for _ in range(100):
            chain.forward_kinematics(q)

    return least(of_tables, rounds) / 100, least(of_chains, rounds) / 100


def measure(rounds: int) -> dict[str, float]:
    """All figures of this checkout [µs]."""
    of_table, of_chain = of_a_pose(rounds)
    found = {
        f"{MANY} UR5 with other lengths side by side, each": of_columns(MANY, rounds, lengths=True),
        f"{MANY} arms with all numbers different side by side, each": of_columns(MANY, rounds, all_numbers=True),
        "a group of one, all numbers its own": of_columns(1, 10 * rounds, all_numbers=True),
        "a UR5 without numpy": of_one(rounds),
        "an arm of general numbers without numpy": of_one(rounds, all_numbers=True),
        "a UR5 by itself in a run": of_one(10 * rounds, **TOGETHER),
        "60 axes by themselves in a run, each joint": of_one(rounds, axes=60, **TOGETHER) / 60,
        "60 general axes by themselves in a run, each joint": of_one(rounds, axes=60, all_numbers=True, **TOGETHER)
        / 60,
        "T(q) of a UR5's table, once": of_table,
        "T(q) of its chain of joints": of_chain,
    }
    return {name: 1e6 * seconds for name, seconds in found.items()}


def of_checkout(folder: Path, rounds: int) -> dict[str, float]:
    """All figures of a checkout, in a process of its own [µs]."""
    path = os.pathsep.join(str(folder / part) for part in ("pipeline", "plugins"))
    command = [sys.executable, __file__, "--measure", "--rounds", str(rounds)]
    out = subprocess.run(command, env={**os.environ, "PYTHONPATH": path}, check=True, capture_output=True)
    found: dict[str, float] = json.loads(out.stdout)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--turns", type=int, default=3, help="processes of each checkout")
    parser.add_argument("--against", type=Path, help="another checkout")
    parser.add_argument("--measure", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.measure:
        print(json.dumps(measure(given.rounds)))
        return
    here = Path(__file__).resolve().parents[1]
    print(machine(here, ["dh2urdf", "numpy"]), "\n")
    checkouts = [here] if given.against is None else [given.against.resolve(), here]
    turns = [[of_checkout(folder, given.rounds) for folder in checkouts] for _ in range(given.turns)]
    rows = []
    for name in turns[0][0]:
        best = [min(turn[place][name] for turn in turns) for place in range(len(checkouts))]
        rows.append(
            [
                name,
                *(f"{microseconds:.1f}" for microseconds in best),
                *([f"{best[1] / best[0]:.2f}"] if best[1:] else []),
            ]
        )
    table(["[µs]", *(["before", "after", "ratio"] if given.against else ["proof"])], rows)


if __name__ == "__main__":
    main()
