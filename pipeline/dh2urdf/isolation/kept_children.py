"""Children that are kept for further calls: of a run's loads, of the programs that `check` asks, of the studio."""

from __future__ import annotations

import os
import threading
import weakref
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from dh2urdf.isolation.child_process import PLAIN, Child, pickled_call

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Self

    from dh2urdf.isolation.encodings import Data


class KeptChildren:
    """The children of a process, by what they have prepared: a context that ends all of them.

    Several threads may use them: a child serves one caller at a time. A copy in another process begins without any.
    """

    def __init__(self) -> None:
        self._idle: dict[bytes, list[Child]] = {}
        self._busy: set[Child] = set()
        self._changing = threading.Lock()
        weakref.finalize(self, _end_all, self._idle, os.getpid())

    def __reduce__(self) -> tuple[type[KeptChildren], tuple[()]]:
        return KeptChildren, ()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def end(self) -> None:
        """End all children; one at work is killed, so that its caller gets an error."""
        with self._changing:
            for child in self._busy:
                child.kill()  # Its caller ends it: two at once would close what the other one reads.
            _end_all(self._idle, os.getpid())

    @contextmanager
    def child(
        self,
        who: str,
        prepare: Callable[..., Any] | None = None,
        args: tuple[Any, ...] = (),
        timeout: float | None = None,
        encoding: Data[Any] = PLAIN,
    ) -> Iterator[Child]:
        """A child that is the caller's for a while, and has called a function, such as one that imports a simulator.

        What the function printed is part of the output of each later call. A child that cannot be called any more at
        the end is ended; any other is kept.

        Raises:
            CrashError: as `dh2urdf.isolation.child_process.run_in_child`; so is whatever the function raises.
        """
        key = pickled_call(prepare, args, who) if prepare else b""
        child = self._taken(key)
        try:
            if child.prepared is None:
                child.prepared = (child.call(prepare, args, timeout, who, encoding).value if prepare else None,)
                child.printed_before = child.output.text()
            yield child
        finally:
            with self._changing:
                self._busy.discard(child)
                is_kept = child.prepared is not None and child.is_alive()
                if is_kept:
                    self._idle.setdefault(key, []).append(child)
            if not is_kept:
                child.end()

    def _taken(self, key: bytes) -> Child:
        """A child that has nothing to do; a new one, where there is none."""
        while True:
            with self._changing:
                idle = self._idle.get(key)
                child = idle.pop() if idle else None
            if child is None:
                child = Child.started()
            elif not child.is_alive():
                child.end()
                continue
            with self._changing:
                self._busy.add(child)
            return child


def _end_all(idle: dict[bytes, list[Child]], owner: int) -> None:
    if os.getpid() == owner:  # A process that was forked off has copies of them, which are not its own to end.
        for child in [child for children in idle.values() for child in children]:
            child.end()
    idle.clear()
