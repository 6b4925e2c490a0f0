"""The web server of the studio: on loopback unless told otherwise, for its own pages only."""

from __future__ import annotations

import errno
import ipaddress
import socket
import threading
import webbrowser
from importlib.util import find_spec
from typing import TYPE_CHECKING

from dh2urdf.errors import InputError, MissingDependencyError
from dh2urdf.source import Mark, Messages
from dh2urdf_studio.guard import Guard

if TYPE_CHECKING:
    from collections.abc import Callable

say = Messages(__file__)

LOOPBACK = "127.0.0.1"
PORT = 8420
"""The port that is tried first."""
PATIENCE = 10.0
"""How long a tab that is gone may come back to what it showed [s]."""


def require_nicegui(command: str) -> None:
    """Refuses to go on without NiceGUI.

    Raises:
        MissingDependencyError: it is not installed.
    """
    if find_spec("nicegui") is None:
        raise MissingDependencyError(f"the command {command!r}", "nicegui", "dh2urdf[studio]")


def listen(host: str, port: int | None) -> socket.socket:
    """A socket that listens at an address of this machine.

    Args:
        host: the address, or a name of this machine.
        port: the port; 0 for any that is free, None for the usual one or, where that is taken, any that is free.

    Raises:
        InputError: the port is taken, or the address is not one of this machine.
    """
    try:
        family, _, _, _, address = socket.getaddrinfo(host, PORT if port is None else port, type=socket.SOCK_STREAM)[0]
    except OSError as error:
        raise InputError(say("host-unknown", found=host, reason=error.strerror)) from error
    listening = socket.socket(family, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind(address)
    except OSError as error:
        if port is not None or error.errno != errno.EADDRINUSE:
            listening.close()
            number, mark = PORT if port is None else port, Mark(file="command line")
            about = {"host": host, "number": str(number), "reason": str(error.strerror)}
            raise InputError(say("port-taken", mark, found=str(port), **about)) from error
        listening.bind((address[0], 0, *address[2:]))
    listening.listen(128)
    return listening


def serve(
    build: Callable[[], None], *, host: str, port: int | None, browser: bool, report: Callable[[str], None], title: str
) -> None:
    """Serves pages until it is interrupted.

    Raises:
        InputError: nothing can be served there.
        KeyboardInterrupt: that is how a server ends.
    """
    listening = listen(host, port)
    import uvicorn
    from fastapi import FastAPI
    from fastapi.middleware.gzip import GZipMiddleware
    from nicegui import app as pages, ui

    from dh2urdf_studio.drawing.mesh_files import LARGEST

    name, port = listening.getsockname()[:2]
    is_open = not ipaddress.ip_address(name).is_loopback  # to other machines
    app = FastAPI(openapi_url=None)
    # Quasar's bar at the top of a page has no name for people who hear it, and the page has progress of its own.
    pages.config.quasar_config["loadingBar"]["skipHijack"] = True
    build()
    ui.run_with(
        app,
        title=title,
        favicon="🦾",
        show_welcome_message=False,
        reconnect_timeout=PATIENCE,
        tailwind=False,
        gzip_middleware_factory=GZipMiddleware if is_open else None,  # packing takes longer than loopback saves
    )
    guarded = Guard(app, port, [host, socket.gethostname()], LARGEST + 2**20)  # files, and their names
    server = uvicorn.Server(uvicorn.Config(guarded, log_level="warning", ws_max_size=64 * 2**20))
    place = f"[{name}]" if ":" in name else name
    address = f"http://{LOOPBACK if name in ('0.0.0.0', '::') else place}:{port}/"  # noqa: S104 - a comparison
    report(f"{title} is at {address} (Ctrl-C ends it)")
    if is_open:
        report("everybody who reaches this port of the machine can use it: there is no password")
    if browser:
        threading.Timer(0.5, webbrowser.open, [address]).start()
    try:
        server.run(sockets=[listening])
    finally:
        listening.close()
