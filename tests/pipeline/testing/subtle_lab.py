"""Stages whose faults are easily overlooked, in a module that child processes can import."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Any

import bad_lab
import subtle_helper

from dh2urdf.errors import TableError
from dh2urdf.hookspecs import hookimpl
from dh2urdf.source import Problem
from dh2urdf.stages import EmittedFile, Loader, Rejected, Requires

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from dh2urdf.robot import Robot

SLEEP = (sys.executable, "-c", "import time; time.sleep(61)")


def by_hash() -> list[Problem]:
    """Problems in the order of a set."""
    names = {"a", "alpha", "d", "theta", "offset", "sign"}
    return [Problem(message=f"{name} is missing") for name in names]


# --- Readers


def read_and_reject(path: Path, options: Any) -> Iterator[Any]:
    try:
        yield from bad_lab.read(path, options)
    except TableError:
        yield Rejected(name="bent", problems=tuple(by_hash()))


# --- Emitters


def emit_and_move(robot: Robot, stem: str, options: Any) -> list[EmittedFile]:
    os.chdir("..")
    return bad_lab.emit(robot, stem, options)


def emit_and_watch(robot: Robot, stem: str, options: Any) -> list[EmittedFile]:
    threading.Thread(target=threading.Event().wait, name="watcher", daemon=True).start()
    return bad_lab.emit(robot, stem, options)


def emit_one_by_one(robot: Robot, stem: str, options: Any) -> Iterator[EmittedFile]:
    yield from bad_lab.emit(robot, stem, options)


def emit_lambdas(robot: Robot, stem: str, options: Any) -> list[Any]:
    return [*bad_lab.emit(robot, stem, options), lambda: robot]


def emit_sorted(robot: Robot, stem: str, options: Any) -> list[EmittedFile]:
    """Sorts what it is given in place: who is given it again finds nothing to sort."""
    object.__setattr__(robot, "links", tuple(sorted(robot.links, key=lambda link: link.name)))
    return bad_lab.emit(robot, stem, options)


# --- Loaders


def load_and_forget(request: Any, options: Any) -> Any:
    subprocess.Popen(SLEEP, env={}, start_new_session=True)
    return bad_lab.load(request, options)


def load_and_log(request: Any, options: Any) -> Any:
    with open("simulator.log", "w") as log:  # noqa: PTH123 - as authors do
        log.write("started")
    return bad_lab.load(request, options)


def require(_options: Any) -> None:
    subtle_helper.require()


HEAVY = Loader(
    name="heavy",
    summary="imports numpy in a helper of its module",
    open=bad_lab.load,
    options=bad_lab.Three,
    capabilities=(Requires(require),),
)


@hookimpl
def dh2urdf_loaders() -> Any:
    return (HEAVY,)


# --- Executors


def whoever_is_done(function: Any, tasks: Any, _options: Any) -> Iterator[Any]:
    """Few tasks ahead, and the results as they come."""
    upcoming = iter(tasks)
    with ThreadPoolExecutor(4) as pool:
        under_way = [pool.submit(function, task) for task in islice(upcoming, 8)]
        while under_way:
            done = next((future for future in under_way if future.done()), None)
            if done is None:
                time.sleep(0.001)
                continue
            under_way.remove(done)
            yield done.result()
            under_way += [pool.submit(function, task) for task in islice(upcoming, 1)]


def in_spawned_processes(function: Any, tasks: Any, _options: Any) -> Iterator[Any]:
    """A good one, as far as nobody's process ends: Python keeps a helper for its processes."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        for task in tasks:
            yield pool.submit(function, task).result()


SPAWNING = replace(bad_lab.EXECUTOR, map=in_spawned_processes)
