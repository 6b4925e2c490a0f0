"""Runs of many manipulators, against what the same machine takes for parts of the work by other means.

    python benchmarks/batches.py                          all sections but `million`, at a tenth of the full size
    python benchmarks/batches.py --scale 1 files shards   some sections, at full size

All sides of a section take turns in one run, on one file system, and the result is printed as Markdown. The arms have
six axes, cylinders as visuals and collisions, and inertials, and no two are alike: "one form" says that they differ in
numbers only, "mixed forms" that a tenth of their twists is oblique and some links are short, so that their files have
different elements too.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import itertools
import os
import shutil
import sys
import tarfile
import tempfile
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from itertools import repeat
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any, TypeAlias

import orjson
import yaml
from arms import LONG, SHORT, Lengths, write_table
from measuring import Child, fresh, in_turn, machine, run_child, seconds, table

from dh2urdf.output.layouts import DEFAULT_SIZE as SHARD, writing_shard
from dh2urdf.output.store import LocalStore
from dh2urdf.plugin_system.catalog import load
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import Plan, make_plan
from dh2urdf.running.run import execute

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from measuring import Turn

    from dh2urdf.tasks.batch_report import Result

Files: TypeAlias = list[tuple[str, bytes]]
"""Names and contents."""
Side: TypeAlias = "Callable[[Path], Any]"
"""Does its work into a folder."""

PACKAGES = ("dh2urdf", "numpy", "orjson", "lxml", "pyarrow", "urdf-parser-py", "yourdfpy", "xacro")
FORMS = {"one form": LONG, "mixed forms": None}
NO_PROOF = ("proof.first=0", "proof.every=1000000000")
"""Settings with which one file of a run is proved, the first one."""
NO_PAGE = "report.html=false"
"""The page for people: a second or so, however long a run is."""
COMMAND = Path(sys.executable).parent / "dh2urdf"


@dataclass(frozen=True, slots=True, kw_only=True)
class Bench:
    """What all sections share.

    Attributes:
        place: a folder for everything, on the file system that is measured.
        scale: the part of the full size that is done.
        rounds: how often each side has its turn.
    """

    place: Path
    scale: float
    rounds: int

    def count(self, full: int, least: int = 1) -> int:
        """A number of manipulators."""
        return max(least, round(full * self.scale))

    def csv_run(self, robots: int, *, axes: int = 6, lengths: Lengths | None = LONG, emitter: str = "urdf") -> Path:
        """A run file for a CSV file of that many robots."""
        folder = fresh(self.place)
        write_table(folder / "arms.csv", robots, axes=axes, lengths=lengths)
        inputs = {"path": "arms.csv", "options": {"convention": "standard"}}
        return _run_file(folder, {"inputs": inputs, "emitters": [{"stage": emitter}]})

    def variations_run(self, robots: int) -> Path:
        """A run file for one manipulator and its variants, that many together."""
        folder = fresh(self.place)
        write_table(folder / "arms.csv", 1, lengths=LONG)
        vary = [
            {"joints": "all", "field": "a", "scale": [0.8, 1.2]},
            {"joints": "all", "field": "d", "scale": [0.8, 1.2]},
            {"joints": "all", "field": "mass", "uniform": [1, 5]},
        ]
        variation = {"of": "arm_0", "count": robots - 1, "seed": 7, "vary": vary}
        inputs = {"path": "arms.csv", "options": {"convention": "standard"}}
        return _run_file(folder, {"inputs": inputs, "variations": [variation]})


def _run_file(folder: Path, content: dict[str, Any]) -> Path:
    path = folder / "run.yaml"
    path.write_text(yaml.safe_dump({**content, "output": {"directory": "out"}}), encoding="utf-8")
    return path


# --- Sides


def chain(run_file: Path, robots: int, *settings: str) -> Callable[[Path], Result]:
    """Does a run in this process, into a given folder."""
    plan = make_plan(load_config(run_file, ["execution.options.workers=1", NO_PAGE, *settings]), load())
    return partial(_execute, plan, robots)


def _execute(plan: Plan, robots: int, folder: Path) -> Result:
    result, _ = execute(replace(plan, store=LocalStore(folder)))
    if result.statuses != Counter(ok=robots):
        raise ValueError(f"of {robots} robots became {result.statuses}")
    return result


def read_files(folder: Path) -> Files:
    """The descriptions that a run wrote, in the order of its manifest."""
    with (folder / "manifest.jsonl").open("rb") as rows:
        names = [file["path"] for row in rows for file in orjson.loads(row)["files"]]
    return [(name, (folder / name).read_bytes()) for name in names]


def write_files(files: Files, folder: Path) -> None:
    """Write files, each under a temporary name first."""
    temporary = folder / "temporary"
    temporary.mkdir()
    for number, (name, content) in enumerate(files):
        path = f"{temporary}/{number}"
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
        os.write(descriptor, content)
        os.close(descriptor)
        os.rename(path, f"{folder}/{name}")  # noqa: PTH104 - nothing but the calls of the system


def write_shards(files: Files, folder: Path) -> None:
    """Write files into tar shards, as a run does."""
    store = LocalStore(folder)
    for first in range(0, len(files), SHARD):
        with writing_shard(store, f"{first // SHARD:06d}.tar") as add:
            for name, content in files[first : first + SHARD]:
                add(name, content)


def write_tars(files: Files, folder: Path) -> None:
    """Write files into tar shards with Python's own module."""
    for first in range(0, len(files), SHARD):
        temporary = folder / "temporary"
        with tarfile.open(temporary, "w") as shard:
            for name, content in files[first : first + SHARD]:
                info = tarfile.TarInfo(name)
                info.size = len(content)
                shard.addfile(info, io.BytesIO(content))
        temporary.rename(folder / f"{first // SHARD:06d}.tar")


