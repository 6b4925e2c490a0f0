"""urdfdom's command `check_urdf`, which reads a URDF as ROS does, as a program that is given files."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
from functools import cache
from pathlib import Path

from dh2urdf.errors import CrashError, LoaderError
from dh2urdf.stages import HeldRobot, Inspects, Question

COMMAND = "check_urdf"
_LINK = re.compile(r"^(?:root Link: (.*) has \d+ child\(ren\)| *child\(\d+\):  (.*))$", re.MULTILINE)
_MESSAGE = re.compile(r"^(?:Warning|Error): *(.*?) *$", re.MULTILINE)


@cache
def command() -> str | None:
    """The program itself; None where it is not installed.

    The wheel that Pinocchio needs has it, too, behind a Python script of the same name; that script makes a temporary
    folder, which no fence allows.
    """
    found = (shutil.which(COMMAND, path=folder) for folder in (*os.get_exec_path(), str(_wheel() / "bin")))
    return next((path for path in found if path and Path(path).open("rb").read(2) != b"#!"), None)


def _wheel() -> Path:
    """Where programs that wheels bring along are."""
    return Path(sysconfig.get_path("purelib"), "cmeel.prefix")


def prepare() -> str:
    """Find the command, which does not tell its version."""
    command()
    return ""


def inspect(question: Question) -> HeldRobot:
    """The links that urdfdom finds in a URDF; it tells nothing else of it."""
    words = [str(command()), str(question.path)]
    libraries = {"LD_LIBRARY_PATH": str(_wheel() / "lib")} if str(command()).startswith(str(_wheel())) else {}
    done = subprocess.run(  # noqa: S603 - no shell
        words, capture_output=True, check=False, text=True, errors="replace", env={**os.environ, **libraries}
    )
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
