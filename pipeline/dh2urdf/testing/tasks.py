"""What the workers of an executor do in its contract tests: every worker can import this module."""

from __future__ import annotations

import os
import signal
import time
from typing import Any


def doubled(number: int) -> int:
    """Twice a number."""
    return 2 * number


def doubled_at_leisure(number: int) -> int:
    """Twice a number; every fourth takes longer than those after it."""
    time.sleep(0.0 if number % 4 else 0.03)
    return 2 * number


def reciprocal(number: int) -> float:
    """One by a number.

    Raises:
        ZeroDivisionError: the number is 0.
    """
    return 1 / number


def process_of(_task: Any) -> int:  # noqa: ANN401 - any task
    """The process that does the task."""
    return os.getpid()


def doubled_or_killed(number: int) -> int:
    """Twice a number; a negative one ends the process that works at it."""
    if number < 0:
        os.kill(os.getpid(), signal.SIGKILL if hasattr(signal, "SIGKILL") else signal.SIGTERM)
    return 2 * number
