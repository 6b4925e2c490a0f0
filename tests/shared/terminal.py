"""Commands on a terminal."""

import os
import subprocess
import sys
from pathlib import Path

import pytest


def on_a_terminal(
    folder: Path, *words: str, before: str = "", columns: int = 120, stdout: bool = True
) -> tuple[int, str, str]:
    """Exit status of a command, its standard output where that is no terminal, and what the terminal shows."""
    pty = pytest.importorskip("pty")
    terminal, its_end = pty.openpty()
    with subprocess.Popen(
        [sys.executable, "-c", f"{before}\nfrom dh2urdf.cli import main; main()", *words],
        cwd=folder,
        env={**os.environ, "TERM": "xterm", "COLUMNS": str(columns)},
        stdout=its_end if stdout else subprocess.PIPE,
        stderr=its_end,
    ) as process:
        os.close(its_end)
        shown = b""
        try:
            while chunk := os.read(terminal, 1 << 16):
                shown += chunk
        except OSError:  # the other end is closed
            pass
        os.close(terminal)
        printed = process.communicate()[0] or b""
    return process.returncode, printed.decode(), shown.decode()
