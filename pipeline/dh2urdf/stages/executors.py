"""The record of an executor, and what it gives for a task without a result."""

# ruff: noqa: TC004 - nobody asks for the types of these records' fields

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeAlias

from dh2urdf.stages import O, Requires, Usual, _Capable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from contextlib import AbstractContextManager
    from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
class Lost:
    """A task that ended the process which worked at it, and so has no result.

    Attributes:
        reason: what is known of its end, as the end of a sentence: ``the worker crashed (segmentation fault)``.
    """

    reason: str


ExecutorCapability: TypeAlias = Requires | Usual
"""What else an executor can do."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Executor(_Capable, Generic[O]):
    """Runs the pipeline over many manipulators.

    Attributes:
        name: the stage's name in a run file.
        summary: where the work is done, in one line.
        options: its options dataclass.
        map: results of a picklable function over tasks, in the order of the tasks, taking tasks as they are needed. A
            worker that ends costs no result but that of a task which ends every worker it is given to: it gives `Lost`
            in its place, and the others go on. What the function raises is raised after the results before it.
            The function of a run has an attribute ``distributions``: the names of those whose stages it uses, which a
            worker on another machine has to have in the same versions. None where `pool` is given.
        pool: a context manager whose `submit(function, task)` gives a future, as every Executor of concurrent.futures
            has it: then order, errors, and tasks that end a worker (`concurrent.futures.BrokenExecutor`) are dh2urdf's
            work. The field ``workers`` of the options, where it is a number, says how many tasks are submitted ahead.
        capabilities: what else it can do, of `ExecutorCapability`.
    """

    name: str
    summary: str
    options: type[O]
    map: Callable[[Callable[[Any], Any], Iterable[Any], O], Iterator[Any]] | None = None
    pool: Callable[[O], AbstractContextManager[Any]] | None = None
    capabilities: tuple[ExecutorCapability, ...] = ()
