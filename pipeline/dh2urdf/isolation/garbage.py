"""Python's garbage collector, kept from looking through millions of records that are no garbage.

A run makes and drops records by the thousand. Nearly all of them go when nobody refers to them any more; only what
refers to itself in a circle, such as an error and its traceback, waits for the collector, which looks through all that
is alive to find it: a tenth of the time of a run. It is enough to do so when a batch is done.
"""

from __future__ import annotations

import gc
from contextlib import contextmanager
from typing import TYPE_CHECKING

from dh2urdf.isolation.own_process import is_own

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def collected_at_the_end() -> Iterator[None]:
    """Keeps the collector away, and calls it for what is new at the end; in a process of our own alone."""
    if not (is_own() and gc.isenabled()):  # The caller that keeps it away will call it.
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
        gc.collect(0)
