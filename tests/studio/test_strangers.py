"""Nobody but its own page drives the studio: handshakes made by hand, and a hostile page in a real browser."""

from __future__ import annotations

import http.client
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import pytest
from foreign_pages import foreign_page

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from playwright.sync_api import Browser

SOCKET = "/_nicegui_ws/socket.io/?EIO=4&transport=websocket"
POLLING = "/_nicegui_ws/socket.io/?EIO=4&transport=polling"
HANDSHAKE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}


def answer(address: str, path: str, **headers: str | None) -> int:
    """The status that a request gets, Host and other headers as they are given."""
    here = urlsplit(address).netloc
    connection = http.client.HTTPConnection(here, timeout=10)
    sent = {"Host": here, **(HANDSHAKE if path == SOCKET else {}), **headers}
    connection.putrequest("GET", path, skip_host=True)
    for name, value in sent.items():
        if value is not None:
            connection.putheader(name.replace("_", "-"), value)
    connection.endheaders()
    status = connection.getresponse().status
    connection.close()
    return status


@pytest.mark.parametrize("path", ["/", POLLING, SOCKET])
def test_the_own_page_gets_in(studio_address: str, path: str) -> None:
    """With the headers that a browser sends for the studio's own page, a page and a socket are given."""
    own = studio_address.rstrip("/")
    assert answer(studio_address, path, Origin=own) == (101 if path == SOCKET else 200)


@pytest.mark.parametrize("path", ["/", POLLING, SOCKET])
@pytest.mark.parametrize("origin", ["http://evil.example", "https://evil.example", "null", "http://127.0.0.1:1"])
def test_another_origin_does_not(studio_address: str, path: str, origin: str) -> None:
    """A page from elsewhere gets neither the page nor the socket, by whatever transport."""
    assert answer(studio_address, path, Origin=origin) == 403


@pytest.mark.parametrize("path", ["/", POLLING, SOCKET])
def test_another_name_does_not(studio_address: str, path: str) -> None:
    """A name that was made to lead here is refused, though Host and Origin agree."""
    host = f"evil.example:{urlsplit(studio_address).port}"
    assert answer(studio_address, path, Host=host, Origin=f"http://{host}") == 403


def test_a_socket_without_an_origin_does_not(studio_address: str) -> None:
    """A handshake that says nothing of where it comes from is refused."""
    assert answer(studio_address, SOCKET) == 403


HOSTILE = """<!doctype html><title>waiting</title><iframe id="frame" src="{address}"></iframe><script>
const told = {{}};
const ask = (name, promise) => promise.then(() => (told[name] = "in"), () => (told[name] = "out"));
const socket = (url) => new Promise((resolve, reject) => {{
    const socket = new WebSocket(url);
    socket.onopen = resolve;
    socket.onerror = reject;
}});
const script = new Promise((resolve, reject) => {{
    const element = document.createElement("script");
    element.onload = resolve;
    element.onerror = reject;
    element.src = "{address}{script}";
    document.head.append(element);
}});
Promise.all([
    ask("socket", socket("{socket}")),
    ask("page", fetch("{address}")),
    ask("blind", fetch("{address}", {{mode: "no-cors"}}).then((answer) => {{ if (answer.type !== "opaque") throw 0; }})),
    ask("post", fetch("{address}{polling}", {{method: "POST", body: "40"}})),
    ask("script", script),
]).then(() => {{
    let framed = "out";
    try {{ framed = document.getElementById("frame").contentDocument === null ? "hidden" : "in"; }} catch {{}}
    document.title = JSON.stringify(told);
}});
</script>"""


@pytest.fixture
def hostile_page(studio_address: str) -> Iterator[str]:
    """A page of another origin that does what it can to get into the studio."""
    where = urlsplit(studio_address).netloc
    text = HOSTILE.format(
        address=studio_address,
        socket=f"ws://{where}{SOCKET}",
        polling=POLLING[1:],
        script="_nicegui/auto/static/nicegui.js",
    )

    with foreign_page(text) as address:
        yield address


@pytest.mark.long
def test_a_hostile_page(studio_address: str, hostile_page: str, chromium: Browser, new_tab: Callable[..., Any]) -> None:
    """A page that a person has open beside the studio opens no socket, reads nothing, and moves nothing."""
    tab = new_tab(studio_address)
    tab.open("ur5")
    context = chromium.new_context()
    try:
        page = context.new_page()
        page.goto(hostile_page)
        page.wait_for_function("document.title !== 'waiting'")
        told = page.evaluate("JSON.parse(document.title)")
        assert told == dict.fromkeys(("socket", "page", "blind", "post", "script"), "out")
        # Chromium shows an error page in the frame, which is of no origin.
        assert not any(frame.url.startswith(studio_address) for frame in page.frames[1:])
    finally:
        context.close()
    assert tab.status == "6 axes; the arm is the table's"


def test_the_same_page_of_the_own_origin_would_get_in(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """The same socket, opened by the studio's own page, opens: what keeps the hostile one out is where it comes from."""
    tab = new_tab(studio_address)
    page = tab.open()
    opened = page.evaluate(
        """url => new Promise(resolve => {
            const socket = new WebSocket(url);
            socket.onopen = () => { socket.close(); resolve(true); };
            socket.onerror = () => resolve(false);
        })""",
        f"ws://{urlsplit(studio_address).netloc}{SOCKET}",
    )
    assert opened