# --- Sections


def files(bench: Bench) -> None:
    """One URDF for each robot, one worker in this process."""
    robots = bench.count(10_000)
    print("Whole: read the CSV file, transform, write one URDF per robot atomically, hash, manifest (JSON Lines and")
    print(
        "Parquet), index and report. Only written: the same bytes into as many files, under a temporary name first.\n"
    )
    for form, lengths in FORMS.items():
        run_file = bench.csv_run(robots, lengths=lengths)
        first = fresh(bench.place)
        chain(run_file, robots, *NO_PROOF)(first)
        contents = read_files(first)
        sides: dict[str, Side] = {
            "only written": partial(write_files, contents),
            "whole, without the proof": chain(run_file, robots, *NO_PROOF),
            "whole, all proved": chain(run_file, robots),
        }
        turns = in_turn(sides, bench.rounds, bench.place)
        _print_chain(
            f"{robots:,} files, {form}", turns, robots, contents, bounds={"whole, without the proof": "≤ 4 (2)"}
        )


def shards(bench: Bench) -> None:
    """The same robots into tar shards of 1,000, one worker in this process."""
    robots = bench.count(10_000)
    print("Only written: the same bytes into as many tar files, with the writer of a run and with `tarfile`.\n")
    for form, lengths in FORMS.items():
        run_file = bench.csv_run(robots, lengths=lengths)
        first = fresh(bench.place)
        chain(run_file, robots, *NO_PROOF)(first)
        contents = read_files(first)
        sides: dict[str, Side] = {
            "only written": partial(write_shards, contents),
            "only written, tarfile": partial(write_tars, contents),
            "whole, without the proof": chain(run_file, robots, *NO_PROOF, "output.layout=shards"),
            "whole, all proved": chain(run_file, robots, "output.layout=shards"),
        }
        turns = in_turn(sides, bench.rounds, bench.place)
        _print_chain(f"{robots:,} robots in shards, {form}", turns, robots, contents, bounds={})


def _print_chain(
    title: str, turns: dict[str, list[Turn]], robots: int, contents: Files, *, bounds: dict[str, str]
) -> None:
    """A table of sides whose first one only writes and whose last one is a run that proves everything."""
    unit = seconds(turns["only written"])
    steps = {step: median(turn.value.seconds[step] for turn in turns["whole, all proved"]) for step in STEPS}
    times = {name: seconds(turn) for name, turn in turns.items()}
    times["the proof by itself"] = steps["prove"]
    bounds = {"the proof by itself": "(1)", **bounds} if bounds else {}
    size = sum(len(content) for _, content in contents)
    print(f"{title}, {size / robots / 1000:.1f} kB each; median of {len(turns['only written'])}:\n")
    rows = [
        (name, f"{taken:.3f}", *_each(taken, robots), f"{taken / unit:.2f}", bounds.get(name, ""))
        for name, taken in times.items()
    ]
    table(("", "s", "µs per robot", "robots/s", "× only written", "bound (aim)"), rows)
    rest = times["whole, all proved"] - sum(steps.values())
    parts = ", ".join(f"{step} {1e6 * taken / robots:.1f}" for step, taken in {**steps, "the rest": rest}.items())
    print(
        f"The steps of the last run, in µs per robot: {parts}. (The rest: reading, columns, keys, manifest, reports.)\n"
    )


