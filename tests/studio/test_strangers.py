"""Nobody but its own page drives the studio: handshakes made by hand, and a hostile page in a real browser."""

from __future__ import annotations

import http.client
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import pytest
from foreign_pages import foreign_page

if TYPE_CHECKING:
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
def test_only_the_own_page_gets_in(studio_address: str, path: str) -> None:
    """With its own headers; neither from another origin, nor by a name that was made to lead here."""
    here = urlsplit(studio_address)
    assert answer(studio_address, path, Origin=studio_address.rstrip("/")) == (101 if path == SOCKET else 200)
    for origin in ("http://evil.example", "null", "http://127.0.0.1:1"):
        assert answer(studio_address, path, Origin=origin) == 403
    host = f"evil.example:{here.port}"
    assert answer(studio_address, path, Host=host, Origin=f"http://{host}") == 403
    if path == SOCKET:
        assert answer(studio_address, path) == 403, "a handshake without an origin is no browser's"


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
def test_a_hostile_page(studio_address: str, hostile_page: str, chromium: Browser, tab: Any) -> None:
    """A page that a person has open beside the studio opens no socket, reads nothing, and moves nothing."""
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
