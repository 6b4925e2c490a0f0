"""Calls a command on a disk that fails, once for each call of the system that may fail; see `failing_disk.c`.

A script for a process of its own, that has the library preloaded: ``failing_disk.py LIBRARY FOLDER CALLS WORD…``. Each
try is a fork, in a copy of the folder. Prints for each a line of JSON: call, number, exit status, standard error.
"""

import contextlib
import ctypes
import errno
import io
import json
import os
import shutil
import sys
import tempfile
import traceback
from pathlib import Path

MOST = 200
"""Calls of a kind at most; a command here makes far fewer."""


def tried(library: ctypes.CDLL, folder: Path, call: str, number: int, words: list[str]) -> tuple[bool, int, str]:
    """Whether the call came, exit status and standard error of a command whose n-th call of a kind fails."""
    from dh2urdf.cli import exit_status_of

    said, status = io.StringIO(), -1
    os.chdir(folder)
    library.fail_disk(os.fsencode(folder), call.encode(), errno.EIO, number)
    with contextlib.redirect_stderr(said):
        try:
            status = exit_status_of(words)
        except BaseException:  # noqa: BLE001 - it is what the test looks for
            traceback.print_exc()
    return bool(library.has_failed()), status, said.getvalue()


def main(library: ctypes.CDLL, folder: Path, calls: list[str], words: list[str]) -> None:
    """Let each call fail in turn."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what the commands print
    with tempfile.TemporaryDirectory() as top:
        warm = shutil.copytree(folder, Path(top, "warm"))
        assert tried(library, warm, "nothing", 1, words)[:2] == (False, 0)  # All modules are imported now.
        for call in calls:
            for number in range(1, MOST):
                copy = shutil.copytree(folder, Path(top, f"{call}-{number}"))
                reader, writer = os.pipe()
                if (child := os.fork()) == 0:
                    os.close(reader)
                    os.write(writer, json.dumps(tried(library, copy, call, number, words)).encode()[:60_000])
                    os._exit(0)
                os.close(writer)
                with os.fdopen(reader, "rb") as answer:
                    came, status, said = json.load(answer)
                os.waitpid(child, 0)
                shutil.rmtree(copy)
                if not came:
                    break
                print(json.dumps([call, number, status, said]), file=answers, flush=True)


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    main(ctypes.CDLL(sys.argv[1]), Path(sys.argv[2]), sys.argv[3].split(","), sys.argv[4:])
