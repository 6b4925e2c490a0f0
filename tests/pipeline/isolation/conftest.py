"""Functions for child processes, and whether a process runs."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

LONG = 60.0


@pytest.fixture
def functions(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The module `isolated_functions`, which a child can import."""
    monkeypatch.syspath_prepend(Path(__file__).parent)
    import isolated_functions

    return isolated_functions


@pytest.fixture
def is_running() -> Callable[[int], bool]:
    """Whether a process runs; one that nobody has waited for yet does not."""

    def ask(pid: int) -> bool:
        try:
            if Path("/proc/self/stat").exists():
                return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
            os.kill(pid, 0)
        except (FileNotFoundError, ProcessLookupError):
            return False
        return True

    return ask


@pytest.fixture
def soon() -> Callable[[Callable[[], Any]], bool]:
    """Whether a condition comes true within a time that is long enough for any machine."""

    def wait(condition: Callable[[], Any]) -> bool:
        end = time.monotonic() + LONG
        while not (true := condition()) and time.monotonic() < end:
            time.sleep(0.02)
        return bool(true)

    return wait