STEPS = ("transform", "emit", "prove", "write")


def _each(taken: float, robots: int) -> tuple[str, str]:
    return f"{1e6 * taken / robots:.1f}", f"{robots / taken:,.0f}"


def serialisers(bench: Bench) -> None:
    """Other people's serialisers, of robots that are parsed already, against the whole of a run into tar shards."""
    import xacro
    import yourdfpy
    from urdf_parser_py.urdf import URDF

    robots, some = bench.count(10_000, 100), bench.count(200, 10)
    run_file, expanded = bench.csv_run(robots), bench.csv_run(some, emitter="xacro")
    descriptions, macros = fresh(bench.place), fresh(bench.place)
    chain(run_file, robots)(descriptions)
    chain(expanded, some)(macros)
    paths = [str(descriptions / name) for name, _ in read_files(descriptions)[:some]]
    with contextlib.redirect_stderr(io.StringIO()):  # of tags that it does not know
        of_parser_py = [URDF.from_xml_file(path) for path in paths]
    of_yourdfpy = [yourdfpy.URDF.load(path, build_scene_graph=False, load_meshes=False) for path in paths]
    calls = [str(path) for path in sorted(macros.glob("*.urdf.xacro"))]
    sides: dict[str, Side] = {
        "urdf_parser_py to_xml_string": lambda _: [robot.to_xml_string() for robot in of_parser_py],
        "yourdfpy write_xml_string": lambda _: [robot.write_xml_string() for robot in of_yourdfpy],
        "xacro, macro expanded": lambda _: [xacro.process_file(path).toprettyxml(indent="  ") for path in calls],
        "dh2urdf, whole": chain(run_file, robots, "output.layout=shards"),
        "dh2urdf, whole, without the proof": chain(run_file, robots, "output.layout=shards", *NO_PROOF),
    }
    turns = in_turn(sides, bench.rounds, bench.place)
    times = {name: seconds(turn) / (robots if "dh2urdf" in name else some) for name, turn in turns.items()}
    runs = [turn.value.seconds for turn in turns["dh2urdf, whole"]]
    times["dh2urdf, transform and emit"] = median(run["transform"] + run["emit"] for run in runs) / robots
    wholes = [name for name in times if "dh2urdf" in name]
    print(f"Robots of one form: {robots:,} of dh2urdf's, the first {some:,} of them for the others, who do not read,")
    print(f"transform or write anything; median of {bench.rounds}. Times as fast as the other: bounds are 8 for")
    print("urdf_parser_py and 3 for yourdfpy.\n")
    rows = [
        (
            name,
            f"{1e6 * taken:.0f}",
            *["" if name in wholes else f"{taken / times[whole]:.1f} ×" for whole in wholes],
        )
        for name, taken in times.items()
    ]
    table(("", "µs per robot", *[f"faster: {whole.removeprefix('dh2urdf, ')}" for whole in wholes]), rows)


