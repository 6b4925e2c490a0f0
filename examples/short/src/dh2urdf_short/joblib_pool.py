"""The executor `joblib`: the reusable worker processes of joblib's loky."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from dh2urdf.stages import Executor

if TYPE_CHECKING:
    from contextlib import AbstractContextManager


@dataclass(frozen=True, slots=True, kw_only=True)
class JoblibOptions:
    """How many processes work."""

    workers: int = field(default=os.cpu_count() or 1, metadata={"help": "processes; one per processor by default"})

    def __post_init__(self) -> None:
        if self.workers < 1:
            raise ValueError("workers is a number from 1 on")


def pool(options: JoblibOptions) -> AbstractContextManager[Any]:
    """The processes, which end with the run. dh2urdf orders the results, and finds the task that ended a process."""
    from joblib.externals.loky import ProcessPoolExecutor  # type: ignore[import-untyped]

    executor: AbstractContextManager[Any] = ProcessPoolExecutor(options.workers)
    return executor


EXECUTOR = Executor(name="joblib", summary="processes of joblib's loky", options=JoblibOptions, pool=pool)
