"""The executor `threads`: the work of a run on threads of its own process, by `concurrent.futures`."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Literal

from dh2urdf.stages import Executor


@dataclass(frozen=True, slots=True, kw_only=True)
class ThreadsOptions:
    """How many threads work."""

    workers: Literal["auto"] | int = field(default="auto", metadata={"help": "threads; auto takes one per processor"})

    def __post_init__(self) -> None:
        if self.workers != "auto" and self.workers < 1:
            raise ValueError("workers is a number from 1 on, or auto")


def pool(options: ThreadsOptions) -> ThreadPoolExecutor:
    """The threads. dh2urdf submits a few tasks ahead, and orders what comes of them."""
    workers = os.cpu_count() if options.workers == "auto" else options.workers
    return ThreadPoolExecutor(workers, thread_name_prefix="dh2urdf")


EXECUTOR = Executor(name="threads", summary="threads of this process", options=ThreadsOptions, pool=pool)
