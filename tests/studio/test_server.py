from __future__ import annotations

import socket

import pytest

from dh2urdf.errors import InputError, MissingDependencyError
from dh2urdf_studio import server


def test_any_free_port() -> None:
    """Port 0 is any that is free, on loopback."""
    with server.listen("127.0.0.1", 0) as listening:
        address, port = listening.getsockname()
        assert address == "127.0.0.1"
        assert port > 0


def test_a_port_that_is_taken_is_an_error() -> None:
    """Who asks for a port gets that one, or is told why not."""
    with server.listen("127.0.0.1", 0) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(
            InputError, match=f"nothing can be served at 127.0.0.1, port {port}: Address already in use"
        ):
            server.listen("127.0.0.1", port)


def test_the_usual_port_gives_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nobody asks for a port and the usual one is taken, it is another one: two studios run side by side."""
    with server.listen("127.0.0.1", 0) as taken:
        monkeypatch.setattr(server, "PORT", taken.getsockname()[1])
        with server.listen("127.0.0.1", None) as other:
            assert other.getsockname()[1] != server.PORT


def test_an_address_of_another_machine_is_an_error() -> None:
    """Only addresses of this machine can be listened at; the message names address and port."""
    with pytest.raises(InputError, match=r"nothing can be served at 192\.0\.2\.1, port 8420: Cannot assign"):
        server.listen("192.0.2.1", None)


def test_an_unknown_host_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """A name without an address is told as such."""

    def unknown(*_: object, **__: object) -> None:
        raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")

    monkeypatch.setattr(socket, "getaddrinfo", unknown)
    with pytest.raises(InputError, match="no address is known for the host 'nowhere': Name or service not known"):
        server.listen("nowhere", 0)


def test_without_nicegui_it_is_said_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """The message names the command and the extra."""
    monkeypatch.setattr(server, "find_spec", lambda _: None)
    with pytest.raises(
        MissingDependencyError, match=r"the command 'studio' needs nicegui: .* -m pip install 'dh2urdf\[studio\]'"
    ):
        server.require_nicegui("studio")
