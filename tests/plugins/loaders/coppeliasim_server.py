"""A real CoppeliaSim for tests, where there is one: DH2URDF_COPPELIASIM is a command that starts it without a window,
and takes the port of its remote API as a further word."""

from __future__ import annotations

import contextlib
import os
import shlex
import socket
import subprocess
import time
from typing import Self

COMMAND = os.environ.get("DH2URDF_COPPELIASIM", "")
STARTS_WITHIN = 120.0


class Real:
    """A CoppeliaSim on a port that is free, to be started again after a crash."""

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def start(self) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self._process = subprocess.Popen(
            [*shlex.split(COMMAND), str(self.port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        deadline = time.monotonic() + STARTS_WITHIN
        while time.monotonic() < deadline:
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", self.port), 1):
                return
            time.sleep(0.2)
        raise AssertionError(f"no CoppeliaSim at port {self.port} within {STARTS_WITHIN:g} s")

    def end(self) -> None:
        self._process.kill()
        self._process.wait()
