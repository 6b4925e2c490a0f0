"""Sides that take turns, child processes with their memory, and tables in Markdown, for benchmarks."""

from __future__ import annotations

import gc
import importlib.metadata
import os
import platform
import subprocess
import time
from collections import defaultdict
from contextlib import suppress
from itertools import count
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

POLL = 0.1
"""How often the memory of child processes is looked at [s]."""

_folders = count()


class Turn(NamedTuple):
    """A side's turn.

    Attributes:
        seconds: how long it took [s].
        value: what it returned.
    """

    seconds: float
    value: Any


def fresh(place: Path) -> Path:
    """An empty folder that nobody has used before."""
    folder = place / f"{next(_folders):04d}"
    folder.mkdir()
    return folder


def in_turn(sides: Mapping[str, Callable[[Path], Any]], rounds: int, place: Path) -> dict[str, list[Turn]]:
    """Every side once in each round, each round beginning with the next one, so that what else the machine does, and
    what the side before has left to do for the disk, falls on all.

    Each gets a new folder. Nothing is deleted: ext4 is slow for a while after many files have gone.
    """
    names = list(sides)
    turns: dict[str, list[Turn]] = {name: [] for name in names}
    for number in range(rounds):
        first = number % len(names)
        for name in names[first:] + names[:first]:
            folder = fresh(place)
            gc.collect()
            os.sync()
            started = time.perf_counter()
            value = sides[name](folder)
            turns[name].append(Turn(time.perf_counter() - started, value))
    return turns


def seconds(turns: Sequence[Turn]) -> float:
    """The median of how long turns took [s]."""
    return median(turn.seconds for turn in turns)


# --- Child processes


class Child(NamedTuple):
    """A command that has ended.

    Attributes:
        seconds: how long it took, its start included [s].
        memory: the peaks of its processes, added up [byte].
    """

    seconds: float
    memory: int


def run_child(command: Sequence[str | Path]) -> Child:
    """Run a command, and watch the memory of all its processes."""
    peaks: dict[int, int] = defaultdict(int)
    os.sync()
    started = time.perf_counter()
    with subprocess.Popen(command) as process:
        while process.poll() is None:
            for number in _tree(process.pid):
                peaks[number] = max(peaks[number], _peak(number))
            with suppress(subprocess.TimeoutExpired):
                process.wait(POLL)
        taken = time.perf_counter() - started
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command)
    return Child(taken, sum(peaks.values()))


def _tree(process: int) -> list[int]:
    """A process and all that descend from it."""
    found = [process]
    for parent in found:
        for path in Path(f"/proc/{parent}/task").glob("*/children"):
            with suppress(OSError):
                found += map(int, path.read_text().split())
    return found


def _peak(process: int) -> int:
    """The most memory that a process had in use at once, so far [byte]."""
    with suppress(OSError):
        for line in Path(f"/proc/{process}/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return 1024 * int(line.split()[1])
    return 0


# --- What is printed


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table in Markdown, texts to the left and figures to the right."""
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    rule = ["-" * widths[0], *["-" * (width - 1) + ":" for width in widths[1:]]]
    for cells in (header, rule, *rows):
        first, *others = zip(cells, widths, strict=True)
        print("|", " | ".join([first[0].ljust(first[1]), *[cell.rjust(width) for cell, width in others]]), "|")
    print(flush=True)


def machine(place: Path, packages: Sequence[str]) -> str:
    """What a script runs on, and with which versions."""
    versions = []
    for name in packages:
        with suppress(importlib.metadata.PackageNotFoundError):
            versions.append(f"{name} {importlib.metadata.version(name)}")
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    load, *_ = os.getloadavg()
    return (
        f"{_processor()}, {len(os.sched_getaffinity(0))} cores, {memory / 2**30:.0f} GiB, {_file_system(place)}, "
        f"{platform.system()} {platform.release()}, load before {load:.2f}; Python {platform.python_version()}, "
        + ", ".join(versions)
    )


def _processor() -> str:
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.machine()


def _file_system(place: Path) -> str:
    """The kind of file system that a folder is on."""
    mounts = [line.split()[1:3] for line in Path("/proc/mounts").read_text().splitlines()]
    above = [(len(point), number, kind) for number, (point, kind) in enumerate(mounts) if _is_below(place, point)]
    return max(above)[2]


def _is_below(place: Path, point: str) -> bool:
    return place.resolve().is_relative_to(point)
