"""The loader `coppeliasim`: has a running CoppeliaSim import the written URDF, and measures the arm there.

CoppeliaSim is a program of its own. It is asked over its ZMQ remote API, by Coppelia Robotics' own Python client, and
what it prints stays on its console. It has one scene, which all workers of a run would use at once: each waits for its
turn.
"""

from __future__ import annotations

import fcntl
import os
import tempfile
import time
from contextlib import closing, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.errors import LoaderError, MissingProgramError
from dh2urdf.stages import LOAD_TIME_LIMIT
from dh2urdf_plugins.loaders.simulators import PACKAGES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.stages import LoadReport, LoadRequest
    from dh2urdf_plugins.loaders.simulators import CoppeliaSimOptions

ANSWERS_WITHIN = 5.0
"""How long a CoppeliaSim may take to answer at all [s]; its client would wait for ever."""
_AGAIN = 0.02
"""How long to wait between two looks at whether CoppeliaSim is free [s]."""
REMEDY = (
    "start one without a window, in its folder, by ./coppeliaSim.sh -H (with -GzmqRemoteApi.rpcPort=N for another "
    "port), or say in the loader's options `host` and `port` where it runs"
)


def load(request: LoadRequest, options: CoppeliaSimOptions) -> LoadReport:
    """Have CoppeliaSim import a URDF, and measure the arm; it is taken out of the scene again.

    Raises:
        LoaderError: CoppeliaSim cannot import the file, or holds another arm than the one that was written.
        MissingDependencyError: the client is not installed.
        MissingProgramError: no CoppeliaSim answers.
    """
    import socket
    from ipaddress import ip_address

    client_class = PACKAGES["coppeliasim"].load(options).RemoteAPIClient
    import zmq

    from dh2urdf_plugins.loaders.coppeliasim.arm import Arm, Connection

    try:
        with socket.create_connection((options.host, options.port), ANSWERS_WITHIN) as greeting:
            address, own = str(greeting.getpeername()[0]), str(greeting.getsockname()[0])
    except OSError as error:
        raise _silent(options) from error
    same_machine = address == own or ip_address(address.partition("%")[0]).is_loopback
    key = f"coppeliasim-{'localhost' if same_machine else address}-{options.port}"
    with turn(key, f"CoppeliaSim at {options.host}:{options.port}", LOAD_TIME_LIMIT / 2):
        client = client_class(options.host, options.port)
        client.socket.setsockopt(zmq.LINGER, 0)  # What was not delivered must not keep this process from ending.
        client.socket.setsockopt(zmq.RCVTIMEO, round(1000 * ANSWERS_WITHIN))
        try:
            client.require("sim")  # Somebody listens: CoppeliaSim, or another program?
        except zmq.ZMQError as error:
            raise _silent(options) from error
        client.socket.setsockopt(zmq.RCVTIMEO, round(1000 * LOAD_TIME_LIMIT / 4))
        with closing(Arm(request, Connection(client), same_machine=same_machine)) as arm:
            report = arm.report()
            if options.engine is None:
                return report
            held, findings = arm.hold(options.engine)
            return replace(report, hold=held, findings=(*report.findings, *findings))


@contextmanager
def turn(key: str, what: str, patience: float) -> Iterator[None]:
    """Wait until no other process of this machine uses a program, and use it alone.

    The system ends the turn of a process that crashes or is killed.

    Args:
        key: names the program; part of a file name.
        what: names it in messages.
        patience: how long to wait [s].

    Raises:
        LoaderError: others have used it all the time.
    """
    path = Path(tempfile.gettempdir(), f"dh2urdf-{key}.lock".replace(":", "_"))
    deadline = time.monotonic() + patience
    while (lock := _locked(path)) is None:
        if time.monotonic() > deadline:
            how = "use fewer workers, or start another one"
            raise LoaderError(f"{what} was busy with other files for {patience:g} s: {how}")
        time.sleep(_AGAIN)
    try:
        yield
    finally:
        with suppress(PermissionError):  # Another user's file stays.
            path.unlink()
        os.close(lock)


def _locked(path: Path) -> int | None:
    """Open and lock a file; None where another process has the lock, or has just removed the file."""
    with suppress(PermissionError):  # Another user's file can be locked, too.
        path.touch(mode=0o644)
    lock = None
    try:
        lock = os.open(path, os.O_RDONLY)
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.path.samestat(os.fstat(lock), path.stat()):
            return lock
    except (BlockingIOError, FileNotFoundError):
        pass
    if lock is not None:
        os.close(lock)
    return None


def _silent(options: CoppeliaSimOptions) -> MissingProgramError:
    return MissingProgramError(
        "loader 'coppeliasim'", f"a CoppeliaSim that answers at {options.host}:{options.port}", REMEDY
    )
