"""Handing tasks over in their order, a few ahead of the result that is waited for."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

T = TypeVar("T")
P = TypeVar("P")


def handed_over(tasks: Iterable[T], hand_over: Callable[[T], P], ahead: Callable[[], int]) -> Iterator[P]:
    """What is to be waited for, a promise for each task, in the order of the tasks.

    So many tasks as `ahead` says are handed over and not waited for yet; no more are taken, so that a run of any length
    is never held. An error of the tasks themselves is raised after the promises of the tasks before it.
    """
    waiting = iter(tasks)
    promises: deque[P] = deque()
    error: Exception | None = None
    while True:
        while error is None and len(promises) < ahead():
            try:
                promises.append(hand_over(next(waiting)))
            except Exception as raised:  # noqa: BLE001 - raised when its turn comes
                error = raised
        if not promises:
            break
        yield promises.popleft()
    if error is not None and not isinstance(error, StopIteration):
        raise error
