"""Who may talk to the studio, where it listens, what it keeps of tabs and acts, and what its commands refuse."""

import asyncio
import socket
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

pytest.importorskip("nicegui")

from pathlib import Path

from command_line import Cli
from nicegui import Client

from dh2urdf.errors import InputError, MissingDependencyError
from dh2urdf_studio import app, server
from dh2urdf_studio.server import Guard

GUARD = Guard(None, 8420, ["robot-pc"])  # type: ignore[arg-type]  # only its judgement is asked for
HERE = "127.0.0.1:8420"


def headers(**given: str) -> dict[bytes, bytes]:
    return {name.replace("_", "-").encode(): value.encode() for name, value in given.items()}


@pytest.mark.parametrize(
    "host", [HERE, "localhost:8420", "LOCALHOST:8420", "[::1]:8420", "robot-pc:8420", "10.0.0.7:8420"]
)
def test_the_server_has_its_names(host: str) -> None:
    """Addresses and names of this machine are the server's; so is the origin made of them."""
    assert GUARD.refusal("http", headers(host=host)) is None
    assert GUARD.refusal("websocket", headers(host=host, origin=f"http://{host}")) is None


OTHER_HOSTS = [
    *("evil.example:8420", "evil.example", "127.0.0.1", "127.0.0.1:8421", "127.0.0.1.evil.example:8420", "[::1:8420"),
    *("x@localhost:8420", "localhost.evil.example:8420", "localhost:8420/x", "localhost:port"),
]
OTHER_ORIGINS = [
    *("https://evil.example", "http://localhost:8421", "http://127.0.0.1", "null"),
    *("https://127.0.0.1:8420", "http://localhost:8420"),
]


@pytest.mark.parametrize(
    ("host", "origin"),
    [*((host, f"http://{host}") for host in ("", *OTHER_HOSTS)), *((HERE, origin) for origin in ("", *OTHER_ORIGINS))],
)
def test_no_other_name_or_origin_gets_in(host: str, origin: str) -> None:
    """Neither by a name that was made to lead to this machine (DNS rebinding), nor from elsewhere on it."""
    for kind in ("http", "websocket"):
        assert GUARD.refusal(kind, headers(host=host, origin=origin)) is not None


def test_a_socket_needs_an_origin() -> None:
    """Every browser sends one; a handshake without is no browser's."""
    assert GUARD.refusal("websocket", headers(host=HERE)) is not None


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
    said = headers(host=HERE, sec_fetch_site=site, sec_fetch_mode=mode)
    assert (GUARD.refusal("http", said) is None) is allowed


def asked(kind: str, given: dict[bytes, bytes]) -> tuple[list[Any], bool]:
    """What is sent for a request, and whether the application behind was reached."""
    reached: list[bool] = []
    sent: list[Any] = []

    async def behind(_scope: Any, _receive: Any, send: Any) -> None:
        reached.append(True)
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def receive() -> Any:
        return {"type": "websocket.connect"}

    async def send(message: Any) -> None:
        sent.append(message)

    handled = Guard(behind, 8420)({"type": kind, "headers": list(given.items())}, receive, send)
    with ThreadPoolExecutor(1) as thread:  # The browser of other tests has a loop in this one.
        thread.submit(asyncio.run, handled).result()  # type: ignore[arg-type]  # it is a coroutine
    return sent, bool(reached)


@pytest.mark.parametrize(
    ("given", "status"),
    [
        ({"host": "evil.example"}, 403),
        ({"host": HERE, "content_length": "1048576"}, 200),
        ({"host": HERE, "content_length": "1048577"}, 413),
        ({"host": HERE, "content_length": "-1"}, 413),
        ({"host": HERE, "transfer_encoding": "chunked"}, 413),
    ],
)
def test_what_is_refused_reaches_nobody(given: dict[str, str], status: int) -> None:
    """What is too large is not read, by the length that a request has; what has none is not read either."""
    sent, reached = asked("http", headers(**given))
    assert (sent[0]["status"], reached) == (status, status == 200)
    answer = dict(sent[0]["headers"])
    assert b"default-src 'self'" in answer[b"content-security-policy"]
    assert b"frame-ancestors 'none'" in answer[b"content-security-policy"]
    assert answer[b"cross-origin-resource-policy"] == b"same-origin"


