"""Python in a process of its own, for programs and tests that are part of a test."""

import os
import subprocess
import sys
from pathlib import Path

ADDOPTS = "-p no:anyio -p no:hypothesispytest"
"""PYTEST_ADDOPTS of a pytest there: without plugins of this project's own tests, a third of a second of each process."""


def python(
    *words: str | Path, folder: Path, path: tuple[Path, ...] = (), **environment: str
) -> subprocess.CompletedProcess[str]:
    """What Python answers in a folder, whatever its exit status, with more of a search path and environment."""
    inherited = os.environ.get("PYTHONPATH", "")
    environment["PYTHONPATH"] = os.pathsep.join([*map(str, path), *filter(None, [inherited])])
    return subprocess.run(
        [sys.executable, *map(str, words)],
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
        timeout=600,
    )
