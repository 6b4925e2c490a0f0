"""sdformat, called as its command `gz sdf` calls it: a program of Ruby, which takes as long to start as a call takes."""

import ctypes.util
import subprocess
import sys
from pathlib import Path

import pytest

SDFORMAT = next((name for v in range(15, 11, -1) if (name := ctypes.util.find_library(f"sdformat{v}"))), None)
FUNCTIONS = {"--check": "cmdCheck", "--print": "cmdPrint"}
CALL = "import ctypes, sys; sys.exit(ctypes.CDLL(sys.argv[1])[sys.argv[2]](sys.argv[3].encode()))"


def sdformat(option: str, path: Path) -> str:
    """What it prints in a process of its own. A word on standard error is a failure; without sdformat the test is skipped."""
    if SDFORMAT is None:
        pytest.skip("sdformat is not installed (Debian: libsdformat-dev)")
    command = [sys.executable, "-S", "-c", CALL, SDFORMAT, FUNCTIONS[option], str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout + done.stderr
    return done.stdout
