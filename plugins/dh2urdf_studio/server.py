"""The web server of the studio: on loopback unless told otherwise, for its own pages only.

NiceGUI opens its socket to every origin, and a browser lets any page of the web open a socket to a loopback address.
So every request and every handshake is checked before NiceGUI sees it:

- `Host` has to name this server by an address or by ``localhost``, so that a foreign name which was made to lead here
  (DNS rebinding) does not;
- `Origin`, where a browser sends one, has to be the server's own; a socket's handshake has to have one;
- what a foreign page asks for as a part of itself (`Sec-Fetch-Site`) is refused;
- what is sent has to have a length, and no more than may be taken: nothing of a larger one is read.

The answers forbid the page to load anything from elsewhere, and other pages to show it in a frame.
"""

from __future__ import annotations

import errno
import ipaddress
import os
import socket
import threading
import webbrowser
from functools import partial
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from dh2urdf.errors import InputError, MissingDependencyError
from dh2urdf.source import Mark, Messages

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable, MutableMapping

    Message = MutableMapping[str, Any]
    Send = Callable[[Message], Awaitable[None]]
    App = Callable[[Message, Callable[[], Awaitable[Message]], Send], Awaitable[None]]

say = Messages(__file__)

LOOPBACK = "127.0.0.1"
PORT = 8420  # the port that is tried first
PATIENCE = 10.0  # how long a tab that is gone may come back to what it showed [s]
_POLICY = (
    "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self' data:; connect-src 'self' blob: data:; form-action 'self'; "
    "base-uri 'self'; object-src 'none'; frame-ancestors 'none'"
)
_HEADERS = [
    (b"content-security-policy", _POLICY.encode()),
    (b"x-frame-options", b"DENY"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
]
_ELSEWHERE = "a page from elsewhere asks for this"


def require_nicegui(command: str) -> None:
    """Refuses to go on without NiceGUI."""
    if find_spec("nicegui") is None:
        raise MissingDependencyError(f"the command {command!r}", "nicegui", "dh2urdf[studio]")


def listen(host: str, port: int | None) -> socket.socket:
    """A socket that listens at an address of this machine, or a name of it.

    The port 0 is any that is free, None the usual one or, where that is taken, any that is free.

    Raises:
        InputError: the port is taken, or the address is not one of this machine.
    """
    number = PORT if port is None else port
    try:
        family, _, _, _, address = socket.getaddrinfo(host, number, type=socket.SOCK_STREAM)[0]
    except OSError as error:
        raise InputError(say("host-unknown", found=host, reason=error.strerror)) from error
    open_at = partial(socket.create_server, family=family, dualstack_ipv6=family == socket.AF_INET6)
    try:
        return open_at(address)
    except OSError as error:
        if port is None and error.errno == errno.EADDRINUSE:
            return open_at((address[0], 0, *address[2:]))
        about = {"host": host, "number": str(number), "reason": os.strerror(error.errno or 0)}
        raise InputError(say("port-taken", Mark(file="command line"), found=str(port), **about)) from error


def serve(
    build: Callable[[bool], None],
    host: str,
    port: int | None,
    report: Callable[[str], None],
    title: str,
    *,
    browser: bool,
) -> None:
    """Serves pages until it is interrupted, with a `KeyboardInterrupt`.

    `build` declares the pages; its argument is whether other machines can reach them.
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
    build(is_open)
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


class Guard:
    """An ASGI application that lets through to another one what comes from its own pages."""

    def __init__(self, app: App, port: int, names: Iterable[str] = (), largest: int = 2**20) -> None:
        """Takes the application, its port, its names besides addresses, and the size of what may be sent [B]."""
        self.app, self._port, self._largest = app, port, largest
        self._names = {"localhost", *(name.casefold() for name in names)}

    async def __call__(self, scope: Message, receive: Callable[[], Awaitable[Message]], send: Send) -> None:
        """Handles a request, a socket, or the start and end of the server."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        headers = {name.lower(): value for name, value in scope["headers"]}
        refusal, status = self.refusal(scope["type"], headers), 403
        if refusal is None:  # the server cuts off what is beyond the length that a request has
            length = headers.get(b"content-length", b"0")
            if b"transfer-encoding" in headers or not length.isdigit():
                refusal, status = "what is sent needs a length, which every browser gives", 413
            elif int(length) > self._largest:
                refusal, status = f"more than {self._largest // 2**20} MB", 413
        if refusal is None:

            async def answer(message: Message) -> None:
                if message["type"] == "http.response.start":
                    message = {**message, "headers": [*message.get("headers", ()), *_HEADERS]}
                await send(message)

            await self.app(scope, receive, answer)
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008, "reason": refusal})  # before it is accepted: 403
        else:
            told = [(b"content-type", b"text/plain; charset=utf-8"), *_HEADERS]
            await send({"type": "http.response.start", "status": status, "headers": told})
            await send({"type": "http.response.body", "body": f"{refusal}\n".encode()})

    def refusal(self, kind: str, headers: dict[bytes, bytes]) -> str | None:
        """Why a request (``http`` or ``websocket``) with some headers is refused; None where it is not."""
        host, origin = headers.get(b"host", b"").decode("latin-1"), headers.get(b"origin")
        if not self._is_here(host):
            return f"this server is not called {host!r}"
        if origin is not None:
            is_own = origin.decode("latin-1").casefold() == f"http://{host}".casefold()
            return None if is_own else _ELSEWHERE
        if kind == "websocket":
            return "a socket needs an Origin, which every browser sends"
        navigates = headers.get(b"sec-fetch-mode") == b"navigate"
        is_own = headers.get(b"sec-fetch-site", b"none") in (b"none", b"same-origin")
        return None if navigates or is_own else _ELSEWHERE

    def _is_here(self, host: str) -> bool:
        """Whether a Host header names this server."""
        try:
            parts = urlsplit(f"http://{host}")
            name, port = (parts.hostname or "").casefold(), parts.port or 80
            if port != self._port or parts.netloc != host or "@" in host:
                return False
            return name in self._names or bool(ipaddress.ip_address(name))
        except ValueError:
            return False