def workers(bench: Bench) -> None:
    """Two workers against one, and against two processes that know nothing of each other, into tar shards."""
    sizes = bench.count(20_000, 2 * SHARD), bench.count(100_000, 10 * SHARD)
    print(f"What a run of {sizes[1]:,} takes more than one of {sizes[0]:,}, so that no start-up counts; everything is")
    print(f"proved; median of {bench.rounds}. A task is one shard or several. Apart: two commands at once, of one")
    print("worker and half the robots each. The bound is 1.7, and 0.98 of what those apart reach.\n")
    rows = []
    for source, make in {"a CSV file": bench.csv_run, "variations": bench.variations_run}.items():
        sides: dict[str, Side] = {}
        for length, size in zip(("small", "large"), sizes, strict=True):
            whole, halves = make(size), [make(size // 2) for _ in range(2)]
            sides[f"1 worker {length}"] = partial(_command, whole, 1)
            sides[f"2 workers {length}"] = partial(_command, whole, 2)
            sides[f"apart {length}"] = partial(_apart, halves)
        turns = in_turn(sides, bench.rounds, bench.place)
        taken_by = {name: median(turn.value.seconds for turn in own) for name, own in turns.items()}
        more = {way: taken_by[f"{way} large"] - taken_by[f"{way} small"] for way in ("1 worker", "2 workers", "apart")}
        rows += [
            (f"{source}, {way}", *_each(taken, sizes[1] - sizes[0]), f"{more['1 worker'] / taken:.2f}")
            for way, taken in more.items()
        ]
    table(("", "µs per robot", "robots/s", "× as fast"), rows)


def _apart(run_files: Sequence[Path], folder: Path) -> Child:
    """Runs as commands of one worker each, at the same time."""
    folders = [folder / str(number) for number, _ in enumerate(run_files)]
    started = time.perf_counter()
    with ThreadPoolExecutor(len(run_files)) as threads:
        children = list(threads.map(_command, run_files, repeat(1), folders))
    return Child(time.perf_counter() - started, sum(child.memory for child in children))


def _command(run_file: Path, number: int, folder: Path) -> Child:
    """Does a run into tar shards as a command, and removes the shards."""
    settings = ("--set", "output.layout=shards", "--set", NO_PAGE)
    child = run_child([COMMAND, "run", run_file, "-o", folder, "--workers", str(number), "-q", *settings])
    for path in folder.glob("*.tar"):
        path.unlink()
    return child


def memory(bench: Bench) -> None:
    """Peak memory and time per robot of ten times as many robots, as commands, into tar shards."""
    tiny, few, many = [bench.count(full, least) for full, least in ((2_000, SHARD), (20_000, 2 * SHARD), (200_000, 0))]
    print("The peaks of all processes, added up. Time per robot is what a run takes more than one of")
    print(f"{tiny:,} robots, by the robots more. Everything is proved. Bounds: memory 1.1, time 1.15.\n")
    rows = []
    for source, make in {"a CSV file": bench.csv_run, "variations": bench.variations_run}.items():
        run_files = [make(size) for size in (tiny, few, many)]
        for number in (1, 2):
            start, *runs = [_command(run_file, number, fresh(bench.place)) for run_file in run_files]
            each = [(run.seconds - start.seconds) / (size - tiny) for run, size in zip(runs, (few, many), strict=True)]
            for run, size, taken in zip(runs, (few, many), each, strict=True):
                cells = f"{run.memory / 2**20:.0f}", f"{run.memory / runs[0].memory:.3f}"
                label = f"{source}, {number} worker{'s'[: number - 1]}, {size:,} robots"
                rows.append((label, *cells, f"{1e6 * taken:.1f}", f"{taken / each[0]:.3f}"))
    table(("", "peak MiB", "ratio", "µs per robot", "ratio"), rows)


def axes(bench: Bench) -> None:
    """Robots of more axes, the same number of joints in all, into tar shards."""
    joints = bench.count(120_000, 60_000)
    numbers = (6, 60, 600)
    sides: dict[str, Side] = {
        f"{length} axes": chain(
            bench.csv_run(joints // length, axes=length, lengths=SHORT), joints // length, "output.layout=shards"
        )
        for length in numbers
    }
    for side in sides.values():  # What is imported for the first time is not counted.
        side(fresh(bench.place))
    turns = in_turn(sides, bench.rounds, bench.place)
    times = {length: seconds(turns[f"{length} axes"]) for length in numbers}
    print(f"{joints:,} joints in all; everything is proved; median of {bench.rounds}. Steps are in µs per joint.\n")
    rows = []
    for length, taken in times.items():
        runs = [turn.value.seconds for turn in turns[f"{length} axes"]]
        steps = {step: median(run.get(step, 0.0) for run in runs) for step in STEPS}
        steps["rest"] = taken - sum(steps.values())
        rows.append(
            (
                f"{length} axes, {joints // length:,} robots",
                f"{1e6 * taken * length / joints:.0f}",
                f"{1e6 * taken / joints:.1f}",
                f"{taken / times[numbers[0]]:.2f}",
                *[f"{1e6 * part / joints:.1f}" for part in steps.values()],
            )
        )
    table(("", "µs per robot", "µs per joint", "× 6 axes", *STEPS, "rest"), rows)


def mixed(bench: Bench) -> None:
    """The steps of runs whose files hardly have the same elements twice, each as a command of its own."""
    joints = bench.count(120_000, 12_000)
    sides: dict[str, Side] = {}
    for length, (form, lengths) in itertools.product((6, 60), FORMS.items()):
        run_file = bench.csv_run(joints // length, axes=length, lengths=lengths and SHORT)
        sides[f"{length} axes, {form}"] = partial(_steps, run_file)
    turns = in_turn(sides, bench.rounds, bench.place)
    print(f"{joints:,} joints in all; everything is proved; median of {bench.rounds}. In µs per joint.\n")
    rows = [
        (name, *[f"{1e6 * median(turn.value[step] for turn in own) / joints:.1f}" for step in STEPS])
        for name, own in turns.items()
    ]
    table(("", *STEPS), rows)


def _steps(run_file: Path, folder: Path) -> dict[str, float]:
    """How long each step takes of a run by one worker into tar shards [s]."""
    _command(run_file, 1, folder)
    steps: dict[str, float] = orjson.loads((folder / "timing.json").read_bytes())["steps"]
    return steps


def million(bench: Bench) -> None:
    """A million variations into tar shards, with as many workers as there are cores."""
    robots = bench.count(1_000_000)
    needed, free = 15_000 * robots, shutil.disk_usage(bench.place).free
    if needed > free:
        raise SystemExit(f"{robots:,} robots need {needed / 1e9:.0f} GB, and only {free / 1e9:.0f} GB are free")
    number = len(os.sched_getaffinity(0))
    run_file, folder = bench.variations_run(robots), fresh(bench.place)
    settings = ("--set", "output.layout=shards", "--set", NO_PAGE)
    child = run_child([COMMAND, "run", run_file, "-o", folder, "--workers", str(number), "-q", *settings])
    with (folder / "manifest.jsonl").open("rb") as lines:
        rows = Counter((row["status"], bool(row["proof"]["urdf"])) for row in map(orjson.loads, lines))
    shards = list(folder.glob("*.tar"))
    size = sum(path.stat().st_size for path in shards)
    facts = {
        "rows of the manifest that are ok and proved": f"{rows['ok', True]:,}",
        "other rows": f"{rows.total() - rows['ok', True]:,}",
        "shards": f"{len(shards):,}, {size / 1e9:.2f} GB",
        "time": f"{child.seconds:.0f} s",
        "robots per second": f"{robots / child.seconds:,.0f}",
        "peak memory of all processes": f"{child.memory / 2**20:.0f} MiB",
    }
    table((f"{robots:,} robots, {number} workers", ""), list(facts.items()))
    for path in shards:
        path.unlink()


SECTIONS = {
    section.__name__: section for section in (files, shards, serialisers, workers, memory, axes, mixed, million)
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sections", nargs="*", metavar="SECTION", help=", ".join(SECTIONS))
    parser.add_argument("--scale", type=float, default=0.1, help="part of the full size; 0.1 by default")
    parser.add_argument("--rounds", type=int, default=5, help="turns of each side; 5 by default")
    parser.add_argument(
        "--folder", type=Path, default=Path(tempfile.gettempdir()), help="on the file system to measure"
    )
    given = parser.parse_args()
    chosen: Sequence[str] = given.sections or [name for name in SECTIONS if name != "million"]
    if unknown := set(chosen) - set(SECTIONS):
        parser.error(f"no section is called {', '.join(sorted(unknown))}: there are {', '.join(SECTIONS)}")
    print(f"`python benchmarks/batches.py --scale {given.scale:g} --rounds {given.rounds} {' '.join(chosen)}`\n")
    print(f"{machine(given.folder, PACKAGES)}\n", flush=True)
    with tempfile.TemporaryDirectory(prefix="dh2urdf-benchmark-", dir=given.folder) as place:
        bench = Bench(place=Path(place), scale=given.scale, rounds=given.rounds)
        for name in chosen:
            print(f"### {name}\n\n{SECTIONS[name].__doc__}\n", flush=True)
            SECTIONS[name](bench)


if __name__ == "__main__":
    main()