def test_a_socket_that_is_refused_is_never_open() -> None:
    sent, reached = asked("websocket", headers(host=HERE, origin="http://evil.example"))
    assert ([message["type"] for message in sent], reached) == (["websocket.close"], False)


# --- Acts ------------------------------------------------------------------------------------------------------------


def test_an_act_is_new_once() -> None:
    """An act that arrives again, or behind a later one, is known; none overtakes another; each page counts its own."""
    arrivals = app.Arrivals()
    assert [arrivals.take("one", number) for number in (1, 2, 1, 2, 3)] == [True, True, False, False, True]
    assert [arrivals.take("page", number) for number in (1, 3, 2, 3)] == [True, None, True, True]
    assert arrivals.lost("page", [(3, "row 1, a: 2"), (4, "undo")]) == ["undo"]
    assert arrivals.lost("a page of a server before", [(7, "redo")]) == ["redo"]


def test_pages_that_are_gone_are_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the pages that are gone, the one that was not heard of for the longest time goes first."""
    arrivals = app.Arrivals()
    monkeypatch.setattr(app, "MOST_PAGES", 3)
    monkeypatch.setitem(Client.instances, "there", None)
    for page in ("there", "one", "two", "one", "three"):
        arrivals.take(page, 1)
    assert [arrivals.take(page, 1) for page in ("there", "one", "three", "two")] == [False, False, False, True]


# --- Where it listens, and the commands -------------------------------------------------------------------------------


def test_ports(monkeypatch: pytest.MonkeyPatch) -> None:
    """0 is any that is free, on loopback; one that is asked for and taken is refused, the usual one gives way."""
    with server.listen("127.0.0.1", 0) as taken:
        address, port = taken.getsockname()
        assert address == "127.0.0.1"
        with pytest.raises(InputError) as caught:
            server.listen("127.0.0.1", port)
        assert caught.value.problems[0].code == "port-taken"
        monkeypatch.setattr(server, "PORT", port)
        with server.listen("127.0.0.1", None) as other:
            assert other.getsockname()[1] != port


def test_other_addresses(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only addresses of this machine can be listened at; a name without an address is none."""

    def unknown(*_: object, **__: object) -> None:
        raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")

    for host, code in (("192.0.2.1", "port-taken"), ("nowhere", "host-unknown")):
        with pytest.raises(InputError) as caught:
            server.listen(host, None)
        assert caught.value.problems[0].code == code
        monkeypatch.setattr(socket, "getaddrinfo", unknown)


def test_without_nicegui_nothing_is_served(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "find_spec", lambda _: None)
    with pytest.raises(MissingDependencyError, match=r"dh2urdf\[studio\]"):
        server.require_nicegui("studio")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["studio", "two.csv"], ["two.csv"]),
        (["studio", "two.csv", "--robot", "secnd"], ["two.csv", "'secnd'", "'second'"]),
        (["studio", "nowhere.csv", "--no-browser"], ["nowhere.csv"]),
        (["view", "nowhere.csv", "--no-browser"], ["nowhere.csv"]),
        (["view", "wrong.csv", "other.csv"], ["wrong.csv:3:3", "other.csv:3:3"]),
        (["studio", "--port", "65536"], ["--port"]),
        (["studio", "--port", "http"], ["--port"]),
    ],
)
def test_what_is_refused_before_anything_is_served(cli: Cli, tmp_path: Path, words: list[str], told: list[str]) -> None:
    """The file, the place and what there is to choose from are named; of several wrong files all are."""
    head = "# convention: standard\n"
    (tmp_path / "two.csv").write_text(f"{head}robot,a,alpha,d\nfirst,1,0,0\nsecond,2,0,0\n")
    for name in ("wrong.csv", "other.csv"):
        (tmp_path / name).write_text(f"{head}a,alpha,d\n1,x,0\n")
    answer = cli(*words, status=2)
    assert [each for each in told if each not in answer.stderr] == []
    assert answer.stdout == ""
