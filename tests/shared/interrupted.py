"""An interrupt at every step of some work."""

import sys
from collections.abc import Callable, Iterator
from typing import Any


def at_every_step(work: "Callable[[], object]", most: int = 1000) -> "Iterator[bool]":
    """Do the work again and again, interrupted at its first line, its second, and so on until it ends uninterrupted.

    Each time it gives whether KeyboardInterrupt came out of the work.
    """
    for step in range(1, most):
        seen = 0

        def stop(_frame: Any, event: str, _argument: Any) -> Any:
            nonlocal seen
            if event == "line":
                seen += 1
                if seen == step:  # noqa: B023 - it is called in this round alone
                    sys.settrace(None)
                    raise KeyboardInterrupt
            return stop

        interrupted = False
        sys.settrace(stop)
        try:
            work()
        except KeyboardInterrupt:
            interrupted = True
        finally:
            sys.settrace(None)
        yield interrupted
        if seen < step:
            return
