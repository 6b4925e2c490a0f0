from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from dh2urdf_studio.server import Guard

GUARD = Guard(None, 8420, ["robot-pc"])  # type: ignore[arg-type]  # only its judgement is asked for


def headers(**given: str) -> dict[bytes, bytes]:
    return {name.replace("_", "-").encode(): value.encode() for name, value in given.items()}


@pytest.mark.parametrize(
    "host", ["127.0.0.1:8420", "localhost:8420", "LOCALHOST:8420", "[::1]:8420", "robot-pc:8420", "10.0.0.7:8420"]
)
def test_the_server_has_its_names(host: str) -> None:
    """Addresses and names of this machine are the server's; so is the origin made of them."""
    assert GUARD.refusal("http", headers(host=host)) is None
    assert GUARD.refusal("websocket", headers(host=host, origin=f"http://{host}")) is None


@pytest.mark.parametrize(
    "host",
    [
        "",
        "evil.example:8420",
        "evil.example",
        "127.0.0.1",
        "127.0.0.1:8421",
        "127.0.0.1.evil.example:8420",
        "localhost.evil.example:8420",
        "x@localhost:8420",
        "localhost:8420/x",
        "localhost:port",
        "[::1:8420",
    ],
)
def test_no_other_name_leads_here(host: str) -> None:
    """A name that was made to lead to this machine (DNS rebinding) is refused."""
    for kind in ("http", "websocket"):
        assert GUARD.refusal(kind, headers(host=host, origin=f"http://{host}")) is not None


@pytest.mark.parametrize(
    "origin",
    [
        "https://evil.example",
        "http://localhost:8421",
        "http://127.0.0.1",
        "null",
        "https://127.0.0.1:8420",
        "http://localhost:8420",
        "",
    ],
)
def test_no_other_origin_speaks_to_it(origin: str) -> None:
    """Another origin, even on this machine, gets neither a page nor a socket."""
    for kind in ("http", "websocket"):
        assert GUARD.refusal(kind, headers(host="127.0.0.1:8420", origin=origin)) is not None


def test_a_socket_needs_an_origin() -> None:
    """Every browser sends one; a handshake without is no browser's."""
    assert GUARD.refusal("websocket", headers(host="127.0.0.1:8420")) is not None


@pytest.mark.parametrize(
    ("site", "mode", "allowed"),
    [
        ("none", "navigate", True),
        ("same-origin", "cors", True),
        ("cross-site", "navigate", True),
        ("cross-site", "no-cors", False),
        ("same-site", "no-cors", False),
    ],
)
def test_no_page_takes_it_for_a_part_of_itself(site: str, mode: str, *, allowed: bool) -> None:
    """A link may lead here; a script, a picture or a fetch of a foreign page may not."""
    said = headers(host="127.0.0.1:8420", sec_fetch_site=site, sec_fetch_mode=mode)
    assert (GUARD.refusal("http", said) is None) is allowed


def asked(kind: str, given: dict[bytes, bytes]) -> tuple[list[Any], bool]:
    """What is sent for a request, and whether the application behind was reached."""
    reached: list[bool] = []
    sent: list[Any] = []

    async def app(_scope: Any, _receive: Any, send: Any) -> None:
        reached.append(True)
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def receive() -> Any:
        return {"type": "websocket.connect"}

    async def send(message: Any) -> None:
        sent.append(message)

    handled = Guard(app, 8420)({"type": kind, "headers": list(given.items())}, receive, send)
    with ThreadPoolExecutor(1) as thread:  # The browser of other tests has a loop in this one.
        thread.submit(asyncio.run, handled).result()  # type: ignore[arg-type]  # it is a coroutine
    return sent, bool(reached)


def test_what_is_refused_reaches_nobody() -> None:
    """A request gets 403, a socket is closed before it is open, and the application behind sees neither."""
    sent, reached = asked("http", headers(host="evil.example"))
    assert (sent[0]["status"], reached) == (403, False)
    sent, reached = asked("websocket", headers(host="127.0.0.1:8420", origin="http://evil.example"))
    assert ([message["type"] for message in sent], reached) == (["websocket.close"], False)


@pytest.mark.parametrize(
    ("sent", "status"),
    [
        ({"content-length": "1048576"}, 200),
        ({"content-length": "1048577"}, 413),
        ({"content-length": "-1"}, 413),
        ({"transfer-encoding": "chunked"}, 413),
    ],
)
def test_what_is_too_large_is_not_read(sent: dict[str, str], status: int) -> None:
    """By the length that a request says, before any of it is in memory; what says none is not read."""
    more = {name.encode(): text.encode() for name, text in sent.items()}
    answer, reached = asked("http", headers(host="127.0.0.1:8420") | more)
    assert (answer[0]["status"], reached) == (status, status == 200)


def test_answers_forbid_what_is_foreign() -> None:
    """A page of the studio loads nothing from elsewhere and is shown in nobody's frame."""
    sent, reached = asked("http", headers(host="127.0.0.1:8420"))
    assert reached
    answer = dict(sent[0]["headers"])
    assert b"default-src 'self'" in answer[b"content-security-policy"]
    assert b"frame-ancestors 'none'" in answer[b"content-security-policy"]
    assert answer[b"cross-origin-resource-policy"] == b"same-origin"
