"""urdfdom's command `check_urdf`, which reads a URDF as ROS does, as a program that is given files."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import sys
from functools import cache

from dh2urdf.errors import CrashError, LoaderError
from dh2urdf.stages import HeldRobot, Inspects, Question

COMMAND = "check_urdf"
_LINK = re.compile(r"^(?:root Link: (.*) has \d+ child\(ren\)| *child\(\d+\):  (.*))$", re.MULTILINE)
_MESSAGE = re.compile(r"^(?:Warning|Error): *(.*?) *$", re.MULTILINE)


@cache
def _command() -> str | None:
    return shutil.which(COMMAND)


def is_installed() -> bool:
    """Whether there is such a command."""
    return _command() is not None


def prepare() -> str:
    """Find the command, which does not tell its version."""
    _command()
    return ""


def inspect(question: Question) -> HeldRobot:
    """The links that urdfdom finds in a URDF; it tells nothing else of it.

    Raises:
        LoaderError: it refuses the file.
        CrashError: it ends with a signal.
    """
    words = [str(_command()), str(question.path)]
    done = subprocess.run(words, capture_output=True, check=False, text=True, errors="replace")  # noqa: S603 - no shell
    sys.stderr.write(done.stderr)
    if done.returncode < 0:
        raise CrashError(f"it crashed ({signal.strsignal(-done.returncode)})")
    if done.returncode:
        told = _MESSAGE.findall(done.stderr)
        raise LoaderError("; ".join(told) or " ".join(done.stderr.split()) or f"exit status {done.returncode}")
    return HeldRobot(links={root or child: None for root, child in _LINK.findall(done.stdout)})


def complaints(output: str) -> list[str]:
    """The warnings and errors that urdfdom printed."""
    return _MESSAGE.findall(output)


URDFDOM = Inspects(inspect, prepare, complaints, ("urdf",), "urdfdom", unopened=("mesh",), starts_program=True)
